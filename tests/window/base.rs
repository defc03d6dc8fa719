//! The camera's base: estimated in its panel, looked at, taken over; and how far the lines are to
//! be trusted.

use super::harness::{Window, truth};
use crate::parts::{Test, tests};
use egui::{Key, Rect, pos2};
use egui_kittest::kittest::Queryable as _;
use touchline::app::session::{Mode, SidePanel};
use touchline::document::Target;
use touchline::scene::uncertainty::UncertaintyView;

pub const TESTS: &[Test] = tests![
    [Adapter] a_base_is_estimated_in_the_panel_compared_and_taken_over;
    [Adapter] a_key_shows_a_band_then_a_heat_map_then_neither;
    [Adapter] the_details_rank_the_next_points_and_one_is_placed_from_there;
];

fn a_base_is_estimated_in_the_panel_compared_and_taken_over() {
    let mut window = Window::open_clicked(12, [1280.0, 900.0]);
    assert!(
        window.app().current().preview.is_some(),
        "the landmarks of one frame show what they can"
    );
    window.press_label("Estimate the base");
    window.harness.step();
    window.wait_for(|shell| {
        shell
            .app()
            .operations
            .base_estimate
            .proposed_base()
            .is_some()
    });
    window.harness.run_steps(3);
    assert_eq!(window.app().session.panel, SidePanel::Camera);
    assert!(
        window.app().current().base.is_none(),
        "nothing is taken over unasked"
    );
    window.harness.get_by_label("CAMERA POSITION");
    let use_it = window.harness.get_by_label("Use this base").rect();
    assert!(
        use_it.left() > 985.0,
        "the panel is no wider than its place: {use_it:?}"
    );
    assert!(
        window
            .harness
            .query_all_by_label_contains("0003.png: ")
            .next()
            .is_some()
    );
    window.press_label("Use this base");
    window.wait_for(|shell| shell.app().current().base.is_some());
    window.harness.run_steps(3);
    let base = window.app().current().base.unwrap();
    assert!(
        (base.position_m - truth(0).base().position_m).norm() < 0.3,
        "{:?}",
        base.position_m
    );
    assert!(
        window
            .app()
            .operations
            .base_estimate
            .applied_base()
            .is_some()
    );
    assert!(
        window
            .app()
            .open()
            .unwrap()
            .document
            .frames
            .iter()
            .all(|frame| frame.is_solved_by_clicks())
    );

    assert_eq!(
        window.app().session.panel,
        SidePanel::Frame,
        "Enter goes on with the drafts"
    );
    window.key(Key::F2);
    window.harness.run_steps(3);
    // A bar leads to its frame, a cross leaves it out, a button puts it back.
    window
        .harness
        .get_all_by_label_contains("0003.png: ")
        .next()
        .unwrap()
        .click();
    window.harness.run_steps(2);
    assert_eq!(window.app().session.frame, 3);
    window
        .harness
        .get_by_label("Leave 0003.png out")
        .scroll_to_me();
    window.harness.run_steps(3);
    window
        .harness
        .get_by_label("Leave 0003.png out")
        .click_accesskit();
    window.harness.run_steps(2);
    assert_eq!(window.app().base_readiness().left_out, 1);
    window.harness.get_by_label("Put back").click_accesskit();
    window.harness.run_steps(2);
    assert_eq!(window.app().base_readiness().left_out, 0);
}

/// Two points close together: nothing far from them is known well.
fn two_points_close_together() -> Window {
    let mut window = Window::open(2, [1280.0, 720.0], 1.0);
    for (landmark, code) in [
        ("penalty_area_far_left_front", "pflf"),
        ("penalty_mark_left", "pml"),
    ] {
        window.click(window.image_of(landmark));
        if matches!(window.app().session.mode, Mode::Naming(_)) {
            window.type_text(code);
            window.key(Key::Enter);
        }
    }
    assert!(
        window.app().current().click_solution().is_some(),
        "{:?}",
        window.app().current().solution
    );
    // The paint is measured beside the work, and the verdict grows with it.
    window.wait_for(|shell| {
        let app = shell.app();
        !app.line_offsets(app.session.frame).is_empty()
    });
    window
}

fn a_key_shows_a_band_then_a_heat_map_then_neither() {
    let mut window = two_points_close_together();
    window.key(Key::U);
    assert_eq!(
        window.app().session.picture.uncertainty,
        UncertaintyView::Band
    );
    window.key(Key::U);
    assert_eq!(
        window.app().session.picture.uncertainty,
        UncertaintyView::Heat
    );
    window.harness.hover_at(pos2(1100.0, 500.0));
    window.harness.run_steps(3);
    // Rings and names have come to rest.
    for _ in 0..400 {
        window.harness.step();
    }
    window.snapshot_of(
        "heat",
        Rect::from_min_max(pos2(0.0, 24.0), pos2(980.0, 596.0)),
    );
    window.key(Key::U);
    assert_eq!(
        window.app().session.picture.uncertainty,
        UncertaintyView::Off
    );
}

fn the_details_rank_the_next_points_and_one_is_placed_from_there() {
    let mut window = two_points_close_together();
    let next = window.app().current().next_clicks.clone();
    assert!(next[0].share_left < 0.5, "{next:?}");
    assert!(
        next.windows(2)
            .all(|pair| pair[0].worst_corner_px <= pair[1].worst_corner_px)
    );
    window.harness.get_by_label("Details").scroll_to_me();
    window.harness.run_steps(3);
    window.press_label("Details");
    window.harness.run_steps(3);
    let picture = window.harness.get_by_label("Picture").rect();
    assert!(
        (picture.right() - 980.0).abs() < 1.5,
        "the panel keeps its width: {picture:?}"
    );
    let target = Target::Landmark(next[0].id.clone());
    let label = format!("{}: {}", window.app().label(&target), next[0].gain());
    window.harness.get_by_label(&label).scroll_to_me();
    window.harness.run_steps(3);
    window.press_label(&label);
    window.harness.run_steps(2);
    assert_eq!(window.app().session.mode, Mode::Placing(target));
}
