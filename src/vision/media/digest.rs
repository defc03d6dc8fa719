//! The SHA-256 of a frame's file, to detect whether it is still the one that was labelled.

use super::MediaError;
use super::error::open_file;
use sha2::{Digest, Sha256};
use std::io::Read;
use std::path::Path;
use touchline_core::geometry::hex;

/// The SHA-256 of a file's bytes, in lower-case hexadecimal digits.
///
/// # Errors
/// The file is missing, empty, not a file or cannot be read.
pub fn sha256_of_file(path: &Path) -> Result<String, MediaError> {
    // In blocks, so that the memory does not depend on the size of the file.
    let mut file = open_file(path)?;
    let mut digest = Sha256::new();
    let mut block = vec![0; 1 << 16];
    loop {
        let count = file
            .read(&mut block)
            .map_err(|error| MediaError::from_io(path, &error))?;
        if count == 0 {
            break;
        }
        digest.update(&block[..count]);
    }
    Ok(hex(&digest.finalize()))
}

/// The SHA-256 of bytes, in lower-case hexadecimal digits.
#[must_use]
pub fn sha256_of_bytes(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_digest_of_abc() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("abc");
        std::fs::write(&path, "abc").unwrap();
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sha256_of_file(&path).unwrap(), expected);
        assert_eq!(sha256_of_bytes(b"abc"), expected);
    }
}
