//! The paint of frames, assigned to the lines that their cameras see nearest to it: the
//! observations of the joint adjustment.
//!
//! Paint that is too bright for the line beside it is left out ([`BrightMarkings`]).
//!
//! The assignment is made with the cameras of the moment and repeated as they get better. In
//! between it can be moved to a field of another size or crown, measured, and summed up as one pose
//! prior per frame.

use crate::autocalibrate::frames::matched_frames::FramePaint;
use crate::autocalibrate::search::bright_markings::{BrightMarkings, MarkingAtLine};
use crate::autocalibrate::search::pitch_map::PitchMap;
use crate::autocalibrate::search::pose::paint_certainty;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, subsample};
use touchline_core::markings::ProjectedLine;
use touchline_core::solve::base::FrameClicks;
use touchline_core::solve::{BlockEquations, Loss, Observation};
use touchline_vision::track::{PosePrior, PriorSource};

/// 1-σ of a point on the centre of a stroke, px at 1920 px width. It includes the error that
/// neighbouring points have in common.
pub const SIGMA_PX: f64 = 1.5;

/// Maximum number of paint points per line and frame: long lines would otherwise outweigh short
/// ones.
const OF_LINE: usize = 20;

/// The robust loss of the paint in a pose prior: paint hardly counts beyond 2 σ.
const PAINT_LOSS: Loss = Loss::Cauchy { c: 2.0 };

/// The lines that paint is assigned to, and how far from them it may lie.
pub struct LineAssignment<'a> {
    pub field: &'a FieldModel,
    pub map: &'a PitchMap,
    /// Paint farther than this from every line is left out, px at 1920 px width.
    pub reach_px: f64,
    /// Pixels of the frames per pixel at 1920 px width.
    pub scale: f64,
}

/// A point of paint with the line that it is assigned to.
struct AssignedPaint {
    /// Index of the point in the paint of its frame.
    place: usize,
    image: ImagePoint,
    marking: MarkingAtLine,
}

impl LineAssignment<'_> {
    /// The paint of each frame that lies near lines; nothing for frames without a camera.
    pub fn clicks_of_frames(
        &self,
        paint: &[FramePaint],
        base: &CameraBase,
        ptz: &[Option<Ptz>],
    ) -> Vec<FrameClicks> {
        let near_lines = |(paint, ptz): (&FramePaint, &Option<Ptz>)| match ptz {
            Some(ptz) => self.assign(paint, &PtzCamera::new(*base, *ptz)),
            None => Vec::new(),
        };
        // What is too bright is decided by all frames: one may show far lines alone.
        let assigned: Vec<Vec<AssignedPaint>> = paint.iter().zip(ptz).map(near_lines).collect();
        let markings = assigned.iter().flatten().map(|paint| paint.marking);
        let bright = BrightMarkings::measure(self.field.lines.len(), markings);
        let is_line = |paint: &&AssignedPaint| !bright.contain(paint.marking);
        let clicks = assigned.iter().map(|of_frame| FrameClicks {
            observations: self.observations(of_frame.iter().filter(is_line)),
            start: None,
        });
        clicks.collect()
    }

    /// Assigns each point of paint to the line that the camera sees nearest to it, if within reach.
    fn assign(&self, paint: &FramePaint, camera: &PtzCamera) -> Vec<AssignedPaint> {
        let eye_m = camera.base().position_m;
        let mut assigned = Vec::new();
        for (place, point) in paint.iter().enumerate() {
            let image = point.at;
            let ground = self.map.ground(|z_m| camera.plane_from_image(image, z_m));
            let Some(near) = ground.and_then(|ground| self.map.nearest(ground, eye_m)) else {
                continue;
            };
            // The nearest line is found by angle from the camera; the gate is in pixels, the unit
            // of the adjustment.
            let Some(seen) = ProjectedLine::new(camera, near.at, near.tangent) else {
                continue;
            };
            if seen.distance_px(image) > self.reach_px * self.scale {
                continue;
            }
            assigned.push(AssignedPaint {
                place,
                image,
                marking: MarkingAtLine {
                    line: near.line,
                    contrast_px: point.contrast_px,
                    width_px: seen.width_px(self.field.lines[near.line].width_m),
                },
            });
        }
        assigned
    }

    /// The observations of some assigned paint of a frame; at most [`OF_LINE`] per line, evenly
    /// subsampled.
    fn observations<'p>(
        &self,
        of_frame: impl Iterator<Item = &'p AssignedPaint>,
    ) -> Vec<Observation> {
        let mut of_line: Vec<Vec<Observation>> = vec![Vec::new(); self.field.lines.len()];
        for paint in of_frame {
            of_line[paint.marking.line].extend(Observation::from_paint(
                self.field,
                paint.marking.line,
                paint.image,
                SIGMA_PX * self.scale / paint_certainty(paint.marking.width_px).sqrt(),
                paint.place,
            ));
        }
        of_line
            .into_iter()
            .flat_map(|places| subsample(places, OF_LINE))
            .collect()
    }
}

/// Moves the assigned paint to the same lines of a field with another crown or size.
pub fn move_to_field(mut taken: Vec<FrameClicks>, field: &FieldModel) -> Vec<FrameClicks> {
    for frame in &mut taken {
        frame.observations = frame
            .observations
            .iter()
            .filter_map(|seen| seen.with_element(field, seen.element?))
            .collect();
    }
    taken
}

/// The distances of a frame's assigned paint from its lines, px; none without a camera.
pub fn distances_px(taken: &FrameClicks, base: &CameraBase, ptz: Option<Ptz>) -> Vec<f64> {
    let Some(ptz) = ptz else {
        return Vec::new();
    };
    let camera = PtzCamera::new(*base, ptz);
    taken
        .observations
        .iter()
        .filter_map(|seen| seen.distance_px(&camera))
        .collect()
}

/// The pose prior of each frame with a camera from its own assigned paint.
pub fn paint_priors(
    base: &CameraBase,
    ptz: &[Option<Ptz>],
    taken: &[FrameClicks],
) -> Vec<PosePrior> {
    ptz.iter()
        .zip(taken)
        .enumerate()
        .filter_map(|(frame, (ptz, taken))| Some(paint_prior(frame, taken, base, (*ptz)?)))
        .collect()
}

/// The pose prior of a frame from its assigned paint: the normal equations of (pan, tilt, log f) at
/// its camera.
fn paint_prior(frame: usize, taken: &FrameClicks, base: &CameraBase, ptz: Ptz) -> PosePrior {
    let camera = PtzCamera::new(*base, ptz);
    let mut equations = BlockEquations::<0, 3>::zero();
    for seen in &taken.observations {
        equations.add(seen, &camera, PAINT_LOSS);
    }
    PosePrior::new(frame, ptz, equations.own, PriorSource::Paint)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autocalibrate::rotating_camera::{IMAGE_SIZE, base, paint, ptz, soccer};
    use touchline_core::field::FieldElement;
    use touchline_core::geometry::Vec3;

    #[test]
    fn paint_beside_a_line_that_is_hardly_seen_counts_less() {
        let (field, ptz) = (soccer().assumed, ptz()[3]);
        let scale = IMAGE_SIZE.scale_from_1920();
        let lines = LineAssignment {
            field: &field,
            map: &PitchMap::with_grid(&field),
            reach_px: 4.0,
            scale,
        };
        let taken = lines.clicks_of_frames(&[paint(&field, ptz)], &base(), &[Some(ptz)]);
        let [taken] = taken.as_slice() else {
            panic!("{} frames", taken.len());
        };
        let wide_px = SIGMA_PX * scale;
        let is_wide = |seen: &&Observation| seen.sigma_px < wide_px + 1e-9;
        assert!(taken.observations.iter().filter(is_wide).count() > 10);

        // The far touchline is 97 m away and 0.18 px wide.
        let far = field
            .lines
            .iter()
            .position(|line| line.id.as_str() == "touchline_far");
        let of_far = FieldElement::Paint(far.unwrap());
        let of_far: Vec<&Observation> = taken
            .observations
            .iter()
            .filter(|seen| seen.element == Some(of_far))
            .collect();
        assert!(of_far.len() > 10);
        for seen in of_far {
            let times = seen.sigma_px / wide_px;
            assert!((3.5..5.5).contains(&times), "{times}");
        }
    }

    #[test]
    fn paint_that_is_too_bright_for_its_line_is_left_out() {
        let (field, ptz) = (soccer().assumed, ptz()[3]);
        let camera = PtzCamera::new(base(), ptz);
        let far = FieldElement::Paint(
            field
                .lines
                .iter()
                .position(|line| line.id.as_str() == "touchline_far")
                .unwrap(),
        );
        let lines = LineAssignment {
            field: &field,
            map: &PitchMap::with_grid(&field),
            reach_px: 8.0,
            scale: IMAGE_SIZE.scale_from_1920(),
        };
        // Every marking has the contrast of a line 0.12 m wide at 60 m, as the nearer lines have.
        // The far touchline is 97 m away.
        let num_of_far = |contrast_px: f64| {
            let mut shown = paint(&field, ptz);
            for point in &mut shown {
                let ground = camera.plane_from_image(point.at, 0.0).unwrap();
                let is_far = ground.y > 0.5 * field.width_m - 1.0;
                point.contrast_px = Some(if is_far { contrast_px } else { 100.0 });
            }
            let taken = lines.clicks_of_frames(&[shown], &base(), &[Some(ptz)]);
            let of_frame = taken[0].observations.iter();
            of_frame.filter(|seen| seen.element == Some(far)).count()
        };
        assert!(num_of_far(20.0) > 10);
        assert_eq!(num_of_far(400.0), 0);
    }

    #[test]
    fn a_line_has_the_width_of_its_edges_and_points_beside_it_their_distance() {
        let (field, camera) = (soccer().assumed, PtzCamera::new(base(), ptz()[2]));
        for line in PitchMap::without_grid(&field).samples(5.0) {
            let paint_m = field.lines[line.line].width_m;
            let Some(seen) = ProjectedLine::new(&camera, line.at, line.tangent) else {
                continue;
            };
            let across = Vec3::new(-line.tangent.y, line.tangent.x, 0.0).normalize();
            let edge = camera.image_from_world(line.at + across * (0.5 * paint_m));
            // Perspective makes the nearer half of the paint a little wider.
            let half_px = seen.distance_px(edge.unwrap());
            let width_px = seen.width_px(paint_m);
            assert!((half_px - 0.5 * width_px).abs() <= 0.01 * width_px + 1e-9);
        }
    }
}
