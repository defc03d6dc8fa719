//! Writes pictures that were stretched to another proportion as they were before.
//!
//! Sets for training networks come as 640 × 640, and frames of older videos lose the proportion
//! that their container states. A camera has square pixels here, so that such pictures give one
//! that stands too high by the stretch. Once they are written in their own proportion, nothing else
//! of the program has to know of it.

use crate::cli::terminal::messages::Messages;
use crate::cli::terminal::output::refuse_existing;
use anyhow::{Context as _, bail};
use image::ImageFormat;
use std::fs::{create_dir_all, write};
use std::path::{Path, PathBuf};
use touchline_core::geometry::ImageSize;
use touchline_documents::exchange::encode_picture;
use touchline_vision::media::{FrameSource, Picture, load_image};

/// Writes each image in the size that it had before it was stretched, under its own name, and
/// returns those written. One that cannot be read is named and left out.
///
/// # Errors
/// The frames are a video, the folder has files already, or a file cannot be written.
pub fn write_unstretched(
    source: &FrameSource,
    size: ImageSize,
    folder: &Path,
    messages: Messages,
) -> anyhow::Result<FrameSource> {
    let listing = match source {
        FrameSource::Folder(listing) => listing,
        FrameSource::Video(info) => bail!(
            "{path} is a video: state its proportion in the file, which encodes nothing again: \
             `ffmpeg -i {path} -c copy -aspect {}:{} OUT.mp4`, and take OUT.mp4 without \
             --stretched-from",
            size.width,
            size.height,
            path = info.path.display()
        ),
    };
    refuse_existing(folder, false)?;
    create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let bar = messages.progress(listing.images.len(), "Writing images");
    let mut written = Vec::with_capacity(listing.images.len());
    for path in &listing.images {
        match load_image(path) {
            Ok(picture) => written.push(write_resized(&picture, size, path, folder)?),
            Err(error) => messages.frame_failed(&path.display().to_string(), &error.to_string()),
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(written.into())
}

/// Writes a picture in another size, under the name and in the format of its file.
fn write_resized(
    picture: &Picture,
    size: ImageSize,
    path: &Path,
    folder: &Path,
) -> anyhow::Result<PathBuf> {
    let to = folder.join(path.file_name().context("an image has a name")?);
    let failed = || format!("cannot write {}", to.display());
    let bytes = encode_picture(&picture.resize(size)?, ImageFormat::from_path(&to)?);
    write(&to, bytes.with_context(failed)?).with_context(failed)?;
    Ok(to)
}
