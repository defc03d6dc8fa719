//! Slow work beside the window: how an operation is described, started, observed, cancelled, and
//! how its result enters the application.
//!
//! An operation is a value with all inputs of its work. Its way through the program:
//!
//! 1. `App::start` gives it a [`RequestId`], keeps it in the [`Slot`] of its kind and returns it to
//!    the shell as a [`Job`].
//! 2. `jobs` runs the job on a thread of its own. It does not know which operation that is.
//! 3. Progress and result come back as [`Report`]s. A report carries its own types, so it reaches
//!    [`Operation::take_over`] without a cast and without a list of all operations.
//! 4. A report whose request is no longer in its slot is dropped. No operation compares request ids
//!    itself.
//!
//! A request is cancelled by dropping it from its slot. Whatever removes the request (the user
//! stops it, a newer one of the same kind replaces it, another document is opened) therefore also
//! ends its work, without further code.

mod job;
#[cfg(test)]
pub(crate) mod probe;
mod slot;

pub use job::{Context, Decoders, Job};
pub use slot::{RequestId, Running, Slot};

use super::App;
use crate::app::window_state::session::Level;
use slot::Cancellation;
use std::fmt::{self, Debug, Display};
use thiserror::Error;
use touchline_documents::document::{Camera, CameraId, Document, Frame, FrameId};

/// One kind of slow work. The value is the input: a copy of what the work needs of the document,
/// because the document may change while the work runs. Documents share their parts, so a copy is
/// cheap.
///
/// All code of an operation is in its own file in `app/operations/`; `Operations` there has a field
/// for its state.
pub trait Operation: Sized + Send + Sync + 'static {
    /// Progress of the work. [`std::convert::Infallible`] if it reports none.
    type Progress: Debug + Send + 'static;
    /// The result of the work.
    type Output: Send + 'static;
    /// Why the work failed. Its text completes a sentence that the operation begins.
    type Error: Display + Send + 'static;

    /// The name of the thread, for debuggers and bug reports.
    const NAME: &'static str;

    /// Does the work, on a thread of its own. It checks `context` regularly for cancellation; the
    /// result of a cancelled request is dropped.
    ///
    /// # Errors
    /// Any error of the operation's own.
    fn run(&self, context: &Context<'_, Self::Progress>) -> Result<Self::Output, Self::Error>;

    /// The slot of the request while it runs. A slot has room for one request: starting another one
    /// cancels the first.
    fn slot(app: &mut App) -> &mut Slot<Self>;

    /// Whether the result must wait, for instance for the end of a drag. Evaluated again after each
    /// action. Meanwhile the request stays in its slot and can still be cancelled.
    fn must_wait(_app: &App) -> bool {
        false
    }

    /// Puts the result into the application. The slot is empty by then, so the operation may be
    /// started again from here.
    fn take_over(&self, app: &mut App, result: Result<Self::Output, Failure<Self::Error>>);
}

/// Why a request has no result.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Failure<E> {
    /// The work returned an error.
    #[error("{0}")]
    Failed(E),
    /// The work did not run to its end.
    #[error(transparent)]
    Broken(Breakdown),
}

/// Failures that can happen to any operation.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Breakdown {
    /// The work panicked with this message.
    #[error("internal error (please report it): {0}")]
    Panicked(String),
    /// The system could not start a thread, for this reason.
    #[error("the system could not start a thread: {0}")]
    NotStarted(String),
}

impl<E> Failure<E> {
    /// The severity of the message to the user. An error of the work itself is a warning, since its
    /// text usually says what to do.
    pub const fn level(&self) -> Level {
        match self {
            Self::Failed(_) => Level::Warning,
            Self::Broken(_) => Level::Error,
        }
    }
}

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

// The one rule by which a result of background work joins the document of now: what is as it was
// when the work began takes the result, and what has changed since stays.
//
// Work that changes the whole document has the rule in its own form: a change of many frames in
// `BulkSolved::join`, the shots of a search in `VideoShots::from_search`, answers of the forest in
// `Project::suggest`, an import by joining it once more with the document of now.

/// The document when some work began, and as it is now.
#[derive(Clone, Copy)]
pub(in crate::app) struct AsItWas<'a> {
    pub then: &'a Document,
    pub now: &'a Document,
}

impl AsItWas<'_> {
    /// Whether a camera looks at the same field.
    pub fn has_field(self, camera: &CameraId) -> bool {
        let Self { then, now } = self;
        then.field_of_camera(camera)
            .is_same_field(now.field_of_camera(camera))
    }

    /// Whether a camera has the same base and field. Cameras of frames, and lengths, are valid for
    /// these alone.
    pub fn has_base_and_field(self, camera: &CameraId) -> bool {
        let [then, now] = [self.then, self.now].map(|of| of.camera(camera).and_then(Camera::base));
        then == now && self.has_field(camera)
    }

    /// The present position of a frame in which nobody has worked since: camera, clicks, decision
    /// and solution are those of then. Suggestions, the shot, comments and masks may differ.
    pub fn position_if_untouched(self, id: &FrameId) -> Option<usize> {
        let then = self.then.frames.by_id(id)?;
        let position = self.now.frames.position_of(id)?;
        let now = &self.now.frames[position];
        let is_same = then.is_same(now)
            || has_same_labels(&then.without_suggestion(), &now.without_suggestion());
        is_same.then_some(position)
    }

    /// The same for a frame that shows the same suggestion, too, because the result replaces it.
    pub fn position_if_unchanged(self, id: &FrameId) -> Option<usize> {
        let position = self.now.frames.position_of(id)?;
        let then = self.then.frames.by_id(id)?;
        has_same_labels(then, &self.now.frames[position]).then_some(position)
    }
}

fn has_same_labels(one: &Frame, other: &Frame) -> bool {
    one.camera == other.camera
        && one.ptz == other.ptz
        && one.lens == other.lens
        && one.solution == other.solution
        && one.status == other.status
        && one.clicks == other.clicks
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::{ImagePoint, ImageSize};
    use touchline_core::testing::pixel_box;
    use touchline_documents::document::{Click, Clip, FrameStatus};
    use touchline_documents::testing::{new_frame, ptz_at, soccer_document};

    type Change = fn(&mut Frame);

    #[test]
    fn a_frame_counts_as_it_was_unless_someone_worked_in_it() {
        let mut then = soccer_document();
        let size = ImageSize::new(64, 36);
        then.frames.push(new_frame("a.jpg", size).into());
        let id = then.frames[0].id.clone();
        let suggest = |frame: &mut Frame| {
            frame.status = FrameStatus::Suggested;
            frame.ptz = ptz_at(1.0, -9.0, 900.0);
        };
        let beside: [Change; 4] = [
            |frame| frame.clip = Some(Clip::Number(1)),
            |frame| frame.comment = Some("rain".to_owned()),
            |frame| frame.use_for_base = false,
            |frame| {
                frame.masks.push(pixel_box(0.0, 0.0, 9.0, 9.0));
            },
        ];
        let work: [Change; 4] = [
            |frame| frame.camera = "side".into(),
            |frame| {
                frame
                    .clicks
                    .push(Click::without_name(ImagePoint::new(1.0, 1.0)));
            },
            |frame| frame.status = FrameStatus::Rejected,
            |frame| frame.status = FrameStatus::Reference,
        ];
        let joins = |change: &dyn Fn(&mut Frame)| {
            let mut now = then.clone();
            change(&mut now.frames[0]);
            let pair = AsItWas {
                then: &then,
                now: &now,
            };
            [
                pair.position_if_untouched(&id),
                pair.position_if_unchanged(&id),
            ]
        };
        for change in beside {
            assert_eq!(joins(&change), [Some(0), Some(0)]);
        }
        assert_eq!(joins(&suggest), [Some(0), None]);
        for change in work {
            assert_eq!(joins(&change), [None, None]);
        }
    }
}
