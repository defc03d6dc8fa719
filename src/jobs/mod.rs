//! The only detached threads.
//!
//! A job is a handle that owns its thread: orders go in through a bounded channel, reports come back, a [`Wake`] callback
//! says that there is one. Dropping the handle ends the thread.

mod saver;

pub use saver::{Revision, Saver, SaverOptions, SaverReport};

/// Called by a job's thread when it has reported something; a window repaints then.
pub type Wake = std::sync::Arc<dyn Fn() + Send + Sync>;
