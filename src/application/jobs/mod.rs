//! The program's only detached threads: decoding, thumbnails, saving, training, and slow work in
//! general.
//!
//! All of them use one mechanism, `worker`: a handle that owns a thread and shares a mailbox with
//! it. Orders go in. A bounded number of reports waits until the owner polls, each time the window
//! is drawn; the [`Wake`] callback makes it draw. A panic becomes a report that the user sees.
//! Dropping the handle ends and joins the thread. The jobs built on it:
//!
//! | job | its orders |
//! |---|---|
//! | [`Background`] | none: one task with progress and a result |
//! | [`Decoder`], of frames and of thumbnails | the frames wanted now, which replace those wanted before |
//! | [`Saver`] | edits, in order; to write the document |
//! | [`Trainer`] | the newest document and the shown frame, which replace those before |
//!
//! [`Runner`] owns the jobs of an open document. It translates effects into orders, and reports
//! into actions. It runs the operations of `app` as [`Job`](crate::app::operation::Job)s, without
//! knowing which they are.

mod background;
mod decoder;
mod drawn_broadcast;
mod drawn_match;
mod error;
#[cfg(test)]
mod fake_reader;
mod frame_orders;
mod frame_worker;
mod opening;
mod pictures;
mod queue_opening;
mod runner;
mod saver;
mod settings_file;
mod shared_pictures;
mod thumbnails;
mod trainer;
mod worker;

pub use background::{Background, BackgroundReport, Panicked, Reporter, until_it_panics};
pub use decoder::{Decoder, FrameState};
pub use drawn_broadcast::broadcast_truth;
pub use drawn_match::{DrawnMatch, DrawnPicture, MatchOrder, draw_match};
pub use error::JobError;
pub use frame_orders::DecoderReport;
pub use opening::{Ready, open_anything};
pub use pictures::{PictureNews, PictureState, Pictures, picture_source};
pub use queue_opening::look_at_match;
pub use runner::{Request, Runner};
pub use saver::{Revision, Saver, SaverOptions, SaverReport};
pub use settings_file::{SettingsError, load_settings, save_settings, settings_path};
pub use shared_pictures::SharedPictures;
pub use trainer::{Trainer, TrainerOptions};

use std::sync::Arc;
use touchline_core::progress::panic_message;

/// Called by a job's thread when a report waits to be polled; a window repaints then.
pub type Wake = Arc<dyn Fn() + Send + Sync>;
