//! What the journal brings back when a document is opened: all edits of a whole one, as many as
//! possible of a damaged one.

use super::{Project, click, document, new_project, open_project, total_clicks};
use std::fs;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{Click, Edit, History};
use touchline_documents::store::{Location, Opened, open, read, write_document};

#[test]
fn a_journal_cut_at_any_byte_brings_back_every_edit_up_to_the_cut() {
    let (_folder, path) = new_project(3);
    let (mut project, start) = open_project(&path);
    let mut states = vec![start];
    for number in 0..6 {
        let next = click(&mut project.store, states.last().unwrap(), number);
        states.push(next);
    }
    let mut shorter = states.last().unwrap().clone();
    shorter.frames.remove(1);
    shorter.field.params.insert("length_m".to_owned(), 101.5);
    project
        .store
        .append(&[Edit::between(
            states.last().unwrap(),
            &shorter,
            "Remove a frame",
        )])
        .unwrap();
    states.push(shorter);
    drop(project);

    let journal = Location::find(&path).unwrap().journal();
    let bytes = fs::read(&journal).unwrap();
    let line_ends: Vec<usize> = (1..=bytes.len())
        .filter(|end| bytes[end - 1] == b'\n')
        .collect();
    assert_eq!(
        line_ends.len(),
        states.len(),
        "a line for the start, a line an edit"
    );
    for cut in 0..=bytes.len() {
        fs::write(&journal, &bytes[..cut]).unwrap();
        let whole = line_ends
            .iter()
            .filter(|end| **end <= cut)
            .count()
            .saturating_sub(1);
        let (_, document, recovery) = read(&path).unwrap();
        assert_eq!(document, states[whole], "cut at byte {cut}");
        assert_eq!(recovery.edits.len(), whole, "cut at byte {cut}");
        assert_eq!(
            recovery.lost_bytes > 0,
            cut > 0 && !line_ends.contains(&cut),
            "cut at byte {cut}"
        );
        assert_eq!(
            recovery.message().is_some(),
            whole > 0 || recovery.lost_bytes > 0
        );
        if cut % 41 == 0 || line_ends.contains(&cut) {
            let (mut project, document) = open_project(&path);
            let next = click(&mut project.store, &document, 99);
            drop(project);
            let (project, document) = open_project(&path);
            assert_eq!(document, next, "an edit after a cut at byte {cut}");
            assert_eq!(project.recovered, whole + 1);
        }
    }
}

#[test]
fn recovery_says_what_came_back() {
    let (_folder, path) = new_project(2);
    let (mut project, document) = open_project(&path);
    assert_eq!(project.message, None);
    let one = click(&mut project.store, &document, 1);
    drop(project);
    let (mut project, _) = open_project(&path);
    assert_eq!(
        project.message.as_deref(),
        Some("Recovered 1 edit: Click 1.")
    );
    let two = click(&mut project.store, &one, 2);
    drop(project);
    let (mut project, document) = open_project(&path);
    assert_eq!(
        project.message.as_deref(),
        Some("Recovered 2 edits, the last one: Click 2.")
    );
    assert_eq!(document, two);
    project.store.save(&document, &History::default()).unwrap();
    drop(project);
    let (project, document) = open_project(&path);
    assert_eq!(
        (project.message, document.frames),
        (None, two.frames),
        "saved: nothing to recover"
    );
}

#[test]
fn a_damaged_journal_is_kept_beside() {
    let (_folder, path) = new_project(2);
    let (mut project, mut document) = open_project(&path);
    for number in 0..3 {
        document = click(&mut project.store, &document, number);
    }
    drop(project);
    let journal = Location::find(&path).unwrap().journal();
    let whole = fs::read(&journal).unwrap();
    for (damaged, name) in [(1, b"Click 1"), (2, b"Click 2")] {
        let mut bytes = whole.clone();
        let edit = bytes.windows(7).position(|window| window == name).unwrap();
        bytes[edit] ^= 1;
        fs::write(&journal, &bytes).unwrap();
        let Opened {
            document, recovery, ..
        } = open(&path).unwrap();
        assert_eq!(
            (total_clicks(&document), recovery.edits.len()),
            (damaged, damaged)
        );
        assert_eq!(fs::read(recovery.set_aside.unwrap()).unwrap(), bytes);
    }
}

#[test]
fn what_can_be_read_can_be_recovered_however_deep_it_is() {
    // A key of a frame lies in the document, its list of frames and the frame.
    const FRAMES: usize = 3;
    let deep = |levels: usize| {
        serde_json::from_str(&format!("{}1{}", "[".repeat(levels), "]".repeat(levels))).unwrap()
    };
    let (_folder, path) = new_project(1);
    let mut first = document(1);
    first.frames[0]
        .extra
        .insert("deepest".to_owned(), deep(100 - FRAMES));
    let location = Location::find(&path).unwrap();
    write_document(&location, &first, true).unwrap();
    let (Project { mut store, .. }, opened_first) = open_project(&path);
    let after = click(&mut store, &opened_first, 1);
    drop(store);
    let (Project { recovered, .. }, again) = open_project(&path);
    assert_eq!((recovered, again), (1, after));
    // One level more is refused when it is read, not when it is recovered.
    let text = fs::read_to_string(location.file())
        .unwrap()
        .replace("\"deepest\": ", "\"deepest\": [");
    let text = text.replacen("1]", "1]]", 1);
    fs::write(path.with_extension("json"), &text).unwrap();
    let refused = read(&path.with_extension("json")).unwrap_err().to_string();
    assert!(
        refused.contains("lists and objects lie more than 100 deep within each other"),
        "{refused}"
    );
}

#[test]
fn an_edit_that_does_not_fit_is_named_with_those_behind_it() {
    let (_folder, path) = new_project(2);
    let (Project { mut store, .. }, start) = open_project(&path);
    let first = click(&mut store, &start, 0);
    // Made of a document in which the frame was changed otherwise.
    let mut elsewhere = first.clone();
    elsewhere.frames[0]
        .clicks
        .push(Click::without_name(ImagePoint::new(9.0, 9.0)));
    elsewhere.frames[0].revision += 7;
    let misfit = click(&mut store, &elsewhere, 2);
    click(&mut store, &misfit, 3);
    drop(store);
    let (_, recovered, recovery) = read(&path).unwrap();
    assert_eq!(total_clicks(&recovered), total_clicks(&first));
    let message = recovery.message().unwrap();
    let said =
        "The edit \"Click 2\" does not apply to the document: it and 1 edit after it are left out.";
    assert!(message.contains(said), "{message}");
}
