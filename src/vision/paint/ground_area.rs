//! The part of a picture that is the field and its surroundings: smooth, connected, of the ground's
//! colours.

use super::GroundPicture;
use touchline_core::geometry::ImagePoint;

/// The side of a block of pixels that is inside the area or not, px.
const BLOCK_PX: usize = 8;

/// A block is ground if at least this share of its pixels has the ground's most common colours.
const SHARE: f64 = 0.5;

/// The brightness within a block of ground scatters by no more than this share of it, or this many
/// grey levels: a crowd on a grey day has the colour of turf, but not its smoothness.
const SCATTER_SHARE: f64 = 0.09;
const SCATTER: f64 = 4.0;

/// Near the border of the area means within as many blocks.
const BORDER_BLOCKS: usize = 2;

/// Where a picture shows ground.
pub(super) struct GroundArea {
    width: usize,
    columns: usize,
    inside: Vec<bool>,
    near: Vec<bool>,
    /// Blocks within reach of one that lies outside.
    near_border: Vec<bool>,
    of_ground: Vec<bool>,
}

impl GroundArea {
    pub fn of(ground: &GroundPicture) -> Self {
        let (width, height) = (ground.size().width as usize, ground.size().height as usize);
        let (columns, rows) = (width.div_ceil(BLOCK_PX), height.div_ceil(BLOCK_PX));
        let pixels = ground.picture().rgba().as_chunks::<4>().0;
        let colour = |index: usize| [pixels[index][0], pixels[index][1], pixels[index][2]];
        let mut of_ground: Vec<bool> = (0..width * height)
            .map(|index| ground.surface().holds(colour(index)))
            .collect();
        for mask in ground.masks() {
            let range = |from: f64, extent: f64, limit: usize| {
                let clamp = |at: f64| (at.max(0.0) as usize).min(limit);
                clamp(from)..clamp(from + extent)
            };
            for y in range(mask.y, mask.height, height) {
                let columns = range(mask.x, mask.width, width);
                of_ground[y * width + columns.start..y * width + columns.end].fill(false);
            }
        }
        let open = |block: usize| {
            let (top, left) = (block / columns * BLOCK_PX, block % columns * BLOCK_PX);
            let (bottom, right) = ((top + BLOCK_PX).min(height), (left + BLOCK_PX).min(width));
            let (mut common, mut sum, mut squares) = (0.0, 0.0, 0.0);
            let rows = (top..bottom).map(|y| y * width + left..y * width + right);
            for index in rows.flatten() {
                let grey = f64::from(ground.grey().values[index]);
                (sum, squares) = (sum + grey, squares + grey * grey);
                common += f64::from(u8::from(
                    of_ground[index] && ground.surface().is_common(colour(index)),
                ));
            }
            let count = ((bottom - top) * (right - left)) as f64;
            let mean = sum / count;
            let scatter = (squares / count - mean * mean).max(0.0).sqrt();
            common >= SHARE * count && scatter < (SCATTER_SHARE * mean).max(SCATTER)
        };
        let open: Vec<bool> = (0..columns * rows).map(open).collect();
        let grid = Grid { columns, rows };
        // Single blocks go, lines and players are closed over, narrow bridges go.
        let closed = grid.shrunk(&grid.grown(&grid.grown(&grid.shrunk(&open, 1), 1), 3), 3);
        let open = grid.grown(&grid.shrunk(&closed, 2), 2);
        let mut inside = vec![false; columns * rows];
        for block in parts(&open, columns)
            .into_iter()
            .max_by_key(Vec::len)
            .unwrap_or_default()
        {
            inside[block] = true;
        }
        grid.fill_holes(&mut inside);
        let outside: Vec<bool> = inside.iter().map(|inside| !inside).collect();
        let near_border = grid.grown(&outside, BORDER_BLOCKS);
        let near = grid.grown(&inside, 1);
        Self {
            width,
            columns,
            inside,
            near,
            near_border,
            of_ground,
        }
    }

    fn block(&self, x: usize, y: usize) -> usize {
        y / BLOCK_PX * self.columns + x / BLOCK_PX
    }

    /// Whether a pixel lies in the area.
    pub fn holds(&self, x: usize, y: usize) -> bool {
        self.inside.get(self.block(x, y)).copied().unwrap_or(false)
    }

    /// Whether a pixel lies in the area or within a block of it.
    pub fn is_near(&self, x: usize, y: usize) -> bool {
        self.near.get(self.block(x, y)).copied().unwrap_or(false)
    }

    /// Whether a point is near the area's border.
    pub fn is_near_border(&self, at: ImagePoint) -> bool {
        at.x >= 0.0
            && at.y >= 0.0
            && self
                .near_border
                .get(self.block(at.x as usize, at.y as usize))
                .copied()
                .unwrap_or(false)
    }

    /// Whether a pixel has one of the ground's colours and is not masked.
    pub fn is_of_ground(&self, at: ImagePoint) -> bool {
        let inside = at.x >= 0.0 && at.y >= 0.0 && (at.x as usize) < self.width;
        inside
            && self
                .of_ground
                .get(at.y as usize * self.width + at.x as usize)
                .copied()
                .unwrap_or(false)
    }
}

/// Columns and rows of blocks.
struct Grid {
    columns: usize,
    rows: usize,
}

impl Grid {
    /// Every block that has a set one within reach, along rows and columns and over corners.
    fn grown(&self, set: &[bool], reach: usize) -> Vec<bool> {
        let mut along = vec![false; set.len()];
        let mut both = vec![false; set.len()];
        for row in 0..self.rows {
            for column in 0..self.columns {
                let columns = column.saturating_sub(reach)..(column + reach + 1).min(self.columns);
                along[row * self.columns + column] =
                    columns.into_iter().any(|c| set[row * self.columns + c]);
            }
        }
        for row in 0..self.rows {
            for column in 0..self.columns {
                let mut rows = row.saturating_sub(reach)..(row + reach + 1).min(self.rows);
                both[row * self.columns + column] = rows.any(|r| along[r * self.columns + column]);
            }
        }
        both
    }

    /// Every block that has set ones alone within reach; the grid's border takes none away.
    fn shrunk(&self, set: &[bool], reach: usize) -> Vec<bool> {
        let unset: Vec<bool> = set.iter().map(|set| !set).collect();
        self.grown(&unset, reach)
            .iter()
            .map(|grown| !grown)
            .collect()
    }

    /// Sets what set blocks enclose.
    fn fill_holes(&self, set: &mut [bool]) {
        let unset: Vec<bool> = set.iter().map(|set| !set).collect();
        for hole in parts(&unset, self.columns) {
            let at_border = |&block: &usize| {
                let (row, column) = (block / self.columns, block % self.columns);
                row == 0 || column == 0 || row + 1 == self.rows || column + 1 == self.columns
            };
            if !hole.iter().any(at_border) {
                for block in hole {
                    set[block] = true;
                }
            }
        }
    }
}

/// The connected parts of the cells that are set, by their numbers; cells that touch at a corner
/// are connected.
pub(super) fn parts(set: &[bool], columns: usize) -> Vec<Vec<usize>> {
    let rows = set.len() / columns.max(1);
    let mut reached = vec![false; set.len()];
    let mut parts = Vec::new();
    for start in (0..set.len()).filter(|cell| set[*cell]) {
        if reached[start] {
            continue;
        }
        let (mut part, mut next) = (vec![start], 0);
        reached[start] = true;
        while next < part.len() {
            let (row, column) = (part[next] / columns, part[next] % columns);
            next += 1;
            for r in row.saturating_sub(1)..(row + 2).min(rows) {
                for c in column.saturating_sub(1)..(column + 2).min(columns) {
                    let cell = r * columns + c;
                    if set[cell] && !reached[cell] {
                        reached[cell] = true;
                        part.push(cell);
                    }
                }
            }
        }
        parts.push(part);
    }
    parts
}
