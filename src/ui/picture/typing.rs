//! Decides whether a key after a click names the new point or is a command.
//!
//! # Problem
//!
//! The program often names a new point by itself. An annotator who types its code does not notice
//! in time and types on; the rest of the code must not be read as commands. And an Enter that was
//! meant to choose the name must not accept the frame.
//!
//! # Rules
//!
//! 1. After a point was named automatically, letters change its name, until the annotator places
//!    another point, moves the pointer away, or confirms the name.
//! 2. Enter first confirms the name. Only a second Enter, after a pause, accepts the frame.
//! 3. Keys in quick succession are one word: what begins as a name ends as one.
//!
//! Time is counted in frames of the window that were drawn, each for at most [`TICK_S`]. A frame
//! that takes 2 s to draw therefore cannot split a word.

use egui::{Context, Event, FocusDirection, Id, Key, Modifiers, Pos2};
use touchline_application::app::session::{Mode, Naming, OFFERED};
use touchline_application::app::{Action, App, Command, EditAction, Navigation};

/// Distance from where the pointer placed the point at which it has moved away, points.
const LEFT_POINTS: f32 = 30.0;
/// Time after placing a point during which Enter only confirms its name, s.
const CONFIRMING_S: f64 = 5.0;
/// Maximum time between two keys of one word, s.
const WORD_S: f64 = 0.4;
/// Maximum time that one frame of the window counts, s. All events that arrive while it is drawn
/// are treated as simultaneous.
const TICK_S: f64 = 0.1;

/// What the annotator did last. It is stored from one frame of the window to the next.
#[derive(Clone, Copy, Debug, Default)]
struct Hand {
    /// Time that counts only while the window draws, s.
    clock_s: f64,
    /// egui's time of the previous frame of the window, s.
    seen_s: f64,
    /// The point that was named automatically, if that name can still be changed by typing.
    placed: Option<AutoNamedPoint>,
    /// When a key last belonged to a name, in `clock_s`.
    stroke_s: Option<f64>,
}

/// A point that was named automatically: its index, when (in `clock_s`), where the pointer was on
/// the screen, and whether the pointer has moved away since.
#[derive(Clone, Copy, Debug)]
struct AutoNamedPoint {
    click: usize,
    at_s: f64,
    pointer: Option<Pos2>,
    has_left: bool,
}

impl Hand {
    /// Advances the clock to this frame of the window and follows point and pointer.
    fn follow(mut self, app: &App, time_s: f64, pointer: Option<Pos2>) -> Self {
        // The first frame counts for at most one tick: `seen_s` begins at 0.
        self.clock_s += (time_s - self.seen_s).clamp(0.0, TICK_S);
        self.seen_s = time_s;
        // Another point was named, or none is any more: begin again.
        let named = app
            .session
            .points
            .named_automatically
            .filter(|_| app.session.mode == Mode::Idle);
        let is_known = self.placed.map(|placed| placed.click) == named;
        if !is_known {
            self.placed = named.map(|click| AutoNamedPoint {
                click,
                at_s: self.clock_s,
                pointer,
                has_left: false,
            });
        }
        // Once the pointer has left, coming back changes nothing. Without a known position it never
        // leaves.
        if let Some(placed) = &mut self.placed {
            let away = placed
                .pointer
                .zip(pointer)
                .is_some_and(|(from, now)| from.distance(now) > LEFT_POINTS);
            placed.has_left |= away;
        }
        self
    }

    /// Whether a key stroke now continues the word that was typed before it.
    fn is_in_word(&self) -> bool {
        self.stroke_s
            .is_some_and(|stroke_s| self.clock_s - stroke_s < WORD_S)
    }

    /// Whether letters change the name of the point that was named automatically.
    fn names(&self) -> bool {
        self.placed
            .is_some_and(|placed| !placed.has_left || self.is_in_word())
    }

    /// Whether Enter only confirms that name.
    fn confirms(&self) -> bool {
        self.placed
            .is_some_and(|placed| self.clock_s - placed.at_s < CONFIRMING_S || self.names())
    }

    /// Whether the window must be drawn again to advance the clock, even if nothing happens.
    fn waits(&self) -> bool {
        self.is_in_word()
            || self
                .placed
                .is_some_and(|placed| self.clock_s - placed.at_s < CONFIRMING_S)
    }
}

/// Where [`Hand`] is stored.
fn memory() -> Id {
    Id::unique("the hand that types a name")
}

/// Whether letters change the name of the point that was named automatically.
pub fn names_placed(ctx: &Context) -> bool {
    ctx.data(|data| data.get_temp::<Hand>(memory()))
        .is_some_and(|hand| hand.names())
}

/// Reads the keys that concern names and removes them from the input, before anything else reads
/// them.
pub fn read(app: &App, actions: &mut Vec<Action>, ctx: &Context) {
    let (time_s, pointer) = ctx.input(|input| (input.time, input.pointer.latest_pos()));
    let before = ctx
        .data(|data| data.get_temp::<Hand>(memory()))
        .unwrap_or_default();
    // The clock advances even while another control has the keys, so that a word ends meanwhile.
    let mut hand = before.follow(app, time_s, pointer);
    if !keys_are_taken(app, ctx) {
        match &app.session.mode {
            Mode::Naming(naming) => read_list(naming, &mut hand, actions, ctx),
            _ => read_word(&mut hand, actions, ctx),
        }
    }
    if hand.waits() {
        ctx.request_repaint_after_secs(TICK_S as f32);
    }
    ctx.data_mut(|data| data.insert_temp(memory(), hand));
}

/// Whether a text field, a dialog or a menu receives the keys.
pub fn keys_are_taken(app: &App, ctx: &Context) -> bool {
    ctx.text_edit_focused() || app.session.dialog.is_some() || egui::Popup::is_any_open(ctx)
}

/// Reads the keys while the list of names is open.
fn read_list(naming: &Naming, hand: &mut Hand, actions: &mut Vec<Action>, ctx: &Context) {
    let mut typed = naming.typed.clone();
    let offered = naming.listed_candidates().len();
    // A digit's key takes a row. The text event that follows it must not type the digit as well.
    let mut digit = false;
    ctx.input_mut(|input| {
        input.events.retain(|event| {
            let action = match event {
                Event::Key {
                    key,
                    physical_key,
                    pressed: true,
                    modifiers,
                    ..
                } if is_typing(*modifiers) => {
                    let row = row_of(physical_key.unwrap_or(*key));
                    digit = row.is_some();
                    match row {
                        Some(row) => Some(take_row(row, offered)),
                        None => on_key(*key, naming, offered, &mut typed).map(Some),
                    }
                }
                Event::Text(_) if std::mem::take(&mut digit) => Some(None),
                Event::Text(text) => Some(on_text(text, naming, offered, &mut typed)),
                _ => None,
            };
            // `Some(None)`: the list takes the event, and nothing follows from it.
            let for_others = action.is_none();
            if !for_others {
                hand.stroke_s = Some(hand.clock_s);
            }
            actions.extend(action.flatten());
            for_others
        });
    });
    // The keys of the list must not move the keyboard focus as well.
    ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
}

/// Reads the keys while no list is open: letters change an automatic name, Enter confirms it, and
/// keys without a pause after a name are swallowed as part of it.
fn read_word(hand: &mut Hand, actions: &mut Vec<Action>, ctx: &Context) {
    // The state before this frame's events: all of them are treated as simultaneous.
    let (names, confirms, in_word) = (hand.names(), hand.confirms(), hand.is_in_word());
    if !(names || confirms || in_word) {
        return;
    }
    ctx.input_mut(|input| {
        input.events.retain(|event| match event {
            Event::Key {
                key: Key::Enter,
                pressed: true,
                modifiers,
                ..
            } if modifiers.is_none() => {
                if !(confirms || in_word) {
                    return true;
                }
                // An Enter within a word is swallowed even without an automatic name to confirm.
                actions.extend(confirms.then_some(Action::Navigate(Navigation::ConfirmName)));
                hand.stroke_s = Some(hand.clock_s);
                false
            }
            Event::Key {
                key,
                pressed: true,
                modifiers,
                ..
            } => {
                // The key itself is only kept from the commands. The name changes with the text
                // that the key types.
                let is_letter = (Key::A..=Key::Z).contains(key) && is_typing(*modifiers);
                !(is_letter && (names || in_word))
            }
            Event::Text(text) if text.chars().all(char::is_alphabetic) && (names || in_word) => {
                actions
                    .extend(names.then(|| Action::Navigate(Navigation::RefineName(text.clone()))));
                hand.stroke_s = Some(hand.clock_s);
                false
            }
            _ => true,
        });
    });
}

/// Whether a key with these modifiers types a character.
fn is_typing(modifiers: Modifiers) -> bool {
    !modifiers.command && !modifiers.alt
}

/// The row of the list that a digit's key takes, from 0. The physical key counts, because digits
/// need Shift on a French keyboard.
fn row_of(key: Key) -> Option<usize> {
    const DIGITS: [Key; OFFERED] = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5];
    DIGITS.iter().position(|digit| *digit == key)
}

/// Takes the name in a row, if the row exists.
fn take_row(row: usize, offered: usize) -> Option<Action> {
    (row < offered).then_some(Action::Edit(EditAction::TakeName(row)))
}

/// The action of a key in the list of names. Backspace shortens `typed`.
fn on_key(key: Key, naming: &Naming, offered: usize, typed: &mut String) -> Option<Action> {
    // The highlight wraps around at both ends. An empty list counts as one row, so that the
    // remainder is defined.
    match key {
        Key::Enter => Some(Action::Edit(EditAction::TakeName(naming.highlighted))),
        Key::ArrowDown => Some(Action::Navigate(Navigation::HighlightName(
            (naming.highlighted + 1) % offered.max(1),
        ))),
        Key::ArrowUp => Some(Action::Navigate(Navigation::HighlightName(
            (naming.highlighted + offered.max(1) - 1) % offered.max(1),
        ))),
        Key::Tab => Some(Action::Navigate(Navigation::ListLines(!naming.lines))),
        Key::Escape => Some(Action::Command(Command::Cancel)),
        Key::Backspace => {
            typed.pop();
            Some(Action::Navigate(Navigation::TypeName(typed.clone())))
        }
        _ => None,
    }
}

/// The action of a text in the list of names: a digit takes a row, a capital L switches between
/// landmarks and lines, everything else filters.
fn on_text(text: &str, naming: &Naming, offered: usize, typed: &mut String) -> Option<Action> {
    if let Some(number) = text
        .parse::<usize>()
        .ok()
        .filter(|number| (1..=OFFERED).contains(number))
    {
        return take_row(number - 1, offered);
    }
    if text == "L" {
        return Some(Action::Navigate(Navigation::ListLines(!naming.lines)));
    }
    typed.extend(text.chars().filter(|letter| !letter.is_control()));
    Some(Action::Navigate(Navigation::TypeName(typed.clone())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::main_window::keys;
    use egui::{RawInput, pos2};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;
    use touchline_application::app::PointerAction;
    use touchline_core::camera::PtzCamera;
    use touchline_core::geometry::{ImagePoint, ImageSize};
    use touchline_core::testing::{TestBase, base_at, landmark_in, soccer};
    use touchline_documents::document::{Click, FrameStatus};
    use touchline_documents::testing::{WithFrames, match_from};

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    fn pointed() -> PtzCamera {
        base_at([0.0, -60.0, 18.0], SIZE).aim(-14.0, -12.0, 1300.0)
    }

    fn image_of(landmark: &str) -> ImagePoint {
        let field = soccer();
        landmark_in(&pointed(), &field, landmark)
    }

    /// A window without panels that carries out the actions it reads.
    struct Hands {
        app: App,
        ctx: Context,
        time_s: f64,
        pointer: Pos2,
    }

    impl Hands {
        /// Three frames; the shown one has two points that determine its camera.
        fn new() -> Self {
            let mut document =
                match_from(pointed().base(), SIZE).with_pictures(["0.jpg", "1.jpg", "2.jpg"], SIZE);
            let named = ["penalty_area_far_left_front", "centre_circle_halfway_near"];
            document.frames[0].clicks = named
                .map(|id| Click::landmark(id.into(), image_of(id)))
                .into_iter()
                .collect();
            document.frames[0].status = FrameStatus::Draft;
            let mut app = App::with_document(document);
            app.update(Action::Edit(EditAction::SolveAgain));
            Self {
                app,
                ctx: Context::default(),
                time_s: 1.0,
                pointer: pos2(400.0, 300.0),
            }
        }

        /// Draws one frame of the window, `after_s` after the previous one.
        fn frame(&mut self, after_s: f64, mut events: Vec<Event>) {
            self.time_s += after_s;
            events.insert(0, Event::PointerMoved(self.pointer));
            self.ctx.begin_pass(RawInput {
                time: Some(self.time_s),
                events,
                focused: true,
                ..RawInput::default()
            });
            let mut actions = Vec::new();
            read(&self.app, &mut actions, &self.ctx);
            keys::read(&self.app, &mut actions, &self.ctx);
            // Nothing draws what these frames upload.
            self.ctx.end_pass().textures_delta.clear();
            for action in actions {
                self.app.update(action);
            }
        }

        fn wait(&mut self, seconds: f64) {
            for _ in 0..(seconds / 0.05).round() as usize {
                self.frame(0.05, Vec::new());
            }
        }

        fn place(&mut self, landmark: &str) {
            self.app.update(Action::Pointer(PointerAction::Press {
                at: image_of(landmark),
                on: None,
            }));
            self.app.update(Action::Pointer(PointerAction::Release));
            self.frame(0.02, Vec::new());
            assert_eq!(
                self.app.frame().unwrap().clicks.len(),
                3,
                "{landmark} lies in the picture"
            );
        }

        fn stroke(&mut self, after_s: f64, key: Key, text: &str) {
            let press = |pressed| Event::Key {
                key,
                physical_key: Some(key),
                pressed,
                repeat: false,
                modifiers: Modifiers::NONE,
            };
            let typed = (!text.is_empty()).then(|| Event::Text(text.to_owned()));
            self.frame(after_s, [press(true)].into_iter().chain(typed).collect());
            self.frame(0.01, vec![press(false)]);
        }

        fn type_letter(&mut self, after_s: f64, letter: char) {
            let key = Key::from_name(&letter.to_uppercase().to_string()).unwrap();
            self.stroke(after_s, key, &letter.to_string());
        }

        fn status(&self) -> FrameStatus {
            self.app.open().unwrap().frame(0).unwrap().status
        }
    }

    #[test]
    fn letters_belong_to_the_point_until_the_pointer_leaves_it() {
        let mut hands = Hands::new();
        hands.place("penalty_mark_left");
        assert!(
            hands.app.session.points.named_automatically.is_some(),
            "{:?}",
            hands.app.session.mode
        );
        hands.wait(20.0);
        hands.type_letter(0.1, 'k');
        assert!(
            matches!(hands.app.session.mode, Mode::Naming(_)),
            "however late it comes"
        );
        let mut hands = Hands::new();
        hands.place("penalty_mark_left");
        hands.pointer.x += 40.0;
        hands.type_letter(0.5, 'k');
        assert!(
            hands.app.frame().unwrap().clicks[2].check,
            "K makes it a check point"
        );
    }

    #[test]
    fn the_first_enter_confirms_and_only_another_one_accepts() {
        let mut hands = Hands::new();
        hands.place("penalty_mark_left");
        hands.pointer.x += 200.0;
        hands.stroke(0.1, Key::Enter, "");
        // A key that bounces sends two key presses.
        hands.stroke(0.1, Key::Enter, "");
        assert_eq!(
            (hands.status(), hands.app.session.points.named_automatically),
            (FrameStatus::Draft, None)
        );
        hands.wait(0.5);
        hands.stroke(0.1, Key::Enter, "");
        assert_eq!(hands.status(), FrameStatus::Reference);
    }

    #[test]
    fn a_slow_window_cuts_no_word_in_two() {
        let mut hands = Hands::new();
        hands.place("penalty_mark_left");
        hands.type_letter(0.1, 'p');
        hands.stroke(0.1, Key::Enter, "");
        // Each frame of the window takes two seconds to draw.
        hands.type_letter(2.0, 'x');
        hands.type_letter(2.0, 'n');
        assert_eq!(
            (
                hands.app.session.frame,
                hands.status(),
                &hands.app.session.mode
            ),
            (0, FrameStatus::Draft, &Mode::Idle)
        );
    }

    #[test]
    fn a_digit_chooses_by_its_place_on_the_keyboard() {
        let mut hands = Hands::new();
        hands.place("penalty_mark_left");
        hands
            .app
            .update(Action::Navigate(Navigation::RefineName("g".to_owned())));
        let Mode::Naming(naming) = &hands.app.session.mode else {
            panic!("{:?}", hands.app.session.mode)
        };
        let second = naming.listed_candidates()[1].target.clone();
        // On a French keyboard the physical key 2 types an é.
        let press = |pressed| Event::Key {
            key: Key::Num2,
            physical_key: Some(Key::Num2),
            pressed,
            repeat: false,
            modifiers: Modifiers::NONE,
        };
        hands.frame(0.1, vec![press(true), Event::Text("é".to_owned())]);
        assert_eq!(hands.app.frame().unwrap().clicks[2].target, Some(second));
    }

    /// `TOUCHLINE_SEQUENCES=10000` tries more sequences.
    #[test]
    fn no_burst_of_letters_after_a_click_accepts_or_touches_another_frame() {
        let bursts = std::env::var("TOUCHLINE_SEQUENCES")
            .ok()
            .and_then(|count| count.parse().ok())
            .unwrap_or(150);
        let marks = [
            "penalty_mark_left",
            "goal_area_far_left_front",
            "centre_mark",
        ];
        for seed in 0..bursts {
            let mut random = Pcg64Mcg::seed_from_u64(seed);
            let mut hands = Hands::new();
            let before = hands.app.open().unwrap().document.frames.clone();
            hands.place(marks[random.random_range(0..marks.len())]);
            hands.wait(random.random_range(0.0..4.0));
            let mut typed = String::new();
            for _ in 0..random.random_range(1..9) {
                let letter = char::from(b'a' + random.random_range(0..26_u8));
                hands.type_letter(random.random_range(0.02..0.35), letter);
                typed.push(letter);
                if random.random_range(0..8) == 0 {
                    hands.stroke(random.random_range(0.02..0.35), Key::Enter, "");
                    typed.push('\n');
                }
            }
            hands.stroke(random.random_range(0.02..0.35), Key::Enter, "");
            let frames = &hands.app.open().unwrap().document.frames;
            assert_eq!(
                (hands.app.session.frame, hands.status()),
                (0, FrameStatus::Draft),
                "{seed}: {typed:?}"
            );
            assert!(
                (1..3).all(|other| frames.get(other) == before.get(other)),
                "{seed}: {typed:?}"
            );
        }
    }
}
