//! Finds burnt-in graphics by their edges: an edge that keeps its pixels and its direction while
//! the camera moves belongs to the screen and not to the stadium.
//!
//! This finds graphics with few features (watermarks, even faint ones, black boxes, the rims of a
//! ticker whose letters move) and graphics that are shown in some of the pictures only.
//!
//! # Method
//!
//! 1. Pictures between which the camera moved are selected (`standing.rs`), separately for
//!    upright and for level edges: level edges of boards stay in place while a camera pans.
//! 2. At every pixel the gradients of these pictures are averaged. An edge is static if the mean is
//!    far from zero in units of its standard error (a one-sample t statistic), so that a faint edge
//!    over a changing background appears after enough pictures.
//! 3. Static edges that lie together are grouped, and groups that look like a box are kept
//!    (`edge_groups.rs`).
//! 4. Each group is looked up in all pictures, which gives the pictures that show it.
//!
//! Steps 2 to 4 are done for all pictures and for shorter windows of consecutive ones.

use super::black_bars::black_bars;
use super::burnt_in::{CAP, StaticEdge, StaticGraphic};
use super::edge_groups::{EdgeGroup, group_edges};
use super::reduced::{EdgeKind, ReducedPicture, Slope};
use super::standing::camera_views;
use rayon::prelude::*;
use std::ops::Range;
use touchline_core::geometry::PixelBox;

/// Minimum number of pictures from different directions. With fewer, edges of a crowd coincide by
/// chance.
const LEAST_VIEWS: usize = 6;

/// Lengths of the windows of consecutive pictures that are searched in addition to all pictures,
/// longest first. Windows overlap by half.
const WINDOWS: [usize; 3] = [32, 16, 8];

/// Minimum number of pictures from different directions in a window.
const LEAST_VIEWS_IN_WINDOW: usize = 7;

/// Minimum strength of a mean gradient, grey levels over two px, and its minimum in standard
/// errors.
const LEAST_MEAN: f32 = 1.5;
const LEAST_ERRORS: f32 = 7.0;

/// Alternative criterion for all pictures, which may be too few for the statistic: at least this
/// share of them has an edge along the mean gradient (see [`Slope::is_edge_along`]).
const AGREEING: f32 = 0.85;

/// Variance of a gradient that does not change, from rounding, grey levels².
const LEAST_VARIANCE: f32 = 0.25;

/// Maximum number of consecutive pictures in which a graphic may be missed.
const LONGEST_GAP: usize = 1;

/// Minimum number of edges of a graphic, in all pictures and in a window. During a slow zoom a few
/// edges around its fixed point stay in place for a while.
const LEAST_EDGES: usize = 24;
const LEAST_EDGES_IN_WINDOW: usize = 150;

/// With fewer views than this in all pictures the minimum is higher: a player whom the camera
/// follows keeps his place on the screen for a second.
const FEW_VIEWS: usize = 12;
const LEAST_EDGES_IN_FEW: usize = 75;

/// Maximum area of a graphic, as a share of the picture.
const LARGEST: f64 = 0.35;

/// Margin of a box around its edges, px of the reduced picture.
const MARGIN: f64 = 1.5;

/// Finds the graphics that all pictures of one camera show, or consecutive ones of them. The
/// pictures are in order of time as far as they have one. Graphics that are shown longest come
/// first.
///
/// Returns nothing for fewer than six pictures, for pictures of different sizes, or if the camera
/// turned by only a degree or two in all. Black bars along the borders need only two pictures.
pub fn standing_graphics(pictures: &[ReducedPicture]) -> Vec<StaticGraphic> {
    let Some(first) = pictures.first() else {
        return Vec::new();
    };
    if pictures.iter().any(|picture| picture.size != first.size) {
        return Vec::new();
    }
    // Black bars first: they need no motion of the camera.
    let width = first.width;
    let mut found = black_bars(pictures);
    let views = camera_views(pictures);
    let has_few = views.iter().all(|of_kind| of_kind.len() < FEW_VIEWS);
    for window in windows(pictures.len()) {
        let is_part = window.len() < pictures.len();
        // Shorter windows need more edges: fewer pictures leave more coincidences.
        let (least_views, least_edges) = match (is_part, has_few) {
            (true, _) => (LEAST_VIEWS_IN_WINDOW, LEAST_EDGES_IN_WINDOW),
            (false, true) => (LEAST_VIEWS, LEAST_EDGES_IN_FEW),
            (false, false) => (LEAST_VIEWS, LEAST_EDGES),
        };
        // Views of one kind of edge are used only if there are enough of them.
        let in_window = EdgeKind::ALL.map(|kind| {
            let of_kind = &views[kind as usize];
            let within: Vec<usize> = of_kind
                .iter()
                .copied()
                .filter(|view| window.contains(view))
                .collect();
            if within.len() < least_views {
                Vec::new()
            } else {
                within
            }
        });
        for group in group_edges(&standing_edges(pictures, &in_window, is_part)) {
            if group.edges.len() < least_edges || !group.is_a_box(width) {
                continue;
            }
            let Some(graphic) = graphic_from_group(pictures, &window, group) else {
                continue;
            };
            // A graphic found in a longer window is not reported again.
            if !found
                .iter()
                .any(|known: &StaticGraphic| known.is_also(&graphic))
            {
                found.push(graphic);
            }
        }
    }
    found
}

/// The range of all pictures, then those of shorter windows.
fn windows(count: usize) -> Vec<Range<usize>> {
    let shorter = WINDOWS
        .into_iter()
        .filter(|length| *length < count)
        .flat_map(|length| {
            let starts = (0..count - length)
                .step_by(length / 2)
                .chain([count - length]);
            starts.map(move |start| start..start + length)
        });
    std::iter::once(0..count).chain(shorter).collect()
}

/// The static edges in the views of each kind of edge.
fn standing_edges(
    pictures: &[ReducedPicture],
    views: &[Vec<usize>; 2],
    is_part: bool,
) -> Vec<StaticEdge> {
    let rows = 1..pictures[0].height.saturating_sub(1);
    rows.into_par_iter()
        .flat_map_iter(|row| standing_edges_in_row(row, pictures, views, is_part))
        .collect()
}

/// The static edges in one row of the reduced pictures, from left to right.
fn standing_edges_in_row(
    row: usize,
    pictures: &[ReducedPicture],
    views: &[Vec<usize>; 2],
    is_part: bool,
) -> impl Iterator<Item = StaticEdge> {
    let columns = 1..pictures[0].width.saturating_sub(1);
    columns.filter_map(move |column| {
        EdgeKind::ALL.into_iter().find_map(|kind| {
            // Gradients are capped: one strong edge of the stadium must not outweigh many weak
            // ones.
            let slopes = views[kind as usize]
                .iter()
                .map(|&view| pictures[view].slope(column, row).clamp_strength(CAP));
            let slope = mean_slope(slopes, is_part).filter(|mean| mean.kind() == kind)?;
            Some(StaticEdge { column, row, slope })
        })
    })
}

/// The mean of gradients that agree; none if they do not.
fn mean_slope(slopes: impl Iterator<Item = Slope> + Clone, is_part: bool) -> Option<Slope> {
    let (sum, count) = slopes
        .clone()
        .fold((Slope::default(), 0.0_f32), |(sum, count), slope| {
            (sum.plus(slope), count + 1.0)
        });
    if count < 2.0 {
        return None;
    }
    let mean = sum.times(1.0 / count);
    let strength = mean.strength();
    if strength < LEAST_MEAN {
        return None;
    }
    // The t statistic of the gradients' components along their mean. The added variance of rounding
    // keeps equal gradients from being infinitely certain.
    let direction = mean.unit();
    let scatter: f32 = slopes
        .clone()
        .map(|slope| (slope.dot(direction) - strength).powi(2))
        .sum();
    let variance = scatter / (count - 1.0) + LEAST_VARIANCE;
    // With few pictures the statistic is weak; it is enough that nearly all have the edge.
    let agreeing = slopes.filter(|slope| slope.is_edge_along(direction));
    let stands = strength * (count / variance).sqrt() > LEAST_ERRORS
        || (!is_part && agreeing.count() as f32 >= AGREEING * count);
    stands.then_some(mean)
}

/// A group of edges with the pictures that show it, in the window in which it was found and beyond.
fn graphic_from_group(
    pictures: &[ReducedPicture],
    window: &Range<usize>,
    group: EdgeGroup,
) -> Option<StaticGraphic> {
    let first = pictures.first()?;
    let step = first.step as f64;
    // The box in px of the full picture, with a margin, clipped to the picture.
    let [left, top, right, bottom] = group.extents.map(|at| at as f64);
    let (x, y) = (
        (step * (left - MARGIN)).max(0.0),
        (step * (top - MARGIN)).max(0.0),
    );
    let to_x = (step * (right + 1.0 + MARGIN)).min(f64::from(first.size.width));
    let to_y = (step * (bottom + 1.0 + MARGIN)).min(f64::from(first.size.height));
    let pixel_box = PixelBox::new(x, y, to_x - x, to_y - y);
    let area = f64::from(first.size.width) * f64::from(first.size.height);
    if pixel_box.width * pixel_box.height > LARGEST * area {
        return None;
    }
    let mut graphic = StaticGraphic {
        pixel_box,
        first: 0,
        last: 0,
        edges: group.edges,
    };
    // All pictures, not only those of the window: a graphic may outlast the window that found it.
    let shown: Vec<bool> = pictures
        .iter()
        .map(|picture| graphic.is_shown_in(picture))
        .collect();
    let run = longest_run(&shown).filter(|run| run.len() >= LEAST_VIEWS)?;
    // The run of pictures must overlap the window by half of the shorter of the two, or it shows
    // something else than what was found there.
    let in_window = (window.start.max(run.start)..window.end.min(run.end)).len();
    if 2 * in_window < window.len().min(run.len()) {
        return None;
    }
    (graphic.first, graphic.last) = (run.start, run.end - 1);
    Some(graphic)
}

/// The longest run of true values, with gaps of at most [`LONGEST_GAP`] in it.
fn longest_run(values: &[bool]) -> Option<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for place in (0..values.len()).filter(|&place| values[place]) {
        match runs.last_mut() {
            Some(run) if place - run.end <= LONGEST_GAP => run.end = place + 1,
            _ => runs.push(place..place + 1),
        }
    }
    // `max_by_key` returns the last of equal maxima; reversed, that is the first run.
    runs.into_iter().rev().max_by_key(ExactSizeIterator::len)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Picture;
    use touchline_core::geometry::ImageSize;

    const SIZE: ImageSize = ImageSize::new(960, 540);

    /// Stripes that move from picture to picture under a bar with letters and a faint box.
    fn picture(shift: u32, with_graphics: bool) -> ReducedPicture {
        let mut rgba = Vec::new();
        for y in 0..SIZE.height {
            for x in 0..SIZE.width {
                let stripes = if (x + y / 2 + shift) % 97 < 40 {
                    90
                } else {
                    130
                };
                let in_bar = (60..300).contains(&x) && (40..80).contains(&y);
                let letter = in_bar && (50..70).contains(&y) && x % 24 < 10;
                let faint = (700..860).contains(&x) && (440..500).contains(&y);
                let grey: u8 = match (letter, in_bar, faint) {
                    _ if !with_graphics => stripes,
                    (true, ..) => 240,
                    (_, true, _) => 20,
                    (.., true) => stripes + 25,
                    _ => stripes,
                };
                rgba.extend([grey, grey, grey, 255]);
            }
        }
        ReducedPicture::new(&Picture::new(SIZE, rgba).unwrap())
    }

    fn pictures(shifts: &[u32], with_graphics: bool) -> Vec<ReducedPicture> {
        shifts
            .iter()
            .map(|&shift| picture(shift, with_graphics))
            .collect()
    }

    const SHIFTS: [u32; 6] = [0, 13, 31, 50, 64, 83];

    #[test]
    fn a_bar_and_a_faint_box_are_found_as_wide_as_they_are() {
        let found = standing_graphics(&pictures(&SHIFTS, true));
        let [bar, faint] = &found[..] else {
            panic!("{found:?}")
        };
        for (graphic, [x, y, to_x, to_y]) in [
            (bar, [60.0, 40.0, 300.0, 80.0]),
            (faint, [700.0, 440.0, 860.0, 500.0]),
        ] {
            let found = graphic.pixel_box;
            assert_eq!((graphic.first, graphic.last), (0, SHIFTS.len() - 1));
            let off = [
                found.x - x,
                found.y - y,
                found.x + found.width - to_x,
                found.y + found.height - to_y,
            ];
            assert!(
                off[0] <= 0.0 && off[1] <= 0.0 && off[2] >= 0.0 && off[3] >= 0.0,
                "{found:?}"
            );
            assert!(off.iter().all(|px| px.abs() < 10.0), "{found:?}");
        }
    }

    #[test]
    fn what_moves_is_no_graphic_and_neither_is_a_still_camera() {
        assert_eq!(standing_graphics(&pictures(&SHIFTS, false)), []);
        assert_eq!(standing_graphics(&pictures(&[7; 6], true)), []);
        assert_eq!(
            standing_graphics(&pictures(&SHIFTS[..3], true)),
            [],
            "too few pictures"
        );
        assert_eq!(standing_graphics(&[]), []);
    }
}
