//! Programs that run beside this one, such as `ffmpeg`. Their output is read with a limit on the time
//! without any, and none outlives the value that stands for it.

use std::ffi::OsString;
use std::io::{self, Read};
use std::path::Path;
use std::process::{Child, ChildStderr, ChildStdout, Command, ExitStatus, Stdio};
use std::time::Duration;

/// A process without output for this long is taken to hang.
const PATIENCE: Duration = Duration::from_secs(30);

/// A running program. Dropping it ends it.
pub(super) struct Process {
    child: Child,
    /// Its standard output.
    pub output: Patient<ChildStdout>,
}

impl Process {
    /// Starts a program without input. Where its standard error goes is up to the command.
    ///
    /// # Errors
    /// It cannot be run.
    pub fn start(command: &mut Command) -> io::Result<Self> {
        let mut child = command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()?;
        let output = child
            .stdout
            .take()
            .ok_or_else(|| io::Error::other("it has no output"))?;
        Ok(Self {
            child,
            output: Patient(output),
        })
    }

    /// Its standard error, if the command pipes it; once.
    pub fn take_errors(&mut self) -> Option<Patient<ChildStderr>> {
        self.child.stderr.take().map(Patient)
    }

    /// Waits until it has ended.
    ///
    /// # Errors
    /// The system does not tell.
    pub fn wait(&mut self) -> io::Result<ExitStatus> {
        self.child.wait()
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // Both fail harmlessly if the process has already ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The whole output of a short-lived program; `None` if it cannot be run, fails or hangs.
pub(super) fn output_of(command: &mut Command) -> Option<String> {
    let mut process = Process::start(command.stderr(Stdio::null())).ok()?;
    let mut output = Vec::new();
    process.output.read_to_end(&mut output).ok()?;
    let has_succeeded = process.wait().is_ok_and(|status| status.success());
    has_succeeded.then(|| String::from_utf8_lossy(&output).into_owned())
}

/// A path that `ffmpeg` cannot mistake for a protocol, as `a:b.mp4`, or for an option.
pub(super) fn as_file(path: &Path) -> io::Result<OsString> {
    let mut file = OsString::from("file:");
    file.push(std::path::absolute(path)?);
    Ok(file)
}

/// A pipe that is read with [`PATIENCE`].
pub(super) struct Patient<R>(R);

#[cfg(unix)]
impl<R: Read + std::os::fd::AsFd> Read for Patient<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        use rustix::event::{PollFd, PollFlags, Timespec, poll};
        let patience = Timespec::try_from(PATIENCE).map_err(io::Error::other)?;
        // Wait for data with a timeout: a plain read would block forever if the process hangs.
        let ready = poll(&mut [PollFd::new(&self.0, PollFlags::IN)], Some(&patience))?;
        if ready == 0 {
            return Err(io::Error::other(format!(
                "it gave nothing for {} s",
                PATIENCE.as_secs()
            )));
        }
        self.0.read(buffer)
    }
}

#[cfg(not(unix))]
impl<R: Read> Read for Patient<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_output_of_a_program_is_read_and_a_failing_or_missing_one_has_none() {
        let shell = |script: &str| output_of(Command::new("sh").args(["-c", script]));
        assert_eq!(shell("echo a line").as_deref(), Some("a line\n"));
        assert_eq!(shell("echo a line; exit 3"), None);
        assert_eq!(output_of(&mut Command::new("/no/such/program")), None);
    }

    /// Dropping waits for the end, so that this would take as long as the program sleeps.
    #[test]
    fn a_program_ends_with_the_value_that_stands_for_it() {
        let sleeping = Process::start(Command::new("sleep").arg("1000")).unwrap();
        let of_process = format!("/proc/{}", sleeping.child.id());
        drop(sleeping);
        assert!(!Path::new(&of_process).exists(), "{of_process}");
    }

    #[test]
    fn a_path_is_neither_an_option_nor_a_protocol() {
        let file = as_file(Path::new("/videos/-a:b.mp4")).unwrap();
        assert_eq!(file.to_str(), Some("file:/videos/-a:b.mp4"));
    }
}
