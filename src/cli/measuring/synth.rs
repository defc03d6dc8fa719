//! `touchline synth`: draws a match with exact truth, as a project.

use super::broadcast::draw_broadcast;
use super::drawn_folder::{DrawnFolder, TRUTH_FILE};
use crate::cli::Outcome;
use crate::cli::terminal::messages::Messages;
use crate::cli::terminal::output::write_file;
use anyhow::Context as _;
use std::fs;
use std::path::PathBuf;
use touchline_application::jobs::{DrawnPicture, MatchOrder, draw_match};
use touchline_core::geometry::{ImageSize, pluralise};
use touchline_documents::store::{Location, write_document};
use touchline_vision::synthetic::{
    BROADCAST_FPS, BroadcastOptions, CameraSide, Graphics, Preset, Scene, SceneError, Setting,
    ShootOptions,
};

/// Draws a match: images, a project without calibrations, and the exact truth beside it.
///
/// DIR gets images/0001.jpg and so on, project.json (the camera's base is known, no frame is
/// solved) and truth.json (the same with the exact pan, tilt and focal length of every frame and
/// the boxes of the players). The same options give the same bytes.
///
/// With `--broadcast` DIR gets broadcast.mp4, a match cut together from several cameras with
/// replays, close-ups, spectators and transitions, and truth.json with the exact camera of every
/// frame and the shots. It needs the program ffmpeg.
#[derive(clap::Args, Debug)]
pub struct SynthArgs {
    /// The folder to write; an empty one counts as absent.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// How many frames.
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: u32,
    /// Chooses the stadium, the match and the camera's path.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// What is drawn: stadium, basketball, hockey, tennis, badminton, volleyball, handball or
    /// football (American).
    #[arg(long, default_value = "stadium")]
    scene: Scene,
    /// Where the camera stands: side, end or corner; by default where it usually does.
    #[arg(long, value_name = "PLACE")]
    camera: Option<CameraSide>,
    /// A camera that neither pans, tilts nor zooms, and shows the whole field.
    #[arg(long)]
    still: bool,
    /// The size of the frames, px.
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1280x720", value_parser = image_size)]
    size: ImageSize,
    /// The difficulty of lens, light and sensor: easy, paper or hard.
    #[arg(long, default_value = "paper")]
    preset: Preset,
    /// JPEG quality; the preset's by default.
    #[arg(long, value_name = "1..100", value_parser = clap::value_parser!(u8).range(1..=100))]
    quality: Option<u8>,
    /// Seconds between frames; the preset's by default.
    #[arg(long, value_name = "SECONDS", value_parser = step_s)]
    step: Option<f64>,
    /// Also write the pixels of the players: masks/0001.png and so on.
    #[arg(long)]
    masks: bool,
    /// The broadcaster's graphics, one or more; the camera's masks cover them unless `--unmasked`
    /// is given.
    #[arg(
        long,
        value_name = "GRAPHIC",
        value_enum,
        value_delimiter = ',',
        default_value = "score-bug"
    )]
    graphics: Vec<Graphic>,
    /// Write no masks for the graphics.
    #[arg(long)]
    unmasked: bool,
    /// Draw the demo project that comes with the program: a third of its frames are solved
    /// references.
    #[arg(long, conflicts_with_all = [
        "frames", "seed", "scene", "camera", "still", "preset", "quality", "step", "size", "masks",
        "graphics", "unmasked",
    ])]
    demo: bool,
    /// Draw a broadcast of this many seconds instead of single frames, 25 frames a second.
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u32).range(4..=36_000),
        conflicts_with_all = [
            "frames", "scene", "camera", "still", "quality", "step", "masks", "graphics",
            "unmasked", "demo",
        ])]
    broadcast: Option<u32>,
    /// How many cameras in the stands a broadcast has.
    #[arg(long, value_name = "N", default_value_t = 5, requires = "broadcast",
        value_parser = clap::value_parser!(u8).range(3..=7))]
    cameras: u8,
    /// Draw over an earlier match; files of other names stay.
    #[arg(long)]
    force: bool,
}

/// A graphic over the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Graphic {
    /// No graphics, whatever else is named.
    None,
    /// The score and the clock.
    ScoreBug,
    /// A band with a name and numbers.
    LowerThird,
    /// A channel's half-transparent logo.
    Watermark,
}

/// The match that the arguments describe.
///
/// # Errors
/// The scene has no camera there.
fn order_of(args: &SynthArgs) -> Result<MatchOrder, SceneError> {
    if args.demo {
        return Ok(MatchOrder::demo());
    }
    let preset = args.preset.shoot();
    let shoot = ShootOptions {
        jpeg_quality: args.quality.unwrap_or(preset.jpeg_quality),
        step_s: args.step.unwrap_or(preset.step_s),
        is_still: args.still,
        ..preset
    };
    let (frames, seed, image_size, masks) =
        (args.frames as usize, args.seed, args.size, args.masks);
    let shows =
        |graphic| args.graphics.contains(&graphic) && !args.graphics.contains(&Graphic::None);
    // The list has a default, so that an empty one cannot be written: `none` takes its place.
    let graphics = Graphics {
        score_bug: shows(Graphic::ScoreBug),
        lower_third: shows(Graphic::LowerThird),
        watermark: shows(Graphic::Watermark),
        ..Graphics::NONE
    };
    Ok(MatchOrder {
        frames,
        seed,
        setting: Setting::new(args.scene, args.camera)?,
        image_size,
        shoot,
        masks,
        graphics,
        unmasked: args.unmasked,
        references: 0.0,
    })
}

/// Draws the match and writes its pictures, its project and its truth.
///
/// # Errors
/// The folder has other content and `--force` was not given, or a file cannot be written.
pub fn synth(args: &SynthArgs, messages: Messages) -> anyhow::Result<Outcome> {
    if let Some(seconds) = args.broadcast {
        let options = BroadcastOptions {
            seed: args.seed,
            frames: (f64::from(seconds) * BROADCAST_FPS) as usize,
            cameras: usize::from(args.cameras),
            image_size: args.size,
            shoot: args.preset.shoot(),
        };
        return draw_broadcast(&args.output, args.force, &options, messages);
    }
    let order = order_of(args)?;
    let folder = DrawnFolder::begin(&args.output, args.force)?;
    fs::create_dir_all(args.output.join("images"))
        .with_context(|| format!("cannot make {}", args.output.display()))?;
    let progress = messages.progress(order.frames, "Drawing frames");
    let drawn = draw_match(&order, &mut |picture: DrawnPicture| -> anyhow::Result<()> {
        write_file(&args.output.join(&picture.image), &picture.jpeg, args.force)?;
        if let Some((mask, png)) = &picture.mask {
            fs::create_dir_all(args.output.join("masks"))
                .with_context(|| format!("cannot make {}", args.output.join("masks").display()))?;
            write_file(&args.output.join(mask), png, args.force)?;
        }
        progress.inc(1);
        Ok(())
    })?;
    progress.finish_and_clear();
    // The truth is written first. It marks the folder as one that this command may draw over.
    folder.write_truth(&drawn.truth)?;
    let location = Location::for_new_document(&args.output.join(""))?;
    write_document(&location, &drawn.project, args.force)?;
    folder.finish()?;
    messages.note(&format!(
        "{}: {}, the truth in {TRUTH_FILE}",
        location.file().display(),
        pluralise(order.frames, "frame")
    ));
    Ok(Outcome::Done)
}

fn image_size(text: &str) -> Result<ImageSize, String> {
    let sides = text
        .split_once('x')
        .and_then(|(width, height)| Some((side_px(width)?, side_px(height)?)));
    let (width, height) = sides.ok_or_else(|| {
        format!("{text:?} is not a size; write it like 1280x720, both from 16 to 8192")
    })?;
    Ok(ImageSize::new(width, height))
}

/// The length of a side of a picture, px; none where it is no number or out of range.
fn side_px(digits: &str) -> Option<u32> {
    digits
        .parse::<u32>()
        .ok()
        .filter(|side| (16..=8192).contains(side))
}

fn step_s(text: &str) -> Result<f64, String> {
    let step = text
        .parse::<f64>()
        .ok()
        .filter(|step| *step > 0.0 && *step <= 3600.0);
    step.ok_or_else(|| format!("{text:?} is not a time; give seconds above 0, up to 3600"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_steps_are_checked_with_a_way_out() {
        assert_eq!(image_size("640x360"), Ok(ImageSize::new(640, 360)));
        for wrong in [
            "640",
            "640x",
            "x",
            "0x0",
            "640x-1",
            "99999x9",
            "640 x 360",
            "NaNx3",
        ] {
            assert!(
                image_size(wrong)
                    .unwrap_err()
                    .contains("write it like 1280x720"),
                "{wrong}"
            );
        }
        assert_eq!(step_s("0.04"), Ok(0.04));
        for wrong in ["0", "-1", "NaN", "inf", "soon"] {
            assert!(step_s(wrong).is_err(), "{wrong}");
        }
    }
}
