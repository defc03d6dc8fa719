//! What the work of an operation reports.

use super::{Failure, Operation, RequestId};
use crate::app::App;
use std::fmt;

/// What a request has to say: how far it has come, or what came of it. It holds the values with
/// their types and knows what becomes of them, so that nothing on the way from the thread to the
/// application has to know the operation.
pub struct Report {
    id: RequestId,
    name: &'static str,
    apply: Box<Apply>,
}

/// Takes a report into the application, or returns it where it has to wait.
type Apply = dyn FnOnce(&mut App) -> Option<Report> + Send;

impl Report {
    /// A request has come this far.
    #[must_use]
    pub fn of_progress<O: Operation>(id: RequestId, progress: O::Progress) -> Self {
        let apply = move |app: &mut App| {
            O::slot(app).set_progress(id, progress);
            None
        };
        Self {
            id,
            name: O::NAME,
            apply: Box::new(apply),
        }
    }

    /// A request has ended.
    #[must_use]
    pub fn of_end<O: Operation>(
        id: RequestId,
        result: Result<O::Output, Failure<O::Error>>,
    ) -> Self {
        let apply = move |app: &mut App| {
            if O::slot(app).is_running_as(id) && O::must_wait(app) {
                return Some(Self::of_end::<O>(id, result));
            }
            // Nothing where it was cancelled or replaced, or belongs to a document that has been
            // closed.
            if let Some(operation) = O::slot(app).finish(id) {
                operation.take_over(app, result);
            }
            None
        };
        Self {
            id,
            name: O::NAME,
            apply: Box::new(apply),
        }
    }

    /// Takes the report into the application. One that has to wait comes back.
    pub(in crate::app) fn apply(self, app: &mut App) -> Option<Self> {
        (self.apply)(app)
    }
}

impl fmt::Debug for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}", self.name, self.id)
    }
}

/// Actions are compared in tests of the window, which sends no reports: a report equals only
/// itself.
impl PartialEq for Report {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}
