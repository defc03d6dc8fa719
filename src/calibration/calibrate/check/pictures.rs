//! Compares the pictures with what the document states: missing ones, changed ones, ones of another
//! size, and other frames of the video.

use super::fault::{Fault, Problem};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use touchline_core::progress::Progress;
use touchline_documents::document::{DocumentAt, Frame, VideoFrame};
use touchline_vision::media::{self, FrameReader, MediaError, VideoInfo};

/// Compares the pictures of a document with what it states about them. Every video is opened once.
pub struct PictureCheck<'a> {
    document: DocumentAt<'a>,
    videos: Videos,
}

impl<'a> PictureCheck<'a> {
    /// Opens the videos of a document.
    pub fn open(document: DocumentAt<'a>) -> Self {
        Self {
            document,
            videos: videos(document),
        }
    }

    /// What is wrong with the picture of a frame, by the frame's index.
    pub fn faults(&self, index: usize) -> Vec<Fault> {
        let frame = self.document.frames.get(index);
        frame.map_or_else(Vec::new, |frame| {
            check_frame(frame, self.document.folder, &self.videos)
        })
    }
}

/// Everything wrong with the pictures of a document, in its order. `progress` counts frames, from
/// any thread; if it cancels this, some frames have not been checked. Images are read in parallel,
/// every video is opened once.
pub fn check_pictures(document: DocumentAt<'_>, progress: &Progress<'_, ()>) -> Vec<Problem> {
    let check = PictureCheck::open(document);
    let faults = (0..document.frames.len()).into_par_iter().map(|index| {
        if progress.is_cancelled() {
            return Vec::new();
        }
        let faults = check.faults(index);
        // The frames that follow check for cancellation themselves.
        let _ = progress.report(());
        faults
    });
    let faults: Vec<Vec<Fault>> = faults.collect();
    let problems = faults.into_iter().enumerate().flat_map(|(index, faults)| {
        let frame = &document.document.frames[index];
        faults
            .into_iter()
            .map(move |fault| Problem::in_frame(index, frame, fault))
    });
    // A video that was replaced is one problem, not one of each of its frames.
    let mut replaced = BTreeSet::new();
    let is_new = |problem: &Problem| match &problem.fault {
        Fault::VideoChanged { video } => replaced.insert(video.clone()),
        _ => true,
    };
    problems.filter(is_new).collect()
}

/// A video that was opened.
struct OpenedVideo {
    info: Result<VideoInfo, MediaError>,
    /// What its file is recognised by.
    file_id: Option<String>,
}

type Videos = BTreeMap<PathBuf, OpenedVideo>;

fn videos(document: DocumentAt<'_>) -> Videos {
    let mut videos = Videos::new();
    // The survey of a video reads its whole file, so all frames of a video share one. Its error is
    // stored as well, because each of these frames reports it.
    for video in document
        .frames
        .iter()
        .filter_map(|frame| frame.video.as_ref())
    {
        videos
            .entry(video.file_path(document.folder))
            .or_insert_with_key(|path| OpenedVideo {
                info: FrameReader::new().video_info(path).cloned(),
                file_id: media::video_file_id(path).ok(),
            });
    }
    videos
}

fn check_frame(frame: &Frame, folder: &Path, videos: &Videos) -> Vec<Fault> {
    let mut faults = Vec::new();
    if let Some(image) = frame.image_path(folder) {
        check_image(frame, &image, &mut faults);
    }
    if let Some(video) = &frame.video
        && let Some(opened) = videos.get(&video.file_path(folder))
    {
        match &opened.info {
            // What else differs follows from that.
            Ok(_) if video.is_of_other_file(opened.file_id.as_deref()) => {
                faults.push(Fault::VideoChanged {
                    video: video.path.clone(),
                });
            }
            Ok(info) => check_video(frame, video, info, &mut faults),
            Err(error) => faults.push(unreadable(error)),
        }
    }
    faults
}

fn unreadable(error: &MediaError) -> Fault {
    Fault::Picture {
        message: error.to_string(),
        missing: matches!(error, MediaError::Missing { .. }),
    }
}

fn check_image(frame: &Frame, path: &Path, faults: &mut Vec<Fault>) {
    // The size is in the header of the file. The hash needs all of it, and is computed only where
    // the document states one. A file that cannot be opened is reported once.
    match media::image_size(path) {
        Err(error) => {
            faults.push(unreadable(&error));
            return;
        }
        Ok(actual) if actual != frame.image_size => {
            faults.push(Fault::PictureSize {
                actual,
                stated: frame.image_size,
            });
        }
        Ok(_) => {}
    }
    let Some(stated) = &frame.sha256 else { return };
    match media::sha256_of_file(path) {
        Ok(actual) if actual.eq_ignore_ascii_case(stated) => {}
        Ok(actual) => faults.push(Fault::PictureChanged { actual }),
        Err(error) => faults.push(unreadable(&error)),
    }
}

fn check_video(frame: &Frame, video: &VideoFrame, info: &VideoInfo, faults: &mut Vec<Fault>) {
    // A number beyond the last frame has no time and no picture to compare with.
    let index = usize::try_from(video.frame_index)
        .ok()
        .filter(|index| *index < info.decoded_frames);
    let Some(index) = index else {
        faults.push(Fault::NoSuchVideoFrame {
            index: video.frame_index,
            frames: info.decoded_frames,
        });
        return;
    };
    // Number and time must name the same frame of the video.
    if let Some(stated) = video.pts_s
        && info.clock.index_at(stated) != Some(index)
    {
        faults.push(Fault::VideoTime {
            index: video.frame_index,
            stated,
            actual: info.pts_s(index),
        });
    }
    // A frame that also has an image is shown from the image, which was compared above.
    if frame.image.is_none() && info.size != frame.image_size {
        faults.push(Fault::PictureSize {
            actual: info.size,
            stated: frame.image_size,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use touchline_core::geometry::ImageSize;
    use touchline_vision::media::FrameClock;

    #[test]
    fn another_video_under_the_name_is_a_fault_whatever_its_length_and_size() {
        let size = ImageSize::new(64, 36);
        let mut frame = Frame::from_video(VideoFrame::new("a.mp4", 3, None), "main".into(), size);
        let opened = OpenedVideo {
            info: Ok(VideoInfo {
                path: Arc::from(Path::new("/match/a.mp4")),
                size,
                rotation_deg: 0,
                fps: 25.0,
                stated_frames: 50,
                decoded_frames: 50,
                interlaced: false,
                clock: FrameClock::Even {
                    first_s: 0.0,
                    fps: 25.0,
                },
                notices: Vec::new(),
            }),
            file_id: Some("00ff".to_owned()),
        };
        let videos = Videos::from([(PathBuf::from("/match/a.mp4"), opened)]);
        let mut faults = |file_id: Option<&str>| {
            if let Some(video) = &mut frame.video {
                video.file_id = file_id.map(Arc::from);
            }
            let faults = check_frame(&frame, Path::new("/match"), &videos);
            faults.iter().map(Fault::code).collect::<Vec<_>>()
        };
        assert_eq!(faults(None), [""; 0], "an earlier version stated none");
        assert_eq!(faults(Some("00FF")), [""; 0]);
        assert_eq!(faults(Some("00fe")), ["video_changed"]);
    }
}
