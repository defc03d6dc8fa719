//! Fault injection: each of the store's system calls fails in turn, before or after its effect,
//! alone or with all later ones. Afterwards the folder is examined as it is after a kill or after a
//! power cut.

use super::{Access, Location, Opened, Store, StoreError, open, orphans, read};
use crate::document::{Click, Document, Edit, FieldSpec, Frame, History, Step, document_to_string};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::mem::ManuallyDrop;
use std::path::Path;
use tempfile::TempDir;
use touchline_core::geometry::{ImagePoint, ImageSize};

/// Which calls fail. Calls are numbered from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    /// None.
    None,
    /// One call fails without effect.
    Before(usize),
    /// One call takes effect, but reports a failure.
    After(usize),
    /// One call and all later ones fail without effect.
    From(usize),
}

/// The error that a failing call reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Refusal {
    NoSpace,
    Broken,
}

/// The part of a folder that is on the disk, as opposed to the system's cache.
#[derive(Debug, Default)]
struct Durable {
    /// The inode of each name.
    names: BTreeMap<String, u64>,
    /// The content of each inode at its last flush.
    contents: BTreeMap<u64, Vec<u8>>,
    /// Flushed files, kept open so that their inodes are not reused.
    held: Vec<File>,
}

/// The faults of this thread, and the record of its calls.
#[derive(Debug)]
struct Plan {
    fault: Fault,
    refusal: Refusal,
    calls: usize,
    durable: Durable,
}

thread_local! {
    static PLAN: RefCell<Plan> = const {
        RefCell::new(Plan {
            fault: Fault::None,
            refusal: Refusal::Broken,
            calls: 0,
            durable: Durable { names: BTreeMap::new(), contents: BTreeMap::new(), held: Vec::new() },
        })
    };
}

/// Sets the faults of this thread and restarts the numbering of calls.
fn plan(fault: Fault, refusal: Refusal) {
    PLAN.with_borrow_mut(|plan| (plan.fault, plan.refusal, plan.calls) = (fault, refusal, 0));
}

fn calls() -> usize {
    PLAN.with_borrow(|plan| plan.calls)
}

/// Makes a call, unless it is planned to fail.
pub(super) fn try_call<T>(call: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
    let (number, fault, refusal) = PLAN.with_borrow_mut(|plan| {
        plan.calls += 1;
        (plan.calls - 1, plan.fault, plan.refusal)
    });
    let refused = || {
        Err(match refusal {
            Refusal::NoSpace => io::ErrorKind::StorageFull.into(),
            Refusal::Broken => io::Error::other("Input/output error"),
        })
    };
    match fault {
        Fault::Before(failing) if number == failing => refused(),
        Fault::From(failing) if number >= failing => refused(),
        Fault::After(failing) if number == failing => call().and_then(|_| refused()),
        _ => call(),
    }
}

/// Records what a call flushed: a file's content, or the names in a folder.
pub(super) fn note_flushed(path: &Path) {
    #[cfg(unix)]
    PLAN.with_borrow_mut(|plan| {
        use std::os::unix::fs::MetadataExt as _;
        let id = |path: &Path| fs::metadata(path).map(|metadata| metadata.ino());
        if path.is_dir() {
            let entries = fs::read_dir(path).into_iter().flatten().flatten();
            let named = entries.filter_map(|entry| {
                Some((
                    entry.file_name().into_string().ok()?,
                    id(&entry.path()).ok()?,
                ))
            });
            plan.durable.names = named.collect();
        } else if let (Ok(id), Ok(bytes)) = (id(path), fs::read(path)) {
            plan.durable.contents.insert(id, bytes);
            plan.durable.held.extend(File::open(path));
        }
    });
}

/// Records a whole folder as flushed.
fn all_flushed(folder: &Path) {
    PLAN.with_borrow_mut(|plan| plan.durable = Durable::default());
    note_flushed(folder);
    for entry in fs::read_dir(folder).unwrap() {
        note_flushed(&entry.unwrap().path());
    }
}

/// The folder after a power cut: names and contents at their last flush. A file that has a flushed
/// name but no flushed content is empty.
fn after_power_cut() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    PLAN.with_borrow(|plan| {
        for (name, id) in &plan.durable.names {
            let bytes = plan.durable.contents.get(id).map_or(&[][..], Vec::as_slice);
            fs::write(folder.path().join(name), bytes).unwrap();
        }
    });
    folder
}

/// The folder after the program was killed. Unflushed writes survive, because the system has them.
fn after_kill(folder: &Path) -> TempDir {
    let copy = tempfile::tempdir().unwrap();
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        fs::copy(entry.path(), copy.path().join(entry.file_name())).unwrap();
    }
    copy
}

const STEPS: usize = 7;

fn start() -> Document {
    let mut document = Document::new(FieldSpec::new("soccer"));
    let frame = |index| {
        Frame::from_image(
            &format!("{index}.jpg"),
            "main".into(),
            ImageSize::new(1280, 720),
        )
        .into()
    };
    document.frames = (0..2).map(frame).collect();
    document
}

fn add_click(before: &Document, number: usize) -> Document {
    let mut after = before.clone();
    let frame = &mut after.frames[number % 2];
    frame
        .clicks
        .push(Click::without_name(ImagePoint::new(number as f64, 0.5)));
    frame.revision += 1;
    after
}

/// The document after each number of clicks.
fn states() -> Vec<Document> {
    (0..=STEPS)
        .scan(start(), |state, number| {
            let now = state.clone();
            *state = add_click(state, number);
            Some(now)
        })
        .collect()
}

fn clicks(document: &Document) -> usize {
    document.frames.iter().map(|frame| frame.clicks.len()).sum()
}

/// Asserts that a message names the path in one line, without temporary names, and has a remedy for
/// a full disk.
fn assert_said(error: &StoreError, folder: &Path) {
    let said = error.to_string();
    let place = folder.to_string_lossy();
    assert!(
        said.contains(&*place) && !said.contains('\n') && !said.contains(".touchline-"),
        "{said}"
    );
    if said.contains("no storage space") {
        assert!(
            said.contains("free some space") || said.contains("save a copy elsewhere"),
            "{said}"
        );
    }
}

/// The counts of one session.
struct Session {
    /// Clicks that the store accepted, in the journal or in the document.
    acknowledged: usize,
    /// Clicks that were made.
    made: usize,
    /// Calls that returned an error.
    refused: usize,
}

/// A user opens a project, clicks, saves now and then, and closes it. A step that fails is repeated
/// if `again` is set; otherwise it ends the session.
fn session(folder: &Path, again: bool) -> Session {
    let mut session = Session {
        acknowledged: 0,
        made: 0,
        refused: 0,
    };
    let _ = try_session(folder, again, &mut session);
    session
}

/// Repeats a failed attempt once, if `again` is set.
fn with_retry<T>(
    folder: &Path,
    again: bool,
    session: &mut Session,
    mut attempt: impl FnMut() -> Result<T, StoreError>,
) -> Option<T> {
    let error = match attempt() {
        Ok(done) => return Some(done),
        Err(error) => error,
    };
    session.refused += 1;
    assert_said(&error, folder);
    if !again {
        return None;
    }
    Some(attempt().unwrap_or_else(|second| panic!("{error}; and then: {second}")))
}

fn try_session(folder: &Path, again: bool, session: &mut Session) -> Option<()> {
    let file = folder.join("project.json");
    let (store, mut document) = with_retry(folder, again, session, || {
        let Opened {
            document, access, ..
        } = open(&file)?;
        match access {
            Access::Writable(store) => Ok((store, document)),
            Access::ReadOnly(reason) => Err(StoreError::ReadOnly {
                path: file.clone(),
                reason,
            }),
        }
    })?;
    // A program that crashes does not run `drop`.
    let mut store = ManuallyDrop::new(store);
    let mut history = History::default();
    for number in clicks(&document)..STEPS {
        history.begin(&document, Step::on_document("Click"));
        let after = add_click(&document, number);
        history.commit(&after);
        let edit = Edit::between(&document, &after, "Click");
        session.made = number + 1;
        with_retry(folder, again, session, || {
            store.append(std::slice::from_ref(&edit))
        })?;
        (document, session.acknowledged) = (after, number + 1);
        if number % 3 == 1 {
            with_retry(folder, again, session, || store.save(&document, &history))?;
        }
        if number == 4 {
            // Close and open again in the middle.
            drop(ManuallyDrop::into_inner(store));
            return try_session(folder, again, session);
        }
    }
    drop(ManuallyDrop::into_inner(store));
    Some(())
}

/// A new project, flushed to disk.
fn project() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let folder_path = fs::canonicalize(folder.path()).unwrap();
    let location = Location::for_new_document(&folder_path.join("project.json")).unwrap();
    drop(Store::create(&location, &start()).unwrap());
    all_flushed(&folder_path);
    folder
}

/// Asserts that the folder opens with every acknowledged click, and at most one more.
fn assert_kept(left: &Path, session: &Session, what: &str) {
    let (_, document, recovery) = read(left).unwrap_or_else(|error| panic!("{what}: {error}"));
    let found = clicks(&document);
    let states = states();
    assert!(
        (session.acknowledged..=session.made.max(session.acknowledged)).contains(&found),
        "{what}: {found} clicks, {} acknowledged; {recovery:?}",
        session.acknowledged
    );
    assert_eq!(document.frames, states[found].frames, "{what}");
    assert_eq!(
        (recovery.foreign_edits, recovery.misfit),
        (0, None),
        "{what}"
    );
    // The folder also opens for writing, and a session without faults finishes.
    let next = self::session(&fs::canonicalize(left).unwrap(), false);
    assert_eq!(next.refused, 0, "{what}");
    assert_eq!(read(left).unwrap().1.frames, states[STEPS].frames, "{what}");
}

/// Number of calls of a session without faults.
fn calls_of_a_session() -> usize {
    let folder = project();
    plan(Fault::None, Refusal::Broken);
    let session = session(&fs::canonicalize(folder.path()).unwrap(), false);
    assert_eq!((session.acknowledged, session.refused), (STEPS, 0));
    calls()
}

#[test]
fn whichever_call_fails_nothing_acknowledged_is_lost_and_the_retry_works() {
    let count = calls_of_a_session();
    assert!(count > 60, "{count}");
    let mut refused = 0;
    for failing in 0..count {
        for fault in [Fault::Before(failing), Fault::After(failing)] {
            for refusal in [Refusal::NoSpace, Refusal::Broken] {
                let folder = project();
                plan(fault, refusal);
                let session = session(&fs::canonicalize(folder.path()).unwrap(), true);
                plan(Fault::None, refusal);
                assert_eq!(session.acknowledged, STEPS, "{fault:?}");
                assert!(session.refused <= 1, "{fault:?}");
                refused += session.refused;
                assert_kept(folder.path(), &session, &format!("{fault:?}, {refusal:?}"));
            }
        }
    }
    assert!(
        refused > 2 * count,
        "most failures are said: {refused} of {}",
        4 * count
    );
}

#[test]
fn a_program_that_dies_at_any_call_keeps_what_it_acknowledged() {
    for failing in 0..calls_of_a_session() {
        for fault in [
            Fault::From(failing),
            Fault::Before(failing),
            Fault::After(failing),
        ] {
            let folder = project();
            plan(fault, Refusal::Broken);
            let session = session(&fs::canonicalize(folder.path()).unwrap(), false);
            let left = after_kill(folder.path());
            plan(Fault::None, Refusal::Broken);
            assert_kept(left.path(), &session, &format!("{fault:?}"));
        }
    }
}

#[cfg(unix)]
#[test]
fn a_power_cut_at_any_call_keeps_what_was_acknowledged() {
    for failing in 0..calls_of_a_session() {
        let folder = project();
        plan(Fault::From(failing), Refusal::Broken);
        let session = session(&fs::canonicalize(folder.path()).unwrap(), false);
        let left = after_power_cut();
        plan(Fault::None, Refusal::Broken);
        assert_kept(
            left.path(),
            &session,
            &format!("power cut at call {failing}"),
        );
    }
}

/// Opens the document of a folder, which must be writable.
fn open_to_write(place: &Path) -> (Store, Location) {
    match open(place).unwrap() {
        Opened {
            access: Access::Writable(store),
            location,
            ..
        } => (store, location),
        Opened {
            access: Access::ReadOnly(reason),
            ..
        } => panic!("{reason}"),
    }
}

#[test]
fn after_a_journal_is_lost_nothing_is_acknowledged_before_the_document_is_whole() {
    let states = states();
    let edit = |number: usize| Edit::between(&states[number - 1], &states[number], "Click");
    let mut saved_early = 0;
    for failing in 0..30 {
        let folder = project();
        let place = fs::canonicalize(folder.path()).unwrap();
        let (mut store, location) = open_to_write(&place);
        store.append(&[edit(1)]).unwrap();
        fs::remove_file(location.journal()).unwrap();
        assert!(matches!(
            store.append(&[edit(2)]),
            Err(StoreError::Gone { .. })
        ));
        // The disk is full while the document is written to replace the journal.
        plan(Fault::From(failing), Refusal::NoSpace);
        let saved = store.save(&states[2], &History::default());
        plan(Fault::None, Refusal::NoSpace);
        match store.append(&[edit(3)]) {
            Ok(()) => saved_early += 1,
            Err(error) => {
                assert!(
                    saved.is_err() && matches!(error, StoreError::Gone { .. }),
                    "failing from {failing}: {error}"
                );
                store.save(&states[2], &History::default()).unwrap();
                store.append(&[edit(3)]).unwrap();
            }
        }
        let left = after_kill(&place);
        assert_eq!(
            read(left.path()).unwrap().1.frames,
            states[3].frames,
            "failing from {failing}"
        );
    }
    assert!((1..30).contains(&saved_early), "{saved_early}");
}

#[cfg(unix)]
#[test]
fn a_deleted_lock_is_taken_again_unless_another_program_has_the_document() {
    let folder = project();
    let place = fs::canonicalize(folder.path()).unwrap();
    let (mut store, location) = open_to_write(&place);
    fs::remove_file(location.lock()).unwrap();
    store.save(&start(), &History::default()).unwrap();
    assert!(location.lock().exists());

    fs::remove_file(location.lock()).unwrap();
    let (other, _) = open_to_write(&place);
    let refusal = store.save(&start(), &History::default()).unwrap_err();
    assert!(matches!(refusal, StoreError::ReadOnly { .. }), "{refusal}");
    drop(store);
    assert!(
        location.journal().exists(),
        "it is the other program's by now"
    );
    drop(other);
}

#[test]
fn an_own_version_is_one_file_and_goes_when_the_document_holds_its_edits() {
    let folder = project();
    let place = fs::canonicalize(folder.path()).unwrap();
    let (mut store, location) = open_to_write(&place);
    let ours = fs::read(location.file()).unwrap();
    let mut theirs = start();
    theirs.frames[0].comment = Some("theirs".to_owned());
    fs::write(location.file(), document_to_string(&theirs).unwrap()).unwrap();
    let states = states();
    assert!(store.keep_own(&states[1]).unwrap().is_some());
    // The user takes the click back, and clicks again.
    assert!(store.keep_own(&states[0]).unwrap().is_none());
    assert!(store.keep_own(&states[2]).unwrap().is_some());
    assert_eq!(orphans(&location).len(), 1);
    // The other program puts our version back.
    fs::write(location.file(), ours).unwrap();
    store.save(&states[2], &History::default()).unwrap();
    assert!(orphans(&location).is_empty());
}

#[test]
fn a_journal_that_cannot_be_read_is_not_lost_with_the_document_that_is_replaced() {
    let folder = project();
    let location = Location::find(folder.path()).unwrap();
    fs::write(location.journal(), "edits of a newer program\n").unwrap();
    drop(Store::replace(&location, &start()).unwrap());
    let kept = folder.path().join("project.json.journal.orphan-1");
    assert_eq!(
        fs::read_to_string(kept).unwrap(),
        "edits of a newer program\n"
    );
}
