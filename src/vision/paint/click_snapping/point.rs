//! Click snapping: moves a placed point to the painted corner, crossing or point marking that it
//! names, where that is certain.
//!
//! # Method
//!
//! 1. The lines that meet at the landmark are predicted by a camera and moved so that the landmark
//!    lies on the placed point. The camera may be rough: only the directions and the widths of the
//!    lines come from it.
//! 2. Ridges are searched across each line. The offset that most of them agree on is the line's.
//! 3. The crossing of the two lines that meet at the widest angle is the start of a robust
//!    least-squares fit of all lines (`crossing.rs`), whose covariance gives the 1-σ.

use super::crossing::{
    CrossingAtScale, CrossingLine, CrossingState, MOST_LINES, PaintedSample, meeting_point,
    residual_px,
};
use super::spot::snap_spot;
use super::{PointSnapOptions, SnappedPoint, lines_through};
use crate::paint::GroundPicture;
use crate::paint::ridges::profile::Across;
use crate::paint::ridges::ridge::RidgeFinder;
use nalgebra::Matrix2;
use touchline_core::camera::PtzCamera;
use touchline_core::field::{FieldModel, Landmark};
use touchline_core::geometry::{ImagePoint, Vec2};
use touchline_core::markings::{LineSample, SampleOptions, sample_lines};
use touchline_core::solve::{Problem, gauss_newton_step};

/// Distance from the landmark up to which its lines are searched, px at 1920 px width.
const FOLLOWED_PX: f64 = 90.0;

/// Distance between the samples of a line, px at 1920 px width.
const SPACING_PX: f64 = 4.0;

/// Distance between the samples of a profile across a line, px.
const STEP_PX: f64 = 0.5;

/// No samples are taken nearer to the landmark than this plus half the line's width, px at 1920 px
/// width: there the lines run into each other.
const CLEAR_PX: f64 = 6.0;

/// Minimum number of samples with paint for a line to be found.
const MIN_SAMPLES: usize = 6;

/// Minimum share of a line's open samples that have paint at the common offset.
const SEEN_SHARE: f64 = 0.75;

/// A line is ambiguous if another offset has this share of the best one's votes.
const AS_GOOD: f64 = 0.6;

/// Offsets nearer to each other than this count as one, px at 1920 px width.
const SAME_PX: f64 = 4.0;

/// A ridge votes for an offset within this distance, px at 1920 px width, plus [`WITHIN_SLOPE`] per
/// px along the line, because the predicted direction may be a few degrees off.
const WITHIN_PX: f64 = 1.5;
const WITHIN_SLOPE: f64 = 0.04;

/// Scales of the robust loss, one for each Gauss–Newton step, px at 1920 px width. Ridges farther
/// away belong to another line.
const SCALES_PX: [f64; 4] = [3.0, 2.0, 1.2, 1.2];

/// Moves a placed point to the corner or crossing of painted lines, or to the point marking, that a
/// landmark names.
///
/// None if the landmark is neither, if fewer than two of its lines or no marking is seen near by,
/// or if it is ambiguous which ones are meant.
///
/// `camera` need not be exact: the directions of its lines may be a few degrees off, and its
/// position in the picture does not matter.
pub fn snap_point(
    ground: &GroundPicture,
    field: &FieldModel,
    camera: &PtzCamera,
    landmark: &Landmark,
    placed: ImagePoint,
    options: &PointSnapOptions,
) -> Option<SnappedPoint> {
    if landmark.spot_diameter_m.is_some() {
        return snap_spot(ground, field, camera, landmark, placed, options);
    }
    let scale = ground.size().scale_from_1920();
    let predicted = camera
        .image_from_world(field.landmark_in_world(landmark))
        .ok()?;
    let lines = lines_through(field, landmark);
    if lines.len() < 2 || lines.len() > MOST_LINES || ground.is_masked(placed) {
        return None;
    }
    let crossing = Crossing {
        ground,
        predicted,
        by: placed.offset_from(predicted),
        scale,
        reach_px: options.reach_px * scale,
    };
    // Steps 1 and 2: all lines must be found, or the crossing would be of other lines.
    let samples = sample_lines(
        field,
        camera,
        ground.size(),
        &SampleOptions {
            spacing_px: SPACING_PX * scale,
            border_px: 0.0,
        },
    );
    let mut finder = RidgeFinder::default();
    let mut courses = Vec::with_capacity(lines.len());
    for line in lines {
        let of_line = samples.iter().filter(|sample| sample.line == line);
        courses.push(crossing.course(of_line, &mut finder)?);
    }
    // Step 3. The 1-σ is the root mean square of the two axes. If it is NaN, the comparisons fail.
    let (shift, covariance) = crossing.solve(&courses)?;
    let sigma_px = (covariance.trace() / 2.0).sqrt();
    let certain = shift.norm() <= crossing.reach_px && sigma_px <= options.max_sigma_px * scale;
    certain.then(|| SnappedPoint {
        image: placed.translate(shift),
        sigma_px,
    })
}

/// The neighbourhood of a placed point.
struct Crossing<'a> {
    ground: &'a GroundPicture,
    /// The landmark as the camera predicts it, px.
    predicted: ImagePoint,
    /// From there to the placed point, px.
    by: Vec2,
    /// Width of the picture by 1920 px.
    scale: f64,
    reach_px: f64,
}

impl Crossing<'_> {
    /// Searches for one line. None if it is not seen or its offset is ambiguous.
    fn course<'s>(
        &self,
        samples: impl Iterator<Item = &'s LineSample>,
        finder: &mut RidgeFinder,
    ) -> Option<CrossingLine> {
        let mut near: Vec<(f64, &LineSample)> = samples
            .map(|sample| (sample.image.distance_px(self.predicted), sample))
            .filter(|(distance_px, _)| *distance_px <= FOLLOWED_PX * self.scale)
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        // The direction of the line where it meets the landmark; of a circle, its tangent.
        let normal = near.first()?.1.normal;
        let direction = Vec2::new(-normal.y, normal.x);
        let mut course = CrossingLine {
            places: Vec::new(),
            open: 0,
            offset_px: 0.0,
            normal,
        };
        for (distance_px, sample) in near {
            let clear_px = CLEAR_PX * self.scale + 0.5 * sample.width_px;
            // The predicted line, moved to the placed point.
            let across = Across {
                at: sample.image.translate(self.by),
                ..Across::from(sample)
            };
            if distance_px < clear_px || self.ground.is_masked(across.at) {
                continue;
            }
            let mut ridges = Vec::new();
            finder.find(self.ground, &across, self.reach_px, STEP_PX, &mut ridges);
            // Open: there is paint, or ground where paint should be. Players and boards are
            // neither.
            course.open += usize::from(!ridges.is_empty() || self.ground.is_ground(across.at));
            if !ridges.is_empty() {
                let along_px = direction.dot(&sample.image.offset_from(self.predicted));
                course.places.push(PaintedSample {
                    normal: sample.normal,
                    along_px,
                    ridges,
                });
            }
        }
        course.offset_px = self.likely_offset_px(&course)?;
        Some(course)
    }

    /// The offset at the landmark that most samples of a line vote for. None if too few do, or if
    /// another offset has nearly as many votes.
    fn likely_offset_px(&self, course: &CrossingLine) -> Option<f64> {
        // Every ridge proposes its own offset; exhaustive, so that no ridge is missed by chance. A
        // line has up to 45 samples, so that the square of their number is small.
        let ridges = course.places.iter().flat_map(|place| &place.ridges);
        let counted: Vec<(f64, usize)> = ridges
            .map(|ridge| (ridge.offset_px, self.votes(course, ridge.offset_px)))
            .collect();
        let (_, most) = *counted.iter().max_by_key(|(_, count)| *count)?;
        // Several proposals may have equally many votes; their mean is taken.
        let best: Vec<f64> = counted
            .iter()
            .filter(|(_, count)| *count == most)
            .map(|(offset_px, _)| *offset_px)
            .collect();
        let offset_px = best.iter().sum::<f64>() / best.len() as f64;
        // The runner-up is the best proposal that is not the same line.
        let elsewhere = counted
            .iter()
            .filter(|(other_px, _)| (other_px - offset_px).abs() > SAME_PX * self.scale);
        let second = elsewhere.map(|(_, count)| *count).max().unwrap_or(0);
        let seen = most >= MIN_SAMPLES && most as f64 >= SEEN_SHARE * course.open as f64;
        (seen && (second as f64) < AS_GOOD * most as f64).then_some(offset_px)
    }

    /// Number of samples of a line with a ridge at an offset. The tolerance grows along the line,
    /// because its direction is not exact.
    fn votes(&self, course: &CrossingLine, offset_px: f64) -> usize {
        let votes = course.places.iter().filter(|place| {
            let within_px = WITHIN_PX * self.scale + WITHIN_SLOPE * place.along_px.abs();
            CrossingLine::nearest(place, offset_px)
                .is_some_and(|nearest| (nearest - offset_px).abs() <= within_px)
        });
        votes.count()
    }

    /// The landmark's shift from the placed point, px, on which the ridges of all lines agree, and
    /// its covariance, px². None if the lines do not cross or their ridges do not agree.
    fn solve(&self, courses: &[CrossingLine]) -> Option<(Vec2, Matrix2<f64>)> {
        // Rotations and offsets of the lines start at zero, the shift at the crossing.
        let mut state = CrossingState::zeros();
        state
            .fixed_rows_mut::<2>(0)
            .copy_from(&meeting_point(courses)?);
        for scale_px in SCALES_PX {
            state =
                gauss_newton_step(&CrossingAtScale::new(courses, scale_px, self.scale), &state)?;
        }
        let shift = state.fixed_rows::<2>(0).into_owned();
        // Each line must keep enough ridges at the solution, not only in the vote. There the
        // rotation of the line is solved for, and the tolerance does not grow along it.
        for (line, course) in courses.iter().enumerate() {
            let agreeing = course
                .places
                .iter()
                .filter_map(|place| residual_px(place, line, &state))
                .filter(|residual| residual.abs() <= WITHIN_PX * self.scale)
                .count();
            if agreeing < MIN_SAMPLES || (agreeing as f64) < SEEN_SHARE * course.open as f64 {
                return None;
            }
        }
        // Covariance: the shift's block of the inverse normal matrix, which marginalises over the
        // rotations and offsets of the lines.
        let equations = CrossingAtScale::new(courses, SCALES_PX[SCALES_PX.len() - 1], self.scale)
            .equations(&state);
        let covariance = equations
            .own
            .try_inverse()?
            .fixed_view::<2, 2>(0, 0)
            .into_owned();
        Some((shift, covariance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::drawn::{PICTURE, camera, draw_field, soccer, truth};
    use touchline_core::camera::{CameraBase, FocalCurve};
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::TestBase;

    fn snapped(camera: &PtzCamera, landmark: &str, off_px: Vec2) -> Option<(SnappedPoint, f64)> {
        let field = soccer();
        let landmark = field.landmark(landmark).unwrap();
        let exact = truth()
            .image_from_world(field.landmark_in_world(landmark))
            .unwrap();
        let ground = GroundPicture::new(&PICTURE, &[]);
        let found = snap_point(
            &ground,
            &field,
            camera,
            landmark,
            exact.translate(off_px),
            &PointSnapOptions::default(),
        )?;
        Some((found, found.image.distance_px(exact)))
    }

    const CROSSINGS: [&str; 3] = [
        "centre_circle_halfway_near",
        "centre_circle_halfway_far",
        "halfway_far",
    ];

    #[test]
    fn a_point_beside_a_crossing_goes_to_it() {
        for landmark in CROSSINGS {
            for off_px in [
                Vec2::zeros(),
                Vec2::new(3.0, -2.0),
                Vec2::new(-5.0, 1.5),
                Vec2::new(1.0, 4.0),
            ] {
                let (found, error_px) = snapped(&truth(), landmark, off_px).unwrap();
                assert!(
                    error_px < 0.4,
                    "{landmark} from {off_px:?}: {error_px} px, {found:?}"
                );
                assert!((0.05..1.0).contains(&found.sigma_px), "{found:?}");
            }
        }
    }

    #[test]
    fn corners_in_a_small_picture_are_where_the_lines_meet_and_on_average_right_there() {
        let (field, size) = (soccer(), ImageSize::new(640, 360));
        let base = CameraBase {
            principal_point: size.centre(),
            distortion: FocalCurve::NONE,
            ..*truth().base()
        };
        let camera = base.aim(38.0, -14.0, 900.0);
        let picture = draw_field(&field, &camera, size);
        let ground = GroundPicture::new(&picture, &[]);
        let mut off_px = Vec::new();
        for landmark in field
            .landmarks
            .iter()
            .filter(|landmark| landmark.id.as_str().contains("_area_"))
        {
            let exact = camera
                .image_from_world(field.landmark_in_world(landmark))
                .unwrap();
            for placed in [Vec2::zeros(), Vec2::new(1.5, -1.0), Vec2::new(-1.0, 1.5)]
                .map(|by| exact.translate(by))
            {
                let found = snap_point(
                    &ground,
                    &field,
                    &camera,
                    landmark,
                    placed,
                    &PointSnapOptions::default(),
                );
                off_px.extend(found.map(|found| found.image.offset_from(exact)));
            }
        }
        assert!(off_px.len() >= 20, "{off_px:?}");
        assert!(off_px.iter().all(|off| off.norm() < 0.4), "{off_px:?}");
        // A pixel's middle taken for its corner would show here.
        let mean = off_px.iter().sum::<Vec2>() / off_px.len() as f64;
        assert!(mean.norm() < 0.1, "{mean:?}");
    }

    #[test]
    fn a_rough_camera_is_enough() {
        // 150 px off, turned and zoomed.
        for rough in [
            camera(9.0, -12.5, 1500.0),
            camera(2.0, -15.0, 1620.0),
            camera(4.0, -14.0, 1380.0),
        ] {
            for landmark in CROSSINGS {
                if let Some((found, error_px)) = snapped(&rough, landmark, Vec2::new(2.0, -3.0)) {
                    assert!(error_px < 1.0, "{landmark}: {error_px} px, {found:?}");
                }
            }
            assert!(
                snapped(&rough, "centre_circle_halfway_near", Vec2::new(2.0, -3.0)).is_some(),
                "{:?}",
                rough.ptz()
            );
        }
    }

    #[test]
    fn what_is_no_crossing_or_is_too_far_off_stays() {
        for landmark in ["centre_circle_left", "post_near_right_top"] {
            assert_eq!(
                snapped(&truth(), landmark, Vec2::new(2.0, 1.0)),
                None,
                "{landmark}"
            );
        }
        for off_px in [
            Vec2::new(60.0, 0.0),
            Vec2::new(0.0, 45.0),
            Vec2::new(-30.0, 30.0),
        ] {
            assert_eq!(snapped(&truth(), "halfway_far", off_px), None, "{off_px:?}");
        }
    }
}
