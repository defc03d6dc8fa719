//! The SHA-256 of a frame's file, to detect whether it is still the one that was labelled; of a
//! video that of its size and its ends, because hashing a match takes minutes.

use super::MediaError;
use super::error::open_file;
use sha2::{Digest, Sha256};
use std::io::{self, Read, Seek as _, SeekFrom};
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

/// Number of bytes at each end of a video by which it is recognised.
const END_BYTES: u64 = 1 << 20;

/// What a video's file is recognised by, under whatever name: the first 32 hexadecimal digits of the
/// SHA-256 of its size (eight bytes, big-endian), its first MB and its last MB.
///
/// # Errors
/// The file is missing, empty, not a file or cannot be read.
pub fn video_file_id(path: &Path) -> Result<String, MediaError> {
    let file = open_file(path)?;
    let read = |mut file: std::fs::File| -> io::Result<String> {
        let bytes = file.metadata()?.len();
        let mut digest = Sha256::new().chain_update(bytes.to_be_bytes());
        let mut end = Vec::new();
        for start in [0, bytes.saturating_sub(END_BYTES)] {
            end.clear();
            file.seek(SeekFrom::Start(start))?;
            (&mut file).take(END_BYTES).read_to_end(&mut end)?;
            digest.update(&end);
        }
        Ok(hex(&digest.finalize()[..16]))
    };
    read(file).map_err(|error| MediaError::from_io(path, &error))
}

/// The SHA-256 of bytes, in lower-case hexadecimal digits.
pub fn sha256_of_bytes(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_video_is_recognised_by_its_length_and_both_ends() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mp4");
        let id_of = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            video_file_id(&path).unwrap()
        };
        let mut bytes = vec![7; 3 << 20];
        let id = id_of(&bytes);
        assert_eq!(id.len(), 32);
        let last = bytes.len() - 1;
        for at in [0, last] {
            bytes[at] = 8;
            assert_ne!(id_of(&bytes), id, "byte {at}");
            bytes[at] = 7;
        }
        assert_eq!(id_of(&bytes), id);
        assert_ne!(id_of(&bytes[..last]), id);
        assert_ne!(id_of(b"short"), id_of(b"shore"));
    }

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
