//! The window as a whole. It hands the actions of all panels to the application and carries out the
//! effects that it returns.
//!
//! One frame of the window: results of background work and dialogs come in (`logic`); keys and
//! pointer are read and their actions executed; then everything is drawn, and the actions of
//! widgets are executed for the next frame.

use super::files::Files;
use super::input_queue::InputQueue;
use super::layout;
use crate::ui::controls::{symbol, theme};
use crate::ui::drawing::canvas;
use crate::ui::{Panel, PictureState, Pictures};
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use touchline_application::app::session::Level;
use touchline_application::app::{Action, App, DiskReport, Effect, ViewAction, WindowPlace};
use touchline_application::jobs::{Request, Runner, Wake, load_settings, save_settings};

/// The program of the window.
pub struct Shell {
    app: App,
    pictures: Pictures,
    runner: Runner,
    files: Files,
    adapter: String,
    settings_path: Option<PathBuf>,
    /// Where the window is, so that it opens there again; `None` until it is known.
    place: Option<WindowPlace>,
    /// Whether the application has agreed to close.
    may_close: bool,
}

impl Shell {
    /// Creates the application and opens `documents`, several of them as if they were dropped.
    /// Settings are read from and kept in `settings_path`, if given.
    ///
    /// # Errors
    /// The operating system provides no thread.
    pub fn new(
        creation: &eframe::CreationContext<'_>,
        settings_path: Option<PathBuf>,
        documents: Vec<PathBuf>,
    ) -> io::Result<Self> {
        theme::apply(&creation.egui_ctx);
        symbol::install(&creation.egui_ctx);
        creation.egui_ctx.add_plugin(InputQueue::default());
        canvas::install(&creation.egui_ctx, creation.wgpu_render_state.as_ref());
        // Quitting goes through the application, which warns before edits are lost.
        creation.egui_ctx.options_mut(|options| {
            options.quit_shortcuts.clear();
            // The size of texts is a setting and not changed by keys.
            options.zoom_with_keyboard = false;
        });
        let (settings, trouble) = settings_path
            .as_deref()
            .map(load_settings)
            .unwrap_or_default();
        // Background work wakes the window by asking for a repaint, in which `take_in` receives its
        // results.
        let ctx = creation.egui_ctx.clone();
        let wake: Wake = Arc::new(move || ctx.request_repaint());
        let pictures = Pictures::start(wake.clone())?;
        let mut shell = Self {
            app: App::new(settings).with_clock(jiff::Timestamp::now),
            runner: Runner::new(wake.clone(), pictures.shared_pictures()),
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
        shell.report_about_adapter(creation);
        let first = trouble.map(|text| Action::View(ViewAction::Notify(Level::Warning, text)));
        let open = match <[PathBuf; 1]>::try_from(documents) {
            Ok([document]) => Some(Action::Open(document)),
            Err(several) => (!several.is_empty()).then_some(Action::OpenAny(several)),
        };
        shell.apply(first.into_iter().chain(open));
        Ok(shell)
    }

    /// The application behind the window.
    pub const fn app(&self) -> &App {
        &self.app
    }

    /// Reads keys and pointer and carries out their actions, so that everything that is drawn
    /// afterwards is up to date.
    fn read_input(&mut self, ctx: &egui::Context) {
        if self.files.is_open() {
            // Keys that are typed before the dialog has the focus are meant for it.
            ctx.input_mut(|input| input.events.retain(|event| !is_typed(event)));
        }
        let mut actions = Vec::new();
        let mut panel = Panel {
            app: &self.app,
            pictures: &mut self.pictures,
            actions: &mut actions,
            adapter: &self.adapter,
        };
        layout::read(&mut panel, ctx);
        self.apply(actions);
        // After these actions the shown frame is settled. Its picture is requested now, because a
        // frame's lines must never be drawn over another frame's picture.
        let actions = self.pictures.update(&self.app, ctx);
        self.apply(actions);
    }

    /// Whether the shown frame's picture is available.
    pub fn has_picture(&self) -> bool {
        matches!(self.pictures.current(), PictureState::Ready(..))
    }

    /// Whether every thumbnail in view is available.
    pub const fn has_thumbnails(&self) -> bool {
        let progress = self.pictures.thumbnails_in_view();
        progress.done == progress.wanted
    }

    /// Whether no background work is running.
    pub fn is_idle(&self) -> bool {
        !self.runner.is_busy()
    }

    /// Notifies the user, once for each adapter, that the processor draws in place of a graphics
    /// card.
    fn report_about_adapter(&mut self, creation: &eframe::CreationContext<'_>) {
        let Some(state) = &creation.wgpu_render_state else {
            return;
        };
        // The settings remember the adapter by its name: a graphics card that is added or lost is
        // reported anew.
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

    /// Hands actions to the application and carries out their effects.
    pub fn apply(&mut self, actions: impl IntoIterator<Item = Action>) {
        for action in actions {
            let effects = self.app.update(action);
            self.carry_out(effects);
        }
    }

    /// Carries out effects. Background work goes to the runner; file dialogs, settings and closing
    /// are the window's.
    fn carry_out(&mut self, effects: Vec<Effect>) {
        for effect in effects {
            match self.runner.carry_out(effect) {
                Some(Request::Ask(question)) => {
                    let near = self.folder_to_begin_in();
                    self.files.ask(question, near.as_deref());
                }
                Some(Request::SaveSettings) => self.save_settings(),
                Some(Request::Close) => self.may_close = true,
                None => {}
            }
        }
    }

    /// The folder in which a file dialog begins: the project's, else that of the last document.
    fn folder_to_begin_in(&self) -> Option<PathBuf> {
        let open = self.app.open().map(|open| open.folder.clone());
        let recent = self.app.settings.recent.first();
        open.or_else(|| Some(recent?.file.parent()?.to_path_buf()))
    }

    /// Writes the settings; a failure is shown as a message.
    fn save_settings(&mut self) {
        if let Some(problem) = self.write_settings() {
            self.app.session.notify(Level::Warning, problem);
        }
    }

    /// Writes the settings, if they have a file. Returns why that failed.
    fn write_settings(&self) -> Option<String> {
        let path = self.settings_path.as_deref()?;
        let written = save_settings(&self.app.settings, path);
        written.err().map(|error| error.to_string())
    }

    /// Receives the results of background work, the answers of file dialogs, and dropped files.
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
        self.apply((!dropped.is_empty()).then_some(Action::OpenAny(dropped)));
    }
}

impl eframe::App for Shell {
    // The application decides whether to close, because it may have to ask about unsaved edits.
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        if ctx.input(|input| input.viewport().close_requested()) && !self.may_close {
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.apply([Action::CloseRequested]);
        }
        self.take_in(ctx);
        // The last known place stays while the window is minimised.
        let zoom = ctx.zoom_factor();
        self.place = ctx
            .input(|input| place_of(input.viewport(), zoom))
            .or(self.place);
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
            // The effect of a widget is drawn in the next frame of the window.
            ui.ctx().request_repaint();
        }
        self.apply(actions);
    }

    fn on_exit(&mut self) {
        // The window is gone, so a failure to save can only be reported on the terminal.
        if self.place.is_some() && self.place != self.app.settings.window {
            self.app.settings.window = self.place;
            if let Some(problem) = self.write_settings() {
                eprintln!("touchline: {problem}");
            }
        }
        for action in self.runner.close() {
            if let Action::Disk(DiskReport::SaveFailed(message)) = action {
                eprintln!("touchline: NOT SAVED: {message}");
            }
        }
    }
}

/// Whether an event is a key that goes down, or its text.
const fn is_typed(event: &egui::Event) -> bool {
    matches!(
        event,
        egui::Event::Key { pressed: true, .. } | egui::Event::Text(_)
    )
}

/// Name and interface of a graphics adapter.
fn adapter_of(state: &eframe::egui_wgpu::RenderState) -> String {
    let info = state.adapter.get_info();
    format!("{} ({:?})", info.name, info.backend)
}

/// Position and size of a window, `None` while it is minimised. A maximised one has no position of
/// its own.
///
/// Both are in points of the system, as a window is opened. egui's are larger by `zoom`, the size
/// of texts: with those a window would shrink from one start to the next.
fn place_of(viewport: &egui::ViewportInfo, zoom: f32) -> Option<WindowPlace> {
    let inner = viewport
        .inner_rect
        .filter(|_| viewport.minimized != Some(true))?;
    let maximized = viewport.maximized == Some(true) || viewport.fullscreen == Some(true);
    let position = viewport.outer_rect.map(|outer| (outer.min * zoom).into());
    Some(WindowPlace {
        position: position.filter(|_| !maximized),
        size: (inner.size() * zoom).into(),
        maximized,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Rect, pos2, vec2};

    #[test]
    fn a_window_opens_where_it_was_whatever_the_size_of_texts() {
        // The system's 300, 150 and 1350 × 900 points with texts at 1.5.
        let viewport = egui::ViewportInfo {
            inner_rect: Some(Rect::from_min_size(pos2(200.0, 120.0), vec2(900.0, 600.0))),
            outer_rect: Some(Rect::from_min_size(pos2(200.0, 100.0), vec2(900.0, 620.0))),
            ..egui::ViewportInfo::default()
        };
        let expected = WindowPlace {
            position: Some([300.0, 150.0]),
            size: [1350.0, 900.0],
            maximized: false,
        };
        assert_eq!(place_of(&viewport, 1.5), Some(expected));
    }
}
