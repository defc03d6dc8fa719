//! Reports: how progress and results travel from the thread of an operation to the application.

use super::{Failure, Operation, RequestId};
use crate::app::App;
use std::fmt;

/// Progress or result of a request: the value with its type and a function that applies it, so
/// that nothing between the thread and the application needs to know the operation.
pub struct Report {
    id: RequestId,
    name: &'static str,
    apply: Box<Apply>,
}

/// Applies a report to the application, or returns it if it must wait.
type Apply = dyn FnOnce(&mut App) -> Option<Report> + Send;

impl Report {
    /// A report of progress.
    pub fn from_progress<O: Operation>(id: RequestId, progress: O::Progress) -> Self {
        Self {
            id,
            name: O::NAME,
            apply: Box::new(move |app: &mut App| {
                O::slot(app).set_progress(id, progress);
                None
            }),
        }
    }

    /// A report of the result.
    pub fn from_result<O: Operation>(
        id: RequestId,
        result: Result<O::Output, Failure<O::Error>>,
    ) -> Self {
        Self {
            id,
            name: O::NAME,
            apply: Box::new(move |app: &mut App| {
                // Only a request that still runs may wait: the report of a cancelled one is of no
                // use later either.
                if O::slot(app).is_running_as(id) && O::must_wait(app) {
                    return Some(Self::from_result::<O>(id, result));
                }
                // The slot has another request or none if this one was cancelled or replaced, or if
                // its document was closed. Then the result is dropped.
                if let Some(operation) = O::slot(app).finish(id) {
                    operation.take_over(app, result);
                }
                None
            }),
        }
    }

    /// Applies the report, or returns it if it must wait.
    pub(in crate::app) fn apply(self, app: &mut App) -> Option<Self> {
        (self.apply)(app)
    }
}

impl fmt::Debug for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}", self.name, self.id)
    }
}

/// Needed to compare actions in tests of the window, which send no reports: a report equals only
/// itself.
impl PartialEq for Report {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}
