//! The result of an estimation: its checks, its errors, and which clicks and frames contradict it.

use super::disputes::{disputed_clicks, mirrored_frames};
use super::{
    AdjustedBase, BaseError, BaseModel, DisputedClick, FrameClicks, MirroredFrame, ModelReason,
    ModelScore, OneMoreFrame, PixelAspect,
};
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::field::FieldModel;
use crate::geometry::{AngleRange, ImageSize, Mat3, median, quantile};
use serde::Serialize;

/// A fit with a larger median click error is rejected, px at 1920 px width.
const NO_FIT_PX: f64 = 25.0;

/// A base with a larger 1-σ of the position, along its worst direction, is rejected, m.
const MAX_POSITION_SIGMA_M: f64 = 20.0;

/// How one frame fits the base.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameFit {
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// Median distance of its clicks, px.
    pub median_px: f64,
    /// Root mean square distance of its clicks, px.
    pub rms_px: f64,
}

/// A base estimated from clicks, with its errors and diagnostics.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BaseEstimate {
    /// The base with its sigma. The sigma is that of the adjustment, which includes landmarks
    /// displaced in every frame, raised in the directions in which the jackknife over groups of
    /// frames is larger.
    pub base: CameraBase,
    /// The crown of the pitch, m.
    pub crown_m: f64,
    /// Which parameters were free.
    pub model: BaseModel,
    /// Why this model was chosen.
    pub reason: ModelReason,
    /// The cross-validation scores of all models; a single one where the model was prescribed.
    pub scores: Vec<ModelScore>,
    /// Covariance of the position, m²: that of the base's sigma.
    #[serde(serialize_with = "crate::geometry::rows")]
    pub position_covariance: Mat3,
    /// Each frame's fit; none where its clicks gave no camera.
    pub frames: Vec<Option<FrameFit>>,
    /// Median distance of all clicks, px.
    pub median_px: f64,
    /// The 90 % quantile of it, px.
    pub p90_px: f64,
    /// The median distance of all clicks under the previous base, px, if one was given.
    pub previous_median_px: Option<f64>,
    /// Where frames are few: the further frame that would reduce the uncertainty most.
    pub one_more_frame: Option<OneMoreFrame>,
    /// The aspect of the pixels, where the clicks clearly fit pixels that are not square. The base
    /// is that of square ones; its sigma contains the error.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pixel_aspect: Option<PixelAspect>,
    /// Clicks that contradict the others, without those of mirrored frames.
    pub disputed: Vec<DisputedClick>,
    /// Frames whose landmarks are named from the wrong side of the field.
    pub mirrored: Vec<MirroredFrame>,
}

impl BaseEstimate {
    /// A notice for the user if all frames look the same way, because they then determine the
    /// position less well than their number suggests. None if the views differ, or for a single
    /// frame.
    pub fn one_view(&self) -> Option<String> {
        /// Frames whose pan and focal length differ by less than this are one view, degrees and log
        /// f.
        const ONE_VIEW: [f64; 2] = [3.0, 0.1];
        let solved: Vec<&FrameFit> = self.frames.iter().flatten().collect();
        // The smallest arc, because pan may cross ±180°.
        let pan_deg = AngleRange::smallest(solved.iter().map(|fit| fit.ptz.pan))?
            .width()
            .degrees();
        let log_focals = solved.iter().map(|fit| fit.ptz.focal_px.ln());
        let (least, most) = log_focals.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        });
        let same = solved.len() > 1 && pan_deg < ONE_VIEW[0] && most - least < ONE_VIEW[1];
        let sigma_m = self.base.sigma.position_m.norm();
        same.then(|| {
            format!(
                "all {} frames look the same way (pan within {pan_deg:.1}°), so the position is known to ±{sigma_m:.1} m: click landmarks in frames that look further left and right",
                solved.len()
            )
        })
    }
}

/// A base adjusted with the model that was chosen.
pub(super) struct ChosenFit {
    pub adjusted: AdjustedBase,
    pub model: BaseModel,
    pub reason: ModelReason,
    pub scores: Vec<ModelScore>,
}

/// Checks a fit and summarises it, by the clicks on the fitted field and the frames' cameras.
pub(super) fn summary(
    fit: ChosenFit,
    field: &FieldModel,
    frames: &[FrameClicks],
    ptz: &[Option<Ptz>],
    image_size: ImageSize,
) -> Result<BaseEstimate, BaseError> {
    let ChosenFit {
        adjusted,
        model,
        reason,
        scores,
    } = fit;
    let base = adjusted.base;
    let mut errors = distances(&base, frames, ptz);
    errors.sort_by(f64::total_cmp);

    // Reject a base that does not explain half of the clicks, whose position is not determined, or
    // that stands below the ground. Comparisons are written so that NaN is rejected.
    let median_px = quantile_or_infinite(&errors, 0.5);
    // A base estimated on paint alone has no clicks to be measured by.
    let has_clicks = frames.iter().any(|frame| frame.equations() > 0);
    if has_clicks && !(median_px < NO_FIT_PX * image_size.scale_from_1920()) {
        return Err(BaseError::NoFit { median_px });
    }
    // The 1-σ along the worst direction is the root of the largest eigenvalue. It is that of the
    // adjustment: the jackknife, which may have raised the base's sigma, is rough with few clicks.
    let known = adjusted.position_covariance.iter().all(|x| x.is_finite());
    let sigma_m = if known {
        adjusted
            .position_covariance
            .symmetric_eigenvalues()
            .max()
            .max(0.0)
            .sqrt()
    } else {
        f64::INFINITY
    };
    if !(sigma_m < MAX_POSITION_SIGMA_M) {
        return Err(BaseError::Undetermined { sigma_m });
    }
    if base.position_m.z <= 0.0 {
        return Err(BaseError::BelowGround {
            depth_m: base.position_m.z.abs(),
        });
    }

    // The clicks of a mirrored frame all disagree for one reason; only the frame is reported.
    let mirrored = mirrored_frames(&base, frames, ptz, image_size);
    let noise_scale = adjusted.noise_scale.sqrt();
    let mut disputed = disputed_clicks(&base, field, frames, ptz, noise_scale);
    disputed.retain(|click| mirrored.iter().all(|frame| frame.frame != click.frame));
    let frame_fits = frames
        .iter()
        .zip(ptz)
        .map(|(frame, ptz)| frame_fit(&base, frame, (*ptz)?))
        .collect();
    Ok(BaseEstimate {
        base,
        crown_m: adjusted.crown_m,
        model,
        reason,
        scores,
        position_covariance: base.sigma.position_covariance(),
        frames: frame_fits,
        median_px,
        p90_px: quantile_or_infinite(&errors, 0.9),
        previous_median_px: None,
        one_more_frame: None,
        pixel_aspect: None,
        disputed,
        mirrored,
    })
}

/// A quantile of errors in ascending order; infinite without any.
fn quantile_or_infinite(ascending: &[f64], share: f64) -> f64 {
    if ascending.is_empty() {
        f64::INFINITY
    } else {
        quantile(ascending, share)
    }
}

/// How a frame with a camera fits a base; none without clicks, or if most have no image.
pub(super) fn frame_fit(base: &CameraBase, frame: &FrameClicks, ptz: Ptz) -> Option<FrameFit> {
    let mut errors = distances(base, std::slice::from_ref(frame), &[Some(ptz)]);
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    let rms_px = (squares / errors.len() as f64).sqrt();
    Some(FrameFit {
        ptz,
        median_px: median(&mut errors).filter(|median_px| median_px.is_finite())?,
        rms_px,
    })
}

/// The distances of all clicks of solved frames, px, in order; infinite where one has no image.
pub(super) fn distances(
    base: &CameraBase,
    frames: &[FrameClicks],
    ptz: &[Option<Ptz>],
) -> Vec<f64> {
    let mut found = Vec::new();
    for (frame, ptz) in frames.iter().zip(ptz) {
        let Some(ptz) = ptz else { continue };
        let camera = PtzCamera::new(*base, *ptz);
        found.extend(
            frame
                .used_clicks()
                .map(|click| click.distance_px_or_infinite(&camera)),
        );
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::BaseSigma;
    use crate::geometry::Vec3;
    use crate::solve::Observation;
    use crate::solve::base::{CrownModel, LensModel};
    use crate::solve::fixtures;
    use crate::testing::{SIZE, soccer};

    fn ptz() -> Ptz {
        Ptz::from_degrees(0.0, -12.0, 1500.0)
    }

    /// Clicks exactly where a camera shows these points of the ground, and `behind` more that lie
    /// behind it.
    fn frame(base: &CameraBase, seen: &[[f64; 2]], behind: usize) -> FrameClicks {
        let camera = PtzCamera::new(*base, ptz());
        let clicks = seen.iter().map(|[x, y]| {
            let at = Vec3::new(*x, *y, 0.0);
            Observation::from_point(at, camera.image_from_world(at).unwrap(), 2.0, 0)
        });
        let at = Vec3::new(3.0, -150.0, 0.0);
        let unseen = Observation::from_point(at, SIZE.centre(), 2.0, 0);
        FrameClicks {
            observations: clicks.chain(std::iter::repeat_n(unseen, behind)).collect(),
            start: None,
        }
    }

    const SEEN: [[f64; 2]; 4] = [[0.0, 0.0], [12.0, 8.0], [-14.0, 5.0], [2.0, 30.0]];

    /// The summary of a base by one frame of exact clicks.
    fn summary_of(base: &CameraBase) -> Result<BaseEstimate, BaseError> {
        let fit = ChosenFit {
            adjusted: AdjustedBase {
                base: *base,
                crown_m: 0.0,
                ptz: vec![Some(ptz())],
                position_covariance: Mat3::identity() * 0.01,
                noise_scale: 1.0,
                cost: 0.0,
                iterations: 1,
            },
            model: BaseModel {
                lens: LensModel::K1FocalK2,
                crown: CrownModel::Fixed(0.0),
                principal_point: None,
            },
            reason: ModelReason::Prescribed,
            scores: Vec::new(),
        };
        let field = soccer();
        let frames = [frame(base, &SEEN, 0)];
        summary(fit, &field, &frames, &[Some(ptz())], SIZE)
    }

    #[test]
    fn clicks_without_an_image_count_as_infinitely_far() {
        let base = fixtures::base();
        let one_of_five = frame(&base, &SEEN, 1);
        let found = distances(&base, std::slice::from_ref(&one_of_five), &[Some(ptz())]);
        assert_eq!((found.len(), found[4]), (5, f64::INFINITY));
        let fit = frame_fit(&base, &one_of_five, ptz()).unwrap();
        assert!(fit.median_px < 1e-6 && fit.rms_px == f64::INFINITY);
        assert_eq!(frame_fit(&base, &frame(&base, &SEEN, 5), ptz()), None);
    }

    #[test]
    fn the_covariance_of_the_position_is_that_of_the_stated_sigma() {
        let sigma = BaseSigma {
            position_m: Vec3::new(1.0, 2.0, 0.5),
            ..BaseSigma::default()
        };
        let base = CameraBase {
            sigma,
            ..fixtures::base()
        };
        let found = summary_of(&base).unwrap();
        let expected = Mat3::from_diagonal(&Vec3::new(1.0, 4.0, 0.25));
        assert!(
            (found.position_covariance - expected).amax() < 1e-12,
            "{}",
            found.position_covariance
        );
    }

    #[test]
    fn messages_say_no_infinite_distance_and_one_frame() {
        let unseen = BaseError::NoFit {
            median_px: f64::INFINITY,
        };
        assert!(
            unseen
                .to_string()
                .starts_with("no camera explains the clicks: the best one does not see them"),
            "{unseen}"
        );
        let single = BaseError::NoStart {
            frames: 1,
            most_landmarks: 1,
        };
        assert!(
            single
                .to_string()
                .contains("(1 frame with clicks, the best has 1 landmark on the ground)"),
            "{single}"
        );
    }

    #[test]
    fn a_camera_on_the_ground_is_not_less_than_nothing_below_it() {
        let mut base = fixtures::base();
        base.position_m.z = 0.0;
        let message = summary_of(&base).unwrap_err().to_string();
        assert!(message.contains("is 0.0 m below the field"), "{message}");
    }
}
