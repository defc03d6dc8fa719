//! Decoded pixels.

use super::MediaError;
use image::imageops::{self, FilterType};
use image::{ImageBuffer, Rgba};
use std::fmt;
use std::sync::Arc;
use touchline_core::geometry::ImageSize;

/// A decoded frame: opaque RGBA, 8 bits a channel, rows from the top, no padding.
///
/// Cloning shares the pixels.
#[derive(Clone, PartialEq, Eq)]
pub struct Picture {
    size: ImageSize,
    rgba: Arc<Vec<u8>>,
}

impl Picture {
    /// A picture from its pixels: `4 · width · height` bytes, red first.
    ///
    /// # Errors
    /// [`MediaError::WrongLength`] when the buffer does not fit the size.
    pub fn new(size: ImageSize, rgba: Vec<u8>) -> Result<Self, MediaError> {
        if Some(rgba.len()) == byte_count(size) {
            Ok(Self {
                size,
                rgba: Arc::new(rgba),
            })
        } else {
            Err(MediaError::WrongLength {
                bytes: rgba.len(),
                width: size.width,
                height: size.height,
            })
        }
    }

    /// A picture of one colour.
    pub fn with_colour(size: ImageSize, colour: [u8; 4]) -> Self {
        let count = size.width as usize * size.height as usize;
        Self {
            size,
            rgba: Arc::new(colour.repeat(count)),
        }
    }

    /// Columns and rows.
    pub const fn size(&self) -> ImageSize {
        self.size
    }

    /// The pixels: rows from the top, four bytes each, red first.
    pub fn rgba(&self) -> &[u8] {
        &self.rgba
    }

    /// The pixel in column `x` and row `y`, both from 0; none outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 4]> {
        if x >= self.size.width || y >= self.size.height {
            return None;
        }
        let at = 4 * (y as usize * self.size.width as usize + x as usize);
        self.rgba.get(at..at + 4)?.try_into().ok()
    }

    /// The same picture in another size, by cubic interpolation.
    ///
    /// # Errors
    /// [`MediaError::WrongLength`] when there is no buffer for the size.
    pub fn resize(&self, size: ImageSize) -> Result<Self, MediaError> {
        let ImageSize { width, height } = self.size;
        let pixels = ImageBuffer::<Rgba<u8>, &[u8]>::from_raw(width, height, &self.rgba);
        let resized = pixels.map(|pixels| {
            imageops::resize(&pixels, size.width, size.height, FilterType::CatmullRom)
        });
        Self::new(size, resized.map_or_else(Vec::new, ImageBuffer::into_raw))
    }

    /// Memory of the pixels, bytes.
    pub fn bytes(&self) -> usize {
        self.rgba.len()
    }
}

/// The length of an RGBA buffer of this size; none when it cannot be addressed.
pub(super) fn byte_count(size: ImageSize) -> Option<usize> {
    (size.width as usize)
        .checked_mul(size.height as usize)?
        .checked_mul(4)
}

impl fmt::Debug for Picture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Picture({} × {})", self.size.width, self.size.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_buffer_must_fit_its_size() {
        let error = Picture::new(ImageSize::new(2, 2), vec![0; 15]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "15 bytes are not a picture of 2 × 2 px with 4 bytes each"
        );
        assert!(Picture::new(ImageSize::new(u32::MAX, u32::MAX), Vec::new()).is_err());
    }

    #[test]
    fn pixels_stand_in_rows_from_the_top() {
        let picture = Picture::new(ImageSize::new(2, 2), (0..16).collect()).unwrap();
        assert_eq!(picture.pixel(1, 0), Some([4, 5, 6, 7]));
        assert_eq!(picture.pixel(0, 1), Some([8, 9, 10, 11]));
        assert_eq!(picture.pixel(2, 0), None);
        assert_eq!(picture.pixel(0, 2), None);
    }
}
