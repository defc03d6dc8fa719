//! Number fields that can be dragged or typed. Each change is one step of undo.
//!
//! A typed text that cannot be used stays in the field, with the reason below it. Enter in a field
//! ends typing and never accepts the frame.

use super::theme::Themed as _;
use egui::{
    Area, CornerRadius, DragValue, Key, Label, Order, Response, RichText, Stroke, StrokeKind, Ui,
    vec2,
};
use std::cell::RefCell;
use std::ops::RangeInclusive;
use touchline_application::app::session::Mode;
use touchline_application::app::{Action, App, EditAction};

/// Time for which the reason for refusing a text is shown, s.
const PROBLEM_SHOWN_S: f64 = 8.0;
/// Maximum width of the reason, points.
const PROBLEM_WIDTH: f32 = 260.0;

/// A number field.
pub struct Number<'a> {
    /// Its accessible name.
    pub name: &'a str,
    /// The name of its step of undo.
    pub step: &'static str,
    /// Its tooltip: meaning and unit.
    pub tip: &'a str,
    /// The present value.
    pub value: f64,
    /// Change of the value for each point of dragging.
    pub speed: f64,
    /// Number of decimals.
    pub decimals: usize,
    /// The values that are accepted.
    pub range: RangeInclusive<f64>,
    /// The reason for that range, in words: "a camera stands above the field".
    pub why: &'a str,
    /// The unit, written after the number.
    pub suffix: &'a str,
    /// Width of the field, points.
    pub width: f32,
}

impl Number<'_> {
    /// Shows the field. `change` makes the action for a new value. The actions of one drag or of
    /// one typed text are between `Begin` and `End`, so that they are one step of undo; Escape
    /// aborts the step.
    pub fn show(
        self,
        ui: &mut Ui,
        app: &App,
        actions: &mut Vec<Action>,
        change: impl FnOnce(f64) -> Action,
    ) -> Response {
        let mut value = self.value;
        // The parser cannot return a reason, so it leaves it here. A cell, because egui wants a
        // parser that does not change what it captures.
        let problem = RefCell::new(None);
        let field = DragValue::new(&mut value)
            .speed(self.speed)
            .fixed_decimals(self.decimals)
            .range(self.range.clone())
            .custom_parser(|text| match self.read(text) {
                Ok(number) => number,
                Err(refused) => {
                    *problem.borrow_mut() = Some(refused);
                    None
                }
            })
            // A document may state a value out of range. It is shown as it is, not changed by
            // looking at it.
            .clamp_existing_to_range(false)
            .suffix(self.suffix)
            .update_while_editing(false)
            .min_size(vec2(self.width, ui.spacing().interact_size.y));
        let tip = format!(
            "{} Drag to change it (Shift: finer), click to type.",
            self.tip
        );
        let response = ui
            .add(field)
            .accessible_name(self.name)
            .on_hover_text(tip)
            .on_disabled_hover_text(self.tip);
        // How typing ended: with Escape, with a text that was refused, or with a number. After
        // Enter with a refused text the focus stays, so that the user can correct it.
        let given_up = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Escape));
        let left = response.lost_focus();
        let problem = problem.take().filter(|_| left && !given_up);
        let stays = problem.is_some() && ui.input(|input| input.key_pressed(Key::Enter));
        if stays {
            response.request_focus();
        }
        // The reason goes away with the next input.
        show_problem(
            ui,
            &response,
            problem,
            given_up || response.changed() || response.drag_started(),
        );
        let forgets = was_given_up(ui, &response, given_up);
        // A step of undo begins with a drag or with the focus, before the value changes.
        let begins = response.drag_started() || response.gained_focus();
        if begins {
            actions.push(Action::Edit(EditAction::Begin(self.step)));
        }
        // Escape cancels a drag although the button is still down. The drag must not begin again.
        let abandoned = response.dragged() && !begins && app.session.mode != Mode::Editing;
        // A field that the user has entered and left returns its rounded number. That is no change.
        let same = !response.dragged()
            && (value - self.value).abs() <= 0.5 * 10_f64.powi(-(self.decimals as i32));
        if response.changed() && !abandoned && !same && !forgets && value.is_finite() {
            actions.push(change(value));
        }
        // The end of the step of undo. The loss of the focus ends it even without a change, because
        // the focus began it.
        if given_up {
            actions.push(Action::Edit(EditAction::Abort));
        } else if response.drag_stopped() || left && !stays {
            actions.push(Action::Edit(EditAction::End));
        }
        response
    }
}

impl Number<'_> {
    /// Reads a typed text. Returns `None` if it is what the field shows already.
    ///
    /// # Errors
    /// One sentence for the user: it is not a number, or it is out of range.
    fn read(&self, text: &str) -> Result<Option<f64>, String> {
        let unit = self.suffix.trim();
        // The minus sign of typography and the unit may be typed, too.
        let digits = text.replace('−', "-");
        let digits = digits.trim();
        let digits = digits.strip_suffix(unit).unwrap_or(digits).trim();
        let Some(number) = digits
            .parse::<f64>()
            .ok()
            .filter(|number| number.is_finite())
        else {
            let hint = if digits.contains(',') {
                ": no commas, and decimals after a point"
            } else {
                ""
            };
            return Err(format!("“{}” is not a number{hint}.", text.trim()));
        };
        // The field shows a rounded number; reading that back must not change the value.
        if digits.parse() == format!("{:.*}", self.decimals, self.value).parse::<f64>() {
            return Ok(None);
        }
        if self.range.contains(&number) {
            return Ok(Some(number));
        }
        // The number as it was typed: rounded, it might seem to be within the range.
        let (from, upto) = (shortest(*self.range.start()), shortest(*self.range.end()));
        Err(format!(
            "{digits}{unit} is out of range: {from} to {upto}{}; {}.",
            self.suffix, self.why
        ))
    }
}

/// A number with at most two decimals and no trailing zeros.
pub fn shortest(number: f64) -> String {
    let rounded = (100.0 * number).round() / 100.0;
    if rounded == 0.0 {
        "0".to_owned()
    } else {
        rounded.to_string()
    }
}

/// Shows below a field why the typed text was refused, for [`PROBLEM_SHOWN_S`] seconds or until
/// something else is entered.
fn show_problem(ui: &Ui, response: &Response, problem: Option<String>, over: bool) {
    // The reason outlives the frame of the window in which the text was refused, so it is
    // remembered with the time of the refusal.
    let (memory, now) = (response.id.with("problem"), ui.input(|input| input.time));
    if let Some(problem) = problem {
        ui.data_mut(|data| data.insert_temp(memory, (problem, now)));
    } else if over {
        ui.data_mut(|data| data.remove::<(String, f64)>(memory));
    }
    let Some((text, since)) = ui.data(|data| data.get_temp::<(String, f64)>(memory)) else {
        return;
    };
    let left = PROBLEM_SHOWN_S - (now - since);
    if left <= 0.0 {
        return;
    }
    // Drawn as a tooltip above all panels. It does not take the pointer, because it may cover the
    // next field.
    ui.ctx().request_repaint_after_secs(left as f32);
    ui.painter().rect_stroke(
        response.rect,
        CornerRadius::same(4),
        Stroke::new(1.5, ui.palette().bad),
        StrokeKind::Outside,
    );
    Area::new(memory)
        .order(Order::Tooltip)
        .fixed_pos(response.rect.left_bottom() + vec2(0.0, 4.0))
        .interactable(false)
        .show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(PROBLEM_WIDTH);
                ui.add(Label::new(RichText::new(&text).color(ui.palette().bad)).wrap());
            });
        });
}

/// Whether Escape ended typing in this field in this frame of the window or one of the two before.
/// egui reports for two frames that a field has lost the focus, and in the second one it would
/// accept the text after all.
fn was_given_up(ui: &Ui, response: &Response, now: bool) -> bool {
    let (memory, frame) = (response.id.with("given up"), ui.ctx().cumulative_frame_nr());
    ui.data_mut(|data| {
        if now {
            data.insert_temp(memory, frame);
        }
        data.get_temp::<u64>(memory)
            .is_some_and(|left| frame <= left + 2)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view() -> Number<'static> {
        Number {
            name: "Field of view",
            step: "Set field of view",
            tip: "",
            value: 43.404,
            speed: 0.05,
            decimals: 2,
            range: 0.5..=150.0,
            why: "no lens shows less or more",
            suffix: "°",
            width: 60.0,
        }
    }

    #[test]
    fn what_is_typed_is_taken_or_refused_with_the_range_and_its_reason() {
        assert_eq!(view().read("50"), Ok(Some(50.0)));
        assert_eq!(view().read(" 50.5 ° "), Ok(Some(50.5)));
        assert_eq!(
            view().read("43.40"),
            Ok(None),
            "what the field shows already changes nothing"
        );
        assert_eq!(view().read("abc"), Err("“abc” is not a number.".to_owned()));
        assert_eq!(view().read("nan"), Err("“nan” is not a number.".to_owned()));
        let problem = "“50,5” is not a number: no commas, and decimals after a point.";
        assert_eq!(view().read("50,5"), Err(problem.to_owned()));
        let in_m = Number {
            suffix: " m",
            ..view()
        };
        assert_eq!(
            in_m.read("5 mm"),
            Err("“5 mm” is not a number.".to_owned()),
            "another unit, not the field's own twice"
        );
        for typed in ["-5", "−5"] {
            let problem = "-5° is out of range: 0.5 to 150°; no lens shows less or more.";
            assert_eq!(view().read(typed), Err(problem.to_owned()));
        }
        let problem = "150.001° is out of range: 0.5 to 150°; no lens shows less or more.";
        assert_eq!(view().read("150.001°"), Err(problem.to_owned()));
    }
}
