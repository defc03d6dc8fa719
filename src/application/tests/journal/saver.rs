//! The saver acknowledges edits that are on disk, and tries again what the disk refuses.

use super::{document, new_project, open_project, total_clicks};
use std::fs;
use std::sync::Arc;
use std::time::{Duration, Instant};
use touchline_application::app::Snapshot;
use touchline_application::jobs::{Saver, SaverOptions, SaverReport};
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{Click, Document, Edit, History};
use touchline_documents::store::{Store, read};

fn saver(store: Store, document: &Document, options: SaverOptions) -> Saver {
    Saver::start(store, snapshot(document, 0), options, Arc::new(|| {})).unwrap()
}

fn snapshot(document: &Document, revision: u64) -> Snapshot {
    Snapshot {
        document: document.clone(),
        history: History::default(),
        revision,
    }
}

/// Waits for a report that `wanted` picks out; a minute without it is a failure.
fn wait_for<T>(saver: &Saver, mut wanted: impl FnMut(&SaverReport) -> Option<T>) -> T {
    let start = Instant::now();
    while start.elapsed() < Duration::from_mins(1) {
        if let Some(found) = saver.reports().iter().find_map(&mut wanted) {
            return found;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    panic!("the saver said nothing in a minute")
}

fn revision_in_journal(wanted: u64) -> impl FnMut(&SaverReport) -> Option<()> {
    move |report| {
        matches!(report, SaverReport::Journaled { revision, .. } if *revision >= wanted)
            .then_some(())
    }
}

#[test]
fn the_saver_acknowledges_what_is_on_disk_and_drains_at_closing() {
    let (_folder, path) = new_project(4);
    let (project, mut document) = open_project(&path);
    let saver = saver(project.store, &document, SaverOptions::default());
    let count = 300;
    for revision in 1..=count {
        let mut after = document.clone();
        after.frames[revision % 4]
            .clicks
            .push(Click::without_name(ImagePoint::new(revision as f64, 1.0)));
        saver.edit(
            Edit::between(&document, &after, "Click"),
            snapshot(&after, revision as u64),
        );
        document = after;
        if revision == 10 {
            wait_for(&saver, revision_in_journal(10));
            assert!(
                total_clicks(&read(&path).unwrap().1) >= 10,
                "what is acknowledged is there"
            );
        }
    }
    let reports = saver.close();
    let last = reports.last().unwrap();
    assert!(
        matches!(
            last,
            SaverReport::Saved {
                revision: 300,
                set_aside: None,
                ..
            }
        ),
        "{last:?}"
    );
    let (project, after) = open_project(&path);
    assert_eq!((after.frames, project.message), (document.frames, None));
}

#[test]
fn the_saver_writes_the_document_from_time_to_time_and_on_request() {
    let (_folder, path) = new_project(1);
    let (project, document) = open_project(&path);
    let options = SaverOptions {
        save_every: Duration::from_millis(5),
        ..SaverOptions::default()
    };
    let saver = saver(project.store, &document, options);
    let mut after = document.clone();
    after.frames[0].comment = Some("rain".to_owned());
    saver.edit(
        Edit::between(&document, &after, "Comment"),
        snapshot(&after, 1),
    );
    let saved = |report: &SaverReport| {
        matches!(report, SaverReport::Saved { revision: 1, .. }).then_some(())
    };
    wait_for(&saver, saved);
    assert!(
        fs::read_to_string(path.join("project.json"))
            .unwrap()
            .contains("\"rain\"")
    );
    saver.save(7);
    wait_for(&saver, |report| {
        matches!(
            report,
            SaverReport::Saved {
                revision: 1,
                request: 7,
                ..
            }
        )
        .then_some(())
    });
    assert!(saver.close().is_empty(), "nothing was left to do");
}

#[test]
fn what_the_disk_refuses_stays_in_memory_and_is_tried_again() {
    let (folder, path) = new_project(1);
    let (project, document) = open_project(&path);
    let options = SaverOptions {
        save_every: Duration::from_millis(5),
        retry_after: Duration::from_millis(5),
    };
    let saver = saver(project.store, &document, options);
    let away = folder.path().join("away");
    fs::rename(&path, &away).unwrap();
    let mut after = document.clone();
    after.frames[0].comment = Some("kept".to_owned());
    saver.edit(
        Edit::between(&document, &after, "Comment"),
        snapshot(&after, 1),
    );
    let message = wait_for(&saver, |report| match report {
        SaverReport::Failed(error) => Some(error.to_string()),
        _ => None,
    });
    assert!(
        message.ends_with("was moved or deleted while it was open; put it back, or save elsewhere"),
        "{message}"
    );
    fs::rename(&away, &path).unwrap();
    wait_for(&saver, |report| {
        matches!(report, SaverReport::Saved { revision: 1, .. }).then_some(())
    });
    drop(saver);
    assert_eq!(
        open_project(&path).1.frames[0].comment.as_deref(),
        Some("kept")
    );
}

#[test]
fn the_document_that_an_edit_led_to_is_journalled_even_where_the_edit_does_not_fit() {
    let (_folder, path) = new_project(2);
    let (project, start) = open_project(&path);
    let saver = saver(project.store, &start, SaverOptions::default());
    let more = document(5);
    let mut after = more.clone();
    after.frames[4].comment = Some("fifth".to_owned());
    // The saver knows two frames only.
    saver.edit(Edit::between(&more, &after, "Comment"), snapshot(&after, 1));
    wait_for(&saver, revision_in_journal(1));
    assert_eq!(
        read(&path).unwrap().1.frames,
        after.frames,
        "the journal leads there"
    );
    let mut last = after.clone();
    last.frames[0].comment = Some("first".to_owned());
    saver.edit(Edit::between(&after, &last, "Comment"), snapshot(&last, 2));
    wait_for(&saver, revision_in_journal(2));
    drop(saver);
    assert_eq!(open_project(&path).1.frames, last.frames);
}
