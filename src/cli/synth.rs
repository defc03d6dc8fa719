//! `touchline synth`: a drawn match with exact truth, as a project.

use super::Outcome;
use super::messages::Messages;
use super::output::{refuse_existing, write_file};
use crate::calibrate::{FrameLookup, calibrate};
use crate::camera::{CameraBase, FocalCurve, PtzCamera};
use crate::document::{
    Camera, CameraId, Click, Document, FieldSpec, Frame, FramePtz, FrameStatus, Target, document_to_string,
};
use crate::field::{FieldModel, builtin};
use crate::geometry::{ImageSize, PixelBox};
use crate::media::sha256_of_file;
use crate::store::{Location, write_document};
use crate::synthetic::{
    ClickOptions, ClickTarget, FrameOptions, Graphics, Mover, PathStep, Preset, RenderedFrame, ShootOptions, Side,
    Stadium, StadiumOptions, camera_path, drawn_clicks, stadium,
};
use anyhow::{Context as _, ensure};
use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ImageFormat};
use serde_json::{Value, json};
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// The file beside the project that holds what is true.
const TRUTH_FILE: &str = "truth.json";
/// How far a mask reaches beyond the score graphic, px.
const MASK_MARGIN_PX: f64 = 4.0;

/// How many landmarks the demo's annotator clicks, from reference to reference: two are enough, more are a check.
const LANDMARKS_A_REFERENCE: [usize; 6] = [4, 2, 3, 6, 2, 5];

/// Draws a match: images, a project without calibrations, and the exact truth beside it.
///
/// DIR gets images/0001.jpg and so on, project.json (the camera's base is known, no frame is solved) and truth.json (the
/// same with the exact pan, tilt and focal length of every frame and the boxes of the players). The same options give the
/// same bytes.
#[derive(clap::Args, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a flag of the command line")]
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
    /// What is drawn.
    #[arg(long, value_enum, default_value_t)]
    scene: Scene,
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
    /// The broadcaster's graphics, one or more; the camera's masks cover them unless `--unmasked` is given.
    #[arg(long, value_name = "GRAPHIC", value_enum, value_delimiter = ',', default_value = "score-bug")]
    graphics: Vec<Graphic>,
    /// Write no masks for the graphics.
    #[arg(long)]
    unmasked: bool,
    /// Draw the demo project that comes with the program: a third of its frames are solved references.
    #[arg(long, conflicts_with_all = ["frames", "seed", "preset", "quality", "step", "size", "masks", "graphics", "unmasked"])]
    demo: bool,
    /// Replace files that exist; files of other names stay.
    #[arg(long)]
    force: bool,
}

/// A scene that can be drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
enum Scene {
    /// A football match in a stadium.
    #[default]
    Stadium,
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

/// Everything that decides what is drawn.
struct Order {
    frames: usize,
    seed: u64,
    image_size: ImageSize,
    shoot: ShootOptions,
    masks: bool,
    graphics: Graphics,
    /// The camera's masks do not cover the graphics.
    unmasked: bool,
    /// The share of frames that are clicked and solved.
    references: f64,
}

impl Order {
    fn of(args: &SynthArgs) -> Self {
        if args.demo {
            return Self::demo();
        }
        let preset = args.preset.shoot();
        let shoot = ShootOptions {
            jpeg_quality: args.quality.unwrap_or(preset.jpeg_quality),
            step_s: args.step.unwrap_or(preset.step_s),
            ..preset
        };
        let (frames, seed, image_size, masks) = (args.frames as usize, args.seed, args.size, args.masks);
        let shows = |graphic| args.graphics.contains(&graphic) && !args.graphics.contains(&Graphic::None);
        let graphics = Graphics {
            score_bug: shows(Graphic::ScoreBug),
            lower_third: shows(Graphic::LowerThird),
            watermark: shows(Graphic::Watermark),
            ..Graphics::NONE
        };
        Self { frames, seed, image_size, shoot, masks, graphics, unmasked: args.unmasked, references: 0.0 }
    }

    /// The committed demo: a lens that a person sees bending, an ordinary sensor, frames some seconds apart.
    fn demo() -> Self {
        let shoot = ShootOptions {
            step_s: 4.7,
            focal_px_at_1280: [1200.0, 3200.0],
            distortion_at_1280: FocalCurve { at_focal_px: 1500.0, value: -0.03, per_1000_px: 0.08, ..FocalCurve::NONE },
            noise_levels: 0.7,
            jpeg_quality: 76,
            ..Preset::Paper.shoot()
        };
        let image_size = ImageSize::new(1280, 720);
        let graphics = Graphics::default();
        Self { frames: 27, seed: 5, image_size, shoot, masks: false, graphics, unmasked: false, references: 1.0 / 3.0 }
    }
}

/// Carries out the command.
///
/// # Errors
/// The folder holds something already and `--force` was not given, or a file cannot be written.
pub fn synth(args: &SynthArgs, messages: Messages) -> anyhow::Result<Outcome> {
    let Scene::Stadium = args.scene;
    refuse_existing(&args.output, args.force)?;
    ensure!(
        args.output.is_dir() || !args.output.exists(),
        "{} is a file; give a folder for the match",
        args.output.display()
    );
    let order = Order::of(args);
    let spec = FieldSpec::new("soccer");
    let field = builtin(&spec.template)?.default_model()?;
    let scene = stadium(&StadiumOptions { daylight: order.shoot.daylight, ..StadiumOptions::new(field, order.seed) });
    let base = order.shoot.main_camera(order.image_size);
    let mut project = Document::new(spec);
    let masked = if order.unmasked { Graphics::NONE } else { order.graphics };
    project.cameras.push(main_camera(&base, order.image_size, masked).into());
    let mut truth = project.clone();

    fs::create_dir_all(args.output.join("images")).with_context(|| format!("cannot make {}", args.output.display()))?;
    let path = camera_path(&scene, &base, order.image_size, &order.shoot, order.frames);
    let mut references = 0;
    let progress = messages.progress(path.len(), "Drawing frames");
    for (index, step) in path.iter().enumerate() {
        let options = order.shoot.frame(index, step, order.image_size, order.seed);
        let options = FrameOptions { graphics: order.graphics, ..options };
        let camera = PtzCamera::new(base, step.ptz);
        let drawn = scene.render(&camera, order.image_size, &options);
        let image = format!("images/{:04}.jpg", index + 1);
        let file = args.output.join(&image);
        write_file(&file, &jpeg(&drawn, order.shoot.jpeg_quality)?, args.force)?;
        if order.masks {
            write_mask(&args.output, index, &drawn, args.force)?;
        }
        let mut frame = Frame::from_image(&image, CameraId::from("main"), order.image_size);
        frame.sha256 = Some(sha256_of_file(&file)?);
        truth.frames.push(true_frame(&frame, &camera, step, &drawn).into());
        let due = order.references * (index + 1) as f64 > f64::from(references);
        if due && solve_as_reference(&mut frame, &project, &scene, &camera, &drawn, index) {
            references += 1;
        }
        project.frames.push(frame.into());
        progress.inc(1);
    }
    progress.finish_and_clear();
    write_file(&args.output.join(TRUTH_FILE), document_to_string(&truth)?.as_bytes(), args.force)?;
    let location = Location::for_new_document(&args.output.join(""))?;
    write_document(&location, &project, args.force)?;
    messages.note(&format!("{}: {} frames, the truth in {TRUTH_FILE}", location.file().display(), order.frames));
    Ok(Outcome::Done)
}

fn main_camera(base: &CameraBase, image_size: ImageSize, masked: Graphics) -> Camera {
    let mut camera = Camera::new(CameraId::from("main"), image_size);
    camera.set_base(base);
    let with_margin = |graphic: PixelBox| PixelBox {
        x: (graphic.x - MASK_MARGIN_PX).floor().max(0.0),
        y: (graphic.y - MASK_MARGIN_PX).floor().max(0.0),
        width: (graphic.width + 2.0 * MASK_MARGIN_PX).ceil(),
        height: (graphic.height + 2.0 * MASK_MARGIN_PX).ceil(),
    };
    camera.masks = masked.boxes(image_size, 0.0).into_iter().map(with_margin).collect();
    camera
}

/// The frame as it is: the exact camera, the players' boxes, and who they are under `truth`.
fn true_frame(frame: &Frame, camera: &PtzCamera, step: &PathStep, drawn: &RenderedFrame) -> Frame {
    let mut frame = frame.clone();
    frame.status = FrameStatus::Reference;
    frame.ptz = Some(FramePtz::new(camera.ptz(), Some(camera.lens())));
    frame.masks = drawn.movers.iter().map(|mover| mover.area).collect();
    let movers: Vec<Value> = drawn.movers.iter().map(|mover| json!(mover_name(mover.mover))).collect();
    frame.extra.insert("truth".to_owned(), json!({ "time_s": step.time_s, "masks": movers }));
    frame
}

fn mover_name(mover: Mover) -> &'static str {
    match mover {
        Mover::Person(Side::Home) => "home",
        Mover::Person(Side::Away) => "away",
        Mover::Person(Side::HomeKeeper) => "home_keeper",
        Mover::Person(Side::AwayKeeper) => "away_keeper",
        Mover::Person(Side::Official) => "official",
        Mover::Ball => "ball",
    }
}

/// Clicks a frame as a person would and accepts what the clicks give; false where too little of the field is in view.
fn solve_as_reference(
    frame: &mut Frame,
    project: &Document,
    scene: &Stadium,
    camera: &PtzCamera,
    drawn: &RenderedFrame,
    index: usize,
) -> bool {
    let field: &FieldModel = scene.field();
    let hidden: Vec<PixelBox> =
        drawn.movers.iter().map(|mover| mover.area).chain(drawn.graphics.iter().copied()).collect();
    let options = ClickOptions {
        landmarks: LANDMARKS_A_REFERENCE[index / 3 % LANDMARKS_A_REFERENCE.len()],
        lines: usize::from(index % 4 == 3),
        sigma_px: 1.0,
        seed: index as u64,
    };
    let mut clicked = frame.clone();
    clicked.clicks = drawn_clicks(field, camera, frame.image_size, &hidden, &options)
        .into_iter()
        .map(|click| match click.target {
            ClickTarget::Landmark(id) => Click::new(Target::Landmark(id), click.image),
            ClickTarget::Line(id) => Click::new(Target::Line(id), click.image),
        })
        .collect();
    let Ok(solved) = calibrate(project, &FrameLookup::default(), &clicked, field, project.frames.len()) else {
        return false;
    };
    clicked.record(&solved);
    clicked.status = FrameStatus::Reference;
    *frame = clicked;
    true
}

fn jpeg(drawn: &RenderedFrame, quality: u8) -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, quality).encode_image(&drawn.image)?;
    Ok(bytes)
}

fn write_mask(folder: &Path, index: usize, drawn: &RenderedFrame, force: bool) -> anyhow::Result<()> {
    let mut bytes = Cursor::new(Vec::new());
    DynamicImage::from(drawn.mover_mask.clone()).write_to(&mut bytes, ImageFormat::Png)?;
    let masks = folder.join("masks");
    fs::create_dir_all(&masks).with_context(|| format!("cannot make {}", masks.display()))?;
    write_file(&masks.join(format!("{:04}.png", index + 1)), bytes.get_ref(), force)
}

fn image_size(text: &str) -> Result<ImageSize, String> {
    let wrong = || format!("{text:?} is not a size; write it like 1280x720, both from 16 to 8192");
    let (width, height) = text.split_once('x').ok_or_else(wrong)?;
    let side = |digits: &str| digits.parse::<u32>().ok().filter(|side| (16..=8192).contains(side)).ok_or_else(wrong);
    Ok(ImageSize::new(side(width)?, side(height)?))
}

fn step_s(text: &str) -> Result<f64, String> {
    let step = text.parse::<f64>().ok().filter(|step| *step > 0.0 && *step <= 3600.0);
    step.ok_or_else(|| format!("{text:?} is not a time; give seconds above 0, up to 3600"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_steps_are_checked_with_a_way_out() {
        assert_eq!(image_size("640x360"), Ok(ImageSize::new(640, 360)));
        for wrong in ["640", "640x", "x", "0x0", "640x-1", "99999x9", "640 x 360", "NaNx3"] {
            assert!(image_size(wrong).unwrap_err().contains("write it like 1280x720"), "{wrong}");
        }
        assert_eq!(step_s("0.04"), Ok(0.04));
        for wrong in ["0", "-1", "NaN", "inf", "soon"] {
            assert!(step_s(wrong).is_err(), "{wrong}");
        }
    }
}
