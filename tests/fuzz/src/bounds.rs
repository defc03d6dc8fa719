//! What a reader may take, and what it may say.

use cpu_time::ProcessTime;
use peak_alloc::PeakAlloc;
use std::fmt::Display;
use std::time::Duration;

#[global_allocator]
static COUNTED: PeakAlloc = PeakAlloc;

/// What reading may take beside a multiple of the input, bytes.
const MEMORY: usize = 64 << 20;
const MEMORY_FOR_EACH_BYTE: usize = 20;
/// How long a reader may work, on all threads, however busy the machine is.
const TIME: Duration = Duration::from_secs(1);
/// The longest message, characters, beside names, which are as long as the input has them and
/// longer once escaped.
const MESSAGE: usize = 1000;

/// Reads, and fails where it takes too long or too much memory.
pub fn run_in_bounds<T>(input: &[u8], read: impl FnOnce() -> T) -> T {
    run_in_bounds_beside(0, input, read)
}

/// The same where a result of so many bytes is kept beside, as a picture that is as large as it
/// says.
pub fn run_in_bounds_beside<T>(kept: usize, input: &[u8], read: impl FnOnce() -> T) -> T {
    let before = COUNTED.current_usage();
    COUNTED.reset_peak_usage();
    let start = ProcessTime::now();
    let result = read();
    let (took, peak) = (start.elapsed(), COUNTED.peak_usage().saturating_sub(before));
    assert!(took <= TIME, "{took:?} for {} bytes", input.len());
    let most = MEMORY + MEMORY_FOR_EACH_BYTE * input.len() + kept;
    assert!(peak <= most, "{} MiB for {} bytes", peak >> 20, input.len());
    result
}

/// Fails where a message is none, too long or more than one plain line.
pub fn one_line(message: &impl Display, input: &[u8]) {
    let text = message.to_string();
    assert!(!text.trim().is_empty(), "nothing is said");
    assert!(!text.chars().any(char::is_control), "{text:?} is one plain line");
    assert!(text.chars().count() <= MESSAGE + 10 * input.len(), "{} characters", text.chars().count());
}
