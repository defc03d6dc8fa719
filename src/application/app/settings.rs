//! What belongs to the user and not to a project: style, keys, recent documents.

use super::Keymap;
use crate::scene::{OverlayStyle, PictureLook, Sport};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// How many recent documents are remembered.
pub const MAX_RECENT: usize = 12;

/// The user's settings, kept as JSON in the user's configuration folder.
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// How the field's lines are drawn over the picture; their colour is that of fields of no known
    /// sport.
    pub overlay: OverlayStyle,
    /// The colours of the lines that a person chose, by [`Sport::id`].
    pub line_colours: BTreeMap<String, [u8; 3]>,
    /// The loupe around a point that is placed or dragged.
    pub loupe: Loupe,
    /// Memory for decoded frames, MiB.
    pub picture_memory_mib: u32,
    /// Dark or light.
    pub theme: ThemeChoice,
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
    /// A point that is placed or dropped goes to the painted corner, crossing or spot that it
    /// names.
    pub snap_points: bool,
    /// The base of a camera is estimated from the painted lines of its frames as well.
    pub base_on_paint: bool,
    /// What the forest proposes is snapped to the painted lines before it is shown, where they
    /// decide.
    pub snap_suggestions: bool,
    /// The note that drawing runs on the processor has been shown for this adapter.
    pub told_about_adapter: String,
}

/// The colours of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ThemeChoice {
    /// Light on dark: a picture is judged best on a dark ground.
    #[default]
    Dark,
    /// Dark on light.
    Light,
    /// What the system has.
    System,
}

/// The loupe around a point that is placed or dragged.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Loupe {
    /// It is shown.
    pub shown: bool,
    /// Points of the screen per px of the picture.
    pub magnification: f32,
    /// Its side, points.
    pub side: f32,
}

impl Loupe {
    /// What the magnification may be.
    pub const MAGNIFICATION: std::ops::RangeInclusive<f32> = 3.0..=16.0;
    /// What the side may be.
    pub const SIDE: std::ops::RangeInclusive<f32> = 120.0..=280.0;

    /// Numbers from a file edited by hand, brought into their ranges.
    #[must_use]
    pub fn within_limits(self) -> Self {
        let default = Self::default();
        let within = |value: f32, range: std::ops::RangeInclusive<f32>, default: f32| {
            if value.is_finite() {
                value.clamp(*range.start(), *range.end())
            } else {
                default
            }
        };
        Self {
            shown: self.shown,
            magnification: within(
                self.magnification,
                Self::MAGNIFICATION,
                default.magnification,
            ),
            side: within(self.side, Self::SIDE, default.side),
        }
    }
}

impl Default for Loupe {
    fn default() -> Self {
        Self {
            shown: true,
            magnification: 8.0,
            side: 160.0,
        }
    }
}

/// What the memory for decoded frames may be, MiB.
pub const PICTURE_MEMORY_MIB: std::ops::RangeInclusive<u32> = 128..=16_384;

/// How large texts and controls may be.
pub const TEXT_SIZE: std::ops::RangeInclusive<f32> = 0.75..=2.0;

/// A size of texts, brought into its range.
#[must_use]
pub const fn text_size_within_limits(size: f32) -> f32 {
    if size.is_finite() {
        size.clamp(*TEXT_SIZE.start(), *TEXT_SIZE.end())
    } else {
        1.0
    }
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
        let is_usable = size
            .iter()
            .all(|side| side.is_finite() && *side <= 20_000.0);
        let position = self.position.filter(|at| {
            at.iter()
                .all(|side| side.is_finite() && side.abs() <= 20_000.0)
        });
        let size = [size[0].max(Self::LEAST[0]), size[1].max(Self::LEAST[1])];
        is_usable.then_some(Self {
            position,
            size,
            ..self
        })
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            overlay: OverlayStyle::default(),
            line_colours: BTreeMap::new(),
            loupe: Loupe::default(),
            picture_memory_mib: 512,
            theme: ThemeChoice::default(),
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
            snap_suggestions: true,
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

    /// How the lines of a field are drawn over the picture: in the colour of its sport.
    #[must_use]
    pub fn overlay_of(&self, template: &str) -> OverlayStyle {
        let colour = Sport::of_template(template).map_or(self.overlay.colour, |sport| {
            self.line_colours
                .get(sport.id)
                .copied()
                .unwrap_or(sport.colour)
        });
        OverlayStyle {
            colour,
            ..self.overlay
        }
    }

    /// Chooses the colour of a sport's lines.
    pub fn set_line_colour(&mut self, sport: &Sport, colour: [u8; 3]) {
        if colour == sport.colour {
            self.line_colours.remove(sport.id);
        } else {
            self.line_colours.insert(sport.id.to_owned(), colour);
        }
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
            if value.is_finite() {
                value.clamp(low, high)
            } else {
                default
            }
        };
        self.overlay.width = within(self.overlay.width, 0.5, 12.0, style.width);
        self.overlay.opacity = within(self.overlay.opacity, 0.05, 1.0, style.opacity);
        self.overlay.outline = within(self.overlay.outline, 0.0, 4.0, style.outline);
        self.loupe = self.loupe.within_limits();
        self.picture_memory_mib = self
            .picture_memory_mib
            .clamp(*PICTURE_MEMORY_MIB.start(), *PICTURE_MEMORY_MIB.end());
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
        let mended = Settings::from_json(
            r#"{"picture": {"gamma": 0}, "window": {"size": [10, 700], "maximized": false}}"#,
        )
        .unwrap();
        assert!((mended.picture.gamma - 0.25).abs() < 1e-6);
        assert_eq!(mended.window.unwrap().size, [900.0, 700.0]);
    }

    #[test]
    fn lines_have_the_colour_of_their_sport_until_another_is_chosen() {
        let mut settings = Settings::default();
        let colour = |settings: &Settings, template| settings.overlay_of(template).colour;
        assert_eq!(colour(&settings, "soccer"), [255, 221, 64]);
        assert_eq!(colour(&settings, "basketball_nba"), [90, 225, 255]);
        let basketball = Sport::of_template("basketball_fiba").unwrap();
        settings.set_line_colour(basketball, [86, 180, 233]);
        assert_eq!(colour(&settings, "basketball_nba"), [86, 180, 233]);
        assert_eq!(colour(&settings, "soccer"), [255, 221, 64]);
        settings.set_line_colour(basketball, basketball.colour);
        assert!(settings.line_colours.is_empty());
        settings.overlay.colour = [1, 2, 3];
        assert_eq!(colour(&settings, "my_own_field"), [1, 2, 3]);
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
