//! The folder of the session, which the libraries of Wayland and Vulkan look for.

/// Starts the program again with a runtime folder if its session names none. Without one the
/// libraries of Wayland and Vulkan write an error each time they look for a display, although X11
/// and drawing off screen need none; and a process cannot set a variable of its own once it may
/// have threads. On other systems than Linux nothing happens.
pub fn give_runtime_folder() {
    #[cfg(target_os = "linux")]
    {
        use std::os::unix::process::CommandExt as _;
        const VARIABLE: &str = "XDG_RUNTIME_DIR";
        if std::env::var_os(VARIABLE).is_some() {
            return;
        }
        if let Ok(program) = std::env::current_exe() {
            // It returns only if it failed: then the program goes on as it is.
            let _ = std::process::Command::new(program)
                .args(std::env::args_os().skip(1))
                .env(VARIABLE, std::env::temp_dir())
                .exec();
        }
    }
}
