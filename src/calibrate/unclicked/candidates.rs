//! The bases that explain the paint of tied frames, the best first.

use super::joint::{FramePaint, Joint, joint};
use super::pitch_map::PitchMap;
use super::pose::RigPose;
use super::search::{Hypothesis, PLACES, Panorama, search};
use super::traces::FrameTraces;
use super::venue::Venue;
use super::{Abstention, Doubt, UnclickedError, UnclickedEvidence, UnclickedProgress, WatchUnclicked, evidence};
use crate::camera::{BaseAngles, CameraBase, Ptz};
use crate::features::Features;
use crate::field::FieldModel;
use crate::geometry::{ImageSize, Vec3};
use crate::paint::{PersistentPoint, SeenGround, Strokes, persistent_paint};
use crate::solve::base::FittedSize;
use crate::track::{Hold, Tie, TurnOptions, Turns, adjust_turns, groups, tie_frames};
use rayon::prelude::*;
use std::sync::Arc;

/// How much longer or shorter than the ties say the focal lengths may be: rotations leave their common scale uncertain.
const FOCAL_PERCENT: [u32; 5] = [100, 94, 106, 88, 113];

/// Places that are adjusted with all frames.
const ADJUSTED: usize = 5;

/// The best of these are moved to neighbouring sizes of the field.
const CLIMBING: usize = 2;

/// Two answers this near to each other are one, m.
pub(super) const SAME_M: f64 = 1.5;

/// A place is taken for the only one if it explains this many times as much as the next.
pub(super) const OVER_RIVAL: f64 = 1.35;

/// Why the search ended before its answer.
pub(super) enum Stop {
    Failed(UnclickedError),
    Abstained(Abstention),
}

impl From<UnclickedError> for Stop {
    fn from(error: UnclickedError) -> Self {
        Self::Failed(error)
    }
}

impl From<Abstention> for Stop {
    fn from(why: Abstention) -> Self {
        Self::Abstained(why)
    }
}

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

/// The bases that explain the frames' paint, the best first.
pub(super) fn candidates(
    frames: &[FrameTraces],
    venue: &Venue,
    watch: WatchUnclicked<'_>,
) -> Result<Vec<Candidate>, Stop> {
    let told = |progress| if watch(progress).is_break() { Err(UnclickedError::Stopped) } else { Ok(()) };
    let features: Vec<Features> = frames.iter().map(|frame| frame.features.clone()).collect();
    let pairs = frames.len() * frames.len().saturating_sub(1) / 2;
    let ties = tie_frames(&features, &|done, of| watch(UnclickedProgress::Tying { done, of }))
        .map_err(UnclickedError::Track)?;
    told(UnclickedProgress::Tying { done: pairs, of: pairs })?;
    let group = largest_group(frames, &ties)?;
    let size = frames[group[0]].size();
    let tied = Group::new(frames, &group, &ties);

    told(UnclickedProgress::Gathering)?;
    let fields = venue.levels();
    let maps: Vec<PitchMap> = fields.iter().map(PitchMap::of).collect();
    let mut starts: Vec<Start> = Vec::new();
    for (done, percent) in FOCAL_PERCENT.into_iter().enumerate() {
        told(UnclickedProgress::Trying { places: PLACES * fields.len(), done, of: FOCAL_PERCENT.len() })?;
        let options = TurnOptions { focal_scale: f64::from(percent) / 100.0, ..TurnOptions::default() };
        let turns = match adjust_turns(group.len(), &tied.ties, size, &options) {
            Ok(turns) => turns,
            Err(error) if percent == FOCAL_PERCENT[0] => return Err(Abstention::NotTurning(error).into()),
            Err(_) => continue,
        };
        starts.extend(tied.places(&turns, &maps)?);
    }
    starts.sort_by(|a, b| b.hypothesis.score().total_cmp(&a.hypothesis.score()));

    let ties = Arc::new(tied.ties.clone());
    let mut joints: Vec<(Joint, UnclickedEvidence, &Start)> = Vec::new();
    let mut tried = 0;
    for start in &starts {
        if tried == ADJUSTED {
            break;
        }
        told(UnclickedProgress::Adjusting { done: tried, of: ADJUSTED })?;
        let base = start.base(size);
        if joints.iter().any(|(joint, ..)| (joint.start_m - base.position_m).norm() < SAME_M) {
            continue;
        }
        tried += 1;
        let adjusted = |sized: Option<&Venue>| {
            let field = &fields[start.hypothesis.field];
            let ptz: Vec<Option<Ptz>> = start.turns.ptz.iter().copied().map(Some).collect();
            let joint = joint(field, sized, &start.paint, &base, (&ptz, &tied.ties), size)?;
            let evidence = evidence::of(&joint, &start.paint, &tied.strokes);
            Some((joint, evidence))
        };
        let as_assumed = (start.hypothesis.field == 0).then(|| adjusted(None)).flatten();
        let sized = venue.is_open().then(|| adjusted(Some(venue))).flatten();
        let better = of_one_size(as_assumed, sized, venue.is_known);
        joints.extend(better.map(|(joint, evidence)| (joint, evidence, start)));
    }
    joints.sort_by(|a, b| b.1.score().total_cmp(&a.1.score()));
    if venue.is_open() && !venue.is_known {
        let climbing = joints.len().min(CLIMBING);
        for (done, (joint, evidence, start)) in joints.iter_mut().take(climbing).enumerate() {
            told(UnclickedProgress::Sizing { done, of: climbing })?;
            climb((joint, evidence), venue, start, &tied, size);
        }
        joints.sort_by(|a, b| b.1.score().total_cmp(&a.1.score()));
    }
    let candidate = |(joint, evidence, start): (Joint, UnclickedEvidence, &Start)| {
        let mut ptz = vec![None; frames.len()];
        for (frame, found) in group.iter().zip(&joint.ptz) {
            ptz[*frame] = *found;
        }
        let doubts = evidence.doubts(&joint);
        let (group, ties, holds) = (group.clone(), Arc::clone(&ties), joint.holds());
        let (turns, paint) = (start.turns.ptz.clone(), start.paint.clone());
        let neighbours = Neighbours { group, ties, turns, ptz: joint.ptz, paint, holds };
        Candidate { base: joint.base, field: joint.field, sizes: joint.sizes, ptz, evidence, doubts, neighbours }
    };
    Ok(joints.into_iter().map(candidate).collect())
}

/// A base on the field as assumed, unless another size explains more; where the size is known, that is a doubt about it.
fn of_one_size(
    as_assumed: Option<(Joint, UnclickedEvidence)>,
    sized: Option<(Joint, UnclickedEvidence)>,
    is_known: bool,
) -> Option<(Joint, UnclickedEvidence)> {
    /// Two more numbers always explain a little more: .1 % on a real pitch of the usual size, 2.8 % on a drawn one 3 m wider.
    const CLEARLY: f64 = 1.01;
    /// Nobody doubts a stated size for less, m: pitches are painted by tape, and a few decimetres explain a little more on most.
    const DOUBTED_M: f64 = 1.0;
    let (assumed, mut evidence, sized) = match (as_assumed, sized) {
        (Some((assumed, evidence)), Some(sized)) => (assumed, evidence, sized),
        (as_assumed, sized) => return as_assumed.or(sized.filter(|_| !is_known)),
    };
    if sized.1.score() <= CLEARLY * evidence.score() {
        return Some((assumed, evidence));
    }
    if !is_known {
        return Some(sized);
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
    tied: &Group,
    size: ImageSize,
) {
    /// So much more is explained by a better size.
    const BETTER: f64 = 1.01;
    const STEPS: usize = 3;
    for _ in 0..STEPS {
        let beside = venue.beside(&joint_here.field);
        let tried = beside.par_iter().filter_map(|field| {
            let from = (joint_here.ptz.as_slice(), tied.ties.as_slice());
            let joint = joint(field, Some(venue), &start.paint, &joint_here.base, from, size)?;
            let evidence = evidence::of(&joint, &start.paint, &tied.strokes);
            Some((joint, evidence))
        });
        let tried: Vec<(Joint, UnclickedEvidence)> = tried.collect();
        let best = tried.into_iter().max_by(|a, b| a.1.score().total_cmp(&b.1.score()));
        let Some((mut joint, evidence)) = best.filter(|(_, it)| it.score() > BETTER * evidence_here.score()) else {
            return;
        };
        joint.start_m = joint_here.start_m;
        (*joint_here, *evidence_here) = (joint, evidence);
    }
}

/// The largest group of frames of one size that hang together.
fn largest_group(frames: &[FrameTraces], ties: &[Tie]) -> Result<Vec<usize>, Abstention> {
    /// Fewer frames hardly show what is drawn on the ground and what is not.
    const LEAST: usize = 3;
    let same_size: Vec<Tie> =
        ties.iter().filter(|tie| frames[tie.first].size() == frames[tie.second].size()).cloned().collect();
    let group = groups(frames.len(), &same_size).into_iter().next().unwrap_or_default();
    if group.len() < LEAST {
        return Err(Abstention::NotTied { frames: frames.len(), tied: group.len() });
    }
    Ok(group)
}

/// Frames that hang together, numbered among themselves.
struct Group {
    ties: Vec<Tie>,
    strokes: Vec<Strokes>,
}

impl Group {
    fn new(frames: &[FrameTraces], group: &[usize], ties: &[Tie]) -> Self {
        let place = |frame: usize| group.binary_search(&frame).ok();
        let inside = |tie: &Tie| Some(Tie { first: place(tie.first)?, second: place(tie.second)?, ..tie.clone() });
        let strokes = group.iter().map(|frame| frames[*frame].strokes.clone()).collect();
        Self { ties: ties.iter().filter_map(inside).collect(), strokes }
    }

    /// The best places for the frames turned as stated.
    fn places(&self, turns: &Turns, maps: &[PitchMap]) -> Result<Vec<Start>, Abstention> {
        /// Places of one focal scale that may be adjusted.
        const OF_SCALE: usize = 3;
        /// Directions of paint without which nothing can be found.
        const LEAST: usize = 150;
        let frames: Vec<_> =
            self.strokes.iter().enumerate().map(|(frame, strokes)| (turns.camera(frame), strokes.clone())).collect();
        let points = persistent_paint(&frames);
        let directions: Vec<Vec3> = points.iter().map(|point| point.direction).collect();
        let panorama = Panorama::of(&directions, SeenGround::of(&frames));
        if panorama.directions.len() < LEAST {
            return Err(Abstention::LittlePaint { places: panorama.directions.len() });
        }
        let paint = paint_of_frames(&points, self.strokes.len());
        let start = |hypothesis| Start { hypothesis, turns: turns.clone(), paint: paint.clone() };
        Ok(search(&panorama, maps).into_iter().take(OF_SCALE).map(start).collect())
    }
}

fn paint_of_frames(points: &[PersistentPoint], frames: usize) -> Vec<FramePaint> {
    let mut paint = vec![FramePaint::new(); frames];
    for point in points {
        paint[point.frame].push(point.stroke.at);
    }
    paint
}

/// A place from which everything is adjusted.
struct Start {
    hypothesis: Hypothesis,
    turns: Turns,
    paint: Vec<FramePaint>,
}

impl Start {
    fn base(&self, size: ImageSize) -> CameraBase {
        let RigPose { position_m, world_from_rig } = self.hypothesis.pose;
        let base_from_rig = BaseAngles::default().base_from_world();
        let base_from_world = base_from_rig * world_from_rig.transpose();
        CameraBase { distortion: self.turns.lens, ..CameraBase::new(position_m, base_from_world, size.centre()) }
    }
}
