//! Videos through the user's `ffmpeg` program.
//!
//! One process decodes from some position to the end of the video and writes the pixels of each
//! frame to its standard output. Before these it writes the frame's time stamp to its standard
//! error, one line per frame and nothing else, since its own messages are switched off. So a frame
//! is identified by the time that the container gives it, not by counting. A seek ends the process
//! and starts one at another position. `ffmpeg` runs only as fast as its pipes are read; they are
//! the buffer.
//!
//! `ffmpeg` applies edit lists, turns frames upright and drops the frames before the seek position;
//! `-copyts` and passing every frame through keep the container's times. `ffprobe`, of the same
//! package, reports what the container states.

use super::capture::{Capture, StatedProperties};
use crate::media::picture::byte_count;
use crate::media::{MediaError, Picture};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::io::{self, BufRead, BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, ChildStdout, Command, Stdio};
use std::sync::LazyLock;
use std::time::Duration;
use touchline_core::geometry::ImageSize;

/// A process without output for this long is taken to hang.
const PATIENCE: Duration = Duration::from_secs(30);
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
    static FFMPEG: LazyLock<Option<Ffmpeg>> = LazyLock::new(|| {
        let version = stated_version(&output_of(Command::new("ffmpeg").arg("-version"))?)?;
        output_of(Command::new("ffprobe").arg("-version"))?;
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

/// The output of a short-lived program; `None` if it cannot be run or fails.
fn output_of(command: &mut Command) -> Option<String> {
    let output = command
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .output()
        .ok()?;
    output
        .status
        .success()
        .then(|| String::from_utf8_lossy(&output.stdout).into_owned())
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

/// The video's stream, as `ffprobe` describes it.
struct Stream {
    stated: StatedProperties,
    /// One step of its time stamps, s.
    time_base_s: f64,
    /// Its first time stamp, steps.
    start_pts: i64,
    /// Start of the stream relative to that of the file, s.
    late_s: f64,
}

impl FfmpegCapture {
    pub(super) fn open(path: &Path, output: Output) -> Result<Self, MediaError> {
        let program = ffmpeg().ok_or_else(|| MediaError::NoVideoSupport {
            path: path.to_path_buf(),
        })?;
        let stream = Stream::probe(path)?;
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
    fn stated(&self) -> &StatedProperties {
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
    process: Child,
    pixels: Patient<ChildStdout>,
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
        // `-ss` counts from the start of the file, which is that of its earliest stream.
        let from_s = start_s
            .map(|start_s| start_s + stream.late_s)
            .filter(|&from_s| from_s > 0.0);
        let seek = from_s.map(|from_s| ["-ss".to_owned(), format!("{from_s:.6}")]);
        let ImageSize { width, height } = stream.stated.size;
        let size = match output {
            Output::Pictures => format!("scale={width}:{height}:flags=bicubic,format=rgba"),
            Output::Times => "crop=2:2:0:0,format=gray".to_owned(),
        };
        // The filter prints only frames with some metadata, so one key is added to each.
        let stamp =
            "metadata=mode=add:key=t:value=0,metadata=mode=print:key=t:direct=1:file=pipe\\\\:2";
        let mut process = Command::new("ffmpeg")
            .args([
                "-nostdin",
                "-v",
                "quiet",
                "-protocol_whitelist",
                "file,pipe",
                "-copyts",
            ])
            .args(seek.iter().flatten())
            .arg("-i")
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
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        let (Some(pixels), Some(times)) = (process.stdout.take(), process.stderr.take()) else {
            return Err(io::Error::other("its output cannot be read"));
        };
        Ok(Self {
            process,
            pixels: Patient(pixels),
            times: BufReader::new(Patient(times)),
            line: Vec::new(),
        })
    }

    /// Fills `bytes` with a frame; false at the end, also if only part of a frame is left.
    fn read_pixels(&mut self, bytes: &mut [u8]) -> io::Result<bool> {
        match self.pixels.read_exact(bytes) {
            Ok(()) => Ok(true),
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(false),
            Err(error) => Err(error),
        }
    }

    /// The time stamp of the frame whose pixels were read last, in steps of the stream's time base;
    /// `None` if it has none. Its line is written before the pixels, so this does not block.
    fn read_time_stamp(&mut self) -> io::Result<Option<i64>> {
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
        let status = self.process.wait()?;
        // A damaged file makes it exit with an error code, after all frames that decode; that is no
        // failure here. A killed process has no exit code.
        if status.code().is_some() {
            Ok(())
        } else {
            Err(io::Error::other(format!("it was ended: {status}")))
        }
    }
}

impl Drop for Decoder {
    fn drop(&mut self) {
        // Both fail harmlessly if the process has already ended.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The stamp in `frame:12   pts:6144    pts_time:0.48`.
fn time_stamp(line: &str) -> Option<i64> {
    line.split_whitespace()
        .find_map(|word| word.strip_prefix("pts:"))?
        .parse()
        .ok()
}

/// A pipe that is read with [`PATIENCE`].
struct Patient<R>(R);

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

impl Stream {
    /// Reads the properties of the stream with `ffprobe`.
    ///
    /// # Errors
    /// It finds no video in the file.
    fn probe(path: &Path) -> Result<Self, MediaError> {
        let entries = "stream=codec_name,width,height,avg_frame_rate,r_frame_rate,nb_frames,start_pts,start_time,time_base,\
                       sample_aspect_ratio,duration:stream_side_data=rotation:format=duration,start_time";
        let file = as_file(path).map_err(|error| MediaError::from_io(path, &error))?;
        let mut command = probe_command(entries);
        let described = output_of(command.arg(file))
            .and_then(|output| Self::described_in(&Properties::read(&output)));
        described.ok_or_else(|| MediaError::NotAVideo {
            path: path.to_path_buf(),
        })
    }

    fn described_in(properties: &Properties) -> Option<Self> {
        let stream = |name: &str| properties.of_stream(name);
        // A codec that has no name has no decoder.
        stream("codec_name").filter(|&name| name != "unknown")?;
        let [width, height] =
            ["width", "height"].map(|name| stream(name)?.parse::<u32>().ok().filter(|&px| px > 0));
        let stored = ImageSize::new(width?, height?);
        // `ffprobe` states the rotation counterclockwise.
        let rotation_deg = (-properties.rotation_deg()).rem_euclid(360) as u32;
        let is_turned = rotation_deg % 180 == 90;
        let size = if is_turned {
            ImageSize::new(stored.height, stored.width)
        } else {
            stored
        };
        // The mean rate, over all frames, is preferred: it differs from the nominal one if frames
        // are missing.
        let [mean, nominal] =
            ["avg_frame_rate", "r_frame_rate"].map(|name| stream(name).and_then(ratio));
        let fps = mean.or(nominal).unwrap_or(25.0);
        let seconds = |text: Option<&str>| {
            text.and_then(|text| text.parse::<f64>().ok())
                .filter(|s| s.is_finite())
        };
        let duration_s =
            seconds(stream("duration")).or_else(|| seconds(properties.of_file("duration")));
        let counted = stream("nb_frames")
            .and_then(|count| count.parse().ok())
            .filter(|&count: &usize| count > 0);
        let frames = counted
            .or_else(|| duration_s.map(|duration_s| (duration_s * fps).round().max(0.0) as usize));
        let starts_s = [
            seconds(stream("start_time")),
            seconds(properties.of_file("start_time")),
        ];
        Some(Self {
            stated: StatedProperties {
                size,
                rotation_deg,
                fps,
                frames: frames.unwrap_or(0),
                pixel_aspect: stream("sample_aspect_ratio").and_then(ratio).unwrap_or(1.0),
            },
            time_base_s: stream("time_base").and_then(ratio)?,
            start_pts: stream("start_pts")
                .and_then(|pts| pts.parse().ok())
                .unwrap_or(0),
            late_s: starts_s[0]
                .zip(starts_s[1])
                .map_or(0.0, |(stream_s, file_s)| stream_s - file_s),
        })
    }
}

/// The number of stored frames by `ffprobe`, which does not decode them; `None` if it cannot count
/// them.
pub(super) fn count_packets(
    path: &Path,
    count: &mut dyn FnMut(usize) -> Result<(), MediaError>,
) -> Result<Option<usize>, MediaError> {
    let file = as_file(path).map_err(|error| MediaError::from_io(path, &error))?;
    let mut command = probe_command("packet=size");
    let process = command
        .arg(file)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn();
    let Ok(mut process) = process else {
        return Ok(None);
    };
    let mut packets = 0;
    for _ in process
        .stdout
        .take()
        .into_iter()
        .flat_map(|output| BufReader::new(Patient(output)).lines())
    {
        packets += 1;
        if let Err(stopped) = count(packets) {
            let _ = process.kill();
            let _ = process.wait();
            return Err(stopped);
        }
    }
    let is_whole = process.wait().is_ok_and(|status| status.success());
    Ok(is_whole.then_some(packets))
}

/// An `ffprobe` command for some entries of a file's first video stream, one per line.
fn probe_command(entries: &str) -> Command {
    let mut command = Command::new("ffprobe");
    command
        .args([
            "-v",
            "quiet",
            "-protocol_whitelist",
            "file,pipe",
            "-of",
            "flat",
            "-select_streams",
            "V:0",
        ])
        .args(["-show_entries", entries]);
    command
}

/// A path that `ffmpeg` cannot mistake for a protocol, as `a:b.mp4`, or for an option.
fn as_file(path: &Path) -> io::Result<OsString> {
    let mut file = OsString::from("file:");
    file.push(std::path::absolute(path)?);
    Ok(file)
}

/// The value of a ratio such as `30000/1001` or `4:3`; `None` if it is not positive.
fn ratio(text: &str) -> Option<f64> {
    let (above, below) = text.split_once(['/', ':'])?;
    let value = above.parse::<f64>().ok()? / below.parse::<f64>().ok()?;
    (value.is_finite() && value > 0.0).then_some(value)
}

/// The output of `ffprobe`, lines such as `streams.stream.0.width=1280`.
struct Properties(BTreeMap<String, String>);

impl Properties {
    fn read(output: &str) -> Self {
        let lines = output.lines().filter_map(|line| line.split_once('='));
        Self(
            lines
                .map(|(key, value)| (key.to_owned(), value.trim_matches('"').to_owned()))
                .collect(),
        )
    }

    fn of_stream(&self, name: &str) -> Option<&str> {
        self.0
            .get(&format!("streams.stream.0.{name}"))
            .map(String::as_str)
    }

    fn of_file(&self, name: &str) -> Option<&str> {
        self.0.get(&format!("format.{name}")).map(String::as_str)
    }

    /// Counterclockwise rotation to apply to the frames, degrees.
    fn rotation_deg(&self) -> i64 {
        let rotation = self.0.iter().find(|(key, _)| key.ends_with(".rotation"));
        rotation
            .and_then(|(_, degrees)| degrees.parse().ok())
            .unwrap_or(0)
    }
}
