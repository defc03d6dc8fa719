//! The common base of two versions of a document, where one of them may come from an earlier state
//! than the other.

use crate::document::{Document, Frame, FrameId, Shared};

/// The latest state from which both a session and another program's version can have started,
/// without suggestions, frame by frame and camera by camera.
///
/// `opened` is the file as the session opened it, `written` as the session last wrote it, `theirs`
/// as another program replaced it. A sync client or git may have made `theirs` from either, or from
/// a state before both. Frames that the session wrote and that `theirs` lacks were then not removed
/// by the other program:
///
/// | theirs is | the common state is |
/// |---|---|
/// | what was written | what was written |
/// | no earlier than what was opened, by its revision | what was opened |
/// | earlier than what was opened | none: whatever differs is named, and ours stays |
pub(crate) fn common_base(opened: &Document, written: &Document, theirs: &Document) -> Document {
    let [opened, written, theirs] = [opened, written, theirs].map(Document::without_suggestions);
    let mut base = opened.clone();
    base.frames = common_frames(&opened, &written, &theirs)
        .into_iter()
        .collect();
    // What `theirs` has as the session wrote it is common; otherwise the opened state is the base.
    if theirs.field == written.field {
        base.field = written.field;
    }
    if theirs.click_noise == written.click_noise {
        base.click_noise = written.click_noise;
    }
    if theirs.shots == written.shots {
        base.shots = written.shots;
    }
    if theirs.conventions == written.conventions {
        base.conventions = written.conventions;
    }
    if theirs.extra == written.extra {
        base.extra = written.extra;
    }
    let common = written
        .cameras
        .iter()
        .filter(|camera| theirs.camera(&camera.id) == Some(&***camera));
    for camera in common {
        match base.cameras.iter_mut().find(|known| known.id == camera.id) {
            Some(known) => known.clone_from(camera),
            None => base.cameras.push(camera.clone()),
        }
    }
    base
}

fn common_frames(opened: &Document, written: &Document, theirs: &Document) -> Vec<Shared<Frame>> {
    let added = written
        .frames
        .iter()
        .filter(|frame| opened.frames.by_id(&frame.id).is_none());
    let frames = opened.frames.iter().chain(added);
    frames
        .filter_map(|frame| common_frame(&frame.id, [opened, written, theirs]))
        .cloned()
        .collect()
}

fn common_frame<'a>(
    id: &FrameId,
    [opened, written, theirs]: [&'a Document; 3],
) -> Option<&'a Shared<Frame>> {
    let (opened, written) = (opened.frames.by_id(id), written.frames.by_id(id));
    // Only a frame that was opened can have been removed by the other program. One that the session
    // added was never in its version.
    let Some(theirs) = theirs.frames.by_id(id) else {
        return opened;
    };
    // A base of `None` makes the merge name the frame if both sides differ.
    match (opened, written) {
        (_, Some(written)) if theirs.has_content_of(written) => Some(written),
        (Some(opened), _) if theirs.revision >= opened.revision => Some(opened),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Merged, merge};
    use crate::testing::{new_frame, soccer_document};
    use touchline_core::geometry::ImageSize;

    fn document(comments: &[&str]) -> Document {
        let mut document = soccer_document();
        for (index, comment) in comments.iter().enumerate() {
            let mut frame = new_frame(&index.to_string(), ImageSize::new(64, 48));
            frame.comment = Some((*comment).to_owned());
            document.frames.push(frame.into());
        }
        document
    }

    fn edited(document: &Document, frame: usize, comment: &str) -> Document {
        let mut edited = document.clone();
        edited.frames[frame].comment = Some(comment.to_owned());
        edited.frames[frame].revision += 1;
        edited
    }

    fn comments(document: &Document) -> Vec<&str> {
        document
            .frames
            .iter()
            .filter_map(|frame| frame.comment.as_deref())
            .collect()
    }

    fn merged(opened: &Document, written: &Document, theirs: &Document) -> Merged {
        merge(&common_base(opened, written, theirs), written, theirs)
    }

    #[test]
    fn what_was_saved_in_the_session_is_not_removed_by_an_earlier_state() {
        let opened = document(&["", ""]);
        let written = edited(&opened, 0, "ours");
        let Merged {
            document,
            conflicts,
        } = merged(&opened, &written, &edited(&opened, 1, "theirs"));
        assert_eq!(
            (comments(&document), conflicts.len()),
            (vec!["ours", "theirs"], 0)
        );
        let Merged {
            document,
            conflicts,
        } = merged(&opened, &written, &edited(&opened, 0, "theirs"));
        assert_eq!(
            (comments(&document), &conflicts[..]),
            (vec!["ours", ""], &["0".to_owned()][..])
        );
    }

    #[test]
    fn what_others_made_of_what_was_written_is_taken() {
        let opened = document(&["", ""]);
        let written = edited(&opened, 0, "ours");
        let theirs = edited(&written, 1, "theirs");
        assert_eq!(
            comments(&merged(&opened, &written, &theirs).document),
            ["ours", "theirs"]
        );
        let mut added = written.clone();
        added
            .frames
            .push(new_frame("new", ImageSize::new(64, 48)).into());
        assert_eq!(
            merged(&opened, &added, &theirs).document.frames.len(),
            3,
            "they never had it"
        );
        let mut fewer = theirs;
        fewer.frames.remove(1);
        assert_eq!(
            merged(&opened, &written, &fewer).document.frames.len(),
            1,
            "they removed it"
        );
    }

    #[test]
    fn a_state_before_the_session_takes_nothing_away_unnamed() {
        let before = document(&["", ""]);
        let opened = edited(&before, 0, "of an earlier session");
        let Merged {
            document,
            conflicts,
        } = merged(&opened, &opened, &edited(&before, 1, "theirs"));
        assert_eq!(
            (comments(&document), &conflicts[..]),
            (
                vec!["of an earlier session", "theirs"],
                &["0".to_owned()][..]
            )
        );
    }
}
