//! Running the program as a script would, and the documents that it reads and writes.

use std::fs;
use std::path::Path;
use std::process::Command;
use touchline::document::{Document, document_from_bytes, document_to_string};

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

/// A document of a file.
pub fn document(path: &Path) -> Document {
    document_from_bytes(&fs::read(path).unwrap()).unwrap()
}

/// Writes a document into a file.
pub fn write(path: &Path, document: &Document) {
    fs::write(path, document_to_string(document).unwrap()).unwrap();
}
