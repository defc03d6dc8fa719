//! The uncertainty of the projected lines over the picture: a band or a heat map with its legend,
//! and the landmarks to click next.
//!
//! All values are 1-σ of the overlay in px of the picture, from the covariance of the frame's
//! solution.

use crate::ui::Panel;
use crate::ui::controls::theme;
use crate::ui::drawing::labels::{PlateStyle, colour, plate};
use crate::ui::drawing::placement::Placement;
use egui::{Align2, Color32, FontId, Id, Mesh, Painter, Rect, Shape, Stroke, Ui, pos2, vec2};
use std::sync::Arc;
use touchline_application::app::App;
use touchline_application::app::session::Mode;
use touchline_application::render::Layer;
use touchline_application::scene::next_click::NextClick;
use touchline_application::scene::uncertainty::{
    HEAT_STOPS, HeatMap, UncertaintyView, band, heat_ticks_px,
};
use touchline_core::camera::PtzCamera;
use touchline_core::solve::{FrameSolution, GOOD_CORNER_SIGMA_PX};
use touchline_documents::document::FrameStatus;

/// Opacity of the heat map.
const HEAT_OPACITY: f32 = 0.45;
/// Maximum number of landmarks that are proposed in the picture.
const PROPOSED: usize = 3;
/// Minimum distance between two proposed landmarks, points. Of nearer ones only the better is
/// shown.
const CROWDED: f32 = 90.0;
/// How long the rings pulse, s.
const PULSING_S: f64 = 5.0;
/// Size of the legend, points.
const LEGEND: egui::Vec2 = vec2(284.0, 52.0);

/// The band or heat map of the shown frame, if it is switched on and the frame is solved.
pub fn layer(app: &App) -> Option<Layer> {
    // Only a solution that was computed here has a covariance; a recorded one has a few numbers.
    let (solved, camera) = solution_and_camera(app)?;
    let image_size = app.frame()?.image_size;
    match app.session.picture.uncertainty {
        UncertaintyView::Off => None,
        UncertaintyView::Band => {
            let field = app.current().field()?;
            let style = &app.overlay_style();
            Some(Layer::Drawing(Arc::new(band(
                &solved.uncertainty,
                field,
                camera,
                image_size,
                style,
            ))))
        }
        UncertaintyView::Heat => Some(Layer::Heat(
            Arc::new(HeatMap::new(&solved.uncertainty, camera, image_size)),
            HEAT_OPACITY,
        )),
    }
}

/// Solution and camera of the shown frame, unless the overlay is hidden or belongs to an estimated
/// base that is not applied yet.
fn solution_and_camera(app: &App) -> Option<(&FrameSolution, &PtzCamera)> {
    if app.session.picture.held.hide_overlay || app.current().proposal.is_some() {
        return None;
    }
    Some((
        app.current().click_solution()?,
        app.current().camera.as_ref()?,
    ))
}

/// Draws the legend in the picture's lower right corner, with 1-σ at the pointer, or else at the
/// worst corner of the picture.
pub fn legend(panel: &Panel<'_>, painter: &Painter, placement: &Placement) {
    let app = panel.app;
    if app.session.picture.uncertainty == UncertaintyView::Off
        || app.session.picture.held.hide_overlay
    {
        return;
    }
    let corner = placement.rect.right_bottom() - vec2(12.0, 12.0);
    let card = Rect::from_min_max(corner - LEGEND, corner);
    painter.rect_filled(card, 6.0, Color32::from_black_alpha(190));
    let inside = card.shrink2(vec2(10.0, 7.0));
    let font = FontId::proportional(theme::SMALL);
    let Some((solved, camera)) = solution_and_camera(app) else {
        let text = "Uncertainty: place points first";
        painter.text(
            inside.left_center(),
            Align2::LEFT_CENTER,
            text,
            font,
            theme::ON_PICTURE.weak,
        );
        return;
    };
    // 1-σ at the pointer, if it is over the picture.
    let here = app
        .session
        .points
        .hover
        .filter(|at| placement.image_size.contains(*at))
        .and_then(|at| solved.uncertainty.overlay_sigma_px(camera, at));
    let value = here.map_or_else(
        || format!("worst corner {}", solved.describe_corner()),
        |px| format!("here ±{px:.1} px"),
    );
    let title = format!("1-σ of the lines: {value}");
    painter.text(
        inside.left_top(),
        Align2::LEFT_TOP,
        title,
        font,
        theme::ON_PICTURE.strong,
    );
    if app.session.picture.uncertainty == UncertaintyView::Band {
        let text = "The band contains the true line in 68 of 100 cases.";
        painter.text(
            inside.left_bottom(),
            Align2::LEFT_BOTTOM,
            text,
            FontId::proportional(theme::SMALL),
            theme::ON_PICTURE.text,
        );
    } else {
        scale(
            painter,
            Rect::from_min_max(pos2(inside.left(), inside.top() + 18.0), inside.max),
            placement,
        );
    }
}

/// Draws the colour scale of the heat map: a bar with one tick for each colour stop.
fn scale(painter: &Painter, rect: Rect, placement: &Placement) {
    // A mesh with two vertices for each stop, between which the graphics card blends the colours as
    // it does in the heat map.
    let bar = Rect::from_min_max(rect.min, pos2(rect.right(), rect.top() + 8.0));
    let steps = (HEAT_STOPS.len() - 1) as f32;
    let mut mesh = Mesh::default();
    for (index, (stop, px)) in HEAT_STOPS
        .iter()
        .zip(heat_ticks_px(placement.image_size))
        .enumerate()
    {
        let x = bar.left() + index as f32 / steps * bar.width();
        mesh.colored_vertex(pos2(x, bar.top()), colour(*stop));
        mesh.colored_vertex(pos2(x, bar.bottom()), colour(*stop));
        let corner = 2 * index as u32;
        if index > 0 {
            mesh.add_triangle(corner - 2, corner - 1, corner);
            mesh.add_triangle(corner - 1, corner, corner + 1);
        }
        let align = match index {
            0 => Align2::LEFT_BOTTOM,
            last if last + 1 == HEAT_STOPS.len() => Align2::RIGHT_BOTTOM,
            _ => Align2::CENTER_BOTTOM,
        };
        // Two significant digits; the unit only at the first tick.
        let text = if px < 9.95 {
            format!("{px:.1}")
        } else {
            format!("{px:.0}")
        };
        let text = if index == 0 {
            format!("{text} px")
        } else {
            text
        };
        let text = text.replace(".0", "");
        painter.text(
            pos2(x, rect.bottom()),
            align,
            text,
            FontId::proportional(theme::SMALL),
            theme::ON_PICTURE.text,
        );
    }
    painter.add(Shape::mesh(mesh));
}

/// The best landmarks that are at least [`CROWDED`] points apart on the screen, at most
/// [`PROPOSED`]. `ranked` is in order of gain.
fn apart<'a>(ranked: &'a [NextClick], placement: &Placement) -> Vec<&'a NextClick> {
    // Greedy: each candidate is taken unless a better one that was taken is too near.
    let mut found: Vec<&NextClick> = Vec::new();
    for next in ranked {
        let at = placement.screen_from_image(next.at);
        if found
            .iter()
            .all(|other| placement.screen_from_image(other.at).distance(at) > CROWDED)
        {
            found.push(next);
        }
    }
    found.truncate(PROPOSED);
    found
}

/// For which state of the frame the proposals began to pulse, and when. Each new click starts
/// again.
#[derive(Clone, Default)]
struct Proposing {
    frame: usize,
    clicks: usize,
    since: f64,
}

/// Draws rings at the landmarks that would reduce the uncertainty most, if the frame is still too
/// uncertain and waits for a click. They pulse at first, to be noticed, and then stay still.
pub fn propose(panel: &Panel<'_>, ui: &Ui, painter: &Painter, placement: &Placement) {
    let app = panel.app;
    let Some(frame) = app.frame() else { return };
    // The limit is stated for pictures of 1920 px width.
    let limit_px = GOOD_CORNER_SIGMA_PX * frame.image_size.scale_from_1920();
    // Only a frame that is uncertain and waits for a click needs proposals.
    let unsure =
        solution_and_camera(app).is_some_and(|(solved, _)| solved.worst_corner_sigma_px > limit_px);
    let waits = app.session.mode == Mode::Idle
        && !matches!(frame.status, FrameStatus::Rejected | FrameStatus::Reference);
    if !unsure || !waits {
        return;
    }
    // Each new frame or click starts the pulsing again.
    let now = ui.input(|input| input.time);
    let memory = Id::NULL.with("proposed landmarks");
    let (index, clicks) = (app.session.frame, frame.clicks.len());
    let since = ui.data_mut(|data| {
        let known = data.get_temp_mut_or_default::<Proposing>(memory);
        if (known.frame, known.clicks) != (index, clicks) || known.since == 0.0 {
            *known = Proposing {
                frame: index,
                clicks,
                since: now,
            };
        }
        known.since
    });
    let pulsing = now - since < PULSING_S;
    for (rank, next) in apart(&app.current().next_clicks, placement)
        .into_iter()
        .enumerate()
    {
        // The rings pulse one after the other, in order of gain.
        let phase = if pulsing {
            ((now - since) * 3.0 - rank as f64 * 0.7).sin() as f32
        } else {
            0.0
        };
        let ring = theme::ON_PICTURE
            .caution
            .gamma_multiply(0.65 + 0.25 * phase);
        let at = placement.screen_from_image(next.at);
        painter.circle_stroke(
            at,
            13.0 + 2.5 * phase,
            Stroke::new(if rank == 0 { 2.0 } else { 1.25 }, ring),
        );
        let description = if rank == 0 {
            next.gain()
        } else {
            format!("±{:.1} px", next.worst_corner_px)
        };
        let style = PlateStyle::new(
            FontId::proportional(theme::SMALL),
            theme::ON_PICTURE.caution,
            Color32::from_black_alpha(150),
        );
        let below = at + vec2(0.0, 24.0);
        plate(painter, below, Align2::CENTER_CENTER, &description, style);
    }
    if pulsing {
        ui.ctx().request_repaint_after_secs(0.05);
    }
}
