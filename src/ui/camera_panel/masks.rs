//! The list of masks: boxes of the picture, px, that are excluded from feature detection.

use super::section;
use crate::ui::Panel;
use crate::ui::controls::symbol::{self, Symbol};
use crate::ui::controls::theme::{self, Themed as _};
use egui::{Align, Button, Layout, RichText, Ui};
use strum::IntoEnumIterator as _;
use touchline_application::app::{Command, EditAction, MaskList, MaskScope, Tool};
use touchline_core::geometry::PixelBox;
use touchline_documents::document::{Camera, MaskSource, RangedMask};

/// Shows the masks of the camera for every frame, those for a range of frames, and those of the
/// shown frame.
pub fn show(panel: &mut Panel<'_>, ui: &mut Ui, camera: &Camera) {
    section(ui, "MASKS");
    let of_frame = panel
        .app
        .frame()
        .map(|frame| frame.masks.clone())
        .unwrap_or_default();
    if camera.masks.is_empty() && camera.ranged_masks.is_empty() && of_frame.is_empty() {
        theme::weak(
            ui,
            "None. Shift-drag a box around the score bug and each logo.",
        );
    }
    // One row for each mask of the three lists. An action names a mask by its list and its index
    // there.
    for (index, mask) in camera.masks.iter().enumerate() {
        row(panel, ui, MaskList::Camera, index, mask, "every frame");
    }
    for (index, mask) in camera.ranged_masks.iter().enumerate() {
        let covers = covers(mask);
        row(panel, ui, MaskList::Ranged, index, &mask.pixel_box, &covers);
    }
    for (index, mask) in of_frame.iter().enumerate() {
        row(panel, ui, MaskList::Frame, index, mask, "this frame");
    }
    let says = if panel.app.session.picture.tool == Tool::Mask {
        "Done drawing"
    } else {
        "Draw masks"
    };
    panel.run_on_click(ui.add(Button::new(says).small()), Command::ShowMasks);
}

/// Which frames a mask with a range covers, as text, and whether the program found it.
fn covers(mask: &RangedMask) -> String {
    let frames = match (mask.from, mask.to) {
        (None, None) => "every frame".to_owned(),
        (Some(from), None) => format!("from {from}"),
        (None, Some(to)) => format!("up to {to}"),
        (Some(from), Some(to)) => format!("{from}–{to}"),
    };
    if mask.source == MaskSource::Found {
        format!("{frames}, found")
    } else {
        frames
    }
}

/// Shows a mask with a menu that changes which frames it covers, and a button that removes it.
/// `covers` says which frames those are.
fn row(
    panel: &mut Panel<'_>,
    ui: &mut Ui,
    list: MaskList,
    index: usize,
    mask: &PixelBox,
    covers: &str,
) {
    ui.horizontal(|ui| {
        ui.label(format!("{:.0}, {:.0}", mask.x, mask.y))
            .on_hover_text("Left and top edge, px.");
        theme::weak(ui, format!("{:.0} × {:.0} px", mask.width, mask.height));
        // From right to left: the remove button stands at the end of every row, whatever the others
        // need.
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let name = format!("Remove mask {} of {covers}", index + 1);
            let palette = ui.palette();
            if symbol::button(ui, Symbol::Cross, &name, palette.weak)
                .on_hover_text("Remove this mask.")
                .clicked()
            {
                panel.edit(EditAction::RemoveMask { list, index });
            }
            let menu = ui.menu_button(RichText::new(covers).small(), |ui| {
                for scope in MaskScope::iter() {
                    let why_not = panel.app.why_not_scope(scope);
                    let entry = ui.add_enabled(why_not.is_none(), Button::new(scope.label()));
                    if entry
                        .on_disabled_hover_text(why_not.unwrap_or_default())
                        .clicked()
                    {
                        panel.edit(EditAction::ScopeMask { list, index, scope });
                        ui.close();
                    }
                }
            });
            menu.response.on_hover_text(
                "Which frames it covers; a range of a video is set at its first and last frame.",
            );
        });
    });
}
