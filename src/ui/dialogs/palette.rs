//! The command palette: every command, found by typing.

use super::{curtain, fuzzy, has_just_opened, recall};
use crate::ui::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::drawing::labels::lay_out_within;
use egui::{
    Align2, Area, Context, CornerRadius, FontId, Frame, Id, Key, Margin, Modifiers, Order, Role,
    ScrollArea, Sense, TextEdit, Ui, WidgetInfo, pos2, vec2,
};
use std::cmp::Reverse;
use touchline_application::app::synonyms::synonyms;
use touchline_application::app::{Action, App, Command, ViewAction};

/// Width of the palette, points.
const WIDTH: f32 = 520.0;
/// Height of a row, points.
const ROW: f32 = 28.0;
/// Score of a match by another word for a command.
const BY_SYNONYM: u32 = 60;
/// Number of rows in view.
const ROWS: f32 = 11.0;

/// The typed text and the index of the highlighted row.
#[derive(Clone, Default)]
struct State {
    typed: String,
    highlighted: usize,
}

/// Shows the palette.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    curtain(panel, ctx);
    // Text and highlight are in egui's memory: nothing outside the palette depends on them.
    let memory = Id::unique("palette");
    let opened = has_just_opened(ctx, "palette");
    let mut state: State = recall(ctx, memory, opened).unwrap_or_default();
    let all = ctx.content_rect();
    Area::new(Id::unique("command palette"))
        .order(Order::Foreground)
        .pivot(Align2::CENTER_TOP)
        .fixed_pos(pos2(
            all.center().x,
            all.top() + (all.height() * 0.14).round(),
        ))
        .role(egui::accesskit::Role::Dialog)
        .accessible_name("Command palette")
        .show(ctx, |ui| {
            Frame::window(ui.style())
                .inner_margin(Margin::same(8))
                .show(ui, |ui| {
                    ui.set_width(WIDTH.min(all.width() - 48.0));
                    contents(panel, ui, &mut state, opened);
                });
        });
    ctx.data_mut(|data| data.insert_temp(memory, state));
}

/// Shows the text field and the matching commands.
fn contents(panel: &mut Panel<'_>, ui: &mut Ui, state: &mut State, opened: bool) {
    // Arrows and Enter are read before the text field sees them.
    let (step, take) = ui.input_mut(|input| {
        let down = input.count_and_consume_key(Modifiers::NONE, Key::ArrowDown) as isize;
        let up = input.count_and_consume_key(Modifiers::NONE, Key::ArrowUp) as isize;
        (down - up, input.consume_key(Modifiers::NONE, Key::Enter))
    });
    let field = TextEdit::singleline(&mut state.typed)
        .hint_text("Type what you want to do")
        .desired_width(f32::INFINITY)
        .font(FontId::proportional(theme::BODY))
        .margin(Margin::symmetric(8, 6));
    let response = ui
        .add(field)
        .accessible_name("Command")
        .on_hover_text("Arrows choose, Enter runs the command, Esc closes.");
    if opened {
        response.request_focus();
    }
    if response.changed() {
        state.highlighted = 0;
    }
    // Typing starts again from the first row; arrows move on from the present one.
    let found = find_commands(panel.app, &state.typed);
    let last = found.len().saturating_sub(1);
    state.highlighted = state.highlighted.saturating_add_signed(step).min(last);
    ui.add_space(theme::SPACE);
    ui.spacing_mut().item_spacing.y = 0.0;
    if found.is_empty() {
        ui.add_space(theme::SPACE);
        ui.weak(format!("No command matches “{}”.", state.typed.trim()));
    }
    ScrollArea::vertical()
        .max_height(ROWS * ROW)
        .auto_shrink([false, true])
        .show(ui, |ui| {
            for (index, command) in found.iter().enumerate() {
                let chosen = index == state.highlighted;
                let clicked = row(
                    panel.app,
                    ui,
                    *command,
                    chosen,
                    chosen && (step != 0 || response.changed()),
                );
                if (clicked || chosen && take) && panel.app.why_not(*command).is_none() {
                    panel.actions.extend([
                        Action::View(ViewAction::CloseDialog),
                        Action::Command(*command),
                    ]);
                }
            }
        });
}

/// The matching commands: available ones first, then by score; in the order of the menus while
/// nothing is typed.
fn find_commands(app: &App, typed: &str) -> Vec<Command> {
    let candidates = Command::all().filter(|command| *command != Command::Palette);
    // The sort is stable: equal ranks stay in the order of the menus.
    let mut scored: Vec<((bool, Reverse<u32>), Command)> = candidates
        .filter_map(|command| {
            Some((
                (
                    app.why_not(command).is_some(),
                    Reverse(score(typed, command)?),
                ),
                command,
            ))
        })
        .collect();
    scored.sort_by_key(|(rank, _)| *rank);
    scored.into_iter().map(|(_, command)| command).collect()
}

/// How well a command matches the typed text, by its name, its menu, or another word for it; `None`
/// if it does not.
fn score(typed: &str, command: Command) -> Option<u32> {
    let typed = typed.trim();
    if typed.is_empty() {
        return Some(0);
    }
    let by_name = fuzzy::score(typed, command.name());
    let by_group = fuzzy::score(
        typed,
        &format!("{} {}", command.group().title(), command.name()),
    );
    // Another word matches only by its beginning, and scores less than a name all of whose words
    // begin as typed.
    let wanted = typed.to_lowercase();
    let is_synonym = synonyms(command)
        .split(' ')
        .any(|word| word.to_lowercase().starts_with(&wanted));
    let by_synonym = (wanted.len() > 2 && is_synonym).then_some(BY_SYNONYM);
    by_name.max(by_group).max(by_synonym)
}

/// Shows a command with its menu, or with the reason why it is not available, and its key. Returns
/// whether it was clicked.
fn row(app: &App, ui: &mut Ui, command: Command, chosen: bool, into_view: bool) -> bool {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let why_not = app.why_not(command);
    response.widget_info(|| {
        WidgetInfo::selected(Role::Button, why_not.is_none(), chosen, command.name())
    });
    if into_view {
        response.scroll_to_me(None);
    }
    if !ui.is_rect_visible(rect) {
        return false;
    }
    let painter = ui.painter();
    if chosen || response.hovered() {
        let ground = if chosen {
            ui.palette().accent_ground
        } else {
            ui.palette().raised
        };
        painter.rect_filled(rect, CornerRadius::same(4), ground);
    }
    let middle = rect.center().y;
    let name = if why_not.is_some() {
        ui.palette().weak
    } else {
        ui.palette().strong
    };
    let end = painter.text(
        pos2(rect.left() + 8.0, middle),
        Align2::LEFT_CENTER,
        command.name(),
        FontId::proportional(theme::BODY),
        name,
    );
    let key = app.settings.keys.key_label(command);
    let key = painter.text(
        pos2(rect.right() - 8.0, middle),
        Align2::RIGHT_CENTER,
        key,
        FontId::monospace(theme::SMALL),
        ui.palette().text,
    );
    // Beside the name: its menu, or why it is not available, cut where the key begins.
    let beside = why_not.unwrap_or_else(|| command.group().title());
    let left = end.right() + 10.0;
    let galley = lay_out_within(
        painter,
        beside.to_owned(),
        FontId::proportional(theme::SMALL),
        ui.palette().weak,
        (key.left() - 10.0 - left).max(0.0),
    );
    let at = pos2(left, middle - galley.size().y / 2.0);
    painter.galley(at, galley, ui.palette().weak);
    let about = command.about();
    let tip = why_not.map_or_else(|| about.to_owned(), |reason| format!("{about} {reason}"));
    response.on_hover_text(tip).clicked()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_typed_finds_the_command_that_is_meant() {
        let app = App::default();
        for (typed, wanted) in [
            ("undo", Command::Undo),
            ("next to do", Command::NextNeedsMe),
            ("expo", Command::Export),
            ("overlay style", Command::OverlayStyle),
            ("accept", Command::Accept),
            ("key", Command::Keys),
        ] {
            let best =
                Command::all().max_by_key(|command| (score(typed, *command), *command == wanted));
            assert_eq!(best, Some(wanted), "{typed}");
        }
        assert!(find_commands(&app, "zzzz").is_empty());
        assert_eq!(find_commands(&app, " ").len(), Command::all().count() - 1);
    }

    #[test]
    fn other_words_find_a_command_and_what_can_be_done_now_comes_first() {
        let app = App::default();
        for word in ["basketball", "sport", "pitch", "NBA"] {
            assert!(
                find_commands(&app, word).contains(&Command::ChooseSport),
                "{word}"
            );
        }
        assert!(find_commands(&app, "shortcuts").contains(&Command::Keys));
        // Nothing is open, so commands that need a document come last.
        let found = find_commands(&app, "");
        let first_refused = found
            .iter()
            .position(|command| app.why_not(*command).is_some())
            .unwrap();
        assert!(
            found[first_refused..]
                .iter()
                .all(|command| app.why_not(*command).is_some())
        );
    }
}
