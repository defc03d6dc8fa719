//! Finds the frame of an open document that shows the same picture as an imported one. Labels must
//! never be assigned to another picture.
//!
//! | rule, in this order | not where |
//! |---|---|
//! | the same image file | their SHA-256 are known and differ |
//! | an image of the same name without its ending, if one frame has it | their SHA-256 are known and differ |
//! | the same number of the same video | what their files are recognised by is known and differs |
//!
//! The SHA-256 of a picture is the one stated in its document, else that of the file if it exists.
//! Videos are the same if they have the same path, or the same name and not two existing files of
//! different lengths. A track that names no video belongs to the only video of the document.

use crate::document::{DocumentAt, Frame, VideoFrame, resolve_path};
use crate::exchange::cameras::camera_format::file_stem;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use touchline_vision::media::sha256_of_file;

/// The maximum difference of the times of one video frame, s; a larger one means two different
/// videos.
const SAME_TIME_S: f64 = 0.01;

/// An index of a document's frames by their pictures.
pub struct Places<'a> {
    open: DocumentAt<'a>,
    by_file: BTreeMap<PathBuf, usize>,
    /// None for a name shared by several frames.
    by_stem: BTreeMap<String, Option<usize>>,
    by_number: BTreeMap<(PathBuf, u64), usize>,
    videos: Vec<PathBuf>,
}

impl<'a> Places<'a> {
    /// The frames of an open document.
    pub fn from_document(open: DocumentAt<'a>) -> Self {
        let mut places = Self {
            open,
            by_file: BTreeMap::new(),
            by_stem: BTreeMap::new(),
            by_number: BTreeMap::new(),
            videos: Vec::new(),
        };
        for (index, frame) in open.document.frames.iter().enumerate() {
            if let Some(file) = image_file(frame, open.folder) {
                places.by_file.insert(file, index);
            }
            if let Some(stem) = image_stem(frame) {
                places
                    .by_stem
                    .entry(stem)
                    .and_modify(|known| *known = None)
                    .or_insert(Some(index));
            }
            if let Some(video) = &frame.video {
                let file = resolve_path(&video.file_path(open.folder));
                places.by_number.insert((file, video.frame_index), index);
            }
        }
        // The keys of the map are sorted by video, so that equal videos are neighbours.
        places.videos = places
            .by_number
            .keys()
            .map(|(video, _)| video.clone())
            .collect();
        places.videos.dedup();
        places
    }

    /// The position of the frame that shows the same picture as an imported one.
    pub fn find(&self, imported: &Frame, folder: &Path) -> Option<usize> {
        // The rules of the table above, in its order. Where a picture of this name is there but
        // another one by its digest, the frame is none of the document: the number of a video must
        // not overrule it.
        let by_file =
            image_file(imported, folder).and_then(|file| self.by_file.get(&file).copied());
        let by_image =
            by_file.or_else(|| self.by_stem.get(&image_stem(imported)?).copied().flatten());
        match by_image {
            Some(index) if self.has_same_digest(index, imported, folder) => Some(index),
            Some(_) => None,
            None => self.find_in_video(imported.video.as_ref()?, folder),
        }
    }

    /// Whether the digests do not contradict that a frame shows the same picture.
    fn has_same_digest(&self, index: usize, imported: &Frame, folder: &Path) -> bool {
        let Some(frame) = self.open.document.frames.get(index) else {
            return false;
        };
        let is_one_file = image_file(frame, self.open.folder) == image_file(imported, folder);
        match (
            digest(frame, self.open.folder, is_one_file),
            digest(imported, folder, is_one_file),
        ) {
            (Some(known), Some(other)) => known == other,
            _ => true,
        }
    }

    fn find_in_video(&self, imported: &VideoFrame, folder: &Path) -> Option<usize> {
        let video = self.find_video(&imported.path, folder)?;
        let index = *self.by_number.get(&(video.clone(), imported.frame_index))?;
        let known = self.open.document.frames.get(index)?.video.as_ref()?;
        if known.is_of_other_file(imported.file_id.as_deref()) {
            return None;
        }
        // A track that names no video counts from its own beginning, so that its times say nothing.
        let times_s = known.pts_s.zip(imported.pts_s);
        let are_apart = times_s.is_some_and(|(a, b)| (a - b).abs() > SAME_TIME_S);
        (!(are_apart && names_video(&imported.path))).then_some(index)
    }

    fn find_video(&self, path: &str, folder: &Path) -> Option<&PathBuf> {
        let file = resolve_path(&folder.join(path));
        if let Some(same) = self.videos.iter().find(|video| **video == file) {
            return Some(same);
        }
        // Only where the document has one video is it clear which one a nameless track is of.
        if !names_video(path) {
            return <&[PathBuf; 1]>::try_from(&self.videos[..])
                .ok()
                .map(|[only]| only);
        }
        // Two videos of one name and length are no match at all.
        let mut alike = self
            .videos
            .iter()
            .filter(|video| may_be_copies(video, &file));
        alike.next().filter(|_| alike.next().is_none())
    }
}

/// The SHA-256 of a frame's image: the stated one, else that of the file. Not computed if both
/// frames have the same file, because then only stated digests can differ.
fn digest(frame: &Frame, folder: &Path, is_one_file: bool) -> Option<String> {
    match &frame.sha256 {
        Some(stated) => Some(stated.to_ascii_lowercase()),
        None if is_one_file => None,
        None => sha256_of_file(&frame.image_path(folder)?).ok(),
    }
}

/// Whether two videos may be the same: equal names, and not two existing files of different
/// lengths.
fn may_be_copies(a: &Path, b: &Path) -> bool {
    a.file_name() == b.file_name()
        && file_length(a)
            .zip(file_length(b))
            .is_none_or(|(a, b)| a == b)
}

/// The length of a file, bytes; none where it does not exist.
fn file_length(path: &Path) -> Option<u64> {
    fs::metadata(path).ok().map(|metadata| metadata.len())
}

/// Whether a path names a video file. Tracks without a video are named by their numbers.
pub fn names_video(path: &str) -> bool {
    Path::new(path).extension().is_some()
}

fn image_file(frame: &Frame, folder: &Path) -> Option<PathBuf> {
    frame.image_path(folder).map(|image| resolve_path(&image))
}

fn image_stem(frame: &Frame) -> Option<String> {
    frame.image.as_deref().map(file_stem)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Document, FieldSpec};
    use touchline_core::geometry::ImageSize;

    const SIZE: ImageSize = ImageSize::new(64, 48);

    fn of_images(images: &[&str]) -> Document {
        let mut document = Document::new(FieldSpec::new("soccer"));
        document.frames = images
            .iter()
            .map(|image| Frame::from_image(image, "main".into(), SIZE).into())
            .collect();
        document
    }

    fn of_video(path: &str, numbers: &[u64]) -> Document {
        let mut document = Document::new(FieldSpec::new("soccer"));
        let frame = |&number: &u64| {
            let video = VideoFrame::new(path, number, Some(number as f64 / 25.0));
            Frame::from_video(video, "main".into(), SIZE).into()
        };
        document.frames = numbers.iter().map(frame).collect();
        document
    }

    fn found(
        open: &Document,
        folder: &Path,
        imported: &Document,
        imported_folder: &Path,
    ) -> Vec<Option<usize>> {
        let places = Places::from_document(open.at(folder));
        imported
            .frames
            .iter()
            .map(|frame| places.find(frame, imported_folder))
            .collect()
    }

    #[test]
    fn numbers_count_within_one_video() {
        let here = Path::new("/no/match");
        let mine = of_video("videos/mine.mp4", &[4, 5]);
        assert_eq!(
            found(&mine, here, &of_video("videos/theirs.mp4", &[4, 5]), here),
            [None, None]
        );
        assert_eq!(
            found(
                &mine,
                here,
                &of_video("mine.mp4", &[5, 6]),
                Path::new("/no/copy")
            ),
            [Some(1), None]
        );
        assert_eq!(
            found(
                &mine,
                here,
                &of_video("000005", &[5]),
                Path::new("/no/track")
            ),
            [Some(1)],
            "of no video"
        );
        let mut two = mine.clone();
        two.frames
            .extend(of_video("videos/second.mp4", &[7]).frames.iter().cloned());
        assert_eq!(
            found(
                &two,
                here,
                &of_video("000005", &[5]),
                Path::new("/no/track")
            ),
            [None]
        );
        let mut later = of_video("mine.mp4", &[5]);
        later.frames[0].video.as_mut().unwrap().pts_s = Some(17.0);
        assert_eq!(
            found(&mine, here, &later, Path::new("/no/copy")),
            [None],
            "another video of that name"
        );
    }

    #[test]
    fn videos_of_one_name_and_two_lengths_are_two() {
        let place = tempfile::tempdir().unwrap();
        let (mine, theirs) = (place.path().join("mine"), place.path().join("theirs"));
        for (folder, bytes) in [(&mine, "long"), (&theirs, "longer")] {
            fs::create_dir(folder).unwrap();
            fs::write(folder.join("match.mp4"), bytes).unwrap();
        }
        let document = of_video("match.mp4", &[3]);
        assert_eq!(found(&document, &mine, &document, &theirs), [None]);
        fs::write(theirs.join("match.mp4"), "copy").unwrap();
        assert_eq!(found(&document, &mine, &document, &theirs), [Some(0)]);
    }

    #[test]
    fn a_name_is_no_picture() {
        let place = tempfile::tempdir().unwrap();
        let (mine, theirs) = (place.path().join("mine"), place.path().join("theirs"));
        for (folder, bytes) in [(&mine, "a picture"), (&theirs, "another")] {
            fs::create_dir(folder).unwrap();
            fs::write(folder.join("0001.jpg"), bytes).unwrap();
        }
        let open = of_images(&["0001.jpg", "0002.jpg"]);
        let imported = of_images(&["0001.png", "0001.jpg", "0002.jpg"]);
        assert_eq!(
            found(&open, &mine, &imported, &theirs),
            [Some(0), None, Some(1)],
            "where neither is there"
        );
        fs::write(theirs.join("0001.jpg"), "a picture").unwrap();
        assert_eq!(
            found(&open, &mine, &imported, &theirs)[1],
            Some(0),
            "a copy of it"
        );
        // The digests that the documents state.
        let (mut open, mut imported) = (of_images(&["1.jpg"]), of_images(&["1.jpg"]));
        open.frames[0].sha256 = Some("AB".to_owned());
        for (stated, is_found) in [(None, true), (Some("ab"), true), (Some("cd"), false)] {
            imported.frames[0].sha256 = stated.map(str::to_owned);
            for folder in [Path::new("/no/a"), Path::new("/no/b")] {
                assert_eq!(
                    found(&open, Path::new("/no/a"), &imported, folder) == [Some(0)],
                    is_found,
                    "{stated:?}"
                );
            }
        }
    }
}
