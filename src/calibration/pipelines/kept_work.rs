//! Finished parts of long work, kept on disk by content: work that was stopped or killed goes on
//! from there, and gives the same document as in one run.
//!
//! Every expensive part is a function of what it reads: pictures, what the document says of their
//! frames, and settings. Its *key* is a hash of all these, and its result lies in a file of that
//! name. A run always goes through the whole work in the same order, and takes each result that is
//! there instead of computing it. So a changed setting repeats what depends on it and nothing else,
//! and no state of a stopped run has to be restored.
//!
//! | part | depends on |
//! |---|---|
//! | cuts of a video | the video |
//! | what a shot shows | three of its pictures |
//! | search for a camera | frames, clicks, shots, field, number of sampled frames |
//! | its parts: features of eight frames, matches, poses at one focal scale | the search |
//! | a clip tracked | its frames and what is known of them, base, field, options |
//! | a base refined | the tracked frames of its camera |
//! | other shots by a forest | all frames |
//!
//! Pictures are named by the content of their file, never by its name alone. The program is part
//! of each key, so that another one begins anew. The files lie in `.touchline/work` beside the
//! project, and may be deleted at any time; beyond [`MAX_BYTES`] the oldest go.

use crate::calibrate::ClipFrames;
use crate::calibrate::kept::{Kept, from_bytes, to_bytes};
use crate::proposals::WorkFolder;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{LazyLock, Mutex, PoisonError};
use touchline_core::files::{FileCache, state_of_program};
use touchline_core::geometry::hex;
use touchline_documents::document::{CameraId, Document, DocumentAt, Frame, FrameId, generator};
use touchline_vision::media::{FrameRef, sha256_of_file, video_file_id};

/// Maximum size of all results, bytes: the points of about three hours of video.
pub const MAX_BYTES: u64 = 4 << 30;
const EXTENSION: &str = "kept";
/// Number of bytes of the SHA-256 before a result, by which a damaged file is recognised.
const CHECKSUM_BYTES: usize = 16;

/// The results of finished parts; without a folder nothing is kept.
#[derive(Debug)]
pub struct KeptWork {
    files: Option<FileCache>,
    /// What each file is recognised by.
    contents: Mutex<BTreeMap<PathBuf, Option<String>>>,
}

/// A hash of everything that determines a result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorkKey(String);

impl KeptWork {
    /// Nothing is kept.
    pub const fn none() -> Self {
        Self {
            files: None,
            contents: Mutex::new(BTreeMap::new()),
        }
    }

    /// The work in the hidden folder beside a document; nothing is kept if that is a link.
    pub fn in_folder(folder: &WorkFolder) -> Self {
        let files = folder.finished_work().ok();
        Self {
            files: files.map(|folder| FileCache::new(&folder, EXTENSION, MAX_BYTES)),
            ..Self::none()
        }
    }

    /// Whether results are kept.
    pub const fn is_kept(&self) -> bool {
        self.files.is_some()
    }

    /// The result with this key; none if there is none, or it is damaged.
    pub fn recall<T: Kept>(&self, key: &WorkKey) -> Option<T> {
        from_bytes(&self.recall_bytes(&key.0)?)
    }

    /// Keeps a result. Where it cannot be written, it is computed again the next time.
    pub fn keep(&self, key: &WorkKey, result: &impl Kept) {
        self.keep_bytes(&key.0, &to_bytes(result));
    }

    /// The intact content of a file.
    pub fn recall_bytes(&self, name: &str) -> Option<Vec<u8>> {
        let mut bytes = self.files.as_ref()?.get(name)?;
        if bytes.len() < CHECKSUM_BYTES {
            return None;
        }
        let body = bytes.split_off(CHECKSUM_BYTES);
        (Sha256::digest(&body)[..CHECKSUM_BYTES] == bytes[..]).then_some(body)
    }

    /// Writes a file with its checksum. True if it is there now.
    pub fn keep_bytes(&self, name: &str, body: &[u8]) -> bool {
        let mut bytes = Sha256::digest(body)[..CHECKSUM_BYTES].to_vec();
        bytes.extend(body);
        let files = self.files.as_ref();
        files.is_some_and(|files| files.put(name, &bytes).is_ok())
    }

    /// Writes a file that is named by its content. Returns its name; none if it cannot be written.
    pub fn keep_content(&self, body: &[u8]) -> Option<String> {
        let name = hex(&Sha256::digest(body)[..16]);
        let is_there = self.files.as_ref()?.contains(&name) || self.keep_bytes(&name, body);
        is_there.then_some(name)
    }

    /// Begins the key of a part of the work, by the part's name; none if nothing is kept.
    pub fn begin_key(&self, part: &str) -> Option<KeyParts<'_>> {
        self.is_kept().then(|| {
            let mut parts = KeyParts {
                work: self,
                digest: Sha256::new(),
                is_known: true,
            };
            parts.add_text(&PROGRAM);
            parts.add_text(part);
            parts
        })
    }

    /// What the file of a picture is recognised by, and the picture's number in it; none if it
    /// cannot be read.
    fn content_of(&self, picture: &FrameRef) -> Option<(String, usize)> {
        let (path, index) = match picture {
            FrameRef::Image(path) => (path, 0),
            FrameRef::Video { path, index } => (path, *index),
        };
        let mut contents = self.contents.lock().unwrap_or_else(PoisonError::into_inner);
        let content = contents.entry(path.to_path_buf()).or_insert_with(|| {
            match picture {
                FrameRef::Image(path) => sha256_of_file(path),
                FrameRef::Video { path, .. } => video_file_id(path),
            }
            .ok()
        });
        Some((content.clone()?, index))
    }
}

/// The program, as far as results depend on it: its version, and size and time of its file, so
/// that a program of the same version that was built again begins anew.
static PROGRAM: LazyLock<String> =
    LazyLock::new(|| format!("{} {:?}", generator(), state_of_program()));

/// A key in the making.
pub struct KeyParts<'a> {
    work: &'a KeptWork,
    digest: Sha256,
    /// Whether everything could be added. Without the content of a picture there is no key.
    is_known: bool,
}

impl KeyParts<'_> {
    /// A text, or the debug output of options, which has all their values.
    pub fn add_text(&mut self, text: &str) {
        // The length goes before it, so that no two lists of texts are the same bytes.
        self.digest.update((text.len() as u64).to_le_bytes());
        self.digest.update(text.as_bytes());
    }

    /// A part of a document.
    fn add_json(&mut self, value: &impl Serialize) {
        match serde_json::to_string(value) {
            Ok(text) => self.add_text(&text),
            Err(_) => self.is_known = false,
        }
    }

    /// A value as it is kept.
    pub fn add(&mut self, value: &impl Kept) {
        let bytes = to_bytes(value);
        self.digest.update((bytes.len() as u64).to_le_bytes());
        self.digest.update(&bytes);
    }

    /// A picture, by the content of its file.
    pub fn add_picture(&mut self, picture: Option<&FrameRef>) {
        let content = picture.map(|picture| self.work.content_of(picture));
        match content {
            None => self.add_text("no picture"),
            Some(None) => self.is_known = false,
            Some(Some((content, index))) => {
                self.add_text(&content);
                self.digest.update((index as u64).to_le_bytes());
            }
        }
    }

    /// A frame: its picture, and what the document says of it but for names and paths.
    pub fn add_frame(&mut self, at: DocumentAt<'_>, index: usize) {
        let Some(frame) = at.document.frames.get(index) else {
            return self.add_text("no frame");
        };
        self.add_picture(frame.picture_source(at.folder).as_ref());
        let mut frame = Frame::clone(frame);
        frame.id = FrameId::default();
        frame.revision = 0;
        frame.image = None;
        frame.video = None;
        frame.sha256 = None;
        self.add_json(&frame);
    }

    /// All frames.
    pub fn add_frames(&mut self, at: DocumentAt<'_>) {
        for index in 0..at.document.frames.len() {
            self.add_frame(at, index);
        }
    }

    /// The cameras, the fields with their templates, the click noise and the shots.
    pub fn add_document(&mut self, at: DocumentAt<'_>) {
        let document = at.document;
        for camera in &document.cameras {
            self.add_json(&**camera);
        }
        self.add_json(&document.field);
        for spec in document.fields() {
            match at.model_of(spec) {
                Ok(field) => self.add(&field),
                Err(_) => self.is_known = false,
            }
        }
        self.add_json(&document.click_noise);
        self.add_json(&document.shots);
    }

    /// The pictures of a clip, with the document's frames among them.
    pub fn add_clip(&mut self, at: DocumentAt<'_>, clip: &ClipFrames) {
        self.add(&clip.camera);
        for frame in &clip.frames {
            self.add(&frame.place);
            match frame.place {
                Some(place) => self.add_frame(at, place),
                None => self.add_picture(Some(&frame.source)),
            }
        }
    }

    /// The key; none if the content of a picture is not known.
    pub fn finish(self) -> Option<WorkKey> {
        self.is_known
            .then(|| WorkKey(hex(&self.digest.finalize()[..16])))
    }
}

impl WorkKey {
    /// The name of its file.
    pub fn name(&self) -> &str {
        &self.0
    }
}

/// What a part of the work changed in a document: its fields, its cameras and some frames.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DocumentChange {
    /// As JSON, which gives numbers back to the bit.
    field: String,
    cameras: Vec<(CameraId, String)>,
    frames: Vec<(usize, String)>,
}

crate::calibrate::kept::kept! {
    DocumentChange { field, cameras, frames }
}

impl DocumentChange {
    /// The change from one state to another with the same frames; none if it cannot be written.
    pub fn between(before: &Document, after: &Document) -> Option<Self> {
        let cameras = after.cameras.iter().map(|camera| {
            let json = serde_json::to_string(&**camera).ok()?;
            Some((camera.id.clone(), json))
        });
        let frames = after.frames.differences(&before.frames);
        let frames = frames.into_iter().map(|index| {
            let json = serde_json::to_string(&**after.frames.get(index)?).ok()?;
            Some((index, json))
        });
        let change = Self {
            field: serde_json::to_string(&after.field).ok()?,
            cameras: cameras.collect::<Option<_>>()?,
            frames: frames.collect::<Option<_>>()?,
        };
        // What JSON cannot say is computed again rather than kept a little otherwise.
        (change.apply(before).as_ref() == Some(after)).then_some(change)
    }

    /// The changed document; none if this is not a change of it.
    pub fn apply(&self, before: &Document) -> Option<Document> {
        let mut after = before.clone();
        after.field = serde_json::from_str(&self.field).ok()?;
        for (id, json) in &self.cameras {
            *after.camera_mut(id)? = serde_json::from_str(json).ok()?;
        }
        for (index, json) in &self.frames {
            let frame: Frame = serde_json::from_str(json).ok()?;
            **after.frames.get_mut(*index)? = frame;
        }
        Some(after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{Camera, VideoFrame};
    use touchline_documents::testing::{ptz_at, soccer_document};

    fn document(video: &str) -> Document {
        let size = ImageSize::new(64, 36);
        let mut document = soccer_document();
        document
            .cameras
            .push(Camera::new("main".into(), size).into());
        for index in 0..3 {
            let of_video = VideoFrame::new(video, index, Some(0.04 * index as f64));
            document
                .frames
                .push(Frame::from_video(of_video, "main".into(), size).into());
        }
        document
    }

    fn key(work: &KeptWork, document: &Document, folder: &Path) -> Option<WorkKey> {
        let mut parts = work.begin_key("search")?;
        let at = document.at(folder);
        parts.add_document(at);
        parts.add_frames(at);
        parts.finish()
    }

    #[test]
    fn a_key_is_of_content_and_never_of_a_name() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        std::fs::write(at("a.mp4"), "one video").unwrap();
        std::fs::write(at("moved.mp4"), "one video").unwrap();
        std::fs::write(at("other.mp4"), "other video").unwrap();
        let work = || KeptWork::in_folder(&WorkFolder::beside(&at("project.json")));
        let key_of = |document: &Document| key(&work(), document, place.path());
        let one = document("a.mp4");
        let first = key_of(&one);
        assert!(first.is_some());
        assert_eq!(key_of(&document("moved.mp4")), first, "moved");
        assert_ne!(key_of(&document("other.mp4")), first, "another video");
        assert_eq!(key_of(&document("missing.mp4")), None);
        assert_eq!(key(&KeptWork::none(), &one, place.path()), None);
        let mut changed = one.clone();
        changed.frames[1].ptz = ptz_at(1.0, -9.0, 90.0);
        assert_ne!(key_of(&changed), first, "a camera");
        let mut changed = one.clone();
        changed.field.params.insert("length_m".to_owned(), 104.0);
        assert_ne!(key_of(&changed), first, "the field's size");
        // The same name, other content: the file is read again by the next run.
        std::fs::write(at("a.mp4"), "two video").unwrap();
        assert_ne!(key_of(&one), first, "replaced");
    }

    #[test]
    fn results_are_kept_on_disk_and_damaged_ones_are_none() {
        let place = tempfile::tempdir().unwrap();
        let folder = WorkFolder::beside(&place.path().join("project.json"));
        let key = WorkKey("0123".to_owned());
        KeptWork::in_folder(&folder).keep(&key, &vec![1_usize, 2, 3]);
        let work = KeptWork::in_folder(&folder);
        assert_eq!(work.recall(&key), Some(vec![1_usize, 2, 3]));
        assert_eq!(work.recall::<String>(&key), None, "of another type");
        assert_eq!(work.recall::<Vec<usize>>(&WorkKey("4".to_owned())), None);
        let path = place.path().join(".touchline/work/0123.kept");
        let whole = std::fs::read(&path).unwrap();
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            assert_eq!(work.recall::<Vec<usize>>(&key), None, "{length} bytes");
        }
    }

    #[test]
    fn a_change_of_a_document_is_repeated_to_the_bit() {
        let before = document("a.mp4");
        let mut after = before.clone();
        after.frames[2].ptz = ptz_at(0.1 + 0.2, -9.0 / 7.0, 1e3 / 3.0);
        after.field.params.insert("width_m".to_owned(), 68.1);
        let change = DocumentChange::between(&before, &after).unwrap();
        assert_eq!(change.frames.len(), 1);
        let read: DocumentChange = from_bytes(&to_bytes(&change)).unwrap();
        assert_eq!(read.apply(&before).as_ref(), Some(&after));
        let mut shorter = before.clone();
        shorter.frames.pop();
        assert_eq!(change.apply(&shorter), None);
    }
}
