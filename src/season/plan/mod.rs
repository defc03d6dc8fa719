//! A plan: the shards of a season.
//!
//! 1. Each match gives one *find* shard, which finds its cameras without a click (or takes them
//!    from the match's project) and trains a forest on the frames found ([`make_plan`]).
//! 2. Its video is divided into windows of about a minute, its folder into runs of images. Each
//!    gives one *label* shard, which needs the part of the find shard and labels the frames of its
//!    window.
//!
//! **Why windows of equal length and not shots?** Where a match is cut is known only once its
//! frames were looked at, and a plan must be the same before and after. Within its window a shard
//! finds the cuts itself, as `touchline track` does: nothing is tracked across them. A shot that
//! two windows share is labelled in two halves; the first and the last frame of a window are key
//! frames, so that neither half depends on the other.
//!
//! A plan's file states everything that a shard's bytes depend on. Reading it checks that each
//! shard is named by what goes into it (`file.rs`), so a plan that was edited is
//! refused.

mod file;
mod make;

pub(crate) use file::path_in_plan;
pub use file::{LabelShard, Plan, PlanError, PlannedFile, PlannedMatch, ShardOfPlan};
pub use make::{MakePlanError, MatchError, hash_of_project, make_plan};
