//! Sorts the paths that a user drops on the window or types: pictures and projects are opened,
//! labels of another program are imported into what is open.

use crate::app::operation::{Context, Failure, Operation, Slot};
use crate::app::window_state::session::{Level, Opening};
use crate::app::{App, Command};
use std::convert::Infallible;
use std::path::{Path, PathBuf};
use touchline_core::geometry::pluralise;
use touchline_documents::exchange::{ExchangeError, Format, recognize_format};
use touchline_documents::store::PROJECT_FILE;
use touchline_vision::media::{has_image_extension, list_images};

/// Labels never lie in a file larger than this, bytes; videos do.
const MOST_BYTES: u64 = 64 << 20;

pub struct PathSorting {
    paths: Vec<PathBuf>,
}

/// Labels of another program that are to be imported.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ForeignLabels {
    /// Their file or folder.
    pub path: PathBuf,
    pub format: Format,
}

#[derive(Debug, Default)]
pub struct SortedPaths {
    /// What is opened; several of them as a queue.
    open: Vec<PathBuf>,
    /// What is imported.
    labels: Option<ForeignLabels>,
    /// Number of paths beside these.
    left_out: usize,
    /// A folder of labels that belong to several formats.
    unclear: Option<PathBuf>,
}

impl Operation for PathSorting {
    type Progress = Infallible;
    type Output = SortedPaths;
    type Error = Infallible;

    const NAME: &'static str = "sort paths";

    fn run(&self, _: &Context<'_, Infallible>) -> Result<SortedPaths, Infallible> {
        Ok(SortedPaths::new(&self.paths))
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.path_sorting
    }

    fn take_over(&self, app: &mut App, result: Result<SortedPaths, Failure<Infallible>>) {
        match result {
            Ok(sorted) => app.take_sorted_paths(sorted),
            Err(failure) => {
                let text = format!("Nothing was opened: {failure}.");
                app.session.notify(failure.level(), text);
            }
        }
    }
}

impl SortedPaths {
    fn new(paths: &[PathBuf]) -> Self {
        let mut sorted = Self::default();
        for path in paths {
            match format_of_labels(path) {
                Ok(Some(format)) if sorted.labels.is_none() => {
                    let path = path.clone();
                    sorted.labels = Some(ForeignLabels { path, format });
                }
                Ok(None) if sorted.open.is_empty() || !has_image_extension(path) => {
                    sorted.open.push(path.clone());
                }
                Ok(_) => sorted.left_out += 1,
                Err(_) => sorted.unclear = Some(path.clone()),
            }
        }
        sorted
    }
}

/// The format of the labels at a path; none where pictures, a project or nothing known lies there,
/// which opening it then says.
///
/// # Errors
/// A folder has labels of several formats.
fn format_of_labels(path: &Path) -> Result<Option<Format>, ExchangeError> {
    // Cheap checks first: recognising a format reads files.
    let is_document = path.join(PROJECT_FILE).exists();
    let is_large = path.metadata().is_ok_and(|found| found.len() > MOST_BYTES);
    let has_pictures = list_images(path).is_ok_and(|listing| !listing.images.is_empty());
    if is_document || is_large || has_pictures {
        return Ok(None);
    }
    match recognize_format(path) {
        // The program's own format is opened, not imported.
        Ok(Format::Json) => Ok(None),
        Ok(format) => Ok(Some(format)),
        Err(error @ ExchangeError::SeveralFormats { .. }) => Err(error),
        Err(_) => Ok(None),
    }
}

// ---- In the application ----

impl App {
    /// Opens or imports what lies at paths that the user dropped or typed.
    pub(in crate::app) fn open_any(&mut self, paths: Vec<PathBuf>) {
        if !paths.is_empty() {
            self.start(PathSorting { paths });
        }
    }

    fn take_sorted_paths(&mut self, sorted: SortedPaths) {
        if let Some(path) = sorted.unclear {
            let text = format!(
                "{} has labels of several formats: choose one of them.",
                path.display()
            );
            let offers = [("Import…", Command::Import)];
            self.session.notify_with(Level::Warning, text, offers);
        }
        if sorted.left_out > 0 {
            let more = pluralise(sorted.left_out, "more path");
            let text =
                format!("{more} left out: give the folder of pictures and one set of labels.");
            self.session.warn(text);
        }
        if sorted.labels.is_some() {
            self.waiting_labels = sorted.labels;
        }
        match sorted.open.as_slice() {
            [path] => self.open_path(path.clone()),
            [_, ..] => self.open_instead(Opening::Paths(sorted.open)),
            [] if self.open.is_some() => self.import_waiting_labels(),
            // The start page says that they wait.
            [] => {}
        }
    }

    /// Shows what the labels that wait for their pictures would bring to the document that is open
    /// now.
    pub(in crate::app) fn import_waiting_labels(&mut self) {
        let Some(labels) = self.waiting_labels.take() else {
            return;
        };
        match self.why_not(Command::Import) {
            Some(why) => self.session.warn(why),
            None => self.look_at_labels(labels),
        }
    }

    /// The labels that wait until their pictures are opened.
    pub const fn waiting_labels(&self) -> Option<&ForeignLabels> {
        self.waiting_labels.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    const CAMERA: &str = r#"{"pan_degrees": 1, "x_focal_length": 2}"#;

    #[test]
    fn a_video_is_opened_and_its_cameras_wait_for_it() {
        let root = tempfile::tempdir().unwrap();
        let [cameras, video] = ["cameras", "match.mp4"].map(|name| root.path().join(name));
        fs::create_dir(&cameras).unwrap();
        fs::write(cameras.join("camera_0001.json"), CAMERA).unwrap();
        fs::write(&video, "not a film").unwrap();
        let sorted = SortedPaths::new(&[cameras.clone(), video.clone()]);
        assert_eq!(sorted.open, [video]);
        let format = Format::SoccerNet;
        let path = cameras;
        assert_eq!(sorted.labels, Some(ForeignLabels { path, format }));
        assert_eq!((sorted.left_out, sorted.unclear), (0, None));
    }

    #[test]
    fn pictures_projects_and_unknown_files_are_opened() {
        let root = tempfile::tempdir().unwrap();
        let [frames, project, empty] = ["frames", "project", "empty"].map(|name| {
            let folder = root.path().join(name);
            fs::create_dir(&folder).unwrap();
            folder
        });
        // Pictures with labels beside them are a folder of frames.
        fs::write(frames.join("0001.JPG"), "").unwrap();
        fs::write(frames.join("camera_0001.json"), CAMERA).unwrap();
        fs::write(project.join(PROJECT_FILE), "{}").unwrap();
        for path in [frames, project, empty, root.path().join("none")] {
            assert_eq!(format_of_labels(&path).unwrap(), None, "{path:?}");
        }
    }

    #[test]
    fn a_second_picture_and_a_mixture_are_named_and_several_videos_are_a_queue() {
        let root = tempfile::tempdir().unwrap();
        let file = |name: &str, text: &str| {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, text).unwrap();
            path
        };
        let pictures = ["1.png", "2.png"].map(|name| file(name, ""));
        let sorted = SortedPaths::new(&pictures);
        assert_eq!((sorted.open, sorted.left_out), (pictures[..1].to_vec(), 1));
        let videos = ["1.mp4", "2.mp4"].map(|name| file(name, ""));
        let sorted = SortedPaths::new(&videos);
        assert_eq!(
            (sorted.open, sorted.left_out),
            (videos.to_vec(), 0),
            "a queue of them"
        );
        file("mixed/camera_0003.json", CAMERA);
        let mixed = file(
            "mixed/0003.json",
            r#"{"Middle line": [{"x": 0.5, "y": 0.5}]}"#,
        );
        let sorted = SortedPaths::new(&[mixed.parent().unwrap().to_path_buf()]);
        assert_eq!(sorted.unclear.as_deref(), mixed.parent());
        assert!(sorted.open.is_empty() && sorted.labels.is_none());
    }
}
