//! Files written and read back, and damaged files.

use super::Fifa;
use super::arrays::arrays_of;
use crate::document::{Document, FrameStatus};
use crate::exchange::cameras::camera_format::CameraFormat;
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, KnownLens, Pinhole};
use crate::exchange::export;
use crate::exchange::files::Files;
use crate::exchange::import;
use crate::exchange::options::{ImportOptions, Rotations};
use crate::exchange::syntax::npy::Array;
use crate::exchange::syntax::npz::{Npz, archive_to_bytes};
use crate::exchange::tests::{awkward, export_as, reference};
use crate::exchange::{ExportOptions, Exported, Format};
use std::collections::BTreeMap;
use std::path::Path;
use touchline_core::camera::Radial;
use touchline_core::geometry::{ImagePoint, Vec3};

/// The arrays of an export.
fn arrays(exported: &Exported) -> BTreeMap<String, Array> {
    let bytes = exported.files.get("cameras.npz").unwrap();
    let archive = Npz::open(bytes).unwrap();
    archive
        .names()
        .map(|name| (name.to_owned(), archive.array(name).unwrap()))
        .collect()
}

/// The document of an archive's bytes.
fn import_bytes(name: &str, bytes: &[u8]) -> Document {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    import(&path, Format::Fifa, &ImportOptions::default())
        .unwrap()
        .document
}

#[test]
fn the_reference_camera_has_the_published_numbers() {
    let exported = export_as(&reference(), Format::Fifa);
    let arrays = arrays(&exported);
    assert_eq!(arrays["K"].shape, [1, 3, 3]);
    assert_eq!(
        arrays["K"].values,
        [2410.0, 0.0, 959.5, 0.0, 2410.0, 539.5, 0.0, 0.0, 1.0]
    );
    assert_eq!(
        (&arrays["k"].shape[..], arrays["k"].values[0]),
        (&[1, 5][..], 0.0661)
    );
    for (found, wanted) in
        arrays["t"]
            .values
            .iter()
            .zip([-12.986376836286173, 6.279379503790085, 60.95837440182727])
    {
        assert!((found - wanted).abs() < 1e-12, "{arrays:?}");
    }
    assert!(
        exported.notes[0].starts_with("rows carry no frame numbers: row 0 is frame 412"),
        "{:?}",
        exported.notes
    );
}

#[test]
fn awkward_cameras_come_back_with_a_lens_a_frame() {
    let exported = export_as(&awkward(), Format::Fifa);
    assert!(
        exported.loss.is_none() && exported.worst_px < 1e-6,
        "{exported:?}"
    );
    let document = import_bytes("ARG_CRO.npz", exported.files.get("cameras.npz").unwrap());
    assert_eq!((document.cameras.len(), document.frames.len()), (1, 12));
    let video = document.frames[3].video.as_ref().unwrap();
    assert_eq!((video.path.as_str(), video.frame_index), ("ARG_CRO.mp4", 3));
    for (frame, before) in document.frames.iter().zip(&awkward().frames) {
        let (lens, camera) = (
            frame.lens.as_ref().unwrap(),
            awkward().ptz_camera(before).unwrap(),
        );
        assert_eq!(
            (lens.focal_px, lens.radial()),
            (camera.ptz().focal_px, camera.lens())
        );
        assert_eq!(frame.ptz.as_ref().unwrap().lens(), Some(lens.radial()));
    }
}

#[test]
fn frames_without_a_rotation_keep_their_lens_and_have_no_pan_and_tilt() {
    let options = ExportOptions {
        rotations: Rotations::First,
        ..ExportOptions::default()
    };
    let exported = export(awkward().at(Path::new("/")), Format::Fifa, &options).unwrap();
    assert_eq!(
        (
            arrays(&exported)["K"].shape[0],
            &arrays(&exported)["t"].shape[..]
        ),
        (12, &[1, 3][..])
    );
    let document = import_bytes("a.npz", exported.files.get("cameras.npz").unwrap());
    let solved: Vec<bool> = document
        .frames
        .iter()
        .map(|frame| frame.ptz.is_some())
        .collect();
    assert_eq!(solved, [vec![true], vec![false; 11]].concat());
    assert_eq!(document.cameras.len(), 1);
    let truth = awkward();
    for (frame, before) in document.frames.iter().zip(&truth.frames).skip(1) {
        assert_eq!(
            (frame.status, frame.camera.as_str()),
            (FrameStatus::New, "main")
        );
        let (base, camera) = (
            document.cameras[0].base_for(frame).unwrap(),
            truth.ptz_camera(before).unwrap(),
        );
        let focal_px = camera.ptz().focal_px;
        assert_eq!(frame.lens.as_ref().unwrap().focal_px, focal_px);
        assert_eq!(
            (base.distortion.radial_at(focal_px).k1, base.principal_point),
            (camera.lens().k1, camera.base().principal_point)
        );
    }
}

#[test]
fn a_file_without_any_rotation_gives_a_camera_without_a_base() {
    let mut arrays = arrays_of(&[FrameCamera::new("a", None, FrameProjection::Lens(lens()))]);
    arrays.truncate(2);
    let document = import_bytes("a.npz", &archive_to_bytes(&arrays));
    assert!(document.cameras.len() == 1 && document.cameras[0].base().is_none());
    assert_eq!(document.frames[0].lens.as_ref().unwrap().focal_px, 3000.0);
}

fn lens() -> KnownLens {
    KnownLens {
        focal_px: 3000.0,
        principal_point: ImagePoint::new(960.0, 540.0),
        radial: Radial {
            k1: 0.2,
            k2: 1.5,
            ..Radial::default()
        },
    }
}

/// A frame's arrays.
fn good() -> BTreeMap<&'static str, Array> {
    let camera = Pinhole {
        position_m: Vec3::new(0.0, -70.0, 15.0),
        ..lens().camera_at_origin()
    };
    arrays_of(&[FrameCamera::new("a", None, FrameProjection::Camera(camera))])
        .into_iter()
        .collect()
}

#[test]
fn damaged_arrays_are_named_in_one_line() {
    let with_value = |name: &'static str, at: usize, value: f64| {
        let mut arrays = good();
        arrays.get_mut(name).unwrap().values[at] = value;
        arrays
    };
    let with_shape = |name: &'static str, shape: &[usize]| {
        let mut arrays = good();
        let values = vec![1.0; shape.iter().product()];
        arrays.insert(
            name,
            Array {
                shape: shape.to_vec(),
                values,
            },
        );
        arrays
    };
    let without = |name: &str| {
        let mut arrays = good();
        arrays.remove(name);
        arrays
    };
    for (arrays, wanted) in [
        (without("K"), "the array K is missing"),
        (without("k"), "the array k is missing"),
        (without("R"), "the array R is missing"),
        (without("t"), "the array t is missing"),
        (
            with_shape("K", &[3, 3]),
            "the shape of K: (frames, 3, 3), at most 900 000 frames, is expected, found (3, 3)",
        ),
        (
            with_shape("K", &[0, 3, 3]),
            "the shape of K: (frames, 3, 3), at most 900 000 frames, is expected, found (0, 3, 3)",
        ),
        (
            with_shape("k", &[2, 5]),
            "the shape of k: (frames, 2 or 5), as many frames as K has, is expected, found (2, 5)",
        ),
        (
            with_shape("R", &[2, 3, 3]),
            "the shape of R: (1, 3, 3) or (frames, 3, 3) is expected, found (2, 3, 3)",
        ),
        (
            with_shape("t", &[3]),
            "the shape of t: (1, 3) or (frames, 3), as R has, is expected, found (3)",
        ),
        (
            with_value("K", 0, f64::NAN),
            "frame 0: a number of K or k is not a finite number",
        ),
        (
            with_value("K", 4, 300.0),
            "frame 0: fy / fx of the focal lengths 3000 and 300 px is 0.1, which must be 0.25 to 4",
        ),
        (
            with_value("k", 2, 0.01),
            "frame 0: a distortion coefficient of 0.01 beyond k1 and k2 cannot be read: the document's lens has k1 and k2 only",
        ),
        (
            with_value("k", 0, 0.0),
            "frame 0: k2 = 1.5 without k1 of the camera cannot be read: in the lens model k2 depends on k1",
        ),
        (
            with_value("R", 0, f64::NAN),
            "frame 0: a number of the camera is not a finite number",
        ),
        (
            with_value("R", 0, 0.5),
            "frame 0: the rotation of the camera is not a rotation: its rows are off by 7.5e-1",
        ),
        (
            with_value("t", 2, f64::INFINITY),
            "frame 0: a number of the camera is not a finite number",
        ),
    ] {
        let arrays: Vec<(&str, Array)> = arrays.into_iter().collect();
        let files = Files::one("a.npz", archive_to_bytes(&arrays));
        let error = Fifa
            .read(&files, &ImportOptions::default())
            .unwrap_err()
            .to_string();
        assert_eq!(error, format!("a.npz: {wanted}"));
    }
}

#[test]
fn arrays_that_are_not_read_are_named() {
    let mut arrays: Vec<(&str, Array)> = good().into_iter().collect();
    arrays.push((
        "Rt",
        Array {
            shape: vec![1],
            values: vec![0.0],
        },
    ));
    assert_eq!(
        Fifa.unread(&Files::one("a.npz", archive_to_bytes(&arrays))),
        ["not read: Rt"]
    );
}
