//! Start from nothing: a camera found in one picture by its painted lines alone, its base known.
//!
//! All directions and focal lengths are tried against the strokes of the picture, on a coarse grid.
//! The best nodes are moved to where the strokes agree most, the best of those are snapped, and
//! what the paint bears out is compared. Nothing is drawn by chance.

use super::agreement::{Agreement, PaintedCells};
use super::check::overlays_apart_px;
use super::evidence::{Chains, EvidenceMaps};
use super::strokes::Strokes;
use super::{GroundPicture, SnapError, SnapOptions, Snapped, snap};
use rayon::prelude::*;
use thiserror::Error;
use touchline_core::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Angle, AngleRange, ImageSize};
use touchline_core::progress::Progress;
use touchline_core::solve::Observation;

/// How a camera is searched for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FindOptions {
    /// Focal lengths, px at 1920 px width. 800 to 3200 by default: narrower views show too few
    /// lines. For a field that looks smaller than a soccer pitch does from its stands, a basketball
    /// court say, they are longer by as much.
    pub focal_px: (f64, f64),
    /// How the likely cameras are snapped.
    pub snap: SnapOptions,
    /// So many of the likeliest cameras are snapped. 12 by default.
    pub tried: usize,
    /// The line check's score of the result is at least this. 0.93 by default.
    pub min_score: f64,
    /// The result explains at least this share of the strokes, and as large a share of what it
    /// predicts is there: the product of both. 0.2 by default.
    pub min_agreement: f64,
    /// No other camera agrees with the strokes by more than this share of the result's agreement.
    /// 0.75 by default.
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

/// Why no camera is found.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum FindError {
    /// The picture shows too little paint.
    #[error("the picture shows {found_px:.0} px of painted lines, {needed_px:.0} px are needed")]
    TooLittlePaint {
        /// The length of all strokes, px.
        found_px: f64,
        /// What is needed, px.
        needed_px: f64,
    },
    /// No likely camera can be snapped.
    #[error("no camera fits the painted lines; of the likeliest: {reason}")]
    NotSnapped {
        /// Why the likeliest was not.
        reason: SnapError,
    },
    /// The paint does not bear out the best one.
    #[error("the painted lines do not decide (line check {score:.2}, agreement {agreement:.2})")]
    NotBorneOut {
        /// The line check's score, 0 to 1.
        score: f64,
        /// The share of the strokes that is explained times the share of the predicted lines that
        /// are there.
        agreement: f64,
    },
    /// Two cameras fit.
    #[error("another camera {apart_px:.0} px away fits the painted lines nearly as well")]
    Ambiguous {
        /// How far apart the overlays are, px.
        apart_px: f64,
    },
    /// It was cancelled.
    #[error("the search was stopped")]
    Stopped,
}

/// A camera found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The camera on the paint.
    pub snapped: Snapped,
    /// How far the picture's strokes and its lines agree.
    pub agreement: Agreement,
    /// The agreement of the best other camera, both ways at once; 0 where there is none.
    pub rival: f64,
}

/// Neighbouring nodes of the grid move the picture by this, px at 1920 px width.
const GRID_PX: f64 = 36.0;

/// A line of the grid's cameras may lie this far from a stroke, px at 1920 px width.
const COARSE_REACH_PX: f64 = 40.0;

/// So many nodes of the grid are looked at closer.
const CLOSER: usize = 200;

/// Looked at closer, lines may lie this far from a stroke, and a camera is moved by these steps; px
/// at 1920 px width.
const FINE_REACH_PX: f64 = 20.0;
const STEPS_PX: [f64; 3] = [18.0, 9.0, 4.5];

/// Where a camera is moved by a step: across, down, nearer.
const DIRECTIONS: [[f64; 3]; 6] = [
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
];

/// The lines are cut into pieces of these lengths, m: for the grid, and looked at closer.
const COARSE_PIECE_M: f64 = 4.0;
const FINE_PIECE_M: f64 = 2.0;

/// Nodes of the grid this near to a better one are one with it, px at 1920 px width; and so are
/// cameras looked at closer.
const SAME_NODE_PX: f64 = 45.0;
const SAME_CLOSER_PX: f64 = 16.0;

/// Cameras nearer to each other are one, px at 1920 px width.
const SAME_PX: f64 = 10.0;

/// A pitch's length is seen from this many of its lengths away; a field that is farther away for
/// its length looks smaller.
const USUAL_LENGTHS: f64 = 0.75;

/// With less paint nothing is searched for, px at 1920 px width.
const LEAST_PAINT_PX: f64 = 500.0;

/// The search over the grid is this share of the work.
const GRID_WORK: f64 = 0.7;

/// Finds the camera of a picture by its painted lines, tied to `clicks` where there are any;
/// `progress` receives the share that is done, from 0 to 1.
///
/// # Errors
/// [`FindError`] names what is missing: paint, a camera that fits it, or the certainty that no other one does.
pub fn find_camera(
    ground: &GroundPicture,
    field: &FieldModel,
    base: &CameraBase,
    clicks: &[Observation],
    options: &FindOptions,
    progress: &Progress<'_, f64>,
) -> Result<Found, FindError> {
    let scale = ground.size().scale_from_1920();
    let strokes = Strokes::of(ground);
    let (found_px, needed_px) = (strokes.points.len() as f64, LEAST_PAINT_PX * scale);
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
        strokes,
        scale,
    };
    let likely = search.likely(progress)?;
    search.decided(&likely, progress)
}

/// What stays the same during a search.
struct Search<'a> {
    ground: &'a GroundPicture,
    field: &'a FieldModel,
    base: &'a CameraBase,
    clicks: &'a [Observation],
    options: &'a FindOptions,
    strokes: Strokes,
    scale: f64,
}

/// How closely cameras are looked at.
struct Look {
    maps: EvidenceMaps,
    chains: Chains,
}

/// A camera that is tried.
#[derive(Clone, Copy, Debug)]
struct Node {
    ptz: Ptz,
    score: f64,
}

impl Node {
    /// A step moves the picture's middle across and down, and its left and right border, px.
    fn stepped(ptz: Ptz, [across, down, zoom]: [f64; 3], width_px: u32) -> Ptz {
        Ptz {
            pan: (ptz.pan + Angle::from_radians(across / ptz.focal_px)).wrapped(),
            tilt: ptz.tilt + Angle::from_radians(down / ptz.focal_px),
            focal_px: ptz.focal_px * (1.0 + 2.0 * zoom / f64::from(width_px)),
        }
    }

    /// About how far the picture moves from one to another, px.
    fn apart_px(self, other: &Self, width_px: u32) -> f64 {
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

    fn look(&self, reach_px: f64, piece_m: f64) -> Look {
        let maps = EvidenceMaps::of(&self.strokes, reach_px * self.scale);
        Look {
            maps,
            chains: Chains::of(self.field, self.base, piece_m),
        }
    }

    fn node(&self, look: &Look, ptz: Ptz) -> Node {
        Node {
            ptz,
            score: look.maps.score(&look.chains, &self.camera(ptz)),
        }
    }

    /// The likeliest cameras, far from each other, the best first.
    fn likely(&self, progress: &Progress<'_, f64>) -> Result<Vec<Node>, FindError> {
        let look = self.look(COARSE_REACH_PX, COARSE_PIECE_M);
        let Some(region) = Region::of(&look.chains) else {
            return Ok(Vec::new());
        };
        let focals_px = self.focals_px();
        let mut nodes: Vec<Node> = Vec::new();
        for (level, focal_px) in focals_px.iter().enumerate() {
            if progress
                .report(GRID_WORK * level as f64 / focals_px.len() as f64)
                .is_break()
            {
                return Err(FindError::Stopped);
            }
            let grid = region.grid(*focal_px, GRID_PX * self.scale);
            let scored: Vec<Node> = grid
                .into_par_iter()
                .map(|ptz| self.node(&look, ptz))
                .collect();
            nodes.extend(self.distinct(scored, CLOSER, SAME_NODE_PX));
        }
        let nodes = self.distinct(nodes, CLOSER, SAME_NODE_PX);
        let look = self.look(FINE_REACH_PX, FINE_PIECE_M);
        let closer: Vec<Node> = nodes
            .into_par_iter()
            .map(|node| self.moved(&look, node.ptz))
            .collect();
        Ok(self.distinct(closer, self.options.tried, SAME_CLOSER_PX))
    }

    /// A camera moved to where the strokes agree most.
    fn moved(&self, look: &Look, start: Ptz) -> Node {
        let width_px = self.size().width;
        let mut best = self.node(look, start);
        for step_px in STEPS_PX {
            let step_px = step_px * self.scale;
            loop {
                let around = DIRECTIONS.map(|by| {
                    self.node(
                        look,
                        Node::stepped(best.ptz, by.map(|by| by * step_px), width_px),
                    )
                });
                match around
                    .into_iter()
                    .max_by(|a, b| a.score.total_cmp(&b.score))
                {
                    Some(next) if next.score > best.score => best = next,
                    _ => break,
                }
            }
        }
        best
    }

    /// Focal lengths whose pictures differ by a step of the grid at the left and right border.
    fn focals_px(&self) -> Vec<f64> {
        let lengths_away = self.base.position_m.norm() / self.field.length_m;
        let longer = (lengths_away / USUAL_LENGTHS).max(1.0) * self.scale;
        let (least_px, most_px) = (
            self.options.focal_px.0 * longer,
            self.options.focal_px.1 * longer,
        );
        let ratio = 1.0 + 2.0 * GRID_PX * self.scale / f64::from(self.size().width);
        let mut focals_px = Vec::new();
        let mut focal_px = least_px;
        while focal_px <= most_px {
            focals_px.push(focal_px);
            focal_px *= ratio;
        }
        focals_px
    }

    /// The best of some nodes, the best first, none nearer than `same_px` (at 1920 px width) to a
    /// better one.
    fn distinct(&self, mut nodes: Vec<Node>, most: usize, same_px: f64) -> Vec<Node> {
        nodes.sort_by(|a, b| b.score.total_cmp(&a.score));
        let mut kept: Vec<Node> = Vec::new();
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

    /// The likely cameras snapped, and the best of them if the paint decides for it.
    fn decided(&self, likely: &[Node], progress: &Progress<'_, f64>) -> Result<Found, FindError> {
        let painted = PaintedCells::of(&self.strokes);
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
                    refused.get_or_insert(reason);
                }
            }
        }
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
        // A likely camera that cannot be snapped is a rival as well.
        let nodes = likely.iter().map(|node| {
            let agreement = painted.agreement(self.field, &self.camera(node.ptz));
            (agreement.both(), node.ptz)
        });
        let nodes = nodes.filter(|(_, ptz)| apart_px(*ptz) > GRID_PX * self.scale);
        let others = fits[1..]
            .iter()
            .map(|(agreement, other)| (agreement.both(), other.ptz));
        let others = others
            .filter(|(_, ptz)| apart_px(*ptz) > SAME_PX * self.scale)
            .chain(nodes);
        let rival = others.max_by(|a, b| a.0.total_cmp(&b.0));
        let score = snapped.check.score;
        let both = agreement.both();
        if !(score >= self.options.min_score && both >= self.options.min_agreement) {
            return Err(FindError::NotBorneOut {
                score,
                agreement: both,
            });
        }
        if let Some((rival, ptz)) = rival
            && rival > self.options.max_rival * both
        {
            return Err(FindError::Ambiguous {
                apart_px: apart_px(ptz),
            });
        }
        let rival = rival.map_or(0.0, |(rival, _)| rival);
        Ok(Found {
            snapped: snapped.clone(),
            agreement: *agreement,
            rival,
        })
    }
}

/// The directions in which the field lies.
struct Region {
    pan: AngleRange,
    tilt: AngleRange,
}

impl Region {
    /// None where the field has no lines.
    fn of(chains: &Chains) -> Option<Self> {
        let rays = || chains.directions().map(PanTilt::from_direction);
        Some(Self {
            pan: AngleRange::smallest(rays().map(|ray| ray.pan))?,
            tilt: AngleRange::smallest(rays().map(|ray| ray.tilt))?,
        })
    }

    /// Cameras that look into the region, a step apart in the picture.
    fn grid(&self, focal_px: f64, step_px: f64) -> Vec<Ptz> {
        let steps = |range: &AngleRange| {
            (range.width().radians() * focal_px / step_px)
                .ceil()
                .max(1.0) as u32
        };
        let (pans, tilts) = (steps(&self.pan), steps(&self.tilt));
        let at =
            |range: &AngleRange, index: u32, of: u32| range.at(f64::from(index) / f64::from(of));
        let node = |pan, tilt| Ptz {
            pan: at(&self.pan, pan, pans).wrapped(),
            tilt: at(&self.tilt, tilt, tilts).wrapped(),
            focal_px,
        };
        (0..=tilts)
            .flat_map(|tilt| (0..=pans).map(move |pan| node(pan, tilt)))
            .collect()
    }
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

    fn found(picture: &Picture, base: &CameraBase) -> Result<Found, FindError> {
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
    fn a_picture_without_paint_is_refused_by_name_and_a_search_can_be_stopped() {
        let turf = Picture::filled(SIZE, [62, 110, 42, 255]);
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
