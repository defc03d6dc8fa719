//! Imported labels joined with a document that is open: nothing that a person did there is changed.

use super::imported::Imported;
use crate::document::{Camera, CameraId, Document, DocumentAt, Frame, FrameStatus, path_between, resolved};
use crate::geometry::ImageSize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A document with imported labels, and what came of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Joined {
    /// The document.
    pub document: Document,
    /// Frames of the document that got clicks or a camera.
    pub matched: usize,
    /// Frames that were not in the document.
    pub added: usize,
    /// Frames that have labels of their own, which stay.
    pub kept: usize,
    /// Frames whose picture has another size in the document.
    pub other_size: usize,
    /// Clicks that came.
    pub clicks: usize,
    /// Cameras that came.
    pub cameras: usize,
    /// What a user should know.
    pub notes: Vec<String>,
}

/// Joins imported frames with those of a document: by the files of their pictures, else by their names where these are unique.
/// A frame gets clicks if it has none, and a camera if nobody has clicked or decided on it; all others stay as they are. Frames
/// that are not there are appended.
#[must_use]
pub fn join(open: DocumentAt<'_>, imported: &Imported) -> Joined {
    let mut joined = Joined {
        document: open.document.clone(),
        matched: 0,
        added: 0,
        kept: 0,
        other_size: 0,
        clicks: 0,
        cameras: 0,
        notes: imported.notes.clone(),
    };
    let places = Places::of(open);
    let mut cameras = Cameras { ids: BTreeMap::new() };
    for frame in &imported.document.frames {
        let place = places.of_frame(frame, &imported.folder);
        match place.and_then(|place| joined.document.frames.get(place).map(|there| (place, (**there).clone()))) {
            Some((_, there)) if there.image_size != frame.image_size => joined.other_size += 1,
            Some((place, there)) => match labelled(there, frame, &mut joined.document, imported, &mut cameras) {
                Some(labelled) => {
                    joined.matched += 1;
                    joined.clicks += labelled.clicks.len();
                    if let Some(known) = joined.document.frames.get_mut(place) {
                        **known = labelled;
                    }
                }
                None => joined.kept += 1,
            },
            None => {
                let image = frame.image.as_ref().map(|image| path_between(open.folder, &imported.folder.join(image)));
                let camera = match frame.ptz {
                    Some(_) => cameras.imported(&frame.camera, &mut joined.document, imported),
                    None => cameras.of_size(frame, &mut joined.document, imported),
                };
                joined.added += 1;
                joined.clicks += frame.clicks.len();
                joined.document.frames.push(Frame { image, camera, ..(**frame).clone() }.into());
            }
        }
    }
    joined.cameras = joined.document.cameras.len() - open.document.cameras.len();
    joined
}

/// A frame with what an imported one brings; none where it has labels of its own.
fn labelled(
    there: Frame,
    imported_frame: &Frame,
    document: &mut Document,
    imported: &Imported,
    cameras: &mut Cameras,
) -> Option<Frame> {
    let mut frame = there;
    let mut changed = false;
    if imported_frame.ptz.is_some() && frame.is_open() {
        frame.camera = cameras.imported(&imported_frame.camera, document, imported);
        (frame.ptz, frame.solution) = (imported_frame.ptz.clone(), imported_frame.solution.clone());
        frame.status = FrameStatus::Suggested;
        changed = true;
    }
    let is_undecided = matches!(frame.status, FrameStatus::New | FrameStatus::Draft | FrameStatus::Suggested);
    if !imported_frame.clicks.is_empty() && frame.clicks.is_empty() && is_undecided {
        frame.clicks.clone_from(&imported_frame.clicks);
        if imported_frame.ptz.is_none() {
            frame.status = FrameStatus::Draft;
        }
        changed = true;
    }
    changed.then_some(frame)
}

/// Where the frames of a document are, by their pictures.
struct Places {
    files: BTreeMap<PathBuf, usize>,
    /// None for a name that several frames have.
    stems: BTreeMap<String, Option<usize>>,
    numbers: BTreeMap<u64, Option<usize>>,
}

fn file_of(frame: &Frame, folder: &Path) -> Option<PathBuf> {
    frame.image.as_ref().map(|image| resolved(&folder.join(image)))
}

fn stem_of(frame: &Frame) -> Option<String> {
    let image = frame.image.as_deref()?.replace('\\', "/");
    Some(Path::new(&image).file_stem()?.to_string_lossy().into_owned())
}

impl Places {
    fn of(open: DocumentAt<'_>) -> Self {
        let mut places = Self { files: BTreeMap::new(), stems: BTreeMap::new(), numbers: BTreeMap::new() };
        for (place, frame) in open.document.frames.iter().enumerate() {
            if let Some(file) = file_of(frame, open.folder) {
                places.files.insert(file, place);
            }
            if let Some(stem) = stem_of(frame) {
                places.stems.entry(stem).and_modify(|known| *known = None).or_insert(Some(place));
            }
            if let Some(video) = &frame.video {
                places.numbers.entry(video.frame_index).and_modify(|known| *known = None).or_insert(Some(place));
            }
        }
        places
    }

    fn of_frame(&self, frame: &Frame, folder: &Path) -> Option<usize> {
        let by_file = file_of(frame, folder).and_then(|file| self.files.get(&file).copied());
        let by_stem = || self.stems.get(&stem_of(frame)?).copied().flatten();
        let by_number = || self.numbers.get(&frame.video.as_ref()?.frame_index).copied().flatten();
        by_file.or_else(by_stem).or_else(by_number)
    }
}

/// The cameras that came with the imported frames, by their names there.
struct Cameras {
    ids: BTreeMap<CameraId, CameraId>,
}

impl Cameras {
    /// A camera of the imported document: one of the document with the same base, else a new one.
    fn imported(&mut self, name: &CameraId, document: &mut Document, imported: &Imported) -> CameraId {
        if let Some(known) = self.ids.get(name) {
            return known.clone();
        }
        let Some(camera) = imported.document.camera(name) else { return name.clone() };
        let same = document.cameras.iter().find(|known| known.base() == camera.base() && known.base().is_some());
        let id = if let Some(known) = same {
            known.id.clone()
        } else {
            let id = free_id(document, name);
            document.cameras.push(Camera { id: id.clone(), ..camera.clone() }.into());
            id
        };
        self.ids.insert(name.clone(), id.clone());
        id
    }

    /// The camera of the document that takes pictures of a frame's size, else the frame's own.
    fn of_size(&mut self, frame: &Frame, document: &mut Document, imported: &Imported) -> CameraId {
        let is_alike = |size: ImageSize| size == frame.image_size;
        let alike = document.cameras.iter().find(|camera| is_alike(camera.image_size)).map(|camera| camera.id.clone());
        alike.unwrap_or_else(|| self.imported(&frame.camera, document, imported))
    }
}

/// The first of `name`, `name-2`, … that no camera has.
fn free_id(document: &Document, name: &CameraId) -> CameraId {
    let numbered = (1..).map(|number| if number == 1 { name.to_string() } else { format!("{name}-{number}") });
    let mut ids = numbered.map(|id| CameraId::from(id.as_str()));
    ids.find(|id| document.camera(id).is_none()).unwrap_or_else(|| name.clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Click, FieldSpec};
    use crate::exchange::tests::{SIZE, awkward};
    use crate::geometry::ImagePoint;

    fn click(name: &str) -> Click {
        Click::landmark(name.into(), ImagePoint::new(100.0, 200.0))
    }

    /// Frames 0001 to 0004: new, clicked, rejected, new; no base.
    fn open() -> Document {
        let mut document = Document::new(FieldSpec::new("soccer"));
        document.cameras.push(Camera::new("main".into(), SIZE).into());
        for index in 1..=4 {
            document.frames.push(Frame::from_image(&format!("images/{index:04}.jpg"), "main".into(), SIZE).into());
        }
        document.frames[1].clicks = vec![click("centre_mark")];
        document.frames[1].status = FrameStatus::Draft;
        document.frames[2].status = FrameStatus::Rejected;
        document
    }

    fn imported(document: Document, folder: &str) -> Imported {
        Imported { document, folder: PathBuf::from(folder), notes: vec!["said".to_owned()] }
    }

    #[test]
    fn clicks_come_to_frames_that_have_none_and_nothing_of_a_persons_changes() {
        let mut foreign = open();
        foreign.cameras[0].id = "other".into();
        for frame in &mut foreign.frames {
            frame.camera = "other".into();
            frame.status = FrameStatus::Draft;
            frame.clicks = vec![click("halfway_far"), click("halfway_near")];
        }
        foreign.frames.push(Frame::from_image("images/0009.jpg", "other".into(), SIZE).into());
        let (mine, joined) = (open(), join(open().at(Path::new("/match")), &imported(foreign, "/match")));
        assert_eq!((joined.matched, joined.kept, joined.added, joined.clicks, joined.cameras), (2, 2, 1, 4, 0));
        assert_eq!((&joined.document.frames[1], &joined.document.frames[2]), (&mine.frames[1], &mine.frames[2]));
        assert_eq!(joined.document.frames[0].status, FrameStatus::Draft);
        assert_eq!(joined.document.frames[4].camera, "main".into(), "of the same picture size");
        assert_eq!(joined.notes, ["said"]);
    }

    #[test]
    fn cameras_come_with_their_bases_to_frames_that_nobody_decided_on() {
        let joined = join(open().at(Path::new("/match")), &imported(awkward(), "/elsewhere"));
        assert_eq!((joined.matched, joined.kept, joined.added, joined.cameras), (2, 2, 8, 1), "by their names");
        let frame = &joined.document.frames[0];
        assert_eq!((frame.camera.as_str(), frame.status), ("main-2", FrameStatus::Suggested));
        let there = awkward();
        let point = crate::geometry::Vec3::new(3.0, 4.0, 0.0);
        let shown =
            |document: &Document| document.pointed(&document.frames[0]).unwrap().image_from_world(point).unwrap();
        assert_eq!(shown(&joined.document), shown(&there));
        assert_eq!(joined.document.frames[4].image.as_deref(), Some("../elsewhere/images/0005.jpg"));
        let again = join(joined.document.at(Path::new("/match")), &imported(awkward(), "/elsewhere"));
        assert_eq!((again.cameras, again.added), (0, 0), "a base that is there is not added twice");
    }

    #[test]
    fn pictures_of_another_size_are_counted_and_left() {
        let mut foreign = open();
        foreign.frames[0].image_size = ImageSize::new(960, 540);
        foreign.frames[0].clicks = vec![click("halfway_far")];
        let joined = join(open().at(Path::new("/match")), &imported(foreign, "/match"));
        assert_eq!((joined.other_size, joined.matched), (1, 0));
    }
}
