//! The background trainer on a drawn match.
#![cfg(feature = "opencv")]

use crate::drawn::draw;
use crate::drawn::drawn_match;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::Duration;
use touchline::app::{TrainerActivity, TrainerOrder, TrainerReport, TrainerStatus};
use touchline::document::{Document, FramePtz, FrameStatus};
use touchline::geometry::rotation::{angle_between, q_pan, q_tilt};
use touchline::jobs::{SharedPictures, Trainer, TrainerOptions};
use touchline::proposals::{Proposal, WorkFolder};
use touchline::relocalize::TrainOptions;
use touchline_documents::testing::load;

/// Lets a trainer do all that it has to do with a document.
fn session(file: &Path, document: &Document) -> (TrainerStatus, Vec<Proposal>) {
    let (wake, woken) = channel();
    let options = TrainerOptions {
        settle: Duration::ZERO,
        ..TrainerOptions::default()
    };
    let wake = Arc::new(move || wake.send(()).unwrap_or_default());
    let trainer =
        Trainer::start(file.to_path_buf(), options, SharedPictures::none(), wake).unwrap();
    trainer.notify(TrainerOrder::Document(Box::new(document.clone())));
    let (mut last, mut proposed) = (TrainerStatus::default(), Vec::new());
    while !(last.doing == TrainerActivity::Nothing && last.forest.is_some()) {
        woken.recv().unwrap();
        for report in trainer.poll() {
            match report {
                TrainerReport::Status(status) => last = *status,
                TrainerReport::Proposals(proposals) => proposed.extend(proposals),
                TrainerReport::Tracked(_) => panic!("these are no videos"),
                TrainerReport::Features(_) => panic!("nobody asked for features"),
                TrainerReport::Broken { message } => panic!("{message}"),
            }
        }
    }
    (last, proposed)
}

fn read(path: &Path) -> Document {
    load(path)
}

#[test]
fn it_learns_proposes_and_goes_on_where_it_was() {
    let place = tempfile::tempdir().unwrap();
    drawn_match(place.path());
    let file = place.path().join("match/ask.json");
    let truth = read(&file.with_file_name("truth.json"));
    let mut document = read(&file);

    let (status, proposals) = session(&file, &document);
    assert_eq!(
        (status.references, status.training_frames, status.trouble),
        (5, 5, None)
    );
    let facts = status.forest.unwrap();
    assert_eq!(
        (facts.references, facts.trees),
        (5, TrainOptions::default().trees as usize)
    );
    assert!(
        facts.took.is_some() && facts.features > 100 && facts.leaves > 100,
        "{facts:?}"
    );
    assert!(
        status
            .quality
            .is_some_and(|quality| quality.tested.len() == 5)
    );
    assert_eq!(status.coverage.len(), 1);
    assert_eq!(proposals.len(), 5);
    let mut answered = 0;
    for proposal in &proposals {
        assert!(
            proposal
                .request
                .is_still(&document, document.frames.by_id(&proposal.frame).unwrap())
        );
        if let Ok(answer) = &proposal.outcome {
            answered += 1;
            let truth = truth
                .frames
                .by_id(&proposal.frame)
                .unwrap()
                .ptz
                .as_ref()
                .unwrap()
                .ptz();
            let turned = |ptz: touchline::camera::Ptz| q_tilt(ptz.tilt) * q_pan(ptz.pan);
            let off = angle_between(&turned(answer.ptz.ptz()), &turned(truth)).degrees();
            assert!(off < 0.1, "frame {}: {off}°", proposal.frame);
        }
        proposal.record(document.frames.by_id_mut(&proposal.frame).unwrap());
    }
    assert!(answered >= 3, "{answered} of 5");
    assert_eq!(
        (status.answered, status.unanswered),
        (answered, 5 - answered)
    );

    let (again, _) = session(&file, &document);
    assert_eq!(
        again.forest.unwrap().took,
        None,
        "the forest of the session before serves"
    );
    assert_eq!(again.answered, answered);

    let kept = WorkFolder::beside(&file);
    fs::write(kept.forest(), "no forest").unwrap();
    let (mended, _) = session(&file, &document);
    assert!(
        mended.forest.unwrap().took.is_some() && mended.trouble.is_none(),
        "{mended:?}"
    );
    assert!(fs::read(kept.forest()).unwrap().len() > 1000);

    // A file in the folder's place refuses everybody.
    fs::remove_dir_all(kept.path()).unwrap();
    fs::write(kept.path(), "").unwrap();
    let (unkept, _) = session(&file, &document);
    assert!(
        unkept.not_kept.is_some() && unkept.forest.is_some(),
        "{unkept:?}"
    );
}

/// A drawn match whose frames are all references, as they were drawn but for what `mislabel` does;
/// those that the trainer names.
fn suspects(file: &Path, mislabel: impl Fn(&mut Vec<FramePtz>)) -> Vec<usize> {
    let mut document = read(file);
    let mut labels: Vec<FramePtz> = document
        .frames
        .iter()
        .map(|frame| frame.ptz.clone().unwrap())
        .collect();
    mislabel(&mut labels);
    for (frame, label) in document.frames.iter_mut().zip(labels) {
        (frame.status, frame.ptz) = (FrameStatus::Reference, Some(label));
    }
    let (status, _) = session(file, &document);
    assert_eq!(
        (status.training_frames, status.trouble),
        (document.frames.len(), None)
    );
    let mut named: Vec<usize> = status
        .suspects
        .iter()
        .filter_map(|suspect| document.frames.position_of(&suspect.frame))
        .collect();
    named.sort_unstable();
    named
}

#[test]
fn a_mislabelled_reference_is_named_and_right_ones_raise_no_alarm() {
    let place = tempfile::tempdir().unwrap();
    draw(
        place.path(),
        "--frames 14 --seed 5 --size 640x360 --preset easy",
    );
    let file = place.path().join("match/truth.json");
    assert_eq!(suspects(&file, |_| ()), [] as [usize; 0], "all are right");
    assert_eq!(
        suspects(&file, |labels| labels[4].pan_deg += 2.0),
        [4],
        "a landmark taken for its neighbour"
    );
    let mirrored = |labels: &mut Vec<FramePtz>| labels[4].pan_deg = -labels[4].pan_deg;
    assert_eq!(suspects(&file, mirrored), [4], "left taken for right");
    assert_eq!(
        suspects(&file, |labels| labels[9].focal_px *= 1.2),
        [9],
        "a larger box taken for a smaller"
    );
}
