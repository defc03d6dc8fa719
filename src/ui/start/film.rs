//! The moving picture of the start page: two clicks on a frame of the demo match, and the field's
//! lines where the camera that was solved from them projects them.

use crate::ui::controls::theme::{self, Themed as _};
use crate::ui::drawing::labels::{PlateStyle, plate};
use crate::ui::drawing::pictures::{WHOLE, decode_texture};
use egui::{
    Align2, Color32, Context, CornerRadius, FontId, Id, Painter, Pos2, Rect, Sense, Shape, Stroke,
    TextureHandle, Ui, Vec2, WidgetInfo, pos2, vec2,
};
use std::sync::Arc;
use touchline_application::jobs::MatchOrder;
use touchline_application::scene::OverlayStyle;
use touchline_core::camera::PtzCamera;
use touchline_core::field::builtin;
use touchline_core::geometry::ImagePoint;
use touchline_core::markings::{MarkingOptions, project_lines};
use touchline_core::solve::solve_two_points;

/// The two landmarks of the film, their names for readers, and where a person clicked them in frame
/// 13 of the demo match, px.
const CLICKS: [(&str, &str, ImagePoint); 2] = [
    (
        "centre_mark",
        "Centre mark",
        ImagePoint::new(65.941_590_693_969_74, 388.075_406_601_126_93),
    ),
    (
        "penalty_mark_right",
        "Penalty mark",
        ImagePoint::new(1_135.671_637_480_265_4, 307.249_682_636_723_43),
    ),
];

/// When each part of the film begins, s: the pointer sets out, the first click, the pointer goes on,
/// the second click, the lines, the end.
const SETS_OUT_S: f64 = 0.8;
const FIRST_CLICK_S: f64 = 1.8;
const GOES_ON_S: f64 = 2.8;
const SECOND_CLICK_S: f64 = 3.9;
const LINES_S: f64 = 4.2;
const END_S: f64 = 9.0;

/// The time in which the lines appear, s.
const FADE_S: f64 = 0.5;

/// The number of times that the film is shown by itself. Its last picture then stays, so that a
/// window left open rests.
const TIMES: f64 = 3.0;

/// Time between two pictures while something moves, s.
const STEP_S: f32 = 1.0 / 25.0;

/// Where the pointer sets out, as a share of the picture.
const POINTER_START: Pos2 = pos2(0.5, 0.9);

/// What the film shows.
struct Film {
    picture: TextureHandle,
    /// The clicks, as shares of the picture.
    clicks: [Pos2; 2],
    /// The field's lines under the solved camera, as shares of the picture.
    lines: Vec<Vec<Pos2>>,
}

/// The height of the film with its caption for a width, points.
pub fn height(width: f32) -> f32 {
    width * 9.0 / 16.0 + CAPTION
}

/// Height of the caption, points.
const CAPTION: f32 = 28.0;

/// Shows the film in a width. A click begins it again.
pub fn show(ui: &mut Ui, width: f32) {
    let (rect, response) = ui.allocate_exact_size(vec2(width, height(width)), Sense::click());
    let response = response.on_hover_text("How it works. Click to see it again.");
    response.widget_info(|| {
        WidgetInfo::labeled(egui::Role::Image, true, "How two clicks solve a frame")
    });
    let Some(film) = film(ui.ctx()) else { return };
    // The film begins when it is first shown. After TIMES rounds it rests at its end, without
    // repaints; a click begins again.
    let now = ui.input(|input| input.time);
    let begun_id = Id::unique("the film began");
    if response.clicked() {
        ui.data_mut(|data| data.insert_temp(begun_id, now));
    }
    let begun: f64 = ui.data_mut(|data| *data.get_temp_mut_or_insert_with(begun_id, || now));
    let passed = now - begun;
    let at_s = if passed < TIMES * END_S {
        ui.ctx().request_repaint_after_secs(STEP_S);
        passed % END_S
    } else {
        END_S
    };
    let picture = Rect::from_min_size(rect.min, vec2(width, width * 9.0 / 16.0));
    film.paint(&ui.painter_at(picture), picture, at_s);
    ui.painter().text(
        pos2(rect.left(), rect.bottom()),
        Align2::LEFT_BOTTOM,
        caption(at_s),
        FontId::proportional(theme::BODY),
        ui.palette().text,
    );
}

/// What happens at a moment of the film.
fn caption(at_s: f64) -> &'static str {
    if at_s < GOES_ON_S {
        "1. Click a point of the field that you know."
    } else if at_s < LINES_S {
        "2. And a second one."
    } else {
        "Pan, tilt and focal length are solved: the lines of the field follow."
    }
}

impl Film {
    /// Draws the picture of a moment.
    fn paint(&self, painter: &Painter, within: Rect, at_s: f64) {
        let corner = CornerRadius::same(6);
        let picture = egui::epaint::RectShape::filled(within, corner, Color32::WHITE);
        painter.add(picture.with_texture(self.picture.id(), WHOLE));
        let at = |share: Pos2| within.lerp_inside(share.to_vec2());

        // The lines fade in after the second click, as in the program itself the solution follows
        // the click that determines it.
        let [red, green, blue] = OverlayStyle::default().colour;
        let colour = Color32::from_rgb(red, green, blue);
        let shown = ((at_s - LINES_S) / FADE_S).clamp(0.0, 1.0) as f32;
        if shown > 0.0 {
            let stroke = Stroke::new(2.0, colour.gamma_multiply(shown));
            for line in &self.lines {
                painter.add(Shape::line(
                    line.iter().map(|share| at(*share)).collect(),
                    stroke,
                ));
            }
        }
        for ((_, name, _), (click, clicked_s)) in CLICKS
            .iter()
            .zip(self.clicks.iter().zip([FIRST_CLICK_S, SECOND_CLICK_S]))
        {
            if at_s >= clicked_s {
                paint_click(painter, at(*click), name, colour, within);
            }
        }
        // The last picture, which stays, has no pointer.
        if at_s < END_S - FADE_S {
            paint_pointer(painter, at(self.pointer(at_s)));
        }
    }

    /// Where the pointer is, as a share of the picture.
    fn pointer(&self, at_s: f64) -> Pos2 {
        let [first, second] = self.clicks;
        let (from, to, begin_s, end_s) = if at_s < GOES_ON_S {
            (POINTER_START, first, SETS_OUT_S, FIRST_CLICK_S)
        } else {
            (first, second, GOES_ON_S, SECOND_CLICK_S)
        };
        let share = ((at_s - begin_s) / (end_s - begin_s)).clamp(0.0, 1.0) as f32;
        // It starts and stops gently, as a hand does: 3 t² − 2 t³ has no speed at 0 and at 1.
        let share = share * share * (3.0 - 2.0 * share);
        from + (to - from) * share
    }
}

/// Draws a click with its name, on the side of the picture's middle.
fn paint_click(painter: &Painter, at: Pos2, name: &str, colour: Color32, within: Rect) {
    painter.circle_stroke(at, 7.0, Stroke::new(4.0, theme::ON_PICTURE.backdrop));
    painter.circle_stroke(at, 7.0, Stroke::new(2.0, colour));
    let (away, align) = if at.x < within.center().x {
        (12.0, Align2::LEFT_CENTER)
    } else {
        (-12.0, Align2::RIGHT_CENTER)
    };
    let font = FontId::proportional(theme::SMALL);
    let style = PlateStyle::new(font, Color32::WHITE, theme::ON_PICTURE.control);
    plate(painter, at + vec2(away, 0.0), align, name, style);
}

/// Draws an arrow with its tip at a point.
fn paint_pointer(painter: &Painter, tip: Pos2) {
    // The arrow is not convex, so it is filled as two triangles and outlined as a whole.
    let corners = [(0.0, 0.0), (0.0, 17.0), (4.5, 13.0), (12.0, 12.0)];
    let corners = corners.map(|(x, y)| tip + Vec2::new(x, y));
    painter.add(Shape::convex_polygon(
        vec![corners[0], corners[1], corners[2]],
        Color32::WHITE,
        Stroke::NONE,
    ));
    painter.add(Shape::convex_polygon(
        vec![corners[0], corners[2], corners[3]],
        Color32::WHITE,
        Stroke::NONE,
    ));
    painter.add(Shape::closed_line(
        corners.to_vec(),
        Stroke::new(1.0, Color32::BLACK),
    ));
}

/// The film, made at the first call. None if the picture or the field is not what they were when
/// this was written.
fn film(ctx: &Context) -> Option<Arc<Film>> {
    let id = Id::unique("film");
    if let Some(film) = ctx.data(|data| data.get_temp::<Arc<Film>>(id)) {
        return Some(film);
    }
    // Shares of the picture, because the film has any size on the screen.
    let order = MatchOrder::demo();
    let (width, height) = (
        order.image_size.width as f32,
        order.image_size.height as f32,
    );
    let share = |at: &ImagePoint| pos2(at.x as f32 / width, at.y as f32 / height);
    let lines = lines(&order)?;
    let film = Arc::new(Film {
        picture: decode_texture(ctx, "start page", touchline_assets::START_PICTURE)?,
        clicks: CLICKS.map(|(.., at)| share(&at)),
        lines: lines
            .iter()
            .map(|line| line.iter().map(share).collect())
            .collect(),
    });
    ctx.data_mut(|data| data.insert_temp(id, Arc::clone(&film)));
    Some(film)
}

/// The field's lines under the camera that the two clicks determine, px of the demo's pictures.
fn lines(order: &MatchOrder) -> Option<Vec<Vec<ImagePoint>>> {
    // Solved by the program's own two-point solver, so that the film shows what the program does.
    // Its roots come in ascending order of focal length; the first is shown.
    let field = builtin("soccer").ok()?.default_model().ok()?;
    let base = order.shoot.main_camera(order.image_size);
    let mut world = [touchline_core::geometry::Vec3::zeros(); 2];
    for (point, (id, ..)) in world.iter_mut().zip(&CLICKS) {
        *point = field.landmark_in_world(field.landmark(id)?);
    }
    let solved = solve_two_points(&base, world, CLICKS.map(|(.., at)| at)).ok()?;
    let camera = PtzCamera::new(base, solved.iter().next()?);
    let lines = project_lines(
        &field,
        &camera,
        order.image_size,
        &MarkingOptions::default(),
    );
    Some(lines.into_iter().map(|line| line.points).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::document::{Target, document_from_bytes};

    #[test]
    fn the_film_shows_the_demo_as_it_is_delivered() {
        let demo = include_bytes!("../../../projects/demo/project.json");
        let demo = document_from_bytes(demo).unwrap();
        let order = MatchOrder::demo();
        assert_eq!(
            demo.cameras[0].base(),
            Some(order.shoot.main_camera(order.image_size))
        );
        for (id, _, at) in CLICKS {
            let target = Some(Target::Landmark(id.into()));
            let mut clicks = demo.frames[12].clicks.iter();
            let click = clicks.find(|click| click.target == target).unwrap();
            assert_eq!(click.image, at);
        }
        let lines = lines(&order).unwrap();
        assert!(lines.len() > 8, "{} lines", lines.len());
    }
}
