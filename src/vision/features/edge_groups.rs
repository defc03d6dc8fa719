//! Groups of static edges that lie together on the screen, and whether such a group is a graphic.

use super::burnt_in::StaticEdge;
use super::grid::join_touching_cells;
use super::reduced::EdgeKind;
use std::collections::{BTreeMap, BTreeSet};

/// Side of the cells by which edges are joined, px of the reduced picture.
const CELL: usize = 6;

/// Minimum number of edges in a cell.
const IN_CELL: usize = 3;

/// Minimum width and height of a box, px of the reduced picture. Anything thinner is a line.
const THIN: usize = 3;

/// Two rims of one box end within this of each other, px of the reduced picture,
const RIMS_END_WITHIN: usize = 3;

/// and their distance is at most this many times their length: for upper and lower rim, and for
/// left and right side.
const RIMS_APART: f64 = 0.25;
const SIDES_APART: f64 = 8.0;

/// Minimum share of upright edges in a group with letters.
const LETTERS: f64 = 0.25;

/// A side of a box has upright edges along this share of the box's height, within [`SIDE_WITHIN`]
/// px of the reduced picture from the box's end.
const SIDE: f64 = 0.5;
const SIDE_WITHIN: usize = 2;

/// A band across the whole picture has a level rim in this share of the columns, within
/// [`LEVEL_WITHIN`] px of the reduced picture from one row.
const ACROSS: f64 = 0.9;
const LEVEL_WITHIN: usize = 1;

/// Static edges that lie together.
#[derive(Clone, Debug)]
pub(super) struct EdgeGroup {
    /// Left, top, right, bottom, both ends included, px of the reduced picture.
    pub extents: [usize; 4],
    pub edges: Vec<StaticEdge>,
}

impl EdgeGroup {
    fn from_edges(edges: Vec<StaticEdge>) -> Self {
        let (left, right) = extent(edges.iter().map(|edge| edge.column));
        let (top, bottom) = extent(edges.iter().map(|edge| edge.row));
        Self {
            extents: [left, top, right, bottom],
            edges,
        }
    }

    /// Whether the group looks like a graphic: it has letters, or sides at its left and right end,
    /// or both rims across a picture of this width. The rim of a board has none of these; it stays
    /// in place while the camera pans along it.
    pub(super) fn is_a_box(&self, width: usize) -> bool {
        let [left, top, right, bottom] = self.extents;
        if right - left < THIN || bottom - top < THIN {
            return false;
        }
        self.edges_of_kind(EdgeKind::Upright).count() as f64 >= LETTERS * self.edges.len() as f64
            || (self.has_side(left) && self.has_side(right))
            || (self.has_rim(top, width) && self.has_rim(bottom, width))
    }

    fn edges_of_kind(&self, kind: EdgeKind) -> impl Iterator<Item = &StaticEdge> {
        self.edges
            .iter()
            .filter(move |edge| edge.slope.kind() == kind)
    }

    /// Whether level edges near the row `end` extend across a picture of this width.
    fn has_rim(&self, end: usize, width: usize) -> bool {
        let columns: BTreeSet<usize> = self
            .edges_of_kind(EdgeKind::Level)
            .filter(|edge| edge.row.abs_diff(end) <= LEVEL_WITHIN)
            .map(|edge| edge.column)
            .collect();
        columns.len() as f64 >= ACROSS * width as f64
    }

    /// Whether upright edges near the column `end` extend over enough of the box's height.
    fn has_side(&self, end: usize) -> bool {
        let [_, top, _, bottom] = self.extents;
        let rows: BTreeSet<usize> = self
            .edges_of_kind(EdgeKind::Upright)
            .filter(|edge| edge.column.abs_diff(end) <= SIDE_WITHIN)
            .map(|edge| edge.row)
            .collect();
        rows.len() as f64 >= SIDE * (bottom - top + 1) as f64
    }

    /// Whether two groups are the upper and lower rim of one box, or its two sides. They are not
    /// connected if the camera only pans, because level edges are then not tested.
    fn is_rim_beside(&self, other: &Self) -> bool {
        let ([left, top, right, bottom], [other_left, other_top, other_right, other_bottom]) =
            (self.extents, other.extents);
        // Upper and lower rim: the same columns, and near to each other for their length.
        let rows_between = gap([top, bottom], [other_top, other_bottom]);
        let rims = ends_agree(left, other_left)
            && ends_agree(right, other_right)
            && rows_between as f64 <= RIMS_APART * (right - left) as f64;
        // Sides: the same rows, upright edges only. A box is wide, so they may be far apart.
        let columns_between = gap([left, right], [other_left, other_right]);
        let sides = ends_agree(top, other_top)
            && ends_agree(bottom, other_bottom)
            && self.is_upright()
            && other.is_upright()
            && columns_between as f64 <= SIDES_APART * (bottom - top) as f64;
        rims || sides
    }

    fn is_upright(&self) -> bool {
        self.edges
            .iter()
            .all(|edge| edge.slope.kind() == EdgeKind::Upright)
    }
}

/// The least and the greatest of some positions.
fn extent(positions: impl Iterator<Item = usize>) -> (usize, usize) {
    positions.fold((usize::MAX, 0), |(least, most), at| {
        (least.min(at), most.max(at))
    })
}

/// Whether the ends of two rims, or of two sides, are those of one box.
fn ends_agree(one: usize, other: usize) -> bool {
    one.abs_diff(other) <= RIMS_END_WITHIN
}

/// The distance between two ranges along one axis; 0 if they overlap.
fn gap([from, to]: [usize; 2], [other_from, other_to]: [usize; 2]) -> usize {
    from.max(other_from).saturating_sub(to.min(other_to))
}

/// Groups of edges whose cells touch, diagonals included, topmost first. The rims of a box are one
/// group.
pub(super) fn group_edges(edges: &[StaticEdge]) -> Vec<EdgeGroup> {
    // A cell with fewer edges than `IN_CELL` may be chance, and would connect groups that do not
    // belong together.
    let mut cells = BTreeMap::<(i64, i64), Vec<StaticEdge>>::new();
    for &edge in edges {
        let cell = ((edge.row / CELL) as i64, (edge.column / CELL) as i64);
        cells.entry(cell).or_default().push(edge);
    }
    cells.retain(|_, edges| edges.len() >= IN_CELL);
    let mut found: Vec<EdgeGroup> = Vec::new();
    for edges in join_touching_cells(cells) {
        let mut group = EdgeGroup::from_edges(edges);
        // A merged group may be a rim of yet another one, so this repeats until nothing merges.
        while let Some(rim) = found.iter().position(|known| known.is_rim_beside(&group)) {
            group.edges.splice(0..0, found.remove(rim).edges);
            group = EdgeGroup::from_edges(group.edges);
        }
        found.push(group);
    }
    found.sort_by_key(|group| (group.extents[1], group.extents[0]));
    found
}
