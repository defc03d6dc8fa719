//! An application with an opened document, driven by actions.

use touchline_application::app::operation::{Failure, Job, Operation, Report};
use touchline_application::app::{Action, App, Command, Effect, Opened, PointerAction, Settings};
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::Document;

/// The application and every effect since the document was opened.
pub struct Bench {
    pub app: App,
    pub effects: Vec<Effect>,
}

impl Bench {
    pub fn new(document: Document) -> Self {
        let mut bench = Self {
            app: App::new(Settings::default()),
            effects: Vec::new(),
        };
        bench.act(Action::Opened(Box::new(Opened::new(
            document,
            "/nowhere/project.json",
        ))));
        bench.effects.clear();
        bench
    }

    pub fn act(&mut self, action: Action) {
        self.effects.extend(self.app.update(action));
    }

    pub fn command(&mut self, command: Command) {
        self.act(Action::Command(command));
    }

    pub fn click(&mut self, at: ImagePoint) {
        self.act(Action::Pointer(PointerAction::Press { at, on: None }));
        self.act(Action::Pointer(PointerAction::Release));
    }

    /// The request of an operation that was started last.
    pub fn last_job<O: Operation>(&self) -> Job {
        let mut jobs = self.effects.iter().filter_map(|effect| match effect {
            Effect::Start(job) if job.name() == O::NAME => Some(job),
            _ => None,
        });
        jobs.next_back()
            .unwrap_or_else(|| panic!("{} was not started", O::NAME))
            .clone()
    }

    /// The operation that was started last has come this far.
    #[cfg(feature = "opencv")]
    pub fn report_progress<O: Operation>(&mut self, progress: O::Progress) {
        let id = self.last_job::<O>().id();
        self.act(Action::Report(Report::from_progress::<O>(id, progress)));
    }

    /// The operation that was started last has ended.
    pub fn report_end<O: Operation>(&mut self, result: Result<O::Output, Failure<O::Error>>) {
        let id = self.last_job::<O>().id();
        self.act(Action::Report(Report::from_result::<O>(id, result)));
    }

    /// The last message has this.
    #[track_caller]
    pub fn assert_notice(&self, part: &str) {
        let notice = self.last_notice();
        assert!(notice.contains(part), "no {part:?}: {notice}");
    }

    pub fn last_notice(&self) -> &str {
        self.app
            .session
            .messages
            .notices
            .last()
            .map_or("", |notice| notice.text.as_str())
    }
}
