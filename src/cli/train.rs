//! `touchline train`: trains the pan-tilt forest on a document's references.

use super::Outcome;
use crate::cli::terminal::document::{DocumentArg, Loaded};
use crate::cli::terminal::features::{FeaturesArg, report_refusal};
use crate::cli::terminal::messages::{Messages, count_steps};
use crate::cli::terminal::output::{refuse_existing_file, write_file};
use anyhow::ensure;
use clap::ValueEnum;
use std::ops::ControlFlow;
use std::path::PathBuf;
use touchline_calibration::proposals::{
    FramePictures, LearnOptions, TrainingFrames, WRONG_PX, learn, measure, study,
};
use touchline_core::geometry::pluralise;
use touchline_core::progress::{Progress, Share};
use touchline_vision::features::{Detector, FeatureOptions};
use touchline_vision::media::FrameReader;
use touchline_vision::relocalize::{RelocalizeOptions, TrainOptions, TrainProgress};

/// Trains the pan-tilt forest on the frames that people accepted.
#[derive(clap::Args, Debug)]
pub struct TrainArgs {
    #[command(flatten)]
    document: DocumentArg,
    #[command(flatten)]
    kept: FeaturesArg,
    /// The forest to write.
    #[arg(short, long, value_name = "FOREST")]
    output: PathBuf,
    /// Also train with accepted suggestions of the forest and of tracking.
    #[arg(long)]
    all_references: bool,
    /// The settings of the paper: 5 trees of 30 references, depth 20, 6 dimensions with 10
    /// thresholds each, leaves that are means. Options given with it take precedence.
    #[arg(long)]
    published: bool,
    /// Trees; 3 by default.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    trees: Option<u32>,
    /// The longest way from the root of a tree to a leaf; 64 by default.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    max_depth: Option<u32>,
    /// Descriptor dimensions tried at a split; 2 by default.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=128))]
    dimensions: Option<u32>,
    /// References drawn for each tree; all by default.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    frames_per_tree: Option<u32>,
    /// Features per picture at most.
    #[arg(long, value_name = "N", default_value_t = FeatureOptions::default().max_count, value_parser = clap::value_parser!(u32).range(20..=100_000))]
    features: u32,
    /// Wider pictures are reduced by the smallest whole factor that brings them to this width, px;
    /// every picture is looked at in half of it first, if that is 400 px or more.
    #[arg(long, value_name = "PX", default_value_t = FeatureOptions::default().max_width_px, value_parser = clap::value_parser!(u32).range(160..=16_384))]
    max_width: u32,
    /// `RootSIFT` instead of plain SIFT.
    #[arg(long)]
    root_sift: bool,
    /// What finds features; the forest remembers it.
    #[arg(long, value_enum, default_value_t = DetectorArg::Sift)]
    detector: DetectorArg,
    /// The seed of all random numbers; the same seed gives the same forest.
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// Replace an existing file.
    #[arg(long)]
    force: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum DetectorArg {
    /// As in the paper.
    Sift,
    /// Corners and bits: faster, for comparison.
    Orb,
    /// Bits from a non-linear scale space, for comparison.
    Akaze,
}

/// Trains a forest, measures it by leaving references out, and writes it. [`Outcome::SomeFailed`]
/// if a reference could not be used.
///
/// # Errors
/// The document cannot be read or has no usable references, or the forest cannot be written.
pub fn train(args: &TrainArgs, messages: Messages) -> anyhow::Result<Outcome> {
    refuse_existing_file(&args.output, args.force)?;
    let Loaded { location, document } = args.document.load(messages)?;
    let options = args.options();
    let training_frames = TrainingFrames::from_document(&document, args.all_references);
    ensure!(
        !training_frames.frames.is_empty(),
        "{}: there are no references to train with; accept solved frames first",
        location.file().display()
    );
    messages.name_video_backend(&document);
    let store = args.kept.store(Some(location.file()));
    let pictures = FramePictures::new(&document, location.folder(), options.features, &store);
    // Find features in the references.
    let bar = messages.progress(training_frames.frames.len(), "Finding features");
    let studied = study(
        &pictures,
        &mut FrameReader::new(),
        &training_frames.frames,
        &count_steps(&bar),
    );
    bar.finish_and_clear();
    // None would mean that the progress cancelled it, and this one never does.
    let studied = studied.unwrap_or_default();
    report_refusal(&store, messages);
    let failed = studied.failed.iter();
    messages.frames_failed(failed.map(|(index, error)| (document.frames[*index].name(), error)));
    ensure!(
        studied
            .training_samples
            .iter()
            .any(|sample| !sample.fine.rays.is_empty()),
        "{}: no reference gave features to train with",
        location.file().display()
    );
    let bar = messages.progress(0, "Training");
    let training = Progress::new(|progress: TrainProgress| {
        bar.set_length(progress.total as u64);
        bar.set_position(progress.placed as u64);
        ControlFlow::Continue(())
    });
    let model = learn(&document, &studied, &options, &training);
    bar.finish_and_clear();
    let mut model = model?;
    // Measure the forest, and lower its stated probabilities if certain answers were wrong.
    let bar = messages.progress(0, "Solving references left out");
    let asking = Progress::new(|progress: Share| {
        bar.set_length(progress.of as u64);
        bar.set_position(progress.done as u64);
        ControlFlow::Continue(())
    });
    let (references, relocalizing) = (&training_frames.frames, RelocalizeOptions::default());
    let quality = measure(
        &pictures,
        &mut FrameReader::new(),
        references,
        &options,
        &relocalizing,
        &asking,
    );
    bar.finish_and_clear();
    // None where no group of references can be left out. The stated probabilities then stay as they
    // are.
    if let Some(quality) = &quality {
        quality.bound(&document, &mut model);
        messages.note(&format!(
            "{} left out and tested: {} found, {} of them off by over {WRONG_PX} px",
            pluralise(quality.tested.len(), "reference"),
            quality.found_count(),
            quality.wrong().count()
        ));
    }
    // Written last, for the measurement changes the probabilities that the file states.
    write_file(&args.output, &model.to_bytes(), args.force)?;
    let cameras = model.cameras.iter();
    let references: usize = cameras
        .clone()
        .map(|camera| camera.seen.references as usize)
        .sum();
    let leaves: usize = cameras.map(|camera| camera.forest.leaves()).sum();
    messages.note(&format!(
        "{}: {}, {leaves} leaves",
        args.output.display(),
        pluralise(references, "reference")
    ));
    for found in &studied.burnt_in {
        messages.note(&found.describe(&document));
    }
    if training_frames.withheld > 0 {
        messages.note(&format!(
            "{} not used for training: accepted suggestions (--all-references takes them, too), \
             frames with the verdict Wrong, or left out by hand",
            pluralise(training_frames.withheld, "reference")
        ));
    }
    Ok(Outcome::from_failure(!studied.failed.is_empty()))
}

impl TrainArgs {
    fn options(&self) -> LearnOptions {
        // The paper's settings are those of the trees alone; features have options of their own.
        let usual = if self.published {
            TrainOptions::from_paper()
        } else {
            TrainOptions::default()
        };
        LearnOptions {
            features: FeatureOptions {
                max_count: self.features,
                max_width_px: self.max_width,
                root_sift: self.root_sift,
                detector: match self.detector {
                    DetectorArg::Sift => Detector::Sift,
                    DetectorArg::Orb => Detector::Orb,
                    DetectorArg::Akaze => Detector::Akaze,
                },
            },
            train: TrainOptions {
                trees: self.trees.unwrap_or(usual.trees),
                max_depth: self.max_depth.unwrap_or(usual.max_depth),
                dimensions: self.dimensions.unwrap_or(usual.dimensions),
                frames_per_tree: self.frames_per_tree.or(usual.frames_per_tree),
                seed: self.seed,
                ..usual
            },
        }
    }
}
