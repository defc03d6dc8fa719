//! Pictures outside the project, which are copied only on request.
//!
//! A received project may refer to any file of this machine, and a dataset is made to be passed on.
//! The project of a video or of a folder of frames lies beside it (`match.mp4.touchline/`); these
//! frames belong to the project.

use crate::document::resolve_path;
use std::path::{Component, Path, PathBuf};
use touchline_core::files::PROJECT_SUFFIX;

/// The paths that contain a project's own pictures.
pub struct OwnPlaces(Vec<PathBuf>);

impl OwnPlaces {
    /// The places of a project in `folder`.
    pub fn from_project(folder: &Path) -> Self {
        let folder = resolve_path(folder);
        let name = folder
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        // `match.mp4.touchline` is the project of `match.mp4` beside it; a folder named by the
        // suffix alone is of nothing.
        let frames = name
            .strip_suffix(PROJECT_SUFFIX)
            .filter(|name| !name.is_empty());
        let frames = frames.map(|name| folder.with_file_name(name));
        Self(std::iter::once(folder).chain(frames).collect())
    }

    /// Whether a file lies in one of them, with links resolved. False if the path still contains
    /// `..`, which cannot be resolved in a missing folder.
    pub fn hold(&self, file: &Path) -> bool {
        let file = resolve_path(file);
        let leads_up = file.components().any(|part| part == Component::ParentDir);
        !leads_up && self.0.iter().any(|place| file.starts_with(place))
    }
}

#[cfg(test)]
mod tests {
    use super::OwnPlaces;
    use std::path::Path;

    #[test]
    fn a_project_has_what_lies_in_it_and_the_video_that_it_is_named_after() {
        let places = OwnPlaces::from_project(Path::new("/data/match.mp4.touchline"));
        let holds = |file: &str| places.hold(Path::new(file));
        assert!(holds("/data/match.mp4") && holds("/data/match.mp4.touchline/images/1.jpg"));
        assert!(!holds("/data/match.mp4.jpg") && !holds("/data/other.mp4"));
        assert!(
            !OwnPlaces::from_project(Path::new("/data/match"))
                .hold(Path::new("/data/match/../private/1.jpg"))
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_link_in_the_project_leads_outside() {
        let place = tempfile::tempdir().unwrap();
        let project = place.path().join("project");
        std::fs::create_dir(&project).unwrap();
        std::fs::write(place.path().join("private.jpg"), "").unwrap();
        std::os::unix::fs::symlink(place.path().join("private.jpg"), project.join("1.jpg"))
            .unwrap();
        assert!(!OwnPlaces::from_project(&project).hold(&project.join("1.jpg")));
    }
}
