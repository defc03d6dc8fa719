//! The camera found without a click, in the application: the search starts, the result is reported
//! and applied as one step of undo, and of two possible results each can be tried.
#![cfg(feature = "opencv")]

use crate::bench::Bench;
use touchline_application::app::guidance::next_step;
use touchline_application::app::operation::{Breakdown, Failure};
use touchline_application::app::operations::CameraSearch;
use touchline_application::app::operations::camera_search::{NoAnswer, SearchSteps};
use touchline_application::app::session::Level;
use touchline_application::app::{Action, App, Command, EditAction, Navigation, PointerAction};
use touchline_application::testing::proposed::blank;
use touchline_application::testing::{base, landmark_in, without_counts};
use touchline_calibration::autocalibrate::{
    Abstention, AutocalibrationAnswer, AutocalibrationProgress, Doubt, WantedClicks,
};
use touchline_calibration::calibrate::{
    AutocalibratedCamera, AutocalibratedFrame, AutocalibrationEvidence,
};
use touchline_core::camera::{BaseSigma, CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::{ImagePoint, Vec3};
use touchline_core::testing::soccer;
use touchline_documents::document::{Click, Document, SolutionSource};

/// Frames of a camera of which nothing is known.
pub fn unknown(frames: usize) -> Document {
    let mut document = blank(frames);
    let camera = &mut document.cameras[0];
    (camera.position_m, camera.base_from_world) = (None, None);
    assert!(camera.base().is_none());
    document
}

fn ptz(frame: usize) -> Ptz {
    Ptz::from_degrees(8.0 * frame as f64 - 16.0, -13.0, 2300.0)
}

/// The camera of the drawn truth moved sideways, over a flat field as the truth, found from all but
/// the last frame.
pub fn found_camera(frames: usize, sideways_m: f64) -> AutocalibratedCamera {
    let known = base();
    let sigma = BaseSigma {
        position_m: Vec3::new(0.3, 0.4, 0.0),
        ..known.sigma
    };
    let base = CameraBase {
        position_m: known.position_m + Vec3::new(sideways_m, 0.0, 0.0),
        sigma,
        ..known
    };
    let frames = (0..frames - 1)
        .map(|index| AutocalibratedFrame {
            index,
            ptz: ptz(index),
            uncertainty: None,
            snapped: None,
            unaligned_score: None,
        })
        .collect();
    let field = soccer();
    let evidence = AutocalibrationEvidence::default();
    AutocalibratedCamera {
        base,
        field,
        sizes: Vec::new(),
        frames,
        others: Vec::new(),
        paint: Vec::new(),
        evidence,
    }
}

fn report(bench: &mut Bench, answer: AutocalibrationAnswer) {
    bench.report_end::<CameraSearch>(Ok(answer));
}

fn has_base(app: &App) -> bool {
    app.open().unwrap().document.cameras[0].base().is_some()
}

#[test]
fn it_is_available_where_a_base_is_missing_and_reports_its_progress() {
    let mut bench = Bench::new(unknown(5));
    let missing = bench.app.missing_base().unwrap();
    assert_eq!(missing.why_no_search, None);
    assert!(
        Bench::new(blank(5))
            .app
            .why_not(Command::FindCamera)
            .is_some(),
        "its base is known"
    );
    assert!(
        Bench::new(unknown(2))
            .app
            .why_not(Command::FindCamera)
            .unwrap()
            .contains("too few frames")
    );
    bench.command(Command::FindCamera);
    let search = bench.last_job::<CameraSearch>();
    assert_eq!(
        bench
            .app
            .operations
            .camera_search
            .running()
            .unwrap()
            .camera
            .as_str(),
        "main"
    );
    assert!(
        bench.app.why_not(Command::FindCamera).is_some(),
        "one at a time"
    );
    let steps = SearchSteps::default();
    let matching = AutocalibrationProgress::Tying { done: 212, of: 480 };
    bench.report_progress::<CameraSearch>(steps.of_search(&matching));
    let card = &bench.app.under_way()[0];
    assert_eq!(
        (card.job.as_str(), card.step.as_str()),
        (
            "Finding the camera",
            "Matching pairs of frames, 212 of 480."
        )
    );
    assert_eq!(card.share, Some(212.0 / 480.0));
    assert_eq!(card.stop, Command::StopFindCamera);
    assert_eq!(bench.app.missing_base(), None, "its card is in the place");
    let said = next_step(&bench.app).text;
    assert!(
        said.starts_with("Finding the camera for 5 frames, this one too. Review others meanwhile"),
        "no click is wanted: {said}"
    );
    bench.command(Command::StopFindCamera);
    assert!(search.is_cancelled() && bench.app.why_not(Command::FindCamera).is_none());
    // What arrives of it all the same is passed over.
    report(
        &mut bench,
        AutocalibrationAnswer::Found(found_camera(5, 0.0).into()),
    );
    assert!(!has_base(&bench.app));
}

#[test]
fn what_is_found_is_one_step_of_undo_and_no_click_is_lost() {
    let start = unknown(5);
    let mut bench = Bench::new(start.clone());
    bench.command(Command::FindCamera);
    // The user clicks in a frame during the search, and is in the middle of a drag when it ends.
    let placed = |landmark: &str| {
        let at = landmark_in(&PtzCamera::new(base(), ptz(1)), landmark);
        Click::landmark(landmark.into(), at)
    };
    bench.act(Action::Navigate(Navigation::GoTo(1)));
    for click in [placed("centre_mark"), placed("halfway_far")] {
        bench.act(Action::Edit(EditAction::Pick(
            click.target.clone().unwrap(),
        )));
        bench.act(Action::Pointer(PointerAction::Press {
            at: click.image,
            on: None,
        }));
        bench.act(Action::Pointer(PointerAction::Release));
    }
    bench.act(Action::Pointer(PointerAction::Press {
        at: ImagePoint::new(100.0, 100.0),
        on: None,
    }));
    report(
        &mut bench,
        AutocalibrationAnswer::Found(found_camera(5, 0.0).into()),
    );
    assert!(!has_base(&bench.app), "a drag is not cut in two");
    bench.command(Command::Cancel);
    bench.act(Action::Pointer(PointerAction::Release));
    bench.command(Command::Cancel);
    assert!(has_base(&bench.app), "{:?}", bench.app.session.mode);
    assert!(
        bench
            .last_notice()
            .starts_with("Camera found: 17.0 m high, 62.0 m"),
        "{}",
        bench.last_notice()
    );
    bench.assert_notice("known to ±0.5 m. 0 of 4 frames match");

    let open = bench.app.open().unwrap();
    assert_eq!(
        open.document.cameras[0].base().unwrap().sigma.position_m,
        Vec3::new(0.3, 0.4, 0.0)
    );
    assert_eq!(
        bench.statuses(),
        "SDSSN",
        "the clicked frame is the person's, of the last nothing was found"
    );
    for index in [0, 2, 3] {
        let frame = &open.document.frames[index];
        assert_eq!(
            frame.solution.as_ref().unwrap().source,
            Some(SolutionSource::Markings)
        );
        assert!((frame.ptz.as_ref().unwrap().pan_deg - (8.0 * index as f64 - 16.0)).abs() < 1e-9);
    }
    // The clicks decide in their frame, now that its camera stands somewhere.
    let clicked = &open.document.frames[1];
    assert_eq!(
        (
            clicked.clicks.len(),
            clicked.solution.as_ref().unwrap().source
        ),
        (2, Some(SolutionSource::Clicks))
    );
    assert!(
        (clicked.ptz.as_ref().unwrap().pan_deg + 8.0).abs() < 0.05,
        "{:?}",
        clicked.ptz
    );

    let with = without_counts(&open.document);
    bench.command(Command::Undo);
    assert!(!has_base(&bench.app));
    assert_eq!(bench.statuses(), "NDNNN");
    bench.command(Command::Redo);
    assert_eq!(without_counts(&bench.app.open().unwrap().document), with);
}

#[test]
fn where_it_abstains_it_says_why_and_which_view_is_missing() {
    let mut bench = Bench::new(unknown(5));
    let wanted = WantedClicks {
        frame: 3,
        landmarks: 2,
        named: Vec::new(),
    };
    let named = WantedClicks {
        named: vec!["corner_far_left".into(), "centre_mark".into()],
        ..wanted.clone()
    };
    let deciding = WantedClicks {
        landmarks: 1,
        named: vec!["halfway_far".into()],
        ..wanted.clone()
    };
    for (why, clicks, says) in [
        (
            Abstention::Uncertain {
                doubts: vec![Doubt::Rival],
                best: None,
            },
            Some(deciding),
            "No camera was found: the best answer is not certain (another position of the camera explains the paint nearly as \
             well). Wide views of both ends and of the middle are missing: add such frames, or click “Halfway line meets far \
             touchline” on frame 3 and look again.",
        ),
        (
            Abstention::NotConnected {
                frames: 40,
                connected: 7,
            },
            None,
            "No camera was found: only 7 of 40 frames overlap with each other. Add frames in which the camera pans from one \
             view to the next, all of one camera that does not move, or click 4 landmarks on 2 wide frames.",
        ),
        (
            Abstention::Uncertain {
                doubts: vec![Doubt::LinesMissing {
                    lines: vec!["Centre circle".to_owned()],
                }],
                best: None,
            },
            None,
            "No camera was found: the best answer is not certain (no paint lies where Centre circle should be). A view of \
             Centre circle is missing: add frames that show it, or click 2 landmarks far from each other and look again.",
        ),
        (
            Abstention::Uncertain {
                doubts: vec![Doubt::FewSnapped {
                    snapped: 3,
                    frames: 9,
                }],
                best: None,
            },
            Some(wanted),
            "No camera was found: the best answer is not certain (only 3 of 9 frames agree with the painted lines of their own \
             picture). Wide views of both ends and of the middle are missing: add such frames, or click 2 landmarks far \
             from each other on frame 3 and look again.",
        ),
        (
            Abstention::NothingFits,
            Some(named),
            "No camera was found: no position of the camera explains the painted lines: check the sport. Check that the field's \
             sport is the one in the pictures, or click “Corner, far left” and “Centre mark”, or two other landmarks far from each \
             other, on frame 3 and look again.",
        ),
    ] {
        bench.command(Command::FindCamera);
        let wanted_frame = clicks.as_ref().map(|clicks| clicks.frame);
        report(&mut bench, AutocalibrationAnswer::Abstained { why, clicks });
        assert_eq!(bench.last_notice(), says);
        let no_answer = &bench.app.operations.camera_search.no_answer;
        let NoAnswer { why, frame, .. } = no_answer.as_ref().unwrap();
        assert_eq!(*why, says);
        let frames = &bench.app.open().unwrap().document.frames;
        assert_eq!(*frame, wanted_frame.map(|index| frames[index].id.clone()));
    }
    assert!(
        !has_base(&bench.app) && bench.app.open().unwrap().history.next_undo().is_none(),
        "nothing was changed"
    );
    bench.command(Command::FindCamera);
    bench.report_end::<CameraSearch>(Err(Failure::Broken(Breakdown::Panicked(
        "the tripod fell".to_owned(),
    ))));
    let last = bench.app.session.messages.notices.last().unwrap();
    assert!(
        last.level == Level::Error && last.text.contains("the tripod fell"),
        "{last:?}"
    );
}
