//! The survey of a video when it is opened: number of frames that decode, their times, and how to
//! seek.
//!
//! The number of frames follows from the time of the last one, provided that the frame rate is
//! constant. Two checks establish that. An MP4 states the average rate over all frames; if its
//! first frames lie exactly on the stated rate, the rate is constant. In other containers the
//! packets are counted. If the rate is not constant, the sample table of an MP4 has the times,
//! provided that sampled frames confirm it; otherwise every frame is decoded once.

use super::backend::{DescribedVideo, VideoBackend};
use super::comb::{count_combed_in_middle, is_combed, may_be_interlaced};
use super::container::{ContainerKind, container_of};
use super::frame_times::{
    Counter, EXACT_S, ROUNDED_S, clock_from_times, count_to_the_end, deviation_s, is_uneven,
    play_through, times_go_back, verified_sample_times_s,
};
use super::player::Player;
use super::{Capture, CountProgress, FrameClock, VideoInfo};
use crate::media::image_file::ImageLimits;
use crate::media::{MediaError, Notice, Picture};
use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::Arc;
use touchline_core::geometry::ImageSize;
use touchline_core::progress::Progress;

/// Number of frames played at the start, to measure their spacing and to compare seeks with.
const LEAD_FRAMES: usize = 32;
/// The same for containers in which a seek needs a run-up of [`PREROLL_FRAMES`].
const LONG_LEAD_FRAMES: usize = 640;
/// Run-up of a seek in a container without an index of key frames: longer than their usual
/// distance.
const PREROLL_FRAMES: usize = 300;

/// A surveyed video, ready to be played.
pub(super) struct Survey {
    pub(super) video: SurveyedVideo,
    pub(super) capture: Box<dyn Capture>,
}

/// The result of a survey. It is valid for as long as the file does not change.
#[derive(Clone)]
pub(super) struct SurveyedVideo {
    pub(super) info: VideoInfo,
    /// The size of the frames as they are stored, upright: another one than that of `info` where
    /// pixels are not square.
    pub(super) stored_size: ImageSize,
    /// The run-up of a seek, frames.
    pub(super) preroll: usize,
    /// Opens the video again.
    pub(super) described: DescribedVideo,
}

/// Opens a video and surveys it.
pub(super) fn survey(
    path: &Path,
    backend: VideoBackend,
    progress: &Progress<'_, CountProgress>,
) -> Result<Survey, MediaError> {
    // What is no video is refused before a backend reads it, and the stated size before a frame is
    // decoded.
    let container = container_of(path)?;
    let described = DescribedVideo::new(path, container, backend)?;
    let mut capture = described.open(path)?;
    let stated = *capture.stated_properties();
    let size = stated.size;
    ImageLimits::default().check(path, size.width, size.height)?;
    let preroll = if container.kind == ContainerKind::Stream {
        PREROLL_FRAMES
    } else {
        0
    };

    // 1. Play the first frames: size, start time, spacing, and pictures to compare seeks with.
    let lead = play_lead(
        &mut *capture,
        if preroll > 0 {
            LONG_LEAD_FRAMES
        } else {
            LEAD_FRAMES
        },
    )?;
    let Some(first_s) = lead
        .times_s
        .first()
        .copied()
        .map(|time_s| time_s.unwrap_or(0.0))
    else {
        return Err(MediaError::NoFrames {
            path: path.to_path_buf(),
        });
    };
    let mut info = VideoInfo {
        path: Arc::from(path),
        size: lead.size.unwrap_or(size),
        rotation_deg: stated.rotation_deg,
        fps: stated.fps,
        stated_frames: stated.frames,
        interlaced: false,
        decoded_frames: lead.times_s.len(),
        clock: FrameClock::Even {
            first_s,
            fps: stated.fps,
        },
        notices: Vec::new(),
    };
    let mut player = Player {
        capture,
        position: Some(lead.times_s.len() - 1),
        preroll,
    };
    // 2. How far the first frames deviate from the stated rate, and how many of them are
    //    interlaced.
    let lead_deviation_s = deviation_s(&info.clock, &lead.times_s);
    let at_the_start = lead
        .samples
        .iter()
        .filter(|(_, picture)| may_be_interlaced(&info) && is_combed(picture));
    let mut combed = at_the_start.count();

    let mut go_back = false;
    if lead.is_whole {
        // A short video was played as a whole; its times are known. An even clock is preferred
        // where it fits, for it stores no list.
        if lead_deviation_s > ROUNDED_S {
            info.clock = clock_from_times(&lead.times_s, first_s, info.fps);
            go_back = times_go_back(&info.clock, &lead.times_s);
        }
    } else {
        let counter = Counter {
            path: Arc::clone(&info.path),
            stated: info.stated_frames,
            progress,
        };
        // 3. Constant rate: an MP4 states the mean rate over all frames, which equals that of the
        //    first ones exactly only if it is constant.
        let may_be_even = lead_deviation_s
            <= if container.kind == ContainerKind::Mp4 {
                EXACT_S
            } else {
                ROUNDED_S
            };
        let counted = if may_be_even {
            count_to_the_end(&mut player, &info, &mut combed)?
        } else {
            None
        };
        // Other containers state a nominal rate: the count by time must equal the number of
        // packets.
        let is_sure = counted.is_some()
            && (container.kind == ContainerKind::Mp4
                || described.count_packets(path, &mut |count| counter.at(count))? == counted);
        if let Some(count) = counted.filter(|_| is_sure) {
            info.decoded_frames = count;
        } else {
            // 4. No constant rate: times by the sample table, or by decoding everything.
            let times_s = if let Some(times_s) =
                verified_sample_times_s(path, container.kind, &lead.times_s, &mut player, &info)?
            {
                times_s.into_iter().map(Some).collect()
            } else {
                play_through(described.open_times(path)?, &counter)?
            };
            // All times may lie on the stated rate after all: then only the count was wrong.
            info.decoded_frames = times_s.len();
            if deviation_s(&info.clock, &times_s) > ROUNDED_S {
                info.clock = clock_from_times(&times_s, first_s, info.fps);
                go_back = times_go_back(&info.clock, &times_s);
            }
        }
    }
    // 5. Interlaced if two of the sampled frames show combs. If seeking does not reproduce the
    //    pictures of playing, or a time stands for several frames, all access plays from the start.
    combed += count_combed_in_middle(&mut player, &info);
    info.interlaced = combed >= 2;
    if go_back || !jumps_agree(&mut player, &info, &lead.samples) {
        player.preroll = usize::MAX;
        info.notices.push(Notice::NoJumping {
            path: path.to_path_buf(),
        });
    }
    let stored_size = info.size;
    info.size = with_square_pixels(stored_size, stated.pixel_aspect);
    ImageLimits::default().check(path, info.size.width, info.size.height)?;
    add_notices(&mut info, stored_size);
    let video = SurveyedVideo {
        info,
        stored_size,
        preroll: player.preroll,
        described,
    };
    Ok(Survey {
        video,
        capture: player.capture,
    })
}

/// The size in which frames have square pixels: a camera here has one focal length for both
/// directions. Pixels are made wider or higher, never fewer, so that no detail is lost. An aspect
/// that no format of television has is a mistake of the file, and is ignored.
fn with_square_pixels(stored: ImageSize, aspect: f64) -> ImageSize {
    const LEAST: f64 = 1e-3;
    const USUAL: RangeInclusive<f64> = 0.25..=4.0;
    if (aspect - 1.0).abs() <= LEAST || !USUAL.contains(&aspect) {
        return stored;
    }
    let enlarge = |side_px: u32, factor: f64| (f64::from(side_px) * factor).round() as u32;
    if aspect > 1.0 {
        ImageSize::new(enlarge(stored.width, aspect), stored.height)
    } else {
        ImageSize::new(stored.width, enlarge(stored.height, aspect.recip()))
    }
}

fn add_notices(info: &mut VideoInfo, stored: ImageSize) {
    let path = info.path.to_path_buf();
    if info.stated_frames > 0 && info.stated_frames != info.decoded_frames {
        let (stated, decoded) = (info.stated_frames, info.decoded_frames);
        info.notices.push(Notice::FramesStated {
            path: path.clone(),
            stated,
            decoded,
        });
    }
    if is_uneven(info) {
        info.notices.push(Notice::UnevenFrameTimes {
            path: path.clone(),
            fps: info.fps,
        });
    }
    if info.interlaced {
        info.notices.push(Notice::Interlaced { path: path.clone() });
    }
    if info.size != stored {
        let shown = info.size;
        info.notices.push(Notice::PixelsNotSquare {
            path,
            stored,
            shown,
        });
    }
}

/// The first frames of a video.
struct Lead {
    times_s: Vec<Option<f64>>,
    /// Two of the frames, to compare seeks with.
    samples: Vec<(usize, Picture)>,
    size: Option<ImageSize>,
    /// Whether the video has no more frames.
    is_whole: bool,
}

fn play_lead(capture: &mut dyn Capture, frames: usize) -> Result<Lead, MediaError> {
    let mut lead = Lead {
        times_s: Vec::new(),
        samples: Vec::new(),
        size: None,
        is_whole: false,
    };
    // The size is that of the first picture, since a container may state another. The samples are
    // late in the lead, so that a seek to them has frames to skip.
    for index in 0..frames {
        if !capture.grab()? {
            lead.is_whole = true;
            break;
        }
        lead.times_s.push(capture.time_s());
        if index == 0 {
            lead.size = Some(capture.picture(index)?.size());
        }
        if index == frames * 2 / 3 || index == frames - 2 {
            lead.samples.push((index, capture.picture(index)?));
        }
    }
    Ok(lead)
}

/// Whether seeking gives the same pictures as playing.
fn jumps_agree(player: &mut Player, info: &VideoInfo, samples: &[(usize, Picture)]) -> bool {
    // Backwards, and with the position forgotten, so that each one is a seek and none reads on.
    // Equal to the last byte: a decoder that seeks correctly gives the same pixels.
    samples.iter().rev().all(|(index, played)| {
        player.position = None;
        player.go_to(info, *index).is_ok()
            && player
                .capture
                .picture(*index)
                .is_ok_and(|jumped| jumped == *played)
    })
}
