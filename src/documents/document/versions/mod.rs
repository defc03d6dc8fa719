//! Several versions of one document, joined. Two versions with a common base are merged three ways;
//! edits whose base is unknown are applied to another document; work packages divide a document
//! between people and join it again. Steps of a single person's history belong to `edits`.

pub mod common_base;
pub mod graft;
pub mod merge;
pub mod package;
mod package_record;
pub mod restored;
