//! Assigning frames to the camera that took them: one of the document's, or a new one.

use super::{has_just_opened, recall, sheet};
use crate::ui::Panel;
use crate::ui::controls::theme::{self, Themed as _};
use egui::{Button, Context, Id, RichText, ScrollArea, TextEdit, Ui, vec2};
use touchline_application::app::selection::Scope;
use touchline_application::app::{CameraChoice, EditAction, Navigation};
use touchline_core::geometry::pluralise;
use touchline_documents::document::CameraId;

/// Height of the list of cameras, points; longer lists scroll.
const LIST: f32 = 200.0;

/// Shows the dialog. `scope` says which frames are assigned.
pub fn show(panel: &mut Panel<'_>, ctx: &Context, scope: Scope) {
    let memory = Id::unique("name of the new camera");
    let opened = has_just_opened(ctx, "assign to camera");
    // The name of the new camera is kept while the dialog is open.
    let known = recall(ctx, memory, opened);
    let mut name: String = known.unwrap_or_else(|| suggested_name(panel));
    sheet(
        panel,
        ctx,
        "Assign frames to a camera",
        vec2(440.0, 420.0),
        |panel, ui| {
            let count = scopes(panel, ui, scope);
            ui.add_space(2.0 * theme::SPACE);
            theme::title(ui, "ASSIGN TO");
            cameras(panel, ui, scope, count);
            ui.add_space(2.0 * theme::SPACE);
            theme::title(ui, "OR CREATE A NEW CAMERA");
            ui.horizontal(|ui| {
                let field = ui.add(
                    TextEdit::singleline(&mut name)
                        .desired_width(240.0)
                        .hint_text("Name"),
                );
                let field = field.accessible_name("Name of the new camera");
                if opened {
                    // With the focus here, Enter creates the camera, and typing changes its name.
                    field.request_focus();
                }
                // Names are compared without the spaces around them, as they are stored.
                let taken = panel
                    .app
                    .open()
                    .is_some_and(|open| open.document.camera(&name.trim().into()).is_some());
                let possible = count > 0 && !taken && !name.trim().is_empty();
                let create = ui.add_enabled(possible, Button::new("Create and assign"));
                let why = if taken {
                    "There is already a camera of this name."
                } else {
                    "Enter a name and choose at least one frame."
                };
                let create = create
                    .on_hover_text("Its base has to be estimated afterwards.")
                    .on_disabled_hover_text(why);
                // A text field loses the focus with Enter.
                let entered =
                    field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
                if create.clicked() || (entered && possible) {
                    let camera = CameraChoice::New(name.trim().into());
                    panel.edit(EditAction::AssignToCamera { scope, camera });
                }
            });
            ui.add_space(theme::SPACE);
            let text = "Their points are solved with the other base. Proposed and manual values are removed. One step of undo.";
            theme::small_weak_text(ui, text);
        },
    );
    ctx.data_mut(|data| data.insert_temp(memory, name));
}

/// A free name, derived from the present camera's.
fn suggested_name(panel: &Panel<'_>) -> String {
    let open = panel.app.open().zip(panel.app.camera_id());
    open.map_or_else(String::new, |(open, camera)| {
        open.document.free_camera_name(camera).as_str().to_owned()
    })
}

/// The choice of frames. Returns their number.
fn scopes(panel: &mut Panel<'_>, ui: &mut Ui, chosen: Scope) -> usize {
    let Some(open) = panel.app.open() else {
        return 0;
    };
    // All scopes are counted in every frame of the window, since the counts stand beside them.
    let mut total = 0;
    for scope in Scope::ALL {
        let count = scope.frames(open, &panel.app.session).len();
        if scope == chosen {
            total = count;
        }
        let says = if count > 1 {
            format!("{} ({count})", scope.label())
        } else {
            scope.label().to_owned()
        };
        let row = ui.add_enabled(count > 0, egui::RadioButton::new(scope == chosen, says));
        let why = match scope {
            Scope::Selected => "Shift-click or Ctrl-click on the filmstrip selects frames.",
            _ => "This frame is not in a shot.",
        };
        if row.on_disabled_hover_text(why).clicked() {
            panel.navigate(Navigation::AskCamera(scope));
        }
    }
    total
}

/// Lists the cameras of the document; a click assigns the frames. Only a camera with pictures of
/// the same size is possible.
fn cameras(panel: &mut Panel<'_>, ui: &mut Ui, scope: Scope, count: usize) {
    let Some(open) = panel.app.open() else { return };
    // Principal point and focal lengths are in px of a camera's pictures, so frames of another size
    // do not belong to it.
    let size = panel.app.frame().map(|frame| frame.image_size);
    ScrollArea::vertical()
        .id_salt("cameras")
        .max_height(LIST)
        .show(ui, |ui| {
            for camera in &open.document.cameras {
                let frames = open.counts().count_of_camera(&camera.id);
                let known = if camera.base().is_some() {
                    ""
                } else {
                    ", base not known"
                };
                let button = Button::new(camera.id.as_str())
                    .right_text(
                        RichText::new(format!("{}{known}", pluralise(frames, "frame")))
                            .small()
                            .color(ui.palette().weak),
                    )
                    .min_size(vec2(ui.available_width(), 24.0));
                let is_own = scope == Scope::Frame && panel.app.camera_id() == Some(&camera.id);
                let fits = size == Some(camera.image_size);
                let row = ui.add_enabled(count > 0 && !is_own && fits, button);
                let why = if is_own {
                    "This frame is already assigned to this camera."
                } else if fits {
                    "Choose at least one frame."
                } else {
                    "Its pictures have another size."
                };
                let tip = format!("Assign to camera {}.", camera.id);
                if row.on_hover_text(tip).on_disabled_hover_text(why).clicked() {
                    let camera = CameraChoice::Known(CameraId::clone(&camera.id));
                    panel.edit(EditAction::AssignToCamera { scope, camera });
                }
            }
        });
}
