//! A camera of its own for each frame that shows one: pictures of unknown cameras, each with its
//! lines.
//!
//! Labels of this kind (`SoccerNet`'s) come as one picture for each camera. A base from many frames
//! is of no use there; each frame's lines give position, rotation, lens and focal length together
//! ([`camera_from_lines`]). The document then has a camera for each such frame.

use crate::calibrate::base_readiness::LANDMARKS_ALONE;
use crate::calibrate::frames::calibration::rms_of_clicks_px;
use crate::calibrate::observations;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::Path;
use thiserror::Error;
use touchline_core::camera::{PtzCamera, StatedLens};
use touchline_core::field::{FieldError, FieldModel};
use touchline_core::geometry::{ImageSize, subsample};
use touchline_core::progress::Progress;
use touchline_core::solve::ObservationError;
use touchline_core::solve::base::FrameClicks;
use touchline_core::solve::from_lines::{
    CameraFromLines, FromLinesError, FromLinesOptions, LinePicture, camera_from_lines,
};
use touchline_documents::document::{
    BetterName, Camera, CameraId, Document, Fields, Frame, FrameStatus, Solution, SolutionWarning,
};

/// Why a frame has no camera of its own.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum OwnCameraError {
    /// A click names a landmark or line that the field does not have.
    #[error(transparent)]
    Observation(#[from] ObservationError),
    /// The lines give no camera.
    #[error(transparent)]
    FromLines(#[from] FromLinesError),
}

/// What became of the frames without a base.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnCameras {
    /// Indices of the frames that have a camera of their own now.
    pub solved: Vec<usize>,
    /// Indices of those whose clicks give none, with the reason.
    pub failed: Vec<(usize, OwnCameraError)>,
}

/// Frames that are solved before their cameras are written; limits the memory.
const AT_ONCE: usize = 4096;

/// Number of frames of one camera whose lines are tried for a start of its base.
const MAX_BY_LINES: usize = 12;

/// Gives each frame a camera of its own that has clicks, no camera pose, and whose camera has no
/// base. Frames of the same camera are taken as pictures of different ones. `folder` is the
/// document's; `progress` counts these frames, from any thread. None if it cancels this, and the
/// document has not changed then.
///
/// # Errors
/// A field of the document is not valid.
pub fn give_own_cameras(
    document: &mut Document,
    folder: &Path,
    progress: &Progress<'_, ()>,
) -> Result<Option<OwnCameras>, FieldError> {
    let fields = Fields::from_document(document.at(folder))?;
    // Frames are solved in the document as it was given, so that the batches do not change the
    // result. A cancelled run goes back to it.
    let given = document.clone();
    let with_base: BTreeSet<&CameraId> = given
        .cameras
        .iter()
        .filter(|camera| camera.base().is_some())
        .map(|camera| &camera.id)
        .collect();
    let open: Vec<usize> = (0..given.frames.len())
        .filter(|&index| {
            let frame = &given.frames[index];
            frame.ptz.is_none() && !frame.clicks.is_empty() && !with_base.contains(&frame.camera)
        })
        .collect();

    let mut names = FreeNames::from_document(&given);
    let mut result = OwnCameras::default();
    for some in open.chunks(AT_ONCE) {
        let solved = some.par_iter().map(|&index| {
            let frame = &given.frames[index];
            let solved = solve_alone(&given, frame, fields.for_frame(&given, frame));
            progress.report(()).is_continue().then_some((index, solved))
        });
        let Some(solved) = solved.collect::<Option<Vec<_>>>() else {
            *document = given;
            return Ok(None);
        };
        for (index, solved) in solved {
            match solved {
                Ok(found) => {
                    record(document, index, &found, &mut names);
                    result.solved.push(index);
                }
                Err(error) => result.failed.push((index, error)),
            }
        }
    }
    drop_unused(document, &with_base);
    Ok(Some(result))
}

/// The cameras that single frames have by their lines, of up to [`MAX_BY_LINES`] frames that could
/// have one.
pub(super) fn cameras_from_lines(
    field: &FieldModel,
    frames: &[FrameClicks],
    image_size: ImageSize,
    lens: StatedLens,
) -> Vec<PtzCamera> {
    // A start needs one good camera, and each takes 10 ms (`tests/benches/lines.md`), so some
    // frames suffice. Frames with fewer equations than four landmarks give are not tried.
    let enough: Vec<&FrameClicks> = frames
        .iter()
        .filter(|frame| frame.equations() >= 2 * LANDMARKS_ALONE)
        .collect();
    let chosen: Vec<&FrameClicks> = subsample(enough, MAX_BY_LINES).collect();
    chosen
        .par_iter()
        .filter_map(|frame| {
            let picture = LinePicture {
                field,
                observations: &frame.observations,
                image_size,
                lens,
            };
            let found = camera_from_lines(&picture, &FromLinesOptions::default());
            found.ok().map(|found| found.camera())
        })
        .collect()
}

/// A camera of a frame's lines, with the root mean square distance of its points, px.
struct LineCameraFit {
    camera: CameraFromLines,
    rms_px: f64,
}

fn solve_alone(
    document: &Document,
    frame: &Frame,
    field: &FieldModel,
) -> Result<LineCameraFit, OwnCameraError> {
    let clicks = observations(frame, field)?;
    let picture = LinePicture {
        field,
        observations: &clicks,
        image_size: frame.image_size,
        lens: document.stated_lens(frame),
    };
    let camera = camera_from_lines(&picture, &FromLinesOptions::default())?;
    let rms_px = rms_of_clicks_px(&clicks, &camera.camera()).unwrap_or(0.0);
    Ok(LineCameraFit { camera, rms_px })
}

/// Writes a frame's own camera into the document.
fn record(document: &mut Document, index: usize, found: &LineCameraFit, names: &mut FreeNames) {
    let LineCameraFit { camera, rms_px } = found;
    let known = document.camera_of(&document.frames[index]).cloned();
    let frame = &mut document.frames[index];
    let id = names.take(&frame.camera);
    // Masks, field and whatever else the document states of the given camera stay with the frame.
    let mut own = known.unwrap_or_else(|| Camera::new(id.clone(), frame.image_size));
    own.id.clone_from(&id);
    own.set_base(&camera.base);
    document.cameras.push(own.into());

    let pointed = camera.camera();
    let known = &camera.uncertainty;
    frame.camera = id;
    frame.point(camera.ptz, pointed.lens());
    if frame.status == FrameStatus::New {
        frame.status = FrameStatus::Suggested;
    }
    frame.solution = Some(Solution {
        source: Some(frame.source_of_clicks()),
        rms_px: Some(*rms_px),
        covariance: Some(known.ptz_covariance_deg()),
        own_covariance: Some(known.own_covariance_deg()),
        worst_corner_sigma_px: known.corner_sigma_px_if_known(&pointed, frame.image_size),
        imported: frame.take_imported(),
        warnings: camera
            .identity
            .iter()
            .map(|finding| {
                let warning = finding.warning();
                SolutionWarning {
                    clicks: warning.clicks,
                    renames: BetterName::all(finding).collect(),
                    ..SolutionWarning::new(warning.code.as_str(), warning.message)
                }
            })
            .collect(),
        ..Solution::default()
    });
}

/// Drops cameras without a base that no frame is of any more.
fn drop_unused(document: &mut Document, with_base: &BTreeSet<&CameraId>) {
    let used = document.used_cameras();
    document
        .cameras
        .retain(|camera| used.contains(&camera.id) || with_base.contains(&camera.id));
}

/// Names for further cameras: that of a frame's camera with the next free number.
struct FreeNames {
    taken: BTreeSet<CameraId>,
    next: usize,
}

impl FreeNames {
    fn from_document(document: &Document) -> Self {
        let taken = document.cameras.iter().map(|camera| camera.id.clone());
        Self {
            taken: taken.collect(),
            next: 1,
        }
    }

    fn take(&mut self, like: &CameraId) -> CameraId {
        loop {
            // The number grows over all names: to search from 1 for each would take quadratic time
            // in documents of ten thousand pictures.
            let id = CameraId::from(format!("{like}-{}", self.next).as_str());
            self.next += 1;
            if self.taken.insert(id.clone()) {
                return id;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::{BaseProblem, BaseReadiness, camera_alone};
    use std::ops::ControlFlow;
    use touchline_core::camera::{CameraBase, FocalCurve};
    use touchline_core::geometry::{ImagePoint, ImageSize};
    use touchline_core::score::annotated_lines;
    use touchline_core::solve::base::BaseOptions;
    use touchline_core::testing::{TestBase, base_at, soccer};
    use touchline_documents::document::{Click, Target};
    use touchline_documents::testing::{new_frame, soccer_document};

    const SIZE: ImageSize = ImageSize::new(960, 540);

    /// Two pictures of different cameras with their lines, and one with a single line, of a stated
    /// lens.
    fn three_pictures_of(
        principal_point: ImagePoint,
        distortion: FocalCurve,
    ) -> (Document, Vec<PtzCamera>) {
        let field = soccer();
        let cameras = [
            ([2.0, -66.0, 16.0], (-28.0, -12.0, 2000.0)),
            ([-4.0, -80.0, 22.0], (24.0, -14.0, 2600.0)),
        ]
        .map(|(position_m, (pan_deg, tilt_deg, focal_px))| {
            let base = CameraBase {
                distortion,
                ..base_at(position_m, principal_point)
            };
            base.aim(pan_deg, tilt_deg, focal_px)
        });
        let mut document = soccer_document();
        // Of the camera only the lens is known.
        let mut main = Camera::new("main".into(), SIZE);
        main.set_base(cameras[0].base());
        (main.position_m, main.base_from_world) = (None, None);
        document.cameras.push(main.into());
        for (number, camera) in cameras.iter().enumerate() {
            let mut frame = new_frame(&format!("{number}.jpg"), SIZE);
            for line in annotated_lines(&field, camera, SIZE) {
                let id = field.lines[line.line].id.clone();
                let click = |at| Click::new(Target::Line(id.clone()), at);
                frame.clicks.extend(line.points.into_iter().map(click));
            }
            document.frames.push(frame.into());
        }
        let mut little = new_frame("little.jpg", SIZE);
        little.clicks = document.frames[0].clicks[..2].to_vec();
        document.frames.push(little.into());
        (document, cameras.to_vec())
    }

    fn three_pictures() -> (Document, Vec<PtzCamera>) {
        three_pictures_of(SIZE.centre(), FocalCurve::NONE)
    }

    #[test]
    fn a_stated_principal_point_is_kept() {
        let stated = ImagePoint::new(300.0, 330.0);
        let (mut document, cameras) = three_pictures_of(stated, FocalCurve::NONE);
        give_own_cameras(&mut document, Path::new("/"), &Progress::default()).unwrap();
        for (frame, truth) in document.frames.iter().zip(&cameras) {
            let base = document.camera_of(frame).unwrap().base().unwrap();
            let off_m = (base.position_m - truth.base().position_m).norm();
            assert_eq!(base.principal_point, stated);
            assert!(off_m < 2.0, "{off_m} m");
        }
    }

    #[test]
    fn a_stated_distortion_is_the_prior() {
        let stated = FocalCurve::constant(-0.35);
        let (mut document, cameras) = three_pictures_of(SIZE.centre(), stated);
        give_own_cameras(&mut document, Path::new("/"), &Progress::default()).unwrap();
        for (frame, truth) in document.frames.iter().zip(&cameras) {
            let found = document.ptz_camera(frame).unwrap();
            let off_m = (found.base().position_m - truth.base().position_m).norm();
            assert!(off_m < 2.0, "{off_m} m");
            assert!((found.k1() + 0.35).abs() < 0.02, "{}", found.k1());
            let k1_sigma = found.base().sigma.k1;
            assert!((1e-4..0.02).contains(&k1_sigma), "{k1_sigma}");
        }
    }

    #[test]
    fn each_picture_gets_its_camera_and_a_failure_is_named() {
        let (mut document, cameras) = three_pictures();
        let folder = Path::new("/");
        let found = give_own_cameras(&mut document, folder, &Progress::default())
            .unwrap()
            .unwrap();
        assert_eq!(found.solved, [0, 1]);
        let [(2, error)] = found.failed.as_slice() else {
            panic!("{found:?}");
        };
        assert!(error.to_string().contains("equations"), "{error}");
        let names: Vec<&str> = document
            .cameras
            .iter()
            .map(|camera| camera.id.as_str())
            .collect();
        assert_eq!(names, ["main", "main-1", "main-2"]);
        for (frame, truth) in document.frames.iter().zip(&cameras) {
            let camera = document.ptz_camera(frame).unwrap();
            let centre = truth.plane_from_image(SIZE.centre(), 0.0).unwrap();
            let shown = camera.image_from_world(centre).unwrap();
            assert!(shown.distance_px(SIZE.centre()) < 1.0, "{shown:?}");
            assert_eq!(frame.status, FrameStatus::Suggested);
            let solution = frame.solution.as_ref().unwrap();
            assert!(solution.rms_px.unwrap() < 1.0 && solution.warnings.is_empty());
        }
        assert!(document.frames[2].ptz.is_none());
        // Nothing is left to do.
        let again = give_own_cameras(&mut document, folder, &Progress::default());
        assert_eq!(again.unwrap().unwrap().solved, Vec::<usize>::new());
    }

    #[test]
    fn lines_without_a_base_give_the_camera_of_their_picture() {
        let (document, cameras) = three_pictures();
        let field = soccer();
        for (frame, truth) in document.frames.iter().zip(&cameras) {
            let camera = camera_alone(&document, frame, &field).unwrap();
            let centre = truth.plane_from_image(SIZE.centre(), 0.0).unwrap();
            let shown = camera.image_from_world(centre).unwrap();
            assert!(shown.distance_px(SIZE.centre()) < 1.0, "{shown:?}");
        }
        assert_eq!(camera_alone(&document, &document.frames[2], &field), None);
    }

    #[test]
    fn frames_of_one_camera_with_lines_alone_give_its_base() {
        let field = soccer();
        let base = base_at([3.0, -70.0, 17.0], SIZE);
        let mut document = soccer_document();
        let id = CameraId::from("main");
        document.cameras.push(Camera::new(id.clone(), SIZE).into());
        let mut wide = 0;
        for (pan_deg, tilt_deg, focal_px) in [
            (-28.0, -12.0, 1500.0),
            (-2.0, -13.0, 1300.0),
            (27.0, -12.5, 1700.0),
        ] {
            let camera = base.aim(pan_deg, tilt_deg, focal_px);
            let name = format!("{}.jpg", document.frames.len());
            let mut frame = Frame::from_image(&name, id.clone(), SIZE);
            for line in annotated_lines(&field, &camera, SIZE) {
                let target = Target::Line(field.lines[line.line].id.clone());
                let click = |at| Click::new(target.clone(), at);
                frame.clicks.extend(line.points.into_iter().map(click));
            }
            wide += BaseReadiness::from_frame(&frame).wide;
            document.frames.push(frame.into());
        }
        assert!(wide >= 2, "{wide}");
        let problem = BaseProblem::from_document(document.at(Path::new(".")), &id).unwrap();
        let options = BaseOptions::default();
        let found = problem.estimate(&document, &options, &Progress::default());
        let found = found.unwrap().estimate.base;
        let off_m = (found.position_m - base.position_m).norm();
        assert!(off_m < 0.5, "{off_m} m, stated {:?}", found.sigma);
        // Two lines in each frame are not enough for a start, and it is said what is.
        for frame in &mut document.frames {
            frame.clicks.truncate(4);
        }
        let problem = BaseProblem::from_document(document.at(Path::new(".")), &id).unwrap();
        let error = problem.estimate(&document, &options, &Progress::default());
        let error = error.unwrap_err().to_string();
        assert!(error.contains("two points on as many lines"), "{error}");
    }

    #[test]
    fn a_cancelled_run_changes_nothing() {
        let (mut document, _) = three_pictures();
        let before = document.clone();
        let stop = Progress::new(|()| ControlFlow::Break(()));
        let found = give_own_cameras(&mut document, Path::new("/"), &stop).unwrap();
        assert!(found.is_none() && document == before);
    }
}
