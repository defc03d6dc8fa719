//! The window as a whole: lays the panels out, hands actions to the app and effects to the outside.

use super::{
    Panel, Pictures, camera_panel, canvas, dialogs, filmstrip, inspector, keys, menu, naming, notices, rejecting,
    status, theme, viewport,
};
use crate::app::session::Panel as RightPanel;
use crate::app::{Action, App, Effect, Settings};
use std::path::PathBuf;

/// The height of the menu row and of the status row, points.
const ROW: f32 = 24.0;

/// The window's program.
pub struct Shell {
    app: App,
    pictures: Pictures,
}

impl Shell {
    /// A window on an application; `document` is opened at once.
    pub fn new(creation: &eframe::CreationContext<'_>, settings: Settings, document: Option<PathBuf>) -> Self {
        theme::apply(&creation.egui_ctx);
        canvas::install(&creation.egui_ctx, creation.wgpu_render_state.as_ref());
        let mut shell = Self { app: App::new(settings), pictures: Pictures::default() };
        if let Some(document) = document {
            shell.carry_out(vec![Action::Open(document)]);
        }
        shell
    }

    /// The application behind the window.
    #[must_use]
    pub const fn app(&self) -> &App {
        &self.app
    }

    /// Reads keys and pointer and carries out what they ask for, so that everything drawn afterwards shows it.
    fn read_input(&mut self, ctx: &egui::Context) {
        let mut actions = Vec::new();
        let mut panel = Panel { app: &self.app, pictures: &mut self.pictures, actions: &mut actions };
        naming::read(&mut panel, ctx);
        rejecting::read(&mut panel, ctx);
        keys::read(&mut panel, ctx);
        viewport::read(&mut panel, ctx);
        self.carry_out(actions);
    }

    fn carry_out(&mut self, actions: Vec<Action>) {
        let effects: Vec<Effect> = actions.into_iter().flat_map(|action| self.app.update(action)).collect();
        drop(effects);
    }
}

impl eframe::App for Shell {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.read_input(&ui.ctx().clone());
        let mut actions = Vec::new();
        let mut panel = Panel { app: &self.app, pictures: &mut self.pictures, actions: &mut actions };
        let (filmstrip_height, side_width) =
            if ui.available_width() >= 1800.0 { (110.0, 380.0) } else { (92.0, 300.0) };
        egui::Panel::top("menu").exact_size(ROW).show(ui, |ui| menu::show(&mut panel, ui));
        egui::Panel::bottom("status").exact_size(ROW).show(ui, |ui| status::show(&mut panel, ui));
        egui::Panel::right("side").exact_size(side_width).show(ui, |ui| match panel.app.session.panel {
            RightPanel::Frame => inspector::show(&mut panel, ui),
            RightPanel::Camera => camera_panel::show(&mut panel, ui),
        });
        egui::Panel::bottom("filmstrip").exact_size(filmstrip_height).show(ui, |ui| filmstrip::show(&mut panel, ui));
        egui::CentralPanel::no_frame().show(ui, |ui| viewport::show(&mut panel, ui));
        notices::show(&mut panel, ui);
        dialogs::show(&mut panel, ui);
        if !actions.is_empty() {
            // What a button asked for is shown by the next frame of the window.
            ui.ctx().request_repaint();
        }
        self.carry_out(actions);
    }
}

/// Opens the window and returns when it is closed.
///
/// # Errors
/// There is no display or no way to draw on it.
pub fn run(document: Option<PathBuf>) -> eframe::Result<()> {
    let settings = Settings::default_path().map(|path| Settings::load(&path).0).unwrap_or_default();
    let options = eframe::NativeOptions::default();
    eframe::run_native(
        "touchline",
        options,
        Box::new(|creation| Ok(Box::new(Shell::new(creation, settings, document)))),
    )
}
