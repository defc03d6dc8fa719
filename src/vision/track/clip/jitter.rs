//! Jitter: how much a camera's motion changes from frame to frame.

use touchline_core::camera::Ptz;

/// Root mean square of the second differences of consecutive cameras.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Jitter {
    /// Of the pan, degrees.
    pub pan_deg: f64,
    /// Of the tilt, degrees.
    pub tilt_deg: f64,
    /// Of the focal length, px.
    pub focal_px: f64,
    /// Of the image position of the scene at the picture's centre, px.
    pub centre_px: f64,
}

impl Jitter {
    /// Of cameras in frame order. A missing frame interrupts the sequence; `None` without three
    /// consecutive cameras.
    pub fn measure(cameras: &[Option<Ptz>]) -> Option<Self> {
        let (mut squares, mut count) = ([0.0; 4], 0.0);
        for three in cameras.windows(3) {
            let [Some(a), Some(b), Some(c)] = three else {
                continue;
            };
            // Second differences. At the picture's centre a pan moves the image by f cos(tilt) per
            // radian, a tilt by f.
            let pan = (c.pan.turn_from(b.pan) - b.pan.turn_from(a.pan)).degrees();
            let tilt = (c.tilt - b.tilt - (b.tilt - a.tilt)).degrees();
            let focal = c.focal_px - 2.0 * b.focal_px + a.focal_px;
            let centre =
                b.focal_px * (pan.to_radians() * b.tilt.radians().cos()).hypot(tilt.to_radians());
            // A steady turn has no second difference; what is left is noise and acceleration.
            for (sum, value) in squares.iter_mut().zip([pan, tilt, focal, centre]) {
                *sum += value * value;
            }
            count += 1.0;
        }
        // Without three consecutive cameras this is 0/0; the result below is then `None`.
        let [pan_deg, tilt_deg, focal_px, centre_px] = squares.map(|sum: f64| (sum / count).sqrt());
        (count > 0.0).then_some(Self {
            pan_deg,
            tilt_deg,
            focal_px,
            centre_px,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_motion_has_none_and_a_jerk_is_measured() {
        let even: Vec<_> = (0..9)
            .map(|at| Some(Ptz::from_degrees(0.1 * f64::from(at), -10.0, 2000.0)))
            .collect();
        let none = Jitter::measure(&even).unwrap();
        assert!(none.pan_deg < 1e-12 && none.centre_px < 1e-9, "{none:?}");
        let mut jerk = even.clone();
        jerk[4] = Some(Ptz::from_degrees(0.5, -10.0, 2000.0));
        let jerk = Jitter::measure(&jerk).unwrap();
        // 0.1 − 2 · 0.1 + 0.1: second differences of 0.1, −0.2 and 0.1 among seven.
        assert!(
            (jerk.pan_deg - (0.06_f64 / 7.0).sqrt()).abs() < 1e-9,
            "{jerk:?}"
        );
        assert!(
            (jerk.centre_px / jerk.pan_deg - 2000.0 * 1f64.to_radians() * 10f64.to_radians().cos())
                .abs()
                < 1e-6
        );
        let mut gap = even;
        gap[2] = None;
        assert!(Jitter::measure(&gap[..5]).is_none() && Jitter::measure(&gap).is_some());
    }
}
