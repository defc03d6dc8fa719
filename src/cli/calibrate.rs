//! `touchline calibrate`: a project with its camera, from frames alone.

use super::Outcome;
use super::messages::Messages;
use super::new::parameter;
use super::output::refuse_existing;
use crate::calibrate::{
    FrameTraces, UnclickedBase, UnclickedProgress, base_without_clicks, record_found, record_snapped, snap_frame,
};
use crate::document::{CameraId, Document, FieldSpec, Fields, document_from_frames};
use crate::media::{FrameReader, FrameSource, Picture};
use crate::paint::SnapOptions;
use crate::proposals::read_picture;
use crate::store::Location;
use anyhow::{Context as _, ensure};
use rayon::prelude::*;
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
    /// A parameter of the field, such as `length_m=105`; may be given several times.
    #[arg(long = "set", value_name = "NAME=NUMBER", value_parser = parameter)]
    set: Vec<(String, f64)>,
    /// The camera is found from this many frames at most, spread over all of them.
    #[arg(long, value_name = "N", default_value_t = 40, value_parser = clap::value_parser!(u32).range(3..=300))]
    look_at: u32,
    /// Make the project although the folder holds something; a project in it is kept as project.json.bak.
    #[arg(long)]
    force: bool,
}

/// At least this share of the frames has to agree with the painted lines of its own picture. Right answers had .9 and more on
/// real and drawn matches, wrong ones .5 and less.
const MIN_SNAPPED: f64 = 0.75;

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
    let model = field.model(Path::new(""))?;
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
    let looked_at = spread(&document, &camera, args.look_at as usize);
    let (looked_at, traces) = look(&document, &looked_at, &folder, messages)?;
    let bar = messages.progress(100, "Tying frames");
    let found = base_without_clicks(&traces, &model, &|progress| {
        match progress {
            UnclickedProgress::Tying(done, of) => bar.set_position((done * 100 / of.max(1)) as u64),
            UnclickedProgress::Trying(_) => bar.set_message("Trying places"),
            UnclickedProgress::Adjusting(..) => bar.set_message("Adjusting"),
        }
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    let found = found.with_context(|| args.frames.display().to_string())?;
    record_found(&mut document, &camera, &looked_at, &found);
    let snapped = snap_found(&mut document, &looked_at, &folder, messages)?;
    let of = found.ptz.iter().flatten().count();
    ensure!(
        snapped as f64 >= MIN_SNAPPED * of as f64,
        "{}: the best answer is not certain, so none is given: only {snapped} of {of} frames agree with the painted lines of \
         their own picture. Click 4 landmarks on 2 frames instead",
        args.frames.display()
    );
    say(&found, messages);
    let location = Location::for_new_document(&folder.join(""))?;
    crate::store::write_document(&location, &document, args.force)?;
    new_folder.keep();
    messages.note(&format!(
        "{}: {} frames, {} with a suggested camera, {snapped} of them snapped to the painted lines",
        location.file().display(),
        document.frames.len(),
        of,
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

/// The frames that are looked at: of one camera, spread evenly.
fn spread(document: &Document, camera: &CameraId, count: usize) -> Vec<usize> {
    let of_camera: Vec<usize> =
        (0..document.frames.len()).filter(|index| document.frames[*index].camera == *camera).collect();
    let count = count.min(of_camera.len());
    (0..count).map(|place| of_camera[place * of_camera.len() / count]).collect()
}

/// What is kept of the frames' pictures, and which frames could be read. Pictures are read a few at a time.
fn look(
    document: &Document,
    frames: &[usize],
    folder: &Path,
    messages: Messages,
) -> anyhow::Result<(Vec<usize>, Vec<FrameTraces>)> {
    const AT_ONCE: usize = 8;
    let mut reader = FrameReader::new();
    let bar = messages.progress(frames.len(), "Looking at frames");
    let (mut read, mut traces) = (Vec::new(), Vec::new());
    for some in frames.chunks(AT_ONCE) {
        let mut pictures: Vec<(usize, Picture)> = Vec::new();
        for &index in some {
            match read_picture(&mut reader, &document.frames[index], folder) {
                Ok(picture) => pictures.push((index, picture)),
                Err(error) => messages.frame_failed(&document.frames[index].name(), &error.to_string()),
            }
        }
        let of_picture = |(index, picture): &(usize, Picture)| {
            FrameTraces::of(picture, &document.masks_of(&document.frames[*index]))
        };
        traces.extend(pictures.par_iter().map(of_picture).collect::<Result<Vec<_>, _>>()?);
        read.extend(pictures.iter().map(|(index, _)| *index));
        bar.inc(some.len() as u64);
    }
    bar.finish_and_clear();
    Ok((read, traces))
}

/// What was found and what speaks for it.
fn say(found: &UnclickedBase, messages: Messages) {
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

/// Pulls the found cameras onto the painted lines of their own pictures; how many could be.
fn snap_found(document: &mut Document, frames: &[usize], folder: &Path, messages: Messages) -> anyhow::Result<usize> {
    let fields = Fields::of(document.at(folder))?;
    let mut reader = FrameReader::new();
    let bar = messages.progress(frames.len(), "Snapping");
    let mut snapped = 0;
    for &index in frames {
        bar.inc(1);
        let frame = &*document.frames[index];
        let Ok(picture) = read_picture(&mut reader, frame, folder) else { continue };
        let field = fields.of_frame(document, frame);
        if let Ok((base, found)) = snap_frame(document, frame, field, &picture, &SnapOptions::default()) {
            snapped += 1;
            record_snapped(&mut document.frames[index], &base, &found);
        }
    }
    bar.finish_and_clear();
    Ok(snapped)
}
