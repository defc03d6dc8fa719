//! Writing a video through the user's `ffmpeg` program.

use super::ffmpeg::ffmpeg;
use super::process::as_file;
use std::io::{self, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use touchline_core::geometry::ImageSize;

/// Quality of the video (constant rate factor): 18 looks like the original.
const QUALITY: &str = "18";

/// An MP4 (H.264) that is written frame by frame. Dropped before [`VideoWriter::finish`], it stays
/// incomplete.
pub struct VideoWriter {
    process: Child,
    /// None once all frames are written.
    input: Option<ChildStdin>,
}

impl VideoWriter {
    /// Begins a video, over one that is there.
    ///
    /// # Errors
    /// A side is odd, which H.264 does not store, or there is no `ffmpeg`.
    pub fn create(path: &Path, size: ImageSize, fps: f64) -> io::Result<Self> {
        let ImageSize { width, height } = size;
        if width % 2 != 0 || height % 2 != 0 {
            return Err(io::Error::other(format!(
                "{width} × {height} px has an odd side; give even ones"
            )));
        }
        if ffmpeg().is_none() {
            return Err(io::Error::other(
                "the program ffmpeg that writes videos is not found; install it and start again",
            ));
        }
        let mut process = Command::new("ffmpeg")
            .args(["-v", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"])
            .args(["-video_size", &format!("{width}x{height}")])
            .args(["-framerate", &fps.to_string(), "-i", "pipe:0"])
            .args(["-c:v", "libx264", "-preset", "veryfast", "-crf", QUALITY])
            .args(["-pix_fmt", "yuv420p", "-y"])
            .arg(as_file(path)?)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()?;
        let input = process.stdin.take();
        Ok(Self { process, input })
    }

    /// Adds a frame: red, green and blue of each pixel, row by row.
    ///
    /// # Errors
    /// `ffmpeg` has ended, for instance because the disk is full.
    pub fn write(&mut self, rgb: &[u8]) -> io::Result<()> {
        let written = match &mut self.input {
            Some(input) => input.write_all(rgb),
            None => Ok(()),
        };
        written.or_else(|_| self.wait())
    }

    /// Ends the video.
    ///
    /// # Errors
    /// `ffmpeg` could not write it.
    pub fn finish(mut self) -> io::Result<()> {
        self.wait()
    }

    /// Waits for the end of the program, and fails with what it says if it failed.
    fn wait(&mut self) -> io::Result<()> {
        self.input = None;
        let mut message = String::new();
        if let Some(mut errors) = self.process.stderr.take() {
            errors.read_to_string(&mut message)?;
        }
        let status = self.process.wait()?;
        if status.success() {
            return Ok(());
        }
        let message = message.lines().next().unwrap_or_default();
        Err(io::Error::other(format!(
            "ffmpeg failed: {message} ({status})"
        )))
    }
}

impl Drop for VideoWriter {
    fn drop(&mut self) {
        // Both fail harmlessly if the process has already ended.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_odd_size_and_a_folder_that_is_not_there_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let odd = VideoWriter::create(&folder.path().join("a.mp4"), ImageSize::new(65, 36), 25.0);
        assert!(odd.is_err());
        if ffmpeg().is_some() {
            let nowhere = folder.path().join("none/a.mp4");
            let mut writer = VideoWriter::create(&nowhere, ImageSize::new(64, 36), 25.0).unwrap();
            // The pipe takes some frames before the program has failed.
            let written = writer
                .write(&[0; 64 * 36 * 3])
                .and_then(|()| writer.finish());
            assert!(
                written
                    .unwrap_err()
                    .to_string()
                    .starts_with("ffmpeg failed: ")
            );
        }
    }
}
