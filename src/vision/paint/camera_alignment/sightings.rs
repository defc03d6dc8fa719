//! Observations of the paint that a camera predicts: samples along the lines, and the ridges that
//! the picture shows across each.

use crate::paint::GroundPicture;
use crate::paint::ridges::profile::{Across, Ridge};
use crate::paint::ridges::ridge::RidgeFinder;
use crate::paint::turf::surface::GroundPart;
use std::ops::Range;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::markings::{LineSample, SampleOptions, sample_lines};

/// Minimum share of the pixels across a sample that have the ground's colours, for it to count as
/// bare ground.
const BARE: f64 = 0.75;

/// What is seen at one sample of a line.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum SampleContent {
    /// Ridges, as a range of indices into [`LineObservations::ridges`].
    Paint(Range<usize>),
    /// Ground without paint.
    Bare,
    /// Neither: a player, a board, a graphic.
    Hidden,
}

/// What a picture shows at every sample of the lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct LineObservations {
    /// The samples of the predicted lines.
    pub samples: Vec<LineSample>,
    /// What is seen at each sample.
    pub seen: Vec<SampleContent>,
    /// All ridges; those of one sample are consecutive and in order of their offset.
    pub ridges: Vec<Ridge>,
}

/// Sampling of a picture, px.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::struct_field_names, reason = "each name ends with its unit")]
pub(super) struct SamplingDistances {
    /// Reach of the search on both sides of a predicted line.
    pub reach_px: f64,
    /// Distance between neighbouring samples of a line.
    pub spacing_px: f64,
    /// Distance between the samples of a profile across a line.
    pub step_px: f64,
}

impl LineObservations {
    /// Searches a picture for the paint that a camera predicts. Lengths of `look` are px of the
    /// picture.
    pub(in crate::paint) fn search(
        ground: &GroundPicture,
        field: &FieldModel,
        camera: &PtzCamera,
        look: SamplingDistances,
    ) -> Self {
        let options = SampleOptions {
            spacing_px: look.spacing_px,
            ..SampleOptions::default()
        };
        let samples = sample_lines(field, camera, ground.size(), &options);
        let mut finder = RidgeFinder::default();
        let mut ridges = Vec::new();
        let seen = samples
            .iter()
            .map(|sample| {
                if ground.is_masked(sample.image) {
                    return SampleContent::Hidden;
                }
                // The finder appends to one list for all samples, so that a sample stores a range
                // instead of a vector of its own.
                let across = Across::from(sample);
                let first = ridges.len();
                finder.find(ground, &across, look.reach_px, look.step_px, &mut ridges);
                // Without a ridge, bare ground is evidence against the line; a player or a board is
                // not.
                if ridges.len() > first {
                    SampleContent::Paint(first..ridges.len())
                } else if is_bare(ground, &across, look.reach_px) {
                    SampleContent::Bare
                } else {
                    SampleContent::Hidden
                }
            })
            .collect();
        Self {
            samples,
            seen,
            ridges,
        }
    }

    /// The ridges at a sample.
    pub fn ridges_at(&self, sample: usize) -> &[Ridge] {
        match &self.seen[sample] {
            SampleContent::Paint(range) => &self.ridges[range.clone()],
            SampleContent::Bare | SampleContent::Hidden => &[],
        }
    }

    /// The ridge of a sample that is nearest to an offset from the predicted line, px.
    pub fn nearest(&self, sample: usize, offset_px: f64) -> Option<&Ridge> {
        let distance = |ridge: &Ridge| (ridge.offset_px - offset_px).abs();
        self.ridges_at(sample)
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// Number of samples that show bare ground.
    pub fn bare(&self) -> usize {
        self.seen
            .iter()
            .filter(|seen| **seen == SampleContent::Bare)
            .count()
    }
}

/// Whether the ground is open on both sides of a predicted line. The caller has found no ridge.
fn is_bare(ground: &GroundPicture, across: &Across, reach_px: f64) -> bool {
    const STEP_PX: usize = 2;
    let reach = (reach_px + across.width_px).ceil() as i32;
    let (mut all, mut bare, mut areas) = (0_u32, 0_u32, 0_u32);
    // Every other px over the reach of the search and the width of the line. Points outside the
    // picture are counted and show no ground, so that samples at the border tend to be hidden.
    for offset in (-reach..=reach).step_by(STEP_PX) {
        all += 1;
        match ground.part(across.point(f64::from(offset))) {
            Some(GroundPart::Bare) => bare += 1,
            Some(GroundPart::Area) => areas += 1,
            None => {}
        }
    }
    // Where an area of another colour begins, a narrow line is hardly visible, and the boundary of
    // many courts is no line at all: a sample is bare only on one kind of ground.
    let open = bare.max(areas);
    f64::from(open) >= BARE * f64::from(all)
}
