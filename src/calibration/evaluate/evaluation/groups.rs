//! Groups of frames and the summaries of their scores.

use super::{Evaluation, FrameResult, FrameScores, Measure};
use touchline_core::geometry::ImageSize;
use touchline_core::score::{SigmaCoverage, Summary};

/// The criterion of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GroupKind {
    /// All frames.
    All,
    /// The frames of one shot.
    Clip,
    /// The frames of one camera.
    Camera,
    /// Frames of about the same field of view.
    View,
}

impl GroupKind {
    /// Its name in files.
    pub const fn key(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Clip => "clip",
            Self::Camera => "camera",
            Self::View => "view",
        }
    }
}

/// A group of frames and its scores. Errors are those of frames with a camera, so the completeness
/// belongs to them.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameGroup {
    /// Criterion of the group.
    pub kind: GroupKind,
    /// Name of the group: shot, camera, or range of the field of view in degrees.
    pub name: String,
    /// The sizes of their pictures, in whose px errors are.
    pub image_sizes: Vec<ImageSize>,
    /// Number of frames with a truth.
    pub frames: usize,
    /// Number of those that have a camera in the estimate.
    pub scored: usize,
    /// Summaries over the frames of every measure that some frame has.
    pub measures: Vec<(Measure, Summary)>,
    /// Distances of all clicks from which the estimates were made, px.
    pub clicks_px: Option<Summary>,
    /// Distances of all other clicks, px.
    pub held_out_px: Option<Summary>,
    /// Distances of these on the ground, m.
    pub held_out_m: Option<Summary>,
    /// Calibration of the stated sigmas.
    pub coverage: Option<SigmaCoverage>,
}

/// The width of a bin of fields of view, degrees.
const VIEW_BIN_DEG: f64 = 10.0;

impl FrameGroup {
    /// The share of the frames that have a camera.
    pub fn completeness(&self) -> f64 {
        self.scored as f64 / (self.frames as f64).max(1.0)
    }

    /// The summary of one measure.
    pub fn measure(&self, measure: Measure) -> Option<&Summary> {
        self.measures
            .iter()
            .find(|(other, _)| *other == measure)
            .map(|(_, summary)| summary)
    }

    /// The score of the `SoccerNet` camera calibration task: mean `JaC@5` times completeness.
    pub fn soccernet_score(&self) -> Option<f64> {
        self.measure(Measure::Jaccard5)
            .map(|jaccard| jaccard.mean * self.completeness())
    }

    fn from_frames(kind: GroupKind, name: String, frames: &[&FrameResult], seed: u64) -> Self {
        // Errors are summarised over the frames that have a camera. The others count in the
        // completeness alone: an error of theirs would be made up.
        let scored: Vec<&FrameScores> = frames
            .iter()
            .filter_map(|frame| frame.scores.as_ref().ok())
            .collect();
        let summaries = Measure::ALL.into_iter().filter_map(|measure| {
            let summary = Summary::from_values(&values_of(&scored, measure), seed)?;
            Some((measure, summary))
        });
        // The measure is the root mean square over three parameters; the coverage needs their sum,
        // χ² with three degrees of freedom.
        let squared: Vec<f64> = values_of(&scored, Measure::Sigmas)
            .iter()
            .map(|sigmas| 3.0 * sigmas * sigmas)
            .collect();
        let mut sizes: Vec<ImageSize> = Vec::new();
        for frame in frames {
            if !sizes.contains(&frame.image_size) {
                sizes.push(frame.image_size);
            }
        }
        Self {
            kind,
            name,
            image_sizes: sizes,
            frames: frames.len(),
            scored: scored.len(),
            measures: summaries.collect(),
            clicks_px: summarise_pooled(&scored, |scores| &scores.clicks_px, seed),
            held_out_px: summarise_pooled(&scored, |scores| &scores.held_out_px, seed),
            held_out_m: summarise_pooled(&scored, |scores| &scores.held_out_m, seed),
            coverage: SigmaCoverage::from_squared_distances(&squared),
        }
    }
}

/// A measure of the frames, one value per frame that has it.
fn values_of(scored: &[&FrameScores], measure: Measure) -> Vec<f64> {
    scored
        .iter()
        .filter_map(|scores| scores.get(measure))
        .collect()
}

/// The summary of distances of clicks. They are pooled over frames, so that frames with many clicks
/// count for more.
fn summarise_pooled(
    scored: &[&FrameScores],
    distances: fn(&FrameScores) -> &[f64],
    seed: u64,
) -> Option<Summary> {
    let values: Vec<f64> = scored
        .iter()
        .flat_map(|scores| distances(scores))
        .copied()
        .collect();
    Summary::from_values(&values, seed)
}

impl Evaluation {
    /// All frames together, then by shot, by camera and by field of view. A criterion with a single
    /// group is left out. `seed` determines the bootstrap intervals.
    pub fn groups(&self, seed: u64) -> Vec<FrameGroup> {
        let all: Vec<&FrameResult> = self.frames.iter().collect();
        let mut groups = vec![FrameGroup::from_frames(
            GroupKind::All,
            "all".to_owned(),
            &all,
            seed,
        )];
        let clip = |frame: &FrameResult| frame.clip.as_ref().map(ToString::to_string);
        let camera = |frame: &FrameResult| Some(frame.camera.as_str().to_owned());
        self.add(&mut groups, GroupKind::Clip, &clip, seed);
        self.add(&mut groups, GroupKind::Camera, &camera, seed);
        self.add(&mut groups, GroupKind::View, &view_bin, seed);
        groups
    }

    /// Adds the groups of one criterion, if there is more than one.
    fn add(
        &self,
        groups: &mut Vec<FrameGroup>,
        kind: GroupKind,
        name: &dyn Fn(&FrameResult) -> Option<String>,
        seed: u64,
    ) {
        // A frame without a shot or a field of view is in none of the criterion's groups.
        let mut names: Vec<String> = self.frames.iter().filter_map(name).collect();
        // Natural order: shot 2 before shot 10.
        alphanumeric_sort::sort_str_slice(&mut names);
        names.dedup();
        if names.len() < 2 {
            return;
        }
        for wanted in names {
            let of_group: Vec<&FrameResult> = self
                .frames
                .iter()
                .filter(|frame| name(frame).as_ref() == Some(&wanted))
                .collect();
            groups.push(FrameGroup::from_frames(kind, wanted, &of_group, seed));
        }
    }
}

/// The bin of a frame's field of view, as text.
fn view_bin(frame: &FrameResult) -> Option<String> {
    let from = (frame.view?.degrees() / VIEW_BIN_DEG).floor() * VIEW_BIN_DEG;
    Some(format!("{from:.0}–{:.0}°", from + VIEW_BIN_DEG))
}
