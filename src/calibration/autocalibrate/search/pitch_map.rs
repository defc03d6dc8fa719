//! The painted lines of a field, and which of them a camera sees nearest to a ground point.

use super::painted_curves::{CurveGrid, Endless, NearOfKinds, nearest_of, nearest_parameter};
use super::places::relative_size;
use touchline_core::field::{Crown, Curve, FieldModel};
use touchline_core::geometry::{Vec2, Vec3};

/// The height of a camera of a soccer match, m. Below it angles between distant lines shrink in
/// proportion to the height.
const USUAL_HEIGHT_M: f64 = 15.0;

/// They are not taken as smaller than this share, however low the camera is.
const LEAST_SHARE: f64 = 0.4;

/// The factor on angular tolerances for a camera at a height (m) above a field of some size relative
/// to a soccer pitch: 1 from the usual height on.
pub fn angular_scale(height_m: f64, relative_size: f64) -> f64 {
    (height_m / (USUAL_HEIGHT_M * relative_size)).clamp(LEAST_SHARE, 1.0)
}

/// The painted lines of a field. They are indexed on the flat field; the crown is added to the
/// points that are returned.
pub struct PitchMap {
    crown: Crown,
    /// The painted curves, each with the index of its line in the field.
    curves: Vec<(usize, Curve)>,
    /// The infinite line or full circle of each curve.
    endless: Vec<Endless>,
    /// None if each look-up goes through all curves.
    grid: Option<CurveGrid>,
    /// By [`relative_size`].
    relative_size: f64,
}

/// The point of a line that is nearest to a direction or a ground point, on the crowned ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnLine {
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
pub struct Scatter {
    pub sideways_squared: f64,
    pub upright_squared: f64,
}

/// The view of a ground point from a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
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
        let mut map = Self::without_grid(field);
        map.grid = Some(CurveGrid::new(field, &map.curves, map.relative_size));
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
            relative_size: relative_size(field),
        }
    }

    /// The size of the field relative to a soccer pitch.
    pub const fn relative_size(&self) -> f64 {
        self.relative_size
    }

    /// The factor on angular tolerances for a camera at a height (m): 1 from the usual height on.
    pub fn angular_scale(&self, height_m: f64) -> f64 {
        angular_scale(height_m, self.relative_size)
    }

    /// The nearest curve of each kind to a ground point; none outside the grid, if there is one.
    #[inline]
    fn near(&self, place: Vec3) -> Option<NearOfKinds> {
        match &self.grid {
            Some(grid) => grid.near(place),
            None => Some(nearest_of(&self.curves, place, self.relative_size)),
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
        // The nearest on the ground of each kind; the nearest in the picture among these.
        let [along, across, arc] = self.near(place)?.map(|curve| {
            curve.map_or(f64::INFINITY, |curve| {
                self.beside_curve_squared(curve, place.xy(), view, scatter)
            })
        });
        Some(along.min(across).min(arc))
    }

    /// [`Self::beside_squared`] for one curve, by its index, without its ends.
    #[inline]
    fn beside_curve_squared(&self, curve: u16, place: Vec2, view: View, scatter: Scatter) -> f64 {
        let View {
            over_ground,
            fall_squared,
        } = view;
        let (across_m, tangent) = self.endless[usize::from(curve)].across(place);
        let along_squared = tangent.dot(&over_ground).powi(2);
        let side_squared = tangent.perp(&over_ground).powi(2);
        let seen = side_squared * scatter.upright_squared
            + along_squared * fall_squared * scatter.sideways_squared;
        across_m * across_m * fall_squared / seen
    }

    /// The line that a camera sees nearest to a ground point, and the foot of the perpendicular on
    /// it; none outside the grid.
    pub fn nearest(&self, place: Vec3, eye_m: Vec3) -> Option<OnLine> {
        let direction = (place - eye_m).normalize();
        // Of the candidates on the ground, the nearest as an angle.
        let near = self.near(place)?.into_iter().flatten().map(|curve| {
            let foot = self.foot_on_curve(curve, place);
            (foot.sine_of_distance(eye_m, direction), foot)
        });
        near.min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, foot)| foot)
    }

    /// The point of a curve, by its index, that is nearest to a ground point.
    fn foot_on_curve(&self, curve: u16, place: Vec3) -> OnLine {
        let (line, curve) = &self.curves[usize::from(curve)];
        let parameter = nearest_parameter(curve, Vec3::new(place.x, place.y, 0.0));
        self.on_line(*line, curve, parameter)
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
