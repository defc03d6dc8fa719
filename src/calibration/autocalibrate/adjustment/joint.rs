//! Joint adjustment of the base and of every frame's camera to the paint of all frames.
//!
//! Iterative closest point in the pictures, residuals in px. Each round assigns paint to the lines
//! that the cameras of the moment see nearest to it, within a reach that shrinks from round to
//! round, and adjusts base, lens and all frames at once ([`adjust_base`]). The crown is fitted from
//! a later round on, and the field's size and the matches between frames take part after some
//! rounds.

use super::paint_on_lines::{LineAssignment, SIGMA_PX, distances_px, move_to_field, paint_priors};
use crate::autocalibrate::field_prior::FieldPrior;
use crate::autocalibrate::frames::matched_frames::{FramePaint, renumber_matches};
use crate::autocalibrate::search::pitch_map::PitchMap;
use crate::calibrate::{alone_sigma_m, as_paint_alone_gives};
use touchline_core::camera::{CameraBase, Ptz, StatedLens};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, Vec3, median};
use touchline_core::solve::Loss;
use touchline_core::solve::base::{
    AdjustOptions, AdjustedBase, BaseModel, CameraClicks, CrownModel, FittedSize, FrameClicks,
    LensModel, adjust_base,
};
use touchline_vision::track::{PosePrior, ViewGraphEdge, adjust_matched_frames};

/// The reach of each round: paint farther than this from every line is left out, px at 1920 px
/// width.
const REACH_PX: [f64; 6] = [40.0, 25.0, 14.0, 8.0, 5.0, 4.0];

/// From this round on the crown is fitted. Before, too much paint is assigned to wrong lines.
const CROWN_FROM: usize = 3;

/// The field's size is fitted after these rounds, where it is open: first coarsely, then again with
/// reliable assignments.
const SIZE_AFTER: [usize; 2] = [1, 3];

/// After these rounds the frames are adjusted to their matches as well, which brings back frames
/// that went to wrong lines.
const CONNECTED_AFTER: [usize; 2] = [2, 3];

/// A frame with fewer paint points on lines takes no part.
const MIN_PLACES: usize = 25;

/// Fewer frames do not determine a base.
const MIN_FRAMES: usize = 2;

/// A base and its frames, adjusted jointly to paint.
pub struct JointAdjustment {
    pub base: CameraBase,
    /// The field with its fitted crown and, if a size prior was given, its fitted size.
    pub field: FieldModel,
    /// The fitted lengths; empty without a size prior.
    pub sizes: Vec<FittedSize>,
    /// The camera of each frame; none for frames that show too little paint.
    pub ptz: Vec<Option<Ptz>>,
    /// The distance between the positions that parts of the frames give, m ([`apart`]); infinite if
    /// a part gives none.
    pub parts_m: f64,
    /// The paint of each frame, assigned to lines.
    taken: Vec<FrameClicks>,
    /// Pixels of these frames per pixel at 1920 px width.
    scale: f64,
}

impl JointAdjustment {
    /// The median distance of paint from its line, px at 1920 px width; infinite without any.
    pub fn residual_px(&self) -> f64 {
        let mut all_px: Vec<f64> = self
            .ptz
            .iter()
            .zip(&self.taken)
            .flat_map(|(ptz, taken)| distances_px(taken, &self.base, *ptz))
            .collect();
        median(&mut all_px).map_or(f64::INFINITY, |px| px / self.scale)
    }

    /// The pose prior of each frame from its own paint.
    pub fn paint_priors(&self) -> Vec<PosePrior> {
        paint_priors(&self.base, &self.ptz, &self.taken)
    }
}

/// The frames, adjusted to their paint and to the pairwise matches, with the base held fixed.
/// Unchanged if the two leave a frame undetermined.
fn adjust_to_matches(
    base: &CameraBase,
    ptz: &[Option<Ptz>],
    taken: &[FrameClicks],
    edges: &[ViewGraphEdge],
    size: ImageSize,
) -> Vec<Option<Ptz>> {
    // Only frames with a camera take part, and the adjustment numbers them consecutively.
    let part: Vec<usize> = (0..ptz.len())
        .filter(|frame| ptz[*frame].is_some())
        .collect();
    let edges = renumber_matches(edges, &part);
    let start: Vec<Ptz> = ptz.iter().copied().flatten().collect();
    // The paint enters as one Gaussian prior per frame instead of point by point: linearised at the
    // present cameras, three parameters each.
    let priors: Vec<PosePrior> = paint_priors(base, ptz, taken)
        .into_iter()
        .filter_map(|prior| {
            Some(PosePrior {
                frame: part.binary_search(&prior.frame).ok()?,
                ..prior
            })
        })
        .collect();
    let Some(adjusted) = adjust_matched_frames(base, &start, &edges, &priors, size) else {
        return ptz.to_vec();
    };
    let mut brought = ptz.to_vec();
    for (frame, adjusted) in part.into_iter().zip(adjusted) {
        brought[frame] = Some(adjusted.ptz);
    }
    brought
}

/// Where a joint adjustment begins.
pub struct JointStart {
    pub field: FieldModel,
    pub base: CameraBase,
    /// The camera of each frame; frames without one take no part.
    pub ptz: Vec<Option<Ptz>>,
}

/// What the frames of a joint adjustment show.
pub struct FrameObservations<'a> {
    /// Persistent paint of each frame.
    pub paint: &'a [FramePaint],
    /// Pairwise matches, numbered like the frames.
    pub matches: &'a [ViewGraphEdge],
    pub image_size: ImageSize,
    /// Their lens as it is stated.
    pub lens: &'a StatedLens,
}

/// Adjusts a base and the cameras of its frames to paint; with a size prior, the field's size too.
/// None if too few frames show paint near the lines.
pub fn adjust_jointly(
    start: &JointStart,
    size_prior: Option<&FieldPrior>,
    observed: &FrameObservations<'_>,
) -> Option<JointAdjustment> {
    let FrameObservations {
        paint,
        matches,
        image_size: size,
        lens,
    } = *observed;
    let options = |loss| options(loss).with_lens(lens, size);
    let scale = size.scale_from_1920();
    let mut map = PitchMap::with_grid(&start.field);
    let mut sizes = Vec::new();
    let mut at = JointState {
        field: start.field.clone(),
        base: start.base,
        ptz: start.ptz.clone(),
        taken: Vec::new(),
    };
    // Seen from a low camera the lines lie close together in the picture, and the widest rounds
    // would assign paint to neighbouring lines; skip them. The start is good enough for that.
    let widest_px = map.angular_scale(start.base.position_m.z) * REACH_PX[0];
    for (round, reach_px) in REACH_PX
        .into_iter()
        .enumerate()
        .skip_while(|(_, reach_px)| *reach_px > widest_px)
    {
        at.assign_paint(paint, &map, reach_px, scale);
        // Adjust base, lens and frames. The scale of the Cauchy loss is a quarter of the reach, but
        // at least 1.5 σ, so that paint at the edge of the reach counts little in every round.
        let crown = if round < CROWN_FROM {
            CrownModel::Fixed(at.field.crown_m)
        } else {
            CrownModel::Free
        };
        let (model, options) = (
            model(crown),
            options(Loss::Cauchy {
                c: (reach_px / 4.0 / SIGMA_PX).max(1.5),
            }),
        );
        at = at.adjust(&model, &options, size)?;
        if CONNECTED_AFTER.contains(&round) {
            at.ptz = adjust_to_matches(&at.base, &at.ptz, &at.taken, matches, size);
        }
        // Fit the field's size. The map of lines has to follow, and so has the base: the origin is
        // the middle of the field, so a camera behind one end moves by half of what the length
        // does. Left where it was, it would lose the lines that it sees best to the smaller reach of
        // the next round (drawn clip 27 of the bowl: 588 of 600 points of the near goal line).
        let Some(prior) = size_prior.filter(|_| SIZE_AFTER.contains(&round)) else {
            continue;
        };
        let measured = (size, &options);
        let fitted = prior.fit_size(&at.field, &at.taken, &at.base, &at.ptz, &model, measured);
        let Some((field, fitted)) = fitted else {
            continue;
        };
        sizes = fitted;
        map = PitchMap::with_grid(&field);
        at = at.on_field(field).adjust(&model, &options, size)?;
    }
    let JointState {
        field,
        mut base,
        ptz,
        taken,
    } = at;
    // Cross-validation: each part of the frames is adjusted alone, with assignments, field and
    // crown held fixed, and the positions are compared.
    let parts = apart(base.position_m, &ptz, |ptz| {
        let (model, options) = (
            model(CrownModel::Fixed(field.crown_m)),
            options(Loss::Cauchy { c: 1.5 }),
        );
        let part = try_adjust_base(
            &CameraClicks::with_centred_principal_point(&field, &taken, size),
            &base,
            ptz,
            &model,
            &options,
        )?;
        Some(part.base.position_m)
    });
    // The formal covariance takes the residuals of paint as independent, which they are not.
    // Inflate it so that it covers half the difference of the parts, and at least the accuracy with
    // which real grounds are painted.
    if let Some(apart_m) = parts {
        let half = base.sigma.following_position(0.5 * apart_m);
        base.sigma = base
            .sigma
            .covering(&(half * half.transpose()))
            .with_position_error_of(alone_sigma_m(&field));
    }
    as_paint_alone_gives(&mut sizes, &field);
    let parts_m = parts.map_or(f64::INFINITY, |apart_m| apart_m.norm());
    Some(JointAdjustment {
        base,
        field,
        sizes,
        ptz,
        parts_m,
        taken,
        scale,
    })
}

/// What the rounds of a joint adjustment improve.
struct JointState {
    field: FieldModel,
    base: CameraBase,
    /// The camera of each frame that takes part.
    ptz: Vec<Option<Ptz>>,
    /// The paint of each frame, assigned to lines of the field.
    taken: Vec<FrameClicks>,
}

impl JointState {
    /// Assigns paint to lines. Frames with too little of it leave and do not come back.
    fn assign_paint(&mut self, paint: &[FramePaint], map: &PitchMap, reach_px: f64, scale: f64) {
        let lines = LineAssignment {
            field: &self.field,
            map,
            reach_px,
            scale,
        };
        self.taken = lines.clicks_of_frames(paint, &self.base, &self.ptz);
        for (ptz, taken) in self.ptz.iter_mut().zip(&self.taken) {
            *ptz = ptz.filter(|_| taken.observations.len() >= MIN_PLACES);
        }
    }

    /// The same paint on the same lines of a field with another crown or size.
    fn on_field(self, field: FieldModel) -> Self {
        let taken = move_to_field(self.taken, &field);
        Self {
            field,
            taken,
            ..self
        }
    }

    /// Adjusts base, lens, frames and, if it is free, the crown to the assigned paint. None as
    /// [`try_adjust_base`].
    fn adjust(self, model: &BaseModel, options: &AdjustOptions, size: ImageSize) -> Option<Self> {
        let clicks = CameraClicks::with_centred_principal_point(&self.field, &self.taken, size);
        let adjusted = try_adjust_base(&clicks, &self.base, &self.ptz, model, options)?;
        // The observations contain the position of their line in the world, which depends on the
        // crown.
        let crowned = FieldModel {
            crown_m: adjusted.crown_m,
            ..self.field.clone()
        };
        let adjusted = Self {
            base: adjusted.base,
            ptz: adjusted.ptz,
            ..self
        };
        Some(adjusted.on_field(crowned))
    }
}

/// The difference between the positions from the two halves of the frames (even and odd), m.
///
/// If a half gives no position, twice the 1-σ of the jackknife over single frames (B. Efron, 1982):
/// σ² = (n − 1)/n Σ (x₋ᵢ − x)², with the position x₋ᵢ without frame i and x from all n frames.
/// Twice, because two independent halves have σ√2 each and therefore differ by 2 σ (1-σ), where σ
/// is the error of all frames. None if a part gives no position.
fn apart(
    whole_m: Vec3,
    ptz: &[Option<Ptz>],
    position_m: impl Fn(&[Option<Ptz>]) -> Option<Vec3>,
) -> Option<Vec3> {
    // Even frames against odd ones.
    let [one, other] = [1, 0].map(|half| position_m(&leave_out(ptz, |frame| frame % 2 == half)));
    if let Some((one, other)) = one.zip(other) {
        return Some(one - other);
    }
    // Jackknife over the frames that take part.
    let part: Vec<usize> = (0..ptz.len())
        .filter(|frame| ptz[*frame].is_some())
        .collect();
    let squares = part.iter().try_fold(Vec3::zeros(), |sum, left_out| {
        let off_m = position_m(&leave_out(ptz, |frame| frame == *left_out))? - whole_m;
        Some(sum + off_m.component_mul(&off_m))
    });
    let share = 1.0 - (part.len().max(1) as f64).recip();
    Some(2.0 * (squares? * share).map(f64::sqrt))
}

/// The cameras of all frames but some.
fn leave_out(ptz: &[Option<Ptz>], is_left_out: impl Fn(usize) -> bool) -> Vec<Option<Ptz>> {
    ptz.iter()
        .enumerate()
        .map(|(frame, ptz)| ptz.filter(|_| !is_left_out(frame)))
        .collect()
}

/// Runs the adjustment. None with too few frames, or if it diverged or put the camera below the
/// ground.
fn try_adjust_base(
    taken: &CameraClicks<'_>,
    base: &CameraBase,
    ptz: &[Option<Ptz>],
    model: &BaseModel,
    options: &AdjustOptions,
) -> Option<AdjustedBase> {
    let enough = ptz.iter().flatten().count() >= MIN_FRAMES;
    let adjusted = enough.then(|| adjust_base(taken, base, ptz, model, options))?;
    (adjusted.base.is_finite() && adjusted.base.position_m.z > 0.0).then_some(adjusted)
}

/// The lens has a k₁ that is linear in the focal length; the principal point stays in the image
/// centre.
const fn model(crown: CrownModel) -> BaseModel {
    BaseModel {
        lens: LensModel::K1Focal,
        crown,
        principal_point: None,
    }
}

fn options(loss: Loss) -> AdjustOptions {
    AdjustOptions {
        loss,
        max_iterations: 8,
        ..AdjustOptions::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autocalibrate::rotating_camera::{
        IMAGE_SIZE, base, exact_matches, frames_at_scale, ptz, soccer,
    };
    use touchline_core::field::FieldElement;
    use touchline_core::solve::Observation;

    /// The position that is found in the paint of a field, from a start, m, and how much of the
    /// paint lies on lines in the end.
    fn adjusted(paint_of: &FieldModel, field: &FieldModel, base: &CameraBase) -> (Vec3, usize) {
        let start = JointStart {
            field: field.clone(),
            base: *base,
            ptz: ptz().into_iter().map(Some).collect(),
        };
        let observed = FrameObservations {
            paint: &frames_at_scale(paint_of).paint,
            matches: &exact_matches(),
            image_size: IMAGE_SIZE,
            lens: &StatedLens::default(),
        };
        let found = adjust_jointly(&start, Some(&soccer()), &observed).unwrap();
        let num_taken = found.taken.iter().map(|frame| frame.observations.len());
        (found.base.position_m, num_taken.sum())
    }

    /// Where the field is 4 m wider than assumed, a camera that starts in the right place beside
    /// the near touchline is 2 m from the right one beside the middle. It moves with the size, so
    /// that no line loses its paint.
    #[test]
    fn the_base_follows_a_size_that_is_fitted() {
        let wide = soccer().with_lengths(&[105.0, 72.0]).unwrap();
        let mut beside = base();
        beside.position_m.y += 2.0;
        let (position_m, num_taken) = adjusted(&wide, &soccer().assumed, &beside);
        let (_, num_of_right) = adjusted(&wide, &wide, &base());
        let off_m = (position_m - base().position_m).norm();
        assert!(off_m < 0.3, "{off_m:.2} m");
        assert!(
            100 * num_taken >= 98 * num_of_right,
            "{num_taken} of {num_of_right}"
        );
    }

    /// Whether a point lies on a line that does not move with the length of a field.
    fn shows_no_length(seen: &Observation, field: &FieldModel) -> bool {
        let Some(FieldElement::Paint(line)) = seen.element else {
            return false;
        };
        [
            "halfway_line",
            "centre_circle",
            "touchline_near",
            "touchline_far",
        ]
        .contains(&field.lines[line].id.as_str())
    }

    #[test]
    fn a_length_that_no_line_shows_returns_to_what_is_assumed() {
        let prior = soccer();
        let long = prior.with_lengths(&[110.0, 68.0]).unwrap();
        let mut at = JointState {
            field: long.clone(),
            base: base(),
            ptz: ptz().into_iter().map(Some).collect(),
            taken: Vec::new(),
        };
        let paint = &frames_at_scale(&long).paint;
        let scale = IMAGE_SIZE.scale_from_1920();
        at.assign_paint(paint, &PitchMap::with_grid(&long), 4.0, scale);
        for frame in &mut at.taken {
            frame
                .observations
                .retain(|seen| shows_no_length(seen, &long));
        }
        let model = model(CrownModel::Fixed(long.crown_m));
        let options = options(Loss::Cauchy { c: 1.5 });
        let size = (IMAGE_SIZE, &options);
        let (field, sizes) = prior
            .fit_size(&long, &at.taken, &at.base, &at.ptz, &model, size)
            .unwrap();
        assert!(sizes[0].is_open, "{:?}", sizes[0]);
        assert!((field.length_m - 105.0).abs() < 0.5, "{} m", field.length_m);
        assert!((field.width_m - 68.0).abs() < 0.5, "{} m", field.width_m);
    }

    /// `apart` of frames that each measure the position along x, m. The position from several
    /// frames is their mean, and none from fewer than `least`.
    fn apart_of(says_m: &[Option<f64>], least: usize) -> Option<Vec3> {
        let ptz = |at: &Option<f64>| at.map(|at| Ptz::from_degrees(0.0, 0.0, at));
        let mean = |ptz: &[Option<Ptz>]| {
            let says: Vec<f64> = ptz.iter().flatten().map(|ptz| ptz.focal_px).collect();
            (says.len() >= least)
                .then(|| Vec3::x() * (says.iter().sum::<f64>() / says.len() as f64))
        };
        let ptz: Vec<Option<Ptz>> = says_m.iter().map(ptz).collect();
        apart(mean(&ptz)?, &ptz, mean)
    }

    #[test]
    fn parts_of_the_frames_say_how_sure_all_of_them_are() {
        let halves = apart_of(&[Some(10.0), Some(10.4), Some(10.2), Some(10.6)], 2).unwrap();
        assert!((halves.x + 0.4).abs() < 1e-9 && halves.y == 0.0, "{halves}");
        // Of three frames one at a time is left out: the standard error of the mean of 0.1, 0.2 and
        // 0.6 is 0.1528.
        let three = apart_of(&[Some(10.1), Some(10.2), None, Some(10.6)], 2).unwrap();
        assert!(
            (three.x - 2.0 * (0.07_f64 / 3.0).sqrt()).abs() < 1e-9,
            "{three}"
        );
        assert_eq!(
            apart_of(&[Some(10.0), None, Some(10.2)], 2),
            None,
            "none confirms the other"
        );
    }
}
