//! Black bars along the borders of pictures: above and below a wide film, beside a narrow one.
//!
//! A bar consists of the rows (or columns) from a border on that are black in nearly all pictures.
//! It must end abruptly, at the same row in most pictures, which a dark sky does not.

use super::burnt_in::StaticGraphic;
use super::reduced::ReducedPicture;
use touchline_core::geometry::PixelBox;

/// Upper limit of black after compression, grey levels.
const BLACK: f32 = 24.0;

/// Minimum share of a row's pixels that are black.
const OF_ROW: f32 = 0.98;

/// A row belongs to a bar if it is black in this share of the pictures,
const OF_PICTURES: f64 = 0.95;

/// and in this share of them the picture that follows the bar is brighter by [`EDGE`] grey levels.
/// A dark sky ends at another row in each picture.
const EDGE_IN: f64 = 0.7;
const EDGE: f32 = 12.0;

/// Maximum share of the height or width that a bar takes. Bars of fewer than [`THIN`] px of the
/// reduced picture are the picture's own border.
const LARGEST: f64 = 0.3;
const THIN: usize = 2;

/// A border of the picture.
#[derive(Clone, Copy)]
enum Border {
    Top,
    Bottom,
    Left,
    Right,
}

/// A row parallel to a border, or a column: share of black pixels, and mean brightness.
#[derive(Clone, Copy, Default)]
struct BorderRow {
    black: f32,
    mean: f32,
}

/// The black bars of pictures of one size, as boxes that all pictures show.
pub(super) fn black_bars(pictures: &[ReducedPicture]) -> Vec<StaticGraphic> {
    // Pictures that are mostly black, such as fades, say nothing; two others are needed.
    let lit: Vec<&ReducedPicture> = pictures.iter().filter(|picture| is_lit(picture)).collect();
    let [first, _, ..] = lit[..] else {
        return Vec::new();
    };
    // Boxes are in px of the full picture and end at its border, so that they include the columns
    // and rows that the reduction dropped.
    let (width, height) = (f64::from(first.size.width), f64::from(first.size.height));
    let mut bars = Vec::new();
    for border in [Border::Top, Border::Bottom, Border::Left, Border::Right] {
        let Some(rows) = depth(&lit, border) else {
            continue;
        };
        // One row more: the reduced row in which the bar ends is partly black.
        let rows = rows + 1;
        let (mut x, mut y, mut right, mut bottom) = (0.0, 0.0, width, height);
        match border {
            Border::Top => bottom = (first.step * rows) as f64,
            Border::Bottom => y = (first.step * (first.height - rows)) as f64,
            Border::Left => right = (first.step * rows) as f64,
            Border::Right => x = (first.step * (first.width - rows)) as f64,
        }
        let pixel_box = PixelBox::new(x, y, right - x, bottom - y);
        bars.push(StaticGraphic::throughout(pixel_box, pictures.len()));
    }
    bars
}

/// Whether more than half of a picture is not black; false for a picture without pixels.
fn is_lit(picture: &ReducedPicture) -> bool {
    let black = picture.grey.iter().filter(|grey| **grey < BLACK).count();
    2 * black < picture.grey.len()
}

/// Number of rows from a border on that are black in nearly all pictures, with an abrupt end in
/// most. None if there is no bar.
fn depth(pictures: &[&ReducedPicture], border: Border) -> Option<usize> {
    let first = pictures.first()?;
    let all = match border {
        Border::Top | Border::Bottom => first.height,
        Border::Left | Border::Right => first.width,
    };
    // One row beyond `most` shows that a bar is too deep, and two more are compared at its end.
    let most = (LARGEST * all as f64) as usize;
    let rows: Vec<Vec<BorderRow>> = pictures
        .iter()
        .map(|picture| (0..most + 3).map(|at| row(picture, border, at)).collect())
        .collect();
    let deep = (0..=most)
        .take_while(|&at| share_of_pictures(&rows, |rows| rows[at].black >= OF_ROW) >= OF_PICTURES)
        .count();
    // Row `deep` is a mixture of bar and picture, so its two neighbours are compared.
    let ends = share_of_pictures(&rows, |rows| {
        deep > 0 && rows[deep + 1].mean > rows[deep - 1].mean + EDGE
    });
    (deep >= THIN && deep <= most && ends >= EDGE_IN).then_some(deep)
}

/// The share of the pictures that meet a condition on their rows.
fn share_of_pictures(rows: &[Vec<BorderRow>], condition: impl Fn(&[BorderRow]) -> bool) -> f64 {
    rows.iter().filter(|rows| condition(rows)).count() as f64 / rows.len() as f64
}

/// The `at`-th row, or column, from a border.
fn row(picture: &ReducedPicture, border: Border, at: usize) -> BorderRow {
    let (width, height) = (picture.width, picture.height);
    // Index of the first pixel, distance between pixels, and their number, in row-major order. In a
    // tiny picture rows beyond the last one repeat it.
    let (start, step, count) = match border {
        Border::Top => (at.min(height - 1) * width, 1, width),
        Border::Bottom => (height.saturating_sub(at + 1) * width, 1, width),
        Border::Left => (at.min(width - 1), width, height),
        Border::Right => (width.saturating_sub(at + 1), width, height),
    };
    let mut row = BorderRow::default();
    for grey in picture.grey.iter().skip(start).step_by(step).take(count) {
        row.mean += grey / count as f32;
        row.black += f32::from(u8::from(*grey < BLACK)) / count as f32;
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Picture;
    use touchline_core::geometry::ImageSize;

    const SIZE: ImageSize = ImageSize::new(480, 270);

    /// Grey that changes from picture to picture inside a frame of black, px above, below, left and
    /// right.
    fn picture(number: u32, [above, below, left, right]: [u32; 4]) -> ReducedPicture {
        let mut rgba = Vec::new();
        for y in 0..SIZE.height {
            for x in 0..SIZE.width {
                let inside = (above..SIZE.height - below).contains(&y)
                    && (left..SIZE.width - right).contains(&x);
                let grey = if inside {
                    60 + ((x + y + 17 * number) % 120) as u8
                } else {
                    ((x + y) % 5) as u8
                };
                rgba.extend([grey, grey, grey, 255]);
            }
        }
        ReducedPicture::new(&Picture::new(SIZE, rgba).unwrap())
    }

    fn found(of: &[[u32; 4]]) -> Vec<PixelBox> {
        let pictures: Vec<ReducedPicture> = (0..)
            .zip(of)
            .map(|(number, bars)| picture(number, *bars))
            .collect();
        black_bars(&pictures)
            .iter()
            .map(|bar| bar.pixel_box)
            .collect()
    }

    #[test]
    fn bars_are_as_deep_as_they_are() {
        let [above, below] = found(&[[30, 20, 0, 0]; 5])[..] else {
            panic!("two bars")
        };
        assert_eq!(
            (above.x, above.y, above.width, above.height),
            (0.0, 0.0, 480.0, 31.0)
        );
        assert_eq!((below.y, below.width, below.height), (249.0, 480.0, 21.0));
        let [left, right] = found(&[[0, 0, 60, 60]; 2])[..] else {
            panic!("two bars")
        };
        assert_eq!(
            (left.width, left.height, right.x, right.width),
            (61.0, 270.0, 419.0, 61.0)
        );
    }

    #[test]
    fn a_dark_sky_and_a_black_picture_are_no_bars() {
        assert_eq!(found(&[[0; 4]; 4]), []);
        assert_eq!(
            found(&[[20, 0, 0, 0], [34, 0, 0, 0], [50, 0, 0, 0], [28, 0, 0, 0]]),
            [],
            "it ends elsewhere in each"
        );
        assert_eq!(found(&[[269, 0, 0, 0]; 4]), [], "black all over");
        assert_eq!(found(&[[30, 20, 0, 0]]), [], "one picture");
    }
}
