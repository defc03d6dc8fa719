//! Writes what packages ship beside the program and the command line determines: man pages and shell
//! completions, into the folder that is named.

use clap_complete::Shell;
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from);
    let folder = folder.ok_or("name the folder to write into")?;
    std::fs::create_dir_all(&folder)?;
    clap_mangen::generate_to(touchline::cli::command(), &folder)?;
    for shell in [Shell::Bash, Shell::Zsh, Shell::Fish] {
        clap_complete::generate_to(shell, &mut touchline::cli::command(), "touchline", &folder)?;
    }
    Ok(())
}
