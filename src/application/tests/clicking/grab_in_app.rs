//! A drawn landmark or line is grabbed and dragged to where the picture shows it.

use crate::bench::Bench;
use touchline_application::app::session::{Filter, Mode};
use touchline_application::app::{Action, Command, EditAction, PointerAction};
use touchline_application::scene::drawn_element::ElementReach;
use touchline_application::testing::proposed::{blank, suggestions, truth};
use touchline_application::testing::{base, landmark_in};
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::geometry::ImagePoint;
use touchline_core::testing::{SIZE, TestBase, soccer};
use touchline_documents::document::{
    Click, Document, Frame, FramePtz, FrameStatus, RejectReason, SolutionSource, Target,
};
use touchline_documents::testing::{answered_by, solved_by};

const REACH: ElementReach = ElementReach {
    landmark_px: 12.0,
    line_px: 6.0,
};

/// The camera that the picture was taken with: it looks 50 px to the right of the frame's own.
fn picture_camera() -> PtzCamera {
    let own = truth(0);
    let turned_deg = (50.0 / own.focal_px).atan().to_degrees();
    base().aim(
        own.pan.degrees() + turned_deg,
        own.tilt.degrees(),
        own.focal_px,
    )
}

/// A frame with a camera of a source, off by 50 px, and no clicks.
fn off_by_50_px(source: SolutionSource) -> Document {
    let mut document = blank(2);
    let frame = &mut document.frames[0];
    frame.ptz = Some(FramePtz::new(truth(0), None));
    frame.status = FrameStatus::Draft;
    frame.solution = solved_by(source);
    document
}

fn frame(bench: &Bench) -> &Frame {
    bench.app.frame().unwrap()
}

fn ptz(bench: &Bench) -> Ptz {
    frame(bench).ptz.as_ref().unwrap().ptz()
}

/// Where the frame's camera draws a landmark.
fn drawn_place(bench: &Bench, landmark: &str) -> ImagePoint {
    landmark_in(&bench.app.current().camera.unwrap(), landmark)
}

impl Bench {
    /// Presses on what is drawn at a place, as the viewport does.
    fn press_drawn(&mut self, at: ImagePoint) {
        let found = self.app.grabbable(at, REACH).unwrap();
        self.act(Action::Pointer(PointerAction::Grab {
            at,
            element: found.target,
        }));
    }

    fn drag_to(&mut self, to: ImagePoint) {
        self.act(Action::Pointer(PointerAction::Drag(to)));
    }

    fn release(&mut self) {
        self.act(Action::Pointer(PointerAction::Release));
    }
}

#[test]
fn one_dragged_landmark_turns_any_camera_without_clicks_and_leaves_its_focal_length() {
    for source in [
        SolutionSource::Import,
        SolutionSource::Markings,
        SolutionSource::Forest,
        SolutionSource::Tracking,
        SolutionSource::Manual,
        SolutionSource::Interpolated,
    ] {
        let mut bench = Bench::new(off_by_50_px(source));
        let before = frame(&bench).clone();
        let from = drawn_place(&bench, "centre_mark");
        let to = landmark_in(&picture_camera(), "centre_mark");
        bench.press_drawn(ImagePoint::new(from.x + 4.0, from.y - 3.0));
        // Half the way, and the rest: the camera follows with each movement.
        bench.drag_to(ImagePoint::new(
            f64::midpoint(from.x, to.x),
            f64::midpoint(from.y, to.y),
        ));
        let halfway = ptz(&bench);
        bench.drag_to(to);
        let (own, wanted, now) = (truth(0), picture_camera().ptz(), ptz(&bench));
        assert!(
            own.pan < halfway.pan && halfway.pan < now.pan,
            "{source:?}: {halfway:?} {now:?}"
        );
        bench.release();
        assert_eq!(ptz(&bench), now, "{source:?}: the release changes nothing");
        let off_px = drawn_place(&bench, "centre_mark").distance_px(to);
        assert!(off_px < 1.0, "{source:?}: {off_px} px off");
        assert!(
            (now.focal_px / wanted.focal_px - 1.0).abs() < 0.005,
            "{source:?}: {now:?}"
        );
        // What lies far from the landmark comes along.
        let far = landmark_in(&picture_camera(), "halfway_far");
        let far_px = drawn_place(&bench, "halfway_far").distance_px(far);
        assert!(far_px < 5.0, "{source:?}: {far_px} px off");
        let clicks = &frame(&bench).clicks;
        assert_eq!(clicks.len(), 1);
        assert_eq!(
            clicks[0].target,
            Some(Target::Landmark("centre_mark".into()))
        );
        assert!(clicks[0].image.distance_px(to) < 1e-9);
        assert_eq!(bench.app.session.mode, Mode::Idle);

        bench.command(Command::Undo);
        let undone = Frame {
            revision: before.revision,
            ..frame(&bench).clone()
        };
        assert_eq!(undone, before, "{source:?}: one step");
        let history = &bench.app.open().unwrap().history;
        assert!(history.next_undo().is_none(), "{source:?}");
    }
}

#[test]
fn without_its_click_the_frame_has_the_camera_that_it_had() {
    let mut bench = Bench::new(off_by_50_px(SolutionSource::Import));
    let before = frame(&bench).ptz.clone();
    bench.press_drawn(drawn_place(&bench, "centre_mark"));
    bench.drag_to(landmark_in(&picture_camera(), "centre_mark"));
    bench.release();
    assert_ne!(frame(&bench).ptz, before);
    bench.act(Action::Edit(EditAction::DeleteClick(0)));
    assert_eq!(frame(&bench).ptz, before);
    assert_eq!(frame(&bench).source(), Some(SolutionSource::Import));
}

#[test]
fn a_second_dragged_landmark_determines_the_camera_by_clicks() {
    let mut bench = Bench::new(off_by_50_px(SolutionSource::Import));
    for landmark in ["centre_mark", "halfway_far"] {
        bench.press_drawn(drawn_place(&bench, landmark));
        bench.drag_to(landmark_in(&picture_camera(), landmark));
        bench.release();
    }
    assert!(frame(&bench).is_solved_by_clicks());
    let (now, wanted) = (ptz(&bench), picture_camera().ptz());
    assert!((now.pan - wanted.pan).abs().degrees() < 1e-6, "{now:?}");
    assert!((now.focal_px - wanted.focal_px).abs() < 1e-3, "{now:?}");
}

#[test]
fn a_dragged_line_is_a_click_on_that_line() {
    let mut bench = Bench::new(off_by_50_px(SolutionSource::Import));
    let field = soccer();
    let mark = field.landmark_in_world(field.landmark("centre_mark").unwrap());
    let on_line = mark + touchline_core::geometry::Vec3::new(0.0, 5.0, 0.0);
    let camera = bench.app.current().camera.unwrap();
    let from = camera.image_from_world(on_line).unwrap();
    bench.press_drawn(from);
    let to = ImagePoint::new(from.x - 50.0, from.y);
    bench.drag_to(to);
    bench.release();
    let click = &frame(&bench).clicks[0];
    assert_eq!(click.target, Some(Target::Line("halfway_line".into())));
    let now = bench.app.current().camera.unwrap();
    let off_px = now.image_from_world(on_line).unwrap().distance_px(to);
    assert!(off_px < 5.0, "the line runs through the pointer: {off_px}");
    assert!((now.ptz().focal_px / 2300.0 - 1.0).abs() < 0.01);
}

#[test]
fn escape_during_the_drag_takes_it_back() {
    let mut bench = Bench::new(off_by_50_px(SolutionSource::Import));
    let before = frame(&bench).clone();
    bench.press_drawn(drawn_place(&bench, "centre_mark"));
    bench.drag_to(landmark_in(&picture_camera(), "centre_mark"));
    assert_ne!(ptz(&bench), truth(0));
    bench.command(Command::Cancel);
    assert_eq!(*frame(&bench), before);
    assert_eq!(bench.app.session.mode, Mode::Idle);
    bench.drag_to(ImagePoint::new(5.0, 5.0));
    bench.release();
    assert_eq!(*frame(&bench), before, "the button is still down");
    assert!(bench.app.open().unwrap().history.next_undo().is_none());
}

#[test]
fn a_press_without_a_drag_places_a_point_as_everywhere() {
    let places = [-4.0, 0.0].map(|off| {
        let grabs = off == 0.0;
        let mut bench = Bench::new(suggestions(&[Some(0.9)]));
        let at = drawn_place(&bench, "centre_mark");
        let at = ImagePoint::new(at.x + 3.0, at.y);
        if grabs {
            bench.press_drawn(at);
            bench.release();
        } else {
            bench.click(at);
        }
        let frame = frame(&bench);
        (frame.clicks.clone(), frame.ptz.clone(), frame.status)
    });
    assert_eq!(places[0], places[1]);
    assert_eq!(places[0].0.len(), 1);
}

#[test]
fn the_own_clicks_take_part_in_the_solve() {
    let mut document = off_by_50_px(SolutionSource::Clicks);
    let own = PtzCamera::new(base(), truth(0));
    let frame_mut = &mut document.frames[0];
    for landmark in ["centre_mark", "halfway_far"] {
        let at = landmark_in(&own, landmark);
        frame_mut.clicks.push(Click::landmark(landmark.into(), at));
    }
    let mut bench = Bench::new(document);
    let from = drawn_place(&bench, "centre_circle_left");
    bench.press_drawn(from);
    bench.drag_to(ImagePoint::new(from.x - 6.0, from.y));
    bench.release();
    assert_eq!(frame(&bench).clicks.len(), 3);
    assert!(frame(&bench).is_solved_by_clicks());
    let solved = bench.app.current().click_solution().unwrap();
    assert_eq!(solved.redundancy, 3, "no prior among six equations");
}

#[test]
fn where_nothing_of_the_frames_own_camera_is_drawn_there_is_nothing_to_grab() {
    let at = landmark_in(&PtzCamera::new(base(), truth(0)), "centre_mark");
    let grabs = |bench: &Bench| bench.app.grabbable(at, REACH).is_some();

    // Without a base, and without a camera.
    let mut document = off_by_50_px(SolutionSource::Import);
    document.cameras[0].position_m = None;
    assert!(!grabs(&Bench::new(document)));
    assert!(!grabs(&Bench::new(blank(1))));

    let mut bench = Bench::new(off_by_50_px(SolutionSource::Import));
    assert!(grabs(&bench));
    let beside = ImagePoint::new(at.x + 60.0, at.y + 35.0);
    assert_eq!(bench.app.grabbable(beside, REACH), None);
    for command in [
        Command::HideOverlay,
        Command::ShowMasks,
        Command::PlaceOnLine,
    ] {
        bench.command(command);
        assert!(!grabs(&bench), "{command:?}");
        bench.command(command);
        assert!(grabs(&bench), "{command:?}");
    }
    bench.command(Command::Reject);
    assert!(!grabs(&bench), "a reason is to be chosen");
    bench.act(Action::Edit(EditAction::RejectAs(RejectReason::Blur)));
    bench.act(Action::Navigate(
        touchline_application::app::Navigation::GoTo(0),
    ));
    assert!(!grabs(&bench), "rejected");
    assert!(Filter::All.shows(frame(&bench)) && SIZE.contains(at));
}

#[cfg(feature = "opencv")]
#[test]
fn doubtful_frames_beside_a_dragged_one_follow_it() {
    use touchline_application::app::Effect;
    use touchline_application::app::operation::Operation as _;
    use touchline_application::app::operations::ClipTracking;

    let tracks = |confidence: Option<f64>| {
        let mut document = off_by_50_px(SolutionSource::Markings);
        let neighbour = &mut document.frames[1];
        neighbour.ptz = Some(FramePtz::new(truth(0), None));
        neighbour.status = FrameStatus::Suggested;
        neighbour.solution = answered_by(SolutionSource::Markings, confidence);
        let mut bench = Bench::new(document);
        bench.press_drawn(drawn_place(&bench, "centre_mark"));
        bench.drag_to(landmark_in(&picture_camera(), "centre_mark"));
        let starts = |bench: &Bench| {
            let is_tracking = |effect: &Effect| matches!(effect, Effect::Start(job) if job.name() == ClipTracking::NAME);
            bench.effects.iter().any(is_tracking)
        };
        assert!(!starts(&bench), "not before the release");
        bench.release();
        starts(&bench)
    };
    assert!(tracks(Some(0.3)));
    assert!(!tracks(Some(0.99)));
}
