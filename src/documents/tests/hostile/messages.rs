//! What is said of damaged files. `messages.txt` is read by people: each line says what is wrong,
//! where, and how to mend it.
//!
//! `UPDATE_MESSAGES=1 cargo test --test hostile` writes it anew.

use crate::damage::Damage;
use crate::memory::alone;
use crate::samples::{Sample, formats};
use std::fmt::Write as _;
use std::path::Path;
use touchline_documents::exchange::{ExchangeError, Imported, import};

/// The least damaged files of a format.
const LEAST: usize = 15;

/// What an import says, without the name of the temporary folder.
fn message_of(error: &ExchangeError, folder: &Path) -> String {
    error
        .to_string()
        .replace(&folder.join("in").display().to_string(), "FOLDER")
}

/// What an import says of frames that it cannot read, beside others that it can.
fn note_of_damage(imported: &Imported) -> Option<String> {
    imported.failures.first().cloned()
}

/// Damage to a place, not to a file.
fn places(sample: &Sample, folder: &Path) -> Vec<(&'static str, String)> {
    let within = folder.join("in");
    let at = |name: &str| within.join(name);
    std::fs::create_dir_all(at("empty")).unwrap();
    let mut said_of = Vec::new();
    let mut refused = |name, path: &Path| {
        let error = import(path, sample.format, &sample.options).err();
        let error = error.unwrap_or_else(|| panic!("{}: {name} is imported", sample.format));
        said_of.push((name, message_of(&error, folder)));
    };
    refused("missing", &at("missing"));
    refused("an-empty-folder", &at("empty"));
    #[cfg(target_os = "linux")]
    {
        assert!(
            std::process::Command::new("mkfifo")
                .arg(at("pipe"))
                .status()
                .unwrap()
                .success()
        );
        refused("a-pipe", &at("pipe"));
        std::os::unix::fs::symlink("/dev/zero", at("link")).unwrap();
        refused("a-link-to-a-device", &at("link"));
        std::os::unix::fs::symlink("/etc", at("empty/etc")).unwrap();
        refused("a-link-out-of-the-folder", &at("empty"));
    }
    let large = at("large").with_extension(sample.main().rsplit('.').next().unwrap());
    std::fs::File::create(&large)
        .unwrap()
        .set_len(300 << 20)
        .unwrap();
    refused("300-mib", &large);
    std::fs::remove_dir_all(within).unwrap();
    said_of
}

#[test]
#[cfg(target_os = "linux")]
fn each_damaged_file_has_its_line() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let mut all = String::new();
    for format in formats() {
        let damage = Damage::to(format);
        let mut lines: Vec<(String, String)> = places(&damage.sample, folder.path())
            .into_iter()
            .map(|(name, said)| (name.to_owned(), said))
            .collect();
        for case in &damage.cases {
            let sample = Sample {
                options: case.options.clone(),
                ..damage.sample.clone()
            };
            let line = match sample.import(&case.files, folder.path()) {
                Ok(imported) => note_of_damage(&imported),
                Err(error) => Some(message_of(&error, folder.path())),
            };
            let line = line.unwrap_or_else(|| panic!("{format}: {} is imported", case.name));
            lines.push((case.name.clone(), line));
        }
        assert!(
            lines.len() >= LEAST,
            "{format}: {} damaged files",
            lines.len()
        );
        writeln!(all, "## {format}").unwrap();
        for (name, said) in lines {
            assert!(
                !said.chars().any(char::is_control),
                "{format}: {name}: {said:?} is one plain line"
            );
            assert!(
                said.chars().count() <= 300,
                "{format}: {name}: {} letters: {said}",
                said.chars().count()
            );
            writeln!(all, "{name}: {said}").unwrap();
        }
        all.push('\n');
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hostile/messages.txt");
    if std::env::var_os("UPDATE_MESSAGES").is_some() {
        std::fs::write(&file, &all).unwrap();
    }
    let wanted = std::fs::read_to_string(&file).unwrap_or_default();
    for (line, (wanted, found)) in wanted.lines().zip(all.lines()).enumerate() {
        assert_eq!(found, wanted, "messages.txt:{}", line + 1);
    }
    assert_eq!(
        all.lines().count(),
        wanted.lines().count(),
        "messages.txt has another number of lines"
    );
}
