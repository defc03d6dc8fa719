//! Documents: what they hold, where they live, and what other programs read and write.
//!
//! | floor | rooms |
//! |---|---|
//! | 5 | [`exchange`] (foreign formats), [`store`] (where a document lives), [`report`] (tables, figures, Markdown) |
//! | 4 | [`document`] (typed schema, edits, history) |

pub mod document;
pub mod exchange;
#[doc(hidden)]
pub mod report;
pub mod store;
#[cfg(any(test, feature = "testing"))]
#[doc(hidden)]
pub mod testing;
