//! What belongs to the user and not to a project: style, keys, recent documents.

use super::Keymap;
use crate::scene::{OverlayStyle, PictureLook};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// How many recent documents are remembered.
pub const MAX_RECENT: usize = 12;

/// The user's settings, kept as JSON in the user's configuration folder.
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// How the field's lines are drawn over the picture.
    pub overlay: OverlayStyle,
    /// How large texts and controls are; 1 is the system's.
    pub text_size: f32,
    /// How bright the picture is shown; never in exports.
    pub picture: PictureLook,
    /// The width of the side panel, points; none: by the window's size.
    pub side_width: Option<f32>,
    /// The height of the filmstrip, points; none: by the window's size.
    pub filmstrip_height: Option<f32>,
    /// Where the window was, and its size, points.
    pub window: Option<WindowPlace>,
    /// Keys that differ from the defaults.
    pub keys: Keymap,
    /// Documents opened before, the latest first.
    pub recent: Vec<PathBuf>,
    /// The field map is shown.
    pub field_map: bool,
    /// The inspector's details are unfolded.
    pub details: bool,
    /// A point that is placed or dropped goes to the painted corner, crossing or spot that it names.
    pub snap_points: bool,
    /// The base of a camera is estimated from the painted lines of its frames as well.
    pub base_on_paint: bool,
    /// What the forest proposes is snapped to the painted lines before it is shown, where they decide.
    pub snap_suggestions: bool,
    /// The note that drawing runs on the processor has been shown for this adapter.
    pub told_about_adapter: String,
}

/// How large texts and controls may be.
pub const TEXT_SIZE: std::ops::RangeInclusive<f32> = 0.75..=2.0;

/// A size of texts, brought into its range.
#[must_use]
pub const fn text_size_within_limits(size: f32) -> f32 {
    if size.is_finite() { size.clamp(*TEXT_SIZE.start(), *TEXT_SIZE.end()) } else { 1.0 }
}

/// Where a window is on the screen, and its size, points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WindowPlace {
    /// The left and top edge; none where the system does not say.
    pub position: Option<[f32; 2]>,
    /// Width and height of its contents.
    pub size: [f32; 2],
    /// It fills the screen.
    pub maximized: bool,
}

impl WindowPlace {
    /// The smallest window that everything can be used in, points.
    pub const LEAST: [f32; 2] = [900.0, 600.0];

    /// A place from a file edited by hand; none where it is none.
    fn within_limits(self) -> Option<Self> {
        let size = self.size;
        let is_usable = size.iter().all(|side| side.is_finite() && *side <= 20_000.0);
        let position = self.position.filter(|at| at.iter().all(|side| side.is_finite() && side.abs() <= 20_000.0));
        let size = [size[0].max(Self::LEAST[0]), size[1].max(Self::LEAST[1])];
        is_usable.then_some(Self { position, size, ..self })
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            overlay: OverlayStyle::default(),
            text_size: 1.0,
            picture: PictureLook::default(),
            side_width: None,
            filmstrip_height: None,
            window: None,
            keys: Keymap::default(),
            recent: Vec::new(),
            field_map: true,
            details: false,
            snap_points: true,
            base_on_paint: false,
            snap_suggestions: false,
            told_about_adapter: String::new(),
        }
    }
}

impl Settings {
    /// The settings that a file holds; what is missing takes its default.
    ///
    /// # Errors
    /// The text is not JSON, or a key has a value of another kind.
    pub fn from_json(text: &str) -> Result<Self, serde_json::Error> {
        serde_json::from_str::<Self>(text).map(Self::within_limits)
    }

    /// Puts a document at the head of the recent ones.
    pub fn remember(&mut self, document: &Path) {
        self.recent.retain(|path| path != document);
        self.recent.insert(0, document.to_path_buf());
        self.recent.truncate(MAX_RECENT);
    }

    /// Numbers from a file edited by hand, brought into their ranges.
    fn within_limits(mut self) -> Self {
        let style = OverlayStyle::default();
        let within = |value: f32, low: f32, high: f32, default: f32| {
            if value.is_finite() { value.clamp(low, high) } else { default }
        };
        self.overlay.width = within(self.overlay.width, 0.5, 12.0, style.width);
        self.overlay.opacity = within(self.overlay.opacity, 0.05, 1.0, style.opacity);
        self.overlay.outline = within(self.overlay.outline, 0.0, 4.0, style.outline);
        self.text_size = text_size_within_limits(self.text_size);
        self.picture = self.picture.within_limits();
        self.side_width = self.side_width.filter(|width| width.is_finite());
        self.filmstrip_height = self.filmstrip_height.filter(|height| height.is_finite());
        self.window = self.window.and_then(WindowPlace::within_limits);
        self.recent.truncate(MAX_RECENT);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_out_of_their_range_are_brought_into_it() {
        let mended = Settings::from_json(r#"{"overlay": {"width": -4}}"#).unwrap();
        assert!((mended.overlay.width - 0.5).abs() < 1e-6);
        let mended =
            Settings::from_json(r#"{"picture": {"gamma": 0}, "window": {"size": [10, 700], "maximized": false}}"#)
                .unwrap();
        assert!((mended.picture.gamma - 0.25).abs() < 1e-6);
        assert_eq!(mended.window.unwrap().size, [900.0, 700.0]);
    }

    #[test]
    fn the_latest_document_comes_first_and_once() {
        let mut settings = Settings::default();
        for n in 0..20 {
            settings.remember(Path::new(&format!("/m/{}", n % 15)));
        }
        assert_eq!(settings.recent.len(), MAX_RECENT);
        assert_eq!(settings.recent[0], Path::new("/m/4"));
    }
}
