//! Reads and writes the file of the user's settings.

use crate::app::Settings;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;
use touchline_core::files::{plain, read_named_text};
use touchline_documents::store::write_atomically;

/// Why settings could not be written.
#[derive(Debug, Error)]
pub enum SettingsError {
    /// The file or its folder cannot be written.
    #[error("cannot write the settings {path}: {source}; changes last until the window closes", path = .path.display())]
    Write {
        /// The settings file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
}

/// Maximum size of a settings file, bytes; larger ones are not read.
const MAX_BYTES: u64 = 1 << 20;

/// The path of the user's settings. `None` on a system without a home folder.
pub fn settings_path() -> Option<PathBuf> {
    Some(
        directories::ProjectDirs::from("", "", "touchline")?
            .config_dir()
            .join("settings.json"),
    )
}

/// Reads the settings. If that fails, the defaults and the reason; a missing file is no failure.
pub fn load_settings(path: &Path) -> (Settings, Option<String>) {
    match read_named_text(path, MAX_BYTES) {
        Ok(text) => match Settings::from_json(&text) {
            Ok(settings) => (settings, None),
            Err(error) => default_settings_because(&plain(&error.to_string()), path),
        },
        Err(error) if error.kind() == io::ErrorKind::NotFound => (Settings::default(), None),
        Err(error) => default_settings_because(&error.to_string(), path),
    }
}

/// The default settings, and a message that says why they are used.
fn default_settings_because(reason: &str, path: &Path) -> (Settings, Option<String>) {
    let message = format!("settings {}: {reason}; defaults are used", path.display());
    (Settings::default(), Some(message))
}

/// Writes the settings atomically.
///
/// # Errors
/// The file or its folder cannot be written.
pub fn save_settings(settings: &Settings, path: &Path) -> Result<(), SettingsError> {
    write_settings(settings, path).map_err(|source| SettingsError::Write {
        path: path.to_path_buf(),
        source,
    })
}

fn write_settings(settings: &Settings, path: &Path) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    write_atomically(path, serde_json::to_string_pretty(settings)?.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::settings::RecentDocument;

    #[test]
    fn settings_survive_the_round_trip_and_damage_falls_back_to_defaults() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep").join("settings.json");
        assert_eq!(load_settings(&path), (Settings::default(), None));
        let mut settings = Settings::default();
        settings.remember(RecentDocument::new(Path::new("/matches/a"), None));
        settings.overlay.width = 3.5;
        save_settings(&settings, &path).unwrap();
        assert_eq!(load_settings(&path), (settings, None));
        fs::write(&path, "{ not json").unwrap();
        let (defaults, reason) = load_settings(&path);
        assert_eq!(defaults, Settings::default());
        assert!(reason.unwrap().contains("defaults are used"));
        fs::write(&path, r#"{"text_size": "\u001b[2J"}"#).unwrap();
        let (_, reason) = load_settings(&path);
        let reason = reason.unwrap();
        assert!(!reason.contains(char::is_control), "{reason:?}");
    }
}
