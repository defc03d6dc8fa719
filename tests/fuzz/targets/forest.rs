//! A forest's file. The checksum that fits is put in, or no damage would come farther.
#![no_main]

use libfuzzer_sys::fuzz_target;
use touchline::relocalize::ForestModel;
use touchline_fuzz::{one_line, run_in_bounds};

/// Magic, version, length, checksum.
const HEADER: usize = 24;

fn check_bytes(bytes: &[u8]) {
    match run_in_bounds(bytes, || ForestModel::from_bytes(bytes)) {
        Ok(model) => {
            let written = model.to_bytes();
            let again = ForestModel::from_bytes(&written).expect("what is written is read");
            assert_eq!(again.to_bytes(), written, "and written as the same");
        }
        Err(error) => one_line(&error, bytes),
    }
}

fuzz_target!(|data: &[u8]| {
    check_bytes(data);
    if let Some(body) = data.get(HEADER..) {
        let mut whole = data.to_vec();
        whole[12..20].copy_from_slice(&(body.len() as u64).to_le_bytes());
        whole[20..24].copy_from_slice(&crc32fast::hash(body).to_le_bytes());
        check_bytes(&whole);
    }
});
