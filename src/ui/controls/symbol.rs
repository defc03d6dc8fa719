//! Symbols, as glyphs of a font of icons. Each button with a symbol has an accessible name.

use super::theme::{self, Themed as _};
use egui::{
    Align2, Atom, Color32, Context, FontData, FontDefinitions, FontFamily, FontId, Painter, Rect,
    Response, Role, Sense, Ui, Vec2, WidgetInfo, vec2,
};
use std::sync::Arc;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symbol {
    /// Close or delete.
    Cross,
    /// A check point.
    Diamond,
    /// A point on a line.
    OnLine,
    /// A point on a landmark.
    Landmark,
    /// The pointer that selects.
    Pointer,
    Mask,
    /// Selected.
    Tick,
    /// The Enter key.
    Return,
    Warning,
    /// Information.
    Info,
    /// Collapsed; a click expands.
    Folded,
    /// Expanded; a click collapses.
    Unfolded,
    Play,
    Pause,
    /// A video.
    Film,
    Folder,
    /// A project.
    Document,
    /// Pictures to try.
    Picture,
    Lesson,
    Camera,
    Forest,
    /// A list to work through.
    List,
    Plot,
}

impl Symbol {
    /// Its code in the font of icons (`.ci/icons`).
    const fn glyph(self) -> char {
        match self {
            Self::Cross => '\u{e1b2}',
            Self::Diamond => '\u{e2d2}',
            Self::OnLine => '\u{e51d}',
            Self::Landmark => '\u{e0ac}',
            Self::Pointer => '\u{e1c3}',
            Self::Mask => '\u{e1cb}',
            Self::Tick => '\u{e06c}',
            Self::Return => '\u{e0a1}',
            Self::Warning => '\u{e193}',
            Self::Info => '\u{e0f9}',
            Self::Folded => '\u{e06f}',
            Self::Unfolded => '\u{e06d}',
            Self::Play => '\u{e13c}',
            Self::Pause => '\u{e12e}',
            Self::Film => '\u{e29b}',
            Self::Folder => '\u{e247}',
            Self::Document => '\u{e0cc}',
            Self::Picture => '\u{e0f6}',
            Self::Lesson => '\u{e234}',
            Self::Camera => '\u{e1a5}',
            Self::Forest => '\u{e2f5}',
            Self::List => '\u{e1d0}',
            Self::Plot => '\u{e2a5}',
        }
    }
}

/// The name of the font of icons.
const FONT: &str = "icons";
/// Size of a symbol in a row of text, points.
const SIZE: f32 = 14.0;

/// Size of a symbol in a large button, points.
const ATOM: f32 = 18.0;

/// Adds the font of icons to the fonts of a window. Must be called before a symbol is drawn.
pub fn install(ctx: &Context) {
    // A family of its own: the codes lie in Unicode's private area, in which other fonts may have
    // other glyphs.
    let mut fonts = FontDefinitions::default();
    let data = FontData::from_static(touchline_assets::ICONS);
    fonts.font_data.insert(FONT.to_owned(), Arc::new(data));
    let family = FontFamily::Name(FONT.into());
    fonts.families.insert(family, vec![FONT.to_owned()]);
    ctx.set_fonts(fonts);
}

/// Draws a symbol into the middle of a rectangle.
pub fn paint(painter: &Painter, symbol: Symbol, within: Rect, colour: Color32) {
    paint_sized(painter, symbol, within, SIZE, colour);
}

/// Draws a symbol of a size (points) into the middle of a rectangle.
pub fn paint_sized(painter: &Painter, symbol: Symbol, within: Rect, size: f32, colour: Color32) {
    let font = FontId::new(size, FontFamily::Name(FONT.into()));
    painter.text(
        within.center(),
        Align2::CENTER_CENTER,
        symbol.glyph(),
        font,
        colour,
    );
}

/// A symbol as a part of a button with a text.
pub fn atom(symbol: Symbol, colour: Color32) -> Atom<'static> {
    Atom::paint(Vec2::splat(ATOM), move |ui, within| {
        paint_sized(ui.painter(), symbol, within.rect, ATOM, colour);
    })
}

/// Shows a symbol that is not a button.
pub fn show(ui: &mut Ui, symbol: Symbol, colour: Color32) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(16.0, 16.0), Sense::hover());
    paint(ui.painter(), symbol, rect, colour);
    response
}

/// A button with a symbol. `name` is its accessible name.
pub fn button(ui: &mut Ui, symbol: Symbol, name: &str, colour: Color32) -> Response {
    let (rect, response) = ui.allocate_exact_size(theme::SYMBOL, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, ui.is_enabled(), name));
    paint_button(ui, &response, rect, symbol, colour);
    response
}

/// A button with a symbol that is on or off. `colour` is that of the on state.
pub fn toggle(ui: &mut Ui, symbol: Symbol, name: &str, on: bool, colour: Color32) -> Response {
    let (rect, response) = ui.allocate_exact_size(theme::SYMBOL, Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, ui.is_enabled(), on, name));
    paint_button(
        ui,
        &response,
        rect,
        symbol,
        if on {
            colour
        } else {
            ui.palette().hovered_line
        },
    );
    response
}

/// Draws the symbol of a button, brighter with a ground under the pointer or with the focus.
fn paint_button(ui: &Ui, response: &Response, rect: Rect, symbol: Symbol, colour: Color32) {
    if ui.is_rect_visible(rect) {
        let painter = ui.painter();
        // The focus looks like the pointer, so that keyboard users see where they are.
        let lit = response.hovered() || response.has_focus();
        if lit {
            painter.rect_filled(rect, 4.0, ui.visuals().widgets.hovered.weak_bg_fill);
        }
        paint(
            painter,
            symbol,
            rect,
            if lit { ui.palette().strong } else { colour },
        );
    }
}
