//! Wrong names in the application: found, marked, compared, mended in one step of undo; and written
//! into the document.

use crate::bench::Bench;
use touchline_application::app::session::Mode;
use touchline_application::app::{
    Action, App, Command, EditAction, Effect, Navigation, PointerAction,
};
use touchline_application::testing::base;
use touchline_calibration::calibrate::{FrameLookup, calibrate};
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::geometry::{Vec2, Vec3};
use touchline_core::solve::{IdentityKind, Verdict, WarningCode, judge};
use touchline_core::testing::seeded::{self, normal};
use touchline_core::testing::{SIZE, landmark_in, soccer};
use touchline_documents::document::{
    Click, Document, Frame, FrameStatus, Target, VideoFrame, document_from_bytes,
    document_to_string,
};
use touchline_documents::testing::{WithFrames, a_match, match_from, new_frame};

pub fn project() -> Document {
    match_from(&base(), SIZE)
}

/// A frame with clicks on landmarks, each named as the pair says, a little off.
fn frame(name: &str, ptz: Ptz, spots: &[(&str, &str)]) -> Frame {
    let field = soccer();
    let camera = PtzCamera::new(base(), ptz);
    let mut rng = seeded::rng(name);
    let mut frame = new_frame(name, SIZE);
    frame.clicks = spots
        .iter()
        .map(|(shown, named)| {
            let at = landmark_in(&camera, &field, shown);
            let off = Vec2::new(normal(&mut rng), normal(&mut rng));
            Click::landmark((*named).into(), at.translate(off))
        })
        .collect();
    frame.status = FrameStatus::Draft;
    frame
}

/// Centre mark and far end of the circle are exchanged.
pub fn swapped_frame() -> Frame {
    let ptz = Ptz::from_degrees(-12.0, -14.0, 2000.0);
    let spots = [
        ("halfway_far", "halfway_far"),
        ("centre_mark", "centre_circle_halfway_far"),
        ("centre_circle_halfway_far", "centre_mark"),
        ("penalty_area_far_left_front", "penalty_area_far_left_front"),
    ];
    frame("swapped.jpg", ptz, &spots)
}

fn open_document(document: Document) -> App {
    Bench::new(document).app
}

fn names(app: &App) -> Vec<String> {
    let named = app
        .frame()
        .unwrap()
        .clicks
        .iter()
        .filter_map(|click| click.target.as_ref());
    named.map(|target| target.as_str().to_owned()).collect()
}

#[test]
fn a_swap_is_marked_compared_and_mended_in_one_step() {
    let mut document = project();
    document.frames.push(swapped_frame().into());
    let mut app = open_document(document);
    let before = names(&app);
    let current = app.current();
    let judgement = current.judgement.clone().unwrap();
    assert_eq!(judgement.verdict, Verdict::Wrong);
    assert!(
        judgement
            .reason
            .starts_with("Points 2 and 3 look swapped: "),
        "{}",
        judgement.reason
    );
    assert_eq!(current.disputed, [1, 2]);
    let compared = current.alternative().unwrap().ptz();
    assert!((compared.pan.degrees() + 12.0).abs() < 0.1 && app.why_not(Command::Compare).is_none());

    let effects = app.update(Action::Command(Command::MendNames));
    assert_eq!(
        effects
            .iter()
            .filter(|effect| matches!(effect, Effect::Journal { .. }))
            .count(),
        1,
        "one step"
    );
    assert_eq!(
        names(&app)[1..3],
        ["centre_mark", "centre_circle_halfway_far"]
    );
    assert!(app.current().other_names().is_none() && app.current().disputed.is_empty());
    let mended = app.current().judgement.as_ref().unwrap();
    assert_eq!(mended.verdict, Verdict::Good, "{mended:?}");
    assert!(
        app.why_not(Command::MendNames).is_some(),
        "there is nothing left to mend"
    );
    app.update(Action::Command(Command::Undo));
    assert_eq!(names(&app), before);
    assert_eq!(
        app.session.messages.notices.last().unwrap().text,
        "Undone: Swap points 2 and 3."
    );
}

#[test]
fn the_correction_is_in_the_document() {
    let mut document = project();
    document.frames.push(swapped_frame().into());
    // A point without a name comes first: a dataset leaves it out, and the numbers follow.
    let unnamed = Click::without_name(document.frames[0].clicks[0].image);
    document.frames[0].clicks.insert(0, unnamed);
    let field = document.field.model("/nowhere".as_ref()).unwrap();
    let solved = calibrate(
        &document,
        &FrameLookup::from_document(&document),
        &document.frames[0],
        &field,
        0,
    )
    .unwrap();
    document.frames[0].record(&solved);
    let solution = document.frames[0].solution.clone().unwrap();
    assert_eq!(solution.disputed, [2, 3]);
    let renames = &solution.warnings[0].renames;
    assert_eq!(
        (renames[0].click, renames[0].target.clone()),
        (2, Target::Landmark("centre_mark".into()))
    );
    let text = document_to_string(&document).unwrap();
    assert!(text.contains("\"renames\""), "{text}");
    assert_eq!(document_from_bytes(text.as_bytes()).unwrap(), document);
    let dataset = document.into_dataset();
    let solution = dataset.frames[0].solution.as_ref().unwrap();
    let numbers: Vec<usize> = solution.warnings[0]
        .renames
        .iter()
        .map(|rename| rename.click)
        .collect();
    assert_eq!((numbers, &solution.disputed), (vec![1, 2], &vec![1, 2]));
}

/// A slow pan in a video: every second frame of the first 40 is solved and accepted.
fn panned_document() -> Document {
    let mut document = project();
    for index in 0..41 {
        let ptz = Ptz::from_degrees(-40.0 + 0.2 * index as f64, -12.0, 5000.0);
        let mut frame = frame(&format!("{index}.jpg"), ptz, &[]);
        frame.video = Some(VideoFrame::new("match.mp4", index, None));
        if index % 2 == 0 && index < 40 {
            frame.ptz = Some(touchline_documents::document::FramePtz::new(ptz, None));
            frame.status = FrameStatus::Reference;
        }
        document.frames.push(frame.into());
    }
    document
}

#[test]
fn two_clicks_of_another_part_are_given_away_by_where_the_camera_was() {
    let mut document = panned_document();
    let ptz = Ptz::from_degrees(-40.0 + 0.2 * 21.0, -12.0, 5000.0);
    let taken_for = [
        (
            "goal_area_far_left_goal_line",
            "penalty_area_far_left_goal_line",
        ),
        ("goal_area_far_left_front", "penalty_area_far_left_front"),
    ];
    let right = taken_for.map(|(shown, _)| (shown, shown));
    let field = document.field.model("/nowhere".as_ref()).unwrap();
    let solved = |document: &Document, spots: &[(&str, &str)]| {
        let clicked = frame("21.jpg", ptz, spots);
        let clicked = Frame {
            video: document.frames[21].video.clone(),
            ..clicked
        };
        calibrate(
            document,
            &FrameLookup::from_document(document),
            &clicked,
            &field,
            21,
        )
        .unwrap()
    };
    let fine = solved(&document, &right);
    assert!(
        fine.warnings
            .iter()
            .all(|warning| warning.code == WarningCode::Separation),
        "{:?}",
        fine.warnings
    );

    let wrong = solved(&document, &taken_for);
    let messages: Vec<&str> = wrong
        .warnings
        .iter()
        .map(|warning| warning.message.as_str())
        .collect();
    let jump = wrong
        .warnings
        .iter()
        .find(|warning| warning.code == WarningCode::Implausible)
        .unwrap();
    assert!(
        jump.message.contains("The focal length differs by"),
        "{messages:?}"
    );
    assert_ne!(judge(&wrong, SIZE).verdict, Verdict::Good);
    let found = wrong
        .identity
        .as_ref()
        .unwrap_or_else(|| panic!("{messages:?}"));
    assert!(
        matches!(found.kind, IdentityKind::OtherPart { .. }),
        "{found:?}"
    );
    assert!(
        (found.ptz.pan - ptz.pan).abs().degrees() < 0.2,
        "the other part is where the camera was"
    );

    // In another shot the camera may look anywhere: only the picture's own doubt remains.
    document.frames[21].clip = Some(touchline_documents::document::Clip::Number(2));
    let clicked = Frame {
        clip: document.frames[21].clip.clone(),
        ..frame("21.jpg", ptz, &taken_for)
    };
    let elsewhere = calibrate(
        &document,
        &FrameLookup::from_document(&document),
        &clicked,
        &field,
        21,
    )
    .unwrap();
    assert!(
        elsewhere
            .warnings
            .iter()
            .all(|warning| !warning.message.contains("A cut, or a wrong name?"))
    );
}

#[test]
fn a_camera_under_the_pitch_is_implausible() {
    let mut document = project();
    let below = CameraBase {
        position_m: Vec3::new(0.0, -60.0, -2.0),
        ..base()
    };
    document.cameras[0].set_base(&below);
    document.frames.push(swapped_frame().into());
    let field = document.field.model("/nowhere".as_ref()).unwrap();
    let Ok(solved) = calibrate(
        &document,
        &FrameLookup::from_document(&document),
        &document.frames[0],
        &field,
        0,
    ) else {
        return;
    };
    assert!(
        solved
            .warnings
            .iter()
            .any(|warning| warning.message.contains("2.0 m below the pitch"))
    );
    assert_ne!(judge(&solved, SIZE).verdict, Verdict::Good);
}

#[test]
fn a_frame_that_looks_wrong_is_accepted_only_after_a_question() {
    let mut document = project();
    document.frames.push(swapped_frame().into());
    document
        .frames
        .push(frame("next.jpg", Ptz::from_degrees(0.0, -14.0, 2000.0), &[]).into());
    let mut app = open_document(document.clone());
    assert_eq!(
        app.current().judgement.as_ref().unwrap().verdict,
        Verdict::Wrong
    );
    app.update(Action::Command(Command::Accept));
    assert_eq!(
        (app.session.frame, app.frame().unwrap().status),
        (0, FrameStatus::Draft),
        "it asks first"
    );
    let notice = app.session.messages.notices.last().unwrap();
    let offers: Vec<_> = notice.offers.iter().map(|(says, _)| *says).collect();
    assert_eq!(offers, ["Swap", "Accept anyway"], "{}", notice.text);
    assert!(
        notice.text.starts_with("Point ") && notice.text.ends_with("px off."),
        "{}",
        notice.text
    );
    app.update(Action::Command(Command::AcceptAnyway));
    let accepted = app.open().unwrap().frame(0).unwrap();
    assert_eq!(
        (app.session.frame, accepted.status),
        (1, FrameStatus::Reference)
    );
    assert!(
        !accepted.is_used_for_training(),
        "a wrong frame is not used for training by default"
    );
    assert!(
        !app.session.offers(Command::AcceptAnyway),
        "the question is answered"
    );

    // Pressing Enter twice accepts as well; after a change the question is shown again.
    let mut app = open_document(document);
    app.update(Action::Command(Command::AcceptAndStay));
    app.update(Action::Navigate(Navigation::Select(Some(0))));
    app.update(Action::Edit(EditAction::Nudge {
        dx_px: 0.1,
        dy_px: 0.0,
        held: false,
    }));
    app.update(Action::Command(Command::AcceptAndStay));
    assert_eq!(app.frame().unwrap().status, FrameStatus::Draft);
    app.update(Action::Command(Command::AcceptAndStay));
    assert_eq!(
        (app.session.frame, app.frame().unwrap().status),
        (0, FrameStatus::Reference)
    );
    // Mended, it is accepted at once.
    app.update(Action::Command(Command::Undo));
    app.update(Action::Command(Command::MendNames));
    assert!(app.why_not(Command::AcceptAnyway).is_some());
    app.update(Action::Command(Command::AcceptAndStay));
    assert!(app.frame().unwrap().is_used_for_training());
}

/// The number that the sentence about a wrong name says of a point is the one that the list of
/// points shows for it.
#[test]
fn a_point_has_one_residual_wherever_it_is_said() {
    let ptz = Ptz::from_degrees(-12.0, -14.0, 2000.0);
    let spots = [
        ("halfway_far", "halfway_far"),
        ("centre_mark", "centre_mark"),
        ("centre_circle_halfway_near", "centre_circle_halfway_far"),
        ("penalty_area_far_left_front", "penalty_area_far_left_front"),
    ];
    let mut document = project();
    document
        .frames
        .push(frame("renamed.jpg", ptz, &spots).into());
    let app = open_document(document);
    let finding = app.current().other_names().unwrap();
    assert_eq!(finding.renames.len(), 1, "{finding:?}");
    let listed = app
        .shown_values()
        .residual(finding.renames[0].click)
        .unwrap()
        .distance_px()
        .unwrap();
    let text = &app.judgement().unwrap().reason;
    assert!(
        text.contains(&format!("{listed:.0} px as named")),
        "{text} and {listed:.1} px in the list"
    );
}

#[test]
fn a_name_in_use_is_found_by_typing_it_and_taking_it_swaps_the_two() {
    let mut document = project();
    document.frames.push(swapped_frame().into());
    let mut app = open_document(document);
    let before = names(&app);
    app.update(Action::Navigate(Navigation::Select(Some(1))));
    app.update(Action::Command(Command::RenameClick));
    let offered = |app: &App| match &app.session.mode {
        Mode::Naming(naming) => naming
            .listed_candidates()
            .iter()
            .map(|name| (name.code.clone(), name.in_use))
            .collect(),
        _ => Vec::new(),
    };
    assert!(
        offered(&app).iter().all(|(_, in_use)| in_use.is_none()),
        "names in use are not offered unasked"
    );
    app.update(Action::Navigate(Navigation::TypeName("cm".to_owned())));
    assert_eq!(offered(&app)[0], ("cm".to_owned(), Some(2)));
    app.update(Action::Edit(EditAction::TakeName(0)));
    let mut swapped = before.clone();
    swapped.swap(1, 2);
    assert_eq!((names(&app), &app.session.mode), (swapped, &Mode::Idle));
    app.update(Action::Command(Command::Undo));
    assert_eq!(names(&app), before, "one step of undo");
}

#[test]
fn what_nothing_painted_marks_is_not_suggested_before_a_base_and_warned_of_when_typed() {
    let document = a_match(SIZE).with_pictures(["a.jpg"], SIZE);
    let mut app = open_document(document);
    let place = |app: &mut App, x: f64| {
        app.update(Action::Pointer(PointerAction::Press {
            at: touchline_core::geometry::ImagePoint::new(x, 500.0),
            on: None,
        }));
        app.update(Action::Pointer(PointerAction::Release));
    };
    place(&mut app, 700.0);
    let Mode::Naming(naming) = &app.session.mode else {
        panic!("{:?}", app.session.mode)
    };
    let of = |id: &str| {
        naming
            .candidates
            .iter()
            .find(|name| name.target.as_str() == id)
            .unwrap()
    };
    assert!(
        of("centre_circle_left").hidden
            && of("penalty_arc_apex_right").hidden
            && !of("centre_mark").hidden
    );
    assert_eq!(
        of("centre_circle_left").label,
        "Centre circle, left, level with its middle"
    );
    app.update(Action::Navigate(Navigation::TypeName("ccl".to_owned())));
    app.update(Action::Edit(EditAction::TakeName(0)));
    assert_eq!(names(&app), ["centre_circle_left"]);
    let warned = app.session.messages.notices.last().unwrap();
    assert!(
        warned.text.contains("is not where the curve looks widest"),
        "{}",
        warned.text
    );
    // With a base it is a name like others.
    let mut document = project();
    document.frames.push(new_frame("a.jpg", SIZE).into());
    let mut app = open_document(document);
    place(&mut app, 700.0);
    let Mode::Naming(naming) = &app.session.mode else {
        panic!("{:?}", app.session.mode)
    };
    assert!(naming.candidates.iter().all(|name| !name.hidden));
}
