//! `touchline calibrate`: a project with its camera, from frames alone.

use super::Outcome;
use super::messages::Messages;
use super::new::parameter;
use super::output::refuse_existing;
use crate::calibrate::{
    DecidingLandmark, UnclickedAnswer, UnclickedCamera, UnclickedProgress, camera_without_clicks, describe_size,
    record_found,
};
use crate::document::{CameraId, Document, DocumentAt, FieldSize, FieldSpec, document_from_frames};
use crate::media::{FrameReader, FrameSource};
use crate::proposals::{PictureError, read_picture};
use crate::store::Location;
use anyhow::{Context as _, bail, ensure};
use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Makes a project from a folder of images or a video and finds its camera without a click: where it stands, its lens, and
/// each frame's pan, tilt and focal length, as suggestions.
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
    /// Make the project although the folder holds something; a project in it is kept as project.json.bak.
    #[arg(long)]
    force: bool,
}

/// Carries out the command.
///
/// # Errors
/// The folder exists, the field is not valid, the frames cannot be read, or no camera is found with certainty.
pub fn calibrate(args: &CalibrateArgs, messages: Messages) -> anyhow::Result<Outcome> {
    refuse_existing(&args.output, args.force)?;
    ensure!(
        args.output.is_dir() || !args.output.exists(),
        "{} is a file; give a folder for the project",
        args.output.display()
    );
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
            bail!("{}: {}", args.frames.display(), two_answers(&document, &best, &other, deciding.as_ref()))
        }
        UnclickedAnswer::Abstained(why) => bail!("{}: {why}", args.frames.display()),
    };
    record_found(&mut document, &camera, &found);
    say(&found, messages);
    let location = Location::for_new_document(&folder.join(""))?;
    crate::store::write_document(&location, &document, args.force)?;
    new_folder.keep();
    messages.note(&format!(
        "{}: {} frames, {} with a suggested camera, {} of them snapped to the painted lines",
        location.file().display(),
        document.frames.len(),
        found.frames.len(),
        found.snapped_count(),
    ));
    Ok(if made.left_out.is_empty() { Outcome::Done } else { Outcome::SomeFailed })
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
        at.x, at.y, at.z, sigma.x, sigma.y, sigma.z, found.crown_m
    ));
    messages.note(&format!(
        "{} frames; {:.0} % of the paint explained, {:.0} % of the lines seen ({} by name), next best answer {:.0} % of this \
         one, paint {:.2} px off its lines, halves of the frames {:.2} m apart",
        evidence.frames,
        100.0 * evidence.explained,
        100.0 * evidence.visible,
        evidence.lines.len(),
        100.0 * evidence.rival / evidence.score(),
        evidence.residual_px,
        evidence.halves_m,
    ));
}
