//! Graphics that look burned into the pictures: found, confirmed by the user, kept as masks.
#![cfg(feature = "opencv")]

use crate::bench::Bench;
use crate::clicking::masks_in_app::{BUG, ranged_masks, video};
use touchline_application::app::operation::Report;
use touchline_application::app::operations::BurntInSearch;
use touchline_application::app::session::{Level, SidePanel};
use touchline_application::app::{
    Action, App, Command, EditAction, MaskList, Navigation, Opened, Settings, Tool, ViewAction,
};
use touchline_calibration::proposals::FoundMask;
use touchline_core::testing::{TestBase, soccer};
use touchline_documents::document::{Document, Extra, MaskSource, RangedMask};
use touchline_documents::testing::{a_match, new_frame};

pub fn found_mask(from: Option<u64>, to: Option<u64>) -> FoundMask {
    let mask = RangedMask {
        pixel_box: BUG,
        from,
        to,
        source: MaskSource::Found,
        extra: Extra::new(),
    };
    FoundMask {
        camera: "main".into(),
        mask,
        frames: [0, 4],
        features: 40,
    }
}

fn bench_with_found() -> Bench {
    let mut bench = bench_of(video());
    bench.report_end::<BurntInSearch>(Ok(vec![found_mask(None, Some(499))]));
    bench
}

/// A document with what opening it started.
fn bench_of(document: Document) -> Bench {
    let mut bench = Bench {
        app: App::new(Settings::default()),
        effects: Vec::new(),
    };
    open(&mut bench, document);
    bench
}

fn open(bench: &mut Bench, document: Document) {
    bench.act(Action::Opened(Box::new(Opened::new(
        document,
        "/nowhere/project.json",
    ))));
}

#[test]
fn what_looks_burned_in_causes_a_question_and_is_kept_in_one_step() {
    let mut bench = bench_with_found();
    let [notice] = &bench.app.session.messages.notices[..] else {
        panic!("{:?}", bench.app.session.messages.notices)
    };
    assert_eq!(
        notice.level,
        Level::Question,
        "it stays until it is answered"
    );
    assert!(
        notice.text.contains("burned in") && notice.text.contains("300 × 50 px at 60, 40"),
        "{}",
        notice.text
    );
    assert_eq!(
        notice
            .offers
            .iter()
            .map(|(says, _)| *says)
            .collect::<Vec<_>>(),
        ["Ignore", "Edit…"]
    );
    assert_eq!(bench.app.masks_in_question(), [BUG], "shown on the picture");
    bench.act(Action::Navigate(Navigation::GoTo(7)));
    assert!(
        bench.app.masks_in_question().is_empty(),
        "not where it is not shown"
    );
    bench.command(Command::KeepBurntIn);
    assert_eq!(
        ranged_masks(&bench.app),
        [(None, Some(499), MaskSource::Found)]
    );
    assert!(bench.app.session.messages.notices.is_empty());
    assert_eq!(bench.app.session.picture.tool, Tool::Point);
    assert!(bench.app.why_not(Command::KeepBurntIn).is_some());
    bench.command(Command::Undo);
    assert!(ranged_masks(&bench.app).is_empty());
    bench.command(Command::Redo);
    assert_eq!(ranged_masks(&bench.app).len(), 1);
}

#[test]
fn change_keeps_them_and_opens_the_masks() {
    let mut bench = bench_with_found();
    bench.command(Command::ChangeBurntIn);
    assert_eq!(ranged_masks(&bench.app).len(), 1);
    assert_eq!(bench.app.session.picture.tool, Tool::Mask);
    assert_eq!(bench.app.session.panel, SidePanel::Camera);
    bench.act(Action::Edit(EditAction::RemoveMask {
        list: MaskList::Ranged,
        index: 0,
    }));
    assert!(ranged_masks(&bench.app).is_empty());
}

#[test]
fn a_closed_question_shows_nothing_and_what_is_masked_causes_no_new_question() {
    let mut bench = bench_with_found();
    let id = bench.app.session.messages.notices[0].id;
    bench.act(Action::View(ViewAction::DismissNotice(id)));
    assert!(bench.app.masks_in_question().is_empty());
    assert!(
        bench.app.why_not(Command::KeepBurntIn).is_none(),
        "the menu still offers it"
    );
    bench.command(Command::KeepBurntIn);
    let before = bench.last_job::<BurntInSearch>().id();
    let document = (*bench.app.open().unwrap().document).clone();
    open(&mut bench, document);
    bench.report_end::<BurntInSearch>(Ok(vec![found_mask(None, None)]));
    bench.act(Action::Report(Report::from_result::<BurntInSearch>(
        before,
        Ok(vec![found_mask(None, None)]),
    )));
    assert!(
        bench.app.session.messages.notices.is_empty(),
        "{:?}",
        bench.app.session.messages.notices
    );
}

#[test]
fn a_drawn_match_with_a_score_bug_causes_a_question_after_opening() {
    use crate::headless::Headless;
    use touchline_core::geometry::ImageSize;
    use touchline_vision::synthetic::{FrameOptions, Graphics, Preset, StadiumOptions, stadium};

    const DRAWN: ImageSize = ImageSize::new(640, 360);
    let folder = tempfile::tempdir().unwrap();
    let scene = stadium(&StadiumOptions::new(soccer(), 7));
    let base = Preset::Easy.shoot().main_camera(DRAWN);

    let mut document = a_match(DRAWN);
    for (index, pan_deg) in [-22.0, -9.0, 4.0, 18.0].into_iter().enumerate() {
        let camera = base.aim(pan_deg, -11.0, 1100.0);
        let graphics = Graphics {
            score_bug: true,
            ..Graphics::default()
        };
        let options = FrameOptions {
            time_s: 3.0 * index as f64,
            graphics,
            ..FrameOptions::default()
        };
        let name = format!("{index}.png");
        scene
            .render(&camera, DRAWN, &options)
            .image
            .save(folder.path().join(&name))
            .unwrap();
        document.frames.push(new_frame(&name, DRAWN).into());
    }
    let text = touchline_documents::document::document_to_string(&document).unwrap();
    std::fs::write(folder.path().join("project.json"), text).unwrap();
    let mut headless = Headless::new();
    headless.act(Action::Open(folder.path().to_path_buf()));
    headless.wait_until("the question", |app| {
        app.session.offers(Command::KeepBurntIn)
    });
    let masks = headless.app.masks_in_question();
    assert!(
        !masks.is_empty() && masks.iter().all(|mask| mask.y < 80.0 || mask.y > 280.0),
        "{masks:?}"
    );
    headless.act(Action::Command(Command::KeepBurntIn));
    headless.wait_until("the journal", |app| {
        matches!(
            app.session.disk.saving,
            touchline_application::app::session::Saving::Saved { .. }
        )
    });
    assert_eq!(ranged_masks(&headless.app).len(), masks.len());
}
