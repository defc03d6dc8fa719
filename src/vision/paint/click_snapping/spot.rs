//! Moves a placed point to the painted point marking that its landmark names: a penalty mark, a
//! face-off spot, the mark in the middle of a halfway line.
//!
//! # Method
//!
//! Template matching by least squares. The template is the marking and the lines through it, as the
//! camera predicts them, blurred (`drawn_spot.rs`), in four sizes. At every whole pixel within
//! reach, contrast and background level are fitted in closed form; the offset that explains most of
//! the variance wins. Gauss–Newton then refines the offset below the pixel. There is no result if
//! the contrast is weak, if the template explains too little, or if another offset is nearly as
//! good.

use super::drawn_spot::{DrawnSpot, Shape, SpotProblem};
use super::{LINE_SIGMA_PX, PointSnapOptions, SnappedPoint, lines_through};
use crate::paint::GroundPicture;
use touchline_core::camera::PtzCamera;
use touchline_core::field::{FieldModel, Landmark};
use touchline_core::geometry::{ImagePoint, Vec2};
use touchline_core::solve::{Equations, Problem};

/// Diameters that are tried, relative to the rule's. Painted markings vary that much.
const SIZES: [f64; 4] = [0.7, 0.85, 1.0, 1.3];

/// Minimum contrast of the marking against the ground, grey levels.
const MIN_CONTRAST: f64 = 8.0;

/// Minimum share of the variance that the template explains.
const MIN_EXPLAINED: f64 = 0.7;

/// At this distance from the best offset, px at 1920 px width, the residual sum of squares is at
/// least [`MUCH_WORSE`] times the minimum.
const BESIDE_PX: f64 = 3.0;
const MUCH_WORSE: f64 = 1.6;

/// Another marking within reach explains at most this share of what the best one does.
const RUNNER_UP: f64 = 0.6;

/// Two offsets are different markings if they are this many diameters apart on the ground.
const ANOTHER: f64 = 1.2;

/// Minimum share of the pixels around the marking that have the ground's colours.
const ON_GROUND: f64 = 0.7;

/// Minimum 1-σ of a pixel's noise, grey levels.
const LEAST_NOISE: f64 = 1.5;

/// Neighbouring pixels have correlated errors: only this share of them counts as independent.
const INDEPENDENT: f64 = 0.25;

/// Number of iterations of the refinement.
const STEPS: usize = 5;

/// Maximum distance of the refined offset from the best whole-pixel offset, px.
const MAX_REFINEMENT_PX: f64 = 2.0;

/// Moves a placed point to the marking that is painted around a landmark. None if the landmark has
/// no point marking, or if the picture does not show it for certain. `camera` need not be exact:
/// only its scale and viewing direction at the landmark are used.
pub(super) fn snap_spot(
    ground: &GroundPicture,
    field: &FieldModel,
    camera: &PtzCamera,
    landmark: &Landmark,
    placed: ImagePoint,
    options: &PointSnapOptions,
) -> Option<SnappedPoint> {
    let scale = ground.size().scale_from_1920();
    let diameter_m = landmark.spot_diameter_m?;
    // Best offset over all sizes and all pixels within reach, by the sum of squares explained.
    let reach = (options.reach_px * scale).ceil() as i32;
    let scans: Vec<TemplateScan> = SIZES
        .into_iter()
        .filter_map(|size| Shape::render(field, camera, landmark, size * diameter_m, scale))
        .map(|shape| TemplateScan::search(ground, placed, shape, reach))
        .collect();
    let all = scans
        .iter()
        .flat_map(|scan| scan.fits.iter().map(move |fit| (scan, fit)));
    let (scan, best) = all
        .clone()
        .max_by(|a, b| a.1.explained.total_cmp(&b.1.explained))?;
    // Reject if a second marking within reach is nearly as good. On a line this test is skipped:
    // the template contains the line, so that every offset along the line explains much.
    if lines_through(field, landmark).is_empty() {
        let mut good = all.filter(|(_, fit)| fit.explained > RUNNER_UP * best.explained);
        if good.any(|(_, fit)| {
            (scan.shape.metres_a_px * (fit.shift - best.shift)).norm() > ANOTHER * diameter_m
        }) {
            return None;
        }
    }
    // Refine, then test contrast, fit, surroundings and precision. Paint is not quite where the
    // rules put it; this error, which no picture shows, is added in quadrature.
    let refined = scan.refine(ground, best, BESIDE_PX * scale.max(0.5))?;
    let (shift, sigma_px) = (refined.shift, refined.sigma_px.hypot(LINE_SIGMA_PX * scale));
    let is_paint = refined.contrast.abs() >= MIN_CONTRAST
        && (refined.contrast > 0.0 || !ground.surface().is_turf())
        && refined.explained >= MIN_EXPLAINED
        && scan.lies_on_ground(ground, shift);
    let is_certain =
        shift.norm() <= options.reach_px * scale && sigma_px <= options.max_sigma_px * scale;
    (is_paint && is_certain).then(|| SnappedPoint {
        image: placed.translate(shift),
        sigma_px,
    })
}

/// One template at every offset within reach.
struct TemplateScan {
    placed: ImagePoint,
    shape: Shape,
    fits: Vec<Fit>,
}

/// A template at one offset, px from the placed point.
#[derive(Clone, Copy, Debug)]
struct Fit {
    shift: Vec2,
    /// Sum of squares about the mean that the template explains, grey levels².
    explained: f64,
}

/// Linear regression of grey levels on the template's coverage.
struct CoverageRegression {
    contrast: f64,
    /// Grey level where the template covers nothing.
    level: f64,
    /// Sum of squares about the mean that the template explains, and the total.
    squares: f64,
    about_mean: f64,
}

/// A template at the offset of least squares.
struct TemplateFit {
    shift: Vec2,
    sigma_px: f64,
    contrast: f64,
    explained: f64,
}

impl CoverageRegression {
    /// Residual sum of squares, grey levels².
    fn unexplained_squares(&self) -> f64 {
        self.about_mean - self.squares
    }
}

impl TemplateScan {
    /// Fits a template at every whole-pixel offset within reach, px.
    fn search(ground: &GroundPicture, placed: ImagePoint, shape: Shape, reach: i32) -> Self {
        let mut scan = Self {
            placed,
            shape,
            fits: Vec::new(),
        };
        for row in -reach..=reach {
            for column in -reach..=reach {
                let shift = Vec2::new(f64::from(column), f64::from(row));
                // Only where no pixel is hidden: otherwise the sums of different offsets are not
                // comparable.
                let pixels = scan.pixels(ground, shift);
                if !scan.is_whole(&pixels) {
                    continue;
                }
                // On turf paint is bright.
                let fit = scan.fit_contrast(&pixels, Vec2::zeros());
                let is_possible = fit.contrast > 0.0 || !ground.surface().is_turf();
                let explained = if is_possible { fit.squares } else { 0.0 };
                scan.fits.push(Fit { shift, explained });
            }
        }
        scan
    }

    /// The pixels under a template at an offset: centre relative to the template's centre, px, and
    /// grey level. Pixels that a graphic covers, and pixels outside the picture, are left out.
    fn pixels(&self, ground: &GroundPicture, shift: Vec2) -> Vec<(Vec2, f64)> {
        let middle = self.placed.translate(shift);
        let [half_x, half_y] = self.shape.half;
        // At the centres of pixels no grey level is interpolated. They lie at the same offsets from
        // the template's centre for every whole-pixel shift.
        let (left, top) = (middle.x.floor(), middle.y.floor());
        let offsets =
            (-half_y..=half_y).flat_map(|row| (-half_x..=half_x).map(move |column| (column, row)));
        offsets
            .map(|(column, row)| {
                ImagePoint::new(left + f64::from(column) + 0.5, top + f64::from(row) + 0.5)
            })
            .filter(|at| ground.size().contains(*at) && !ground.is_masked(*at))
            .map(|at| (at.offset_from(middle), ground.grey().at(at)))
            .collect()
    }

    /// Whether none of the template's pixels is hidden.
    fn is_whole(&self, pixels: &[(Vec2, f64)]) -> bool {
        let [columns, rows] = self.shape.half.map(|half| 2 * half as usize + 1);
        pixels.len() == columns * rows
    }

    /// Fits grey = level + contrast · coverage to some pixels, with the template moved by `by`.
    ///
    /// Ordinary least squares for a line: contrast = Σ(c − c̄)(g − ḡ) / Σ(c − c̄)², with the
    /// coverage c and the grey level g of each pixel.
    fn fit_contrast(&self, pixels: &[(Vec2, f64)], by: Vec2) -> CoverageRegression {
        let count = pixels.len() as f64;
        // Sums of coverage c and grey level g: Σc, Σg, Σc², Σcg, Σg².
        let [mut covers, mut greys, mut covers_2, mut both, mut greys_2] = [0.0; 5];
        for (off, grey) in pixels {
            let here = self.shape.covers(off - by);
            (covers, greys) = (covers + here, greys + grey);
            (covers_2, both, greys_2) = (
                covers_2 + here * here,
                both + here * grey,
                greys_2 + grey * grey,
            );
        }
        // About the means. A template that covers all pixels alike has no contrast.
        let of_covers = covers_2 - covers * covers / count;
        let together = both - covers * greys / count;
        let contrast = if of_covers > 0.0 {
            together / of_covers
        } else {
            0.0
        };
        CoverageRegression {
            contrast,
            level: (greys - contrast * covers) / count,
            squares: contrast * together,
            about_mean: greys_2 - greys * greys / count,
        }
    }

    /// Refines an offset below the pixel. None if it diverges, or if offsets `beside_px` away are
    /// nearly as good.
    fn refine(&self, ground: &GroundPicture, from: &Fit, beside_px: f64) -> Option<TemplateFit> {
        let seen = self.pixels(ground, from.shift);
        let count = seen.len() as f64;
        let CoverageRegression {
            contrast,
            level,
            about_mean,
            ..
        } = self.fit_contrast(&seen, Vec2::zeros());
        let problem = SpotProblem {
            shape: &self.shape,
            pixels: &seen,
        };
        let mut spot = DrawnSpot {
            by: Vec2::zeros(),
            contrast,
            level,
        };
        // Offset, contrast and level are refined together; the set of pixels stays. The result is
        // that of the last equations, for which the residuals are known; the step after it is
        // small.
        let mut result = None;
        for _ in 0..STEPS {
            let equations = problem.equations(&spot);
            let inverse = equations.own.try_inverse()?;
            // Noise variance from the residuals, at least [`LEAST_NOISE`]², increased for the
            // correlation of neighbours. The 1-σ is the root of the mean variance of the two axes.
            let left = equations.cost();
            let noise_2 = (left / count).max(LEAST_NOISE.powi(2)) / INDEPENDENT;
            let sigma_px = (noise_2 * 0.5 * (inverse[(0, 0)] + inverse[(1, 1)])).sqrt();
            let explained = if about_mean > 0.0 {
                1.0 - left / about_mean
            } else {
                0.0
            };
            result = Some(TemplateFit {
                shift: from.shift + spot.by,
                sigma_px,
                contrast: spot.contrast,
                explained,
            });
            spot = problem.apply_step(&spot, &equations.step(0.0)?);
            if !(spot.by.norm() <= MAX_REFINEMENT_PX) {
                return None;
            }
        }
        result.filter(|_| self.is_much_worse_beside(&seen, spot.by, beside_px))
    }

    /// Whether the residual sum of squares rises by [`MUCH_WORSE`] in all directions at
    /// `beside_px`. A line, or a border of two areas, fits equally well along itself and fails.
    fn is_much_worse_beside(&self, pixels: &[(Vec2, f64)], by: Vec2, beside_px: f64) -> bool {
        const DIRECTIONS: u32 = 16;
        let noise = pixels.len() as f64 * LEAST_NOISE.powi(2);
        // Noise is added on both sides: the ratio of two very small residuals says nothing.
        let least = MUCH_WORSE * (self.fit_contrast(pixels, by).unexplained_squares() + noise);
        (0..DIRECTIONS).all(|index| {
            let (y, x) =
                (std::f64::consts::TAU * f64::from(index) / f64::from(DIRECTIONS)).sin_cos();
            let beside = by + Vec2::new(x, y) * beside_px;
            self.fit_contrast(pixels, beside).unexplained_squares() + noise >= least
        })
    }

    /// Whether most of what surrounds the marking has the ground's colours.
    fn lies_on_ground(&self, ground: &GroundPicture, shift: Vec2) -> bool {
        let middle = self.placed.translate(shift);
        let bare: Vec<ImagePoint> = self
            .pixels(ground, shift)
            .into_iter()
            .filter(|(off, _)| self.shape.covers(*off) < 0.05)
            .map(|(off, _)| middle.translate(off))
            .collect();
        let of_ground = bare.iter().filter(|at| ground.is_ground(**at)).count();
        of_ground as f64 >= ON_GROUND * bare.len() as f64 && !bare.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Picture;
    use crate::paint::drawn::{camera, draw_field, soccer};
    use crate::paint::snap_point;
    use std::sync::LazyLock;
    use touchline_core::camera::Ptz;
    use touchline_core::geometry::{ImageSize, PixelBox};
    use touchline_core::testing::{landmark_in, pixel_box};

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    /// Looks at the middle of the field and at a penalty mark, close enough to see them.
    const VIEWS: [(&str, f64, f64); 3] = [
        ("centre_mark", -1.0, 2600.0),
        ("penalty_mark_right", 34.0, 2600.0),
        ("penalty_mark_left", -34.5, 2600.0),
    ];

    fn view(pan_deg: f64, focal_px: f64) -> PtzCamera {
        let seen = camera(pan_deg, -14.0, focal_px);
        PtzCamera::new(
            *seen.base(),
            Ptz {
                focal_px,
                ..seen.ptz()
            },
        )
    }

    static PICTURES: LazyLock<Vec<Picture>> = LazyLock::new(|| {
        VIEWS
            .iter()
            .map(|(_, pan, focal)| draw_field(&soccer(), &view(*pan, *focal), SIZE))
            .collect()
    });

    fn view_of(index: usize) -> (PtzCamera, ImagePoint) {
        let field = soccer();
        let (landmark, pan_deg, focal_px) = VIEWS[index];
        let camera = view(pan_deg, focal_px);
        let at = landmark_in(&camera, &field, landmark);
        (camera, at)
    }

    fn snapped(
        index: usize,
        camera: &PtzCamera,
        placed: ImagePoint,
        masks: &[PixelBox],
    ) -> Option<SnappedPoint> {
        let field = soccer();
        let landmark = field.landmark(VIEWS[index].0).unwrap();
        let ground = GroundPicture::new(&PICTURES[index], masks);
        snap_point(
            &ground,
            &field,
            camera,
            landmark,
            placed,
            &PointSnapOptions::default(),
        )
    }

    #[test]
    fn a_point_beside_a_mark_goes_to_its_middle() {
        for (index, (landmark, ..)) in VIEWS.iter().enumerate() {
            let (camera, exact) = view_of(index);
            for off_px in [
                Vec2::zeros(),
                Vec2::new(2.5, -1.5),
                Vec2::new(-3.0, 2.0),
                Vec2::new(0.5, 3.0),
            ] {
                let found = snapped(index, &camera, exact.translate(off_px), &[]);
                let found = found.unwrap_or_else(|| panic!("{landmark} from {off_px:?}"));
                let error_px = found.image.distance_px(exact);
                assert!(
                    error_px < 0.25,
                    "{landmark} from {off_px:?}: {error_px} px, {found:?}"
                );
                assert!((0.1..1.0).contains(&found.sigma_px), "{found:?}");
            }
        }
    }

    #[test]
    fn a_rough_camera_is_enough() {
        let (_, exact) = view_of(1);
        for rough in [
            view(31.0, 2600.0),
            view(34.0, 2350.0),
            camera(36.0, -15.5, 2700.0),
        ] {
            let found = snapped(1, &rough, exact.translate(Vec2::new(2.0, -1.0)), &[]).unwrap();
            assert!(found.image.distance_px(exact) < 0.5, "{found:?}");
        }
    }

    #[test]
    fn without_a_mark_or_with_something_else_in_its_place_a_point_stays() {
        let (camera, exact) = view_of(1);
        assert_eq!(
            snapped(1, &camera, exact.translate(Vec2::new(40.0, 0.0)), &[]),
            None,
            "bare turf"
        );
        let hidden = pixel_box(exact.x - 30.0, exact.y - 10.0, 60.0, 20.0);
        assert_eq!(snapped(1, &camera, exact, &[hidden]), None, "a graphic");
        // The halfway line without its mark, and the mark of another place beside a line.
        let (middle, centre) = view_of(0);
        assert_eq!(
            snapped(0, &middle, centre.translate(Vec2::new(0.0, 60.0)), &[]),
            None,
            "a line alone"
        );
    }
}
