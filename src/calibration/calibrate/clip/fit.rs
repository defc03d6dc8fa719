//! A clip adjusted to its points, to the cameras that are known and to its painted lines, in
//! rounds: paint is looked for where the frames are thought to look, and from where it puts them
//! more of it is found.
//!
//! What the paint says about a camera holds for that camera only. After the last adjustment every
//! frame that was asked is therefore judged where it ended, and a frame that had a camera before
//! keeps it where the paint speaks more for that one.

use super::certainty::PaintVerdict;
use super::error::TrackClipError;
use super::evidence::{ClipEvidence, apart_px};
use super::options::{ClipProgress, TrackClipOptions};
use super::paint::{Painted, share_alike};
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
    AdjustedClip, Carried, ClipCamera, PointTracks, PosePrior, PriorSource, adjust_clip,
};

/// Rounds of paint and adjustment at most.
const MAX_ROUNDS: usize = 3;

/// If no frame moves by more in a round, the next would find the same paint, px at 1920 px width.
const SETTLED_PX: f64 = 4.0;

/// A camera this near to another is the same answer, px at 1920 px width: paint is found to half of
/// it.
const ALIKE_PX: f64 = 1.5;

/// What a clip is adjusted from.
pub(super) struct ClipFit<'a> {
    pub camera: &'a ClipCamera,
    pub field: &'a FieldModel,
    pub tracks: &'a PointTracks,
    pub carried: &'a Carried,
    /// The cameras that the document knows.
    pub known: &'a [PosePrior],
    pub pictures: ClipPictures<'a>,
    /// Whether the field's size was found from the paint. One that was assumed or typed may be
    /// another's.
    pub is_size_fitted: bool,
    pub options: &'a TrackClipOptions,
}

/// A clip after its last adjustment.
pub(super) struct FittedClip {
    pub adjusted: AdjustedClip,
    /// Frames that were aligned to their painted lines.
    pub painted: usize,
    /// What the paint says about the adjusted cameras.
    pub judged: Judged,
}

/// What the paint says about the frames of a clip where the last adjustment has put them.
pub(super) struct Judged {
    /// About each frame's adjusted camera.
    pub paint: Vec<PaintVerdict>,
    /// Frames for whose earlier camera it speaks more.
    pub kept: BTreeSet<usize>,
    /// The share of each frame's paint that lies on no line; 0 where it was not asked, or shows too
    /// little.
    pub unexplained: Vec<f64>,
    /// Whether the paint of some frame lies as on a field of another length.
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
        let mut adjusted = self.adjust(&BTreeMap::new(), progress)?;
        let mut painted = 0;
        for _ in 0..if self.options.paint_every > 0 {
            MAX_ROUNDS
        } else {
            0
        } {
            let asked = self.frames_to_ask(&adjusted);
            let found = self.pictures.ask_paint(
                reader,
                (self.field, self.camera),
                &asked,
                evidence,
                progress,
            )?;
            let aligned: BTreeMap<usize, PosePrior> = found
                .into_iter()
                .filter_map(|(frame, says)| {
                    if let Painted::Snapped(at) = says {
                        Some((frame, at))
                    } else {
                        None
                    }
                })
                .collect();
            painted = aligned.len();
            if aligned.is_empty() {
                break;
            }
            let before = std::mem::replace(&mut adjusted, self.adjust(&aligned, progress)?);
            if self.largest_move_px(&before, &adjusted) <= SETTLED_PX {
                break;
            }
        }
        let judged = self.judge(&adjusted, reader, evidence, progress)?;
        Ok(FittedClip {
            adjusted,
            painted,
            judged,
        })
    }

    /// Adjusts all frames to the points, the known cameras and those aligned to paint.
    fn adjust(
        &self,
        aligned: &BTreeMap<usize, PosePrior>,
        progress: &Progress<'_, ClipProgress>,
    ) -> Result<AdjustedClip, TrackClipError> {
        report(progress, ClipProgress::Adjusting)?;
        // Paint of one picture counts once, however often it was asked.
        let is_same_paint = |anchor: &PosePrior| {
            anchor.source == PriorSource::Paint && aligned.contains_key(&anchor.frame)
        };
        let known = self.known.iter().filter(|anchor| !is_same_paint(anchor));
        let mut anchors: Vec<PosePrior> = known.chain(aligned.values()).copied().collect();
        share_alike(&mut anchors, self.pictures.size);
        let undetermined = TrackClipError::Undetermined {
            frames: self.pictures.clip.frames.len(),
        };
        adjust_clip(
            self.camera,
            self.tracks,
            self.carried,
            &anchors,
            &self.options.adjust,
        )
        .ok_or(undetermined)
    }

    /// The frames whose paint is looked for, with their cameras: every n-th, and those that had a
    /// camera before.
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

    /// The cameras that frames had before and that no person gave them.
    fn earlier(&self) -> impl Iterator<Item = &PosePrior> {
        self.known
            .iter()
            .filter(|anchor| anchor.source != PriorSource::Person)
    }

    /// How far a frame moved at most from one adjustment to another, px at 1920 px width.
    fn largest_move_px(&self, before: &AdjustedClip, after: &AdjustedClip) -> f64 {
        let pairs = before.frames.iter().zip(&after.frames);
        let moves = pairs
            .filter_map(|(one, other)| Some(self.apart(one.as_ref()?.ptz, other.as_ref()?.ptz)));
        moves.fold(0.0, f64::max)
    }

    /// How far apart two cameras' pictures are, px at 1920 px width.
    fn apart(&self, one: Ptz, other: Ptz) -> f64 {
        apart_px(one, other, self.pictures.size) / self.pictures.size.scale_from_1920()
    }

    /// What the paint says about each frame where the last adjustment has put it, and the frames
    /// whose earlier camera it speaks more for. Frames that are not asked are like the one before
    /// them.
    fn judge(
        &self,
        adjusted: &AdjustedClip,
        reader: &mut dyn ReadFrames,
        evidence: &ClipEvidence,
        progress: &Progress<'_, ClipProgress>,
    ) -> Result<Judged, TrackClipError> {
        let paint = vec![PaintVerdict::Silent; adjusted.frames.len()];
        let unexplained = vec![0.0; paint.len()];
        let mut judged = Judged {
            paint,
            kept: BTreeSet::new(),
            unexplained,
            is_of_other_field: false,
        };
        if self.options.paint_every == 0 {
            return Ok(judged);
        }
        let asked = self.frames_to_ask(adjusted);
        let mut verdicts = Vec::with_capacity(asked.len());
        for (done, &(frame, ptz)) in asked.iter().enumerate() {
            report(progress, ClipProgress::Painting(done, asked.len()))?;
            verdicts.push((
                frame,
                self.judge_frame(reader, evidence, (frame, ptz), &mut judged)?,
            ));
        }
        // Where one frame lies on its paint and the next that was asked does not, what spoilt the
        // clip (a dissolve, a graphic that wipes over it) happened at a frame between the two.
        let is_off = |verdict: PaintVerdict| verdict == PaintVerdict::Contradicts;
        let changes: Vec<_> = verdicts
            .windows(2)
            .filter(|pair| is_off(pair[0].1) != is_off(pair[1].1))
            .map(|pair| pair[0].0..pair[1].0)
            .collect();
        for frame in changes.into_iter().flat_map(|range| range.skip(1)) {
            let Some(at) = adjusted.frames[frame] else {
                continue;
            };
            verdicts.push((
                frame,
                self.judge_frame(reader, evidence, (frame, at.ptz), &mut judged)?,
            ));
        }
        verdicts.sort_by_key(|(frame, _)| *frame);
        for (place, &(frame, verdict)) in verdicts.iter().enumerate() {
            let next = verdicts
                .get(place + 1)
                .map_or(judged.paint.len(), |next| next.0);
            let like_it = frame..next.min(frame + self.options.paint_every);
            judged.paint[like_it.clone()].fill(verdict);
            let unexplained = judged.unexplained[frame];
            judged.unexplained[like_it].fill(unexplained);
        }
        Ok(judged)
    }

    /// What the paint says about a frame's adjusted camera; what else the look at its picture shows
    /// goes into `judged`.
    fn judge_frame(
        &self,
        reader: &mut dyn ReadFrames,
        evidence: &ClipEvidence,
        (frame, ptz): (usize, Ptz),
        judged: &mut Judged,
    ) -> Result<PaintVerdict, TrackClipError> {
        let earlier = self
            .earlier()
            .find(|anchor| anchor.frame == frame)
            .map(|anchor| anchor.ptz);
        let other = earlier.filter(|earlier| self.apart(*earlier, ptz) > ALIKE_PX);
        let known = self
            .verdict_by_evidence(evidence, frame, ptz)
            .filter(|_| self.is_size_fitted);
        if let (Some(verdict), None) = (known, other) {
            return Ok(verdict);
        }
        let (check, keeps_earlier) = self.look_again(reader, frame, ptz, other)?;
        if keeps_earlier {
            judged.kept.insert(frame);
        }
        judged.is_of_other_field |= self.is_of_other_field(&check);
        judged.unexplained[frame] = check.unexplained.unwrap_or(0.0);
        Ok(known.unwrap_or_else(|| self.verdict_of(&check)))
    }

    /// What the paint says about a frame's adjusted camera, and whether it speaks more for the one
    /// that the frame had earlier.
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

    /// What a line check says about a camera.
    fn verdict_of(&self, check: &LineCheck) -> PaintVerdict {
        match check.verdict() {
            _ if self.is_of_other_field(check) => PaintVerdict::Contradicts,
            LineVerdict::Supports => PaintVerdict::Agrees,
            LineVerdict::Contradicts => PaintVerdict::Contradicts,
            LineVerdict::CannotSay => PaintVerdict::Silent,
        }
    }

    /// Whether a line check finds a field of another length than was assumed or typed.
    fn is_of_other_field(&self, check: &LineCheck) -> bool {
        !self.is_size_fitted && check.is_of_other_field()
    }

    /// What the paint said about a camera like this one; none where it was asked about others only.
    fn verdict_by_evidence(
        &self,
        evidence: &ClipEvidence,
        frame: usize,
        ptz: Ptz,
    ) -> Option<PaintVerdict> {
        match evidence.paint(frame, ptz, self.pictures.size)? {
            Painted::Snapped(anchor) => {
                (self.apart(anchor.ptz, ptz) <= ALIKE_PX).then_some(PaintVerdict::Agrees)
            }
            Painted::Contradicts => Some(PaintVerdict::Contradicts),
            Painted::Open => Some(PaintVerdict::Silent),
        }
    }
}
