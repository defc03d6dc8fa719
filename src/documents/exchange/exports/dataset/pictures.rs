//! The pictures of a dataset: copied, linked, or decoded and written anew.

use crate::exchange::error::ExchangeError;
use crate::exchange::files::{cannot_read, cannot_write};
use image::codecs::jpeg::JpegEncoder;
use image::error::{ParameterError, ParameterErrorKind};
use image::{ImageError, ImageFormat, RgbImage};
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::io::{self, Cursor};
use std::path::{Path, PathBuf};
use touchline_core::files::{folder_of, open_named};
use touchline_core::geometry::hex;
use touchline_vision::media::{Picture, sha256_of_file};

/// The quality of JPEG pictures, of 100: a second compression should not be seen.
const JPEG_QUALITY: u8 = 95;

/// A folder being written, and the SHA-256 of every file in it.
pub struct Folder<'a> {
    root: &'a Path,
    /// Its final path, which errors name.
    place: &'a Path,
    hashes: BTreeMap<String, String>,
}

impl<'a> Folder<'a> {
    /// An empty folder at `root`, which will be renamed to `place`.
    pub const fn new(root: &'a Path, place: &'a Path) -> Self {
        Self {
            root,
            place,
            hashes: BTreeMap::new(),
        }
    }

    /// Every file and its SHA-256, in the format of `sha256sum`.
    pub fn manifest(&self) -> String {
        self.hashes
            .iter()
            .fold(String::new(), |mut text, (name, hash)| {
                // Writing to a string cannot fail.
                let _ = writeln!(text, "{hash}  {name}");
                text
            })
    }

    /// The names of the files that were written.
    pub fn into_names(self) -> BTreeSet<String> {
        self.hashes.into_keys().collect()
    }

    /// Writes a file and returns its SHA-256.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> Result<String, ExchangeError> {
        let path = self.file(name)?;
        fs::write(path, bytes).map_err(|source| self.write_error(name, source))?;
        Ok(self.note(name, hex(&Sha256::digest(bytes))))
    }

    /// Copies a file, or makes a hard link to it, and returns its SHA-256.
    ///
    /// # Errors
    /// [`ExchangeError::Read`] if the file cannot be opened; otherwise the copy cannot be written.
    pub fn take_over(
        &mut self,
        name: &str,
        from: &Path,
        as_link: bool,
    ) -> Result<String, ExchangeError> {
        open_named(from).map_err(|source| cannot_read(from, source))?;
        let path = self.file(name)?;
        if as_link {
            // A hard link to a symbolic link would be a symbolic link.
            let from = fs::canonicalize(from).map_err(|source| cannot_read(from, source))?;
            fs::hard_link(&from, &path).map_err(|source| match source.kind() {
                io::ErrorKind::CrossesDevices => ExchangeError::OtherDisk {
                    from,
                    to: self.place.join(name),
                },
                _ => self.write_error(name, source),
            })?;
        } else {
            fs::copy(from, &path).map_err(|source| self.write_error(name, source))?;
        }
        // The hash of what arrived, not of the source: a damaged copy must not have the right one
        // in the manifest.
        let hash = sha256_of_file(&path)?;
        Ok(self.note(name, hash))
    }

    /// Removes a file.
    pub fn remove(&mut self, name: &str) -> Result<(), ExchangeError> {
        self.hashes.remove(name);
        fs::remove_file(self.root.join(name)).map_err(|source| self.write_error(name, source))
    }

    fn write_error(&self, name: &str, source: io::Error) -> ExchangeError {
        cannot_write(&self.place.join(name), source)
    }

    fn note(&mut self, name: &str, hash: String) -> String {
        self.hashes.insert(name.to_owned(), hash.clone());
        hash
    }

    /// The temporary path of a file, until the folder is complete.
    fn file(&self, name: &str) -> Result<PathBuf, ExchangeError> {
        let path = self.root.join(name);
        fs::create_dir_all(folder_of(&path)).map_err(|source| self.write_error(name, source))?;
        Ok(path)
    }
}

/// A picture encoded in a format.
///
/// # Errors
/// The format cannot hold it.
pub fn encode_picture(picture: &Picture, format: ImageFormat) -> Result<Vec<u8>, ImageError> {
    let size = picture.size();
    // Pictures have no transparency; three bytes a pixel are smaller, and JPEG has no fourth.
    let pixels = picture.rgba().as_chunks::<4>().0.iter();
    let rgb = pixels.flat_map(|[red, green, blue, _]| [*red, *green, *blue]);
    let image = RgbImage::from_raw(size.width, size.height, rgb.collect()).ok_or_else(|| {
        ImageError::Parameter(ParameterError::from_kind(
            ParameterErrorKind::DimensionMismatch,
        ))
    })?;
    let mut bytes = Cursor::new(Vec::new());
    if format == ImageFormat::Jpeg {
        image.write_with_encoder(JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY))?;
    } else {
        image.write_to(&mut bytes, format)?;
    }
    Ok(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_written_is_named_where_it_was_to_be_and_a_source_where_it_is() {
        let temporary = tempfile::tempdir().unwrap();
        let mut folder = Folder::new(temporary.path(), Path::new("/data/set"));
        fs::create_dir(temporary.path().join("a.txt")).unwrap();
        let said = |error: ExchangeError| error.to_string();
        let in_the_way = said(folder.write("a.txt", b"").unwrap_err());
        assert!(
            in_the_way.starts_with("cannot write /data/set/a.txt: "),
            "{in_the_way}"
        );
        let missing = said(
            folder
                .take_over("b.png", Path::new("/no/such.png"), false)
                .unwrap_err(),
        );
        assert!(
            missing.starts_with("cannot read /no/such.png: "),
            "{missing}"
        );
    }
}
