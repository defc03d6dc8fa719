//! The pictures of a document's frames, and what is done with each of them.

use crate::features::{FeatureOptions, Features, extract};
use crate::geometry::PixelBox;
use crate::media::{FrameReader, FrameRef, Picture};
use crate::project::{Document, Frame};
use anyhow::bail;
use rayon::prelude::*;
use std::path::Path;
use std::time::{Duration, Instant};

/// The pixels of a frame: its image file, else its video's frame.
///
/// # Errors
/// The frame has no picture, it cannot be read, or it is not as large as the document says.
pub fn read_picture(reader: &mut FrameReader, frame: &Frame, folder: &Path) -> anyhow::Result<Picture> {
    let source = match (frame.image_path(folder), &frame.video) {
        (Some(image), _) => FrameRef::image(image),
        (None, Some(video)) => FrameRef::video(video.file_path(folder), usize::try_from(video.frame_index)?),
        (None, None) => bail!("the frame has neither an image nor a video to show"),
    };
    let picture = reader.read(&source)?;
    if picture.size() != frame.image_size {
        let (is, said) = (picture.size(), frame.image_size);
        bail!(
            "{source} is {} × {} px, but the document says {} × {} px: it is not the frame that was labelled",
            is.width,
            is.height,
            said.width,
            said.height
        );
    }
    Ok(picture)
}

/// The features of a frame, and how long they took.
pub struct FrameFeatures {
    /// Outside the masks of the frame and its camera.
    pub features: Features,
    /// Without reading the picture.
    pub time: Duration,
}

/// Frames taken at a time: so many pictures of a video lie in memory at most.
const BATCH: usize = 32;

/// Hands the features of some frames of a document to `work`, in parallel, a batch at a time; what it makes of them, in the
/// frames' order. Images are read in parallel, videos one frame after the other.
pub fn with_features<T: Send>(
    document: &Document,
    folder: &Path,
    frames: &[usize],
    options: &FeatureOptions,
    work: impl Fn(&Frame, anyhow::Result<FrameFeatures>) -> T + Sync,
) -> Vec<T> {
    let mut reader = FrameReader::new();
    let mut made = Vec::with_capacity(frames.len());
    for batch in frames.chunks(BATCH) {
        let pictures: Vec<(&Frame, Option<anyhow::Result<Picture>>)> = batch
            .iter()
            .map(|&index| {
                let frame = &*document.frames[index];
                (frame, frame.image.is_none().then(|| read_picture(&mut reader, frame, folder)))
            })
            .collect();
        made.par_extend(pictures.into_par_iter().map(|(frame, picture)| {
            let picture = picture.unwrap_or_else(|| read_picture(&mut FrameReader::new(), frame, folder));
            work(frame, picture.and_then(|picture| features_of(document, frame, &picture, options)))
        }));
    }
    made
}

fn features_of(
    document: &Document,
    frame: &Frame,
    picture: &Picture,
    options: &FeatureOptions,
) -> anyhow::Result<FrameFeatures> {
    let of_camera = document.camera_of(frame).map_or(&[][..], |camera| &camera.masks);
    let masks: Vec<PixelBox> = of_camera.iter().chain(&frame.masks).copied().collect();
    let start = Instant::now();
    let features = extract(picture, &masks, options)?;
    Ok(FrameFeatures { features, time: start.elapsed() })
}
