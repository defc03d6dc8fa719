//! Cameras through every format and back: the reference camera, awkward cameras, damaged files.

use super::{ExportOptions, Exported, Files, Format};
use crate::document::{
    Camera, Click, Document, FieldSpec, Frame, FramePtz, FrameStatus, VideoFrame,
};
use crate::exchange::export;
use std::path::Path;
use touchline_core::camera::{BaseAngles, CameraBase, FocalCurve, Ptz};
use touchline_core::geometry::{Angle, ImagePoint, ImageSize, Vec3};

pub const SIZE: ImageSize = ImageSize::new(1920, 1080);

/// The camera of the published example: 25 frames a second, video frame 412.
pub fn reference() -> Document {
    let base = CameraBase {
        distortion: FocalCurve::constant(0.0661),
        ..CameraBase::new(
            Vec3::new(0.0, -60.0, 18.0),
            BaseAngles::default().base_from_world(),
            SIZE.centre(),
        )
    };
    document(&base, &[(12.5, -11.2, 2410.0)])
}

/// The same camera without distortion.
pub fn pinhole_reference() -> Document {
    let mut document = reference();
    document.cameras[0].distortion = None;
    document
}

/// A document with one camera and frames pointed so.
pub fn document(base: &CameraBase, ptz: &[(f64, f64, f64)]) -> Document {
    let mut document = Document::new(FieldSpec::new("soccer"));
    let mut camera = Camera::new("main".into(), SIZE);
    camera.set_base(base);
    document.cameras.push(camera.into());
    for (index, (pan, tilt, focal)) in ptz.iter().enumerate() {
        let mut frame =
            Frame::from_image(&format!("images/{:04}.jpg", index + 1), "main".into(), SIZE);
        let number = 412 + index as u64;
        frame.video = Some(VideoFrame::new(
            "match.mp4",
            number,
            Some(number as f64 / 25.0),
        ));
        frame.status = FrameStatus::Reference;
        frame.ptz = Some(FramePtz::new(Ptz::from_degrees(*pan, *tilt, *focal), None));
        document.frames.push(frame.into());
    }
    document
}

/// Twelve frames of a leaning, off-centre, distorting camera that zooms, on a field of 100 × 64 m.
pub fn awkward() -> Document {
    let angles = BaseAngles {
        heading: Angle::from_degrees(3.0),
        pitch: Angle::from_degrees(-0.7),
        roll: Angle::from_degrees(1.3),
    };
    let curve = FocalCurve {
        at_focal_px: 2000.0,
        value: -0.12,
        per_1000_px: 0.04,
        k2_per_k1_squared: 2.0,
        ..FocalCurve::NONE
    };
    let base = CameraBase {
        distortion: curve,
        ..CameraBase::new(
            Vec3::new(-7.25, -58.5, 16.125),
            angles.base_from_world(),
            ImagePoint::new(951.5, 548.25),
        )
    };
    let ptz: Vec<(f64, f64, f64)> = (0..12)
        .map(f64::from)
        .map(|step| (-44.0 + 7.5 * step, -9.0 - 0.4 * step, 1500.0 + 210.0 * step))
        .collect();
    let mut document = document(&base, &ptz);
    document
        .field
        .params
        .extend([("length_m".to_owned(), 100.0), ("width_m".to_owned(), 64.0)]);
    document
}

/// A document as a format, with the defaults.
pub fn export_as(document: &Document, format: Format) -> Exported {
    export(
        document.at(Path::new("/")),
        format,
        &ExportOptions::default(),
    )
    .unwrap()
}

/// The text of a file of an export.
pub fn text_of(files: &Files, name: &str) -> String {
    String::from_utf8(
        files
            .get(name)
            .unwrap_or_else(|| panic!("{name} is not in {files:?}"))
            .to_vec(),
    )
    .unwrap()
}

/// The reference camera with two landmarks (the second a check) and a point on a line clicked.
pub fn with_clicks() -> Document {
    let mut document = reference();
    let landmark = |name: &str, x, y| Click::landmark(name.into(), ImagePoint::new(x, y));
    document.frames[0].clicks = vec![
        landmark("centre_mark", 444.681, 789.175),
        Click {
            check: true,
            ..landmark("halfway_far", 434.064, 535.656)
        },
        landmark("penalty_area_far_right_front", 1449.22, 565.92),
        Click::line("halfway_line".into(), ImagePoint::new(440.63, 690.25)),
    ];
    document
}
