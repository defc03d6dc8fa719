//! Gold frames in the application: chosen, clicked again blind, undone, journalled; the resulting
//! click noise and its use.

use crate::bench::Bench;
use rand_pcg::Pcg64Mcg;
use std::path::Path;
use touchline_application::app::operation::{Breakdown, Failure};
use touchline_application::app::operations::{Comparison, ComparisonResult};
use touchline_application::app::{
    Action, Command, EditAction, Effect, Navigation, PointerAction, Question,
};
use touchline_application::testing::{base, landmark_in, without_counts};
use touchline_calibration::calibrate::ENOUGH_REPEATS;
use touchline_calibration::evaluate::agreement;
use touchline_core::geometry::{ImagePoint, Vec2};
use touchline_core::testing::seeded::{normal, rng};
use touchline_core::testing::{SIZE, TestBase};
use touchline_documents::document::{Click, Document, FrameStatus, Target};
use touchline_documents::testing::{match_from, new_frame};

const LANDMARKS: [&str; 3] = ["centre_mark", "halfway_far", "centre_circle_halfway_near"];

fn exact(frame: usize, landmark: &str) -> ImagePoint {
    landmark_in(
        &base().aim(2.0 * frame as f64 - 3.0, -12.0, 2200.0),
        landmark,
    )
}

fn jitter(at: ImagePoint, sigma_px: f64, rng: &mut Pcg64Mcg) -> ImagePoint {
    at.translate(Vec2::new(normal(rng), normal(rng)) * sigma_px)
}

/// Accepted frames with three points each, with click noise of this sigma.
fn accepted_frames(frames: usize, sigma_px: f64, rng: &mut Pcg64Mcg) -> Bench {
    let mut document = match_from(&base(), SIZE);
    for index in 0..frames {
        let mut frame = new_frame(&format!("{index}.jpg"), SIZE);
        frame.status = FrameStatus::Draft;
        frame.clicks = LANDMARKS
            .iter()
            .map(|id| Click::landmark((*id).into(), jitter(exact(index, id), sigma_px, rng)))
            .collect();
        document.frames.push(frame.into());
    }
    let mut bench = Bench::new(document);
    for index in 0..frames {
        bench.act(Action::Navigate(Navigation::GoTo(index)));
        bench.act(Action::Edit(EditAction::Nudge {
            dx_px: 0.0,
            dy_px: 0.0,
            held: false,
        }));
        bench.command(Command::AcceptAndStay);
    }
    bench
}

impl Bench {
    fn document(&self) -> &Document {
        &self.app.open().unwrap().document
    }

    /// Answers the round with click noise of this sigma.
    fn answer(&mut self, sigma_px: f64, rng: &mut Pcg64Mcg) {
        while let Some(target) = self.app.round().and_then(|round| round.target().cloned()) {
            assert_eq!(self.app.session.frame, target.frame);
            self.click(jitter(
                exact(target.frame, target.landmark.as_str()),
                sigma_px,
                rng,
            ));
        }
    }
}

#[test]
fn a_blind_click_keeps_its_time_if_there_is_a_clock() {
    let mut rng = rng("a_blind_click_keeps_its_time_if_there_is_a_clock");
    let mut bench = accepted_frames(4, 0.8, &mut rng);
    bench.command(Command::ChooseGold);
    bench.command(Command::ClickAgain);
    let click_once = |bench: &mut Bench| {
        bench.click(ImagePoint::new(500.0, 400.0));
        let repeats = bench
            .document()
            .frames
            .iter()
            .flat_map(|frame| &frame.repeats);
        repeats.map(|repeat| repeat.at.clone()).collect::<Vec<_>>()
    };
    assert_eq!(click_once(&mut bench), [None]);
    bench.command(Command::Undo);
    bench.app = std::mem::take(&mut bench.app)
        .with_clock(|| jiff::Timestamp::from_second(1_777_660_200).unwrap());
    assert_eq!(
        click_once(&mut bench),
        [Some("2026-05-01T18:30:00Z".to_owned())]
    );
}

#[test]
fn a_blind_round_asks_for_every_point_and_leaves_the_labels_alone() {
    let mut rng = rng("a_blind_round_asks_for_every_point_and_leaves_the_labels_alone");
    let mut bench = accepted_frames(4, 0.8, &mut rng);
    assert!(
        bench
            .document()
            .frames
            .iter()
            .all(|frame| frame.status == FrameStatus::Reference)
    );
    bench.command(Command::ClickAgain);
    assert!(bench.app.round().is_none() && bench.last_notice().starts_with("No frame is gold."));
    bench.command(Command::ChooseGold);
    assert!(bench.document().frames.iter().all(|frame| frame.gold));
    let before = bench.document().clone();
    bench.effects.clear();
    bench.command(Command::ClickAgain);
    assert_eq!(bench.app.round().unwrap().len(), 12);

    // Nothing that shows the label or leads away from it.
    for command in [
        Command::Accept,
        Command::NextFrame,
        Command::NextClick,
        Command::CameraPanel,
        Command::Uncertainty,
    ] {
        assert!(bench.app.why_not(command).is_some(), "{command:?}");
    }
    for action in [
        Action::Navigate(Navigation::GoTo(3)),
        Action::Navigate(Navigation::Select(Some(0))),
        Action::Edit(EditAction::Pick(Target::Landmark("centre_mark".into()))),
    ] {
        bench.act(action);
        assert!(
            bench.app.session.frame == 0
                && bench.app.session.points.selected.is_none()
                && bench.app.round().is_some()
        );
    }
    // A press on the label's own click takes hold of nothing; outside of the picture it is none.
    let label = before.frames[0].clicks[0].image;
    bench.act(Action::Pointer(PointerAction::Press {
        at: ImagePoint::new(-5.0, 3.0),
        on: None,
    }));
    bench.act(Action::Pointer(PointerAction::Release));
    assert_eq!(bench.app.round().unwrap().clicked_count(), 0);
    bench.act(Action::Pointer(PointerAction::Press {
        at: label,
        on: Some(0),
    }));
    bench.act(Action::Pointer(PointerAction::Drag(ImagePoint::new(
        500.0, 400.0,
    ))));
    bench.act(Action::Pointer(PointerAction::Release));
    let frame = &bench.document().frames[0];
    assert_eq!(
        (frame.repeats[0].image, frame.repeats[0].round),
        (ImagePoint::new(500.0, 400.0), 1)
    );
    assert_eq!(bench.app.round().unwrap().number(), 2);

    // Back, skip, go on.
    bench.command(Command::Undo);
    assert!(
        bench.document().frames[0].repeats.is_empty() && bench.app.round().unwrap().number() == 1
    );
    bench.command(Command::SkipAgain);
    assert_eq!(bench.app.round().unwrap().skipped_count(), 1);
    bench.answer(0.8, &mut rng);
    assert!(bench.app.round().is_none());
    assert!(
        bench
            .last_notice()
            .starts_with("11 blind clicks are kept; after 1 more"),
        "{}",
        bench.last_notice()
    );
    for (frame, labelled) in bench.document().frames.iter().zip(&before.frames) {
        assert_eq!(
            (&frame.clicks, &frame.ptz, frame.status),
            (&labelled.clicks, &labelled.ptz, labelled.status)
        );
    }

    assert_eq!(bench.replay_journal(&before), *bench.document());
    // After the round each click is a step of its own.
    bench.command(Command::Undo);
    assert_eq!(bench.document().frames[3].repeats.len(), 2);
}

#[test]
fn another_document_is_compared_on_the_quality_page() {
    let mut rng = rng("another_document_is_compared_on_the_quality_page");
    let mut bench = accepted_frames(3, 0.5, &mut rng);
    bench.effects.clear();
    bench.command(Command::CompareAnnotators);
    assert_eq!(
        bench.effects.pop(),
        Some(Effect::Ask(Question::CompareWith))
    );
    bench.act(Action::Answer(
        Question::CompareWith,
        "/other/project.json".into(),
    ));
    assert!(bench.app.session.quality.open && bench.app.operations.comparison.is_running());
    bench.last_job::<Comparison>();
    let request = bench.app.operations.comparison.running().unwrap();
    let (document, with, revision) = (
        request.document.clone(),
        request.with.clone(),
        request.revision,
    );
    assert_eq!(
        (&document, with.as_path()),
        (bench.document(), Path::new("/other/project.json"))
    );
    assert!(
        bench.app.why_not(Command::CompareAnnotators).is_some(),
        "one at a time"
    );
    bench.report_end::<Comparison>(Err(Failure::Broken(Breakdown::Panicked(
        "no such file".to_owned(),
    ))));
    assert!(
        !bench.app.operations.comparison.is_running()
            && bench.app.operations.comparison.last_result().is_none()
    );
    bench.assert_notice("no such file");

    let mut other = document.clone();
    for frame in &mut other.frames {
        for click in &mut frame.clicks {
            click.image = jitter(click.image, 1.0, &mut rng);
        }
    }
    let agreement = agreement(document.at(Path::new("/a")), other.at(Path::new("/b"))).unwrap();
    bench.act(Action::Compare(with.clone()));
    bench.report_end::<Comparison>(Ok(ComparisonResult {
        file: with,
        revision,
        agreement,
    }));
    let made = bench.app.operations.comparison.last_result().unwrap();
    assert_eq!(
        (
            made.agreement.distances.unwrap().count,
            made.agreement.lone.len()
        ),
        (9, 0)
    );
    let pair = made.agreement.frames[2].clicks[1].clicks[0];
    bench.act(Action::Navigate(Navigation::LookAt {
        frame: 2,
        click: Some(pair),
    }));
    assert_eq!(
        (bench.app.session.frame, bench.app.session.points.selected),
        (2, Some(pair))
    );
}

#[test]
fn enough_blind_clicks_weigh_the_points_until_that_is_undone() {
    let mut rng = rng("enough_blind_clicks_weigh_the_points_until_that_is_undone");
    let mut bench = accepted_frames(6, 0.5, &mut rng);
    bench.command(Command::ChooseGold);
    bench.command(Command::ClickAgain);
    bench.command(Command::Cancel);
    assert!(bench.app.round().is_none());
    assert!(bench.app.why_not(Command::UseOwnNoise).is_some());
    bench.command(Command::ClickAgain);
    bench.answer(0.5, &mut rng);
    assert!(bench.app.gold().own.repeats >= ENOUGH_REPEATS);
    let noise = bench.app.gold().own.noise.unwrap();
    assert!(
        noise.interval_95[0] < 0.5 && 0.5 < noise.interval_95[1],
        "{noise:?}"
    );
    bench.assert_notice("Your click noise is");

    let sigma = |bench: &Bench| {
        let solution = bench.document().frames[2].solution.as_ref().unwrap();
        (
            solution.worst_corner_sigma_px.unwrap(),
            bench.document().frames[2].status,
        )
    };
    let before = bench.document().clone();
    let (usual, _) = sigma(&bench);
    bench.command(Command::UseOwnNoise);
    let (own, status) = sigma(&bench);
    assert!(
        own < 0.95 * usual && status == FrameStatus::Reference,
        "{own} of {usual}"
    );
    assert!(
        bench.app.why_not(Command::UseOwnNoise).is_some(),
        "it is in use"
    );
    bench.command(Command::UseUsualNoise);
    assert!((sigma(&bench).0 - usual).abs() < 1e-9);
    assert!(
        bench.document().own_click_noise().is_some(),
        "kept for later"
    );
    bench.command(Command::Undo);
    assert!((sigma(&bench).0 - own).abs() < 1e-12);
    bench.command(Command::Undo);
    assert_eq!(without_counts(bench.document()), without_counts(&before));
}
