//! The container of a video, recognised by the first bytes of the file.
//!
//! It names the demuxer that reads the file, decides how much of what the container states can be
//! believed, and whether a seek needs a run-up. `FFmpeg` would guess the demuxer from anything in
//! the file, and some of them are lists: HLS, DASH, `ffconcat` and session descriptions have the
//! pictures taken from other files or from the network. A video may come from a stranger, so only
//! containers that hold their pictures themselves are opened, each with its own demuxer; whatever
//! is not recognised is refused before a backend reads it.

use crate::media::MediaError;
use crate::media::error::open_file;
use std::io::Read;
use std::path::Path;

/// The container of a video.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Container {
    pub kind: ContainerKind,
    /// The name of its demuxer in `FFmpeg`.
    pub demuxer: &'static str,
}

/// What can be believed of a container.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ContainerKind {
    /// MP4 and `QuickTime`: state the exact number of stored frames and their average rate.
    Mp4,
    /// Matroska, `WebM` and AVI: have an index of key frames; rate and length are nominal.
    Indexed,
    /// Transport streams and similar: no index.
    Stream,
}

/// Number of bytes that are read of a file: five packets of a transport stream that begins in the
/// middle of one.
const HEAD_BYTES: u64 = 2048;

/// The lengths of packets of a transport stream: as broadcast, with a time stamp, with parity.
const PACKET_BYTES: [usize; 3] = [188, 192, 204];

/// Beginnings of lists of other files or addresses. None begins a video, but a demuxer that is not
/// named finds some of them anywhere in the text at the beginning of a file.
const LISTS: [&[u8]; 5] = [
    b"#EXTM3U",
    b"ffconcat",
    b"<MPD",
    b"<CompositionPlaylist",
    b"c=IN IP",
];

/// Recognises the container by the first bytes of the file.
///
/// # Errors
/// The file cannot be read, or begins as no container that holds its own pictures does.
pub(super) fn container_of(path: &Path) -> Result<Container, MediaError> {
    let head = head_of(path)?;
    if let Some(kind) = foreign_picture(&head) {
        return Err(MediaError::UnsupportedImage {
            path: path.to_path_buf(),
            what: kind.to_owned(),
        });
    }
    container_by_head(&head).ok_or_else(|| MediaError::NotAVideo {
        path: path.to_path_buf(),
    })
}

/// The error of a file in which a reader finds no video: one that begins as a video was probably not
/// written or copied to its end.
pub(super) fn no_video_in(path: &Path) -> MediaError {
    let is_begun = head_of(path).is_ok_and(|head| container_by_head(&head).is_some());
    let path = path.to_path_buf();
    if is_begun {
        MediaError::NoFrames { path }
    } else {
        MediaError::NotAVideo { path }
    }
}

/// The first bytes of a file.
fn head_of(path: &Path) -> Result<Vec<u8>, MediaError> {
    let mut head = Vec::new();
    open_file(path)?
        .take(HEAD_BYTES)
        .read_to_end(&mut head)
        .map_err(|error| MediaError::from_io(path, &error))?;
    Ok(head)
}

/// The kind of a file that holds pictures which no video reader shows as they are: those of
/// telephones lie in boxes as MP4 does, in tiles.
fn foreign_picture(head: &[u8]) -> Option<&'static str> {
    const BRANDS: [&[u8]; 7] = [
        b"heic", b"heix", b"heim", b"heis", b"mif1", b"avif", b"avis",
    ];
    if head.starts_with(b"%PDF") {
        return Some("PDF");
    }
    let brand = head
        .get(8..12)
        .filter(|_| head.get(4..8) == Some(b"ftyp"))?;
    let is_picture = BRANDS.contains(&brand);
    is_picture.then_some(if brand.starts_with(b"av") {
        "AVIF"
    } else {
        "HEIC"
    })
}

fn container_by_head(head: &[u8]) -> Option<Container> {
    use ContainerKind::{Indexed, Mp4, Stream};
    // The backend of OpenCV cannot be given a demuxer. Its text demuxers read up to the first zero
    // byte, so no list may begin before it.
    let text = head.split(|byte| *byte == 0).next().unwrap_or_default();
    let has = |list: &[u8]| text.windows(list.len()).any(|part| part == list);
    if LISTS.iter().any(|list| has(list)) {
        return None;
    }
    let (kind, demuxer) = if is_mp4(head) {
        (Mp4, "mov")
    } else if head.starts_with(b"\x1a\x45\xdf\xa3") {
        (Indexed, "matroska")
    } else if head.starts_with(b"RIFF") && head.get(8..11) == Some(b"AVI") {
        (Indexed, "avi")
    } else {
        (Stream, stream_demuxer(head)?)
    };
    Some(Container { kind, demuxer })
}

/// Whether a file begins with a box of MP4 or `QuickTime`.
fn is_mp4(head: &[u8]) -> bool {
    let boxes: [&[u8; 4]; 14] = [
        b"ftyp", b"moov", b"mdat", b"free", b"wide", b"skip", b"styp", b"sidx", b"moof", b"pnot",
        b"uuid", b"udta", b"junk", b"prfl",
    ];
    boxes
        .iter()
        .any(|name| head.get(4..8) == Some(name.as_slice()))
}

/// The demuxer of a container without an index, and of bare streams of a codec.
fn stream_demuxer(head: &[u8]) -> Option<&'static str> {
    let beginnings: [(&[u8], &'static str); 16] = [
        (b"FLV\x01", "flv"),
        (b"OggS", "ogg"),
        (b"\x30\x26\xb2\x75\x8e\x66\xcf\x11", "asf"),
        (b"\x06\x0e\x2b\x34\x02\x05\x01\x01\x0d\x01\x02", "mxf"),
        (b"\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\xbc", "gxf"),
        (b"YUV4MPEG2 ", "yuv4mpegpipe"),
        (b"DKIF", "ivf"),
        (b"nut/multimedia container\0", "nut"),
        (b"GIF8", "gif"),
        (b"\x1f\x07\x00", "dv"),
        (b"\x00\x00\x01\xba", "mpeg"),
        // A recorder of surveillance cameras puts a header of its own before the same stream.
        (b"IMKH", "mpeg"),
        (b"\x00\x00\x01\xb3", "mpegvideo"),
        (b"\x00\x00\x01\xb0", "m4v"),
        // A picture under the name of a video is a video of one frame.
        (b"\x89PNG", "png_pipe"),
        (b"\xff\xd8\xff", "jpeg_pipe"),
    ];
    let beginning = beginnings
        .iter()
        .find(|(beginning, _)| head.starts_with(beginning));
    if let Some((_, demuxer)) = beginning {
        return Some(demuxer);
    }
    if is_transport_stream(head) {
        return Some("mpegts");
    }
    // A bare stream of H.264 begins with a parameter set, a delimiter or what its encoder says of
    // itself, one of HEVC likewise: the kind of a unit is in the lowest five bits of its first byte,
    // or in the middle six.
    let after_zeros = head.iter().position(|byte| *byte != 0).unwrap_or_default();
    match (after_zeros, head.get(after_zeros..after_zeros + 2)) {
        (2 | 3, Some(&[1, unit])) if unit & 0x80 == 0 => match (unit & 31, unit >> 1) {
            (7 | 9, _) | (_, 3) => Some("h264"),
            (_, 32 | 33 | 35 | 39) => Some("hevc"),
            _ => None,
        },
        _ => None,
    }
}

/// Whether packets of a transport stream follow each other to the end of `head`.
fn is_transport_stream(head: &[u8]) -> bool {
    // A recording may begin within a packet. Three of them in a row are no coincidence.
    let in_step = |first: usize, bytes: usize| {
        let mut starts = head.iter().skip(first).step_by(bytes);
        starts.len() >= 3 && starts.all(|byte| *byte == b'G')
    };
    PACKET_BYTES
        .iter()
        .any(|&bytes| (0..bytes).any(|first| in_step(first, bytes)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn demuxer(head: &[u8]) -> Option<&'static str> {
        container_by_head(head).map(|container| container.demuxer)
    }

    #[test]
    fn a_container_names_its_demuxer() {
        let mut packets = vec![0; 60];
        for _ in 0..5 {
            packets.push(b'G');
            packets.extend([0xaa; 187]);
        }
        let cases: [(&[u8], &str); 9] = [
            (b"\0\0\0\x20ftypisom", "mov"),
            (b"\0\0\0\x08wide\0\0\0\0mdat", "mov"),
            (b"\x1a\x45\xdf\xa3\xa3\x42\x86\x81\x01", "matroska"),
            (b"RIFF\x10\0\0\0AVI LIST", "avi"),
            (&packets, "mpegts"),
            (&packets[60..], "mpegts"),
            (b"\0\0\x01\xba\x44\0", "mpeg"),
            (b"\0\0\0\x01\x67\x64\0\x1f", "h264"),
            (b"\0\0\0\x01\x40\x01\x0c", "hevc"),
        ];
        for (head, expected) in cases {
            assert_eq!(demuxer(head), Some(expected), "{head:?}");
        }
        assert_eq!(demuxer(&packets[..400]), None, "two packets");
        assert_eq!(demuxer(&[0; 64]), None);
    }

    #[test]
    fn pictures_of_telephones_and_documents_want_another_conversion() {
        let place = tempfile::tempdir().unwrap();
        let refused = |bytes: &[u8]| {
            let path = place.path().join("a.mp4");
            std::fs::write(&path, bytes).unwrap();
            container_of(&path).unwrap_err().to_string()
        };
        for (head, kind) in [
            (&b"\0\0\0\x18ftypheic\0\0\0\0"[..], "HEIC"),
            (b"\0\0\0\x1cftypavif\0\0\0\0", "AVIF"),
            (b"%PDF-1.7\n", "PDF"),
        ] {
            let said = refused(head);
            let remedy = format!("({kind}); convert it to PNG or JPEG");
            assert!(said.ends_with(&remedy), "{said}");
        }
        let half = place.path().join("half.mp4");
        std::fs::write(&half, b"\0\0\0\x20ftypisom\0\0\x02\0isomiso2avc1mp41").unwrap();
        assert!(no_video_in(&half).to_string().contains("copy it again"));
    }

    #[test]
    fn a_list_of_other_files_is_no_video() {
        let lists: [&[u8]; 6] = [
            b"#EXTM3U\n#\x01\n#EXTINF:1.0,\n/home/me/family.mp4\n",
            b"ffconcat version 1.0\n#\x01\nfile '/home/me/family.mp4'\n",
            b"<?xml version=\"1.0\"?>\x01<MPD profiles=\"urn:mpeg:dash:profile:isoff-live:2011\">",
            b"\x1a\x45\xdf\xa3<MPD profiles=\"urn:mpeg:dash:profile:isoff-live:2011\">",
            b"GIF8\nc=IN IP4 10.0.0.1\nm=video 5000 RTP/AVP 96\n",
            b"\x01a file that begins as nothing does",
        ];
        for list in lists {
            assert_eq!(demuxer(list), None, "{}", String::from_utf8_lossy(list));
        }
    }
}
