//! Names that look wrong: reported in the inspector, compared while a button is held, fixed by
//! another button.

use super::harness::{Window, truth};
use crate::parts::{Test, tests};
use egui::{Rect, pos2};
use egui_kittest::kittest::Queryable as _;
use touchline::app::{Action, EditAction};
use touchline::document::Target;

pub const TESTS: &[Test] = tests![
    [Adapter] swapped_points_are_compared_and_mended_with_a_button;
];

fn swapped_points_are_compared_and_mended_with_a_button() {
    let mut window = Window::open(2, [1280.0, 720.0], 1.0);
    let named = [
        "penalty_mark_left",
        "penalty_area_far_left_front",
        "penalty_arc_far_left",
        "goal_area_far_left_front",
    ];
    for (place, landmark) in named.iter().enumerate() {
        let pick = Action::Edit(EditAction::Pick(Target::Landmark((*landmark).into())));
        window.apply(pick);
        let shown = named[match place {
            1 => 3,
            3 => 1,
            _ => place,
        }];
        window.click(window.image_of(shown));
    }
    // The check against the paint adds its line to the inspector: buttons keep their places after
    // it.
    window.wait_for(|shell| shell.app().paint_says(0).is_some() && shell.is_idle());
    // What has just appeared is drawn brighter for a moment.
    window.harness.run_steps(40);
    let before = window.app().current().camera.unwrap().ptz();
    let told = window
        .harness
        .query_all_by_label_contains("look swapped")
        .next();
    assert!(told.is_some(), "{:?}", window.app().current().judgement);

    // Held down the other camera shows; let go, it is gone.
    let button = window.harness.get_by_label("Compare").rect().center();
    window.press(button);
    window.harness.run_steps(2);
    assert!(window.app().session.picture.held.compare);
    window.snapshot_of(
        "compared",
        Rect::from_min_max(pos2(0.0, 24.0), pos2(980.0, 480.0)),
    );
    window.release(button);
    window.harness.run_steps(2);
    assert!(!window.app().session.picture.held.compare);

    window.press_label("Swap");
    window.harness.run_steps(3);
    let after = window.app().current().camera.unwrap().ptz();
    assert_ne!(before, after);
    assert!(
        (after.pan - truth(0).ptz().pan).abs().degrees() < 0.2,
        "{after:?}"
    );
    assert!(window.harness.query_by_label("Swap").is_none());
}
