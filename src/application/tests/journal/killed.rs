//! A program that is killed while it writes.

use super::{click, new_project, open_project, total_clicks};
use std::path::Path;
use touchline_core::testing::child::{numbers_behind, spawn_test};
use touchline_documents::document::History;
use touchline_documents::store::{Access, ReadOnly, open};

const CHILD_FOLDER: &str = "TOUCHLINE_TEST_CHILD_FOLDER";

/// Not a test by itself: the program that the next test kills. It edits and saves for ever, and
/// says what is on disk.
#[test]
fn child_that_writes_until_it_is_killed() {
    let Some(path) = std::env::var_os(CHILD_FOLDER) else {
        return;
    };
    let (mut project, mut document) = open_project(Path::new(&path));
    for number in total_clicks(&document).. {
        document = click(&mut project.store, &document, number);
        println!("acknowledged {}", number + 1);
        if number % 3 == 0 {
            project.store.save(&document, &History::default()).unwrap();
        }
    }
}

#[test]
fn a_program_that_is_killed_loses_nothing_it_acknowledged() {
    let (_folder, path) = new_project(3);
    let mut acknowledged = 0;
    for round in 0..12 {
        let (mut child, lines) = spawn_test(
            "journal::killed::child_that_writes_until_it_is_killed",
            [(CHILD_FOLDER, path.to_str().unwrap())],
        );
        let mut counts = numbers_behind("acknowledged ", lines);
        // Each round is cut at another place, and the moment of the kill is the system's.
        for count in counts.by_ref().take(3 + round) {
            acknowledged = count;
        }
        if round == 0 {
            let Access::ReadOnly(reason) = open(&path).unwrap().access else {
                panic!("two writers")
            };
            assert_eq!(
                reason,
                ReadOnly::OpenElsewhere {
                    holder: format!("process {}", child.id())
                }
            );
        }
        child.kill().unwrap();
        acknowledged = counts.last().unwrap_or(acknowledged);
        child.wait().unwrap();
        let (project, document) = open_project(&path);
        let found = total_clicks(&document);
        assert!(
            found >= acknowledged,
            "round {round}: {acknowledged} acknowledged, {found} found"
        );
        for (index, frame) in document.frames.iter().enumerate() {
            for (nth, click) in frame.clicks.iter().enumerate() {
                assert_eq!(
                    click.image.x as usize,
                    nth * 3 + index,
                    "no edit is missing in between"
                );
            }
        }
        drop(project);
    }
    assert!(
        acknowledged >= 12 * 3,
        "the child did write: {acknowledged}"
    );
}
