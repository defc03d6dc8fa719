//! Suggestions that are pulled onto the painted lines before anybody sees them.

use crate::drawn::draw;
use touchline::camera::PtzCamera;
use touchline::document::{Document, FramePtz, FrameStatus};
use touchline::geometry::{Angle, ImagePoint};
use touchline::media::FrameReader;
use touchline::proposals::{LineEvidence, NoProposal, Proposal};
use touchline_application::testing::proposed::proposal_in;
use touchline_documents::testing::load;

/// How far the proposed cameras are turned away from the true ones, px.
const OFF_PX: [f64; 3] = [6.0, 260.0, 6.0];

/// Three drawn frames, the last one's picture lost, what the forest says of them, and what the
/// paint makes of that, not snapping and snapping.
fn judge_both() -> (Document, [Vec<Proposal>; 2]) {
    let place = tempfile::tempdir().unwrap();
    draw(
        place.path(),
        "--frames 3 --seed 11 --size 960x540 --preset easy",
    );
    let folder = place.path().join("match");
    let truth = load(folder.join("truth.json"));
    let mut open = truth.clone();
    open.frames[2].image = Some("lost.png".to_owned());
    for frame in &mut open.frames {
        frame.clicks.clear();
        (frame.ptz, frame.solution, frame.status) = (None, None, FrameStatus::New);
    }
    let mut proposals: Vec<Proposal> = (0..3)
        .map(|frame| proposal_in(&open, frame, 1, Some(0.0)))
        .collect();
    for (index, proposal) in proposals.iter_mut().enumerate() {
        let ptz = truth.frames[index].ptz.as_ref().unwrap().ptz();
        let pan = ptz.pan + Angle::from_radians(OFF_PX[index] / ptz.focal_px);
        proposal.outcome.as_mut().unwrap().ptz =
            FramePtz::new(touchline::camera::Ptz { pan, ..ptz }, None);
    }
    let mut reader = FrameReader::new();
    let at = open.at(&folder);
    let proposals = [false, true].map(|snapping| {
        let mut proposals = proposals.clone();
        LineEvidence::from_document(at, &mut reader, snapping)
            .unwrap()
            .judge(at, &mut reader, &mut proposals, 0.5);
        proposals
    });
    (truth, proposals)
}

/// How far the overlay is off at the farther of two places, px.
fn off_px(truth: &Document, proposal: &Proposal) -> f64 {
    let truth = truth
        .ptz_camera(truth.frames.by_id(&proposal.frame).unwrap())
        .unwrap();
    let camera = PtzCamera::new(*truth.base(), proposal.outcome.as_ref().unwrap().ptz.ptz());
    let off_px = [ImagePoint::new(60.0, 300.0), ImagePoint::new(900.0, 500.0)].map(|place| {
        let ray = truth.ray_from_image(place).unwrap();
        camera.image_from_ray(ray).unwrap().distance_px(place)
    });
    off_px.into_iter().fold(0.0, f64::max)
}

#[test]
fn a_suggestion_goes_to_the_paint_that_decides_and_one_that_the_paint_contradicts_is_none() {
    let (truth, [plain, snapped]) = judge_both();
    let [before, after] =
        [&plain[0], &snapped[0]].map(|proposal| proposal.outcome.as_ref().unwrap());
    assert_eq!(before.samples, None);
    assert!(
        (5.5..7.0).contains(&off_px(&truth, &plain[0])),
        "{}",
        off_px(&truth, &plain[0])
    );
    assert!(
        off_px(&truth, &snapped[0]) < 0.5,
        "{}",
        off_px(&truth, &snapped[0])
    );
    assert!(
        after.samples.is_some_and(|samples| samples >= 40) && after.line_check.unwrap().score > 0.9,
        "{after:?}"
    );
    // It is known as the paint has it: its numbers and not the forest's are stated.
    assert!(
        after.covariance != before.covariance && after.worst_corner_sigma_px < 2.0,
        "{after:?}"
    );
    assert!(
        after.confidence >= before.confidence,
        "{} {}",
        after.confidence,
        before.confidence
    );
    for proposals in [&plain, &snapped] {
        assert!(
            matches!(proposals[1].outcome, Err(NoProposal::Contradicted { .. })),
            "{:?}",
            proposals[1].outcome
        );
    }
    assert_eq!(
        plain[2], snapped[2],
        "where the paint cannot be open a suggestion stays as the forest gave it"
    );
    assert_eq!(snapped[2].outcome.as_ref().unwrap().samples, None);

    // A frame says what it shows.
    let mut frame = truth.frames[0].clone();
    frame.clicks.clear();
    after_recording(&mut frame, &snapped[0]);
    assert!(
        frame.is_snapped_proposal()
            && frame.is_suggestion()
            && frame.status == FrameStatus::Suggested
    );
    after_recording(&mut frame, &plain[0]);
    assert!(!frame.is_snapped_proposal() && frame.is_suggestion());
}

fn after_recording(frame: &mut touchline::document::Frame, proposal: &Proposal) {
    (frame.ptz, frame.solution, frame.status) = (None, None, FrameStatus::New);
    proposal.record(frame);
}

#[cfg(feature = "opencv")]
#[test]
fn the_choice_is_kept_and_the_trainer_is_told_of_it() {
    use crate::bench::Bench;
    use touchline::app::{Action, App, Command, Effect, Opened, Settings, TrainerOrder};
    use touchline_application::testing::proposed::blank;

    let mut bench = Bench::new(blank(1));
    let orders = |bench: &Bench| -> Vec<bool> {
        let orders = bench.effects.iter().filter_map(|effect| match effect {
            Effect::Trainer(TrainerOrder::Wishes(wishes)) => Some(wishes.snapping),
            _ => None,
        });
        orders.collect()
    };
    assert!(
        bench.app.settings.snap_suggestions,
        "unless it is switched off"
    );
    let opened = Action::Opened(Box::new(Opened::new(blank(1), "/nowhere/project.json")));
    let told = App::new(Settings::default()).update(opened);
    let aligns = |effect: &Effect| matches!(effect, Effect::Trainer(TrainerOrder::Wishes(wishes)) if wishes.snapping);
    assert!(told.iter().any(aligns));
    bench.command(Command::SnapSuggestions);
    assert!(!bench.app.settings.snap_suggestions && bench.effects.contains(&Effect::SaveSettings));
    bench.command(Command::SnapSuggestions);
    assert_eq!(orders(&bench), [false, true]);
}
