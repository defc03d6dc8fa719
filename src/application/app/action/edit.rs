//! What changes the document.

use crate::app::choices::{CameraChoice, MaskList, MaskScope, Scope};
use touchline_core::camera::Ptz;
use touchline_core::field::Symmetry;
use touchline_core::geometry::PixelBox;
use touchline_documents::document::{Camera, FieldSpec, RejectReason, Target};

/// What changes the document.
#[derive(Debug, PartialEq)]
pub enum EditAction {
    /// The selected click moves by px of the picture.
    Nudge {
        /// To the right.
        dx_px: f64,
        /// Downwards.
        dy_px: f64,
        /// The key is held down: this belongs to the nudge before.
        held: bool,
    },
    /// A candidate on offer is taken.
    TakeName(usize),
    /// A landmark or line was picked on the field map or in a list.
    Pick(Target),
    /// A click gets a name.
    Name {
        /// Which click.
        click: usize,
        /// Its name.
        target: Target,
    },
    /// A click is removed.
    DeleteClick(usize),
    /// A click is held out of the solve, or takes part again.
    SetCheck {
        /// Which click.
        click: usize,
        /// Held out.
        check: bool,
    },
    /// Frames are assigned to a camera.
    AssignToCamera {
        /// Which frames.
        scope: Scope,
        /// Which camera.
        camera: CameraChoice,
    },
    /// The frame (or its shot) is not calibratable.
    RejectAs(RejectReason),
    /// The frame's comment; empty: none.
    SetComment(String),
    /// A mask is drawn: for the camera, or for this frame only.
    AddMask {
        /// Of every frame of the camera.
        of_camera: bool,
        /// The box, px.
        mask: PixelBox,
    },
    /// A mask is to cover other frames.
    ScopeMask {
        /// The list that it is in so far.
        list: MaskList,
        /// Which, from 0.
        index: usize,
        /// Which frames.
        scope: MaskScope,
    },
    /// A mask is removed.
    RemoveMask {
        /// The list that it is in.
        list: MaskList,
        /// Which, from 0.
        index: usize,
    },
    /// A number begins to change; the name is the undo step's.
    Begin(&'static str),
    /// Pan, tilt and focal length by hand.
    Ptz(Ptz),
    /// The frame's camera by hand.
    Camera(Box<Camera>),
    /// The field by hand.
    Field(FieldSpec),
    /// The field is another template's.
    ChooseSport(String),
    /// The number is as wanted.
    End,
    /// The number goes back to what it was.
    Abort,
    /// The frame's clicks decide again, instead of numbers by hand.
    SolveAgain,
    /// The suggestions that the preview speaks of are accepted together.
    AcceptAll,
    /// The forest is trained with a reference, or not.
    SetUseForTraining {
        /// Which frame.
        frame: usize,
        /// Whether it is.
        used: bool,
    },
    /// A frame takes part in the estimation of its camera's base, or is left out.
    UseForBase {
        /// Which frame.
        frame: usize,
        /// It takes part.
        used: bool,
    },
    /// The names of a frame's clicks are mirrored.
    MirrorNames {
        /// Which frame.
        frame: usize,
        /// Left for right, near for far, or both.
        symmetry: Symmetry,
    },
    /// A cut of the shown frame's video is moved.
    MoveCut {
        /// The first frame of the shot that begins there, as the video counts.
        cut: u64,
        /// The first frame of that shot from now on.
        to: u64,
    },
}
