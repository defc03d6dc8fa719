//! Starts refined to minima, and the lowest of them.

use super::fit::{Fitted, PictureFit, starting_state};
use super::{FromLinesError, FromLinesOptions, LinePicture, starts};
use crate::geometry::{keep_distinct, median};
use crate::solve::initial_cameras::line_pairs::few_per_line;
use crate::solve::initial_cameras::starts::camera_distance;
use crate::solve::observations::crossings;
use crate::solve::observations::drawn_line::DrawnLine;
use crate::solve::{Loss, Observation};

/// The losses of the fit: first wide, so that starts that are off converge; then one under which a
/// line that is twenty sigmas off has little influence.
const FIRST_LOSS: Loss = Loss::Cauchy { c: 6.0 };
pub(super) const FINAL_LOSS: Loss = Loss::Cauchy { c: 4.0 };

/// Steps of the first fit of each start, and of the final one, at most.
const FIRST_STEPS: usize = 12;
const FINAL_STEPS: usize = 60;

/// Minima of the first fit from which the final one begins, at most.
const FINAL_STARTS: usize = 3;

/// Minima nearer to each other than this are one ([`camera_distance`]).
const SAME_MINIMUM: f64 = 0.02;

/// A fitted picture: the observations of the fit, ends of lines included, and its minimum.
pub(super) struct FittedPicture {
    pub lines: Vec<DrawnLine>,
    /// The given observations first, in their order; then the ends of lines. All are on the ground
    /// with the fitted crown.
    pub observations: Vec<Observation>,
    pub found: Fitted,
}

/// The lowest of the minima to which the starts of a picture lead.
///
/// # Errors
/// No start leads to a camera.
pub(super) fn fit_picture(
    picture: &LinePicture<'_>,
    used: &[Observation],
    options: &FromLinesOptions,
) -> Result<FittedPicture, FromLinesError> {
    let lines = DrawnLine::group(used);
    let crossings = crossings::find_crossings(&lines, used);
    let ends = crossings::find_ends(&lines, picture.image_size);

    // A few points of each line bring every start near its minimum.
    let few = [few_per_line(&lines, used), ends.clone()].concat();
    let starts = starts::find_starts(picture, &lines, &crossings, &few, &options.priors);
    let mut first: Vec<Fitted> = Vec::with_capacity(starts.len());
    for start in &starts {
        let from = starting_state(picture, start, options);
        let fit = PictureFit::new(picture, &few, &from, options, FIRST_LOSS);
        first.push(fit.minimum(&from, FIRST_STEPS));
    }
    first.sort_by(|a, b| a.cost.total_cmp(&b.cost));

    // All points decide between the best ones.
    let observations = [used, &ends].concat();
    let distinct = keep_distinct(&first, FINAL_STARTS, |one, other| {
        camera_distance(&one.state.ptz, &other.state.ptz) > SAME_MINIMUM
    });
    let found = distinct
        .into_iter()
        .map(|from| {
            let fit = PictureFit::new(picture, &observations, &from.state, options, FINAL_LOSS);
            fit.minimum(&from.state, FINAL_STEPS)
        })
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
        .ok_or(FromLinesError::NoStart)?;
    // The fit lifts the nominal shapes onto its own crown; from here on the observations are
    // compared with a camera alone, so they are lifted themselves.
    let (from, to) = (picture.field.crown(), found.state.shared.crown);
    let on_fitted_ground = observations.into_iter().map(|observation| Observation {
        shape: observation.shape.change_crown(from, to),
        ..observation
    });
    Ok(FittedPicture {
        lines,
        observations: on_fitted_ground.collect(),
        found,
    })
}

impl FittedPicture {
    /// The median distance of the points from their lines, px; infinite where most of them have no
    /// image.
    pub fn median_px(&self) -> f64 {
        let camera = self.found.state.camera();
        let mut distances_px: Vec<f64> = self
            .observations
            .iter()
            .map(|observation| observation.distance_px_or_infinite(&camera))
            .collect();
        median(&mut distances_px).unwrap_or(f64::INFINITY)
    }

    /// Whether the camera explains at least half of the points, from above the ground.
    ///
    /// # Errors
    /// It does not.
    pub fn check_misfit(&self) -> Result<(), FromLinesError> {
        /// Points farther off are not explained, in their own sigmas: landmarks are clicked more
        /// exactly than lines are drawn.
        const EXPLAINED_SIGMAS: f64 = 12.0;
        let camera = self.found.state.camera();
        let mut sigmas: Vec<f64> = self
            .observations
            .iter()
            .map(|observation| observation.distance_sigmas(&camera))
            .collect();
        let is_explained = median(&mut sigmas).is_some_and(|median| median <= EXPLAINED_SIGMAS);
        if !is_explained {
            return Err(FromLinesError::NoFit {
                median_px: self.median_px(),
            });
        }
        let height_m = camera.base().position_m.z;
        if height_m > 0.0 {
            Ok(())
        } else {
            // On the ground it is 0.0 m below, not -0.0.
            Err(FromLinesError::BelowGround {
                depth_m: height_m.abs(),
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::fit::PictureState;
    use super::*;
    use crate::camera::{CameraBase, Ptz, PtzCamera};
    use crate::field::Crown;
    use crate::geometry::{Vec2, Vec3};
    use crate::solve::base::parameters::Shared;
    use crate::solve::fixtures;

    /// A fit from this height with points that lie this far off and have these sigmas, px.
    fn fitted(height_m: f64, points_px: &[[f64; 2]]) -> FittedPicture {
        let position_m = Vec3::new(3.0, -62.0, height_m);
        let base = CameraBase {
            position_m,
            ..fixtures::base()
        };
        let ptz = Ptz::from_degrees(0.0, 0.0, 1500.0);
        let image = PtzCamera::new(base, ptz)
            .image_from_world(Vec3::zeros())
            .unwrap();
        let observations = points_px.iter().map(|[off_px, sigma_px]| {
            let image = image.translate(Vec2::new(*off_px, 0.0));
            Observation::from_point(Vec3::zeros(), image, *sigma_px, 0)
        });
        let shared = Shared::new(&base, Crown::FLAT);
        FittedPicture {
            lines: Vec::new(),
            observations: observations.collect(),
            found: Fitted {
                state: PictureState { shared, ptz },
                cost: 0.0,
            },
        }
    }

    #[test]
    fn every_point_is_compared_with_its_own_sigma() {
        let mixed = [[5.0, 0.1], [5.0, 2.0], [5.0, 2.0]];
        assert_eq!(fitted(17.0, &mixed).check_misfit(), Ok(()));
        let exact = [[5.0, 2.0], [5.0, 0.1], [5.0, 0.1]];
        assert!(matches!(
            fitted(17.0, &exact).check_misfit(),
            Err(FromLinesError::NoFit { .. })
        ));
    }

    #[test]
    fn a_camera_below_the_ground_is_named_as_that() {
        let below = fitted(-17.0, &[[0.0, 2.0]; 3]).check_misfit();
        assert_eq!(below, Err(FromLinesError::BelowGround { depth_m: 17.0 }));
        let on_ground = fitted(0.0, &[[0.0, 2.0]; 3]).check_misfit().unwrap_err();
        let message = on_ground.to_string();
        assert!(message.contains("is 0.0 m below the field"), "{message}");
    }
}
