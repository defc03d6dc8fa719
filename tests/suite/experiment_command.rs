//! `touchline experiment`: what a script can rely on.

use crate::program::touchline;
use std::collections::BTreeMap;
use std::path::Path;

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(&path).unwrap()))
        .collect()
}

#[test]
fn data_figures_and_report_are_written_and_repeat() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["one", "two"] {
        let ran = touchline(folder.path(), &format!("experiment ransac --quick --seed 4 -o {name}"));
        assert_eq!(ran.code, 0, "{}", ran.stderr);
    }
    let (one, two) = (files(&folder.path().join("one")), files(&folder.path().join("two")));
    assert!(one.keys().eq(two.keys()));
    for (name, bytes) in one.iter().filter(|(name, _)| !name.contains("-times")) {
        assert_eq!(bytes, &two[name], "{name}");
    }
    let report = String::from_utf8(one["ransac.md"].clone()).unwrap();
    assert!(report.contains("| 4 | 71.36 | 72 | 71 |"), "{report}");
    // Everything that the report shows is there.
    for shown in report.match_indices("](").map(|(at, _)| report[at + 2..].split(')').next().unwrap()) {
        assert!(one.contains_key(shown), "{shown}");
    }
    assert!(one["ransac-table-1.csv"].starts_with(b"points,needed,whole,paper,simulated\n"));
    assert!(
        serde_json::from_slice::<serde_json::Value>(&one["ransac.json"]).unwrap()["tables"]["ransac-outliers"]
            .is_array()
    );
    assert!(one["ransac-success.svg"].starts_with(b"<svg ") && one["ransac-success.png"].starts_with(b"\x89PNG"));

    let refused = touchline(folder.path(), "experiment ransac --quick -o one");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("one already exists; give --force"), "{}", refused.stderr);
}

#[test]
fn wrong_orders_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, named) in [
        ("experiment nothing -o out", "there is no experiment \"nothing\"; there are synthetic, ransac,"),
        ("experiment highlights -o out --test b.json", "--train"),
        ("experiment highlights -o out --train a.json --test b.json", "a.json"),
    ] {
        let ran = touchline(folder.path(), arguments);
        assert_eq!((ran.code, ran.stderr.lines().count()), (2, 1), "{}", ran.stderr);
        assert!(ran.stderr.contains(named), "{}", ran.stderr);
        assert!(!folder.path().join("out").exists());
    }
}
