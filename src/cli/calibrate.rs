//! `touchline calibrate`: a project with its camera, from frames alone.

use super::Outcome;
use super::messages::Messages;
use super::new::parameter;
use super::other_cameras::split_off;
use super::output::{refuse_existing, write_file};
use super::rest::answer_the_rest;
use anyhow::{Context as _, ensure};
use image::DynamicImage;
use std::collections::BTreeSet;
use std::io::Cursor;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use touchline_application::scene::paint_map::{PaintMapFrame, PaintMapScene, paint_map_picture};
use touchline_calibration::autocalibrate::{
    DecidingLandmark, UnclickedAnswer, UnclickedProgress, camera_without_clicks,
};
use touchline_calibration::calibrate::{UnclickedCamera, describe_size, record_found};
use touchline_calibration::proposals::{PictureError, read_picture};
use touchline_documents::document::{CameraId, Document, DocumentAt, FieldSize, FieldSpec, document_from_frames};
use touchline_documents::store;
use touchline_documents::store::Location;
use touchline_vision::media::{FrameReader, FrameSource};

/// Makes a project from a folder of images or a video and finds its camera without a click: where it stands, its lens, and
/// each frame's pan, tilt and focal length, as suggestions. The frames that were not looked at follow from those that were.
#[derive(clap::Args, Debug)]
pub struct CalibrateArgs {
    /// The folder of images, or the video.
    #[arg(value_name = "FRAMES_OR_VIDEO")]
    frames: PathBuf,
    /// The project's folder; made if absent.
    #[arg(short, long, value_name = "PROJECT")]
    output: PathBuf,
    /// The field's template (`touchline fields` lists them).
    #[arg(long, value_name = "TEMPLATE", default_value = "soccer")]
    field: String,
    /// A parameter of the field, such as `length_m=105`; may be given several times. The field's size is then taken as known;
    /// else length and width are fitted where the usual size does not explain the paint.
    #[arg(long = "set", value_name = "NAME=NUMBER", value_parser = parameter)]
    set: Vec<(String, f64)>,
    /// The camera is found from this many frames at most, spread over all of them.
    #[arg(long, value_name = "N", default_value_t = 40, value_parser = clap::value_parser!(u32).range(3..=300))]
    look_at: u32,
    /// Also write a picture of what was found: the paint that stays while the camera turns, over pan and tilt, and the field's lines
    /// as the base has them. Where they fall together the base is right.
    #[arg(long, value_name = "FILE.png")]
    panorama: Option<PathBuf>,
    /// Answer only the frames that are looked at. Else a video's other frames are carried from them, and other images are asked of
    /// a forest that learns from them.
    #[arg(long)]
    found_only: bool,
    /// Make the project although the folder holds something; a project in it is kept as project.json.bak.
    #[arg(long)]
    force: bool,
}

/// Carries out the command.
///
/// # Errors
/// The folder exists, the field is not valid, the frames cannot be read, or the result cannot be written.
pub fn calibrate(args: &CalibrateArgs, messages: Messages) -> anyhow::Result<Outcome> {
    refuse_existing(&args.output, args.force)?;
    store::refuse_open(&args.output)?;
    ensure!(
        args.output.is_dir() || !args.output.exists(),
        "{} is a file; give a folder for the project",
        args.output.display()
    );
    if let Some(panorama) = &args.panorama {
        let is_png = panorama.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
        ensure!(is_png, "--panorama {}: a PNG is written, so its name must end with .png", panorama.display());
        refuse_existing(panorama, args.force)?;
    }
    let mut field = FieldSpec::new(&args.field);
    ensure!(!field.is_file(), "{}: calibrate takes the templates that are built in", args.field);
    field.params = args.set.iter().cloned().collect();
    if !field.params.is_empty() {
        field.size = Some(FieldSize::Confirmed);
    }
    field.model(Path::new(""))?;
    let source = FrameSource::open(&args.frames)?;
    for notice in source.notices() {
        messages.note(&notice.to_string());
    }
    ensure!(!source.is_empty(), "{} holds no image", args.frames.display());
    let folder = std::path::absolute(&args.output)?;
    let new_folder = NewFolder::make(&folder)?;
    let made = document_from_frames(&source, &folder, field, NonZeroUsize::MIN, &|| {});
    for (name, error) in &made.left_out {
        messages.frame_failed(name, &error.to_string());
    }
    let mut document = made.document;
    let camera = document.cameras.first().context("not one image can be read")?.id.clone();
    let found = look_for(&document.at(&folder), &camera, args.look_at as usize, messages)?;
    let found = match found {
        UnclickedAnswer::Found(found) => found,
        UnclickedAnswer::Two { best, other, deciding } => {
            return Ok(say_no_answer(args, &two_answers(&document, &best, &other, deciding.as_ref()), messages));
        }
        UnclickedAnswer::Abstained(why) => return Ok(say_no_answer(args, &why.to_string(), messages)),
    };
    record_found(&mut document, &camera, &found);
    say(&found, messages);
    let all = with_others(&mut document, &folder, (camera, *found), args.look_at as usize, messages)?;
    let rest = if args.found_only { (0, 0) } else { answer_the_rest(&mut document, &folder, &all, messages)? };
    let location = Location::for_new_document(&folder.join(""))?;
    touchline_documents::store::write_document(&location, &document, args.force)?;
    new_folder.keep();
    messages.note(&format!(
        "{}: {} frames, {} with a suggested camera, {} of them snapped to the painted lines",
        location.file().display(),
        document.frames.len(),
        all.iter().map(|found| found.frames.len()).sum::<usize>(),
        all.iter().map(UnclickedCamera::snapped_count).sum::<usize>(),
    ));
    if rest != (0, 0) {
        messages.note(&format!("of the other frames {} got a suggested camera, {} none", rest.0, rest.1));
    }
    if let Some(panorama) = &args.panorama {
        for (number, found) in all.iter().enumerate() {
            write_file(&numbered(panorama, number), &panorama_png(&document, found)?, args.force)?;
        }
    }
    Ok(if made.left_out.is_empty() && rest.1 == 0 { Outcome::Done } else { Outcome::SomeFailed })
}

/// Says why no camera is found. Nothing is wrong with the input or its use: nothing is written, and the exit code is 1.
fn say_no_answer(args: &CalibrateArgs, why: &str, messages: Messages) -> Outcome {
    messages.error(&format!("{}: {why}", args.frames.display()));
    Outcome::SomeFailed
}

/// The camera that was found, and those of the frames that hang together with none of its frames: each becomes a camera of its own,
/// with a search of its own.
fn with_others(
    document: &mut Document,
    folder: &Path,
    (camera, found): (CameraId, UnclickedCamera),
    look_at: usize,
    messages: Messages,
) -> anyhow::Result<Vec<UnclickedCamera>> {
    let mut all = vec![found];
    let mut of = camera;
    while let Some(last) = all.last() {
        let looked_at: Vec<usize> = last.frames.iter().map(|frame| frame.index).collect();
        let Some(other) = split_off(document, &of, &looked_at, &last.others) else { break };
        let count = last.others.len();
        match look_for(&document.at(folder), &other, look_at, messages)? {
            UnclickedAnswer::Found(found) => {
                messages.note(&format!("{count} frames are of another camera, {other}:"));
                record_found(document, &other, &found);
                say(&found, messages);
                all.push(*found);
                of = other;
            }
            UnclickedAnswer::Two { best, other: rival, deciding } => {
                let says = two_answers(document, &best, &rival, deciding.as_ref());
                messages.note(&format!("{count} frames are of another camera, {other}: {says}"));
                break;
            }
            UnclickedAnswer::Abstained(why) => {
                messages.note(&format!("{count} frames are of another camera, {other}: {why}"));
                break;
            }
        }
    }
    Ok(all)
}

/// The file of a camera's panorama: the first one's as named, the others' with their numbers.
fn numbered(panorama: &Path, number: usize) -> PathBuf {
    if number == 0 {
        return panorama.to_path_buf();
    }
    let stem = panorama.file_stem().unwrap_or_default().to_string_lossy();
    panorama.with_file_name(format!("{stem}_{}.png", number + 1))
}

/// The picture of what was found.
fn panorama_png(document: &Document, found: &UnclickedCamera) -> anyhow::Result<Vec<u8>> {
    let frames: Vec<_> =
        found.frames.iter().map(|frame| (frame.ptz, document.frames[frame.index].image_size)).collect();
    let scene = PaintMapScene { base: &found.base, field: &found.field, frames: &frames, paint: &found.paint };
    let picture = PaintMapFrame::of(&scene).and_then(|frame| paint_map_picture(&scene, &frame));
    let picture = picture.context("there is no frame for a panorama")?;
    let size = picture.size();
    let image = image::RgbaImage::from_raw(size.width, size.height, picture.rgba().to_vec());
    let mut png = Cursor::new(Vec::new());
    let image = DynamicImage::from(image.context("a panorama without pixels")?).to_rgb8();
    image.write_to(&mut png, image::ImageFormat::Png).context("cannot encode the PNG")?;
    Ok(png.into_inner())
}

/// A folder for the project; frames are named from it, so it has to be there while they are read. One that was made and stays
/// without a project goes again.
struct NewFolder(Option<PathBuf>);

impl NewFolder {
    fn make(folder: &Path) -> anyhow::Result<Self> {
        let made = !folder.exists();
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
        Ok(Self(made.then(|| folder.to_path_buf())))
    }

    fn keep(mut self) {
        self.0 = None;
    }
}

impl Drop for NewFolder {
    fn drop(&mut self) {
        if let Some(folder) = &self.0 {
            // It is removed only if it is empty; else it stays.
            let _ = std::fs::remove_dir(folder);
        }
    }
}

/// The search with a bar for each of its steps.
fn look_for(
    document: &DocumentAt<'_>,
    camera: &CameraId,
    look_at: usize,
    messages: Messages,
) -> anyhow::Result<UnclickedAnswer> {
    const PARTS: usize = 1000;
    let bar = messages.progress(PARTS, "Finding the camera");
    let mut reader = FrameReader::new();
    let mut failed = BTreeSet::new();
    let mut picture = |index: usize| {
        let frame = &document.frames[index];
        let told = |error: &PictureError| {
            if failed.insert(index) {
                messages.frame_failed(&frame.name(), &error.to_string());
            }
        };
        read_picture(&mut reader, frame, document.folder).inspect_err(told).ok()
    };
    let watch = |progress: UnclickedProgress| {
        bar.set_message(progress.to_string());
        bar.set_position((progress.share_of_step() * PARTS as f64) as u64);
        ControlFlow::Continue(())
    };
    let found = camera_without_clicks(*document, camera, look_at, &mut picture, &watch);
    bar.finish_and_clear();
    Ok(found?)
}

/// Two answers in words, and the click that decides between them.
fn two_answers(
    document: &Document,
    best: &UnclickedCamera,
    other: &UnclickedCamera,
    deciding: Option<&DecidingLandmark>,
) -> String {
    let at = |found: &UnclickedCamera| {
        let at = found.base.position_m;
        format!("({:.1}, {:.1}, {:.1}) m", at.x, at.y, at.z)
    };
    let click = deciding.map_or_else(
        || "click 4 landmarks on 2 frames".to_owned(),
        |deciding| {
            let frame = document.frames[deciding.frame].name();
            let [here, there] = deciding.image.map(|image| format!("({:.0}, {:.0})", image.x, image.y));
            format!("one click decides: {} on {frame} is at {here} or at {there} px", deciding.landmark.as_str())
        },
    );
    format!("two places for the camera explain the paint, {} and {}, so none is given; {click}", at(best), at(other))
}

/// What was found and what speaks for it.
fn say(found: &UnclickedCamera, messages: Messages) {
    for size in &found.sizes {
        messages.note(&describe_size(size));
    }
    let (at, sigma, evidence) = (found.base.position_m, found.base.sigma.position_m, &found.evidence);
    messages.note(&format!(
        "position ({:.2}, {:.2}, {:.2}) ± ({:.2}, {:.2}, {:.2}) m, crown {:.2} m",
        at.x, at.y, at.z, sigma.x, sigma.y, sigma.z, found.field.crown_m
    ));
    messages.note(&format!(
        "{} frames; {:.0} % of the paint explained, {:.0} % of the lines seen ({} by name), next best answer {:.0} % of this \
         one, paint {:.2} px off its lines, parts of the frames {:.2} m apart",
        evidence.frames,
        100.0 * evidence.explained,
        100.0 * evidence.visible,
        evidence.lines.len(),
        100.0 * evidence.rival / evidence.score(),
        evidence.residual_px,
        evidence.parts_m,
    ));
}
