//! Detection of truncated JPEG files.
//!
//! Decoders silently fill missing data with grey; a frame that is half grey must not be accepted.

/// The marker "end of image" (ITU-T T.81, table B.1).
const END: u8 = 0xd9;

/// Whether the bytes of a JPEG run out before its "end of image" marker.
///
/// Segments are skipped by their lengths, so that the end of an embedded thumbnail does not count
/// (T.81, B.1.1.4). In entropy-coded data 0xff is always followed by a marker, or by 0 if it is
/// data (B.1.1.5).
pub(super) fn is_cut_off(bytes: &[u8]) -> bool {
    // Position 2 is after the "start of image" marker. Every step goes on by at least two bytes, so
    // that the loop ends.
    let mut at = 2;
    while let Some((marker, after)) = next_marker(bytes, at) {
        match marker {
            END => return false,
            // Markers without a segment: stuffed data, temporary, restarts, start of image.
            0 | 0x01 | 0xd0..=0xd8 => at = after,
            _ => {
                // The length counts its own two bytes. After the header of a scan, the
                // entropy-coded data follow, in which the next marker is searched.
                let Some(&[high, low]) = bytes.get(after..after + 2).and_then(<[u8]>::first_chunk)
                else {
                    return true;
                };
                at = after + usize::from(u16::from_be_bytes([high, low])).max(2);
            }
        }
    }
    true
}

/// The next marker at or after a position, and the position after it. Fill bytes (0xff) before a
/// marker belong to it.
fn next_marker(bytes: &[u8], from: usize) -> Option<(u8, usize)> {
    let start = from + bytes.get(from..)?.iter().position(|&byte| byte == 0xff)?;
    let after_fill = start + bytes[start..].iter().position(|&byte| byte != 0xff)?;
    Some((bytes[after_fill], after_fill + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn jpeg() -> Vec<u8> {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let picture = image::RgbImage::from_fn(32, 24, |x, y| {
            image::Rgb([(9 * x) as u8, (7 * y) as u8, (x * y) as u8])
        });
        picture
            .write_to(&mut bytes, image::ImageFormat::Jpeg)
            .unwrap();
        bytes.into_inner()
    }

    #[test]
    fn a_whole_picture_ends_and_every_shorter_one_does_not() {
        let bytes = jpeg();
        assert!(!is_cut_off(&bytes));
        for length in 0..bytes.len() {
            assert!(
                is_cut_off(&bytes[..length]),
                "{length} of {} bytes",
                bytes.len()
            );
        }
    }

    #[test]
    fn what_follows_the_picture_does_not_matter_and_a_thumbnail_inside_does_not_end_it() {
        let bytes = jpeg();
        assert!(!is_cut_off(&[bytes.as_slice(), &[0; 9]].concat()));
        let comment = [&[0xff, 0xfe, 0, 6, 0xff, 0xd9, 0xff, 0xd9], &bytes[2..]].concat();
        let with_comment = [&bytes[..2], comment.as_slice()].concat();
        assert!(!is_cut_off(&with_comment));
        assert!(is_cut_off(&with_comment[..with_comment.len() - 2]));
    }
}
