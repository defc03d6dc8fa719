//! The checks find what they look for: small crates, each with one thing wrong.

use super::plan::{Plan, broken_fences, circles};
use super::source_map::SourceMap;
use std::path::Path;

const LIB: &str = "\
//! | floor | rooms |
//! |---|---|
//! | 1 | `upper` (uses [`lower`]), [`beside`] |
//! | 0 | [`lower`] |
pub mod beside;
pub mod lower;
pub mod upper;
";

/// A crate of a few files below `src`.
fn map(files: &[(&str, &str)]) -> SourceMap {
    let read = |path: &Path| {
        let wanted = path.strip_prefix("src").unwrap().to_str().unwrap();
        let others = [
            ("lib.rs", LIB),
            ("beside.rs", ""),
            ("lower.rs", ""),
            ("upper.rs", ""),
        ];
        files
            .iter()
            .chain(&others)
            .find(|(name, _)| *name == wanted)
            .map(|(_, text)| (*text).to_owned())
    };
    SourceMap::read(Path::new("src/lib.rs"), &read)
}

fn floors(files: &[(&str, &str)]) -> Vec<String> {
    Plan::read(LIB).broken_floors(&map(files), &[])
}

#[test]
fn a_broken_floor_is_named_with_file_and_line() {
    let broken = floors(&[(
        "lower.rs",
        "//! Text.\nuse std::fmt;\nuse crate::{beside::A, upper};\n",
    )]);
    assert_eq!(
        broken,
        [
            "src/lower.rs:3: lower (floor 0) uses beside (floor 1)",
            "src/lower.rs:3: lower (floor 0) uses upper (floor 1)"
        ]
    );
    assert_eq!(
        floors(&[("upper.rs", "use crate::lower::A;")]),
        [] as [&str; 0]
    );
    for (path, line) in [
        ("fn f() -> crate::upper::A { todo!() }", 1),
        ("fn f() {\n    let a = 1;\n    super::upper::g(a);\n}", 3),
        (
            "fn f() {\n    println!(\"{}\",\n        crate::upper::g());\n}",
            3,
        ),
        ("fn f(a: &[Vec<crate::upper::A>]) {}", 1),
        ("mod inner {\n    use super::super::upper::A;\n}", 2),
        ("fn f() { use crate::upper::A as B; }", 1),
    ] {
        let expected = [format!(
            "src/lower.rs:{line}: lower (floor 0) uses upper (floor 1)"
        )];
        assert_eq!(floors(&[("lower.rs", path)]), expected, "{path}");
    }
}

#[test]
fn modules_for_tests_may_use_more() {
    for text in [
        "#[cfg(test)]\nmod tests { use crate::upper::A; }",
        "#[cfg(all(test, unix))]\nmod tests { use crate::upper::A; }",
        "#[cfg(test)]\nuse crate::upper::A;",
        "#[cfg(test)]\nfn f() { crate::upper::f(); }",
        "// use crate::upper::A;",
    ] {
        assert_eq!(floors(&[("lower.rs", text)]), [] as [&str; 0], "{text}");
    }
    let with_file = [
        ("lower.rs", "#[cfg(test)]\nmod tests;"),
        ("lower/tests.rs", "use crate::upper::A;"),
    ];
    assert_eq!(floors(&with_file), [] as [&str; 0]);
    assert_eq!(
        floors(&[("lower.rs", "#[cfg(not(test))]\nuse crate::upper::A;")]).len(),
        1
    );
}

#[test]
fn rooms_of_one_floor_see_each_other_only_where_it_is_stated() {
    let map = map(&[("upper.rs", "use crate::beside::A;")]);
    let plan = Plan::read(LIB);
    assert_eq!(
        plan.broken_floors(&map, &[]),
        ["src/upper.rs:1: upper (floor 1) uses beside (floor 1)"]
    );
    assert_eq!(
        plan.broken_floors(&map, &[("upper", "beside", "why")]),
        [] as [&str; 0]
    );
    let unneeded = [("upper", "beside", "why"), ("beside", "upper", "why")];
    assert_eq!(
        plan.broken_floors(&map, &unneeded),
        ["beside uses upper: stated, but nothing does"]
    );
}

#[test]
fn a_room_on_paper_only_and_a_room_off_the_plan_are_named() {
    let more = LIB.replace("[`beside`]", "[`attic`]");
    assert_eq!(
        Plan::read(&more).rooms_apart(&map(&[])),
        [
            "src/lib.rs names the room `attic`: there is none",
            "src/lib.rs does not name the room `beside`"
        ]
    );
}

#[test]
fn a_fence_is_seen_through_groups_renames_and_macros() {
    const FS: &[(&[&str], &[&str], &str)] = &[(&["std", "fs"], &["upper"], "why")];
    let within = "use std::fs;";
    for text in [
        "use std::fs;",
        "use std::{fmt, fs::{self, File}};",
        "use std::fs as f;",
        "fn f() { std::fs::read(a); }",
    ] {
        let broken = broken_fences(&[map(&[("upper.rs", within), ("lower.rs", text)])], FS);
        assert!(
            !broken.is_empty()
                && broken
                    .iter()
                    .all(|line| line.starts_with("src/lower.rs:1: std::fs")),
            "{text}"
        );
    }
    let broken = broken_fences(
        &[map(&[
            ("upper.rs", within),
            ("lower.rs", "fn f() { dbg!(std::fs::read(a)); }"),
        ])],
        FS,
    );
    assert_eq!(broken, ["src/lower.rs:1: std::fs::read (why)"]);
    assert_eq!(
        broken_fences(&[map(&[("upper.rs", "use std::io;")])], FS),
        ["src/upper may name std::fs, but does not"]
    );
}

#[test]
fn a_circle_is_found_behind_re_exports_and_told_once() {
    let files = [
        (
            "lower.rs",
            "mod a;\nmod b;\nmod c;\npub use a::A;\npub use b::*;",
        ),
        ("lower/a.rs", "use super::B;\npub struct A;"),
        ("lower/b.rs", "use super::c::C;\npub struct B;"),
        ("lower/c.rs", "use crate::lower::A;\npub struct C;"),
    ];
    assert_eq!(
        circles(&map(&files)),
        ["circle: lower::a, lower::b, lower::c\
          \n    src/lower/a.rs:1 names lower::B\
          \n    src/lower/b.rs:1 names lower::c::C\
          \n    src/lower/c.rs:1 names lower::A"]
    );
    let open = files.map(|(name, text)| {
        (
            name,
            if name == "lower/c.rs" {
                "pub struct C;"
            } else {
                text
            },
        )
    });
    assert_eq!(circles(&map(&open)), [] as [&str; 0]);
}

#[test]
fn a_module_and_what_it_is_made_of_are_no_circle() {
    let files = [
        ("lower.rs", "mod a;\npub struct L;\npub fn f() { a::g(); }"),
        ("lower/a.rs", "use super::L;\npub fn g() {}"),
    ];
    assert_eq!(circles(&map(&files)), [] as [&str; 0]);
}
