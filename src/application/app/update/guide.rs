//! Opens the user guide at the page about what is shown, on top of the dialog from which it was
//! opened.

use super::App;
use crate::app::commands::guide::GuidePage;
use crate::app::window_state::session::{Dialog, SidePanel};

impl App {
    /// The page of the user guide about what is shown. None in dialogs that explain themselves or
    /// would lose typed text.
    pub fn guide_page(&self) -> Option<GuidePage> {
        Some(match &self.session.dialog {
            None if self.session.quality.open => GuidePage::Quality,
            None => match self.session.panel {
                SidePanel::Frame => self.session.guide_page,
                SidePanel::Camera => GuidePage::Base,
                SidePanel::Trainer | SidePanel::Review => GuidePage::Review,
            },
            Some(Dialog::Sport) => GuidePage::FirstProject,
            Some(
                Dialog::Keys
                | Dialog::Messages
                | Dialog::Preferences
                | Dialog::OverlayStyle
                | Dialog::PictureLook
                | Dialog::About
                | Dialog::NotSaved(_),
            ) => GuidePage::Window,
            Some(Dialog::AssignToCamera(_) | Dialog::FoundCamera) => GuidePage::Base,
            Some(Dialog::GoToPlace) => GuidePage::Video,
            Some(Dialog::AcceptAll | Dialog::DiscardBatch { .. }) => GuidePage::Review,
            Some(Dialog::Transfer) => GuidePage::Export,
            Some(Dialog::ChangedOutside | Dialog::Orphans) => GuidePage::SeveralPeople,
            Some(Dialog::Palette | Dialog::Comment(_) | Dialog::Path(_) | Dialog::Guide { .. }) => {
                return None;
            }
        })
    }

    /// Opens the guide, and keeps the present dialog behind it.
    pub(super) fn open_guide(&mut self) {
        let Some(page) = self.guide_page() else {
            return;
        };
        let behind = self.session.dialog.take().map(Box::new);
        self.session.dialog = Some(Dialog::Guide { page, behind });
    }

    /// Shows another page of the open guide.
    pub(super) fn show_guide_page(&mut self, wanted: GuidePage) {
        if let Some(Dialog::Guide { page, .. }) = &mut self.session.dialog {
            *page = wanted;
        }
    }

    /// Closes the dialog. From the guide, returns to the dialog behind it.
    pub(super) fn close_dialog(&mut self) {
        self.session.dialog = match self.session.dialog.take() {
            Some(Dialog::Guide { page, behind }) => {
                self.session.guide_page = page;
                behind.map(|dialog| *dialog)
            }
            _ => None,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{Action, Command, ViewAction};

    #[test]
    fn the_guide_opens_at_the_page_of_a_dialog_and_leads_back_to_it() {
        let mut app = App::default();
        app.update(Action::Command(Command::Preferences));
        app.update(Action::Command(Command::Guide));
        let opened = Dialog::Guide {
            page: GuidePage::Window,
            behind: Some(Box::new(Dialog::Preferences)),
        };
        assert_eq!(app.session.dialog, Some(opened));
        app.update(Action::View(ViewAction::ShowGuidePage(GuidePage::Glossary)));
        app.update(Action::View(ViewAction::CloseDialog));
        assert_eq!(app.session.dialog, Some(Dialog::Preferences));
        app.update(Action::Command(Command::Cancel));
        assert_eq!(app.session.dialog, None);
        // Without a dialog it opens at the page where it was closed.
        app.update(Action::Command(Command::Guide));
        assert_eq!(
            app.session.dialog,
            Some(Dialog::Guide {
                page: GuidePage::Glossary,
                behind: None
            })
        );
        app.update(Action::Command(Command::Cancel));
        assert_eq!(app.session.dialog, None);
    }
}
