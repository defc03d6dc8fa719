//! The base of a camera from its frames alone, without a click.
//!
//! One frame lacks lines, but the frames of one fixed camera together show most of the field. Their pictures tie together by
//! rotation and zoom ([`crate::track`]); paint that many of them show in one direction is drawn on the ground
//! ([`persistent_paint`]); a field of known size fits what is drawn in one way only. Places are tried, the best are adjusted
//! with all frames to the paint in the pictures, and the answer is given where it explains the paint, is seen where it
//! should be, and leaves its rivals behind.

mod error;
mod evidence;
mod joint;
mod pitch_map;
mod pose;
mod record;
mod search;

pub use error::UnclickedError;
pub use evidence::UnclickedEvidence;
pub use record::record_found;

use crate::camera::{BaseAngles, CameraBase, Ptz};
use crate::features::{FeatureError, FeatureOptions, Features, extract};
use crate::field::FieldModel;
use crate::geometry::{ImageSize, PixelBox, Vec3};
use crate::media::Picture;
use crate::paint::{GroundPicture, PersistentPoint, SeenGround, Strokes, persistent_paint};
use crate::track::{Tie, TurnOptions, Turns, adjust_turns, groups, tie_frames};
use joint::{FramePaint, Joint, joint};
use pitch_map::PitchMap;
use pose::RigPose;
use search::{Hypothesis, Panorama, search};
use std::ops::ControlFlow;

/// What is kept of a frame's picture.
#[derive(Clone, Debug)]
pub struct FrameTraces {
    features: Features,
    strokes: Strokes,
}

impl FrameTraces {
    /// Of a picture; nothing within `masks` (px) counts.
    ///
    /// # Errors
    /// The program was built without OpenCV, or OpenCV refused.
    pub fn of(picture: &Picture, masks: &[PixelBox]) -> Result<Self, FeatureError> {
        let options = FeatureOptions { root_sift: true, ..FeatureOptions::default() };
        let features = extract(picture, masks, &options)?;
        let strokes = Strokes::of(&GroundPicture::new(picture, masks));
        Ok(Self { features, strokes })
    }

    fn size(&self) -> ImageSize {
        self.strokes.size()
    }
}

/// A base that was found, and the cameras of the frames that it was found from.
#[derive(Clone, Debug, PartialEq)]
pub struct UnclickedBase {
    /// The base, in the pan gauge of the conventions.
    pub base: CameraBase,
    /// The height of the pitch's crown, m.
    pub crown_m: f64,
    /// Of each frame; none for those that do not hang together with the others or show too little paint.
    pub ptz: Vec<Option<Ptz>>,
    /// What speaks for it.
    pub evidence: UnclickedEvidence,
}

/// How far the search has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnclickedProgress {
    /// Pairs of frames compared, of how many.
    Tying(usize, usize),
    /// Places are tried for the focal lengths as tied, times this many hundredths.
    Trying(u32),
    /// The best places are adjusted with all frames: this one, of how many.
    Adjusting(usize, usize),
}

/// How much longer or shorter than the ties say the focal lengths may be: rotations leave their common scale uncertain.
const FOCAL_PERCENT: [u32; 5] = [100, 94, 106, 88, 113];

/// Places that are adjusted with all frames.
const ADJUSTED: usize = 5;

/// Two answers this near to each other are one, m.
const SAME_M: f64 = 1.5;

/// The base of a camera from frames of it. `watch` is told how far it has come and may end it.
///
/// # Errors
/// By name, why there is no answer: see [`UnclickedError`].
pub fn base_without_clicks(
    frames: &[FrameTraces],
    field: &FieldModel,
    watch: &(dyn Fn(UnclickedProgress) -> ControlFlow<()> + Sync),
) -> Result<UnclickedBase, UnclickedError> {
    let told = |progress| if watch(progress).is_break() { Err(UnclickedError::Stopped) } else { Ok(()) };
    let features: Vec<Features> = frames.iter().map(|frame| frame.features.clone()).collect();
    let ties = tie_frames(&features, &|done, of| watch(UnclickedProgress::Tying(done, of)))?;
    told(UnclickedProgress::Tying(1, 1))?;
    let group = largest_group(frames, &ties)?;
    let size = frames[group[0]].size();
    let tied = Group::new(frames, &group, &ties);

    let map = PitchMap::of(field);
    let mut starts: Vec<Start> = Vec::new();
    for percent in FOCAL_PERCENT {
        told(UnclickedProgress::Trying(percent))?;
        let options = TurnOptions { focal_scale: f64::from(percent) / 100.0, ..TurnOptions::default() };
        let turns = match adjust_turns(group.len(), &tied.ties, size, &options) {
            Ok(turns) => turns,
            Err(error) if percent == FOCAL_PERCENT[0] => return Err(error.into()),
            Err(_) => continue,
        };
        starts.extend(tied.places(&turns, &map)?);
    }
    starts.sort_by(|a, b| b.hypothesis.score().total_cmp(&a.hypothesis.score()));

    let mut found: Vec<(Joint, UnclickedEvidence)> = Vec::new();
    let mut tried = 0;
    for start in &starts {
        if tried == ADJUSTED {
            break;
        }
        told(UnclickedProgress::Adjusting(tried, ADJUSTED))?;
        let base = start.base(size);
        if found.iter().any(|(joint, _)| (joint.start_m - base.position_m).norm() < SAME_M) {
            continue;
        }
        tried += 1;
        let Some(joint) = joint(field, &start.paint, base, &start.turns.ptz, size) else { continue };
        let evidence = evidence::of(field, &joint, &start.paint, &tied.strokes);
        found.push((joint, evidence));
    }
    found.sort_by(|a, b| b.1.score().total_cmp(&a.1.score()));
    let mut found = found.into_iter();
    let Some((best, mut evidence)) = found.next() else { return Err(UnclickedError::NothingFits) };
    let rival = found.find(|(joint, _)| (joint.base.position_m - best.base.position_m).norm() > SAME_M);
    evidence.rival = rival.map_or(0.0, |(_, evidence)| evidence.score());
    evidence.check(&best)?;
    let mut ptz = vec![None; frames.len()];
    for (frame, found) in group.iter().zip(&best.ptz) {
        ptz[*frame] = *found;
    }
    Ok(UnclickedBase { base: best.base, crown_m: best.crown_m, ptz, evidence })
}

/// The largest group of frames of one size that hang together.
fn largest_group(frames: &[FrameTraces], ties: &[Tie]) -> Result<Vec<usize>, UnclickedError> {
    /// Fewer frames hardly show what is drawn on the ground and what is not.
    const LEAST: usize = 3;
    let same_size: Vec<Tie> =
        ties.iter().filter(|tie| frames[tie.first].size() == frames[tie.second].size()).cloned().collect();
    let group = groups(frames.len(), &same_size).into_iter().next().unwrap_or_default();
    if group.len() < LEAST {
        return Err(UnclickedError::NotTied { frames: frames.len(), tied: group.len() });
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
    fn places(&self, turns: &Turns, map: &PitchMap) -> Result<Vec<Start>, UnclickedError> {
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
            return Err(UnclickedError::LittlePaint { places: panorama.directions.len() });
        }
        let paint = paint_of_frames(&points, self.strokes.len());
        let start = |hypothesis| Start { hypothesis, turns: turns.clone(), paint: paint.clone() };
        Ok(search(&panorama, map).into_iter().take(OF_SCALE).map(start).collect())
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
