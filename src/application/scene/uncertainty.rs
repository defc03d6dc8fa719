//! The uncertainty of the overlay as a drawing: a band around the lines, or a heat map over the
//! picture.
//!
//! Both show the 1-σ of the lines in the picture (see [`Uncertainty`]). The band shows its
//! component across the line, the heat map its RMS length.

use super::OverlayStyle;
use super::drawing::{Area, Colour, Drawing, Stroke, StrokeGroup};
use rayon::prelude::*;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, Vec2};
use touchline_core::markings::{MarkingOptions, project_lines};
use touchline_core::solve::Uncertainty;

/// How the uncertainty is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UncertaintyView {
    /// Not at all.
    #[default]
    Off,
    /// A band around the lines.
    Band,
    /// A heat map over the picture.
    Heat,
}

impl UncertaintyView {
    /// The next view in the cycle.
    #[must_use]
    pub const fn next(self) -> Self {
        match self {
            Self::Off => Self::Band,
            Self::Band => Self::Heat,
            Self::Heat => Self::Off,
        }
    }
}

/// Colours of a heat map, evenly spaced on a logarithmic scale: from dark (certain) to bright
/// (uncertain), distinguishable for colour-blind people, too.
pub const HEAT_STOPS: [Colour; 5] = [
    Colour::rgb(20, 40, 110),
    Colour::rgb(30, 120, 180),
    Colour::rgb(90, 200, 170),
    Colour::rgb(250, 215, 80),
    Colour::rgb(255, 95, 60),
];

/// 1-σ of the first and the last colour, px at 1920 px width.
const HEAT_FROM_TO_PX: (f64, f64) = (1.0, 16.0);

/// Columns and rows of a heat map's grid, including the borders of the picture.
pub const HEAT_GRID: [u32; 2] = [60, 40];

/// 1-σ of the overlay on a grid over the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatMap {
    /// Columns and rows. The first and the last lie on the borders of the picture.
    pub size: [u32; 2],
    /// Size of the picture, px.
    pub image_size: ImageSize,
    /// Position on the colour scale at each grid point, 0 to 65535, row by row.
    pub levels: Vec<u16>,
}

impl HeatMap {
    /// Computes the map of a solved frame.
    pub fn new(uncertainty: &Uncertainty, camera: &PtzCamera, image_size: ImageSize) -> Self {
        let [columns, rows] = HEAT_GRID;
        let levels = (0..rows)
            .into_par_iter()
            .flat_map_iter(|row| (0..columns).map(move |column| (row, column)));
        // 16 bits a level: the shader draws contour lines, which would show the steps of 8 bits.
        let levels = levels
            .map(|(row, column)| {
                let pixel = ImagePoint::new(
                    grid_position_px(column, columns, image_size.width),
                    grid_position_px(row, rows, image_size.height),
                );
                let sigma_px = uncertainty
                    .overlay_sigma_px(camera, pixel)
                    .unwrap_or(f64::INFINITY);
                (f64::from(u16::MAX) * heat_level(sigma_px, image_size)).round() as u16
            })
            .collect();
        Self {
            size: HEAT_GRID,
            image_size,
            levels,
        }
    }
}

/// The coordinate of a grid's column or row: the first of `count` lies on one border of the
/// picture, the last on the opposite one.
fn grid_position_px(index: u32, count: u32, length_px: u32) -> f64 {
    f64::from(index) / f64::from(count - 1) * f64::from(length_px)
}

/// The position of a 1-σ on the colour scale: 0 is the first colour, 1 the last. `sigma_px` is in
/// px of the picture.
pub fn heat_level(sigma_px: f64, image_size: ImageSize) -> f64 {
    let (from_px, to_px) = HEAT_FROM_TO_PX;
    let share = (sigma_px / image_size.scale_from_1920() / from_px).ln() / (to_px / from_px).ln();
    // A scale by factors: each colour stands for twice the 1-σ of the one before. NaN means
    // unknown: show it as the most uncertain.
    if share.is_nan() {
        1.0
    } else {
        share.clamp(0.0, 1.0)
    }
}

/// The 1-σ of each colour of the scale, px of the picture.
pub fn heat_ticks_px(image_size: ImageSize) -> [f64; HEAT_STOPS.len()] {
    let (from_px, to_px) = HEAT_FROM_TO_PX;
    let steps = (HEAT_STOPS.len() - 1) as f64;
    std::array::from_fn(|index| {
        from_px * (to_px / from_px).powf(index as f64 / steps) * image_size.scale_from_1920()
    })
}

/// A band of ±1-σ around the lines, in which they truly lie in 68 of 100 frames.
pub fn band(
    uncertainty: &Uncertainty,
    field: &FieldModel,
    camera: &PtzCamera,
    image_size: ImageSize,
    style: &OverlayStyle,
) -> Drawing {
    /// Maximum distance between points at which the width of the band is computed, px of the
    /// picture.
    const STEP_PX: f64 = 60.0;
    let [r, g, b] = style.colour;
    let colour = Colour::rgb(r, g, b);
    let mut drawing = Drawing::default();
    let mut borders = Vec::new();
    for line in project_lines(field, camera, image_size, &MarkingOptions::default()) {
        let points = resample_polyline(&line.points, STEP_PX);
        let Some([left, right]) = sides(&points, uncertainty, camera) else {
            continue;
        };
        // The area between the borders as one polygon: one side forwards, the other backwards.
        let mut corners = left.clone();
        corners.extend(right.iter().rev());
        drawing.areas.push(Area {
            corners,
            colour: colour.with_alpha(70),
        });
        borders.extend([left, right].map(|points| Stroke {
            points,
            colour,
            width_pt: 1.0,
            outline: None,
            dash: None,
        }));
    }
    let ImageSize { width, height } = image_size;
    let clip_px = Some([0.0, 0.0, width as f32, height as f32]);
    drawing.strokes.push(StrokeGroup {
        strokes: borders,
        opacity: 0.6,
        clip_px,
    });
    drawing
}

/// The two borders of the band along a polyline. `None` for fewer than two points with a
/// covariance.
fn sides(
    points: &[ImagePoint],
    uncertainty: &Uncertainty,
    camera: &PtzCamera,
) -> Option<[Vec<[f32; 2]>; 2]> {
    let (mut left, mut right) = (
        Vec::with_capacity(points.len()),
        Vec::with_capacity(points.len()),
    );
    for (index, point) in points.iter().enumerate() {
        let before = points.get(index.wrapping_sub(1)).unwrap_or(point);
        let after = points.get(index + 1).unwrap_or(point);
        // The component of the covariance across the line: √(nᵀ Σ n), with the unit normal n.
        // The direction at a point is that of its two neighbours; the ends have one.
        let along = after.offset_from(*before).try_normalize(1e-9)?;
        let across = Vec2::new(-along.y, along.x);
        let Some(covariance) = uncertainty.overlay_at(camera, *point) else {
            continue;
        };
        let half = across * (across.transpose() * covariance * across).x.max(0.0).sqrt();
        let place = |at: ImagePoint| [at.x as f32, at.y as f32];
        left.push(place(point.translate(half)));
        right.push(place(point.translate(-half)));
    }
    (left.len() > 1).then_some([left, right])
}

/// Resamples a polyline so that its points are at most `step_px` apart, and not much less.
fn resample_polyline(points: &[ImagePoint], step_px: f64) -> Vec<ImagePoint> {
    let Some(first) = points.first() else {
        return Vec::new();
    };
    let mut found = vec![*first];
    for pair in points.windows(2) {
        let way = pair[1].offset_from(pair[0]);
        let parts = (way.norm() / step_px).ceil().max(1.0);
        found.extend(
            (1..=parts as usize).map(|part| pair[0].translate(way * (part as f64 / parts))),
        );
    }
    // Curves have far more points than a band needs: keep one about every sixth of a step.
    let last = found[found.len() - 1];
    let mut kept: Vec<ImagePoint> = Vec::with_capacity(found.len());
    for point in found {
        if kept
            .last()
            .is_none_or(|before| before.distance_px(point) >= step_px / 6.0)
        {
            kept.push(point);
        }
    }
    if kept.last().is_some_and(|end| end.distance_px(last) > 1e-6) {
        kept.push(last);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::{BaseSigma, CameraBase};
    use touchline_core::geometry::Vec3;
    use touchline_core::solve::Observation;
    use touchline_core::testing::{SIZE, TestBase, base_at, soccer};

    fn solved() -> (FieldModel, PtzCamera, Uncertainty) {
        let field = soccer();
        let base = CameraBase {
            sigma: BaseSigma {
                position_m: Vec3::repeat(0.2),
                rotation: Vec3::new(1e-3, 1e-3, 0.0),
                ..BaseSigma::default()
            },
            ..base_at([0.0, -60.0, 18.0], SIZE)
        };
        let camera = base.aim(0.0, -13.0, 1500.0);
        let click = |name: &str| {
            let at = camera
                .image_from_world(field.landmark(name).unwrap().nominal_m)
                .unwrap();
            Observation::from_landmark(&field, name, at, SIZE, 0).unwrap()
        };
        let clicks = [click("centre_mark"), click("centre_circle_right")];
        let uncertainty = Uncertainty::from_observations(&camera, &clicks, None).unwrap();
        (field, camera, uncertainty)
    }

    #[test]
    fn a_heat_map_is_dark_between_the_clicks_and_bright_in_a_corner() {
        let (_, camera, uncertainty) = solved();
        let map = HeatMap::new(&uncertainty, &camera, SIZE);
        assert_eq!(map.levels.len(), (HEAT_GRID[0] * HEAT_GRID[1]) as usize);
        let at = |column: u32, row: u32| map.levels[(row * HEAT_GRID[0] + column) as usize];
        assert!(at(32, 22) < at(0, 39), "{} {}", at(32, 22), at(0, 39));
    }

    #[test]
    fn the_scale_runs_from_its_first_tick_to_its_last() {
        for size in [SIZE, ImageSize::new(640, 360)] {
            let ticks = heat_ticks_px(size);
            for (index, tick) in ticks.iter().enumerate() {
                let level = heat_level(*tick, size);
                assert!((level - index as f64 / 4.0).abs() < 1e-9, "{tick} {level}");
            }
            assert_eq!(heat_level(0.0, size), 0.0);
            assert_eq!(
                (heat_level(f64::INFINITY, size), heat_level(f64::NAN, size)),
                (1.0, 1.0)
            );
        }
    }

    #[test]
    fn a_band_is_as_wide_as_the_line_is_unsure() {
        let (field, camera, uncertainty) = solved();
        let drawing = band(
            &uncertainty,
            &field,
            &camera,
            SIZE,
            &OverlayStyle::default(),
        );
        assert!(
            !drawing.areas.is_empty()
                && drawing.areas.len() * 2 == drawing.strokes[0].strokes.len()
        );
        let points = resample_polyline(
            &[ImagePoint::new(0.0, 0.0), ImagePoint::new(100.0, 0.0)],
            60.0,
        );
        assert_eq!(points, [0.0, 50.0, 100.0].map(|x| ImagePoint::new(x, 0.0)));
        let [left, right] = sides(&points, &uncertainty, &camera).unwrap();
        let covariance = uncertainty.overlay_at(&camera, points[1]).unwrap();
        let half = f64::from(left[1][1] - right[1][1]).abs() / 2.0;
        assert!((half - covariance[(1, 1)].sqrt()).abs() < 1e-3, "{half}");
    }
}
