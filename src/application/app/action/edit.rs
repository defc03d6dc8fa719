//! Actions that change the document.

use crate::app::window_state::choices::{CameraChoice, MaskList, MaskScope, Scope};
use touchline_calibration::proposals::BatchId;
use touchline_core::camera::Ptz;
use touchline_core::field::Symmetry;
use touchline_core::geometry::PixelBox;
use touchline_documents::document::{Camera, FieldSpec, RejectReason, Target};

/// An action that changes the document.
#[derive(Debug, PartialEq)]
pub enum EditAction {
    /// Move the selected click, px of the picture.
    Nudge {
        /// To the right, px.
        dx_px: f64,
        /// Downwards, px.
        dy_px: f64,
        /// Whether the key is held down; then the movement belongs to the same step as the one
        /// before.
        held: bool,
    },
    /// Give the click that waits for a name the candidate at an index in the list.
    TakeName(usize),
    /// Use a landmark or line that was picked on the field map or in a list.
    Pick(Target),
    /// Name a click.
    Name {
        /// The index of the click.
        click: usize,
        /// The name.
        target: Target,
    },
    /// Remove a click, by its index.
    DeleteClick(usize),
    /// Hold a click out of the solve, or use it again.
    SetCheck {
        /// The index of the click.
        click: usize,
        /// Whether it is held out.
        check: bool,
    },
    /// Assign frames to a camera.
    AssignToCamera {
        /// The frames.
        scope: Scope,
        camera: CameraChoice,
    },
    /// Reject the shown frame, or its shot if the question was about that.
    RejectAs(RejectReason),
    /// Set the comment of the shown frame; an empty text removes it.
    SetComment(String),
    AddMask {
        /// Whether it is for every frame of the camera, or for the shown frame only.
        of_camera: bool,
        /// The box, px.
        mask: PixelBox,
    },
    /// Change the frames that a mask covers.
    ScopeMask {
        /// The list that contains the mask.
        list: MaskList,
        /// The index in that list.
        index: usize,
        /// The frames to cover.
        scope: MaskScope,
    },
    RemoveMask {
        /// The list that contains the mask.
        list: MaskList,
        /// The index in that list.
        index: usize,
    },
    /// Start a series of edits of numbers; the name is that of the step of undo.
    Begin(&'static str),
    /// Set pan, tilt and focal length.
    Ptz(Ptz),
    /// Change the shown frame's camera.
    Camera(Box<Camera>),
    /// Change the shown frame's field.
    Field(FieldSpec),
    /// Replace the field by another template's.
    ChooseSport(String),
    /// Keep the template of the field editor beside the project, which uses it from then on.
    SaveFieldTemplate,
    /// End the series of edits.
    End,
    /// Abort the series of edits: the numbers return to what they were.
    Abort,
    /// Solve the shown frame from its clicks again, in place of numbers set by hand.
    SolveAgain,
    /// Discards a batch of suggestions after the question.
    DiscardBatch(BatchId),
    /// Accept the suggestions on the sheet *Accept all*.
    AcceptAll,
    /// Accept the suggestions that are selected in the gallery.
    AcceptSelected,
    /// Mark the frames that are selected in the gallery as not calibratable.
    RejectSelected(RejectReason),
    /// Use a reference for training, or not.
    SetUseForTraining {
        /// The index of the frame.
        frame: usize,
        /// Whether it is used.
        used: bool,
    },
    /// Use a frame for the estimation of its camera's base, or not.
    UseForBase {
        /// The index of the frame.
        frame: usize,
        /// Whether it is used.
        used: bool,
    },
    /// Mirror the names of a frame's clicks.
    MirrorNames {
        /// The index of the frame.
        frame: usize,
        /// Left and right, near and far, or both.
        symmetry: Symmetry,
    },
    /// Move a cut of the shown frame's video.
    MoveCut {
        /// The present first frame of the shot after the cut, as the video counts.
        cut: u64,
        /// The new first frame of that shot.
        to: u64,
    },
}
