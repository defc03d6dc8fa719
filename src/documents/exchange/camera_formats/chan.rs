//! Nuke's camera track: a line a frame, `frame tx ty tz rx ry rz vfov` between tabs.
//!
//! World y up, metres: (x, z, −y) of ours. The camera looks along −z, y up; rotation = Ry · Rx · Rz
//! (Nuke's default order ZXY). The last column is the *vertical* field of view in degrees. There is
//! neither a size of picture nor a principal point, lens or rate.

use crate::exchange::cameras::camera_format::{
    CameraFormat, HeldFrame, SequenceScope, WriteContext,
};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection, Pinhole};
use crate::exchange::cameras::held::{
    OTHER_SIZE, cannot_hold, note_several_cameras, parts, plain, with,
};
use crate::exchange::cameras::unreadable::FrameCollector;
use crate::exchange::error::{ExchangeError, ExchangeResult, Problem};
use crate::exchange::files::{Files, text};
use crate::exchange::format::{About, Format};
use crate::exchange::format_options::{self, FormatOption};
use crate::exchange::options::ImportOptions;
use crate::exchange::syntax::table::numbers;
use crate::exchange::syntax::values::frame_number;
use std::fmt::Write as _;
use touchline_core::camera::Radial;
use touchline_core::geometry::{Mat3, Vec3};

/// The format.
pub struct Chan;

/// The rotation from our `world` to a world with y up: (x, y, z) → (x, z, −y).
pub fn y_up() -> Mat3 {
    Mat3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0)
}

/// The change between our camera axes (y down, z forward) and those of a camera that looks along −z
/// with y up. It is its own inverse.
pub fn looking_back() -> Mat3 {
    Mat3::from_diagonal(&Vec3::new(1.0, -1.0, -1.0))
}

/// rx, ry, rz in degrees of m = Ry · Rx · Rz.
fn angles_deg(m: &Mat3) -> [f64; 3] {
    // m = Ry Rx Rz: its third column is (sin ry cos rx, −sin rx, cos ry cos rx), its second row
    // (cos rx sin rz, cos rx cos rz, −sin rx).
    let rx = (-m[(1, 2)]).atan2(m[(0, 2)].hypot(m[(2, 2)]));
    let ry = m[(0, 2)].atan2(m[(2, 2)]);
    let rz = m[(1, 0)].atan2(m[(1, 1)]);
    [rx, ry, rz].map(f64::to_degrees)
}

fn rotation([rx, ry, rz]: [f64; 3]) -> Mat3 {
    let [(sx, cx), (sy, cy), (sz, cz)] = [rx, ry, rz].map(|degrees| degrees.to_radians().sin_cos());
    Mat3::new(cy, 0.0, sy, 0.0, 1.0, 0.0, -sy, 0.0, cy)
        * Mat3::new(1.0, 0.0, 0.0, 0.0, cx, -sx, 0.0, sx, cx)
        * Mat3::new(cz, -sz, 0.0, sz, cz, 0.0, 0.0, 0.0, 1.0)
}

/// The number of a frame in the track.
fn number_of(frame: &FrameCamera, index: usize) -> u64 {
    frame.frame_index.unwrap_or(index as u64)
}

/// The name of a line's frame where its camera cannot be read: its number, where that can be read.
fn name_of(line: &str, number_of_line: usize) -> String {
    let first = line.split_whitespace().next();
    let number: Option<f64> = first.and_then(|first| first.parse().ok());
    match number.map(|number| frame_number("the frame", number)) {
        Some(Ok(number)) => format!("{number:06}"),
        _ => format!("line {number_of_line}"),
    }
}

fn read_line(line: &str, options: &ImportOptions) -> Result<Option<FrameCamera>, Problem> {
    let values = numbers("a column", line)?;
    if values.is_empty() {
        return Ok(None);
    }
    let found = values.len();
    let [number, x, y, z, rx, ry, rz, view]: [f64; 8] = values
        .try_into()
        .map_err(|_| Problem::wrong_count("columns", 8, found))?;
    let number = frame_number("the frame", number)?;
    // Towards 180° the focal length goes to zero; written so that NaN is refused.
    if !(view > 0.0 && view < 179.0) {
        let what = "the field of view".to_owned();
        return Err(Problem::out_of_range(
            what,
            view,
            "between 0 and 179 degrees",
        ));
    }
    // `read` refuses files without a given size before any line is read.
    let size = options.size.unwrap_or_default();
    let world_from_cam = y_up().transpose() * rotation([rx, ry, rz]) * looking_back();
    let pinhole = Pinhole {
        cam_from_world: world_from_cam.transpose(),
        position_m: y_up().transpose() * Vec3::new(x, y, z),
        focal_px: f64::from(size.height) / 2.0 / (view / 2.0).to_radians().tan(),
        principal_point: size.centre(),
        lens: Radial::default(),
    };
    let name = format!("{number:06}");
    Ok(Some(FrameCamera::new(
        &name,
        Some(size),
        FrameProjection::Camera(pinhole.validate("the camera")?),
    )))
}

impl CameraFormat for Chan {
    fn about(&self) -> About {
        About {
            name: "chan",
            title: "a Nuke camera track",
            conventions: "y up, m, rotation order ZXY, vertical field of view in degrees",
            users: "Nuke, Blender, Natron",
            loses: Some("lens, principal point, size, rate, uncertainty"),
            file: Some("camera.chan"),
            files: "camera track (.chan)",
            endings: &["chan"],
            export_options: &[
                FormatOption::Size,
                FormatOption::Interpolate,
                FormatOption::Takes,
                FormatOption::StageOrigin,
                FormatOption::StageHeading,
            ],
            import_options: format_options::CAMERAS_IN,
        }
    }

    fn hold(&self, frame: &FrameCamera, index: usize, _context: &WriteContext<'_>) -> HeldFrame {
        let (pinhole, size) = parts(frame)?;
        Ok(with(
            frame,
            format!("{:06}", number_of(frame, index)),
            plain(&pinhole, size),
        ))
    }

    fn notes(&self, frames: &[FrameCamera], _context: &WriteContext<'_>) -> Vec<String> {
        let how = "the last column is the vertical field of view in degrees, rotation order ZXY; set the aperture to the \
                   picture's proportions before importing";
        let mut notes = vec![how.to_owned()];
        notes.extend(note_several_cameras(frames));
        notes
    }

    fn sequence(&self) -> Option<SequenceScope> {
        Some(SequenceScope::All)
    }

    fn write(&self, held: &[FrameCamera], _context: &WriteContext<'_>) -> ExchangeResult<Files> {
        let mut text = String::new();
        // A reader knows one size for the whole track, by which it finds the focal lengths.
        let first_size = held.first().and_then(|first| first.size);
        for (index, frame) in held.iter().enumerate() {
            let Ok((pinhole, size)) = parts(frame) else {
                continue;
            };
            if Some(size) != first_size {
                return Err(cannot_hold(frame, Format::Chan, OTHER_SIZE.to_owned()));
            }
            // Camera to world, both in Nuke's axes.
            let m = y_up() * pinhole.cam_from_world.transpose() * looking_back();
            let [rx, ry, rz] = angles_deg(&m);
            let at = y_up() * pinhole.position_m;
            // The angle is vertical, over the whole height, for the principal point is the middle.
            let view = 2.0
                * (f64::from(size.height) / 2.0)
                    .atan2(pinhole.focal_px)
                    .to_degrees();
            let number = number_of(frame, index);
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{number}\t{}\t{}\t{}\t{rx}\t{ry}\t{rz}\t{view}",
                at.x, at.y, at.z
            );
        }
        Ok(Files::one("camera.chan", text.into_bytes()))
    }

    fn read(&self, files: &Files, options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        if options.size.is_none() {
            let (what, option) = ("the size of its pictures", "--size WIDTHxHEIGHT");
            return Err(ExchangeError::OptionNeeded {
                format: Format::Chan,
                what,
                option,
            });
        }
        files.read_all(|_, bytes| {
            let mut frames = FrameCollector::default();
            for (index, line) in text(bytes)?.lines().enumerate() {
                let read = read_line(line, options).map_err(|problem| problem.at_line(index + 1));
                if let Some(read) = read.transpose() {
                    frames.add(&name_of(line, index + 1), None, read);
                }
                if frames.has_only_damaged() {
                    break;
                }
            }
            frames.finish()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::ExportOptions;
    use crate::exchange::export;
    use crate::exchange::tests::{SIZE, awkward, export_as, reference, text_of};
    use std::path::Path;
    use touchline_core::geometry::ImageSize;

    #[test]
    fn the_reference_camera_has_the_published_numbers() {
        let exported = export_as(&reference(), Format::Chan);
        let text = text_of(&exported.files, "camera.chan");
        let found = numbers("the line", &text).unwrap();
        for (found, wanted) in
            found
                .iter()
                .zip([412.0, 0.0, 18.0, 60.0, -11.2, -12.5, 0.0, 25.25891790605078])
        {
            assert!((found - wanted).abs() < 1e-12, "{text}");
        }
        assert_eq!(exported.loss.unwrap().what, ["lens distortion"]);
    }

    #[test]
    fn rolled_cameras_come_back_as_far_as_they_are_held() {
        let exported = export_as(&awkward(), Format::Chan);
        assert!(exported.worst_px < 1e-6, "{}", exported.worst_px);
        assert_eq!(
            exported.loss.unwrap().what,
            ["lens distortion", "the principal point"]
        );
    }

    #[test]
    fn pictures_of_two_sizes_are_refused() {
        let mut document = awkward();
        let mut small = (*document.cameras[0]).clone();
        (small.id, small.image_size) = ("small".into(), ImageSize::new(960, 540));
        document.cameras.push(small.into());
        document.frames[3].camera = "small".into();
        document.frames[3].image_size = ImageSize::new(960, 540);
        let options = ExportOptions::default();
        let error = export(document.at(Path::new("/")), Format::Chan, &options).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!("images/0004.jpg cannot be written as chan: {OTHER_SIZE}")
        );
    }

    #[test]
    fn damaged_tracks_are_named_in_one_line() {
        let options = ImportOptions {
            size: Some(SIZE),
            ..ImportOptions::default()
        };
        for (text, wanted) in [
            ("", "the file is empty"),
            (
                "412 0 18 60 -11 -12 0\n",
                "line 1: columns: 8 are expected, found 7",
            ),
            (
                "412 0 18 60 -11 -12 0 25 1\n",
                "line 1: columns: 8 are expected, found 9",
            ),
            (
                "frame tx ty\n",
                "line 1: a column: a number is expected, found \"frame\"",
            ),
            (
                "413 0 18 nan -11 -12 0 25\n",
                "line 1: a column is not a finite number",
            ),
            (
                "412 0 18 60 -11 -12 0 0\n",
                "line 1: the field of view is 0, which must be between 0 and 179 degrees",
            ),
            (
                "412 0 18 60 -11 -12 0 2000\n",
                "line 1: the field of view is 2000, which must be between 0 and 179 degrees",
            ),
            (
                "4.5 0 18 60 -11 -12 0 25\n",
                "line 1: the frame is 4.5, which must be a whole number from 0 to 10^12",
            ),
            (
                "412 0 1e9 60 -11 -12 0 25\n",
                "line 1: a coordinate of the position of the camera is 1000000000, which must be within 100 km, in metres",
            ),
        ] {
            let files = Files::one("a.chan", text.as_bytes().to_vec());
            let error = Chan.read(&files, &options).unwrap_err().to_string();
            assert_eq!(error, format!("a.chan: {wanted}"));
        }
        let files = Files::one("a.chan", b"1 0 0 0 0 0 0 25".to_vec());
        let error = Chan
            .read(&files, &ImportOptions::default())
            .unwrap_err()
            .to_string();
        assert_eq!(
            error,
            "chan does not say the size of its pictures; give --size WIDTHxHEIGHT"
        );
    }
}
