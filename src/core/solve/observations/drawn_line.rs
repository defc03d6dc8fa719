//! The points that were drawn on one line of the field.

use crate::field::Curve;
use crate::geometry::{ImagePoint, Vec2, Vec3, keep_distinct};
use crate::solve::{Observation, ObservedShape, WorldCurve};
use nalgebra::Matrix2;

/// A line of the field with the points that were drawn on it.
#[derive(Clone, Debug)]
pub(in crate::solve) struct DrawnLine {
    pub curve: WorldCurve,
    /// Indices into the observations that the lines were grouped from.
    pub indices: Vec<usize>,
    /// The points, px, in the order of the observations.
    pub points: Vec<ImagePoint>,
    /// 1-σ of a point, px.
    pub sigma_px: f64,
}

/// A straight line of the picture, fitted to points.
#[derive(Clone, Copy, Debug)]
pub(in crate::solve) struct StraightLine {
    /// The points' centroid.
    pub middle: ImagePoint,
    /// Unit vector along it.
    pub along: Vec2,
    /// The outermost points along it.
    pub ends: [ImagePoint; 2],
    /// The sum of the points' squared distances from their centroid, along the line, px².
    spread: f64,
    count: f64,
}

/// Points nearer together than this are one point, in sigmas of a drawn point.
const SAME_POINT_SIGMAS: f64 = 1.0;

impl DrawnLine {
    /// The lines of a picture's observations, in the order of their first points; landmarks are
    /// left out.
    pub fn group(observations: &[Observation]) -> Vec<Self> {
        let mut lines: Vec<Self> = Vec::new();
        for (index, observation) in observations.iter().enumerate() {
            let ObservedShape::Curve(curve) = observation.shape else {
                continue;
            };
            if let Some(line) = lines.iter_mut().find(|line| line.curve == curve) {
                line.indices.push(index);
                line.points.push(observation.image);
            } else {
                lines.push(Self {
                    curve,
                    indices: vec![index],
                    points: vec![observation.image],
                    sigma_px: observation.sigma_px,
                });
            }
        }
        lines
    }

    /// The two ends of a straight line of the field, nominal and without the crown, `world`, m;
    /// none for a circle or an arc.
    pub fn segment(&self) -> Option<[Vec3; 2]> {
        match *self.curve.nominal() {
            Curve::Segment { from, to } => Some([from, to]),
            Curve::Arc { .. } => None,
        }
    }

    /// How many points there are, those that coincide counted once, and at most `most`.
    pub fn distinct_points(&self, most: usize) -> usize {
        let same_px = SAME_POINT_SIGMAS * self.sigma_px;
        keep_distinct(&self.points, most, |one, other| {
            one.distance_px(**other) > same_px
        })
        .len()
    }

    /// The straight line of the picture nearest to the points (total least squares); none for a
    /// circle or an arc, and where the points coincide.
    pub fn straight(&self) -> Option<StraightLine> {
        // Relative to a point, so that the squares do not cancel far from the picture's corner.
        self.segment()?;
        let first = *self.points.first()?;
        let count = self.points.len() as f64;
        let mean = self.offsets_from(first).sum::<Vec2>() / count;
        let scatter: Matrix2<f64> = self
            .offsets_from(first)
            .map(|offset| (offset - mean) * (offset - mean).transpose())
            .sum();
        // The line runs along the eigenvector of the largest eigenvalue, which is the sum of the
        // squares along it. If that is within a drawn point's noise, the direction is noise as
        // well.
        let eigen = scatter.symmetric_eigen();
        let most = eigen.eigenvalues.imax();
        let spread = eigen.eigenvalues[most];
        if !(spread > (SAME_POINT_SIGMAS * self.sigma_px).powi(2)) {
            return None;
        }
        let (middle, along) = (
            first.translate(mean),
            eigen.eigenvectors.column(most).into_owned(),
        );
        Some(StraightLine {
            middle,
            along,
            ends: outermost(&self.points, middle, along)?,
            spread,
            count,
        })
    }

    /// From a point to each of the drawn ones, px.
    fn offsets_from(&self, origin: ImagePoint) -> impl Iterator<Item = Vec2> {
        self.points
            .iter()
            .map(move |point| point.offset_from(origin))
    }
}

/// The first and the last of some points along a direction; none without points.
fn outermost(points: &[ImagePoint], middle: ImagePoint, along: Vec2) -> Option<[ImagePoint; 2]> {
    let shares = points
        .iter()
        .map(|point| (point.offset_from(middle).dot(&along), *point));
    let (_, first) = shares.clone().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let (_, last) = shares.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some([first, last])
}

impl StraightLine {
    /// Where it crosses another line, px; none where they are parallel.
    pub fn crossing(&self, other: &Self) -> Option<ImagePoint> {
        // m + t u lies on the other line where (m + t u − m') × u' = 0; parallel lines divide by
        // zero.
        let sine = self.along.perp(&other.along);
        let share = other.middle.offset_from(self.middle).perp(&other.along) / sine;
        let crossing = self.middle.translate(self.along * share);
        crossing.is_finite().then_some(crossing)
    }

    /// The distance of a point from it, px.
    pub fn distance_px(&self, point: ImagePoint) -> f64 {
        self.along.perp(&point.offset_from(self.middle)).abs()
    }

    /// 1-σ of the line across itself beside a point, as a multiple of that of one drawn point.
    pub fn sigma_at(&self, point: ImagePoint) -> f64 {
        // Centroid and direction of a fitted line are uncorrelated: variances σ² / n and σ² / Σ t²,
        // the latter with the squared distance from the centroid.
        let away = point.offset_from(self.middle).dot(&self.along);
        (1.0 / self.count + away * away / self.spread).sqrt()
    }
}
