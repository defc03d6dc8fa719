//! The bases that explain the paint of tied frames, the best first.

use super::clicked::GroundClick;
use super::error::Stop;
use super::joint::{FramePaint, Joint, joint};
use super::pitch_map::PitchMap;
use super::rig::{Rig, adjusted_rig};
use super::search::Hypothesis;
use super::starts::{Start, named, searched};
use super::tied::TiedFrames;
use super::turn_levels::TurnLevels;
use super::venue::Venue;
use super::{Doubt, UnclickedError, UnclickedEvidence, UnclickedProgress, WatchUnclicked, evidence};
use crate::camera::{CameraBase, Ptz};
use crate::field::FieldModel;
use crate::solve::base::FittedSize;
use crate::track::{Hold, Tie, filled};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Places that are adjusted with all frames.
const ADJUSTED: usize = 5;

/// An adjustment is better if it explains so many times as much.
const BETTER: f64 = 1.01;

/// The best of these are moved to neighbouring sizes of the field.
const CLIMBING: usize = 2;

/// Two answers this near to each other are one, m.
pub(super) const SAME_M: f64 = 1.5;

/// A place is taken for the only one if it explains this many times as much as the next.
pub(super) const OVER_RIVAL: f64 = 1.35;

/// A base adjusted to all frames, with what speaks for and against it.
pub(super) struct Candidate {
    pub base: CameraBase,
    /// With the crown, and the size where that was fitted.
    pub field: FieldModel,
    /// The lengths of the field that were fitted.
    pub sizes: Vec<FittedSize>,
    /// Of each frame; none for those that do not hang together with the others or show too little paint.
    pub ptz: Vec<Option<Ptz>>,
    pub evidence: UnclickedEvidence,
    pub doubts: Vec<Doubt>,
    pub neighbours: Neighbours,
}

/// How the frames of a group hold each other. Frames are numbered within the group.
#[derive(Clone)]
pub(super) struct Neighbours {
    /// Their places among the frames looked at.
    pub group: Vec<usize>,
    pub ties: Arc<Vec<Tie>>,
    /// Where they look by the ties alone.
    pub turns: Vec<Ptz>,
    /// By the paint of all together; none for those that show too little.
    pub ptz: Vec<Option<Ptz>>,
    /// Their paint that stays.
    pub paint: Vec<FramePaint>,
    /// What their own paint says.
    pub holds: Vec<Hold>,
}

impl Candidate {
    pub fn score(&self) -> f64 {
        self.evidence.score()
    }
}

/// The bases that explain the frames' paint, the best first; `clicks` name places to begin from, with none they are searched.
/// `frames` were looked at.
pub(super) fn candidates(
    frames: usize,
    tied: &TiedFrames,
    clicks: Option<&[GroundClick]>,
    venue: &Venue,
    watch: WatchUnclicked<'_>,
) -> Result<Vec<Candidate>, Stop> {
    let told = |progress| if watch(progress).is_break() { Err(UnclickedError::Stopped) } else { Ok(()) };
    told(UnclickedProgress::Gathering)?;
    let fields = venue.levels();
    let maps: Vec<PitchMap> = fields.iter().map(PitchMap::of).collect();
    let (starts, levels) = match clicks {
        None => searched(tied, &maps, watch)?,
        Some(clicks) => named(tied, &fields, &maps, clicks, watch)?,
    };
    let group = &tied.group;
    let rigs = rigs(&starts, &levels, &fields, venue);
    let done = AtomicUsize::new(0);
    let of_rig = |&(ref rig, start)| {
        told(UnclickedProgress::Adjusting { done: done.load(Ordering::Relaxed), of: rigs.len() })?;
        let joint = joint_of(rig, start, &levels, venue, tied);
        done.fetch_add(1, Ordering::Relaxed);
        Ok(joint.map(|(joint, evidence)| (joint, evidence, start)))
    };
    let joints: Result<Vec<_>, UnclickedError> = rigs.par_iter().map(of_rig).collect();
    let mut joints: Vec<(Joint, UnclickedEvidence, &Start)> = joints?.into_iter().flatten().collect();
    joints.sort_by(|a, b| b.1.score().total_cmp(&a.1.score()));
    if venue.is_size_free() {
        let climbing = joints.len().min(CLIMBING);
        for (done, (joint, evidence, start)) in joints.iter_mut().take(climbing).enumerate() {
            told(UnclickedProgress::Sizing { done, of: climbing })?;
            climb((joint, evidence), venue, start, tied);
        }
        joints.sort_by(|a, b| b.1.score().total_cmp(&a.1.score()));
    }
    let candidate = |(joint, evidence, start): (Joint, UnclickedEvidence, &Start)| {
        let mut ptz = vec![None; frames];
        for (frame, found) in group.iter().zip(&joint.ptz) {
            ptz[*frame] = *found;
        }
        let doubts = evidence.doubts(&joint);
        let (group, ties, holds) = (group.clone(), Arc::clone(&tied.ties), joint.holds());
        let (turns, paint) = (start.turns.ptz.clone(), start.paint.clone());
        let neighbours = Neighbours { group, ties, turns, ptz: joint.ptz, paint, holds };
        Candidate { base: joint.base, field: joint.field, sizes: joint.sizes, ptz, evidence, doubts, neighbours }
    };
    Ok(joints.into_iter().map(candidate).collect())
}

/// The best of the rigs that several starts lead to, each once, with its start.
fn rigs<'a>(starts: &'a [Start], levels: &TurnLevels, fields: &[FieldModel], venue: &Venue) -> Vec<(Rig, &'a Start)> {
    let sized = venue.is_size_free().then_some(venue);
    let of_start = |start: &'a Start| {
        let Hypothesis { pose, field, .. } = start.hypothesis;
        Some((adjusted_rig(start, (pose, start.log_scale), &fields[field], sized, levels)?, start))
    };
    let mut found: Vec<(Rig, &Start)> = starts.par_iter().filter_map(of_start).collect();
    let score = |(rig, start): &(Rig, &Start)| rig.explained * start.hypothesis.visible;
    found.sort_by(|a, b| score(b).total_cmp(&score(a)));
    let mut distinct: Vec<(Rig, &Start)> = Vec::new();
    for (rig, start) in found {
        let near = |(other, _): &(Rig, &Start)| (other.pose.position_m - rig.pose.position_m).norm() < SAME_M;
        if distinct.len() < ADJUSTED && !distinct.iter().any(near) {
            distinct.push((rig, start));
        }
    }
    distinct
}

/// A rig's frames adjusted each for itself, on the field as assumed or of the size that explains more.
fn joint_of(
    rig: &Rig,
    start: &Start,
    levels: &TurnLevels,
    venue: &Venue,
    tied: &TiedFrames,
) -> Option<(Joint, UnclickedEvidence)> {
    let of_assumed = |sized: bool| {
        let field = &venue.assumed;
        adjusted_rig(start, (rig.pose, rig.log_scale), field, sized.then_some(venue), levels)
    };
    // Where the size is open the rig has the one that fits, elsewhere the one that is known.
    let (as_assumed, sized) = if venue.is_size_free() {
        (of_assumed(false), Some(rig.clone()))
    } else {
        (Some(rig.clone()), venue.is_open().then(|| of_assumed(true)).flatten())
    };
    let (as_assumed, sized) = rayon::join(
        || as_assumed.and_then(|rig| adjusted(&Begin::at(&rig), None, start, tied)),
        || sized.and_then(|rig| adjusted(&Begin::at(&rig), Some(venue), start, tied)),
    );
    of_one_size(as_assumed, sized, venue.is_known)
}

/// Where an adjustment begins.
struct Begin {
    field: FieldModel,
    base: CameraBase,
    ptz: Vec<Option<Ptz>>,
}

impl Begin {
    /// Where a rig stands.
    fn at(rig: &Rig) -> Self {
        Self { field: rig.field.clone(), base: rig.base(), ptz: rig.turns.ptz.iter().copied().map(Some).collect() }
    }

    /// Where an adjustment has ended, the frames that it left out put beside their neighbours.
    fn again(joint: &Joint, start: &Start, tied: &TiedFrames) -> Option<Self> {
        let ptz = filled(&joint.ptz, &start.turns.ptz, &tied.ties)?;
        Some(Self { field: joint.field.clone(), base: joint.base, ptz: ptz.into_iter().map(Some).collect() })
    }
}

/// A base adjusted, and again from where that ends while more is explained by it: frames that were taken for other lines at first
/// find theirs from a better base and size.
fn adjusted(
    begin: &Begin,
    sized: Option<&Venue>,
    start: &Start,
    tied: &TiedFrames,
) -> Option<(Joint, UnclickedEvidence)> {
    const PASSES: usize = 4;
    let adjust = |Begin { field, base, ptz }: &Begin| {
        let joint = joint(field, sized, &start.paint, base, (ptz, &tied.ties), tied.size)?;
        let evidence = evidence::of(&joint, &start.paint, &tied.strokes);
        Some((joint, evidence))
    };
    let mut best = adjust(begin)?;
    for _ in 1..PASSES {
        let Some(next) = Begin::again(&best.0, start, tied).and_then(|again| adjust(&again)) else { break };
        if next.1.score() <= BETTER * best.1.score() {
            break;
        }
        best = next;
    }
    Some(best)
}

/// A base on the field as assumed, unless another size explains more; where the size is known, that is a doubt about it.
fn of_one_size(
    as_assumed: Option<(Joint, UnclickedEvidence)>,
    sized: Option<(Joint, UnclickedEvidence)>,
    is_known: bool,
) -> Option<(Joint, UnclickedEvidence)> {
    /// A stated size is doubted for this. Two more numbers always explain a little more: .1 % on a real pitch of the usual size, 2.8 % on
    /// a drawn one 3 m wider.
    const CLEARLY: f64 = 1.01;
    /// Nobody doubts a stated size for less, m: pitches are painted by tape, and a few decimetres explain a little more on most.
    const DOUBTED_M: f64 = 1.0;
    let (assumed, mut evidence, sized) = match (as_assumed, sized) {
        (Some((assumed, evidence)), Some(sized)) => (assumed, evidence, sized),
        (as_assumed, sized) => return as_assumed.or(sized.filter(|_| !is_known)),
    };
    if !is_known && sized.1.score() >= evidence.score() {
        return Some(sized);
    }
    if sized.1.score() <= CLEARLY * evidence.score() {
        return Some((assumed, evidence));
    }
    let [length_m, width_m] = [sized.0.field.length_m, sized.0.field.width_m];
    let off_m = (length_m - assumed.field.length_m).abs().max((width_m - assumed.field.width_m).abs());
    evidence.other_size_m = (off_m > DOUBTED_M).then_some([length_m, width_m]);
    Some((assumed, evidence))
}

/// Moves a base to neighbouring sizes of the field as long as another one explains more: the fit of the size alone stays where
/// wrong lines have been taken for each other.
fn climb(
    (joint_here, evidence_here): (&mut Joint, &mut UnclickedEvidence),
    venue: &Venue,
    start: &Start,
    tied: &TiedFrames,
) {
    const STEPS: usize = 3;
    for _ in 0..STEPS {
        let beside = venue.beside(&joint_here.field);
        let tried = beside.par_iter().filter_map(|field| {
            let from = (joint_here.ptz.as_slice(), tied.ties.as_slice());
            let joint = joint(field, Some(venue), &start.paint, &joint_here.base, from, tied.size)?;
            let evidence = evidence::of(&joint, &start.paint, &tied.strokes);
            Some((joint, evidence))
        });
        let tried: Vec<(Joint, UnclickedEvidence)> = tried.collect();
        let best = tried.into_iter().max_by(|a, b| a.1.score().total_cmp(&b.1.score()));
        let Some((joint, evidence)) = best.filter(|(_, it)| it.score() > BETTER * evidence_here.score()) else {
            return;
        };
        (*joint_here, *evidence_here) = (joint, evidence);
    }
}
