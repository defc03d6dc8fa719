//! The camera of square pixels that is nearest to one whose pixels are not quite square.
//!
//! A document has one focal length and no skew. Programs that estimate fx and fy by themselves make
//! them differ by some 0.1 %, and resampled crops have a skew of a few thousandths of a pixel. Such
//! a camera is taken with the focal length and principal point that show the same picture best, and
//! with how far it is off at most.

use crate::exchange::error::Problem;
use crate::exchange::options::Pixels;
use touchline_core::geometry::{ImagePoint, ImageSize};

/// The largest relative difference of two focal lengths that is taken.
const MOST_OBLONG: f64 = 5e-3;
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

/// The nearest camera of square pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SquarePixels {
    /// px.
    pub focal_px: f64,
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
            return Err(Problem::not_supported(
                format!("a matrix with {a} below fx and the last row {b}, {c}, {scale}"),
                "a calibration matrix is fx, skew, cx; 0, fy, cy; 0, 0, 1",
            ));
        }
        let shift = pixels.to_corner_px();
        Ok(Self {
            fx: fx / scale,
            fy: fy / scale,
            skew: skew / scale,
            principal_point: ImagePoint::new(cx / scale + shift, cy / scale + shift),
        })
    }

    /// The camera of square pixels that shows a picture of this size most alike.
    ///
    /// With a focal length of f and its own principal point the picture changes by (f / fx − 1) of
    /// the distance from the middle in u, and by (f / fy − 1) of it in v. The f that makes the sum
    /// of the squares at the corner smallest is returned; the principal point keeps the middle of
    /// the picture where it is.
    ///
    /// # Errors
    /// The pixels are too far from square; how far is said.
    pub fn with_square_pixels(&self, size: ImageSize) -> Result<SquarePixels, Problem> {
        let Self {
            fx,
            fy,
            skew,
            principal_point: at,
        } = *self;
        if fx == fy && skew == 0.0 {
            return Ok(SquarePixels {
                focal_px: fx,
                principal_point: at,
                off_px: 0.0,
            });
        }
        let half = [size.width, size.height].map(|side| 0.5 * f64::from(side));
        // Both residuals are linear in f: (f a − half) with a = half / fx or half / fy.
        let [a, b] = [half[0] / fx, half[1] / fy];
        let focal_px = (a * half[0] + b * half[1]) / (a * a + b * b);
        let middle = [
            (half[0] - at.x - skew * (half[1] - at.y) / fy) / fx,
            (half[1] - at.y) / fy,
        ];
        let corner_px = [
            (focal_px * a - half[0]).abs() + (focal_px / fx * skew * half[1] / fy).abs(),
            focal_px * b - half[1],
        ];
        let off_px = corner_px[0].hypot(corner_px[1]);
        // Written so that NaN is refused.
        let is_square = (fx / fy - 1.0).abs() <= MOST_OBLONG && skew.abs() <= MOST_SKEW_PX;
        if !(is_square && off_px.is_finite()) {
            return Err(Problem::NotSquare {
                focal_px: [fx, fy],
                skew_px: skew,
                off_px,
            });
        }
        Ok(SquarePixels {
            focal_px,
            principal_point: ImagePoint::new(
                half[0] - focal_px * middle[0],
                half[1] - focal_px * middle[1],
            ),
            off_px,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: ImageSize = ImageSize::new(960, 540);

    /// How far the two are apart at most over the picture, by a grid of pixels.
    fn worst_px(matrix: &Calibration, square: &SquarePixels) -> f64 {
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
            let there = square.principal_point;
            let off = (
                square.focal_px * x + there.x - u,
                square.focal_px * y + there.y - v,
            );
            off.0.hypot(off.1)
        });
        distances.fold(0.0, f64::max)
    }

    #[test]
    fn nearly_square_pixels_are_taken_as_far_off_as_is_said() {
        for (fx, fy, skew, x, y) in [
            (1894.7074, 1894.7069, -0.0014, 326.9, 109.3),
            (2410.0, 2414.0, 0.0, -928.0, 562.0),
            (1200.0, 1195.0, 0.05, 1353.0, -40.0),
        ] {
            let principal_point = ImagePoint::new(x, y);
            let matrix = Calibration {
                fx,
                fy,
                skew,
                principal_point,
            };
            let square = matrix.with_square_pixels(SIZE).unwrap();
            let worst_px = worst_px(&matrix, &square);
            assert!(
                (worst_px - square.off_px).abs() < 1e-9,
                "{worst_px} {square:?}"
            );
            // No other focal length is nearer at the corner.
            for by in [-0.1, 0.1].into_iter().filter(|_| skew == 0.0) {
                let other = Calibration {
                    fx: fx + by,
                    fy: fy + by,
                    ..matrix
                };
                let other = SquarePixels {
                    focal_px: square.focal_px + by,
                    ..other.with_square_pixels(SIZE).unwrap()
                };
                assert!(self::worst_px(&matrix, &other) >= worst_px);
            }
        }
    }

    #[test]
    fn square_pixels_stay_as_they_are_and_oblong_ones_are_refused_with_how_far_they_are() {
        let square = Calibration {
            fx: 2410.0,
            fy: 2410.0,
            skew: 0.0,
            principal_point: ImagePoint::new(951.5, 548.25),
        };
        let kept = square.with_square_pixels(SIZE).unwrap();
        assert_eq!((kept.focal_px, kept.off_px), (2410.0, 0.0));
        assert_eq!(kept.principal_point, square.principal_point);
        let oblong = Calibration {
            fy: 2434.0,
            ..square
        };
        let said = oblong.with_square_pixels(SIZE).unwrap_err().to_string();
        assert!(
            said.contains(
                "focal lengths of 2410 and 2434 px with a skew of 0 px: the nearest \
             square pixels are 2.33 px off"
            ),
            "{said}"
        );
        let skewed = Calibration {
            skew: 0.2,
            ..square
        };
        assert!(skewed.with_square_pixels(SIZE).is_err());
        let none = Calibration {
            fx: f64::NAN,
            ..square
        };
        assert!(none.with_square_pixels(SIZE).is_err());
        let rows = [2410.0, 0.0, 959.5, 0.0, 2410.0, 539.5, 0.0, 0.1, 1.0];
        assert!(Calibration::from_rows(&rows, Pixels::Centre).is_err());
    }
}
