//! Edits between two states of a document: each leads from the one to the other, and a second time
//! it is refused.
#![no_main]

use arbitrary::Arbitrary;
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;
use touchline::document::{Click, Document, Edit, EditMismatch, Frame, document_from_bytes, document_to_string};
use touchline::geometry::{ImagePoint, ImageSize};
use touchline_fuzz::run_in_bounds;

static DOCUMENT: LazyLock<Document> = LazyLock::new(|| {
    document_from_bytes(include_bytes!("../../../src/documents/tests/samples/document-v1.json")).expect("the document is read")
});

/// What a person or a program does to a document.
#[derive(Debug, Arbitrary)]
enum Deed {
    Comment { frame: u8, comment: Option<String> },
    Click { frame: u8, landmark: String, at: [i16; 2] },
    Unclick { frame: u8 },
    Gold { frame: u8, gold: bool },
    Add { before: u8, image: String },
    Remove { frame: u8 },
    Swap { frames: [u8; 2] },
    Crown { crown_cm: i8 },
    DropCameras,
}

fn done(document: &mut Document, deed: Deed) {
    let place = |frame: u8| usize::from(frame) % document.frames.len().max(1);
    match deed {
        Deed::Comment { frame, comment } => {
            let place = place(frame);
            document.frames.get_mut(place).map(|frame| frame.comment = comment);
        }
        Deed::Click { frame, landmark, at: [x, y] } => {
            let place = place(frame);
            let click =
                Click::landmark(landmark.as_str().into(), ImagePoint::new(f64::from(x) / 8.0, f64::from(y) / 8.0));
            document.frames.get_mut(place).map(|frame| frame.clicks.push(click));
        }
        Deed::Unclick { frame } => {
            let place = place(frame);
            document.frames.get_mut(place).map(|frame| frame.clicks.pop());
        }
        Deed::Gold { frame, gold } => {
            let place = place(frame);
            document.frames.get_mut(place).map(|frame| frame.gold = gold);
        }
        Deed::Add { before, image } => {
            let place = place(before);
            document.frames.insert(place, Frame::from_image(&image, "main".into(), ImageSize::new(64, 48)).into());
        }
        Deed::Remove { frame } => {
            let place = place(frame);
            document.frames.remove(place);
        }
        Deed::Swap { frames: [one, other] } => {
            let places = [place(one), place(other)];
            let frames: Option<Vec<_>> = places.iter().map(|&place| document.frames.get(place).cloned()).collect();
            if let Some([one, other]) = frames.as_deref() {
                document.frames[places[0]] = other.clone();
                document.frames[places[1]] = one.clone();
            }
        }
        Deed::Crown { crown_cm } => {
            document.field.params.insert("crown_m".to_owned(), f64::from(crown_cm) / 100.0);
        }
        Deed::DropCameras => document.cameras.clear(),
    }
}

fuzz_target!(|deeds: (Vec<Deed>, Vec<Deed>)| {
    let mut before = DOCUMENT.clone();
    for deed in deeds.0.into_iter().take(40) {
        done(&mut before, deed);
    }
    let mut after = before.clone();
    for deed in deeds.1.into_iter().take(40) {
        done(&mut after, deed);
    }
    after.count_edits_since(&before);
    let edit = run_in_bounds(&[], || Edit::between(&before, &after, "Edit"));
    let text = serde_json::to_string(&edit).expect("an edit is written");
    let read: Edit = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(read, edit, "an edit is read as it was written");
    let mut made = before.clone();
    read.apply(&mut made).unwrap_or_else(|mismatch| panic!("{mismatch}\n{text}"));
    assert_eq!(made, after, "{text}");
    let is_same = |frame: &Frame| after.frames.by_id(&frame.id).is_some_and(|other| **other == *frame);
    if !before.frames.iter().all(|frame| is_same(frame)) {
        let again = edit.apply(&mut made);
        let is_refused = matches!(again, Err(EditMismatch::Revision { .. } | EditMismatch::NoFrame { .. }));
        assert!(is_refused, "a second time: {again:?}\n{text}");
        assert_eq!(made, after, "what is refused changes nothing");
    }
    document_to_string(&made).expect("an edited document is written");
});
