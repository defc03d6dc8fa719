//! The program `touchline`: the desktop app and the command line.

use std::process::ExitCode;
use touchline::cli::{self, Next};

fn main() -> ExitCode {
    match cli::run() {
        Next::Exit(code) => code,
        Next::Window(document) => window(document),
    }
}

#[cfg(feature = "gui")]
fn window(document: Option<std::path::PathBuf>) -> ExitCode {
    match touchline::ui::run(document) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!(
                "touchline: the window cannot open: {error}. It needs a display (DISPLAY or WAYLAND_DISPLAY) and a Vulkan or \
                 OpenGL driver; the commands work without (touchline --help)"
            );
            ExitCode::from(2)
        }
    }
}

#[cfg(not(feature = "gui"))]
fn window(_document: Option<std::path::PathBuf>) -> ExitCode {
    eprintln!("touchline: this program was built without the window (feature \"gui\"); see touchline --help");
    ExitCode::from(2)
}
