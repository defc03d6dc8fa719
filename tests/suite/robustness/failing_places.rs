//! Places that take nothing or are no more: what is wrong is said with a way out. Full disks are
//! tried by `.ci/reliability`.
#![cfg(target_os = "linux")]

use crate::program::touchline;
use std::os::unix::fs::symlink;
use std::process::Command;

const DEMO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/projects/demo");

#[test]
fn a_full_place_is_named_with_a_way_out() {
    let folder = tempfile::tempdir().unwrap();
    symlink("/dev/full", folder.path().join("full.svg")).unwrap();
    for (command, place) in [
        (
            format!("export {DEMO} --format csv -o /dev/full --force"),
            "/dev/full",
        ),
        (format!("solve {DEMO} -o /dev/full --force"), "/dev/full"),
        (
            "fields tennis --render full.svg --force".to_owned(),
            "full.svg",
        ),
    ] {
        let ran = touchline(folder.path(), &command);
        assert_eq!(ran.code, 2, "{command}: {}", ran.stderr);
        let reason = "No space left on device (os error 28); free some space, or save elsewhere";
        assert!(
            ran.stderr
                .ends_with(&format!("cannot write {place}: {reason}\n")),
            "{command}: {}",
            ran.stderr
        );
    }
}

#[test]
fn a_working_folder_that_was_removed_is_told_apart_from_a_missing_document() {
    let folder = tempfile::tempdir().unwrap();
    let program = env!("CARGO_BIN_EXE_touchline");
    for (arguments, place) in [
        (format!("solve {DEMO} -o out.json"), "."),
        ("check doc.json".to_owned(), "doc.json"),
    ] {
        let script =
            format!("mkdir gone && cd gone && rmdir ../gone && exec {program} {arguments}");
        let ran = Command::new("sh")
            .args(["-c", &script])
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert_eq!(ran.status.code(), Some(2));
        let wanted = format!(
            "touchline: cannot find {place}: the folder that the program was started in was removed; start it in another one\n"
        );
        let said = String::from_utf8(ran.stderr).unwrap();
        assert!(said.ends_with(&wanted), "{arguments}: {said}");
    }
}
