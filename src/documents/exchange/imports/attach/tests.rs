//! Cameras of every format that are attached to a video, and those that must not be.

use super::*;
use crate::document::{Document, FrameStatus};
use crate::exchange::tests::{SIZE, document, export_as};
use crate::exchange::{ExchangeError, ImportOptions, JoinedImport, import, join};
use std::fs;
use touchline_core::camera::{BaseAngles, CameraBase};
use touchline_core::geometry::Vec3;

/// How many frames the video has.
const FRAMES: usize = 12;

/// All frames of a video, solved; no two are pointed alike.
fn solved_video() -> Document {
    let base = CameraBase::new(
        Vec3::new(1.0, -58.0, 16.0),
        BaseAngles::default().base_from_world(),
        SIZE.centre(),
    );
    let ptz: Vec<(f64, f64, f64)> = (0..FRAMES)
        .map(|step| (-22.0 + 4.0 * step as f64, -11.0, 1800.0))
        .collect();
    let mut solved = document(&base, &ptz);
    let frames = solved.frames.iter().enumerate().map(|(index, frame)| {
        let video = VideoFrame::new("match.mp4", index as u64, Some(index as f64 / 25.0));
        let labelled = Frame {
            ptz: frame.ptz.clone(),
            status: FrameStatus::Reference,
            ..Frame::from_video(video, "main".into(), SIZE)
        };
        Shared::from(labelled)
    });
    solved.frames = frames.collect();
    solved
}

/// The frames of a document without their labels.
fn without_labels(document: &Document) -> Document {
    let mut unsolved = document.clone();
    for frame in &mut unsolved.frames {
        frame.ptz = None;
        frame.status = FrameStatus::New;
    }
    unsolved.cameras = vec![crate::document::Camera::new("main".into(), SIZE).into()];
    unsolved
}

/// The import of a document's export.
fn export_and_import(
    document: &Document,
    exporter: Format,
    importer: Format,
) -> Result<Imported, ExchangeError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("exported");
    let files = export_as(document, exporter).files;
    files.write(&path, exporter.is_folder(), false).unwrap();
    let options = ImportOptions {
        video_size: Some(SIZE),
        ..ImportOptions::default()
    };
    import(&path, importer, &options)
}

fn join_with(open: &Document, imported: &Imported) -> JoinedImport {
    join(open.at(Path::new("/match")), imported)
}

/// The farthest distance between what two documents show in the middle of their pictures, m on the
/// ground, over the frames that the first one has solved.
fn worst_m(truth: &Document, joined: &Document) -> f64 {
    let middle = |document: &Document, index: usize| {
        let camera = document.ptz_camera(document.frames.get(index)?)?;
        camera.plane_from_image(SIZE.centre(), 0.0)
    };
    let mut worst_m = 0.0_f64;
    for index in 0..truth.frames.len() {
        if let Some(point) = middle(truth, index) {
            let found = middle(joined, index).expect("the frame is solved");
            worst_m = worst_m.max((point - found).norm());
        }
    }
    worst_m
}

/// Imported frames of some names, with the cameras of a video's first frames.
fn imported_frames(names: &[String]) -> Imported {
    let mut document = solved_video();
    let solved: Vec<Shared<Frame>> = document.frames.iter().cloned().collect();
    let frames = names.iter().enumerate().map(|(index, name)| {
        let labelled = Frame {
            ptz: solved[index % FRAMES].ptz.clone(),
            ..Frame::from_image(name, "main".into(), SIZE)
        };
        Shared::from(labelled)
    });
    document.frames = frames.collect();
    Imported {
        document,
        folder: "/cameras".into(),
        format: Format::SoccerNet,
        notes: Vec::new(),
        failures: Vec::new(),
    }
}

fn plan(open: &Document, imported: &Imported) -> Result<Option<Attachment>, NotAttached> {
    plan_attachment(open.at(Path::new("/match")), imported)
}

#[test]
fn exports_of_a_video_are_attached_to_it() {
    let truth = solved_video();
    for (exporter, importer, by) in [
        (Format::SoccerNet, Format::SoccerNet, MatchedBy::Number),
        (Format::SoccerNet, Format::PnlCalib, MatchedBy::Number),
        (Format::BroadTrack, Format::BroadTrack, MatchedBy::Number),
        (Format::OpenCv, Format::OpenCv, MatchedBy::Number),
        (Format::Wc14, Format::Wc14, MatchedBy::Number),
        (Format::TsWorldCup, Format::TsWorldCup, MatchedBy::Number),
        (Format::Homography, Format::Homography, MatchedBy::Number),
        (Format::Colmap, Format::Colmap, MatchedBy::Number),
        (Format::OpenTrackIo, Format::OpenTrackIo, MatchedBy::Number),
        (Format::Csv, Format::Csv, MatchedBy::Index),
        (Format::Chan, Format::Chan, MatchedBy::Number),
        (Format::Fifa, Format::Fifa, MatchedBy::Order),
    ] {
        let imported = export_and_import(&truth, exporter, importer).unwrap();
        let attachment = plan(&without_labels(&truth), &imported).unwrap().unwrap();
        assert_eq!(attachment.matched_by(), by, "{importer}");
        let joined = join_with(&without_labels(&truth), &imported);
        assert_eq!(
            (joined.matched, joined.added, joined.other_size),
            (FRAMES, 0, 0),
            "{importer}: {:?}",
            joined.notes
        );
        let worst_m = worst_m(&truth, &joined.document);
        assert!(worst_m < 0.05, "{importer}: {worst_m} m");
        let note = joined.notes.last().unwrap();
        assert!(
            note.starts_with("12 cameras are attached to match.mp4 "),
            "{importer}: {note}"
        );
    }
}

#[test]
fn cameras_of_a_smaller_picture_are_rescaled_to_the_video() {
    let half = ImageSize::new(SIZE.width / 2, SIZE.height / 2);
    let mut video = solved_video();
    let video_size = size_of_only_video(video.at(Path::new("/match")));
    let export = crate::exchange::ExportOptions {
        size: Some(half),
        ..crate::exchange::ExportOptions::default()
    };
    for format in [Format::SoccerNet, Format::Wc14] {
        let exported = crate::exchange::export(video.at(Path::new("/")), format, &export).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("exported");
        exported.files.write(&path, true, false).unwrap();
        // A homography does not say the size of its picture, which has to be given then.
        let given = [None, Some(half)].into_iter();
        for size in given.filter(|size| size.is_some() || format == Format::SoccerNet) {
            let options = ImportOptions {
                size,
                video_size,
                ..ImportOptions::default()
            };
            let imported = import(&path, format, &options).unwrap();
            let joined = join_with(&without_labels(&video), &imported);
            assert_eq!((joined.matched, joined.other_size), (FRAMES, 0), "{format}");
            let worst_m = worst_m(&video, &joined.document);
            assert!(worst_m < 0.05, "{format}, {size:?}: {worst_m} m");
        }
    }
    video.frames[3].image_size = half;
    assert_eq!(
        size_of_only_video(video.at(Path::new("/match"))),
        None,
        "frames of two sizes"
    );
}

#[test]
fn gaps_stay_gaps_and_rows_without_numbers_are_not_attached() {
    let mut truth = solved_video();
    for index in [0, 3, 7] {
        truth.frames[index].ptz = None;
        truth.frames[index].status = FrameStatus::New;
    }
    for format in [Format::SoccerNet, Format::Csv, Format::OpenCv] {
        let imported = export_and_import(&truth, format, format).unwrap();
        let joined = join_with(&without_labels(&truth), &imported);
        assert_eq!((joined.matched, joined.added), (9, 0), "{format}");
        assert!(worst_m(&truth, &joined.document) < 0.01, "{format}");
        let is_solved = |index: usize| joined.document.frames[index].ptz.is_some();
        assert!(![0, 3, 7].into_iter().any(is_solved), "{format}");
    }
    let rows = export_and_import(&truth, Format::Fifa, Format::Fifa).unwrap();
    let joined = join_with(&without_labels(&truth), &rows);
    assert_eq!(joined.matched, 0);
    assert_eq!(
        joined.notes.last().unwrap(),
        "nothing is attached to match.mp4: 9 cameras without frame numbers do not fit its 12 frames; give each camera the \
         number of its frame"
    );
}

#[test]
fn one_camera_is_attached_by_its_number() {
    let open = without_labels(&solved_video());
    let one = imported_frames(&["camera_000005.json".to_owned()]);
    let joined = join_with(&open, &one);
    assert!(joined.document.frames[5].ptz.is_some());
    assert_eq!(
        joined.notes,
        [
            "1 camera is attached to match.mp4 by the numbers in their names, counted from 0; counted from 1 they fit, too"
        ]
    );
    let attachment = plan(&open, &one).unwrap().unwrap();
    let second = attachment.apply(&one, &attachment.candidates()[1]);
    let video = second.document.frames[0].video.as_ref().unwrap();
    assert_eq!((video.path.as_str(), video.frame_index), ("match.mp4", 4));
    assert!(join_with(&open, &second).document.frames[4].ptz.is_some());
}

#[test]
fn cameras_counted_from_one_are_moved_unless_this_program_named_them() {
    let open = without_labels(&solved_video());
    let names = |stem: &str, range: std::ops::Range<usize>| -> Vec<String> {
        range
            .map(|number| format!("{stem}_{number:06}.png"))
            .collect()
    };
    let first_frame = |names: &[String]| {
        let attachment = plan(&open, &imported_frames(names)).unwrap().unwrap();
        attachment.candidates()[0].pairs[0].frame_index
    };
    assert_eq!(first_frame(&names("frame", 1..12)), 0);
    assert_eq!(first_frame(&names("match", 1..12)), 1);
    assert_eq!(first_frame(&names("match", 1..13)), 0, "all 12 frames");
    assert_eq!(first_frame(&names("frame", 500..512)), 0, "a cut beginning");
}

#[test]
fn attached_cameras_are_exported_under_the_names_that_they_came_with() {
    let truth = solved_video();
    let folder = tempfile::tempdir().unwrap();
    let names = |index: usize| format!("camera_shot7-{:03}.json", 100 + index);
    for (index, (_, bytes)) in export_as(&truth, Format::SoccerNet)
        .files
        .sorted_entries()
        .iter()
        .enumerate()
    {
        fs::write(folder.path().join(names(index)), bytes).unwrap();
    }
    let options = ImportOptions {
        video_size: Some(SIZE),
        ..ImportOptions::default()
    };
    let imported = import(folder.path(), Format::SoccerNet, &options).unwrap();
    let open = without_labels(&truth);
    let joined = join(open.at(Path::new("/match")), &imported);
    assert_eq!(
        (joined.matched, joined.added),
        (FRAMES, 0),
        "{:?}",
        joined.notes
    );
    assert_eq!(joined.pairs[3].imported, "shot7-103");
    let again = export_as(&joined.document, Format::SoccerNet).files;
    let expected: Vec<String> = (0..FRAMES).map(names).collect();
    let written: Vec<String> = again
        .sorted_entries()
        .iter()
        .map(|(name, _)| (*name).to_owned())
        .collect();
    assert_eq!(written, expected);
}

#[test]
fn files_of_one_name_and_rows_without_a_name_are_exported_again() {
    let open = without_labels(&solved_video());
    let names: Vec<String> = (0..FRAMES)
        .map(|number| format!("{number:06}/c.json"))
        .collect();
    let rows = export_and_import(&solved_video(), Format::Fifa, Format::Fifa).unwrap();
    for (imported, first) in [
        (imported_frames(&names), "camera_000000_c.json"),
        (rows, "camera_match_000000.json"),
    ] {
        let joined = join_with(&open, &imported);
        assert_eq!(joined.matched, FRAMES, "{:?}", joined.notes);
        let files = export_as(&joined.document, Format::SoccerNet).files;
        assert_eq!(files.sorted_entries()[0].0, first);
    }
}

#[test]
fn cameras_of_another_video_are_not_attached() {
    let open = without_labels(&solved_video());
    let names: Vec<String> = (0..400).map(|number| format!("c_{number}.json")).collect();
    let joined = join_with(&open, &imported_frames(&names));
    assert_eq!((joined.matched, joined.added), (0, 400));
    assert_eq!(
        joined.notes,
        [
            "nothing is attached to match.mp4: the numbers 0 to 399 of 400 cameras do not fit its 12 frames; rename the \
             files so that their numbers count the video's frames"
        ]
    );
    let views: Vec<String> = ["left", "right"]
        .into_iter()
        .flat_map(|view| (0..6).map(move |number| format!("{view}/{number}.json")))
        .collect();
    let refused = plan(&open, &imported_frames(&views)).unwrap_err();
    assert!(
        matches!(refused, NotAttached::NumbersRepeat { distinct: 6, .. }),
        "{refused}"
    );
}

#[test]
fn a_few_cameras_more_than_frames_are_left_out() {
    let open = without_labels(&solved_video());
    let names: Vec<String> = (0..13).map(|number| format!("c_{number}.json")).collect();
    let joined = join_with(&open, &imported_frames(&names));
    assert_eq!((joined.matched, joined.added), (12, 0));
    assert_eq!(
        joined.notes[1],
        "1 camera left out, because match.mp4 has no frame of their number or another has it: c_12.json"
    );
}

#[test]
fn pictures_are_never_frames_of_a_video() {
    let folder = tempfile::tempdir().unwrap();
    let open = without_labels(&solved_video());
    let mut imported = imported_frames(&["000003.png".to_owned(), "000004.png".to_owned()]);
    imported.folder = folder.path().to_path_buf();
    assert!(plan(&open, &imported).unwrap().is_some());
    fs::write(folder.path().join("000004.png"), "a picture").unwrap();
    assert_eq!(plan(&open, &imported), Ok(None), "one is on disk");
    fs::remove_file(folder.path().join("000004.png")).unwrap();
    imported.document.frames[0].sha256 = Some("ab".to_owned());
    assert_eq!(plan(&open, &imported), Ok(None), "its digest is stated");
    imported.document.frames[0].sha256 = None;
    imported.format = Format::Json;
    assert_eq!(plan(&open, &imported), Ok(None), "a document names its own");
}

#[test]
fn a_document_of_no_video_or_of_two_takes_nothing() {
    let imported = imported_frames(&["000003.png".to_owned()]);
    let mut open = without_labels(&solved_video());
    open.frames[1].video.as_mut().unwrap().path = "second.mp4".to_owned();
    assert_eq!(plan(&open, &imported), Ok(None));
    open.frames.retain(|_| false);
    assert_eq!(plan(&open, &imported), Ok(None));
}
