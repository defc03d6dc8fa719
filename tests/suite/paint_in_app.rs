//! The painted lines in the application: a frame is snapped in one step, cameras are judged in the
//! background.

use crate::drawn::draw;
use crate::headless::Headless;
use touchline::app::guidance::next_step;
use touchline::app::operation::Report;
use touchline::app::operations::FrameSnap;
use touchline::app::session::Level;
use touchline::app::{Action, App, Command, EditAction, Navigation, PointerAction};
use touchline::calibrate::check_values;
use touchline::camera::{Ptz, PtzCamera};
use touchline::document::{
    Document, Frame, FramePtz, FrameStatus, Solution, SolutionSource, Target,
};
use touchline::exchange::{ExportOptions, Format, export};
use touchline::geometry::{Angle, Vec2};
use touchline::markings::{LineVerdict, project_landmarks};
use touchline::solve::Verdict;
use touchline_core::testing::landmark_in;
use touchline_documents::testing::{load, save, solved_by};

/// Two drawn frames: the camera of the first is 10 px off, that of the second looks elsewhere.
fn project() -> (tempfile::TempDir, Document) {
    let place = tempfile::tempdir().unwrap();
    draw(
        place.path(),
        "--frames 2 --seed 11 --size 960x540 --preset easy",
    );
    let folder = place.path().join("match");
    let truth = load(folder.join("truth.json"));
    let mut off = truth.clone();
    for (frame, pan_px) in off.frames.iter_mut().zip([10.0, 260.0]) {
        frame.clicks.clear();
        let ptz = frame.ptz.as_ref().unwrap().ptz();
        let pan = ptz.pan + Angle::from_radians(pan_px / ptz.focal_px);
        frame.ptz = Some(FramePtz::new(Ptz { pan, ..ptz }, None));
        frame.solution = solved_by(SolutionSource::Manual);
        frame.status = FrameStatus::Draft;
    }
    let project = place.path().join("project");
    std::fs::create_dir(&project).unwrap();
    for frame in &mut off.frames {
        let name = frame.image.clone().unwrap();
        frame.image = Some(folder.join(name).to_string_lossy().into_owned());
    }
    save(project.join("project.json"), &off);
    (place, truth)
}

fn frame(app: &App) -> &Frame {
    app.frame().unwrap()
}

fn is_snapped(app: &App) -> bool {
    frame(app).solution.as_ref().unwrap().source == Some(SolutionSource::Markings)
}

/// How far the picture's middle is off, px.
fn off_px(app: &App, truth: &Document) -> f64 {
    let centre = frame(app).image_size.centre();
    let camera: PtzCamera = app.current().camera.unwrap();
    let truth = truth.ptz_camera(&truth.frames[app.session.frame]).unwrap();
    truth
        .image_from_ray(camera.ray_from_image(centre).unwrap())
        .unwrap()
        .distance_px(centre)
}

#[test]
fn a_frame_is_snapped_in_one_step_and_its_lines_are_judged() {
    let (place, truth) = project();
    let mut headless = Headless::open(&place.path().join("project"));
    headless.wait_for_picture();
    // Messages name the key that the user chose.
    let keys = &mut headless.app.settings.keys;
    keys.assign(Command::Snap, "F8".parse().unwrap());
    assert!((9.0..11.0).contains(&off_px(&headless.app, &truth)));

    // Both are judged without being asked for, the shown one first.
    headless.wait_until("the line checks", |app| {
        app.paint_says(0).is_some() && app.paint_says(1).is_some()
    });
    assert_eq!(
        headless.app.paint_says(1).unwrap().verdict,
        LineVerdict::Contradicts
    );
    let document = &headless.app.open().unwrap().document;
    assert!(
        document
            .frames
            .iter()
            .all(|frame| frame.solution.as_ref().unwrap().line_check.is_none()),
        "no edit"
    );

    // The key snaps; held down again it shows the camera before.
    let before = frame(&headless.app).ptz.clone();
    headless.act(Action::Hold(Command::Snap, true));
    assert!(
        headless.app.why_not(Command::Snap).is_some(),
        "one at a time"
    );
    headless.act(Action::Hold(Command::Snap, false));
    headless.wait_until("the snap", is_snapped);
    let notices = &headless.app.session.messages.notices;
    assert!(
        notices
            .iter()
            .any(|notice| notice.text.ends_with(". Hold F8 to see it before.")),
        "{notices:?}"
    );
    assert!(
        off_px(&headless.app, &truth) < 0.5,
        "{}",
        off_px(&headless.app, &truth)
    );
    assert_eq!(
        headless.app.judgement().unwrap().verdict,
        Verdict::Good,
        "{:?}",
        headless.app.judgement()
    );
    assert_eq!(
        headless.app.paint_says(0).unwrap().verdict,
        LineVerdict::Supports
    );
    let solution = frame(&headless.app).solution.as_ref().unwrap();
    assert!(
        solution.worst_corner_sigma_px.is_some_and(|px| px < 5.0) && solution.covariance.is_some()
    );
    headless.act(Action::Hold(Command::Snap, true));
    assert!(
        headless.app.session.picture.held.before_snap
            && headless.app.operations.frame_snap.running().is_none()
    );
    assert_eq!(
        Some(headless.app.before_snap().unwrap().ptz()),
        before.as_ref().map(FramePtz::ptz)
    );
    headless.act(Action::Hold(Command::Snap, false));
    assert!(!headless.app.session.picture.held.before_snap);
    headless.act(Action::Command(Command::Undo));
    assert_eq!(frame(&headless.app).ptz, before);
    assert!(
        !next_step(&headless.app).text.contains("ligned"),
        "{:?}",
        next_step(&headless.app)
    );
    headless.act(Action::Command(Command::Redo));
    let said = next_step(&headless.app).text;
    assert!(
        said.starts_with("Aligned to the painted lines. Enter accepts it")
            && said.ends_with("Hold F8: before."),
        "{said}"
    );
    assert!(is_snapped(&headless.app));
}

#[test]
fn lines_are_searched_only_where_there_is_no_camera_and_a_picture_without_paint_is_refused_in_words()
 {
    let (place, _) = project();
    let file = place.path().join("project").join("project.json");
    let mut document = load(&file);
    let turf = place.path().join("turf.png");
    image::RgbImage::from_pixel(960, 540, image::Rgb([62, 110, 42]))
        .save(&turf)
        .unwrap();
    let bare = &mut document.frames[1];
    bare.image = Some(turf.to_string_lossy().into_owned());
    (bare.ptz, bare.solution, bare.status) = (None, None, FrameStatus::New);
    save(&file, &document);
    let mut headless = Headless::open(&place.path().join("project"));
    assert_eq!(
        headless.app.why_not(Command::SearchLines),
        Some("This frame has a camera: snap it.")
    );
    headless.act(Action::Navigate(Navigation::GoTo(1)));
    headless.wait_for_picture();
    assert!(headless.app.why_not(Command::Snap).is_some());
    assert_eq!(headless.app.why_not(Command::SearchLines), None);
    headless.act(Action::Command(Command::SearchLines));
    assert!(
        headless.app.why_not(Command::SearchLines).is_some(),
        "one at a time"
    );
    // It says so, and can be stopped; then nothing comes of it.
    let card = |headless: &Headless| headless.app.under_way().remove(0);
    let searching = card(&headless);
    assert_eq!(searching.job, "Searching the painted lines");
    assert_eq!(searching.stop, Command::StopSearch);
    let said = next_step(&headless.app).text;
    assert!(
        said.starts_with("Searching the painted lines for this frame."),
        "{said}"
    );
    let request = headless.app.operations.frame_snap.running().unwrap().id();
    headless.act(Action::Report(Report::from_progress::<FrameSnap>(
        request, 0.5,
    )));
    assert_eq!(card(&headless).share, Some(0.5));
    headless.act(Action::Command(Command::StopSearch));
    assert!(
        headless.app.operations.frame_snap.running().is_none()
            && headless.app.why_not(Command::StopSearch).is_some()
    );
    headless.act(Action::Command(Command::SearchLines));
    assert_eq!(card(&headless).job, searching.job, "another search");
    let refused = "No camera found: the picture shows 0 px of painted lines";
    headless.wait_until("the refusal", |app| {
        app.session
            .messages
            .notices
            .iter()
            .any(|notice| notice.text.starts_with(refused))
    });
    assert_eq!(
        (
            frame(&headless.app).ptz.as_ref(),
            frame(&headless.app).status
        ),
        (None, FrameStatus::New)
    );
}

#[test]
fn what_is_far_off_is_refused_in_words_and_accepting_writes_the_line_check() {
    let (place, _) = project();
    let mut headless = Headless::open(&place.path().join("project"));
    headless.act(Action::Navigate(Navigation::GoTo(1)));
    headless.wait_for_picture();
    let before = frame(&headless.app).ptz.clone();
    headless.act(Action::Command(Command::Snap));
    headless.wait_until("the refusal", |app| {
        app.session
            .messages
            .notices
            .iter()
            .any(|notice| notice.text.starts_with("Not snapped: "))
    });
    let refusal = headless
        .app
        .session
        .messages
        .notices
        .iter()
        .find(|notice| notice.text.starts_with("Not snapped"))
        .unwrap();
    assert_eq!(refusal.level, Level::Warning);
    assert_eq!(frame(&headless.app).ptz, before);
    headless.wait_until("the line check", |app| app.paint_says(1).is_some());
    // It is asked once whether that is meant.
    headless.act(Action::Command(Command::AcceptAndStay));
    assert_eq!(frame(&headless.app).status, FrameStatus::Draft);
    assert!(
        headless.app.session.offers(Command::AcceptAnyway),
        "{:?}",
        headless.app.session.messages.notices
    );
    headless.act(Action::Command(Command::AcceptAndStay));
    assert_eq!(frame(&headless.app).status, FrameStatus::Reference);
    let solution = frame(&headless.app).solution.as_ref().unwrap();
    assert!(
        solution
            .line_check
            .as_ref()
            .is_some_and(|check| check.score < 0.1),
        "{solution:?}"
    );
    assert!(
        solution
            .warnings
            .iter()
            .any(|warning| warning.code == "line_check")
    );
    // Whoever looks at the whole is told as well.
    let open = headless.app.open().unwrap();
    let at = open.document.at(&open.folder);
    let faults: Vec<_> = check_values(at)
        .into_iter()
        .map(|problem| (problem.frame, problem.fault.code()))
        .collect();
    assert!(faults.contains(&(Some(1), "off_paint")), "{faults:?}");
    let exported = export(at, Format::Csv, &ExportOptions::default()).unwrap();
    assert!(
        exported
            .notes
            .iter()
            .any(|note| note.starts_with("the paint contradicts the camera of ")),
        "{exported:?}"
    );
    headless.act(Action::Command(Command::QualityPage));
    assert_eq!(headless.app.quality().off_paint, [1]);
}

#[test]
fn a_proposal_that_is_more_likely_wrong_is_asked_about_names_nothing_and_below_a_tenth_is_not_drawn()
 {
    let (place, _) = project();
    let file = place.path().join("project").join("project.json");
    let drawn = load(&file);
    for (confidence, is_drawn, is_asked) in
        [(0.03, false, true), (0.3, true, true), (0.7, true, false)]
    {
        let mut document = drawn.clone();
        let proposed = &mut document.frames[0];
        proposed.status = FrameStatus::Suggested;
        let source = Some(SolutionSource::Forest);
        proposed.solution = Some(Solution {
            source,
            confidence: Some(confidence),
            ..Solution::default()
        });
        save(&file, &document);
        let mut headless = Headless::open(&place.path().join("project"));
        assert_eq!(
            headless.app.shown_values().camera.is_some(),
            is_drawn,
            "{confidence}"
        );
        assert_eq!(
            next_step(&headless.app)
                .text
                .starts_with("No proposal that holds."),
            !is_drawn
        );
        headless.act(Action::Command(Command::AcceptAndStay));
        let accepted = frame(&headless.app).status == FrameStatus::Reference;
        assert_eq!(
            (accepted, headless.app.session.offers(Command::AcceptAnyway)),
            (!is_asked, is_asked),
            "{confidence}"
        );
        headless.act(Action::Command(Command::Undo));
        // A click right where such a camera has a landmark is named by one that is likely alone.
        let camera = document.ptz_camera(&document.frames[0]).unwrap();
        let field = headless.app.current().field().unwrap().clone();
        let shown = project_landmarks(&field, &camera, frame(&headless.app).image_size, -40.0);
        headless.act(Action::Pointer(PointerAction::Press {
            at: shown[0].image,
            on: None,
        }));
        headless.act(Action::Pointer(PointerAction::Release));
        assert_eq!(
            frame(&headless.app).clicks[0].target.is_some(),
            !is_asked,
            "{confidence}"
        );
    }
}

#[test]
fn points_beside_painted_crossings_go_to_them() {
    let (place, truth) = project();
    let mut headless = Headless::open(&place.path().join("project"));
    headless.wait_for_picture();
    let (field, size) = (
        headless.app.current().field().unwrap().clone(),
        frame(&headless.app).image_size,
    );
    let camera = truth.ptz_camera(&truth.frames[0]).unwrap();
    let shown = project_landmarks(&field, &camera, size, -40.0);
    assert!(shown.len() >= 3, "{shown:?}");
    for projected in shown.iter().take(5) {
        headless.act(Action::Edit(EditAction::Pick(Target::Landmark(
            field.landmarks[projected.landmark].id.clone(),
        ))));
        headless.act(Action::Pointer(PointerAction::Press {
            at: projected.image.translate(Vec2::new(2.0, -1.0)),
            on: None,
        }));
        headless.act(Action::Pointer(PointerAction::Release));
    }
    headless.wait_until("the snap", |app| {
        !app.session.points.just_snapped.is_empty()
    });
    let snapped = frame(&headless.app)
        .clicks
        .iter()
        .filter(|click| click.snapped_sigma_px.is_some());
    for click in snapped {
        let id = click.target.as_ref().unwrap().as_str();
        let exact = landmark_in(&camera, &field, id);
        let (off_px, sigma_px) = (
            click.image.distance_px(exact),
            click.snapped_sigma_px.unwrap(),
        );
        assert!(
            off_px < 4.0 * sigma_px && off_px < 5f64.sqrt(),
            "{id}: {off_px} px, σ {sigma_px} px"
        );
    }
}

#[test]
fn snapping_a_proposal_is_a_step_of_its_own() {
    let (place, truth) = project();
    let file = place.path().join("project").join("project.json");
    let mut document = load(&file);
    document.frames[0].status = FrameStatus::Suggested;
    document.frames[0].solution = solved_by(SolutionSource::Forest);
    save(&file, &document);
    let mut headless = Headless::open(&place.path().join("project"));
    headless.act(Action::Navigate(Navigation::GoTo(1)));
    headless.wait_until("the line check", |app| app.paint_says(1).is_some());
    headless.act(Action::Command(Command::AcceptAndStay));
    headless.act(Action::Command(Command::AcceptAnyway));
    headless.act(Action::Navigate(Navigation::GoTo(0)));
    headless.wait_for_picture();
    let before = frame(&headless.app).ptz.clone();
    headless.act(Action::Command(Command::Snap));
    headless.wait_until("the snap", is_snapped);
    assert!(off_px(&headless.app, &truth) < 0.5);
    headless.act(Action::Command(Command::Undo));
    assert_eq!(
        (&frame(&headless.app).ptz, frame(&headless.app).status),
        (&before, FrameStatus::Suggested)
    );
    let accepted = headless.app.open().unwrap().document.frames[1].status;
    assert_eq!(
        accepted,
        FrameStatus::Reference,
        "what was accepted elsewhere stays"
    );
    headless.act(Action::Command(Command::Redo));
    assert!(is_snapped(&headless.app));
}
