//! Dialogs. At most one is open at a time.
//!
//! Most are sheets in the middle of the darkened window. They close with Escape or a click beside
//! them, and Tab stays within them. The dialogs about appearance (`overlay_style.rs`) leave the window bright and usable, so that their effect is seen.

mod about;
mod accept_all;
mod assign;
mod field_editor;
mod found_camera;
mod fuzzy;
mod gallery;
mod guide;
mod keys;
mod other_versions;
mod overlay_style;
mod palette;
mod preferences;
mod sport;
mod transfer;
mod typed;

pub use keys::captures_keys;

use super::{Panel, key_in_brackets};
use crate::ui::controls::theme::Themed as _;
use crate::ui::controls::{replace_remembered, show_button};
use crate::ui::controls::{symbol, theme};
use crate::ui::rows::menu::is_on;
use egui::{
    Align, Align2, Area, Button, Color32, Context, Frame, Id, Layout, Margin, Order, RichText,
    Sense, Ui, Vec2, vec2,
};
use std::any::Any;
use touchline_application::app::Command;
use touchline_application::app::session::Dialog;

/// Shows the open dialog, if any.
pub fn show(panel: &mut Panel<'_>, ui: &Ui) {
    let ctx = &ui.ctx().clone();
    match panel.app.session.dialog.clone() {
        None => {}
        Some(Dialog::Palette) => palette::show(panel, ctx),
        Some(Dialog::Keys) => keys::show(panel, ctx),
        Some(Dialog::About) => about::show(panel, ctx),
        Some(Dialog::Messages) => about::show_messages(panel, ctx),
        Some(Dialog::Sport) => sport::show(panel, ctx),
        Some(Dialog::FieldEditor) => field_editor::show(panel, ctx),
        Some(Dialog::Guide { page, behind }) => guide::show(panel, ctx, page, behind.is_some()),
        Some(Dialog::Preferences) => preferences::show(panel, ctx),
        Some(Dialog::PictureLook) => overlay_style::show_picture_look(panel, ctx),
        Some(Dialog::OverlayStyle) => overlay_style::show(panel, ctx),
        Some(Dialog::AcceptAll) => accept_all::show(panel, ctx),
        Some(Dialog::Gallery) => gallery::show(panel, ctx),
        Some(Dialog::DiscardBatch { batch, frames }) => {
            accept_all::show_discard_batch(panel, ctx, batch, frames);
        }
        Some(Dialog::Comment(comment)) => typed::show_comment(panel, ctx, &comment),
        Some(Dialog::FoundCamera) => found_camera::show(panel, ctx),
        Some(Dialog::GoToPlace) => typed::show_go_to(panel, ctx),
        Some(Dialog::AssignToCamera(scope)) => assign::show(panel, ctx, scope),
        Some(Dialog::Path(question)) => typed::show_path(panel, ctx, question),
        Some(Dialog::ChangedOutside) => other_versions::show_changed_outside(panel, ctx),
        Some(Dialog::Transfer) => transfer::show(panel, ctx),
        Some(Dialog::Orphans) => other_versions::show_orphans(panel, ctx),
        Some(Dialog::NotSaved(leaving)) => other_versions::show_not_saved(panel, ctx, &leaving),
    }
}

/// Whether this dialog has just opened, that is, was not shown in the previous frame of the window.
/// Then it takes the focus and forgets what was typed into it before.
fn has_just_opened(ctx: &Context, dialog: &str) -> bool {
    let (memory, now) = (
        Id::unique(("dialog was shown", dialog)),
        ctx.cumulative_frame_nr(),
    );
    // A dialog asks once in every frame of the window in which it is shown, so a gap in the numbers
    // means that it was closed.
    replace_remembered(ctx, memory, now).is_none_or(|before| before + 1 < now)
}

/// What was typed into or chosen in a dialog so far, unless it has just opened.
fn recall<T: 'static + Any + Clone>(ctx: &Context, memory: Id, has_opened: bool) -> Option<T> {
    ctx.data(|data| data.get_temp(memory))
        .filter(|_| !has_opened)
}

/// Darkens the window behind a dialog. A click there closes the dialog; nothing behind it can have
/// the keyboard focus.
fn curtain(panel: &mut Panel<'_>, ctx: &Context) {
    let all = ctx.content_rect();
    let area = Area::new(Id::unique("curtain"))
        .order(Order::Middle)
        .fixed_pos(all.min);
    // egui limits the focus to this layer and those above it.
    ctx.memory_mut(|memory| memory.set_modal_layer(area.layer()));
    area.show(ctx, |ui| {
        let (_, response) = ui.allocate_exact_size(all.size(), Sense::CLICK);
        ui.painter()
            .rect_filled(all, 0.0, Color32::from_black_alpha(96));
        if response.clicked() {
            panel.close_dialog();
        }
    });
}

/// Shows a dialog with a title in the middle of the window. `size` is the largest size of its
/// contents, points.
fn sheet(
    panel: &mut Panel<'_>,
    ctx: &Context,
    title: &str,
    size: Vec2,
    contents: impl FnOnce(&mut Panel<'_>, &mut Ui),
) {
    curtain(panel, ctx);
    let all = ctx.content_rect();
    // A margin stays free in a small window.
    let size = size.min(all.size() - vec2(48.0, 48.0));
    Area::new(Id::unique(("dialog", title)))
        .order(Order::Foreground)
        .pivot(Align2::CENTER_CENTER)
        .fixed_pos(all.center())
        .role(egui::accesskit::Role::Dialog)
        .accessible_name(title)
        .show(ctx, |ui| {
            frame(ui).show(ui, |ui| {
                ui.set_width(size.x);
                ui.set_max_height(size.y);
                header(panel, ui, title);
                contents(panel, ui);
            });
        });
}

/// Shows a dialog at the upper left of the picture that leaves the window bright and usable.
fn floating(
    panel: &mut Panel<'_>,
    ctx: &Context,
    title: &str,
    contents: impl FnOnce(&mut Panel<'_>, &mut Ui),
) {
    let corner = ctx.content_rect().min + vec2(16.0, 40.0);
    Area::new(Id::unique(("dialog", title)))
        .order(Order::Foreground)
        .fixed_pos(corner)
        .role(egui::accesskit::Role::Dialog)
        .accessible_name(title)
        .show(ctx, |ui| {
            frame(ui).show(ui, |ui| {
                ui.set_width(300.0);
                header(panel, ui, title);
                contents(panel, ui);
            });
        });
}

/// The border and margin of a dialog.
fn frame(ui: &Ui) -> Frame {
    Frame::window(ui.style()).inner_margin(Margin::same(16))
}

/// The title of a dialog, with the buttons that close it and open the guide.
fn header(panel: &mut Panel<'_>, ui: &mut Ui, title: &str) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(title).heading().color(ui.palette().strong));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let palette = ui.palette();
            let close = symbol::button(
                ui,
                symbol::Symbol::Cross,
                &format!("Close: {title}"),
                palette.weak,
            );
            if close.on_hover_text("Close. (Esc)").clicked() {
                panel.close_dialog();
            }
            to_guide(panel, ui);
        });
    });
    ui.add_space(theme::SPACE);
}

/// The button that closes the dialog without carrying anything out.
fn cancel(panel: &mut Panel<'_>, ui: &mut Ui, tip: &str) {
    if show_button(ui, Button::new("Cancel"), tip) {
        panel.close_dialog();
    }
}

/// A button that closes the dialog and runs a command. A command that is on already (a panel that
/// is open) is not run, because it would be switched off.
fn closing_button(panel: &mut Panel<'_>, ui: &mut Ui, button: Button<'_>, command: Command) {
    let tip = panel.app.settings.keys.tooltip(command);
    if show_button(ui, button, tip) {
        panel.close_dialog();
        if !is_on(panel.app, command) {
            panel.run(command);
        }
    }
}

/// The button that opens the guide at the page about this dialog, if there is one.
fn to_guide(panel: &mut Panel<'_>, ui: &mut Ui) {
    let Some(page) = panel.app.guide_page() else {
        return;
    };
    let button = Button::new(RichText::new("Guide").small().color(ui.palette().weak)).small();
    let key = key_in_brackets(&panel.app.settings.keys, Command::Guide);
    let tip = format!(
        "Open the user guide at “{}”; closing it leads back here.{key}",
        page.title()
    );
    if ui
        .add(button)
        .accessible_name(format!("Guide: {}", page.title()))
        .on_hover_text(tip)
        .clicked()
    {
        panel.run(Command::Guide);
    }
}
