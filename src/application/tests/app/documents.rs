//! Opening, saving and closing; and any command at any time.

use super::document;
use crate::bench::Bench;
use touchline_application::app::session::{Dialog, Leaving, Level, Saving};
use touchline_application::app::{
    Action, App, Command, DiskReport, EditAction, Effect, Opened, PointerAction, Settings,
};
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::RejectReason;

#[test]
fn a_document_to_look_at_only_stays_as_it_is() {
    let mut bench = Bench::new(document(2, true));
    let mut opened = Opened::new(document(2, true), "/nowhere/project.json");
    opened.read_only = Some("another program has it open".into());
    opened.notices = vec![(Level::Warning, "3 edits recovered.".into())];
    bench.act(Action::Opened(Box::new(opened)));
    bench.effects.clear();
    bench.click(ImagePoint::new(500.0, 500.0));
    bench.act(Action::Edit(EditAction::SetComment("no".into())));
    assert_eq!(*bench.app.open().unwrap().document, document(2, true));
    assert!(bench.effects.is_empty());
    bench.assert_notice("another program has it open");
}

#[test]
fn escape_gives_up_what_is_being_opened() {
    let mut bench = Bench::new(document(1, true));
    bench.act(Action::Open("/match.mp4".into()));
    bench.act(Action::Disk(DiskReport::Progress(
        "Counting frames: 500…".into(),
    )));
    assert_eq!(
        bench.app.session.disk.opening.as_deref(),
        Some("Counting frames: 500…")
    );
    bench.command(Command::Cancel);
    assert!(bench.effects.contains(&Effect::CancelOpening));
    assert_eq!(bench.app.session.disk.opening, None);
    bench.act(Action::Disk(DiskReport::Progress(
        "Counting frames: 600…".into(),
    )));
    assert_eq!(
        bench.app.session.disk.opening, None,
        "a late word brings nothing back"
    );
}

#[test]
fn closing_waits_until_everything_is_on_disk() {
    let mut bench = Bench::new(document(1, true));
    bench.place("centre_mark");
    bench.effects.clear();
    bench.act(Action::CloseRequested);
    let [Effect::Save { request }] = bench.effects[..] else {
        panic!("{:?}", bench.effects)
    };
    let revision = bench.app.open().unwrap().revision;
    bench.act(Action::Disk(DiskReport::Saved {
        revision: revision - 1,
        at: "1".into(),
        document: Some(request),
    }));
    assert!(!bench.effects.contains(&Effect::Close));
    // A write of before the request says nothing of what another program has done since.
    bench.act(Action::Disk(DiskReport::Saved {
        revision,
        at: "1".into(),
        document: Some(request - 1),
    }));
    assert!(!bench.effects.contains(&Effect::Close));
    bench.act(Action::Disk(DiskReport::Saved {
        revision,
        at: "2".into(),
        document: Some(request),
    }));
    assert!(bench.effects.contains(&Effect::Close));
}

#[test]
fn a_full_disk_is_said_and_edits_are_lost_only_by_saying_so() {
    let mut bench = Bench::new(document(1, true));
    bench.place("centre_mark");
    bench.act(Action::Disk(DiskReport::SaveFailed("disk full".into())));
    bench.effects.clear();
    bench.act(Action::CloseRequested);
    assert!(!bench.effects.contains(&Effect::Close));
    bench.act(Action::Disk(DiskReport::SaveFailed("disk full".into())));
    assert!(
        matches!(&bench.app.session.disk.saving, Saving::Failed { message, .. } if message == "disk full")
    );
    for _ in 0..2 {
        bench.act(Action::CloseRequested);
        assert!(!bench.effects.contains(&Effect::Close));
        assert_eq!(
            bench.app.session.dialog,
            Some(Dialog::NotSaved(Leaving::Close))
        );
    }
    bench.act(Action::LeaveUnsaved);
    assert!(bench.effects.contains(&Effect::Close));
}

#[test]
fn every_command_can_be_requested_at_any_time() {
    for document in [
        None,
        Some(document(0, true)),
        Some(document(3, false)),
        Some(document(3, true)),
    ] {
        let mut app = App::new(Settings::default());
        if let Some(document) = document {
            app.update(Action::Opened(Box::new(Opened::new(
                document,
                "/nowhere/project.json",
            ))));
        }
        for first in Command::all() {
            for second in Command::all() {
                app.update(Action::Command(first));
                app.update(Action::Command(second));
                app.update(Action::Pointer(PointerAction::Press {
                    at: ImagePoint::new(9.0, 9.0),
                    on: Some(7),
                }));
                app.update(Action::Pointer(PointerAction::Drag(ImagePoint::new(
                    f64::NAN,
                    9.0,
                ))));
                app.update(Action::Pointer(PointerAction::Release));
                app.update(Action::Edit(EditAction::TakeName(3)));
                app.update(Action::Edit(EditAction::RejectAs(RejectReason::Blur)));
                app.update(Action::Command(Command::Cancel));
            }
        }
    }
}
