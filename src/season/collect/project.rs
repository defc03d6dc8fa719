//! The project of one match from its parts.
//!
//! 1. The part of the find shard gives cameras and field, and of a match with a project all of the
//!    project's frames. The parts of label shards give the frames of their windows.
//! 2. If the season was collected before, the project of then is the one that stays: new frames are
//!    put between its own, and frames without a person's work take the suggestions of the parts.

use super::record::Record;
use super::{CollectError, CollectEvent};
use crate::part::{Part, PartError};
use crate::plan::{LabelShard, PlannedMatch, path_in_plan};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use touchline_core::files::folder_of;
use touchline_core::progress::Progress;
use touchline_documents::document::{
    Camera, CameraId, Document, Frame, FrameId, Frames, History, Shared, Suggestion, resolve_path,
};
use touchline_documents::store::{
    Access, Location, Opened, PROJECT_FILE, open, read, write_document,
};

/// A match whose parts are to be collected.
pub(super) struct MatchToCollect<'a> {
    pub(super) plan_path: &'a Path,
    pub(super) of_match: &'a PlannedMatch,
    pub(super) parts: &'a Path,
    pub(super) output: &'a Path,
    /// The name of its folder in there.
    pub(super) folder: &'a str,
}

/// What was collected of a match.
#[derive(Default)]
pub(super) struct CollectedMatch {
    /// Its project; none if there is none yet.
    pub(super) document: Option<Document>,
    /// Why no camera, or no forest, was found.
    pub(super) reason: Option<String>,
    /// Number of shards without a whole part.
    pub(super) gaps: usize,
    /// Whether its project was left as it is.
    pub(super) is_left_alone: bool,
}

impl MatchToCollect<'_> {
    /// Collects the parts of the match and writes its project, unless it is as it should be.
    pub(super) fn collect(
        &self,
        record: &mut Record,
        progress: &Progress<'_, CollectEvent>,
    ) -> Result<CollectedMatch, CollectError> {
        let name = &self.of_match.name;
        let mut collected = CollectedMatch::default();
        let folder = self.output.join(self.folder);
        let is_there = folder.join(PROJECT_FILE).exists();
        let found = match Part::read(self.parts, &self.of_match.find) {
            Ok(found) => found,
            Err(why) => {
                // Frames without cameras are of no use, so the whole match is one gap. What was
                // collected of it earlier stays and is counted.
                collected.gaps = 1 + self.of_match.labels.len();
                let what = format!("no cameras and no frames: {why}");
                let _ = progress.report(CollectEvent::Gap {
                    name: name.clone(),
                    what,
                });
                if is_there {
                    collected.document = Some(read(&folder)?.1);
                }
                return Ok(collected);
            }
        };
        collected.reason.clone_from(&found.about.reason);
        let labelled = self.read_windows(&mut collected.gaps, progress);
        // Without a project the find shard's frames are those of windows, and come with these.
        let mut made = found.document;
        if self.of_match.project.is_none() {
            made.frames = Frames::new();
        }
        made.frames = merge_frames(&made.frames, &labelled);
        // The empty name ends the path in a separator, by which a folder is meant that need not
        // exist yet.
        let location = Location::for_new_document(&folder.join(""))?;
        let made = made.relocate(&self.source_folder(), location.folder());
        if !is_there {
            record.remember(self.folder, self.of_match);
            record.announce(self.output, self.folder, &made)?;
            write_document(&location, &made, false)?;
            record.confirm(self.folder, &made);
            collected.document = Some(made);
            return Ok(collected);
        }
        let before = open(&folder)?;
        let (document, left) = self.bring_up_to_date(before, made, record)?;
        collected.is_left_alone = left.is_some();
        if let Some(why) = left {
            let name = name.clone();
            let _ = progress.report(CollectEvent::LeftAlone { name, why });
        }
        collected.document = Some(document);
        Ok(collected)
    }

    /// The frames of all windows that have a whole part. Neighbouring windows without one are
    /// reported as one gap.
    fn read_windows(
        &self,
        gaps: &mut usize,
        progress: &Progress<'_, CollectEvent>,
    ) -> Vec<Shared<Frame>> {
        let mut frames = Vec::new();
        let mut gap: Option<Gap<'_>> = None;
        for label in &self.of_match.labels {
            // A window that is there ends the gap before it, which is then reported.
            let why = match Part::read(self.parts, &label.shard) {
                Ok(part) => {
                    frames.extend(part.document.frames.iter().cloned());
                    self.report_gap(gap.take(), progress);
                    continue;
                }
                Err(why) => why,
            };
            *gaps += 1;
            match &mut gap {
                // Parts that are not there yet are one gap; each that is not whole is its own.
                Some(open) if open.is_missing && is_missing(&why) => {
                    open.last = label;
                    open.shards += 1;
                }
                _ => {
                    let next = Gap::begin(label, &why);
                    self.report_gap(gap.replace(next), progress);
                }
            }
        }
        self.report_gap(gap, progress);
        frames
    }

    /// Brings a project that was collected before up to date and writes it. Returns the project,
    /// and why it was left as it is, if it was.
    fn bring_up_to_date(
        &self,
        before: Opened,
        made: Document,
        record: &mut Record,
    ) -> Result<(Document, Option<String>), CollectError> {
        let Opened {
            document,
            history,
            access,
            ..
        } = before;
        // The lock of the store keeps the window out until the project is written.
        let mut store = match access {
            Access::Writable(store) => store,
            Access::ReadOnly(reason) => return Ok((document, Some(format!("it is {reason}")))),
        };
        let is_video = made.frames.iter().any(|frame| frame.video.is_some());
        let foreign = record.why_foreign(self.folder, self.of_match, is_video);
        if let Some(why) = foreign.or_else(|| why_other_pictures(&document, &made)) {
            return Ok((document, Some(why)));
        }
        let (updated, history) = match camera_with_other_base(&document, &made) {
            None => merge_parts(&document, history, &made),
            // No person has worked with the other base, or without one.
            Some(_) if history.is_empty() && record.is_untouched(&document) => (made, history),
            Some(camera) => {
                let base = document.camera(&camera).and_then(Camera::base);
                let base = base.map_or("no base, unlike", |_| "another base than");
                let why = format!(
                    "camera {} has {base} in the parts; move its folder away to collect it anew",
                    camera.as_str()
                );
                return Ok((document, Some(why)));
            }
        };
        record.remember(self.folder, self.of_match);
        if updated != document {
            // Only a project that no person has worked in is untouched afterwards.
            let is_untouched = record.is_untouched(&document);
            if is_untouched {
                record.announce(self.output, self.folder, &updated)?;
            }
            store.save(&updated, &history)?;
            if is_untouched {
                record.confirm(self.folder, &updated);
            }
        }
        Ok((updated, None))
    }

    fn report_gap(&self, gap: Option<Gap<'_>>, progress: &Progress<'_, CollectEvent>) {
        let Some(gap) = gap else { return };
        let others = match gap.shards {
            1 => String::new(),
            shards => format!(" and of {} shards after it", shards - 1),
        };
        let (first, last) = (gap.first.first, gap.last.last);
        let what = format!("frames {first} to {last}: {}{others}", gap.why);
        let name = self.of_match.name.clone();
        let _ = progress.report(CollectEvent::Gap { name, what });
    }

    /// The folder that the paths in parts begin at. The frames themselves need not be there.
    fn source_folder(&self) -> PathBuf {
        let frames = resolve_path(&path_in_plan(self.plan_path, &self.of_match.frames));
        folder_of(&frames).to_path_buf()
    }
}

/// Windows beside each other that have no whole part.
struct Gap<'a> {
    first: &'a LabelShard,
    last: &'a LabelShard,
    shards: usize,
    why: String,
    is_missing: bool,
}

impl<'a> Gap<'a> {
    fn begin(label: &'a LabelShard, why: &PartError) -> Self {
        Self {
            first: label,
            last: label,
            shards: 1,
            why: why.to_string(),
            is_missing: is_missing(why),
        }
    }
}

const fn is_missing(why: &PartError) -> bool {
    matches!(why, PartError::Missing { .. })
}

/// A project with the frames of the parts. Collecting is no step of a person: it happened before all
/// of them, so that undoing one leads to a state that has the new frames, too.
fn merge_parts(
    document: &Document,
    mut history: History<Document>,
    made: &Document,
) -> (Document, History<Document>) {
    let labelled: Vec<Shared<Frame>> = made.frames.iter().cloned().collect();
    let with_parts = |state: &Document| Document {
        frames: merge_frames(&state.frames, &labelled),
        ..state.clone()
    };
    let updated = with_parts(document);
    if updated != *document && !history.is_empty() {
        // Steps hold the work of people alone, without suggestions; states share their frames.
        let edited = updated.without_suggestions();
        history.update_states(|state| {
            let mut state = with_parts(state).without_suggestions();
            for frame in &mut state.frames {
                if let Some(known) = edited
                    .frames
                    .by_id(&frame.id)
                    .filter(|known| *known == frame)
                {
                    *frame = known.clone();
                }
            }
            state
        });
    }
    (updated, history)
}

/// Why the frames of a project are not those of the parts, although they have the same names; none
/// if no hash contradicts.
fn why_other_pictures(document: &Document, made: &Document) -> Option<String> {
    let other = made.frames.iter().find(|frame| {
        document.frames.by_id(&frame.id).is_some_and(|known| {
            let hashes = known.sha256.as_ref().zip(frame.sha256.as_ref());
            let videos = known.video.as_ref().zip(frame.video.as_ref());
            hashes.is_some_and(|(known, now)| known != now)
                || videos.is_some_and(|(known, now)| known.is_of_other_file(now.file_id.as_deref()))
        })
    })?;
    Some(format!(
        "{} is another picture than when it was collected; move its folder away to collect it anew",
        other.name()
    ))
}

/// A camera of the parts that has another base in the project, or none there: cameras of frames in
/// one mean something else in the other.
fn camera_with_other_base(document: &Document, made: &Document) -> Option<CameraId> {
    made.cameras
        .iter()
        .find(|camera| document.camera(&camera.id).and_then(Camera::base) != camera.base())
        .map(|camera| camera.id.clone())
}

/// The frames of a project with those of the parts, which are in the order of time: frames of both
/// are updated, new ones come after the frame before them.
fn merge_frames(project: &Frames, labelled: &[Shared<Frame>]) -> Frames {
    // A merge of two sorted lists in one pass: `next` is the first frame of the project that is not
    // in its place yet.
    let in_parts: BTreeSet<&FrameId> = labelled.iter().map(|frame| &frame.id).collect();
    let mut merged = Vec::with_capacity(project.len().max(labelled.len()));
    let mut next = 0;
    for frame in labelled {
        let Some(position) = project.position_of(&frame.id) else {
            merged.push(frame.clone());
            continue;
        };
        // Frames of the project alone keep their place before the next common one.
        while next < position {
            if !in_parts.contains(&project[next].id) {
                merged.push(project[next].clone());
            }
            next += 1;
        }
        merged.push(update_by_part(&project[position], frame));
    }
    let rest = project.iter().skip(next);
    merged.extend(rest.filter(|frame| !in_parts.contains(&frame.id)).cloned());
    merged.into_iter().collect()
}

/// A frame of a project with the suggestion of a part, or with what a person did since in the
/// match's own project; as it is where a person has worked on it, or where it is another camera's.
fn update_by_part(frame: &Shared<Frame>, part: &Shared<Frame>) -> Shared<Frame> {
    let is_free = frame.shows_suggestion() || frame.is_untouched();
    if !is_free || frame.camera != part.camera {
        return frame.clone();
    }
    // A part without a suggestion takes the old one away: the newest parts count. An equal frame
    // keeps its handle, so that a project without news is not written again.
    let mut updated = frame.without_suggestion();
    if let Some(suggestion) = Suggestion::in_frame(part, None) {
        suggestion.show_in(&mut updated);
    } else if !part.is_untouched() {
        updated = take_label(&updated, part);
    }
    take_notes(&mut updated, part);
    if updated == **frame {
        return frame.clone();
    }
    updated.into()
}

/// What a person did in the same frame of another document, as a whole, for a frame that has notes
/// at most. The frame keeps its picture and shot.
fn take_label(frame: &Frame, labelled: &Frame) -> Frame {
    let (clip, sha256) = (frame.clip.as_ref(), frame.sha256.as_ref());
    Frame {
        id: frame.id.clone(),
        revision: frame.revision.max(labelled.revision),
        image: frame.image.clone(),
        video: frame.video.clone(),
        sha256: sha256.or(labelled.sha256.as_ref()).cloned(),
        clip: clip.or(labelled.clip.as_ref()).cloned(),
        // What was noted here stays; the caller adds what was noted there.
        comment: frame.comment.clone(),
        masks: frame.masks.clone(),
        repeats: frame.repeats.clone(),
        use_for_base: frame.use_for_base,
        use_for_training: frame.use_for_training,
        gold: frame.gold,
        ..labelled.clone()
    }
}

/// Adds the notes of a person from the same frame of another document, where there are none.
fn take_notes(frame: &mut Frame, noted: &Frame) {
    if frame.comment.is_none() {
        frame.comment.clone_from(&noted.comment);
    }
    if frame.masks.is_empty() {
        frame.masks.clone_from(&noted.masks);
    }
    if frame.repeats.is_empty() {
        frame.repeats.clone_from(&noted.repeats);
    }
    if uses(frame) == NO_CHOICE {
        (frame.use_for_base, frame.use_for_training, frame.gold) = uses(noted);
    }
}

/// What a frame is used for: its camera's base, training, blind clicks.
const fn uses(frame: &Frame) -> (bool, Option<bool>, bool) {
    (frame.use_for_base, frame.use_for_training, frame.gold)
}

/// The uses of a frame for which a person chose none.
const NO_CHOICE: (bool, Option<bool>, bool) = (true, None, false);

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::Ptz;
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::pixel_box;
    use touchline_documents::document::{FramePtz, FrameStatus, Step};
    use touchline_documents::testing::new_frame;

    fn frame(name: &str, pan_deg: Option<f64>, status: FrameStatus) -> Shared<Frame> {
        let mut frame = new_frame(name, ImageSize::new(64, 36));
        let ptz = |pan_deg| FramePtz::new(Ptz::from_degrees(pan_deg, -9.0, 900.0), None);
        frame.ptz = pan_deg.map(ptz);
        frame.status = status;
        frame.into()
    }

    #[test]
    fn frames_of_parts_come_between_those_of_the_project_and_peoples_work_stays() {
        use FrameStatus::{New, Reference, Rejected, Suggested};
        let project: Frames = [
            frame("a", None, New),
            frame("own", None, New),
            frame("c", Some(1.0), Reference),
            frame("d", Some(1.0), Suggested),
            frame("e", None, Rejected),
            frame("last", None, New),
        ]
        .into_iter()
        .collect();
        let labelled = ["a", "b", "c", "d", "e"].map(|name| frame(name, Some(2.0), Suggested));
        let merged = merge_frames(&project, &labelled);
        let shown = |frame: &Shared<Frame>| {
            let pan_deg = frame.ptz.as_ref().map(|ptz| ptz.pan_deg);
            (frame.image.clone().unwrap(), pan_deg)
        };
        let found: Vec<_> = merged.iter().map(shown).collect();
        let wanted = [
            ("a", Some(2.0)),
            ("b", Some(2.0)),
            ("own", None),
            ("c", Some(1.0)),
            ("d", Some(2.0)),
            ("e", None),
            ("last", None),
        ];
        let wanted: Vec<_> = wanted
            .map(|(name, pan_deg)| (name.to_owned(), pan_deg))
            .to_vec();
        assert_eq!(found, wanted);
        let again = merge_frames(&merged, &labelled);
        assert_eq!(again, merged, "nothing changes the second time");
    }

    #[test]
    fn what_a_person_did_since_in_the_matchs_own_project_takes_the_suggestions_place() {
        use FrameStatus::{New, Reference, Rejected, Suggested};
        let project: Frames = [
            frame("a", Some(1.0), Suggested),
            frame("b", None, New),
            frame("c", Some(1.0), Suggested),
        ]
        .into_iter()
        .collect();
        let labelled = [
            frame("a", Some(2.0), Reference),
            frame("b", None, Rejected),
            frame("c", None, New),
        ];
        let merged = merge_frames(&project, &labelled);
        let found: Vec<_> = merged
            .iter()
            .map(|frame| (frame.status, frame.ptz.as_ref().map(|ptz| ptz.pan_deg)))
            .collect();
        assert_eq!(
            found,
            [(Reference, Some(2.0)), (Rejected, None), (New, None)]
        );
    }

    #[test]
    fn a_label_is_taken_with_all_that_was_noted_beside_it() {
        let project: Frames = [
            frame("a", Some(1.0), FrameStatus::Suggested),
            frame("b", Some(1.0), FrameStatus::Suggested),
        ]
        .into_iter()
        .collect();
        let noted = |name: &str, status| {
            let mut noted = (*frame(name, Some(2.0), status)).clone();
            noted.comment = Some("left post only".to_owned());
            noted.masks = vec![pixel_box(1.0, 2.0, 3.0, 4.0)];
            (noted.use_for_base, noted.use_for_training, noted.gold) = (false, Some(false), true);
            Shared::from(noted)
        };
        let mut own = project.clone();
        own[1].comment = Some("of this project".to_owned());
        let labelled = [
            noted("a", FrameStatus::Reference),
            noted("b", FrameStatus::Suggested),
        ];
        let merged = merge_frames(&own, &labelled);
        assert_eq!(merged[0], labelled[0]);
        assert_eq!(merged[1].comment.as_deref(), Some("of this project"));
        assert_eq!(
            (merged[1].masks.len(), uses(&merged[1])),
            (1, (false, Some(false), true))
        );
    }

    #[test]
    fn undo_after_collecting_again_leads_to_a_state_with_the_new_frames() {
        let mut document = Document::new(touchline_documents::document::FieldSpec::new("soccer"));
        document
            .frames
            .push(frame("a", Some(1.0), FrameStatus::Suggested));
        let mut edited = document.without_suggestions();
        let mut history = History::default();
        history.begin(&edited, Step::on_document("Reject"));
        edited.frames[0].status = FrameStatus::Rejected;
        history.commit(&edited);
        document.frames[0] = edited.frames[0].clone();
        let mut made = document.clone();
        made.frames = ["a", "b"]
            .map(|name| frame(name, Some(2.0), FrameStatus::Suggested))
            .into_iter()
            .collect();
        let (updated, mut history) = merge_parts(&document, history, &made);
        assert_eq!(updated.frames.len(), 2);
        assert_eq!(updated.frames[0].status, FrameStatus::Rejected);
        let mut undone = updated.without_suggestions();
        assert!(history.undo(&mut undone).is_some());
        assert_eq!(
            (undone.frames.len(), undone.frames[0].status),
            (2, FrameStatus::New)
        );
    }
}
