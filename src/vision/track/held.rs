//! Tied frames of a camera whose base is known: what each frame's own picture says of its pan, tilt and focal length, and what the
//! ties to its neighbours say, in one adjustment.

use super::Tie;
use super::anchor_residual::Hold;
use super::clip::anchor::by_focal_px;
use super::tie_problem::{Freedom, LENS, Tied, TiedState};
use super::tie_residual::View;
use touchline_core::camera::{CameraBase, PanTilt, Ptz};
use touchline_core::geometry::rotation::{q_pan, q_tilt};
use touchline_core::geometry::{ImageSize, Mat3};
use touchline_core::solve::{Loss, Stopping, minimise};

/// 1-σ of a match, px at 1920 px width: features scatter by one, and crowds, boards and lenses are not quite still.
const MATCH_SIGMA_PX: f64 = 2.0;

/// At most as many matches of a tie take part: their errors are alike.
const OF_TIE: usize = 6;

/// Beyond so many sigmas a match hardly counts: at first the neighbours reach for a frame that has strayed.
const LOSS_SIGMAS: [f64; 3] = [30.0, 8.0, 2.0];

/// A frame as it and its neighbours see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldFrame {
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// The covariance of (pan rad, tilt rad, focal length px), the base taken as exact.
    pub covariance: Mat3,
}

/// Adjusts frames that hang together by ties to what is known of each; none where that leaves one of them open. `start` has the
/// cameras of all frames, `base` their lens.
#[must_use]
pub fn hold_frames(
    base: &CameraBase,
    start: &[Ptz],
    ties: &[Tie],
    known: &[Hold],
    image_size: ImageSize,
) -> Option<Vec<HeldFrame>> {
    let few: Vec<Tie> = ties
        .iter()
        .map(|tie| {
            let every = tie.matches.len().div_ceil(OF_TIE).max(1);
            Tie { matches: tie.matches.iter().step_by(every).copied().collect(), ..tie.clone() }
        })
        .collect();
    let view = |ptz: &Ptz| View {
        cam_from_common: q_tilt(ptz.tilt) * q_pan(ptz.pan),
        focal_px: ptz.focal_px,
        principal_point: base.principal_point,
    };
    let problem = |sigmas| Tied {
        ties: &few,
        freedom: Freedom::PanTilt,
        loss: Loss::Cauchy { c: sigmas },
        px: MATCH_SIGMA_PX * image_size.scale_from_1920(),
        expected: base.distortion,
        sigma: [1e-6, 1e-9],
        fixed_scale: false,
        held: Some(known),
    };
    let start = TiedState { views: start.iter().map(view).collect(), lens: base.distortion };
    let until = Stopping { max_iterations: 10, short_step: 1e-7, small_gain: 1e-6 };
    let [first, later @ ..] = LOSS_SIGMAS;
    let mut found = minimise(&problem(first), start, until);
    for sigmas in later {
        found = minimise(&problem(sigmas), found.state, until);
    }
    let covariance = found.equations.covariance()?;
    let frames = found.state.ptz().into_iter().enumerate().map(|(frame, ptz)| {
        let first = LENS + 3 * frame;
        let of_frame: Mat3 = covariance.fixed_view::<3, 3>(first, first).into_owned();
        HeldFrame { ptz, covariance: by_focal_px(&of_frame, ptz.focal_px) }
    });
    Some(frames.collect())
}

/// Where the frames look from a base, those of which only the turns of the ties are known included; none where no frame's camera
/// is known.
#[must_use]
pub fn filled(known: &[Option<Ptz>], turns: &[Ptz], ties: &[Tie]) -> Option<Vec<Ptz>> {
    let nearest = |frame: usize| {
        let beside = ties.iter().filter_map(|tie| {
            let other = if tie.first == frame { tie.second } else { tie.first };
            let is_of = tie.first == frame || tie.second == frame;
            (is_of && known[other].is_some()).then_some((tie.agreeing, other))
        });
        beside.max().map(|(_, other)| other).or_else(|| known.iter().position(Option::is_some))
    };
    let turn = |ptz: &Ptz| q_tilt(ptz.tilt) * q_pan(ptz.pan);
    (0..known.len())
        .map(|frame| {
            if let Some(ptz) = known[frame] {
                return Some(ptz);
            }
            let beside = nearest(frame)?;
            let there = known[beside]?;
            let base_from_common = turn(&there).transpose() * turn(&turns[beside]);
            let ahead = base_from_common * turn(&turns[frame]).row(2).transpose();
            let PanTilt { pan, tilt } = PanTilt::from_direction(ahead);
            Some(Ptz { pan, tilt, focal_px: turns[frame].focal_px * there.focal_px / turns[beside].focal_px })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::PtzCamera;
    use touchline_core::geometry::{Angle, ImagePoint, Vec3};

    const SIZE: ImageSize = ImageSize::new(1920, 1080);

    fn base() -> CameraBase {
        CameraBase::new(Vec3::zeros(), touchline_core::camera::BaseAngles::default().base_from_world(), SIZE.centre())
    }

    fn truth() -> Vec<Ptz> {
        [(-6.0, -11.0, 2000.0), (2.0, -12.0, 2300.0), (9.0, -10.5, 1900.0)]
            .map(|(pan, tilt, focal)| Ptz::from_degrees(pan, tilt, focal))
            .to_vec()
    }

    fn ties(truth: &[Ptz]) -> Vec<Tie> {
        let tie = |(first, second): (usize, usize)| {
            let [one, other] = [first, second].map(|frame| PtzCamera::new(base(), truth[frame]));
            let grid =
                (0..64).map(|at| ImagePoint::new(f64::from(at % 8) * 240.0 + 120.0, f64::from(at / 8) * 135.0 + 67.0));
            let seen = |at: ImagePoint| {
                let there = other.image_from_ray(one.ray_from_image(at).ok()?).ok()?;
                SIZE.contains(there).then_some((at, there))
            };
            let matches: Vec<_> = grid.filter_map(seen).collect();
            Tie { first, second, agreeing: matches.len(), matches, second_from_first: Mat3::identity() }
        };
        [(0, 1), (1, 2)].map(tie).to_vec()
    }

    fn hold(frame: usize, ptz: Ptz, sigma_deg: f64) -> Hold {
        let turn = sigma_deg.to_radians().powi(-2);
        Hold { frame, ptz, information: Mat3::from_diagonal(&Vec3::new(turn, turn, turn)), loss: Loss::Squared }
    }

    #[test]
    fn a_frame_that_shows_nothing_is_held_by_its_neighbours() {
        let truth = truth();
        let ties = ties(&truth);
        let known = [Some(truth[0]), None, None];
        let turned: Vec<Ptz> =
            truth.iter().map(|ptz| Ptz { pan: ptz.pan + Angle::from_degrees(20.0), ..*ptz }).collect();
        let start = filled(&known, &turned, &ties).unwrap();
        assert!((start[2].pan - truth[2].pan).degrees().abs() < 1e-9);
        let off = Ptz { pan: start[2].pan + Angle::from_degrees(0.5), ..start[2] };
        let held = hold_frames(&base(), &[start[0], start[1], off], &ties, &[hold(0, truth[0], 0.01)], SIZE).unwrap();
        for (held, exact) in held.iter().zip(&truth) {
            assert!((held.ptz.pan - exact.pan).degrees().abs() < 1e-3, "{held:?} for {exact:?}");
            assert!((held.ptz.focal_px / exact.focal_px - 1.0).abs() < 1e-3, "{held:?} for {exact:?}");
        }
        // The farther from what is known, the less certain.
        assert!(held[2].covariance[(0, 0)] > held[1].covariance[(0, 0)]);
        assert!(held[1].covariance[(0, 0)] > held[0].covariance[(0, 0)]);
    }

    #[test]
    fn what_nothing_holds_is_refused() {
        let truth = truth();
        assert!(hold_frames(&base(), &truth, &ties(&truth)[..1], &[hold(0, truth[0], 0.01)], SIZE).is_none());
        assert!(filled(&[None, None, None], &truth, &[]).is_none());
    }
}
