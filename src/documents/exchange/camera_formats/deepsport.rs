//! `DeepSport`'s basketball cameras: a JSON file for each picture, or the list of its challenge.
//! Import only.
//!
//! World in *centimetres* from the far left corner of the court, x right, y towards the camera, z
//! **down**; `KK`, `R`, `T` by rows, world→camera; `kc` = k1 k2 p1 p2 k3; pixels from the first
//! one's centre. Source: `deepsport-utilities`, `calib3d`.

use super::soccernet::flip_rotation;
use crate::exchange::cameras::calibration_matrix::Calibration;
use crate::exchange::cameras::camera_format::CameraFormat;
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use crate::exchange::cameras::into_document::Exactness;
use crate::exchange::cameras::unreadable::{FrameCollector, read_frame_files};
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, without_ending};
use crate::exchange::format::About;
use crate::exchange::format_options;
use crate::exchange::options::{ImportOptions, Pixels};
use crate::exchange::syntax::node::{Node, parse};
use crate::exchange::syntax::values::{refuse_further_coefficients, side_px};
use std::path::Path;
use touchline_core::camera::Radial;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, Mat3, Vec3};

/// The format.
pub struct DeepSport;

/// Centimetres per metre.
const CM: f64 = 100.0;

/// The frame of a camera, for a picture of this size. `k` is the matrix, in whose keys the layouts
/// differ.
fn frame(
    name: &str,
    node: &Node<'_>,
    (k, size): (&Node<'_>, ImageSize),
    court: &FieldModel,
) -> Result<FrameCamera, Problem> {
    let rotation = Mat3::from_row_slice(&node.key("R")?.numbers::<9>()?);
    let translation = Vec3::from(node.key("T")?.numbers::<3>()?);
    let lens: [f64; 5] = node.key("kc")?.numbers()?;
    refuse_further_coefficients(&lens[2..])?;
    let taken = Calibration::from_rows(&k.numbers()?, Pixels::Centre)?.without_skew(size)?;
    // C = −Rᵀ T, cm to m; then from the far left corner with y towards the camera and z down to our
    // world.
    let centre = -(rotation.transpose() * translation) / CM;
    let pinhole = Pinhole {
        cam_from_world: flip_rotation(&rotation),
        position_m: Vec3::new(
            centre.x - court.length_m / 2.0,
            court.width_m / 2.0 - centre.y,
            -centre.z,
        ),
        focal_px: taken.focal_px,
        principal_point: taken.principal_point,
        lens: Radial {
            k1: lens[0],
            k2: lens[1],
            pixel_aspect: taken.pixel_aspect,
        },
    };
    let shown = FrameProjection::Camera(pinhole.validate("the camera")?);
    Ok(FrameCamera {
        off_px: taken.off_px,
        ..FrameCamera::new(name, Some(size), shown)
    })
}

/// The frame of a file with one camera.
fn read_file(stem: &str, bytes: &[u8], court: &FieldModel) -> Result<FrameCamera, Problem> {
    let value = parse(bytes)?;
    let node = Node::root(&value).key("calibration")?;
    let size = node.size_at("img_width", "img_height")?;
    Ok(FrameCamera {
        // The pictures of a camera file have its name with an offset behind it; the one of the
        // stated time has 0.
        image: Some(format!("{stem}_0.png")),
        ..frame(stem, &node, (&node.key("KK")?, size), court)?
    })
}

/// The frames of the challenge's list: the size of all pictures first, and then a camera a picture;
/// none where the file has no list.
fn read_list(bytes: &[u8], court: &FieldModel) -> Result<Option<Vec<FrameCamera>>, Problem> {
    let value = parse(bytes)?;
    let root = Node::root(&value);
    let Ok(items) = root.items() else {
        return Ok(None);
    };
    let mut size_of_all = None;
    let mut frames = FrameCollector::default();
    for node in items {
        if node.find("K").is_none() && node.find("width").is_some() {
            size_of_all = Some(node.size_at("width", "height")?);
            continue;
        }
        let name = format!("{:06}", frames.len());
        // A camera may state a size of its own, as a list of one number.
        let size = size_of_all.map_or_else(|| size_in_lists(&node), Ok);
        let read = size.and_then(|size| frame(&name, &node, (&node.key("K")?, size), court));
        frames.add(&name, None, read);
        if frames.has_only_damaged() {
            break;
        }
    }
    frames.finish().map(Some)
}

/// The size that a camera of the challenge states.
fn size_in_lists(node: &Node<'_>) -> Result<ImageSize, Problem> {
    let [width]: [f64; 1] = node.key("width")?.numbers()?;
    let [height]: [f64; 1] = node.key("height")?.numbers()?;
    Ok(ImageSize::new(
        side_px("width", width)?,
        side_px("height", height)?,
    ))
}

impl CameraFormat for DeepSport {
    fn about(&self) -> About {
        About {
            name: "deepsport",
            title: "DeepSport basketball cameras",
            conventions: "far-left corner, z down, cm",
            users: "DeepSport, calib3d",
            loses: None,
            file: None,
            files: "camera files (.json)",
            endings: &["json"],
            export_options: &[],
            import_options: format_options::CAMERAS_IN,
        }
    }

    fn exactness(&self) -> Exactness {
        // Rotations are stored as 32-bit numbers, and a place is computed from each anew.
        Exactness {
            angle_rad: 1e-6,
            place_m: 5e-5,
        }
    }

    fn read(&self, files: &Files, options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        // The origin is a corner of the court, so that its size must be known to find the middle.
        // The import has put its folder before the name of a template of the user's own.
        let court = options.field.model(Path::new(""))?;
        if let [(file, bytes)] = files.sorted_entries()[..]
            && let Some(frames) =
                read_list(bytes, &court).map_err(|problem| problem.within(file))?
        {
            return Ok(frames);
        }
        read_frame_files(&files.sorted_entries(), without_ending, |stem, bytes| {
            read_file(stem, bytes, &court)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::FieldSpec;
    use crate::exchange::Format;
    use serde_json::{Value, json};
    use touchline_core::geometry::ImagePoint;

    fn published() -> Value {
        json!({ "calibration": {
            "img_width": 1920, "img_height": 1080,
            "KK": [2410, 0, 959.5, 0, 2410, 539.5, 0, 0, 1],
            "kc": [0.0661, 0, 0, 0, 0],
            "R": [0.97629600712, 0.216439613938, 0.0, -0.042040007992, 0.189630221542, 0.980955155349, 0.212317555114, -0.957702601331, 0.19423435122],
            "T": [-2827.781804, 544.571295, 6516.869814],
        } })
    }

    fn read(value: &Value) -> Result<FrameCamera, String> {
        let files = Files::one("camcourt1_7.json", value.to_string().into_bytes());
        let options = ImportOptions {
            field: FieldSpec::new("basketball_fiba"),
            ..ImportOptions::default()
        };
        DeepSport
            .read(&files, &options)
            .map(|mut frames| frames.remove(0))
            .map_err(|error| error.to_string())
    }

    #[test]
    fn the_published_camera_is_the_reference_camera() {
        let frame = read(&published()).unwrap();
        let pinhole = frame.pinhole().unwrap();
        // The rotation is published with 12 digits.
        assert!(
            (pinhole.position_m - Vec3::new(0.0, -60.0, 18.0)).norm() < 1e-6,
            "{pinhole:?}"
        );
        assert_eq!(pinhole.principal_point, ImagePoint::new(960.0, 540.0));
        let mark = frame.image_from_world(Vec3::zeros()).unwrap();
        assert!(
            mark.distance_px(ImagePoint::new(444.680987, 789.175247)) < 1e-4,
            "{mark:?}"
        );
    }

    #[test]
    fn a_court_of_the_users_own_is_found_beside_the_files() {
        let place = tempfile::tempdir().unwrap();
        let (_, template) = touchline_assets::FIELDS
            .iter()
            .find(|(name, _)| *name == "basketball_fiba")
            .unwrap();
        std::fs::write(place.path().join("mine.json"), template).unwrap();
        let file = place.path().join("camcourt1_7.json");
        std::fs::write(&file, published().to_string()).unwrap();
        let options = ImportOptions {
            field: FieldSpec::new("mine.json"),
            ..ImportOptions::default()
        };
        let imported = crate::exchange::import(&file, Format::DeepSport, &options).unwrap();
        let base = imported.document.cameras[0].base().unwrap();
        assert!(
            (base.position_m - Vec3::new(0.0, -60.0, 18.0)).norm() < 1e-6,
            "{base:?}"
        );
        assert_eq!(
            imported.document.field.template, "mine.json",
            "it lies in the document's folder"
        );
    }

    #[test]
    fn damaged_files_are_named_in_one_line() {
        for (key, value, wanted) in [
            (
                "KK",
                json!([1, 2, 3]),
                "calibration.KK (numbers): 9 are expected, found 3",
            ),
            (
                "R",
                json!([[1, 0, 0], [0, 1, 0], [0, 0, 1]]),
                "calibration.R (numbers): 9 are expected, found 3",
            ),
            (
                "R",
                json!([2, 0, 0, 0, 2, 0, 0, 0, 2]),
                "the rotation of the camera is not a rotation: its rows are off by 3.0e0",
            ),
            (
                "R",
                json!([1, 0, 0, 0, 1, 0, 0, 0, -1]),
                "the rotation of the camera is not a rotation: it is mirrored, or not made of numbers",
            ),
            (
                "kc",
                json!([0.1, 0, 0.01, 0, 0]),
                "a distortion coefficient of 0.01 beyond k1 and k2 cannot be read: the document's lens has k1 and k2 only",
            ),
            (
                "T",
                json!([1e9, 0, 0]),
                "a coordinate of the position of the camera is",
            ),
            (
                "img_width",
                json!("wide"),
                "calibration.img_width: a number is expected, found the text \"wide\"",
            ),
        ] {
            let mut damaged = published();
            damaged["calibration"][key] = value;
            let error = read(&damaged).unwrap_err();
            assert!(
                error.starts_with(&format!("camcourt1_7.json: {wanted}")),
                "{error}"
            );
        }
        assert_eq!(
            read(&json!({})).unwrap_err(),
            "camcourt1_7.json: calibration is missing"
        );
    }
}
