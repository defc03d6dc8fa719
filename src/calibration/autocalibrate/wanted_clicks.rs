//! The clicks that would help a search without an answer: in which frame, and how many.
//!
//! Two landmarks of the ground determine the poses in place of the search. If two did not suffice,
//! four in one frame determine the base without the paint. Which landmarks a frame shows is what
//! the search does not know, so only the frame is named: the one whose paint fills the largest part
//! of its picture, because it most likely shows landmarks far apart.

use super::WantedClicks;
use super::matched_frames::{FramePaint, MatchedFrames};
use std::collections::BTreeSet;
use touchline_core::geometry::ImageSize;

/// The clicks to begin with, and those that always suffice.
const FEW: usize = 2;
const SUFFICIENT: usize = 4;

/// The picture is divided into this many columns and rows.
const CELLS: [f64; 2] = [16.0, 9.0];

/// The clicks that would help, after `clicked` landmarks did not. None if no frame shows paint.
pub(super) fn wanted_clicks(matched: &MatchedFrames, clicked: usize) -> Option<WantedClicks> {
    let (frames, _) = matched.at_scale(100).ok()?;
    let paint = frames.paint.iter().enumerate();
    let (number, filled) = paint
        .map(|(number, paint)| (number, cells_filled(paint, matched.image_size)))
        .rev()
        .max_by_key(|(_, filled)| *filled)?;
    (filled > 0).then(|| WantedClicks {
        frame: matched.indices[number],
        landmarks: if clicked < FEW { FEW } else { SUFFICIENT },
    })
}

/// The number of cells of the picture in which paint lies.
fn cells_filled(paint: &FramePaint, size: ImageSize) -> usize {
    let [columns, rows] = CELLS;
    let cells = paint.iter().map(|at| {
        (
            cell_of(at.x, size.width, columns),
            cell_of(at.y, size.height, rows),
        )
    });
    cells.collect::<BTreeSet<_>>().len()
}

/// The number of the column or row of a coordinate (px) in a picture of a size (px).
fn cell_of(at_px: f64, size_px: u32, num_cells: f64) -> u32 {
    (at_px * num_cells / f64::from(size_px)) as u32
}

#[cfg(test)]
mod tests {
    use super::super::rotating_camera::{matched_views, matched_views_with_pixels, soccer};
    use super::*;
    use touchline_core::geometry::ImagePoint;

    #[test]
    fn two_clicks_are_wanted_first_and_four_after_them() {
        let views = [0, 1, 2, 3, 4, 5, 6];
        let matched = matched_views_with_pixels(&soccer().assumed, &views);
        let first = wanted_clicks(&matched, 0).unwrap();
        assert_eq!(first.landmarks, 2);
        assert!(matched.indices.contains(&first.frame));
        let next = wanted_clicks(&matched, 2).unwrap();
        assert_eq!((next.frame, next.landmarks), (first.frame, 4));
    }

    #[test]
    fn where_no_frame_shows_paint_no_click_is_wanted() {
        assert_eq!(wanted_clicks(&matched_views(), 0), None);
    }

    #[test]
    fn paint_all_over_the_picture_fills_more_than_a_long_line() {
        let size = ImageSize::new(1600, 900);
        let line = (0..160).map(|step| ImagePoint::new(10.0 * f64::from(step), 450.0));
        let box_corner = (0..9).flat_map(|step| {
            let step = f64::from(step);
            [
                ImagePoint::new(50.0 + 100.0 * step, 50.0 + 100.0 * step),
                ImagePoint::new(1550.0 - 100.0 * step, 50.0 + 100.0 * step),
            ]
        });
        assert_eq!(cells_filled(&line.collect(), size), 16);
        assert_eq!(cells_filled(&box_corner.collect(), size), 18);
        assert_eq!(cells_filled(&Vec::new(), size), 0);
    }
}
