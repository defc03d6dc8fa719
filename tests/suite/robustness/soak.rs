//! A person works for hours: memory, threads and open files stay as they are.
//! `TOUCHLINE_SOAK=14400` makes it eight hours of one action every two seconds.
#![cfg(all(feature = "opencv", target_os = "linux"))]

use crate::drawn::drawn_match;
use crate::headless::Headless;
use rand::RngExt;
use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::Duration;
use touchline::app::session::Saving;
use touchline::app::{
    Action, App, Command as Do, EditAction, Navigation, PointerAction, TrainerActivity,
};
use touchline::document::RejectReason;
use touchline::geometry::ImagePoint;
use touchline_core::testing::child::spawn_test;
use touchline_core::testing::seeded::rng;

const CHILD: &str = "TOUCHLINE_TEST_SOAK";

/// The project is closed and opened again after so many actions.
const SESSION: usize = 150;

/// What the program takes of the machine.
#[derive(Clone, Copy, Debug, Default)]
struct ResourceUse {
    memory_mib: f64,
    threads: usize,
    open_files: usize,
}

impl ResourceUse {
    fn now() -> Self {
        let status = fs::read_to_string("/proc/self/status").unwrap();
        let kib = status.lines().find_map(|line| {
            line.strip_prefix("VmRSS:")?
                .trim()
                .strip_suffix(" kB")?
                .parse()
                .ok()
        });
        // A thread that is just ending, with the files that it has open, is gone at a later look.
        let count = |folder: &str| {
            let look = |_| {
                sleep(Duration::from_millis(20));
                fs::read_dir(folder).unwrap().count()
            };
            (0..10).map(look).min().unwrap()
        };
        let kib: f64 = kib.unwrap();
        Self {
            memory_mib: kib / 1024.0,
            threads: count("/proc/self/task"),
            open_files: count("/proc/self/fd"),
        }
    }
}

/// How many actions a person does.
fn actions() -> usize {
    std::env::var("TOUCHLINE_SOAK").map_or(8 * SESSION, |number| number.parse().unwrap())
}

fn is_quiet(app: &App) -> bool {
    app.session.trainer.status.doing == TrainerActivity::Nothing
        && !matches!(app.session.disk.saving, Saving::Pending)
}

/// Not a test by itself: the program that the next test measures.
#[test]
fn child_that_works_for_hours() {
    let Some(told) = std::env::var_os(CHILD) else {
        return;
    };
    let told = told.into_string().unwrap();
    let (actions, file) = told.split_once(' ').unwrap();
    let mut random = rng("soak");
    let mut headless = Headless::open(Path::new(file));
    for done in 1..=actions.parse().unwrap() {
        let frames = headless.app.open().unwrap().document.frames.len();
        let at = ImagePoint::new(
            random.random_range(0.0..640.0),
            random.random_range(0.0..360.0),
        );
        let clicks = headless.app.frame().map_or(0, |frame| frame.clicks.len());
        match random.random_range(0..24) {
            0..6 => headless.act(Action::Navigate(Navigation::GoTo(
                random.random_range(0..frames),
            ))),
            6..9 if clicks < 12 => {
                headless.act(Action::Pointer(PointerAction::Press { at, on: None }));
                headless.act(Action::Pointer(PointerAction::Release));
            }
            6..12 if clicks > 0 => {
                headless.act(Action::Pointer(PointerAction::Press {
                    at,
                    on: Some(random.random_range(0..clicks)),
                }));
                headless.act(Action::Pointer(PointerAction::Drag(at)));
                headless.act(Action::Pointer(PointerAction::Release));
            }
            12 => headless.act(Action::Command(Do::DeleteClick)),
            13..15 => headless.act(Action::Edit(EditAction::SetComment(done.to_string()))),
            15..17 => headless.act(Action::Command(Do::Undo)),
            17 => headless.act(Action::Command(Do::Redo)),
            18 => headless.act(Action::Edit(EditAction::RejectAs(RejectReason::Blur))),
            19 => headless.act(Action::Command(Do::AcceptAndStay)),
            20 => headless.act(Action::Command(Do::Snap)),
            21 => headless.act(Action::Command(Do::QualityPage)),
            22 => headless.act(Action::Command(Do::MarkGold)),
            _ => headless.act(Action::Command(Do::Save)),
        }
        headless.wait_for_picture();
        for action in headless.runner.poll() {
            headless.act(action);
        }
        if done % SESSION == 0 {
            headless.wait_until("rest", is_quiet);
            assert!(headless.runner.close().is_empty());
            headless = Headless::open(Path::new(file));
            headless.wait_until("rest", is_quiet);
            headless.wait_for_picture();
            let ResourceUse {
                memory_mib,
                threads,
                open_files,
            } = ResourceUse::now();
            println!("taken {memory_mib} {threads} {open_files}");
        }
    }
    headless.runner.close();
}

/// What a program takes of the machine each time that it has opened the project again.
fn resource_uses(actions: usize, file: &Path) -> Vec<ResourceUse> {
    let told = format!("{actions} {}", file.display());
    // Every session has threads of its own, and the allocator would keep room for some of each
    // until it has seen very many.
    let variables = [(CHILD, told.as_str()), ("MALLOC_ARENA_MAX", "1")];
    let (mut child, lines) = spawn_test("robustness::soak::child_that_works_for_hours", variables);
    let taken = lines.map_while(Result::ok).filter_map(|line| {
        let numbers: Vec<f64> = line
            .split_once("taken ")?
            .1
            .split(' ')
            .map(|number| number.parse().unwrap())
            .collect();
        let [memory_mib, threads, open_files] = numbers[..] else {
            panic!("{line}")
        };
        Some(ResourceUse {
            memory_mib,
            threads: threads as usize,
            open_files: open_files as usize,
        })
    });
    let taken: Vec<ResourceUse> = taken.collect();
    assert!(child.wait().unwrap().success());
    assert_eq!(taken.len(), actions / SESSION);
    taken
}

#[test]
fn hours_of_work_take_no_more_of_the_machine_than_minutes() {
    let place = tempfile::tempdir().unwrap();
    drawn_match(place.path());
    let file = place.path().join("match/ask.json");
    let taken = resource_uses(actions(), &file);
    let (begun, last) = taken.split_at(taken.len() / 2);
    let mean_mib = |some: &[ResourceUse]| {
        some.iter().map(|taken| taken.memory_mib).sum::<f64>() / some.len() as f64
    };
    let most =
        |some: &[ResourceUse], of: fn(&ResourceUse) -> usize| some.iter().map(of).max().unwrap();
    let most_of = |some: &[ResourceUse]| {
        [
            most(some, |taken| taken.threads),
            most(some, |taken| taken.open_files),
        ]
    };
    eprintln!(
        "{} actions: {:.0} MiB in the first half, {:.0} in the second; threads and open files at most {:?} and {:?}",
        actions(),
        mean_mib(begun),
        mean_mib(last),
        most_of(begun),
        most_of(last),
    );
    assert!(mean_mib(last) <= 1.05 * mean_mib(begun), "{taken:?}");
    // One that is just ending may be counted.
    assert!(
        most_of(last)
            .into_iter()
            .zip(most_of(begun))
            .all(|(last, begun)| last <= begun + 1),
        "{taken:?}"
    );
}
