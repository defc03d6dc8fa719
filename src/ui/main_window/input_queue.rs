//! Limits the input of the window to one key stroke or button press per frame of the window.
//!
//! A key, a click and the next key may arrive within one frame of the window. What the second means
//! may depend on the effect of the first, which shows in the next frame only: a list opens, a text
//! field takes the focus, another frame is shown. So events beyond the first stroke or press wait
//! for the next frame. Their order never changes.
//!
//! A text field that has the focus takes letters and digits in bulk, so that a slow window does not
//! lag behind the typing: what they do does not depend on the frame of the window.

use egui::{Context, Event, Key, Plugin, RawInput};
use std::collections::VecDeque;

/// Keeps the events that wait for a later frame of the window.
#[derive(Debug, Default)]
pub struct InputQueue {
    waiting: VecDeque<Event>,
    /// The keys that are down: the physical key, and the logical key that it was when it went down.
    down: Vec<(Key, Key)>,
}

/// What a frame of the window has received so far.
#[derive(Debug, Default)]
struct ReceivedInput {
    /// The key that went down (`None` for text or the clipboard), and whether its text has
    /// followed.
    stroke: Option<(Option<Key>, bool)>,
    /// Whether it has an event of the pointer.
    pointer: bool,
    /// Whether a button of the pointer went down or up.
    button: bool,
    /// Whether a text field reads what is typed, and every key so far typed a character.
    types: bool,
}

impl ReceivedInput {
    /// Accepts an event, or refuses it because it must wait for the next frame. The first refusal
    /// ends the frame.
    fn accepts(&mut self, event: &Event) -> bool {
        // A refusal may change the fields as well. That does no harm, because no event of this
        // frame is accepted after it.
        match event {
            // The modifiers must be those at the time of the key stroke or button press.
            Event::ModifiersChanged(_) => self.stroke.is_none() && !self.button,
            Event::WindowFocused(_) => true,
            // A key that went down in this frame goes up in the next one. Otherwise egui would
            // never see it down.
            Event::Key {
                pressed: false,
                key,
                ..
            } => {
                let is_new = self.stroke.is_none_or(|(down, _)| down != Some(*key));
                !self.pointer && (is_new || self.types)
            }
            // The text that a key types belongs to its stroke.
            Event::Text(_) if matches!(self.stroke, Some((Some(_), false))) => {
                self.stroke = self.stroke.map(|(key, _)| (key, true));
                true
            }
            Event::Key { key, modifiers, .. } => {
                let types = is_character(*key) && !modifiers.command && !modifiers.alt;
                self.accepts_stroke(Some(*key), types)
            }
            // A text that no key of this frame has typed, for example from an input method, is a
            // stroke of its own.
            Event::Text(_) => self.accepts_stroke(None, true),
            Event::Ime(_)
            | Event::Copy
            | Event::Cut
            | Event::Paste(_)
            | Event::PasteImage(_)
            | Event::MiddleClickPaste { .. } => self.accepts_stroke(None, false),
            // A click may end in the frame in which it began, but a second press waits.
            Event::PointerButton { pressed, .. } => {
                let free = self.stroke.is_none() && !(*pressed && self.button);
                (self.pointer, self.button) = (true, true);
                free
            }
            // Movements, wheel and touch may pile up before a stroke, but none passes one.
            _ => {
                self.pointer = true;
                self.stroke.is_none()
            }
        }
    }

    /// Accepts a key stroke if the frame has no other stroke and no event of the pointer. `types`:
    /// whether it types a character, of which a text field takes several.
    fn accepts_stroke(&mut self, key: Option<Key>, types: bool) -> bool {
        let free = !self.pointer && (self.stroke.is_none() || self.types && types);
        self.stroke = Some((key, false));
        self.types &= types;
        free
    }
}

/// Whether a key types a letter, a digit, a sign or a space.
fn is_character(key: Key) -> bool {
    key == Key::Space || key.symbol_or_name().chars().count() == 1 && !is_arrow(key)
}

/// Whether a key is an arrow, which has a sign of its own.
const fn is_arrow(key: Key) -> bool {
    matches!(
        key,
        Key::ArrowLeft | Key::ArrowRight | Key::ArrowUp | Key::ArrowDown
    )
}

impl InputQueue {
    /// Queues new events and returns those for the next frame of the window. `into_text`: whether a
    /// text field has the focus.
    fn exchange(&mut self, events: Vec<Event>, into_text: bool) -> Vec<Event> {
        let mut text_of_repeat = false;
        for event in events {
            if event == Event::WindowFocused(false) {
                // Another window receives the events of keys that go up there.
                self.down.clear();
            }
            let event = self.match_release_to_press(event);
            match &event {
                // Repeats of a key that stays down are dropped while one waits, so that they do not
                // pile up in a slow window; so is the text that each of them types.
                Event::Key {
                    key, pressed: true, ..
                } if self.is_down_at_end(*key) => {
                    text_of_repeat = true;
                    continue;
                }
                Event::Text(_) if std::mem::take(&mut text_of_repeat) => continue,
                _ => text_of_repeat = false,
            }
            self.waiting.push_back(event);
        }
        // Whatever still waits, the order stays: the first event that has to wait ends the frame.
        let mut given = ReceivedInput {
            types: into_text,
            ..ReceivedInput::default()
        };
        let count = self
            .waiting
            .iter()
            .take_while(|event| given.accepts(event))
            .count();
        self.waiting.drain(..count).collect()
    }

    /// Makes a key go up as the logical key that it went down as.
    ///
    /// Otherwise, if Shift goes up before the slash, a question mark has gone down and a slash goes
    /// up. The question mark would stay down, and its next press would count as a repetition.
    fn match_release_to_press(&mut self, event: Event) -> Event {
        let Event::Key {
            key,
            physical_key: Some(physical),
            pressed,
            repeat,
            modifiers,
        } = event
        else {
            return event;
        };
        // A repetition keeps the first press. A key without a known press went down in another
        // window, so its own name is all there is.
        let known = self.down.iter().position(|(down, _)| *down == physical);
        let meant = match (known, pressed) {
            (Some(known), false) => self.down.swap_remove(known).1,
            (None, true) => {
                self.down.push((physical, key));
                key
            }
            (Some(_), true) | (None, false) => key,
        };
        Event::Key {
            key: meant,
            physical_key: Some(physical),
            pressed,
            repeat,
            modifiers,
        }
    }

    /// Whether the last waiting event of a key is a press.
    fn is_down_at_end(&self, wanted: Key) -> bool {
        let last = self.waiting.iter().rev().find_map(|event| match event {
            Event::Key { key, pressed, .. } if *key == wanted => Some(*pressed),
            _ => None,
        });
        last == Some(true)
    }
}

impl Plugin for InputQueue {
    fn debug_name(&self) -> &'static str {
        "input queue"
    }

    fn input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        let into_text = ctx.text_edit_focused();
        input.events = self.exchange(std::mem::take(&mut input.events), into_text);
        if !self.waiting.is_empty() {
            ctx.request_repaint();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Modifiers, PointerButton, pos2};

    fn key(key: Key, pressed: bool) -> Event {
        Event::Key {
            key,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: Modifiers::NONE,
        }
    }

    fn text(text: &str) -> Event {
        Event::Text(text.to_owned())
    }

    fn button(pressed: bool) -> Event {
        let (pos, button, modifiers) = (pos2(1.0, 2.0), PointerButton::Primary, Modifiers::NONE);
        Event::PointerButton {
            pos,
            button,
            pressed,
            modifiers,
        }
    }

    /// The events of each frame of the window, if these events arrive together.
    fn frames(events: &[Event]) -> Vec<Vec<Event>> {
        let mut queue = InputQueue::default();
        let first = queue.exchange(events.to_vec(), false);
        let mut frames = vec![first];
        while !queue.waiting.is_empty() {
            frames.push(queue.exchange(Vec::new(), false));
        }
        frames
    }

    #[test]
    fn each_stroke_comes_alone_with_its_text() {
        let [x, one] = [key(Key::X, true), key(Key::Num1, true)];
        assert_eq!(
            frames(&[x.clone(), text("x"), one.clone(), text("1"), text("é")]),
            [
                vec![x.clone(), text("x")],
                vec![one.clone(), text("1")],
                vec![text("é")]
            ]
        );
        let [x_up, one_up] = [key(Key::X, false), key(Key::Num1, false)];
        assert_eq!(
            frames(&[x.clone(), x_up.clone(), one.clone(), one_up.clone()]),
            [vec![x], vec![x_up, one], vec![one_up]],
            "a key goes up in the frame after it went down"
        );
    }

    #[test]
    fn a_text_field_takes_letters_in_bulk_and_other_keys_alone() {
        let stroke = |of, typed: &str| [key(of, true), text(typed), key(of, false)];
        let word: Vec<Event> = [stroke(Key::A, "a"), stroke(Key::B, "b")].concat();
        let enter = [key(Key::Enter, true), key(Key::Enter, false)];
        let mut queue = InputQueue::default();
        let first = queue.exchange([word.clone(), enter.to_vec()].concat(), true);
        assert_eq!(first, word);
        assert_eq!(queue.exchange(Vec::new(), true), [enter[0].clone()]);
        assert_eq!(queue.exchange(Vec::new(), true), [enter[1].clone()]);
    }

    #[test]
    fn keys_and_pointer_keep_their_order() {
        let (moved, n) = (Event::PointerMoved(pos2(3.0, 4.0)), key(Key::N, true));
        assert_eq!(
            frames(&[
                moved.clone(),
                button(true),
                button(false),
                n.clone(),
                moved.clone(),
                button(true)
            ]),
            [
                vec![moved.clone(), button(true), button(false)],
                vec![n],
                vec![moved.clone(), button(true)]
            ]
        );
        assert_eq!(
            frames(&[
                button(true),
                moved.clone(),
                button(false),
                button(true),
                button(false)
            ]),
            [
                vec![button(true), moved, button(false)],
                vec![button(true), button(false)]
            ],
            "each press is interpreted after the effect of the one before"
        );
    }

    #[test]
    fn modifiers_change_where_they_are_pressed() {
        let [ctrl, none] = [Modifiers::COMMAND, Modifiers::NONE].map(Event::ModifiersChanged);
        let z = key(Key::Z, true);
        assert_eq!(
            frames(&[
                ctrl.clone(),
                z.clone(),
                none.clone(),
                key(Key::Z, false),
                z.clone()
            ]),
            [
                vec![ctrl.clone(), z.clone()],
                vec![none.clone(), key(Key::Z, false), z]
            ]
        );
        assert_eq!(
            frames(&[ctrl.clone(), button(true), button(false), none.clone()]),
            [vec![ctrl, button(true), button(false)], vec![none]]
        );
    }

    #[test]
    fn a_held_key_does_not_run_ahead_and_taps_are_all_there() {
        let (down, up) = (key(Key::Period, true), key(Key::Period, false));
        let held = [
            down.clone(),
            text("."),
            down.clone(),
            text("."),
            down.clone(),
            text("."),
            up.clone(),
        ];
        assert_eq!(
            frames(&held),
            [vec![down.clone(), text(".")], vec![up.clone()]]
        );
        let taps = [down.clone(), up.clone(), down.clone(), up.clone()];
        assert_eq!(
            frames(&taps),
            [vec![down.clone()], vec![up.clone(), down], vec![up]]
        );
    }

    #[test]
    fn a_key_goes_up_as_what_it_went_down_as() {
        let event = |key: Key, pressed: bool, modifiers: Modifiers| Event::Key {
            key,
            physical_key: Some(Key::Slash),
            pressed,
            repeat: false,
            modifiers,
        };
        let mut queue = InputQueue::default();
        for _ in 0..2 {
            let shifted = event(Key::Questionmark, true, Modifiers::SHIFT);
            assert_eq!(queue.exchange(vec![shifted.clone()], false), [shifted]);
            // Shift went up before.
            let up = queue.exchange(vec![event(Key::Slash, false, Modifiers::NONE)], false);
            assert_eq!(up, [event(Key::Questionmark, false, Modifiers::NONE)]);
        }
    }
}
