//! Frames that match none of a camera's frames may be that camera's all the same, turned to where
//! none of the others shows. The search from them then ends at the same place.

use crate::calibrate::{AutocalibratedCamera, AutocalibratedFrame, ptz_on_base};
use std::f64::consts::TAU;
use touchline_core::camera::{CameraBase, PtzCamera};
use touchline_core::geometry::{ImageSize, Mat3, Vec3, median};
use touchline_core::solve::base::FittedSize;

/// The largest squared distance of two estimates of one position by their joint covariance: 99.7 %
/// of χ² with three degrees of freedom.
const MAX_DISTANCE_SQUARED: f64 = 14.2;
/// The largest difference of two estimates of one length of the field, joint σ.
const MAX_SIZE_SIGMAS: f64 = 3.0;

/// How the main cameras of different stadiums scatter, 1-σ, m: along the touchline, away from it,
/// and in height. From four broadcasts.
const SPREAD_M: [f64; 3] = [1.0, 10.0, 4.0];
/// The largest probability that the camera of another stadium agrees by chance. Estimates that are
/// too uncertain to tell two stadiums apart join none.
const MAX_CHANCE: f64 = 0.01;

/// How far the ground may move in a frame that goes to the other estimate's base, px at 1920 px
/// width: the median over the ground that it shows, and over the frames. Estimates of one camera
/// from its left and its right views differ by several px in the corners, as their lenses do.
const MAX_MOVED_PX: f64 = 3.0;

/// A camera whose frames are given to the base of another estimate of the same camera; none if the
/// two are not certain to stand at one place.
pub(super) fn join_same(
    known: &AutocalibratedCamera,
    found: &AutocalibratedCamera,
    image_size: impl Fn(usize) -> ImageSize,
) -> Option<AutocalibratedCamera> {
    if !is_same_place(known, found) || !have_same_sizes(&known.sizes, &found.sizes) {
        return None;
    }
    // A frame that shows no ground cannot be compared, and is found again by tracking.
    let moved = found.frames.iter().filter_map(|frame| {
        let size = image_size(frame.index);
        move_frame(frame, &found.base, &known.base, size)
    });
    let (frames, mut moved_px): (Vec<_>, Vec<_>) = moved.unzip();
    (median(&mut moved_px)? <= MAX_MOVED_PX).then(|| AutocalibratedCamera {
        frames,
        ..known.clone()
    })
}

/// A frame on another base, and how far its ground moves, px at 1920 px width.
fn move_frame(
    frame: &AutocalibratedFrame,
    from: &CameraBase,
    to: &CameraBase,
    size: ImageSize,
) -> Option<(AutocalibratedFrame, f64)> {
    let mut moved = frame.clone();
    let on_base = ptz_on_base(&PtzCamera::new(*from, frame.ptz), to, size)?;
    moved.ptz = on_base.ptz;
    if let Some(of_picture) = &mut moved.snapped {
        of_picture.ptz = ptz_on_base(&PtzCamera::new(*from, of_picture.ptz), to, size)?.ptz;
    }
    Some((moved, on_base.moved_px))
}

/// Whether two estimates of a position agree, and so closely that another match's camera would
/// hardly stand there.
fn is_same_place(known: &AutocalibratedCamera, found: &AutocalibratedCamera) -> bool {
    let apart_m = found.base.position_m - known.base.position_m;
    let covariance: Mat3 =
        known.base.sigma.position_covariance() + found.base.sigma.position_covariance();
    let agree = covariance
        .cholesky()
        .is_some_and(|joint| apart_m.dot(&joint.solve(&apart_m)) <= MAX_DISTANCE_SQUARED);
    // The density of other stadiums' cameras around this one, times the volume in which they would
    // agree with it.
    let spread: Vec3 = SPREAD_M.into();
    let density = 1.0 / (TAU.powf(1.5) * spread.product());
    let radius = MAX_DISTANCE_SQUARED.sqrt();
    let volume = 2.0 / 3.0 * TAU * radius.powi(3) * covariance.determinant().sqrt();
    agree && density * volume <= MAX_CHANCE
}

/// Whether the lengths of the field that both have fitted agree.
fn have_same_sizes(known: &[FittedSize], found: &[FittedSize]) -> bool {
    let pairs = found.iter().filter_map(|size| {
        let other = known.iter().find(|other| other.name == size.name)?;
        (!size.is_open && !other.is_open).then_some((size, other))
    });
    pairs.into_iter().all(|(size, other)| {
        let sigma_m = size.error.sigma_m.hypot(other.error.sigma_m);
        (size.value_m - other.value_m).abs() <= MAX_SIZE_SIGMAS * sigma_m
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::AutocalibrationEvidence;
    use touchline_core::camera::{BaseSigma, Ptz, SizeError};
    use touchline_core::testing::{SIZE, soccer, turned_base};

    /// A camera at a place, with its 1-σ along each axis, and frames at these pans.
    fn camera(position_m: [f64; 3], sigma_m: [f64; 3], pans_deg: &[f64]) -> AutocalibratedCamera {
        let mut base = turned_base(position_m, [0.0; 3], SIZE);
        base.sigma = BaseSigma {
            position_m: sigma_m.into(),
            ..BaseSigma::default()
        };
        let frame = |(index, pan_deg): (usize, &f64)| AutocalibratedFrame {
            index,
            ptz: Ptz::from_degrees(*pan_deg, -12.0, 2000.0),
            uncertainty: None,
            snapped: None,
            unaligned_score: None,
        };
        AutocalibratedCamera {
            base,
            field: soccer(),
            sizes: Vec::new(),
            frames: pans_deg.iter().enumerate().map(frame).collect(),
            others: Vec::new(),
            paint: Vec::new(),
            evidence: AutocalibrationEvidence::default(),
        }
    }

    fn with_length(mut camera: AutocalibratedCamera, value_m: f64) -> AutocalibratedCamera {
        camera.sizes.push(FittedSize {
            name: "length_m".to_owned(),
            assumed_m: 105.0,
            value_m,
            error: SizeError::alone(0.3),
            is_open: false,
        });
        camera
    }

    const CLOSE: [f64; 3] = [0.06, 0.3, 0.07];

    #[test]
    fn frames_to_the_left_and_to_the_right_are_one_cameras() {
        let left = camera([0.0, -70.6, 15.3], CLOSE, &[-30.0, -24.0]);
        let right = camera([0.05, -70.4, 15.35], CLOSE, &[20.0, 27.0]);
        let joined = join_same(&left, &right, |_| SIZE).unwrap();
        assert_eq!(joined.base, left.base);
        assert_eq!(joined.frames.len(), 2);
        for (before, after) in right.frames.iter().zip(&joined.frames) {
            let moved_deg = (after.ptz.pan.degrees() - before.ptz.pan.degrees()).abs();
            assert!(moved_deg < 0.2, "{moved_deg}°");
        }
    }

    #[test]
    fn cameras_of_two_stadiums_stay_apart() {
        let known = camera([0.0, -70.6, 15.3], CLOSE, &[-30.0, -24.0]);
        for [x, y, z] in [[0.5, -70.6, 15.3], [0.0, -73.3, 15.3], [0.0, -70.6, 16.0]] {
            let other = camera([x, y, z], CLOSE, &[-30.0, -24.0]);
            assert!(join_same(&known, &other, |_| SIZE).is_none(), "{x} {y} {z}");
        }
        let vague = camera([0.05, -70.4, 15.35], [0.7, 1.5, 0.5], &[20.0, 27.0]);
        assert!(
            join_same(&known, &vague, |_| SIZE).is_none(),
            "other stadiums have one there, too"
        );
        let [of_known, of_other] = [105.2, 103.6].map(|length_m| {
            let same = camera([0.0, -70.6, 15.3], CLOSE, &[20.0]);
            with_length(same, length_m)
        });
        assert!(join_same(&of_known, &of_other, |_| SIZE).is_none());
        assert!(join_same(&of_known, &of_known, |_| SIZE).is_some());
    }

    #[test]
    fn a_camera_that_leans_another_way_is_another_one() {
        let known = camera([0.0, -70.6, 15.3], CLOSE, &[-30.0, 0.0, 30.0]);
        let mut leaning = known.clone();
        leaning.base = CameraBase {
            sigma: known.base.sigma,
            ..turned_base([0.0, -70.6, 15.3], [0.0, 0.0, 2.0], SIZE)
        };
        assert!(join_same(&known, &leaning, |_| SIZE).is_none());
    }
}
