//! Graphics that are burnt into pictures, by their edges: an edge that stands at the same pixels with the same direction in most
//! of many pictures belongs to the screen and not to the stadium. Finds what has few features: watermarks, black boxes.

use crate::geometry::{ImageSize, PixelBox};
use crate::media::Picture;
use std::borrow::Borrow;
use std::collections::BTreeMap;

/// Pictures are reduced to about this width, px.
const WIDTH: u32 = 480;

/// With fewer pictures the edges of a crowd stand by chance.
const LEAST_PICTURES: usize = 6;

/// Boxes reach beyond the edges, px of the reduced picture.
const MARGIN: f64 = 1.5;

/// An edge weaker than this may be noise, grey levels over two px of the reduced picture.
const LEAST_EDGE: f32 = 4.0;

/// An edge stands if its direction is the common one in this share of the pictures,
const SHARE: f32 = 0.85;

/// as far as this share of its strength.
const ALONG: f32 = 0.7;

/// Standing edges are joined by cells of this side, px of the reduced picture.
const CELL: usize = 6;

/// A cell counts from this many standing edges on, and a graphic has at least this many.
const IN_CELL: usize = 2;
const IN_GRAPHIC: usize = 12;

/// What is thinner than this is the border of the picture, px of the reduced picture.
const THIN: usize = 3;

/// If more of the picture's edges stand than this share, the camera hardly moved.
const STILL: f32 = 0.3;

/// Of the edges of two pictures less than this share stands once a camera has moved by a few px: by chance a third, from frame to
/// frame of a slow pan four fifths.
const MOVED: f32 = 0.5;

/// Fewer edges than this share of the reduced picture's pixels tell nothing: a fade, a white-out.
const FEWEST: f32 = 0.01;

/// The brightness of a picture, reduced in size.
#[derive(Clone, Debug, PartialEq)]
pub struct ReducedPicture {
    size: ImageSize,
    /// How many px of the picture one px of the reduced picture is.
    step: usize,
    width: usize,
    height: usize,
    grey: Vec<f32>,
}

impl ReducedPicture {
    /// Reduces a picture by whole steps.
    #[must_use]
    pub fn new(picture: &Picture) -> Self {
        let size = picture.size();
        let step = (f64::from(size.width) / f64::from(WIDTH)).round().max(1.0) as usize;
        let (width, height) = (size.width as usize / step, size.height as usize / step);
        let mut grey = vec![0.0_f32; width * height];
        let rows = picture.rgba().chunks_exact(4 * size.width as usize);
        for (row, pixels) in rows.take(height * step).enumerate() {
            let reduced = &mut grey[row / step * width..][..width];
            for (column, pixel) in pixels.chunks_exact(4).take(width * step).enumerate() {
                reduced[column / step] += f32::from(pixel[0]) + 2.0 * f32::from(pixel[1]) + f32::from(pixel[2]);
            }
        }
        let weight = 1.0 / (4 * step * step) as f32;
        for value in &mut grey {
            *value *= weight;
        }
        Self { size, step, width, height, grey }
    }

    /// How the brightness changes to the right and downwards over two px, away from the borders.
    fn slope(&self, column: usize, row: usize) -> (f32, f32) {
        let at = row * self.width + column;
        (self.grey[at + 1] - self.grey[at - 1], self.grey[at + self.width] - self.grey[at - self.width])
    }
}

/// Finds the graphics that stand in most of some pictures of one camera, as boxes with how many edges of the reduced pictures
/// stand in each, from the top down. Nothing is found in fewer than six pictures, in pictures that differ in size, or where the
/// camera hardly moved between them.
#[must_use]
pub fn standing_graphics(pictures: &[ReducedPicture]) -> Vec<(PixelBox, usize)> {
    let Some(first) = pictures.first() else { return Vec::new() };
    if pictures.len() < LEAST_PICTURES || pictures.iter().any(|picture| picture.size != first.size) {
        return Vec::new();
    }
    let step = first.step as f64;
    let boxed = |group: Group| {
        let [left, top, right, bottom] = group.extents.map(|at| at as f64);
        let (x, y) = ((step * (left - MARGIN)).max(0.0), (step * (top - MARGIN)).max(0.0));
        let to_x = (step * (right + 1.0 + MARGIN)).min(f64::from(first.size.width));
        let to_y = (step * (bottom + 1.0 + MARGIN)).min(f64::from(first.size.height));
        (PixelBox { x, y, width: to_x - x, height: to_y - y }, group.edges)
    };
    let Standing { edges, all } = standing_edges(pictures);
    if edges.len() as f32 > STILL * all {
        return Vec::new();
    }
    joined(&edges).into_iter().map(boxed).collect()
}

/// Whether the camera moved between two pictures, whatever else did: less than half of the edges stand where they stood. None for
/// pictures of two sizes, or without edges.
#[must_use]
pub fn has_moved(one: &ReducedPicture, other: &ReducedPicture) -> Option<bool> {
    let Standing { edges, all } = standing_edges(&[one, other]);
    let tells = one.size == other.size && all > FEWEST * one.grey.len() as f32;
    tells.then_some((edges.len() as f32) < MOVED * all)
}

/// Standing edges that lie together.
struct Group {
    /// Left, top, right, bottom, both ends included, px of the reduced picture.
    extents: [usize; 4],
    edges: usize,
}

/// The edges of some pictures.
struct Standing {
    /// The pixels of a reduced picture at which an edge stands in most of them.
    edges: Vec<(usize, usize)>,
    /// How many edges one of them has on average, standing or not.
    all: f32,
}

/// The edges of pictures of one size.
fn standing_edges<P: Borrow<ReducedPicture>>(pictures: &[P]) -> Standing {
    let pictures: Vec<&ReducedPicture> = pictures.iter().map(Borrow::borrow).collect();
    let (mut standing, mut edges) = (Vec::new(), 0.0);
    let (width, height) = match *pictures {
        [first, ..] if pictures.iter().all(|picture| picture.size == first.size) => (first.width, first.height),
        _ => (0, 0),
    };
    let needed = (SHARE * pictures.len() as f32).ceil() as usize;
    for row in 1..height.saturating_sub(1) {
        for column in 1..width.saturating_sub(1) {
            let slopes = || pictures.iter().map(|picture| picture.slope(column, row));
            let (x, y) = slopes().fold((0.0, 0.0), |sum, slope| (sum.0 + slope.0, sum.1 + slope.1));
            let norm = x.hypot(y).max(f32::MIN_POSITIVE);
            let (mut count, mut present) = (0, 0);
            for slope in slopes() {
                let strength = slope.0.hypot(slope.1);
                let along = (slope.0 * x + slope.1 * y) / norm;
                present += usize::from(strength > LEAST_EDGE);
                count += usize::from(along > LEAST_EDGE && along > ALONG * strength);
            }
            edges += present as f32 / pictures.len() as f32;
            if count >= needed {
                standing.push((column, row));
            }
        }
    }
    Standing { edges: standing, all: edges }
}

/// Groups of standing edges, the topmost first.
fn joined(standing: &[(usize, usize)]) -> Vec<Group> {
    let mut cells = BTreeMap::<(usize, usize), Vec<(usize, usize)>>::new();
    for &(column, row) in standing {
        cells.entry((row / CELL + 1, column / CELL + 1)).or_default().push((column, row));
    }
    cells.retain(|_, edges| edges.len() >= IN_CELL);
    let mut found = Vec::new();
    while let Some((first, mut edges)) = cells.pop_first() {
        let mut open = vec![first];
        while let Some((row, column)) = open.pop() {
            for near in (row - 1..=row + 1).flat_map(|row| (column - 1..=column + 1).map(move |column| (row, column))) {
                if let Some(more) = cells.remove(&near) {
                    edges.extend(more);
                    open.push(near);
                }
            }
        }
        let extent = |of: fn(&(usize, usize)) -> usize| {
            edges.iter().map(of).fold((usize::MAX, 0), |(least, most), at| (least.min(at), most.max(at)))
        };
        let ((left, right), (top, bottom)) = (extent(|edge| edge.0), extent(|edge| edge.1));
        if edges.len() >= IN_GRAPHIC && right - left >= THIN && bottom - top >= THIN {
            found.push(Group { extents: [left, top, right, bottom], edges: edges.len() });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: ImageSize = ImageSize::new(960, 540);

    /// Stripes that move from picture to picture under a bar with letters and a faint box.
    fn picture(shift: u32, with_graphics: bool) -> ReducedPicture {
        let mut rgba = Vec::new();
        for y in 0..SIZE.height {
            for x in 0..SIZE.width {
                let stripes = if (x + y / 2 + shift) % 97 < 40 { 90 } else { 130 };
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
        shifts.iter().map(|&shift| picture(shift, with_graphics)).collect()
    }

    const SHIFTS: [u32; 6] = [0, 13, 31, 50, 64, 83];

    #[test]
    fn a_bar_and_a_faint_box_are_found_as_wide_as_they_are() {
        let found = standing_graphics(&pictures(&SHIFTS, true));
        let [(bar, _), (faint, _)] = &found[..] else { panic!("{found:?}") };
        for (found, [x, y, to_x, to_y]) in [(bar, [60.0, 40.0, 300.0, 80.0]), (faint, [700.0, 440.0, 860.0, 500.0])] {
            let off = [found.x - x, found.y - y, found.x + found.width - to_x, found.y + found.height - to_y];
            assert!(off[0] <= 0.0 && off[1] <= 0.0 && off[2] >= 0.0 && off[3] >= 0.0, "{found:?}");
            assert!(off.iter().all(|px| px.abs() < 10.0), "{found:?}");
        }
    }

    #[test]
    fn what_moves_is_no_graphic_and_neither_is_a_still_camera() {
        assert_eq!(standing_graphics(&pictures(&SHIFTS, false)), []);
        assert_eq!(standing_graphics(&pictures(&[7; 6], true)), []);
        assert_eq!(standing_graphics(&pictures(&SHIFTS[..3], true)), [], "too few pictures");
        assert_eq!(standing_graphics(&[]), []);
    }

    #[test]
    fn a_picture_has_moved_under_its_graphics_and_a_still_one_has_not() {
        let shown = picture(0, true);
        assert_eq!(has_moved(&shown, &picture(30, true)), Some(true));
        assert_eq!(has_moved(&shown, &picture(0, false)), Some(false), "only the graphics went");
        let black = ReducedPicture { grey: vec![0.0; shown.grey.len()], ..shown.clone() };
        assert_eq!(has_moved(&black, &black), None);
        assert_eq!(has_moved(&shown, &ReducedPicture { size: ImageSize::new(10, 10), ..shown.clone() }), None);
    }
}
