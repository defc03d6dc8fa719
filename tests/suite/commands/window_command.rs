//! `touchline [DOCUMENT]` where no window can open.

use crate::program::touchline;

#[test]
fn a_word_that_is_neither_file_nor_command_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let ran = touchline(folder.path(), "sovle");
    assert_eq!((ran.code, ran.stdout.as_str()), (2, ""));
    let expected = if cfg!(feature = "gui") {
        "sovle: neither a file or folder nor a command"
    } else {
        "built without the window"
    };
    assert!(
        ran.stderr.contains(expected) && ran.stderr.lines().count() == 1,
        "{}",
        ran.stderr
    );
}
