//! A video's container, and its first frame. What decodes it is FFmpeg, which is not instrumented.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;
use touchline::media::Video;
use touchline_fuzz::{Folder, one_line, run_in_bounds_beside};

static FOLDER: LazyLock<Folder> = LazyLock::new(Folder::new);

/// A first frame is as large as the container says: 100 megapixels at most, in colour with its
/// opacity.
const PICTURE: usize = 400_000_000;

fuzz_target!(|data: &[u8]| {
    let path = FOLDER.file("a.mp4", data);
    match run_in_bounds_beside(PICTURE, data, || Video::open(&path)) {
        Ok(mut video) => {
            if let Err(error) = video.frame(0) {
                one_line(&error, data);
            }
        }
        Err(error) => one_line(&error, data),
    }
});
