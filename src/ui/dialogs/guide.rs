//! The user guide: pages of Markdown from `assets/guide`, with their pictures.
//!
//! Only the Markdown that the guide uses is understood: titles, section headings, pictures, lists,
//! and marked words. Each paragraph is one line.

use super::sheet;
use crate::ui::Panel;
use crate::ui::controls::show_button;
use crate::ui::controls::theme::{self, Palette, Themed as _};
use crate::ui::drawing::pictures::decode_texture;
use egui::text::{LayoutJob, TextFormat};
use egui::{
    Button, Context, FontFamily, FontId, Id, Image, Label, RichText, Role, ScrollArea,
    TextureHandle, Ui, WidgetInfo, vec2,
};
use strum::IntoEnumIterator as _;
use touchline_application::app::ViewAction;
use touchline_application::app::guide::GuidePage;
use touchline_assets::guide;

/// The Markdown of a page.
const fn text(page: GuidePage) -> &'static str {
    match page {
        GuidePage::FirstProject => guide::FIRST_PROJECT,
        GuidePage::Window => guide::WINDOW,
        GuidePage::Base => guide::BASE,
        GuidePage::Trust => guide::TRUST,
        GuidePage::Video => guide::VIDEO,
        GuidePage::Review => guide::REVIEW,
        GuidePage::Quality => guide::QUALITY,
        GuidePage::Export => guide::EXPORT,
        GuidePage::SeveralPeople => guide::SEVERAL_PEOPLE,
        GuidePage::Glossary => guide::GLOSSARY,
    }
}

/// Width of the list of pages, points.
const LIST: f32 = 120.0;

/// Shows a page of the guide. If `leads_back`, closing it shows the dialog from which it was
/// opened.
pub fn show(panel: &mut Panel<'_>, ctx: &Context, page: GuidePage, leads_back: bool) {
    sheet(panel, ctx, "User guide", vec2(860.0, 580.0), |panel, ui| {
        ui.horizontal_top(|ui| {
            ui.vertical(|ui| {
                ui.set_width(LIST);
                for other in GuidePage::iter() {
                    let button =
                        Button::selectable(other == page, other.title()).min_size(vec2(LIST, 22.0));
                    if ui.add(button).clicked() {
                        panel.view(ViewAction::ShowGuidePage(other));
                    }
                }
                if leads_back {
                    ui.add_space(2.0 * theme::SPACE);
                    if show_button(
                        ui,
                        Button::new("Back").min_size(vec2(LIST, 22.0)),
                        "Back to the dialog. (Esc)",
                    ) {
                        panel.close_dialog();
                    }
                }
            });
            ScrollArea::vertical()
                .id_salt(page.title())
                .auto_shrink(false)
                .show(ui, |ui| {
                    // A scroll area inherits the layout of the row around it, which is horizontal.
                    ui.vertical(|ui| {
                        for line in text(page).lines() {
                            show_line(ui, line);
                        }
                    });
                });
        });
    });
}

/// Shows a line of Markdown: a title, a section heading, a picture, a list entry, or a paragraph.
fn show_line(ui: &mut Ui, line: &str) {
    if let Some(title) = line.strip_prefix("# ") {
        ui.label(RichText::new(title).heading().color(ui.palette().strong));
        return;
    }
    if let Some(heading) = line.strip_prefix("## ") {
        ui.add_space(theme::SPACE);
        ui.label(
            RichText::new(heading)
                .size(theme::BODY)
                .strong()
                .color(ui.palette().strong),
        );
        return;
    }
    if let Some((caption, name)) = picture(line) {
        show_picture(ui, caption, name);
        return;
    }
    let Some(text) = Some(line.trim()).filter(|line| !line.is_empty()) else {
        ui.add_space(theme::SPACE);
        return;
    };
    // An entry of a numbered or plain list, or a paragraph.
    let numbered = text
        .split_once(". ")
        .filter(|(number, _)| number.parse::<u32>().is_ok());
    let (mark, text) = match (numbered, text.strip_prefix("- ")) {
        (Some((number, rest)), _) => (Some(format!("{number}.")), rest),
        (None, Some(rest)) => (Some("•".to_owned()), rest),
        (None, None) => (None, text),
    };
    ui.horizontal_top(|ui| {
        if let Some(mark) = mark {
            ui.add_sized(
                vec2(20.0, 16.0),
                Label::new(RichText::new(mark).color(ui.palette().weak)),
            );
        }
        ui.add(
            Label::new(laid_out(ui.palette(), text))
                .wrap()
                .selectable(true),
        );
    });
}

/// Caption and file name, if a line is a picture.
fn picture(line: &str) -> Option<(&str, &str)> {
    line.strip_prefix("![")?.strip_suffix(')')?.split_once("](")
}

/// Shows a picture, at most as wide as the available space. The caption is its description for
/// screen readers.
fn show_picture(ui: &mut Ui, caption: &str, name: &str) {
    // A picture is decoded when its page is first shown, and stays on the graphics card.
    let memory = Id::unique(("picture of the guide", name));
    let known = ui.data(|data| data.get_temp::<TextureHandle>(memory));
    let Some(texture) = known.or_else(|| decode_picture(ui.ctx(), name)) else {
        return;
    };
    ui.data_mut(|data| data.insert_temp(memory, texture.clone()));
    let size = texture.size_vec2();
    let width = ui.available_width().min(size.x);
    let shown = ui.add(
        Image::from_texture(&texture)
            .fit_to_exact_size(size * (width / size.x))
            .corner_radius(4.0),
    );
    shown.widget_info(|| WidgetInfo::labeled(Role::Image, true, caption));
    shown.on_hover_text(caption);
}

/// Decodes a picture of the guide into a texture. `None` if the guide has no picture of this name.
fn decode_picture(ctx: &Context, name: &str) -> Option<TextureHandle> {
    let (_, bytes) = guide::PICTURES.iter().find(|(known, _)| *known == name)?;
    decode_texture(ctx, name, bytes)
}

/// Lays out a text with the words between pairs of `**`, `*` and `` ` `` emphasised.
fn laid_out(palette: &Palette, text: &str) -> LayoutJob {
    // All emphasised words look alike but for keys and commands in backticks, which are monospaced.
    let mut job = LayoutJob::default();
    for (part, is_set_off) in parts(text) {
        let key = is_set_off && part.starts_with('`');
        let family = if key {
            FontFamily::Monospace
        } else {
            FontFamily::Proportional
        };
        let colour = if is_set_off {
            palette.strong
        } else {
            palette.text
        };
        let shown = if is_set_off {
            part.trim_matches(['`', '*'])
        } else {
            part
        };
        job.append(
            shown,
            0.0,
            TextFormat::simple(FontId::new(theme::BODY, family), colour),
        );
    }
    job
}

/// Splits a text into parts, each with whether it is emphasised. Emphasised parts keep their marks;
/// a mark without a second one is text.
fn parts(text: &str) -> Vec<(&str, bool)> {
    // Both marks are one byte long, so the byte positions are borders of characters.
    let (mut found, mut rest) = (Vec::new(), text);
    while let Some(start) = rest.find(['`', '*']) {
        let mark = if rest[start..].starts_with("**") {
            "**"
        } else {
            &rest[start..=start]
        };
        // A mark without a second one: the rest is text.
        let Some(length) = rest[start + mark.len()..].find(mark) else {
            break;
        };
        let end = start + mark.len() + length + mark.len();
        found.extend([(&rest[..start], false), (&rest[start..end], true)]);
        rest = &rest[end..];
    }
    found.push((rest, false));
    found.retain(|(part, _)| !part.is_empty());
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_set_words_off_and_single_ones_are_text() {
        let found = parts("Press `Ctrl-K` or *File › Open*, **never** 2 * 3.");
        let set_off: Vec<&str> = found
            .iter()
            .filter(|(_, is_set_off)| *is_set_off)
            .map(|(part, _)| *part)
            .collect();
        assert_eq!(set_off, ["`Ctrl-K`", "*File › Open*", "**never**"]);
        assert_eq!(
            found.iter().map(|(part, _)| *part).collect::<String>(),
            "Press `Ctrl-K` or *File › Open*, **never** 2 * 3."
        );
        assert_eq!(laid_out(theme::ON_PICTURE, "**a** b").text, "a b");
    }

    #[test]
    fn every_page_has_a_title_and_nothing_that_is_not_rendered() {
        for page in GuidePage::iter() {
            let (name, text) = (page.title(), text(page));
            assert!(text.starts_with("# "), "{name}");
            for line in text.lines().filter(|line| picture(line).is_none()) {
                assert!(
                    !line.contains('<') && !line.contains("](") && !line.starts_with("  "),
                    "{name}: {line}"
                );
            }
        }
    }

    #[test]
    fn every_picture_that_a_page_names_is_there_and_has_a_caption() {
        let named: Vec<(&str, &str)> = GuidePage::iter()
            .flat_map(|page| text(page).lines().filter_map(picture))
            .collect();
        let ctx = Context::default();
        for (caption, name) in &named {
            assert!(caption.len() > 20, "{name}");
            let size = decode_picture(&ctx, name).map(|texture| texture.size());
            assert!(
                size.is_some_and(|[width, _]| width >= 900),
                "{name}: {size:?}"
            );
        }
        let unused: Vec<_> = guide::PICTURES
            .iter()
            .filter(|(name, _)| !named.iter().any(|(_, used)| used == name))
            .collect();
        assert_eq!(unused.len(), 0);
    }
}
