//! Calibration matrices of other programs: two focal lengths, a skew and a principal point.
//!
//! A document has a focal length and the aspect of the pixels, and no skew. The skew of resampled
//! crops is a few thousandths of a pixel: such a camera is taken without it, with the principal
//! point that keeps the middle of the picture where it is, and with how far it is off at most.

use crate::exchange::error::Problem;
use crate::exchange::options::Pixels;
use touchline_core::camera::PIXEL_ASPECTS;
use touchline_core::geometry::{ImagePoint, ImageSize};

/// The largest skew that is taken, px.
const MOST_SKEW_PX: f64 = 0.1;

/// A calibration matrix: from normalised coordinates (after distortion) to pixels, u = fx x + skew y
/// + cx, v = fy y + cy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// px.
    pub fx: f64,
    /// px.
    pub fy: f64,
    /// px.
    pub skew: f64,
    /// px, corner convention.
    pub principal_point: ImagePoint,
}

/// The same without a skew, as a document has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WithoutSkew {
    /// The focal length across the picture, px.
    pub focal_px: f64,
    /// The focal length down the picture over that.
    pub pixel_aspect: f64,
    /// px, corner convention.
    pub principal_point: ImagePoint,
    /// How far a point of the picture is at most from where the matrix shows it, px.
    pub off_px: f64,
}

impl Calibration {
    /// The calibration of a matrix by rows.
    ///
    /// # Errors
    /// Its other entries are not those of a calibration matrix.
    pub fn from_rows(rows: &[f64; 9], pixels: Pixels) -> Result<Self, Problem> {
        // A matrix in 32-bit numbers may have a last entry that is not quite one.
        let [fx, skew, cx, a, fy, cy, b, c, scale] = *rows;
        if [a, b, c] != [0.0; 3] || !((scale - 1.0).abs() < 1e-6) {
            return Err(Problem::Unsupported {
                what: format!("a matrix with {a} below fx and the last row {b}, {c}, {scale}"),
                why: "a calibration matrix is fx, skew, cx; 0, fy, cy; 0, 0, 1",
            });
        }
        let shift = pixels.to_corner_px();
        Ok(Self {
            fx: fx / scale,
            fy: fy / scale,
            skew: skew / scale,
            principal_point: ImagePoint::new(cx / scale + shift, cy / scale + shift),
        })
    }

    /// The same camera without the skew, for a picture of this size.
    ///
    /// A line of the picture then moves by the skew times its distance from the middle, in focal
    /// lengths; the principal point keeps the middle line where it is.
    ///
    /// # Errors
    /// The skew is too large, or the focal lengths too different; how far off that is is said.
    pub fn without_skew(&self, size: ImageSize) -> Result<WithoutSkew, Problem> {
        let Self {
            fx,
            fy,
            skew,
            principal_point: at,
        } = *self;
        let half_height = 0.5 * f64::from(size.height);
        let pixel_aspect = if fx == fy { 1.0 } else { fy / fx };
        let per_line = if skew == 0.0 { 0.0 } else { skew / fy };
        let off_px = (per_line * half_height).abs();
        // Both are written so that NaN is refused.
        if !PIXEL_ASPECTS.contains(&pixel_aspect) {
            return Err(Problem::OutOfRange {
                what: format!("fy / fx of the focal lengths {fx} and {fy} px"),
                value: pixel_aspect,
                wanted: "0.25 to 4",
            });
        }
        if !(skew.abs() <= MOST_SKEW_PX && off_px.is_finite()) {
            return Err(Problem::Skew {
                skew_px: skew,
                off_px,
            });
        }
        Ok(WithoutSkew {
            focal_px: fx,
            pixel_aspect,
            principal_point: ImagePoint::new(at.x + per_line * (half_height - at.y), at.y),
            off_px,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: ImageSize = ImageSize::new(960, 540);

    /// How far the two are apart at most over the picture, by a grid of pixels.
    fn worst_px(matrix: &Calibration, taken: &WithoutSkew) -> f64 {
        let Calibration {
            fx,
            fy,
            skew,
            principal_point: at,
        } = *matrix;
        let pixels = (0..=48).flat_map(|column| (0..=27).map(move |row| (column, row)));
        let distances = pixels.map(|(column, row)| {
            let (u, v) = (20.0 * f64::from(column), 20.0 * f64::from(row));
            let y = (v - at.y) / fy;
            let x = (u - at.x - skew * y) / fx;
            let there = taken.principal_point;
            let off = (
                taken.focal_px * x + there.x - u,
                taken.focal_px * taken.pixel_aspect * y + there.y - v,
            );
            off.0.hypot(off.1)
        });
        distances.fold(0.0, f64::max)
    }

    #[test]
    fn two_focal_lengths_are_kept_and_a_skew_is_off_as_far_as_is_said() {
        for (fx, fy, skew, x, y) in [
            (1894.7074, 1894.7069, -0.0014, 326.9, 109.3),
            (2410.0, 2414.0, 0.0, -928.0, 562.0),
            (1200.0, 2133.0, 0.05, 1353.0, -40.0),
        ] {
            let principal_point = ImagePoint::new(x, y);
            let matrix = Calibration {
                fx,
                fy,
                skew,
                principal_point,
            };
            let taken = matrix.without_skew(SIZE).unwrap();
            let worst_px = worst_px(&matrix, &taken);
            assert!(
                (worst_px - taken.off_px).abs() < 1e-9,
                "{worst_px} {taken:?}"
            );
            assert!((taken.off_px > 0.0) == (skew != 0.0), "{taken:?}");
        }
    }

    #[test]
    fn square_pixels_stay_as_they_are_and_no_camera_is_refused_with_how_far_it_is_off() {
        let square = Calibration {
            fx: 2410.0,
            fy: 2410.0,
            skew: 0.0,
            principal_point: ImagePoint::new(951.5, 548.25),
        };
        let kept = square.without_skew(SIZE).unwrap();
        assert_eq!(
            (kept.focal_px, kept.pixel_aspect, kept.off_px),
            (2410.0, 1.0, 0.0)
        );
        assert_eq!(kept.principal_point, square.principal_point);
        let skewed = Calibration {
            skew: 24.1,
            ..square
        };
        let said = skewed.without_skew(SIZE).unwrap_err().to_string();
        assert!(
            said.contains("a skew of 24.1 px: without it the picture is 2.70 px off"),
            "{said}"
        );
        for fy in [f64::NAN, 0.0, -2410.0, 240.0, 24100.0] {
            assert!(
                Calibration { fy, ..square }.without_skew(SIZE).is_err(),
                "{fy}"
            );
        }
        let rows = [2410.0, 0.0, 959.5, 0.0, 2410.0, 539.5, 0.0, 0.1, 1.0];
        assert!(Calibration::from_rows(&rows, Pixels::Centre).is_err());
    }
}
