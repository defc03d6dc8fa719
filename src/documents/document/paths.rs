//! Rewriting of a document's paths for another folder.

use super::Document;
use std::path::{Component, Path, PathBuf};

impl Document {
    /// The document with its relative paths rewritten for another folder, so that they refer to the
    /// same files.
    ///
    /// Absolute paths stay. Both folders are absolute; across drives a path becomes absolute.
    #[must_use]
    pub fn relocate(mut self, from_folder: &Path, to_folder: &Path) -> Self {
        if from_folder == to_folder {
            return self;
        }
        for frame in &mut self.frames {
            // Both paths are worked out before either is set: only a frame with a relative path is
            // borrowed to be changed, so that all others stay shared with other states.
            let image = frame
                .image
                .as_deref()
                .and_then(|image| relocate(image, from_folder, to_folder));
            let video = frame
                .video
                .as_ref()
                .and_then(|video| relocate(&video.path, from_folder, to_folder));
            if image.is_some() {
                frame.image = image;
            }
            if let Some(path) = video
                && let Some(video) = &mut frame.video
            {
                video.path = path;
            }
        }
        for field in self.fields_mut() {
            if field.is_file()
                && let Some(path) = relocate(&field.template, from_folder, to_folder)
            {
                field.template = path;
            }
        }
        self
    }
}

/// The character that replaces parts of a name that are not UTF-8.
const NOT_UTF8: char = char::REPLACEMENT_CHARACTER;

impl Document {
    /// The first path whose file cannot be found because the name of a folder or file is not UTF-8,
    /// which the document requires.
    pub fn unwritable_path(&self, folder: &Path) -> Option<&str> {
        let mut paths = self.frames.iter().flat_map(|frame| {
            let video = frame.video.as_ref().map(|video| video.path.as_str());
            [frame.image.as_deref(), video].into_iter().flatten()
        });
        paths.find(|path| path.contains(NOT_UTF8) && !folder.join(path).exists())
    }
}

/// A relative path rewritten for another folder; none for an absolute one, which is kept.
fn relocate(path: &str, from_folder: &Path, to_folder: &Path) -> Option<String> {
    (!is_absolute(path)).then(|| path_between(to_folder, &from_folder.join(path)))
}

/// Whether a path is absolute on this or another system: a document written on Windows keeps its
/// `C:\…`. A file named `a:1.jpg` is not absolute.
fn is_absolute(path: &str) -> bool {
    let is_on_drive =
        matches!(path.as_bytes(), [letter, b':', b'/' | b'\\', ..] if letter.is_ascii_alphabetic());
    Path::new(path).is_absolute() || path.starts_with(['/', '\\']) || is_on_drive
}

/// The path of a file relative to a folder, with `/` between the parts; absolute where they share
/// no root.
pub fn path_between(folder: &Path, file: &Path) -> String {
    let (folder, file) = (normalise(folder), normalise(file));
    // Without a common root, such as on another drive, no relative path leads there.
    let shared = folder.iter().zip(&file).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return file
            .iter()
            .collect::<PathBuf>()
            .to_string_lossy()
            .into_owned();
    }
    let up = std::iter::repeat_n("..".to_owned(), folder.len() - shared);
    let down = file[shared..]
        .iter()
        .map(|part| part.as_os_str().to_string_lossy().into_owned());
    up.chain(down).collect::<Vec<_>>().join("/")
}

/// A path with symbolic links resolved as far as it exists; the rest is kept as it is written.
pub fn resolve_path(path: &Path) -> PathBuf {
    // The file need not exist: the longest ancestor that does is resolved, and the rest is
    // appended. The root always exists, so the last line is for systems that refuse it.
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    for ancestor in path.ancestors() {
        if let (Ok(real), Ok(rest)) = (ancestor.canonicalize(), path.strip_prefix(ancestor)) {
            // Joining an empty rest would append a separator and turn a file into a folder.
            return if rest.as_os_str().is_empty() {
                real
            } else {
                real.join(rest)
            };
        }
    }
    path
}

/// The parts of a path with `.` and `..` resolved where that is possible without the disk.
fn normalise(path: &Path) -> Vec<Component<'_>> {
    let mut parts = Vec::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(parts.last(), Some(Component::Normal(_))) => {
                parts.pop();
            }
            Component::ParentDir if matches!(parts.last(), Some(Component::RootDir)) => {}
            other => parts.push(other),
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{FieldSpec, VideoFrame};
    use crate::testing::new_frame;
    use touchline_core::geometry::ImageSize;

    #[test]
    fn paths_between_folders() {
        let between = |folder, file| path_between(Path::new(folder), Path::new(file));
        assert_eq!(between("/a/b", "/a/b/images/1.jpg"), "images/1.jpg");
        assert_eq!(
            between("/a/c", "/a/b/../b/images/1.jpg"),
            "../b/images/1.jpg"
        );
        assert_eq!(between("/x/y", "/a/1.jpg"), "../../a/1.jpg");
        assert_eq!(between("/a/b", "/a/b/./../../1.jpg"), "../../1.jpg");
    }

    #[test]
    fn relative_paths_follow_and_absolute_ones_stay() {
        let mut document = Document::new(FieldSpec::new("fields/mine.json"));
        let size = ImageSize::new(64, 48);
        let mut both = new_frame("images/1.jpg", size);
        both.video = Some(VideoFrame::new("../match.mp4", 3, None));
        document.frames.push(both.into());
        document.frames.push(new_frame("/data/2.jpg", size).into());
        document
            .frames
            .push(new_frame("D:\\data\\3.jpg", size).into());
        document
            .frames
            .push(new_frame("d:/data/4.jpg", size).into());
        document.frames.push(new_frame("a:1.jpg", size).into());
        let moved = document
            .clone()
            .relocate(Path::new("/home/a/match"), Path::new("/home/a/out/deep"));
        assert_eq!(
            moved.frames[0].image.as_deref(),
            Some("../../match/images/1.jpg")
        );
        assert_eq!(
            moved.frames[0].video.as_ref().unwrap().path,
            "../../match.mp4"
        );
        assert_eq!(moved.field.template, "../../match/fields/mine.json");
        assert_eq!(
            moved.frames[4].image.as_deref(),
            Some("../../match/a:1.jpg"),
            "a name, and no drive"
        );
        assert!(moved.frames.range(1..4).eq(document.frames.range(1..4)));
        assert!(
            moved.frames[1].is_same(&document.frames[1]),
            "untouched frames are shared"
        );
        let back = moved.relocate(Path::new("/home/a/out/deep"), Path::new("/home/a/match"));
        assert_eq!(back, document);
    }
}
