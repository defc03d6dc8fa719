//! The program is killed at random moments, by a scripted person and in its commands: nothing that
//! was acknowledged is lost, and no result is half a one. `TOUCHLINE_KILLS=1000` makes more of it;
//! each kill follows from its number.
#![cfg(feature = "opencv")]

use crate::drawn::drawn_match;
use crate::headless::Headless;
use crate::program::touchline;
use rand::RngExt;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use touchline::app::session::Saving;
use touchline::app::{Action, Command as Do, EditAction, Navigation};
use touchline::document::{Document, FrameStatus, RejectReason};
use touchline::media::sha256_of_file;
use touchline::relocalize::ForestModel;
use touchline::store::read;
use touchline_core::testing::child::spawn_test;
use touchline_core::testing::seeded::rng;

const CHILD: &str = "TOUCHLINE_TEST_RANDOM_KILLS";

/// How often each is killed.
fn kills() -> usize {
    let all =
        std::env::var("TOUCHLINE_KILLS").map_or(14, |number| number.parse::<usize>().unwrap());
    all.div_ceil(2)
}

/// What people did to a document; what is proposed is not theirs.
fn done_in(document: &Document) -> String {
    let frame = |frame: &touchline::document::Frame| {
        let status = match frame.status {
            FrameStatus::Reference | FrameStatus::Rejected => frame.status.as_str(),
            _ => "open",
        };
        format!(
            "{status}/{}/{}/{}",
            frame.comment.as_deref().unwrap_or_default(),
            frame.gold,
            frame.clicks.len()
        )
    };
    document
        .frames
        .iter()
        .map(|each| frame(each))
        .collect::<Vec<_>>()
        .join(",")
}

/// Not a test by itself: the program that the next test kills. It says what it has made before that
/// is journaled, and what is kept once it is.
#[test]
fn child_that_edits_until_it_is_killed() {
    let Some(place) = std::env::var_os(CHILD) else {
        return;
    };
    let place = place.into_string().unwrap();
    let (number, file) = place.split_once(' ').unwrap();
    let mut headless = Headless::open(Path::new(file));
    let mut random = rng(number);
    let mut edits = 0;
    let is_saved = |app: &touchline::app::App| !matches!(app.session.disk.saving, Saving::Pending);
    loop {
        let document = &headless.app.open().unwrap().document;
        println!("kept {}", done_in(document));
        let frames = document.frames.len();
        headless.act(Action::Navigate(Navigation::GoTo(
            random.random_range(0..frames),
        )));
        edits += 1;
        let action = match random.random_range(0..20) {
            0..8 => Action::Edit(EditAction::SetComment(format!("{number}-{edits}"))),
            8..11 => Action::Command(Do::Undo),
            11..13 => Action::Command(Do::Redo),
            13 => Action::Edit(EditAction::RejectAs(RejectReason::Blur)),
            14..16 => Action::Command(Do::AcceptAndStay),
            16 => Action::Command(Do::MarkGold),
            17 => Action::Edit(EditAction::DeleteClick(0)),
            _ => Action::Command(Do::Save),
        };
        let effects = headless.app.update(action);
        println!("made {}", done_in(&headless.app.open().unwrap().document));
        for effect in effects {
            headless.requests.extend(headless.runner.carry_out(effect));
        }
        headless.wait_until("the journal", is_saved);
    }
}

#[test]
fn what_a_person_did_survives_kills_at_random_moments() {
    let place = tempfile::tempdir().unwrap();
    drawn_match(place.path());
    let file = place.path().join("match/ask.json");
    let mut random = rng("what_a_person_did_survives_kills_at_random_moments");
    let mut known = vec![done_in(&read(&file).unwrap().1)];
    let mut kept = 0;
    for number in 0..kills() {
        let told = format!("{number} {}", file.display());
        let (mut child, lines) = spawn_test(
            "robustness::random_kills::child_that_edits_until_it_is_killed",
            [(CHILD, &told)],
        );
        let mut lines = lines.map_while(Result::ok);
        // Now and then while it opens; else while it works.
        let mut heard = Vec::new();
        if random.random_range(0..5) > 0 {
            heard.extend(lines.by_ref().find(|line| line.contains("kept ")));
        }
        sleep(Duration::from_millis(
            random.random_range(0.0..7.0_f64).exp() as u64,
        ));
        child.kill().unwrap();
        child.wait().unwrap();
        for line in heard.into_iter().chain(lines) {
            if let Some((_, state)) = line.split_once("kept ") {
                known = vec![state.to_owned()];
                kept += 1;
            } else if let Some((_, state)) = line.split_once("made ") {
                known.push(state.to_owned());
            }
        }
        let found = done_in(&read(&file).unwrap().1);
        assert!(
            known.contains(&found),
            "kill {number}: found {found}, and it was one of {known:#?}"
        );
        known = vec![found];
    }
    assert!(kept > 0, "the program was never at work");
    eprintln!(
        "{} kills of a person's program, {kept} states kept",
        kills()
    );
}

/// The commands that are killed: what they write, and what tells that it is whole.
const COMMANDS: [(&str, &str); 6] = [
    ("solve ask.json -o ask.json --force", "ask.json"),
    ("train references.json -o new.tlf --force", "new.tlf"),
    (
        "relocalize forest.tlf ask.json -o answers.json --force",
        "answers.json",
    ),
    (
        "track references.json -o tracked.json --force",
        "tracked.json",
    ),
    (
        "export references.json --format csv -o clicks.csv --force",
        "clicks.csv",
    ),
    (
        "export references.json --dataset set --force",
        "set/manifest.sha256",
    ),
];

fn assert_whole(folder: &Path, result: &str, whole: &[u8]) {
    let path = folder.join(result);
    let Ok(bytes) = fs::read(&path) else { return };
    match path.extension().unwrap().to_str().unwrap() {
        "json" => drop(read(&path).unwrap_or_else(|error| panic!("{result}: {error}"))),
        "tlf" => drop(
            ForestModel::from_bytes(&bytes).unwrap_or_else(|error| panic!("{result}: {error}")),
        ),
        "sha256" => {
            for line in String::from_utf8(bytes).unwrap().lines() {
                let (hash, name) = line.split_once("  ").unwrap();
                assert_eq!(
                    sha256_of_file(&path.with_file_name(name)).unwrap(),
                    hash,
                    "{name}"
                );
            }
        }
        _ => assert!(bytes == whole, "{result} is not whole"),
    }
}

#[test]
fn results_of_commands_are_whole_or_absent_after_kills_at_random_moments() {
    let place = tempfile::tempdir().unwrap();
    drawn_match(place.path());
    let folder = place.path().join("match");
    assert_eq!(
        touchline(&folder, "train references.json -o forest.tlf").code,
        0
    );
    let mut random = rng("results_of_commands_are_whole_or_absent_after_kills_at_random_moments");
    let whole: Vec<(Duration, Vec<u8>)> = COMMANDS
        .into_iter()
        .map(|(command, result)| {
            let start = Instant::now();
            let ran = touchline(&folder, command);
            assert!(ran.code < 2, "{command}: {}", ran.stderr);
            (start.elapsed(), fs::read(folder.join(result)).unwrap())
        })
        .collect();
    let clicks = done_in(&read(&folder.join("ask.json")).unwrap().1);
    let mut killed = 0;
    for number in 0..kills() {
        let at = number % COMMANDS.len();
        let ((command, result), (took, bytes)) = (COMMANDS[at], &whole[at]);
        if random.random_range(0..2) == 0 && result != "ask.json" {
            let _ = fs::remove_file(folder.join(result));
            let _ = fs::remove_dir_all(folder.join("set"));
        }
        let mut child = Command::new(env!("CARGO_BIN_EXE_touchline"))
            .args(command.split_whitespace())
            .current_dir(&folder)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        sleep(took.mul_f64(random.random_range(0.0..1.1)));
        child.kill().unwrap();
        killed += usize::from(child.wait().unwrap().code().is_none());
        assert_whole(&folder, result, bytes);
        assert_eq!(
            done_in(&read(&folder.join("ask.json")).unwrap().1),
            clicks,
            "kill {number}: {command}"
        );
    }
    eprintln!(
        "{} commands, {killed} of them killed before their end",
        kills()
    );
}
