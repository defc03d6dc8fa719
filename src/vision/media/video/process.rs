//! Programs that run beside this one, such as `ffmpeg`. Their output is read with a limit on the time
//! without any, and none outlives the value that stands for it.

use std::borrow::Cow;
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
    patience: Duration,
}

impl Process {
    /// Starts a program without input. Where its standard error goes is up to the command.
    ///
    /// # Errors
    /// It cannot be run.
    pub fn start(command: &mut Command) -> io::Result<Self> {
        Self::start_with_patience(command, PATIENCE)
    }

    fn start_with_patience(command: &mut Command, patience: Duration) -> io::Result<Self> {
        let mut child = command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()?;
        let pipe = child
            .stdout
            .take()
            .ok_or_else(|| io::Error::other("it has no output"))?;
        Ok(Self {
            child,
            output: Patient { pipe, patience },
            patience,
        })
    }

    /// Its standard error, if the command pipes it; once.
    pub fn take_errors(&mut self) -> Option<Patient<ChildStderr>> {
        let patience = self.patience;
        let pipe = self.child.stderr.take()?;
        Some(Patient { pipe, patience })
    }

    /// Waits until it has ended, which is soon after the end of its output.
    ///
    /// # Errors
    /// It does not end, or the system does not tell.
    #[cfg(unix)]
    pub fn wait(&mut self) -> io::Result<ExitStatus> {
        use rustix::event::{Timespec, poll};
        use rustix::io::retry_on_intr;
        const INTERVAL: Duration = Duration::from_millis(5);
        let interval = Timespec::try_from(INTERVAL).map_err(io::Error::other)?;
        for _ in 0..self.patience.as_millis() / INTERVAL.as_millis() {
            if let Some(status) = self.child.try_wait()? {
                return Ok(status);
            }
            // Nothing to poll: this only passes the time. A signal, such as Ctrl-C, interrupts it
            // and is no failure of the process.
            retry_on_intr(|| poll(&mut [], Some(&interval)))?;
        }
        Err(io::Error::other(format!(
            "it gave all its output and did not end for {} s",
            self.patience.as_secs()
        )))
    }

    /// Waits until it has ended.
    ///
    /// # Errors
    /// The system does not tell.
    #[cfg(not(unix))]
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

/// The whole output of a short-lived program; `None` if it states by its exit code that it failed.
///
/// # Errors
/// It cannot be run, hangs, or was killed.
pub(super) fn output_of(command: &mut Command) -> io::Result<Option<String>> {
    let mut process = Process::start(command.stderr(Stdio::null()))?;
    let mut output = Vec::new();
    process.output.read_to_end(&mut output)?;
    let status = process.wait()?;
    fail_if_killed(status)?;
    let text = status.success().then(|| String::from_utf8_lossy(&output));
    Ok(text.map(Cow::into_owned))
}

/// Fails if a program was killed, and did not end by itself: it then has no exit code.
pub(super) fn fail_if_killed(status: ExitStatus) -> io::Result<()> {
    if status.code().is_some() {
        Ok(())
    } else {
        Err(io::Error::other(format!("it was ended: {status}")))
    }
}

/// A path that `ffmpeg` cannot mistake for a protocol, as `a:b.mp4`, or for an option.
pub(super) fn as_file(path: &Path) -> io::Result<OsString> {
    let mut file = OsString::from("file:");
    file.push(std::path::absolute(path)?);
    Ok(file)
}

/// A pipe that is read with a limit on the time without any data.
pub(super) struct Patient<R> {
    pipe: R,
    patience: Duration,
}

#[cfg(unix)]
impl<R: Read + std::os::fd::AsFd> Read for Patient<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        use rustix::event::{PollFd, PollFlags, Timespec, poll};
        let patience = Timespec::try_from(self.patience).map_err(io::Error::other)?;
        // Wait for data with a timeout: a plain read would block forever if the process hangs. The
        // end of the output counts as data. Callers of `Read` repeat what a signal interrupts.
        let ready = poll(
            &mut [PollFd::new(&self.pipe, PollFlags::IN)],
            Some(&patience),
        )?;
        if ready == 0 {
            return Err(io::Error::other(format!(
                "it gave nothing for {} s",
                self.patience.as_secs()
            )));
        }
        self.pipe.read(buffer)
    }
}

#[cfg(not(unix))]
impl<R: Read> Read for Patient<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.pipe.read(buffer)
    }
}

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_output_of_a_program_is_read_and_a_failing_or_missing_one_has_none() {
        let shell = |script: &str| output_of(Command::new("sh").args(["-c", script]));
        assert_eq!(shell("echo a line").unwrap().as_deref(), Some("a line\n"));
        assert_eq!(shell("echo a line; exit 3").unwrap(), None);
        assert!(output_of(&mut Command::new("/no/such/program")).is_err());
        let killed = shell("echo a line; kill -9 $$").unwrap_err();
        assert_eq!(killed.to_string(), "it was ended: signal: 9 (SIGKILL)");
    }

    /// A shell script that is given up after a second and a half without output.
    fn start_impatiently(script: &str) -> Process {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        let patience = Duration::from_millis(1500);
        Process::start_with_patience(&mut command, patience).unwrap()
    }

    #[test]
    fn a_program_that_hangs_is_given_up_before_and_after_the_end_of_its_output() {
        let mut output = String::new();
        let mut silent = start_impatiently("echo a line; exec sleep 1000");
        let error = silent.output.read_to_string(&mut output).unwrap_err();
        assert_eq!(output, "a line\n");
        assert_eq!(error.to_string(), "it gave nothing for 1 s");
        output.clear();
        let mut endless = start_impatiently("echo a line; exec sleep 1000 >&-");
        endless.output.read_to_string(&mut output).unwrap();
        assert_eq!(output, "a line\n");
        let error = endless.wait().unwrap_err().to_string();
        assert_eq!(error, "it gave all its output and did not end for 1 s");
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
