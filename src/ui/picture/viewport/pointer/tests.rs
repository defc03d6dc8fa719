//! Presses, drags and releases, as the window sends them.

use super::*;
use egui::{PointerButton, Rect, pos2, vec2};
use touchline_application::app::session::PictureView;
use touchline_application::app::{EditAction, PointerAction, ViewAction};
use touchline_core::testing::SIZE;

/// A ring is drawn at (800, 600) and can be grabbed within 16 px.
fn drawn_ring(at: ImagePoint) -> Option<DrawnElement> {
    let image = ImagePoint::new(800.0, 600.0);
    (image.distance_px(at) <= 16.0).then(|| DrawnElement {
        target: touchline_documents::document::Target::Landmark("centre_mark".into()),
        image,
    })
}

/// At half size: two px of the picture per point.
fn read(pointer: &mut Pointer, events: &[Event], modifiers: Modifiers, mode: &Mode) -> Vec<Action> {
    read_with(Tool::Point, pointer, events, modifiers, mode)
}

fn read_with(
    tool: Tool,
    pointer: &mut Pointer,
    events: &[Event],
    modifiers: Modifiers,
    mode: &Mode,
) -> Vec<Action> {
    let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(960.0, 540.0));
    let around = Surroundings {
        placement: Placement::new(rect, 1.0, SIZE, PictureView::Fit),
        clicks: &[ImagePoint::new(400.0, 400.0), ImagePoint::new(410.0, 400.0)],
        mode,
        hover: None,
        ready: true,
        tool,
        space: false,
        is_free: &|at| rect.contains(at),
        drawn_at: &drawn_ring,
    };
    let mut actions = pointer.read(events, modifiers, &around);
    actions.retain(|action| !matches!(action, Action::Pointer(PointerAction::Hover(_))));
    actions
}

fn button(pos: Pos2, pressed: bool) -> Event {
    Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    }
}

const DRAGGING: Mode = Mode::Dragging {
    click: 0,
    placed: false,
};
#[test]
fn a_press_and_its_release_in_one_frame_are_both_seen() {
    let at = pos2(100.25, 50.5);
    let actions = read(
        &mut Pointer::default(),
        &[button(at, true), button(at, false)],
        Modifiers::NONE,
        &Mode::Idle,
    );
    let press = Action::Pointer(PointerAction::Press {
        at: ImagePoint::new(200.5, 101.0),
        on: None,
    });
    assert_eq!(actions, [press, Action::Pointer(PointerAction::Release)]);
}

#[test]
fn the_tool_that_selects_takes_hold_of_points_and_else_of_the_picture() {
    let held = |at: Pos2, mode: &Mode| {
        let mut pointer = Pointer::default();
        let press = [button(at, true)];
        read_with(Tool::Select, &mut pointer, &press, Modifiers::NONE, mode);
        pointer.hold
    };
    let picture = DragTarget::Picture(PointerButton::Primary);
    assert_eq!(held(pos2(100.0, 50.0), &Mode::Idle), picture);
    let on_click = held(pos2(201.0, 203.0), &Mode::Idle);
    assert!(matches!(on_click, DragTarget::Click { .. }), "{on_click:?}");
    // A name that was chosen first is placed.
    let placing = Mode::Placing(touchline_documents::document::Target::Landmark("x".into()));
    let placed = held(pos2(100.0, 50.0), &placing);
    assert!(matches!(placed, DragTarget::Click { .. }), "{placed:?}");
}

#[test]
fn a_press_grabs_the_nearest_click_and_small_movements_do_not_drag_it() {
    let mut pointer = Pointer::default();
    let events = [
        button(pos2(201.0, 203.0), true),
        Event::PointerMoved(pos2(202.0, 204.0)),
    ];
    let actions = read(&mut pointer, &events, Modifiers::NONE, &Mode::Idle);
    assert_eq!(
        actions,
        [Action::Pointer(PointerAction::Press {
            at: ImagePoint::new(402.0, 406.0),
            on: Some(0)
        })]
    );
    let actions = read(
        &mut pointer,
        &[button(pos2(202.0, 204.0), false)],
        Modifiers::NONE,
        &DRAGGING,
    );
    assert_eq!(actions, [Action::Pointer(PointerAction::Release)]);
}

#[test]
fn a_dragged_click_keeps_its_distance_from_the_pointer_and_shift_is_fine() {
    let mut pointer = Pointer::default();
    read(
        &mut pointer,
        &[button(pos2(201.0, 203.0), true)],
        Modifiers::NONE,
        &Mode::Idle,
    );
    let moves = [
        Event::PointerMoved(pos2(210.0, 203.0)),
        Event::PointerMoved(pos2(221.0, 213.0)),
    ];
    let actions = read(&mut pointer, &moves, Modifiers::NONE, &DRAGGING);
    assert_eq!(
        actions,
        [Action::Pointer(PointerAction::Drag(ImagePoint::new(
            440.0, 420.0
        )))],
        "one drag a frame of the window"
    );
    let actions = read(
        &mut pointer,
        &[Event::PointerMoved(pos2(231.0, 213.0))],
        Modifiers::SHIFT,
        &DRAGGING,
    );
    assert_eq!(
        actions,
        [Action::Pointer(PointerAction::Drag(ImagePoint::new(
            442.0, 420.0
        )))]
    );
}

#[test]
fn a_drawn_ring_is_grabbed_and_keeps_its_distance_from_the_pointer() {
    let mut pointer = Pointer::default();
    let pressed = [button(pos2(403.0, 304.0), true)];
    let grab = PointerAction::Grab {
        at: ImagePoint::new(806.0, 608.0),
        element: touchline_documents::document::Target::Landmark("centre_mark".into()),
    };
    assert_eq!(
        read(&mut pointer, &pressed, Modifiers::NONE, &Mode::Idle),
        [Action::Pointer(grab)]
    );
    let moved = [Event::PointerMoved(pos2(413.0, 304.0))];
    let drag = PointerAction::Drag(ImagePoint::new(820.0, 600.0));
    assert_eq!(
        read(&mut pointer, &moved, Modifiers::NONE, &DRAGGING),
        [Action::Pointer(drag)]
    );
}

#[test]
fn alt_at_the_release_keeps_the_point_where_it_is() {
    let mut pointer = Pointer::default();
    let at = pos2(100.0, 50.0);
    read(
        &mut pointer,
        &[button(at, true)],
        Modifiers::NONE,
        &Mode::Idle,
    );
    let released = Event::PointerButton {
        pos: at,
        button: PointerButton::Primary,
        pressed: false,
        modifiers: Modifiers::ALT,
    };
    assert_eq!(
        read(&mut pointer, &[released], Modifiers::ALT, &DRAGGING),
        [Action::Pointer(PointerAction::ReleaseExactly)]
    );
}

#[test]
fn a_drag_that_was_cancelled_lets_go() {
    let mut pointer = Pointer::default();
    read(
        &mut pointer,
        &[button(pos2(200.0, 200.0), true)],
        Modifiers::NONE,
        &Mode::Idle,
    );
    let moves = [
        Event::PointerMoved(pos2(300.0, 203.0)),
        button(pos2(300.0, 203.0), false),
    ];
    assert_eq!(read(&mut pointer, &moves, Modifiers::NONE, &Mode::Idle), []);
}

#[test]
fn a_mask_is_cancelled_with_its_tool() {
    let mut pointer = Pointer::default();
    let begun = [
        button(pos2(200.0, 200.0), true),
        Event::PointerMoved(pos2(300.0, 260.0)),
    ];
    let released = [button(pos2(300.0, 260.0), false)];
    let (none, idle) = (Modifiers::NONE, &Mode::Idle);
    read_with(Tool::Mask, &mut pointer, &begun, none, idle);
    let actions = read_with(Tool::Point, &mut pointer, &released, none, idle);
    assert_eq!(actions, []);
    read_with(Tool::Mask, &mut pointer, &begun, none, idle);
    let actions = read_with(Tool::Mask, &mut pointer, &released, none, idle);
    let adds = matches!(actions[..], [Action::Edit(EditAction::AddMask { .. })]);
    assert!(adds, "{actions:?}");
}

#[test]
fn with_a_chosen_name_a_click_near_another_point_places_a_new_one() {
    let mode = Mode::Placing(touchline_documents::document::Target::Landmark(
        "centre_mark".into(),
    ));
    let actions = read(
        &mut Pointer::default(),
        &[button(pos2(200.0, 200.0), true)],
        Modifiers::NONE,
        &mode,
    );
    assert_eq!(
        actions,
        [Action::Pointer(PointerAction::Press {
            at: ImagePoint::new(400.0, 400.0),
            on: None
        })]
    );
}

#[test]
fn a_middle_drag_moves_the_picture_and_leaves_points_alone() {
    let mut pointer = Pointer::default();
    let middle = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Middle,
        pressed,
        modifiers: Modifiers::NONE,
    };
    let events = [
        middle(pos2(200.0, 200.0), true),
        Event::PointerMoved(pos2(260.0, 200.0)),
        middle(pos2(260.0, 200.0), false),
    ];
    let actions = read(&mut pointer, &events, Modifiers::NONE, &Mode::Idle);
    assert!(
        actions
            .iter()
            .all(|action| matches!(action, Action::View(ViewAction::Picture(_)))),
        "{actions:?}"
    );
    assert_eq!(pointer.hold, DragTarget::Nothing);
}
