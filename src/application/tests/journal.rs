//! Nothing a person did is lost: journal, atomic store, locks, the saver, and a program that is
//! killed.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use touchline_application::app::Snapshot;
use touchline_application::jobs::{Saver, SaverOptions, SaverReport};
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_documents::document::{Click, Document, Edit, FieldSpec, Frame, History};
use touchline_documents::store::{
    Access, DocumentStore as _, Location, Opened, ReadOnly, Store, StoreError, open, read,
    write_document,
};

fn document(frames: usize) -> Document {
    let mut document = Document::new(FieldSpec::new("soccer"));
    let frame = |index| {
        Frame::from_image(
            &format!("images/{index:04}.jpg"),
            "main".into(),
            ImageSize::new(1280, 720),
        )
    };
    document.frames = (0..frames).map(|index| frame(index).into()).collect();
    document
}

fn new_project(frames: usize) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("match");
    drop(
        Store::create(
            &Location::for_new_document(&with_separator(&path)).unwrap(),
            &document(frames),
        )
        .unwrap(),
    );
    (folder, path)
}

fn with_separator(path: &Path) -> PathBuf {
    path.join("")
}

fn opened(path: &Path) -> (Project, Document) {
    let Opened {
        document,
        access,
        recovery,
        ..
    } = open(path).unwrap();
    match access {
        Access::Writable(store) => (
            Project {
                message: recovery.message(),
                recovered: recovery.edits.len(),
                store,
            },
            document,
        ),
        Access::ReadOnly(reason) => panic!("read-only: {reason}"),
    }
}

struct Project {
    store: Store,
    recovered: usize,
    message: Option<String>,
}

/// Clicks once more, journals it, and returns the document after it.
fn click(store: &mut Store, before: &Document, number: usize) -> Document {
    let mut after = before.clone();
    let index = number % after.frames.len();
    after.frames[index]
        .clicks
        .push(Click::unnamed(ImagePoint::new(number as f64, 0.5)));
    store
        .append(&[Edit::between(before, &after, &format!("Click {number}"))])
        .unwrap();
    after
}

fn total_clicks(document: &Document) -> usize {
    document.frames.iter().map(|frame| frame.clicks.len()).sum()
}

#[test]
fn a_journal_cut_at_any_byte_brings_back_every_edit_up_to_the_cut() {
    let (_folder, path) = new_project(3);
    let (mut project, start) = opened(&path);
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
            let (mut project, document) = opened(&path);
            let next = click(&mut project.store, &document, 99);
            drop(project);
            let (project, document) = opened(&path);
            assert_eq!(document, next, "an edit after a cut at byte {cut}");
            assert_eq!(project.recovered, whole + 1);
        }
    }
}

#[test]
fn recovery_says_what_came_back() {
    let (_folder, path) = new_project(2);
    let (mut project, document) = opened(&path);
    assert_eq!(project.message, None);
    let one = click(&mut project.store, &document, 1);
    drop(project);
    let (mut project, _) = opened(&path);
    assert_eq!(
        project.message.as_deref(),
        Some("Recovered 1 edit: Click 1.")
    );
    let two = click(&mut project.store, &one, 2);
    drop(project);
    let (mut project, document) = opened(&path);
    assert_eq!(
        project.message.as_deref(),
        Some("Recovered 2 edits, the last one: Click 2.")
    );
    assert_eq!(document, two);
    project.store.save(&document, &History::default()).unwrap();
    drop(project);
    let (project, document) = opened(&path);
    assert_eq!(
        (project.message, document.frames),
        (None, two.frames),
        "saved: nothing to recover"
    );
}

#[test]
fn a_damaged_journal_is_kept_beside() {
    let (_folder, path) = new_project(2);
    let (mut project, mut document) = opened(&path);
    for number in 0..3 {
        document = click(&mut project.store, &document, number);
    }
    drop(project);
    let journal = Location::find(&path).unwrap().journal();
    let mut bytes = fs::read(&journal).unwrap();
    let second_edit = bytes
        .windows(7)
        .position(|window| window == b"Click 1")
        .unwrap();
    bytes[second_edit] ^= 1;
    fs::write(&journal, &bytes).unwrap();
    let Opened {
        document, recovery, ..
    } = open(&path).unwrap();
    assert_eq!((total_clicks(&document), recovery.edits.len()), (1, 1));
    assert_eq!(fs::read(recovery.set_aside.unwrap()).unwrap(), bytes);
}

#[test]
fn saving_keeps_the_last_version_and_restarts_the_journal() {
    let (_folder, path) = new_project(2);
    let location = Location::find(&path).unwrap();
    let before = fs::read(location.file()).unwrap();
    let (mut project, document) = opened(&path);
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
fn a_second_program_gets_the_reason_and_reads_only() {
    let (_folder, path) = new_project(2);
    let (mut project, document) = opened(&path);
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
    let (mut project, document) = opened(&path);
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
    assert_eq!(opened(&path).1.frames, after.frames);
}

#[test]
fn edits_of_another_version_are_set_aside_and_not_mixed_in() {
    let (_folder, path) = new_project(2);
    let file = path.join("project.json");
    let (mut project, document) = opened(&path);
    click(&mut project.store, &document, 1);
    drop(project);
    fs::write(
        &file,
        fs::read_to_string(&file)
            .unwrap()
            .replace("\"soccer\"", "\"theirs\""),
    )
    .unwrap();
    let (project, document) = opened(&path);
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
    assert_eq!(opened(&path).0.message, None, "said once");
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
    let (mut project, document) = opened(&path);
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
    let (mut project, _) = opened(&path);
    project.store.save(&after, &History::default()).unwrap();
    drop(project);
    assert_eq!(names(), ["project.json", "project.json.bak"]);
}

/// What a received project may hold in place of the program's own files, and a file of the user's
/// behind a link.
#[cfg(unix)]
fn plant(place: &Path, victim: &Path, how: &str) {
    match how {
        "link" => std::os::unix::fs::symlink(victim, place).unwrap(),
        "pipe" => assert!(
            Command::new("mkfifo")
                .arg(place)
                .status()
                .unwrap()
                .success()
        ),
        _ => fs::create_dir(place).unwrap(),
    }
}

#[cfg(unix)]
#[test]
fn a_received_project_reaches_no_file_of_the_user() {
    for own in ["journal", "lock", "bak"] {
        for how in ["link", "pipe", "folder"] {
            let (folder, path) = new_project(2);
            let victim = folder.path().join("precious.txt");
            fs::write(&victim, "precious").unwrap();
            let planted = path.join(format!("project.json.{own}"));
            plant(&planted, &victim, how);
            match (own, open(&path)) {
                ("journal", Err(error)) => {
                    assert!(error.to_string().contains("not a regular file"), "{error}");
                }
                (
                    "lock",
                    Ok(Opened {
                        access: Access::ReadOnly(reason),
                        ..
                    }),
                ) => {
                    assert!(
                        reason.to_string().contains("not a regular file"),
                        "{reason}"
                    );
                }
                (
                    "bak",
                    Ok(Opened {
                        access: Access::Writable(mut store),
                        document,
                        ..
                    }),
                ) => {
                    let after = click(&mut store, &document, 1);
                    let saved = store.save(&after, &History::default());
                    assert_eq!(saved.is_err(), how == "folder", "{saved:?}");
                }
                (_, opened) => panic!("{own} as {how}: {opened:?}"),
            }
            let replaced = Store::replace(&Location::find(&path).unwrap(), &document(3));
            assert_eq!(
                replaced.is_err(),
                own != "bak" || how == "folder",
                "{own} as {how}: {replaced:?}"
            );
            assert_eq!(
                fs::read_to_string(&victim).unwrap(),
                "precious",
                "{own} as {how}"
            );
        }
    }
}

#[cfg(unix)]
#[test]
fn a_document_is_written_behind_a_link_and_into_a_pipe() {
    let (folder, path) = new_project(1);
    let link = folder.path().join("link.json");
    std::os::unix::fs::symlink(path.join("project.json"), &link).unwrap();
    write_document(
        &Location::for_new_document(&link).unwrap(),
        &document(4),
        true,
    )
    .unwrap();
    assert!(link.is_symlink());
    assert_eq!(read(&path).unwrap().1.frames.len(), 4);
    let pipe = folder.path().join("pipe.json");
    plant(&pipe, &pipe, "pipe");
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read(pipe).unwrap()
    });
    write_document(
        &Location::for_new_document(&pipe).unwrap(),
        &document(3),
        true,
    )
    .unwrap();
    let written =
        touchline_documents::document::document_from_bytes(&reader.join().unwrap()).unwrap();
    assert_eq!(written.frames.len(), 3);
    let names: Vec<_> = fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert_eq!(names.len(), 3, "no backup of a pipe: {names:?}");
}

#[test]
fn nothing_is_acknowledged_in_a_folder_that_is_gone() {
    let (folder, path) = new_project(2);
    let (mut project, before) = opened(&path);
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
    let (project, document) = opened(&path);
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
    let (mut project, before) = opened(&path);
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
    assert_eq!(opened(&path).1, next);
}

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

fn journaled(wanted: u64) -> impl FnMut(&SaverReport) -> Option<()> {
    move |report| {
        matches!(report, SaverReport::Journaled { revision, .. } if *revision >= wanted)
            .then_some(())
    }
}

#[test]
fn the_saver_acknowledges_what_is_on_disk_and_drains_at_closing() {
    let (_folder, path) = new_project(4);
    let (project, mut document) = opened(&path);
    let saver = saver(project.store, &document, SaverOptions::default());
    let count = 300;
    for revision in 1..=count {
        let mut after = document.clone();
        after.frames[revision % 4]
            .clicks
            .push(Click::unnamed(ImagePoint::new(revision as f64, 1.0)));
        saver.edit(
            Edit::between(&document, &after, "Click"),
            snapshot(&after, revision as u64),
        );
        document = after;
        if revision == 10 {
            wait_for(&saver, journaled(10));
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
    let (project, after) = opened(&path);
    assert_eq!((after.frames, project.message), (document.frames, None));
}

#[test]
fn the_saver_writes_the_document_from_time_to_time_and_on_request() {
    let (_folder, path) = new_project(1);
    let (project, document) = opened(&path);
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
    let (project, document) = opened(&path);
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
        SaverReport::Failed { error, .. } => Some(error.to_string()),
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
    assert_eq!(opened(&path).1.frames[0].comment.as_deref(), Some("kept"));
}

#[test]
fn the_document_that_an_edit_led_to_is_journalled_even_where_the_edit_does_not_fit() {
    let (_folder, path) = new_project(2);
    let (project, start) = opened(&path);
    let saver = saver(project.store, &start, SaverOptions::default());
    let more = document(5);
    let mut after = more.clone();
    after.frames[4].comment = Some("fifth".to_owned());
    // The saver knows two frames only.
    saver.edit(Edit::between(&more, &after, "Comment"), snapshot(&after, 1));
    wait_for(&saver, journaled(1));
    assert_eq!(
        read(&path).unwrap().1.frames,
        after.frames,
        "the journal leads there"
    );
    let mut last = after.clone();
    last.frames[0].comment = Some("first".to_owned());
    saver.edit(Edit::between(&after, &last, "Comment"), snapshot(&last, 2));
    wait_for(&saver, journaled(2));
    drop(saver);
    assert_eq!(opened(&path).1.frames, last.frames);
}

const CHILD_FOLDER: &str = "TOUCHLINE_TEST_CHILD_FOLDER";

/// Not a test by itself: the program that the next test kills. It edits and saves for ever, and
/// says what is on disk.
#[test]
fn child_that_writes_until_it_is_killed() {
    let Some(path) = std::env::var_os(CHILD_FOLDER) else {
        return;
    };
    let (mut project, mut document) = opened(Path::new(&path));
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
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args([
                "journal::child_that_writes_until_it_is_killed",
                "--exact",
                "--nocapture",
                "--test-threads=1",
            ])
            .env(CHILD_FOLDER, &path)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let output = BufReader::new(child.stdout.take().unwrap());
        let mut lines = output.lines().map_while(Result::ok);
        let number = |line: String| {
            line.split("acknowledged ")
                .nth(1)
                .and_then(|count| count.trim().parse().ok())
        };
        // Each round is cut at another place, and the moment of the kill is the system's.
        for count in lines.by_ref().filter_map(number).take(3 + round) {
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
        acknowledged = lines.filter_map(number).last().unwrap_or(acknowledged);
        child.wait().unwrap();
        let (project, document) = opened(&path);
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
    let (Project { mut store, .. }, opened_first) = opened(&path);
    let after = click(&mut store, &opened_first, 1);
    drop(store);
    let (Project { recovered, .. }, again) = opened(&path);
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
    let (Project { mut store, .. }, start) = opened(&path);
    let first = click(&mut store, &start, 0);
    // Made of a document in which the frame was changed otherwise.
    let mut elsewhere = first.clone();
    elsewhere.frames[0]
        .clicks
        .push(Click::unnamed(ImagePoint::new(9.0, 9.0)));
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
