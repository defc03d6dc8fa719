//! The picture of the shown frame, with everything that lies over it.
//!
//! [`read`] turns the pointer into actions before anything is drawn, so that the overlay follows a dragged point in the
//! same frame of the window; [`show`] draws.

mod blind;
mod features;
mod hints;
mod pointer;
mod scene;
mod trust;
mod wheel;

use super::overlay::Overlay;
use super::placement::Placement;
use super::{Panel, PictureState, canvas, labels, loupe, masks, naming, theme};
use egui::{CursorIcon, Id, Key, Rect, Sense, WidgetInfo};
use pointer::{Hold, Pointer, Surroundings};
use touchline_application::app::session::Mode;
use touchline_application::app::{Action, ViewAction};
use touchline_application::render::{Layer, PictureKey, PictureLayer};
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_vision::media;

pub use wheel::Gesture;

/// A picture that arrives within this time needs no waiting indicator, s.
const PATIENCE_S: f64 = 0.15;
/// The brightness of the previous picture while the next one is loading.
const DIMMED: f32 = 0.4;
/// How bright the picture is below masks.
const BELOW_MASKS: f32 = 0.75;

/// What the viewport remembers from one frame of the window to the next.
#[derive(Clone, Debug, Default)]
struct Remembered {
    pointer: Pointer,
    /// The picture that was shown last.
    last: Option<(u64, media::Picture)>,
    /// Since when the shown frame's picture is waited for, s.
    waiting_since: Option<f64>,
}

fn id() -> Id {
    Id::NULL.with("viewport")
}

fn remembered<T>(ctx: &egui::Context, change: impl FnOnce(&mut Remembered) -> T) -> T {
    ctx.data_mut(|data| change(data.get_temp_mut_or_default::<Remembered>(id())))
}

/// Reads the pointer.
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
    let layer = before.layer_id;
    let is_free = |at| {
        before.rect.contains(at)
            && before.enabled()
            && ctx.layer_id_at(at).is_none_or(|on_top| on_top == layer)
    };
    // A hidden label cannot be dragged either.
    let hidden = panel.app.round().is_some();
    let clicks: Vec<ImagePoint> = frame
        .clicks
        .iter()
        .filter(|_| !hidden)
        .map(|click| click.image)
        .collect();
    let around = Surroundings {
        placement,
        clicks: &clicks,
        mode: &session.mode,
        hover: session.points.hover,
        ready: shown_picture(panel, frame.image_size).is_ok(),
        masks: session.picture.masks,
        space: ctx.input(|input| input.key_down(Key::Space)) && !ctx.text_edit_focused(),
        is_free: &is_free,
    };
    let (events, modifiers) = ctx.input(|input| (input.events.clone(), input.modifiers));
    let mut pointer = remembered(ctx, |remembered| remembered.pointer);
    panel
        .actions
        .extend(pointer.read(&events, modifiers, &around));
    remembered(ctx, |remembered| remembered.pointer = pointer);
}

/// The shown frame's picture if points can be placed on it, or why not.
fn shown_picture(panel: &Panel<'_>, expected: ImageSize) -> Result<(u64, media::Picture), Missing> {
    match panel.pictures.current() {
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
    /// It is loading.
    Yet,
    /// It failed, and why.
    Never(String),
}

/// Shows the picture and what lies over it.
pub fn show(panel: &mut Panel<'_>, ui: &mut egui::Ui) {
    let pixels_per_point = ui.pixels_per_point();
    let rect = egui::emath::GuiRounding::round_to_pixels(
        ui.available_rect_before_wrap(),
        pixels_per_point,
    );
    let response = ui.interact(rect, id(), Sense::CLICK | Sense::DRAG);
    ui.advance_cursor_after_rect(rect);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Canvas, true, "Picture"));
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
    if panel.app.session.picture.fit_scale != placement.fit_scale {
        panel
            .actions
            .push(Action::View(ViewAction::FitScale(placement.fit_scale)));
    }
    match shown_picture(panel, expected) {
        Ok((key, picture)) => {
            let hold = remembered(ui.ctx(), |remembered| {
                remembered.last = Some((key, picture.clone()));
                remembered.waiting_since = None;
                remembered.pointer.hold
            });
            show_frame(panel, ui, &placement, &hold, key, picture);
        }
        Err(Missing::Yet) => show_stand_in(panel, ui, &placement),
        Err(Missing::Never(reason)) => hints::failed(&painter, rect, &reason),
    }
}

/// The decoded picture of the nearest frame, or else the previous picture, dimmed once the frame's
/// own takes longer.
fn show_stand_in(panel: &mut Panel<'_>, ui: &egui::Ui, placement: &Placement) {
    let (now, rect) = (ui.input(|input| input.time), placement.rect);
    let (last, since) = remembered(ui.ctx(), |remembered| {
        (
            remembered.last.clone(),
            *remembered.waiting_since.get_or_insert(now),
        )
    });
    let last = panel.pictures.nearest(panel.app.session.frame).or(last);
    let slow = now - since >= PATIENCE_S;
    if let Some((key, pixels)) = last
        && pixels.size() == placement.image_size
    {
        let look = panel
            .app
            .settings
            .picture
            .dimmed(if slow { DIMMED } else { 1.0 });
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

fn show_frame(
    panel: &mut Panel<'_>,
    ui: &mut egui::Ui,
    placement: &Placement,
    hold: &Hold,
    key: u64,
    pixels: media::Picture,
) {
    let rect = placement.rect;
    if panel.app.round().is_some() {
        let picture = Layer::Picture(PictureLayer {
            key: PictureKey(key),
            pixels,
            look: panel.app.settings.picture,
        });
        blind::show(panel, ui, placement, hold, &picture);
        return;
    }
    let overlay = Overlay::new(panel.app, hold, placement.scale);
    let look = panel
        .app
        .settings
        .picture
        .dimmed(if panel.app.session.picture.masks {
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
    labels::paint(&painter, placement, overlay.labels());
    trust::propose(panel, ui, &painter, placement);
    features::show(panel.app, &painter, placement);
    hints::over_picture(panel, ui, placement);
    trust::legend(panel, &painter, placement);
    cursor(panel, ui, placement, hold);
    masks::show(panel, ui, placement);
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
}

/// Sets the pointer's shape to what a press would do.
fn cursor(panel: &Panel<'_>, ui: &egui::Ui, placement: &Placement, hold: &Hold) {
    let icon = match hold {
        Hold::Picture(_) => CursorIcon::Grabbing,
        Hold::Click { moving: true, .. } => CursorIcon::None,
        Hold::Click { .. } | Hold::Mask { .. } => CursorIcon::Crosshair,
        Hold::Nothing => {
            let free = |at: &egui::Pos2| {
                placement.rect.contains(*at)
                    && ui
                        .ctx()
                        .layer_id_at(*at)
                        .is_none_or(|on_top| on_top == ui.layer_id())
            };
            let Some(at) = ui.input(|input| input.pointer.hover_pos()).filter(free) else {
                return;
            };
            let clicks: Vec<ImagePoint> = panel
                .app
                .frame()
                .into_iter()
                .flat_map(|frame| &frame.clicks)
                .map(|click| click.image)
                .collect();
            if ui.input(|input| input.key_down(Key::Space)) {
                CursorIcon::Grab
            } else if !panel.app.session.picture.masks
                && pointer::click_at(placement, &clicks, at).is_some()
            {
                CursorIcon::Move
            } else {
                CursorIcon::Crosshair
            }
        }
    };
    ui.ctx().set_cursor_icon(icon);
}
