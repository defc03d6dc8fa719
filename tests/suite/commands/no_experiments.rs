//! `touchline experiment` of a program that was built without the experiments.

use crate::program::touchline;

#[test]
fn how_to_have_the_experiments_is_said_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let ran = touchline(folder.path(), "experiment all --quick -o results");
    assert_eq!((ran.code, ran.stdout.as_str()), (2, ""));
    assert!(
        ran.stderr
            .contains("cargo run --release --features experiments")
            && ran.stderr.lines().count() == 1,
        "{}",
        ran.stderr
    );
    assert!(!folder.path().join("results").exists());
}
