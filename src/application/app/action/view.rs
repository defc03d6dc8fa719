//! Actions that change how something is displayed.

use crate::app::commands::guide::GuidePage;
use crate::app::review::ReviewOrder;
use crate::app::window_state::choices::TimeAxis;
use crate::app::window_state::session::{Filter, Level, PictureView, Question};
use crate::app::window_state::video::PlaySpeed;
use touchline_documents::document::CameraId;

/// An action that changes how something is displayed. It neither changes a label nor shows more of
/// it.
#[derive(Debug, PartialEq)]
pub enum ViewAction {
    /// Show another part of the picture.
    Picture(PictureView),
    /// The scale at which the picture fits its canvas changed.
    FitScale(f64),
    /// Clear the selection on the filmstrip.
    SelectNoFrames,
    /// Set the filter of the filmstrip.
    SetFilter(Filter),
    /// The pointer entered (true) or left the list in the review panel; see [`crate::app::review`].
    HoldReview(bool),
    /// Set the order of the list in the review panel.
    SetReviewOrder(ReviewOrder),
    /// Set the minimum confidence of suggestions that are accepted together.
    SetReviewThreshold(f64),
    /// Set whether suggestions that disagree with their neighbours are accepted, too.
    SetWithDisagreeing(bool),
    /// Include a suggestion in the common acceptance, or exclude it.
    TickSuggestion {
        /// The index of the frame.
        frame: usize,
        /// Whether it is included.
        ticked: bool,
    },
    /// Set whether the list in the review panel shows one suggestion per shot.
    SetOnePerShot(bool),
    /// Select the camera of the quality page.
    SetQualityCamera(CameraId),
    /// Select the unit of time on the quality page.
    SetTimeAxis(TimeAxis),
    /// Show a part of the time on the quality page, or all of it.
    ShowSpan(Option<[f64; 2]>),
    /// Read the field templates again that could not be read.
    ReadFailedTemplatesAgain,
    /// Close the dialog.
    CloseDialog,
    /// Show another page of the guide.
    ShowGuidePage(GuidePage),
    /// Remove a message by its id.
    DismissNotice(u64),
    /// Show a message from outside of the application.
    Notify(Level, String),
    /// Ask for a typed path, because the system has no file dialog.
    TypePath(Question),
    /// Set the speed of the video.
    SetSpeed(PlaySpeed),
    /// Pause the video, at its end or because the user does something else.
    Pause,
}
