//! The commands for a season of matches: `plan` divides it into shards, `shard` does one of them,
//! and `collect` joins their parts. The work is in the crate `touchline-season`. A single match is
//! labelled by `calibrate` and `track` in the folder above.

pub mod collect;
pub mod plan;
pub mod shard;
