//! Work on the features of many frames, batch by batch and coarse to fine.
//!
//! More than nine tenths of the time of a frame is SIFT, and half the width takes a quarter of it.
//! So frames are looked at coarsely first, and at the resolution of the options only where the
//! coarse features do not suffice.

use super::features::ExtractionInput;
use crate::proposals::{FrameFeatures, FramePictures, PictureError, Resolution, read_picture};
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use touchline_documents::document::Frame;
use touchline_vision::media::{FrameReader, Picture, ReadFrames};

/// Number of frames per batch: at most this many pictures of a video are in memory.
const BATCH: usize = 16;

/// A frame with its features, coarse or fine.
pub struct FrameWithFeatures<'a, T> {
    /// Its index in the document.
    pub index: usize,
    /// The frame.
    pub frame: &'a Frame,
    /// Its features, or why there are none.
    pub found: Result<FrameFeatures, PictureError>,
    /// Where the features are fine and coarse ones did not suffice, the result of the work on
    /// these.
    pub earlier: Option<T>,
}

/// A frame before work on its features.
struct PreparedFrame<'a, T> {
    index: usize,
    frame: &'a Frame,
    resolution: Resolution,
    found: ExtractionInput,
    /// The result of the work on its coarse features.
    earlier: Option<T>,
}

/// The result of work on a frame; its picture, if it was read and is needed again.
enum FrameWorkOutcome<T> {
    Done(T),
    NeedsFine(T, Option<Picture>),
}

impl<T> FrameWorkOutcome<T> {
    fn result(self) -> T {
        match self {
            Self::Done(result) | Self::NeedsFine(result, _) => result,
        }
    }
}

impl FramePictures<'_> {
    /// Calls `work` with the features of some frames, in parallel and batch by batch. Returns the
    /// results in the order of the frames; none if `work` ended it. Images are read in parallel,
    /// videos one frame after the other by `reader`.
    pub fn each<T: Send>(
        &self,
        reader: &mut dyn ReadFrames,
        frames: &[usize],
        work: impl Fn(usize, &Frame, Result<FrameFeatures, PictureError>) -> ControlFlow<(), T> + Sync,
    ) -> Option<Vec<T>> {
        self.in_batches(
            reader,
            frames,
            |_| Resolution::Fine,
            |look: FrameWithFeatures<'_, T>| work(look.index, look.frame, look.found),
            |_| false,
        )
    }

    /// The same with the coarse features of each frame, and once more with its fine ones if the
    /// result `needs_fine` ones. The picture is read once. Frames that are too narrow for a coarse
    /// look have fine features at once.
    pub fn each_coarse_to_fine<T: Send>(
        &self,
        reader: &mut dyn ReadFrames,
        frames: &[usize],
        work: impl Fn(FrameWithFeatures<'_, T>) -> ControlFlow<(), T> + Sync,
        needs_fine: impl Fn(&T) -> bool + Sync,
    ) -> Option<Vec<T>> {
        self.in_batches(
            reader,
            frames,
            |frame| self.first_resolution(frame),
            work,
            needs_fine,
        )
    }

    fn first_resolution(&self, frame: &Frame) -> Resolution {
        match self.options.coarse(frame.image_size.width) {
            Some(_) => Resolution::Coarse,
            None => Resolution::Fine,
        }
    }

    fn in_batches<T: Send>(
        &self,
        reader: &mut dyn ReadFrames,
        frames: &[usize],
        first: impl Fn(&Frame) -> Resolution,
        work: impl Fn(FrameWithFeatures<'_, T>) -> ControlFlow<(), T> + Sync,
        needs_fine: impl Fn(&T) -> bool + Sync,
    ) -> Option<Vec<T>> {
        let mut made = Vec::with_capacity(frames.len());
        // Videos are decoded here in sequence; extraction, and reading of images, runs in parallel
        // after that.
        for batch in frames.chunks(BATCH) {
            // Nothing is read of an image yet. A picture of a video is decoded, in order, unless
            // the store has its features.
            let begun = batch.iter().map(|&index| {
                let frame = &*self.document.frames[index];
                let resolution = first(frame);
                PreparedFrame {
                    index,
                    frame,
                    resolution,
                    found: self.begin(reader, frame, resolution, None),
                    earlier: None,
                }
            });
            let begun = begun.collect();
            // The frames that need fine features keep their place in the batch, so that all results
            // can be put in the order of the frames again.
            let (mut done, mut again, mut places) = (Vec::new(), Vec::new(), Vec::new());
            let worked = self.work_on(begun, &work, &needs_fine)?;
            for (place, (&index, worked)) in batch.iter().zip(worked).enumerate() {
                let frame = &*self.document.frames[index];
                match worked {
                    FrameWorkOutcome::Done(result) => done.push((place, result)),
                    FrameWorkOutcome::NeedsFine(earlier, picture) => {
                        places.push(place);
                        again.push(PreparedFrame {
                            index,
                            frame,
                            resolution: Resolution::Fine,
                            found: self.begin(reader, frame, Resolution::Fine, picture),
                            earlier: Some(earlier),
                        });
                    }
                }
            }
            // A result from fine features is final.
            let fine = self.work_on(again, &work, &|_: &T| false)?;
            done.extend(
                places
                    .into_iter()
                    .zip(fine.into_iter().map(FrameWorkOutcome::result)),
            );
            done.sort_unstable_by_key(|(place, _)| *place);
            made.extend(done.into_iter().map(|(_, result)| result));
        }
        Some(made)
    }

    /// Calls `work` with the features of some frames, in parallel. None if it ended.
    fn work_on<T: Send>(
        &self,
        begun: Vec<PreparedFrame<'_, T>>,
        work: &(impl Fn(FrameWithFeatures<'_, T>) -> ControlFlow<(), T> + Sync),
        needs_fine: &(impl Fn(&T) -> bool + Sync),
    ) -> Option<Vec<FrameWorkOutcome<T>>> {
        let ended = AtomicBool::new(false);
        let worked = begun.into_par_iter().map(|begun| {
            // A result that is computed in vain does no harm, so the flag needs no stronger
            // ordering.
            if ended.load(Ordering::Relaxed) {
                return None;
            }
            let (frame, resolution) = (begun.frame, begun.resolution);
            let (found, picture) = self.features_of(frame, resolution, begun.found);
            let worked = work(FrameWithFeatures {
                index: begun.index,
                frame,
                found,
                earlier: begun.earlier,
            });
            if worked.is_break() {
                ended.store(true, Ordering::Relaxed);
            }
            let result = worked.continue_value()?;
            Some(if resolution == Resolution::Coarse && needs_fine(&result) {
                FrameWorkOutcome::NeedsFine(result, picture)
            } else {
                FrameWorkOutcome::Done(result)
            })
        });
        worked.collect()
    }

    /// Calls `work` with the pictures of some frames, each read once, in parallel and batch by
    /// batch. Returns the results in the order of the frames; none if `work` ended it.
    pub(in crate::proposals) fn each_picture<T: Send>(
        &self,
        reader: &mut dyn ReadFrames,
        frames: &[usize],
        work: impl Fn(usize, &Frame, Result<Picture, PictureError>) -> ControlFlow<(), T> + Sync,
    ) -> Option<Vec<T>> {
        let mut made = Vec::with_capacity(frames.len());
        for batch in frames.chunks(BATCH) {
            let mut begun = Vec::with_capacity(batch.len());
            for &index in batch {
                let frame = &*self.document.frames[index];
                // The decoder of a video is used by one thread and in order; images are read below,
                // in parallel.
                let of_video = frame
                    .image
                    .is_none()
                    .then(|| read_picture(reader, frame, self.folder));
                begun.push((index, frame, of_video));
            }
            let worked = begun.into_par_iter().map(|(index, frame, of_video)| {
                let picture = of_video
                    .unwrap_or_else(|| read_picture(&mut FrameReader::new(), frame, self.folder));
                work(index, frame, picture).continue_value()
            });
            made.extend(worked.collect::<Option<Vec<T>>>()?);
        }
        Some(made)
    }
}
