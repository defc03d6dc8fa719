//! `touchline relocalize`: finds the cameras of unclicked frames with a trained forest.

use super::Outcome;
use crate::cli::terminal::document::{
    Destination, DocumentOutput, Loaded, is_document, refuse_unwritable,
};
use crate::cli::terminal::features::{FeaturesArg, report_refusal};
use crate::cli::terminal::interrupt::Interrupt;
use crate::cli::terminal::messages::Messages;
use crate::cli::terminal::output::{ending, write_file};
use anyhow::{Context as _, anyhow, ensure};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use touchline_application::app::where_to_label::where_to_label;
use touchline_calibration::pipelines::{ForestRequest, PictureFiles, label_frames};
use touchline_calibration::proposals::{
    CameraOfSizeError, Coverage, KeyWindow, TrainingFrames, adopt_bases, camera_of_size,
    label_advice,
};
use touchline_core::files::{folder_of, read_named};
use touchline_core::geometry::pluralise;
use touchline_core::progress::Progress;
use touchline_documents::document::{
    Document, DocumentAt, FieldSpec, Frame, FrameStatus, document_from_bytes,
    frames_in_transitions, path_between, resolve_path,
};
use touchline_vision::media::{FrameReader, FrameSource, image_size};
use touchline_vision::relocalize::{ForestModel, PoseOptions, PredictOptions, RelocalizeOptions};

/// Maximum size of a forest's file, bytes.
const MAX_FOREST_BYTES: u64 = 8 << 30;

/// Finds the cameras of frames without clicks, from a trained forest.
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
    #[command(flatten)]
    kept: FeaturesArg,
    /// The least confidence of an answer, from 0 to 1.
    #[arg(long, value_name = "0..1", default_value_t = PoseOptions::default().min_confidence, value_parser = probability)]
    min_confidence: f64,
    /// Pull each answer onto the painted lines, where they decide.
    #[arg(long)]
    snap: bool,
    /// Leave frames that are answered already as they are: to go on where an earlier run was
    /// stopped.
    #[arg(long)]
    resume: bool,
    /// Of videos, answer only key frames, a second apart; `touchline track` then finds the cameras
    /// of the frames between.
    #[arg(long)]
    key_frames: bool,
    /// Leaves examined in each tree.
    #[arg(long, value_name = "N", default_value_t = PredictOptions::default().leaves_per_tree, value_parser = clap::value_parser!(u32).range(1..=4096))]
    leaves: u32,
    /// Also write how long each frame took (`solution.timings_ms`). Two runs then differ in these
    /// numbers.
    #[arg(long)]
    timings: bool,
    /// The seed of all random numbers; the same seed gives the same answers.
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
}

/// Parses a probability.
pub(super) fn probability(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("a probability is a number from 0 to 1".to_owned()),
    }
}

/// Queries the forest and writes the document. [`Outcome::SomeFailed`] if a frame got no camera,
/// [`Outcome::Stopped`] after Ctrl-C.
///
/// # Errors
/// The forest or the input cannot be read, a camera's base differs from the forest's, or the result
/// cannot be written.
pub fn relocalize(args: &RelocalizeArgs, messages: Messages) -> anyhow::Result<Outcome> {
    let output = reserve(args, messages)?;
    let interrupt = Interrupt::listen();
    ensure!(
        !args.forest.is_dir(),
        "{} is a folder, and the forest comes first: touchline relocalize FOREST DOC",
        args.forest.display()
    );
    let bytes = read_named(&args.forest, MAX_FOREST_BYTES)
        .with_context(|| format!("cannot read {}", args.forest.display()))?;
    let model =
        ForestModel::from_bytes(&bytes).with_context(|| args.forest.display().to_string())?;
    let taught = document_from_bytes(model.document.as_bytes())
        .with_context(|| args.forest.display().to_string())?;
    let Input {
        mut document,
        file,
        folder,
        skipped,
    } = read_input(args, &model, taught.clone(), &output)?;
    // The forest's rays are pan and tilt in the base of its training. A document without a base
    // takes that one; under another one its answers would be wrong, which is an error.
    adopt_bases(&mut document, &taught, &model)?;
    messages.name_video_backend(&document);
    let before = document.clone();
    // Choose the frames: undecided ones, with `--resume` without an answer, with `--key-frames` not
    // between key frames; never those between two shots, which show two pictures or none.
    let is_between_shots = frames_in_transitions(&document);
    let mut queried: Vec<usize> = (0..document.frames.len())
        .filter(|&index| {
            let frame = &document.frames[index];
            frame.is_open() && !is_between_shots[index] && !(args.resume && is_answered(frame))
        })
        .collect();
    if args.key_frames {
        let windows = KeyWindow::from_document(document.at(&folder));
        let between: BTreeSet<usize> = windows
            .into_iter()
            .flat_map(|window| window.between)
            .collect();
        queried.retain(|index| !between.contains(index));
    }
    let options = RelocalizeOptions {
        predict: PredictOptions {
            leaves_per_tree: args.leaves,
            ..PredictOptions::default()
        },
        pose: PoseOptions {
            min_confidence: args.min_confidence,
            seed: args.seed,
            ..PoseOptions::default()
        },
    };
    let store = args.kept.store(file.as_deref());
    let files = PictureFiles {
        folder: &folder,
        store: &store,
    };
    let forest = ForestRequest {
        model: &model,
        generation: 0,
        options,
    };
    let bar = messages.progress(queried.len(), "Relocalizing");
    let progress = Progress::new(|done: usize| {
        bar.set_position(done as u64);
        interrupt.check()
    });
    let mut reader = FrameReader::new();
    let proposals = label_frames(
        &mut document,
        files,
        &mut reader,
        &queried,
        &forest,
        args.snap,
        &progress,
    );
    bar.finish_and_clear();
    report_refusal(&store, messages);
    let proposals = proposals?;
    // Count the answers. A frame without an answer keeps a camera that it has from another source.
    // Ctrl-C leaves fewer proposals than frames.
    let looked_at = proposals.len();
    let (mut answered, mut kept) = (0, 0);
    let mut without_answer = Vec::new();
    for proposal in &proposals {
        let Some(frame) = document.frames.by_id_mut(&proposal.frame) else {
            continue;
        };
        match &proposal.outcome {
            Ok(_) => answered += 1,
            Err(_) if frame.ptz.is_some() => {
                kept += 1;
                continue;
            }
            Err(reason) => without_answer.push((frame.name(), reason)),
        }
        // Without the times, two runs write the same bytes.
        if let Some(solution) = frame.solution.as_mut().filter(|_| !args.timings) {
            solution.timings_ms = None;
        }
    }
    messages.frames_failed(without_answer);
    document.count_edits_since(&before);
    write(&args.output, output, document.clone(), &folder)?;
    // Stopped early: `--resume` continues with what has been written.
    if looked_at < queried.len() {
        let kept = args.output.output.as_ref().map_or_else(
            || "standard output".to_owned(),
            |path| path.display().to_string(),
        );
        // Lines of frames are no document that this command reads.
        let way_on = match &args.output.output {
            Some(path) if is_lines_file(path) => "",
            _ => ". Give that document with --resume for the rest",
        };
        messages.note(&format!(
            "stopped: {looked_at} of {} were looked at, {answered} answered; they are in \
             {kept}{way_on}",
            pluralise(queried.len(), "frame")
        ));
        return Ok(Outcome::Stopped);
    }
    // Not after Ctrl-C: the answers to the other frames may change the advice.
    report_where_to_label(document.at(&folder), messages);
    // Every queried frame has a proposal here, with a camera or a reason, so that this is the
    // number of reasons without a camera of another source, and of unreadable images.
    let failed = queried.len() - answered - kept + skipped;
    let passed = document.frames.len() - queried.len() + kept;
    let why_passed = if args.key_frames {
        "no key frames, with clicks, or accepted"
    } else {
        "with clicks, or accepted"
    };
    if kept > 0 {
        messages.note(&format!(
            "{} keep the camera that they have: it comes from no forest, and the forest's is no better",
            pluralise(kept, "frame")
        ));
    }
    messages.note(&format!(
        "{} answered, {failed} not, {passed} left unchanged ({why_passed})",
        pluralise(answered, "frame")
    ));
    Ok(Outcome::from_failure(failed > 0))
}

/// Whether an earlier run has answered a frame.
fn is_answered(frame: &Frame) -> bool {
    frame.status == FrameStatus::Suggested && frame.ptz.is_some()
}

/// Reports which frame to label next. If a camera has no references in this document, the advice
/// names no uncovered direction: the forest may have been trained on another document.
fn report_where_to_label(document: DocumentAt<'_>, messages: Messages) {
    let coverage = Coverage::measure_cameras(
        document,
        &TrainingFrames::from_solved_frames(&document).frames,
    );
    let advice = label_advice(&document, &coverage);
    if let Some(said) = where_to_label(&advice, |frame| document.frames[frame].name()) {
        messages.note(&said);
    }
}

/// The frames to be answered.
struct Input {
    document: Document,
    /// The document's file. `None` for images.
    file: Option<PathBuf>,
    /// The folder from which relative paths start.
    folder: PathBuf,
    /// Number of images that cannot be read.
    skipped: usize,
}

/// Reads a document, or images as new frames of the forest's document.
fn read_input(
    args: &RelocalizeArgs,
    model: &ForestModel,
    taught: Document,
    output: &Destination,
) -> anyhow::Result<Input> {
    if let [path] = &args.inputs[..]
        && is_document(path)
    {
        let Loaded { location, document } = output.read(path)?;
        let file = Some(location.file().to_path_buf());
        return Ok(Input {
            document,
            file,
            folder: location.folder().to_path_buf(),
            skipped: 0,
        });
    }
    // Images become frames of the forest's document, with its cameras and field.
    ensure!(
        !taught.field.is_file()
            && !taught
                .cameras
                .iter()
                .any(|camera| camera.field.as_ref().is_some_and(FieldSpec::is_file)),
        "the forest's field is a template file of your own; images do not name it, so relocalize a document"
    );
    let folder = std::env::current_dir()?;
    let mut input = Input {
        document: taught,
        file: None,
        // `add_image` names images by their canonical paths relative to this folder.
        folder: folder.canonicalize().unwrap_or(folder),
        skipped: 0,
    };
    for path in &args.inputs {
        ensure!(
            !is_document(path),
            "{} is a document; give it alone, or give images",
            path.display()
        );
        let listed = if path.is_dir() {
            images_of(path)?
        } else {
            vec![path.clone()]
        };
        ensure!(!listed.is_empty(), "{} holds no image", path.display());
        for image in listed {
            if let Err(error) = add_image(&mut input, model, &image) {
                input.skipped += 1;
                output
                    .messages
                    .frame_failed(&image.display().to_string(), &format!("{error:#}"));
            }
        }
    }
    ensure!(
        !input.document.frames.is_empty(),
        "none of the images can be read"
    );
    Ok(input)
}

fn images_of(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let source = FrameSource::open(folder)?;
    let frames = (0..source.len()).filter_map(|index| source.frame(index));
    Ok(frames.map(|frame| frame.path().to_path_buf()).collect())
}

/// Appends a frame for an image, with the camera that has pictures of its size.
fn add_image(input: &mut Input, model: &ForestModel, path: &Path) -> anyhow::Result<()> {
    let size = image_size(path)?;
    let camera = camera_of_size(&input.document, model, size).map_err(|error| match error {
        CameraOfSizeError::Several { .. } => anyhow!("{error}: relocalize a document"),
        CameraOfSizeError::Missing { .. } => error.into(),
    })?;
    let name = path_between(&input.folder, &path.canonicalize()?);
    let frame = Frame::from_image(&name, camera.id.clone(), size);
    input.document.frames.push(frame.into());
    Ok(())
}

/// Whether a path is that of a file of frames, one per line.
fn is_lines_file(path: &Path) -> bool {
    ending(path) == "jsonl"
}

/// Checks where the result goes, and locks a document there.
fn reserve(args: &RelocalizeArgs, messages: Messages) -> anyhow::Result<Destination> {
    // A file of frames is no document.
    if args.output.output.as_deref().is_some_and(is_lines_file) {
        args.output.refuse_for_export()?;
        return DocumentOutput::default().reserve("relocalize", &[], messages);
    }
    let inputs: Vec<&Path> = args.inputs.iter().map(PathBuf::as_path).collect();
    args.output.reserve("relocalize", &inputs, messages)
}

/// Writes the document; to a `.jsonl` file its frames, one per line.
fn write(
    output: &DocumentOutput,
    destination: Destination,
    document: Document,
    folder: &Path,
) -> anyhow::Result<()> {
    let Some(path) = output.output.as_deref().filter(|path| is_lines_file(path)) else {
        return destination.write(document, folder);
    };
    let parent = resolve_path(folder_of(path));
    let moved = document.relocate(folder, &parent);
    refuse_unwritable(&moved, &parent)?;
    let mut lines = String::new();
    for frame in &moved.frames {
        lines.push_str(&serde_json::to_string(&**frame)?);
        lines.push('\n');
    }
    write_file(path, lines.as_bytes(), output.force)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::testing::{new_frame, soccer_document};

    #[test]
    fn lines_of_frames_name_no_picture_that_cannot_be_found() {
        let folder = tempfile::tempdir().unwrap();
        let output = DocumentOutput {
            output: Some(folder.path().join("out.JSONL")),
            force: false,
        };
        let written = |image: &str| {
            let mut document = soccer_document();
            let frame = new_frame(image, ImageSize::new(64, 36));
            document.frames.push(frame.into());
            let destination =
                DocumentOutput::default().reserve("relocalize", &[], Messages::Text)?;
            write(&output, destination, document, folder.path())
        };
        let refused = written("clip-\u{fffd}/1.jpg").unwrap_err().to_string();
        assert!(refused.contains("is not UTF-8"), "{refused}");
        written("clip/1.jpg").unwrap();
        let text = std::fs::read_to_string(folder.path().join("out.JSONL")).unwrap();
        assert_eq!(text.lines().count(), 1, "{text}");
    }
}
