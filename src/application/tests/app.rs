//! The application by actions, without a window: place, name, drag, undo, accept, reject.

use crate::bench::{Bench, SIZE, base, landmark_in};
use touchline_application::app::session::{
    Dialog, Filter, Leaving, Level, Mode, PictureView, Saving,
};
use touchline_application::app::{
    Action, App, Command, DiskReport, EditAction, Effect, MaskList, MaskScope, Navigation, Opened,
    PointerAction, Settings, Tool, ViewAction,
};
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::field::builtin;
use touchline_core::geometry::{ImagePoint, PixelBox, Vec3};
use touchline_documents::document::{
    Camera, Clip, Document, FieldSpec, Frame, FrameStatus, RejectReason, SolutionSource, Target,
};

/// The truth of frame `index`: a slow pan.
fn truth(index: usize) -> PtzCamera {
    PtzCamera::new(
        base(),
        Ptz::from_degrees(-4.0 + 0.6 * index as f64, -14.0, 2300.0),
    )
}

fn document(frames: usize, with_base: bool) -> Document {
    let mut document = Document::new(FieldSpec::new("soccer"));
    let mut camera = Camera::new("main".into(), SIZE);
    if with_base {
        camera.set_base(&base());
    }
    document.cameras.push(camera.into());
    for index in 0..frames {
        let mut frame = Frame::from_image(&format!("images/{index:04}.jpg"), "main".into(), SIZE);
        frame.clip = Some(Clip::Number(i64::from(index >= 4)));
        document.frames.push(frame.into());
    }
    document
}

impl Bench {
    /// Where a landmark is in the shown frame, by the truth.
    fn image_of(&self, landmark: &str) -> ImagePoint {
        landmark_in(&truth(self.app.session.frame), landmark)
    }

    /// Clicks a landmark and names it by its code where the list asks for it.
    fn place(&mut self, landmark: &str) {
        self.click(self.image_of(landmark));
        if let Mode::Naming(_) = self.app.session.mode {
            let code = builtin("soccer")
                .unwrap()
                .default_model()
                .unwrap()
                .landmark(landmark)
                .unwrap()
                .code
                .clone();
            self.act(Action::Navigate(Navigation::TypeName(code)));
            self.act(Action::Edit(EditAction::TakeName(0)));
        }
        let named = self.frame().clicks.last().unwrap().target.clone();
        assert_eq!(named, Some(Target::Landmark(landmark.into())));
    }

    fn frame(&self) -> &Frame {
        self.app.frame().unwrap()
    }

    fn ptz_error(&self) -> f64 {
        let (found, truth) = (
            self.frame().ptz.as_ref().unwrap().ptz(),
            truth(self.app.session.frame).ptz(),
        );
        (found.pan - truth.pan).abs().degrees()
            + (found.tilt - truth.tilt).abs().degrees()
            + (found.focal_px - truth.focal_px).abs()
    }
}

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
fn once_solved_a_third_click_takes_its_name_by_itself() {
    let mut bench = Bench::new(document(2, true));
    bench.place("centre_mark");
    bench.place("halfway_far");
    bench.click(bench.image_of("centre_circle_halfway_near"));
    assert_eq!(
        bench.app.session.mode,
        Mode::Idle,
        "no list: one name is plausible"
    );
    let target = bench.frame().clicks[2].target.clone();
    assert_eq!(
        target,
        Some(Target::Landmark("centre_circle_halfway_near".into()))
    );
}

#[test]
fn the_names_suggested_for_the_second_click_put_the_right_one_first_beside_a_solved_neighbour() {
    let mut bench = Bench::new(document(3, true));
    bench.place("centre_mark");
    bench.place("halfway_far");
    bench.command(Command::Accept);
    bench.click(bench.image_of("centre_mark"));
    if let Mode::Naming(naming) = &bench.app.session.mode {
        assert_eq!(naming.offered()[0].target.as_str(), "centre_mark");
        bench.act(Action::Edit(EditAction::TakeName(0)));
    }
    bench.click(bench.image_of("centre_circle_halfway_far"));
    let name = match &bench.app.session.mode {
        Mode::Naming(naming) => naming.offered()[0].target.clone(),
        _ => bench.frame().clicks[1].target.clone().unwrap(),
    };
    assert_eq!(name.as_str(), "centre_circle_halfway_far");
}

#[test]
fn in_a_new_shot_the_names_follow_where_the_camera_usually_looks() {
    let mut bench = Bench::new(document(6, true));
    for _ in 0..4 {
        bench.place("centre_mark");
        bench.place("halfway_far");
        bench.command(Command::Accept);
    }
    assert_eq!(
        bench.app.session.frame, 4,
        "the first frame of the second shot"
    );
    bench.click(bench.image_of("halfway_far"));
    let Mode::Naming(naming) = &bench.app.session.mode else {
        panic!("one click of a new shot is never certain")
    };
    assert!(
        naming
            .offered()
            .iter()
            .take(2)
            .any(|name| name.target.as_str() == "halfway_far"),
        "{naming:?}"
    );
    bench.act(Action::Edit(EditAction::Name {
        click: 0,
        target: Target::Landmark("halfway_far".into()),
    }));
    bench.click(bench.image_of("centre_circle_halfway_near"));
    let Mode::Naming(naming) = &bench.app.session.mode else {
        panic!("a camera of another shot vouches for no name")
    };
    assert_eq!(
        naming.offered()[0].target.as_str(),
        "centre_circle_halfway_near"
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

#[test]
fn undo_on_another_frame_goes_there_first() {
    let mut bench = Bench::new(document(3, true));
    bench.place("centre_mark");
    bench.act(Action::Navigate(Navigation::GoTo(2)));
    bench.command(Command::Undo);
    assert_eq!(bench.app.session.frame, 0);
    assert_eq!(
        bench.frame().clicks.len(),
        1,
        "the first press only goes there"
    );
    assert!(
        bench.last_notice().contains("Press again"),
        "{}",
        bench.last_notice()
    );
    bench.command(Command::Undo);
    bench.command(Command::Undo);
    assert!(bench.frame().clicks.is_empty());
    assert_eq!(bench.frame().status, FrameStatus::New);
}

#[test]
fn accept_is_refused_while_a_point_has_no_name_or_nothing_is_solved() {
    let mut bench = Bench::new(document(2, true));
    bench.command(Command::Accept);
    assert!(
        bench.last_notice().starts_with("Nothing to accept"),
        "{}",
        bench.last_notice()
    );
    bench.place("centre_mark");
    bench.place("halfway_far");
    bench.click(ImagePoint::new(3.0, 3.0));
    bench.act(Action::Pointer(PointerAction::Press {
        at: ImagePoint::new(900.0, 500.0),
        on: None,
    }));
    bench.command(Command::Accept);
    assert_eq!(bench.app.session.frame, 0);
    assert!(
        bench.last_notice().starts_with("Point 3 has no name. "),
        "{}",
        bench.last_notice()
    );
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

#[test]
fn points_on_lines_check_points_and_deleting() {
    let mut bench = Bench::new(document(1, true));
    bench.place("centre_mark");
    bench.command(Command::PlaceOnLine);
    let field = builtin("soccer").unwrap().default_model().unwrap();
    let on_touchline = truth(0)
        .image_from_world(field.line("touchline_far").unwrap().curve.point_at(0.55))
        .unwrap();
    bench.click(on_touchline);
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
    assert_eq!(bench.app.current().solved().unwrap().checks.len(), 1);
    bench.command(Command::DeleteClick);
    assert_eq!(bench.frame().clicks.len(), 3);
    assert_eq!(bench.app.session.points.selected, None);
}

#[test]
fn a_tool_stays_until_another_is_chosen() {
    let mut bench = Bench::new(document(1, true));
    let field = builtin("soccer").unwrap().default_model().unwrap();
    let on_line = |share: f64| {
        let line = &field.line("touchline_far").unwrap().curve;
        truth(0).image_from_world(line.point_at(share)).unwrap()
    };
    let take_touchline = |bench: &mut Bench| {
        let typed = Navigation::TypeName("touchline far".into());
        bench.act(Action::Navigate(typed));
        bench.act(Action::Edit(EditAction::TakeName(0)));
    };
    bench.command(Command::LineTool);
    for share in [0.45, 0.55] {
        bench.click(on_line(share));
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
    bench.click(on_line(0.5));
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
fn a_name_is_given_once_in_a_frame() {
    let mut bench = Bench::new(document(1, true));
    bench.place("centre_mark");
    bench.place("halfway_far");
    bench.act(Action::Edit(EditAction::Name {
        click: 1,
        target: Target::Landmark("centre_mark".into()),
    }));
    assert_eq!(
        bench.last_notice(),
        "Points 2 and 1 have swapped their names."
    );
    let named = |bench: &Bench, click: usize| bench.frame().clicks[click].target.clone();
    let [mark, far] = ["centre_mark", "halfway_far"].map(|id| Some(Target::Landmark(id.into())));
    assert_eq!([named(&bench, 0), named(&bench, 1)], [far, mark.clone()]);
    // A point without a name has none to give back.
    bench.click(ImagePoint::new(3.0, 3.0));
    bench.act(Action::Edit(EditAction::Name {
        click: 2,
        target: Target::Landmark("centre_mark".into()),
    }));
    assert!(
        bench.last_notice().contains("already point 2"),
        "{}",
        bench.last_notice()
    );
    assert_eq!([named(&bench, 1), named(&bench, 2)], [mark, None]);
}

#[test]
fn rejecting_a_shot_is_one_step() {
    let mut bench = Bench::new(document(7, true));
    bench.command(Command::RejectShot);
    bench.act(Action::Edit(EditAction::RejectAs(RejectReason::Replay)));
    let open = bench.app.open().unwrap();
    assert_eq!(open.count(FrameStatus::Rejected), 4);
    assert_eq!(bench.app.session.frame, 4, "on to the next shot");
    bench.command(Command::Undo);
    bench.command(Command::Undo);
    assert_eq!(bench.app.open().unwrap().count(FrameStatus::Rejected), 0);
}

#[test]
fn numbers_by_hand_move_the_overlay_in_one_step_and_clicks_can_decide_again() {
    let mut bench = Bench::new(document(1, true));
    bench.place("centre_mark");
    bench.place("halfway_far");
    let solved = bench.frame().ptz.clone();
    bench.act(Action::Edit(EditAction::Begin("Set pan")));
    for step in 1..=5 {
        bench.act(Action::Edit(EditAction::Ptz(Ptz::from_degrees(
            f64::from(step),
            -13.0,
            2000.0,
        ))));
    }
    bench.act(Action::Edit(EditAction::End));
    assert_eq!(bench.frame().ptz.as_ref().unwrap().pan_deg, 5.0);
    assert!(bench.app.current().by_hand);
    assert!((bench.app.current().camera.unwrap().ptz().pan.degrees() - 5.0).abs() < 1e-12);
    bench.act(Action::Edit(EditAction::SolveAgain));
    assert_eq!(bench.frame().ptz, solved);
    bench.command(Command::Undo);
    bench.command(Command::Undo);
    assert_eq!(bench.frame().ptz, solved);
    bench.act(Action::Edit(EditAction::Ptz(Ptz::from_degrees(
        f64::NAN,
        0.0,
        0.0,
    ))));
    assert_eq!(
        bench.frame().ptz,
        solved,
        "numbers that are none are not taken"
    );
}

#[test]
fn a_camera_change_solves_every_frame_that_clicks_solved() {
    let mut bench = Bench::new(document(2, true));
    bench.place("centre_mark");
    bench.place("halfway_far");
    let before = bench.frame().ptz.clone();
    bench.act(Action::Navigate(Navigation::GoTo(1)));
    let mut camera = bench.app.open().unwrap().document.cameras[0].clone();
    camera.position_m = Some(Vec3::new(0.0, -70.0, 20.0));
    bench.act(Action::Edit(EditAction::Begin("Set height")));
    bench.act(Action::Edit(EditAction::Camera(Box::new(
        (*camera).clone(),
    ))));
    bench.act(Action::Edit(EditAction::End));
    assert_ne!(bench.app.open().unwrap().frame(0).unwrap().ptz, before);
    bench.command(Command::Undo);
    bench.command(Command::Undo);
    assert_eq!(bench.app.open().unwrap().frame(0).unwrap().ptz, before);
}

#[test]
fn without_a_base_clicks_are_kept_and_the_error_says_what_is_missing() {
    let mut bench = Bench::new(document(1, false));
    bench.click(ImagePoint::new(500.0, 500.0));
    bench.act(Action::Navigate(Navigation::TypeName("cm".into())));
    bench.act(Action::Edit(EditAction::TakeName(0)));
    bench.click(ImagePoint::new(1500.0, 500.0));
    bench.act(Action::Navigate(Navigation::TypeName(
        "centre circle right".into(),
    )));
    bench.act(Action::Edit(EditAction::TakeName(0)));
    assert_eq!(bench.frame().clicks.len(), 2);
    let error = bench
        .app
        .current()
        .solution
        .as_ref()
        .unwrap()
        .as_ref()
        .unwrap_err()
        .to_string();
    assert!(error.contains("no position or base rotation"), "{error}");
}

#[test]
fn a_document_to_look_at_only_stays_as_it_is() {
    let mut bench = Bench::new(document(2, true));
    let mut opened = Opened::new(document(2, true), "/nowhere/project.json");
    opened.read_only = Some("another program has it open".into());
    opened.notices = vec![(Level::Warning, "3 edits recovered.".into())];
    bench.act(Action::Opened(Box::new(opened)));
    bench.effects.clear();
    bench.click(ImagePoint::new(500.0, 500.0));
    bench.act(Action::Edit(EditAction::SetComment("no".into())));
    assert_eq!(*bench.app.open().unwrap().document, document(2, true));
    assert!(bench.effects.is_empty());
    assert!(
        bench.last_notice().contains("another program has it open"),
        "{}",
        bench.last_notice()
    );
}

#[test]
fn closing_waits_until_everything_is_on_disk() {
    let mut bench = Bench::new(document(1, true));
    bench.place("centre_mark");
    bench.effects.clear();
    bench.act(Action::CloseRequested);
    let [Effect::Save { request }] = bench.effects[..] else {
        panic!("{:?}", bench.effects)
    };
    let revision = bench.app.open().unwrap().revision;
    bench.act(Action::Disk(DiskReport::Saved {
        revision: revision - 1,
        at: "1".into(),
        document: Some(request),
    }));
    assert!(!bench.effects.contains(&Effect::Close));
    // A write of before the request says nothing of what another program has done since.
    bench.act(Action::Disk(DiskReport::Saved {
        revision,
        at: "1".into(),
        document: Some(request - 1),
    }));
    assert!(!bench.effects.contains(&Effect::Close));
    bench.act(Action::Disk(DiskReport::Saved {
        revision,
        at: "2".into(),
        document: Some(request),
    }));
    assert!(bench.effects.contains(&Effect::Close));
}

#[test]
fn a_full_disk_is_said_and_edits_are_lost_only_by_saying_so() {
    let mut bench = Bench::new(document(1, true));
    bench.place("centre_mark");
    bench.act(Action::Disk(DiskReport::SaveFailed("disk full".into())));
    bench.effects.clear();
    bench.act(Action::CloseRequested);
    assert!(!bench.effects.contains(&Effect::Close));
    bench.act(Action::Disk(DiskReport::SaveFailed("disk full".into())));
    assert!(
        matches!(&bench.app.session.disk.saving, Saving::Failed { message, .. } if message == "disk full")
    );
    for _ in 0..2 {
        bench.act(Action::CloseRequested);
        assert!(!bench.effects.contains(&Effect::Close));
        assert_eq!(
            bench.app.session.dialog,
            Some(Dialog::NotSaved(Leaving::Close))
        );
    }
    bench.act(Action::LeaveUnsaved);
    assert!(bench.effects.contains(&Effect::Close));
}

#[test]
fn zoom_and_position_stay_from_frame_to_frame_and_filters_count() {
    let mut bench = Bench::new(document(6, true));
    let view = PictureView::Zoomed {
        scale: 6.0,
        centre: ImagePoint::new(700.0, 300.0),
    };
    bench.act(Action::View(ViewAction::Picture(view)));
    bench.command(Command::NextFrame);
    bench.command(Command::NextTenFrames);
    assert_eq!(bench.app.session.frame, 5);
    assert_eq!(bench.app.session.picture.view, view);
    bench.act(Action::View(ViewAction::SetFilter(Filter::Status(
        FrameStatus::Reference,
    ))));
    assert!(!bench.app.session.filter.shows(bench.frame()));
}

#[test]
fn escape_gives_up_what_is_being_opened() {
    let mut bench = Bench::new(document(1, true));
    bench.act(Action::Open("/match.mp4".into()));
    bench.act(Action::Disk(DiskReport::Progress(
        "Counting frames: 500…".into(),
    )));
    assert_eq!(
        bench.app.session.disk.opening.as_deref(),
        Some("Counting frames: 500…")
    );
    bench.command(Command::Cancel);
    assert!(bench.effects.contains(&Effect::CancelOpening));
    assert_eq!(bench.app.session.disk.opening, None);
    bench.act(Action::Disk(DiskReport::Progress(
        "Counting frames: 600…".into(),
    )));
    assert_eq!(
        bench.app.session.disk.opening, None,
        "a late word brings nothing back"
    );
}

#[test]
fn every_command_can_be_requested_at_any_time() {
    for document in [
        None,
        Some(document(0, true)),
        Some(document(3, false)),
        Some(document(3, true)),
    ] {
        let mut app = App::new(Settings::default());
        if let Some(document) = document {
            app.update(Action::Opened(Box::new(Opened::new(
                document,
                "/nowhere/project.json",
            ))));
        }
        for first in Command::all() {
            for second in Command::all() {
                app.update(Action::Command(first));
                app.update(Action::Command(second));
                app.update(Action::Pointer(PointerAction::Press {
                    at: ImagePoint::new(9.0, 9.0),
                    on: Some(7),
                }));
                app.update(Action::Pointer(PointerAction::Drag(ImagePoint::new(
                    f64::NAN,
                    9.0,
                ))));
                app.update(Action::Pointer(PointerAction::Release));
                app.update(Action::Edit(EditAction::TakeName(3)));
                app.update(Action::Edit(EditAction::RejectAs(RejectReason::Blur)));
                app.update(Action::Command(Command::Cancel));
            }
        }
    }
}

#[test]
fn a_mask_of_one_frame_becomes_one_of_every_frame_in_one_step() {
    let mut bench = Bench::new(document(3, true));
    let score = PixelBox {
        x: 40.0,
        y: 30.0,
        width: 300.0,
        height: 50.0,
    };
    bench.act(Action::Edit(EditAction::AddMask {
        of_camera: false,
        mask: score,
    }));
    let masks = |bench: &Bench| {
        let document = &bench.app.open().unwrap().document;
        (
            document.cameras[0].masks.clone(),
            document.frames[0].masks.clone(),
        )
    };
    bench.act(Action::Edit(EditAction::ScopeMask {
        list: MaskList::Frame,
        index: 0,
        scope: MaskScope::All,
    }));
    assert_eq!(masks(&bench), (vec![score], vec![]));
    bench.act(Action::Navigate(Navigation::GoTo(2)));
    bench.act(Action::Edit(EditAction::ScopeMask {
        list: MaskList::Camera,
        index: 7,
        scope: MaskScope::Frame,
    }));
    assert_eq!(
        masks(&bench),
        (vec![score], vec![]),
        "there is no such mask"
    );
    bench.act(Action::Navigate(Navigation::GoTo(0)));
    bench.command(Command::Undo);
    assert_eq!(masks(&bench), (vec![], vec![score]));
}
