//! Random numbers whose seed is the test's name, so that a failure can be seen again.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A generator seeded by a name (FNV-1a).
pub fn rng(name: &str) -> Pcg64Mcg {
    let hash = |seed: u64, byte: u8| (seed ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    Pcg64Mcg::seed_from_u64(name.bytes().fold(0xcbf2_9ce4_8422_2325, hash))
}

/// A standard normal number.
pub fn normal(rng: &mut Pcg64Mcg) -> f64 {
    rng.sample(rand_distr::StandardNormal)
}
