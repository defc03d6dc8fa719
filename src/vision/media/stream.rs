//! A list of frames, read one after the other.

use super::{FrameReader, FrameRef, MediaError, Picture, ReadFrames};
use std::collections::BTreeSet;
use std::fmt;
use touchline_core::progress::{Progress, Share};

/// Reads a list of frames in order: the frames of a clip, every tenth frame of a video, the images
/// of a folder.
///
/// Each frame is read once, when it is requested, and is the same picture that
/// [`FrameReader::read`] returns for it. A frame that cannot be read is an item like any other; its
/// receiver decides what to do. The stream has a decoder of its own, unless it [borrows
/// one](Self::with_reader). A video is read in order without a seek if nothing else reads with that
/// decoder meanwhile.
///
/// The stream reports to its progress before each frame, and ends early if that cancels it.
pub struct FrameStream<'a, I> {
    reader: Box<dyn ReadFrames + 'a>,
    frames: I,
    /// The frames that will be read again; none if this is not known.
    read_again: Option<BTreeSet<FrameRef>>,
    progress: Progress<'a, Share>,
    /// Number of frames requested so far, of all.
    share: Share,
}

/// A frame of a stream.
#[derive(Clone, Debug)]
pub struct StreamedFrame {
    /// The frame.
    pub source: FrameRef,
    /// Its pixels, or the reason why it could not be read.
    pub picture: Result<Picture, MediaError>,
}

impl<'a, I: ExactSizeIterator<Item = FrameRef>> FrameStream<'a, I> {
    /// Streams these frames. Nothing is read yet.
    pub fn new(frames: impl IntoIterator<IntoIter = I>) -> Self {
        let frames = frames.into_iter();
        let share = Share::new(0, frames.len());
        Self {
            reader: Box::new(FrameReader::new()),
            frames,
            read_again: None,
            progress: Progress::default(),
            share,
        }
    }

    /// Reads with a decoder that is used elsewhere before and after: a video that it has open is
    /// not opened again.
    #[must_use]
    pub fn with_reader(self, reader: impl ReadFrames + 'a) -> Self {
        Self {
            reader: Box::new(reader),
            ..self
        }
    }

    /// States which frames will be read again with the same decoder later. It need not keep the
    /// pictures of the others: see [`ReadFrames::read_in_passing`].
    #[must_use]
    pub fn with_read_again(self, frames: BTreeSet<FrameRef>) -> Self {
        Self {
            read_again: Some(frames),
            ..self
        }
    }

    /// Reports the number of finished frames before each one is read. If that cancels, no further
    /// frame follows.
    #[must_use]
    pub fn with_progress(self, progress: Progress<'a, Share>) -> Self {
        Self { progress, ..self }
    }

    /// Reads the next frame while `work` runs on another thread. `work` is done when this returns,
    /// even if there is no further frame.
    pub fn next_during(&mut self, work: impl FnOnce() + Send) -> Option<StreamedFrame> {
        rayon::in_place_scope(|scope| {
            scope.spawn(|_| work());
            self.next()
        })
    }
}

impl<I: ExactSizeIterator<Item = FrameRef>> Iterator for FrameStream<'_, I> {
    type Item = StreamedFrame;

    fn next(&mut self) -> Option<StreamedFrame> {
        // A cancelled stream takes no frame from its list and reports nothing more; nor is the end
        // of the list reported.
        if self.progress.is_cancelled() {
            return None;
        }
        let source = self.frames.next()?;
        self.progress.report(self.share).continue_value()?;
        self.share.done += 1;
        let is_in_passing = self
            .read_again
            .as_ref()
            .is_some_and(|read_again| !read_again.contains(&source));
        let picture = if is_in_passing {
            self.reader.read_in_passing(&source)
        } else {
            self.reader.read(&source)
        };
        Some(StreamedFrame { source, picture })
    }
}

impl<I> fmt::Debug for FrameStream<'_, I> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FrameStream")
            .field("share", &self.share)
            .field("progress", &self.progress)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::CachedReader;
    use std::ops::ControlFlow;
    use std::path::Path;
    use std::sync::Mutex;
    use std::sync::atomic::{AtomicBool, Ordering};
    use touchline_core::geometry::ImageSize;

    /// Gives a picture for each frame of a video but those of some numbers, and remembers in which
    /// order they were requested.
    #[derive(Default)]
    struct Numbered {
        damaged: Vec<usize>,
        requests: Vec<usize>,
    }

    impl ReadFrames for Numbered {
        fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
            let FrameRef::Video { path, index } = frame else {
                panic!("{frame}")
            };
            self.requests.push(*index);
            if self.damaged.contains(index) {
                return Err(MediaError::Missing {
                    path: path.to_path_buf(),
                });
            }
            Ok(Picture::with_colour(
                ImageSize::new(4, 4),
                [*index as u8, 0, 0, 255],
            ))
        }
    }

    fn frames(numbers: &[usize]) -> Vec<FrameRef> {
        numbers
            .iter()
            .map(|number| FrameRef::video(Path::new("match.mp4"), *number))
            .collect()
    }

    /// What a picture shows; none where it could not be read.
    fn number_in(frame: &StreamedFrame) -> Option<u8> {
        frame.picture.as_ref().ok().map(|picture| picture.rgba()[0])
    }

    #[test]
    fn frames_come_in_the_order_of_the_list_and_then_it_ends() {
        let mut reader = Numbered::default();
        let mut stream = FrameStream::new(frames(&[7, 3, 9])).with_reader(&mut reader);
        let shown: Vec<Option<u8>> = stream.by_ref().map(|frame| number_in(&frame)).collect();
        assert_eq!(shown, [Some(7), Some(3), Some(9)]);
        assert!(stream.next().is_none(), "it stays at its end");
        drop(stream);
        assert_eq!(reader.requests, [7, 3, 9]);
        assert!(FrameStream::new(frames(&[])).next().is_none());
    }

    #[test]
    fn a_frame_that_cannot_be_read_is_an_item_and_the_next_one_follows() {
        let mut reader = Numbered {
            damaged: vec![1],
            ..Numbered::default()
        };
        let streamed: Vec<StreamedFrame> = FrameStream::new(frames(&[0, 1, 2]))
            .with_reader(&mut reader)
            .collect();
        assert_eq!(
            streamed.iter().map(number_in).collect::<Vec<_>>(),
            [Some(0), None, Some(2)]
        );
        assert_eq!(
            streamed[1].source,
            FrameRef::video(Path::new("match.mp4"), 1)
        );
    }

    #[test]
    fn progress_is_reported_before_each_frame_and_may_end_it() {
        let (steps, mut reader) = (Mutex::new(Vec::new()), Numbered::default());
        let progress = Progress::new(|Share { done, of }| {
            steps.lock().unwrap().push([done, of]);
            if done == 2 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        let mut stream = FrameStream::new(frames(&[4, 5, 6, 7]))
            .with_reader(&mut reader)
            .with_progress(progress);
        assert_eq!(
            stream
                .by_ref()
                .filter_map(|frame| number_in(&frame))
                .collect::<Vec<_>>(),
            [4, 5]
        );
        assert!(stream.next().is_none(), "it does not begin again");
        drop(stream);
        assert_eq!(*steps.lock().unwrap(), [[0, 4], [1, 4], [2, 4]]);
        assert_eq!(reader.requests, [4, 5]);
    }

    #[test]
    fn only_frames_that_are_read_again_are_kept() {
        let mut reader = CachedReader::new(Numbered::default(), 1 << 20);
        let all = frames(&[0, 1, 2, 3]);
        let read_again = BTreeSet::from([all[1].clone(), all[3].clone()]);
        let stream = FrameStream::new(all.clone()).with_reader(&mut reader);
        let streamed: Vec<StreamedFrame> = stream.with_read_again(read_again).collect();
        let shown: Vec<Option<u8>> = streamed.iter().map(number_in).collect();
        assert_eq!(shown, [Some(0), Some(1), Some(2), Some(3)]);
        let kept = all.iter().filter(|frame| reader.is_kept(frame));
        assert!(kept.eq([&all[1], &all[3]]));
    }

    #[test]
    fn work_is_done_while_the_next_frame_is_read_and_at_the_end() {
        let mut stream = FrameStream::new(frames(&[1])).with_reader(Numbered::default());
        for expected in [Some(1), None] {
            let is_done = AtomicBool::new(false);
            let next = stream.next_during(|| is_done.store(true, Ordering::Relaxed));
            assert!(is_done.load(Ordering::Relaxed));
            assert_eq!(next.as_ref().and_then(number_in), expected);
        }
    }

    #[test]
    fn images_are_read_with_a_reader_of_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let paths = ["a.png", "b.png"].map(|name| folder.path().join(name));
        image::RgbImage::from_pixel(2, 2, image::Rgb([8, 0, 0]))
            .save(&paths[0])
            .unwrap();
        let streamed: Vec<StreamedFrame> =
            FrameStream::new(paths.each_ref().map(|path| FrameRef::image(path.as_path())))
                .collect();
        assert_eq!(number_in(&streamed[0]), Some(8));
        assert_eq!(
            streamed[1].picture,
            Err(MediaError::Missing {
                path: paths[1].clone()
            })
        );
    }
}
