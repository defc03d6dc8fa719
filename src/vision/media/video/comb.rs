//! Interlaced frames: two fields, taken one after the other, in alternating rows. Where something
//! moves, they form a comb.

use super::VideoInfo;
use super::player::Player;
use crate::media::{Picture, grey_reduced};

/// Minimum step of a comb, grey levels.
const STEP: i32 = 12;
/// Minimum share of pixels in combs for a frame to be interlaced.
const LEAST_SHARE: f64 = 0.01;
/// Minimum ratio of combs between rows to zigzags within one field: fine detail produces both. In
/// two progressive matches there are three times more within a field, and at least half as many in
/// one where little moves.
const OVER_DETAIL: f64 = 1.2;
/// Heights of interlaced footage, px: 480i with and without its blanked lines, 576i, 1080i.
const INTERLACED_HEIGHTS: [u32; 4] = [480, 486, 576, 1080];

/// Whether a frame consists of two fields with motion between them. A frame without motion shows no
/// comb.
pub(super) fn is_combed(picture: &Picture) -> bool {
    let (width, height) = (
        picture.size().width as usize,
        picture.size().height as usize,
    );
    // Chroma of interlaced frames is subsampled by field; only the brightness shows the fields row
    // by row.
    let grey = grey_reduced(picture, 1);
    let (mut combed, mut detailed, mut count) = (0_u64, 0_u64, 0_u64);
    // Rows 1 apart are of different fields, rows 2 apart of the same one. Every third row covers
    // both fields.
    for y in (2..height.saturating_sub(2)).step_by(3) {
        for x in (0..width).step_by(2) {
            let [two_above, above, at, below, two_below] =
                [y - 2, y - 1, y, y + 1, y + 2].map(|y| i32::from(grey.pixel(x, y)));
            combed += u64::from(stands_out(above, at, below));
            detailed += u64::from(stands_out(two_above, at, two_below));
            count += 1;
        }
    }
    combed as f64 >= LEAST_SHARE * count as f64 && combed as f64 > OVER_DETAIL * detailed as f64
}

/// Whether a pixel is brighter, or darker, than both others.
fn stands_out(above: i32, at: i32, below: i32) -> bool {
    let (up, down) = (at - above, at - below);
    up.min(down) > STEP || up.max(down) < -STEP
}

/// Whether the frames may be interlaced: such footage has one of a few heights.
pub(super) fn may_be_interlaced(info: &VideoInfo) -> bool {
    INTERLACED_HEIGHTS.contains(&info.size.height) && info.rotation_deg.is_multiple_of(180)
}

/// Number of interlaced frames among six in the middle of the video: at its beginning and end often
/// nothing moves.
pub(super) fn count_combed_in_middle(player: &mut Player, info: &VideoInfo) -> usize {
    if !may_be_interlaced(info) {
        return 0;
    }
    // Reading on is cheap, so one seek serves several frames.
    let places = (info.decoded_frames / 2..info.decoded_frames)
        .step_by(4)
        .take(6);
    let pictures = places.filter_map(|index| {
        player.go_to(info, index).ok()?;
        player.capture.picture(index).ok()
    });
    pictures.filter(is_combed).count()
}

/// Interpolates a picture from the first field: its rows stay, each row between is the mean of its
/// neighbours.
pub(super) fn first_field(picture: &Picture) -> Picture {
    let (size, row) = (picture.size(), 4 * picture.size().width as usize);
    let mut rgba = picture.rgba().to_vec();
    for y in (1..size.height as usize).step_by(2) {
        let (above, from_here) = rgba.split_at_mut(y * row);
        let above = &above[above.len() - row..];
        let (here, below) = from_here.split_at_mut(row);
        // The last row has only one neighbour.
        let below = if below.is_empty() {
            above
        } else {
            &below[..row]
        };
        for ((value, above), below) in here.iter_mut().zip(above).zip(below) {
            *value = u8::midpoint(*above, *below);
        }
    }
    Picture::new(size, rgba).unwrap_or_else(|_| picture.clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;

    /// A bright bar that has moved to the right by some px in the second field.
    fn frame(moved: u32) -> Picture {
        let size = ImageSize::new(64, 40);
        let pixels = (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y)));
        let shade = |(x, y): (u32, u32)| {
            let left = 10 + if y % 2 == 1 { moved } else { 0 };
            if (left..left + 12).contains(&x) {
                200
            } else {
                60
            }
        };
        Picture::new(
            size,
            pixels
                .flat_map(|at| [shade(at), shade(at), shade(at), 255])
                .collect(),
        )
        .unwrap()
    }

    #[test]
    fn a_comb_is_where_something_moved_between_the_fields() {
        assert!(is_combed(&frame(4)));
        assert!(!is_combed(&frame(0)));
        assert!(!is_combed(&Picture::with_colour(
            ImageSize::new(64, 40),
            [9, 9, 9, 255]
        )));
        assert!(!is_combed(&Picture::with_colour(
            ImageSize::new(1, 1),
            [9, 9, 9, 255]
        )));
    }

    #[test]
    fn the_first_field_has_no_comb() {
        assert_eq!(first_field(&frame(4)), frame(0));
        assert_eq!(first_field(&frame(0)), frame(0));
    }
}
