//! Videos through the user's `ffmpeg` program.
//!
//! One process decodes from some position to the end of the video and writes the pixels of each
//! frame to its standard output. Before these it writes the frame's time stamp to its standard
//! error, one line per frame and nothing else, since its own messages are switched off. So a frame
//! is identified by the time that the container gives it, not by counting. A seek ends the process
//! and starts one at another position. `ffmpeg` runs only as fast as its pipes are read; they are
//! the buffer.
//!
//! `ffmpeg` applies edit lists, rotates frames upright and drops the frames before the seek
//! position; `-copyts` and passing every frame through keep the container's times. `ffprobe`, of
//! the same package, reports what the container states (`ffprobe.rs`).

use super::ffprobe::Stream;
use super::process::{Patient, Process, as_file, fail_if_killed, output_of};
use super::{Capture, StatedProperties};
use crate::media::picture::byte_count;
use crate::media::{MediaError, Picture};
use std::io::{self, BufRead, BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::process::{ChildStderr, Command, Stdio};
use std::sync::LazyLock;
use touchline_core::geometry::ImageSize;

/// A seek starts this many frames before the wanted time, because times are rounded.
const SEEK_AHEAD_FRAMES: f64 = 0.5;

/// The programs `ffmpeg` and `ffprobe` of this machine.
#[derive(Debug)]
pub(super) struct Ffmpeg {
    /// The version as it states it: `5.1.9-0+deb12u1`.
    pub version: String,
    /// The option that passes every frame through with its own time; its name changed with version
    /// 5.1.
    pass_through: &'static str,
}

/// The programs; `None` if one of them cannot be run.
pub(super) fn ffmpeg() -> Option<&'static Ffmpeg> {
    // Once per process, because starting the two programs takes time.
    static FFMPEG: LazyLock<Option<Ffmpeg>> = LazyLock::new(|| {
        let version = stated_version(&version_text("ffmpeg")?)?;
        version_text("ffprobe")?;
        let pass_through = if is_before_5_1(&version) {
            "-vsync"
        } else {
            "-fps_mode"
        };
        Some(Ffmpeg {
            version,
            pass_through,
        })
    });
    FFMPEG.as_ref()
}

/// What a program says of its version; `None` if it cannot be run.
fn version_text(program: &str) -> Option<String> {
    output_of(Command::new(program).arg("-version")).ok()?
}

/// The version in `ffmpeg version 5.1.9 Copyright …`.
fn stated_version(output: &str) -> Option<String> {
    output
        .strip_prefix("ffmpeg version ")?
        .split_whitespace()
        .next()
        .map(str::to_owned)
}

/// Whether a version is a release before 5.1. A development build states no number and is new.
fn is_before_5_1(version: &str) -> bool {
    let mut numbers = version
        .trim_start_matches('n')
        .split(['.', '-', '+'])
        .map(str::parse::<u32>);
    match (numbers.next(), numbers.next()) {
        (Some(Ok(major)), Some(Ok(minor))) => (major, minor) < (5, 1),
        (Some(Ok(major)), _) => major < 5,
        _ => false,
    }
}

/// The output of a process for each frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Output {
    /// Its pixels, RGBA.
    Pictures,
    /// 2 × 2 px of it: only its time is needed, and nothing is converted.
    Times,
}

/// A video that `ffmpeg` reads.
pub(super) struct FfmpegCapture {
    program: &'static Ffmpeg,
    path: PathBuf,
    stream: Stream,
    output: Output,
    /// Position at which the next process begins, s from the stream's start; `None` for the first
    /// frame.
    start_s: Option<f64>,
    decoder: Option<Decoder>,
    /// The output for the last frame.
    bytes: Vec<u8>,
    time_s: Option<f64>,
}

impl FfmpegCapture {
    /// Opens a video that has been described, before its first frame. No process is started yet.
    ///
    /// # Errors
    /// There is no `ffmpeg`.
    pub(super) fn open(path: &Path, stream: Stream, output: Output) -> Result<Self, MediaError> {
        let program = ffmpeg().ok_or_else(|| MediaError::no_video_support(path))?;
        let bytes = match output {
            Output::Pictures => byte_count(stream.stated.size).unwrap_or(0),
            Output::Times => DOT_BYTES,
        };
        Ok(Self {
            program,
            path: path.to_path_buf(),
            stream,
            output,
            start_s: None,
            decoder: None,
            bytes: vec![0; bytes],
            time_s: None,
        })
    }

    /// Reads the next frame and its time; false at the end.
    fn read_frame(&mut self) -> io::Result<bool> {
        // The process starts with the first read after a seek, so that seeks in a row start only
        // one.
        let decoder = match &mut self.decoder {
            Some(decoder) => decoder,
            none => none.insert(Decoder::start(
                self.program,
                &self.path,
                &self.stream,
                self.output,
                self.start_s,
            )?),
        };
        // End of the pixels: only the exit of the process shows whether it is the end of the video.
        if !decoder.read_pixels(&mut self.bytes)? {
            decoder.check_end()?;
            return Ok(false);
        }
        // Time stamps count from an arbitrary origin; times here are relative to the stream's
        // start.
        let pts = decoder.read_time_stamp()?;
        self.time_s = pts.map(|pts| (pts - self.stream.start_pts) as f64 * self.stream.time_base_s);
        Ok(true)
    }
}

impl Capture for FfmpegCapture {
    fn stated_properties(&self) -> &StatedProperties {
        &self.stream.stated
    }

    fn grab(&mut self) -> Result<bool, MediaError> {
        self.read_frame().map_err(|error| MediaError::ReaderFailed {
            path: self.path.clone(),
            reader: "ffmpeg".to_owned(),
            reason: error.to_string(),
        })
    }

    fn time_s(&self) -> Option<f64> {
        self.time_s
    }

    fn restart(&mut self) -> Result<(), MediaError> {
        // Dropping the decoder ends its process.
        (self.decoder, self.start_s, self.time_s) = (None, None, None);
        Ok(())
    }

    fn jump_near(&mut self, time_s: f64) {
        self.decoder = None;
        self.start_s = Some(time_s - SEEK_AHEAD_FRAMES / self.stream.stated.fps);
        self.time_s = None;
    }

    fn picture(&mut self, index: usize) -> Result<Picture, MediaError> {
        Picture::new(self.stream.stated.size, self.bytes.clone()).map_err(|_| {
            MediaError::DamagedFrame {
                path: self.path.clone(),
                index,
                reason: "the decoder gave no picture".to_owned(),
            }
        })
    }
}

/// The bytes of [`Output::Times`]: 2 × 2 px of one byte each.
const DOT_BYTES: usize = 4;

/// A running process.
struct Decoder {
    process: Process,
    times: BufReader<Patient<ChildStderr>>,
    line: Vec<u8>,
}

impl Decoder {
    fn start(
        program: &Ffmpeg,
        path: &Path,
        stream: &Stream,
        output: Output,
        start_s: Option<f64>,
    ) -> io::Result<Self> {
        // `-ss` counts from the start of the file, which is that of its earliest stream. Before the
        // input it seeks to a key frame and decodes from there, without output up to the position.
        let from_s = start_s
            .map(|start_s| start_s + stream.late_s)
            .filter(|&from_s| from_s > 0.0);
        let seek = from_s.map(|from_s| ["-ss".to_owned(), format!("{from_s:.6}")]);
        let ImageSize { width, height } = stream.stated.size;
        let size = match output {
            Output::Pictures => format!("scale={width}:{height}:flags=bicubic,format=rgba"),
            Output::Times => "crop=2:2:0:0,format=gray".to_owned(),
        };
        // The filter prints only frames with some metadata, so one key is added to each. Unbuffered
        // (`direct`), so that a stamp is in its pipe before the pixels are. The colon is escaped
        // for the filter and once more for the graph of filters. Stamps come before scaling or
        // cropping.
        let stamp =
            "metadata=mode=add:key=t:value=0,metadata=mode=print:key=t:direct=1:file=pipe\\\\:2";
        let mut command = Command::new("ffmpeg");
        command
            .args([
                "-nostdin",
                "-v",
                "quiet",
                "-protocol_whitelist",
                "file",
                "-copyts",
            ])
            .args(seek.iter().flatten())
            .args(["-f", stream.demuxer, "-i"])
            .arg(as_file(path)?)
            .args([
                "-map",
                "0:V:0",
                "-vf",
                &format!("{stamp},{size}"),
                program.pass_through,
                "passthrough",
            ])
            .args(["-flush_packets", "1", "-f", "rawvideo", "pipe:1"])
            .stderr(Stdio::piped());
        let mut process = Process::start(&mut command)?;
        let times = process
            .take_errors()
            .ok_or_else(|| io::Error::other("it tells no times"))?;
        Ok(Self {
            process,
            times: BufReader::new(times),
            line: Vec::new(),
        })
    }

    /// Fills `bytes` with a frame; false at the end, also if only part of a frame is left.
    fn read_pixels(&mut self, bytes: &mut [u8]) -> io::Result<bool> {
        match self.process.output.read_exact(bytes) {
            Ok(()) => Ok(true),
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(false),
            Err(error) => Err(error),
        }
    }

    /// The time stamp of the frame whose pixels were read last, in steps of the stream's time base;
    /// `None` if it has none. Its line is written before the pixels, so this does not block.
    fn read_time_stamp(&mut self) -> io::Result<Option<i64>> {
        // The filter prints two lines for each frame, the stamp and the key. Whatever is not a
        // stamp is skipped, UTF-8 or not.
        loop {
            self.line.clear();
            if self.times.read_until(b'\n', &mut self.line)? == 0 {
                return Err(io::Error::other("it gave a frame and no time"));
            }
            if let Some(line) = str::from_utf8(&self.line)
                .ok()
                .filter(|line| line.starts_with("frame:"))
            {
                return Ok(time_stamp(line));
            }
        }
    }

    /// Fails if the process was killed.
    fn check_end(&mut self) -> io::Result<()> {
        // A damaged file makes it exit with an error code, after all frames that decode; that is no
        // failure here.
        fail_if_killed(self.process.wait()?)
    }
}

/// The stamp in `frame:12   pts:6144    pts_time:0.48`.
fn time_stamp(line: &str) -> Option<i64> {
    line.split_whitespace()
        .find_map(|word| word.strip_prefix("pts:"))?
        .parse()
        .ok()
}
