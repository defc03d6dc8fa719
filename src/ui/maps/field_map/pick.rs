//! Finds the landmark or line under the pointer on the field map.

use crate::ui::drawing::placement::Placement;
use egui::{Pos2, Vec2, vec2};
use touchline_application::scene::field_map::FieldMap;
use touchline_core::field::{Curve, FieldModel, Landmark};
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::Target;

/// Distance within which a landmark is picked, points.
const LANDMARK_REACH_PT: f32 = 12.0;
/// Distance within which a line is picked, points.
const LINE_REACH_PT: f32 = 8.0;
/// How far outwards a landmark is drawn if another one is below it, points. From above, both ends
/// of a post are in one place.
const RAISED_PT: f32 = 9.0;
/// Horizontal distance below which one landmark counts as above the other, m.
const SAME_PLACE_M: f64 = 0.3;
/// Number of segments that approximate a curve.
const PIECES: u32 = 48;

/// Where each landmark is drawn on the screen, in the field's order.
pub fn spots(field: &FieldModel, map: &FieldMap, placement: &Placement) -> Vec<Pos2> {
    // Every landmark is compared with every other one; a field has some dozens of them.
    field
        .landmarks
        .iter()
        .map(|landmark| {
            // A landmark above another one is drawn beside it, so that both can be picked.
            let stands_above = field.landmarks.iter().any(|other| {
                let apart = other.nominal_m.xy() - landmark.nominal_m.xy();
                apart.norm() < SAME_PLACE_M && other.nominal_m.z < landmark.nominal_m.z
            });
            let away = if stands_above {
                outwards(field, map, landmark) * RAISED_PT
            } else {
                Vec2::ZERO
            };
            placement.screen_from_image(map.map_from_world(landmark.nominal_m)) + away
        })
        .collect()
}

/// The direction on the map that points out of the field, across the border that the landmark is
/// on. Upwards for a landmark within the field.
fn outwards(field: &FieldModel, map: &FieldMap, landmark: &Landmark) -> Vec2 {
    // World y points up on the map and screen y down; a map that is rotated by 180° reverses both
    // axes.
    let sign = if map.turned { -1.0 } else { 1.0 };
    let away = sign
        * vec2(
            side_of_field(landmark.nominal_m.x, field.length_m),
            -side_of_field(landmark.nominal_m.y, field.width_m),
        );
    if away == Vec2::ZERO {
        Vec2::UP
    } else {
        away.normalized()
    }
}

/// The border that a coordinate is on, m from the middle of the field: 1 for the upper one, -1 for
/// the lower one, 0 for none.
fn side_of_field(at_m: f64, extent_m: f64) -> f32 {
    /// A coordinate beyond this share of half the extent counts as on the border.
    const BORDER: f64 = 0.98;
    if at_m.abs() > BORDER * extent_m / 2.0 {
        at_m.signum() as f32
    } else {
        0.0
    }
}

/// The landmark under the pointer, else the line; only a line if `lines`. `spots` comes from
/// [`spots`].
pub fn under(
    field: &FieldModel,
    map: &FieldMap,
    placement: &Placement,
    spots: &[Pos2],
    at: Pos2,
    lines: bool,
) -> Option<Target> {
    let landmark = if lines {
        None
    } else {
        landmark_under(field, spots, at)
    };
    landmark.or_else(|| line_under(field, map, placement, at))
}

/// The landmark that is drawn nearest to the pointer, within reach.
fn landmark_under(field: &FieldModel, spots: &[Pos2], at: Pos2) -> Option<Target> {
    let near = field
        .landmarks
        .iter()
        .zip(spots)
        .map(|(landmark, spot)| (landmark, spot.distance(at)));
    let nearest = near
        .filter(|(_, distance)| *distance <= LANDMARK_REACH_PT)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    nearest.map(|(landmark, _)| Target::Landmark(landmark.id.clone()))
}

/// The line that is drawn nearest to the pointer, within reach.
fn line_under(
    field: &FieldModel,
    map: &FieldMap,
    placement: &Placement,
    at: Pos2,
) -> Option<Target> {
    let near = field
        .lines
        .iter()
        .map(|line| (line, distance_to_curve(&line.curve, map, placement, at)));
    let nearest = near
        .filter(|(_, distance)| *distance <= LINE_REACH_PT)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    nearest.map(|(line, _)| Target::Line(line.id.clone()))
}

/// A curve of the field as a polyline on the screen.
pub fn on_screen(curve: &Curve, map: &FieldMap, placement: &Placement) -> Vec<Pos2> {
    // The map scales and rotates, so a straight line of the field is one on the map, too.
    let pieces = if matches!(curve, Curve::Segment { .. }) {
        1
    } else {
        PIECES
    };
    (0..=pieces)
        .map(|piece| curve.point_at(f64::from(piece) / f64::from(pieces)))
        .map(|point| placement.screen_from_image(map.map_from_world(point)))
        .collect()
}

/// Distance of a place on the screen from a curve, points.
fn distance_to_curve(curve: &Curve, map: &FieldMap, placement: &Placement, at: Pos2) -> f32 {
    let point = |at: &Pos2| ImagePoint::new(f64::from(at.x), f64::from(at.y));
    let points: Vec<ImagePoint> = on_screen(curve, map, placement).iter().map(point).collect();
    let distances = points
        .windows(2)
        .map(|ends| point(&at).distance_from_segment_px(ends[0], ends[1]) as f32);
    distances.min_by(f32::total_cmp).unwrap_or(f32::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Rect, pos2};
    use std::path::Path;
    use touchline_application::app::session::PictureView;
    use touchline_documents::document::FieldSpec;

    fn soccer() -> FieldModel {
        FieldSpec::new("soccer").model(Path::new("")).unwrap()
    }

    fn scene(turned: bool) -> (FieldModel, FieldMap, Placement) {
        let field = soccer();
        let map = FieldMap {
            turned,
            ..FieldMap::new(&field, 6.0, 10.0)
        };
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(300.0, 195.0));
        let placement = Placement::new(rect, 1.0, map.size_px(), PictureView::Fit);
        (field, map, placement)
    }

    #[test]
    fn every_landmark_can_be_picked_on_the_whole_map_turned_or_not() {
        for turned in [false, true] {
            let (field, map, placement) = scene(turned);
            let spots = spots(&field, &map, &placement);
            for (landmark, spot) in field.landmarks.iter().zip(&spots) {
                let picked = under(&field, &map, &placement, &spots, *spot, false);
                assert_eq!(
                    picked,
                    Some(Target::Landmark(landmark.id.clone())),
                    "{}",
                    landmark.label
                );
            }
        }
    }

    #[test]
    fn away_from_landmarks_or_on_demand_a_line_is_picked() {
        let (field, map, placement) = scene(false);
        let spots = spots(&field, &map, &placement);
        let at = pos2(placement.rect.center().x, placement.rect.top() + 60.0);
        let pick = |at, lines| under(&field, &map, &placement, &spots, at, lines);
        assert_eq!(pick(at, false), Some(Target::Line("halfway_line".into())));
        assert_eq!(
            pick(placement.rect.center(), true),
            Some(Target::Line("halfway_line".into()))
        );
        assert_eq!(
            pick(placement.rect.center() + vec2(45.0, 60.0), false),
            None
        );
    }
}
