//! Pan, tilt and roll about Z, X and Y of a body whose axes are right, forward, up: `OpenTrackIO`
//! and `FreeD`.
//!
//! `R_world_from_body = Rz(pan) · Rx(tilt) · Ry(roll)`, right-handed, so pan is positive to the
//! *left*; `FreeD` negates it.

use touchline_core::geometry::Mat3;

/// The rotation from `cam` (right, down, forward) to the body (right, forward, up).
fn body_from_cam() -> Mat3 {
    Mat3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0)
}

/// Pan (to the left), tilt and roll, degrees.
pub fn angles_deg(cam_from_world: &Mat3) -> [f64; 3] {
    // m = Rz(pan) Rx(tilt) Ry(roll): its second column is (−sin pan cos tilt, cos pan cos tilt, sin
    // tilt), its third row (−cos tilt sin roll, sin tilt, cos tilt cos roll). Two-argument
    // arctangents keep all digits where an arcsine of the tilt loses half of them near ±90°.
    let m = cam_from_world.transpose() * body_from_cam().transpose();
    let pan = (-m[(0, 1)]).atan2(m[(1, 1)]);
    let tilt = m[(2, 1)].atan2(m[(0, 1)].hypot(m[(1, 1)]));
    let roll = (-m[(2, 0)]).atan2(m[(2, 2)]);
    [pan, tilt, roll].map(f64::to_degrees)
}

/// The rotation of pan (to the left), tilt and roll, degrees.
pub fn cam_from_world([pan, tilt, roll]: [f64; 3]) -> Mat3 {
    (world_from_body([pan, tilt, roll]) * body_from_cam()).transpose()
}

/// `R_world_from_body` of pan (to the left), tilt and roll, degrees.
pub fn world_from_body([pan, tilt, roll]: [f64; 3]) -> Mat3 {
    let [(sp, cp), (st, ct), (sr, cr)] =
        [pan, tilt, roll].map(|degrees| degrees.to_radians().sin_cos());
    Mat3::new(cp, -sp, 0.0, sp, cp, 0.0, 0.0, 0.0, 1.0)
        * Mat3::new(1.0, 0.0, 0.0, 0.0, ct, -st, 0.0, st, ct)
        * Mat3::new(cr, 0.0, sr, 0.0, 1.0, 0.0, -sr, 0.0, cr)
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::BaseAngles;
    use touchline_core::geometry::Angle;
    use touchline_core::geometry::rotation::{q_pan, q_tilt};

    #[test]
    fn a_level_base_has_our_angles_with_pan_to_the_left() {
        let level = BaseAngles::default().base_from_world();
        let rotation =
            q_tilt(Angle::from_degrees(-11.2)) * q_pan(Angle::from_degrees(12.5)) * level;
        let [pan, tilt, roll] = angles_deg(&rotation);
        assert!((pan + 12.5).abs() < 1e-12 && (tilt + 11.2).abs() < 1e-12 && roll.abs() < 1e-12);
        for angles in [[-170.0, 20.0, 3.0], [80.0, -60.0, -8.0]] {
            let again = angles_deg(&cam_from_world(angles));
            assert!(
                angles.iter().zip(again).all(|(a, b)| (a - b).abs() < 1e-12),
                "{again:?}"
            );
        }
        let leaning = cam_from_world([0.0, 0.0, 5.0]);
        let right = leaning.row(0).transpose();
        assert!(
            right.z < 0.0,
            "clockwise seen from behind lowers the right-hand side"
        );
    }
}
