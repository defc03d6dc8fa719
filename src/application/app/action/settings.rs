//! What belongs to the user and not to the document.

use crate::app::settings::{Loupe, ThemeChoice};
use crate::app::{Chord, Command};
use crate::scene::{OverlayStyle, PictureLook, Sport};

/// What belongs to the user and not to the document.
#[derive(Debug, PartialEq)]
pub enum SettingsAction {
    /// The overlay's style.
    OverlayStyle(OverlayStyle),
    /// Dark or light.
    Theme(ThemeChoice),
    /// The lines of a sport have this colour.
    LineColour(&'static Sport, [u8; 3]),
    /// The loupe's look.
    Loupe(Loupe),
    /// The memory for decoded frames, MiB.
    PictureMemory(u32),
    /// How bright the picture is shown.
    PictureLook(PictureLook),
    /// How large texts and controls are; 1 is the system's.
    TextSize(f32),
    /// The side panel or the filmstrip was made larger or smaller, points; none: by the window's
    /// size.
    PanelSizes {
        /// The side panel's width.
        side: Option<f32>,
        /// The filmstrip's height.
        filmstrip: Option<f32>,
    },
    /// A command gets a key.
    AssignKey(Command, Chord),
    /// Every key goes back to its default.
    ResetKeys,
    /// The inspector's details unfold or fold.
    Details(bool),
}
