//! Joint adjustment of a clip: cameras of all frames from tracked points, known cameras and painted
//! lines.
//!
//! Adjustment and line search alternate, for at most three rounds. Lines are searched for near
//! where the current cameras project them, so that better cameras find more lines.
//!
//! Evidence from painted lines is valid only for the camera that it was measured at. After the last
//! adjustment, every frame whose paint is searched is therefore checked again at its final camera.
//! A frame that already had a camera keeps it if the paint supports that one better.

use super::certainty::PaintVerdict;
use super::error::TrackClipError;
use super::evidence::{ClipEvidence, apart_px};
use super::options::{ClipProgress, TrackClipOptions};
use super::paint::{PaintAlignmentOutcome, share_alike};
use super::pictures::{ClipPictures, report};
use crate::calibrate::may_replace;
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::markings::LineVerdict;
use touchline_core::progress::Progress;
use touchline_vision::media::ReadFrames;
use touchline_vision::paint::{GroundPicture, LineCheck, check_lines};
use touchline_vision::track::{
    AdjustedClip, ClipCamera, PointTracks, PosePrior, PriorSource, PropagatedClip, adjust_clip,
};

/// Maximum number of rounds of line search and adjustment.
const MAX_ROUNDS: usize = 3;

/// The rounds end when no frame moves by more than this, px at 1920 px width: the next round would
/// find the same paint.
const SETTLED_PX: f64 = 4.0;

/// Two cameras whose pictures differ by at most this are the same answer, px at 1920 px width.
/// Paint is localised to half of it.
const ALIKE_PX: f64 = 1.5;

/// The inputs of the adjustment of one clip.
pub(super) struct ClipFit<'a> {
    pub camera: &'a ClipCamera,
    pub field: &'a FieldModel,
    pub tracks: &'a PointTracks,
    pub propagated: &'a PropagatedClip,
    /// The cameras that the document already has, as pose priors.
    pub known: &'a [PosePrior],
    pub pictures: ClipPictures<'a>,
    pub options: &'a TrackClipOptions,
}

/// A clip after its last adjustment.
pub(super) struct FittedClip {
    pub adjusted: AdjustedClip,
    /// The same before any paint was searched, from points and known cameras alone.
    pub by_points: AdjustedClip,
    /// Number of frames that were aligned to their painted lines.
    pub painted: usize,
    /// Verdicts of the paint on the adjusted cameras.
    pub paint_verdicts: PaintVerdicts,
}

/// Verdicts of the painted lines on the cameras of the last adjustment.
pub(super) struct PaintVerdicts {
    /// The verdict on each frame's adjusted camera.
    pub paint: Vec<PaintVerdict>,
    /// Frames whose earlier camera explains the paint better than the adjusted one.
    pub kept: BTreeSet<usize>,
    /// Whether the paint of some frame fits a field of another length.
    pub is_of_other_field: bool,
}

impl ClipFit<'_> {
    /// Adjusts all frames, aligns every n-th one to its paint, and repeats that until no frame
    /// moves.
    pub fn adjust_to_paint(
        &self,
        reader: &mut dyn ReadFrames,
        evidence: &mut ClipEvidence,
        progress: &Progress<'_, ClipProgress>,
    ) -> Result<FittedClip, TrackClipError> {
        // The first adjustment has no paint of its own: only points and the known cameras.
        let by_points = self.adjust(&BTreeMap::new(), progress)?;
        let mut adjusted = by_points.clone();
        let mut painted = 0;
        for _ in 0..if self.options.paint_every > 0 {
            MAX_ROUNDS
        } else {
            0
        } {
            // Align to the paint from the current cameras. `evidence` repeats the earlier answer
            // for a frame that has hardly moved since, without reading its picture again.
            let queries = self.frames_to_ask(&adjusted);
            let found = self.pictures.ask_paint(
                reader,
                (self.field, self.camera),
                &queries,
                evidence,
                progress,
            )?;
            let aligned: BTreeMap<usize, PosePrior> = found
                .into_iter()
                .filter_map(|(frame, says)| {
                    if let PaintAlignmentOutcome::Snapped(at) = says {
                        Some((frame, at))
                    } else {
                        None
                    }
                })
                .collect();
            // Frames that could not be aligned contribute no prior; their cameras follow from the
            // points.
            painted = aligned.len();
            if aligned.is_empty() {
                break;
            }
            let before = std::mem::replace(&mut adjusted, self.adjust(&aligned, progress)?);
            if self.largest_move_px(&before, &adjusted) <= SETTLED_PX {
                break;
            }
        }
        // The last adjustment moved the frames once more, so the answers of the loop do not apply.
        let paint_verdicts = self.judge(&adjusted, reader, progress)?;
        Ok(FittedClip {
            adjusted,
            by_points,
            painted,
            paint_verdicts,
        })
    }

    /// Adjusts all frames to the points, the known cameras and the cameras that were aligned to
    /// paint.
    fn adjust(
        &self,
        aligned: &BTreeMap<usize, PosePrior>,
        progress: &Progress<'_, ClipProgress>,
    ) -> Result<AdjustedClip, TrackClipError> {
        report(progress, ClipProgress::Adjusting)?;
        // A known camera that was itself aligned to paint repeats the evidence of the new alignment
        // of that picture. Only the new one is used, so that no paint counts twice.
        let known = self.known.iter().filter(|anchor| {
            anchor.source != PriorSource::Paint || !aligned.contains_key(&anchor.frame)
        });
        let mut anchors: Vec<PosePrior> = known.chain(aligned.values()).copied().collect();
        // Frames with the same view share the errors of their paint (and those of a forest's
        // proposals), so their weight is reduced.
        share_alike(&mut anchors, self.pictures.size);
        let undetermined = TrackClipError::Undetermined {
            frames: self.pictures.clip.frames.len(),
        };
        adjust_clip(
            self.camera,
            self.tracks,
            self.propagated,
            &anchors,
            &self.options.adjust,
        )
        .ok_or(undetermined)
    }

    /// The frames whose paint is searched, with their current cameras: every n-th frame, and each
    /// frame that had a camera before.
    fn frames_to_ask(&self, adjusted: &AdjustedClip) -> Vec<(usize, Ptz)> {
        let earlier: BTreeSet<usize> = self.earlier().map(|anchor| anchor.frame).collect();
        let reached = adjusted
            .frames
            .iter()
            .enumerate()
            .filter_map(|(frame, at)| Some((frame, (*at)?.ptz)));
        reached
            .filter(|(frame, _)| frame % self.options.paint_every == 0 || earlier.contains(frame))
            .collect()
    }

    /// The earlier cameras of frames, except those that a person determined.
    fn earlier(&self) -> impl Iterator<Item = &PosePrior> {
        self.known
            .iter()
            .filter(|anchor| anchor.source != PriorSource::Person)
    }

    /// The largest displacement of a frame between two adjustments, px at 1920 px width.
    fn largest_move_px(&self, before: &AdjustedClip, after: &AdjustedClip) -> f64 {
        let pairs = before.frames.iter().zip(&after.frames);
        let moves = pairs
            .filter_map(|(one, other)| Some(self.apart(one.as_ref()?.ptz, other.as_ref()?.ptz)));
        moves.fold(0.0, f64::max)
    }

    /// Distance between the pictures of two cameras, px at 1920 px width.
    fn apart(&self, one: Ptz, other: Ptz) -> f64 {
        apart_px(one, other, self.pictures.size) / self.pictures.size.scale_from_1920()
    }

    /// Checks the final camera of each searched frame against its paint, and finds the frames whose
    /// earlier camera explains the paint better. Frames in between take the verdict of the searched
    /// frame before them.
    fn judge(
        &self,
        adjusted: &AdjustedClip,
        reader: &mut dyn ReadFrames,
        progress: &Progress<'_, ClipProgress>,
    ) -> Result<PaintVerdicts, TrackClipError> {
        let paint = vec![PaintVerdict::Silent; adjusted.frames.len()];
        let mut paint_verdicts = PaintVerdicts {
            paint,
            kept: BTreeSet::new(),
            is_of_other_field: false,
        };
        // Without line search every verdict is `Silent`.
        if self.options.paint_every == 0 {
            return Ok(paint_verdicts);
        }
        // First pass: every n-th frame, and those that had a camera before.
        let queries = self.frames_to_ask(adjusted);
        let mut verdicts = Vec::with_capacity(queries.len());
        for (done, &(frame, ptz)) in queries.iter().enumerate() {
            report(progress, ClipProgress::Painting(done, queries.len()))?;
            verdicts.push((
                frame,
                self.judge_frame(reader, (frame, ptz), &mut paint_verdicts)?,
            ));
        }
        // Second pass: where the verdict changes between two searched frames, whatever spoilt the
        // clip (a dissolve, a graphic that wipes over it) began or ended at a frame between the
        // two. Check each of these frames, so that the boundary is exact.
        let is_off = |verdict: PaintVerdict| verdict == PaintVerdict::Contradicts;
        let changes: Vec<_> = verdicts
            .windows(2)
            .filter(|pair| is_off(pair[0].1) != is_off(pair[1].1))
            .map(|pair| pair[0].0..pair[1].0)
            .collect();
        let between: Vec<usize> = changes
            .into_iter()
            .flat_map(|range| range.skip(1))
            .collect();
        for (done, &frame) in between.iter().enumerate() {
            report(progress, ClipProgress::Painting(done, between.len()))?;
            let Some(at) = adjusted.frames[frame] else {
                continue;
            };
            verdicts.push((
                frame,
                self.judge_frame(reader, (frame, at.ptz), &mut paint_verdicts)?,
            ));
        }
        // Third pass: the frames beside a place where the points ended.
        let beside = frames_beside_stops(self.propagated, self.options.paint_every);
        let mut unconfirmed = Vec::new();
        for frames in &beside {
            for &frame in frames {
                let known = verdicts.iter().find(|(other, _)| *other == frame);
                let verdict = match (known, adjusted.frames[frame]) {
                    (Some((_, verdict)), _) => *verdict,
                    (None, Some(at)) => {
                        report(progress, ClipProgress::Painting(0, frames.len()))?;
                        let at = (frame, at.ptz);
                        let verdict = self.judge_frame(reader, at, &mut paint_verdicts)?;
                        verdicts.push((frame, verdict));
                        verdict
                    }
                    (None, None) => break,
                };
                match verdict {
                    PaintVerdict::Agrees => break,
                    PaintVerdict::Silent => unconfirmed.push(frame),
                    _ => {}
                }
            }
        }
        // Each verdict also applies to the unchecked frames after it, for at most `paint_every`
        // frames: beyond a gap in the clip nothing is known.
        verdicts.sort_by_key(|(frame, _)| *frame);
        for (place, &(frame, verdict)) in verdicts.iter().enumerate() {
            let next = verdicts
                .get(place + 1)
                .map_or(paint_verdicts.paint.len(), |next| next.0);
            let like_it = frame..next.min(frame + self.options.paint_every);
            paint_verdicts.paint[like_it].fill(verdict);
        }
        for frame in unconfirmed {
            paint_verdicts.paint[frame] = PaintVerdict::Unconfirmed;
        }
        Ok(paint_verdicts)
    }

    /// The verdict of the paint on a frame's adjusted camera. The other findings of the check (kept
    /// camera, other field length, unexplained paint) are written into `paint_verdicts`.
    fn judge_frame(
        &self,
        reader: &mut dyn ReadFrames,
        (frame, ptz): (usize, Ptz),
        paint_verdicts: &mut PaintVerdicts,
    ) -> Result<PaintVerdict, TrackClipError> {
        // An earlier camera is compared only where it differs from the adjusted one.
        let earlier = self
            .earlier()
            .find(|anchor| anchor.frame == frame)
            .map(|anchor| anchor.ptz);
        let other = earlier.filter(|earlier| self.apart(*earlier, ptz) > ALIKE_PX);
        // The verdict of the last round is not enough even where the frame has hardly moved since:
        // a camera is aligned to most of the paint, and one line that it does not explain shows a
        // field of another size.
        let (check, keeps_earlier) = self.look_again(reader, frame, ptz, other)?;
        if keeps_earlier {
            paint_verdicts.kept.insert(frame);
        }
        paint_verdicts.is_of_other_field |= check.is_of_other_field();
        Ok(verdict_of(&check))
    }

    /// Checks a frame's adjusted camera against its picture, and whether its earlier camera
    /// explains the paint better.
    fn look_again(
        &self,
        reader: &mut dyn ReadFrames,
        frame: usize,
        ptz: Ptz,
        earlier: Option<Ptz>,
    ) -> Result<(LineCheck, bool), TrackClipError> {
        let shown = self.pictures.read_masked(reader, frame)?;
        let ground = GroundPicture::new(&shown.picture, &shown.masks);
        let check = |ptz: Ptz| {
            check_lines(
                &ground,
                self.field,
                &PtzCamera::new(self.camera.base_at(frame), ptz),
            )
        };
        let now = check(ptz);
        let keeps_earlier = earlier.is_some_and(|earlier| !may_replace(&check(earlier), &now));
        Ok((now, keeps_earlier))
    }
}

/// The frames beside each place where propagation stopped, from there on, at most `count` of each.
///
/// What stops the points, most often a dissolve or a graphic, has begun before: the last pictures
/// that were reached may show two scenes, and points of the other one.
fn frames_beside_stops(propagated: &PropagatedClip, count: usize) -> Vec<Vec<usize>> {
    let is_reached = |frame: &usize| propagated.ptz.get(*frame).is_some_and(Option::is_some);
    let stops = propagated.stops.iter();
    let beside = stops.map(|stop| {
        if stop.from > stop.frame {
            let frames = (stop.from..stop.from + count).take_while(is_reached);
            frames.collect()
        } else {
            let frames = (0..=stop.from).rev().take(count).take_while(is_reached);
            frames.collect()
        }
    });
    beside.collect()
}

/// The verdict that follows from a line check.
fn verdict_of(check: &LineCheck) -> PaintVerdict {
    match check.verdict() {
        _ if check.is_of_other_field() => PaintVerdict::Contradicts,
        LineVerdict::Supports => PaintVerdict::Agrees,
        LineVerdict::Contradicts => PaintVerdict::Contradicts,
        LineVerdict::CannotSay => PaintVerdict::Silent,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_vision::track::PropagationStop;

    #[test]
    fn frames_beside_a_stop_run_inwards_from_it() {
        let stop = |frame, from| PropagationStop {
            frame,
            from,
            seen: 30,
            agreeing: 4,
        };
        let ptz = Ptz::from_degrees(0.0, -10.0, 2000.0);
        let reached = [4..12, 20..22].into_iter().flatten();
        let mut propagated = PropagatedClip {
            ptz: vec![None; 30],
            apart_px: vec![None; 30],
            stops: vec![stop(3, 4), stop(12, 11), stop(22, 21)],
            moving: Vec::new(),
        };
        for frame in reached {
            propagated.ptz[frame] = Some(ptz);
        }
        let beside = frames_beside_stops(&propagated, 5);
        let expected: [&[usize]; 3] = [&[4, 5, 6, 7, 8], &[11, 10, 9, 8, 7], &[21, 20]];
        assert_eq!(beside, expected);
    }
}
