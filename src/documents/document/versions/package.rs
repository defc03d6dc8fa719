//! Work packages: parts of a document that several people label, and that are joined again.
//!
//! A package is a document of some of the frames. It records what it was given
//! ([`PackageRecord`]), so that a frame that the user removed can be distinguished from one that
//! was never in it, and a change of the user from one of the owner. [`restore_package`] applies its
//! changes to the whole document; [`merge`](crate::document::merge) then joins the results.

use super::package_record::{KEY, PackageRecord};
use super::restored::{OtherPictures, Restored, has_other_picture};
use crate::document::{Document, Frame, FrameId, Frames, Shared, Shot, ShotEnd};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// The document in packages of `count` frames each, in its order; the last one may have fewer.
pub fn split_into_packages(document: &Document, count: usize) -> Vec<Document> {
    let count = count.max(1);
    (0..document.frames.len())
        .step_by(count)
        .map(|first| take_package(document, first..first.saturating_add(count)))
        .collect()
}

/// The document restricted to the frames at these positions, as far as there are any.
fn take_package(document: &Document, positions: Range<usize>) -> Document {
    // Only the package's own frames are visited: a long document has thousands of packages.
    let frames: Frames = document.frames.range(positions).cloned().collect();
    let mut package = Document {
        shots: shots_of(document, &frames),
        frames,
        ..document.clone()
    };
    let record = PackageRecord::to_json(&package);
    package.extra.insert(KEY.to_owned(), record);
    package
}

/// The shots of a document whose ends still have the same meaning with some of its frames.
fn shots_of(document: &Document, frames: &Frames) -> Vec<Shot> {
    document
        .shots
        .iter()
        .filter(|shot| {
            [&shot.from, &shot.to].into_iter().all(|end| match end {
                ShotEnd::Frame(id) => frames.by_id(id).is_some(),
                // A plain number refers to the first video of the document.
                ShotEnd::VideoFrame(_) => frames.first_video() == document.frames.first_video(),
            })
        })
        .cloned()
        .collect()
}

/// Another user's version of `base` as a whole document, with the picture paths of `base`, and the
/// state that both have in common. Frames that a package did not contain are taken from `base`. A
/// different picture path is not an edit, because a package has copies of the pictures.
///
/// # Errors
/// Most pictures are other ones: the version is of another match.
pub fn restore_package(base: &Document, version: &Document) -> Result<Restored, OtherPictures> {
    if let Some(others) = OtherPictures::find(base, version) {
        return Err(others);
    }
    // Pictures first, also of a version that is no package: otherwise each copied picture would
    // look like an edit. Frames with the same picture are not borrowed to be changed, so that
    // they stay shared.
    let mut whole = version.clone();
    let record = PackageRecord::read(version);
    for frame in &mut whole.frames {
        // A frame that was added to a package is of a picture there, whatever its id.
        let is_added = record
            .as_ref()
            .is_some_and(|record| !record.frames.contains(&frame.id));
        if let Some(known) = base
            .frames
            .by_id(&frame.id)
            .filter(|known| !is_added && !has_place_of(frame, known))
            // A video's identity lies with its path, so taking the path would hide another picture.
            .filter(|known| !has_other_picture(known, frame))
        {
            take_place(frame, known);
        }
    }
    let mut restored = Restored::new(base, whole);
    let Some(PackageRecord { frames, given }) = record else {
        restored.settle_by_revisions(base);
        restored.dispute_other_pictures();
        return Ok(restored);
    };
    // Where `base` is a package itself, its versions are that package again. Without the record,
    // the frames outside it would look removed when they are joined with the whole document.
    let extra = &mut restored.version.extra;
    match base.extra.get(KEY) {
        Some(record) => extra.insert(KEY.to_owned(), record.clone()),
        None => extra.shift_remove(KEY),
    };
    if let Some(given) = &given {
        restored.settle_frames(base, given);
    }
    restored.version.frames = join_frames(base, &restored.version.frames, &frames);
    // The package as it would be given away now: the shots that it had then show which of the
    // base's shots its present ones replace.
    let mut package = base.clone();
    package.frames.retain(|frame| frames.contains(&frame.id));
    package.shots = shots_of(base, &package.frames);
    restored.version.shots = join_shots(base, &package.shots, &version.shots);
    match &given {
        Some(given) => {
            restored.settle_parts(base, version, given);
            restored.settle_shots(base, &package, version, given);
        }
        None => restored.settle_by_revisions(base),
    }
    restored.dispute_other_pictures();
    Ok(restored)
}

fn has_place_of(frame: &Frame, known: &Frame) -> bool {
    (&frame.image, &frame.video) == (&known.image, &known.video)
}

fn take_place(frame: &mut Shared<Frame>, known: &Frame) {
    let frame: &mut Frame = frame;
    frame.image.clone_from(&known.image);
    frame.video.clone_from(&known.video);
}

/// The frames of `base`, with a package's initial frames replaced by its current ones. New frames
/// are inserted behind their predecessor in the package.
fn join_frames(base: &Document, package: &Frames, given: &BTreeSet<FrameId>) -> Frames {
    let mut after: BTreeMap<Option<FrameId>, Vec<Shared<Frame>>> = BTreeMap::new();
    // New frames at the beginning of the package are inserted before its first frame that still
    // exists.
    let first_given = base
        .frames
        .iter()
        .position(|frame| given.contains(&frame.id))
        .unwrap_or(0);
    let before = first_given
        .checked_sub(1)
        .and_then(|before| base.frames.get(before));
    let mut last = before.map(|frame| frame.id.clone());
    for frame in package {
        let is_in_base = base.frames.by_id(&frame.id).is_some();
        if is_in_base && given.contains(&frame.id) {
            last = Some(frame.id.clone());
            continue;
        }
        let mut new = frame.clone();
        // Ids follow from paths, so that a new frame may have the id of a frame that was never in
        // the package. Both are of their own work and stay.
        if is_in_base {
            new.id = new.id.clone().free(|id| {
                [&base.frames, package]
                    .iter()
                    .any(|frames| frames.by_id(id).is_some())
            });
        }
        after.entry(last.clone()).or_default().push(new);
    }
    // A frame that was given away comes from the package, or from nowhere if it was removed there.
    // All others come from the base.
    let mut joined: Vec<Shared<Frame>> = after.remove(&None).unwrap_or_default();
    for frame in &base.frames {
        let is_given = given.contains(&frame.id);
        joined.extend(
            package
                .by_id(&frame.id)
                .filter(|_| is_given)
                .or((!is_given).then_some(frame))
                .cloned(),
        );
        joined.extend(after.remove(&Some(frame.id.clone())).unwrap_or_default());
    }
    joined.into_iter().collect()
}

/// The shots of `base`, with a package's initial shots replaced by its current ones.
fn join_shots(base: &Document, given: &[Shot], now: &[Shot]) -> Vec<Shot> {
    if given == now {
        return base.shots.clone();
    }
    base.shots
        .iter()
        .filter(|shot| !given.contains(shot))
        .chain(now)
        .cloned()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Click, ShotKind, VideoFrame, merge};
    use crate::testing::{a_match, new_frame};
    use proptest::prelude::*;
    use touchline_core::geometry::{ImagePoint, ImageSize};

    const SIZE: ImageSize = ImageSize::new(64, 48);

    fn document(count: usize) -> Document {
        let mut document = a_match(SIZE);
        for index in 0..count {
            document
                .frames
                .push(new_frame(&format!("images/{index:03}.jpg"), SIZE).into());
        }
        for pair in document
            .frames
            .iter()
            .map(|frame| frame.id.clone())
            .collect::<Vec<_>>()
            .chunks_exact(2)
        {
            let [from, to] = [&pair[0], &pair[1]].map(|id| ShotEnd::Frame(id.clone()));
            let extra = crate::document::Extra::new();
            document.shots.push(Shot {
                from,
                to,
                camera: None,
                kind: ShotKind::Cut,
                content: None,
                extra,
            });
        }
        document
    }

    /// What a person does to a frame.
    #[derive(Clone, Debug)]
    enum Edit {
        Click(f64),
        Comment(u8),
        Remove,
        AddAfter(u8),
    }

    fn edit(document: &mut Document, index: usize, id: &FrameId, edit: &Edit) {
        let Some(position) = document.frames.position_of(id) else {
            return;
        };
        match edit {
            Edit::Click(x) => {
                let click = Click::landmark("centre_mark".into(), ImagePoint::new(*x, 3.0));
                document.frames[position].clicks.push(click);
            }
            Edit::Comment(number) => document.frames[position].comment = Some(number.to_string()),
            Edit::Remove => drop(document.frames.remove(position)),
            Edit::AddAfter(number) => {
                let name = format!("new/{index}-{number}.jpg");
                document
                    .frames
                    .insert(position + 1, new_frame(&name, SIZE).into());
            }
        }
    }

    fn edits() -> impl Strategy<Value = Edit> {
        prop_oneof![
            (0.0..64.0).prop_map(Edit::Click),
            any::<u8>().prop_map(Edit::Comment),
            Just(Edit::Remove),
            any::<u8>().prop_map(Edit::AddAfter),
        ]
    }

    proptest! {
        #[test]
        fn packages_that_were_edited_and_merged_are_the_document_with_the_same_edits(
            count in 1_usize..12,
            each in 1_usize..5,
            done in proptest::collection::vec((0_usize..12, edits()), 0..20),
        ) {
            let base = document(count);
            let (mut whole, mut packages) = (base.clone(), split_into_packages(&base, each));
            prop_assert_eq!(packages.len(), count.div_ceil(each));
            let ids: Vec<FrameId> = base.frames.iter().map(|frame| frame.id.clone()).collect();
            for (index, (at, what)) in done.iter().enumerate() {
                let id = &ids[at % count];
                edit(&mut whole, index, id, what);
                edit(&mut packages[(at % count) / each], index, id, what);
            }
            let mut merged = base.clone();
            for mut package in packages {
                for frame in package.frames.iter_mut().filter(|frame| frame.name().starts_with("images/")) {
                    frame.image = frame.image.as_ref().map(|image| image.replace("images/", "copies/"));
                }
                let restored = restore_package(&base, &package).unwrap();
                let joined = merge(&restored.common, &merged, &restored.version);
                prop_assert!(joined.conflicts.is_empty(), "{:?}", joined.conflicts);
                merged = joined.document;
            }
            prop_assert_eq!(merged, whole);
        }
    }

    #[test]
    fn a_new_frame_with_the_id_of_a_frame_outside_the_package_stays_beside_it() {
        let base = document(4);
        let mut package = split_into_packages(&base, 2).remove(0);
        let mut new = (*base.frames[3]).clone();
        new.image = Some("images/003-of-the-package.jpg".to_owned());
        new.comment = Some("new".to_owned());
        package.frames.push(new.into());
        let restored = restore_package(&base, &package).unwrap().version;
        assert_eq!(restored.frames.len(), 5);
        assert_eq!(restored.frames[4], base.frames[3]);
        let added = &restored.frames[2];
        assert_eq!(added.comment.as_deref(), Some("new"));
        assert_eq!(
            added.image.as_deref(),
            Some("images/003-of-the-package.jpg")
        );
    }

    #[test]
    fn parts_of_a_package_are_joined_to_that_package() {
        let base = document(6);
        let package = split_into_packages(&base, 4).remove(0);
        let parts = split_into_packages(&package, 2);
        let [first, second] =
            [0, 1].map(|part| restore_package(&package, &parts[part]).unwrap().version);
        let joined = merge(&package, &first, &second).document;
        assert_eq!(joined, package);
        assert_eq!(restore_package(&base, &joined).unwrap().version, base);
    }

    /// Frames of a video, in a package with a copy of it.
    fn base_and_package_of_video() -> (Document, Document) {
        let mut base = document(0);
        for index in 0..5 {
            let video = VideoFrame {
                file_id: Some("aa".into()),
                ..VideoFrame::new("match.mp4", index, None)
            };
            base.frames
                .push(Frame::from_video(video, "main".into(), SIZE).into());
        }
        let mut package = split_into_packages(&base, 5).remove(0);
        for frame in &mut package.frames {
            frame.video.as_mut().unwrap().path = "copies/match.mp4".to_owned();
        }
        (base, package)
    }

    #[test]
    fn a_copied_video_is_no_edit() {
        let (base, package) = base_and_package_of_video();
        let restored = restore_package(&base, &package).unwrap();
        assert_eq!(restored.version, base);
        assert_eq!(restored.common, base);
    }

    #[test]
    fn a_few_frames_of_another_video_are_conflicts() {
        let (base, mut package) = base_and_package_of_video();
        let replaced = [1, 3];
        for index in replaced {
            package.frames[index].video.as_mut().unwrap().file_id = Some("bb".into());
        }
        let restored = restore_package(&base, &package).unwrap();
        let merged = merge(&restored.common, &base, &restored.version);
        assert_eq!(merged.conflicts.len(), replaced.len());
        assert_eq!(merged.document, base, "the owner's pictures stay");
    }

    #[test]
    fn a_document_that_is_no_package_keeps_what_its_person_removed() {
        let base = document(3);
        let mut version = base.clone();
        version.frames.remove(1);
        version.frames[0].image = Some("elsewhere/000.jpg".to_owned());
        let restored = restore_package(&base, &version).unwrap().version;
        assert_eq!(restored.frames.len(), 2);
        assert_eq!(restored.frames[0].image, base.frames[0].image);
    }
}
