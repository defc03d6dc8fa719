//! Whether a base stops fitting from some frame on: somebody bumped the tripod, or set it up anew
//! at half-time.
//!
//! Each frame's clicks pull the base somewhere (gradient) and say how surely (normal equations, the
//! frame's own pan, tilt and focal length eliminated). At every place of the sequence two models
//! are compared: one displacement of the base for all frames, or one before and another from there
//! on, each with the same prior. With Gaussians the Bayes factor has a closed form. What frames
//! scatter beyond the noise of their clicks (lens, pitch, names) is estimated along and makes all
//! of them count less. What is found must also show in pixels.

use super::FrameClicks;
use super::base_click::BaseClick;
use super::bundle::{Bundle, BundleState, frame_equations};
use super::parameters::{K1, OF_BASE, ROTATION, Shared};
use super::shared_prior::near;
use crate::camera::{BaseSigma, CameraBase, Ptz, PtzCamera, SharedCovariance};
use crate::field::FieldModel;
use crate::geometry::{Angle, median_high, subsample};
use crate::solve::least_squares::{BlockEquations, Stopping, minimise};
use crate::solve::{Loss, Observation, refine};
use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;

/// How many parameters a bump moves: the position and the rotation about world x and y.
const MOVED: usize = K1;

type Moved = SVector<f64, MOVED>;
type MovedMatrix = SMatrix<f64, MOVED, MOVED>;

/// As many frames are needed on each side.
const MIN_SIDE: usize = 3;
/// Clicks whose number of equations is less say nothing about the base.
const MIN_EQUATIONS: usize = 4;
/// A bump moves a camera by this much, m (1-σ).
const BUMP_M: f64 = 1.0;
/// And turns its head by this much (1-σ).
const BUMP_TURN: Angle = Angle::from_degrees(0.5);
/// The logarithm of the Bayes factor that is believed.
const EVIDENCE: f64 = 12.0;
/// Where the base no longer fits, clicks are at least this many times farther off than before.
const WORSE: f64 = 1.4;
/// And with a base of their own they come back to at most this share.
const MENDED: f64 = 0.8;
/// A longer sequence is first looked at in this many frames.
const COARSE: usize = 300;

/// The place where a base stops fitting.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseChange {
    /// The first frame that it no longer fits, by its place among those given.
    pub frame: usize,
    /// Median distance of the clicks before it, px.
    pub before_px: f64,
    /// Median distance of the clicks from it on, with the base that fits those before, px.
    pub after_px: f64,
    /// The same with a base of their own, px.
    pub own_px: f64,
    /// That base: moved and turned, the lens as before.
    pub base: CameraBase,
    /// The logarithm of the Bayes factor for a change here.
    pub evidence: f64,
}

/// Where a base stops fitting, if it does: `frames` and their cameras in the order of time. Frames
/// without a camera or with too few clicks are passed over.
#[must_use]
pub fn base_change(
    field: &FieldModel,
    frames: &[FrameClicks],
    ptz: &[Option<Ptz>],
    base: &CameraBase,
) -> Option<BaseChange> {
    let shared = Shared::new(base, field.crown());
    let telling: Vec<Telling> = frames
        .iter()
        .zip(ptz)
        .enumerate()
        .filter(|(_, (frame, _))| frame.equations() >= MIN_EQUATIONS)
        .filter_map(|(place, (frame, ptz))| Some(Telling::new(place, frame, (*ptz)?, field)))
        .collect();
    if telling.len() > COARSE {
        let coarse: Vec<Pull> = subsample(&telling, COARSE)
            .map(|frame| frame.pull(&shared))
            .collect();
        // What a part of the frames does not suggest, all of them are not asked.
        split(&coarse).filter(|split| split.evidence > 0.5 * EVIDENCE)?;
    }
    let pulls: Vec<Pull> = telling
        .par_iter()
        .map(|frame| frame.pull(&shared))
        .collect();
    let Split {
        at,
        evidence,
        scatter,
    } = split(&pulls).filter(|split| split.evidence > EVIDENCE)?;

    let (before, after) = telling.split_at(at);
    let held = Displaced::fitted(&shared, before);
    let own = Displaced::fitted(&shared, after);
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

/// A frame that says something about the base.
struct Telling {
    place: usize,
    clicks: Vec<BaseClick>,
    observations: Vec<Observation>,
    ptz: Ptz,
}

impl Telling {
    fn new(place: usize, frame: &FrameClicks, ptz: Ptz, field: &FieldModel) -> Self {
        let observations: Vec<Observation> = frame.used().copied().collect();
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

    fn pull(&self, shared: &Shared) -> Pull {
        Pull::of(&frame_equations(
            shared,
            self.ptz,
            &self.clicks,
            Loss::default(),
        ))
    }
}

/// Where a frame's clicks pull the base, and how surely; or several frames' together.
#[derive(Clone, Copy, Debug)]
struct Pull {
    gradient: Moved,
    information: MovedMatrix,
}

impl Pull {
    fn none() -> Self {
        Self {
            gradient: Moved::zeros(),
            information: MovedMatrix::zeros(),
        }
    }

    /// Pan, tilt and focal length follow. A frame that leaves those open says nothing.
    fn of(frame: &BlockEquations<OF_BASE, 3>) -> Self {
        let Some((information, gradient)) = frame.eliminated() else {
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

    /// How much of the misfit a displacement explains, and how much noise alone would have it
    /// explain.
    fn explained(&self) -> (f64, f64) {
        let Some(inverse) = (self.information + prior()).try_inverse() else {
            return (0.0, 0.0);
        };
        (
            self.gradient.dot(&(inverse * self.gradient)),
            (inverse * self.information).trace(),
        )
    }

    /// The logarithm of the evidence for one displacement, against none.
    fn evidence(&self, scatter: f64) -> f64 {
        let information = self.information / scatter;
        let Some(inverse) = (information + prior()).try_inverse() else {
            return 0.0;
        };
        let gradient = self.gradient / scatter;
        let spread = MovedMatrix::identity() + information * variance();
        0.5 * (gradient.dot(&(inverse * gradient)) - spread.determinant().ln())
    }
}

/// What is known of a displacement beforehand, as variances (m², rad²).
fn variance() -> MovedMatrix {
    let turn = BUMP_TURN.radians();
    MovedMatrix::from_diagonal(&Moved::from_fn(|index, _| {
        if index < ROTATION {
            BUMP_M.powi(2)
        } else {
            turn * turn
        }
    }))
}

/// The inverse of [`variance`].
fn prior() -> MovedMatrix {
    MovedMatrix::from_diagonal(&variance().diagonal().map(|variance| 1.0 / variance))
}

/// Where a sequence is best parted.
#[derive(Clone, Copy, Debug)]
struct Split {
    at: usize,
    evidence: f64,
    /// How many times larger than the clicks' noise the frames' scatter is, as variances.
    scatter: f64,
}

fn split(pulls: &[Pull]) -> Option<Split> {
    let all = pulls.iter().fold(Pull::none(), Pull::plus);
    let (mut misfit, mut freedom) = (0.0, 0.0);
    for pull in pulls {
        let (explained, expected) = pull.explained();
        misfit += explained;
        freedom += expected;
    }
    let mut before = Pull::none();
    let mut best: Option<Split> = None;
    for (index, pull) in pulls.iter().enumerate() {
        let after = all.minus(&before);
        if index >= MIN_SIDE && index + MIN_SIDE <= pulls.len() {
            let (of_before, of_after) = (before.explained(), after.explained());
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

/// A base moved and turned to where some frames' clicks have it.
struct Displaced {
    shared: Shared,
    information: MovedMatrix,
}

impl Displaced {
    /// The base adjusted to some frames, held near the start by what is known of bumps; the lens
    /// stays.
    fn fitted(start: &Shared, frames: &[Telling]) -> Self {
        const UNTIL: Stopping = Stopping {
            max_iterations: 8,
            short_step: 0.0,
            small_gain: 1e-6,
        };
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
        let pulls = found.equations.blocks.iter().map(Pull::of);
        let sum = pulls.fold(Pull::none(), |sum, pull| sum.plus(&pull));
        Self {
            shared: found.state.shared,
            information: sum.information,
        }
    }

    /// Median distance of some frames' clicks, each frame pointed anew, px.
    fn median_px(&self, frames: &[Telling]) -> Option<f64> {
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

    /// How far position and rotation are known.
    fn sigma(&self, scatter: f64) -> BaseSigma {
        let covariance = (self.information / scatter + prior())
            .try_inverse()
            .unwrap_or_else(variance);
        let mut of_shared = SharedCovariance::zeros();
        of_shared
            .fixed_view_mut::<5, 5>(0, 0)
            .copy_from(&covariance.fixed_view::<5, 5>(0, 0));
        BaseSigma::from_covariance(&of_shared, self.shared.crown.width_m)
    }
}
