//! Puts cameras that waver about a place on it.
//!
//! Programs that calibrate frame by frame write the place of one tripod a little otherwise in every
//! frame. A camera of the document for each of them would be thousands that no one can track or
//! refine together. So places within [`WAVER_M`] become their mean, and each camera is turned to
//! show the same point in the middle as before: what is left is a parallax of hundredths of a
//! pixel, which the import states.

use super::frame_camera::Pinhole;
use super::into_document::{SAME_PLACE_M, View, group_by_position};
use touchline_core::geometry::Vec3;

/// Two places of one camera's frames that differ by at most this along each axis are one, m. No
/// two cameras stand as near to each other, and no survey tells such places apart.
const WAVER_M: f64 = 5e-3;

/// Puts views that waver about a place on it. Views on one exact place stay as they are.
pub fn put_on_one_place(views: &mut [View]) {
    for group in group_by_position(views, WAVER_M) {
        let first = views[group[0]].2.position_m;
        // Frames of one video keep their own places, whatever these are.
        if views[group[0]].0.common_base.is_some() {
            continue;
        }
        // What rounding alone leaves is no wavering, and such cameras keep their last digits.
        let is_exact = |&index: &usize| (views[index].2.position_m - first).amax() <= SAME_PLACE_M;
        if group.iter().all(is_exact) {
            continue;
        }
        let offsets = group.iter().map(|&index| views[index].2.position_m - first);
        let place_m = first + offsets.sum::<Vec3>() / group.len() as f64;
        for index in group {
            let view = &mut views[index].2;
            *view = Pinhole {
                focal_px: view.focal_px,
                ..view.move_to(place_m)
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::FieldSpec;
    use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole};
    use crate::exchange::cameras::into_document::{Exactness, document_of};
    use touchline_core::testing::{SIZE, TestBase, base_at};

    /// Views of a camera that pans, at these places beside each other, m.
    fn views(offsets_m: &[f64]) -> Vec<View> {
        let aim = |(index, offset_m): (usize, &f64)| {
            let base = base_at([*offset_m, -60.0, 18.0 + offset_m], SIZE);
            let camera = base.aim(index as f64 - 3.0, -12.0, 3000.0);
            let view = Pinhole::from_ptz_camera(&camera);
            let name = format!("{index}.jpg");
            let read = FrameCamera::new(&name, Some(SIZE), FrameProjection::Camera(view));
            (read, SIZE, view)
        };
        offsets_m.iter().enumerate().map(aim).collect()
    }

    #[test]
    fn a_place_that_wavers_is_one_camera_and_hardly_moves_the_picture() {
        let read = views(&[0.0, 1e-3, -1e-3, 7e-4, -4e-4, 2e-4]);
        let mut settled = read.clone();
        put_on_one_place(&mut settled);
        let document = document_of(FieldSpec::new("soccer"), &settled, Exactness::default());
        assert_eq!(document.cameras.len(), 1);
        for (frame, (_, _, view)) in document.frames.iter().zip(&read) {
            let (made, given) = (
                document.ptz_camera(frame).unwrap(),
                view.ptz_camera().unwrap(),
            );
            for pixel in SIZE.cell_centres(5, 5) {
                let Some(point) = given.plane_from_image(pixel, 0.0) else {
                    continue;
                };
                let off_px = made.image_from_world(point).unwrap().distance_px(pixel);
                assert!(off_px < 0.1, "{off_px} px");
            }
        }
    }

    #[test]
    fn exact_places_and_other_cameras_stay() {
        for offsets_m in [&[0.0, 0.0, 0.0][..], &[0.0, 0.3, -0.3]] {
            let read = views(offsets_m);
            let mut settled = read.clone();
            put_on_one_place(&mut settled);
            assert_eq!(settled, read);
        }
    }
}
