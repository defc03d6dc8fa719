//! Tests that need a part which not every machine has. Where it is missing they are ignored and say
//! why, never passed; with `TOUCHLINE_REQUIRE_ALL=1` they fail instead, and with
//! `TOUCHLINE_REQUIRE=adapter,ffmpeg` those do that need these.
//!
//! The standard harness decides what is ignored when it is compiled. These tests are run by
//! `libtest-mimic`, which takes the same arguments, so that `cargo test` and `cargo nextest` list
//! them as ignored on the machine they run on.

use libtest_mimic::{Arguments, Completion, Failed, FormatSetting, Trial};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::sync::LazyLock;
use touchline::render::Offscreen;

/// What a test may need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(
    dead_code,
    reason = "each of the binaries that share this file needs some of them"
)]
pub enum Part {
    /// A graphics adapter, be it a software renderer.
    Adapter,
    /// Real frames: the folder that `TOUCHLINE_DATA` names, else `../shared/data` beside the
    /// package.
    Frames,
    /// The program ffmpeg.
    Ffmpeg,
}

/// A test and what it needs.
#[derive(Clone, Copy)]
pub struct Test {
    pub name: &'static str,
    pub needs: &'static [Part],
    pub run: fn(),
}

/// The tests of a module, each behind what it needs:
/// `tests![[Adapter] lines_are_drawn; [] nothing_is_needed;]`. The compiler tells of a test that is
/// left out: nobody calls it.
macro_rules! tests {
    ($([$($part:ident),*] $name:ident;)+) => {
        &[$($crate::parts::Test {
            name: concat!(module_path!(), "::", stringify!($name)),
            needs: &[$($crate::parts::Part::$part),*],
            run: $name,
        }),+]
    };
}
pub(crate) use tests;

impl Part {
    /// Why it is missing here; none where it is there.
    fn missing(self) -> Option<&'static str> {
        static ADAPTER: LazyLock<Option<String>> =
            LazyLock::new(|| Offscreen::new().err().map(|error| error.to_string()));
        static FRAMES: LazyLock<Option<String>> = LazyLock::new(|| {
            let folder = frames_folder();
            (!folder.is_dir())
                .then(|| format!("no real frames at {} (TOUCHLINE_DATA)", folder.display()))
        });
        static FFMPEG: LazyLock<Option<String>> = LazyLock::new(|| {
            let ran = Command::new("ffmpeg").arg("-version").output();
            ran.err().map(|error| format!("no ffmpeg ({error})"))
        });
        match self {
            Self::Adapter => ADAPTER.as_deref(),
            Self::Frames => FRAMES.as_deref(),
            Self::Ffmpeg => FFMPEG.as_deref(),
        }
    }

    /// Whether the environment says that this machine has it.
    fn is_required(self) -> bool {
        let name = match self {
            Self::Adapter => "adapter",
            Self::Frames => "frames",
            Self::Ffmpeg => "ffmpeg",
        };
        let named = |variable| std::env::var(variable).unwrap_or_default();
        named("TOUCHLINE_REQUIRE_ALL") == "1"
            || named("TOUCHLINE_REQUIRE")
                .split(',')
                .any(|part| part.trim() == name)
    }
}

/// The folder of real frames, for tests that need [`Part::Frames`].
pub fn frames_folder() -> PathBuf {
    std::env::var_os("TOUCHLINE_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"),
        PathBuf::from,
    )
}

/// Runs the tests of some modules as the command line asks.
pub fn run(modules: &[&[Test]]) -> ExitCode {
    let arguments = Arguments::from_args();
    let mut ignored: BTreeMap<String, usize> = BTreeMap::new();
    let mut trials = Vec::new();
    for test in modules
        .iter()
        .copied()
        .flatten()
        .filter(|test| is_chosen(test, &arguments))
    {
        let missing: Vec<Part> = test
            .needs
            .iter()
            .copied()
            .filter(|part| part.missing().is_some())
            .collect();
        let reason: Vec<&str> = missing.iter().filter_map(|part| part.missing()).collect();
        let reason = reason.join("; ");
        let required = missing.iter().any(|part| part.is_required());
        if !missing.is_empty() && !required {
            *ignored.entry(reason.clone()).or_default() += 1;
        }
        trials.push(trial(test, reason, required, &arguments));
    }
    let conclusion = libtest_mimic::run(&arguments, trials);
    // Who lists for a person says why; the listing that nextest reads stays as it is.
    if arguments.list && arguments.format != Some(FormatSetting::Terse) {
        for (reason, count) in ignored {
            println!("ignored, {count} tests: {reason}");
        }
    }
    conclusion.exit_code()
}

/// A test as the harness runs it; `reason` says what is missing and is empty where nothing is.
fn trial(test: &Test, reason: String, required: bool, arguments: &Arguments) -> Trial {
    let (name, run) = (name_of(test), test.run);
    if reason.is_empty() {
        return Trial::test(name, move || {
            run();
            Ok(())
        });
    }
    let asked_for = arguments.ignored || arguments.include_ignored;
    if required || asked_for || arguments.list {
        let fails = move || Err(Failed::from(format!("cannot run: {reason}")));
        return Trial::test(name, fails).with_ignored_flag(!required);
    }
    Trial::ignorable_test(name, move || Ok(Completion::ignored_with(reason)))
}

/// Whether the command line names a test: only what it needs is looked for.
fn is_chosen(test: &Test, arguments: &Arguments) -> bool {
    let by_name = Arguments {
        ignored: false,
        ..arguments.clone()
    };
    !by_name.is_filtered_out(&Trial::test(name_of(test), || Ok(())))
}

/// The name of a test without that of its binary.
fn name_of(test: &Test) -> &'static str {
    test.name
        .split_once("::")
        .map_or(test.name, |(_, name)| name)
}
