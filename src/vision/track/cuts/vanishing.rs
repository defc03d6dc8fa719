//! Gradual transitions of which one picture alone can be followed.
//!
//! # Problem
//!
//! A dissolve into a close-up that follows a walking player is no mixture of the pictures before
//! and after it: until it ends, the close-up has become another picture.
//!
//! # Method
//!
//! The steadier of the two pictures is enough. Its detail D (luminance without the mean around) is
//! followed under the motion of a camera that turns and zooms, predicted from the frames on its own
//! side, as later the other picture may be all that is seen. The share of D that is left in a
//! detail F is ΣDF/ΣD² in least squares: another picture has nothing in common with D, and adds
//! noise alone. In a dissolve the mean of this share over most blocks of the picture falls from 1
//! to 0 along a ramp, in a wipe the number of blocks that are as they were. A camera that turns
//! away loses detail, too, but as much on the other side of the reference, and the pictures before
//! and after agree as far as they overlap.

use super::detail::{Left, Shift};
use super::gradual::{Frames, Gradual, LEAST_CHANGE, Ramp, fit_ramp};
use super::in_order;
use std::ops::Range;

/// Distances of the reference from the middle, frames.
const HALF_WINDOWS: [usize; 3] = [5, 10, 20];
/// Number of frames before the reference that tell its motion.
const BEFORE: usize = 4;
/// Number of frames beyond a window in which a ramp may end.
const BESIDE: usize = 6;
/// Minimum share of the detail that those frames have: a picture that moves by itself cannot be
/// followed.
const LEAST_STEADY: f32 = 0.8;
/// Minimum share of the detail by which the motion is still measured, and not extrapolated.
const FOLLOWED: f32 = 0.3;
/// Maximum root mean square by which the course is off a ramp: at 0.065 pans and hard cuts of three
/// in 25 clips pass, at 0.045 four of 34 drawn transitions do not.
const MOST_MISFIT: f32 = 0.055;
/// Minimum and maximum length of a ramp, frames.
const LENGTHS: Range<usize> = 5..36;
/// Minimum likeness of a block that is still there.
const LIKE: f32 = 0.6;
/// Minimum likeness, in the middle of a wipe, of the blocks that are still there; in a dissolve
/// both pictures are in all of them.
const CLEAR: f32 = 0.85;
/// Number of frames after the ramp that tell what is left by chance, and how much that may be.
const AFTER: usize = 5;
const MOST_LEFT: f32 = 0.3;
/// Maximum number of times that the ramp is fitted again.
const MOST_FITS: usize = 3;
/// Distance of the reference from the ramp in the last fit, frames.
const ASIDE: usize = 2;
/// Maximum share of the detail that one frame may take.
const MOST_AT_ONCE: f32 = 0.4;
/// Minimum share of the detail that is left as many frames away on its own side. A camera that
/// turns away loses as much there.
const LEAST_OWN: f32 = 0.6;

/// The way in time from the picture that is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    Forwards,
    Backwards,
}

impl Way {
    pub const BOTH: [Self; 2] = [Self::Forwards, Self::Backwards];

    fn opposite(self) -> Self {
        match self {
            Self::Forwards => Self::Backwards,
            Self::Backwards => Self::Forwards,
        }
    }

    /// The frame at a distance from another one; negative distances lead back.
    fn from(self, frame: usize, distance: isize) -> Option<usize> {
        frame.checked_add_signed(match self {
            Self::Forwards => distance,
            Self::Backwards => -distance,
        })
    }
}

/// The transition whose middle is near a frame, by what is left of the picture before it, or
/// backwards of that after it; none if there is none.
pub fn find_vanishing(frames: &impl Frames, middle: usize, way: Way) -> Option<Gradual> {
    let found = HALF_WINDOWS.iter().filter_map(|half| {
        let reference = way.from(middle, -(*half as isize))?;
        let mut found = Vanishing::new(frames, reference, way, 2 * half + BESIDE)?;
        // Again with a picture next to the ramp, since when less has moved, until it stays.
        for _ in 0..MOST_FITS {
            if found.begun == ASIDE {
                break;
            }
            let nearer = way.from(found.last_whole, -(ASIDE as isize))?;
            found = Vanishing::new(frames, nearer, way, found.length + ASIDE + BESIDE)?;
        }
        found.check(frames)
    });
    found.min_by(|a, b| a.doubt.total_cmp(&b.doubt))
}

/// What is left of a picture in the frames after it, in one way of time.
#[derive(Debug)]
struct Course {
    /// The share of the detail that is left.
    mixed: Vec<f32>,
    /// The share of the blocks that are still there, and the median likeness of these.
    whole: Vec<f32>,
    clear: Vec<f32>,
    /// Where the last frame has it.
    shift: Shift,
}

impl Course {
    /// Follows a frame over at most `count` others that are kept, with the speed that it has at
    /// first.
    fn new(
        frames: &impl Frames,
        reference: usize,
        way: Way,
        mut speed: Shift,
        count: usize,
    ) -> Option<Self> {
        let followed = frames.frame(reference)?.detail();
        let mut course = Self {
            mixed: vec![1.0],
            whole: vec![1.0],
            clear: vec![1.0],
            shift: Shift::default(),
        };
        let mut is_lost = false;
        for distance in 1..=count {
            let at = way.from(reference, distance as isize);
            let Some(frame) = at.and_then(|at| frames.frame(at)) else {
                break;
            };
            let frame = frame.detail();
            let predicted = course.shift.plus(speed);
            // Once it is nearly gone, it would be found in any picture by chance.
            let measured = (!is_lost)
                .then(|| followed.align(frame, predicted))
                .map(|shift| (shift, followed.compare(frame, shift)))
                .filter(|(_, left)| mean_share(left).is_some_and(|share| share > FOLLOWED));
            is_lost = measured.is_none();
            let left = if let Some((shift, left)) = measured {
                let moved = shift.plus(course.shift.times(-1.0));
                speed = speed.times(0.6).plus(moved.times(0.4));
                course.shift = shift;
                left
            } else {
                course.shift = predicted;
                followed.compare(frame, predicted)
            };
            let Some(share) = mean_share(&left) else {
                break;
            };
            let likeness = left.iter().map(|left| left.likeness);
            let alike: Vec<f32> = likeness.filter(|likeness| *likeness > LIKE).collect();
            course.whole.push(alike.len() as f32 / left.len() as f32);
            course.clear.push(median(alike).unwrap_or_default());
            course.mixed.push(share);
        }
        Some(course)
    }
}

/// How a picture vanishes.
#[derive(Debug)]
struct Vanishing {
    way: Way,
    /// The distance from the reference of the last frame in which all of it is left.
    begun: usize,
    /// That frame.
    last_whole: usize,
    /// Distance from there to the first frame in which nothing is.
    length: usize,
    misfit: f32,
}

impl Vanishing {
    /// Follows a frame over others.
    fn new(frames: &impl Frames, reference: usize, way: Way, count: usize) -> Option<Self> {
        let back = Course::new(frames, reference, way.opposite(), Shift::default(), BEFORE)?;
        if back.mixed.len() <= BEFORE || back.mixed[BEFORE] < LEAST_STEADY {
            return None;
        }
        let speed = back.shift.times(-1.0 / BEFORE as f32);
        let course = Course::new(frames, reference, way, speed, count)?;
        let wiped = fit_fall(&course.whole)
            .filter(|ramp| course.clear[ramp.begin.midpoint(ramp.end)] >= CLEAR);
        let ramp = fit_fall(&course.mixed)
            .into_iter()
            .chain(wiped)
            .min_by(|a, b| a.misfit.total_cmp(&b.misfit))?;
        let length = ramp.end - ramp.begin;
        // A hard cut takes all of it at once.
        let steps = course.mixed.windows(2).map(|pair| pair[0] - pair[1]);
        let is_ramp = ramp.misfit <= MOST_MISFIT
            && LENGTHS.contains(&length)
            && steps.fold(0.0, f32::max) <= MOST_AT_ONCE;
        is_ramp.then_some(Self {
            way,
            begun: ramp.begin,
            last_whole: way.from(reference, ramp.begin as isize)?,
            length,
            misfit: ramp.misfit,
        })
    }

    /// The transition, if the pictures on either side of it differ as two shots do, and the one
    /// that is followed stays as long on its own side.
    fn check(&self, frames: &impl Frames) -> Option<Gradual> {
        let first_without = self.way.from(self.last_whole, self.length as isize)?;
        let (whole, without) = (frames.frame(self.last_whole)?, frames.frame(first_without)?);
        let own_side = self.way.opposite();
        let own = Course::new(
            frames,
            self.last_whole,
            own_side,
            Shift::default(),
            self.length,
        )?;
        let change = whole.difference_over_zoom(without);
        let (last, first) = match self.way {
            Way::Forwards => (self.last_whole, first_without),
            Way::Backwards => (first_without, self.last_whole),
        };
        let is_found = 2 * own.mixed.len() > self.length
            && own.mixed.last().is_some_and(|left| *left >= LEAST_OWN)
            && change >= LEAST_CHANGE
            && !(last + 1..=first).any(|at| frames.is_abrupt(at, change));
        is_found.then_some(Gradual {
            frames: last + 1..first,
            doubt: self.misfit,
        })
    }
}

/// The ramp in which a course falls from 1 to what two pictures have in common by chance or by
/// graphics that both have.
fn fit_fall(course: &[f32]) -> Option<Ramp> {
    let end = course.len().saturating_sub(AFTER);
    let rest = median(course[end..].iter().copied())?.max(0.0);
    if rest > MOST_LEFT {
        return None;
    }
    let gone = course
        .iter()
        .map(|left| ((1.0 - left) / (1.0 - rest)).clamp(0.0, 1.0));
    fit_ramp(&gone.collect::<Vec<f32>>())
}

/// The mean share of the detail that is left in the middle half of the blocks, by their power.
fn mean_share(left: &[Left]) -> Option<f32> {
    let mut sorted = left.to_vec();
    sorted.sort_by(|a, b| a.share.total_cmp(&b.share));
    let quarter = sorted.len() / 4;
    let middle = sorted.get(quarter..sorted.len() - quarter)?;
    let power: f32 = middle.iter().map(|left| left.power).sum();
    let sum: f32 = middle.iter().map(|left| left.share * left.power).sum();
    (power > 0.0).then(|| sum / power)
}

fn median(values: impl IntoIterator<Item = f32>) -> Option<f32> {
    let values = in_order(values);
    values.get(values.len() / 2).copied()
}
