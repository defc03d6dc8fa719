//! `touchline experiment` where the laboratory was not built.

use crate::program::touchline;

#[test]
fn how_to_have_the_laboratory_is_said_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let ran = touchline(folder.path(), "experiment all --quick -o results");
    assert_eq!((ran.code, ran.stdout.as_str()), (2, ""));
    assert!(
        ran.stderr.contains("`make experiments`") && ran.stderr.lines().count() == 1,
        "{}",
        ran.stderr
    );
    assert!(!folder.path().join("results").exists());
}
