//! `touchline new`: makes a project from a folder of images or a video.

use super::Outcome;
use super::export::{parse_finite, parse_size};
use super::stretched::write_unstretched;
use crate::cli::terminal::document::refuse_unwritable;
use crate::cli::terminal::messages::{Messages, count_steps};
use crate::cli::terminal::output::{ending, refuse_existing, refuse_file};
use anyhow::{bail, ensure};
use std::path::{Path, PathBuf};
use touchline_core::geometry::{ImageSize, pluralise};
use touchline_documents::document::{
    FieldSpec, FolderChanges, Frame, Step, document_from_frames, resolve_path,
};
use touchline_documents::store::{
    self, Access, Location, Opened, PROJECT_FILE, refuse_other_file, write_document,
};
use touchline_vision::media::FrameSource;

/// Makes a project from a folder of images or a video. The frames stay where they are. A project
/// that was made of the folder before gets the images that came since.
#[derive(clap::Args, Debug)]
pub struct NewArgs {
    /// The project's folder; made if absent.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// The folder of images, or the video.
    #[arg(long, value_name = "FOLDER_OR_VIDEO")]
    frames: PathBuf,
    /// The field's template, or a template file (`touchline fields` lists the templates).
    #[arg(long, value_name = "TEMPLATE")]
    field: String,
    /// A parameter of the field, such as `length_m=105`; may be given several times.
    #[arg(long = "set", value_name = "NAME=NUMBER", value_parser = parameter)]
    set: Vec<(String, f64)>,
    /// Take every n-th frame only.
    #[arg(long, value_name = "N", default_value = "1", value_parser = parse_stride)]
    every: std::num::NonZeroUsize,
    /// The images were stretched to another proportion: write them into the project's folder as
    /// they were before, in this size, such as 1280x720.
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    stretched_from: Option<ImageSize>,
    /// Make the project even if the folder is not empty; an existing project.json is kept as
    /// project.json.bak.
    #[arg(long)]
    force: bool,
}

/// Parses the number of frames from one that is taken to the next.
pub(super) fn parse_stride(text: &str) -> Result<std::num::NonZeroUsize, String> {
    text.parse().map_err(|_| {
        format!("{text} is no step from frame to frame; give a whole number from 1 on")
    })
}

/// Parses a parameter of the field such as `length_m=105`.
pub(super) fn parameter(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text
        .split_once('=')
        .ok_or("write NAME=NUMBER, such as length_m=105")?;
    match parse_finite(value.trim()) {
        Some(number) => Ok((name.trim().to_owned(), number)),
        None => Err(format!(
            "{value:?} is not a number; write NAME=NUMBER, such as length_m=105"
        )),
    }
}

/// Makes the project. [`Outcome::SomeFailed`] if some images cannot be read.
///
/// # Errors
/// The project's folder exists, the field is invalid, or no frame can be read.
pub fn new(args: &NewArgs, messages: Messages) -> anyhow::Result<Outcome> {
    if let Some(outcome) = add_new_images(args, messages)? {
        return Ok(outcome);
    }
    refuse_swapped(args)?;
    refuse_existing(&args.folder, args.force)?;
    refuse_other_file(&args.folder.join(PROJECT_FILE))?;
    refuse_file(&args.folder, "the project")?;
    let field = read_field(&args.field, &args.set)?;
    let source = FrameSource::open(&args.frames)?;
    messages.notes(source.notices());
    ensure!(
        !source.is_empty(),
        "{} holds no PNG, JPEG, TIFF, BMP or WebP image; give the folder that holds the frames",
        args.frames.display()
    );
    // The document names its frames relative to this folder, which need not exist yet.
    let folder = std::path::absolute(&args.folder)?;
    let source = match args.stretched_from {
        Some(size) => write_unstretched(&source, size, &folder.join("images"), messages)?,
        None => source,
    };
    let bar = messages.progress(source.len().div_ceil(args.every.get()), "Reading frames");
    let made = document_from_frames(&source, &folder, field, args.every, &count_steps(&bar));
    bar.finish_and_clear();
    messages.frames_failed(made.left_out.iter().map(|(name, error)| (name, error)));
    messages.name_video_backend(&made.document);
    ensure!(
        !made.document.frames.is_empty(),
        "{}: none of the images can be read",
        args.frames.display()
    );
    // Refused before the folder is made. The final separator of the joined path says that a folder
    // is meant, although there is none yet.
    refuse_unwritable(&made.document, &folder)?;
    let location = Location::for_new_document(&folder.join(""))?;
    write_document(&location, &made.document, args.force)?;
    messages.note(&format!(
        "{}: {}",
        location.file().display(),
        pluralise(made.document.frames.len(), "frame")
    ));
    Ok(Outcome::from_failure(!made.left_out.is_empty()))
}

/// Refuses a video in the place of the project's folder: the two were exchanged.
fn refuse_swapped(args: &NewArgs) -> anyhow::Result<()> {
    /// Endings of videos.
    const VIDEOS: [&str; 5] = ["mp4", "mov", "mkv", "avi", "ts"];
    let is_video = args.folder.is_file() && VIDEOS.contains(&ending(&args.folder).as_str());
    ensure!(
        !is_video,
        "{} is a video, and the project's folder comes first: touchline new FOLDER --frames {0}",
        args.folder.display()
    );
    Ok(())
}

/// Adds the images that came to the folder since the project was made of it, where that is what the
/// arguments name; nothing else of the project changes. None if they name something else.
fn add_new_images(args: &NewArgs, messages: Messages) -> anyhow::Result<Option<Outcome>> {
    let may_be_it = args.folder.join(PROJECT_FILE).is_file()
        && args.frames.is_dir()
        && args.stretched_from.is_none();
    if !may_be_it || args.force || args.every.get() > 1 {
        return Ok(None);
    }
    let Opened {
        location,
        mut document,
        mut history,
        access,
        recovery,
    } = store::open(&args.folder)?;
    let frames = resolve_path(&std::path::absolute(&args.frames)?);
    let is_in_folder = |frame: &Frame| {
        let image = frame.image_path(location.folder());
        image.is_some_and(|image| resolve_path(&image).parent() == Some(&*frames))
    };
    let field = &document.field;
    let is_of_folder = document.frames.iter().any(|frame| is_in_folder(frame));
    let is_same_field = field.template == args.field
        && args
            .set
            .iter()
            .all(|(name, value)| field.params.get(name) == Some(value));
    if !is_of_folder || !is_same_field {
        return Ok(None);
    }
    messages.notes(recovery.message());
    let bar = messages.progress(0, "Reading new images");
    let changes = FolderChanges::find(&document, location.folder(), &count_steps(&bar));
    bar.finish_and_clear();
    messages.frames_failed(changes.left_out.iter().map(|(name, error)| (name, error)));
    // A step of undo, for whoever opens the project in the window.
    let before = document.without_suggestions();
    let added = document.add_images(&changes);
    if added > 0 {
        let mut store = match access {
            Access::Writable(store) => store,
            Access::ReadOnly(reason) => bail!("{}: {reason}", location.file().display()),
        };
        history.begin(&before, Step::on_document("Add new images"));
        history.commit(&document.without_suggestions());
        store.save(&document, &history)?;
    }
    let gone = match changes.gone {
        0 => String::new(),
        gone => format!("; {} not in the folder any more", pluralise(gone, "image")),
    };
    messages.note(&format!(
        "{}: {} added, {} in all{gone}",
        location.file().display(),
        pluralise(added, "new image"),
        pluralise(document.frames.len(), "frame")
    ));
    Ok(Some(Outcome::from_failure(!changes.left_out.is_empty())))
}

/// The field that the arguments describe. The path of a template file, given relative to the
/// working directory, is made absolute.
///
/// # Errors
/// The template does not exist or does not accept a parameter.
pub(super) fn read_field(template: &str, params: &[(String, f64)]) -> anyhow::Result<FieldSpec> {
    let params = params.iter().cloned().collect();
    let field = FieldSpec::with_params(template, params).with_absolute_path()?;
    // Built only to find mistakes before any frame is read.
    field.model(Path::new(""))?;
    Ok(field)
}

#[cfg(test)]
mod tests {
    use super::parameter;

    #[test]
    fn a_parameter_is_a_name_and_a_number() {
        assert_eq!(
            parameter("length_m=101.5"),
            Ok(("length_m".to_owned(), 101.5))
        );
        for wrong in [
            "length_m",
            "length_m=",
            "length_m=NaN",
            "length_m=inf",
            "length_m=1e999",
        ] {
            assert!(
                parameter(wrong)
                    .unwrap_err()
                    .ends_with("write NAME=NUMBER, such as length_m=105"),
                "{wrong}"
            );
        }
    }
}
