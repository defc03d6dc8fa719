//! The homographies of the World Cup 2014 set and of the TS-WorldCup set.
//!
//! Those of both sets map a pixel (with the first pixel's centre as the origin) to a template of
//! 114.83 × 74.37 *yards* whose origin is the far left corner, y towards the camera. The sets
//! differ in their files alone: text, and arrays of `NumPy` in a folder for each video. Source:
//! ericsujw/KpSFR (loaders).

use super::ground_homography::{corner_from, hold, inverse, matrix, normalise_homography};
use crate::exchange::cameras::camera_format::{CameraFormat, HeldFrame, WriteContext, stem_of};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection};
use crate::exchange::cameras::picture_size::SizeSource;
use crate::exchange::cameras::unreadable::read_frame_files;
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, stem, text};
use crate::exchange::format::About;
use crate::exchange::format_options;
use crate::exchange::options::{ImportOptions, Pixels};
use crate::exchange::syntax::npy;
use crate::exchange::syntax::table::numbers;
use std::fmt::Write as _;
use touchline_core::field::YARD_M;
use touchline_core::geometry::{ImageSize, Mat3};

/// The template of both sets, yards.
pub(super) const TEMPLATE_YD: [f64; 2] = [114.83, 74.37];
/// The pictures of both sets.
const SET_SIZE: ImageSize = ImageSize::new(1280, 720);
/// The ending of the World Cup 2014 set's files.
const WC14_ENDING: &str = "homographyMatrix";
/// The ending of the TS-WorldCup set's files behind the picture's name.
const TS_ENDING: &str = "_homography.npy";
/// The folder of the TS-WorldCup set's files.
const TS_FOLDER: &str = "Annotations/80_95";

/// The conventions of both sets.
const YARDS: &str = "image → template in yards from the far-left corner, y toward the camera; pixel centres at whole numbers";

/// The World Cup 2014 set.
pub struct Wc14;
/// The TS-WorldCup set.
pub struct TsWorldCup;

/// The map from the ground (x and y in m, from the middle, y away from the camera) to a template of
/// this length and width (yards, from the far left corner, y down).
pub fn template_from_ground([length, width]: [f64; 2]) -> Mat3 {
    Mat3::new(
        1.0 / YARD_M,
        0.0,
        0.5 * length,
        0.0,
        -1.0 / YARD_M,
        0.5 * width,
        0.0,
        0.0,
        1.0,
    )
}

/// The homography from picture to template that a frame is written with.
fn template_from_image(frame: &FrameCamera) -> Option<Mat3> {
    let FrameProjection::Ground(image_from_ground) = &frame.shown else {
        return None;
    };
    let ground_from_image = image_from_ground.try_inverse()?;
    Some(normalise_homography(
        template_from_ground(TEMPLATE_YD) * ground_from_image * corner_from(Pixels::Centre),
    ))
}

/// The homography from ground (m) to picture (px), from one from picture to template as both sets
/// store it.
fn image_from_ground(template_from_image: &Mat3) -> Result<Mat3, Problem> {
    let image_from_template = inverse(template_from_image, "the homography")?;
    Ok(corner_from(Pixels::Centre) * image_from_template * template_from_ground(TEMPLATE_YD))
}

/// Notes for the user about both sets.
fn notes(frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
    let mut notes = Vec::new();
    let (length, width) = (context.field.length_m, context.field.width_m);
    let [template_length, template_width] = TEMPLATE_YD.map(|yards| yards * YARD_M);
    // The template is a rounded 105 × 68 m: 0.6 mm longer and 3.9 mm wider.
    if (length - template_length).abs() > 1e-3 || (width - template_width).abs() > 1e-2 {
        notes.push(format!(
            "the field is {length} × {width} m, written in its own yards; readers assume {} × {} yd ({template_length:.2} × \
             {template_width:.2} m)",
            TEMPLATE_YD[0], TEMPLATE_YD[1]
        ));
    }
    if let Some(size) = frames
        .iter()
        .find_map(|frame| frame.size)
        .filter(|size| *size != SET_SIZE)
    {
        notes.push(format!(
            "homographies are in px of {} × {}; readers of the set assume 1280 × 720 (--size 1280x720)",
            size.width, size.height
        ));
    }
    if context.options.undistorted {
        notes.push(
            "homographies are of pictures without distortion; undistort the pictures before they are used".to_owned(),
        );
    }
    notes
}

impl CameraFormat for Wc14 {
    fn about(&self) -> About {
        About {
            name: "wc14",
            title: "World Cup 2014 homographies, one file per frame",
            conventions: YARDS,
            users: "World Cup 2014 benchmarks, KpSFR, SCCvSD",
            loses: Some("lens, points off the ground, time, uncertainty"),
            file: None,
            files: "homographies (.homographyMatrix)",
            endings: &[WC14_ENDING],
            export_options: format_options::HOMOGRAPHIES_OUT,
            import_options: format_options::CAMERAS_IN,
        }
    }

    fn size_source(&self) -> SizeSource {
        SizeSource::Assumed
    }

    fn hold(&self, frame: &FrameCamera, _index: usize, context: &WriteContext<'_>) -> HeldFrame {
        hold(frame, stem_of(frame), context)
    }

    fn notes(&self, frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
        notes(frames, context)
    }

    fn write(&self, held: &[FrameCamera], _context: &WriteContext<'_>) -> ExchangeResult<Files> {
        let mut files = Files::default();
        for frame in held {
            let Some(h) = template_from_image(frame) else {
                continue;
            };
            let mut text = String::new();
            for row in h.row_iter() {
                // Writing to a string cannot fail.
                let _ = writeln!(text, "{:e} {:e} {:e}", row[0], row[1], row[2]);
            }
            files.add(format!("{}.{WC14_ENDING}", frame.name), text);
        }
        Ok(files)
    }

    fn read(&self, files: &Files, _options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        read_frame_files(&files.sorted_entries(), stem, |name, bytes| {
            let shown = image_from_ground(&matrix(&numbers("the homography", text(bytes)?)?)?)?;
            let shown = FrameProjection::Ground(shown);
            Ok(FrameCamera::new(name, Some(SET_SIZE), shown))
        })
    }
}

impl CameraFormat for TsWorldCup {
    fn about(&self) -> About {
        About {
            name: "tsworldcup",
            title: "TS-WorldCup homographies, one .npy per frame",
            conventions: YARDS,
            users: "TS-WorldCup benchmarks, KpSFR",
            loses: Some("lens, points off the ground, time, uncertainty"),
            file: None,
            files: "homographies (…_homography.npy)",
            endings: &["npy"],
            export_options: format_options::HOMOGRAPHIES_OUT,
            import_options: format_options::CAMERAS_IN,
        }
    }

    fn size_source(&self) -> SizeSource {
        SizeSource::Assumed
    }

    fn hold(&self, frame: &FrameCamera, _index: usize, context: &WriteContext<'_>) -> HeldFrame {
        // The folder of a video is that of its camera; a slash or dots in its name would lead
        // elsewhere.
        let camera = frame
            .camera
            .as_deref()
            .unwrap_or("main")
            .replace(['/', '\\', '.'], "_");
        hold(frame, format!("{camera}/{}", stem_of(frame)), context)
    }

    fn notes(&self, frames: &[FrameCamera], context: &WriteContext<'_>) -> Vec<String> {
        let order = "pictures and homographies are paired by their order: keep the same names in both folders";
        notes(frames, context)
            .into_iter()
            .chain([order.to_owned()])
            .collect()
    }

    fn write(&self, held: &[FrameCamera], _context: &WriteContext<'_>) -> ExchangeResult<Files> {
        let mut files = Files::default();
        let mut videos: Vec<&str> = Vec::new();
        for frame in held {
            let Some(h) = template_from_image(frame) else {
                continue;
            };
            files.add(
                format!("{TS_FOLDER}/{}{TS_ENDING}", frame.name),
                npy::matrix_to_bytes(&h),
            );
            // The list of videos, by which the loaders find the folders, each once in the order of
            // the frames.
            let video = frame.name.split('/').next().unwrap_or_default();
            if !videos.contains(&video) {
                videos.push(video);
            }
        }
        files.add("test.txt", format!("{}\n", videos.join("\n")));
        Ok(files)
    }

    fn read(&self, files: &Files, _options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        // The files of an export that are verified include the list of videos.
        let mut homographies = files.sorted_entries();
        homographies.retain(|(name, _)| self.is_wanted(name));
        read_frame_files(&homographies, ts_frame_name, |name, bytes| {
            let shown = FrameProjection::Ground(image_from_ground(&npy::matrix(bytes)?)?);
            Ok(FrameCamera::new(name, Some(SET_SIZE), shown))
        })
    }
}

/// The name of the frame of a file of the TS-WorldCup set, with the folder of its video.
fn ts_frame_name(file: &str) -> &str {
    let stem = file
        .strip_suffix(TS_ENDING)
        .or_else(|| file.strip_suffix(".npy"))
        .unwrap_or(file);
    stem.strip_prefix(TS_FOLDER)
        .map_or(stem, |rest| rest.trim_start_matches('/'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::export;
    use crate::exchange::tests::{awkward, export_as, pinhole_reference, reference, text_of};
    use crate::exchange::{ExportOptions, Format};
    use std::path::Path;
    use touchline_core::geometry::{Vec2, Vec3};

    #[test]
    fn the_centre_mark_is_in_the_middle_of_the_template() {
        let text = text_of(
            &export_as(&pinhole_reference(), Format::Wc14).files,
            "0001.homographyMatrix",
        );
        let h = matrix(&numbers("h", &text).unwrap()).unwrap();
        // The pixel counts from the first one's centre.
        let template = h * Vec3::new(446.0813, 787.7564, 1.0);
        let template = template.xy() / template.z;
        assert!(
            (template - Vec2::new(57.415, 37.185)).norm() < 1e-4,
            "{template}"
        );
        assert_eq!(h[(2, 2)], 1.0);
    }

    #[test]
    fn a_distorted_picture_gives_the_nearest_homography_and_its_distance() {
        let distorted = export_as(&reference(), Format::Wc14);
        let loss = distorted.loss.unwrap();
        assert_eq!(loss.what, ["lens distortion", "points off the ground"]);
        assert!(
            loss.rms_px > 0.1 && loss.rms_px < 5.0 && loss.off_ground > 0,
            "{loss}"
        );
        let options = ExportOptions {
            undistorted: true,
            ..ExportOptions::default()
        };
        let flat = export(reference().at(Path::new("/")), Format::Wc14, &options).unwrap();
        let straight = export_as(&pinhole_reference(), Format::Wc14);
        assert_eq!(
            flat.files, straight.files,
            "of the picture without distortion"
        );
        assert!(
            flat.notes
                .iter()
                .any(|note| note.contains("undistort the pictures")),
            "{:?}",
            flat.notes
        );
    }

    #[test]
    fn awkward_homographies_of_the_sets_come_back() {
        for format in [Format::Wc14, Format::TsWorldCup] {
            let exported = export_as(&awkward(), format);
            assert!(exported.worst_px < 1e-6, "{format}: {}", exported.worst_px);
        }
    }

    #[test]
    fn damaged_files_are_named_in_one_line() {
        for (text, wanted) in [
            ("", "the file is empty"),
            (
                "1 2 3\n4 5 6\n",
                "the homography (numbers): 9 are expected, found 6",
            ),
            (
                "1 2 3\n4 5 6\n7 8 nine\n",
                "the homography: a number is expected, found \"nine\"",
            ),
            (
                "1 2 3\n4 5 6\n7 8 nan\n",
                "the homography is not a finite number",
            ),
            ("0 0 0\n0 0 0\n0 0 0\n", "the homography is singular"),
            ("1 2 3\n2 4 6\n0 0 1\n", "the homography is singular"),
        ] {
            let files = Files::one("1.homographyMatrix", text.as_bytes().to_vec());
            let error = Wc14
                .read(&files, &ImportOptions::default())
                .unwrap_err()
                .to_string();
            assert_eq!(error, format!("1.homographyMatrix: {wanted}"));
        }
    }
}
