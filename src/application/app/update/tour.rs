//! Starts, advances and ends the tour on the demo match.

use super::App;
use crate::app::Command;
use crate::app::action::{Action, EditAction, PointerAction};
use crate::app::commands::guide::GuidePage;
use crate::app::commands::tour::{Tour, TourView};
use crate::app::window_state::session::{Dialog, Level, Mode, SidePanel, is_to_do};

impl App {
    /// Starts the tour on the open demo match; otherwise opens the user's copy of it first.
    pub(super) fn start_tour(&mut self) {
        self.tour_waits = true;
        if self.shows_demo() {
            self.begin_waiting_tour();
        } else {
            self.open_demo();
        }
    }

    /// Whether the open document is a copy of the demo match: its folder is called "demo", and it
    /// has a camera with a base.
    fn shows_demo(&self) -> bool {
        self.open.as_ref().is_some_and(|open| {
            open.folder.file_name().is_some_and(|name| name == "demo")
                && open
                    .document
                    .cameras
                    .iter()
                    .any(|camera| camera.base().is_some())
        })
    }

    /// Suggests the tour when the demo match is opened and nothing has been done in it.
    pub(super) fn suggest_tour(&mut self) {
        let is_new = self
            .open
            .as_ref()
            .is_some_and(|open| open.history.next_undo().is_none());
        if is_new && self.session.tour.is_none() && self.shows_demo() {
            let text = "This is the demo match: its camera is known already.";
            self.session
                .notify_with(Level::Info, text, [("Take the tour", Command::StartTour)]);
        }
    }

    /// Ends the tour.
    pub(super) fn leave_tour(&mut self) {
        self.session.tour = None;
    }

    /// Starts a tour that was requested, on the first frame without work.
    pub(super) fn begin_waiting_tour(&mut self) {
        if !std::mem::take(&mut self.tour_waits) {
            return;
        }
        // A read-only document has its own message.
        let Some(open) = self.open.as_ref().filter(|open| open.read_only.is_none()) else {
            return;
        };
        // An earlier tour or other work may have used some frames of the copy.
        let untouched = open
            .document
            .frames
            .iter()
            .position(|frame| is_to_do(frame) && frame.clicks.is_empty());
        let Some(frame) = untouched else {
            let text = format!(
                "Your copy of the demo match has no frame left to try. Delete {} and start the tour again: a new copy is made.",
                open.folder.display()
            );
            self.session.warn(text);
            return;
        };
        self.session.dialog = None;
        self.go_to(frame);
        self.session.tour = self.tour_view().map(Tour::begin);
    }

    /// Informs the tour of an action, before it is executed.
    pub(super) fn notify_tour(&mut self, action: &Action) {
        let takes_point = matches!(
            action,
            Action::Pointer(PointerAction::Press { on: Some(_), .. })
                | Action::Edit(EditAction::Nudge { .. })
        );
        if let Some(tour) = self.session.tour.as_mut().filter(|_| takes_point) {
            tour.point_taken();
        }
    }

    /// Advances the tour if its step is done. Waits while the user drags or names a point.
    pub(super) fn advance_tour(&mut self) {
        if self.session.tour.is_none() || self.session.mode != Mode::Idle {
            return;
        }
        if let (Some(seen), Some(tour)) = (self.tour_view(), &mut self.session.tour) {
            tour.look(seen);
        }
    }

    /// The state of the document as the tour sees it.
    fn tour_view(&self) -> Option<TourView> {
        let open = self.open.as_ref()?;
        Some(TourView::from_document(
            &open.document,
            self.frame(),
            self.current.click_solution().is_some(),
        ))
    }
}

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
            Some(Dialog::Sport | Dialog::FieldEditor) => GuidePage::FirstProject,
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
            Some(Dialog::AcceptAll | Dialog::Gallery | Dialog::DiscardBatch { .. }) => {
                GuidePage::Review
            }
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
