//! Where the transforms of a sample put its camera: a dolly, a crane, its arm, its head.
//!
//! Each transform is translation, rotation, scale in the axes of the one before. The scale of one
//! moves what stands on it. That of the last one is the size of the camera's model and changes
//! nothing that the camera sees. A scale that is the same along all axes leaves rotations what they
//! are; another one shears what is turned on it, and then no camera of square pixels shows the same
//! picture: how far the nearest one is off decides.

use super::lens_law::Screen;
use crate::exchange::cameras::body_angles::{cam_from_world, world_from_body};
use crate::exchange::error::Problem;
use crate::exchange::syntax::node::Node;
use touchline_core::geometry::rotation::nearest_rotation;
use touchline_core::geometry::{Mat3, Vec3};

/// Points along each side of the picture at which a sheared camera is compared with a rotated one.
const POINTS_A_SIDE: u32 = 16;

/// The camera's body on the stage.
pub(super) struct BodyPose {
    /// The rotation from the body (right, forward, up) to `world`.
    pub(super) world_from_body: Mat3,
    /// The place of the sensor in `world`, m.
    pub(super) place_m: Vec3,
    /// How far the picture is off at most because scales shear the axes, px.
    pub(super) off_px: f64,
}

impl BodyPose {
    /// The transforms of a sample, composed in their order.
    ///
    /// # Errors
    /// There are none, one is damaged, or scales leave nothing that is nearly a rotation.
    pub(super) fn of_sample(
        root: &Node<'_>,
        screen: &Screen,
        most_off_px: f64,
    ) -> Result<Self, Problem> {
        let transforms = root.key("transforms")?;
        let count = transforms.count()?;
        if count == 0 {
            return Err(Problem::Missing("a transform".to_owned()));
        }
        let mut axes = Mat3::identity();
        let mut place_m = Vec3::zeros();
        for (index, transform) in transforms.items()?.enumerate() {
            let (t, r) = (transform.key("translation")?, transform.key("rotation")?);
            place_m += axes * Vec3::from(t.numbers_at(["x", "y", "z"])?);
            axes *= world_from_body(r.angles_at(["pan", "tilt", "roll"])?);
            let scale = scale_of(&transform)?;
            if index + 1 < count {
                axes *= Mat3::from_diagonal(&scale);
            }
        }
        let world_from_body = nearest_rotation(&axes);
        let off_px = shear_px(&axes, &world_from_body, screen);
        if off_px > most_off_px {
            return Err(shear_problem(off_px));
        }
        Ok(Self {
            world_from_body,
            place_m,
            off_px,
        })
    }
}

/// The scale of a transform along its axes; one where none is stated.
///
/// # Errors
/// It is not above zero: it would mirror what stands on it, or make it flat.
fn scale_of(transform: &Node<'_>) -> Result<Vec3, Problem> {
    let mut scale = Vec3::repeat(1.0);
    if let Some(stated) = transform.find("scale") {
        for (index, axis) in ["x", "y", "z"].iter().enumerate() {
            if let Some(side) = stated.find(axis) {
                scale[index] = side.positive()?;
            }
        }
    }
    Ok(scale)
}

/// How far a camera of these axes, which need not be at right angles, shows points of the picture's
/// edge at most from where one that is only rotated does, px. Their common length does not count,
/// and what a multiplication loses in the last digits is nothing.
fn shear_px(axes: &Mat3, rotation: &Mat3, screen: &Screen) -> f64 {
    let length = axes.determinant().abs().cbrt();
    let off = rotation.transpose() * axes / length;
    if (off - Mat3::identity()).amax() < 1e-12 {
        return 0.0;
    }
    let body_from_cam = cam_from_world([0.0; 3]).transpose();
    let cam_from_sheared = body_from_cam.transpose() * off * body_from_cam;
    let (width, height) = (f64::from(screen.size.width), f64::from(screen.size.height));
    let at = screen.principal_point;
    let focal_px = screen.focal_mm / screen.mm_per_px;
    let sides = (0..=POINTS_A_SIDE).flat_map(|step| {
        let share = f64::from(step) / f64::from(POINTS_A_SIDE);
        let (x, y) = (width * share, height * share);
        [[x, 0.0], [x, height], [0.0, y], [width, y]]
    });
    let distances = sides.map(|[x, y]| {
        let ray = Vec3::new((x - at.x) / focal_px, (y - at.y) / focal_px, 1.0);
        let seen = cam_from_sheared * ray;
        // A point behind the rotated camera is nowhere in its picture.
        if seen.z <= 0.0 {
            return f64::INFINITY;
        }
        let shown = [0, 1].map(|axis| focal_px * (seen[axis] / seen.z - ray[axis]));
        shown[0].hypot(shown[1])
    });
    // Written so that NaN is infinite, too.
    distances.fold(0.0, |worst, off_px| {
        if off_px.is_finite() {
            f64::max(worst, off_px)
        } else {
            f64::INFINITY
        }
    })
}

/// The error that the scales of transforms leave no rotation.
fn shear_problem(off_px: f64) -> Problem {
    let by = if off_px.is_finite() {
        format!("by {off_px:.1} px")
    } else {
        "beyond its picture".to_owned()
    };
    Problem::not_supported(
        format!("the scale of transforms, which shears the camera {by},"),
        "up to 0.05 px is taken; where it is the size of a model on the stage, take it out: \
         jq -c 'del(.transforms[].scale)'",
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};
    use touchline_core::geometry::ImageSize;

    fn screen() -> Screen {
        let size = ImageSize::new(1920, 1080);
        Screen {
            size,
            principal_point: size.centre(),
            mm_per_px: 9.6 / 1920.0,
            focal_mm: 12.0,
            squeeze: 1.0,
        }
    }

    /// A crane that is turned, with a camera at the end of its arm, and their scales.
    fn on_a_crane(crane: &Value, camera: &Value) -> Result<BodyPose, Problem> {
        let sample = json!({ "transforms": [
            { "translation": { "x": 1.0, "y": 2.0, "z": 3.0 },
              "rotation": { "pan": 90.0, "tilt": 0.0, "roll": 0.0 }, "scale": crane },
            { "translation": { "x": 0.0, "y": 4.0, "z": 0.0 },
              "rotation": { "pan": 20.0, "tilt": -10.0, "roll": 1.0 }, "scale": camera },
        ] });
        BodyPose::of_sample(&Node::root(&sample), &screen(), 0.05)
    }

    #[test]
    fn a_scale_moves_what_stands_on_it() {
        let one = json!({ "x": 1.0, "y": 1.0, "z": 1.0 });
        let plain = on_a_crane(&one, &one).unwrap();
        // Forward of a crane that is turned by 90° to the left is −x.
        assert!((plain.place_m - Vec3::new(-3.0, 2.0, 3.0)).norm() < 1e-12);
        let half = on_a_crane(&json!({ "x": 0.5, "y": 0.5, "z": 0.5 }), &one).unwrap();
        assert!((half.place_m - Vec3::new(-1.0, 2.0, 3.0)).norm() < 1e-12);
        assert!((half.world_from_body - plain.world_from_body).amax() < 1e-12);
        assert_eq!(half.off_px, 0.0);
    }

    #[test]
    fn the_size_of_the_cameras_own_model_changes_nothing() {
        let one = json!({ "x": 1.0 });
        let plain = on_a_crane(&one, &one).unwrap();
        let large = on_a_crane(&one, &json!({ "x": 1.0, "y": 2.0, "z": 3.0 })).unwrap();
        assert_eq!(large.place_m, plain.place_m);
        assert_eq!(large.world_from_body, plain.world_from_body);
    }

    #[test]
    fn scales_that_shear_are_refused_by_how_far() {
        let one = json!({});
        // Half a millionth shears by less than a hundredth of a pixel.
        let nearly = on_a_crane(&json!({ "x": 1.000_005 }), &one).unwrap();
        assert!(
            nearly.off_px > 0.0 && nearly.off_px < 0.05,
            "{}",
            nearly.off_px
        );
        let said = |crane: Value| on_a_crane(&crane, &one).err().unwrap().to_string();
        // 1 % of x against y at 20°: the edge, 960 px from the middle, moves by some of that.
        let sheared = said(json!({ "x": 1.01, "y": 1.0, "z": 1.0 }));
        let px = sheared.split("shears the camera by ").nth(1).unwrap();
        let px: f64 = px.split(' ').next().unwrap().parse().unwrap();
        assert!((2.0..20.0).contains(&px), "{sheared}");
        assert!(sheared.contains("jq -c 'del(.transforms[].scale)'"));
        for flat in [0.0, -1.0] {
            let refused = said(json!({ "y": flat }));
            assert!(refused.contains("must be above 0"), "{refused}");
        }
    }
}
