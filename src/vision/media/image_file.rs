//! Image files: PNG, JPEG, TIFF, BMP and WebP, recognised by their content and made upright by
//! their EXIF orientation.

use super::error::open_file;
use super::jpeg_end::is_cut_off;
use super::{MediaError, Picture, one_line};
use image::error::{ImageError, ImageFormatHint, UnsupportedErrorKind};
use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use std::error::Error;
use std::io::{BufReader, Read as _};
use std::path::Path;
use touchline_core::files::read_named;
use touchline_core::geometry::ImageSize;

/// Size limits of pictures: a small file could otherwise claim all memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageLimits {
    /// The longest side, px. Default: 16,384, the largest texture of common graphics adapters.
    pub max_side_px: u32,
    /// The largest area, millions of px. Default: 100, which is 400 MB decoded.
    pub max_megapixels: u64,
}

impl Default for ImageLimits {
    fn default() -> Self {
        Self {
            max_side_px: 16_384,
            max_megapixels: 100,
        }
    }
}

/// The signature of a PNG.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Maximum size of a PNG's metadata: colour profile, EXIF, texts.
const MAX_METADATA_BYTES: u64 = 16 << 20;

/// Memory that a decoder may allocate per px: at most four channels of 32 bits.
const MAX_BYTES_PER_PX: u64 = 16;

impl ImageLimits {
    /// Refuses a size beyond the limits.
    pub(super) fn check(&self, path: &Path, width: u32, height: u32) -> Result<(), MediaError> {
        let area = u64::from(width) * u64::from(height);
        if width <= self.max_side_px
            && height <= self.max_side_px
            && area <= self.max_megapixels.saturating_mul(1_000_000)
        {
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

    /// Memory that decoding the largest allowed picture takes at most, bytes.
    const fn max_decoded_bytes(&self) -> u64 {
        self.max_megapixels
            .saturating_mul(1_000_000 * MAX_BYTES_PER_PX)
    }
}

/// Reads an image file with the default [`ImageLimits`].
///
/// The format is known by the content, not by the name's ending. The EXIF orientation is applied,
/// 16-bit and float channels become 8-bit, grey becomes RGB, transparent pixels are laid over
/// black.
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
    let (format, mut decoder) = open_decoder(path, limits)?;
    // The decoder fills a truncated JPEG with grey and reports no error, so the bytes are read once
    // more. The limit bounds the memory; it is far above the size of any real JPEG.
    if format == ImageFormat::Jpeg {
        let bytes = read_named(path, limits.max_decoded_bytes())
            .map_err(|error| MediaError::from_io(path, &error))?;
        if is_cut_off(&bytes) {
            return Err(ends_too_early(path));
        }
    }
    let orientation = orientation_of(&mut decoder);
    // Upright before anything else: all coordinates of documents belong to the upright picture.
    let mut image =
        DynamicImage::from_decoder(decoder).map_err(|error| media_error(path, limits, &error))?;
    image.apply_orientation(orientation);
    let has_alpha = image.color().has_alpha();
    let mut rgba = image.into_rgba8();
    if has_alpha {
        lay_over_black(&mut rgba);
    }
    let size = ImageSize::new(rgba.width(), rgba.height());
    Picture::new(size, rgba.into_raw())
}

/// The size of an image as [`load_image`] returns it, EXIF orientation applied, without decoding
/// the pixels.
///
/// # Errors
/// The file cannot be read, is no image of a known format or is too large by the default
/// [`ImageLimits`].
pub fn image_size(path: &Path) -> Result<ImageSize, MediaError> {
    let (_, mut decoder) = open_decoder(path, ImageLimits::default())?;
    let (width, height) = decoder.dimensions();
    Ok(match orientation_of(&mut decoder) {
        Orientation::Rotate90
        | Orientation::Rotate270
        | Orientation::Rotate90FlipH
        | Orientation::Rotate270FlipH => ImageSize::new(height, width),
        Orientation::NoTransforms
        | Orientation::Rotate180
        | Orientation::FlipHorizontal
        | Orientation::FlipVertical => ImageSize::new(width, height),
    })
}

/// The format, and a decoder that has read the header, after the stated size was checked against
/// the limits.
fn open_decoder(
    path: &Path,
    limits: ImageLimits,
) -> Result<(ImageFormat, impl ImageDecoder), MediaError> {
    // The compressed colour profile of a PNG is inflated before its size is known, so the first
    // attempt has a small limit.
    let all = limits.max_decoded_bytes();
    let max_alloc = if is_png(path)? {
        MAX_METADATA_BYTES
    } else {
        all
    };
    let (format, mut decoder) = open_with_max_alloc(path, limits, max_alloc)?;
    // The size is known: open it again with the memory that a picture of this size takes.
    let (width, height) = decoder.dimensions();
    if format == ImageFormat::Png {
        let pixels = u64::from(width)
            .saturating_mul(u64::from(height))
            .saturating_mul(MAX_BYTES_PER_PX);
        let max_alloc = pixels.saturating_add(MAX_METADATA_BYTES).min(all);
        (_, decoder) = open_with_max_alloc(path, limits, max_alloc)?;
    }
    if width == 0 || height == 0 {
        return Err(MediaError::DamagedImage {
            path: path.to_path_buf(),
            reason: format!("{width} × {height} px"),
        });
    }
    limits.check(path, width, height)?;
    Ok((format, decoder))
}

/// The format of a file, and a decoder that has read the header; `max_alloc` is the most that it
/// may allocate, bytes.
fn open_with_max_alloc(
    path: &Path,
    limits: ImageLimits,
    max_alloc: u64,
) -> Result<(ImageFormat, impl ImageDecoder), MediaError> {
    let reader = ImageReader::new(BufReader::new(open_file(path)?));
    let mut reader = reader
        .with_guessed_format()
        .map_err(|error| MediaError::from_io(path, &error))?;
    let Some(format) = reader.format() else {
        return Err(MediaError::NotAnImage {
            path: path.to_path_buf(),
        });
    };
    // The caller checks the size, with a message that has its numbers; this bounds what a decoder
    // allocates before and in addition.
    let mut decoder_limits = Limits::no_limits();
    decoder_limits.max_alloc = Some(max_alloc);
    reader.limits(decoder_limits);
    let decoder = reader
        .into_decoder()
        .map_err(|error| media_error(path, limits, &error))?;
    Ok((format, decoder))
}

/// Whether a file begins with the signature of a PNG.
fn is_png(path: &Path) -> Result<bool, MediaError> {
    let mut begin = Vec::new();
    let read = open_file(path)?
        .take(PNG.len() as u64)
        .read_to_end(&mut begin);
    read.map_err(|error| MediaError::from_io(path, &error))?;
    Ok(begin == PNG)
}

/// Unreadable EXIF data are ignored: the pixels are still usable.
fn orientation_of(decoder: &mut impl ImageDecoder) -> Orientation {
    decoder.orientation().unwrap_or(Orientation::NoTransforms)
}

/// Composites straight alpha over black, and makes every pixel opaque.
fn lay_over_black(rgba: &mut image::RgbaImage) {
    for pixel in rgba.pixels_mut() {
        let alpha = u16::from(pixel[3]);
        // 127 rounds the division by 255; the largest product, 255 · 255 + 127, fits 16 bits.
        for channel in &mut pixel.0[..3] {
            *channel = ((u16::from(*channel) * alpha + 127) / 255) as u8;
        }
        pixel[3] = 255;
    }
}

/// The error of a decoder as a `MediaError`.
fn media_error(path: &Path, limits: ImageLimits, error: &ImageError) -> MediaError {
    match error {
        ImageError::IoError(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
            ends_too_early(path)
        }
        ImageError::IoError(error) => MediaError::from_io(path, error),
        ImageError::Unsupported(error) => {
            let what = match error.kind() {
                UnsupportedErrorKind::Format(ImageFormatHint::Exact(format)) => {
                    format!("{format:?}").to_uppercase()
                }
                _ => reason(error),
            };
            MediaError::UnsupportedImage {
                path: path.to_path_buf(),
                what,
            }
        }
        ImageError::Limits(_) => MediaError::TooMuchMemory {
            path: path.to_path_buf(),
            max_megapixels: limits.max_megapixels,
        },
        ImageError::Decoding(error) => damaged_image(path, error),
        ImageError::Encoding(_) | ImageError::Parameter(_) => damaged_image(path, error),
    }
}

/// The error of an image that cannot be decoded.
fn damaged_image(path: &Path, error: &dyn Error) -> MediaError {
    MediaError::DamagedImage {
        path: path.to_path_buf(),
        reason: reason(error),
    }
}

fn ends_too_early(path: &Path) -> MediaError {
    MediaError::DamagedImage {
        path: path.to_path_buf(),
        reason: "the file ends too early".to_owned(),
    }
}

/// The innermost message of an error as one line, without a dumped data structure at its end.
fn reason(error: &dyn Error) -> String {
    // The outer messages of `image` repeat the format and the inner one; its PNG decoder appends
    // the debug output of a chunk.
    let innermost = std::iter::successors(Some(error), |&error| error.source())
        .last()
        .unwrap_or(error);
    let words = one_line(&innermost.to_string());
    let words = words
        .split(" while decoding ChunkType")
        .next()
        .unwrap_or(&words);
    words.trim_matches(|c| c == '.' || c == '"').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{GrayImage, ImageBuffer, Luma, LumaA, Rgb, RgbImage, Rgba};
    use std::path::PathBuf;

    const RED: [u8; 4] = [255, 0, 0, 255];
    const BLUE: [u8; 4] = [0, 0, 255, 255];
    const WHITE: [u8; 4] = [255; 4];

    fn saved(folder: &Path, name: &str, image: impl Into<DynamicImage>) -> PathBuf {
        let path = folder.join(name);
        image.into().save(&path).unwrap();
        path
    }

    #[test]
    fn every_format_gives_the_same_pixels() {
        let folder = tempfile::tempdir().unwrap();
        let card = RgbImage::from_fn(6, 4, |x, y| Rgb([(40 * x) as u8, (60 * y) as u8, 200]));
        for name in ["a.png", "a.tif", "a.bmp", "a.webp"] {
            let path = saved(folder.path(), name, card.clone());
            let picture = load_image(&path).unwrap();
            assert_eq!(picture.size(), ImageSize::new(6, 4));
            assert_eq!(image_size(&path).unwrap(), picture.size());
            assert_eq!(picture.pixel(5, 3), Some([200, 180, 200, 255]), "{name}");
            assert_eq!(picture.pixel(0, 0), Some([0, 0, 200, 255]), "{name}");
        }
    }

    #[test]
    fn depth_grey_and_alpha_become_opaque_rgba() {
        let folder = tempfile::tempdir().unwrap();
        let load = |name: &str, image: DynamicImage| {
            load_image(&saved(folder.path(), name, image))
                .unwrap()
                .pixel(0, 0)
                .unwrap()
        };
        assert_eq!(
            load("grey.png", GrayImage::from_pixel(2, 2, Luma([77])).into()),
            [77, 77, 77, 255]
        );
        let deep = ImageBuffer::from_pixel(2, 2, Rgb([0xffff_u16, 0x8080, 0]));
        assert_eq!(load("deep.png", deep.clone().into()), [255, 128, 0, 255]);
        assert_eq!(load("deep.tif", deep.into()), [255, 128, 0, 255]);
        let deep_grey = ImageBuffer::from_pixel(2, 2, Luma([0x4d4d_u16]));
        assert_eq!(load("deep-grey.png", deep_grey.into()), [77, 77, 77, 255]);
        let float = ImageBuffer::from_pixel(2, 2, Rgb([1.0_f32, 0.5, 7.0]));
        assert_eq!(load("float.tif", float.into()), [255, 128, 255, 255]);
        let half = ImageBuffer::from_pixel(2, 2, Rgba([200_u8, 100, 0, 128]));
        assert_eq!(load("half.png", half.clone().into()), [100, 50, 0, 255]);
        assert_eq!(load("half.webp", half.into()), [100, 50, 0, 255]);
        let clear = ImageBuffer::from_pixel(2, 2, LumaA([200_u8, 0]));
        assert_eq!(load("clear.png", clear.into()), [0, 0, 0, 255]);
    }

    /// A JPEG with an EXIF segment that states an orientation.
    fn with_orientation(jpeg: &[u8], orientation: u16) -> Vec<u8> {
        let mut exif = b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01".to_vec();
        exif.extend(orientation.to_be_bytes());
        exif.extend([0; 6]);
        let length = (exif.len() as u16 + 2).to_be_bytes();
        [&jpeg[..2], &[0xff, 0xe1], &length, &exif, &jpeg[2..]].concat()
    }

    #[test]
    fn exif_orientation_is_applied_and_counted_in_the_size() {
        let folder = tempfile::tempdir().unwrap();
        // Stored: red top left, blue top right, white below.
        let stored = RgbImage::from_fn(32, 16, |x, y| match (x < 16, y < 8) {
            (true, true) => Rgb([255, 0, 0]),
            (false, true) => Rgb([0, 0, 255]),
            (_, false) => Rgb([255, 255, 255]),
        });
        let path = saved(folder.path(), "stored.jpg", stored);
        let jpeg = std::fs::read(path).unwrap();
        // (orientation, top left, top right, bottom left), EXIF 2.32, table 6.
        for (orientation, corners) in [
            (1, [RED, BLUE, WHITE]),
            (2, [BLUE, RED, WHITE]),
            (3, [WHITE, WHITE, BLUE]),
            (4, [WHITE, WHITE, RED]),
            (5, [RED, WHITE, BLUE]),
            (6, [WHITE, RED, WHITE]),
            (7, [WHITE, BLUE, WHITE]),
            (8, [BLUE, WHITE, RED]),
            (9, [RED, BLUE, WHITE]),
        ] {
            let path = folder.path().join(format!("{orientation}.jpg"));
            std::fs::write(&path, with_orientation(&jpeg, orientation)).unwrap();
            let picture = load_image(&path).unwrap();
            let size = picture.size();
            let expected = if (5..=8).contains(&orientation) {
                (16, 32)
            } else {
                (32, 16)
            };
            assert_eq!(
                (size.width, size.height),
                expected,
                "orientation {orientation}"
            );
            assert_eq!(image_size(&path).unwrap(), size);
            let places = [(1, 1), (size.width - 2, 1), (1, size.height - 2)];
            for ((x, y), corner) in places.into_iter().zip(corners) {
                let pixel = picture.pixel(x, y).unwrap();
                let is_near = pixel.iter().zip(corner).all(|(&a, b)| a.abs_diff(b) < 24);
                assert!(
                    is_near,
                    "orientation {orientation} at {x}, {y}: {pixel:?}, not {corner:?}"
                );
            }
        }
    }

    #[test]
    fn limits_are_the_callers() {
        let folder = tempfile::tempdir().unwrap();
        let path = saved(folder.path(), "wide.png", RgbImage::new(30, 2));
        let limits = ImageLimits {
            max_side_px: 29,
            max_megapixels: 1,
        };
        assert!(matches!(
            load_image_within(&path, limits),
            Err(MediaError::TooLarge {
                width: 30,
                height: 2,
                ..
            })
        ));
        assert!(
            load_image_within(
                &path,
                ImageLimits {
                    max_side_px: 30,
                    ..limits
                }
            )
            .is_ok()
        );
        let none = ImageLimits {
            max_side_px: u32::MAX,
            max_megapixels: u64::MAX,
        };
        assert!(load_image_within(&path, none).is_ok());
    }
}
