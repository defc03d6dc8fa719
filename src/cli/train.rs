//! `touchline train`: the pan-tilt forest from a document's references.

use super::Outcome;
use super::document::{DocumentArg, Loaded};
use super::messages::Messages;
use super::output::{refuse_existing, write_file};
use super::pictures::with_features;
use crate::camera::{PanTilt, Ptz, PtzCamera};
use crate::features::{Descriptor, FeatureOptions};
use crate::project::{self, Document, Frame, FrameStatus};
use crate::relocalize::{self, CameraForest, ForestModel, Samples, SeenRange, TrainOptions};
use anyhow::{Context as _, ensure};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Trains the pan-tilt forest on the frames that people accepted.
#[derive(clap::Args, Debug)]
pub struct TrainArgs {
    #[command(flatten)]
    document: DocumentArg,
    /// The forest to write.
    #[arg(short, long, value_name = "FOREST")]
    output: PathBuf,
    /// Learn from accepted suggestions of the forest and of tracking, too.
    #[arg(long)]
    all_references: bool,
    /// Trees.
    #[arg(long, value_name = "N", default_value_t = TrainOptions::default().trees, value_parser = clap::value_parser!(u32).range(1..=64))]
    trees: u32,
    /// The longest way from the root of a tree to a leaf.
    #[arg(long, value_name = "N", default_value_t = TrainOptions::default().max_depth, value_parser = clap::value_parser!(u32).range(1..=64))]
    max_depth: u32,
    /// References drawn for each tree; all by default.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    frames_per_tree: Option<u32>,
    /// Features per picture at most.
    #[arg(long, value_name = "N", default_value_t = FeatureOptions::default().max_count, value_parser = clap::value_parser!(u32).range(20..=100_000))]
    features: u32,
    /// Wider pictures are reduced by the smallest whole factor that brings them to this width, px.
    #[arg(long, value_name = "PX", default_value_t = FeatureOptions::default().max_width_px, value_parser = clap::value_parser!(u32).range(160..=16_384))]
    max_width: u32,
    /// `RootSIFT` instead of plain SIFT.
    #[arg(long)]
    root_sift: bool,
    /// Where chance starts; the same seed gives the same forest.
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// Replace an existing file.
    #[arg(long)]
    force: bool,
}

/// Carries out the command.
///
/// # Errors
/// The document cannot be read or has no references to learn from, or the forest cannot be written.
pub fn train(args: &TrainArgs, messages: Messages) -> anyhow::Result<Outcome> {
    refuse_existing(&args.output, args.force)?;
    let Loaded { location, document } = args.document.load(messages)?;
    let features = FeatureOptions { max_count: args.features, max_width_px: args.max_width, root_sift: args.root_sift };
    let teachers: Vec<usize> =
        (0..document.frames.len()).filter(|&index| learns_from(&document.frames[index], args.all_references)).collect();
    ensure!(
        !teachers.is_empty(),
        "{}: there are no references to learn from; accept solved frames first",
        location.file().display()
    );
    let bar = messages.progress(teachers.len(), "Finding features");
    let lessons = with_features(&document, location.folder(), &teachers, &features, |frame, found| {
        let lesson = found.and_then(|found| {
            let camera = camera_of(&document, frame)?;
            let rays = found.features.keypoints.iter().map(|keypoint| camera.ray_from_image(keypoint.point));
            let pairs = rays.zip(&found.features.descriptors);
            let taught = pairs.filter_map(|(ray, descriptor)| Some((*descriptor, ray.ok()?))).collect();
            Ok(Lesson { ptz: camera.ptz(), taught })
        });
        bar.inc(1);
        lesson
    });
    bar.finish_and_clear();
    let mut failed = 0;
    let mut learnt = Vec::new();
    for (&index, lesson) in teachers.iter().zip(lessons) {
        let frame = &document.frames[index];
        match lesson {
            Ok(lesson) => learnt.push((frame.camera.as_str(), lesson)),
            Err(error) => {
                failed += 1;
                messages.frame_failed(&frame.name(), &format!("{error:#}"));
            }
        }
    }
    let options = TrainOptions {
        trees: args.trees,
        max_depth: args.max_depth,
        frames_per_tree: args.frames_per_tree,
        seed: args.seed,
        ..TrainOptions::default()
    };
    let cameras = forests(&document, &learnt, &options, messages)?;
    ensure!(!cameras.is_empty(), "{}: no reference gave features to learn from", location.file().display());
    let model = ForestModel { document: without_frames(&document)?, features, cameras };
    write_file(&args.output, &model.to_bytes(), args.force)?;
    let count = |of: fn(&CameraForest) -> usize| model.cameras.iter().map(of).sum::<usize>();
    messages.note(&format!(
        "{}: {} references, {} leaves",
        args.output.display(),
        count(|camera| camera.seen.references as usize),
        count(|camera| camera.forest.leaves())
    ));
    Ok(if failed > 0 { Outcome::SomeFailed } else { Outcome::Done })
}

/// What one reference teaches.
struct Lesson {
    ptz: Ptz,
    taught: Vec<(Descriptor, PanTilt)>,
}

/// Whether the forest learns from a frame; with `all_references` from accepted suggestions, too.
fn learns_from(frame: &Frame, all_references: bool) -> bool {
    frame.teaches() || all_references && frame.status == FrameStatus::Reference && frame.is_suggestion()
}

fn camera_of(document: &Document, frame: &Frame) -> anyhow::Result<PtzCamera> {
    let camera =
        document.camera_of(frame).with_context(|| format!("camera {:?} is not in the document", frame.camera))?;
    camera.base().with_context(|| format!("camera {:?} has no position or base rotation", camera.id.as_str()))?;
    camera.pointed(frame).context("this reference has no `ptz`; run `touchline solve` first")
}

/// A forest for each camera with references, in the document's order.
fn forests(
    document: &Document,
    learnt: &[(&str, Lesson)],
    options: &TrainOptions,
    messages: Messages,
) -> anyhow::Result<Vec<CameraForest>> {
    let mut made = Vec::new();
    for camera in &document.cameras {
        let lessons = || learnt.iter().filter(|(id, lesson)| *id == camera.id.as_str() && !lesson.taught.is_empty());
        let seen: Vec<Ptz> = lessons().map(|(_, lesson)| lesson.ptz).collect();
        let Some(seen) = SeenRange::of(&seen) else { continue };
        let mut samples = Samples::new();
        for (_, lesson) in lessons() {
            samples.add_frame(lesson.taught.iter().copied());
        }
        let bar = messages.progress(samples.len() * options.trees as usize, "Training");
        let forest = relocalize::train(&samples, options, &|progress| {
            bar.set_length(progress.total as u64);
            bar.set_position(progress.placed as u64);
            ControlFlow::Continue(())
        })?;
        bar.finish_and_clear();
        made.push(CameraForest { camera: camera.id.as_str().to_owned(), seen, forest });
    }
    Ok(made)
}

/// The document's field and cameras as JSON. A template of the user's own is kept by its file name: a forest holds no
/// paths.
fn without_frames(document: &Document) -> anyhow::Result<String> {
    let mut kept = Document { frames: Vec::new(), extra: project::Extra::new(), ..document.clone() };
    let of_cameras = kept.cameras.iter_mut().filter_map(|camera| camera.field.is_some().then(|| &mut **camera));
    for field in of_cameras.filter_map(|camera| camera.field.as_mut()).chain([&mut kept.field]) {
        if field.is_file()
            && let Some(name) = Path::new(&field.template).file_name()
        {
            field.template = name.to_string_lossy().into_owned();
        }
    }
    Ok(project::document_to_string(&kept)?)
}
