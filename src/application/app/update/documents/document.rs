//! Opens, saves and leaves documents.

use crate::app::effect::{Beside, Effect, TemplateOrder};
use crate::app::operations::Operations;
use crate::app::settings::RecentDocument;
use crate::app::window_state::session::{
    Dialog, Leaving, Level, Opening, Question, Saving, Session, is_to_do,
};
use crate::app::{App, Command, Current, OpenProject, Opened};
use std::path::{Path, PathBuf};
use touchline_core::field::{FieldError, Template};

impl App {
    /// Opens a path, as soon as the present document can be left.
    pub(in crate::app) fn open_path(&mut self, path: PathBuf) {
        self.open_instead(Opening::Path(path));
    }

    /// Opens something, as soon as the present document can be left.
    pub(in crate::app) fn open_instead(&mut self, opening: Opening) {
        self.tour_waits = false;
        self.leave_document(Leaving::Open(opening));
    }

    /// Opens the demo match, as soon as the present document can be left.
    pub(in crate::app::update) fn open_demo(&mut self) {
        self.leave_document(Leaving::Open(Opening::Demo));
    }

    /// Starts reading a document.
    pub(super) fn begin_opening(&mut self, opening: Opening) {
        // Earlier errors are obsolete when the user tries again.
        self.session
            .messages
            .notices
            .retain(|notice| notice.level != Level::Error);
        let what = match &opening {
            Opening::Path(path) | Opening::Again(path) => path.display().to_string(),
            Opening::Paths(paths) => format!("a queue of {}", paths.len()),
            Opening::Match(queued) => queued.name.clone(),
            Opening::Demo => "the demo match".to_owned(),
        };
        self.session.disk.opening = Some(format!("Opening {what}…"));
        self.effects.push(Effect::Open(opening));
    }

    /// Shows a document that was read, with a new session.
    pub(in crate::app::update) fn show_document(&mut self, opened: Opened) {
        // A new session keeps the log of messages, the panel and a part of the trainer's state.
        // Dropping the operations cancels all requests on the former document.
        let was_writing = self.operations.is_export_under_way();
        self.operations = Operations::default();
        let panel = self.session.panel;
        let trainer = self.trainer_for_another();
        let log = std::mem::take(&mut self.session.messages.log);
        self.session = Session::default();
        self.session.messages.log = log;
        self.session.trainer = trainer;
        self.session.panel = panel;
        if was_writing {
            let text = "The export was stopped, because another document was opened.";
            self.session.warn(text);
        }
        for (level, text) in &opened.notices {
            self.session.notify(*level, text.clone());
        }
        if let Some(reason) = &opened.read_only {
            self.session.warn(format!("Opened read-only: {reason}"));
        }
        // A new document has no sport yet. With labels that wait, their sheet names the field.
        if opened.is_new && self.waiting_labels.is_none() {
            self.session.dialog = Some(Dialog::Sport);
            self.session.sport_guess = super::sport::guess_template(&opened.file.to_string_lossy());
        }
        self.session.disk.orphans.clone_from(&opened.orphans);
        self.report_orphans();
        let first = opened.document().frames.first();
        let picture = first.and_then(|frame| frame.picture_source(&opened.folder));
        self.settings
            .remember(RecentDocument::new(&opened.file, picture.as_ref()));
        self.effects.push(Effect::SaveSettings);
        let Opened {
            prepared,
            history,
            folder,
            file,
            read_only,
            queue,
            ..
        } = opened;
        // The document itself, and the derived values of the former one reset.
        let mut open = OpenProject::from_prepared(prepared, file, folder, read_only);
        open.history = history;
        self.session.frame = frame_to_resume_at(&open);
        self.open = Some(open);
        self.current = Current::default();
        self.review = crate::app::review::Review::default();
        self.quality = crate::app::quality::Quality::default();
        self.session.unticked.clear();
        self.continue_queue(queue);
        // What starts on opening: a tour that was requested, and operations.
        self.begin_waiting_tour();
        self.suggest_tour();
        self.start_on_opening();
        self.import_waiting_labels();
    }

    /// Requests the field templates that the document names and that have not been read.
    pub(in crate::app::update) fn read_templates(&mut self) {
        let Some(open) = &mut self.open else { return };
        let (of, folder) = (&open.file, &open.folder);
        let names = open.derived.take_wanted_templates().into_iter();
        self.effects.extend(names.map(|name| Effect::Template {
            of: of.clone(),
            folder: folder.clone(),
            name,
            order: TemplateOrder::Read,
        }));
    }

    /// Stores a template that was read, unless the document that names it has been closed since.
    pub(in crate::app::update) fn template_read(
        &mut self,
        of: &Path,
        name: &str,
        template: Result<Box<Template>, FieldError>,
    ) {
        let Some(open) = self.open.as_mut().filter(|open| open.file == of) else {
            return;
        };
        if let Err(error) = &template {
            let said = format!("The field's lines are not drawn: {error}");
            self.session.notify_with(
                Level::Warning,
                said,
                [("Camera panel", Command::CameraPanel)],
            );
        }
        open.template_read(name, template);
    }

    /// Requests again the field templates that could not be read.
    pub(in crate::app::update) fn read_failed_templates_again(&mut self) {
        if let Some(open) = &mut self.open {
            open.want_failed_templates_again();
        }
    }

    /// Writes the document now.
    pub(in crate::app::update) fn save(&mut self) {
        self.commit_open_step();
        let Some(open) = &self.open else { return };
        if open.read_only.is_none() {
            self.session.disk.save_requests += 1;
            self.effects.push(Effect::Save {
                request: self.session.disk.save_requests,
            });
        }
    }

    /// Handles the path that the user chose.
    pub(in crate::app::update) fn answer(&mut self, question: Question, path: PathBuf) {
        // A file dialog asks before a file is replaced; the dialog for typed paths does not.
        let is_typed = matches!(self.session.dialog, Some(Dialog::Path(_)));
        self.session.dialog = None;
        match (question, &self.open) {
            (Question::Project | Question::Folder | Question::Video | Question::Queue, _) => {
                self.open_path(path);
            }
            (Question::CopyTo, Some(open)) => self.effects.push(Effect::SaveCopy {
                of: open.file.clone(),
                document: Box::new((*open.document).clone()),
                revision: open.revision,
                from: open.folder.clone(),
                folder: path,
            }),
            (Question::ExportAs(_) | Question::DatasetTo | Question::ImportFrom(_), Some(_)) => {
                self.place_chosen(question, path, !is_typed);
            }
            (Question::CompareWith, Some(_)) => self.compare(path),
            (Question::CameraFrom, Some(_)) => {
                self.effects.push(Effect::ReadBeside(Beside::Camera(path)));
            }
            (_, None) => {}
        }
    }

    /// Handles a successful write of the state at `revision`. If the document itself was written,
    /// and not only the journal, `document` is the number of the last request for that.
    pub(in crate::app::update) fn handle_save(
        &mut self,
        revision: u64,
        at: String,
        document: Option<u64>,
    ) {
        // An earlier state on disk is no news: the edits after it are still pending.
        let newest = self.open.as_ref().map_or(0, |open| open.revision);
        if revision >= newest {
            self.session.disk.saving = Saving::Saved { at };
            if document.is_some() {
                self.session.disk.changed_outside = None;
                // The document contains the window's version now, so the copy that was set aside is
                // obsolete.
                if let Some(own) = self.session.disk.own_version.take() {
                    self.session
                        .disk
                        .orphans
                        .retain(|orphan| orphan.path != own);
                }
            }
            self.go_on_leaving(document);
        }
    }

    /// Handles a failed write. If the user wanted to leave the document, asks what to do.
    pub(in crate::app::update) fn save_failed(&mut self, message: String) {
        // Repeated failures keep the time of the last success.
        let since = match std::mem::take(&mut self.session.disk.saving) {
            Saving::Saved { at } => Some(at),
            Saving::Failed { since, .. } => since,
            Saving::Untouched | Saving::Pending => None,
        };
        self.session.disk.saving = Saving::Failed { message, since };
        if let Some(leaving) = self.stay()
            && self.is_unsaved()
        {
            self.session.dialog = Some(Dialog::NotSaved(leaving));
        }
    }
}

/// The frame at which to continue: the next one to do, from the one that was changed last. The
/// first frame if none is to do.
fn frame_to_resume_at(open: &OpenProject) -> usize {
    let frames = &open.document.frames;
    let changed = open
        .history
        .next_undo()
        .and_then(|step| frames.position_of(step.frame.as_ref()?))
        .unwrap_or(0);
    (changed..frames.len())
        .chain(0..changed)
        .find(|position| frames.get(*position).is_some_and(|frame| is_to_do(frame)))
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use crate::app::{
        Action, App, Command, DiskReport, EditAction, Effect, Navigation, Opened, PointerAction,
        Question, Settings, ViewAction,
    };
    use touchline_core::field::{FieldError, Template, builtin};
    use touchline_core::geometry::{ImagePoint, ImageSize};
    use touchline_documents::document::{Camera, Document, FieldSpec, FrameStatus};
    use touchline_documents::testing::{WithFrames, a_match, new_frame, soccer_document};

    /// Two frames of a field whose template is a file beside the document, and the effects of
    /// opening it.
    fn opened_with_own_template() -> (App, Vec<Effect>) {
        let (size, mut document) = (
            ImageSize::new(1280, 720),
            Document::new(FieldSpec::new("own.json")),
        );
        document
            .cameras
            .push(Camera::new("main".into(), size).into());
        let document = document.with_numbered(2, size);
        let mut app = App::new(Settings::default());
        let effects = app.update(Action::Opened(Box::new(Opened::new(
            document,
            "/match/project.json",
        ))));
        (app, requests(effects))
    }

    /// The requests for templates among the effects.
    fn requests(effects: Vec<Effect>) -> Vec<Effect> {
        effects
            .into_iter()
            .filter(|effect| matches!(effect, Effect::Template { .. }))
            .collect()
    }

    fn read(of: &str, template: Result<Box<Template>, FieldError>) -> Action {
        Action::Disk(DiskReport::TemplateRead {
            of: of.into(),
            name: "own.json".to_owned(),
            template,
        })
    }

    fn soccer() -> Box<Template> {
        Box::new(builtin("soccer").unwrap().clone())
    }

    /// Requests a copy. Returns the report of its success.
    fn copy_to(app: &mut App, folder: &str) -> Action {
        let effects = app.update(Action::Answer(Question::CopyTo, folder.into()));
        let report = effects.into_iter().find_map(|effect| match effect {
            Effect::SaveCopy {
                of,
                revision,
                folder,
                ..
            } => Some(DiskReport::Copied {
                of,
                revision,
                folder,
            }),
            _ => None,
        });
        Action::Disk(report.unwrap())
    }

    #[test]
    fn a_copy_counts_for_the_edits_that_it_contains() {
        let (mut app, _) = opened_with_own_template();
        let one = copy_to(&mut app, "/copies/one");
        app.update(Action::Edit(EditAction::SetComment("blurred".to_owned())));
        let two = copy_to(&mut app, "/copies/two");
        let revision = app.open().unwrap().revision;
        app.update(one);
        assert_eq!(app.session.disk.copied, Some(revision - 1));
        app.update(two);
        assert_eq!(app.session.disk.copied, Some(revision));
    }

    #[test]
    fn a_copy_after_one_that_failed_counts_for_the_edits_since() {
        let (mut app, _) = opened_with_own_template();
        drop(copy_to(&mut app, "/copies/one"));
        let failed = DiskReport::Failed("No space is left.".to_owned());
        app.update(Action::Disk(failed));
        app.update(Action::Edit(EditAction::SetComment("blurred".to_owned())));
        let again = copy_to(&mut app, "/copies/one");
        app.update(again);
        let revision = app.open().unwrap().revision;
        assert_eq!(app.session.disk.copied, Some(revision));
    }

    #[test]
    fn a_copy_of_a_document_that_was_closed_counts_for_no_other() {
        let (mut app, _) = opened_with_own_template();
        let late = copy_to(&mut app, "/copies/one");
        let document = soccer_document();
        let another = Opened::new(document, "/another/project.json");
        app.update(Action::Opened(Box::new(another)));
        app.update(late);
        assert_eq!(app.session.disk.copied, None);
    }

    #[test]
    fn a_template_of_ones_own_is_read_in_the_background() {
        let (mut app, effects) = opened_with_own_template();
        let (of, folder, name) = (
            "/match/project.json".into(),
            "/match".into(),
            "own.json".to_owned(),
        );
        let order = crate::app::TemplateOrder::Read;
        assert_eq!(
            effects,
            [Effect::Template {
                of,
                folder,
                name,
                order
            }]
        );
        assert!(matches!(
            app.current().field,
            Some(Err(FieldError::BeingRead { .. }))
        ));
        assert!(app.why_not(Command::ShowForBase).is_some());
        assert_eq!(
            requests(app.update(Action::Navigate(Navigation::GoTo(1)))),
            [],
            "requested once"
        );
        app.update(read("/another/project.json", Ok(soccer())));
        assert!(
            app.current().field().is_none(),
            "of a document that was closed meanwhile"
        );
        app.update(read("/match/project.json", Ok(soccer())));
        assert!(app.current().field().is_some(), "{:?}", app.current().field);
        assert_eq!(app.why_not(Command::ShowForBase), None);
        assert_eq!(
            requests(app.update(Action::Navigate(Navigation::GoTo(0)))),
            []
        );
    }

    #[test]
    fn a_template_that_could_not_be_read_is_read_again_on_request() {
        let (mut app, _) = opened_with_own_template();
        let problem = "no such file".to_owned();
        let missing = FieldError::Unreadable {
            place: "own.json".to_owned(),
            problem,
        };
        app.update(read("/match/project.json", Err(missing)));
        assert_eq!(app.current().field.as_ref().map(Result::is_err), Some(true));
        let said = app
            .session
            .messages
            .notices
            .last()
            .map(|notice| notice.text.as_str());
        let wanted = "The field's lines are not drawn: own.json: cannot be read: no such file";
        assert_eq!(said, Some(wanted));
        assert_eq!(
            requests(app.update(Action::Navigate(Navigation::GoTo(0)))),
            [],
            "a file is not tried again without a request"
        );
        assert_eq!(
            requests(app.update(Action::View(ViewAction::ReadFailedTemplatesAgain))).len(),
            1
        );
        assert!(matches!(
            app.current().field,
            Some(Err(FieldError::BeingRead { .. }))
        ));
        app.update(read("/match/project.json", Ok(soccer())));
        assert!(app.current().field().is_some());
        assert_eq!(
            requests(app.update(Action::View(ViewAction::ReadFailedTemplatesAgain))),
            [],
            "what was read stays"
        );
    }

    #[test]
    fn a_project_opens_where_it_was_left() {
        let size = ImageSize::new(1280, 720);
        let mut document = a_match(size);
        for index in 0..6 {
            let mut frame = new_frame(&format!("{index}.jpg"), size);
            if index < 2 {
                frame.status = FrameStatus::Rejected;
            }
            document.frames.push(frame.into());
        }
        let mut app = App::with_document(document);
        assert_eq!(app.session.frame, 2, "the first that is to do");
        app.update(Action::Navigate(Navigation::GoTo(4)));
        app.update(Action::Pointer(PointerAction::Press {
            at: ImagePoint::new(300.0, 400.0),
            on: None,
        }));
        app.update(Action::Pointer(PointerAction::Release));
        let left = app.open().unwrap();
        let mut again = Opened::new(left.document.clone(), "/match/project.json");
        again.history = left.history.clone();
        let mut app = App::new(Settings::default());
        app.update(Action::Opened(Box::new(again)));
        assert_eq!(app.session.frame, 4, "its last point was placed there");
    }
}
