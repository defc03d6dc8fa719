//! Every command of the palette: what changes the document is undone to the same bytes and redone
//! to the same bytes, also after the window was closed or killed; the others leave it alone.

pub mod documents;
mod meanwhile;
pub mod scene;
mod table;

use crate::bench::Bench;
use scene::Scene;
use std::panic::{AssertUnwindSafe, catch_unwind};
use table::{Change, Plan, plan};
use touchline_application::app::{Action, Command};

/// A command that does not change the document leaves its bytes and its history, whatever document
/// is open.
#[test]
fn commands_that_do_not_change_the_document_leave_it_as_it_is() {
    let documents = [
        documents::demo(),
        documents::suggested(),
        documents::video(),
    ];
    for command in Command::all().filter(|command| matches!(plan(*command), Plan::Keeps)) {
        for document in &documents {
            let mut bench = Bench::new(document.clone());
            let bytes = |bench: &Bench| scene::bytes(&bench.app);
            let before = bytes(&bench);
            bench.act(Action::Command(command));
            assert_eq!(bytes(&bench), before, "{command:?}");
            let history = &bench.app.open().unwrap().history;
            assert_eq!(history.num_done(), 0, "{command:?}");
        }
    }
}

#[test]
fn undo_of_every_command_gives_back_what_was_there() {
    let mut failed = Vec::new();
    for command in Command::all() {
        let Plan::Changes(change) = plan(command) else {
            continue;
        };
        // Whatever one command does, the others are tried, too.
        let checked = catch_unwind(AssertUnwindSafe(|| check(command, &change)));
        match checked {
            Ok(Ok(())) => {}
            Ok(Err(why)) => {
                eprintln!("{command:?}: {why}");
                failed.push(format!("{command:?}: {why}"));
            }
            Err(_) => failed.push(format!("{command:?}: see the panic above")),
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}

/// Does it, undoes it and redoes it: at once, after a kill, and after the window was closed on
/// either side of it.
fn check(command: Command, change: &Change) -> Result<(), String> {
    let mut scene = Scene::open(&(change.document)(), change.holds);
    (change.prepare)(&mut scene);
    scene.settle();
    let (before, steps) = (scene.bytes(), scene.steps());
    if let Some(why) = scene.window.app.why_not(command) {
        return Err(format!("not available: {why}"));
    }
    (change.make)(&mut scene);
    scene.settle();
    let after = scene.bytes();
    if after == before {
        return Err(format!("changes nothing: {:?}", scene.last_notice()));
    }
    if scene.steps() != steps + 1 {
        return Err(format!("{} steps of undo", scene.steps() - steps));
    }
    scene.expect(Command::Undo, &before, "undo")?;
    scene.expect(Command::Redo, &after, "redo")?;
    let mut killed = scene.kill();
    killed.is(&after, "killed and opened again")?;
    killed.expect(Command::Undo, &before, "undo after a kill")?;
    killed.expect(Command::Redo, &after, "redo after a kill")?;
    let mut closed = scene.close();
    closed.is(&after, "closed and opened again")?;
    closed.expect(Command::Undo, &before, "undo after closing")?;
    let mut closed = closed.close();
    closed.is(&before, "closed after undo and opened again")?;
    closed.expect(Command::Redo, &after, "redo after closing")
}
