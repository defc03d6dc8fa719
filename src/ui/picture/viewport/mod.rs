//! The picture of the shown frame, with everything that is drawn over it.
//!
//! A frame of the window has two steps. [`read`] makes actions of the pointer before anything is
//! drawn, so that the overlay follows a dragged point without a delay of one frame. [`show`] then
//! draws, from back to front: picture, uncertainty, field and clicks (`scene.rs`), names
//! (`labels.rs`), proposed landmarks (`trust.rs`), texts
//! (`hints.rs`), masks, the loupe, and the list of names for a new click (`naming.rs`). In a blind
//! round `blind.rs` draws in its place.
//!
//! Positions are px of the picture ([`ImagePoint`]) or points of the screen; [`Placement`] converts
//! between them.

mod blind;
mod hints;
mod pointer;
mod scene;
mod trust;
mod wheel;

pub use wheel::Gesture;

use super::{loupe, masks, naming};
use crate::ui::controls::theme;
use crate::ui::drawing::canvas::Overlay;
use crate::ui::drawing::placement::Placement;
use crate::ui::drawing::{canvas, labels};
use crate::ui::rows::tools;
use crate::ui::{Panel, PictureState};
use egui::{CursorIcon, Id, Key, Rect, Sense, WidgetInfo};
use pointer::{DragTarget, Pointer, Surroundings};
use touchline_application::app::session::Mode;
use touchline_application::app::{App, Tool, ViewAction};
use touchline_application::render::{Layer, PictureKey, PictureLayer};
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_vision::media;

/// Waiting time after which the previous picture is dimmed and a spinner appears, s. A shorter wait
/// would only flicker.
const PATIENCE_S: f64 = 0.15;
/// Brightness of the previous picture while the next one is loading.
const DIMMED: f32 = 0.4;
/// Brightness of the picture below masks.
const BELOW_MASKS: f32 = 0.75;

/// What the viewport remembers between two frames of the window.
#[derive(Clone, Debug, Default)]
struct Remembered {
    pointer: Pointer,
    /// Key and pixels of the picture that was shown last.
    last: Option<(u64, media::Picture)>,
    /// When the wait for the shown frame's picture began, s; `None` while there is a picture.
    waiting_since: Option<f64>,
}

fn id() -> Id {
    Id::NULL.with("viewport")
}

/// Reads or changes what the viewport remembers. Do not use the context within `change`: it is
/// locked.
fn with_memory<T>(ctx: &egui::Context, change: impl FnOnce(&mut Remembered) -> T) -> T {
    ctx.data_mut(|data| change(data.get_temp_mut_or_default::<Remembered>(id())))
}

/// Ends what the pointer drags, while something else is in the picture's place: the button goes up
/// over that, and the picture would follow the pointer without a button.
pub fn let_go(ctx: &egui::Context) {
    with_memory(ctx, |remembered| remembered.pointer = Pointer::default());
}

/// Reads the pointer events of this frame of the window and makes actions of them.
///
/// The rectangle is that of the previous frame of the window, because this one is not laid out yet.
pub fn read(panel: &mut Panel<'_>, ctx: &egui::Context) {
    let Some(before) = ctx.read_response(id()) else {
        return;
    };
    let Some(frame) = panel.app.frame() else {
        return;
    };
    let session = &panel.app.session;
    let placement = Placement::new(
        before.rect,
        ctx.pixels_per_point(),
        frame.image_size,
        session.picture.view,
    );
    // A position counts only if no menu or dialog covers it.
    let layer = before.layer_id;
    let is_free = |at| {
        before.rect.contains(at)
            && before.enabled()
            && ctx.layer_id_at(at).is_none_or(|on_top| on_top == layer)
    };
    // A blind round hides the labels, so they cannot be dragged either.
    let hidden = panel.app.round().is_some();
    let clicks: Vec<ImagePoint> = frame
        .clicks
        .iter()
        .filter(|_| !hidden)
        .map(|click| click.image)
        .collect();
    // Drawn landmarks and lines are searched only where a press has found no click, because the
    // search projects the whole field.
    let (app, reach) = (panel.app, pointer::element_reach(&placement));
    let around = Surroundings {
        placement,
        clicks: &clicks,
        mode: &session.mode,
        hover: session.points.hover,
        ready: shown_picture(panel, frame.image_size).is_ok(),
        tool: session.picture.tool,
        space: is_moving_key_down(ctx),
        is_free: &is_free,
        drawn_at: &|at| app.grabbable(at, reach),
    };
    // The pointer's state is kept by egui between two frames of the window.
    let (events, modifiers) = ctx.input(|input| (input.events.clone(), input.modifiers));
    let mut pointer = with_memory(ctx, |remembered| remembered.pointer);
    panel
        .actions
        .extend(pointer.read(&events, modifiers, &around));
    with_memory(ctx, |remembered| remembered.pointer = pointer);
}

/// The shown frame's picture, if points can be placed on it; otherwise the reason.
fn shown_picture(panel: &Panel<'_>, expected: ImageSize) -> Result<(u64, media::Picture), Missing> {
    match panel.pictures.current() {
        // Clicks are stored in px of the picture that was labelled. In a picture of another size
        // they would all lie elsewhere.
        PictureState::Ready(_, picture) if picture.size() != expected => {
            let found = picture.size();
            Err(Missing::Never(format!(
                "The picture is {} × {} px, but the project says {} × {} px. Nothing can be clicked here, since every \
                 position would be wrong. Restore the picture that was labelled.",
                found.width, found.height, expected.width, expected.height
            )))
        }
        PictureState::Ready(key, picture) => Ok((key, picture)),
        PictureState::None | PictureState::Loading => Err(Missing::Yet),
        PictureState::Failed(reason) => Err(Missing::Never(reason)),
    }
}

/// Why there is no picture.
enum Missing {
    /// It is still loading.
    Yet,
    /// It cannot be shown; the reason, for the user.
    Never(String),
}

/// Shows the picture and everything over it.
pub fn show(panel: &mut Panel<'_>, ui: &mut egui::Ui) {
    let pixels_per_point = ui.pixels_per_point();
    let rect = egui::emath::GuiRounding::round_to_pixels(
        ui.available_rect_before_wrap(),
        pixels_per_point,
    );
    let response = ui.interact(rect, id(), Sense::CLICK | Sense::DRAG);
    ui.advance_cursor_after_rect(rect);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Canvas, true, "Picture"));
    // The rectangle lies on whole physical pixels, so that at 100 % the pixels of picture and
    // screen coincide.
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, theme::ON_PICTURE.backdrop);
    let Some(frame) = panel.app.frame() else {
        hints::no_frames(&painter, rect);
        return;
    };
    let expected = frame.image_size;
    let placement = Placement::new(
        rect,
        pixels_per_point,
        expected,
        panel.app.session.picture.view,
    );
    // Zoom commands need the scale at which the whole picture fits. The layout alone knows it.
    if panel.app.session.picture.fit_scale != placement.fit_scale {
        panel.view(ViewAction::FitScale(placement.fit_scale));
    }
    match shown_picture(panel, expected) {
        Ok((key, picture)) => {
            let hold = with_memory(ui.ctx(), |remembered| {
                remembered.last = Some((key, picture.clone()));
                remembered.waiting_since = None;
                remembered.pointer.hold
            });
            show_frame(panel, ui, &placement, &hold, key, picture);
        }
        Err(Missing::Yet) => show_placeholder(panel, ui, &placement),
        Err(Missing::Never(reason)) => hints::show_failure(&painter, rect, &reason),
    }
}

/// Shows another picture until the frame's own arrives: the decoded picture of the nearest frame,
/// or else the one shown before.
///
/// It is dimmed after [`PATIENCE_S`]. A picture of another size is not shown, because the view
/// would place it elsewhere.
fn show_placeholder(panel: &mut Panel<'_>, ui: &egui::Ui, placement: &Placement) {
    let (now, rect) = (ui.input(|input| input.time), placement.rect);
    let (last, since) = with_memory(ui.ctx(), |remembered| {
        (
            remembered.last.clone(),
            *remembered.waiting_since.get_or_insert(now),
        )
    });
    // After a jump, the decoded frame nearest to its goal resembles that more than the last one.
    let last = panel.pictures.nearest(panel.app.session.frame).or(last);
    // Short waits show the picture as it was; after that it is dimmed, with a spinner.
    let slow = now - since >= PATIENCE_S;
    if let Some((key, pixels)) = last
        && pixels.size() == placement.image_size
    {
        let look = panel
            .app
            .settings
            .picture
            .dim(if slow { DIMMED } else { 1.0 });
        let picture = Layer::Picture(PictureLayer {
            key: PictureKey(key),
            pixels,
            look,
        });
        canvas::paint(
            &ui.painter_at(rect),
            canvas::VIEWPORT,
            rect,
            placement.render_view(),
            vec![picture],
        );
    }
    if slow {
        egui::Spinner::new().paint_at(
            ui,
            Rect::from_center_size(rect.center(), egui::Vec2::splat(28.0)),
        );
    } else {
        ui.ctx()
            .request_repaint_after_secs((PATIENCE_S - (now - since)) as f32);
    }
}

/// Shows the picture with its layers, or the blind round.
fn show_frame(
    panel: &mut Panel<'_>,
    ui: &mut egui::Ui,
    placement: &Placement,
    hold: &DragTarget,
    key: u64,
    pixels: media::Picture,
) {
    let rect = placement.rect;
    // A blind round hides everything else.
    if panel.app.round().is_some() {
        let picture = Layer::Picture(PictureLayer {
            key: PictureKey(key),
            pixels,
            look: panel.app.settings.picture,
        });
        blind::show(panel, ui, placement, hold, &picture);
        return;
    }
    // What is drawn on the graphics card, from back to front.
    let overlay = Overlay::new(panel.app, hold, placement.scale);
    let look = panel
        .app
        .settings
        .picture
        .dim(if panel.app.session.picture.tool == Tool::Mask {
            BELOW_MASKS
        } else {
            1.0
        });
    let picture = Layer::Picture(PictureLayer {
        key: PictureKey(key),
        pixels,
        look,
    });
    let trust = trust::layer(panel.app);
    let layers = std::iter::once(picture.clone())
        .chain(trust)
        .chain(overlay.layers())
        .collect();
    let painter = ui.painter_at(rect);
    canvas::paint(
        &painter,
        canvas::VIEWPORT,
        rect,
        placement.render_view(),
        layers,
    );
    // What egui draws over it.
    labels::paint(&painter, placement, overlay.labels());
    trust::propose(panel, ui, &painter, placement);
    scene::show_features(panel.app, &painter, placement);
    hints::over_picture(panel, ui, placement);
    trust::legend(panel, &painter, placement);
    cursor(panel, ui, placement, hold);
    masks::show(panel, ui, placement);
    // The loupe shows the same picture, with the overlay at the loupe's zoom and without the marker
    // of the dragged click.
    if let Mode::Dragging { click, .. } = panel.app.session.mode {
        if let Some(held) = panel.app.frame().and_then(|frame| frame.clicks.get(click)) {
            let look = panel.app.settings.loupe;
            loupe::show(ui, look, placement, held.image, &picture, |zoom| {
                Overlay::around(panel.app, click, zoom)
            });
        }
    } else {
        loupe::rest(ui);
    }
    naming::show(panel, ui, placement);
    tools::paint_border(&painter, panel.app.session.picture.tool, rect);
}

/// Whether a drag from a place on the screen would move a drawn landmark or line.
fn is_over_drawn_element(app: &App, placement: &Placement, at: egui::Pos2) -> bool {
    let (in_image, reach) = (
        placement.image_from_screen(at),
        pointer::element_reach(placement),
    );
    app.grabbable(in_image, reach).is_some()
}

/// The pointer's shape over the picture while it drags nothing and the space bar is up.
fn resting_icon(app: &App, placement: &Placement, at: egui::Pos2) -> CursorIcon {
    let (mode, tool) = (&app.session.mode, app.session.picture.tool);
    let clicks: Vec<ImagePoint> = app
        .frame()
        .into_iter()
        .flat_map(|frame| &frame.clicks)
        .map(|click| click.image)
        .collect();
    // While a name waits for its place, a press places it, also with the tool that selects.
    let is_placing = matches!(mode, Mode::Placing(_));
    let is_on_click = pointer::click_to_grab(mode, placement, &clicks, at).is_some();
    if tool != Tool::Mask && is_on_click {
        CursorIcon::Move
    } else if tool == Tool::Select && !is_placing || is_over_drawn_element(app, placement, at) {
        CursorIcon::Grab
    } else {
        CursorIcon::Crosshair
    }
}

/// Sets the pointer's shape according to what a press would do here.
fn cursor(panel: &Panel<'_>, ui: &egui::Ui, placement: &Placement, hold: &DragTarget) {
    let icon = match hold {
        DragTarget::Picture(_) => CursorIcon::Grabbing,
        // A dragged point has a marker of its own, and a pointer would hide what is below it.
        DragTarget::Click { moving: true, .. } => CursorIcon::None,
        DragTarget::Click { .. } | DragTarget::Mask { .. } => CursorIcon::Crosshair,
        DragTarget::Nothing => {
            // Only over the picture: a menu or a dialog on top sets its own shape.
            let pointer = ui.input(|input| input.pointer.hover_pos());
            let Some(at) = pointer.filter(|at| is_uncovered(ui, placement.rect, *at)) else {
                return;
            };
            let icon = if is_moving_key_down(ui.ctx()) {
                CursorIcon::Grab
            } else {
                resting_icon(panel.app, placement, at)
            };
            if icon == CursorIcon::Crosshair {
                let tool = panel.app.session.picture.tool;
                tools::paint_beside_pointer(&ui.painter_at(placement.rect), tool, at);
            }
            icon
        }
    };
    ui.ctx().set_cursor_icon(icon);
}

/// Whether the space bar is down and types nothing: then dragging moves the picture.
fn is_moving_key_down(ctx: &egui::Context) -> bool {
    ctx.input(|input| input.key_down(Key::Space)) && !ctx.text_edit_focused()
}

/// Whether a position is in a rectangle of this layer, and no menu or dialog is on top of it.
fn is_uncovered(ui: &egui::Ui, rect: Rect, at: egui::Pos2) -> bool {
    rect.contains(at)
        && ui
            .ctx()
            .layer_id_at(at)
            .is_none_or(|on_top| on_top == ui.layer_id())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::open_with_click;
    use egui::{PointerButton, pos2, vec2};
    use touchline_application::app::session::PictureView;
    use touchline_documents::document::Target;

    #[test]
    fn the_pointer_promises_to_move_a_point_only_while_none_is_to_be_placed() {
        let mut app = open_with_click(ImagePoint::new(100.0, 100.0));
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(1280.0, 720.0));
        let size = ImageSize::new(1280, 720);
        let placement = Placement::new(rect, 1.0, size, PictureView::Fit);
        let on_click = pos2(102.0, 100.0);
        assert_eq!(resting_icon(&app, &placement, on_click), CursorIcon::Move);
        app.session.mode = Mode::Placing(Target::Landmark("centre_mark".into()));
        assert_eq!(
            resting_icon(&app, &placement, on_click),
            CursorIcon::Crosshair
        );
        app.session.picture.tool = Tool::Select;
        assert_eq!(
            resting_icon(&app, &placement, pos2(400.0, 400.0)),
            CursorIcon::Crosshair
        );
    }

    #[test]
    fn what_the_pointer_holds_is_forgotten_behind_another_page() {
        let ctx = egui::Context::default();
        let picture = DragTarget::Picture(PointerButton::Middle);
        with_memory(&ctx, |remembered| remembered.pointer.hold = picture);
        let_go(&ctx);
        let held = with_memory(&ctx, |remembered| remembered.pointer.hold);
        assert_eq!(held, DragTarget::Nothing);
    }
}
