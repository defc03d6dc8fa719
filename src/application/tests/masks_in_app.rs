//! Masks in the application: graphics that look burned in are found and asked about; masks by hand get their frames.

use crate::bench::{Bench, SIZE};
use touchline_application::app::operation::Report;
use touchline_application::app::operations::BurntInSearch;
use touchline_application::app::session::{Level, SidePanel};
use touchline_application::app::{
    Action, App, Command, EditAction, MaskList, MaskScope, Navigation, Opened, Settings, ViewAction,
};
use touchline_calibration::proposals::FoundMask;
use touchline_core::geometry::PixelBox;
use touchline_documents::document::{
    Camera, Clip, Document, Extra, FieldSpec, Frame, MaskSource, RangedMask, VideoFrame,
};

const BUG: PixelBox = PixelBox { x: 60.0, y: 40.0, width: 300.0, height: 50.0 };

/// Ten frames of a video, the last four another shot.
fn video() -> Document {
    let mut document = Document::new(FieldSpec::new("soccer"));
    document.cameras.push(Camera::new("main".into(), SIZE).into());
    for index in 0..10 {
        let mut frame = Frame::from_image("", "main".into(), SIZE);
        frame.image = None;
        frame.video =
            Some(VideoFrame { path: "match.mp4".into(), frame_index: 100 * index, pts_s: None, extra: Extra::new() });
        frame.clip = Some(Clip::Number(i64::from(index >= 6)));
        document.frames.push(frame.into());
    }
    document
}

fn ranged(app: &App) -> Vec<(Option<u64>, Option<u64>, MaskSource)> {
    let document = &app.open().unwrap().document;
    document.cameras[0].ranged_masks.iter().map(|mask| (mask.from, mask.to, mask.source)).collect()
}

#[cfg(feature = "opencv")]
fn found(from: Option<u64>, to: Option<u64>) -> FoundMask {
    let mask = RangedMask { pixel_box: BUG, from, to, source: MaskSource::Found, extra: Extra::new() };
    FoundMask { camera: "main".into(), mask, frames: [0, 4], features: 40 }
}

#[cfg(feature = "opencv")]
fn bench_with_found() -> Bench {
    let mut bench = opened(video());
    bench.report_end::<BurntInSearch>(Ok(vec![found(None, Some(499))]));
    bench
}

#[cfg(feature = "opencv")]
/// A document with what opening it started.
fn opened(document: Document) -> Bench {
    let mut bench = Bench { app: App::new(Settings::default()), effects: Vec::new() };
    open(&mut bench, document);
    bench
}

#[cfg(feature = "opencv")]
fn open(bench: &mut Bench, document: Document) {
    bench.act(Action::Opened(Box::new(Opened::new(document, "/nowhere/project.json"))));
}

#[cfg(feature = "opencv")]
#[test]
fn what_looks_burned_in_is_asked_about_and_kept_in_one_step() {
    let mut bench = bench_with_found();
    let [notice] = &bench.app.session.messages.notices[..] else { panic!("{:?}", bench.app.session.messages.notices) };
    assert_eq!(notice.level, Level::Question, "it stays until somebody answers");
    assert!(notice.text.contains("burned in") && notice.text.contains("300 × 50 px at 60, 40"), "{}", notice.text);
    assert_eq!(notice.offers.iter().map(|(says, _)| *says).collect::<Vec<_>>(), ["Keep", "Change"]);
    assert_eq!(bench.app.asked_masks(), [BUG], "shown on the picture");
    bench.act(Action::Navigate(Navigation::GoTo(7)));
    assert!(bench.app.asked_masks().is_empty(), "not where it is not shown");
    bench.command(Command::KeepBurntIn);
    assert_eq!(ranged(&bench.app), [(None, Some(499), MaskSource::Found)]);
    assert!(bench.app.session.messages.notices.is_empty() && !bench.app.session.picture.masks);
    assert!(bench.app.why_not(Command::KeepBurntIn).is_some());
    bench.command(Command::Undo);
    assert!(ranged(&bench.app).is_empty());
    bench.command(Command::Redo);
    assert_eq!(ranged(&bench.app).len(), 1);
}

#[cfg(feature = "opencv")]
#[test]
fn change_keeps_them_and_opens_the_masks() {
    let mut bench = bench_with_found();
    bench.command(Command::ChangeBurntIn);
    assert_eq!(ranged(&bench.app).len(), 1);
    assert!(bench.app.session.picture.masks && bench.app.session.panel == SidePanel::Camera);
    bench.act(Action::Edit(EditAction::RemoveMask { list: MaskList::Ranged, index: 0 }));
    assert!(ranged(&bench.app).is_empty());
}

#[cfg(feature = "opencv")]
#[test]
fn a_closed_question_shows_nothing_and_what_is_masked_is_not_asked_again() {
    let mut bench = bench_with_found();
    let id = bench.app.session.messages.notices[0].id;
    bench.act(Action::View(ViewAction::DismissNotice(id)));
    assert!(bench.app.asked_masks().is_empty());
    assert!(bench.app.why_not(Command::KeepBurntIn).is_none(), "the menu still offers it");
    bench.command(Command::KeepBurntIn);
    let before = bench.started::<BurntInSearch>().id();
    let document = (*bench.app.open().unwrap().document).clone();
    open(&mut bench, document);
    bench.report_end::<BurntInSearch>(Ok(vec![found(None, None)]));
    bench.act(Action::Report(Report::of_end::<BurntInSearch>(before, Ok(vec![found(None, None)]))));
    assert!(bench.app.session.messages.notices.is_empty(), "{:?}", bench.app.session.messages.notices);
}

#[test]
fn a_mask_by_hand_is_for_a_frame_a_shot_a_range_or_all() {
    let mut bench = Bench::new(video());
    let scope =
        |bench: &mut Bench, list, scope| bench.act(Action::Edit(EditAction::ScopeMask { list, index: 0, scope }));
    bench.act(Action::Navigate(Navigation::GoTo(2)));
    bench.act(Action::Edit(EditAction::AddMask { of_camera: false, mask: BUG }));
    scope(&mut bench, MaskList::Frame, MaskScope::Shot);
    assert_eq!(ranged(&bench.app), [(Some(0), Some(500), MaskSource::ByHand)]);
    scope(&mut bench, MaskList::Ranged, MaskScope::FromHere);
    assert_eq!(ranged(&bench.app), [(Some(200), Some(500), MaskSource::ByHand)]);
    bench.act(Action::Navigate(Navigation::GoTo(4)));
    scope(&mut bench, MaskList::Ranged, MaskScope::UpToHere);
    assert_eq!(ranged(&bench.app), [(Some(200), Some(400), MaskSource::ByHand)]);
    let covered = |bench: &Bench| {
        let document = &bench.app.open().unwrap().document;
        document.frames.iter().map(|frame| document.masks_of(frame).len()).collect::<Vec<_>>()
    };
    assert_eq!(covered(&bench), [0, 0, 1, 1, 1, 0, 0, 0, 0, 0]);
    scope(&mut bench, MaskList::Ranged, MaskScope::All);
    assert_eq!(covered(&bench), [1; 10]);
    assert_eq!(bench.app.open().unwrap().document.cameras[0].masks, [BUG]);
    scope(&mut bench, MaskList::Camera, MaskScope::Frame);
    assert_eq!(covered(&bench), [0, 0, 0, 0, 1, 0, 0, 0, 0, 0]);
    bench.command(Command::Undo);
    assert_eq!(covered(&bench), [1; 10], "each is one step");
}

#[test]
fn images_have_no_range_in_time_but_a_shot() {
    let mut document = video();
    for (index, frame) in document.frames.iter_mut().enumerate() {
        (frame.image, frame.video) = (Some(format!("{index}.jpg")), None);
    }
    let mut bench = Bench::new(document);
    bench.act(Action::Navigate(Navigation::GoTo(8)));
    bench.act(Action::Edit(EditAction::AddMask { of_camera: true, mask: BUG }));
    assert!(bench.app.why_not_scope(MaskScope::FromHere).is_some());
    bench.act(Action::Edit(EditAction::ScopeMask { list: MaskList::Camera, index: 0, scope: MaskScope::FromHere }));
    assert_eq!(bench.app.open().unwrap().document.cameras[0].masks, [BUG], "refused");
    bench.act(Action::Edit(EditAction::ScopeMask { list: MaskList::Camera, index: 0, scope: MaskScope::Shot }));
    let document = &bench.app.open().unwrap().document;
    let covered: Vec<usize> = document.frames.iter().map(|frame| frame.masks.len()).collect();
    assert_eq!(covered, [0, 0, 0, 0, 0, 0, 1, 1, 1, 1]);
    assert!(document.cameras[0].masks.is_empty());
}

#[cfg(feature = "opencv")]
#[test]
fn a_drawn_match_with_a_score_bug_is_asked_about_after_opening() {
    use crate::headless::Headless;
    use touchline_core::camera::{Ptz, PtzCamera};
    use touchline_core::field::builtin;
    use touchline_core::geometry::ImageSize;
    use touchline_vision::synthetic::{FrameOptions, Graphics, Preset, StadiumOptions, stadium};

    const DRAWN: ImageSize = ImageSize::new(640, 360);
    let folder = tempfile::tempdir().unwrap();
    let scene = stadium(&StadiumOptions::new(builtin("soccer").unwrap().default_model().unwrap(), 7));
    let base = Preset::Easy.shoot().main_camera(DRAWN);
    let mut document = Document::new(FieldSpec::new("soccer"));
    document.cameras.push(Camera::new("main".into(), DRAWN).into());
    for (index, pan_deg) in [-22.0, -9.0, 4.0, 18.0].into_iter().enumerate() {
        let camera = PtzCamera::new(base, Ptz::from_degrees(pan_deg, -11.0, 1100.0));
        let graphics = Graphics { score_bug: true, ..Graphics::default() };
        let options = FrameOptions { time_s: 3.0 * index as f64, graphics, ..FrameOptions::default() };
        let name = format!("{index}.png");
        scene.render(&camera, DRAWN, &options).image.save(folder.path().join(&name)).unwrap();
        document.frames.push(Frame::from_image(&name, "main".into(), DRAWN).into());
    }
    let text = touchline_documents::document::document_to_string(&document).unwrap();
    std::fs::write(folder.path().join("project.json"), text).unwrap();
    let mut headless = Headless::new();
    headless.act(Action::Open(folder.path().to_path_buf()));
    headless.wait_until("the question", |app| app.session.offers(Command::KeepBurntIn));
    let masks = headless.app.asked_masks();
    assert!(!masks.is_empty() && masks.iter().all(|mask| mask.y < 80.0 || mask.y > 280.0), "{masks:?}");
    headless.act(Action::Command(Command::KeepBurntIn));
    headless.wait_until("the journal", |app| {
        matches!(app.session.disk.saving, touchline_application::app::session::Saving::Saved { .. })
    });
    assert_eq!(ranged(&headless.app).len(), masks.len());
}

#[test]
fn escape_leaves_the_masks_and_enter_accepts_nothing_below_them() {
    let mut bench = Bench::new(crate::proposed::suggested(&[Some(0.9), Some(0.9)]));
    bench.command(Command::ShowMasks);
    bench.command(Command::Accept);
    bench.command(Command::AcceptAndStay);
    assert_eq!(bench.statuses(), "SS");
    assert_eq!(bench.last_notice(), "Masks are being drawn: Esc ends that first.");
    bench.command(Command::Cancel);
    assert!(!bench.app.session.picture.masks);
    bench.command(Command::AcceptAndStay);
    assert_eq!(bench.statuses(), "RS");
}
