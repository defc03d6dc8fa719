//! The trainer panel: what goes on, what the forest learns from and is worth, where a reference is
//! missing.
#![cfg(feature = "opencv")]

use super::harness::{Window, truth};
use crate::parts::{Test, tests};
use egui::{Key, Rect, pos2};
use egui_kittest::kittest::Queryable as _;
use std::sync::Arc;
use std::time::Duration;
use touchline::app::session::SidePanel;
use touchline::app::{
    Action, Command, ForestFacts, TrainerActivity, TrainerReport, TrainerStatus, UnusableReference,
};
use touchline::document::Document;
use touchline::geometry::{Angle, AngleRange};
use touchline::progress::Share;
use touchline::proposals::{
    Coverage, CoverageCell, FoundAgain, LeftOut, LeftOutBy, Quality, TrainingSampleError,
};

pub const TESTS: &[Test] = tests![
    [Adapter] the_panel_says_what_is_learnt_and_where_a_reference_is_missing;
    [Adapter] trouble_is_shown_in_the_menu_row_and_leads_to_the_panel;
];

/// What a trainer would say that has learnt from six references on the left.
fn status(document: &Document) -> TrainerStatus {
    let cell = |index: usize| {
        let (column, row) = (index % 10, index / 10);
        CoverageCell {
            references: if column < 5 { row as u32 } else { 0 },
            field: row > 0 && (1..9).contains(&column),
        }
    };
    let asked = |frame: usize, found: Option<f64>| LeftOut {
        frame: document.frames[frame].id.clone(),
        pan_deg: truth(frame).ptz().pan.degrees(),
        tilt_deg: -13.0,
        found: found.map(|error_px| FoundAgain {
            error_px,
            confidence: 0.97,
        }),
    };
    TrainerStatus {
        doing: TrainerActivity::Proposing(Share { done: 30, of: 120 }),
        left: Some(Duration::from_secs(63)),
        references: 8,
        training_frames: 6,
        withheld: 2,
        failed: [UnusableReference {
            frame: document.frames[2].id.clone(),
            error: TrainingSampleError::Changed,
        }]
        .into(),
        forest: Some(ForestFacts {
            generation: 3,
            references: 5,
            features: 4870,
            trees: 5,
            leaves: 23_410,
            took: Some(Duration::from_millis(1340)),
        }),
        answered: 27,
        unanswered: 3,
        quality: Some(Arc::new(Quality {
            left_out_by: LeftOutBy::Shot,
            groups: 3,
            tested: vec![asked(0, Some(1.4)), asked(3, Some(64.0)), asked(5, None)],
        })),
        suspects: Vec::new().into(),
        coverage: vec![Coverage {
            camera: "main".into(),
            pan: AngleRange::around(Angle::ZERO, Angle::from_degrees(60.0)),
            tilt_deg: -30.0..=0.0,
            columns: 10,
            cells: (0..60).map(cell).collect(),
            missing_pan_deg: Some(40.2),
        }]
        .into(),
        trouble: None,
        not_kept: None,
    }
}

fn the_panel_says_what_is_learnt_and_where_a_reference_is_missing() {
    let mut window = Window::open(6, [1280.0, 860.0], 1.0);
    window.key(Key::F3);
    assert_eq!(window.app().session.panel, SidePanel::Trainer);
    window
        .harness
        .get_by_label("Waiting for the first reference.");
    let status = status(&window.app().open().unwrap().document);
    window.apply(Action::Trainer(TrainerReport::Status(Box::new(status))));
    window.harness.run_steps(3);
    for said in [
        "Proposing cameras: 30 of 120, about 70\u{a0}s left.",
        "6 references used for training.",
        "2 references not used for training.",
        "0002.png cannot be used: the image changed since it was labelled: the label is kept but not used for training",
        "27 cameras proposed.",
        "No reference sees the field near pan\u{a0}40°.",
    ] {
        assert!(
            window.harness.query_all_by_label(said).next().is_some(),
            "{said}"
        );
    }
    window
        .harness
        .get_by_label_contains("2 of 3 references found");
    window.harness.get_by_label("proposing 30/120");
    window.snapshot_of(
        "trainer",
        Rect::from_min_max(pos2(980.0, 24.0), pos2(1280.0, 836.0)),
    );

    // A reference that was left out leads to its frame.
    window.press_label("0003.png: 64 px");
    window.harness.run_steps(2);
    assert_eq!(window.app().session.frame, 3);

    window.press_label("Pause");
    window.harness.run_steps(2);
    assert!(window.app().session.trainer.paused);
    window.wait_for(|shell| shell.app().session.trainer.status.doing == TrainerActivity::Paused);
    window.harness.run_steps(2);
    window.press_label("Resume");
    window.harness.run_steps(2);
    assert!(!window.app().session.trainer.paused);
    window.key(Key::F3);
    assert_eq!(window.app().session.panel, SidePanel::Frame);
}

fn trouble_is_shown_in_the_menu_row_and_leads_to_the_panel() {
    let mut window = Window::open(2, [1280.0, 720.0], 1.0);
    let trouble =
        Some("Internal error while learning (please report it): the saw broke.".to_owned());
    let status = TrainerStatus {
        trouble,
        references: 1,
        ..TrainerStatus::default()
    };
    window.apply(Action::Trainer(TrainerReport::Status(Box::new(status))));
    window.harness.run_steps(2);
    window.press_label("trainer: problem");
    window.harness.run_steps(2);
    assert_eq!(window.app().session.panel, SidePanel::Trainer);
    window.harness.get_by_label_contains("the saw broke");
    assert!(window.app().why_not(Command::PauseTrainer).is_none());
}
