//! A test of this program run as a program of its own, so that it can be killed and measured.

use std::io::{BufRead, BufReader, Lines};
use std::process::{Child, ChildStdout, Command, Stdio};

/// Starts the test `name`, which does nothing unless variables are set; what it prints comes line
/// by line.
pub fn spawn_test<const N: usize>(
    name: &str,
    variables: [(&str, &str); N],
) -> (Child, Lines<BufReader<ChildStdout>>) {
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args([name, "--exact", "--nocapture", "--test-threads=1"])
        .envs(variables)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    (child, lines)
}

/// The numbers that a child prints behind a word.
pub fn numbers_behind(
    word: &str,
    lines: Lines<BufReader<ChildStdout>>,
) -> impl Iterator<Item = usize> {
    lines
        .map_while(Result::ok)
        .filter_map(move |line| line.split_once(word)?.1.trim().parse().ok())
}
