//! `touchline relocalize`: cameras of frames that nobody clicked, from a trained forest.

use super::Outcome;
use super::document::{DocumentArg, DocumentOutput, Loaded};
use super::messages::Messages;
use super::output::write_file;
use super::pictures::{FrameFeatures, with_features};
use crate::camera::CameraBase;
use crate::media::{FrameSource, image_size};
use crate::project::{
    self, Camera, Document, FieldSpec, Frame, FramePtz, FrameStatus, Solution, SolutionSource, SolutionWarning,
    document_from_bytes, path_between,
};
use crate::relocalize::{ForestModel, Pose, PoseOptions, RelocalizeOptions, Relocalized, relocalize as relocalized};
use anyhow::{Context as _, bail, ensure};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Finds the cameras of frames that nobody clicked, from a trained forest.
#[derive(clap::Args, Debug)]
pub struct RelocalizeArgs {
    /// The forest that `touchline train` wrote.
    #[arg(value_name = "FOREST")]
    forest: PathBuf,
    /// A document whose new frames are to be answered, or images, or folders of images.
    #[arg(value_name = "DOC_OR_IMAGES", required = true)]
    inputs: Vec<PathBuf>,
    #[command(flatten)]
    output: DocumentOutput,
    /// Answers that are right with less than this probability are not given.
    #[arg(long, value_name = "0..1", default_value_t = PoseOptions::default().min_confidence, value_parser = probability)]
    min_confidence: f64,
    /// Leaves examined in each tree.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=4096))]
    leaves: u32,
    /// Where chance starts; the same seed gives the same answers.
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
}

fn probability(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("a probability is a number from 0 to 1".to_owned()),
    }
}

/// Carries out the command.
///
/// # Errors
/// The forest or the input cannot be read, the cameras' bases differ, or the result cannot be written.
pub fn relocalize(args: &RelocalizeArgs, messages: Messages) -> anyhow::Result<Outcome> {
    args.output.refuse_existing()?;
    let bytes = std::fs::read(&args.forest).with_context(|| format!("cannot read {}", args.forest.display()))?;
    let model = ForestModel::from_bytes(&bytes).with_context(|| args.forest.display().to_string())?;
    let taught = document_from_bytes(model.document.as_bytes()).with_context(|| args.forest.display().to_string())?;
    let Input { mut document, folder, skipped } = read_input(args, taught.clone(), messages)?;
    adopt_bases(&mut document, &taught, &model)?;
    let asked: Vec<usize> = (0..document.frames.len()).filter(|&index| is_open(&document.frames[index])).collect();
    let mut options = RelocalizeOptions::default();
    options.predict.leaves_per_tree = args.leaves;
    options.pose.min_confidence = args.min_confidence;
    options.pose.seed = args.seed;
    let bar = messages.progress(asked.len(), "Relocalizing");
    let answers = with_features(&document, &folder, &asked, &model.features, |frame, found| {
        let answer = found.and_then(|found| answer(&document, &model, frame, &found, &options));
        bar.inc(1);
        answer
    });
    bar.finish_and_clear();
    let mut answered = 0;
    for (&index, answer) in asked.iter().zip(answers) {
        let frame = &mut document.frames[index];
        let reason = match answer {
            Ok(answer) => record(frame, answer),
            Err(error) => {
                forget(frame);
                Some(format!("{error:#}"))
            }
        };
        match reason {
            None => answered += 1,
            Some(reason) => messages.frame_failed(&frame.name(), &reason),
        }
    }
    write(&args.output, &document, &folder)?;
    let (failed, passed) = (asked.len() - answered + skipped, document.frames.len() - asked.len());
    messages.note(&format!("{answered} frames answered, {failed} not, {passed} with clicks or accepted, as they were"));
    Ok(if failed > 0 { Outcome::SomeFailed } else { Outcome::Done })
}

/// What the frames to be answered are.
struct Input {
    document: Document,
    /// Where relative paths start.
    folder: PathBuf,
    /// Images that could not be read.
    skipped: usize,
}

/// A document, or images as a document with the forest's cameras.
fn read_input(args: &RelocalizeArgs, taught: Document, messages: Messages) -> anyhow::Result<Input> {
    if let [path] = &args.inputs[..]
        && is_document(path)
    {
        let Loaded { location, document } = DocumentArg { document: path.clone() }.load(messages)?;
        return Ok(Input { document, folder: location.folder().to_path_buf(), skipped: 0 });
    }
    ensure!(
        !taught.field.is_file()
            && !taught.cameras.iter().any(|camera| camera.field.as_ref().is_some_and(FieldSpec::is_file)),
        "the forest's field is a template file of your own, which images do not bring along; relocalize a document"
    );
    let folder = std::env::current_dir()?;
    let mut input = Input { document: taught, folder: folder.canonicalize().unwrap_or(folder), skipped: 0 };
    for path in &args.inputs {
        ensure!(!is_document(path), "{} is a document; give it alone, or give images", path.display());
        let listed = if path.is_dir() { images_of(path)? } else { vec![path.clone()] };
        ensure!(!listed.is_empty(), "{} holds no image", path.display());
        for image in listed {
            if let Err(error) = add_image(&mut input, &image) {
                input.skipped += 1;
                messages.frame_failed(&image.display().to_string(), &format!("{error:#}"));
            }
        }
    }
    ensure!(!input.document.frames.is_empty(), "none of the images can be read");
    Ok(input)
}

/// A project folder, or a JSON file.
fn is_document(path: &Path) -> bool {
    path.join(project::PROJECT_FILE).is_file() || path.extension().is_some_and(|end| end.eq_ignore_ascii_case("json"))
}

fn images_of(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let source = FrameSource::open(folder)?;
    let frames = (0..source.len()).filter_map(|index| source.frame(index));
    Ok(frames.map(|frame| frame.path().to_path_buf()).collect())
}

/// A new frame for an image, of the camera whose pictures have its size.
fn add_image(input: &mut Input, path: &Path) -> anyhow::Result<()> {
    let size = image_size(path)?;
    let camera = input.document.cameras.iter().find(|camera| camera.image_size == size);
    let camera = camera.with_context(|| {
        format!("{} × {} px, and the forest knows no camera with pictures of this size", size.width, size.height)
    })?;
    let name = path_between(&input.folder, &path.canonicalize()?);
    let frame = Frame::from_image(&name, camera.id.clone(), size);
    input.document.frames.push(frame.into());
    Ok(())
}

/// How far numbers of a base may differ, m and px: digits that were rounded when a document was written.
const SAME_BASE: f64 = 1e-6;

/// Cameras without a base take over the forest's; one with another base makes the forest useless.
fn adopt_bases(document: &mut Document, taught: &Document, model: &ForestModel) -> anyhow::Result<()> {
    for forest in &model.cameras {
        let id = forest.camera.as_str().into();
        let known = taught.camera(&id).and_then(Camera::base);
        let known =
            known.with_context(|| format!("the forest does not hold the base of its camera {}", forest.camera))?;
        let Some(camera) = document.camera_mut(&id) else { continue };
        match camera.base() {
            None => camera.set_base(&known),
            Some(base) if differs(&base, &known) => bail!(
                "camera {}: its position, rotation, principal point or lens is not the one that the forest was trained with; \
                 train the forest again",
                forest.camera
            ),
            Some(_) => {}
        }
    }
    Ok(())
}

fn differs(one: &CameraBase, other: &CameraBase) -> bool {
    let lens = |base: &CameraBase, focal_px: f64| base.distortion.at(focal_px);
    (one.position_m - other.position_m).amax() > SAME_BASE
        || (one.base_from_world - other.base_from_world).amax() > SAME_BASE
        || one.principal_point.distance_px(other.principal_point) > SAME_BASE
        || [1000.0, 5000.0].iter().any(|&focal_px| (lens(one, focal_px) - lens(other, focal_px)).abs() > SAME_BASE)
}

/// Whether nobody has clicked or accepted a frame: those are answered, all others stay as they are.
fn is_open(frame: &Frame) -> bool {
    frame.clicks.is_empty() && matches!(frame.status, FrameStatus::New | FrameStatus::Suggested)
}

/// What became of a frame.
struct Answer {
    relocalized: Relocalized,
    features_time: Duration,
    k1: Option<f64>,
}

fn answer(
    document: &Document,
    model: &ForestModel,
    frame: &Frame,
    found: &FrameFeatures,
    options: &RelocalizeOptions,
) -> anyhow::Result<Answer> {
    let forest = model.camera(frame.camera.as_str());
    let forest =
        forest.with_context(|| format!("the forest has no references of camera {:?}", frame.camera.as_str()))?;
    let base = document.camera_of(frame).and_then(Camera::base).context("its camera has no base")?;
    let relocalized = relocalized(&found.features, &forest.forest, &forest.seen, &base, options);
    let k1 = relocalized.pose.as_ref().ok().map(|pose| base.distortion.at(pose.ptz.focal_px));
    Ok(Answer { relocalized, features_time: found.time, k1: k1.filter(|k1| *k1 != 0.0) })
}

/// Takes an answer over; the reason, where there is none.
fn record(frame: &mut Frame, answer: Answer) -> Option<String> {
    forget(frame);
    let Answer { relocalized: Relocalized { pose, predict_time, pose_time }, features_time, k1 } = answer;
    let milliseconds = |time: Duration| (time.as_secs_f64() * 1e6).round() / 1e3;
    let timings = serde_json::json!({
        "features": milliseconds(features_time),
        "predict": milliseconds(predict_time),
        "pose": milliseconds(pose_time),
    });
    let mut solution = Solution { source: Some(SolutionSource::Forest), ..Solution::default() };
    solution.extra.insert("timings_ms".to_owned(), timings);
    let reason = match pose {
        Ok(pose) => {
            frame.ptz = Some(FramePtz::new(pose.ptz, k1));
            frame.status = FrameStatus::Suggested;
            take_over(&mut solution, &pose);
            None
        }
        Err(reason) => {
            solution.warnings.push(SolutionWarning::new(reason.code(), reason.to_string()));
            Some(reason.to_string())
        }
    };
    frame.solution = Some(solution);
    reason
}

fn take_over(solution: &mut Solution, pose: &Pose) {
    solution.covariance = Some(pose.covariance);
    solution.rms_px = Some(pose.rms_px);
    solution.worst_corner_sigma_px = Some(pose.worst_corner_sigma_px);
    solution.confidence = Some(pose.confidence);
}

/// Drops what an earlier run suggested.
fn forget(frame: &mut Frame) {
    frame.ptz = None;
    frame.solution = None;
    frame.status = FrameStatus::New;
}

/// Writes the document, or its frames a line each where the name ends with `.jsonl`.
fn write(output: &DocumentOutput, document: &Document, folder: &Path) -> anyhow::Result<()> {
    let Some(path) = output.output.as_deref().filter(|path| path.extension().is_some_and(|end| end == "jsonl")) else {
        return output.write(document, folder);
    };
    let parent = std::path::absolute(path)?.parent().map(Path::to_path_buf).unwrap_or_default();
    let moved = document.relocated(folder, &parent.canonicalize().unwrap_or(parent));
    let mut lines = String::new();
    for frame in &moved.frames {
        lines.push_str(&serde_json::to_string(&**frame)?);
        lines.push('\n');
    }
    write_file(path, lines.as_bytes(), output.force)
}
