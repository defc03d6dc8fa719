//! Changes of the user's settings.

use crate::app::settings::{Loupe, ThemeChoice};
use crate::app::{Chord, Command};
use crate::scene::{OverlayStyle, PictureLook, Sport};

/// A change of the user's settings.
#[derive(Debug, PartialEq)]
pub enum SettingsAction {
    /// The style of the overlay.
    OverlayStyle(OverlayStyle),
    /// Dark or light.
    Theme(ThemeChoice),
    /// The colour of a sport's lines.
    LineColour(&'static Sport, [u8; 3]),
    /// The loupe.
    Loupe(Loupe),
    /// The memory for decoded frames, MiB.
    PictureMemory(u32),
    /// Brightness, contrast and gamma of the displayed picture.
    PictureLook(PictureLook),
    /// The size of texts and controls; 1 is the system's.
    TextSize(f32),
    /// The sizes of the side panel and the filmstrip, points; none: derived from the window's size.
    PanelSizes {
        /// The side panel's width.
        side: Option<f32>,
        /// The filmstrip's height.
        filmstrip: Option<f32>,
    },
    /// Assign a key to a command.
    AssignKey(Command, Chord),
    /// Reset all keys to their defaults.
    ResetKeys,
    /// Whether the details in the inspector are unfolded.
    Details(bool),
}
