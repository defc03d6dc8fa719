//! The program `touchline`: the desktop app and the command line.

#[cfg(feature = "gui")]
use std::io::IsTerminal as _;
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
    let refuse = |why: String| {
        eprintln!("touchline: {why}");
        ExitCode::from(2)
    };
    if let Some(document) = &document
        && !document.exists()
    {
        return refuse(format!(
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
             without, see touchline --help"
                .to_owned(),
        );
    }
    cli::give_runtime_folder();
    // Who started the program from a desktop sees no terminal.
    let refuse = |why: String| {
        if !std::io::stdin().is_terminal() && !std::io::stderr().is_terminal() {
            touchline::ui::say_in_dialog(&why);
        }
        refuse(why)
    };
    match touchline::ui::run(document) {
        Ok(()) => ExitCode::SUCCESS,
        Err(touchline::ui::WindowError::BrokeDown(panicked)) => refuse(format!(
            "the window broke down: {panicked}. Every edit was journalled as it was made and is there when the project is opened \
             again; if the display is still there, this is a fault of the program: please report it"
        )),
        Err(error) if is_about_display(&error.to_string()) => refuse(format!(
            "the window cannot open: {error}. The display cannot be reached: look at DISPLAY, WAYLAND_DISPLAY and XAUTHORITY; \
             the commands work without, see touchline --help"
        )),
        Err(error) => refuse(format!(
            "the window cannot open, for neither a Vulkan nor an OpenGL driver can be used (Debian: \
             mesa-vulkan-drivers libegl1): {error}. The commands work without, see touchline --help"
        )),
    }
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
fn window(_document: Option<std::path::PathBuf>) -> ExitCode {
    eprintln!(
        "touchline: this program was built without the window (feature \"gui\"); see touchline --help"
    );
    ExitCode::from(2)
}
