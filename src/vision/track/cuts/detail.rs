//! The detail of a miniature, and how a camera moves it.

use nalgebra::{Matrix4, Vector4};

/// Columns of a miniature.
pub const WIDTH: usize = 64;
/// Rows of a miniature.
pub const HEIGHT: usize = 36;
/// Half the side of the squares whose mean is a cell's value, and whose mean is no detail, cells.
const SMOOTHED: usize = 1;
const AROUND: usize = 4;
/// Number of blocks of a picture in each direction, and the size of each, cells.
const BLOCKS: [usize; 2] = [8, 6];
const BLOCK: [usize; 2] = [WIDTH / BLOCKS[0], HEIGHT / BLOCKS[1]];
/// Minimum mean square of a block's detail, squared grey levels; turf without lines has less.
const LEAST_POWER: f32 = 3.0;
/// Minimum number of blocks that say what is left.
const LEAST_BLOCKS: usize = 12;
/// Number of steps of an alignment, and their largest length, cells and logarithm of the zoom.
const STEPS: usize = 3;
const LARGEST_STEP: [f32; 3] = [1.0, 1.0, 0.03];
/// Minimum contrast of the other picture, relative to this one, that tells a shift.
const LEAST_CONTRAST: f32 = 0.15;
/// The middle of a miniature, cells.
const MIDDLE: [f32; 2] = [0.5 * (WIDTH as f32 - 1.0), 0.5 * (HEIGHT as f32 - 1.0)];

/// Luminance of each cell without the mean around it, grey levels.
#[derive(Clone, Debug, PartialEq)]
pub struct Detail(Vec<f32>);

/// What is left of a block in another picture.
#[derive(Clone, Copy, Debug)]
pub struct Left {
    /// The contrast of its detail there, relative to its own.
    pub share: f32,
    /// The power of its own detail, which the share is as exact as.
    pub power: f32,
    /// How alike both are: 1 for the same detail, about 0 for another one of any contrast.
    pub likeness: f32,
}

/// Where a camera that turns and zooms moves a picture to: by cells to the right and down, and by
/// the logarithm of the zoom about the middle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shift([f32; 3]);

impl Shift {
    pub fn times(self, factor: f32) -> Self {
        Self(self.0.map(|part| factor * part))
    }

    pub fn plus(self, other: Self) -> Self {
        Self([0, 1, 2].map(|at| self.0[at] + other.0[at]))
    }

    /// Where it moves the cell of a column and a row to.
    fn to_places(self) -> impl Fn(usize, usize) -> [f32; 2] {
        let [right, down, log_zoom] = self.0;
        let zoom = log_zoom.exp();
        move |column, row| {
            let [x, y] = from_middle(column, row);
            [x * zoom + right + MIDDLE[0], y * zoom + down + MIDDLE[1]]
        }
    }
}

/// The columns and rows of all cells, row by row.
fn cells() -> impl Iterator<Item = (usize, usize)> {
    (0..HEIGHT).flat_map(|row| (0..WIDTH).map(move |column| (column, row)))
}

/// The mean of each cell and those at most `reach` columns and rows beside it.
fn mean_around(cells: &[f32], reach: usize) -> Vec<f32> {
    let rows: Vec<f32> = self::cells()
        .map(|(column, row)| mean_near(column, WIDTH, reach, |column| cells[row * WIDTH + column]))
        .collect();
    self::cells()
        .map(|(column, row)| mean_near(row, HEIGHT, reach, |row| rows[row * WIDTH + column]))
        .collect()
}

/// The mean of the values at a place of a side and at most `reach` places beside it.
fn mean_near(at: usize, side: usize, reach: usize, value: impl Fn(usize) -> f32) -> f32 {
    let near = at.saturating_sub(reach)..(at + reach + 1).min(side);
    let count = near.len() as f32;
    near.map(value).sum::<f32>() / count
}

fn from_middle(column: usize, row: usize) -> [f32; 2] {
    [column as f32 - MIDDLE[0], row as f32 - MIDDLE[1]]
}

impl Detail {
    /// The detail of a picture by the luminance of its cells, row by row.
    pub fn new(luminance: &[f32]) -> Self {
        // A little smoothed, so that a shift by a part of a cell takes nothing away.
        let smooth = mean_around(luminance, SMOOTHED);
        let mean = mean_around(luminance, AROUND);
        Self(
            smooth
                .iter()
                .zip(mean)
                .map(|(cell, mean)| cell - mean)
                .collect(),
        )
    }

    fn at(&self, column: usize, row: usize) -> f32 {
        self.0[row * WIDTH + column]
    }

    /// The value at a place between cells; none outside.
    fn sample(&self, [x, y]: [f32; 2]) -> Option<f32> {
        let inside =
            (0.0..=WIDTH as f32 - 1.0).contains(&x) && (0.0..=HEIGHT as f32 - 1.0).contains(&y);
        if !inside {
            return None;
        }
        let (column, row) = ((x as usize).min(WIDTH - 2), (y as usize).min(HEIGHT - 2));
        let (right, down) = (x - column as f32, y - row as f32);
        let upper = (1.0 - right) * self.at(column, row) + right * self.at(column + 1, row);
        let lower = (1.0 - right) * self.at(column, row + 1) + right * self.at(column + 1, row + 1);
        Some((1.0 - down) * upper + down * lower)
    }

    /// The shift near another one under which this detail lies in `other`, in least squares with a
    /// free contrast, by Gauss and Newton.
    pub fn align(&self, other: &Self, mut shift: Shift) -> Shift {
        for _ in 0..STEPS {
            let mut normal = Matrix4::<f32>::zeros();
            let mut right_side = Vector4::<f32>::zeros();
            let place = shift.to_places();
            // The other picture has c (D + ∇D·δ) there, if its contrast is c and the shift too far
            // by δ: linear in c and c δ.
            for (column, row) in cells().step_by(2) {
                let Some(seen) = other.sample(place(column, row)) else {
                    continue;
                };
                let [x, y] = from_middle(column, row);
                let [along_x, along_y] = self.slope(column, row);
                let terms = Vector4::new(
                    self.at(column, row),
                    along_x,
                    along_y,
                    along_x * x + along_y * y,
                );
                normal += terms * terms.transpose();
                right_side += terms * seen;
            }
            // Flat directions stay where they are.
            for at in 0..4 {
                normal[(at, at)] = 1.001 * normal[(at, at)] + 1.0;
            }
            let Some(solution) = normal.cholesky().map(|factors| factors.solve(&right_side)) else {
                break;
            };
            let contrast = solution[0];
            if contrast < LEAST_CONTRAST {
                break;
            }
            let step = [1, 2, 3].map(|at| {
                let most = LARGEST_STEP[at - 1];
                (-solution[at] / contrast).clamp(-most, most)
            });
            shift = shift.plus(Shift(step));
        }
        shift
    }

    /// Half the difference of the neighbours, to the right and down.
    fn slope(&self, column: usize, row: usize) -> [f32; 2] {
        let is_inside = (1..WIDTH - 1).contains(&column) && (1..HEIGHT - 1).contains(&row);
        if !is_inside {
            return [0.0; 2];
        }
        [
            0.5 * (self.at(column + 1, row) - self.at(column - 1, row)),
            0.5 * (self.at(column, row + 1) - self.at(column, row - 1)),
        ]
    }

    /// What is left of this detail in `other` under a shift, in each block that has detail and is
    /// still seen.
    pub fn compare(&self, other: &Self, shift: Shift) -> Vec<Left> {
        let mut blocks = vec![[0.0_f32; 3]; BLOCKS[0] * BLOCKS[1]];
        let place = shift.to_places();
        for (column, row) in cells() {
            let block = &mut blocks[row / BLOCK[1] * BLOCKS[0] + column / BLOCK[0]];
            if let Some(seen) = other.sample(place(column, row)) {
                let own = self.at(column, row);
                block[0] += own * seen;
                block[1] += own * own;
                block[2] += seen * seen;
            }
        }
        let least = (BLOCK[0] * BLOCK[1]) as f32;
        let told = blocks
            .iter()
            .filter(|[_, power, _]| *power > LEAST_POWER * least);
        let left = told.map(|[along, own, others]| Left {
            share: along / own,
            power: *own,
            likeness: 2.0 * along / (own + others),
        });
        let left: Vec<Left> = left.collect();
        if left.len() < LEAST_BLOCKS {
            Vec::new()
        } else {
            left
        }
    }
}
