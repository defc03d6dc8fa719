//! The window as a whole: passes actions to the app and carries out its effects.

use super::files::Files;
use super::input_queue::InputQueue;
use super::{Panel, PictureState, Pictures, canvas, layout, theme};
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use touchline_application::app::session::Level;
use touchline_application::app::{Action, App, DiskReport, Effect, ViewAction, WindowPlace};
use touchline_application::jobs::{Request, Runner, Wake, load_settings, save_settings};

/// The window's program.
pub struct Shell {
    app: App,
    pictures: Pictures,
    runner: Runner,
    files: Files,
    adapter: String,
    settings_path: Option<PathBuf>,
    /// Where the window is, to open it there again.
    place: Option<WindowPlace>,
    may_close: bool,
}

impl Shell {
    /// A window on an application; `document` is opened at once. Settings are kept in
    /// `settings_path`, if given.
    ///
    /// # Errors
    /// The operating system gives no thread.
    pub fn new(
        creation: &eframe::CreationContext<'_>,
        settings_path: Option<PathBuf>,
        document: Option<PathBuf>,
    ) -> io::Result<Self> {
        theme::apply(&creation.egui_ctx);
        creation.egui_ctx.add_plugin(InputQueue::default());
        canvas::install(&creation.egui_ctx, creation.wgpu_render_state.as_ref());
        // Quitting goes through the application, which warns before edits are lost.
        creation.egui_ctx.options_mut(|options| {
            options.quit_shortcuts.clear();
            // The size of texts is a setting.
            options.zoom_with_keyboard = false;
        });
        let (settings, trouble) = settings_path
            .as_deref()
            .map(load_settings)
            .unwrap_or_default();
        let ctx = creation.egui_ctx.clone();
        let wake: Wake = Arc::new(move || ctx.request_repaint());
        let pictures = Pictures::start(wake.clone())?;
        let mut shell = Self {
            app: App::new(settings).with_clock(jiff::Timestamp::now),
            runner: Runner::new(wake.clone(), pictures.shared()),
            pictures,
            files: Files::new(wake),
            adapter: creation
                .wgpu_render_state
                .as_ref()
                .map(adapter_of)
                .unwrap_or_default(),
            settings_path,
            place: None,
            may_close: false,
        };
        shell.tell_about_adapter(creation);
        let first = trouble.map(|text| Action::View(ViewAction::Notify(Level::Warning, text)));
        shell.apply(first.into_iter().chain(document.map(Action::Open)));
        Ok(shell)
    }

    /// The application behind the window.
    #[must_use]
    pub const fn app(&self) -> &App {
        &self.app
    }

    /// Reads keys and pointer and carries out their actions, so that everything drawn afterwards is
    /// up to date.
    fn read_input(&mut self, ctx: &egui::Context) {
        let mut actions = Vec::new();
        let mut panel = Panel {
            app: &self.app,
            pictures: &mut self.pictures,
            actions: &mut actions,
            adapter: &self.adapter,
        };
        layout::read(&mut panel, ctx);
        self.apply(actions);
        // Only now is it known which frame is shown; its lines must never lie over another frame's
        // picture.
        let actions = self.pictures.update(&self.app, ctx);
        self.apply(actions);
    }

    /// Whether the shown frame's picture is available.
    #[must_use]
    pub fn has_picture(&self) -> bool {
        matches!(self.pictures.current(), PictureState::Ready(..))
    }

    /// Whether every visible thumbnail is available.
    #[must_use]
    pub const fn has_thumbnails(&self) -> bool {
        let progress = self.pictures.thumbnails_in_view();
        progress.done == progress.wanted
    }

    /// Whether no background work is running.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        !self.runner.is_busy()
    }

    /// Notifies once per adapter that drawing runs on the processor.
    fn tell_about_adapter(&mut self, creation: &eframe::CreationContext<'_>) {
        let Some(state) = &creation.wgpu_render_state else {
            return;
        };
        let on_processor = state.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        if on_processor && self.app.settings.told_about_adapter != self.adapter {
            self.app
                .settings
                .told_about_adapter
                .clone_from(&self.adapter);
            let text = format!(
                "No graphics card was found: {} draws on the processor. Everything works, but slower.",
                self.adapter
            );
            self.app.session.notify(Level::Info, text);
            self.save_settings();
        }
    }

    /// Carries out actions.
    pub fn apply(&mut self, actions: impl IntoIterator<Item = Action>) {
        for action in actions {
            let effects = self.app.update(action);
            self.carry_out(effects);
        }
    }

    fn carry_out(&mut self, effects: Vec<Effect>) {
        for effect in effects {
            match self.runner.carry_out(effect) {
                Some(Request::Ask(question)) => {
                    let near = self.app.open().map(|open| open.folder.clone());
                    self.files.ask(question, near.as_deref());
                }
                Some(Request::SaveSettings) => self.save_settings(),
                Some(Request::Close) => self.may_close = true,
                None => {}
            }
        }
    }

    fn save_settings(&mut self) {
        if let Some(path) = &self.settings_path
            && let Err(error) = save_settings(&self.app.settings, path)
        {
            self.app.session.notify(Level::Warning, error.to_string());
        }
    }

    /// Receives what came from background work, dialogs and other programs.
    fn take_in(&mut self, ctx: &egui::Context) {
        let actions = self.runner.poll();
        self.apply(actions);
        let answer = self.files.poll();
        self.apply(answer);
        let dropped: Vec<_> = ctx.input(|input| {
            input
                .raw
                .dropped_files
                .iter()
                .map(|file| file.path().to_path_buf())
                .collect()
        });
        self.apply(dropped.into_iter().take(1).map(Action::Open));
    }
}

impl eframe::App for Shell {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        if ctx.input(|input| input.viewport().close_requested()) && !self.may_close {
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.apply([Action::CloseRequested]);
        }
        self.take_in(ctx);
        self.place = ctx.input(|input| place_of(input.viewport())).or(self.place);
        if self.may_close {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        if ui.ctx().zoom_factor() != self.app.settings.text_size {
            ui.ctx().set_zoom_factor(self.app.settings.text_size);
        }
        theme::follow(ui.ctx(), self.app.settings.theme);
        self.read_input(&ui.ctx().clone());
        let mut actions = Vec::new();
        let mut panel = Panel {
            app: &self.app,
            pictures: &mut self.pictures,
            actions: &mut actions,
            adapter: &self.adapter,
        };
        layout::show(&mut panel, ui);
        self.pictures.finish();
        if !actions.is_empty() {
            // The effect of a button is shown in the next frame of the window.
            ui.ctx().request_repaint();
        }
        self.apply(actions);
    }

    fn on_exit(&mut self) {
        if self.place.is_some() && self.place != self.app.settings.window {
            self.app.settings.window = self.place;
            self.save_settings();
        }
        for action in self.runner.close() {
            if let Action::Disk(DiskReport::SaveFailed(message)) = action {
                eprintln!("touchline: NOT SAVED: {message}");
            }
        }
    }
}

fn adapter_of(state: &eframe::egui_wgpu::RenderState) -> String {
    let info = state.adapter.get_info();
    format!("{} ({:?})", info.name, info.backend)
}

/// Where a window is; none while it is minimised.
fn place_of(viewport: &egui::ViewportInfo) -> Option<WindowPlace> {
    let inner = viewport
        .inner_rect
        .filter(|_| viewport.minimized != Some(true))?;
    let maximized = viewport.maximized == Some(true) || viewport.fullscreen == Some(true);
    let position = viewport.outer_rect.map(|outer| [outer.left(), outer.top()]);
    Some(WindowPlace {
        position: position.filter(|_| !maximized),
        size: inner.size().into(),
        maximized,
    })
}
