//! `touchline experiment`: what a script can rely on.

use crate::touchline;
use std::collections::BTreeMap;
use std::path::Path;

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    entries
        .map(|path| {
            (
                path.file_name().unwrap().to_string_lossy().into_owned(),
                std::fs::read(&path).unwrap(),
            )
        })
        .collect()
}

#[test]
fn data_figures_and_report_are_written_and_repeat() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["one", "two"] {
        let ran = touchline(
            folder.path(),
            &format!("experiment ransac --quick --seed 4 -o {name}"),
        );
        assert_eq!(ran.code, 0, "{}", ran.stderr);
    }
    let (one, two) = (
        files(&folder.path().join("one")),
        files(&folder.path().join("two")),
    );
    assert!(one.keys().eq(two.keys()));
    for (name, bytes) in one.iter().filter(|(name, _)| !name.contains("-times")) {
        assert_eq!(bytes, &two[name], "{name}");
    }
    let report = String::from_utf8(one["ransac.md"].clone()).unwrap();
    assert!(report.contains("| 4 | 71.36 | 72 | 71 |"), "{report}");
    // Everything that the report shows is there.
    for shown in report
        .match_indices("](")
        .map(|(at, _)| report[at + 2..].split(')').next().unwrap())
    {
        assert!(one.contains_key(shown), "{shown}");
    }
    assert!(one["ransac-table-1.csv"].starts_with(b"points,needed,whole,paper,simulated\n"));
    let json: serde_json::Value = serde_json::from_slice(&one["ransac.json"]).unwrap();
    assert!(json["tables"]["ransac-outliers"].is_array());
    let claims = String::from_utf8(one["claims.csv"].clone()).unwrap();
    let first = claims.lines().nth(1).unwrap();
    assert!(
        first.starts_with("Table 1: RANSAC rounds with 4 points,by formula,number,71,0.5,1,71.3"),
        "{first}"
    );
    assert!(
        first.contains(",confirmed,ransac-table-1,needed,,points=4: 1"),
        "{first}"
    );
    let made_by = &json["made_by"];
    assert_eq!(
        made_by["command"],
        "touchline experiment ransac --quick --seed 4"
    );
    assert_eq!(
        (&made_by["seeds"], &made_by["quick"]),
        (&serde_json::json!([4]), &serde_json::json!(true))
    );
    assert!(report.contains("seed 4. A quick run"), "{report}");
    assert!(
        one["ransac-success.svg"].starts_with(b"<svg ")
            && one["ransac-success.png"].starts_with(b"\x89PNG")
    );

    let refused = touchline(folder.path(), "experiment ransac --quick -o one");
    assert_eq!(refused.code, 2);
    assert!(
        refused.stderr.contains("one already exists; give --force"),
        "{}",
        refused.stderr
    );
}

#[test]
fn wrong_orders_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, named) in [
        (
            "experiment nothing -o out",
            "there is no experiment \"nothing\"; there are synthetic, ransac,",
        ),
        ("experiment highlights -o out --test b.json", "--train"),
        (
            "experiment highlights -o out --train a.json --test b.json",
            "a.json",
        ),
    ] {
        let ran = touchline(folder.path(), arguments);
        assert_eq!(
            (ran.code, ran.stderr.lines().count()),
            (2, 1),
            "{}",
            ran.stderr
        );
        assert!(ran.stderr.contains(named), "{}", ran.stderr);
        assert!(!folder.path().join("out").exists());
    }
}

/// The one experiment that draws frames and is quick enough: a set, its tables with the paper's
/// row, and every frame.
#[test]
fn drawn_games_have_the_papers_row_beside_them_and_every_frame_in_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let ran = touchline(
        folder.path(),
        "experiment worldcup --quick --seeds 1 -o out",
    );
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let out = files(&folder.path().join("out"));
    let report = String::from_utf8(out["worldcup.md"].clone()).unwrap();
    assert!(
        report.contains("| IoU of the whole | paper: IoU ± SD |"),
        "{report}"
    );
    let row = |start: &str| report.lines().find(|line| line.starts_with(start));
    let row = row("| published, BRA–MEX |").unwrap();
    assert!(row.ends_with("| .99 ± .01 |"), "{row}");
    let frames = String::from_utf8(out["worldcup-frames.csv"].clone()).unwrap();
    let mut lines = frames.lines();
    assert!(
        lines
            .next()
            .unwrap()
            .starts_with("way,seed,sequence,frame,view_deg,view,covered,right,wrong,refused,")
    );
    // Nine frames: two forests, with and without their test, without players, and of five
    // references; and three numbers of references for the homography.
    assert_eq!(lines.count(), (2 * 4 + 3) * 9, "{frames}");
    // Each frame is right, wrong or refused, and a refused one has an IoU of 0.
    for row in csv_rows(&out["worldcup-frames.csv"]) {
        let number = |key: &str| row[key].parse::<f64>().unwrap();
        let outcomes = ["right", "wrong", "refused"].map(number);
        assert_eq!(outcomes.iter().sum::<f64>(), 1.0, "{row:?}");
        assert!(
            number("refused") == 0.0 || number("iou_part") == 0.0,
            "{row:?}"
        );
    }
    let rows = csv_rows(&out["worldcup-summary.csv"]);
    assert_eq!(rows.len(), 2 * 3 + 2 * 2 + 3 + 2);
    let all = rows.iter().find(|row| row["method"] == "published, all");
    let counts = ["right", "wrong", "refused"].map(|key| all.unwrap()[key].parse::<u32>().unwrap());
    assert_eq!(counts.iter().sum::<u32>(), 9);
}

/// The rows of a table, by column. Cells in quotes hold commas, never quotes.
fn csv_rows(bytes: &[u8]) -> Vec<BTreeMap<String, String>> {
    let text = std::str::from_utf8(bytes).unwrap();
    let cells = |line: &str| {
        let parts = line.split('"').enumerate();
        let hidden = parts.map(|(number, part)| match number % 2 {
            0 => part.to_owned(),
            _ => part.replace(',', "\u{1}"),
        });
        let cells = hidden.collect::<String>();
        let cells = cells.split(',').map(|cell| cell.replace('\u{1}', ","));
        cells.collect::<Vec<String>>()
    };
    let mut lines = text.lines().map(cells);
    let keys = lines.next().unwrap();
    lines
        .map(|cells| keys.iter().cloned().zip(cells).collect())
        .collect()
}
