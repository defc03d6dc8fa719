//! Shots of a video in the application: found when it is imported, changed cut by cut, each change
//! one step of undo.
#![cfg(feature = "opencv")]

use touchline_application::app::operation::{Failure, Job, Operation, Report};
use touchline_application::app::operations::{BurntInSearch, FoundShots, ShotSearch};
use touchline_application::app::session::Mode;
use touchline_application::app::{
    Action, App, Command, EditAction, Effect, Navigation, Opened, Settings,
};
use touchline_core::geometry::ImageSize;
use touchline_documents::document::{Document, FrameStatus, RejectReason, ShotKind};
use touchline_documents::testing::{WithFrames, a_match, new_video_frame};
use touchline_vision::media::MediaError;

const FRAMES: u64 = 30;

fn document() -> Document {
    let size = ImageSize::new(64, 36);
    a_match(size).with_frames((0..FRAMES).map(|index| new_video_frame("match.mp4", index, size)))
}

/// An application on a document, and the search for cuts that it requested.
fn open_document(document: Document) -> (App, Option<Job>) {
    let mut app = App::new(Settings::default());
    let effects = app.update(Action::Opened(Box::new(Opened::new(
        document,
        "/match/project.json",
    ))));
    let search = job_of::<ShotSearch>(&effects);
    (app, search)
}

/// The request of an operation among effects.
fn job_of<O: Operation>(effects: &[Effect]) -> Option<Job> {
    effects.iter().find_map(|effect| match effect {
        Effect::Start(job) if job.name() == O::NAME => Some(job.clone()),
        _ => None,
    })
}

/// A search has ended like this.
fn report_of(search: &Job, result: Result<FoundShots, MediaError>) -> Action {
    Action::Report(Report::from_result::<ShotSearch>(
        search.id(),
        result.map_err(Failure::Failed),
    ))
}

/// The same with two cuts found, the second one a fade.
fn with_shots() -> App {
    let (mut app, search) = open_document(document());
    let found = FoundShots {
        last: FRAMES - 1,
        cuts: vec![(10, ShotKind::Cut), (20, ShotKind::Fade)],
    };
    app.update(report_of(&search.unwrap(), Ok(found)));
    app
}

fn starts(app: &App) -> Vec<u64> {
    app.shots()
        .map(|shots| shots.starts().map(|(from, _)| from).collect())
        .unwrap_or_default()
}

fn undo(app: &mut App) {
    // The first press may go to the frame of the change.
    let before = starts(app);
    app.update(Action::Command(Command::Undo));
    if starts(app) == before {
        app.update(Action::Command(Command::Undo));
    }
}

#[test]
fn cuts_are_looked_for_when_a_video_is_imported_and_only_then() {
    let (app, search) = open_document(document());
    assert!(search.is_some());
    let search = app.operations.shot_search.running().unwrap();
    assert_eq!(
        (search.video.as_str(), search.path.as_path()),
        ("match.mp4", std::path::Path::new("/match/match.mp4"))
    );
    assert!(app.operations.shot_search.running().is_some() && app.shots().is_none());
    let mut labelled = document();
    labelled.frames[3].status = FrameStatus::Reference;
    assert_eq!(
        open_document(labelled).1,
        None,
        "a person has worked here: nothing is changed automatically"
    );
    let (again, none) = open_document((*with_shots().open().unwrap().document).clone());
    assert_eq!((starts(&again), none), (vec![0, 10, 20], None));
}

#[test]
fn shots_are_marked_in_one_step_once_a_drag_is_over() {
    let mut app = App::new(Settings::default());
    let effects = app.update(Action::Opened(Box::new(Opened::new(
        document(),
        "/match/project.json",
    ))));
    let [search, other] = [
        job_of::<ShotSearch>(&effects),
        job_of::<BurntInSearch>(&effects),
    ]
    .map(Option::unwrap);
    app.update(Action::Edit(EditAction::Begin("Pan")));
    let found = FoundShots {
        last: FRAMES - 1,
        cuts: vec![(10, ShotKind::Cut)],
    };
    app.update(report_of(
        &other,
        Ok(FoundShots {
            last: FRAMES - 1,
            cuts: vec![(12, ShotKind::Cut)],
        }),
    ));
    app.update(report_of(&search, Ok(found)));
    assert_eq!((starts(&app), &app.session.mode), (vec![], &Mode::Editing));
    app.update(Action::Edit(EditAction::End));
    assert_eq!(starts(&app), [0, 10]);
    undo(&mut app);
    assert_eq!(starts(&app), [0; 0]);
    assert!(
        app.open()
            .unwrap()
            .document
            .frames
            .iter()
            .all(|frame| frame.clip.is_none())
    );
}

#[test]
fn a_search_that_fails_says_so_and_one_that_is_stopped_does_not() {
    for (error, notices) in [
        (
            MediaError::Missing {
                path: "match.mp4".into(),
            },
            1,
        ),
        (
            MediaError::Stopped {
                path: "match.mp4".into(),
            },
            0,
        ),
    ] {
        let (mut app, search) = open_document(document());
        app.update(report_of(&search.unwrap(), Err(error)));
        assert_eq!(app.session.messages.notices.len(), notices);
        assert!(app.operations.shot_search.running().is_none());
    }
}

#[test]
fn a_cut_is_added_moved_and_removed() {
    let mut app = with_shots();
    app.update(Action::Navigate(Navigation::GoTo(15)));
    app.update(Action::Command(Command::AddCut));
    assert_eq!(starts(&app), [0, 10, 15, 20]);
    app.update(Action::Edit(EditAction::MoveCut { cut: 15, to: 17 }));
    assert_eq!(starts(&app), [0, 10, 17, 20]);
    app.update(Action::Edit(EditAction::MoveCut { cut: 17, to: 25 }));
    assert_eq!(starts(&app), [0, 10, 17, 20], "a cut does not pass another");
    app.update(Action::Navigate(Navigation::GoTo(18)));
    app.update(Action::Command(Command::RemoveCut));
    assert_eq!(starts(&app), [0, 10, 20]);
    app.update(Action::Navigate(Navigation::GoTo(2)));
    app.update(Action::Command(Command::RemoveCut));
    assert_eq!(starts(&app), [0, 10, 20], "before the first shot is none");
    for expected in [
        vec![0, 10, 17, 20],
        vec![0, 10, 15, 20],
        vec![0, 10, 20],
        vec![],
    ] {
        undo(&mut app);
        assert_eq!(starts(&app), expected);
    }
}

#[test]
fn a_whole_shot_is_rejected_in_one_step_and_stepped_over() {
    let mut app = with_shots();
    app.update(Action::Navigate(Navigation::GoTo(14)));
    app.update(Action::Command(Command::RejectShot));
    app.update(Action::Edit(EditAction::RejectAs(RejectReason::Replay)));
    let rejected = |app: &App| {
        let frames = &app.open().unwrap().document.frames;
        frames
            .iter()
            .enumerate()
            .filter(|(_, frame)| frame.status == FrameStatus::Rejected)
            .map(|(at, _)| at)
            .collect::<Vec<_>>()
    };
    assert_eq!(rejected(&app), (10..20).collect::<Vec<_>>());
    app.update(Action::Navigate(Navigation::GoTo(14)));
    app.update(Action::Command(Command::Undo));
    assert_eq!(rejected(&app), [0; 0]);
    app.update(Action::Command(Command::NextShot));
    assert_eq!(app.session.frame, 20);
    app.update(Action::Navigate(Navigation::GoTo(14)));
    app.update(Action::Command(Command::PreviousShot));
    app.update(Action::Command(Command::PreviousShot));
    assert_eq!(app.session.frame, 0);
}

#[test]
fn shots_are_stepped_through_where_the_document_lacks_their_first_frames() {
    let mut document = document();
    document.frames = document.frames.iter().step_by(4).cloned().collect();
    let (mut app, search) = open_document(document);
    let found = FoundShots {
        last: FRAMES - 1,
        cuts: vec![(10, ShotKind::Cut), (18, ShotKind::Cut)],
    };
    app.update(report_of(&search.unwrap(), Ok(found)));
    app.update(Action::Command(Command::LastFrame));
    for (command, number) in [
        (Command::PreviousShot, 20),
        (Command::PreviousShot, 12),
        (Command::PreviousShot, 0),
        (Command::NextShot, 12),
        (Command::NextShot, 20),
    ] {
        app.update(Action::Command(command));
        assert_eq!(app.frame().unwrap().video_frame_index(), Some(number));
    }
}

#[test]
fn nothing_is_accepted_before_its_picture_is_there() {
    let mut document = document();
    document.frames[4].ptz = Some(touchline_documents::document::FramePtz::new(
        touchline_core::camera::Ptz::from_degrees(1.0, -9.0, 900.0),
        None,
    ));
    document.frames[4].status = FrameStatus::Suggested;
    let (mut app, _) = open_document(document);
    app.update(Action::Navigate(Navigation::GoTo(4)));
    app.update(Action::PictureAwaited(true));
    app.update(Action::Command(Command::AcceptAndStay));
    assert_eq!(app.frame().unwrap().status, FrameStatus::Suggested);
    assert!(app.unacceptable().unwrap().contains("picture"));
    app.update(Action::PictureAwaited(false));
    app.update(Action::Command(Command::AcceptAndStay));
    assert_eq!(app.frame().unwrap().status, FrameStatus::Reference);
}

#[test]
fn undo_takes_back_what_a_person_did_before_what_was_found_meanwhile() {
    let (mut app, search) = open_document(document());
    app.update(Action::Navigate(Navigation::GoTo(3)));
    app.update(Action::Edit(EditAction::SetComment("mine".to_owned())));
    app.update(Action::Edit(EditAction::SetComment("undone".to_owned())));
    app.update(Action::Command(Command::Undo));
    let found = FoundShots {
        last: FRAMES - 1,
        cuts: vec![(10, ShotKind::Cut)],
    };
    let effects = app.update(report_of(&search.unwrap(), Ok(found)));
    assert_eq!(starts(&app), [0, 10]);
    let given = effects.iter().find_map(|effect| match effect {
        Effect::Journal { to, .. } => Some((&to.document, &to.history)),
        _ => None,
    });
    let given = given.expect("the saver is given the history as it is now");
    assert_eq!(
        given,
        (&*app.open().unwrap().document, &app.open().unwrap().history)
    );
    assert!(effects.contains(&Effect::WriteDocument), "and writes it");
    app.update(Action::Command(Command::Redo));
    assert_eq!(
        app.frame().unwrap().comment.as_deref(),
        Some("undone"),
        "redo stays"
    );
    for comment in [Some("mine"), None] {
        app.update(Action::Command(Command::Undo));
        assert_eq!(
            (app.frame().unwrap().comment.as_deref(), starts(&app)),
            (comment, vec![0, 10])
        );
    }
    undo(&mut app);
    assert_eq!(starts(&app), [0; 0]);
}

#[test]
fn cuts_set_while_the_search_runs_stay_on_top_of_those_found() {
    let (mut app, search) = open_document(document());
    let cut_at = |app: &mut App, frame| {
        app.update(Action::Navigate(Navigation::GoTo(frame)));
        app.update(Action::Command(Command::AddCut));
    };
    cut_at(&mut app, 5);
    cut_at(&mut app, 15);
    app.update(Action::Command(Command::Undo));
    let found = FoundShots {
        last: FRAMES - 1,
        cuts: vec![(10, ShotKind::Cut), (20, ShotKind::Cut)],
    };
    app.update(report_of(&search.unwrap(), Ok(found.clone())));
    assert_eq!(starts(&app), [0, 5, 10, 20]);
    app.update(Action::Command(Command::Redo));
    assert_eq!(starts(&app), [0, 5, 10, 15, 20]);
    for expected in [vec![0, 5, 10, 20], vec![0, 10, 20], vec![]] {
        undo(&mut app);
        assert_eq!(starts(&app), expected);
    }
    for expected in [vec![0, 10, 20], vec![0, 5, 10, 20], vec![0, 5, 10, 15, 20]] {
        app.update(Action::Command(Command::Redo));
        if starts(&app) != expected {
            app.update(Action::Command(Command::Redo));
        }
        assert_eq!(starts(&app), expected);
    }
    // A search at the user's command: what is joined while it runs stays joined.
    let effects = app.update(Action::Command(Command::FindShots));
    let again = job_of::<ShotSearch>(&effects).unwrap();
    app.update(Action::Navigate(Navigation::GoTo(11)));
    app.update(Action::Command(Command::RemoveCut));
    assert_eq!(starts(&app), [0, 5, 15, 20]);
    app.update(report_of(&again, Ok(found)));
    assert_eq!(starts(&app), [0, 5, 15, 20]);
}
