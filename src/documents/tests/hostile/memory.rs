//! What is allocated while something is read, and files that are made to take as much as possible.

use crate::mat_writer::{Out, mat};
use crate::samples::{Sample, formats};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use peak_alloc::PeakAlloc;
use std::io::Write as _;
use std::sync::{Mutex, MutexGuard, PoisonError};
use touchline_documents::exchange::Format;
use touchline_vision::media::{image_size, load_image};

#[global_allocator]
static COUNTED: PeakAlloc = PeakAlloc;

/// What reading a small file may take beside the file itself, bytes.
pub const MOST: usize = 64 << 20;

/// Tests that count have the process for themselves.
pub fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The most bytes that were allocated at a time while something ran, beyond those before.
pub fn peak<T>(run: impl FnOnce() -> T) -> (T, usize) {
    let before = COUNTED.current_usage();
    COUNTED.reset_peak_usage();
    let result = run();
    (result, COUNTED.peak_usage().saturating_sub(before))
}

#[test]
fn the_counter_counts() {
    let _alone = alone();
    let ((), bytes) = peak(|| drop(vec![1_u8; 10 << 20]));
    assert!((10 << 20..11 << 20).contains(&bytes), "{bytes}");
}

/// Files of a megabyte or less that unfold to as much as they can.
fn bombs(format: Format) -> Vec<Vec<u8>> {
    let mut bombs: Vec<Vec<u8>> = vec![
        b"[".repeat(1 << 20),
        [b"[".to_vec(), b"[],".repeat(300_000), b"0]".to_vec()].concat(),
        [b"[".to_vec(), b"{},".repeat(300_000), b"0]".to_vec()].concat(),
        b",".repeat(1 << 20),
        b"0 ".repeat(1 << 19),
        b"\n".repeat(1 << 20),
        b"a:\n".repeat(300_000),
        [
            b"<annotations>".to_vec(),
            b"<a/>".repeat(200_000),
            b"</annotations>".to_vec(),
        ]
        .concat(),
        [b"<annotations>".to_vec(), b"<skeleton>".repeat(100_000)].concat(),
        [b"frame_index\n".to_vec(), b"1\n".repeat(500_000)].concat(),
    ];
    if format == Format::AuthorsMat {
        for name in ["meta", "annotation", "features"] {
            bombs.push(mat(
                &[(name, Out::Doubles(vec![0.0; 4 << 20]))],
                false,
                true,
            ));
        }
        let empty = || vec![("a", Out::Doubles(Vec::new()))];
        bombs.push(mat(
            &[(
                "meta",
                Out::Structures((0..50_000).map(|_| empty()).collect()),
            )],
            false,
            true,
        ));
    }
    bombs
}

#[test]
fn files_that_unfold_are_bounded() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    for format in formats() {
        let sample = Sample::of(format);
        for (index, bomb) in bombs(format).into_iter().enumerate() {
            let mut files = sample.files.clone();
            let main = files
                .iter_mut()
                .find(|(name, _)| name == sample.main())
                .unwrap();
            main.1 = bomb;
            let (_, bytes) = peak(|| sample.import(&files, folder.path()).map(drop));
            assert!(
                bytes <= MOST,
                "{format}: bomb {index} takes {} MiB",
                bytes >> 20
            );
        }
    }
}

/// A PNG with a colour profile of zeros.
fn png_with_profile(unfolded: usize) -> Vec<u8> {
    fn chunk(kind: [u8; 4], data: &[u8]) -> Vec<u8> {
        let body = [&kind[..], data].concat();
        [
            &(data.len() as u32).to_be_bytes()[..],
            &body,
            &crc32fast::hash(&body).to_be_bytes(),
        ]
        .concat()
    }
    let folded = |bytes: usize| {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
        let zeros = vec![0; 1 << 20];
        for _ in 0..bytes >> 20 {
            encoder.write_all(&zeros).unwrap();
        }
        encoder
            .write_all(&zeros[..bytes & ((1 << 20) - 1)])
            .unwrap();
        encoder.finish().unwrap()
    };
    let header = [
        &8_u32.to_be_bytes()[..],
        &8_u32.to_be_bytes(),
        &[8, 2, 0, 0, 0],
    ]
    .concat();
    let profile = [&b"icc\0\0"[..], &folded(unfolded)].concat();
    let pixels = folded(8 * (1 + 3 * 8));
    let chunks = [
        chunk(*b"IHDR", &header),
        chunk(*b"iCCP", &profile),
        chunk(*b"IDAT", &pixels),
        chunk(*b"IEND", &[]),
    ];
    [b"\x89PNG\r\n\x1a\n".to_vec(), chunks.concat()].concat()
}

#[test]
fn a_colour_profile_that_unfolds_to_half_a_gigabyte_is_bounded() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    std::fs::write(&path, png_with_profile(1 << 10)).unwrap();
    assert_eq!(load_image(&path).unwrap().size().width, 8);
    std::fs::write(&path, png_with_profile(512 << 20)).unwrap();
    let (_, bytes) = peak(|| (image_size(&path).map(drop), load_image(&path).map(drop)));
    assert!(bytes <= MOST, "{} MiB", bytes >> 20);
}
