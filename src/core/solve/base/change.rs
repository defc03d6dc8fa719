//! Detects whether a base stops fitting from some frame on: the tripod was bumped, or set up anew
//! at half-time.
//!
//! The clicks of each frame are reduced to a gradient and an information matrix of a small
//! displacement of the base; the frame's own pan, tilt and focal length are eliminated. At every
//! frame of the sequence two models are compared: one displacement of the base for all frames, or
//! one before the frame and another from it on, each with the same prior. With Gaussians the Bayes
//! factor has a closed form. Scatter of the frames beyond the noise of their clicks (from lens,
//! pitch and names) is estimated as well, and reduces the weight of all frames. A change must also
//! be visible in pixels.

use super::FrameClicks;
use super::base_click::BaseClick;
use super::bundle::{Bundle, BundleState, frame_equations};
use super::parameters::{K1, OF_BASE, ROTATION, Shared, clear_fixed};
use super::shared_prior::near;
use crate::camera::{BaseSigma, CameraBase, Ptz, PtzCamera, SharedCovariance};
use crate::field::FieldModel;
use crate::geometry::{Angle, median_high, subsample};
use crate::solve::optimiser::least_squares::{BlockEquations, Stopping, minimise};
use crate::solve::{Loss, Observation, refine};
use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;

/// How many parameters a bump moves: the position and the rotation about world x and y.
const MOVED: usize = K1;
/// How many it leaves as they are: lens, crown and principal point.
const KEPT: usize = OF_BASE - MOVED;

type BaseDisplacement = SVector<f64, MOVED>;
type DisplacementMatrix = SMatrix<f64, MOVED, MOVED>;

/// Minimum number of frames on each side of a change.
const MIN_SIDE: usize = 3;
/// Minimum number of equations of a frame that is used: three determine its own camera, only
/// further ones constrain the base.
const MIN_EQUATIONS: usize = 4;
/// Prior of the displacement in each axis, 1-σ, m.
const BUMP_M: f64 = 1.0;
/// Prior of the rotation about each horizontal axis, 1-σ.
const BUMP_TURN: Angle = Angle::from_degrees(0.5);
/// Minimum logarithm of the Bayes factor of a change.
const EVIDENCE: f64 = 12.0;
/// From the change on, the median click error under the old base is at least this many times that
/// before it.
const WORSE: f64 = 1.4;
/// A new base reduces the median click error after the change to at most this fraction.
const MENDED: f64 = 0.8;
/// A longer sequence is first tested on a subsample of this many frames.
const COARSE: usize = 300;

/// A frame from which on a base no longer fits.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseChange {
    /// The index of the first frame that the base no longer fits.
    pub frame: usize,
    /// Median distance of the clicks before it, px.
    pub before_px: f64,
    /// Median distance of the clicks from it on, under the base that fits those before, px.
    pub after_px: f64,
    /// Median distance of the clicks from it on, under a base fitted to them, px.
    pub own_px: f64,
    /// The base fitted to the frames from the change on; the lens is unchanged.
    pub base: CameraBase,
    /// The logarithm of the Bayes factor for a change here.
    pub evidence: f64,
}

/// Finds the frame from which on the base no longer fits, if there is one. `frames` and their
/// cameras are in temporal order. Frames without a camera or with too few clicks are skipped.
pub fn base_change(
    field: &FieldModel,
    frames: &[FrameClicks],
    ptz: &[Option<Ptz>],
    base: &CameraBase,
) -> Option<BaseChange> {
    let shared = Shared::new(base, field.crown());
    let telling: Vec<InformativeFrame> = frames
        .iter()
        .zip(ptz)
        .enumerate()
        .filter(|(_, (frame, _))| frame.equations() >= MIN_EQUATIONS)
        .filter_map(|(place, (frame, ptz))| {
            Some(InformativeFrame::new(place, frame, (*ptz)?, field))
        })
        .collect();
    // Step 1, for long sequences: test a subsample, to save the equations of all frames where
    // nothing suggests a change.
    if telling.len() > COARSE {
        let coarse: Vec<DisplacementEquations> = subsample(&telling, COARSE)
            .map(|frame| frame.pull(&shared))
            .collect();
        // Half of the evidence must show in the subsample.
        split(&coarse).filter(|split| split.evidence > 0.5 * EVIDENCE)?;
    }

    // Step 2: the most likely change, over all frames.
    let pulls: Vec<DisplacementEquations> = telling
        .par_iter()
        .map(|frame| frame.pull(&shared))
        .collect();
    let Split {
        at,
        evidence,
        scatter,
    } = split(&pulls).filter(|split| split.evidence > EVIDENCE)?;

    // Step 3: confirm the change in pixels. The evidence comes from equations linearised at the
    // given base; here a base is fitted to either side, and the clicks after the change are
    // measured under both.
    let (before, after) = telling.split_at(at);
    let held = DisplacedBase::fit(&shared, before);
    let own = DisplacedBase::fit(&shared, after);
    let before_px = held.median_px(before)?;
    let after_px = held.median_px(after)?;
    let own_px = own.median_px(after)?;
    if !(after_px > WORSE * before_px && own_px < MENDED * after_px) {
        return None;
    }
    let mut base = own.shared.base.in_pan_gauge().0;
    base.sigma = own.sigma(scatter);
    Some(BaseChange {
        frame: after.first()?.place,
        before_px,
        after_px,
        own_px,
        base,
        evidence,
    })
}

/// A frame with a camera and enough clicks to constrain the base.
struct InformativeFrame {
    place: usize,
    clicks: Vec<BaseClick>,
    observations: Vec<Observation>,
    ptz: Ptz,
}

impl InformativeFrame {
    fn new(place: usize, frame: &FrameClicks, ptz: Ptz, field: &FieldModel) -> Self {
        let observations: Vec<Observation> = frame.used_clicks().copied().collect();
        let clicks = observations
            .iter()
            .map(|observation| BaseClick::new(observation, field.crown()))
            .collect();
        Self {
            place,
            clicks,
            observations,
            ptz,
        }
    }

    fn pull(&self, shared: &Shared) -> DisplacementEquations {
        DisplacementEquations::from_equations(&frame_equations(
            shared,
            self.ptz,
            &self.clicks,
            Loss::default(),
        ))
    }
}

/// Gradient Jᵀ W r and information Jᵀ W J of a displacement of the base, from the clicks of one
/// frame, or summed over several frames.
#[derive(Clone, Copy, Debug)]
struct DisplacementEquations {
    gradient: BaseDisplacement,
    information: DisplacementMatrix,
}

impl DisplacementEquations {
    fn none() -> Self {
        Self {
            gradient: BaseDisplacement::zeros(),
            information: DisplacementMatrix::zeros(),
        }
    }

    /// Eliminates the frame's pan, tilt and focal length (Schur complement). Zero for a frame that
    /// does not determine them.
    fn from_equations(frame: &BlockEquations<OF_BASE, 3>) -> Self {
        let Some((information, gradient)) = frame.eliminate_own() else {
            return Self::none();
        };
        Self {
            gradient: gradient.fixed_rows::<MOVED>(0).into_owned(),
            information: information.fixed_view::<MOVED, MOVED>(0, 0).into_owned(),
        }
    }

    fn plus(self, other: &Self) -> Self {
        Self {
            gradient: self.gradient + other.gradient,
            information: self.information + other.information,
        }
    }

    fn minus(self, other: &Self) -> Self {
        Self {
            gradient: self.gradient - other.gradient,
            information: self.information - other.information,
        }
    }

    /// How much of χ² a displacement explains, gᵀ (H + V⁻¹)⁻¹ g with gradient g, information H and
    /// prior covariance V, and the expectation of that under click noise alone, tr((H + V⁻¹)⁻¹ H).
    fn explained_chi_squared(&self) -> (f64, f64) {
        let Some(inverse) = (self.information + prior()).try_inverse() else {
            return (0.0, 0.0);
        };
        (
            self.gradient.dot(&(inverse * self.gradient)),
            (inverse * self.information).trace(),
        )
    }

    /// The logarithm of the Bayes factor of one displacement against none: ½ gᵀ (H + V⁻¹)⁻¹ g − ½
    /// ln det(I + H V), with g and H divided by the scatter. It is the ratio of the marginal
    /// likelihoods of a Gaussian with prior covariance V and one with zero displacement.
    fn evidence(&self, scatter: f64) -> f64 {
        let information = self.information / scatter;
        let Some(inverse) = (information + prior()).try_inverse() else {
            return 0.0;
        };
        let gradient = self.gradient / scatter;
        let spread = DisplacementMatrix::identity() + information * variance();
        0.5 * (gradient.dot(&(inverse * gradient)) - spread.determinant().ln())
    }
}

/// The prior covariance V of a displacement (m², rad²).
fn variance() -> DisplacementMatrix {
    let turn = BUMP_TURN.radians();
    DisplacementMatrix::from_diagonal(&BaseDisplacement::from_fn(|index, _| {
        if index < ROTATION {
            BUMP_M.powi(2)
        } else {
            turn * turn
        }
    }))
}

/// V⁻¹, the inverse of [`variance`].
fn prior() -> DisplacementMatrix {
    DisplacementMatrix::from_diagonal(&variance().diagonal().map(|variance| 1.0 / variance))
}

/// The most likely change of a sequence.
#[derive(Clone, Copy, Debug)]
struct Split {
    at: usize,
    evidence: f64,
    /// The ratio of the variance of the frames' scatter to that expected from click noise, at least
    /// 1.
    scatter: f64,
}

/// The index at which two displacements, one before and one from it on, are most likely compared
/// with a single one.
fn split(pulls: &[DisplacementEquations]) -> Option<Split> {
    // χ² that a displacement per frame explains, and its expectation under click noise.
    let all = pulls
        .iter()
        .fold(DisplacementEquations::none(), DisplacementEquations::plus);
    let (mut misfit, mut freedom) = (0.0, 0.0);
    for pull in pulls {
        let (explained, expected) = pull.explained_chi_squared();
        misfit += explained;
        freedom += expected;
    }

    // Gradients and information add up over frames, so running sums give both sides of every index
    // in linear time.
    let mut before = DisplacementEquations::none();
    let mut best: Option<Split> = None;
    for (index, pull) in pulls.iter().enumerate() {
        let after = all.minus(&before);
        // The difference of sums leaves rounding of 1e-16 of the whole, which the prior, added to
        // it below, exceeds by far.
        if index >= MIN_SIDE && index + MIN_SIDE <= pulls.len() {
            let (of_before, of_after) = (
                before.explained_chi_squared(),
                after.explained_chi_squared(),
            );
            // What separate displacements of the frames explain beyond one displacement on each
            // side is scatter: lens, pitch and names. Compared with its expectation it scales the
            // noise, never below the noise of the clicks.
            let left = freedom - of_before.1 - of_after.1;
            let scatter = ((misfit - of_before.0 - of_after.0) / left.max(1.0)).max(1.0);
            let evidence =
                before.evidence(scatter) + after.evidence(scatter) - all.evidence(scatter);
            if best.is_none_or(|best| evidence > best.evidence) {
                best = Some(Split {
                    at: index,
                    evidence,
                    scatter,
                });
            }
        }
        before = before.plus(pull);
    }
    best
}

/// A base fitted to the clicks of some frames by position and rotation alone.
struct DisplacedBase {
    shared: Shared,
    /// Of all shared parameters, the frames' own eliminated.
    information: SharedCovariance,
}

impl DisplacedBase {
    /// Adjusts position and rotation to the clicks of some frames, with the prior of a bump around
    /// the start. The lens is kept.
    fn fit(start: &Shared, frames: &[InformativeFrame]) -> Self {
        const UNTIL: Stopping = Stopping {
            max_iterations: 8,
            short_step: 0.0,
            small_gain: 1e-6,
        };
        // Only position and rotation are free: a bump changes neither the lens nor the pitch.
        let mut free = [false; OF_BASE];
        free[..MOVED].fill(true);
        let bundle = Bundle {
            frames: frames.iter().map(|frame| frame.clicks.clone()).collect(),
            priors: near(&start.base, BUMP_M, BUMP_TURN).collect(),
            free,
            loss: Loss::default(),
        };
        let ptz = frames.iter().map(|frame| frame.ptz).collect();
        let found = minimise(
            &bundle,
            BundleState {
                shared: *start,
                ptz,
            },
            UNTIL,
        );
        let blocks = found.equations.blocks.iter();
        let eliminated = blocks.filter_map(BlockEquations::eliminate_own);
        Self {
            shared: found.state.shared,
            information: eliminated.map(|(information, _)| information).sum(),
        }
    }

    /// Median distance of the clicks of some frames, px, each frame's pan, tilt and focal length
    /// refined under this base.
    fn median_px(&self, frames: &[InformativeFrame]) -> Option<f64> {
        let base = self.shared.base;
        let mut errors: Vec<f64> = frames
            .par_iter()
            .flat_map_iter(|frame| {
                let refined = refine(&base, frame.ptz, &frame.observations, Loss::default(), None);
                let camera = PtzCamera::new(base, refined.ptz);
                frame
                    .observations
                    .iter()
                    .filter_map(move |click| click.distance_px(&camera))
                    .collect::<Vec<_>>()
            })
            .collect();
        median_high(&mut errors)
    }

    /// 1-σ of all shared parameters: of position and rotation with the click noise scaled by the
    /// scatter, of the kept ones as before.
    fn sigma(&self, scatter: f64) -> BaseSigma {
        let information = self.information / scatter;
        let moved = (information.fixed_view::<MOVED, MOVED>(0, 0) + prior())
            .try_inverse()
            .unwrap_or_else(variance);
        // What is kept is not exact: position and rotation change by −H⁻¹ B per unit of its error,
        // with their information H and its coupling B (a "considered" parameter, see
        // `covariance.rs`).
        let mut kept = self.shared.base.sigma.covariance();
        let is_kept = std::array::from_fn(|parameter| parameter >= MOVED);
        clear_fixed(&mut kept, &is_kept);
        let mut follows = SharedCovariance::identity();
        follows
            .fixed_view_mut::<MOVED, KEPT>(0, MOVED)
            .copy_from(&(-moved * information.fixed_view::<MOVED, KEPT>(0, MOVED)));
        let mut covariance = follows * kept * follows.transpose();
        let mut of_moved = covariance.fixed_view_mut::<MOVED, MOVED>(0, 0);
        of_moved += moved;
        BaseSigma::from_covariance(&covariance, self.shared.crown.width_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::FieldElement;
    use crate::geometry::{Vec2, Vec3};
    use crate::markings::project_landmarks;
    use crate::solve::fixtures;
    use crate::testing::{SIZE, soccer};

    /// A frame with exact clicks on all landmarks that it shows.
    fn frame(field: &FieldModel, base: &CameraBase, pan_deg: f64) -> InformativeFrame {
        let ptz = Ptz::from_degrees(pan_deg, -12.0, 1800.0);
        let shown = project_landmarks(field, &PtzCamera::new(*base, ptz), SIZE, 0.0);
        let clicks = shown.iter().enumerate().map(|(number, shown)| {
            Observation::from_point(Vec3::zeros(), shown.image, 2.0, number)
                .with_element(field, FieldElement::Landmark(shown.landmark))
                .unwrap()
        });
        let clicks = FrameClicks {
            observations: clicks.collect(),
            start: None,
        };
        InformativeFrame::new(0, &clicks, ptz, field)
    }

    fn sigma_with(kept: &BaseSigma) -> BaseSigma {
        let field = soccer();
        let base = CameraBase {
            sigma: *kept,
            ..fixtures::base()
        };
        let frames = [-25.0, 0.0, 25.0].map(|pan_deg| frame(&field, &base, pan_deg));
        DisplacedBase::fit(&Shared::new(&base, field.crown()), &frames).sigma(1.0)
    }

    #[test]
    fn a_lens_that_is_kept_stays_as_uncertain_as_it_was() {
        let kept = BaseSigma {
            k1: 0.04,
            k1_per_1000_px: 0.1,
            principal_point_px: Vec2::new(30.0, 20.0),
            ..BaseSigma::default()
        };
        let (exact, found) = (sigma_with(&BaseSigma::default()), sigma_with(&kept));
        assert!((found.k1 - 0.04).abs() < 1e-12 && (exact.k1, exact.crown_m) == (0.0, 0.0));
        assert!((found.principal_point_px - kept.principal_point_px).norm() < 1e-9);
        assert!(
            found.position_m.norm() > 1.1 * exact.position_m.norm(),
            "{found:?} {exact:?}"
        );
    }
}
