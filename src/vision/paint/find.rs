//! Finds pan, tilt and focal length of one picture from its painted lines alone. The base is known.
//!
//! # Method
//!
//! 1. **Grid**: every direction in which the field lies, at every focal length, is scored against
//!    the marking pixels of the picture (`evidence.rs`). Grid nodes are 36 px apart in the picture.
//! 2. **Local search** from the 200 best nodes, by coordinate steps of 18, 9 and 4.5 px, with maps
//!    of half the reach.
//! 3. **Alignment** of the best 12 to the paint (`snap.rs`).
//! 4. **Decision**: the best camera is accepted if the line check and the agreement are high
//!    enough and if no other camera, aligned or not, agrees nearly as well.
//!
//! The search is exhaustive instead of random: parallel lines make many local maxima, and the
//! result is the same in every run.

use super::{GroundPicture, SnapError, SnapOptions, Snapped, snap};
use crate::paint::camera_alignment::check::overlays_apart_px;
use crate::paint::markings::agreement::{Agreement, PaintedCells};
use crate::paint::markings::evidence::{Chains, EvidenceMaps};
use crate::paint::markings::marking_pixels::MarkingPixels;
use rayon::prelude::*;
use thiserror::Error;
use touchline_core::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Angle, AngleRange, ImageSize};
use touchline_core::progress::Progress;
use touchline_core::solve::Observation;

/// Settings of the camera search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FindOptions {
    /// Range of focal lengths, px at 1920 px width. 800 to 3200 by default: narrower views show too
    /// few lines. The range is for a soccer pitch seen from its stands. It is scaled up for a field
    /// that looks smaller, such as a basketball court. The lower end must be positive.
    pub focal_px: (f64, f64),
    /// Settings of the alignment of the best candidates.
    pub snap: SnapOptions,
    /// Number of candidates that are aligned to the paint. 12 by default.
    pub tried: usize,
    /// Minimum score of the result's line check. 0.93 by default.
    pub min_score: f64,
    /// Minimum of the share of marking pixels that the result explains, times the share of its
    /// predicted lines that are seen. 0.2 by default.
    pub min_agreement: f64,
    /// Maximum agreement of the runner-up, as a share of the result's agreement. 0.75 by default.
    pub max_rival: f64,
}

impl Default for FindOptions {
    fn default() -> Self {
        Self {
            focal_px: (800.0, 3200.0),
            snap: SnapOptions::default(),
            tried: 12,
            min_score: 0.93,
            min_agreement: 0.2,
            max_rival: 0.75,
        }
    }
}

/// Why no camera was found.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum FindError {
    /// The picture shows too few marking pixels.
    #[error("the picture shows {found_px:.0} px of painted lines, {needed_px:.0} px are needed")]
    TooLittlePaint {
        /// Total length of the markings, px.
        found_px: f64,
        /// Minimum length, px.
        needed_px: f64,
    },
    /// None of the best candidates can be aligned to the paint.
    #[error("no camera fits the painted lines; of the likeliest: {reason}")]
    NotSnapped {
        /// Why the best candidate could not be aligned.
        reason: SnapError,
    },
    /// The best camera explains too little of the paint.
    #[error("the painted lines do not decide (line check {score:.2}, agreement {agreement:.2})")]
    NotBorneOut {
        /// Score of the line check, 0 to 1.
        score: f64,
        /// Share of the marking pixels that are explained, times the share of the predicted lines
        /// that are seen.
        agreement: f64,
    },
    /// Two different cameras fit nearly as well.
    #[error("another camera {} fits the painted lines nearly as well", place_of_other(*.apart_px))]
    Ambiguous {
        /// Median distance between the overlays of the two cameras, px; infinite if they show
        /// hardly anything in common.
        apart_px: f64,
    },
    /// The caller stopped the search.
    #[error("the search was stopped")]
    Stopped,
}

/// Where a camera lies that fits nearly as well.
fn place_of_other(apart_px: f64) -> String {
    if apart_px.is_finite() {
        format!("{apart_px:.0} px away")
    } else {
        "that looks elsewhere".to_owned()
    }
}

/// The result of the camera search.
#[derive(Clone, Debug, PartialEq)]
pub struct PaintSearchResult {
    /// The camera, aligned to the paint.
    pub snapped: Snapped,
    /// Agreement of the picture's markings with the camera's lines, in both directions.
    pub agreement: Agreement,
    /// Agreement of the runner-up, both directions multiplied; 0 if there is no other candidate.
    pub rival: f64,
}

/// Distance between neighbouring grid nodes, as motion of the picture, px at 1920 px width.
const GRID_PX: f64 = 36.0;

/// Maximum distance of a predicted line from a marking in the grid search, px at 1920 px width.
const COARSE_REACH_PX: f64 = 40.0;

/// Number of grid nodes from which the local search starts.
const NUM_LOCAL_STARTS: usize = 200;

/// Maximum distance of a predicted line from a marking in the local search, and the sizes of its
/// steps, px at 1920 px width.
const FINE_REACH_PX: f64 = 20.0;
const STEPS_PX: [f64; 3] = [18.0, 9.0, 4.5];

/// Directions of the local search: pan, tilt, zoom.
const DIRECTIONS: [[f64; 3]; 6] = [
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
];

/// Length of the pieces that represent the lines, m, in the grid search and in the local search.
const COARSE_PIECE_M: f64 = 4.0;
const FINE_PIECE_M: f64 = 2.0;

/// Candidates nearer to a better one than this are dropped, px at 1920 px width: in the grid search
/// and in the local search.
const SAME_NODE_PX: f64 = 45.0;
const SAME_CANDIDATE_PX: f64 = 16.0;

/// Two aligned cameras nearer than this count as the same, px at 1920 px width.
const SAME_PX: f64 = 10.0;

/// Distance of the camera from the centre of a soccer pitch, in lengths of the pitch, for which
/// [`FindOptions::focal_px`] is meant. Longer focal lengths are tried for a field that is farther
/// away relative to its length.
const USUAL_LENGTHS: f64 = 0.75;

/// Minimum number of marking pixels, px at 1920 px width.
const LEAST_PAINT_PX: f64 = 500.0;

/// Share of the grid search in the reported progress.
const GRID_WORK: f64 = 0.7;

/// Finds the camera of a picture from its painted lines. `clicks`, if any, constrain the alignment.
/// `progress` receives the completed share, from 0 to 1.
///
/// # Errors
/// [`FindError`]: too little paint, no camera that fits it, or another camera that fits nearly as
/// well.
pub fn find_camera(
    ground: &GroundPicture,
    field: &FieldModel,
    base: &CameraBase,
    clicks: &[Observation],
    options: &FindOptions,
    progress: &Progress<'_, f64>,
) -> Result<PaintSearchResult, FindError> {
    let scale = ground.size().scale_from_1920();
    let marking_pixels = MarkingPixels::detect(ground);
    // A picture with little paint fits many cameras; the search would only take time.
    let (found_px, needed_px) = (marking_pixels.points.len() as f64, LEAST_PAINT_PX * scale);
    if !(found_px >= needed_px) {
        return Err(FindError::TooLittlePaint {
            found_px,
            needed_px,
        });
    }
    let search = Search {
        ground,
        field,
        base,
        clicks,
        options,
        marking_pixels,
        scale,
    };
    let likely = search.likely(progress)?;
    search.decide(&likely, progress)
}

/// The inputs of one search, and the factor `scale` from px at 1920 px width to px.
struct Search<'a> {
    ground: &'a GroundPicture,
    field: &'a FieldModel,
    base: &'a CameraBase,
    clicks: &'a [Observation],
    options: &'a FindOptions,
    marking_pixels: MarkingPixels,
    scale: f64,
}

/// The level of detail of a search stage: maps of the markings, and pieces of the lines.
struct DetailLevel {
    maps: EvidenceMaps,
    chains: Chains,
}

/// A candidate camera and its score.
#[derive(Clone, Copy, Debug)]
struct Node {
    ptz: Ptz,
    score: f64,
}

impl Node {
    /// Adds a step in px: how far pan and tilt move the picture's centre, and how far zoom moves
    /// its left and right border.
    fn apply_step(ptz: Ptz, [across, down, zoom]: [f64; 3], width_px: u32) -> Ptz {
        Ptz::new(
            (ptz.pan + Angle::from_radians(across / ptz.focal_px)).wrap(),
            ptz.tilt + Angle::from_radians(down / ptz.focal_px),
            ptz.focal_px * (1.0 + 2.0 * zoom / f64::from(width_px)),
        )
    }

    /// Approximate motion of the picture from one candidate to another, px: the inverse of
    /// [`Self::apply_step`].
    fn apart_px(self, other: &Self, width_px: u32) -> f64 {
        // Without the factor cos(tilt) of a pan: good enough for the small tilts of sports cameras.
        let across = self.ptz.pan.turn_from(other.ptz.pan).radians() * self.ptz.focal_px;
        let down = (self.ptz.tilt - other.ptz.tilt).radians() * self.ptz.focal_px;
        let zoom = (self.ptz.focal_px / other.ptz.focal_px).ln() * f64::from(width_px) / 2.0;
        across.hypot(down).hypot(zoom)
    }
}

impl Search<'_> {
    fn camera(&self, ptz: Ptz) -> PtzCamera {
        PtzCamera::new(*self.base, ptz)
    }

    fn size(&self) -> ImageSize {
        self.ground.size()
    }

    fn look(&self, reach_px: f64, piece_m: f64) -> DetailLevel {
        let maps = EvidenceMaps::from_marking_pixels(&self.marking_pixels, reach_px * self.scale);
        DetailLevel {
            maps,
            chains: Chains::from_field(self.field, self.base, piece_m),
        }
    }

    fn node(&self, look: &DetailLevel, ptz: Ptz) -> Node {
        Node {
            ptz,
            score: look.maps.score(&look.chains, &self.camera(ptz)),
        }
    }

    /// Steps 1 and 2: the best candidates, best first, none near to a better one.
    fn likely(&self, progress: &Progress<'_, f64>) -> Result<Vec<Node>, FindError> {
        // A field without painted lines has no candidate, and `decide` says so.
        let look = self.look(COARSE_REACH_PX, COARSE_PIECE_M);
        let Some(region) = Region::from_chains(&look.chains) else {
            return Ok(Vec::new());
        };
        let focals_px = self.focals_px();
        let mut nodes: Vec<Node> = Vec::new();
        // Step 1, one focal length at a time. Each keeps only its best distinct nodes, so that
        // memory stays bounded whatever the range of focal lengths.
        for (level, focal_px) in focals_px.iter().enumerate() {
            if progress
                .report(GRID_WORK * level as f64 / focals_px.len() as f64)
                .is_break()
            {
                return Err(FindError::Stopped);
            }
            // Nodes are scored on all cores; `collect` keeps their order, so that the result does
            // not depend on the number of threads.
            let grid = region.grid(*focal_px, GRID_PX * self.scale);
            let scored: Vec<Node> = grid
                .into_par_iter()
                .map(|ptz| self.node(&look, ptz))
                .collect();
            nodes.extend(self.distinct(scored, NUM_LOCAL_STARTS, SAME_NODE_PX));
        }
        let nodes = self.distinct(nodes, NUM_LOCAL_STARTS, SAME_NODE_PX);
        // Step 2. Candidates that climb to the same maximum are merged afterwards.
        let look = self.look(FINE_REACH_PX, FINE_PIECE_M);
        let closer: Vec<Node> = nodes
            .into_par_iter()
            .map(|node| self.climb(&look, node.ptz))
            .collect();
        Ok(self.distinct(closer, self.options.tried, SAME_CANDIDATE_PX))
    }

    /// Moves a candidate to a local maximum of the score.
    ///
    /// A compass search (Kolda, Lewis, Torczon: SIAM Review 45, 2003): takes the best of six steps
    /// until none improves, then halves the step. The score jumps from cell to cell of the maps, so
    /// that its gradient is of no use.
    fn climb(&self, look: &DetailLevel, start: Ptz) -> Node {
        let width_px = self.size().width;
        let mut best = self.node(look, start);
        for step_px in STEPS_PX.map(|step_px| step_px * self.scale) {
            // The score rises with every step that is taken and is 1 at most, and the maps have
            // finitely many cells: the loop ends.
            loop {
                let around = DIRECTIONS.map(|direction| {
                    let step = direction.map(|by| by * step_px);
                    self.node(look, Node::apply_step(best.ptz, step, width_px))
                });
                let next = around
                    .into_iter()
                    .max_by(|a, b| a.score.total_cmp(&b.score));
                match next {
                    Some(next) if next.score > best.score => best = next,
                    _ => break,
                }
            }
        }
        best
    }

    /// Focal lengths, in a geometric sequence: neighbours move the left and right border by one
    /// grid step.
    fn focals_px(&self) -> Vec<f64> {
        // A field far away for its length appears small and needs longer focal lengths.
        let lengths_away = self.base.position_m.norm() / self.field.length_m;
        let longer = (lengths_away / USUAL_LENGTHS).max(1.0) * self.scale;
        let (least_px, most_px) = (
            self.options.focal_px.0 * longer,
            self.options.focal_px.1 * longer,
        );
        // A factor 1 + 2 d / width moves the borders, width/2 from the centre, by d px. A sequence
        // that begins at 0 would never end.
        let ratio = 1.0 + 2.0 * GRID_PX * self.scale / f64::from(self.size().width);
        std::iter::successors(Some(least_px), |focal_px| Some(focal_px * ratio))
            .take_while(|focal_px| *focal_px > 0.0 && *focal_px <= most_px)
            .collect()
    }

    /// The best `most` candidates, best first, none nearer than `same_px` (at 1920 px width) to a
    /// better one: greedy non-maximum suppression. Candidates without any score are dropped.
    fn distinct(&self, mut nodes: Vec<Node>, most: usize, same_px: f64) -> Vec<Node> {
        nodes.sort_by(|a, b| b.score.total_cmp(&a.score));
        let mut kept: Vec<Node> = Vec::new();
        // A zero score means that no marking is explained.
        for node in nodes.into_iter().take_while(|node| node.score > 0.0) {
            if kept.len() >= most {
                break;
            }
            if kept
                .iter()
                .all(|other| node.apart_px(other, self.size().width) > same_px * self.scale)
            {
                kept.push(node);
            }
        }
        kept
    }

    /// Steps 3 and 4: aligns the candidates and decides whether the best is accepted.
    fn decide(
        &self,
        likely: &[Node],
        progress: &Progress<'_, f64>,
    ) -> Result<PaintSearchResult, FindError> {
        let painted = PaintedCells::from_marking_pixels(&self.marking_pixels);
        let mut refused = None;
        let mut fits: Vec<(Agreement, Snapped)> = Vec::new();
        for (index, node) in likely.iter().enumerate() {
            if progress
                .report(GRID_WORK + (1.0 - GRID_WORK) * index as f64 / likely.len() as f64)
                .is_break()
            {
                return Err(FindError::Stopped);
            }
            match snap(
                self.ground,
                self.field,
                self.base,
                node.ptz,
                self.clicks,
                &self.options.snap,
            ) {
                Ok(snapped) => {
                    fits.push((
                        painted.agreement(self.field, &self.camera(snapped.ptz)),
                        snapped,
                    ));
                }
                Err(reason) => {
                    // Keep the first error: it belongs to the candidate with the highest score.
                    refused.get_or_insert(reason);
                }
            }
        }
        // The grid's score ranks candidates roughly; aligned cameras are compared by the agreement,
        // which counts both the paint and the lines that are left over.
        fits.sort_by(|a, b| b.0.both().total_cmp(&a.0.both()));
        let Some((agreement, snapped)) = fits.first() else {
            let none = SnapError::TooFewSamples {
                found: 0,
                needed: self.options.snap.min_samples,
            };
            return Err(FindError::NotSnapped {
                reason: refused.unwrap_or(none),
            });
        };
        let apart_px = |ptz: Ptz| overlays_apart_px(&self.camera(snapped.ptz), ptz, self.size());
        // The runner-up is sought among all other cameras. A candidate that cannot be aligned
        // competes as well; it is compared where the local search left it, so only candidates
        // farther than a grid step from the result count as different.
        let nodes = likely
            .iter()
            .filter(|node| apart_px(node.ptz) > GRID_PX * self.scale)
            .map(|node| {
                let agreement = painted.agreement(self.field, &self.camera(node.ptz));
                (agreement.both(), node.ptz)
            });
        let runner_up = fits[1..]
            .iter()
            .map(|(agreement, other)| (agreement.both(), other.ptz))
            .filter(|(_, ptz)| apart_px(*ptz) > SAME_PX * self.scale)
            .chain(nodes)
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let score = snapped.check.score;
        let both = agreement.both();
        // Written so that a score that is not a number is rejected.
        if !(score >= self.options.min_score && both >= self.options.min_agreement) {
            return Err(FindError::NotBorneOut {
                score,
                agreement: both,
            });
        }
        if let Some((runner_up, ptz)) = runner_up
            && runner_up > self.options.max_rival * both
        {
            return Err(FindError::Ambiguous {
                apart_px: apart_px(ptz),
            });
        }
        Ok(PaintSearchResult {
            snapped: snapped.clone(),
            agreement: *agreement,
            rival: runner_up.map_or(0.0, |(agreement, _)| agreement),
        })
    }
}

/// The range of pan and tilt in which the field lies, seen from the base.
struct Region {
    pan: AngleRange,
    tilt: AngleRange,
}

impl Region {
    /// None if the field has no lines.
    fn from_chains(chains: &Chains) -> Option<Self> {
        // The smallest arc, because pan may cross ±180°.
        let rays = || chains.directions().map(PanTilt::from_direction);
        Some(Self {
            pan: AngleRange::smallest(rays().map(|ray| ray.pan))?,
            tilt: AngleRange::smallest(rays().map(|ray| ray.tilt))?,
        })
    }

    /// Cameras that look into the region at one focal length, at most `step_px` apart in the
    /// picture.
    fn grid(&self, focal_px: f64, step_px: f64) -> Vec<Ptz> {
        let [pans, tilts] = [self.pan, self.tilt].map(|range| angles(range, focal_px, step_px));
        tilts
            .into_iter()
            .flat_map(|tilt| pans.iter().map(move |pan| (*pan, tilt)))
            .map(|(pan, tilt)| Ptz::new(pan, tilt, focal_px))
            .collect()
    }
}

/// Angles over a range, both ends included, at most `step_px` apart in the picture.
fn angles(range: AngleRange, focal_px: f64, step_px: f64) -> Vec<Angle> {
    // An angle times the focal length is its length in px, at the centre of the picture.
    let steps = (range.width().radians() * focal_px / step_px)
        .ceil()
        .max(1.0) as u32;
    (0..=steps)
        .map(|index| range.at(f64::from(index) / f64::from(steps)).wrap())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Picture;
    use crate::paint::drawn::{PICTURE, SIZE, soccer, truth};
    use std::ops::ControlFlow;
    use touchline_core::geometry::Vec3;

    /// Few focal lengths, for speed; the truth's is 2250 px at 1920 px width.
    const OPTIONS: fn() -> FindOptions = || FindOptions {
        focal_px: (2150.0, 2350.0),
        tried: 6,
        ..FindOptions::default()
    };

    fn found(picture: &Picture, base: &CameraBase) -> Result<PaintSearchResult, FindError> {
        find_camera(
            &GroundPicture::new(picture, &[]),
            &soccer(),
            base,
            &[],
            &OPTIONS(),
            &Progress::default(),
        )
    }

    #[test]
    fn a_drawn_picture_gives_its_camera_with_no_start() {
        let found = found(&PICTURE, truth().base()).unwrap();
        let apart_px = overlays_apart_px(&truth(), found.snapped.ptz, SIZE);
        assert!(apart_px < 0.2, "{apart_px} px: {found:?}");
        assert!(
            found.agreement.both() > 0.5 && found.rival < 0.5 * found.agreement.both(),
            "{found:?}"
        );
    }

    #[test]
    fn a_base_that_stands_elsewhere_finds_nothing() {
        let elsewhere = CameraBase {
            position_m: Vec3::new(30.0, -45.0, 9.0),
            ..*truth().base()
        };
        let refused = found(&PICTURE, &elsewhere);
        assert!(refused.is_err(), "{refused:?}");
    }

    #[test]
    fn another_camera_that_looks_elsewhere_is_no_number_of_pixels_away() {
        let says = |apart_px: f64| FindError::Ambiguous { apart_px }.to_string();
        assert_eq!(
            says(f64::INFINITY),
            "another camera that looks elsewhere fits the painted lines nearly as well"
        );
        assert_eq!(
            says(210.0),
            "another camera 210 px away fits the painted lines nearly as well"
        );
    }

    #[test]
    fn a_picture_without_paint_is_refused_by_name_and_a_search_can_be_stopped() {
        let turf = Picture::with_colour(SIZE, [62, 110, 42, 255]);
        let refused = found(&turf, truth().base()).unwrap_err();
        assert!(
            matches!(refused, FindError::TooLittlePaint { found_px, .. } if found_px == 0.0),
            "{refused:?}"
        );
        let ground = GroundPicture::new(&PICTURE, &[]);
        let cancelled = Progress::new(|_| ControlFlow::Break(()));
        let stopped = find_camera(
            &ground,
            &soccer(),
            truth().base(),
            &[],
            &OPTIONS(),
            &cancelled,
        );
        assert_eq!(stopped, Err(FindError::Stopped));
    }
}
