//! The least-squares problem of one picture: all points of its lines and the priors.
//!
//! It is the bundle adjustment of a base with a single frame. The frame's pan, tilt and focal
//! length are its own parameters; position, lean, lens, crown and principal point are the shared
//! ones. So residuals, derivatives and the covariance are those of [`crate::solve::base`].

use super::priors::{FocalPrior, PlacePrior};
use super::starts::Start;
use super::{FromLinesOptions, LinePicture};
use crate::camera::{CameraBase, Ptz, PtzCamera, SharedCovariance};
use crate::field::Crown;
use crate::geometry::Angle;
use crate::solve::base::base_click::BaseClick;
use crate::solve::base::bundle::frame_equations;
use crate::solve::base::parameters::{OF_BASE, Shared, clear_fixed, free_parameters};
use crate::solve::base::priors::{UsualView, direction_to_field};
use crate::solve::base::shared_prior::SharedPrior;
use crate::solve::base::{BaseModel, LensModel};
use crate::solve::optimiser::least_squares::{
    BlockEquations, BorderedEquations, BorderedStep, Equations as _, Problem, Stopping, minimise,
};
use crate::solve::{Loss, Observation, refine};

/// The camera of a picture as the fit changes it.
#[derive(Clone, Copy, Debug)]
pub(super) struct PictureState {
    pub shared: Shared,
    pub ptz: Ptz,
}

impl PictureState {
    /// The camera.
    pub fn camera(&self) -> PtzCamera {
        PtzCamera::new(self.shared.base, self.ptz)
    }
}

/// A fitted camera with its cost, sigmas².
#[derive(Clone, Copy, Debug)]
pub(super) struct Fitted {
    pub state: PictureState,
    pub cost: f64,
}

/// The observations and priors of one picture.
pub(super) struct PictureFit {
    clicks: Vec<BaseClick>,
    place: PlacePrior,
    focal: FocalPrior,
    shared: Vec<SharedPrior>,
    free: [bool; OF_BASE],
    loss: Loss,
}

/// The state at a start: its pose, with the usual lens.
pub(super) fn starting_state(
    picture: &LinePicture<'_>,
    start: &Start,
    options: &FromLinesOptions,
) -> PictureState {
    // A start knows no lens: it begins with the stated or the usual one, and the crown in the
    // middle of its prior where it is free.
    let usual = options.priors.of_base(picture);
    let stated = picture.lens.radial.map(|radial| radial.curve);
    let base = CameraBase {
        distortion: stated
            .unwrap_or(usual.usual_lens(picture.image_size))
            .with_pixel_aspect(picture.lens.pixel_aspect.unwrap_or(1.0)),
        ..start.base
    };
    let height_m = options
        .crown(picture.field)
        .fixed_height_m()
        .unwrap_or(usual.crown_m.0);
    let crown = Crown {
        height_m,
        ..picture.field.crown()
    };
    PictureState {
        shared: Shared::new(&base, crown),
        ptz: start.ptz,
    }
}

impl PictureFit {
    /// The problem of some observations; `near` says from where the camera sees the field, along
    /// which heads are levelled.
    pub fn new(
        picture: &LinePicture<'_>,
        observations: &[Observation],
        near: &PictureState,
        options: &FromLinesOptions,
        loss: Loss,
    ) -> Self {
        // The richest lens, with a principal point: their priors decide what one picture leaves
        // open (tests/benches/lines.md, "What was tried").
        let (on_field, priors) = (picture.field.crown(), &options.priors);
        let model = BaseModel {
            lens: LensModel::K1FocalK2,
            crown: options.crown(picture.field),
            // A stated principal point is kept.
            principal_point: picture
                .lens
                .principal_point
                .is_none()
                .then(|| picture.image_size.centre()),
        };
        // Without a usual focal length, because there is no other frame to take it from.
        let view = UsualView {
            along: direction_to_field(near.shared.base.position_m),
            sigma: Angle::default(),
            focal_px: None,
        };
        Self {
            clicks: observations
                .iter()
                .map(|observation| BaseClick::new(observation, on_field))
                .collect(),
            place: priors.place(picture.field),
            focal: priors.focal(picture.image_size),
            shared: priors
                .of_base(picture)
                .for_model(&model, picture.image_size, &view),
            free: free_parameters(&model),
            loss,
        }
    }

    /// The minimum near a state.
    pub fn minimum(&self, start: &PictureState, max_iterations: usize) -> Fitted {
        /// A step in (m, rad, log f) shorter than this is the last, and one that lowers the cost by
        /// less than this fraction.
        const SHORT_STEP: f64 = 1e-5;
        const SMALL_GAIN: f64 = 1e-6;
        let until = Stopping {
            max_iterations,
            short_step: SHORT_STEP,
            small_gain: SMALL_GAIN,
        };
        let found = minimise(self, *start, until);
        Fitted {
            cost: found.equations.cost(),
            state: found.state,
        }
    }

    /// The covariance of the shared parameters at a minimum; none where a combination of them is
    /// not determined.
    pub fn covariance(&self, at: &PictureState) -> Option<SharedCovariance> {
        // Undamped, pan, tilt and focal length eliminated: what is left is the information on the
        // shared parameters. Fixed ones have the identity there, and no variance.
        let (information, _) = self.equations(at).eliminate_blocks(0.0)?;
        let mut covariance = information.cholesky()?.inverse();
        clear_fixed(&mut covariance, &self.free);
        Some(covariance)
    }
}

impl Problem for PictureFit {
    type State = PictureState;
    type Equations = BorderedEquations<OF_BASE, 3>;

    fn equations(&self, at: &PictureState) -> Self::Equations {
        // The prior of the focal length is about the frame's own parameters, so it belongs to the
        // block; all others are about shared ones.
        let mut priors = BlockEquations::zero();
        for prior in &self.shared {
            priors.add(prior, &at.shared, self.loss);
        }
        priors.add(&self.place, &at.shared, self.loss);
        let mut frame = frame_equations(&at.shared, at.ptz, &self.clicks, self.loss);
        frame.add(&self.focal, &at.ptz, self.loss);
        BorderedEquations {
            priors,
            blocks: vec![frame],
            free: self.free,
        }
    }

    fn apply_step(&self, from: &PictureState, step: &BorderedStep<OF_BASE, 3>) -> PictureState {
        PictureState {
            shared: from.shared.apply_step(&step.shared),
            ptz: refine::apply_step(&from.ptz, &step.own[0]),
        }
    }
}
