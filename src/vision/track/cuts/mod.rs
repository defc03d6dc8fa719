//! Shot boundary detection.
//!
//! A hard cut is a frame that differs from the previous one far more than neighbouring frames
//! differ from each other, under every shift of the picture, and stays different: a camera's flash
//! lasts one or two frames, and then the old picture is back. Other transitions take time, and
//! their frames show two pictures, or none:
//!
//! | transition | is found by |
//! |---|---|
//! | fade over black or white | a run of nearly empty frames, with the frames in which the contrast falls and rises |
//! | dissolve, wipe | `gradual.rs`: mixtures or parts of both pictures; `vanishing.rs`: of one |
//! | wipe with a graphic | `graphic.rs`: a run of frames that each change as in a cut |
//!
//! Frames are reduced to miniatures as they come, and only the last few of these are kept, so that
//! a whole match can be searched in one pass.

mod detail;
mod gradual;
mod graphic;
mod miniature;
mod vanishing;

use crate::media::Picture;
use gradual::{CHANGED, Frames, Gradual, LEAST_CHANGE, REACH, find_gradual};
use graphic::MOST_GRAPHIC;
use miniature::Miniature;
use std::collections::VecDeque;
use std::ops::Range;
use vanishing::{Way, find_vanishing};

/// Minimum difference of a cut, grey levels. Neighbouring frames of the fastest pans and zooms of
/// two broadcasts differ by up to 5.3.
const LEAST_CUT: f32 = 6.0;
/// Minimum ratio of a cut's difference to the median difference around it.
const CUT_OVER_MOTION: f32 = 2.5;
/// Minimum share of the picture that a cut changes. A player who enters a close-up changes less.
const LEAST_CUT_AREA: f32 = 0.4;
/// A change of about the whole picture is a cut if it is that much larger than the largest
/// difference around it.
const WHOLE_AREA: f32 = 0.85;
const CUT_OVER_LARGEST: f32 = 1.2;
/// Maximum length of a flash, frames.
const LONGEST_FLASH: usize = 3;
/// Number of differences on each side that measure the usual motion around a frame.
const AROUND: usize = 4;
/// Half the distance of the frames that are compared to notice a gradual transition.
const HALF_CHANGE: usize = 8;
/// Frames of lower contrast are empty, grey levels.
const EMPTY: f32 = 4.0;
/// Maximum length of a run of empty frames within a fade; a longer one is a shot of its own.
const MOST_EMPTY: usize = 32;
/// In a fade the contrast changes by at least this much from frame to frame, grey levels.
const FADE_STEP: f32 = 0.4;
/// Maximum length of each half of a fade, frames.
const HALF_FADE: usize = 30;
/// Pictures are followed at every frame of this number, and the minimum number of these that find a
/// transition: the pans that look like one do so from one or two.
const VANISHING_STRIDE: usize = 3;
const LEAST_VANISHING: usize = 2;
/// Hard cuts within this many frames belong to one transition: no shot is that short.
const NO_SHOT: usize = 10;
/// Number of frames that a transition is examined after, so that what follows it is known.
const LAG: usize = REACH;
/// Number of frames that are kept.
const KEPT: usize = LAG + REACH + MOST_GRAPHIC;

/// A shot boundary.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundCut {
    /// The first frame of the new shot, from 0.
    pub frame: usize,
    /// The frames before it that belong to neither shot, as they show both pictures or none; empty
    /// for a hard cut.
    pub transition: Range<usize>,
}

impl FoundCut {
    /// Whether the new shot begins after frames that belong to no shot.
    pub fn is_gradual(&self) -> bool {
        !self.transition.is_empty()
    }
}

/// Detects cuts in frames that are pushed one after the other without gaps.
#[derive(Debug, Default)]
struct CutFinder {
    /// The latest frames.
    latest: VecDeque<Miniature>,
    measured: Vec<CutMeasurements>,
    /// Dissolves and wipes.
    gradual: Vec<Gradual>,
    /// Both, by what is left of the picture before, and of that after.
    vanishing: [Vec<Gradual>; 2],
    /// Wipes with a graphic.
    graphics: Vec<Range<usize>>,
}

/// Measurements of one frame.
#[derive(Clone, Copy, Debug)]
struct CutMeasurements {
    /// The difference from the previous frame, grey levels.
    step: f32,
    /// The smallest difference between a frame before it and itself or a later one, as far apart
    /// as a flash is long. At a flash it is small.
    lasting: f32,
    /// Whether the frames before and after it differ as in a gradual transition.
    changes: bool,
    contrast: f32,
    /// The share of the picture that differs from the previous frame, where the step may be a cut.
    changed: f32,
}

/// The cuts in a sequence of pictures without gaps. A picture that could not be decoded (none)
/// counts as a repetition of the one before it.
pub fn find_cuts(pictures: impl IntoIterator<Item = Option<Picture>>) -> Vec<FoundCut> {
    let mut finder = CutFinder::default();
    let mut last: Option<Miniature> = None;
    // A repeated picture keeps the numbers of the frames that follow, and is no cut. Pictures
    // missing at the start have nothing to repeat: the finder counts from the first one there.
    let mut missing = 0;
    for picture in pictures {
        last = picture.as_ref().map(Miniature::from_picture).or(last);
        match &last {
            Some(miniature) => finder.push(miniature.clone()),
            None => missing += 1,
        }
    }
    finder
        .finish()
        .into_iter()
        .map(|cut| FoundCut {
            frame: cut.frame + missing,
            transition: cut.transition.start + missing..cut.transition.end + missing,
        })
        .collect()
}

impl Frames for CutFinder {
    fn frame(&self, number: usize) -> Option<&Miniature> {
        let first = self.measured.len() - self.latest.len();
        self.latest.get(number.checked_sub(first)?)
    }

    fn step(&self, number: usize) -> f32 {
        self.measured.get(number).map_or(0.0, |frame| frame.step)
    }
}

impl CutFinder {
    /// Adds the next frame.
    fn push(&mut self, frame: Miniature) {
        // The first frame has no predecessor and is no cut: its difference is 0.
        let step = self.difference_from(1, &frame).unwrap_or(0.0);
        // A change persists if no later frame looks like an earlier one.
        let mut lasting = step;
        for back in 2..=LONGEST_FLASH + 1 {
            let spanned = self.measured.len().saturating_sub(back - 1)..self.measured.len();
            let is_any = |of: &[CutMeasurements]| of.iter().any(|of| of.step >= LEAST_CUT);
            if step < LEAST_CUT && !is_any(&self.measured[spanned.clone()]) {
                continue;
            }
            let Some(over) = self.difference_from(back, &frame) else {
                break;
            };
            lasting = lasting.min(over);
            for frame in &mut self.measured[spanned] {
                frame.lasting = frame.lasting.min(over);
            }
        }
        let changed = match self.latest.back() {
            Some(last) if step >= LEAST_CUT => last.share_of_changed_cells(&frame, CHANGED),
            _ => 0.0,
        };
        self.measured.push(CutMeasurements {
            step,
            lasting,
            changes: false,
            contrast: frame.contrast(),
            changed,
        });
        self.latest.push_back(frame);
        if self.latest.len() > KEPT {
            self.latest.pop_front();
        }
        let newest = self.measured.len() - 1;
        if let Some(middle) = newest.checked_sub(HALF_CHANGE) {
            self.measured[middle].changes = self.changes_around(middle);
        }
        if let Some(at) = newest.checked_sub(LAG) {
            self.examine(at);
        }
    }

    /// Examines the frames that have no successors enough, and returns the cuts in frame order.
    fn finish(&mut self) -> Vec<FoundCut> {
        for at in self.measured.len().saturating_sub(LAG)..self.measured.len() {
            self.examine(at);
        }
        self.cuts()
    }

    /// The difference of a new frame from the one `back` frames before it; `None` if there is none.
    fn difference_from(&self, back: usize, frame: &Miniature) -> Option<f32> {
        let at = self.latest.len().checked_sub(back)?;
        Some(frame.difference(self.latest.get(at)?))
    }

    /// Whether the frames before and after one differ under every shift.
    fn changes_around(&self, middle: usize) -> bool {
        let before = middle.checked_sub(HALF_CHANGE);
        let (Some(before), Some(after)) = (
            before.and_then(|at| self.frame(at)),
            self.frame(middle + HALF_CHANGE),
        ) else {
            return false;
        };
        // The difference under the best shift is rarely the larger one, and far more expensive.
        before.plain_difference(after) >= LEAST_CHANGE && before.difference(after) >= LEAST_CHANGE
    }

    /// Looks for a gradual transition with its middle, and for a wipe with a graphic with its end,
    /// at a frame.
    fn examine(&mut self, at: usize) {
        if self.measured[at].changes {
            self.gradual.extend(find_gradual(self, at));
            if at.is_multiple_of(VANISHING_STRIDE) {
                let found = Way::BOTH.map(|way| find_vanishing(self, at, way));
                for (known, found) in self.vanishing.iter_mut().zip(found) {
                    known.extend(found);
                }
            }
        }
        let found = self.graphic_until(at);
        self.graphics.extend(found);
    }

    /// The cuts among the frames added so far, in frame order.
    fn cuts(&self) -> Vec<FoundCut> {
        let mut spans = self.fades();
        // What darkens in a fade also changes as in a wipe.
        let graphics = self.graphics.iter();
        let apart: Vec<_> = graphics
            .filter(|frames| is_apart(&spans, frames))
            .cloned()
            .collect();
        spans.extend(apart);
        let hard: Vec<usize> = (1..self.measured.len())
            .filter(|&frame| self.is_cut(frame))
            .collect();
        // One hard cut within a dissolve or wipe is all that there is: a mixture changes by a
        // little in each frame.
        let gradual = self.gradual.iter().filter(|found| {
            let Range { start, end } = found.frames;
            let cuts = hard.iter().filter(|cut| (start..=end).contains(*cut));
            cuts.count() != 1
        });
        spans.extend(best_of_each(gradual, 1));
        // Where both pictures explain a transition, its ends are exact; else each picture that was
        // followed tells its own end.
        let of_one = self.vanishing.each_ref().map(|found| {
            let new = found.iter().filter(|found| is_apart(&spans, &found.frames));
            best_of_each(new, LEAST_VANISHING)
        });
        spans.extend(of_one.into_iter().flatten());
        // Hard cuts close to each other are part of one transition.
        let close = hard.windows(2).filter(|pair| pair[1] - pair[0] <= NO_SHOT);
        spans.extend(close.map(|pair| pair[0]..pair[1]));
        let spans = merge(spans);
        let mut cuts: Vec<FoundCut> = hard
            .into_iter()
            .filter(|frame| is_apart(&spans, &(frame.saturating_sub(1)..frame + 1)))
            .map(|frame| FoundCut {
                frame,
                transition: frame..frame,
            })
            .collect();
        cuts.extend(spans.iter().map(|span| FoundCut {
            frame: span.end,
            transition: span.clone(),
        }));
        cuts.sort_unstable_by_key(|cut| cut.frame);
        cuts
    }

    /// Whether a frame differs from those before it for good, and by far more than the motion
    /// around.
    fn is_cut(&self, frame: usize) -> bool {
        // Compare with the usual motion around the frame; the frame itself and its two neighbours
        // are part of the event.
        let lasting = self.measured[frame].lasting;
        if lasting < LEAST_CUT {
            return false;
        }
        let (from, to) = (
            frame.saturating_sub(AROUND).max(1),
            (frame + AROUND).min(self.measured.len() - 1),
        );
        let around = (from..=to).filter(|at| at.abs_diff(frame) > 1);
        // The median is robust against another cut or a flash near by.
        let steps = in_order(around.map(|at| self.measured[at].step));
        let motion = steps.get(steps.len() / 2).copied().unwrap_or_default();
        // In a close-up that moves fast, a cut changes more than any frame near by.
        let most = steps.last().copied().unwrap_or_default();
        let changed = self.measured[frame].changed;
        (changed >= LEAST_CUT_AREA && lasting >= CUT_OVER_MOTION * motion)
            || (changed >= WHOLE_AREA && lasting >= CUT_OVER_LARGEST * most)
    }

    /// The fades over empty frames, with the frames in which the contrast falls and rises again.
    fn fades(&self) -> Vec<Range<usize>> {
        let contrast = |at: usize| self.measured[at].contrast;
        let mut fades = Vec::new();
        let mut begun = None;
        for frame in 0..self.measured.len() {
            match (begun, contrast(frame) < EMPTY) {
                (None, true) => begun = Some(frame),
                (Some(first), false) => {
                    begun = None;
                    // A video that begins empty has no shot before, and a long run is a shot of its
                    // own.
                    if first == 0 || frame - first > MOST_EMPTY {
                        continue;
                    }
                    let earliest = first.saturating_sub(HALF_FADE).max(1);
                    let start = (earliest..first)
                        .rev()
                        .take_while(|&at| contrast(at - 1) > contrast(at) + FADE_STEP)
                        .last()
                        .unwrap_or(first);
                    let latest = (frame + HALF_FADE).min(self.measured.len() - 1);
                    let end = (frame..latest)
                        .take_while(|&at| contrast(at + 1) > contrast(at) + FADE_STEP)
                        .last()
                        .map_or(frame, |at| at + 1);
                    fades.push(start..end);
                }
                _ => {}
            }
        }
        fades
    }
}

fn in_order(values: impl IntoIterator<Item = f32>) -> Vec<f32> {
    let mut values: Vec<f32> = values.into_iter().collect();
    values.sort_by(f32::total_cmp);
    values
}

/// Of the transitions that overlap, the one that is explained best, if there are `least` of them.
fn best_of_each<'a>(found: impl Iterator<Item = &'a Gradual>, least: usize) -> Vec<Range<usize>> {
    let mut sorted: Vec<&Gradual> = found.collect();
    sorted.sort_by(|a, b| {
        let order = a.doubt.total_cmp(&b.doubt);
        order.then(a.frames.start.cmp(&b.frames.start))
    });
    let mut best: Vec<(Range<usize>, usize)> = Vec::new();
    for found in sorted {
        match best
            .iter_mut()
            .find(|(frames, _)| overlap(frames, &found.frames))
        {
            Some((_, count)) => *count += 1,
            None => best.push((found.frames.clone(), 1)),
        }
    }
    best.into_iter()
        .filter(|(_, count)| *count >= least)
        .map(|(frames, _)| frames)
        .collect()
}

/// Whether frames lie in none of some spans.
fn is_apart(spans: &[Range<usize>], frames: &Range<usize>) -> bool {
    spans.iter().all(|span| !overlap(span, frames))
}

fn overlap(one: &Range<usize>, other: &Range<usize>) -> bool {
    one.start < other.end && other.start < one.end
}

/// Spans in order; those between which no shot fits are one.
fn merge(mut spans: Vec<Range<usize>>) -> Vec<Range<usize>> {
    spans.sort_unstable_by_key(|span| (span.start, span.end));
    let mut merged: Vec<Range<usize>> = Vec::new();
    for span in spans {
        match merged.last_mut() {
            Some(last) if span.start <= last.end + NO_SHOT => last.end = last.end.max(span.end),
            _ => merged.push(span),
        }
    }
    merged
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Picture;
    use touchline_core::geometry::ImageSize;

    const SIZE: ImageSize = ImageSize::new(128, 72);

    /// A scene of coloured blobs that a camera sees turned by some px; `seed` tells scenes apart.
    fn colour(seed: f64, x: f64, y: f64) -> [f64; 3] {
        [1.0, 2.0, 3.0].map(|colour| {
            let wave = (0.31 * x + seed * colour).sin() * (0.23 * y + 1.7 * seed).cos()
                + (0.07 * x * colour + y * 0.11).sin();
            127.0 + 60.0 * wave
        })
    }

    fn frame(shade: impl Fn(f64, f64) -> [f64; 3]) -> Miniature {
        let pixels = (0..SIZE.height)
            .flat_map(|y| (0..SIZE.width).map(move |x| (f64::from(x), f64::from(y))));
        let rgba = pixels.flat_map(|(x, y)| {
            let [red, green, blue] = shade(x, y).map(|value| value.clamp(0.0, 255.0) as u8);
            [red, green, blue, 255]
        });
        Miniature::from_picture(&Picture::new(SIZE, rgba.collect()).unwrap())
    }

    fn found(frames: impl IntoIterator<Item = Miniature>) -> Vec<Range<usize>> {
        let mut finder = CutFinder::default();
        frames.into_iter().for_each(|frame| finder.push(frame));
        let cuts = finder.finish();
        assert!(cuts.iter().all(|cut| cut.frame == cut.transition.end));
        cuts.into_iter().map(|cut| cut.transition).collect()
    }

    /// The only transition found, whose ends may be this far from the drawn ones.
    fn assert_only(found: &[Range<usize>], drawn: Range<usize>, off: usize) {
        let [only] = found else {
            panic!("{found:?} for {drawn:?}")
        };
        let is_near =
            only.start.abs_diff(drawn.start) <= off && only.end.abs_diff(drawn.end) <= off;
        assert!(is_near, "{only:?} for {drawn:?}");
    }

    #[test]
    fn cuts_are_found_in_a_camera_that_turns_and_flashes_are_none() {
        for flash_frames in 1..=LONGEST_FLASH {
            let frames = (0..48).map(|at| {
                let (seed, turned) = if at < 17 {
                    (0.4, 3.0 * at as f64)
                } else {
                    (2.6, -2.0 * at as f64)
                };
                let is_flash = (30..30 + flash_frames).contains(&at);
                let flash = if is_flash { 90.0 } else { 0.0 };
                frame(|x, y| colour(seed, x + turned, y).map(|value| value + flash))
            });
            let cut = vec![Range { start: 17, end: 17 }];
            assert_eq!(found(frames), cut, "a flash of {flash_frames} frames");
        }
    }

    #[test]
    fn dissolves_and_wipes_are_found_with_their_frames() {
        // A long dissolve from a moving camera is found, but too short.
        for (length, speed) in [(6, 0.3), (12, 0.2), (24, 0.0)] {
            let share = |at: usize| ((at as f64 - 29.0) / (length as f64 + 1.0)).clamp(0.0, 1.0);
            let dissolve = (0..90).map(|at| {
                let (share, turned) = (share(at), speed * at as f64);
                frame(|x, y| {
                    let (before, after) = (colour(0.4, x + turned, y), colour(2.6, x, y));
                    [0, 1, 2].map(|colour| (1.0 - share) * before[colour] + share * after[colour])
                })
            });
            assert_only(&found(dissolve), 30..30 + length, 2);
            let wipe = (0..90).map(|at| {
                let edge = share(at) * f64::from(SIZE.width);
                frame(|x, y| colour(if x < edge { 2.6 } else { 0.4 }, x, y))
            });
            assert_only(&found(wipe), 30..30 + length, 3);
        }
    }

    #[test]
    fn a_graphic_that_sweeps_over_the_picture_is_one_transition() {
        let swept = (0..90).map(|at| {
            let head =
                ((f64::from(at) - 29.0) / 16.0).clamp(0.0, 1.0) * 1.6 * f64::from(SIZE.width);
            let tail = head - 0.6 * f64::from(SIZE.width);
            frame(|x, y| match x {
                x if x < tail => colour(2.6, x, y),
                x if x < head => [250.0, 20.0, 20.0],
                _ => colour(0.4, x, y),
            })
        });
        assert_only(&found(swept), 30..45, 3);
    }

    #[test]
    fn fades_over_black_include_the_frames_that_darken() {
        let black = (0..60).map(|at| {
            let (seed, light) = if at < 30 {
                (0.4, (28.0 - f64::from(at)) / 8.0)
            } else {
                (2.6, (f64::from(at) - 32.0) / 8.0)
            };
            frame(|x, y| colour(seed, x, y).map(|value| value * light.clamp(0.0, 1.0)))
        });
        assert_only(&found(black), 21..40, 1);
    }

    #[test]
    fn a_pan_over_new_ground_and_a_zoom_are_no_transition() {
        let pan = (0..120).map(|at| frame(|x, y| colour(0.4, x + 5.0 * f64::from(at), y)));
        assert_eq!(found(pan), []);
        let zoom = (0..60).map(|at| {
            let zoom = 1.0 + 0.02 * f64::from(at);
            frame(|x, y| colour(0.4, 64.0 + (x - 64.0) / zoom, 36.0 + (y - 36.0) / zoom))
        });
        assert_eq!(found(zoom), []);
    }

    #[test]
    fn a_cut_is_no_part_of_what_moves_beside_it() {
        // An object crosses the picture right after the cut, as in a close-up.
        let frames = (0..80).map(|at| {
            let seed = if at < 40 { 0.4 } else { 2.6 };
            let edge = 6.0 * (f64::from(at) - 44.0);
            frame(|x, y| {
                let is_object = at > 43 && x > edge && x < edge + 40.0;
                if is_object {
                    [40.0, 40.0, 200.0]
                } else {
                    colour(seed, x, y)
                }
            })
        });
        assert!(found(frames).contains(&(40..40)));
    }

    #[test]
    fn pictures_that_are_missing_at_the_start_keep_the_numbers() {
        let picture = |seed: f64| {
            let pixels = (0..SIZE.height).flat_map(|y| (0..SIZE.width).map(move |x| (x, y)));
            let rgba = pixels.flat_map(|(x, y)| {
                let [red, green, blue] =
                    colour(seed, f64::from(x), f64::from(y)).map(|value| value as u8);
                [red, green, blue, 255]
            });
            Picture::new(SIZE, rgba.collect()).unwrap()
        };
        let pictures = (0..40).map(|at| match at {
            0..5 => None,
            5..20 => Some(picture(0.4)),
            _ => Some(picture(2.6)),
        });
        let cuts = find_cuts(pictures);
        assert_eq!(cuts.len(), 1);
        assert_eq!((cuts[0].frame, cuts[0].is_gradual()), (20, false));
    }

    #[test]
    fn a_still_picture_and_none_at_all_have_no_cut() {
        assert_eq!(found([]), []);
        assert_eq!(found((0..20).map(|_| frame(|x, y| colour(0.4, x, y)))), []);
        assert_eq!(found((0..20).map(|_| frame(|_, _| [0.0; 3]))), []);
    }

    impl Frames for Vec<Miniature> {
        fn frame(&self, number: usize) -> Option<&Miniature> {
            self.get(number)
        }

        fn step(&self, _: usize) -> f32 {
            0.0
        }
    }

    #[test]
    fn a_picture_that_fades_evenly_is_told_from_one_that_is_left_behind() {
        // Squares of random grey levels; those of the other picture are large and go by.
        let speckle = |seed: u64, side: f64, x: f64, y: f64| {
            let [column, row] = [x, y].map(|at| (at / side).floor() as i64 as u64);
            let mixed = (column.wrapping_mul(0x9E37_79B9) ^ row.wrapping_mul(0x85EB_CA6B) ^ seed)
                .wrapping_mul(0x2545_F491_4F6C_DD1D);
            40.0 + f64::from((mixed >> 56) as u8) * 0.7
        };
        let dissolve = (0..90).map(|at| {
            let at = f64::from(at);
            let share = ((at - 39.0) / 19.0).clamp(0.0, 1.0);
            frame(|x, y| {
                let still = speckle(1, 6.0, x + 0.3 * at, y);
                let moving = speckle(2, 40.0, x + 4.0 * at, y);
                [(1.0 - share) * still + share * moving; 3]
            })
        });
        let dissolve: Vec<Miniature> = dissolve.collect();
        for middle in [44, 49, 54] {
            let found = find_vanishing(&dissolve, middle, Way::Forwards).unwrap();
            assert_only(&[found.frames], 40..58, 3);
        }
        let pan = (0..90).map(|at| {
            let turned = 0.06 * f64::from(at * at);
            frame(|x, y| [speckle(1, 6.0, x + turned, y); 3])
        });
        let pan: Vec<Miniature> = pan.collect();
        let ways = Way::BOTH.map(|way| {
            (20..70)
                .filter_map(|at| find_vanishing(&pan, at, way))
                .count()
        });
        assert_eq!(ways, [0, 0]);
    }

    #[test]
    fn a_picture_that_moves_fast_for_long_is_no_graphic() {
        let moved = |at: usize| 7.0 * (at as f64 - 30.0).clamp(0.0, 40.0);
        let frames =
            (0..110).map(|at| frame(|x, y| colour(0.4, x + moved(at), y + 0.5 * moved(at))));
        assert_eq!(found(frames), []);
    }
}
