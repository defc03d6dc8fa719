//! Small pictures for the filmstrip.

use super::Picture;
use crate::geometry::ImageSize;
use image::{ImageBuffer, Rgba, RgbaImage, imageops};

/// The size of a thumbnail in the filmstrip, px.
pub const THUMBNAIL_SIZE: ImageSize = ImageSize::new(160, 90);

/// A picture scaled to fit into `size` and centred on black. A picture that is small enough is not enlarged.
#[must_use]
pub fn letterboxed(picture: &Picture, size: ImageSize) -> Picture {
    let mut canvas = RgbaImage::from_pixel(size.width, size.height, Rgba([0, 0, 0, 255]));
    let inner = fitted(picture.size(), size);
    let source = ImageBuffer::<Rgba<u8>, &[u8]>::from_raw(picture.size().width, picture.size().height, picture.rgba());
    if let Some(source) = source.filter(|_| inner.width > 0 && inner.height > 0) {
        let small = imageops::thumbnail(&source, inner.width, inner.height);
        let (left, top) = ((size.width - inner.width) / 2, (size.height - inner.height) / 2);
        imageops::replace(&mut canvas, &small, i64::from(left), i64::from(top));
    }
    Picture::new(size, canvas.into_raw()).unwrap_or_else(|_| Picture::filled(size, [0, 0, 0, 255]))
}

/// The largest size of the shape of `inner` that fits into `outer`, at most `inner` itself.
fn fitted(inner: ImageSize, outer: ImageSize) -> ImageSize {
    let (width, height) = (f64::from(inner.width.max(1)), f64::from(inner.height.max(1)));
    let scale = (f64::from(outer.width) / width).min(f64::from(outer.height) / height).min(1.0);
    let side = |length: f64, limit: u32| ((length * scale).round().max(1.0) as u32).min(limit);
    ImageSize::new(side(width, outer.width), side(height, outer.height))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: [u8; 4] = [255; 4];
    const BLACK: [u8; 4] = [0, 0, 0, 255];

    #[test]
    fn a_square_stands_between_two_black_bars() {
        let small = letterboxed(&Picture::filled(ImageSize::new(900, 900), WHITE), THUMBNAIL_SIZE);
        assert_eq!(small.size(), THUMBNAIL_SIZE);
        assert_eq!(small.pixel(34, 45), Some(BLACK));
        assert_eq!(small.pixel(35, 45), Some(WHITE));
        assert_eq!(small.pixel(124, 45), Some(WHITE));
        assert_eq!(small.pixel(125, 45), Some(BLACK));
    }

    #[test]
    fn extreme_shapes_keep_one_pixel() {
        for (width, height) in [(1, 10_000), (10_000, 1), (1, 1), (160, 90)] {
            let small = letterboxed(&Picture::filled(ImageSize::new(width, height), WHITE), THUMBNAIL_SIZE);
            assert_eq!(small.size(), THUMBNAIL_SIZE);
            assert!(small.rgba().chunks(4).any(|pixel| pixel == WHITE), "{width} × {height}");
        }
        let none = letterboxed(&Picture::filled(ImageSize::new(0, 0), WHITE), THUMBNAIL_SIZE);
        assert!(none.rgba().chunks(4).all(|pixel| pixel == BLACK));
    }
}
