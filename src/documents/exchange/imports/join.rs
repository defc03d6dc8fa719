//! Joins imported labels with an open document. The user's work in that document is never changed.
//! Frames without pictures of their own are first attached to the document's only video.

use super::attach::{Attachment, NotAttached, plan_attachment};
use super::imported::Imported;
use super::places::Places;
use crate::document::{Camera, CameraId, Document, DocumentAt, FieldSpec, Frame, FrameStatus};
use std::collections::BTreeMap;
use touchline_core::geometry::ImageSize;

/// A document with imported labels, and counts of what was joined.
#[derive(Clone, Debug, PartialEq)]
pub struct JoinedImport {
    /// The document.
    pub document: Document,
    /// Frames of the document that got clicks or a camera.
    pub matched: usize,
    /// The pairs of an imported frame and a frame of the document, with or without new labels.
    pub pairs: Vec<JoinedPair>,
    /// Frames that were not in the document.
    pub added: usize,
    /// Frames whose own labels were kept.
    pub kept: usize,
    /// Frames whose picture has another size in the document.
    pub other_size: usize,
    /// Clicks that were added.
    pub clicks: usize,
    /// Cameras that were added.
    pub cameras: usize,
    /// How frames without pictures of their own were attached to the document's only video, or why
    /// they were not; none where there is nothing to attach.
    pub attachment: Result<Option<Attachment>, NotAttached>,
    /// What a user should know.
    pub notes: Vec<String>,
    /// What could not be read of the imported files.
    pub failures: Vec<String>,
}

/// An imported frame and the frame of the document that shows the same picture, by name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JoinedPair {
    /// The imported frame.
    pub imported: String,
    /// The document's.
    pub document: String,
}

/// Joins imported frames with those of a document that show the same pictures (`Places`). A frame
/// gets the imported clicks if it has none, and the imported camera if it has no click and no
/// decision of the user. Frames that are not in the document are appended.
///
/// Imported frames that have no pictures of their own are attached to the frames of the document's
/// only video in the most plausible way ([`plan_attachment`]); where none is plausible, a note says
/// why, and they are appended.
pub fn join(open: DocumentAt<'_>, imported: &Imported) -> JoinedImport {
    let attachment = plan_attachment(open, imported);
    // The most plausible way, which is the first; the window lets the user choose another one.
    let attached = attachment.as_ref().ok().and_then(|plan| {
        let plan = plan.as_ref()?;
        Some(plan.apply(imported, plan.candidates().first()?))
    });
    let imported = attached.as_ref().unwrap_or(imported);
    // Where numbers contradict the video, the same numbers must not find frames of it.
    let may_match = attachment.is_ok();
    let reason = attachment.as_ref().err().map(ToString::to_string);
    let mut joined = JoinedImport {
        document: open.document.clone(),
        matched: 0,
        pairs: Vec::new(),
        added: 0,
        kept: 0,
        other_size: 0,
        clicks: 0,
        cameras: 0,
        notes: imported.notes.iter().cloned().chain(reason).collect(),
        failures: imported.failures.clone(),
        attachment,
    };
    let places = Places::from_document(open);
    // The imported document with paths relative to the open document's folder.
    let moved = imported
        .document
        .clone()
        .relocate(&imported.folder, open.folder);
    let mut cameras = Cameras {
        imported: &moved,
        ids: BTreeMap::new(),
    };
    for (frame, moved) in imported.document.frames.iter().zip(&moved.frames) {
        let there = may_match
            .then(|| places.find(frame, &imported.folder))
            .flatten()
            .and_then(|place| Some((place, Frame::clone(joined.document.frames.get(place)?))));
        match there {
            // Clicks and cameras are in px of a picture of another size.
            Some((_, there)) if there.image_size != frame.image_size => joined.other_size += 1,
            Some((place, there)) => {
                joined.pairs.push(JoinedPair {
                    imported: frame.labels_name.clone().unwrap_or_else(|| frame.name()),
                    document: there.name(),
                });
                match label(there, frame, &mut joined.document, &mut cameras) {
                    Some(labelled) => {
                        joined.matched += 1;
                        joined.clicks += labelled.clicks.len();
                        if let Some(known) = joined.document.frames.get_mut(place) {
                            **known = labelled;
                        }
                    }
                    // A file that could not be read brings nothing.
                    None => joined.kept += usize::from(has_labels(frame)),
                }
            }
            None => {
                // A frame with a camera brings it; clicks alone join a camera of the document that
                // has their size and field.
                let camera = match frame.ptz {
                    Some(_) => cameras.take(&frame.camera, &mut joined.document),
                    None => cameras.take_of_size(frame, &mut joined.document),
                };
                joined.added += 1;
                joined.clicks += frame.clicks.len();
                joined.document.frames.push(
                    Frame {
                        camera,
                        ..(**moved).clone()
                    }
                    .into(),
                );
            }
        }
    }
    joined.cameras = joined.document.cameras.len() - open.document.cameras.len();
    if joined.matched > 0 {
        share_cameras(&mut joined.document);
    }
    joined
}

/// Gives frames of a video whose camera has no base the camera of the nearest frame that is solved:
/// they are of one recording, and tracking can then fill them.
fn share_cameras(document: &mut Document) {
    let with_base: BTreeMap<CameraId, ImageSize> = document
        .cameras
        .iter()
        .filter(|camera| camera.base().is_some())
        .map(|camera| (camera.id.clone(), camera.image_size))
        .collect();
    // The frames of each video by their numbers, with their places in the document.
    let mut videos: BTreeMap<String, BTreeMap<u64, usize>> = BTreeMap::new();
    for (place, frame) in document.frames.iter().enumerate() {
        if let Some(video) = &frame.video {
            let numbers = videos.entry(video.path.clone()).or_default();
            numbers.insert(video.frame_index, place);
        }
    }
    for numbers in videos.values() {
        let solved: BTreeMap<u64, CameraId> = numbers
            .iter()
            .filter_map(|(number, place)| {
                let frame = document.frames.get(*place)?;
                let is_solved = frame.ptz.is_some() && with_base.contains_key(&frame.camera);
                is_solved.then(|| (*number, frame.camera.clone()))
            })
            .collect();
        for (number, place) in numbers {
            let Some(frame) = document.frames.get_mut(*place) else {
                continue;
            };
            if frame.ptz.is_some() || !frame.is_open() || with_base.contains_key(&frame.camera) {
                continue;
            }
            let before = solved.range(..number).next_back();
            let after = solved.range(number..).next();
            let nearest = before
                .into_iter()
                .chain(after)
                .min_by_key(|(other, _)| other.abs_diff(*number));
            if let Some((_, camera)) = nearest
                && with_base.get(camera) == Some(&frame.image_size)
            {
                frame.camera = camera.clone();
            }
        }
    }
}

/// Whether an imported frame has something that a frame of the document may get.
fn has_labels(imported: &Frame) -> bool {
    imported.ptz.is_some()
        || imported.lens.is_some()
        || !imported.clicks.is_empty()
        || !imported.masks.is_empty()
}

/// A frame with the labels of an imported one; none where its own labels are kept.
fn label(
    there: Frame,
    imported: &Frame,
    document: &mut Document,
    cameras: &mut Cameras<'_>,
) -> Option<Frame> {
    let mut frame = there;
    frame.labels_name = imported.labels_name.clone().or(frame.labels_name);
    // A camera is taken by a frame that a person has not touched, clicks by one that has none of
    // its own.
    let mut changed = false;
    let is_open = frame.is_open();
    if is_open && (imported.ptz.is_some() || imported.lens.is_some()) {
        frame.camera = cameras.take(&imported.camera, document);
        frame.lens = imported.lens.clone().or(frame.lens);
        changed = true;
    }
    if is_open && imported.ptz.is_some() {
        (frame.ptz, frame.solution) = (imported.ptz.clone(), imported.solution.clone());
        frame.status = FrameStatus::Suggested;
    }
    // A frame that a person accepted or rejected is decided.
    let is_undecided = matches!(
        frame.status,
        FrameStatus::New | FrameStatus::Draft | FrameStatus::Suggested
    );
    if !imported.clicks.is_empty() && frame.clicks.is_empty() && is_undecided {
        frame.clicks.clone_from(&imported.clicks);
        if imported.ptz.is_none() {
            // Points of a model are no person's work.
            frame.status = if frame.has_points_of_models_alone() {
                frame.undecided_status()
            } else {
                FrameStatus::Draft
            };
        }
        changed = true;
    }
    if !imported.masks.is_empty() && frame.masks.is_empty() {
        frame.masks.clone_from(&imported.masks);
        changed = true;
    }
    changed.then_some(frame)
}

/// The cameras of the imported frames, and their names in the open document.
struct Cameras<'a> {
    imported: &'a Document,
    /// Their names in the open document, by their names in the imported one.
    ids: BTreeMap<CameraId, CameraId>,
}

impl Cameras<'_> {
    /// The name of an imported camera in the open document: a camera with the same base and field,
    /// else a new one.
    fn take(&mut self, name: &CameraId, document: &mut Document) -> CameraId {
        if let Some(known) = self.ids.get(name) {
            return known.clone();
        }
        let Some(camera) = self.imported.camera(name) else {
            return name.clone();
        };
        let field = field_of(camera, self.imported);
        let same = document
            .cameras
            .iter()
            .find(|known| {
                // Cameras without a base are never the same: nothing says that they stand in one
                // place.
                known.base() == camera.base()
                    && known.base().is_some()
                    && field_of(known, document).is_same_field(field)
            })
            .map(|known| known.id.clone());
        let id = same.unwrap_or_else(|| {
            let id = free_id(document, name);
            // The camera keeps its own field, or the imported document's field if the open document
            // has another.
            let own = (camera.field.is_some() || *field != document.field).then(|| field.clone());
            document.cameras.push(
                Camera {
                    id: id.clone(),
                    field: own,
                    ..camera.clone()
                }
                .into(),
            );
            id
        });
        self.ids.insert(name.clone(), id.clone());
        id
    }

    /// The name of a camera of the open document with a frame's picture size and field, else of the
    /// frame's own camera.
    fn take_of_size(&mut self, frame: &Frame, document: &mut Document) -> CameraId {
        let field = self
            .imported
            .camera(&frame.camera)
            .map_or(&self.imported.field, |camera| {
                field_of(camera, self.imported)
            });
        let alike = document
            .cameras
            .iter()
            .find(|camera| {
                camera.image_size == frame.image_size
                    && field_of(camera, document).is_same_field(field)
            })
            .map(|camera| camera.id.clone());
        alike.unwrap_or_else(|| self.take(&frame.camera, document))
    }
}

/// The field of a camera: its own, else its document's.
fn field_of<'a>(camera: &'a Camera, document: &'a Document) -> &'a FieldSpec {
    camera.field.as_ref().unwrap_or(&document.field)
}

/// The name, if no camera has it, else the first of `main-2`, `main-3`, … that none has; `main-2`
/// counts on to `main-3`.
fn free_id(document: &Document, name: &CameraId) -> CameraId {
    let text = name.as_str();
    let numbered = text
        .rsplit_once('-')
        .and_then(|(stem, number)| Some((stem, number.parse::<u32>().ok()?)))
        .filter(|(stem, number)| *number >= 2 && !stem.is_empty());
    let (stem, from) = numbered.unwrap_or((text, 1));
    // There are more numbers than cameras, so that one is free.
    let further = (from.saturating_add(1)..).map(|number| format!("{stem}-{number}"));
    std::iter::once(text.to_owned())
        .chain(further)
        .map(|id| CameraId::from(id.as_str()))
        .find(|id| document.camera(id).is_none())
        .unwrap_or_else(|| name.clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Click, FieldSpec};
    use crate::exchange::Format;
    use crate::exchange::tests::{SIZE, awkward};
    use std::path::{Path, PathBuf};
    use touchline_core::geometry::{ImagePoint, ImageSize};

    fn click(name: &str) -> Click {
        Click::landmark(name.into(), ImagePoint::new(100.0, 200.0))
    }

    /// Frames 0001 to 0004: new, clicked, rejected, new; no base.
    fn open() -> Document {
        let mut document = Document::new(FieldSpec::new("soccer"));
        document
            .cameras
            .push(Camera::new("main".into(), SIZE).into());
        for index in 1..=4 {
            document.frames.push(
                Frame::from_image(&format!("images/{index:04}.jpg"), "main".into(), SIZE).into(),
            );
        }
        document.frames[1].clicks = vec![click("centre_mark")];
        document.frames[1].status = FrameStatus::Draft;
        document.frames[2].status = FrameStatus::Rejected;
        document
    }

    fn imported(document: Document, folder: &str) -> Imported {
        Imported {
            document,
            folder: PathBuf::from(folder),
            format: Format::Json,
            notes: vec!["said".to_owned()],
            failures: Vec::new(),
        }
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
        foreign
            .frames
            .push(Frame::from_image("images/0009.jpg", "other".into(), SIZE).into());
        let (mine, joined) = (
            open(),
            join(open().at(Path::new("/match")), &imported(foreign, "/match")),
        );
        assert_eq!(
            (
                joined.matched,
                joined.kept,
                joined.added,
                joined.clicks,
                joined.cameras
            ),
            (2, 2, 1, 4, 0)
        );
        assert_eq!(
            (&joined.document.frames[1], &joined.document.frames[2]),
            (&mine.frames[1], &mine.frames[2])
        );
        assert_eq!(joined.document.frames[0].status, FrameStatus::Draft);
        assert_eq!(
            joined.document.frames[4].camera,
            "main".into(),
            "of the same picture size"
        );
        assert_eq!(joined.notes, ["said"]);
    }

    #[test]
    fn cameras_come_with_their_bases_to_frames_without_a_decision_of_a_person() {
        let joined = join(
            open().at(Path::new("/match")),
            &imported(awkward(), "/elsewhere"),
        );
        assert_eq!(
            (joined.matched, joined.kept, joined.added, joined.cameras),
            (2, 2, 8, 1),
            "by their names"
        );
        let frame = &joined.document.frames[0];
        assert_eq!(
            (frame.camera.as_str(), frame.status),
            ("main-2", FrameStatus::Suggested)
        );
        let there = awkward();
        let point = touchline_core::geometry::Vec3::new(3.0, 4.0, 0.0);
        let shown = |document: &Document| {
            document
                .ptz_camera(&document.frames[0])
                .unwrap()
                .image_from_world(point)
                .unwrap()
        };
        assert_eq!(shown(&joined.document), shown(&there));
        assert_eq!(
            joined.document.frames[4].image.as_deref(),
            Some("../elsewhere/images/0005.jpg")
        );
        let field = joined.document.cameras[1].field.as_ref().unwrap();
        assert_eq!(
            (field.params["length_m"], field.params["width_m"]),
            (100.0, 64.0),
            "its field comes with it"
        );
        let videos = joined
            .document
            .frames
            .iter()
            .map(|frame| frame.video.as_ref().map(|video| video.path.as_str()));
        assert_eq!(
            videos.collect::<Vec<_>>()[3..5],
            [None, Some("../elsewhere/match.mp4")]
        );
        assert_eq!(joined.pairs.len(), 4);
        assert_eq!(joined.pairs[0].document, "images/0001.jpg");
        let again = join(
            joined.document.at(Path::new("/match")),
            &imported(awkward(), "/elsewhere"),
        );
        assert_eq!(
            (again.cameras, again.added),
            (0, 0),
            "a base that is there is not added twice"
        );
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
