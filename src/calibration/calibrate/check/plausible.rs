//! Implausible cameras: under the ground, a kilometre away, turned away from the field, or with an
//! impossible lens. They come from imported files and typed numbers; each of their numbers is
//! finite, and the clicks need not disagree with them.

use super::fault::Fault;
use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_documents::document::{Camera, Document, Frame};

/// From farther away than this no field is recognisable, m from its centre.
const FARTHEST_M: f64 = 1000.0;
/// The shortest and the longest plausible focal length, in widths of the picture: angles of view of
/// 136° and 0.2°.
const FOCAL_WIDTHS: [f64; 2] = [0.2, 300.0];
/// The largest plausible displacement of a picture's corner by a lens, as a fraction of the
/// corner's distance from the middle.
const MAX_CORNER_SHIFT: f64 = 0.5;
/// Ground at most this far beside the field also counts as a view of it, m.
const BESIDE_M: f64 = 15.0;
/// Steps in each direction of the grid of pixels that are tested, both edges included.
const GRID: u32 = 12;

/// Checks the position of a camera.
pub fn check_place(camera: &Camera, problem: &mut dyn FnMut(Fault)) {
    let Some(base) = camera.base().filter(CameraBase::is_finite) else {
        return;
    };
    if base.position_m.z <= 0.0 {
        problem(Fault::UnderGround {
            z_m: base.position_m.z,
        });
    }
    let distance_m = base.position_m.norm();
    if distance_m >= FARTHEST_M {
        problem(Fault::FarAway { distance_m });
    }
}

/// Checks pan, tilt, focal length and lens of a solved frame.
pub fn check_view(
    document: &Document,
    frame: &Frame,
    field: Option<&FieldModel>,
    problem: &mut dyn FnMut(Fault),
) {
    let Some(pointed) = document
        .ptz_camera(frame)
        .filter(|pointed| pointed.ptz().is_finite())
    else {
        return;
    };
    // `check_values` reports a base that is not finite, and a lens that folds inside the picture.
    if !pointed.base().is_finite() || lens_folds(&pointed, frame.image_size) {
        return;
    }
    let (focal_px, width) = (pointed.ptz().focal_px, f64::from(frame.image_size.width));
    let [shortest, longest] = FOCAL_WIDTHS.map(|widths| widths * width);
    if !(shortest..=longest).contains(&focal_px) {
        problem(Fault::NoSuchFocalLength {
            focal_px,
            shortest,
            longest,
        });
        // What such a camera sees says nothing more.
        return;
    }
    // k₁ r² at the corner, r in units of the focal length: the relative displacement of the corner
    // by distortion.
    let corner = frame
        .image_size
        .centre()
        .distance_px(ImagePoint::new(0.0, 0.0))
        / focal_px;
    if (pointed.k1() * corner * corner).abs() > MAX_CORNER_SHIFT {
        problem(Fault::NoSuchLens { k1: pointed.k1() });
        return;
    }
    // `check_place` reports a camera that is not above the ground.
    if field.is_some_and(|field| {
        pointed.base().position_m.z > 0.0 && !sees_field(&pointed, frame.image_size, field)
    }) {
        problem(Fault::LooksElsewhere);
    }
}

/// Why a solved frame's camera cannot be one of a sports camera: its position, pan, tilt, focal
/// length or lens. None where nothing is wrong with it, or the frame has no camera.
pub fn impossible_camera(
    document: &Document,
    frame: &Frame,
    field: Option<&FieldModel>,
) -> Option<Fault> {
    let pointed = document.ptz_camera(frame)?;
    // The checks below suppose finite numbers, and would find nothing wrong with others.
    if !pointed.base().is_finite() {
        let what = "the base".to_owned();
        return Some(Fault::NotFinite { what });
    }
    if !pointed.ptz().is_finite() {
        let what = "ptz".to_owned();
        return Some(Fault::NotFinite { what });
    }
    let mut found = Vec::new();
    if let Some(camera) = document.camera_of(frame) {
        check_place(camera, &mut |fault| found.push(fault));
    }
    check_view(document, frame, field, &mut |fault| found.push(fault));
    if lens_folds(&pointed, frame.image_size) {
        found.push(Fault::LensFolds { k1: pointed.k1() });
    }
    found.into_iter().next()
}

/// Whether the lens model folds inside a picture: a part of it has no ray then.
pub(super) fn lens_folds(pointed: &PtzCamera, size: ImageSize) -> bool {
    let corners = size.corners();
    corners
        .iter()
        .any(|corner| pointed.cam_plane_from_image(*corner).is_err())
}

/// Whether any part of a picture shows the field or the ground right beside it. Pixels above the
/// horizon have no ground.
fn sees_field(pointed: &PtzCamera, size: ImageSize, field: &FieldModel) -> bool {
    let [half_x, half_y] = [field.length_m, field.width_m].map(|side| 0.5 * side + BESIDE_M);
    let at = |step: u32, side: u32| f64::from(step) / f64::from(GRID) * f64::from(side);
    let mut pixels = (0..=GRID).flat_map(|column| (0..=GRID).map(move |row| (column, row)));
    pixels.any(|(column, row)| {
        let ground = pointed.plane_from_image(
            ImagePoint::new(at(column, size.width), at(row, size.height)),
            0.0,
        );
        ground.is_some_and(|ground| ground.x.abs() <= half_x && ground.y.abs() <= half_y)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::check_values;
    use std::path::Path;
    use touchline_core::geometry::Vec3;
    use touchline_core::testing::{SIZE, TestBase, base_at, soccer};
    use touchline_documents::testing::match_from;
    use touchline_documents::testing::{new_frame, ptz_at};

    /// A document of one frame with this camera.
    fn document_of(
        position_m: Vec3,
        (pan_deg, tilt_deg, focal_px): (f64, f64, f64),
        k1: f64,
    ) -> Document {
        let mut document = match_from(&base_at(position_m, SIZE).bent(k1), SIZE);
        let mut frame = new_frame("1.jpg", SIZE);
        frame.ptz = ptz_at(pan_deg, tilt_deg, focal_px);
        document.frames.push(frame.into());
        document
    }

    /// What the check says of one frame.
    fn codes(position_m: Vec3, view: (f64, f64, f64), k1: f64) -> Vec<&'static str> {
        let document = document_of(position_m, view, k1);
        check_values(document.at(Path::new("/")))
            .iter()
            .map(|problem| problem.fault.code())
            .collect()
    }

    #[test]
    fn implausible_cameras_are_named() {
        let (there, view) = (Vec3::new(0.0, -60.0, 18.0), (12.5, -11.2, 2410.0));
        assert_eq!(codes(there, view, 0.07), [""; 0]);
        assert_eq!(
            codes(Vec3::new(0.0, -60.0, -18.0), view, 0.0),
            ["under_ground"]
        );
        assert_eq!(
            codes(Vec3::new(0.0, -1200.0, 18.0), view, 0.0),
            ["far_away", "looks_elsewhere"]
        );
        assert_eq!(
            codes(there, (180.0, -11.2, 2410.0), 0.0),
            ["looks_elsewhere"]
        );
        assert_eq!(codes(there, (0.0, 30.0, 2410.0), 0.0), ["looks_elsewhere"]);
        for focal_px in [1.0, 3_446_737.0, 1e12] {
            assert_eq!(
                codes(there, (0.0, -11.2, focal_px), 0.0),
                ["no_such_focal_length"],
                "{focal_px}"
            );
        }
        assert_eq!(codes(there, view, 50.0), ["no_such_lens"]);
        // A close-up of a corner, and a wide lens that bends.
        assert_eq!(codes(there, (40.0, -12.0, 30_000.0), 0.0), [""; 0]);
        assert_eq!(codes(there, (0.0, -14.0, 1400.0), -0.15), [""; 0]);
    }

    #[test]
    fn one_camera_is_impossible_for_its_first_reason() {
        let field = soccer();
        let (there, view) = (Vec3::new(0.0, -60.0, 18.0), (12.5, -11.2, 2410.0));
        let code = |position_m, view, k1| {
            let document = document_of(position_m, view, k1);
            let fault = impossible_camera(&document, &document.frames[0], Some(&field));
            fault.map(|fault| fault.code())
        };
        assert_eq!(code(there, view, 0.07), None);
        let below = Vec3::new(0.0, -60.0, -18.0);
        assert_eq!(code(below, view, 0.0), Some("under_ground"));
        let up = (0.0, 30.0, 2410.0);
        assert_eq!(code(there, up, 0.0), Some("looks_elsewhere"));
        let tiny = (0.0, -11.2, 1.0);
        assert_eq!(code(there, tiny, 0.0), Some("no_such_focal_length"));
        assert_eq!(code(there, tiny, -0.15), Some("lens_folds"));
        let unknown = Vec3::new(f64::NAN, -60.0, 18.0);
        assert_eq!(code(unknown, view, 0.0), Some("not_finite"));
        let nowhere = (0.0, f64::NAN, 2410.0);
        assert_eq!(code(there, nowhere, 0.0), Some("not_finite"));
        let mut unsolved = document_of(there, view, 0.0);
        unsolved.frames[0].ptz = None;
        assert_eq!(
            impossible_camera(&unsolved, &unsolved.frames[0], Some(&field)),
            None
        );
    }
}
