//! `touchline export --dataset`: writes a folder with frames, labels, pictures and a dataset card.

use super::Outcome;
use crate::cli::terminal::by_name::value_by_name;
use crate::cli::terminal::interrupt::Interrupt;
use crate::cli::terminal::messages::Messages;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser as _};
use std::path::PathBuf;
use touchline_core::geometry::pluralise;
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::{DocumentAt, FrameStatus};
use touchline_documents::exchange::{
    DatasetOptions, ExchangeError, FrameChoice, PictureFormat, Pictures, Split, SplitBy, Splitting,
    plan_dataset, write_dataset as write,
};
use touchline_vision::media::FrameReader;

/// The options of a dataset.
#[derive(clap::Args, Debug)]
#[command(next_help_heading = "Dataset")]
pub struct DatasetArgs {
    /// Write a dataset into this folder: references (or what --status names) with pictures, a card,
    /// a table of frames, a manifest.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["format", "output"])]
    dataset: Option<PathBuf>,
    /// Where its pictures come from: copies of the image files, hard links to them, frames decoded
    /// from the video, or none.
    #[arg(long, default_value = "copy", value_parser = value_by_name::<Pictures>())]
    #[arg(requires = "dataset")]
    images: Pictures,
    /// How decoded pictures are written.
    #[arg(long, default_value = "png", value_parser = picture_format(), requires = "dataset")]
    image_format: String,
    /// Also take pictures that lie outside the project's folder. They are listed: another person's
    /// project may refer to any file.
    #[arg(long, requires = "dataset")]
    outside_pictures: bool,
    /// Shares of training, validation and test, such as 80/10/10; without it there are no splits.
    #[arg(long, value_name = "SHARES", value_parser = parse_shares, requires = "dataset")]
    split: Option<[u32; 3]>,
    /// What a split never divides.
    #[arg(long, default_value = "clip", value_parser = value_by_name::<SplitBy>())]
    #[arg(requires = "split")]
    split_by: SplitBy,
    /// Another seed gives another split.
    #[arg(long, default_value_t = 0, requires = "split")]
    seed: u64,
    /// The licence of labels and pictures, for the card.
    #[arg(long, value_name = "TEXT", requires = "dataset")]
    licence: Option<String>,
}

/// A parser for `png` and `jpeg`, which may be written `jpg`.
fn picture_format() -> impl clap::builder::TypedValueParser<Value = String> {
    PossibleValuesParser::new([
        PossibleValue::new("png"),
        PossibleValue::new("jpeg").alias("jpg"),
    ])
    .map(|name| name)
}

/// Parses shares of training, validation and test such as `80/10/10`.
fn parse_shares(text: &str) -> Result<[u32; 3], String> {
    let shares: Option<Vec<u32>> = text
        .split('/')
        .map(|share| share.parse().ok().filter(|share| *share <= 1000))
        .collect();
    let shares: Option<[u32; 3]> = shares.and_then(|shares| shares.try_into().ok());
    let shares = shares.filter(|shares| shares.iter().sum::<u32>() > 0);
    shares.ok_or_else(|| {
        format!("{text} is no shares of training, validation and test such as 80/10/10")
    })
}

impl DatasetArgs {
    fn options(&self, mut frames: FrameChoice, undistorted: bool) -> DatasetOptions {
        // A dataset has what people accepted, unless --status names other frames.
        if frames.statuses.is_empty() {
            frames.statuses.push(FrameStatus::Reference);
        }
        DatasetOptions {
            frames,
            pictures: self.images,
            picture_format: if self.image_format.starts_with("jp") {
                PictureFormat::Jpeg
            } else {
                PictureFormat::Png
            },
            undistorted,
            outside: self.outside_pictures,
            splitting: self.split.map(|shares| Splitting {
                shares,
                by: self.split_by,
                seed: self.seed,
            }),
            licence: self.licence.clone(),
        }
    }
}

/// Writes a dataset. [`Outcome::SomeFailed`] if frames had to be left out.
///
/// # Errors
/// No frame is left, two pictures have the same name, or something cannot be written. Nothing is
/// left behind then.
pub fn write_dataset(
    at: DocumentAt<'_>,
    args: &DatasetArgs,
    frames: FrameChoice,
    undistorted: bool,
    force: bool,
    messages: Messages,
) -> anyhow::Result<Outcome> {
    let Some(folder) = &args.dataset else {
        anyhow::bail!("give --format or --dataset")
    };
    let options = args.options(frames, undistorted);
    let plan = plan_dataset(at, &options)?;
    messages.notes(&plan.notes);
    let interrupt = Interrupt::listen();
    let bar = messages.progress(plan.pictures(), "pictures");
    let progress = Progress::new(|pictures: Share| {
        bar.set_position(pictures.done as u64);
        interrupt.check()
    });
    let done = write(
        at,
        &plan,
        &options,
        &mut FrameReader::new(),
        folder,
        force,
        &progress,
    );
    bar.finish_and_clear();
    let done = match done {
        // Nothing was written: a half dataset would pass for a small one.
        Err(stopped @ ExchangeError::Stopped) => {
            messages.note(&stopped.to_string());
            return Ok(Outcome::Stopped);
        }
        done => done?,
    };
    messages.frames_failed(done.left_out.iter().map(|(frame, why)| (frame, why)));
    let counts = if options.splitting.is_some() {
        let counts = Split::ALL
            .into_iter()
            .zip(done.counts)
            .map(|(split, count)| format!("{split} {count}"));
        format!(" ({})", counts.collect::<Vec<_>>().join(", "))
    } else {
        String::new()
    };
    messages.note(&format!(
        "{}{counts} and {} in {}",
        pluralise(done.frames, "frame"),
        pluralise(done.pictures, "picture"),
        folder.display()
    ));
    Ok(Outcome::from_failure(!done.left_out.is_empty()))
}
