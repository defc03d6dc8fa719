//! The clicks that would help a search without an answer: in which frame, how many, and on what.
//!
//! Two landmarks of the ground determine the poses in place of the search, or confirm what the
//! search finds. If two did not suffice, four in one frame determine the base without the paint; a
//! frame that has four already is not named again.
//! The frame is the one whose paint fills the largest part of its picture, because it most likely
//! shows landmarks far apart; where there is a best answer, of the frames that do not agree with
//! it, because a click there says most. With that answer two landmarks can be named as well.

use crate::autocalibrate::WantedClicks;
use crate::autocalibrate::frames::matched_frames::{FramePaint, MatchedFrames, PaintPoint};
use crate::autocalibrate::search::clicked::GroundClick;
use crate::calibrate::{AutocalibratedCamera, AutocalibratedFrame};
use std::collections::BTreeSet;
use touchline_core::camera::PtzCamera;
use touchline_core::field::{Landmark, LandmarkId};
use touchline_core::geometry::{ImageSize, Vec3};
use touchline_core::markings::project_landmarks;

/// The clicks to begin with, and those that always suffice.
const FIRST_CLICKS: usize = 2;
const SUFFICIENT: usize = 4;

/// The picture is divided into this many columns and rows.
const CELLS: [f64; 2] = [16.0, 9.0];

/// Landmarks nearer to the border than this share of the width are not named: the best answer may
/// be some px off.
const BORDER: f64 = 0.03;

/// The clicks that would help, after those that there are did not, with frames numbered as in the
/// group; `best` is the best answer that the search had. None if no frame shows paint, or all that
/// do have clicks enough.
pub fn wanted_clicks(
    matched: &MatchedFrames,
    clicks: &[GroundClick],
    best: Option<&AutocalibratedCamera>,
) -> Option<WantedClicks> {
    let (frames, _) = matched.at_scale(100).ok()?;
    let paint = frames.paint.iter().enumerate();
    let clicks_on = |number: usize| clicks.iter().filter(|click| click.frame == number).count();
    let (number, (_, filled)) = paint
        .filter(|(number, _)| clicks_on(*number) < SUFFICIENT)
        .map(|(number, paint)| {
            let filled = cells_filled(paint, matched.image_size);
            let agrees = best.is_some_and(|best| agrees(best, matched.indices[number]));
            (number, (filled > 0 && !agrees, filled))
        })
        .rev()
        .max_by_key(|(_, rank)| *rank)?;
    let landmarks = if clicks.len() < FIRST_CLICKS {
        FIRST_CLICKS
    } else {
        SUFFICIENT
    };
    let frame = matched.indices[number];
    let named = best
        .filter(|_| landmarks == FIRST_CLICKS)
        .and_then(|best| farthest_landmarks(best, frame, matched.image_size))
        .map(Vec::from);
    (filled > 0).then(|| WantedClicks {
        frame,
        landmarks,
        named: named.unwrap_or_default(),
    })
}

/// Whether a frame of the document agrees with a camera.
fn agrees(camera: &AutocalibratedCamera, index: usize) -> bool {
    let mut aligned = camera.frames.iter().filter(|frame| frame.snapped.is_some());
    aligned.any(|frame| frame.index == index)
}

/// The two landmarks of the ground farthest apart of those that a camera shows in a frame, given by
/// its index in the document; none if the camera has no such frame, or shows fewer.
fn farthest_landmarks(
    camera: &AutocalibratedCamera,
    index: usize,
    size: ImageSize,
) -> Option<[LandmarkId; 2]> {
    let frame = camera.frames.iter().find(|frame| frame.index == index)?;
    let looking = PtzCamera::new(camera.base, AutocalibratedFrame::best_ptz(frame));
    let border_px = BORDER * f64::from(size.width);
    let shown = project_landmarks(&camera.field, &looking, size, -border_px);
    let on_ground: Vec<&Landmark> = shown
        .iter()
        .map(|shown| &camera.field.landmarks[shown.landmark])
        .filter(|landmark| landmark.is_on_ground())
        .collect();
    let mut farthest: Option<(f64, [&Landmark; 2])> = None;
    for (number, one) in on_ground.iter().enumerate() {
        for other in &on_ground[number + 1..] {
            let apart_m = Vec3::norm(&(other.nominal_m - one.nominal_m));
            if farthest.is_none_or(|(most_m, _)| apart_m > most_m) {
                farthest = Some((apart_m, [one, other]));
            }
        }
    }
    farthest.map(|(_, pair)| pair.map(|landmark| landmark.id.clone()))
}

/// The number of cells of the picture in which paint lies.
fn cells_filled(paint: &FramePaint, size: ImageSize) -> usize {
    let [columns, rows] = CELLS;
    let cells = paint.iter().map(|PaintPoint { at, .. }| {
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
    use super::*;
    use crate::autocalibrate::rotating_camera::{
        hypothesis, matched_views, matched_views_with_pixels, soccer,
    };
    use touchline_core::geometry::ImagePoint;

    /// Clicks on a frame of the group.
    fn clicks_on(frame: usize, num_clicks: usize) -> Vec<GroundClick> {
        let click = GroundClick {
            frame,
            landmark: LandmarkId::from("centre_mark"),
            image: ImagePoint::new(0.0, 0.0),
        };
        vec![click; num_clicks]
    }

    #[test]
    fn two_clicks_are_wanted_first_and_four_after_them() {
        let views = [0, 1, 2, 3, 4, 5, 6];
        let matched = matched_views_with_pixels(&soccer().assumed, &views);
        let first = wanted_clicks(&matched, &[], None).unwrap();
        assert_eq!(first.landmarks, 2);
        assert!(matched.indices.contains(&first.frame));
        let number = matched.number_of(first.frame).unwrap();
        let next = wanted_clicks(&matched, &clicks_on(number, 2), None).unwrap();
        assert_eq!((next.frame, next.landmarks), (first.frame, 4));
        let other = wanted_clicks(&matched, &clicks_on(number, 4), None).unwrap();
        assert_ne!(
            other.frame, first.frame,
            "what was given is not asked for again"
        );
    }

    #[test]
    fn a_best_answer_names_two_landmarks_far_apart() {
        let (views, soccer) = ([0, 1, 2, 3, 4, 5, 6], soccer());
        let matched = matched_views_with_pixels(&soccer.assumed, &views);
        let best = hypothesis(&soccer.assumed).camera;
        let wanted = wanted_clicks(&matched, &[], Some(&best)).unwrap();
        let [one, other] = wanted.named.as_slice() else {
            panic!("{wanted:?}");
        };
        let [one, other] = [one, other].map(|id| best.field.landmark(id.as_str()).unwrap());
        assert!(
            (one.nominal_m - other.nominal_m).norm() > 20.0,
            "{wanted:?}"
        );
        let frame = best.frames.iter().find(|frame| frame.index == wanted.frame);
        let looking = PtzCamera::new(best.base, frame.unwrap().ptz);
        for landmark in [one, other] {
            let at = looking.image_from_world(best.field.landmark_in_world(landmark));
            assert!(matched.image_size.contains(at.unwrap()), "{wanted:?}");
        }
        // Four clicks determine a camera without that answer.
        assert!(
            wanted_clicks(&matched, &clicks_on(0, 2), Some(&best))
                .unwrap()
                .named
                .is_empty()
        );
    }

    #[test]
    fn where_no_frame_shows_paint_no_click_is_wanted() {
        assert_eq!(wanted_clicks(&matched_views(), &[], None), None);
    }

    #[test]
    fn paint_all_over_the_picture_fills_more_than_a_long_line() {
        let size = ImageSize::new(1600, 900);
        let line = (0..160).map(|step| ImagePoint::new(10.0 * f64::from(step), 450.0).into());
        let box_corner = (0..9).flat_map(|step| {
            let step = f64::from(step);
            [
                ImagePoint::new(50.0 + 100.0 * step, 50.0 + 100.0 * step).into(),
                ImagePoint::new(1550.0 - 100.0 * step, 50.0 + 100.0 * step).into(),
            ]
        });
        assert_eq!(cells_filled(&line.collect(), size), 16);
        assert_eq!(cells_filled(&box_corner.collect(), size), 18);
        assert_eq!(cells_filled(&Vec::new(), size), 0);
    }
}
