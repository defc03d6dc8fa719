//! A MATLAB file of the authors' annotations.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;
use touchline::exchange::read_authors_sequence;
use touchline_fuzz::{Folder, one_line, run_in_bounds};

static FOLDER: LazyLock<Folder> = LazyLock::new(Folder::new);

fuzz_target!(|data: &[u8]| {
    let path = FOLDER.file("seq1_anno.mat", data);
    if let Err(error) = run_in_bounds(data, || read_authors_sequence(&path)) {
        one_line(&error, data);
    }
});
