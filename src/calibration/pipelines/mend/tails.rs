//! Places that are no place of their own, but the tail of the scatter about a larger one.
//!
//! Cameras of single frames scatter about the place where they were filmed. Those that scatter most
//! do not fit it any more; they lie together on one side of it, or on the other, and would be taken
//! for a second camera. Seen along the way from the place to them, though, the frames grow fewer
//! and fewer, while a camera that really stands beside the place has frames of its own, and between
//! the two there is a valley at least.
//!
//! How far along that way a frame lies is measured in the picture: by how far its ground moves on
//! either place. Positions in metres would not do, because they scatter most along the view, where
//! nothing shows it. Places of several stadiums overlap without a valley, too; they lie outside of
//! each other's scatter, and stay.

use super::given::GivenCamera;
use crate::calibrate::ptz_on_base;
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::{ImageSize, median};
use touchline_core::solve::base::SharedPlace;
use touchline_documents::document::Document;

/// Half the width of the stretch in which the frames at a place are counted, as a multiple of their
/// median deviation: two thirds of normally distributed frames.
const HALF_OF_DEVIATION: f64 = 1.5;

/// The least half width of the stretch in which the frames of a place are counted, px at 1920 px
/// width: a few frames agree by chance.
const LEAST_HALF_PX: f64 = 5.0;

/// The first place (from the smallest on) that is the tail of one with more frames.
pub(super) fn find_tail(
    document: &Document,
    given: &[GivenCamera],
    places: &[SharedPlace],
) -> Option<usize> {
    let size = |place: &SharedPlace| Some(document.frames[*place.members.first()?].image_size);
    let is_of = |small: &SharedPlace, large: &SharedPlace| {
        let size = size(small).filter(|own| size(large) == Some(*own));
        large.members.len() > small.members.len()
            && large.contains(small.base.position_m)
            && size.is_some_and(|size| is_tail(given, small, large, size).unwrap_or(false))
    };
    (0..places.len())
        .rev()
        .find(|small| places.iter().any(|large| is_of(&places[*small], large)))
}

/// Whether there are at least as many frames before a small place, on the way to it from a large
/// one, as at it. None if no ground shows it.
fn is_tail(
    given: &[GivenCamera],
    small: &SharedPlace,
    large: &SharedPlace,
    size: ImageSize,
) -> Option<bool> {
    let usable = |index: &usize| given[*index].usable();
    // How far apart the places are in the pictures of the small one.
    let mut apart: Vec<f64> = small
        .members
        .iter()
        .filter_map(|index| {
            let there = PtzCamera::new(
                small.base,
                ptz_on_base(usable(index)?, &small.base, size)?.ptz,
            );
            Some(ptz_on_base(&there, &large.base, size)?.moved_px)
        })
        .collect();
    let apart_px = median(&mut apart).filter(|px| *px > 0.0)?;
    // By the cosine rule, from the three sides of a triangle: how far along its base the frame is.
    let along_px = |index: &usize| {
        let moved_px =
            |place: &SharedPlace| Some(ptz_on_base(usable(index)?, &place.base, size)?.moved_px);
        let (from_large, from_small) = (moved_px(large)?, moved_px(small)?);
        let squares = from_large.powi(2) - from_small.powi(2) + apart_px.powi(2);
        Some(squares / (2.0 * apart_px)).filter(|px| px.is_finite())
    };
    let mut of_small: Vec<f64> = small.members.iter().filter_map(along_px).collect();
    let of_large = large.members.iter().filter_map(along_px);
    let all: Vec<f64> = of_small.iter().copied().chain(of_large).collect();
    let middle = median(&mut of_small)?;
    let mut beside: Vec<f64> = of_small.iter().map(|px| (px - middle).abs()).collect();
    let half = (HALF_OF_DEVIATION * median(&mut beside)?).max(LEAST_HALF_PX);
    let count = |from: f64, upto: f64| all.iter().filter(|px| (from..upto).contains(*px)).count();
    let at_small = count(middle - half, middle + half);
    Some(count(middle - 3.0 * half, middle - half) >= at_small)
}

#[cfg(test)]
mod tests {
    use super::super::by_frame::FramePlaces;
    use super::*;
    use rand_pcg::Pcg64Mcg;
    use touchline_core::camera::Ptz;
    use touchline_core::geometry::Vec3;
    use touchline_core::testing::seeded::{self, normal};
    use touchline_core::testing::{SIZE, base_at};
    use touchline_documents::testing::{new_frame, soccer_document};

    const PLACE_M: Vec3 = Vec3::new(2.0, -60.0, 14.0);

    /// Frames of a camera that pans, each scattered along the view by `along_m` and by a tenth of
    /// it across, with the focal length that keeps the size of what it shows.
    fn scattered(
        place_m: Vec3,
        frames: usize,
        along_m: f64,
        rng: &mut Pcg64Mcg,
    ) -> Vec<GivenCamera> {
        (0..frames)
            .map(|frame| {
                let pan_deg = 20.0 * (frame as f64 / frames as f64 - 0.5);
                let ptz = Ptz::from_degrees(pan_deg, -13.0, 2400.0);
                let exact = PtzCamera::new(base_at(place_m, SIZE), ptz);
                let target = exact.plane_from_image(SIZE.centre(), 0.0).unwrap();
                let along = (place_m - target).normalize();
                let across = Vec3::from_fn(|_, _| 0.1 * along_m * normal(rng));
                let position_m = place_m + along * (along_m * normal(rng)) + across;
                let (from, to) = (position_m - target, place_m - target);
                let ptz = Ptz::from_degrees(
                    (-from.x).atan2(-from.y).to_degrees(),
                    (-from.z).atan2(from.x.hypot(from.y)).to_degrees(),
                    2400.0 * from.norm() / to.norm() * (1.0 + 0.01 * normal(rng)),
                );
                let camera = PtzCamera::new(base_at(position_m, SIZE), ptz);
                GivenCamera::Possible(Box::new(camera))
            })
            .collect()
    }

    fn numbers_of_members(given: &[GivenCamera]) -> Vec<usize> {
        let mut document = soccer_document();
        for number in 0..given.len() {
            let frame = new_frame(&format!("{number}.jpg"), SIZE);
            document.frames.push(frame.into());
        }
        let found = FramePlaces::from_given(&document, given);
        found
            .places
            .iter()
            .map(|place| place.members.len())
            .collect()
    }

    #[test]
    fn frames_that_scatter_far_along_the_view_have_one_place() {
        let mut rng = seeded::rng("frames_that_scatter_far_along_the_view_have_one_place");
        for _ in 0..6 {
            let given = scattered(PLACE_M, 300, 4.0, &mut rng);
            let members = numbers_of_members(&given);
            assert_eq!(members.len(), 1, "{members:?}");
        }
    }

    #[test]
    fn a_camera_beside_the_place_keeps_its_own() {
        let mut rng = seeded::rng("a_camera_beside_the_place_keeps_its_own");
        for (frames, beside_m) in [(60, 3.0), (20, 8.0), (10, 30.0)] {
            let mut given = scattered(PLACE_M, 270, 1.0, &mut rng);
            let place_m = PLACE_M + Vec3::new(-beside_m, 0.0, 0.0);
            given.extend(scattered(place_m, frames, 1.0, &mut rng));
            let members = numbers_of_members(&given);
            assert_eq!(
                members.len(),
                2,
                "{frames} frames {beside_m} m beside: {members:?}"
            );
        }
    }
}
