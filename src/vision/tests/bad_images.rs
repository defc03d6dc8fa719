//! Broken image files: each gets one clear line, none brings the program down.

use image::{ImageFormat, RgbImage};
use std::path::Path;
use touchline_core::geometry::ImageSize;
use touchline_core::testing::files::{behind_path, cut, new_file};
use touchline_vision::media::{
    ImageLimits, MediaError, Picture, image_size, list_images, load_image, load_image_within,
    sha256_of_file,
};

/// A picture with detail, so that its file has a body to break.
fn card(width: u32, height: u32) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| {
        image::Rgb([(7 * x + y) as u8, (x * y) as u8, (x ^ (5 * y)) as u8])
    })
}

fn encode(picture: &RgbImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn png() -> Vec<u8> {
    encode(&card(64, 48), ImageFormat::Png)
}

/// A PNG chunk with its checksum.
fn chunk(kind: [u8; 4], data: &[u8]) -> Vec<u8> {
    let body = [kind.as_slice(), data].concat();
    let crc = crc32fast::hash(&body);
    [
        &(data.len() as u32).to_be_bytes(),
        body.as_slice(),
        &crc.to_be_bytes(),
    ]
    .concat()
}

/// A PNG that states a size and holds next to nothing.
fn png_stating(width: u32, height: u32) -> Vec<u8> {
    let header = [
        &width.to_be_bytes(),
        &height.to_be_bytes(),
        [8, 2, 0, 0, 0].as_slice(),
    ]
    .concat();
    [
        b"\x89PNG\r\n\x1a\n".to_vec(),
        chunk(*b"IHDR", &header),
        chunk(*b"IDAT", &[0x78, 0x9c, 3, 0, 0, 0, 0, 1]),
        chunk(*b"IEND", &[]),
    ]
    .concat()
}

/// A BMP that states a size and holds nothing.
fn bmp_stating(width: i32, height: i32) -> Vec<u8> {
    let mut bytes = b"BM".to_vec();
    for word in [54_u32, 0, 54, 40] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(width.to_le_bytes());
    bytes.extend(height.to_le_bytes());
    bytes.extend([1, 0, 24, 0]);
    bytes.resize(54, 0);
    bytes
}

fn with_byte_flipped(mut bytes: Vec<u8>, at: usize) -> Vec<u8> {
    bytes[at] ^= 0xff;
    bytes
}

/// What a loader says behind the file's path; what a success is called otherwise.
fn outcome_of(folder: &Path, name: &str, result: Result<Picture, MediaError>) -> String {
    match result {
        Ok(picture) => format!(
            "read, {} × {} px",
            picture.size().width,
            picture.size().height
        ),
        Err(error) => behind_path(folder, name, &error),
    }
}

#[test]
fn each_broken_image_has_its_message() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::create_dir(folder.join("folder.png")).unwrap();
    let jpeg = encode(&card(64, 48), ImageFormat::Jpeg);
    let damaged =
        |reason: &str| format!("the image is damaged ({reason}); copy it again from where it came");
    let missing = "there is no such file; check whether it was moved or renamed";
    let not_an_image = "not a PNG, JPEG, TIFF, BMP or WebP image; convert it to one of these";
    let whole = "read, 64 × 48 px";
    let half = |bytes: &[u8]| cut(bytes, bytes.len() / 2);
    for (name, bytes, expected) in [
        ("missing.png", None, missing.to_owned()),
        ("folder.png", None, "this is not a file; give the path of an image or a video".to_owned()),
        ("folder.png/inside.png", None, missing.to_owned()),
        ("empty.png", Some(Vec::new()), "the file is empty (0 bytes); copy it again from where it came".to_owned()),
        ("one-byte.png", Some(vec![0x89]), not_an_image.to_owned()),
        ("text.jpg", Some(b"just some words, no picture".to_vec()), not_an_image.to_owned()),
        ("zeros.tif", Some(vec![0; 4096]), not_an_image.to_owned()),
        (
            "film.gif",
            Some(b"GIF89a\x01\x00\x01\x00\x00\x00\x00;".to_vec()),
            "this kind of image is not supported (GIF); convert it to PNG or JPEG".to_owned(),
        ),
        ("signature-only.png", Some(cut(&png(), 8)), damaged("the file ends too early")),
        ("header-only.png", Some(cut(&png(), 33)), damaged("the file ends too early")),
        ("half.png", Some(half(&png())), damaged("the file ends too early")),
        (
            "header-crc.png",
            Some(with_byte_flipped(png(), 29)),
            damaged("CRC error: expected 0xd129eb48 have 0x2e29eb48"),
        ),
        (
            "body-crc.png",
            Some(with_byte_flipped(png(), png().len() - 20)),
            damaged("CRC error: expected 0xc0e81e6e have 0x1eed189f"),
        ),
        ("no-pixels.png", Some(png_stating(64, 48)), damaged("IDAT or fDAT chunk does not have enough data for image")),
        ("nothing-wide.png", Some(png_stating(0, 48)), damaged("Invalid image dimensions")),
        (
            "bomb.png",
            Some(png_stating(60_000, 60_000)),
            "states 60000 × 60000 px, the limit is 16384 px a side and 100 megapixels; scale it down".to_owned(),
        ),
        (
            "bomb-area.png",
            Some(png_stating(16_000, 16_000)),
            "states 16000 × 16000 px, the limit is 16384 px a side and 100 megapixels; scale it down".to_owned(),
        ),
        (
            "largest.png",
            Some(png_stating(u32::MAX, u32::MAX)),
            "needs more memory than a picture of 100 megapixels; scale it down".to_owned(),
        ),
        (
            "bomb.bmp",
            Some(bmp_stating(1_000_000, 1_000_000)),
            damaged("Image too large (one of (1000000, 1000000) > soft limit of 65535)"),
        ),
        ("negative.bmp", Some(bmp_stating(-64, 48)), damaged("Negative width (-64)")),
        ("header-only.bmp", Some(bmp_stating(64, 48)), damaged("the file ends too early")),
        ("half.jpg", Some(half(&jpeg)), damaged("the file ends too early")),
        ("start-only.jpg", Some(cut(&jpeg, 2)), not_an_image.to_owned()),
        ("tables-only.jpg", Some(cut(&jpeg, 200)), damaged("I/O errors Not enough bytes, expected 12 but found 2")),
        (
            "no-tables.jpg",
            Some([&[0xff, 0xd8, 0xff, 0xd9], [0; 64].as_slice()].concat()),
            damaged("Premature End of image"),
        ),
        ("half.tif", Some(half(&encode(&card(64, 48), ImageFormat::Tiff))), damaged("the file ends too early")),
        (
            "loop.tif",
            Some(b"II*\0\x08\0\0\0\0\0\x08\0\0\0".to_vec()),
            damaged("file contained a cycle in the list of IFDs"),
        ),
        ("half.webp", Some(half(&encode(&card(64, 48), ImageFormat::WebP))), damaged("Corrupt bitstream")),
        ("riff-only.webp", Some(b"RIFF\x04\0\0\0WEBP".to_vec()), damaged("the file ends too early")),
        ("other-name.jpg", Some(png()), whole.to_owned()),
        ("no-ending", Some(jpeg.clone()), whole.to_owned()),
        ("trailing.png", Some([png(), vec![7; 100]].concat()), whole.to_owned()),
    ] {
        let path = bytes.map_or_else(|| folder.join(name), |bytes| new_file(folder, name, &bytes));
        assert_eq!(
            outcome_of(folder, name, load_image(&path)),
            expected,
            "{name}"
        );
        // The size alone may be had of a file whose pixels are broken, but never by a panic.
        if let Ok(size) = image_size(&path) {
            assert_eq!(size, ImageSize::new(64, 48), "{name}");
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn odd_names_and_odd_files() {
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let path = folder.join(std::ffi::OsStr::from_bytes(b"\xff.png"));
    std::fs::write(&path, png()).unwrap();
    assert_eq!(
        load_image(&path).unwrap().size(),
        ImageSize::new(64, 48),
        "a name need not be UTF-8 to be read"
    );
    std::os::unix::fs::symlink(folder.join("nowhere"), folder.join("link.png")).unwrap();
    assert_eq!(
        outcome_of(folder, "link.png", load_image(&folder.join("link.png"))),
        "there is no such file; check whether it was moved or renamed"
    );
    std::os::unix::fs::symlink("loop.png", folder.join("loop.png")).unwrap();
    assert!(
        outcome_of(folder, "loop.png", load_image(&folder.join("loop.png")))
            .starts_with("could not be read (")
    );
    assert_eq!(
        outcome_of(folder, "/dev/null", load_image(Path::new("/dev/null"))),
        "this is not a file; give the path of an image or a video"
    );
    assert!(matches!(
        sha256_of_file(&folder.join("none")),
        Err(MediaError::Missing { .. })
    ));
    assert!(matches!(
        list_images(&folder.join("none")),
        Err(MediaError::Missing { .. })
    ));
}

/// Whatever the bytes, there is a picture or an error: each format cut at many lengths and broken
/// at many bytes.
#[test]
fn no_bytes_bring_it_down() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("any");
    let limits = ImageLimits {
        max_side_px: 1000,
        max_megapixels: 1,
    };
    let mut refused = 0;
    for format in [
        ImageFormat::Png,
        ImageFormat::Jpeg,
        ImageFormat::Tiff,
        ImageFormat::Bmp,
        ImageFormat::WebP,
    ] {
        let whole = encode(&card(8, 6), format);
        for at in (0..whole.len()).step_by(3) {
            for bytes in [cut(&whole, at), with_byte_flipped(whole.clone(), at)] {
                std::fs::write(&path, bytes).unwrap();
                refused += usize::from(load_image_within(&path, limits).is_err());
            }
        }
    }
    assert!(refused > 500, "{refused}");
}
