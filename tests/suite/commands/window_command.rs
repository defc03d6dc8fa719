//! `touchline [DOCUMENT]` where no window can open.

use crate::program::touchline;

#[test]
fn a_word_that_is_neither_file_nor_command_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let no_file = if cfg!(feature = "gui") {
        "match.mp4: neither a file or folder nor a command"
    } else {
        "built without the window"
    };
    for (word, expected) in [
        ("match.mp4", no_file),
        ("sovle", "`touchline solve` may be meant"),
    ] {
        let ran = touchline(folder.path(), word);
        assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{word}");
        assert!(
            ran.stderr.contains(expected) && ran.stderr.lines().count() == 1,
            "{}",
            ran.stderr
        );
    }
}
