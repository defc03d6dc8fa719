//! The part of a picture that shows the field and its surroundings: the largest connected area that
//! is smooth and has the ground's colours.
//!
//! The picture is divided into blocks of 8 px. A block is ground if half of its pixels have the
//! ground's most common colours and its brightness varies little. Morphology removes small
//! mistakes; the largest component, with its holes filled, is the area.

use crate::paint::GroundPicture;
use std::ops::Range;
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
pub(in crate::paint) struct GroundArea {
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
        let of_ground = ground_pixels(ground);
        let open: Vec<bool> = (0..columns * rows)
            .map(|block| is_open(ground, &of_ground, block, columns))
            .collect();
        // Morphology, in blocks. Opening by 1 removes single blocks; closing by 3 covers lines and
        // players; opening by 2 cuts narrow bridges to other green areas.
        let grid = Grid { columns, rows };
        let closed = grid.shrunk(&grid.grown(&grid.grown(&grid.shrunk(&open, 1), 1), 3), 3);
        let open = grid.grown(&grid.shrunk(&closed, 2), 2);
        // The field is the largest component. What it encloses, such as players, is a part of it.
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

    /// Whether a point is near the border of the area. False outside the picture.
    pub fn is_near_border(&self, at: ImagePoint) -> bool {
        self.pixel(at)
            .and_then(|(x, y)| self.near_border.get(self.block(x, y)).copied())
            .unwrap_or(false)
    }

    /// Whether the pixel at a point has one of the ground's colours and is not masked. False
    /// outside the picture.
    pub fn is_of_ground(&self, at: ImagePoint) -> bool {
        self.pixel(at)
            .and_then(|(x, y)| self.of_ground.get(y * self.width + x).copied())
            .unwrap_or(false)
    }

    /// The column and row of the pixel at a point. None above, left or right of the picture: the
    /// index of such a pixel, or of its block, would be that of one in another row.
    fn pixel(&self, at: ImagePoint) -> Option<(usize, usize)> {
        let inside = at.x >= 0.0 && at.y >= 0.0 && at.x < self.width as f64;
        inside.then_some((at.x as usize, at.y as usize))
    }
}

/// For each pixel, whether it has the ground's colours and is not masked.
fn ground_pixels(ground: &GroundPicture) -> Vec<bool> {
    let (width, height) = (ground.size().width as usize, ground.size().height as usize);
    let pixels = ground.picture().rgba().as_chunks::<4>().0;
    let mut of_ground: Vec<bool> = pixels
        .iter()
        .map(|[red, green, blue, _]| ground.surface().holds([*red, *green, *blue]))
        .collect();
    for mask in ground.masks() {
        let columns = pixel_range(mask.x, mask.width, width);
        for y in pixel_range(mask.y, mask.height, height) {
            // The range of a box of negative width, which a document may state, ends before it
            // begins. Such a box covers nothing.
            let row = y * width;
            if let Some(covered) = of_ground.get_mut(row + columns.start..row + columns.end) {
                covered.fill(false);
            }
        }
    }
    of_ground
}

/// The pixels of a side of the picture, of `limit` px, that a box covers. Both ends are rounded
/// down.
fn pixel_range(from: f64, extent: f64, limit: usize) -> Range<usize> {
    let [start, end] = [from, from + extent].map(|at| (at.max(0.0) as usize).min(limit));
    start..end
}

/// Whether a block shows ground: enough pixels of its common colours, and little variation of
/// brightness.
fn is_open(ground: &GroundPicture, of_ground: &[bool], block: usize, columns: usize) -> bool {
    let (width, height) = (ground.size().width as usize, ground.size().height as usize);
    let pixels = ground.picture().rgba().as_chunks::<4>().0;
    // Blocks at the right and at the lower border may be smaller.
    let (top, left) = (block / columns * BLOCK_PX, block % columns * BLOCK_PX);
    let (bottom, right) = ((top + BLOCK_PX).min(height), (left + BLOCK_PX).min(width));
    let (mut common, mut sum, mut squares) = (0.0, 0.0, 0.0);
    let rows = (top..bottom).map(|y| y * width + left..y * width + right);
    for index in rows.flatten() {
        let grey = f64::from(ground.grey().values[index]);
        (sum, squares) = (sum + grey, squares + grey * grey);
        let [red, green, blue, _] = pixels[index];
        let is_common = of_ground[index] && ground.surface().is_common([red, green, blue]);
        common += f64::from(u8::from(is_common));
    }
    // The variance as mean of squares less square of the mean. The sums are of integers and exact,
    // so that the difference loses no digits.
    let count = ((bottom - top) * (right - left)) as f64;
    let mean = sum / count;
    let scatter = (squares / count - mean * mean).max(0.0).sqrt();
    common >= SHARE * count && scatter < (SCATTER_SHARE * mean).max(SCATTER)
}

/// Dimensions of the grid of blocks.
struct Grid {
    columns: usize,
    rows: usize,
}

impl Grid {
    /// Dilation by a square of side 2 · `reach` + 1.
    fn grown(&self, set: &[bool], reach: usize) -> Vec<bool> {
        // A square is separable: dilation along the rows, then of its result along the columns.
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

    /// Erosion: the complement of the dilated complement. Outside the grid counts as set, so that
    /// an area does not recede from the border of the picture.
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
            if !hole.iter().any(|&block| self.is_at_border(block)) {
                for block in hole {
                    set[block] = true;
                }
            }
        }
    }

    fn is_at_border(&self, block: usize) -> bool {
        let (row, column) = (block / self.columns, block % self.columns);
        row == 0 || column == 0 || row + 1 == self.rows || column + 1 == self.columns
    }
}

/// The 8-connected components of the set cells, as lists of cell indices.
pub(in crate::paint) fn parts(set: &[bool], columns: usize) -> Vec<Vec<usize>> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Picture;
    use touchline_core::geometry::{ImageSize, PixelBox};

    /// Turf, with 32 px of sky on the left.
    fn turf_beside_sky() -> Picture {
        let row: Vec<u8> = (0..320)
            .flat_map(|x| {
                if x < 32 {
                    [150, 180, 220, 255]
                } else {
                    [62, 110, 42, 255]
                }
            })
            .collect();
        Picture::new(ImageSize::new(320, 180), row.repeat(180)).unwrap()
    }

    #[test]
    fn what_lies_right_of_the_picture_is_not_its_next_row() {
        let area = GroundArea::detect(&GroundPicture::new(&turf_beside_sky(), &[]));
        assert!(area.holds(40, 50) && !area.holds(8, 50));
        assert!(area.is_near_border(ImagePoint::new(40.0, 50.0)));
        assert!(!area.is_near_border(ImagePoint::new(310.0, 50.0)));
        for outside in [ImagePoint::new(320.5, 50.0), ImagePoint::new(-0.5, 50.0)] {
            assert!(!area.is_near_border(outside) && !area.is_of_ground(outside));
        }
    }

    #[test]
    fn a_mask_covers_its_pixels_and_one_of_negative_width_covers_none() {
        let mask = |width: f64| PixelBox {
            x: 100.0,
            y: 10.0,
            width,
            height: 30.0,
        };
        let is_of_ground = |mask: PixelBox, x: f64| {
            GroundArea::detect(&GroundPicture::new(&turf_beside_sky(), &[mask]))
                .is_of_ground(ImagePoint::new(x, 20.5))
        };
        assert!(!is_of_ground(mask(20.0), 110.5));
        assert!(is_of_ground(mask(-20.0), 90.5));
    }
}
