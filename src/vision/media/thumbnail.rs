//! Small pictures for the filmstrip.

use super::Picture;
use std::iter::StepBy;
use std::ops::Range;
use touchline_core::geometry::ImageSize;

/// Maximum number of samples per thumbnail pixel in each direction.
const SAMPLES: u32 = 4;
const BLACK: [u8; 4] = [0, 0, 0, 255];

/// The size of a thumbnail in the filmstrip, px.
pub const THUMBNAIL_SIZE: ImageSize = ImageSize::new(160, 90);

/// A picture scaled to fit into `size` and centred on black. A picture that is small enough is not
/// enlarged.
pub fn letterbox(picture: &Picture, size: ImageSize) -> Picture {
    // `fit_within` exceeds `size` in neither direction, so the margins are not negative; the
    // smaller half of an odd one is at the left and at the top.
    let inner = fit_within(picture.size(), size);
    let (left, top) = (
        (size.width - inner.width) / 2,
        (size.height - inner.height) / 2,
    );
    let mut rgba = Vec::with_capacity(4 * size.width as usize * size.height as usize);
    for y in 0..size.height {
        for x in 0..size.width {
            let inside = x
                .checked_sub(left)
                .zip(y.checked_sub(top))
                .filter(|&(x, y)| x < inner.width && y < inner.height);
            rgba.extend(inside.map_or(BLACK, |(x, y)| mean_below(picture, inner, x, y)));
        }
    }
    Picture::new(size, rgba).unwrap_or_else(|_| Picture::with_colour(size, BLACK))
}

/// The mean of the pixels that one pixel of a smaller picture covers: all of them up to [`SAMPLES`]
/// in each direction, beyond that about as many, evenly spaced.
fn mean_below(picture: &Picture, small: ImageSize, x: u32, y: u32) -> [u8; 4] {
    let mut sum = [0_u32; 3];
    let mut count = 0;
    for row in covered_indices(y, small.height, picture.size().height) {
        for column in covered_indices(x, small.width, picture.size().width) {
            let [red, green, blue, _] = picture.pixel(column, row).unwrap_or(BLACK);
            sum = [
                sum[0] + u32::from(red),
                sum[1] + u32::from(green),
                sum[2] + u32::from(blue),
            ];
            count += 1;
        }
    }
    let [red, green, blue] = sum.map(|total| ((total + count / 2) / count.max(1)) as u8);
    [red, green, blue, 255]
}

/// The indices in a row of `large` px that pixel `at` of a row of `small` px covers: at least one.
fn covered_indices(at: u32, small: u32, large: u32) -> StepBy<Range<u32>> {
    // Neighbouring pixels share an edge, so together they cover every index once. 64 bits, because
    // the product of two sides may exceed 32.
    let [start, next] = [at, at + 1]
        .map(|edge| (u64::from(edge) * u64::from(large) / u64::from(small.max(1))) as u32);
    let end = next.max(start + 1);
    (start..end).step_by(((end - start) / SAMPLES).max(1) as usize)
}

/// The largest size of the shape of `inner` that fits into `outer`, at most `inner` itself.
fn fit_within(inner: ImageSize, outer: ImageSize) -> ImageSize {
    let (width, height) = (
        f64::from(inner.width.max(1)),
        f64::from(inner.height.max(1)),
    );
    let scale = (f64::from(outer.width) / width)
        .min(f64::from(outer.height) / height)
        .min(1.0);
    // A side keeps at least a pixel, however extreme the shape, and rounding may not exceed
    // `outer`.
    let [width, height] = [(width, outer.width), (height, outer.height)]
        .map(|(length, limit)| ((length * scale).round().max(1.0) as u32).min(limit));
    ImageSize::new(width, height)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: [u8; 4] = [255; 4];

    #[test]
    fn a_square_stands_between_two_black_bars() {
        let small = letterbox(
            &Picture::with_colour(ImageSize::new(900, 900), WHITE),
            THUMBNAIL_SIZE,
        );
        assert_eq!(small.size(), THUMBNAIL_SIZE);
        assert_eq!(small.pixel(34, 45), Some(BLACK));
        assert_eq!(small.pixel(35, 45), Some(WHITE));
        assert_eq!(small.pixel(124, 45), Some(WHITE));
        assert_eq!(small.pixel(125, 45), Some(BLACK));
    }

    #[test]
    fn a_pixel_is_the_mean_of_what_it_covers() {
        let stripes = (0..320 * 180)
            .flat_map(|pixel| if pixel % 2 == 0 { WHITE } else { BLACK })
            .collect();
        let small = letterbox(
            &Picture::new(ImageSize::new(320, 180), stripes).unwrap(),
            THUMBNAIL_SIZE,
        );
        assert!(
            small
                .rgba()
                .chunks(4)
                .all(|pixel| pixel == [128, 128, 128, 255])
        );
    }

    #[test]
    fn extreme_shapes_keep_one_pixel() {
        for (width, height) in [(1, 10_000), (10_000, 1), (1, 1), (160, 90)] {
            let small = letterbox(
                &Picture::with_colour(ImageSize::new(width, height), WHITE),
                THUMBNAIL_SIZE,
            );
            assert_eq!(small.size(), THUMBNAIL_SIZE);
            assert!(
                small.rgba().chunks(4).any(|pixel| pixel == WHITE),
                "{width} × {height}"
            );
        }
        let none = letterbox(
            &Picture::with_colour(ImageSize::new(0, 0), WHITE),
            THUMBNAIL_SIZE,
        );
        assert!(none.rgba().chunks(4).all(|pixel| pixel == BLACK));
    }
}
