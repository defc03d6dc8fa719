//! The quality page in the application: what it derives and when, what it leaves alone, the way to
//! a frame and back.

use crate::bench::Bench;
use touchline_application::app::quality::TimeAxis;
use touchline_application::app::session::SidePanel;
use touchline_application::app::{Action, Command, EditAction, Navigation, ViewAction};
use touchline_application::testing::base;
use touchline_core::camera::Ptz;
use touchline_core::geometry::ImagePoint;
use touchline_core::solve::Verdict;
use touchline_core::testing::SIZE;
use touchline_documents::document::{Camera, Click, Clip, Document, Frame, FrameStatus};
use touchline_documents::testing::{ptz_at, soccer_document};

/// Two cameras alternately, a slow pan of each; the fifth frame of the first looks elsewhere.
fn document() -> Document {
    let mut document = soccer_document();
    for name in ["main", "high"] {
        let mut camera = Camera::new(name.into(), SIZE);
        camera.set_base(&base());
        document.cameras.push(camera.into());
    }
    for index in 0..20 {
        let name = if index % 2 == 0 { "main" } else { "high" };
        let mut frame = Frame::from_image(&format!("{index:04}.jpg"), name.into(), SIZE);
        // Of one shot: they follow each other in time.
        frame.clip = Some(Clip::Number(1));
        let pan_deg = if index == 8 {
            30.0
        } else {
            0.1 * f64::from(index)
        };
        frame.ptz = ptz_at(pan_deg, -12.0, 2000.0);
        frame.status = FrameStatus::Reference;
        frame.clicks.push(Click::landmark(
            "centre_mark".into(),
            ImagePoint::new(900.0, 500.0),
        ));
        document.frames.push(frame.into());
    }
    document
}

/// A point's pan in tenths of a degree.
fn pan(bench: &Bench, point: usize) -> i64 {
    (10.0 * bench.app.quality().course.points[point].values[0]).round() as i64
}

#[test]
fn an_accepted_frame_off_its_neighbours_way_is_to_be_looked_at() {
    let mut document = document();
    for frame in &mut document.frames {
        frame.clicks.clear();
    }
    let mut bench = Bench::new(document);
    bench.act(Action::Navigate(Navigation::GoTo(8)));
    let judgement = bench.app.judgement().unwrap();
    assert_eq!(judgement.verdict, Verdict::Check);
    assert!(
        judgement
            .reason
            .ends_with("px off the way between the frames before and after it"),
        "{judgement:?}"
    );
    bench.act(Action::Navigate(Navigation::GoTo(6)));
    assert_eq!(
        bench.app.judgement(),
        None,
        "nothing speaks against it, nor for it"
    );
    bench.act(Action::Navigate(Navigation::GoTo(8)));
    bench.act(Action::Edit(EditAction::Begin("Pan")));
    bench.act(Action::Edit(EditAction::Ptz(Ptz::from_degrees(
        0.8, -12.0, 2000.0,
    ))));
    bench.act(Action::Edit(EditAction::End));
    assert!(
        !bench.app.judgement().unwrap().reason.contains("px off"),
        "{:?}",
        bench.app.judgement()
    );
}

#[test]
fn nothing_is_derived_while_the_page_is_closed_and_what_changes_is_derived_again() {
    let mut bench = Bench::new(document());
    assert!(bench.app.quality().course.points.is_empty());
    bench.command(Command::QualityPage);
    assert_eq!(bench.app.quality().camera, Some("main".into()));
    assert_eq!(
        (bench.app.quality().course.points.len(), pan(&bench, 4)),
        (10, 300)
    );
    assert_eq!(bench.app.quality().course.standing_out, [4]);
    bench.act(Action::Navigate(Navigation::LookAt {
        frame: 8,
        click: Some(0),
    }));
    assert!(!bench.app.session.quality.open && bench.app.quality().course.points.is_empty());
    assert_eq!(
        (bench.app.session.frame, bench.app.session.points.selected),
        (8, Some(0))
    );
    bench.act(Action::Edit(EditAction::Begin("Pan")));
    bench.act(Action::Edit(EditAction::Ptz(Ptz::from_degrees(
        0.8, -12.0, 2000.0,
    ))));
    bench.act(Action::Edit(EditAction::End));
    bench.command(Command::QualityPage);
    assert_eq!(pan(&bench, 4), 8);
    assert!(bench.app.quality().course.standing_out.is_empty());
}

#[test]
fn the_page_speaks_of_one_camera_and_another_document_closes_it() {
    let mut bench = Bench::new(document());
    bench.act(Action::Navigate(Navigation::GoTo(3)));
    bench.command(Command::QualityPage);
    assert_eq!(
        bench.app.quality().camera,
        Some("high".into()),
        "the shown frame's"
    );
    bench.act(Action::View(ViewAction::SetQualityCamera("main".into())));
    assert_eq!(bench.app.quality().course.points[1].frame, 2);
    bench.act(Action::View(ViewAction::SetQualityCamera("gone".into())));
    assert_eq!(bench.app.quality().camera, Some("high".into()));
    bench.act(Action::View(ViewAction::SetTimeAxis(TimeAxis::Video)));
    assert_eq!(
        bench.app.quality().course.axis,
        TimeAxis::Frame,
        "no frame knows a time"
    );
    bench.act(Action::Opened(Box::new(
        touchline_application::app::Opened::new(document(), "/nowhere/other.json"),
    )));
    assert!(!bench.app.session.quality.open && bench.app.quality().camera.is_none());
}

#[test]
fn keys_of_the_picture_sleep_and_those_of_the_time_go_on() {
    let mut bench = Bench::new(document());
    bench.act(Action::Navigate(Navigation::Select(Some(0))));
    bench.command(Command::QualityPage);
    let before = bench.app.open().unwrap().document.clone();
    for command in [
        Command::DeleteClick,
        Command::Accept,
        Command::Reject,
        Command::ToggleCheck,
        Command::EstimateBase,
    ] {
        bench.command(command);
        assert_eq!(
            bench.last_notice(),
            "Close the quality page first.",
            "{command:?}"
        );
    }
    assert_eq!(bench.app.open().unwrap().document.clone(), before);
    bench.act(Action::Navigate(Navigation::GoTo(10)));
    bench.command(Command::ZoomIn);
    let [from, upto] = bench.app.session.quality.span.unwrap();
    assert!(
        from < 11.0 && 11.0 < upto && upto - from < 10.0,
        "{from} {upto}"
    );
    bench.command(Command::NextFrame);
    assert!(bench.app.session.quality.open);
    bench.command(Command::ZoomOut);
    assert_eq!(bench.app.session.quality.span, None);
    bench.act(Action::View(ViewAction::ShowSpan(Some([5.0, f64::NAN]))));
    assert_eq!(bench.app.session.quality.span, None);
}

#[test]
fn escape_closes_the_page_and_a_panel_takes_its_place() {
    let mut bench = Bench::new(document());
    bench.command(Command::ReviewPanel);
    bench.command(Command::QualityPage);
    bench.command(Command::Cancel);
    assert!(!bench.app.session.quality.open);
    bench.command(Command::QualityPage);
    bench.command(Command::ReviewPanel);
    assert_eq!(
        (bench.app.session.quality.open, bench.app.session.panel),
        (false, SidePanel::Review)
    );
    let mut empty = Bench::new(soccer_document());
    empty.command(Command::QualityPage);
    assert!(empty.app.session.quality.open && empty.app.quality().course.whole.is_none());
    empty.command(Command::ZoomIn);
}
