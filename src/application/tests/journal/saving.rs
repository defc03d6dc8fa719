//! Saving keeps the version before, leaves alone what another program wrote or has open, and says
//! when files are gone.

use super::{click, document, new_project, open_project, total_clicks};
use std::fs;
use touchline_documents::document::{Edit, History};
use touchline_documents::store::{Access, Location, ReadOnly, Store, StoreError, open, read};

#[test]
fn saving_keeps_the_last_version_and_restarts_the_journal() {
    let (_folder, path) = new_project(2);
    let location = Location::find(&path).unwrap();
    let before = fs::read(location.file()).unwrap();
    let (mut project, document) = open_project(&path);
    let after = click(&mut project.store, &document, 1);
    let journal_length = fs::metadata(location.journal()).unwrap().len();
    assert!(project.store.is_behind());
    project.store.save(&after, &History::default()).unwrap();
    assert!(!project.store.is_behind());
    assert_eq!(fs::read(location.backup()).unwrap(), before);
    assert!(fs::metadata(location.journal()).unwrap().len() < journal_length);
    let written = fs::read(location.file()).unwrap();
    project.store.save(&after, &History::default()).unwrap();
    assert_eq!(
        fs::read(location.file()).unwrap(),
        written,
        "same document, same bytes"
    );
    assert_eq!(
        fs::read(location.backup()).unwrap(),
        before,
        "nothing changed, the backup stays"
    );
}

#[test]
fn creating_overwrites_nothing_and_replacing_keeps_a_backup() {
    let (_folder, path) = new_project(1);
    let location = Location::for_new_document(&path).unwrap();
    assert!(matches!(
        Store::create(&location, &document(5)),
        Err(StoreError::Exists { .. })
    ));
    let before = fs::read(location.file()).unwrap();
    drop(Store::replace(&location, &document(5)).unwrap());
    assert_eq!(fs::read(location.backup()).unwrap(), before);
    assert_eq!(read(&path).unwrap().1.frames.len(), 5);
}

#[test]
fn closing_leaves_only_what_is_needed() {
    let (_folder, path) = new_project(1);
    let names = || {
        let mut names: Vec<_> = fs::read_dir(&path)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    assert_eq!(names(), ["project.json"]);
    let (mut project, document) = open_project(&path);
    assert_eq!(
        names(),
        ["project.json", "project.json.journal", "project.json.lock"]
    );
    let after = click(&mut project.store, &document, 1);
    drop(project);
    assert_eq!(
        names(),
        ["project.json", "project.json.journal"],
        "an edit that is not yet in the document"
    );
    let (mut project, _) = open_project(&path);
    project.store.save(&after, &History::default()).unwrap();
    drop(project);
    assert_eq!(names(), ["project.json", "project.json.bak"]);
}

#[test]
fn a_second_program_gets_the_reason_and_reads_only() {
    let (_folder, path) = new_project(2);
    let (mut project, document) = open_project(&path);
    let after = click(&mut project.store, &document, 1);
    let second = open(&path).unwrap();
    let Access::ReadOnly(reason) = second.access else {
        panic!("two writers")
    };
    assert_eq!(second.document, after, "it sees what is in the journal");
    let expected = format!(
        "open in another touchline (process {}); close it there to edit here",
        std::process::id()
    );
    assert_eq!(reason.to_string(), expected);
    let Err(StoreError::ReadOnly { reason, .. }) =
        Store::replace(project.store.location(), &document)
    else {
        panic!("replaced under another program's hands")
    };
    assert!(matches!(reason, ReadOnly::OpenElsewhere { .. }));
    drop(project);
    assert!(matches!(open(&path).unwrap().access, Access::Writable(_)));
}

#[test]
fn a_write_protected_document_opens_read_only() {
    let (_folder, path) = new_project(1);
    let file = path.join("project.json");
    let mut permissions = fs::metadata(&file).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&file, permissions).unwrap();
    let Access::ReadOnly(reason) = open(&path).unwrap().access else {
        panic!("writable")
    };
    assert_eq!(
        reason.to_string(),
        "not writable (the file is write-protected); save a copy elsewhere to edit"
    );
}

#[test]
fn what_another_program_wrote_is_not_overwritten() {
    let (_folder, path) = new_project(2);
    let file = path.join("project.json");
    let (mut project, document) = open_project(&path);
    let after = click(&mut project.store, &document, 1);
    let theirs = fs::read_to_string(&file)
        .unwrap()
        .replace("\"soccer\"", "\"theirs\"");
    fs::write(&file, &theirs).unwrap();
    let error = project.store.save(&after, &History::default()).unwrap_err();
    assert!(
        matches!(error, StoreError::ChangedOutside { .. }),
        "{error}"
    );
    assert_eq!(fs::read_to_string(&file).unwrap(), theirs);
    let kept = project
        .store
        .save_over(&after, &History::default())
        .unwrap()
        .unwrap();
    assert_eq!(fs::read_to_string(kept).unwrap(), theirs);
    drop(project);
    assert_eq!(open_project(&path).1.frames, after.frames);
}

#[test]
fn edits_of_another_version_are_set_aside_and_not_mixed_in() {
    let (_folder, path) = new_project(2);
    let file = path.join("project.json");
    let (mut project, document) = open_project(&path);
    click(&mut project.store, &document, 1);
    drop(project);
    fs::write(
        &file,
        fs::read_to_string(&file)
            .unwrap()
            .replace("\"soccer\"", "\"theirs\""),
    )
    .unwrap();
    let (project, document) = open_project(&path);
    assert_eq!(
        (document.field.template.as_str(), total_clicks(&document)),
        ("theirs", 0)
    );
    let message = project.message.unwrap();
    assert!(
        message.starts_with("Another program changed the document: 1 edit is not in it."),
        "{message}"
    );
    assert!(
        message.contains("project.json.journal.orphan-1"),
        "{message}"
    );
    drop(project.store);
    assert_eq!(open_project(&path).0.message, None, "said once");
}

#[test]
fn nothing_is_acknowledged_in_a_folder_that_is_gone() {
    let (folder, path) = new_project(2);
    let (mut project, before) = open_project(&path);
    let mut after = before.clone();
    after.frames[0].comment = Some("kept".to_owned());
    let away = folder.path().join("away");
    fs::rename(&path, &away).unwrap();
    for _ in 0..2 {
        let error = project
            .store
            .append(&[Edit::between(&before, &after, "Comment")])
            .unwrap_err();
        assert!(matches!(error, StoreError::Gone { .. }), "{error}");
        assert!(matches!(
            project.store.save(&after, &History::default()),
            Err(StoreError::Gone { .. })
        ));
    }
    fs::rename(&away, &path).unwrap();
    project
        .store
        .append(&[Edit::between(&before, &after, "Comment")])
        .unwrap();
    drop(project);
    let (project, document) = open_project(&path);
    assert_eq!(
        (document, project.recovered),
        (after, 1),
        "the edit is there once"
    );
}

#[test]
fn a_journal_that_was_deleted_is_made_again_by_saving() {
    let (_folder, path) = new_project(2);
    let location = Location::find(&path).unwrap();
    let (mut project, before) = open_project(&path);
    fs::remove_file(location.journal()).unwrap();
    fs::remove_file(location.lock()).unwrap();
    let mut after = before.clone();
    after.frames[1].comment = Some("kept".to_owned());
    let error = project
        .store
        .append(&[Edit::between(&before, &after, "Comment")])
        .unwrap_err();
    assert!(
        matches!(&error, StoreError::Gone { path } if *path == location.journal()),
        "{error}"
    );
    project.store.save(&after, &History::default()).unwrap();
    assert!(
        matches!(open(&path).unwrap().access, Access::ReadOnly(_)),
        "the lock holds again"
    );
    let next = click(&mut project.store, &after, 1);
    drop(project);
    assert_eq!(open_project(&path).1, next);
}
