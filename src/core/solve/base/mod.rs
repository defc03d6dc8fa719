//! The base of a camera from many frames: position, base rotation, lens, principal point and the
//! crown of the pitch.
//!
//! # Problem
//!
//! A broadcast camera stands still. Its frames share a position, the rotation of its head (the
//! *base*) and a lens whose distortion follows the focal length; each frame adds its own pan, tilt
//! and focal length. Given clicks on landmarks and lines in some frames, or painted lines seen in
//! many, estimate the shared parameters and their covariance.
//!
//! # Method
//!
//! 1. **Start** (`start.rs`). A frame with four landmarks on the ground gives a homography, and
//!    that gives a camera (`plane_pose.rs`); frames with lines alone bring a camera with them
//!    (`../from_lines`). Its position is noisy, and some positions are grossly wrong. So each is
//!    tested as the base of a sample of frames, and the one with the lowest robust cost wins. Wrong
//!    names in a few frames do not affect the result.
//! 2. **Bundle adjustment** (`bundle.rs`, `adjust.rs`). All parameters together by damped
//!    Gauss–Newton. Frames are coupled only through the shared parameters, so their own three
//!    parameters are eliminated first (Schur complement; Triggs and others: "Bundle Adjustment – A
//!    Modern Synthesis", 2000, section 6). A robust loss reduces the weight of wrong clicks.
//! 3. **Priors** (`priors.rs`, `shared_prior.rs`). Heads are levelled along and across the
//!    direction in which they see the field; k₁ follows the focal length as measured on twenty
//!    broadcast lenses; the principal point lies within ±40 px of the middle at 1920 px width.
//! 4. **Model choice** (`cross_validation.rs`, `model.rs`). Four lens models, each on a
//!    level and a crowned pitch, are compared by five-fold cross-validation: frames are held out,
//!    each is refined on one half of its clicks and evaluated on the other. A richer model has to
//!    be better by 0.5 %. Fewer than six frames keep the usual lens and pitch unless their clicks
//!    clearly contradict them.
//! 5. **Size of the field** (`field_fit.rs`), on the user's request: length and width as two more
//!    shared parameters.
//!
//! # How certain it is
//!
//! The inverse of the normal equations underestimates the covariance. Three parts are added to it,
//! each as a full covariance of position, rotation, lens, crown and principal point, so that errors
//! that cancel in a picture still cancel:
//!
//! * landmarks are displaced equally in all frames (`scatter.rs`: a random effect per landmark);
//! * lens, crown and principal point that a model fixes are uncertain by their priors
//!   (`covariance.rs`);
//! * errors that frames have in common and no model describes show when groups of frames are held
//!   out (the jackknife of `cross_validation.rs`).
//!
//! # What it is proof against
//!
//! Swapped and mirrored names ([`DisputedClick`], [`MirroredFrame`]), frames of a few clicks each,
//! a first base that is metres off, lenses that no model describes exactly. It is not robust
//! against frames of a single focal length: then k₁ and its slope are determined by their priors.
//!
//! # Figures
//!
//! `tests/benches/base.md`: simulated cameras with all parameters drawn from their priors
//! (`base_coverage`), twelve measured broadcast lenses (`lenses`), clicked matches.

mod adjust;
pub(super) mod base_click;
pub(super) mod bundle;
mod change;
mod covariance;
mod cross_validation;
mod disputes;
mod estimate;
mod field_fit;
mod model;
mod one_more;
pub(super) mod parameters;
mod pixel_aspect;
pub(super) mod priors;
mod scatter;
mod shared_place;
pub(super) mod shared_prior;
mod start;
mod summary;

pub use adjust::AdjustOptions;
pub use cross_validation::{HeldOutErrors, ModelReason, ModelScore};
pub use disputes::{DisputedClick, MirroredFrame};
pub use estimate::{BaseOptions, estimate_base};
pub use field_fit::FittedSize;
pub use model::{BaseModel, CrownModel, LensModel, Prescribed};
pub use one_more::{BesideFrames, OneMoreFrame};
pub use pixel_aspect::PixelAspect;
pub use priors::BasePriors;
pub use shared_place::SharedPlace;
pub use summary::{BaseEstimate, FrameFit};
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    adjust::{AdjustedBase, adjust_base},
    change::{BaseChange, base_change},
    estimate::{cross_validated_errors, estimate_base_on_paint},
    field_fit::{SizeParam, SizeStart, fit_field_size},
    scatter::usual_displacement_m,
    shared_place::shared_places,
    start::{BaseStart, start_base},
};

use super::Observation;
use crate::camera::{Ptz, PtzCamera};
use crate::field::FieldModel;
use crate::geometry::{ImagePoint, ImageSize, pluralise};
use crate::progress::Progress;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use thiserror::Error;

/// The clicks of one frame of the camera whose base is sought.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameClicks {
    /// Its clicks; held-out ones are not used.
    pub observations: Vec<Observation>,
    /// Its pan, tilt and focal length, if known.
    pub start: Option<Ptz>,
}

impl FrameClicks {
    /// The clicks that are used, without held-out ones.
    pub(super) fn used_clicks(&self) -> impl Iterator<Item = &Observation> + Clone {
        self.observations
            .iter()
            .filter(|observation| !observation.check)
    }

    /// The number of equations of the clicks used.
    pub fn equations(&self) -> usize {
        self.used_clicks().map(Observation::equations).sum()
    }
}

/// The clicks of all frames of one camera, from which its base is estimated.
#[derive(Clone, Copy, Debug)]
pub struct CameraClicks<'a> {
    /// The field of the clicks. Its crown is the initial value, unless the model fixes it.
    pub field: &'a FieldModel,
    /// The frames.
    pub frames: &'a [FrameClicks],
    /// The size of every frame; its width scales the priors.
    pub image_size: ImageSize,
    /// Where the optical axis meets the picture, px.
    pub principal_point: ImagePoint,
    /// The aspect of the pixels, fy / fx; 1: square.
    pub pixel_aspect: f64,
    /// Cameras that some frames have by the lines drawn in them, found without a base. The search
    /// starts from these as well.
    pub own_cameras: &'a [PtzCamera],
}

impl<'a> CameraClicks<'a> {
    /// The clicks of a camera whose principal point is the middle of the picture.
    pub fn with_centred_principal_point(
        field: &'a FieldModel,
        frames: &'a [FrameClicks],
        image_size: ImageSize,
    ) -> Self {
        Self {
            field,
            frames,
            image_size,
            principal_point: image_size.centre(),
            pixel_aspect: 1.0,
            own_cameras: &[],
        }
    }
}

/// Why the base cannot be estimated.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BaseError {
    /// No frame determines a camera by itself.
    #[error(
        "no frame determines a camera by itself ({} with clicks, the best has {} on the ground): \
         on wide frames, left, centre and right, click four or more that are not on one line, or \
         two points on as many lines in two directions",
        pluralise(*.frames, "frame"), pluralise(*.most_landmarks, "landmark")
    )]
    NoStart {
        /// Frames with clicks.
        frames: usize,
        /// The largest number of ground landmarks in one of them.
        most_landmarks: usize,
    },
    /// The clicks contradict each other so much that no camera explains half of them.
    #[error(
        "no camera explains the clicks: the best one {}. Check the names, the field's size, and \
         that all frames are of one camera",
        if median_px.is_finite() {
            format!("leaves them {median_px:.0} px off (median)")
        } else {
            "does not see them".to_owned()
        }
    )]
    NoFit {
        /// Median distance of the clicks, px; infinite where most of them have no image.
        median_px: f64,
    },
    /// The best-fitting camera is below the field.
    #[error(
        "the best-fitting camera is {depth_m:.1} m below the field: check left and right, near and far"
    )]
    BelowGround {
        /// How deep, m.
        depth_m: f64,
    },
    /// The estimation was cancelled.
    #[error("the estimation was stopped")]
    Stopped,
    /// The frames do not determine the position.
    #[error(
        "the frames leave the camera's position open by {sigma_m:.0} m: click landmarks in \
         frames that look elsewhere, or zoomed differently"
    )]
    Undetermined {
        /// 1-σ of the position in its worst direction, m.
        sigma_m: f64,
    },
}

/// The progress of an estimation, in adjustments of the base: one for each model and each held-out
/// group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BaseProgress {
    /// Adjustments made.
    pub done: usize,
    /// Adjustments in all.
    pub total: usize,
}

/// Counts the adjustments of one estimation.
struct Adjustments<'a> {
    progress: &'a Progress<'a, BaseProgress>,
    total: usize,
    done: AtomicUsize,
}

impl<'a> Adjustments<'a> {
    pub fn new(progress: &'a Progress<'_, BaseProgress>, total: usize) -> Self {
        Self {
            progress,
            total,
            done: AtomicUsize::new(0),
        }
    }

    /// Counts one more. A break cancels the estimation.
    pub fn count(&self) -> ControlFlow<()> {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.progress.report(BaseProgress {
            done,
            total: self.total,
        })
    }

    pub fn are_cancelled(&self) -> bool {
        self.progress.is_cancelled()
    }
}
