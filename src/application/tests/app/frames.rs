//! Frames are accepted, rejected and gone to; their cameras and masks are changed.

use super::document;
use crate::bench::Bench;
use touchline_application::app::session::{Filter, PictureView};
use touchline_application::app::{
    Action, Command, EditAction, MaskList, MaskScope, Navigation, PointerAction, ViewAction,
};
use touchline_core::camera::{CameraBase, Ptz, PtzCamera, Radial};
use touchline_core::geometry::{ImagePoint, Vec3};
use touchline_core::testing::pixel_box;
use touchline_documents::document::{
    Frame, FrameStatus, ImportedCamera, RejectReason, SolutionSource,
};
use touchline_documents::testing::solved_by;

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
    bench.assert_notice("Press again");
    bench.command(Command::Undo);
    bench.command(Command::Undo);
    assert!(bench.frame().clicks.is_empty());
    assert_eq!(bench.frame().status, FrameStatus::New);
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
fn a_frame_imported_beside_its_camera_is_solved_on_it_and_undo_gives_back_what_came() {
    let mut document = document(1, true);
    let frame: &mut Frame = &mut document.frames[0];
    frame.status = FrameStatus::Suggested;
    frame.solution = solved_by(SolutionSource::Import);
    frame.point(Ptz::from_degrees(2.0, -14.0, 1500.0), Radial::default());
    let mut beside = document.ptz_camera(&document.frames[0]).unwrap();
    beside = PtzCamera::new(
        CameraBase {
            position_m: beside.base().position_m.add_scalar(0.2),
            ..*beside.base()
        },
        beside.ptz(),
    );
    let came = ImportedCamera::new(&beside, None, None).unwrap();
    let frame: &mut Frame = &mut document.frames[0];
    frame.ptz.as_mut().unwrap().imported = Some(Box::new(came.clone()));
    let mut bench = Bench::new(document);
    let shown = |bench: &Bench| bench.app.current().camera.unwrap();
    let base = bench.app.current().base.unwrap();
    let off_m = shown(&bench).base().position_m - beside.base().position_m;
    assert!(off_m.norm() < 1e-12, "it is shown as it came");
    for name in ["centre_mark", "halfway_far"] {
        bench.place(name);
    }
    assert_eq!(shown(&bench).base(), &base);
    let recorded = bench.frame().solution.as_ref().unwrap().imported.clone();
    assert_eq!(recorded, Some(came.clone()));
    bench.command(Command::Undo);
    bench.command(Command::Undo);
    let ptz = bench.frame().ptz.clone().unwrap();
    assert_eq!(ptz.imported.as_deref(), Some(&came));
    assert_eq!(shown(&bench).base().position_m, beside.base().position_m);
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
fn a_mask_of_one_frame_becomes_one_of_every_frame_in_one_step() {
    let mut bench = Bench::new(document(3, true));
    let score = pixel_box(40.0, 30.0, 300.0, 50.0);
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
