//! The part of a picture that shows the field and its surroundings: the largest connected area that
//! is smooth and has the ground's colours.
//!
//! The picture is divided into blocks of 8 px. A block is ground if half of its pixels have the
//! ground's most common colours and its brightness varies little. Morphology removes small
//! mistakes; the largest component, with its holes filled, is the area.

use super::GroundPicture;
use touchline_core::geometry::ImagePoint;

/// Side of a block, px.
const BLOCK_PX: usize = 8;

/// Minimum share of a ground block's pixels that have the ground's most common colours.
const SHARE: f64 = 0.5;

/// Maximum standard deviation of the brightness within a ground block: the larger of this share of
/// its mean and [`SCATTER`] grey levels. A crowd on a grey day has the colour of turf, but not its
/// smoothness.
const SCATTER_SHARE: f64 = 0.09;
const SCATTER: f64 = 4.0;

/// Blocks this near to the outside are near the border.
const BORDER_BLOCKS: usize = 2;

/// The ground area of a picture.
pub(super) struct GroundArea {
    width: usize,
    columns: usize,
    /// For each block, whether it lies in the area.
    inside: Vec<bool>,
    /// Blocks in the area or next to it.
    near: Vec<bool>,
    /// Blocks within [`BORDER_BLOCKS`] of one outside.
    near_border: Vec<bool>,
    /// For each pixel, whether it has the ground's colours and is not masked.
    of_ground: Vec<bool>,
}

impl GroundArea {
    pub fn detect(ground: &GroundPicture) -> Self {
        let (width, height) = (ground.size().width as usize, ground.size().height as usize);
        let (columns, rows) = (width.div_ceil(BLOCK_PX), height.div_ceil(BLOCK_PX));
        let pixels = ground.picture().rgba().as_chunks::<4>().0;
        let colour = |index: usize| [pixels[index][0], pixels[index][1], pixels[index][2]];
        // Pixels: the ground's colours, without masked boxes.
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
        // Blocks: enough common colours, little variance (mean of squares less square of the mean).
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
        // Opening by 1 removes single blocks; closing by 3 covers lines and players; opening by 2
        // cuts narrow bridges to other green areas.
        let closed = grid.shrunk(&grid.grown(&grid.grown(&grid.shrunk(&open, 1), 1), 3), 3);
        let open = grid.grown(&grid.shrunk(&closed, 2), 2);
        // The largest component, including what it encloses.
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

    /// The index of the block that contains a pixel.
    fn block(&self, x: usize, y: usize) -> usize {
        y / BLOCK_PX * self.columns + x / BLOCK_PX
    }

    /// Whether a pixel lies in the area.
    pub fn holds(&self, x: usize, y: usize) -> bool {
        self.inside.get(self.block(x, y)).copied().unwrap_or(false)
    }

    /// Whether a pixel lies in the area or in a block next to it.
    pub fn is_near(&self, x: usize, y: usize) -> bool {
        self.near.get(self.block(x, y)).copied().unwrap_or(false)
    }

    /// Whether a point is near the border of the area.
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

/// Dimensions of the grid of blocks.
struct Grid {
    columns: usize,
    rows: usize,
}

impl Grid {
    /// Dilation by a square of side 2 · `reach` + 1, rows first, then columns.
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

    /// Erosion: the complement of the dilated complement. Outside the grid counts as set.
    fn shrunk(&self, set: &[bool], reach: usize) -> Vec<bool> {
        let unset: Vec<bool> = set.iter().map(|set| !set).collect();
        self.grown(&unset, reach)
            .iter()
            .map(|grown| !grown)
            .collect()
    }

    /// Sets components of unset blocks that do not touch the grid's border.
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

/// The 8-connected components of the set cells, as lists of cell indices.
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
        // Breadth first; the component's own list serves as the queue.
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
