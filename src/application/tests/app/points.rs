//! Points are placed, solve a frame, are dragged and deleted.

use super::{document, truth};
use crate::bench::Bench;
use touchline_application::app::session::{Mode, Saving};
use touchline_application::app::{
    Action, Command, DiskReport, EditAction, Effect, Navigation, PointerAction, Tool,
};
use touchline_core::geometry::ImagePoint;
use touchline_core::testing::soccer;
use touchline_documents::document::{Frame, FrameStatus, SolutionSource, Target};

#[test]
fn two_clicks_solve_a_frame_and_enter_accepts_it() {
    let mut bench = Bench::new(document(6, true));
    bench.place("centre_mark");
    assert_eq!(bench.frame().status, FrameStatus::Draft);
    assert!(bench.frame().ptz.is_none());
    bench.place("centre_circle_halfway_far");
    assert!(bench.ptz_error() < 1e-6, "{}", bench.ptz_error());
    assert!(bench.app.current().judgement.is_some());
    assert_eq!(
        bench.frame().solution.as_ref().unwrap().source,
        Some(SolutionSource::Clicks)
    );
    bench.command(Command::Accept);
    assert_eq!(
        bench.app.session.frame, 1,
        "on to the next that needs a person"
    );
    let accepted = bench.app.open().unwrap().frame(0).unwrap();
    assert_eq!(accepted.status, FrameStatus::Reference);
    let journalled = bench
        .effects
        .iter()
        .filter(|effect| matches!(effect, Effect::Journal { .. }))
        .count();
    assert!(
        journalled >= 4,
        "every edit goes to the journal at once: {journalled}"
    );
    assert_eq!(bench.app.session.disk.saving, Saving::Pending);
    let revision = bench.app.open().unwrap().revision;
    bench.act(Action::Disk(DiskReport::Saved {
        revision,
        at: "12:03:41".into(),
        document: Some(0),
    }));
    assert_eq!(
        bench.app.session.disk.saving,
        Saving::Saved {
            at: "12:03:41".into()
        }
    );
}

#[test]
fn escape_takes_a_stray_click_back_with_what_it_did_to_an_accepted_frame() {
    let mut bench = Bench::new(document(2, true));
    bench.place("centre_mark");
    bench.place("centre_circle_halfway_far");
    bench.command(Command::AcceptAndStay);
    let accepted = bench.frame().clone();
    assert_eq!(accepted.status, FrameStatus::Reference);
    // The click lies on a landmark that the frame's camera projects, and names itself.
    bench.click(bench.image_of("halfway_far"));
    assert_eq!(bench.app.session.mode, Mode::Idle);
    assert_eq!(bench.frame().status, FrameStatus::Draft);
    bench.command(Command::Cancel);
    let now = bench.frame();
    assert_eq!((now.status, now.clicks.len()), (FrameStatus::Reference, 2));
    assert_eq!(now.ptz, accepted.ptz);
    // Nothing was placed since: the next press only lets go.
    bench.command(Command::Cancel);
    assert_eq!(bench.frame().clicks.len(), 2);
}

#[test]
fn landmark_first_shows_the_field_while_the_pointer_moves() {
    let mut bench = Bench::new(document(1, true));
    bench.place("centre_mark");
    bench.act(Action::Edit(EditAction::Pick(Target::Landmark(
        "halfway_far".into(),
    ))));
    assert!(matches!(bench.app.session.mode, Mode::Placing(_)));
    let at = bench.image_of("halfway_far");
    bench.act(Action::Pointer(PointerAction::Hover(Some(at))));
    let preview = bench.app.current().preview.unwrap().ptz();
    assert!((preview.focal_px - 2300.0).abs() < 1e-6);
    bench.click(at);
    assert!(bench.ptz_error() < 1e-6);
    assert!(bench.app.current().preview.is_none());
}

/// The image of a point of the far touchline, at a share of its length.
fn on_far_touchline(share: f64) -> ImagePoint {
    let field = soccer();
    let line = &field.line("touchline_far").unwrap().curve;
    truth(0).image_from_world(line.point_at(share)).unwrap()
}

#[test]
fn points_on_lines_check_points_and_deleting() {
    let mut bench = Bench::new(document(1, true));
    bench.place("centre_mark");
    bench.command(Command::PlaceOnLine);
    bench.click(on_far_touchline(0.55));
    bench.act(Action::Navigate(Navigation::TypeName(
        "touchline far".into(),
    )));
    bench.act(Action::Edit(EditAction::TakeName(0)));
    assert_eq!(
        bench.frame().clicks[1].target,
        Some(Target::Line("touchline_far".into()))
    );
    bench.place("halfway_far");
    assert!(bench.ptz_error() < 1e-6);
    bench.place("centre_circle_right");
    bench.act(Action::Navigate(Navigation::Select(Some(3))));
    bench.command(Command::ToggleCheck);
    assert!(bench.frame().clicks[3].check);
    assert_eq!(
        bench.app.current().click_solution().unwrap().checks.len(),
        1
    );
    bench.command(Command::DeleteClick);
    assert_eq!(bench.frame().clicks.len(), 3);
    assert_eq!(bench.app.session.points.selected, None);
}

#[test]
fn one_point_is_on_a_line_also_where_its_name_is_certain() {
    let mut bench = Bench::new(document(1, true));
    bench.place("centre_mark");
    bench.place("halfway_far");
    bench.command(Command::PlaceOnLine);
    bench.click(on_far_touchline(0.55));
    assert_eq!(
        bench.frame().clicks[2].target,
        Some(Target::Line("touchline_far".into()))
    );
    assert_eq!(bench.app.session.mode, Mode::Idle);
    assert!(!bench.app.session.is_next_on_line());
}

#[test]
fn a_tool_stays_until_another_is_chosen() {
    let mut bench = Bench::new(document(1, true));
    let take_touchline = |bench: &mut Bench| {
        let typed = Navigation::TypeName("touchline far".into());
        bench.act(Action::Navigate(typed));
        bench.act(Action::Edit(EditAction::TakeName(0)));
    };
    bench.command(Command::LineTool);
    for share in [0.45, 0.55] {
        bench.click(on_far_touchline(share));
        take_touchline(&mut bench);
    }
    let names: Vec<_> = bench
        .frame()
        .clicks
        .iter()
        .map(|click| &click.target)
        .collect();
    let touchline = Some(Target::Line("touchline_far".into()));
    assert_eq!(names, [&touchline, &touchline]);

    bench.command(Command::CheckTool);
    bench.place("halfway_far");
    bench.command(Command::PointTool);
    bench.place("centre_mark");
    let checks: Vec<bool> = bench
        .frame()
        .clicks
        .iter()
        .map(|click| click.check)
        .collect();
    assert_eq!(checks, [false, false, true, false]);

    // Nothing is placed, and a point is deselected; a name that was chosen first is placed.
    bench.command(Command::SelectTool);
    bench.click(on_far_touchline(0.5));
    assert_eq!(
        (
            bench.frame().clicks.len(),
            bench.app.session.points.selected
        ),
        (4, None)
    );
    let chosen = Target::Landmark("centre_circle_right".into());
    bench.act(Action::Edit(EditAction::Pick(chosen)));
    bench.click(bench.image_of("centre_circle_right"));
    assert_eq!(bench.frame().clicks.len(), 5);
    bench.command(Command::Cancel);
    assert_eq!(bench.app.session.picture.tool, Tool::Point);
}

#[test]
fn escape_takes_a_point_without_a_name_away() {
    let mut bench = Bench::new(document(1, true));
    bench.click(ImagePoint::new(300.0, 300.0));
    assert!(matches!(bench.app.session.mode, Mode::Naming(_)));
    bench.command(Command::Cancel);
    assert!(bench.frame().clicks.is_empty());
}

#[test]
fn escape_after_a_stray_click_leaves_an_accepted_frame_accepted() {
    let mut bench = Bench::new(document(1, true));
    bench.place("centre_mark");
    bench.place("halfway_far");
    bench.command(Command::AcceptAndStay);
    let accepted = bench.frame().clone();
    assert_eq!(accepted.status, FrameStatus::Reference);
    bench.click(ImagePoint::new(300.0, 300.0));
    assert_eq!(bench.frame().status, FrameStatus::Draft);
    bench.command(Command::Cancel);
    let revision = bench.frame().revision;
    assert_eq!(
        *bench.frame(),
        Frame {
            revision,
            ..accepted
        }
    );
}

#[test]
fn a_drag_is_one_step_and_escape_is_none() {
    let mut bench = Bench::new(document(1, true));
    bench.place("centre_mark");
    bench.place("halfway_far");
    let before = bench.frame().clone();
    let at = before.clicks[1].image;
    bench.act(Action::Pointer(PointerAction::Press { at, on: Some(1) }));
    for step in 1..20 {
        bench.act(Action::Pointer(PointerAction::Drag(ImagePoint::new(
            at.x + f64::from(step),
            at.y,
        ))));
        assert_ne!(bench.frame().ptz, before.ptz, "the overlay follows");
    }
    bench.act(Action::Pointer(PointerAction::Release));
    let dragged = bench.frame().clone();
    assert_eq!(dragged.clicks[1].image.x, at.x + 19.0);
    bench.command(Command::Undo);
    assert_eq!(
        Frame {
            revision: before.revision,
            ..bench.frame().clone()
        },
        before
    );
    bench.command(Command::Redo);
    assert_eq!(
        Frame {
            revision: dragged.revision,
            ..bench.frame().clone()
        },
        dragged
    );
    assert!(bench.frame().revision > dragged.revision, "each is an edit");
    let steps = bench.app.open().unwrap().history.next_undo().cloned();
    bench.act(Action::Pointer(PointerAction::Press {
        at: dragged.clicks[1].image,
        on: Some(1),
    }));
    bench.act(Action::Pointer(PointerAction::Drag(ImagePoint::new(
        5.0, 5.0,
    ))));
    bench.command(Command::Cancel);
    assert_eq!(
        Frame {
            revision: dragged.revision,
            ..bench.frame().clone()
        },
        dragged
    );
    assert!(bench.frame().revision > dragged.revision, "each is an edit");
    assert_eq!(
        bench.app.open().unwrap().history.next_undo().cloned(),
        steps
    );
    bench.act(Action::Pointer(PointerAction::Press {
        at: dragged.clicks[1].image,
        on: Some(1),
    }));
    bench.act(Action::Pointer(PointerAction::Release));
    assert_eq!(
        bench.app.open().unwrap().history.next_undo().cloned(),
        steps,
        "a press without a move is no step"
    );
}
