//! How far the paint lies from where a camera draws the field's lines, line by line, with a sign.
//!
//! A median over all lines hides that one of them is beside its paint. So each line is measured on
//! its own, at the distance that 90 % of its places do not exceed. The paint is found from a camera
//! that is aligned to it, because the camera in question may be so far off that nearer paint, or
//! none, would be taken for its own.

use std::collections::BTreeMap;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, quantile};
use touchline_core::markings::{MarkingOptions, project_lines};
use touchline_vision::paint::{GroundPicture, SnapOptions, paint_places, snap};

/// Distance from which a camera lies beside its paint, px at 1920 px width. Of a camera that is
/// right the 90 % place is at 1 to 2 px, more where a line is worn.
pub const BESIDE_PX: f64 = 5.0;

/// Share of the places of a line that lie within its stated distance.
const SHARE: f64 = 0.9;

/// Minimum number of places of a line. Of fewer, a shoe or a shadow is more than one in ten.
const FEWEST_PLACES: usize = 6;

/// Number of lines that are stated.
const LINES: usize = 5;

/// How far the paint of a line lies from where a camera draws it.
#[derive(Clone, Debug, PartialEq)]
pub struct LineOffset {
    /// The line's label.
    pub line: String,
    /// Distance of the 90 % place, px: positive if the paint lies below the drawn line, or to the
    /// right of a vertical one.
    pub offset_px: f64,
    /// The number of places at which its paint is seen.
    pub places: usize,
}

/// The offsets of the lines that are farthest from their paint, farthest first; at most five. Empty
/// if too little paint is seen.
pub(super) fn line_offsets(
    ground: &GroundPicture,
    field: &FieldModel,
    camera: &PtzCamera,
) -> Vec<LineOffset> {
    // Clicks take no part: a wrong one would hold the camera beside the paint.
    let options = SnapOptions::default();
    let aligned = snap(ground, field, camera.base(), camera.ptz(), &[], &options)
        .map_or(*camera, |found| PtzCamera::new(*camera.base(), found.ptz));
    let drawn = project_lines(field, camera, ground.size(), &MarkingOptions::default());
    let mut by_line: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for place in paint_places(ground, field, &aligned) {
        let parts = drawn.iter().filter(|part| part.line == place.line);
        let segments = parts.flat_map(|part| part.points.windows(2));
        let nearest = segments
            .map(|ends| offset_from_segment_px(place.image, ends[0], ends[1]))
            .min_by(|a, b| a.abs().total_cmp(&b.abs()));
        by_line.entry(place.line).or_default().extend(nearest);
    }
    let mut offsets: Vec<LineOffset> = by_line
        .into_iter()
        .filter(|(_, offsets_px)| offsets_px.len() >= FEWEST_PLACES)
        .map(|(line, offsets_px)| LineOffset {
            line: field.lines[line].label.clone(),
            offset_px: signed_quantile_px(&offsets_px),
            places: offsets_px.len(),
        })
        .collect();
    offsets.sort_by(|a, b| b.offset_px.abs().total_cmp(&a.offset_px.abs()));
    offsets.truncate(LINES);
    offsets
}

/// The distance that [`SHARE`] of the offsets do not exceed, with the sign of most of them.
fn signed_quantile_px(offsets_px: &[f64]) -> f64 {
    let mut distances_px: Vec<f64> = offsets_px.iter().map(|offset| offset.abs()).collect();
    distances_px.sort_by(f64::total_cmp);
    let sign = offsets_px.iter().sum::<f64>().signum();
    sign * quantile(&distances_px, SHARE)
}

/// The offset of a point from a segment, px: positive if the point lies below it, or to the right
/// of a vertical one.
fn offset_from_segment_px(point: ImagePoint, from: ImagePoint, to: ImagePoint) -> f64 {
    let distance_px = point.distance_from_segment_px(from, to);
    let (along, away) = (to.offset_from(from), point.offset_from(from));
    // The normal that points down in the picture, whose y grows downwards.
    let [mut x, mut y] = [-along.y, along.x];
    if y < 0.0 || y == 0.0 && x < 0.0 {
        [x, y] = [-x, -y];
    }
    if x * away.x + y * away.y < 0.0 {
        -distance_px
    } else {
        distance_px
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paint_below_a_line_or_to_its_right_counts_as_positive() {
        let [left, right] = [[0.0, 10.0], [20.0, 10.0]].map(|[x, y]| ImagePoint::new(x, y));
        let below = ImagePoint::new(5.0, 13.0);
        for [from, to] in [[left, right], [right, left]] {
            assert!((offset_from_segment_px(below, from, to) - 3.0).abs() < 1e-12);
        }
        let [top, bottom] = [[8.0, 0.0], [8.0, 20.0]].map(|[x, y]| ImagePoint::new(x, y));
        assert!((offset_from_segment_px(below, top, bottom) + 3.0).abs() < 1e-12);
    }

    #[test]
    fn the_place_is_that_of_nine_in_ten_and_not_the_middle() {
        let offsets: Vec<f64> = (1..=10).map(|px| -f64::from(px)).collect();
        let px = signed_quantile_px(&offsets);
        assert!((-10.0..=-9.0).contains(&px), "{px}");
    }
}
