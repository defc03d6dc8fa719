//! The window. Panels are functions of the application's state.
//!
//! A panel reads the [`App`] and pushes [`Action`]s. Only the shell hands them to `App::update` and
//! carries out the effects that come back. Everything that can be tested without widgets is in
//! `app`, so that this room has little besides layout.
//!
//! | what | where |
//! |---|---|
//! | the window, its repaint cycle, layout, keys and file dialogs | `main_window` |
//! | the picture, what is clicked in it and how a click is named | `picture` |
//! | pictures on the screen, conversion of coordinates, the renderer | `drawing` |
//! | rows and strips around the picture, and the column of tools | `rows` |
//! | what goes on and what is missing, above every side panel | `cards` |
//! | the matches of a queue, left of the picture | `queue` |
//! | side panels | `inspector`, `camera_panel`, `trainer`, `review`, `reclick` |
//! | in place of the picture | `quality`, `start` |
//! | above everything | `dialogs` |
//! | maps and plots that several panels use | `maps` |
//! | controls that several panels use | `controls` |
//!
//! A *frame* is a picture of the document; a repaint of the window is called a *frame of the
//! window*. Lengths on the screen are in egui's points, lengths in a picture in px.

#![allow(
    missing_docs,
    reason = "a room of the program itself: what its name says needs no second sentence"
)]

mod camera_panel;
mod cards;
mod controls;
mod dialogs;
mod drawing;
mod inspector;
mod main_window;
mod maps;
mod picture;
mod quality;
mod queue;
mod reclick;
mod review;
mod rows;
mod start;
mod trainer;

pub use controls::theme::apply as apply_theme;
pub use drawing::pictures::Pictures;
pub use main_window::layout::{read, show};
pub use main_window::shell::Shell;
pub use main_window::window::{WindowError, run, say_in_dialog};
pub use touchline_application::jobs::PictureState;

use egui::{Button, Response, Ui};
use touchline_application::app::session::Dialog;
use touchline_application::app::{
    Action, App, Command, EditAction, Keymap, Navigation, SettingsAction, ViewAction,
};

/// Whether a dialog takes the keys of the window below it. Those about appearance leave them to the
/// picture.
const fn takes_keys(dialog: &Dialog) -> bool {
    !matches!(dialog, Dialog::OverlayStyle | Dialog::PictureLook)
}

/// The key of a command in brackets, for the end of a text; empty if the command has none.
fn key_in_brackets(keys: &Keymap, command: Command) -> String {
    keys.with_key(command, |key| format!(" ({key})"))
}

/// What every panel receives.
pub struct Panel<'a> {
    /// The state, read only.
    pub app: &'a App,
    /// Pictures and thumbnails of frames.
    pub pictures: &'a mut Pictures,
    /// The actions of the user, to which the panel appends.
    pub actions: &'a mut Vec<Action>,
    /// Name and interface of the graphics adapter, for the diagnostic report.
    pub adapter: &'a str,
}

impl Panel<'_> {
    /// Gives a control the tooltip of a command. A click on the control runs the command; returns
    /// whether there was one.
    fn run_on_click(&mut self, control: Response, command: Command) -> bool {
        let tip = self.app.settings.keys.tooltip(command);
        let clicked = control.on_hover_text(tip).clicked();
        if clicked {
            self.run(command);
        }
        clicked
    }

    /// Shows a button that runs a command. While the command is not available, the button is
    /// disabled and its tooltip says why. Returns whether it was clicked.
    fn command_button(&mut self, ui: &mut Ui, button: Button<'_>, command: Command) -> bool {
        let why_not = self.app.why_not(command);
        let button = ui.add_enabled(why_not.is_none(), button);
        let button = button.on_disabled_hover_text(why_not.unwrap_or_default());
        self.run_on_click(button, command)
    }

    /// Has the application do something.
    fn act(&mut self, action: Action) {
        self.actions.push(action);
    }

    /// Changes the document.
    fn edit(&mut self, action: EditAction) {
        self.act(Action::Edit(action));
    }

    /// Changes how something is displayed.
    fn view(&mut self, action: ViewAction) {
        self.act(Action::View(action));
    }

    /// Changes a setting of the user.
    fn set(&mut self, action: SettingsAction) {
        self.act(Action::Settings(action));
    }

    /// Carries out a command.
    fn run(&mut self, command: Command) {
        self.act(Action::Command(command));
    }

    /// Shows another frame or click.
    fn navigate(&mut self, action: Navigation) {
        self.act(Action::Navigate(action));
    }

    /// Closes the dialog that is open.
    fn close_dialog(&mut self) {
        self.view(ViewAction::CloseDialog);
    }

    /// Shows a frame, which is given by its position in the document.
    fn go_to(&mut self, frame: usize) {
        self.navigate(Navigation::GoTo(frame));
    }

    /// Shows a frame and selects one of its clicks. Both are given by their positions.
    fn go_to_click(&mut self, frame: usize, click: usize) {
        self.go_to(frame);
        self.navigate(Navigation::Select(Some(click)));
    }

    /// Closes the quality page and shows a frame; selects one of its clicks, if given. Both are
    /// given by their positions.
    fn look_at(&mut self, frame: usize, click: Option<usize>) {
        self.navigate(Navigation::LookAt { frame, click });
    }
}

/// An application that shows a picture of 1280 × 720 px with one click, which has no name.
#[cfg(test)]
fn open_with_click(click: touchline_core::geometry::ImagePoint) -> App {
    use touchline_application::app::{Opened, Settings};
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{Camera, Click, Document, FieldSpec, Frame};
    let size = ImageSize::new(1280, 720);
    let mut document = Document::new(FieldSpec::new("soccer"));
    document
        .cameras
        .push(Camera::new("main".into(), size).into());
    let mut frame = Frame::from_image("a.jpg", "main".into(), size);
    frame.clicks.push(Click::without_name(click));
    document.frames.push(frame.into());
    let mut app = App::new(Settings::default());
    let opened = Opened::new(document, "/match/project.json");
    app.update(Action::Opened(Box::new(opened)));
    app
}
