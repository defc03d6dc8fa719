//! The committed report on the paper: its page and its files say the same.

use std::path::Path;

/// A line of CSV as cells (RFC 4180; no cell of these files has a line break).
fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    for letter in line.chars() {
        match letter {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            letter => cells.last_mut().unwrap().push(letter),
        }
    }
    cells
}

#[test]
fn every_statement_on_the_page_has_the_verdict_of_the_file() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../experiments");
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let (page, claims) = (read("README.md"), read("claims.csv"));
    let mut lines = claims.lines();
    let keys = cells(lines.next().unwrap());
    let mut before = String::new();
    let mut statements = 0;
    for line in lines {
        let row = cells(line);
        let cell = |key: &str| &row[keys.iter().position(|other| other == key).unwrap()];
        let (stated, verdict) = (cell("stated"), cell("verdict"));
        let start = format!("| {stated} (");
        let shown = page.lines().find(|line| line.starts_with(&start));
        let shown = shown.unwrap_or_else(|| panic!("no row of {stated}"));
        let columns: Vec<&str> = shown.split(" | ").collect();
        // The first measurement of a statement decides, the others stand beside it.
        if *stated == before {
            let beside = format!("{}: ", cell("on"));
            let beside = columns[5]
                .split("; ")
                .find(|part| part.starts_with(&beside));
            assert!(beside.unwrap().ends_with(verdict.as_str()), "{shown}");
        } else {
            statements += 1;
            assert!(columns[2].starts_with(cell("on").as_str()), "{shown}");
            assert_eq!(columns[3], cell("samples"), "{shown}");
            assert_eq!(columns[4].trim_matches('*'), verdict, "{shown}");
        }
        before.clone_from(stated);
    }
    assert!(statements > 10, "{statements}");
    assert!(page.contains(&format!("\n{} statements", count_of_rows(&page))));
}

/// Number of rows of the page's first table, without its two lines of headings.
fn count_of_rows(page: &str) -> usize {
    let table = page.lines().skip_while(|line| !line.starts_with("| "));
    table.take_while(|line| line.starts_with('|')).count() - 2
}
