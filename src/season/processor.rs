//! What a shard's bytes depend on beside its input.
//!
//! The same program gives the same bytes from the same input, on any number of threads, as long as
//! its arithmetic is the same. Three things that the program does not bring along decide that:
//!
//! | what | why |
//! |---|---|
//! | instruction set | wider vectors and fused multiply–add round and sum differently |
//! | libraries | sine and power are the C library's, features and flow are OpenCV's |
//! | ffmpeg | decodes the frames and converts their colours |
//!
//! The program's own loops, OpenCV and the C library choose instructions by the processor that they
//! run on; other versions of the libraries round the last bit differently.
//!
//! All three are in a plan's *processor class* and so in the name of each shard. A machine of
//! another class refuses the shard rather than mixing its bytes with others'.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use touchline_vision::media::{sha256_of_bytes, sha256_of_file};

/// The class of a plan whose shards may run on any machine. Bytes may then differ in last digits.
pub const ANY: &str = "any";

/// Libraries whose arithmetic the program uses, by the beginnings of their file names.
const LIBRARIES: [&str; 3] = ["libm.so", "libm-", "libopencv_"];

/// Number of digits of the libraries' hash.
const HASH_DIGITS: usize = 12;

/// The class of this machine, such as `x86_64-v3 libraries-0c1f… ffmpeg-5.1.6`.
pub fn processor_class() -> String {
    format!(
        "{} libraries-{} ffmpeg-{}",
        instruction_set(),
        hash_of_libraries(),
        ffmpeg_version()
    )
}

/// The processor's architecture; on x86-64 with its level, because the C library and OpenCV choose
/// their functions by the sets that the levels comprise.
fn instruction_set() -> String {
    // The levels v2 to v4 of the x86-64 psABI, by those of their sets that decide about arithmetic.
    // A level includes all below it.
    #[cfg(target_arch = "x86_64")]
    {
        let has_v2 = is_x86_feature_detected!("sse4.2") && is_x86_feature_detected!("popcnt");
        let has_v3 = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi2");
        let has_v4 = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl");
        let level = match (has_v2, has_v3, has_v4) {
            (true, true, true) => 4,
            (true, true, false) => 3,
            (true, false, _) => 2,
            (false, ..) => 1,
        };
        format!("x86_64-v{level}")
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        std::env::consts::ARCH.to_owned()
    }
}

/// A hash of the libraries that the system mapped into this process; `none` where they are part of
/// the program or the system does not list them.
fn hash_of_libraries() -> String {
    let maps = fs::read_to_string("/proc/self/maps").unwrap_or_default();
    // Names stand behind five columns and may contain blanks.
    let paths = maps
        .lines()
        .filter_map(|line| line.find('/').map(|at| PathBuf::from(&line[at..])));
    let libraries: BTreeSet<PathBuf> = paths
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            LIBRARIES.iter().any(|library| name.starts_with(library))
        })
        .collect();
    hash_of_files(&libraries)
}

/// A hash of the contents of files; `none` of no file.
fn hash_of_files(files: &BTreeSet<PathBuf>) -> String {
    // Sorted hashes, without names and paths: where a system keeps its libraries does not matter. A
    // library that cannot be read, such as one that was replaced since the program began, counts by
    // its name: this machine must not be of the class of those without it.
    let hashes: BTreeSet<String> = files
        .iter()
        .map(|file| {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            sha256_of_file(file).unwrap_or_else(|_| format!("unread {name}"))
        })
        .collect();
    if hashes.is_empty() {
        return "none".to_owned();
    }
    let all: String = hashes.into_iter().collect();
    sha256_of_bytes(all.as_bytes())[..HASH_DIGITS].to_owned()
}

/// The version of the ffmpeg that is on the path, as it states it; `none` without one.
fn ffmpeg_version() -> String {
    // A program that cannot be started counts as none, and gives the class of a machine without it.
    let output = Command::new("ffmpeg")
        .arg("-version")
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .output();
    let text = output.map_or_else(
        |_| String::new(),
        |output| String::from_utf8_lossy(&output.stdout).into_owned(),
    );
    text.strip_prefix("ffmpeg version ")
        .and_then(|rest| rest.split_whitespace().next())
        .unwrap_or("none")
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_that_cannot_be_read_is_not_the_same_as_none() {
        let folder = tempfile::tempdir().unwrap();
        let (there, missing) = (folder.path().join("a.so"), folder.path().join("b.so"));
        fs::write(&there, "code").unwrap();
        let one = hash_of_files(&BTreeSet::from([there.clone()]));
        let both = hash_of_files(&BTreeSet::from([there, missing]));
        assert_eq!(both.len(), HASH_DIGITS);
        assert_ne!(one, both);
        assert_eq!(hash_of_files(&BTreeSet::new()), "none");
    }

    #[test]
    fn a_machine_has_one_class_with_three_parts() {
        let class = processor_class();
        assert_eq!(class, processor_class());
        let parts: Vec<&str> = class.split(' ').collect();
        assert_eq!(parts.len(), 3, "{class}");
        assert!(parts[0].starts_with(std::env::consts::ARCH));
        let has_c_library = cfg!(all(target_os = "linux", target_env = "gnu"));
        assert_eq!(parts[1] != "libraries-none", has_c_library, "{class}");
    }
}
