//! What belongs to the user and not to a project: style, keys, recent documents.

use super::Keymap;
use crate::scene::OverlayStyle;
use serde::{Deserialize, Serialize};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// How many recent documents are remembered.
pub const MAX_RECENT: usize = 12;

/// The user's settings, kept as JSON in the user's configuration folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// How the field's lines are drawn over the picture.
    pub overlay: OverlayStyle,
    /// Keys that differ from the defaults.
    pub keys: Keymap,
    /// Documents opened before, the latest first.
    pub recent: Vec<PathBuf>,
    /// The field map is shown.
    pub field_map: bool,
    /// The inspector's details are unfolded.
    pub details: bool,
    /// The note that drawing runs on the processor has been shown for this adapter.
    pub told_about_adapter: String,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            overlay: OverlayStyle::default(),
            keys: Keymap::default(),
            recent: Vec::new(),
            field_map: true,
            details: false,
            told_about_adapter: String::new(),
        }
    }
}

/// Why settings could not be kept.
#[derive(Debug, Error)]
pub enum SettingsError {
    /// The file or its folder cannot be written.
    #[error("cannot write the settings {path}: {source}; changes last until the window closes", path = .path.display())]
    Write {
        /// The settings file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}

impl Settings {
    /// Where the settings of this user live; none on a system without a home.
    #[must_use]
    pub fn default_path() -> Option<PathBuf> {
        Some(directories::ProjectDirs::from("", "", "touchline")?.config_dir().join("settings.json"))
    }

    /// Reads the settings; what is missing or unreadable takes its default, and the reason is returned beside it.
    #[must_use]
    pub fn load(path: &Path) -> (Self, Option<String>) {
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return (Self::default(), None),
            Err(error) => {
                return (Self::default(), Some(format!("settings {}: {error}; defaults are used", path.display())));
            }
        };
        match serde_json::from_str::<Self>(&text) {
            Ok(settings) => (settings.within_limits(), None),
            Err(error) => (Self::default(), Some(format!("settings {}: {error}; defaults are used", path.display()))),
        }
    }

    /// Writes the settings in one piece.
    ///
    /// # Errors
    /// The file or its folder cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), SettingsError> {
        let write = || -> std::io::Result<()> {
            let folder = path.parent().unwrap_or(Path::new("."));
            std::fs::create_dir_all(folder)?;
            let mut file = tempfile::NamedTempFile::new_in(folder)?;
            file.write_all(serde_json::to_string_pretty(self)?.as_bytes())?;
            file.persist(path)?;
            Ok(())
        };
        write().map_err(|source| SettingsError::Write { path: path.to_path_buf(), source })
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
        self.recent.truncate(MAX_RECENT);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_survive_the_round_trip_and_damage_falls_back_to_defaults() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep").join("settings.json");
        assert_eq!(Settings::load(&path), (Settings::default(), None));
        let mut settings = Settings::default();
        settings.remember(Path::new("/matches/a"));
        settings.overlay.width = 3.5;
        settings.save(&path).unwrap();
        assert_eq!(Settings::load(&path), (settings, None));
        std::fs::write(&path, "{ not json").unwrap();
        let (defaults, reason) = Settings::load(&path);
        assert_eq!(defaults, Settings::default());
        assert!(reason.unwrap().contains("defaults are used"));
        std::fs::write(&path, r#"{"overlay": {"width": -4}}"#).unwrap();
        let (mended, _) = Settings::load(&path);
        assert!((mended.overlay.width - 0.5).abs() < 1e-6);
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
