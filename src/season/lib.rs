//! A season of matches, worked on by any number of machines.
//!
//! Nothing here is a cluster. The unit of work is a *shard*: one deterministic command that
//! anything which runs commands can run, such as `xargs`, a Slurm array, Snakemake or Ray. A person
//! writes a season file; [`plan`] makes its shards, [`shard`] does one and writes its part,
//! [`collect`] makes projects, a review queue and a table from the parts.
//!
//! ```text
//! season.toml ── plan ──> plan.json ── shard (each, anywhere) ──> parts/*.part ── collect ──> OUT/
//! ```
//!
//! A shard is named by the SHA-256 of everything that its bytes depend on, so its name is also the
//! name of its result: a part that exists need not be made again, by whichever plan it was made,
//! and two machines that do the same shard write the same file.
//!
//! | floor | rooms |
//! |---|---|
//! | 4 | [`collect`] (projects, queue and table from parts), [`shard`] (one unit of work) |
//! | 3 | [`part`] (the file that a shard writes) |
//! | 2 | [`plan`] (from a season to its shards) |
//! | 1 | [`season_file`] (what a person writes), [`queue`], [`source`], [`processor`], [`parent`] |

#![allow(
    missing_docs,
    reason = "a room of the program itself: what its name says needs no second sentence"
)]

pub mod collect;
pub mod parent;
pub mod part;
pub mod plan;
pub mod processor;
pub mod queue;
pub mod season_file;
pub mod shard;
pub mod source;
