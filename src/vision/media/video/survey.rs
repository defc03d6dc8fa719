//! The survey of a video when it is opened: number of frames that decode, their times, and how to
//! seek.
//!
//! The number of frames follows from the time of the last one, provided that the frame rate is
//! constant. Two checks establish that. An MP4 states the average rate over all frames; if its
//! first frames lie exactly on the stated rate, the rate is constant. In other containers the
//! packets are counted. If the rate is not constant, the sample table of an MP4 has the times,
//! provided that sampled frames confirm it; otherwise every frame is decoded once.

use super::backend::{DescribedVideo, VideoBackend};
use super::capture::Capture;
use super::comb::is_combed;
use super::player::{Player, ReadOutcome};
use super::sample_table::sample_times_s;
use super::{CountProgress, FrameClock, VideoInfo};
use crate::media::error::open_file;
use crate::media::image_file::ImageLimits;
use crate::media::{MediaError, Notice, Picture};
use std::io::Read;
use std::ops::ControlFlow;
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
/// Distance from the end at which the search for the last frame begins.
const TAIL_FRAMES: usize = 64;
/// A decoder keeps back at most this many frames to show them in order (H.264, annex A.3.1:
/// `MaxDpbFrames`).
const REORDERED_FRAMES: usize = 16;
/// Number of frames counted between two progress reports.
const COUNT_REPORT_FRAMES: usize = 100;
/// While the last frames are read to count them, every n-th is checked for interlacing artefacts.
const TAIL_LOOK_FRAMES: usize = 16;
/// Heights of interlaced footage, px: 480i with and without its blanked lines, 576i, 1080i.
const INTERLACED_HEIGHTS: [u32; 4] = [480, 486, 576, 1080];
/// Tolerance of times at a constant rate, s: floating-point rounding only.
const EXACT_S: f64 = 2e-6;
/// Tolerance of times at a constant rate in a container that rounds to milliseconds, s.
const ROUNDED_S: f64 = 6e-4;

/// A surveyed video, ready to be played.
pub(super) struct Survey {
    pub(super) video: SurveyedVideo,
    pub(super) capture: Box<dyn Capture>,
}

/// The result of a survey. It is valid for as long as the file does not change.
#[derive(Clone)]
pub(super) struct SurveyedVideo {
    pub(super) info: VideoInfo,
    /// The run-up of a seek, frames.
    pub(super) preroll: usize,
    /// Opens the video again.
    pub(super) described: DescribedVideo,
}

/// The kind of container, by the first bytes of the file.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Container {
    /// MP4 and `QuickTime`: state the exact number of stored frames and their average rate.
    Mp4,
    /// Matroska, `WebM` and AVI: have an index of key frames; rate and length are nominal.
    Indexed,
    /// Transport streams and similar: no index.
    Stream,
}

/// Opens a video and surveys it.
pub(super) fn survey(
    path: &Path,
    backend: VideoBackend,
    progress: &Progress<'_, CountProgress>,
) -> Result<Survey, MediaError> {
    // Text is refused before a backend reads it, and the stated size before a frame is decoded.
    let container = container_of(path)?;
    let described = DescribedVideo::new(path, backend)?;
    let mut capture = described.open(path)?;
    let stated = *capture.stated_properties();
    let size = stated.size;
    ImageLimits::default().check(path, size.width, size.height)?;
    let preroll = if container == Container::Stream {
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
    let deviation_s = deviation_s(&info.clock, &lead.times_s);
    let at_the_start = lead
        .samples
        .iter()
        .filter(|(_, picture)| may_be_interlaced(&info) && is_combed(picture));
    let mut combed = at_the_start.count();

    let mut go_back = false;
    if lead.is_whole {
        // A short video was played as a whole; its times are known. An even clock is preferred
        // where it fits, for it stores no list.
        if deviation_s > ROUNDED_S {
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
        let may_be_even = deviation_s
            <= if container == Container::Mp4 {
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
            && (container == Container::Mp4
                || described.count_packets(path, &mut |count| counter.at(count))? == counted);
        if let Some(count) = counted.filter(|_| is_sure) {
            info.decoded_frames = count;
        } else {
            // 4. No constant rate: times by the sample table, or by decoding everything.
            let times_s = if let Some(times_s) =
                verified_sample_times_s(path, container, &lead, &mut player, &info)?
            {
                times_s.into_iter().map(Some).collect()
            } else {
                play_through(described.open_times(path)?, &counter)?
            };
            // All times may lie on the stated rate after all: then only the count was wrong.
            info.decoded_frames = times_s.len();
            if self::deviation_s(&info.clock, &times_s) > ROUNDED_S {
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
    add_notices(&mut info, stated.pixel_aspect);
    let video = SurveyedVideo {
        info,
        preroll: player.preroll,
        described,
    };
    Ok(Survey {
        video,
        capture: player.capture,
    })
}

fn add_notices(info: &mut VideoInfo, aspect: f64) {
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
    if (aspect - 1.0).abs() > 1e-3 {
        info.notices.push(Notice::PixelsNotSquare { path, aspect });
    }
}

/// Whether frames come at an uneven rate. Where a file was cut off, some of the last frames lack
/// what they refer to and are missing: the number of frames says that already.
fn is_uneven(info: &VideoInfo) -> bool {
    let FrameClock::Listed(times_s) = &info.clock else {
        return false;
    };
    let is_cut_off = info.decoded_frames < info.stated_frames;
    let before_cut = times_s
        .len()
        .saturating_sub(if is_cut_off { REORDERED_FRAMES } else { 0 });
    !times_s
        .iter()
        .enumerate()
        .take(before_cut)
        .all(|(index, time_s)| (time_s - times_s[0] - index as f64 / info.fps).abs() <= ROUNDED_S)
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

/// The largest deviation of the known times from a clock, s.
fn deviation_s(clock: &FrameClock, times_s: &[Option<f64>]) -> f64 {
    // Unknown times, as OpenCV has for the last frames, cannot deviate.
    let distances = times_s
        .iter()
        .enumerate()
        .filter_map(|(index, time_s)| Some(((*time_s)? - clock.pts_s(index)?).abs()));
    distances.fold(0.0, f64::max)
}

/// A clock from the times of all frames. Unknown times, and times that do not increase, follow
/// their predecessor at the stated rate; OpenCV does not know those of the last frames. The player
/// counts such frames as well.
fn clock_from_times(times_s: &[Option<f64>], first_s: f64, fps: f64) -> FrameClock {
    let mut last_s = first_s - 1.0 / fps;
    let mut filled = Vec::with_capacity(times_s.len());
    for time_s in times_s {
        last_s = time_s
            .filter(|&time_s| time_s > last_s)
            .unwrap_or(last_s + 1.0 / fps);
        filled.push(last_s);
    }
    FrameClock::Listed(filled.into())
}

/// Whether the times go back for more frames than a decoder puts in order at a cut, as where
/// recordings were joined: a seek to a time may then lead to either part.
fn times_go_back(clock: &FrameClock, times_s: &[Option<f64>]) -> bool {
    let replaced = times_s
        .iter()
        .enumerate()
        .filter(|(index, time_s)| time_s.is_some() && **time_s != clock.pts_s(*index));
    replaced.count() > REORDERED_FRAMES
}

/// The number of frames, from the index of the last one; `None` if the times do not fit one rate.
/// Bisects between an index that decodes and one that does not, then reads to the end. Adds to
/// `combed` the number of sampled frames that are interlaced.
fn count_to_the_end(
    player: &mut Player,
    info: &VideoInfo,
    combed: &mut usize,
) -> Result<Option<usize>, MediaError> {
    // `good` decodes; `bad` does not, or is so near the end that its time is unknown.
    let mut good = info.decoded_frames - 1;
    let mut bad = info.stated_frames.max(good + 1);
    let mut probe = bad.saturating_sub(TAIL_FRAMES);
    // The first probe is near the stated end, which is usually right; bisection follows only if it
    // fails.
    while probe > good {
        match player.land_at(info, probe)? {
            ReadOutcome::At(landed) => good = landed,
            ReadOutcome::End => bad = probe,
            ReadOutcome::OffBeat => return Ok(None),
        }
        if bad.saturating_sub(good) <= 2 * TAIL_FRAMES {
            break;
        }
        probe = usize::midpoint(good, bad);
    }
    if player.go_to(info, good).is_err() {
        return Ok(None);
    }
    let mut read = 0;
    let last = player.read_to_the_end(info, |capture, index| {
        read += 1;
        let is_sampled = may_be_interlaced(info) && index.is_multiple_of(TAIL_LOOK_FRAMES);
        if is_sampled
            && capture
                .picture(index)
                .is_ok_and(|picture| is_combed(&picture))
        {
            *combed += 1;
        }
    })?;
    // A missing frame near the end, as in a truncated file, would shift the count of those after
    // it: the number read must equal the difference of the indices. Times that go back may even end
    // at a smaller index.
    Ok(last
        .filter(|&last| last.checked_sub(good) == Some(read))
        .map(|last| last + 1))
}

/// The times of an MP4's frames by its sample table, s. `None` if there is no usable table, or if
/// the first frames or those sampled later on do not have the times listed.
fn verified_sample_times_s(
    path: &Path,
    container: Container,
    lead: &Lead,
    player: &mut Player,
    info: &VideoInfo,
) -> Result<Option<Vec<f64>>, MediaError> {
    /// Number of frames sampled over the video. The last ones cannot be reached by a seek.
    const LOOKED_AT: usize = 4;
    let table = if container == Container::Mp4 {
        sample_times_s(path)?
    } else {
        None
    };
    let Some(times_s) = table else {
        return Ok(None);
    };
    // The table may list frames that the decoder drops, or in another order. So the first frames
    // must have its times exactly, and seeks all over the video must land on a listed time.
    let clock = FrameClock::Listed(times_s.clone().into());
    let listed = VideoInfo {
        clock,
        decoded_frames: times_s.len(),
        ..info.clone()
    };
    let agree = deviation_s(&listed.clock, &lead.times_s) <= EXACT_S
        && times_s.len() > lead.times_s.len()
        && (1..=LOOKED_AT).all(|place| {
            let index = place * (times_s.len() - 1) / (LOOKED_AT + 1);
            matches!(player.land_at(&listed, index), Ok(ReadOutcome::At(_)))
        });
    Ok(agree.then_some(times_s))
}

/// The time of every frame, by decoding all of them.
fn play_through(
    mut capture: Box<dyn Capture>,
    counter: &Counter<'_>,
) -> Result<Vec<Option<f64>>, MediaError> {
    let mut times_s = Vec::new();
    while capture.grab()? {
        times_s.push(capture.time_s());
        counter.at(times_s.len())?;
    }
    Ok(times_s)
}

/// Reports the progress of a count at intervals.
struct Counter<'a> {
    path: Arc<Path>,
    stated: usize,
    progress: &'a Progress<'a, CountProgress>,
}

impl Counter<'_> {
    fn at(&self, counted: usize) -> Result<(), MediaError> {
        if !counted.is_multiple_of(COUNT_REPORT_FRAMES) {
            return Ok(());
        }
        let step = CountProgress {
            path: Arc::clone(&self.path),
            counted,
            stated: self.stated,
        };
        match self.progress.report(step) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(MediaError::Stopped {
                path: self.path.to_path_buf(),
            }),
        }
    }
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

/// Whether the frames may be interlaced: such footage has one of a few heights.
fn may_be_interlaced(info: &VideoInfo) -> bool {
    INTERLACED_HEIGHTS.contains(&info.size.height) && info.rotation_deg.is_multiple_of(180)
}

/// Number of interlaced frames among six in the middle of the video: at its beginning and end often
/// nothing moves.
fn count_combed_in_middle(player: &mut Player, info: &VideoInfo) -> usize {
    if !may_be_interlaced(info) {
        return 0;
    }
    // Reading on is cheap, so one seek serves several frames.
    let places = (info.decoded_frames / 2..info.decoded_frames)
        .step_by(4)
        .take(6);
    let pictures = places.filter_map(|index| {
        player.go_to(info, index).ok()?;
        player.capture.picture(index).ok()
    });
    pictures.filter(is_combed).count()
}

/// Recognises the container by its first bytes. Text is rejected: `FFmpeg` would render it as a
/// video, or follow the list of files and addresses in it.
fn container_of(path: &Path) -> Result<Container, MediaError> {
    let mut head = Vec::new();
    open_file(path)?
        .take(64)
        .read_to_end(&mut head)
        .map_err(|error| MediaError::from_io(path, &error))?;
    let is_text = head
        .iter()
        .all(|&byte| byte >= b' ' || byte.is_ascii_whitespace());
    if is_text && !head.starts_with(b"YUV4MPEG2 ") {
        return Err(MediaError::NotAVideo {
            path: path.to_path_buf(),
        });
    }
    Ok(match (head.get(..4), head.get(4..8), head.get(8..12)) {
        (_, Some(b"ftyp" | b"moov" | b"mdat" | b"free" | b"wide" | b"skip"), _) => Container::Mp4,
        (Some(b"\x1a\x45\xdf\xa3"), ..) | (Some(b"RIFF"), _, Some(b"AVI ")) => Container::Indexed,
        _ => Container::Stream,
    })
}

#[cfg(test)]
mod tests {
    use super::super::capture::StatedProperties;
    use super::*;

    const SIZE: ImageSize = ImageSize::new(64, 36);

    /// A video of which only the times matter; a picture shows how many frames were grabbed.
    struct TimesOnly {
        times_s: Vec<f64>,
        grabbed: usize,
        stated: StatedProperties,
        /// The frame before which the reader breaks down, once.
        breaks_at: Option<usize>,
    }

    impl TimesOnly {
        fn new(indices: impl Iterator<Item = i32>) -> Self {
            Self {
                times_s: indices.map(|index| f64::from(index) / 25.0).collect(),
                grabbed: 0,
                stated: StatedProperties {
                    size: SIZE,
                    rotation_deg: 0,
                    fps: 25.0,
                    frames: 100,
                    pixel_aspect: 1.0,
                },
                breaks_at: None,
            }
        }
    }

    fn player(capture: TimesOnly, preroll: usize) -> Player {
        Player {
            capture: Box::new(capture),
            position: None,
            preroll,
        }
    }

    /// A video of 25 frames a second, of which 32 have been played.
    fn info() -> VideoInfo {
        VideoInfo {
            path: Arc::from(Path::new("match.ts")),
            size: SIZE,
            rotation_deg: 0,
            fps: 25.0,
            stated_frames: 100,
            decoded_frames: 32,
            interlaced: false,
            clock: FrameClock::Even {
                first_s: 0.0,
                fps: 25.0,
            },
            notices: Vec::new(),
        }
    }

    impl Capture for TimesOnly {
        fn stated_properties(&self) -> &StatedProperties {
            &self.stated
        }

        fn grab(&mut self) -> Result<bool, MediaError> {
            if self.breaks_at == Some(self.grabbed) {
                self.breaks_at = None;
                return Err(MediaError::ReaderFailed {
                    path: "match.ts".into(),
                    reader: "ffmpeg".to_owned(),
                    reason: "it was ended".to_owned(),
                });
            }
            let is_there = self.grabbed < self.times_s.len();
            self.grabbed += usize::from(is_there);
            Ok(is_there)
        }

        fn time_s(&self) -> Option<f64> {
            self.times_s.get(self.grabbed.checked_sub(1)?).copied()
        }

        fn restart(&mut self) -> Result<(), MediaError> {
            self.grabbed = 0;
            Ok(())
        }

        fn jump_near(&mut self, time_s: f64) {
            let at = self.times_s.iter().position(|at| *at > time_s - 1e-6);
            self.grabbed = at.unwrap_or(self.times_s.len());
        }

        fn picture(&mut self, _: usize) -> Result<Picture, MediaError> {
            Ok(Picture::with_colour(SIZE, [self.grabbed as u8; 4]))
        }
    }

    #[test]
    fn a_last_frame_whose_time_goes_back_is_not_counted_by_its_time() {
        for (last, expected) in [(60, Some(61)), (10, None)] {
            let mut player = player(TimesOnly::new((0..60).chain([last])), 0);
            let counted = count_to_the_end(&mut player, &info(), &mut 0).unwrap();
            assert_eq!(counted, expected, "the last frame has the time of {last}");
        }
    }

    #[test]
    fn frames_of_joined_recordings_are_counted_where_their_times_begin_again() {
        let capture = TimesOnly::new((0..50).chain(0..70));
        let times_s: Vec<Option<f64>> = capture.times_s.iter().copied().map(Some).collect();
        let joined = VideoInfo {
            clock: clock_from_times(&times_s, 0.0, 25.0),
            decoded_frames: times_s.len(),
            ..info()
        };
        assert!(times_go_back(&joined.clock, &times_s));
        assert!(
            !times_go_back(&joined.clock, &times_s[..51]),
            "the last one alone"
        );
        let mut player = player(capture, usize::MAX);
        for index in [49, 50, 100, 20, 119, 60] {
            player.go_to(&joined, index).unwrap();
            let shown = player.capture.picture(index).unwrap().rgba()[0];
            assert_eq!(usize::from(shown), index + 1);
        }
    }

    #[test]
    fn a_reader_that_broke_down_is_started_again_by_the_next_access() {
        let info = VideoInfo {
            decoded_frames: 100,
            ..info()
        };
        let mut capture = TimesOnly::new(0..100);
        capture.breaks_at = Some(40);
        let mut player = player(capture, 0);
        player.go_to(&info, 30).unwrap();
        assert!(player.go_to(&info, 45).is_err());
        assert_eq!(player.position, None);
        player.go_to(&info, 45).unwrap();
        assert_eq!(player.position, Some(45));
    }
}
