//! A JPEG file: whole, cut off, or none.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;
use touchline::media::{image_size, load_image};
use touchline_fuzz::{Folder, one_line, run_in_bounds};

static FOLDER: LazyLock<Folder> = LazyLock::new(Folder::new);

fuzz_target!(|data: &[u8]| {
    let path = FOLDER.file("a.jpg", data);
    let size = run_in_bounds(data, || image_size(&path));
    match run_in_bounds(data, || load_image(&path)) {
        Ok(picture) => assert_eq!(Some(picture.size()), size.ok()),
        Err(error) => one_line(&error, data),
    }
});
