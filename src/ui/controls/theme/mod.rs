//! Spacing, type and colours of the window. Spacing follows a grid of 4 points.

mod marks;
mod palette;

pub use marks::{paint_line_mark, paint_status_bar, status_letter, verdict_colour};
pub use palette::{ON_PICTURE, Palette, Themed};

use egui::{
    Color32, CornerRadius, FontFamily, FontId, Margin, Shadow, Stroke, TextStyle, Theme,
    ThemePreference, Vec2, vec2,
};
use touchline_application::app::settings::ThemeChoice;

/// Spacing of the grid, points.
pub const SPACE: f32 = 4.0;

/// The three sizes of type, points: what stands beside something else or explains it, what is read,
/// and the one thing that a card or page is about. Within a size, the colour of a text says how
/// much it weighs (`Palette::strong`, `text`, `weak`).
pub const SMALL: f32 = 12.0;
pub const BODY: f32 = 14.0;
pub const TITLE: f32 = 18.0;

/// A small title above a group.
pub fn title(ui: &mut egui::Ui, text: &str) {
    ui.label(
        egui::RichText::new(text)
            .small()
            .color(ui.palette().weak)
            .strong(),
    );
}

/// A small title with space above it.
pub fn section(ui: &mut egui::Ui, text: &str) {
    ui.add_space(2.0 * SPACE);
    title(ui, text);
}

/// A secondary text that wraps.
pub fn weak_text(ui: &mut egui::Ui, text: impl Into<String>) {
    wrap_label(ui, egui::RichText::new(text).color(ui.palette().weak));
}

/// A small secondary text that wraps.
pub fn small_weak_text(ui: &mut egui::Ui, text: impl Into<String>) -> egui::Response {
    wrap_label(
        ui,
        egui::RichText::new(text).small().color(ui.palette().weak),
    )
}

/// A text that wraps.
pub fn text(ui: &mut egui::Ui, text: impl Into<String>) -> egui::Response {
    wrap_label(ui, egui::RichText::new(text).color(ui.palette().text))
}

/// An emphasised text that wraps.
pub fn strong_text(ui: &mut egui::Ui, text: impl Into<String>) -> egui::Response {
    wrap_label(ui, egui::RichText::new(text).color(ui.palette().strong))
}

fn wrap_label(ui: &mut egui::Ui, text: egui::RichText) -> egui::Response {
    ui.add(egui::Label::new(text).wrap())
}

/// A secondary label.
pub fn weak(ui: &mut egui::Ui, text: impl Into<String>) -> egui::Response {
    ui.label(egui::RichText::new(text).color(ui.palette().weak))
}

/// A small secondary label.
pub fn small_weak(ui: &mut egui::Ui, text: impl Into<String>) -> egui::Response {
    ui.label(egui::RichText::new(text).small().color(ui.palette().weak))
}

/// An emphasised label.
pub fn strong(ui: &mut egui::Ui, text: impl Into<String>) -> egui::Response {
    ui.label(egui::RichText::new(text).color(ui.palette().strong))
}

/// The ground for marks in colours that are made for pictures, which are dark: transparent in the
/// dark theme, a dark colour in the light one.
pub fn under_colours_of_pictures(ui: &egui::Ui) -> Color32 {
    if ui.visuals().dark_mode {
        Color32::TRANSPARENT
    } else {
        ON_PICTURE.control
    }
}

/// Installs both themes in a window.
pub fn apply(ctx: &egui::Context) {
    follow(ctx, ThemeChoice::default());
    // Both styles are set at once, so that a change of the theme needs no further call here.
    for theme in [Theme::Dark, Theme::Light] {
        let mut style = (*ctx.style_of(theme)).clone();
        give(&mut style);
        colour(&mut style.visuals, theme);
        ctx.set_style_of(theme, style);
    }
}

/// Switches to the theme that the user chose.
pub fn follow(ctx: &egui::Context, choice: ThemeChoice) {
    let wanted = match choice {
        ThemeChoice::Dark => ThemePreference::Dark,
        ThemeChoice::Light => ThemePreference::Light,
        ThemeChoice::System => ThemePreference::System,
    };
    // The shell calls this in every frame of the window, so the options are written only if the
    // choice differs.
    if ctx.options(|options| options.theme_preference) != wanted {
        ctx.set_theme(wanted);
    }
}

/// Sizes and behaviour, which are the same in both themes.
fn give(style: &mut egui::Style) {
    style.text_styles = [
        (TextStyle::Small, SMALL, FontFamily::Proportional),
        (TextStyle::Body, BODY, FontFamily::Proportional),
        (TextStyle::Button, BODY, FontFamily::Proportional),
        (TextStyle::Heading, TITLE, FontFamily::Proportional),
        (TextStyle::Monospace, SMALL, FontFamily::Monospace),
    ]
    .into_iter()
    .map(|(name, size, family)| (name, FontId::new(size, family)))
    .collect();
    style.drag_value_text_style = TextStyle::Body;
    // A wheel scrolls a list that has only one direction, even if the wheel itself has the other:
    // the filmstrip scrolls sideways.
    style.always_scroll_the_only_direction = true;
    // Egui's own explanations would stand beside the tooltips of this program.
    style.explanation_tooltips = false;
    style.animation_time = 0.08;
    // A drag over a label must not select its text. A text that is worth copying is made
    // selectable where it is shown.
    style.interaction.selectable_labels = false;
    style.interaction.tooltip_delay = 0.4;
    space(&mut style.spacing);
}

/// Margins and sizes of widgets.
fn space(spacing: &mut egui::Spacing) {
    spacing.item_spacing = vec2(2.0 * SPACE, SPACE);
    spacing.button_padding = vec2(2.0 * SPACE, 2.0);
    spacing.interact_size = vec2(36.0, 20.0);
    spacing.menu_margin = Margin::same(SPACE as i8);
    spacing.window_margin = Margin::same(3 * SPACE as i8);
    spacing.indent = 3.0 * SPACE;
    spacing.icon_width = 14.0;
    spacing.icon_width_inner = 8.0;
    spacing.tooltip_width = 360.0;
    spacing.slider_width = 140.0;
    spacing.combo_width = 96.0;
    spacing.scroll = egui::style::ScrollStyle::thin();
}

fn colour(visuals: &mut egui::Visuals, theme: Theme) {
    *visuals = theme.default_visuals();
    let palette = Palette::from_theme(theme);
    let corner = CornerRadius::same(4);
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.window;
    visuals.window_stroke = Stroke::new(1.0, palette.window_line);
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    visuals.extreme_bg_color = palette.backdrop;
    visuals.faint_bg_color = palette.window;
    visuals.code_bg_color = palette.raised;
    visuals.hyperlink_color = palette.accent;
    visuals.warn_fg_color = palette.caution;
    visuals.error_fg_color = palette.bad;
    visuals.weak_text_color = Some(palette.weak);
    visuals.selection.bg_fill = palette.accent_ground;
    visuals.selection.stroke = Stroke::new(1.0, palette.strong);
    visuals.window_shadow = Shadow {
        offset: [0, 6],
        blur: 24,
        spread: 0,
        color: Color32::from_black_alpha(120),
    };
    visuals.popup_shadow = Shadow {
        offset: [0, 4],
        blur: 12,
        spread: 0,
        color: Color32::from_black_alpha(100),
    };
    visuals.slider_trailing_fill = true;
    visuals.disabled_alpha = 0.45;
    // Each state of a widget: ground, border and text.
    let widgets = &mut visuals.widgets;
    for (widget, ground, border, text) in [
        (
            &mut widgets.noninteractive,
            palette.panel,
            palette.line,
            palette.text,
        ),
        (
            &mut widgets.inactive,
            palette.control,
            palette.control,
            palette.text,
        ),
        (
            &mut widgets.hovered,
            palette.hovered,
            palette.hovered_line,
            palette.strong,
        ),
        (
            &mut widgets.active,
            palette.accent_ground,
            palette.accent,
            palette.strong,
        ),
        (
            &mut widgets.open,
            palette.control,
            palette.line,
            palette.strong,
        ),
    ] {
        widget.bg_fill = ground;
        widget.weak_bg_fill = ground;
        widget.bg_stroke = Stroke::new(1.0, border);
        widget.fg_stroke = Stroke::new(1.0, text);
        widget.corner_radius = corner;
        widget.expansion = 0.0;
    }
}

/// Height of a row in lists, points.
pub const LIST_ROW: f32 = 22.0;

/// Size of a button that is only a symbol, points.
pub const SYMBOL: Vec2 = vec2(20.0, 20.0);
