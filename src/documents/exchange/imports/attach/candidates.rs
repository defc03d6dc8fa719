//! The ways in which numbered cameras may count the frames of a video.
//!
//! | numbers of the cameras | ways, the most plausible first |
//! |---|---|
//! | within those of the video | from 0; from 1, unless one is 0. From 1 first where the first is 1 |
//! | beyond the end by one | from 1 |
//! | beyond the end, and they span half of the video or more | the beginning is cut off: the first camera is of the first frame; the last camera of the last frame |
//! | beyond the end whatever is subtracted | as from 0 or 1, if that leaves few cameras over; else none |
//!
//! A document may have every n-th frame of a video only. Then a number may also count the frames of
//! the document. What gives more cameras a frame is more plausible.

use std::cmp::Reverse;
use std::collections::BTreeSet;

/// A camera and the frame that it is attached to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AttachedPair {
    /// The imported frame, by its position in the imported document.
    pub imported: usize,
    /// The frame of the video, counted from 0 among those that decode.
    pub frame_index: u64,
}

/// What the numbers of cameras count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Counting {
    /// The frames of the video.
    VideoFrames,
    /// The frames of the video that the document has.
    DocumentFrames,
}

/// One way to attach cameras to the frames of a video.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AttachmentCandidate {
    /// The number that means the first frame: what is subtracted from each number.
    pub first_number: u64,
    /// What is counted from there.
    pub counting: Counting,
    /// The cameras that have a frame, in their order; no frame occurs twice.
    pub pairs: Vec<AttachedPair>,
    /// Which number of the names it is, where they have several: `f00017 in f00017_t000680ms.jpg`.
    pub number: Option<String>,
}

/// The numbers of cameras beside those of a video's frames.
pub struct NumberedCameras<'a> {
    numbers: &'a [Option<u64>],
    /// The smallest and the largest of them.
    range: [u64; 2],
    /// The frames of the video that the document has, ascending.
    video: &'a [u64],
    /// Whether they are known to count from 0 unless they cannot.
    counts_from_zero: bool,
}

impl<'a> NumberedCameras<'a> {
    /// None where there is no number or no frame. `video` is ascending, without repetitions.
    pub fn new(
        numbers: &'a [Option<u64>],
        video: &'a [u64],
        counts_from_zero: bool,
    ) -> Option<Self> {
        let known = numbers.iter().copied().flatten();
        let range = [known.clone().min()?, known.max()?];
        (!video.is_empty()).then_some(Self {
            numbers,
            range,
            video,
            counts_from_zero,
        })
    }

    /// The smallest and the largest number.
    pub const fn range(&self) -> [u64; 2] {
        self.range
    }

    /// The plausible ways, the most plausible first.
    pub fn candidates(&self) -> Vec<AttachmentCandidate> {
        let mut trials: Vec<Trial> = Vec::new();
        for counting in [Counting::VideoFrames, Counting::DocumentFrames] {
            // The two are the same for a document that has all frames.
            if counting == Counting::VideoFrames || !self.has_whole_video() {
                trials.extend(self.trials(counting));
            }
        }
        // Ways that leave cameras outside of the video are only for the case that every way does.
        if trials.iter().any(|trial| self.fits_all(trial)) {
            trials.retain(|trial| self.fits_all(trial));
        }
        trials.sort_by_key(|trial| {
            let candidate = &trial.candidate;
            (
                Reverse(candidate.pairs.len()),
                candidate.counting,
                trial.rank,
            )
        });
        trials.into_iter().map(|trial| trial.candidate).collect()
    }

    /// Whether the number of every camera lies within the video.
    const fn fits_all(&self, trial: &Trial) -> bool {
        trial.inside == self.numbers.len()
    }

    /// Whether the document has each frame up to its last one.
    fn has_whole_video(&self) -> bool {
        self.video.last().copied() == Some(self.video.len() as u64 - 1)
    }

    /// The first and the last frame as numbers count them.
    fn ends(&self, counting: Counting) -> [u64; 2] {
        let (first, last) = (self.video[0], self.video[self.video.len() - 1]);
        match counting {
            Counting::VideoFrames => [first, last],
            Counting::DocumentFrames => [0, self.video.len() as u64 - 1],
        }
    }

    /// The ways that are plausible for themselves.
    fn trials(&self, counting: Counting) -> Vec<Trial> {
        let [first_frame, last_frame] = self.ends(counting);
        let [first, last] = self.range;
        let starts_at_one = first == 1 && !self.counts_from_zero;
        let mut shifts = if starts_at_one {
            vec![1, 0]
        } else {
            vec![0, 1]
        };
        let usual = shifts.len();
        // The beginning of the video is cut off: the numbers count a longer one. Cameras of a short
        // part of it could be anywhere, so that they must span half of the video.
        let (span, video_span) = (last - first, last_frame - first_frame);
        if last > last_frame && span <= video_span && span >= video_span / 2 {
            shifts.extend(first.checked_sub(first_frame));
            shifts.extend(last.checked_sub(last_frame));
        }
        let mut trials: Vec<Trial> = Vec::new();
        for (rank, shift) in shifts.into_iter().enumerate() {
            let is_new = trials
                .iter()
                .all(|trial| trial.candidate.first_number != shift);
            // A number below the subtracted one would be of no frame; and two reasons may give the
            // same shift.
            if shift > first || !is_new {
                continue;
            }
            let trial = self.subtract(shift, counting, rank);
            // The usual ways may lose a few cameras at the end, a guessed shift none.
            let fits = if rank < usual {
                is_most(trial.inside, self.numbers.len())
            } else {
                self.fits_all(&trial)
            };
            if fits && !trial.candidate.pairs.is_empty() {
                trials.push(trial);
            }
        }
        trials
    }

    /// The frames that cameras get if a number is subtracted from theirs.
    fn subtract(&self, shift: u64, counting: Counting, rank: usize) -> Trial {
        let [_, last_frame] = self.ends(counting);
        let (mut pairs, mut inside) = (Vec::new(), 0);
        let mut used = BTreeSet::new();
        for (imported, number) in self.numbers.iter().enumerate() {
            let Some(frame) = number.and_then(|number| number.checked_sub(shift)) else {
                continue;
            };
            if frame > last_frame {
                continue;
            }
            // Within the video, whether or not the document has that frame.
            inside += 1;
            let frame_index = match counting {
                Counting::VideoFrames => self.video.binary_search(&frame).ok().map(|_| frame),
                Counting::DocumentFrames => self.video.get(frame as usize).copied(),
            };
            if let Some(frame_index) = frame_index
                && used.insert(frame_index)
            {
                pairs.push(AttachedPair {
                    imported,
                    frame_index,
                });
            }
        }
        Trial {
            candidate: AttachmentCandidate {
                first_number: shift,
                counting,
                pairs,
                number: None,
            },
            inside,
            rank,
        }
    }
}

/// A way, and how well it fits.
struct Trial {
    candidate: AttachmentCandidate,
    /// The cameras whose numbers lie within the video.
    inside: usize,
    /// Its order among ways that give equally many cameras a frame.
    rank: usize,
}

/// Whether a part is nine tenths of all: a video may decode to a few frames less than were
/// calibrated, but not to many less.
pub const fn is_most(part: usize, all: usize) -> bool {
    part * 10 >= all * 9
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Instant;

    fn candidates(
        numbers: impl IntoIterator<Item = u64>,
        video: &[u64],
    ) -> Vec<AttachmentCandidate> {
        let numbers: Vec<Option<u64>> = numbers.into_iter().map(Some).collect();
        NumberedCameras::new(&numbers, video, false)
            .unwrap()
            .candidates()
    }

    /// What is subtracted by each candidate for a video of 211 frames, and how many cameras have a
    /// frame.
    fn shifts(numbers: impl IntoIterator<Item = u64>) -> Vec<(u64, usize)> {
        let video: Vec<u64> = (0..211).collect();
        candidates(numbers, &video)
            .into_iter()
            .map(|candidate| (candidate.first_number, candidate.pairs.len()))
            .collect()
    }

    #[test]
    fn numbers_within_the_video_leave_0_and_1_open() {
        assert_eq!(shifts(0..211), [(0, 211)]);
        assert_eq!(shifts(1..212), [(1, 211)], "as many as the video has");
        assert_eq!(shifts(10..50), [(0, 40), (1, 40)]);
        assert_eq!(shifts(1..50), [(1, 49), (0, 49)], "they start at 1");
        assert_eq!(shifts([17]), [(0, 1), (1, 1)]);
        assert_eq!(shifts([0]), [(0, 1)]);
        assert_eq!(shifts((0..211).step_by(7)), [(0, 31)], "gaps");
    }

    #[test]
    fn a_cut_beginning_is_subtracted() {
        assert_eq!(shifts(5000..5211), [(5000, 211)]);
        assert_eq!(shifts(5000..5200), [(5000, 200), (4989, 200)]);
        assert_eq!(shifts(5000..5020), [], "a short part could be anywhere");
        assert_eq!(shifts([5000]), []);
    }

    #[test]
    fn more_cameras_than_frames_are_left_over_or_of_another_video() {
        assert_eq!(shifts(0..214), [(0, 211)]);
        assert_eq!(shifts(1..215), [(1, 211), (0, 210)]);
        assert_eq!(shifts(0..400), []);
        assert_eq!(shifts(7000..7400), []);
    }

    #[test]
    fn a_frame_is_given_once() {
        let video: Vec<u64> = (0..5).collect();
        let found = candidates([0, 1, 1, 2], &video);
        let imported: Vec<usize> = found[0].pairs.iter().map(|pair| pair.imported).collect();
        assert_eq!(imported, [0, 1, 3]);
    }

    #[test]
    fn every_fifth_frame_is_counted_as_the_video_or_as_the_document_counts() {
        let video: Vec<u64> = (0..211).map(|frame| 5 * frame).collect();
        let by_video = candidates(video.iter().copied(), &video);
        assert_eq!(by_video.len(), 1);
        assert_eq!(by_video[0].counting, Counting::VideoFrames);
        assert_eq!(by_video[0].pairs.len(), 211);
        let all = candidates(0..1051, &video);
        assert_eq!(
            (all.len(), all[0].counting, all[0].pairs.len()),
            (1, Counting::VideoFrames, 211)
        );
        let by_document = candidates(0..211, &video);
        assert_eq!(
            (by_document[0].counting, by_document[0].pairs.len()),
            (Counting::DocumentFrames, 211)
        );
        assert_eq!(by_document[0].pairs[3].frame_index, 15);
        assert_eq!(by_document[1].counting, Counting::VideoFrames);
    }

    #[test]
    fn a_hundred_thousand_cameras_take_no_time() {
        let video: Vec<u64> = (0..100_000).collect();
        let start = Instant::now();
        assert_eq!(candidates(1..100_001, &video)[0].pairs.len(), 100_000);
        assert!(start.elapsed().as_secs_f64() < 5.0);
        assert_eq!(candidates([u64::MAX, 0], &video), []);
    }
}
