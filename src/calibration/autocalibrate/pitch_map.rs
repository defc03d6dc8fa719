//! The painted lines of a field, and which of them a camera sees nearest to a ground point.

use touchline_core::field::{Crown, Curve, FieldModel};
use touchline_core::geometry::{Vec2, Vec3};

/// Side of a cell, m. The search reads cells in random order; at this size those of a whole field
/// fit into the cache of a core.
const CELL_M: f64 = 0.5;

/// How far beyond the field the map reaches, m.
const BEYOND_M: f64 = 12.0;

/// A point this far beyond the end of a line still counts as beside it, m.
const OVERSHOOT_M: f64 = 2.0;

/// Number of kinds of curves: lines along the field, lines across it, and arcs.
///
/// A low camera sees the ground so foreshortened that the line nearest on the ground is rarely the
/// nearest in the picture. The latter is, however, one of the nearest of each kind, so the grid
/// stores one curve of each.
const KINDS: usize = 3;

/// The painted lines of a field. They are indexed on the flat field; the crown is added to the
/// points that are returned.
pub(super) struct PitchMap {
    crown: Crown,
    /// The painted curves, each with the index of its line in the field.
    curves: Vec<(usize, Curve)>,
    /// The infinite line or full circle of each curve.
    endless: Vec<Endless>,
    /// None if each look-up goes through all curves.
    grid: Option<Grid>,
}

/// The nearest curve of each kind, as an index into [`PitchMap::curves`].
type NearOfKinds = [Option<u16>; KINDS];

/// The nearest curves to the cell centres of a grid over the field and its surroundings.
struct Grid {
    half_length_m: f64,
    half_width_m: f64,
    columns: usize,
    rows: usize,
    near: Vec<NearOfKinds>,
}

impl Grid {
    /// The nearest curves to the cell that contains a ground point; none outside the grid.
    #[inline]
    fn near(&self, place: Vec3) -> Option<NearOfKinds> {
        let (column, row) = (
            (place.x + self.half_length_m) / CELL_M,
            (place.y + self.half_width_m) / CELL_M,
        );
        let inside =
            column >= 0.0 && row >= 0.0 && column < self.columns as f64 && row < self.rows as f64;
        inside.then(|| self.near[row as usize * self.columns + column as usize])
    }
}

/// The nearest curve of each kind to a point of the flat field.
fn nearest_of(curves: &[(usize, Curve)], place: Vec3) -> NearOfKinds {
    let mut nearest: [Option<(f64, u16)>; KINDS] = [None; KINDS];
    for (number, (_, curve)) in (0_u16..).zip(curves) {
        // Of equally near curves the first stays.
        let near = &mut nearest[kind_of(curve)];
        if let Some(distance_m) = across_m(curve, place)
            && near.is_none_or(|(nearest_m, _)| distance_m < nearest_m)
        {
            *near = Some((distance_m, number));
        }
    }
    nearest.map(|near| near.map(|(_, number)| number))
}

/// A curve without its ends.
#[derive(Clone, Copy)]
enum Endless {
    Line {
        /// Unit.
        along: Vec2,
        /// Signed distance of the line from the origin, m.
        offset_m: f64,
    },
    Circle {
        centre: Vec2,
        radius_m: f64,
    },
}

impl Endless {
    fn from_curve(curve: &Curve) -> Self {
        match *curve {
            Curve::Segment { from, .. } => {
                let along = direction(curve, from);
                Self::Line {
                    along,
                    offset_m: along.perp(&from.xy()),
                }
            }
            Curve::Arc {
                centre, radius_m, ..
            } => Self::Circle {
                centre: centre.xy(),
                radius_m,
            },
        }
    }

    /// The signed distance of a point from the curve, m, and the unit tangent at its foot.
    #[inline]
    fn across(&self, place: Vec2) -> (f64, Vec2) {
        match *self {
            Self::Line { along, offset_m } => (along.perp(&place) - offset_m, along),
            Self::Circle { centre, radius_m } => {
                let out = place - centre;
                let range_m = out.norm();
                (
                    range_m - radius_m,
                    Vec2::new(-out.y, out.x) / range_m.max(1e-9),
                )
            }
        }
    }
}

/// The point of a line that is nearest to a direction or a ground point, on the crowned ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OnLine {
    pub at: Vec3,
    /// Direction of the line in `world`, not normalised.
    pub tangent: Vec3,
    /// Index of the line in the field.
    pub line: usize,
    /// Position along the line, from 0 to 1.
    pub parameter: f64,
}

impl OnLine {
    /// The offset from this point to the point with the same parameter on another field of the same
    /// template, m.
    pub fn offset_on(&self, field: &FieldModel) -> Vec3 {
        let curve = field.lines[self.line].paint_centre;
        field
            .crown()
            .world_from_nominal(curve.point_at(self.parameter))
            - self.at
    }

    /// The angular distance of a unit direction from the line, as its sine: the distance from the
    /// plane through camera and line. Infinite for a line that points at the camera, which spans no
    /// plane.
    pub fn sine_of_distance(&self, eye_m: Vec3, direction: Vec3) -> f64 {
        let across = (self.at - eye_m).cross(&self.tangent);
        let length = across.norm();
        if length > 0.0 {
            (direction.dot(&across) / length).abs()
        } else {
            f64::INFINITY
        }
    }
}

/// Variance of a direction in pan (`sideways`) and in tilt (`upright`), rad².
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scatter {
    pub sideways_squared: f64,
    pub upright_squared: f64,
}

/// The view of a ground point from a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    /// Horizontal offset from the camera, m.
    pub over_ground: Vec2,
    /// The sine of the angle below the horizon, squared.
    pub fall_squared: f64,
}

impl View {
    pub fn new(place: Vec3, eye_m: Vec3) -> Self {
        let view = place - eye_m;
        Self {
            over_ground: view.xy(),
            fall_squared: view.z * view.z / view.norm_squared(),
        }
    }
}

impl PitchMap {
    /// With a grid of nearest curves, for many look-ups.
    pub fn with_grid(field: &FieldModel) -> Self {
        let (half_length_m, half_width_m) = (
            field.length_m / 2.0 + BEYOND_M,
            field.width_m / 2.0 + BEYOND_M,
        );
        let columns = (2.0 * half_length_m / CELL_M).ceil() as usize;
        let rows = (2.0 * half_width_m / CELL_M).ceil() as usize;
        let place = |cell: usize| {
            let x = (cell % columns) as f64 * CELL_M + CELL_M / 2.0 - half_length_m;
            let y = (cell / columns) as f64 * CELL_M + CELL_M / 2.0 - half_width_m;
            Vec3::new(x, y, 0.0)
        };
        let mut map = Self::without_grid(field);
        // Brute force over all curves for each cell centre.
        let near = (0..columns * rows)
            .map(|cell| nearest_of(&map.curves, place(cell)))
            .collect();
        map.grid = Some(Grid {
            half_length_m,
            half_width_m,
            columns,
            rows,
            near,
        });
        map
    }

    /// Without a grid, for fewer look-ups than a grid has cells. Each goes through all curves.
    pub fn without_grid(field: &FieldModel) -> Self {
        let painted = field
            .lines
            .iter()
            .enumerate()
            .filter(|(_, line)| line.painted);
        let curves: Vec<(usize, Curve)> = painted
            .map(|(number, line)| (number, line.paint_centre))
            .collect();
        let endless = curves
            .iter()
            .map(|(_, curve)| Endless::from_curve(curve))
            .collect();
        Self {
            crown: field.crown(),
            curves,
            endless,
            grid: None,
        }
    }

    /// The nearest curve of each kind to a ground point; none outside the grid, if there is one.
    #[inline]
    fn near(&self, place: Vec3) -> Option<NearOfKinds> {
        match &self.grid {
            Some(grid) => grid.near(place),
            None => Some(nearest_of(&self.curves, place)),
        }
    }

    /// The point where a ray meets the ground. `at` returns the point of the ray at a height, m.
    pub fn ground(&self, at: impl Fn(f64) -> Option<Vec3>) -> Option<Vec3> {
        /// Fixed-point iterations. The slope of a crown is at most about 0.01 and flat rays descend
        /// by about 0.05 per metre, so each iteration reduces the error to a fifth.
        const TIMES: usize = 2;
        let roughly = self.ground_roughly(&at)?;
        if self.crown.height_m == 0.0 {
            return Some(roughly);
        }
        (0..TIMES).try_fold(roughly, |ground, _| at(self.crown.ground_z(ground.y)))
    }

    /// [`Self::ground`] with one iteration: exact on flat ground, else within some decimetres.
    #[inline]
    pub fn ground_roughly(&self, at: impl Fn(f64) -> Option<Vec3>) -> Option<Vec3> {
        // The ground's height depends on y only, so that at the point with z = 0 is a good
        // estimate.
        let flat = at(0.0)?;
        if self.crown.height_m == 0.0 {
            Some(flat)
        } else {
            at(self.crown.ground_z(flat.y))
        }
    }

    /// The squared distance of a ground point from the nearest line as the camera sees it, in units
    /// of `scatter`; none outside the grid.
    ///
    /// Let d be the distance across the line on the ground, o the horizontal offset from the
    /// camera, t the unit tangent and β the angle below the horizon. An error δ of pan moves the
    /// ground point across the view by |o| δ, one of tilt along the view by |o| δ / (sin β cos β).
    /// With the variances p² of pan and q² of tilt, the component of both across the line has the
    /// variance (t·o)² p² + (t×o)² q² / (sin² β cos² β). The returned value is d² divided by that,
    /// with cos β taken as 1 and numerator and denominator multiplied by sin² β.
    #[inline]
    pub fn beside_squared(&self, place: Vec3, view: View, scatter: Scatter) -> Option<f64> {
        let View {
            over_ground,
            fall_squared,
        } = view;
        let beside = |curve: u16| {
            let (across_m, tangent) = self.endless[usize::from(curve)].across(place.xy());
            let along_squared = tangent.dot(&over_ground).powi(2);
            let side_squared = tangent.perp(&over_ground).powi(2);
            let seen = side_squared * scatter.upright_squared
                + along_squared * fall_squared * scatter.sideways_squared;
            across_m * across_m * fall_squared / seen
        };
        // The nearest on the ground of each kind; the nearest in the picture among these.
        let [along, across, arc] = self
            .near(place)?
            .map(|curve| curve.map_or(f64::INFINITY, beside));
        Some(along.min(across).min(arc))
    }

    /// The line that a camera sees nearest to a ground point, and the foot of the perpendicular on
    /// it; none outside the grid.
    pub fn nearest(&self, place: Vec3, eye_m: Vec3) -> Option<OnLine> {
        let direction = (place - eye_m).normalize();
        let on_line = |curve: u16| {
            let (line, curve) = &self.curves[usize::from(curve)];
            let on_line = self.on_line(
                *line,
                curve,
                nearest_parameter(curve, Vec3::new(place.x, place.y, 0.0)),
            );
            (on_line.sine_of_distance(eye_m, direction), on_line)
        };
        // Of the candidates on the ground, the nearest as an angle.
        let near = self.near(place)?.into_iter().flatten().map(on_line);
        near.min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, on_line)| on_line)
    }

    /// The point of a curve at a parameter, lifted onto the crowned ground.
    fn on_line(&self, line: usize, curve: &Curve, parameter: f64) -> OnLine {
        let (at, mut tangent) = (
            self.crown.world_from_nominal(curve.point_at(parameter)),
            curve.tangent_at(parameter),
        );
        // The ground is z = −c s(y) with the crown c, so the tangent rises by −c s′(y) per unit of
        // its y component.
        let [drop_by_y, _] = self.crown.drop_share_by_y_and_width(at.y);
        tangent.z -= self.crown.height_m * drop_by_y * tangent.y;
        OnLine {
            at,
            tangent,
            line,
            parameter,
        }
    }

    /// Points along all lines, at most `spacing_m` apart.
    pub fn samples(&self, spacing_m: f64) -> impl Iterator<Item = OnLine> + '_ {
        self.curves.iter().flat_map(move |(line, curve)| {
            // Both ends are sampled; even a very short curve has two samples.
            let count = (curve.length_m() / spacing_m).ceil().max(1.0);
            (0..=count as usize).map(move |step| self.on_line(*line, curve, step as f64 / count))
        })
    }
}

/// The index of a curve's kind ([`KINDS`]).
fn kind_of(curve: &Curve) -> usize {
    match *curve {
        Curve::Segment { from, to } if (to.x - from.x).abs() >= (to.y - from.y).abs() => 0,
        Curve::Segment { .. } => 1,
        Curve::Arc { .. } => 2,
    }
}

/// The unit tangent of a curve at its point nearest to `place`, on the flat field. Axis-parallel
/// lines, which are most, get it without rounding.
fn direction(curve: &Curve, place: Vec3) -> Vec2 {
    let along = match *curve {
        Curve::Segment { from, to } if from.y == to.y => return Vec2::x(),
        Curve::Segment { from, to } if from.x == to.x => return Vec2::y(),
        Curve::Segment { from, to } => (to - from).xy(),
        Curve::Arc { centre, .. } => Vec2::new(centre.y - place.y, place.x - centre.x),
    };
    along.try_normalize(0.0).unwrap_or_default()
}

/// The unsigned distance of a point across a curve, m; none more than [`OVERSHOOT_M`] beyond its
/// ends.
fn across_m(curve: &Curve, place: Vec3) -> Option<f64> {
    // The offset from the nearest point is perpendicular to the curve unless that point is an end;
    // its part along the curve is then the distance beyond the end.
    let nearest = curve.point_at(nearest_parameter(curve, place));
    let off = (place - nearest).xy();
    let along = direction(curve, nearest);
    (off.dot(&along).abs() <= OVERSHOOT_M).then(|| off.perp(&along).abs())
}

/// The parameter, from 0 to 1, of the point of a curve nearest to a point of its plane.
fn nearest_parameter(curve: &Curve, place: Vec3) -> f64 {
    match *curve {
        Curve::Segment { from, to } => {
            let along = to - from;
            let length_squared = along.norm_squared();
            if length_squared > 0.0 {
                ((place - from).dot(&along) / length_squared).clamp(0.0, 1.0)
            } else {
                0.0
            }
        }
        Curve::Arc {
            centre,
            start,
            sweep,
            ..
        } => {
            // The angle from the start of the arc in its own direction, in [0, 2π).
            let out = place - centre;
            let turn = std::f64::consts::TAU;
            let sign = if sweep.radians() < 0.0 { -1.0 } else { 1.0 };
            let extent = sweep.radians().abs();
            let from_start = (sign * (out.y.atan2(out.x) - start.radians())).rem_euclid(turn);
            if from_start <= extent {
                return from_start / extent;
            }
            // Outside the arc: the end that is nearer by angle.
            if from_start - extent < turn - from_start {
                1.0
            } else {
                0.0
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use touchline_core::field::builtin;

    fn map(crown_m: f64) -> PitchMap {
        PitchMap::with_grid(
            &builtin("soccer")
                .unwrap()
                .model(&BTreeMap::new(), crown_m)
                .unwrap(),
        )
    }

    #[test]
    fn a_low_camera_sees_another_line_nearest_than_one_from_above() {
        let map = map(0.0);
        // The centre of a cell, 1.8 m in front of the middle of the far touchline and 1.6 m beside
        // the halfway line.
        let place = Vec3::new(1.625, 32.125, 0.0);
        let is_across = |line: OnLine| line.tangent.x.abs() < 1e-9;
        assert!(is_across(
            map.nearest(place, Vec3::new(0.0, -60.0, 500.0)).unwrap()
        ));
        let eye_m = Vec3::new(0.0, -60.0, 6.0);
        assert!(!is_across(map.nearest(place, eye_m).unwrap()));
        let scatter = Scatter {
            sideways_squared: 0.02_f64.powi(2),
            upright_squared: 0.02_f64.powi(2),
        };
        let low = map
            .beside_squared(place, View::new(place, eye_m), scatter)
            .unwrap()
            .sqrt();
        // 1.815 m on the ground, at a distance of 92 m and 6 m below the camera.
        let expected = 1.815 * 6.0 / 92.0_f64.powi(2) / 0.02;
        assert!((low - expected).abs() < 0.02 * expected, "{low} {expected}");
        let far = Vec3::new(0.0, 90.0, 0.0);
        assert_eq!(
            map.beside_squared(far, View::new(far, eye_m), scatter),
            None,
            "far from the field"
        );
    }

    #[test]
    fn a_place_beside_a_line_belongs_to_it_and_one_beyond_its_end_does_not() {
        let map = map(0.0);
        // The near side of the left penalty area ends 16.5 m from the goal line.
        let high = Vec3::new(-36.0, -20.0, 300.0);
        let before = map.nearest(Vec3::new(-38.0, -20.6, 0.0), high).unwrap();
        let beyond = map.nearest(Vec3::new(-33.0, -20.16, 0.0), high);
        assert!(
            (before.at.y + 20.16).abs() < 0.1 && before.tangent.y.abs() < 1e-9,
            "{before:?}"
        );
        assert!(
            beyond.is_none_or(|line| line.line != before.line),
            "{beyond:?}"
        );
        // On an arc the tangent is perpendicular to the radius.
        let on_circle = map
            .nearest(Vec3::new(6.6, 6.4, 0.0), Vec3::new(0.0, 0.0, 300.0))
            .unwrap();
        assert!(
            on_circle.at.xy().dot(&on_circle.tangent.xy()).abs() < 1e-6,
            "{on_circle:?}"
        );
        assert!(
            (on_circle.at.xy().norm() - 9.15).abs() < 0.1,
            "{on_circle:?}"
        );
    }

    #[test]
    fn rays_meet_the_crowned_ground_and_lines_lie_on_it() {
        let (crowned, eye) = (map(0.2), Vec3::new(0.0, -60.0, 6.0));
        let towards = Vec3::new(5.0, 20.0, crowned.crown.ground_z(20.0)) - eye;
        let met = crowned
            .ground(|z_m| Some(eye + towards * ((z_m - eye.z) / towards.z)))
            .unwrap();
        assert!(
            (met - Vec3::new(5.0, 20.0, crowned.crown.ground_z(20.0))).norm() < 0.02,
            "{met:?}"
        );
        for on_line in crowned.samples(3.0) {
            assert!((on_line.at.z - crowned.crown.ground_z(on_line.at.y)).abs() < 1e-12);
            // The crown ends where the field does.
            if on_line.at.y.abs() > 33.9 {
                continue;
            }
            let step = 1e-4 * on_line.tangent;
            let along = crowned.crown.ground_z(on_line.at.y + step.y) - on_line.at.z;
            assert!((along - step.z).abs() < 1e-6, "{on_line:?}");
        }
    }
}
