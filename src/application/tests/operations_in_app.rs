//! What holds of every operation of the application, whichever it is.

use crate::bench::Bench;
use touchline_application::app::operation::{Job, Operation};
use touchline_application::app::operations::Comparison;
use touchline_application::app::{Action, App, Effect, Opened, Settings};
use touchline_application::testing::proposed::{blank, suggestions};

/// What was started.
fn jobs(effects: &[Effect]) -> Vec<Job> {
    let jobs = effects.iter().filter_map(|effect| {
        if let Effect::Start(job) = effect {
            Some(job.clone())
        } else {
            None
        }
    });
    jobs.collect()
}

fn names(jobs: &[Job]) -> Vec<&'static str> {
    jobs.iter().map(Job::name).collect()
}

/// Opens another document and delivers what the operations before report all the same.
fn open_another(bench: &mut Bench, jobs: &[Job]) {
    assert!(jobs.iter().all(|job| !job.is_cancelled()), "{jobs:?}");
    bench.act(Action::Opened(Box::new(Opened::new(
        blank(1),
        "/elsewhere/project.json",
    ))));
    assert!(jobs.iter().all(Job::is_cancelled), "{jobs:?}");
    let before = bench.app.session.messages.notices.len();
    for job in jobs {
        bench.act(Action::Report(job.panic_report("too late".to_owned())));
    }
    assert_eq!(
        bench.app.session.messages.notices.len(),
        before,
        "{:?}",
        bench.app.session.messages.notices
    );
}

#[test]
fn another_document_ends_a_comparison_and_what_runs_unasked() {
    let mut bench = Bench {
        app: App::new(Settings::default()),
        effects: Vec::new(),
    };
    let document = suggestions(&[Some(0.9), Some(0.8)]);
    bench.act(Action::Opened(Box::new(Opened::new(
        document,
        "/match/project.json",
    ))));
    bench.act(Action::Compare("/other/project.json".into()));
    assert!(bench.app.operations.comparison.is_running());
    let started = jobs(&bench.effects);
    let unasked = if cfg!(feature = "opencv") {
        &["burned-in graphics", "new images", "line check"][..]
    } else {
        &["new images", "line check"]
    };
    assert_eq!(names(&started), [unasked, &[Comparison::NAME]].concat());
    open_another(&mut bench, &started);
    assert!(!bench.app.operations.comparison.is_running());
}

#[cfg(feature = "opencv")]
#[test]
fn another_document_ends_the_tracking_of_a_clip() {
    use touchline_application::app::Command;
    use touchline_application::app::guidance::next_step;
    use touchline_application::app::operations::ClipTracking;
    let mut bench = Bench::new(suggestions(&[Some(0.9), None]));
    bench.command(Command::Track);
    assert!(
        names(&jobs(&bench.effects)).contains(&ClipTracking::NAME),
        "{:?}",
        bench.app.why_not(Command::Track)
    );
    assert_eq!(
        bench.app.under_way()[0].job,
        "Tracking cameras through the shot"
    );
    let said = next_step(&bench.app).text;
    assert!(
        said.starts_with("Tracking cameras for 2 frames, this one too."),
        "{said}"
    );
    assert!(bench.app.why_not(Command::Track).is_some(), "one at a time");
    let started = vec![bench.last_job::<ClipTracking>()];
    open_another(&mut bench, &started);
    assert!(
        bench.app.why_not(Command::StopTracking).is_some(),
        "nothing is left to stop"
    );
}

#[cfg(feature = "opencv")]
#[test]
fn another_document_ends_the_search_for_a_camera() {
    use touchline_application::app::Command;
    use touchline_application::app::operations::CameraSearch;
    let mut document = blank(5);
    let camera = &mut document.cameras[0];
    (camera.position_m, camera.base_from_world) = (None, None);
    let mut bench = Bench::new(document);
    bench.command(Command::FindCamera);
    let started = vec![bench.last_job::<CameraSearch>()];
    open_another(&mut bench, &started);
    assert!(bench.app.operations.camera_search.running().is_none());
}

#[test]
fn another_document_ends_a_look_at_an_export_and_its_writing() {
    use touchline_application::app::operations::transfer::{TransferPreview, TransferWrite};
    use touchline_application::app::{Command, Question};
    let mut bench = Bench::new(suggestions(&[Some(0.9)]));
    bench.command(Command::Export);
    assert!(bench.app.operations.transfer.is_looking());
    let look = bench.last_job::<TransferPreview>();
    open_another(&mut bench, &[look]);
    bench.act(Action::Answer(Question::DatasetTo, "/elsewhere/set".into()));
    let write = bench.last_job::<TransferWrite>();
    open_another(&mut bench, &[write]);
    let transfer = &bench.app.operations.transfer;
    assert!(!transfer.is_looking() && transfer.writing().is_none());
    let text = "The export was stopped, because another document was opened.";
    let mut shown = bench.app.session.messages.notices.iter();
    assert!(shown.any(|notice| notice.text == text));
}
