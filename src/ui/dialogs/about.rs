//! Version, licence, citation, a report for bug reports, and the messages of the session.

use super::sheet;
use crate::ui::Panel;
use crate::ui::controls::show_button;
use crate::ui::controls::theme::Themed as _;
use crate::ui::controls::{symbol, theme};
use crate::ui::rows::notices;
use egui::{Button, Context, Label, RichText, ScrollArea, vec2};
use std::fmt::Write as _;
use touchline_application::app::{App, Command};
use touchline_vision::features::opencv_version;
use touchline_vision::media::VideoBackend;

const CITATION: &str = "J. Chen, F. Zhu and J. J. Little: A Two-point Method for PTZ Camera Calibration in Sports. IEEE \
                        Winter Conference on Applications of Computer Vision (WACV), 2018.";

/// Shows the dialog.
pub fn show(panel: &mut Panel<'_>, ctx: &Context) {
    sheet(panel, ctx, "About", vec2(480.0, 420.0), |panel, ui| {
        ui.label(
            RichText::new(format!("touchline {}", env!("CARGO_PKG_VERSION")))
                .size(theme::TITLE)
                .color(ui.palette().strong),
        );
        ui.label("Calibrates a pan-tilt-zoom sports camera from two clicks.");
        ui.add_space(2.0 * theme::SPACE);
        theme::title(ui, "LICENCE");
        ui.label("MIT. You may use, change and share it; the licence text is included.");
        ui.add_space(2.0 * theme::SPACE);
        theme::title(ui, "IF YOU PUBLISH, CITE THE PAPER");
        ui.add(Label::new(CITATION).wrap().selectable(true));
        if show_button(
            ui,
            Button::new("Copy citation").small(),
            "Copy the citation as text.",
        ) {
            ui.ctx().copy_text(CITATION.to_owned());
        }
        ui.add_space(2.0 * theme::SPACE);
        theme::title(ui, "FOR A BUG REPORT");
        // The report is shown in full before it is copied.
        let report = report(panel.app, panel.adapter, ui.ctx());
        ui.add(
            Label::new(RichText::new(&report).monospace().color(ui.palette().weak))
                .wrap()
                .selectable(true),
        );
        if show_button(
            ui,
            Button::new("Copy diagnostic report"),
            "Copy versions, graphics adapter and counts. It contains no paths and no pictures.",
        ) {
            ui.ctx().copy_text(report);
        }
    });
}

/// Versions, graphics adapter and counts. Nothing in it identifies the match: no path, no name.
fn report(app: &App, adapter: &str, ctx: &Context) -> String {
    let screen = ctx.content_rect().size();
    let adapter = if adapter.is_empty() { "none" } else { adapter };
    let opencv = opencv_version().unwrap_or_else(|| "not built in".to_owned());
    let videos = VideoBackend::available()
        .next()
        .map_or_else(|| "none".to_owned(), |backend| backend.to_string());
    let mut text = format!(
        "touchline {}\n{} {}\ngraphics {adapter}\nOpenCV {opencv}\nvideos by {videos}\nwindow {:.0} × {:.0} points at {} px each\n",
        env!("CARGO_PKG_VERSION"),
        std::env::consts::OS,
        std::env::consts::ARCH,
        screen.x,
        screen.y,
        ctx.pixels_per_point(),
    );
    match app.open() {
        Some(open) => {
            let clicks: usize = open
                .document
                .frames
                .iter()
                .map(|frame| frame.clicks.len())
                .sum();
            let _ = write!(
                text,
                "frames {}, cameras {}, points {clicks}, field {}",
                open.document.frames.len(),
                open.document.cameras.len(),
                open.document.field.template
            );
        }
        None => text.push_str("no document"),
    }
    text
}

/// Shows the dialog.
pub fn show_messages(panel: &mut Panel<'_>, ctx: &Context) {
    sheet(panel, ctx, "Messages", vec2(640.0, 460.0), |panel, ui| {
        let dismiss = Command::DismissNotices;
        panel.command_button(ui, Button::new(dismiss.name()), dismiss);
        ui.add_space(theme::SPACE);
        ScrollArea::vertical()
            .auto_shrink([false, true])
            .show(ui, |ui| {
                for (level, text) in panel.app.session.messages.log.iter().rev() {
                    ui.horizontal_top(|ui| {
                        let (sign, colour) = notices::look(ui.palette(), *level);
                        symbol::show(ui, sign, colour);
                        ui.add(
                            Label::new(RichText::new(text).color(ui.palette().text))
                                .wrap()
                                .selectable(true),
                        );
                    });
                }
            });
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_report_names_versions_and_no_path() {
        let text = report(&App::default(), "llvmpipe (Vulkan)", &Context::default());
        for part in [
            env!("CARGO_PKG_VERSION"),
            std::env::consts::OS,
            "llvmpipe",
            "OpenCV",
            "no document",
        ] {
            assert!(text.contains(part), "{part} is not in {text}");
        }
        assert!(!text.contains(env!("CARGO_MANIFEST_DIR")));
    }
}
