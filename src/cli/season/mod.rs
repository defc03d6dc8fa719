//! The commands for several matches: `queue` labels one after the other; of a season, `plan` makes
//! shards, `shard` does one of them, and `collect` joins their parts. The work is in the crate
//! `touchline-season`. A single match is labelled by `calibrate` and `track` in the folder above.

pub mod collect;
pub mod plan;
pub mod queue;
pub mod shard;
