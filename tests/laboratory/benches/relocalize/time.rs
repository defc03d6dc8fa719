//! How long something takes.

use std::time::Instant;

/// Seconds that a part of this thread took: of its own processor time where Linux tells it, else by
/// the clock.
pub fn seconds<T>(part: impl FnOnce() -> T) -> (T, f64) {
    let (start, before) = (Instant::now(), processor_seconds());
    let value = part();
    let elapsed = start.elapsed().as_secs_f64();
    (
        value,
        before
            .zip(processor_seconds())
            .map_or(elapsed, |(before, after)| after - before),
    )
}

/// The processor time of this thread so far, up to a few milliseconds.
fn processor_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(text.split_whitespace().next()?.parse::<f64>().ok()? / 1e9)
}

/// What work gives for every frame, and the median of the frames' times, ms: each the least of
/// three passes over all frames, so that neither another program nor a warm cache counts.
pub fn best_of_passes<T>(frames: &[usize], work: impl Fn(usize) -> T) -> (Vec<T>, f64) {
    let mut least = vec![f64::INFINITY; frames.len()];
    let mut values = Vec::new();
    for _ in 0..3 {
        values.clear();
        for (&frame, least) in frames.iter().zip(&mut least) {
            let start = Instant::now();
            values.push(work(frame));
            *least = least.min(start.elapsed().as_secs_f64() * 1e3);
        }
    }
    (values, super::set::quantile(&mut least, 0.5))
}

/// A pool of so many threads.
pub fn threads(count: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(count)
        .build()
        .unwrap()
}
