//! What a container states about its video, as the program `ffprobe` reports it.

use super::container::no_video_in;
use super::process::{Process, as_file, output_of};
use super::{StatedProperties, turned_aspect};
use crate::media::MediaError;
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use touchline_core::geometry::ImageSize;

/// The video's stream, as `ffprobe` describes it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stream {
    /// The demuxer of its container.
    pub demuxer: &'static str,
    pub stated: StatedProperties,
    /// One step of its time stamps, s.
    pub time_base_s: f64,
    /// Its first time stamp, steps.
    pub start_pts: i64,
    /// Start of the stream relative to that of the file, s.
    pub late_s: f64,
}

impl Stream {
    /// Reads the properties of the stream with `ffprobe`.
    ///
    /// # Errors
    /// It finds no video in the file, hangs, or was killed.
    pub fn probe(path: &Path, demuxer: &'static str) -> Result<Self, MediaError> {
        let entries = "stream=codec_name,width,height,avg_frame_rate,r_frame_rate,nb_frames,start_pts,start_time,time_base,\
                       sample_aspect_ratio,duration:stream_side_data=rotation:format=duration,start_time";
        let file = as_file(path).map_err(|error| MediaError::from_io(path, &error))?;
        let mut command = probe_command(demuxer, entries);
        let output = output_of(command.arg(file)).map_err(|error| MediaError::ReaderFailed {
            path: path.to_path_buf(),
            reader: "ffprobe".to_owned(),
            reason: error.to_string(),
        })?;
        // Both a failure that `ffprobe` states by its exit code and an output without a video mean
        // that the file is none; only a program that does not run or end is a failure of the
        // reader.
        let described =
            output.and_then(|output| Self::from_properties(demuxer, &Properties::read(&output)));
        described.ok_or_else(|| no_video_in(path))
    }

    fn from_properties(demuxer: &'static str, properties: &Properties) -> Option<Self> {
        let stream = |name: &str| properties.stream_property(name);
        // A codec that has no name has no decoder.
        stream("codec_name").filter(|&name| name != "unknown")?;
        let [width, height] =
            ["width", "height"].map(|name| stream(name)?.parse::<u32>().ok().filter(|&px| px > 0));
        let stored = ImageSize::new(width?, height?);
        // `ffprobe` states the rotation counterclockwise.
        let rotation_deg = (-properties.rotation_deg()).rem_euclid(360) as u32;
        let size = if rotation_deg % 180 == 90 {
            ImageSize::new(stored.height, stored.width)
        } else {
            stored
        };
        // The mean rate, over all frames, is preferred: it differs from the nominal one if frames
        // are missing.
        let [mean, nominal] =
            ["avg_frame_rate", "r_frame_rate"].map(|name| stream(name).and_then(ratio));
        let fps = mean.or(nominal).unwrap_or(25.0);
        // Matroska states no duration of the stream, only of the file, and no number of frames.
        let duration_s = stream("duration")
            .and_then(finite_number)
            .or_else(|| properties.file_property("duration").and_then(finite_number));
        let counted = stream("nb_frames")
            .and_then(|count| count.parse().ok())
            .filter(|&count: &usize| count > 0);
        let frames = counted
            .or_else(|| duration_s.map(|duration_s| (duration_s * fps).round().max(0.0) as usize));
        let stored_aspect = stream("sample_aspect_ratio").and_then(ratio).unwrap_or(1.0);
        let starts_s = [stream("start_time"), properties.file_property("start_time")]
            .map(|text| text.and_then(finite_number));
        Some(Self {
            demuxer,
            stated: StatedProperties {
                size,
                rotation_deg,
                fps,
                frames: frames.unwrap_or(0),
                pixel_aspect: turned_aspect(stored_aspect, rotation_deg),
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
    demuxer: &str,
    count: &mut dyn FnMut(usize) -> Result<(), MediaError>,
) -> Result<Option<usize>, MediaError> {
    let file = as_file(path).map_err(|error| MediaError::from_io(path, &error))?;
    let mut command = probe_command(demuxer, "packet=size");
    command.arg(file).stderr(Stdio::null());
    // No count is no failure: the survey then decodes all frames. If `count` stops it, the process
    // ends as it is dropped.
    let Ok(mut process) = Process::start(&mut command) else {
        return Ok(None);
    };
    let mut packets = 0;
    for line in BufReader::new(&mut process.output).lines() {
        if line.is_err() {
            return Ok(None);
        }
        packets += 1;
        count(packets)?;
    }
    let is_whole = process.wait().is_ok_and(|status| status.success());
    Ok(is_whole.then_some(packets))
}

/// An `ffprobe` command for some entries of a file's first video stream, one per line.
fn probe_command(demuxer: &str, entries: &str) -> Command {
    // The demuxer is named, so that no file is followed as a list of others (`container.rs`). `V`
    // leaves out streams that are cover pictures.
    let mut command = Command::new("ffprobe");
    command
        .args([
            "-v",
            "quiet",
            "-protocol_whitelist",
            "file",
            "-f",
            demuxer,
            "-of",
            "flat",
            "-select_streams",
            "V:0",
        ])
        .args(["-show_entries", entries]);
    command
}

/// A number, unless it is infinite or NaN.
fn finite_number(text: &str) -> Option<f64> {
    text.parse::<f64>().ok().filter(|number| number.is_finite())
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

    fn stream_property(&self, name: &str) -> Option<&str> {
        self.0
            .get(&format!("streams.stream.0.{name}"))
            .map(String::as_str)
    }

    fn file_property(&self, name: &str) -> Option<&str> {
        self.0.get(&format!("format.{name}")).map(String::as_str)
    }

    /// Counterclockwise rotation to apply to the frames, degrees.
    fn rotation_deg(&self) -> i64 {
        // The number of the side data in the key differs from file to file.
        let rotation = self.0.iter().find(|(key, _)| key.ends_with(".rotation"));
        rotation
            .and_then(|(_, degrees)| degrees.parse().ok())
            .unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn size_and_pixels_of_a_video_on_its_side_are_those_of_the_upright_frames() {
        for (rotation, size, aspect) in [
            (0, ImageSize::new(720, 576), 16.0 / 15.0),
            (-90, ImageSize::new(576, 720), 15.0 / 16.0),
        ] {
            let output = format!(
                "streams.stream.0.codec_name=\"h264\"\n\
                 streams.stream.0.width=720\n\
                 streams.stream.0.height=576\n\
                 streams.stream.0.sample_aspect_ratio=\"16:15\"\n\
                 streams.stream.0.time_base=\"1/12800\"\n\
                 streams.stream.0.side_data_list.side_data.0.rotation={rotation}\n"
            );
            let stated = Stream::from_properties("mov", &Properties::read(&output))
                .unwrap()
                .stated;
            assert_eq!(stated.size, size);
            assert!((stated.pixel_aspect - aspect).abs() < 1e-12, "{stated:?}");
        }
    }
}
