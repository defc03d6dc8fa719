//! The steps beside a saved document: what is read again is what there was, whatever happened to
//! the files.

use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use touchline_core::geometry::ImageSize;
use touchline_documents::document::{
    Camera, Document, Edit, EditKind, History, Step, document_to_string,
};
use touchline_documents::store::{Access, HistoryLeftOut, Location, Opened, Recovery, Store, open};
use touchline_documents::testing::{new_frame, soccer_document};

const SIZE: ImageSize = ImageSize::new(1280, 720);

fn new_document(frames: usize) -> Document {
    let mut document = soccer_document();
    let frame = |index| new_frame(&format!("images/{index:04}.jpg"), SIZE).into();
    document.frames.extend((0..frames).map(frame));
    document
}

/// A document that is open in a store, changed as the application changes it.
struct Editor {
    store: Store,
    document: Document,
    history: History<Document>,
    recovery: Recovery,
}

impl Editor {
    fn open(path: &Path) -> Self {
        match open(path).unwrap() {
            Opened {
                document,
                history,
                access: Access::Writable(store),
                recovery,
                ..
            } => Self {
                store,
                document,
                history,
                recovery,
            },
            read_only => panic!("{read_only:?}"),
        }
    }

    fn create(frames: usize) -> (TempDir, PathBuf, Self) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("match");
        let location = Location::for_new_document(&path.join("")).unwrap();
        drop(Store::create(&location, &new_document(frames)).unwrap());
        let editor = Self::open(&path);
        (folder, path, editor)
    }

    fn journal(&mut self, before: &Document, name: &str, kind: EditKind) {
        self.document.count_edits_since(before);
        let edit = Edit::between(before, &self.document, name).with_kind(kind);
        if !edit.is_empty() {
            self.store.append(&[edit]).unwrap();
        }
    }

    fn step(&mut self, name: &str, change: impl FnOnce(&mut Document)) {
        let before = self.document.clone();
        self.history.begin(&self.document, Step::on_document(name));
        self.finish(&before, name, change);
    }

    /// Goes on with the last step, if there is one.
    fn go_on(&mut self, change: impl FnOnce(&mut Document)) {
        let before = self.document.clone();
        let Some(step) = self.history.next_undo().cloned() else {
            return;
        };
        assert!(self.history.resume(&before, &step));
        self.finish(&before, &step.name, change);
    }

    fn finish(&mut self, before: &Document, name: &str, change: impl FnOnce(&mut Document)) {
        change(&mut self.document);
        let kind = self.history.open_kind();
        self.history.commit(&self.document);
        self.journal(before, name, kind);
    }

    fn undo(&mut self) {
        let before = self.document.clone();
        if self.history.undo(&mut self.document).is_some() {
            self.journal(&before, "Undone", EditKind::Undone);
        }
    }

    fn redo(&mut self) {
        let before = self.document.clone();
        if self.history.redo(&mut self.document).is_some() {
            self.journal(&before, "Redone", EditKind::Redone);
        }
    }

    fn save(&mut self) {
        self.store.save(&self.document, &self.history).unwrap();
    }

    fn comment(&mut self, frame: usize, text: &str) {
        self.step(text, |document| {
            document.frames[frame].comment = Some(text.to_owned());
        });
    }
}

#[derive(Clone, Copy, Debug)]
enum EditorEvent {
    Comment(usize, u8),
    GoOn(usize, u8),
    Reorder,
    Remove(usize),
    Add(u8),
    Camera(u8),
    Field(u8),
    Undo,
    Redo,
    Save,
    /// The program ends without saving: the journal is left.
    Restart,
}

fn doing() -> impl Strategy<Value = EditorEvent> {
    prop_oneof![
        3 => (0usize..5, 0u8..3).prop_map(|(frame, text)| EditorEvent::Comment(frame, text)),
        2 => (0usize..5, 0u8..3).prop_map(|(frame, text)| EditorEvent::GoOn(frame, text)),
        1 => Just(EditorEvent::Reorder),
        1 => (0usize..5).prop_map(EditorEvent::Remove),
        1 => (0u8..9).prop_map(EditorEvent::Add),
        1 => (0u8..3).prop_map(EditorEvent::Camera),
        1 => (0u8..3).prop_map(EditorEvent::Field),
        4 => Just(EditorEvent::Undo),
        3 => Just(EditorEvent::Redo),
        2 => Just(EditorEvent::Save),
        2 => Just(EditorEvent::Restart),
    ]
}

fn set_comment(document: &mut Document, frame: usize, text: u8) {
    let frames = document.frames.len();
    if frames > 0 {
        document.frames[frame % frames].comment = Some(text.to_string());
    }
}

fn obey(mut editor: Editor, path: &Path, doing: EditorEvent) -> Editor {
    match doing {
        EditorEvent::Comment(frame, text) => {
            editor.step("Comment", |document| set_comment(document, frame, text));
        }
        EditorEvent::GoOn(frame, text) => {
            editor.go_on(|document| set_comment(document, frame, text));
        }
        EditorEvent::Reorder => editor.step("Reorder", |document| {
            document.frames = document.frames.iter().rev().cloned().collect();
        }),
        EditorEvent::Remove(frame) => editor.step("Remove", |document| {
            document.frames.remove(frame);
        }),
        EditorEvent::Add(name) => editor.step("Add", |document| {
            document
                .frames
                .insert(1, new_frame(&name.to_string(), SIZE).into());
        }),
        EditorEvent::Camera(name) => editor.step("Camera", |document| {
            document.cameras = vec![Camera::new(name.to_string().as_str().into(), SIZE).into()];
        }),
        EditorEvent::Field(length) => editor.step("Field", |document| {
            document
                .field
                .params
                .insert("length_m".to_owned(), 100.0 + f64::from(length));
        }),
        EditorEvent::Undo => editor.undo(),
        EditorEvent::Redo => editor.redo(),
        EditorEvent::Save => editor.save(),
        EditorEvent::Restart => {
            let Editor {
                store,
                document,
                history,
                ..
            } = editor;
            drop(store);
            editor = Editor::open(path);
            assert_eq!(editor.document, document);
            assert_eq!(editor.history, history);
            assert_eq!(editor.recovery.history, None);
        }
    }
    editor
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]
    #[test]
    fn what_can_be_undone_and_redone_is_the_same_after_a_restart(all in prop::collection::vec(doing(), 1..40)) {
        let (_folder, path, mut editor) = Editor::create(3);
        for doing in all.into_iter().chain([EditorEvent::Restart]) {
            editor = obey(editor, &path, doing);
        }
    }
}

#[test]
fn a_step_that_goes_on_and_changes_nothing_more_keeps_what_can_be_redone() {
    let (_folder, path, mut editor) = Editor::create(3);
    for doing in [
        EditorEvent::Comment(1, 2),
        EditorEvent::Comment(2, 0),
        EditorEvent::Comment(0, 0),
        EditorEvent::Undo,
        EditorEvent::GoOn(1, 2),
        EditorEvent::Restart,
        EditorEvent::Redo,
    ] {
        editor = obey(editor, &path, doing);
    }
    assert_eq!(editor.document.frames[0].comment.as_deref(), Some("0"));
}

#[test]
fn a_crash_between_the_history_and_its_document_loses_no_step() {
    let (_folder, path, mut editor) = Editor::create(3);
    for text in ["1", "2", "3"] {
        editor.comment(0, text);
    }
    editor.save();
    editor.comment(1, "4");
    editor.undo();
    let backup = Location::find(&path).unwrap().backup();
    fs::remove_file(&backup).unwrap();
    fs::create_dir(&backup).unwrap();
    for more in ["5", "6"] {
        // The history is written, the document is not.
        assert!(
            editor
                .store
                .save(&editor.document, &editor.history)
                .is_err()
        );
        let Editor {
            store,
            document,
            history,
            ..
        } = editor;
        drop(store);
        editor = Editor::open(&path);
        assert_eq!((&editor.document, &editor.history), (&document, &history));
        assert_eq!(editor.recovery.history, None);
        editor.comment(2, more);
    }
    fs::remove_dir(&backup).unwrap();
    editor.save();
    drop(editor);
    let editor = Editor::open(&path);
    assert_eq!(
        (
            editor.history.next_undo().unwrap().name.as_str(),
            editor.recovery.message()
        ),
        ("6", None)
    );
}

#[test]
fn a_damaged_history_is_left_out_and_the_document_is_as_it_was() {
    let (_folder, path, mut editor) = Editor::create(3);
    for text in ["1", "2", "3"] {
        editor.comment(0, text);
    }
    editor.undo();
    editor.save();
    let (document, written) = (
        editor.document.clone(),
        document_to_string(&editor.document).unwrap(),
    );
    drop(editor);
    let history = Location::find(&path).unwrap().history();
    let bytes = fs::read(&history).unwrap();
    let mut damaged: Vec<Vec<u8>> = Vec::new();
    for place in 0..50 {
        let at = place * bytes.len() / 50;
        damaged.push(bytes[..at].to_vec());
        let mut flipped = bytes.clone();
        flipped[at] ^= 0x10;
        damaged.push(flipped);
    }
    damaged.push(b"\xff\0nonsense\n".to_vec());
    damaged.push(b"{\"history\":[]}".to_vec());
    damaged.push([&bytes[..], b"more"].concat());
    for (case, bytes) in damaged.into_iter().enumerate() {
        fs::write(&history, bytes).unwrap();
        let editor = Editor::open(&path);
        assert_eq!(
            (&editor.document, editor.history.is_empty()),
            (&document, true),
            "case {case}"
        );
        assert_eq!(
            editor.recovery.history,
            Some(HistoryLeftOut::Damaged),
            "case {case}"
        );
        let notice = "Steps of earlier sessions cannot be undone: their file is damaged.";
        assert_eq!(
            editor.recovery.message().as_deref(),
            Some(notice),
            "case {case}"
        );
        drop(editor);
        assert_eq!(
            fs::read_to_string(path.join("project.json")).unwrap(),
            written,
            "case {case}"
        );
    }
    // The next save writes a whole one again.
    let mut editor = Editor::open(&path);
    editor.comment(2, "new");
    editor.save();
    drop(editor);
    let editor = Editor::open(&path);
    assert_eq!(
        (
            editor.history.next_undo().unwrap().name.as_str(),
            editor.recovery.message()
        ),
        ("new", None)
    );
}

#[test]
fn a_history_of_another_document_is_left_out() {
    let (_folder, path, mut editor) = Editor::create(3);
    editor.comment(0, "1");
    editor.save();
    drop(editor);
    let (_other_folder, other_path, mut other) = Editor::create(3);
    other.comment(1, "2");
    other.save();
    drop(other);
    let history = |path: &Path| Location::find(path).unwrap().history();
    fs::copy(history(&other_path), history(&path)).unwrap();
    let mut editor = Editor::open(&path);
    assert_eq!(editor.recovery.history, Some(HistoryLeftOut::OtherDocument));
    assert!(editor.history.is_empty());
    // Steps from here on are kept.
    editor.comment(2, "3");
    editor.save();
    drop(editor);
    let editor = Editor::open(&path);
    assert_eq!(
        (
            editor.history.next_undo().unwrap().name.as_str(),
            editor.recovery.message()
        ),
        ("3", None)
    );
}

#[test]
fn an_edit_that_is_no_step_ends_the_history() {
    let (_folder, path, mut editor) = Editor::create(3);
    editor.comment(0, "1");
    editor.save();
    let before = editor.document.clone();
    editor.document.frames[1].comment = Some("2".to_owned());
    editor.journal(&before, "No step", EditKind::NoStep);
    editor.comment(2, "3");
    drop(editor);
    let mut editor = Editor::open(&path);
    assert_eq!(editor.recovery.edits, ["No step", "3"]);
    editor.undo();
    assert!(editor.document.frames[2].comment.is_none() && editor.history.next_undo().is_none());
}

#[cfg(unix)]
#[test]
fn what_is_no_regular_file_in_its_place_is_neither_read_nor_written() {
    for how in ["link", "folder"] {
        let (folder, path, mut editor) = Editor::create(2);
        let (history, victim) = (
            Location::find(&path).unwrap().history(),
            folder.path().join("precious"),
        );
        fs::write(&victim, "precious").unwrap();
        match how {
            "link" => std::os::unix::fs::symlink(&victim, &history).unwrap(),
            _ => fs::create_dir(&history).unwrap(),
        }
        editor.comment(0, "1");
        editor.save();
        drop(editor);
        let editor = Editor::open(&path);
        assert_eq!(
            editor.document.frames[0].comment.as_deref(),
            Some("1"),
            "{how}: the document is saved"
        );
        let message = editor.recovery.message().unwrap();
        assert!(message.contains("not a regular file"), "{how}: {message}");
        assert!(editor.history.is_empty());
        assert_eq!(fs::read_to_string(&victim).unwrap(), "precious", "{how}");
    }
}

#[test]
fn the_file_grows_with_the_edits_and_not_with_the_document() {
    let bytes = |frames: usize| {
        let (_folder, path, mut editor) = Editor::create(frames);
        for number in 0..600 {
            editor.comment(number % 50, &format!("{number:03}"));
        }
        editor.save();
        let steps = editor.history.undo_edits(&editor.document).count();
        assert_eq!(steps, History::<Document>::DEFAULT_LIMIT);
        fs::metadata(Location::find(&path).unwrap().history())
            .unwrap()
            .len()
    };
    let (few, many) = (bytes(50), bytes(2000));
    assert_eq!(few, many);
    assert!(few < 500 * 400, "{few} bytes");
}
