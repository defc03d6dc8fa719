//! How something is shown, nothing of a label.

use crate::app::choices::TimeAxis;
use crate::app::guide::GuidePage;
use crate::app::review::ReviewOrder;
use crate::app::session::{Filter, Level, PictureView, Question};
use crate::app::video::PlaySpeed;
use touchline_documents::document::CameraId;

/// How something is shown: nothing of a label is changed, and no more of it is seen.
#[derive(Debug, PartialEq)]
pub enum ViewAction {
    /// The view of the picture changes.
    Picture(PictureView),
    /// The scale at which the picture fits its canvas changed.
    FitScale(f64),
    /// No frames are selected.
    SelectNoFrames,
    /// The filmstrip shows other frames.
    SetFilter(Filter),
    /// The pointer is over the review panel's list, or has left it: see [`crate::app::review`].
    HoldReview(bool),
    /// The order of the review panel's list.
    SetReviewOrder(ReviewOrder),
    /// Suggestions of at least this probability are accepted together.
    SetReviewThreshold(f64),
    /// Also those that disagree with their neighbours.
    SetWithDisagreeing(bool),
    /// A suggestion is accepted together with the others, or taken out of them.
    TickSuggestion {
        /// Its place.
        frame: usize,
        /// It is accepted with the others.
        ticked: bool,
    },
    /// The review panel's list has one suggestion a shot.
    SetOnePerShot(bool),
    /// The quality page is about this camera.
    SetQualityCamera(CameraId),
    /// What the quality page counts time in.
    SetTimeAxis(TimeAxis),
    /// The part of the time that the quality page shows; none: all of it.
    ShowSpan(Option<[f64; 2]>),
    /// Read the field templates again that could not be read.
    ReadFailedTemplatesAgain,
    /// The dialog closes.
    CloseDialog,
    /// The guide shows another page.
    ShowGuidePage(GuidePage),
    /// A message goes away.
    DismissNotice(u64),
    /// A message from outside.
    Notify(Level, String),
    /// A path has to be typed, for want of a file dialog.
    TypePath(Question),
    /// The video is played at this speed.
    SetSpeed(PlaySpeed),
    /// The end is reached, or something else is done: the video stands.
    Pause,
}
