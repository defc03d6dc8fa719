//! Image files: PNG, JPEG, TIFF, BMP and WebP, known by their content, turned upright as their EXIF data say.

use super::error::open_file;
use super::{MediaError, Picture};
use crate::geometry::ImageSize;
use image::error::ImageError;
use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageReader, Limits};
use std::io::BufReader;
use std::path::Path;

/// How large a picture may be, so that a few bytes cannot claim all memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageLimits {
    /// The longest side, px. 16,384 by default, the side of a texture that graphics adapters take.
    pub max_side_px: u32,
    /// The largest area, millions of px. 100 by default, 400 MB once decoded.
    pub max_megapixels: u64,
}

impl Default for ImageLimits {
    fn default() -> Self {
        Self { max_side_px: 16_384, max_megapixels: 100 }
    }
}

/// Bytes that a decoder may allocate for one px: four channels of 32 bits at most.
const MAX_BYTES_PER_PX: u64 = 16;

impl ImageLimits {
    /// Refuses a size beyond the limits.
    pub(super) fn check(&self, path: &Path, width: u32, height: u32) -> Result<(), MediaError> {
        let area = u64::from(width) * u64::from(height);
        if width <= self.max_side_px && height <= self.max_side_px && area <= self.max_megapixels * 1_000_000 {
            return Ok(());
        }
        Err(MediaError::TooLarge {
            path: path.to_path_buf(),
            width,
            height,
            max_side_px: self.max_side_px,
            max_megapixels: self.max_megapixels,
        })
    }
}

/// Reads an image file with the default [`ImageLimits`].
///
/// The format is known by the content, not by the name's ending. The EXIF orientation is applied, 16-bit and float
/// channels become 8-bit, grey becomes RGB, transparent pixels are laid over black.
///
/// # Errors
/// The file cannot be read, is no image of a known format, is damaged or too large.
pub fn load_image(path: &Path) -> Result<Picture, MediaError> {
    load_image_within(path, ImageLimits::default())
}

/// Reads an image file, see [`load_image`], of at most the given size.
///
/// # Errors
/// As [`load_image`].
pub fn load_image_within(path: &Path, limits: ImageLimits) -> Result<Picture, MediaError> {
    let mut decoder = open_decoder(path, limits)?;
    let orientation = orientation_of(&mut decoder);
    let mut image = DynamicImage::from_decoder(decoder).map_err(|error| named(path, error))?;
    image.apply_orientation(orientation);
    let has_alpha = image.color().has_alpha();
    let mut rgba = image.into_rgba8();
    if has_alpha {
        lay_over_black(&mut rgba);
    }
    let size = ImageSize::new(rgba.width(), rgba.height());
    Picture::new(size, rgba.into_raw())
}

/// The size of an image as [`load_image`] returns it, EXIF orientation applied, without decoding the pixels.
///
/// # Errors
/// The file cannot be read, is no image of a known format or is too large by the default [`ImageLimits`].
pub fn image_size(path: &Path) -> Result<ImageSize, MediaError> {
    let mut decoder = open_decoder(path, ImageLimits::default())?;
    let (width, height) = decoder.dimensions();
    Ok(match orientation_of(&mut decoder) {
        Orientation::Rotate90 | Orientation::Rotate270 | Orientation::Rotate90FlipH | Orientation::Rotate270FlipH => {
            ImageSize::new(height, width)
        }
        Orientation::NoTransforms
        | Orientation::Rotate180
        | Orientation::FlipHorizontal
        | Orientation::FlipVertical => ImageSize::new(width, height),
    })
}

/// A decoder that has read the header and found the stated size within the limits.
fn open_decoder(path: &Path, limits: ImageLimits) -> Result<impl ImageDecoder, MediaError> {
    let file = BufReader::new(open_file(path)?);
    let mut reader = ImageReader::new(file).with_guessed_format().map_err(|error| MediaError::from_io(path, &error))?;
    if reader.format().is_none() {
        return Err(MediaError::NotAnImage { path: path.to_path_buf() });
    }
    // The size is checked below, with its numbers; this bounds what a decoder allocates before and beside it.
    let mut decoder_limits = Limits::no_limits();
    decoder_limits.max_alloc = Some(limits.max_megapixels.saturating_mul(1_000_000 * MAX_BYTES_PER_PX));
    reader.limits(decoder_limits);
    let decoder = reader.into_decoder().map_err(|error| named(path, error))?;
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 {
        return Err(MediaError::DamagedImage { path: path.to_path_buf(), reason: format!("{width} × {height} px") });
    }
    limits.check(path, width, height)?;
    Ok(decoder)
}

/// Unreadable EXIF data turn nothing: the pixels are still good.
fn orientation_of(decoder: &mut impl ImageDecoder) -> Orientation {
    decoder.orientation().unwrap_or(Orientation::NoTransforms)
}

/// Multiplies straight alpha in and makes every pixel opaque.
fn lay_over_black(rgba: &mut image::RgbaImage) {
    for pixel in rgba.pixels_mut() {
        let alpha = u16::from(pixel[3]);
        for channel in &mut pixel.0[..3] {
            *channel = ((u16::from(*channel) * alpha + 127) / 255) as u8;
        }
        pixel[3] = 255;
    }
}

/// The named form of what a decoder said.
fn named(path: &Path, error: ImageError) -> MediaError {
    let path = path.to_path_buf();
    match error {
        ImageError::IoError(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
            MediaError::DamagedImage { path, reason: "the file ends too early".to_owned() }
        }
        ImageError::IoError(error) => MediaError::from_io(&path, &error),
        ImageError::Unsupported(error) => MediaError::UnsupportedImage { path, what: one_line(&error.to_string()) },
        ImageError::Decoding(error) => MediaError::DamagedImage { path, reason: one_line(&error.to_string()) },
        ImageError::Encoding(_) | ImageError::Parameter(_) | ImageError::Limits(_) => {
            MediaError::DamagedImage { path, reason: one_line(&error.to_string()) }
        }
    }
}

/// A decoder's words as one line.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
