//! Shot boundary detection.
//!
//! A hard cut is a frame that differs from the previous one far more than neighbouring frames
//! differ from each other, under every shift of the picture, and stays different: a camera's flash
//! lasts one frame, and then the old picture is back. A fade is a frame that looks like the mean of
//! two different frames, or a run of nearly empty frames in between. The position of a fade is
//! uncertain and marked as such.

mod miniature;

use crate::media::Picture;
use miniature::Miniature;
use std::collections::VecDeque;

/// Minimum difference of a cut, grey levels. Neighbouring frames of the fastest pans and zooms of
/// two broadcasts differ by up to 5.3.
const LEAST_CUT: f32 = 6.0;
/// Minimum ratio of a cut's difference to the median difference around it.
const CUT_OVER_MOTION: f32 = 2.5;
/// Number of differences on each side that measure the usual motion around a frame.
const AROUND: usize = 4;
/// Half the length of the window in which fades are detected, frames.
const HALF_FADE: usize = 8;
/// Minimum difference between the two ends of a fade, grey levels.
const LEAST_FADE: f32 = 12.0;
/// Maximum difference of the middle frame of a fade from the mean of its ends, relative to the
/// difference of the ends.
const MOST_OFF_BLEND: f32 = 0.35;
/// Frames of lower contrast are empty, grey levels.
const EMPTY: f32 = 4.0;
/// Minimum distance between a fade and any other cut, frames; a weaker one within it is part of the
/// stronger one.
const APART: usize = 2 * HALF_FADE;

/// A shot boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FoundCut {
    /// The first frame of the new shot, from 0.
    pub frame: usize,
    /// Whether it is a fade; its position is uncertain.
    pub is_fade: bool,
}

/// Detects cuts in frames that are pushed one after the other without gaps.
#[derive(Debug, Default)]
struct CutFinder {
    /// The latest frames, as many as the window of a fade has.
    latest: VecDeque<Miniature>,
    measured: Vec<CutMeasurements>,
}

/// Measurements of one frame.
#[derive(Clone, Copy, Debug)]
struct CutMeasurements {
    /// The difference from the previous frame, grey levels.
    step: f32,
    /// The smallest difference between one of the two frames before it and this frame or the next
    /// one. After a flash it is small.
    lasting: f32,
    /// Its difference from the mean of the ends of the window around it, and the difference of the
    /// ends.
    fade: Option<(f32, f32)>,
    contrast: f32,
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
        .cuts()
        .into_iter()
        .map(|cut| FoundCut {
            frame: cut.frame + missing,
            ..cut
        })
        .collect()
}

impl CutFinder {
    /// Adds the next frame.
    fn push(&mut self, frame: Miniature) {
        // The first frame has no predecessor and is no cut: its difference is 0. Other differences
        // that do not exist are ∞, so that they are no minimum.
        let step = self.difference_from(1, &frame).unwrap_or(0.0);
        let over_two = self.difference_from(2, &frame).unwrap_or(f32::INFINITY);
        let over_three = self.difference_from(3, &frame).unwrap_or(f32::INFINITY);
        // Only now is it known whether the change at the last frame persists.
        if let Some(last) = self.measured.last_mut() {
            last.lasting = last.lasting.min(over_two).min(over_three);
        }
        let contrast = frame.contrast();
        self.measured.push(CutMeasurements {
            step,
            lasting: step.min(over_two),
            fade: None,
            contrast,
        });
        self.latest.push_back(frame);
        if self.latest.len() > 2 * HALF_FADE + 1 {
            self.latest.pop_front();
        }
        // Once the window is full, measure its middle frame as the middle of a fade.
        if let (Some(first), Some(middle), Some(last)) = (
            self.latest.front(),
            self.latest.get(HALF_FADE),
            self.latest.get(2 * HALF_FADE),
        ) {
            let off = middle.difference_from_blend(first, last);
            let place = self.measured.len() - 1 - HALF_FADE;
            self.measured[place].fade = Some((off, first.difference(last)));
        }
    }

    /// The difference of a new frame from the one `back` frames before it; `None` if there is none.
    fn difference_from(&self, back: usize, frame: &Miniature) -> Option<f32> {
        let at = self.latest.len().checked_sub(back)?;
        Some(frame.difference(self.latest.get(at)?))
    }

    /// The cuts among the frames added so far, in frame order.
    fn cuts(&self) -> Vec<FoundCut> {
        // Fades over empty frames come first: a fade to black and back is one cut, not one on each
        // side.
        let mut cuts: Vec<FoundCut> = self
            .empty_runs()
            .into_iter()
            .map(|frame| FoundCut {
                frame,
                is_fade: true,
            })
            .collect();
        // Hard cuts have to be apart from these fades, but not from each other.
        let hard: Vec<FoundCut> = (1..self.measured.len())
            .filter(|&frame| self.is_cut(frame) && is_apart(&cuts, frame))
            .map(|frame| FoundCut {
                frame,
                is_fade: false,
            })
            .collect();
        cuts.extend(hard);
        // Cross-fades, the most certain first; each suppresses weaker ones near it.
        let mut blends: Vec<(f32, usize)> = (1..self.measured.len())
            .filter_map(|frame| self.blend_at(frame))
            .collect();
        blends.sort_by(|(a, at), (b, before)| b.total_cmp(a).then(at.cmp(before)));
        for (_, frame) in blends {
            if is_apart(&cuts, frame) {
                cuts.push(FoundCut {
                    frame,
                    is_fade: true,
                });
            }
        }
        cuts.sort_unstable_by_key(|cut| cut.frame);
        cuts
    }

    /// Whether a frame differs from those before it for good, and by far more than the motion
    /// around.
    fn is_cut(&self, frame: usize) -> bool {
        // Compare with the usual motion around the frame; the frame itself and its two neighbours
        // are part of the event.
        let lasting = self.measured[frame].lasting;
        let (from, to) = (
            frame.saturating_sub(AROUND).max(1),
            (frame + AROUND).min(self.measured.len() - 1),
        );
        let around = (from..=to).filter(|at| at.abs_diff(frame) > 1);
        // The median is robust against another cut or a flash near by.
        let mut steps: Vec<f32> = around.map(|at| self.measured[at].step).collect();
        steps.sort_by(f32::total_cmp);
        let motion = steps.get(steps.len() / 2).copied().unwrap_or_default();
        lasting >= LEAST_CUT && lasting >= CUT_OVER_MOTION * motion
    }

    /// The middle of each short run of empty frames between frames that are not empty.
    fn empty_runs(&self) -> Vec<usize> {
        let mut runs = Vec::new();
        let mut begun = None;
        for (frame, measured) in self.measured.iter().enumerate() {
            match (begun, measured.contrast < EMPTY) {
                (None, true) => begun = Some(frame),
                (Some(first), false) => {
                    begun = None;
                    // A video that begins empty has no shot before, and a long run is a shot of its
                    // own.
                    if first > 0 && frame - first <= 2 * APART {
                        runs.push(first.midpoint(frame));
                    }
                }
                _ => {}
            }
        }
        runs
    }

    /// The strength of a cross-fade whose middle is this frame, and the frame; `None` if it is
    /// none.
    fn blend_at(&self, frame: usize) -> Option<(f32, usize)> {
        let (off, ends) = self.measured[frame].fade?;
        (ends >= LEAST_FADE && off <= MOST_OFF_BLEND * ends).then_some((ends - off, frame))
    }
}

/// Whether a frame is far enough from all cuts to be a cut of its own.
fn is_apart(cuts: &[FoundCut], frame: usize) -> bool {
    cuts.iter().all(|cut| cut.frame.abs_diff(frame) > APART)
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

    fn found(frames: impl IntoIterator<Item = Miniature>) -> Vec<(usize, bool)> {
        let mut finder = CutFinder::default();
        frames.into_iter().for_each(|frame| finder.push(frame));
        finder
            .cuts()
            .into_iter()
            .map(|cut| (cut.frame, cut.is_fade))
            .collect()
    }

    #[test]
    fn cuts_are_found_in_a_camera_that_turns_and_flashes_are_none() {
        let frames = (0..48).map(|at| {
            let (seed, turned) = if at < 17 {
                (0.4, 3.0 * f64::from(at))
            } else {
                (2.6, -2.0 * f64::from(at))
            };
            let flash = if at == 30 { 90.0 } else { 0.0 };
            frame(|x, y| colour(seed, x + turned, y).map(|value| value + flash))
        });
        assert_eq!(found(frames), [(17, false)]);
    }

    #[test]
    fn fades_are_found_and_said_to_be_unsure() {
        let blend = (0..60).map(|at| {
            let share = ((f64::from(at) - 25.0) / 10.0).clamp(0.0, 1.0);
            frame(|x, y| {
                let (before, after) = (colour(0.4, x, y), colour(2.6, x, y));
                [0, 1, 2].map(|colour| (1.0 - share) * before[colour] + share * after[colour])
            })
        });
        let blends = found(blend);
        assert!(matches!(blends[..], [(28..=32, true)]), "{blends:?}");
        let black = (0..60).map(|at| {
            let (seed, light) = if at < 30 {
                (0.4, (28.0 - f64::from(at)) / 8.0)
            } else {
                (2.6, (f64::from(at) - 32.0) / 8.0)
            };
            frame(|x, y| colour(seed, x, y).map(|value| value * light.clamp(0.0, 1.0)))
        });
        let blacks = found(black);
        assert!(matches!(blacks[..], [(28..=32, true)]), "{blacks:?}");
    }

    #[test]
    fn a_still_picture_and_none_at_all_have_no_cut() {
        assert_eq!(found([]), []);
        assert_eq!(found((0..20).map(|_| frame(|x, y| colour(0.4, x, y)))), []);
        assert_eq!(found((0..20).map(|_| frame(|_, _| [0.0; 3]))), []);
    }
}
