//! What a shard cost.

use crate::part::Cost;
use std::time::Instant;

/// Ticks of the processor times that Linux states in `/proc`, a second: the same on every machine.
#[cfg(target_os = "linux")]
const TICKS: f64 = 100.0;

/// Measures from its start on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stopwatch {
    wall: Instant,
    cpu_s: Option<f64>,
}

impl Stopwatch {
    pub(super) fn start() -> Self {
        Self {
            wall: Instant::now(),
            cpu_s: cpu_s(),
        }
    }

    /// The cost since the start.
    pub(super) fn cost(self) -> Cost {
        Cost {
            cpu_s: cpu_s().zip(self.cpu_s).map(|(now, start)| now - start),
            wall_s: self.wall.elapsed().as_secs_f64(),
        }
    }
}

/// The time that this process and the decoders that it waited for have used of all processors, s.
#[cfg(target_os = "linux")]
fn cpu_s() -> Option<f64> {
    // User and system time of this process, then those of the children that it waited for, such as
    // ffmpeg.
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name of the program, in parentheses, may contain anything. Behind it the times are the
    // columns 14 to 17 of proc(5); the first one here is column 3.
    let (_, columns) = stat.rsplit_once(')')?;
    let times = columns.split_whitespace().skip(11).take(4);
    let ticks: Vec<f64> = times.filter_map(|ticks| ticks.parse().ok()).collect();
    (ticks.len() == 4).then(|| ticks.iter().sum::<f64>() / TICKS)
}

#[cfg(not(target_os = "linux"))]
fn cpu_s() -> Option<f64> {
    None
}
