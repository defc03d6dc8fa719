//! Running the program as a script would.

use std::path::Path;
use std::process::Command;

/// What a run of the program left.
pub struct Ran {
    /// The exit code.
    pub code: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

/// Runs `touchline` with arguments separated by blanks, in a folder.
pub fn touchline(folder: &Path, arguments: &str) -> Ran {
    let output = Command::new(env!("CARGO_BIN_EXE_touchline"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .output()
        .unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Ran {
        code: output.status.code().unwrap(),
        stdout: text(output.stdout),
        stderr: text(output.stderr),
    }
}

impl Ran {
    /// The same, after it ended well.
    #[track_caller]
    pub fn done(self) -> Self {
        assert_eq!(self.code, 0, "{}", self.stderr);
        self
    }

    /// It ended with this code and one line that says why.
    #[track_caller]
    pub fn assert_refused(&self, code: i32) {
        let lines = self.stderr.trim_end().lines().count();
        assert_eq!((self.code, lines), (code, 1), "{}", self.stderr);
    }

    /// Standard error has this.
    #[track_caller]
    pub fn assert_says(&self, part: &str) {
        assert!(self.stderr.contains(part), "no {part:?}: {}", self.stderr);
    }

    /// Standard output has this.
    #[track_caller]
    pub fn assert_prints(&self, part: &str) {
        assert!(self.stdout.contains(part), "no {part:?}: {}", self.stdout);
    }
}
