//! Gradual transitions: dissolves, wipes and wipes with a graphic, with the frames that they take.
//!
//! # Problem
//!
//! In a dissolve neighbouring frames differ no more than in a pan. What tells them apart is that
//! each frame is a mixture (1 − α) A + α B of one picture before and one after, and that α rises
//! from 0 to 1 once. In a wipe each cell shows one of the two pictures.
//!
//! # Method
//!
//! Around each frame at which the pictures before and after differ under every shift, windows of
//! several lengths are tried: A and B are the frames at their ends. α follows by least squares; it
//! is hardly disturbed by what moves in A and B. A ramp fitted to α gives the first and the last
//! frame of the transition. It counts if the frames within are explained as mixtures or as parts of
//! the two pictures next to it, if these differ under shift and zoom, and if the pictures on either
//! side agree with each other: in a pan or a zoom that goes on, they do not.

use super::miniature::Miniature;
use std::ops::Range;

/// Half lengths of the windows, frames. A dissolve takes a fifth of a second to two seconds.
const HALF_WINDOWS: [usize; 5] = [4, 6, 10, 16, 28];
/// Number of frames on either side of a window in which a ramp may begin or end.
const BESIDE: usize = 6;
/// Number of frames on each side of a frame that [`find_gradual`] uses.
pub const REACH: usize = HALF_WINDOWS[HALF_WINDOWS.len() - 1] + BESIDE;
/// Minimum difference between the pictures before and after a transition, grey levels.
pub const LEAST_CHANGE: f32 = 12.0;
/// Minimum share of the cells that differ by [`CHANGED`] grey levels. A player who crosses a
/// close-up changes fewer.
pub const LEAST_CHANGED_SHARE: f32 = 0.45;
pub const CHANGED: f32 = 8.0;
/// Maximum mean difference of the frames from mixtures, and from parts of both pictures, relative
/// to the difference of the two pictures.
const MOST_OFF_MIXTURE: f32 = 0.36;
const MOST_OFF_EITHER: f32 = 0.2;
/// Maximum difference between the frames of one side, relative to the difference of the two
/// pictures.
const MOST_INCOHERENT: f32 = 0.55;
/// Maximum share of the change that one frame may bring; a hard cut brings all of it.
const MOST_OF_CHANGE: f32 = 0.5;
/// Maximum doubt of a transition beside which a camera may turn or zoom fast.
const EXACT: f32 = 0.35;
/// Distance of the pictures to which the second ramp is fitted from the first ramp, frames.
const ASIDE: usize = 4;
/// Maximum share of the cells in which a frame beside a wipe shows the other picture, by chance.
const WIPED: f32 = 0.04;
/// Maximum number of frames by which a wipe is longer than a ramp at each end.
const MOST_UNEVEN: usize = 2;
/// Maximum number of times that the ramp is fitted to nearer pictures.
const MOST_FITS: usize = 4;
/// Minimum length of a ramp, frames; a shorter one is a hard cut.
const LEAST_RAMP: usize = 3;

/// A transition that takes time.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradual {
    /// Its frames; the first frame of the new shot follows.
    pub frames: Range<usize>,
    /// What the transition leaves unexplained of its frames and of α; of two that overlap, the
    /// one with less is right.
    pub doubt: f32,
}

/// The frames that are still kept, by their number in the video.
pub trait Frames {
    /// A frame; none before the first and after the last that is kept.
    fn frame(&self, number: usize) -> Option<&Miniature>;
    /// The difference of a frame from the one before it under the best shift, grey levels.
    fn step(&self, number: usize) -> f32;

    /// Whether a frame brings so much of a change that it is a hard cut.
    fn is_abrupt(&self, number: usize, change: f32) -> bool {
        self.step(number) > MOST_OF_CHANGE * change
    }
}

/// The gradual transition whose middle is near a frame; none if there is none.
pub fn find_gradual(frames: &impl Frames, middle: usize) -> Option<Gradual> {
    let windows = HALF_WINDOWS.iter().filter_map(|half| {
        let window = middle.checked_sub(*half)?..middle + half;
        let ends = Ends::new(frames, window.clone())?;
        let mut within = window.clone();
        if ends.change < LEAST_CHANGE || within.any(|at| frames.is_abrupt(at + 1, ends.change)) {
            return None;
        }
        let at = [middle - half / 2, middle, middle + half / 2];
        let off = ends.mean_mixture_error(at)?;
        (off <= 1.0).then_some((off / ends.change.sqrt(), ends))
    });
    let (_, ends) = windows.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
    // Again with the pictures next to the ramp, in which less has moved, until it stays.
    let (mut ramp, _) = ends.fit_ramp()?;
    let mut found = None;
    for _ in 0..MOST_FITS {
        let nearer = ramp.start.saturating_sub(ASIDE)..ramp.end + ASIDE - 1;
        let Some((next, of_next)) = Ends::new(frames, nearer).and_then(|ends| ends.fit_ramp())
        else {
            break;
        };
        found = check(frames, next.clone(), of_next).or(found);
        if next == ramp {
            break;
        }
        ramp = next;
    }
    found
}

/// The two pictures of a transition.
struct Ends<'a, F> {
    frames: &'a F,
    /// The number of the picture before, and of that after.
    window: Range<usize>,
    before: &'a Miniature,
    after: &'a Miniature,
    /// The difference of the two, grey levels.
    change: f32,
}

impl<'a, F: Frames> Ends<'a, F> {
    /// The frames at the ends of a window.
    fn new(frames: &'a F, window: Range<usize>) -> Option<Self> {
        let (before, after) = (frames.frame(window.start)?, frames.frame(window.end)?);
        Some(Self {
            frames,
            change: before.plain_difference(after),
            window,
            before,
            after,
        })
    }

    /// The mean of [`mixture_error`] over some frames.
    fn mean_mixture_error(&self, at: impl IntoIterator<Item = usize>) -> Option<f32> {
        let (mut sum, mut count) = (0.0, 0);
        for at in at {
            sum += mixture_error(self.frames.frame(at)?, self.before, self.after);
            count += 1;
        }
        (count > 0).then(|| sum / count as f32)
    }

    /// The frames in which α rises from 0 to 1, by a straight ramp in least squares, and the root
    /// mean square of what is left of α.
    fn fit_ramp(&self) -> Option<(Range<usize>, f32)> {
        // The ramp may begin and end beside the window, but not beyond a hard cut.
        let window = &self.window;
        let first = (window.start.saturating_sub(BESIDE)..window.start)
            .rev()
            .take_while(|at| !self.frames.is_abrupt(at + 1, self.change))
            .last()
            .unwrap_or(window.start);
        let last = (window.end + 1..=window.end + BESIDE)
            .take_while(|at| !self.frames.is_abrupt(*at, self.change))
            .last()
            .unwrap_or(window.end);
        // In a wipe the cells are counted, so that those in which both pictures are alike, and
        // those in which they differ most, do not distort where it begins.
        let is_wipe = is_wiped(
            self.frames.frame(window.start.midpoint(window.end))?,
            self.before,
            self.after,
        );
        let shares: Vec<f32> = (first..=last)
            .map_while(|at| {
                let frame = self.frames.frame(at)?;
                Some(if is_wipe {
                    frame.share_of_cells(self.before, self.after, CHANGED)
                } else {
                    frame.share_of(self.before, self.after)
                })
            })
            .collect();
        let Ramp { begin, end, misfit } = fit_ramp(&shares)?;
        // A wipe is not as even as a ramp where its edge is slanted or curved.
        let (begin, end) = if is_wipe {
            let before = shares[..=begin].iter().rev().take(MOST_UNEVEN);
            let earlier = before.take_while(|share| **share > WIPED).count();
            let after = shares[end..].iter().take(MOST_UNEVEN);
            let later = after.take_while(|share| **share < 1.0 - WIPED).count();
            (
                begin.saturating_sub(earlier),
                (end + later).min(shares.len() - 1),
            )
        } else {
            (begin, end)
        };
        Some((first + begin + 1..first + end, misfit))
    }
}

/// A course that rises from 0 to 1 along a straight line, and is constant beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    /// The last place at which it is 0, and the first one at which it is 1.
    pub begin: usize,
    pub end: usize,
    /// The root mean square of what it leaves of the course.
    pub misfit: f32,
}

/// The ramp nearest to a course, in least squares.
pub fn fit_ramp(shares: &[f32]) -> Option<Ramp> {
    let ramps = (0..shares.len()).flat_map(|begin| {
        let ends = begin + 1..shares.len();
        ends.map(move |end| (begin, end))
    });
    let misfit = |&(begin, end): &(usize, usize)| -> f32 {
        let slope = 1.0 / (end - begin) as f32;
        let misfits = shares.iter().enumerate().map(|(at, share)| {
            let ramp = (at as f32 - begin as f32) * slope;
            (share - ramp.clamp(0.0, 1.0)).powi(2)
        });
        misfits.sum()
    };
    let (misfit, (begin, end)) = ramps
        .map(|ramp| (misfit(&ramp), ramp))
        .min_by(|(a, _), (b, _)| a.total_cmp(b))?;
    Some(Ramp {
        begin,
        end,
        misfit: (misfit / shares.len() as f32).sqrt(),
    })
}

/// How far a frame is from a mixture of two pictures or from parts of both, relative to what is
/// allowed; at most 1 in a transition.
fn mixture_error(frame: &Miniature, before: &Miniature, after: &Miniature) -> f32 {
    let change = before.plain_difference(after).max(f32::EPSILON);
    let share = frame.share_of(before, after).clamp(0.0, 1.0);
    let off_mixture = frame.difference_from_mixture(before, after, share) / change;
    let off_either = frame.difference_from_either(before, after) / change;
    (off_mixture / MOST_OFF_MIXTURE).min(off_either / MOST_OFF_EITHER)
}

/// Whether a frame rather consists of parts of two pictures than of their mixture.
fn is_wiped(frame: &Miniature, before: &Miniature, after: &Miniature) -> bool {
    let share = frame.share_of(before, after).clamp(0.0, 1.0);
    frame.difference_from_either(before, after)
        < 0.5 * frame.difference_from_mixture(before, after, share)
}

/// The transition with these frames, if pictures before, within and after it agree with that.
fn check(frames: &impl Frames, ramp: Range<usize>, misfit: f32) -> Option<Gradual> {
    if ramp.len() + 1 < LEAST_RAMP {
        return None;
    }
    let last_before = ramp.start.checked_sub(1)?;
    let (before, after) = (frames.frame(last_before)?, frames.frame(ramp.end)?);
    let change = before.plain_difference(after);
    if change < LEAST_CHANGE || before.share_of_changed_cells(after, CHANGED) < LEAST_CHANGED_SHARE
    {
        return None;
    }
    let ends = Ends::new(frames, last_before..ramp.end)?;
    let off = ends.mean_mixture_error(ramp.clone())?;
    if off > 1.0 {
        return None;
    }
    // The most expensive test last. A pan or a zoom that goes on changes as much in the same time
    // before and after, so each side is compared over the length of the transition, as far as its
    // shot goes.
    let moved = before.difference_over_zoom(after);
    let is_steady = |from: Option<&Miniature>, to: &Miniature| {
        from.is_none_or(|from| from.difference(to) <= MOST_INCOHERENT * moved)
    };
    let length = ramp.len().max(BESIDE);
    let earlier = (last_before.saturating_sub(length)..last_before)
        .rev()
        .take_while(|at| frames.frame(*at).is_some() && !frames.is_abrupt(at + 1, change))
        .last();
    let later = (ramp.end + 1..=ramp.end + length)
        .take_while(|at| frames.frame(*at).is_some() && !frames.is_abrupt(*at, change))
        .last();
    let is_coherent = is_steady(earlier.and_then(|at| frames.frame(at)), before)
        && is_steady(later.and_then(|at| frames.frame(at)), after);
    let doubt = off + 4.0 * misfit;
    // A mixture this exact is none of a camera's motion, whatever moves beside it.
    (moved >= LEAST_CHANGE && (is_coherent || doubt <= EXACT)).then_some(Gradual {
        frames: ramp,
        doubt,
    })
}
