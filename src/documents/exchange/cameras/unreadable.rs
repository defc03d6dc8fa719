//! Frames whose camera cannot be read.
//!
//! Programs that calibrate frame by frame write `null`, `{}` or NaN where they fail. One such file
//! must not cost the cameras of all others: its frame is imported without a camera, and a note
//! counts and names such files. Only where no file has a camera the import fails.

use super::frame_camera::{FrameCamera, FrameProjection, Unreadable};
use super::into_document::{Cameras, unsolved_frame};
use crate::document::{Document, Frame, Shared};
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::syntax::values::shorten;
use touchline_core::files::plain;
use touchline_core::geometry::{ImageSize, pluralise};

/// Maximum number of damaged frames at the beginning of a file.
const MAX_DAMAGED: usize = 1000;

/// The most of them that a line names.
const MAX_NAMED: usize = 3;

/// Reads files with one frame each, by name with their bytes. A damaged file is a frame without a
/// camera.
///
/// # Errors
/// All of them are damaged; the first is named.
pub fn read_frame_files(
    files: &[(&str, &[u8])],
    frame_name: impl Fn(&str) -> &str,
    read: impl Fn(&str, &[u8]) -> Result<FrameCamera, Problem>,
) -> ExchangeResult<Vec<FrameCamera>> {
    let mut frames = FrameCollector {
        frames: Vec::with_capacity(files.len()),
        ..FrameCollector::default()
    };
    for &(file, bytes) in files {
        let name = frame_name(file);
        frames.add(name, Some(file), read(name, bytes));
    }
    // Where all are damaged, the problem is that of the first file.
    let first = files.first().map_or("", |(file, _)| *file);
    frames.finish().map_err(|problem| problem.within(first))
}

/// Collects frames as they are read, the damaged ones without a camera.
#[derive(Default)]
pub struct FrameCollector {
    frames: Vec<FrameCamera>,
    first_problem: Option<Problem>,
    is_any_read: bool,
}

impl FrameCollector {
    /// Adds a frame, or what is wrong with it; `file` is a file of its own.
    pub fn add(&mut self, name: &str, file: Option<&str>, read: Result<FrameCamera, Problem>) {
        match read {
            Ok(frame) => {
                self.is_any_read = true;
                self.frames.push(frame);
            }
            // The frame stays in its place in the order, because frames without numbers are
            // attached to a video by their order.
            Err(problem) => {
                self.frames.push(frame_without_camera(name, file, &problem));
                self.first_problem.get_or_insert(problem);
            }
        }
    }

    /// Adds a frame of a table, or what is wrong with it; `number` is its number in its video.
    pub fn add_numbered(
        &mut self,
        name: &str,
        number: Option<u64>,
        read: Result<FrameCamera, Problem>,
    ) {
        let is_read = read.is_ok();
        self.add(name, None, read);
        if let Some(frame) = self.frames.last_mut().filter(|_| !is_read) {
            frame.frame_index = number;
        }
    }

    /// How many frames were added.
    pub const fn len(&self) -> usize {
        self.frames.len()
    }

    /// Whether many frames were added and all of them are damaged. Each takes memory for its
    /// message, and a file that begins so is not of the format, however long it is.
    pub const fn has_only_damaged(&self) -> bool {
        !self.is_any_read && self.frames.len() > MAX_DAMAGED
    }

    /// The frames in the order in which they were added.
    ///
    /// # Errors
    /// All of them are damaged; the problem is that of the first.
    pub fn finish(self) -> Result<Vec<FrameCamera>, Problem> {
        match self.first_problem {
            Some(problem) if !self.is_any_read => Err(problem),
            _ => Ok(self.frames),
        }
    }
}

/// A frame of which the camera cannot be read; `file` is a file of its own.
fn frame_without_camera(name: &str, file: Option<&str>, problem: &Problem) -> FrameCamera {
    let unreadable = Unreadable {
        file: file.map(ToOwned::to_owned),
        problem: problem.to_string(),
    };
    FrameCamera {
        unreadable: Some(unreadable),
        ..FrameCamera::new(name, None, FrameProjection::Nothing)
    }
}

/// The line about frames without a camera; none where there is none. `frames` are all that were
/// read.
pub fn describe_unreadable_frames(frames: &[FrameCamera]) -> Option<String> {
    // A frame that was read but fits no camera has no file of its own to name; then all are called
    // frames.
    let mut has_files = true;
    let mut named = Vec::new();
    for frame in frames {
        if let Some(Unreadable { file, problem }) = &frame.unreadable {
            has_files &= file.is_some();
            named.push((file.as_deref().unwrap_or(&frame.name), problem.clone()));
        }
    }
    let kind = if has_files { "file" } else { "frame" };
    describe_unreadable(&named, [named.len(), frames.len()], kind, "camera")
}

/// The line about so many of all things of a kind that have nothing that can be read: the names of
/// the first and what is wrong there. None where there is none.
pub fn describe_unreadable(
    named: &[(&str, String)],
    [count, total]: [usize; 2],
    kind: &str,
    has_no: &str,
) -> Option<String> {
    let verb = if count == 1 { "has" } else { "have" };
    let mut first: Vec<String> = named
        .iter()
        .take(MAX_NAMED)
        .map(|(name, problem)| format!("{} ({})", shorten(name), plain(problem)))
        .collect();
    if count > MAX_NAMED {
        first.push("…".to_owned());
    }
    (count > 0).then(|| {
        format!(
            "{count} of {} {verb} no {has_no} that can be read: {}",
            pluralise(total, kind),
            first.join(", ")
        )
    })
}

/// Adds the frames without a camera to a document of the others, in the order in which all were
/// read. `sizes` are those of their pictures; where one is not known, it is that of a frame with a
/// camera.
pub fn add_unsolved(document: &mut Document, frames: &[FrameCamera], sizes: &[Option<ImageSize>]) {
    // `document` is of at least one frame with a camera; the import fails where there is none.
    let Some(size) = document.frames.first().map(|frame| frame.image_size) else {
        return;
    };
    // The document has the frames with a camera in the order in which they were read, so that one
    // pass over all frames merges the two kinds. A frame is shared, so that copies of it are cheap.
    let solved: Vec<Shared<Frame>> = document.frames.iter().cloned().collect();
    let mut solved = solved.into_iter();
    let mut all = Vec::with_capacity(frames.len());
    for (frame, known) in frames.iter().zip(sizes) {
        if frame.unreadable.is_none() {
            all.extend(solved.next());
            continue;
        }
        let size = known.unwrap_or(size);
        let camera = Cameras(&mut document.cameras).find_or_add(size);
        all.push(unsolved_frame(frame, camera, size).into());
    }
    all.extend(solved);
    document.frames = all.into_iter().collect();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::import;
    use crate::exchange::tests::{SIZE, awkward, export_as};
    use crate::exchange::{Format, ImportOptions, Imported};
    use std::fs;

    /// The import of an export of twelve frames, of which some files have other contents.
    fn import_damaged(
        exporter: Format,
        format: Format,
        damage: &[(String, &str)],
    ) -> ExchangeResult<Imported> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cameras");
        let exported = export_as(&awkward(), exporter);
        exported.files.write(&path, true, false).unwrap();
        for (file, text) in damage {
            assert!(path.join(file).is_file(), "{file} is replaced");
            fs::write(path.join(file), text).unwrap();
        }
        let options = ImportOptions {
            size: Some(SIZE),
            ..ImportOptions::default()
        };
        import(&path, format, &options)
    }

    #[test]
    fn damaged_files_are_frames_without_a_camera() {
        for (exporter, format, file) in [
            (Format::SoccerNet, Format::SoccerNet, "camera_{}.json"),
            (Format::SoccerNet, Format::PnlCalib, "camera_{}.json"),
            (Format::OpenCv, Format::OpenCv, "{}.yml"),
            (Format::Wc14, Format::Wc14, "{}.homographyMatrix"),
        ] {
            let damage = [
                (file.replace("{}", "0003"), "null"),
                (file.replace("{}", "0004"), "{}"),
                (file.replace("{}", "0007"), "{\"a\": NaN}"),
                (file.replace("{}", "0012"), ""),
            ];
            let imported = import_damaged(exporter, format, &damage).unwrap();
            let frames = &imported.document.frames;
            let unsolved: Vec<usize> = (0..frames.len())
                .filter(|index| frames[*index].ptz.is_none())
                .collect();
            assert_eq!(
                (frames.len(), &unsolved[..]),
                (12, &[2, 3, 6, 11][..]),
                "{format}"
            );
            assert_eq!(frames[2].image.as_deref(), Some("0003.jpg"), "{format}");
            let note = imported.failures.first().unwrap();
            let start = format!(
                "4 of 12 files have no camera that can be read: {} (",
                damage[0].0
            );
            assert!(note.starts_with(&start) && note.ends_with(", …"), "{note}");
        }
    }

    #[test]
    fn where_no_file_has_a_camera_the_first_is_named() {
        let damage: Vec<(String, &str)> = (1..=12)
            .map(|number| (format!("camera_{number:04}.json"), "{}"))
            .collect();
        let error = import_damaged(Format::SoccerNet, Format::SoccerNet, &damage).unwrap_err();
        assert_eq!(
            error.to_string(),
            "camera_0001.json: x_focal_length is missing"
        );
    }
}
