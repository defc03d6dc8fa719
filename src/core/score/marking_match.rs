//! Matching of whole markings: the measure of the `SoccerNet` camera calibration task.
//!
//! A marking is found (TP) if the estimate shows it and every annotated point of it lies within t
//! px of its projection. It is a false positive (FP) if the estimate shows it but it was not
//! annotated, or if a point is farther off. It is a false negative (FN) if it was annotated but the
//! estimate does not show it. `JaC@t` = TP / (TP + FP + FN), with t in px of a picture 960 px wide.
//!
//! The field is symmetric, so the value is the better one of two namings: as annotated, and rotated
//! by 180° about the field's centre. The better one is chosen for each threshold separately,
//! because the task is run once per threshold. A marking that leaves the picture and re-enters it,
//! as a circle at the border does, is one polyline: the task joins the two points by a straight
//! segment, and a point near that segment counts as near the marking.
//!
//! Completeness is the share of frames that have a camera, and the task's score is completeness
//! times the mean `JaC@5` over those. Source: the task's `evaluate_camera.py` of 2023
//! (`get_polylines`, `evaluate_camera_prediction`).

use super::FieldView;
use super::camera_error::same_names;
use crate::camera::PtzCamera;
use crate::field::{Curve, FieldModel, Symmetry};
use crate::geometry::{ImagePoint, ImageSize};
use crate::markings::{MarkingOptions, project_lines};

/// The picture width to which the thresholds in px refer.
pub const JACCARD_WIDTH_PX: f64 = 960.0;
/// Shorter markings are ignored, m: the task has no class for corner arcs.
const MIN_LENGTH_M: f64 = 2.0;
/// Number of points that are annotated on a circle or arc.
const POINTS_PER_ARC: usize = 9;

/// The annotation of a marking: points on it.
#[derive(Clone, Debug, PartialEq)]
pub struct AnnotatedLine {
    /// Which line: index into [`FieldModel::lines`].
    pub line: usize,
    /// The two ends of the visible part of a straight marking, or points along a round one; px of
    /// the picture.
    pub points: Vec<ImagePoint>,
}

/// The match of the markings of one picture, for both namings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MarkingMatch {
    /// With the names as annotated.
    pub plain: NamedMatch,
    /// With the names rotated by 180° about the field's centre.
    pub turned: NamedMatch,
}

/// The match of the markings of one picture under one naming.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NamedMatch {
    /// For each marking that is annotated and shown by the estimate, the largest distance of its
    /// points, px at `JACCARD_WIDTH_PX`.
    pub worst_px: Vec<f64>,
    /// Number of markings that the estimate shows and that were not annotated.
    pub only_estimated: usize,
    /// Number of markings that were annotated and that the estimate does not show.
    pub only_annotated: usize,
}

/// The visible polylines (px) of each marking, by line index.
type VisiblePolylines = Vec<Vec<Vec<ImagePoint>>>;

/// Projects all markings of sufficient length.
fn visible_lines(field: &FieldModel, camera: &PtzCamera, size: ImageSize) -> VisiblePolylines {
    let options = MarkingOptions {
        margin_px: 0.0,
        ..MarkingOptions::default()
    };
    let mut seen: VisiblePolylines = vec![Vec::new(); field.lines.len()];
    for polyline in project_lines(field, camera, size, &options) {
        if counts(field, polyline.line) {
            seen[polyline.line].push(polyline.points);
        }
    }
    seen
}

fn counts(field: &FieldModel, line: usize) -> bool {
    field.lines[line].curve.length_m() >= MIN_LENGTH_M
}

/// The points that an annotator would place on a picture of this camera: the two ends of the
/// visible part of each straight marking, and nine points along the visible part of each round one.
pub fn annotated_lines(
    field: &FieldModel,
    camera: &PtzCamera,
    size: ImageSize,
) -> Vec<AnnotatedLine> {
    let seen = visible_lines(field, camera, size);
    let shown = seen
        .iter()
        .enumerate()
        .filter(|(_, parts)| !parts.is_empty());
    shown
        .map(|(line, parts)| {
            let points = match field.lines[line].curve {
                // A segment that a fold or the border cuts into parts still has two ends.
                Curve::Segment { .. } => {
                    let (first, last) = (
                        parts.first().and_then(|p| p.first()),
                        parts.last().and_then(|p| p.last()),
                    );
                    first.into_iter().chain(last).copied().collect()
                }
                Curve::Arc { .. } => spread_along(parts),
            };
            AnnotatedLine { line, points }
        })
        .collect()
}

/// Points at equal distances along some polylines, including both ends.
fn spread_along(parts: &[Vec<ImagePoint>]) -> Vec<ImagePoint> {
    // One pass along all pieces: `passed` is the arc length before the current piece, and point i
    // is due at i / 8 of the whole. Gaps between the parts have no length.
    let whole: f64 = pieces(parts).map(|(from, to)| from.distance_px(to)).sum();
    let mut points = Vec::with_capacity(POINTS_PER_ARC);
    let mut passed = 0.0;
    for (from, to) in pieces(parts) {
        let length = from.distance_px(to);
        while points.len() < POINTS_PER_ARC {
            // The arc length of the next point. Go on to the next piece if it lies beyond this one.
            let due = whole * points.len() as f64 / (POINTS_PER_ARC - 1) as f64;
            if due > passed + length {
                break;
            }
            let share = if length > 0.0 {
                (due - passed) / length
            } else {
                0.0
            };
            points.push(from.translate(to.offset_from(from) * share));
        }
        passed += length;
    }
    // Rounding may miss the last point.
    if let (Some(end), true) = (
        parts.last().and_then(|part| part.last()),
        points.len() < POINTS_PER_ARC,
    ) {
        points.push(*end);
    }
    points
}

/// The straight pieces of some polylines, by their ends.
fn pieces(parts: &[Vec<ImagePoint>]) -> impl Iterator<Item = (ImagePoint, ImagePoint)> {
    parts
        .iter()
        .flat_map(|part| part.windows(2))
        .map(|pair| (pair[0], pair[1]))
}

impl MarkingMatch {
    /// Compares annotated markings with those that the estimated camera shows of its own field.
    /// Short markings are skipped.
    pub fn compare(
        field: &FieldModel,
        annotated: &[AnnotatedLine],
        estimate: FieldView,
        size: ImageSize,
    ) -> Self {
        // The estimate may use another field (size or template); match lines by name.
        let mut of_estimate = visible_lines(estimate.field, estimate.camera, size);
        let twins = same_names(&field.lines, &estimate.field.lines, |line| line.id.as_str());
        let seen: VisiblePolylines = twins
            .iter()
            .map(|twin| {
                twin.map(|line| std::mem::take(&mut of_estimate[line]))
                    .unwrap_or_default()
            })
            .collect();
        let plain = NamedMatch::compare(field, annotated, &seen, size, Some);
        // Rotate the names of the annotation; that is equivalent to rotating the estimate.
        let turned = NamedMatch::compare(field, annotated, &seen, size, |line| {
            let twin = Symmetry::Turn180.line_twin(field, &field.lines[line])?;
            field.lines.iter().position(|other| other.id == twin.id)
        });
        Self { plain, turned }
    }

    /// `JaC@t`: the share of markings found within t px at `JACCARD_WIDTH_PX`, of all that are
    /// annotated or shown, with the better naming. 0 without markings.
    pub fn jaccard(&self, threshold_px: f64) -> f64 {
        self.plain
            .jaccard(threshold_px)
            .max(self.turned.jaccard(threshold_px))
    }
}

impl NamedMatch {
    /// Matches annotated markings with visible ones. `renamed` gives the name under which a marking
    /// is looked up.
    fn compare(
        field: &FieldModel,
        annotated: &[AnnotatedLine],
        seen: &VisiblePolylines,
        size: ImageSize,
        renamed: impl Fn(usize) -> Option<usize>,
    ) -> Self {
        let scale = JACCARD_WIDTH_PX / f64::from(size.width);
        let mut found = Self::default();
        let mut named = vec![false; seen.len()];
        // A marking without points would be found wherever the estimate shows it.
        for marking in annotated
            .iter()
            .filter(|marking| counts(field, marking.line) && !marking.points.is_empty())
        {
            // On a field without that symmetry the marking has no other name, so it cannot be
            // found.
            let Some(line) = renamed(marking.line) else {
                found.only_annotated += 1;
                continue;
            };
            named[line] = true;
            if seen[line].is_empty() {
                found.only_annotated += 1;
                continue;
            }
            // The worst point decides at which thresholds the marking is found.
            let distances = marking
                .points
                .iter()
                .map(|point| distance_px(*point, &seen[line]) * scale);
            found.worst_px.push(distances.fold(0.0, f64::max));
        }
        found.only_estimated = (0..seen.len())
            .filter(|&line| !named[line] && !seen[line].is_empty())
            .count();
        found
    }

    /// `JaC@t` with this naming.
    pub fn jaccard(&self, threshold_px: f64) -> f64 {
        let all = self.worst_px.len() + self.only_estimated + self.only_annotated;
        let found = self
            .worst_px
            .iter()
            .filter(|worst| **worst < threshold_px)
            .count();
        if all == 0 {
            0.0
        } else {
            found as f64 / all as f64
        }
    }
}

/// Distance of a point, px, from the polyline that joins all parts in order, as in the task.
fn distance_px(point: ImagePoint, parts: &[Vec<ImagePoint>]) -> f64 {
    point.distance_from_polyline_px(&parts.concat())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{SIZE, TestBase, base_at, soccer, turned_base};

    fn broadcast(pan_deg: f64, tilt_deg: f64, focal_px: f64) -> PtzCamera {
        base_at([0.0, -60.0, 15.0], SIZE).aim(pan_deg, tilt_deg, focal_px)
    }

    fn view<'a>(field: &'a FieldModel, camera: &'a PtzCamera) -> FieldView<'a> {
        FieldView { field, camera }
    }

    #[test]
    fn the_right_camera_finds_everything_and_names_are_free_up_to_half_a_turn() {
        let field = soccer();
        let truth = broadcast(30.0, -12.0, 2000.0);
        let annotated = annotated_lines(&field, &truth, SIZE);
        assert!(annotated.len() > 8, "{}", annotated.len());
        let right = MarkingMatch::compare(&field, &annotated, view(&field, &truth), SIZE);
        assert!((right.jaccard(1.0) - 1.0).abs() < 1e-12, "{right:?}");
        // From the other side, turned by half a turn, the same picture with the other names.
        let opposite = PtzCamera::new(
            turned_base([0.0, 60.0, 15.0], [180.0, 0.0, 0.0], SIZE),
            truth.ptz(),
        );
        let turned = MarkingMatch::compare(&field, &annotated, view(&field, &opposite), SIZE);
        assert!((turned.jaccard(1.0) - 1.0).abs() < 1e-9, "{turned:?}");
    }

    #[test]
    fn counts_of_a_known_case() {
        let plain = NamedMatch {
            worst_px: vec![2.0, 5.0, 12.0],
            only_estimated: 1,
            only_annotated: 2,
        };
        let found = MarkingMatch {
            plain,
            ..MarkingMatch::default()
        };
        // Strictly nearer: at 5 px one of six, at 10 two, at 20 three.
        assert_eq!(
            [5.0, 10.0, 20.0].map(|t| found.jaccard(t)),
            [1.0 / 6.0, 2.0 / 6.0, 3.0 / 6.0]
        );
        assert!(MarkingMatch::default().jaccard(5.0) == 0.0);
    }

    #[test]
    fn the_better_names_count_at_each_threshold_for_itself() {
        let plain = NamedMatch {
            worst_px: vec![3.0, 30.0],
            only_estimated: 0,
            only_annotated: 0,
        };
        let turned = NamedMatch {
            worst_px: vec![8.0, 9.0],
            only_estimated: 0,
            only_annotated: 0,
        };
        let found = MarkingMatch { plain, turned };
        assert_eq!([5.0, 10.0, 20.0].map(|t| found.jaccard(t)), [0.5, 1.0, 1.0]);
    }

    #[test]
    fn a_circle_that_leaves_the_picture_is_joined_where_it_comes_back() {
        // Two arcs of a circle at the right edge, cut where it is beyond x = 100.
        let point = |x: f64, y: f64| ImagePoint::new(x, y);
        let parts = vec![
            vec![point(60.0, 10.0), point(100.0, 20.0)],
            vec![point(100.0, 80.0), point(60.0, 90.0)],
        ];
        assert!((distance_px(point(98.0, 50.0), &parts) - 2.0).abs() < 1e-12);
        assert!((distance_px(point(55.0, 10.0), &parts) - 5.0).abs() < 1e-12);
    }

    #[test]
    fn thresholds_are_px_at_960() {
        // A pan of about 10 px at 1920 moves every point by about 5 at 960.
        let field = soccer();
        let truth = broadcast(0.0, -12.0, 2000.0);
        let annotated = annotated_lines(&field, &truth, SIZE);
        let off = broadcast((10.0f64 / 2000.0).to_degrees(), -12.0, 2000.0);
        let found = MarkingMatch::compare(&field, &annotated, view(&field, &off), SIZE);
        let worst = found.plain.worst_px.iter().copied().fold(0.0, f64::max);
        assert!((4.5..6.5).contains(&worst), "{found:?}");
        assert!(found.jaccard(20.0) > found.jaccard(4.0));
    }

    #[test]
    fn straight_markings_have_two_points_round_ones_nine_and_corner_arcs_none() {
        let field = soccer();
        let annotated = annotated_lines(&field, &broadcast(0.0, -12.0, 1000.0), SIZE);
        for marking in &annotated {
            let line = &field.lines[marking.line];
            let expected = if matches!(line.curve, Curve::Arc { .. }) {
                9
            } else {
                2
            };
            assert_eq!(marking.points.len(), expected, "{}", line.id);
            assert!(!line.id.as_str().starts_with("corner_arc"));
        }
        assert!(
            annotated
                .iter()
                .any(|marking| field.lines[marking.line].id.as_str() == "centre_circle")
        );
    }

    #[test]
    fn a_marking_without_points_is_not_annotated() {
        let (field, camera) = (soccer(), broadcast(0.0, -12.0, 2000.0));
        let mut annotated = annotated_lines(&field, &camera, SIZE);
        let last = annotated.pop().unwrap();
        let without = MarkingMatch::compare(&field, &annotated, view(&field, &camera), SIZE);
        annotated.push(AnnotatedLine {
            points: Vec::new(),
            ..last
        });
        let with = MarkingMatch::compare(&field, &annotated, view(&field, &camera), SIZE);
        assert_eq!(with, without);
        assert!(with.jaccard(5.0) < 1.0);
    }

    #[test]
    fn a_camera_that_looks_away_finds_nothing() {
        let field = soccer();
        let annotated = annotated_lines(&field, &broadcast(0.0, -12.0, 2000.0), SIZE);
        let found = MarkingMatch::compare(
            &field,
            &annotated,
            view(&field, &broadcast(0.0, 60.0, 2000.0)),
            SIZE,
        );
        assert_eq!(
            (found.plain.only_annotated, found.plain.only_estimated),
            (annotated.len(), 0)
        );
        assert!(found.jaccard(20.0) == 0.0);
    }
}
