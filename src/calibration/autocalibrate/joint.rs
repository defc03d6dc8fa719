//! The base and every frame's camera adjusted to the paint of all frames together.

use super::field_prior::FieldPrior;
use super::matched_frames::{FramePaint, renumber_matches};
use super::pitch_map::{OnLine, PitchMap};
use super::pose::angular_scale;
use crate::calibrate::{ALONE_SIGMA_M, as_paint_alone_gives};
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, Vec3, median, subsample};
use touchline_core::solve::base::{
    AdjustOptions, AdjustedBase, BaseModel, CameraClicks, CrownModel, FittedSize, FrameClicks,
    LensModel, adjust_base,
};
use touchline_core::solve::{BlockEquations, Loss, Observation};
use touchline_vision::track::{PosePrior, PriorSource, Tie, adjust_matched_frames};

/// How far paint may lie from the line that it is taken for, round by round, px at 1920 px width.
const REACH_PX: [f64; 6] = [40.0, 25.0, 14.0, 8.0, 5.0, 4.0];

/// From this round on the pitch may be higher in the middle: before, the lines are not sure enough.
const CROWN_FROM: usize = 3;

/// After these rounds the field's size is fitted, where it is open: once coarsely, once among lines
/// that are sure.
const SIZE_AFTER: [usize; 2] = [1, 3];

/// After these rounds frames that have strayed from where their neighbours have them are brought
/// back.
const TIED_AFTER: [usize; 2] = [2, 3];

/// 1-σ of the middle of a stroke, px at 1920 px width, with what its neighbours have in common with
/// it.
const SIGMA_PX: f64 = 1.5;

/// Places of one line in one frame, at most.
const OF_LINE: usize = 20;

/// A frame takes part with at least this many places.
const MIN_PLACES: usize = 25;

/// Fewer frames do not determine a base.
const MIN_FRAMES: usize = 2;

/// Paint hardly counts beyond 2 σ where it says where a frame looks: the loss of the last round.
const PAINT_LOSS: Loss = Loss::Cauchy { c: 2.0 };

/// A base and its frames, adjusted jointly to paint.
pub(super) struct JointAdjustment {
    pub base: CameraBase,
    /// With the crown, and the size where that was fitted.
    pub field: FieldModel,
    /// The lengths that were fitted.
    pub sizes: Vec<FittedSize>,
    /// Of each frame that shows enough paint.
    pub ptz: Vec<Option<Ptz>>,
    /// How far the bases of parts of the frames lie apart, m; infinite where one has none.
    pub parts_m: f64,
    /// Which paint was taken for which line.
    taken: Vec<FrameClicks>,
    scale: f64,
}

impl JointAdjustment {
    /// The median distance of paint from its line, px at 1920 px width; infinite without any.
    pub fn residual_px(&self) -> f64 {
        let frames = self.ptz.iter().zip(&self.taken);
        let of_frame = |(ptz, taken): (&Option<Ptz>, &FrameClicks)| {
            let camera = ptz.map(|ptz| PtzCamera::new(self.base, ptz));
            let off = move |seen: &Observation| seen.distance_px(&camera?);
            taken
                .observations
                .iter()
                .filter_map(off)
                .collect::<Vec<_>>()
        };
        median(&mut frames.flat_map(of_frame).collect::<Vec<_>>())
            .map_or(f64::INFINITY, |px| px / self.scale)
    }
}

/// The frames as their paint and the ties between them have them.
fn adjusted_by_ties(
    base: &CameraBase,
    ptz: &[Option<Ptz>],
    taken: &[FrameClicks],
    ties: &[Tie],
    size: ImageSize,
) -> Vec<Option<Ptz>> {
    // Frames that take part, numbered among themselves.
    let part: Vec<usize> = (0..ptz.len())
        .filter(|frame| ptz[*frame].is_some())
        .collect();
    let place = |frame: usize| part.binary_search(&frame).ok();
    let ties = renumber_matches(ties, &part);
    let start: Vec<Ptz> = ptz.iter().copied().flatten().collect();
    let priors = paint_priors(base, ptz, taken).into_iter();
    let priors: Vec<PosePrior> = priors
        .filter_map(|prior| {
            Some(PosePrior {
                frame: place(prior.frame)?,
                ..prior
            })
        })
        .collect();
    let Some(adjusted) = adjust_matched_frames(base, &start, &ties, &priors, size) else {
        return ptz.to_vec();
    };
    let mut brought = ptz.to_vec();
    for (frame, adjusted) in part.into_iter().zip(adjusted) {
        brought[frame] = Some(adjusted.ptz);
    }
    brought
}

/// What the paint of each frame says of its camera.
fn paint_priors(base: &CameraBase, ptz: &[Option<Ptz>], taken: &[FrameClicks]) -> Vec<PosePrior> {
    let of_frame = |(frame, (ptz, taken)): (usize, (&Option<Ptz>, &FrameClicks))| {
        let ptz = (*ptz)?;
        let camera = PtzCamera::new(*base, ptz);
        let mut equations = BlockEquations::<0, 3>::zero();
        for seen in &taken.observations {
            equations.add(seen, &camera, PAINT_LOSS);
        }
        Some(PosePrior::new(
            frame,
            ptz,
            equations.own,
            PriorSource::Paint,
        ))
    };
    ptz.iter()
        .zip(taken)
        .enumerate()
        .filter_map(of_frame)
        .collect()
}

impl JointAdjustment {
    /// What the paint of each frame says of its camera.
    pub fn paint_priors(&self) -> Vec<PosePrior> {
        paint_priors(&self.base, &self.ptz, &self.taken)
    }
}

/// Where a joint adjustment begins.
pub(super) struct JointStart {
    pub field: FieldModel,
    pub base: CameraBase,
    /// Of each frame; frames without one take no part.
    pub ptz: Vec<Option<Ptz>>,
}

/// What the frames of a joint adjustment show.
pub(super) struct FrameObservations<'a> {
    /// Of each frame.
    pub paint: &'a [FramePaint],
    /// Pairwise matches, by frame.
    pub matches: &'a [Tie],
    pub image_size: ImageSize,
}

/// Adjusts a base and the cameras of its frames to paint; with a size prior, the field's size too.
/// None if too few frames show paint near the lines.
pub(super) fn adjust_jointly(
    start: &JointStart,
    size_prior: Option<&FieldPrior>,
    observed: &FrameObservations<'_>,
) -> Option<JointAdjustment> {
    let FrameObservations {
        paint,
        matches,
        image_size: size,
    } = *observed;
    let scale = size.scale_from_1920();
    let mut field = start.field.clone();
    let mut map = PitchMap::with_grid(&field);
    let mut base = start.base;
    let mut ptz = start.ptz.clone();
    let (mut taken, mut sizes) = (Vec::new(), Vec::new());
    // From low cameras the lines lie too near to each other for the first rounds, and the start is
    // the nearer.
    let widest_px = angular_scale(start.base.position_m.z) * REACH_PX[0];
    for (round, reach_px) in REACH_PX
        .into_iter()
        .enumerate()
        .skip_while(|(_, reach_px)| *reach_px > widest_px)
    {
        let near = |(paint, ptz): (&FramePaint, &Option<Ptz>)| {
            let camera = ptz.map(|ptz| PtzCamera::new(base, ptz));
            let observations = camera.map_or_else(Vec::new, |camera| {
                near_lines(&field, &map, &camera, paint, reach_px * scale, scale)
            });
            FrameClicks {
                observations,
                start: None,
            }
        };
        taken = paint.iter().zip(&ptz).map(near).collect();
        for (ptz, taken) in ptz.iter_mut().zip(&taken) {
            *ptz = ptz.filter(|_| taken.observations.len() >= MIN_PLACES);
        }
        let crown = if round < CROWN_FROM {
            CrownModel::Fixed(field.crown_m)
        } else {
            CrownModel::Free
        };
        let (model, options) = (
            model(crown),
            options(Loss::Cauchy {
                c: (reach_px / 4.0 / SIGMA_PX).max(1.5),
            }),
        );
        let adjusted = adjusted(
            &CameraClicks::centred(&field, &taken, size),
            &base,
            &ptz,
            &model,
            &options,
        )?;
        (base, ptz) = (adjusted.base, adjusted.ptz);
        let crowned = FieldModel {
            crown_m: adjusted.crown_m,
            ..field
        };
        taken = on_field(taken, &crowned);
        field = crowned;
        if TIED_AFTER.contains(&round) {
            ptz = adjusted_by_ties(&base, &ptz, &taken, matches, size);
        }
        let Some(prior) = size_prior.filter(|_| SIZE_AFTER.contains(&round)) else {
            continue;
        };
        let Some(fitted) =
            prior.fit_size(&field, &taken, &base, &ptz, &model, (size.width, &options))
        else {
            continue;
        };
        (field, sizes) = fitted;
        map = PitchMap::with_grid(&field);
    }
    let parts = apart(base.position_m, &ptz, |ptz| {
        let (model, options) = (
            model(CrownModel::Fixed(field.crown_m)),
            options(Loss::Cauchy { c: 1.5 }),
        );
        let part = adjusted(
            &CameraClicks::centred(&field, &taken, size),
            &base,
            ptz,
            &model,
            &options,
        )?;
        Some(part.base.position_m)
    });
    if let Some(apart_m) = parts {
        let half = base.sigma.following_position(0.5 * apart_m);
        base.sigma = base
            .sigma
            .covering(&(half * half.transpose()))
            .with_position_error_of(ALONE_SIGMA_M);
    }
    as_paint_alone_gives(&mut sizes);
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

/// How far the positions lie apart that halves of the frames give, m; of frames too few for that
/// twice the 1-σ that leaving one out at a time gives (jackknife: Efron, 1982). What is known from
/// all frames scatters half as much. None where a part gives no position.
fn apart(
    whole_m: Vec3,
    ptz: &[Option<Ptz>],
    position_m: impl Fn(&[Option<Ptz>]) -> Option<Vec3>,
) -> Option<Vec3> {
    let without = |is_left_out: &dyn Fn(usize) -> bool| {
        let of_rest = |(frame, ptz): (usize, &Option<Ptz>)| ptz.filter(|_| !is_left_out(frame));
        position_m(&ptz.iter().enumerate().map(of_rest).collect::<Vec<_>>())
    };
    let [one, other] = [1, 0].map(|half| without(&|frame| frame % 2 == half));
    if let Some((one, other)) = one.zip(other) {
        return Some(one - other);
    }
    let part: Vec<usize> = (0..ptz.len())
        .filter(|frame| ptz[*frame].is_some())
        .collect();
    let squares = part.iter().try_fold(Vec3::zeros(), |sum, left_out| {
        let off_m = without(&|frame| frame == *left_out)? - whole_m;
        Some(sum + off_m.component_mul(&off_m))
    });
    let share = 1.0 - (part.len().max(1) as f64).recip();
    Some(2.0 * (squares? * share).map(f64::sqrt))
}

/// The same paint on the lines of a field of another crown or size.
fn on_field(mut taken: Vec<FrameClicks>, field: &FieldModel) -> Vec<FrameClicks> {
    for frame in &mut taken {
        let moved = |seen: &Observation| seen.renamed(field, seen.element?);
        frame.observations = frame.observations.iter().filter_map(moved).collect();
    }
    taken
}

fn adjusted(
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

/// How far a place of a picture lies beside a line, px; none where the line cannot be seen.
fn beside_px(camera: &PtzCamera, line: &OnLine, image: ImagePoint) -> Option<f64> {
    const STEP_M: f64 = 0.1;
    let at = camera.image_from_world(line.at).ok()?;
    let further = camera
        .image_from_world(line.at + STEP_M * line.tangent.normalize())
        .ok()?;
    let along = further.offset_from(at).try_normalize(0.0)?;
    Some(image.offset_from(at).perp(&along).abs())
}

/// Paint taken for the line that is seen nearest to it, within reach in the picture; spread over
/// the lines.
fn near_lines(
    field: &FieldModel,
    map: &PitchMap,
    camera: &PtzCamera,
    paint: &FramePaint,
    reach_px: f64,
    scale: f64,
) -> Vec<Observation> {
    let mut of_line: Vec<Vec<Observation>> = vec![Vec::new(); field.lines.len()];
    let eye_m = camera.base().position_m;
    for (place, image) in paint.iter().enumerate() {
        let ground = map.ground(|z_m| camera.plane_from_image(*image, z_m));
        let Some(near) = ground.and_then(|ground| map.nearest(ground, eye_m)) else {
            continue;
        };
        let off_px = beside_px(camera, &near, *image).unwrap_or(f64::INFINITY);
        if off_px > reach_px {
            continue;
        }
        of_line[near.line].extend(Observation::of_paint(
            field,
            near.line,
            *image,
            SIGMA_PX * scale,
            place,
        ));
    }
    of_line
        .into_iter()
        .flat_map(|places| subsample(places, OF_LINE))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames that each say where the camera stands along x, m; of some the mean, of fewer than
    /// `least` nothing.
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
        // Of three frames one at a time is left out: the mean of .1, .2 and .6 is sure to .1528,
        // their standard error.
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
