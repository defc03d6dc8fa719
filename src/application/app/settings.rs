//! The user's settings, independent of projects: style, keys, recent documents.

use super::Keymap;
use crate::scene::{OverlayStyle, PictureLook, Sport};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use touchline_documents::exchange::Format;
use touchline_vision::media::FrameRef;

/// Maximum number of recent documents.
pub const MAX_RECENT: usize = 12;

/// Maximum number of documents of which it is known that they have shown a question.
const MAX_QUESTIONS: usize = 200;

/// The user's settings, kept as JSON in the user's configuration folder.
#[expect(clippy::struct_excessive_bools, reason = "each is a switch of its own")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// The style of the lines over the picture. Its colour is used for fields of no known sport.
    pub overlay: OverlayStyle,
    /// The line colours that the user chose, by [`Sport::id`].
    pub line_colours: BTreeMap<String, [u8; 3]>,
    /// The loupe around a point that is placed or dragged.
    pub loupe: Loupe,
    /// Memory for decoded frames, MiB.
    pub picture_memory_mib: u32,
    /// Dark or light.
    pub theme: ThemeChoice,
    /// The size of texts and controls; 1 is the system's.
    pub text_size: f32,
    /// Brightness, contrast and gamma of the displayed picture; exports ignore it.
    pub picture: PictureLook,
    /// Width of the side panel, points; none: derived from the window's size.
    pub side_width: Option<f32>,
    /// Height of the filmstrip, points; none: derived from the window's size.
    pub filmstrip_height: Option<f32>,
    /// The last position and size of the window.
    pub window: Option<WindowPlace>,
    /// Keys that differ from the defaults.
    pub keys: Keymap,
    /// Recent documents, latest first.
    pub recent: Vec<RecentDocument>,
    /// The names of the formats that were exported to, last used first.
    pub formats: Vec<String>,
    /// The field templates that the user chose, last used first.
    pub sports: Vec<String>,
    /// The files of documents that have shown the question about burned-in graphics: each shows it
    /// once.
    pub burnt_in_questions: Vec<PathBuf>,
    /// Whether the matches of a queue are shown beside the picture.
    pub queue_panel: bool,
    /// Whether the field map is shown.
    pub field_map: bool,
    /// Whether pan, tilt and focal length over time are shown below the picture.
    pub curves: bool,
    /// Whether the details in the inspector are unfolded.
    pub details: bool,
    /// Whether points that the user places or drops move to the painted corner, crossing or spot
    /// that they name.
    pub snap_points: bool,
    /// Whether a camera's base is estimated from the painted lines as well as from clicks.
    pub base_on_paint: bool,
    /// Whether the forest's proposals are aligned to the painted lines before they are shown, if
    /// the lines determine the camera.
    pub snap_suggestions: bool,
    /// The graphics adapter for which the note about drawing on the processor has been shown.
    pub told_about_adapter: String,
}

/// A document that was opened before.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecentDocument {
    /// The document's file.
    pub file: PathBuf,
    /// Where the picture of its first frame is read from: an image or a video.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picture: Option<PathBuf>,
    /// The frame's index among those of the video; none if the picture is an image.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub video_frame: Option<usize>,
}

impl RecentDocument {
    /// A document with its first picture.
    pub fn new(file: &Path, picture: Option<&FrameRef>) -> Self {
        Self {
            file: file.to_path_buf(),
            picture: picture.map(|picture| picture.path().to_path_buf()),
            video_frame: match picture {
                Some(FrameRef::Video { index, .. }) => Some(*index),
                _ => None,
            },
        }
    }

    /// The picture of the first frame, if the document had one.
    pub fn picture(&self) -> Option<FrameRef> {
        let path = self.picture.clone()?;
        Some(match self.video_frame {
            Some(index) => FrameRef::video(path, index),
            None => FrameRef::image(path),
        })
    }
}

/// The colours of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ThemeChoice {
    /// Light on dark; pictures are assessed best on a dark background.
    #[default]
    Dark,
    /// Dark on light.
    Light,
    /// The system's choice.
    System,
}

/// The loupe around a point that is being placed or dragged.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Loupe {
    /// Whether it is shown.
    pub shown: bool,
    /// Points of the screen per px of the picture.
    pub magnification: f32,
    /// Length of its side, points.
    pub side: f32,
}

impl Loupe {
    /// The range of the magnification.
    pub const MAGNIFICATION: std::ops::RangeInclusive<f32> = 3.0..=16.0;
    /// The range of the side, points.
    pub const SIDE: std::ops::RangeInclusive<f32> = 120.0..=280.0;

    /// The same with numbers clamped to their ranges; the file may have been edited by hand.
    #[must_use]
    pub fn within_limits(self) -> Self {
        let default = Self::default();
        Self {
            shown: self.shown,
            magnification: clamp_finite(
                self.magnification,
                &Self::MAGNIFICATION,
                default.magnification,
            ),
            side: clamp_finite(self.side, &Self::SIDE, default.side),
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

/// The range of the memory for decoded frames, MiB.
pub const PICTURE_MEMORY_MIB: std::ops::RangeInclusive<u32> = 128..=16_384;

/// The range of the size of texts and controls.
pub const TEXT_SIZE: std::ops::RangeInclusive<f32> = 0.75..=2.0;

/// A size of texts, clamped to its range.
pub const fn text_size_within_limits(size: f32) -> f32 {
    if size.is_finite() {
        size.clamp(*TEXT_SIZE.start(), *TEXT_SIZE.end())
    } else {
        1.0
    }
}

/// Position and size of a window, points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WindowPlace {
    /// The left and top edge; none if the system does not report it.
    pub position: Option<[f32; 2]>,
    /// Width and height of the content.
    pub size: [f32; 2],
    /// Whether it fills the screen.
    pub maximized: bool,
}

impl WindowPlace {
    /// Minimum usable size of the window, points.
    pub const MIN_SIZE: [f32; 2] = [900.0, 600.0];

    /// The same with numbers clamped to their ranges. None if the size is not plausible.
    fn within_limits(self) -> Option<Self> {
        let size = self.size;
        // No desktop is larger than 20,000 points: such numbers are damage or a slip of the hand.
        let is_usable = size
            .iter()
            .all(|side| side.is_finite() && *side <= 20_000.0);
        let position = self.position.filter(|at| {
            at.iter()
                .all(|side| side.is_finite() && side.abs() <= 20_000.0)
        });
        let size = [
            size[0].max(Self::MIN_SIZE[0]),
            size[1].max(Self::MIN_SIZE[1]),
        ];
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
            formats: Vec::new(),
            sports: Vec::new(),
            burnt_in_questions: Vec::new(),
            queue_panel: true,
            field_map: true,
            curves: false,
            details: false,
            snap_points: true,
            base_on_paint: false,
            snap_suggestions: true,
            told_about_adapter: String::new(),
        }
    }
}

impl Settings {
    /// Reads settings; missing keys get their defaults, and numbers are clamped to their ranges.
    ///
    /// # Errors
    /// The text is not JSON, or a value has the wrong type.
    pub fn from_json(text: &str) -> Result<Self, serde_json::Error> {
        serde_json::from_str::<Self>(text).map(Self::within_limits)
    }

    /// The style of the lines of a field template, in the colour of its sport.
    pub fn overlay_of(&self, template: &str) -> OverlayStyle {
        let colour = Sport::from_template(template).map_or(self.overlay.colour, |sport| {
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

    /// Sets the colour of a sport's lines. The default colour is not stored.
    pub fn set_line_colour(&mut self, sport: &Sport, colour: [u8; 3]) {
        if colour == sport.colour {
            self.line_colours.remove(sport.id);
        } else {
            self.line_colours.insert(sport.id.to_owned(), colour);
        }
    }

    /// Moves a document to the head of the recent ones.
    pub fn remember(&mut self, document: RecentDocument) {
        self.recent.retain(|known| known.file != document.file);
        move_to_head(&mut self.recent, document, MAX_RECENT);
    }

    /// Moves a format to the head of those that were used.
    pub fn remember_format(&mut self, format: Format) {
        move_to_head(&mut self.formats, format.name().to_owned(), MAX_RECENT);
    }

    /// Moves a field template to the head of those that were chosen.
    pub fn remember_sport(&mut self, template: &str) {
        move_to_head(&mut self.sports, template.to_owned(), MAX_RECENT);
    }

    /// Notes that a document shows the question about burned-in graphics. Returns whether it has
    /// shown it before.
    pub fn note_burnt_in_question(&mut self, file: &Path) -> bool {
        let is_known = self.burnt_in_questions.iter().any(|known| known == file);
        move_to_head(
            &mut self.burnt_in_questions,
            file.to_path_buf(),
            MAX_QUESTIONS,
        );
        is_known
    }

    /// The same with numbers clamped to their ranges; the file may have been edited by hand.
    fn within_limits(mut self) -> Self {
        let style = OverlayStyle::default();
        let overlay = &mut self.overlay;
        overlay.width = clamp_finite(overlay.width, &(0.5..=12.0), style.width);
        overlay.opacity = clamp_finite(overlay.opacity, &(0.05..=1.0), style.opacity);
        overlay.outline = clamp_finite(overlay.outline, &(0.0..=4.0), style.outline);
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

/// Moves a value to the head of a list of at most `most`.
fn move_to_head<T: PartialEq>(list: &mut Vec<T>, value: T, most: usize) {
    list.retain(|known| *known != value);
    list.insert(0, value);
    list.truncate(most);
}

/// A number clamped to its range; `default` if it is not finite.
fn clamp_finite(value: f32, range: &std::ops::RangeInclusive<f32>, default: f32) -> f32 {
    if value.is_finite() {
        value.clamp(*range.start(), *range.end())
    } else {
        default
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
        let basketball = Sport::from_template("basketball_fiba").unwrap();
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
            let file = PathBuf::from(format!("/m/{}", n % 15));
            settings.remember(RecentDocument::new(&file, None));
        }
        assert_eq!(settings.recent.len(), MAX_RECENT);
        assert_eq!(settings.recent[0].file, Path::new("/m/4"));
    }

    #[test]
    fn a_recent_document_keeps_its_picture() {
        let frame = FrameRef::video(PathBuf::from("/m/match.mp4"), 7);
        let image = FrameRef::image(PathBuf::from("/m/1.jpg"));
        let mut settings = Settings::default();
        for picture in [&frame, &image] {
            let file = picture.path().with_extension("json");
            settings.remember(RecentDocument::new(&file, Some(picture)));
        }
        let json = serde_json::to_string(&settings).unwrap();
        let read = Settings::from_json(&json).unwrap();
        assert_eq!(read, settings);
        let pictures: Vec<_> = read.recent.iter().map(RecentDocument::picture).collect();
        assert_eq!(pictures, [Some(image), Some(frame)]);
    }
}
