//! The program `touchline`: the desktop app and the command line.

#[cfg(feature = "gui")]
use std::io::IsTerminal as _;
use std::process::ExitCode;
use touchline::cli::{self, Next};

fn main() -> ExitCode {
    match cli::run() {
        Next::Exit(code) => code,
        Next::Window(documents) => window(documents),
    }
}

/// Says why the program ends, in one line.
fn refuse(why: &str) -> ExitCode {
    eprintln!("touchline: {why}");
    ExitCode::from(2)
}

#[cfg(feature = "gui")]
fn window(documents: Vec<std::path::PathBuf>) -> ExitCode {
    if let Some(document) = documents.iter().find(|document| !document.exists()) {
        return refuse(&format!(
            "{}: neither a file or folder nor a command; see touchline --help",
            document.display()
        ));
    }
    let has_display = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"]
        .iter()
        .any(|name| std::env::var_os(name).is_some());
    if cfg!(target_os = "linux") && !has_display {
        return refuse(
            "there is no display (DISPLAY and WAYLAND_DISPLAY are not set), so the window cannot open; the commands work \
             without, see touchline --help",
        );
    }
    // Before any library of the window system is loaded.
    cli::give_runtime_folder();
    let why = match touchline::ui::run(documents) {
        Ok(()) => return ExitCode::SUCCESS,
        Err(touchline::ui::WindowError::BrokeDown(panicked)) => format!(
            "the window broke down: {panicked}. Every edit was journalled as it was made and is there when the project is opened \
             again; if the display is still there, this is a fault of the program: please report it"
        ),
        // Both kinds of errors arrive as one type. Their texts tell a missing display from a
        // missing driver, for which the user has to do different things.
        Err(error) if is_about_display(&error.to_string()) => format!(
            "the window cannot open: {error}. The display cannot be reached: look at DISPLAY, WAYLAND_DISPLAY and XAUTHORITY; \
             the commands work without, see touchline --help"
        ),
        Err(error) => format!(
            "the window cannot open, for neither a Vulkan nor an OpenGL driver can be used (Debian: \
             mesa-vulkan-drivers libegl1): {error}. The commands work without, see touchline --help"
        ),
    };
    // Who started the program from a desktop sees no terminal.
    if !std::io::stdin().is_terminal() && !std::io::stderr().is_terminal() {
        touchline::ui::say_in_dialog(&why);
    }
    refuse(&why)
}

/// Whether the window system did not answer, which no graphics driver mends.
#[cfg(feature = "gui")]
fn is_about_display(error: &str) -> bool {
    let error = error.to_lowercase();
    [
        "display",
        "wayland",
        "x11",
        "xlib",
        "event loop",
        "eventloop",
    ]
    .iter()
    .any(|word| error.contains(word))
}

#[cfg(not(feature = "gui"))]
fn window(_documents: Vec<std::path::PathBuf>) -> ExitCode {
    refuse("this program was built without the window (feature \"gui\"); see touchline --help")
}
