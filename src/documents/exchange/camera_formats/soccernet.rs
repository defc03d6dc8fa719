//! SoccerNet's cameras: a file `camera_{frame}.json` for each frame.
//!
//! Their world begins at the centre of the pitch, x right, y towards the main camera, z **down**;
//! rotation and angles: camera→world = Rz(pan) · Rx(tilt) · Rz(roll), tilt 0 looks straight down
//! (tilt = 90° + ours on a level base). Distortion is OpenCV's rational model. The files do not
//! state the picture size: readers take twice the principal point. Source:
//! SoccerNet/sn-calibration, `src/camera.py`.

use crate::exchange::cameras::calibration_matrix::Calibration;
use crate::exchange::cameras::camera_format::{
    CameraFormat, HeldFrame, WriteContext, has_ending, stem_of,
};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use crate::exchange::cameras::picture_size::SizeSource;
use crate::exchange::cameras::unreadable::{FrameCollector, read_frame_files};
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, stem, text};
use crate::exchange::format::About;
use crate::exchange::format_options;
use crate::exchange::options::{ImportOptions, Pixels};
use crate::exchange::syntax::node::{Node, parse};
use crate::exchange::syntax::samples::each_sample;
use crate::exchange::syntax::values::refuse_further_coefficients;
use serde_json::{Value, json};
use touchline_core::camera::Radial;
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec3, pluralise};

/// The prefix of the files' names, before the frame's name.
const PREFIX: &str = "camera_";
/// The pitch of all tools of the challenge, m.
pub const PITCH_M: [f64; 2] = [105.0, 68.0];

/// The conventions of the challenge and of the programs around it.
pub const SOCCERNET_WORLD: &str =
    "x right, y toward the main camera, z down, m; angles ZXZ in degrees, tilt 0 looks down";

/// Cameras as the challenge's files have them.
pub struct SoccerNet;

/// What `PnLCalib`, No Bells Just Whistles and `TVCalib` write: the same keys with others beside
/// them, which are ignored.
pub struct PnlCalib;

/// A point of our world in theirs; the same map leads back.
pub fn flip_point(point: Vec3) -> Vec3 {
    Vec3::new(point.x, -point.y, -point.z)
}

/// A rotation from the other world, theirs instead of ours or the reverse.
pub fn flip_rotation(cam_from_world: &Mat3) -> Mat3 {
    cam_from_world * Mat3::from_diagonal(&Vec3::new(1.0, -1.0, -1.0))
}

/// Pan, tilt and roll, degrees, of a rotation from *their* world. ZXZ angles are ambiguous: (pan +
/// 180°, −tilt, roll + 180°) is the same rotation. The triple with the smaller roll is returned.
pub fn angles_deg(cam_from_their_world: &Mat3) -> [f64; 3] {
    // o = Rz(pan) Rx(tilt) Rz(roll): its third column is (sin pan sin tilt, −cos pan sin tilt, cos
    // tilt), its third row (sin tilt sin roll, sin tilt cos roll, cos tilt).
    let o = cam_from_their_world.transpose();
    // |sin tilt|. The arctangents below keep the digits that an arccosine of o₂₂ loses near 0° and
    // 180°.
    let sine = o[(0, 2)].hypot(o[(1, 2)]);
    if sine < 1e-15 {
        // Straight down or up, only the sum of pan and roll (or their difference) is determined.
        let (pan, tilt) = (
            o[(1, 0)].atan2(o[(0, 0)]),
            if o[(2, 2)] > 0.0 { 0.0 } else { 180.0 },
        );
        return [pan.to_degrees(), tilt, 0.0];
    }
    // The sign chooses between the two triples: the one with a roll of at most 90°.
    let roll = o[(2, 0)].atan2(o[(2, 1)]);
    let sign = if roll.abs() <= std::f64::consts::FRAC_PI_2 {
        1.0
    } else {
        -1.0
    };
    let pan = (sign * o[(0, 2)]).atan2(-sign * o[(1, 2)]);
    let tilt = sign * sine.atan2(o[(2, 2)]);
    let roll = (sign * o[(2, 0)]).atan2(sign * o[(2, 1)]);
    [pan, tilt, roll].map(f64::to_degrees)
}

/// The rotation from their world of pan, tilt and roll, degrees.
pub fn rotation_of([pan, tilt, roll]: [f64; 3]) -> Mat3 {
    let (s, c) = tilt.to_radians().sin_cos();
    let about_x = Mat3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c);
    (rotation_about_z(pan) * about_x * rotation_about_z(roll)).transpose()
}

/// The rotation about the z axis, anticlockwise as seen from its tip.
fn rotation_about_z(angle_deg: f64) -> Mat3 {
    let (s, c) = angle_deg.to_radians().sin_cos();
    Mat3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}

/// A note for the user if the pitch is not that of the challenge.
pub fn pitch_note(context: &WriteContext<'_>) -> Option<String> {
    let field = context.field;
    let [length, width] = PITCH_M;
    let same = (field.length_m - length).abs() < 1e-9 && (field.width_m - width).abs() < 1e-9;
    (!same).then(|| {
        let [own_length, own_width] = [field.length_m, field.width_m].map(|metres| (metres * 100.0).round() / 100.0);
        format!(
            "the field is {own_length} × {own_width} m; the tools that read this assume {length} × {width} m and will score it badly"
        )
    })
}

fn to_json(pinhole: &Pinhole) -> Value {
    let [pan, tilt, roll] = angles_deg(&flip_rotation(&pinhole.cam_from_world));
    let position = flip_point(pinhole.position_m);
    json!({
        "pan_degrees": pan,
        "tilt_degrees": tilt,
        "roll_degrees": roll,
        "position_meters": [position.x, position.y, position.z],
        "x_focal_length": pinhole.focal_px,
        "y_focal_length": pinhole.focal_px * pinhole.lens.pixel_aspect,
        "principal_point": [pinhole.principal_point.x, pinhole.principal_point.y],
        "radial_distortion": [pinhole.lens.k1, pinhole.lens.k2, 0.0, 0.0, 0.0, 0.0],
        "tangential_distortion": [0.0, 0.0],
        "thin_prism_distortion": [0.0, 0.0, 0.0, 0.0],
    })
}

/// A camera of their ten keys, and how far it is from the file's own at most, px.
///
/// # Errors
/// A key is missing or invalid, or the lens has distortion that the document cannot represent.
pub(super) fn from_json(node: &Node<'_>) -> Result<(Pinhole, f64), Problem> {
    let [fx, fy] = [
        node.key("x_focal_length")?.positive()?,
        node.key("y_focal_length")?.positive()?,
    ];
    // k1 and k2, the third of the numerator and the three of the denominator of OpenCV's rational
    // model. All ten keys are required, as their loader requires them.
    let radial: [f64; 6] = node.key("radial_distortion")?.numbers()?;
    let others: Vec<f64> = [
        &radial[2..],
        &node.key("tangential_distortion")?.numbers::<2>()?,
        &node.key("thin_prism_distortion")?.numbers::<4>()?,
    ]
    .concat();
    refuse_further_coefficients(&others)?;
    let angles = node.angles_at(["pan_degrees", "tilt_degrees", "roll_degrees"])?;
    let [x, y]: [f64; 2] = node.key("principal_point")?.numbers()?;
    let calibration = Calibration {
        fx,
        fy,
        skew: 0.0,
        principal_point: ImagePoint::new(x, y),
    };
    // The files state no size; readers take twice the principal point.
    let size = ImageSize::new((2.0 * x) as u32, (2.0 * y) as u32);
    let taken = calibration.without_skew(size)?;
    let pinhole = Pinhole {
        cam_from_world: flip_rotation(&rotation_of(angles)),
        position_m: flip_point(Vec3::from(node.key("position_meters")?.numbers::<3>()?)),
        focal_px: taken.focal_px,
        principal_point: taken.principal_point,
        lens: Radial {
            k1: radial[0],
            k2: radial[1],
            pixel_aspect: taken.pixel_aspect,
        },
    };
    Ok((pinhole.validate("the camera")?, taken.off_px))
}

/// Usual aspect ratios (width / height) of pictures.
const USUAL_PROPORTIONS: [f64; 5] = [16.0 / 9.0, 4.0 / 3.0, 3.0 / 2.0, 256.0 / 135.0, 5.0 / 4.0];
/// Tolerance of the aspect ratio, because sides are whole numbers.
const SAME_PROPORTIONS: f64 = 0.005;

/// The picture size if the principal point is its middle; none where that gives no whole numbers or
/// an unusual aspect ratio, which means that the principal point is not in the middle.
pub fn size_by_principal_point(point: ImagePoint) -> Option<ImageSize> {
    // The usual readers take twice the principal point for the size. That is a guess, so that it
    // must give a picture as cameras have them.
    let (width, height) = (2.0 * point.x, 2.0 * point.y);
    let is_usual = USUAL_PROPORTIONS
        .iter()
        .any(|usual| (width / height / usual - 1.0).abs() < SAME_PROPORTIONS);
    (is_whole_side(width) && is_whole_side(height) && is_usual)
        .then(|| ImageSize::new(width.round() as u32, height.round() as u32))
}

/// What is said of cameras whose pixels are counted from the first one's centre.
const PIXEL_CENTRES: &str = "the principal point is the middle of a picture whose pixels are \
 counted from the first one's centre; \
     half a pixel is added";

/// The camera in our pixels and the size of its picture, where its principal point is the middle of
/// a picture whose pixels are counted from the first one's centre: (479.5, 269.5) is that of 960 ×
/// 540, and by itself would be that of 959 × 539.
fn from_pixel_centres(pinhole: &Pinhole) -> Option<(Pinhole, ImageSize)> {
    let at = pinhole.principal_point;
    let shift = Pixels::Centre.to_corner_px();
    let shifted = ImagePoint::new(at.x + shift, at.y + shift);
    // Both sides of a usual picture are even.
    let size = size_by_principal_point(shifted)?;
    let is_even = |side: u32| side.is_multiple_of(2);
    let pinhole = Pinhole {
        principal_point: shifted,
        ..*pinhole
    };
    (is_even(size.width) && is_even(size.height)).then_some((pinhole, size))
}

/// Whether a length is a whole number that a picture may have as its side.
fn is_whole_side(length_px: f64) -> bool {
    (length_px - length_px.round()).abs() < 1e-6 && ImageSize::is_side_px(length_px.round())
}

/// The frame of a camera file.
fn read_file(name: &str, bytes: &[u8]) -> Result<FrameCamera, Problem> {
    let value = parse(bytes)?;
    let node = Node::root(&value);
    // PnLCalib writes the camera under a key of its own.
    let node = node
        .find("cam_params")
        .or_else(|| node.find("parameters"))
        .unwrap_or(node);
    frame_from_json(name, &node)
}

/// The frame of a camera, whose principal point is the only thing that states its picture's size.
fn frame_from_json(name: &str, node: &Node<'_>) -> Result<FrameCamera, Problem> {
    let (pinhole, off_px) = from_json(node)?;
    let other_rotation = has_other_rotation(node, &pinhole).then_some(OTHER_ROTATION);
    if let Some((pinhole, size)) = from_pixel_centres(&pinhole) {
        return Ok(FrameCamera {
            off_px,
            remark: other_rotation.or(Some(PIXEL_CENTRES)),
            ..FrameCamera::new(name, Some(size), FrameProjection::Camera(pinhole))
        });
    }
    let size = size_by_principal_point(pinhole.principal_point);
    Ok(FrameCamera {
        off_px,
        remark: other_rotation,
        ..FrameCamera::new(name, size, FrameProjection::Camera(pinhole))
    })
}

/// What is said of cameras that state two rotations.
const OTHER_ROTATION: &str = "rotation_matrix is not the rotation of the angles beside it; \
 the angles are taken, as the challenge's own reader does";
/// Two statements of one rotation differ by less, degrees: angles are written with two decimals by
/// some programs.
const SAME_ROTATION_DEG: f64 = 0.05;

/// Whether a camera file states another rotation beside its angles.
fn has_other_rotation(node: &Node<'_>, pinhole: &Pinhole) -> bool {
    let rows = node.find("rotation_matrix").and_then(|matrix| {
        let rows = matrix.items().ok()?;
        let rows: Option<Vec<[f64; 3]>> = rows.map(|row| row.numbers().ok()).collect();
        <[[f64; 3]; 3]>::try_from(rows?).ok()
    });
    rows.is_some_and(|rows| {
        let stated = Mat3::from(rows).transpose();
        let of_angles = flip_rotation(&pinhole.cam_from_world);
        let cosine = ((stated.transpose() * of_angles).trace() - 1.0) / 2.0;
        cosine < SAME_ROTATION_DEG.to_radians().cos()
    })
}

fn read_files(files: &Files) -> ExchangeResult<Vec<FrameCamera>> {
    read_frame_files(&files.sorted_entries(), frame_name, read_file)
}

/// The frames of a file with a sample for each, in a list or one a line as `TVCalib` writes them;
/// none where the file is one frame, which has its name. A damaged sample is a frame without a
/// camera.
///
/// # Errors
/// All of them are damaged; the problem is that of the first.
fn read_samples(bytes: &[u8]) -> Result<Option<Vec<FrameCamera>>, Problem> {
    match parse(bytes) {
        Ok(value) if !value.is_array() && image_of_sample(&Node::root(&value)).is_none() => {
            return Ok(None);
        }
        // What does not begin with a sample a line is damaged as a whole.
        Err(problem) if !begins_with_sample(bytes) => return Err(problem),
        _ => {}
    }
    let mut frames = FrameCollector::default();
    let read = each_sample(bytes, |line, sample| {
        let mut name = format!("{:06}", frames.len());
        let frame = sample.and_then(|sample| {
            let sample = Node::root(&sample);
            if let Some(image) = image_of_sample(&sample) {
                stem(&image.image_name()?).clone_into(&mut name);
            }
            frame_from_json(&name, &sample)
        });
        let frame = frame.map_err(|problem| match line {
            Some(line) => problem.at_line(line),
            None => problem,
        });
        frames.add(&name, None, frame);
        if frames.has_only_damaged() {
            Err(Problem::Empty)
        } else {
            Ok(())
        }
    });
    // A stop at damage alone is said by the frames.
    match read {
        Err(problem) if frames.len() == 0 => Err(problem),
        _ => frames.finish().map(Some),
    }
}

/// Whether the first line is a sample by itself.
fn begins_with_sample(bytes: &[u8]) -> bool {
    let lines = text(bytes).unwrap_or_default().lines();
    let first = lines.map(str::trim).find(|line| !line.is_empty());
    first.is_some_and(|line| matches!(parse(line.as_bytes()), Ok(Value::Object(_))))
}

/// What names the image of a sample.
fn image_of_sample<'a>(sample: &Node<'a>) -> Option<Node<'a>> {
    sample.find("image_id").or_else(|| sample.find("image_ids"))
}

/// Whether the principal point of a frame is not in the middle of its picture.
fn is_off_centre(frame: &FrameCamera) -> bool {
    let (Some(pinhole), Some(size)) = (frame.pinhole(), frame.size) else {
        return false;
    };
    pinhole.principal_point.distance_px(size.centre()) > 1e-9
}

/// The name of a file's frame: without folders, prefix and ending.
fn frame_name(file: &str) -> &str {
    let stem = stem(file);
    stem.strip_prefix(PREFIX).unwrap_or(stem)
}

impl CameraFormat for SoccerNet {
    fn about(&self) -> About {
        About {
            name: "soccernet",
            title: "SoccerNet camera files, one per frame",
            conventions: SOCCERNET_WORLD,
            users: "SoccerNet challenges, sn-calibration, tracklab, TVCalib, PnLCalib, sportlight",
            loses: Some("size of the picture, time, uncertainty"),
            file: None,
            files: "camera files (camera_….json)",
            endings: &["json"],
            export_options: format_options::CAMERAS_OUT,
            import_options: format_options::CAMERAS_IN,
        }
    }

    fn size_source(&self) -> SizeSource {
        SizeSource::PrincipalPoint
    }

    fn hold(&self, frame: &FrameCamera, _index: usize, _context: &WriteContext<'_>) -> HeldFrame {
        let name = stem_of(frame);
        if name.contains('.') {
            return Err(format!(
                "the evaluator cuts names at the first dot, and {name:?} has one; rename the image"
            ));
        }
        Ok(frame.with_name(name))
    }

    fn notes(&self, frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
        let off: Vec<&FrameCamera> = frames.iter().filter(|frame| is_off_centre(frame)).collect();
        // Such a camera projects correctly where the size is known, but a reader that rescales by
        // twice the principal point gets another picture.
        let centre = off
            .first()
            .and_then(|frame| Some((frame.pinhole()?.principal_point, frame.size?)));
        let centre = centre.map(|(point, size)| {
            format!(
                "the principal point of {} is off-centre ({}, {} in a picture of {} × {}); readers that rescale take \
                 twice the principal point for the size",
                pluralise(off.len(), "frame"),
                point.x,
                point.y,
                size.width,
                size.height
            )
        });
        // The challenge evaluates at 960 × 540; a camera of another size scores as wrong.
        let wide = frames
            .iter()
            .find_map(|frame| frame.size)
            .filter(|size| size.width != 960);
        let wide = wide.map(|size| {
            format!(
                "cameras are in px of {} × {}; a submission needs --size 960x540",
                size.width, size.height
            )
        });
        pitch_note(context)
            .into_iter()
            .chain(centre)
            .chain(wide)
            .collect()
    }

    fn write(&self, held: &[FrameCamera], _context: &WriteContext<'_>) -> ExchangeResult<Files> {
        let mut files = Files::default();
        for frame in held {
            if let Some(pinhole) = frame.pinhole() {
                files.add(
                    format!("{PREFIX}{}.json", frame.name),
                    format!("{:#}\n", to_json(pinhole)),
                );
            }
        }
        Ok(files)
    }

    fn is_wanted(&self, name: &str) -> bool {
        stem(name).starts_with(PREFIX) && has_ending(name, "json")
    }

    fn read(&self, files: &Files, _options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        read_files(files)
    }
}

impl CameraFormat for PnlCalib {
    fn about(&self) -> About {
        About {
            name: "pnlcalib",
            title: "cameras of PnLCalib, NBJW or TVCalib",
            conventions: SOCCERNET_WORLD,
            users: "PnLCalib, No Bells Just Whistles, TVCalib",
            loses: None,
            file: None,
            files: "camera files (.json)",
            endings: &["json"],
            export_options: &[],
            import_options: format_options::CAMERAS_IN,
        }
    }

    fn size_source(&self) -> SizeSource {
        SizeSource::PrincipalPoint
    }

    /// A file for each frame, or one with a sample for each.
    fn read(&self, files: &Files, _options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        let sorted = files.sorted_entries();
        // Of several files each is a frame. A single one may be a list of samples; where it has
        // none, it is read again as a frame.
        let [(name, bytes)] = sorted[..] else {
            return read_files(files);
        };
        match read_samples(bytes).map_err(|problem| problem.within(name))? {
            Some(frames) => Ok(frames),
            None => read_files(files),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::export;
    use crate::exchange::tests::{awkward, export_as, reference, text_of};
    use crate::exchange::{ExportOptions, Format};
    use std::path::Path;

    #[test]
    fn the_reference_camera_has_the_published_numbers() {
        let files = export_as(&reference(), Format::SoccerNet).files;
        let camera: Value = serde_json::from_str(&text_of(&files, "camera_0001.json")).unwrap();
        let number = |key: &str| camera[key].as_f64().unwrap();
        assert!((number("pan_degrees") - 12.5).abs() < 1e-12);
        assert!((number("tilt_degrees") - 78.8).abs() < 1e-12);
        assert!(number("roll_degrees").abs() < 1e-12);
        assert_eq!(camera["position_meters"], json!([0.0, 60.0, -18.0]));
        assert_eq!(
            camera["radial_distortion"],
            json!([0.0661, 0.0, 0.0, 0.0, 0.0, 0.0])
        );
        assert_eq!(camera.as_object().unwrap().len(), 10, "all ten keys");
    }

    #[test]
    fn awkward_cameras_come_back_and_what_others_assume_is_said() {
        let exported = export_as(&awkward(), Format::SoccerNet);
        assert!(
            exported.worst_px < 1e-6 && exported.loss.is_none(),
            "{exported:?}"
        );
        let notes = exported.notes.join("\n");
        assert!(
            notes.contains("the field is 100 × 64 m; the tools that read this assume 105 × 68 m"),
            "{notes}"
        );
        assert!(
            notes.contains("(951.5, 548.25 in a picture of 1920 × 1080)"),
            "{notes}"
        );
    }

    #[test]
    fn a_submission_is_in_pixels_of_its_size() {
        let options = ExportOptions {
            size: Some(ImageSize::new(960, 540)),
            ..ExportOptions::default()
        };
        let small = export(reference().at(Path::new("/")), Format::SoccerNet, &options).unwrap();
        let camera: Value =
            serde_json::from_str(&text_of(&small.files, "camera_0001.json")).unwrap();
        assert_eq!(camera["x_focal_length"], 1205.0);
        assert_eq!(camera["principal_point"], json!([480.0, 270.0]));
        assert!(
            small.notes.iter().all(|note| !note.contains("960x540")),
            "{:?}",
            small.notes
        );
    }

    #[test]
    fn a_mirrored_or_turned_world_would_be_seen() {
        // A camera on the main side at height 18 m is at positive y and negative z in their world.
        assert_eq!(
            flip_point(Vec3::new(1.0, -60.0, 18.0)),
            Vec3::new(1.0, 60.0, -18.0)
        );
        let straight_down = rotation_of([30.0, 0.0, 0.0]);
        assert!((rotation_of(angles_deg(&straight_down)) - straight_down).amax() < 1e-12);
        let steep = rotation_of([-170.0, 65.0, 1.5]);
        assert!((rotation_of(angles_deg(&steep)) - steep).amax() < 1e-14);
    }

    #[test]
    fn names_with_dots_are_refused() {
        let mut document = reference();
        document.frames[0].image = Some("a.b.jpg".to_owned());
        let error = export(
            document.at(Path::new("/")),
            Format::SoccerNet,
            &ExportOptions::default(),
        )
        .unwrap_err();
        assert_eq!(
            error.to_string(),
            "a.b.jpg cannot be written as soccernet: the evaluator cuts names at the first dot, and \"a.b\" has one; rename \
             the image"
        );
    }

    #[test]
    fn a_damaged_sample_of_a_list_costs_its_own_camera_alone() {
        let files = export_as(&reference(), Format::SoccerNet).files;
        let mut good: Value = serde_json::from_str(&text_of(&files, "camera_0001.json")).unwrap();
        good["image_id"] = "a.jpg".into();
        let bad = json!({ "image_id": "b.jpg" });
        let [frames, all_damaged] = [json!([null, good, bad]), json!([bad])].map(|list| {
            let files = Files::one("all.json", list.to_string().into_bytes());
            PnlCalib.read(&files, &ImportOptions::default())
        });
        let frames = frames.unwrap();
        let read_of: Vec<(&str, bool)> = frames
            .iter()
            .map(|frame| (frame.name.as_str(), frame.unreadable.is_none()))
            .collect();
        assert_eq!(read_of, [("000000", false), ("a", true), ("b", false)]);
        let problem = &frames[2].unreadable.as_ref().unwrap().problem;
        assert!(problem.ends_with("x_focal_length is missing"), "{problem}");
        let error = all_damaged.unwrap_err().to_string();
        assert!(error.starts_with("all.json: "), "{error}");
    }

    #[test]
    fn a_rotation_that_contradicts_the_angles_beside_it_is_noted() {
        let files = export_as(&reference(), Format::SoccerNet).files;
        let camera: Value = serde_json::from_str(&text_of(&files, "camera_0001.json")).unwrap();
        let angles = ["pan_degrees", "tilt_degrees", "roll_degrees"];
        let rotation = rotation_of(angles.map(|key| camera[key].as_f64().unwrap()));
        let rows = |matrix: Mat3| -> Value {
            let rows = matrix.row_iter().map(|row| row.iter().copied().collect());
            rows.collect::<Vec<Vec<f64>>>().into()
        };
        let remark_on = |matrix: Value| {
            let mut camera = camera.clone();
            camera["rotation_matrix"] = matrix;
            let files = Files::one("camera_a.json", camera.to_string().into_bytes());
            SoccerNet.read(&files, &ImportOptions::default()).unwrap()[0].remark
        };
        assert_eq!(remark_on(rows(rotation)), None);
        assert_eq!(remark_on(rows(rotation.transpose())), Some(OTHER_ROTATION));
        assert_eq!(remark_on(json!([1, 0, 0])), None, "another program's key");
    }

    #[test]
    fn samples_are_read_one_a_line_and_a_damaged_one_is_named_by_it() {
        let files = export_as(&reference(), Format::SoccerNet).files;
        let mut good: Value = serde_json::from_str(&text_of(&files, "camera_0001.json")).unwrap();
        let line = |good: &mut Value, image: &str| {
            good["image_ids"] = image.into();
            good["loss_ndc_total"] = 0.008.into();
            good.to_string()
        };
        let [a, b] = ["1.jpg", "2.jpg"].map(|image| line(&mut good, image));
        let read = |text: String| {
            let files = Files::one("per_sample_output.json", text.into_bytes());
            PnlCalib.read(&files, &ImportOptions::default()).unwrap()
        };
        let names = |frames: &[FrameCamera]| -> Vec<String> {
            frames.iter().map(|frame| frame.name.clone()).collect()
        };
        assert_eq!(names(&read(format!("{a}\n{b}\n"))), ["1", "2"]);
        assert_eq!(names(&read(b.clone())), ["2"], "one line of them");
        let frames = read(format!("{a}\n{{\"image_ids\": \"9.jpg\"}}\n{b}\n"));
        assert_eq!(names(&frames), ["1", "9", "2"]);
        let problem = &frames[1].unreadable.as_ref().unwrap().problem;
        assert!(problem.starts_with("line 2: "), "{problem}");
    }

    #[test]
    fn damaged_files_are_named_in_one_line() {
        let good = to_json(&Pinhole {
            cam_from_world: flip_rotation(&rotation_of([12.5, 78.8, 0.0])),
            position_m: Vec3::new(0.0, -60.0, 18.0),
            focal_px: 2410.0,
            principal_point: ImagePoint::new(960.0, 540.0),
            lens: Radial::default(),
        });
        let with = |key: &str, value: Value| {
            let mut camera = good.clone();
            camera[key] = value;
            camera.to_string()
        };
        let without = |key: &str| {
            let mut camera = good.clone();
            camera.as_object_mut().unwrap().remove(key);
            camera.to_string()
        };
        let deep = "[".repeat(100_000);
        let cases: &[(String, &str)] = &[
            (String::new(), "the file is empty"),
            (
                "{".to_owned(),
                "not valid JSON: it ends within an object at line 1 column 1",
            ),
            (
                deep,
                "not valid JSON: lists and objects are nested more than 127 deep at line 1 column 128",
            ),
            (
                "[]".to_owned(),
                "the file: an object is expected, found a list of 0",
            ),
            ("7".to_owned(), "the file: an object is expected, found 7"),
            (without("pan_degrees"), "pan_degrees is missing"),
            (without("radial_distortion"), "radial_distortion is missing"),
            (
                with("tilt_degrees", json!("steep")),
                "tilt_degrees: a number is expected, found the text \"steep\"",
            ),
            (
                with("tilt_degrees", Value::Null),
                "tilt_degrees: a number is expected, found null",
            ),
            (
                with("position_meters", json!([0.0, 60.0])),
                "position_meters (numbers): 3 are expected, found 2",
            ),
            (
                with("position_meters", json!([0.0, "a", 1.0])),
                "position_meters[1]: a number is expected, found the text \"a\"",
            ),
            (
                with("position_meters", json!([0.0, 6e6, 1.0])),
                "a coordinate of the position of the camera is 6000000, which must be within 100 km, in metres",
            ),
            (
                with("x_focal_length", json!(0)),
                "x_focal_length is 0, which must be above 0",
            ),
            (
                with("y_focal_length", json!(241.0)),
                "fy / fx of the focal lengths 2410 and 241 px is 0.1, which must be 0.25 to 4",
            ),
            (
                with("radial_distortion", json!([0.1, 0.0, 0.3, 0.0, 0.0, 0.0])),
                "a distortion coefficient of 0.3 beyond k1 and k2 cannot be read: the document's lens has k1 and k2 only",
            ),
            (
                with("radial_distortion", json!([0.0, 0.2, 0.0, 0.0, 0.0, 0.0])),
                "k2 = 0.2 without k1 of the camera cannot be read: in the lens model k2 depends on k1",
            ),
            (
                with("pan_degrees", json!(0)).replace(":0,", ":NaN,"),
                "not valid JSON: a value is expected (JSON has no NaN and no Infinity) at line 1 column ",
            ),
            (
                with("pan_degrees", json!(0)).replace(":0,", ":1e999,"),
                "not valid JSON: number out of range at line 1 column ",
            ),
        ];
        for (text, wanted) in cases {
            let files = Files::one("camera_a.json", text.clone().into_bytes());
            let error = SoccerNet
                .read(&files, &ImportOptions::default())
                .unwrap_err()
                .to_string();
            assert!(
                error.starts_with(&format!("camera_a.json: {wanted}")),
                "{error}\nwanted {wanted}"
            );
            assert!(!error.contains('\n'));
        }
        let files = Files::one("camera_a.json", vec![b'{', 0xff]);
        let error = SoccerNet
            .read(&files, &ImportOptions::default())
            .unwrap_err()
            .to_string();
        assert_eq!(error, "camera_a.json: not UTF-8 text (byte 1)");
    }
}
