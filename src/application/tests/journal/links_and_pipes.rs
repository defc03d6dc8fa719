//! Links, pipes and folders in place of the files of a project.

use super::{click, document, new_project};
use std::fs;
use std::path::Path;
use std::process::Command;
use touchline_documents::document::History;
use touchline_documents::store::{Access, Location, Opened, Store, open, read, write_document};

/// What a received project may hold in place of the program's own files, and a file of the user's
/// behind a link.
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
