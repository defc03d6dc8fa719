//! Points in the application that go to the paint that they name: part of the step that placed
//! them, and held off by Alt.

use crate::bench::Bench;
use touchline_application::app::operations::PointSnap;
use touchline_application::app::{Action, Command, EditAction, Effect, Navigation, PointerAction};
use touchline_application::testing::proposed::blank;
use touchline_application::testing::{base, landmark_in};
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::geometry::{ImagePoint, Vec2};
use touchline_core::testing::TestBase;
use touchline_documents::document::{Click, Target};
use touchline_vision::paint::SnappedPoint;

fn true_camera() -> PtzCamera {
    base().aim(-4.0, -14.0, 2300.0)
}

impl Bench {
    /// Places a landmark, landmark first, 3 px to the right of where the truth has it.
    fn place_beside(&mut self, landmark: &str, release: Action) -> ImagePoint {
        let at = landmark_in(&true_camera(), landmark).translate(Vec2::new(3.0, 0.0));
        self.act(Action::Edit(EditAction::Pick(Target::Landmark(
            landmark.into(),
        ))));
        self.act(Action::Pointer(PointerAction::Press { at, on: None }));
        self.act(release);
        at
    }

    /// The orders to look for points on the paint, so far.
    fn point_orders(&self) -> Vec<&PointSnap> {
        let orders = self.effects.iter().filter_map(|effect| match effect {
            Effect::Start(job) => job.operation::<PointSnap>(),
            _ => None,
        });
        orders.collect()
    }

    /// Reports that the clicks of the last order are painted where the truth has them.
    fn report(&mut self) {
        let order = self.last_job::<PointSnap>();
        let PointSnap { frame, clicks, .. } = order.operation().unwrap();
        let snapped = |click: &usize| {
            let landmark = frame.clicks[*click].target.as_ref().unwrap().as_str();
            (
                *click,
                SnappedPoint {
                    image: landmark_in(&true_camera(), landmark),
                    sigma_px: 0.4,
                },
            )
        };
        let found = clicks.iter().map(snapped).collect();
        self.report_end::<PointSnap>(Ok(found));
    }

    fn points(&self) -> &[Click] {
        &self.app.frame().unwrap().clicks
    }
}

#[test]
fn points_go_to_the_paint_once_there_is_a_camera_and_undo_takes_place_and_snap_back_together() {
    let mut bench = Bench::new(blank(1));
    let first = bench.place_beside("centre_mark", Action::Pointer(PointerAction::Release));
    assert!(
        bench.point_orders().is_empty(),
        "no camera says yet where lines run"
    );
    bench.place_beside("halfway_far", Action::Pointer(PointerAction::Release));
    assert_eq!(bench.point_orders().len(), 1);
    assert_eq!(bench.point_orders()[0].clicks, [0, 1]);
    bench.report();
    for click in bench.points() {
        let exact = landmark_in(&true_camera(), click.target.as_ref().unwrap().as_str());
        assert_eq!((click.image, click.snapped_sigma_px), (exact, Some(0.4)));
    }
    assert_eq!(bench.app.session.points.just_snapped, [0, 1]);
    assert_eq!(
        bench.point_orders().len(),
        1,
        "they are not looked for again"
    );
    // The noise that is left: of the paint's place in the picture, and of the place on the ground.
    let solved = bench.app.current().click_solution().unwrap();
    let place_px = bench
        .app
        .current()
        .field()
        .unwrap()
        .landmark("centre_mark")
        .unwrap()
        .place_sigma_px;
    assert!((solved.residuals[0].sigma_px - place_px.hypot(0.4)).abs() < 1e-12);
    assert!(
        place_px > 0.1
            && place_px
                < bench
                    .app
                    .current()
                    .field()
                    .unwrap()
                    .landmark("centre_mark")
                    .unwrap()
                    .click_sigma_px
    );
    bench.command(Command::Undo);
    assert_eq!(
        bench.points(),
        [Click::landmark("centre_mark".into(), first)],
        "one step"
    );
    bench.command(Command::Redo);
    assert_eq!(
        bench
            .points()
            .iter()
            .filter_map(|click| click.snapped_sigma_px)
            .count(),
        2
    );
    // Moved by hand it lies where it was put.
    bench.act(Action::Navigate(Navigation::Select(Some(0))));
    bench.act(Action::Edit(EditAction::Nudge {
        dx_px: 1.0,
        dy_px: 0.0,
        held: false,
    }));
    assert_eq!(bench.points()[0].snapped_sigma_px, None);
    assert_eq!(bench.point_orders().len(), 1, "arrows mean what they say");
}

#[test]
fn alt_and_the_setting_hold_it_off() {
    let mut bench = Bench::new(blank(1));
    bench.place_beside(
        "centre_mark",
        Action::Pointer(PointerAction::ReleaseExactly),
    );
    bench.place_beside(
        "halfway_far",
        Action::Pointer(PointerAction::ReleaseExactly),
    );
    assert!(bench.app.current().camera.is_some() && bench.point_orders().is_empty());
    // Also where the name comes after the point.
    let at = landmark_in(&true_camera(), "centre_circle_left");
    bench.act(Action::Pointer(PointerAction::Press { at, on: None }));
    bench.act(Action::Pointer(PointerAction::ReleaseExactly));
    bench.act(Action::Edit(EditAction::Name {
        click: 2,
        target: Target::Landmark("centre_circle_left".into()),
    }));
    assert!(bench.point_orders().is_empty());
    bench.command(Command::SnapPoints);
    assert!(!bench.app.settings.snap_points);
    bench.place_beside(
        "centre_circle_right",
        Action::Pointer(PointerAction::Release),
    );
    assert!(bench.point_orders().is_empty());
    bench.command(Command::SnapPoints);
    bench.act(Action::Pointer(PointerAction::Press { at, on: Some(2) }));
    bench.act(Action::Pointer(PointerAction::Release));
    assert!(
        bench
            .point_orders()
            .iter()
            .all(|order| !order.clicks.contains(&2)),
        "it was not moved"
    );
    bench.act(Action::Pointer(PointerAction::Press { at, on: Some(2) }));
    bench.act(Action::Pointer(PointerAction::Drag(
        at.translate(Vec2::new(2.0, 0.0)),
    )));
    bench.act(Action::Pointer(PointerAction::Release));
    assert!(
        bench.point_orders().last().unwrap().clicks.contains(&2),
        "a dropped point is looked for"
    );
}

#[test]
fn what_was_changed_meanwhile_stays_and_what_is_under_way_is_not_disturbed() {
    let mut bench = Bench::new(blank(2));
    bench.place_beside("centre_mark", Action::Pointer(PointerAction::Release));
    bench.place_beside("halfway_far", Action::Pointer(PointerAction::Release));
    bench.act(Action::Navigate(Navigation::Select(Some(0))));
    bench.act(Action::Edit(EditAction::Nudge {
        dx_px: 1.0,
        dy_px: 0.0,
        held: false,
    }));
    let nudged = bench.points()[0].clone();
    bench.report();
    assert_eq!(
        (
            &bench.points()[0],
            bench.point_orders().last().unwrap().clicks.as_slice()
        ),
        (&nudged, &[1][..])
    );
    bench.report();
    assert_eq!(
        (&bench.points()[0], bench.points()[1].snapped_sigma_px),
        (&nudged, Some(0.4))
    );
    // A report in the middle of a drag waits for its end.
    bench.place_beside(
        "centre_circle_left",
        Action::Pointer(PointerAction::Release),
    );
    let at = landmark_in(&true_camera(), "centre_circle_right");
    bench.act(Action::Edit(EditAction::Pick(Target::Landmark(
        "centre_circle_right".into(),
    ))));
    bench.act(Action::Pointer(PointerAction::Press { at, on: None }));
    bench.report();
    assert_eq!(bench.points()[2].snapped_sigma_px, None);
    bench.act(Action::Pointer(PointerAction::Release));
    assert_eq!(bench.point_orders().last().unwrap().clicks, [2, 3]);
    bench.report();
    assert!(
        bench.points()[2..]
            .iter()
            .all(|click| click.snapped_sigma_px.is_some())
    );
    // On another frame nothing is waited for.
    bench.act(Action::Navigate(Navigation::GoTo(1)));
    let orders = bench.point_orders().len();
    bench.act(Action::Pointer(PointerAction::Hover(None)));
    assert_eq!(bench.point_orders().len(), orders);
}

#[test]
fn numbers_set_by_hand_meanwhile_are_not_solved_away() {
    let mut bench = Bench::new(blank(1));
    bench.place_beside("centre_mark", Action::Pointer(PointerAction::Release));
    bench.place_beside("halfway_far", Action::Pointer(PointerAction::Release));
    bench.act(Action::Edit(EditAction::Begin("Set tilt")));
    bench.act(Action::Edit(EditAction::Ptz(Ptz::from_degrees(
        -4.0, -13.0, 2300.0,
    ))));
    bench.act(Action::Edit(EditAction::End));
    let before = bench.app.frame().unwrap().clone();
    bench.report();
    assert_eq!(*bench.app.frame().unwrap(), before);
    assert_eq!(bench.point_orders().len(), 1);
}
