//! Common Data Format (football match data, schema 0.3.2): the metadata sheet of a video, as a
//! small file beside an export. Export only.
//!
//! Axes and units are ours: the pitch's centre, metres, x along the touchlines, z up. It holds the
//! camera's *place* only: no angles, no focal length, no lens, no frames. Frame rates are whole
//! numbers, so 29.97 cannot be stored. Match, start and perspective are not in a document; the user
//! must give them. Source: common-data-format-validator 0.1.1 (`schema/video.json`); arXiv
//! 2505.15820.

use crate::exchange::cameras::camera_format::{CameraFormat, HeldFrame, WriteContext};
use crate::exchange::cameras::frame_camera::FrameCamera;
use crate::exchange::cameras::held::{cannot_hold, parts};
use crate::exchange::error::{ExchangeError, ExchangeResult};
use crate::exchange::files::Files;
use crate::exchange::format::{About, Format};
use crate::exchange::format_options::FormatOption;
use crate::exchange::options::ImportOptions;
use serde_json::json;

/// The format.
pub struct Cdf;

/// Cameras nearer to each other than this count as one, m.
const SAME_PLACE_M: f64 = 1e-6;

/// A value that the sheet needs and that has to be given.
fn require<T>(value: Option<T>, what: &'static str, option: &'static str) -> ExchangeResult<T> {
    value.ok_or(ExchangeError::ExportNeeds {
        format: Format::Cdf,
        what,
        option,
    })
}

impl CameraFormat for Cdf {
    fn about(&self) -> About {
        About {
            name: "cdf",
            title: "Common Data Format: the sheet of a video",
            conventions: "touchline's world; the camera's position, m",
            users: "the Common Data Format and its validator",
            loses: Some(
                "everything but the camera's position, the picture size and the frame rate",
            ),
            file: Some("video.json"),
            files: "sheet (.json)",
            endings: &[],
            export_options: &[
                FormatOption::Size,
                FormatOption::Fps,
                FormatOption::MatchId,
                FormatOption::StartTime,
                FormatOption::Perspective,
                FormatOption::Automated,
            ],
            import_options: &[],
        }
    }

    fn hold(&self, frame: &FrameCamera, index: usize, _context: &WriteContext<'_>) -> HeldFrame {
        parts(frame)?;
        Ok(frame.with_name(format!("{index:06}")))
    }

    fn notes(&self, _frames: &[FrameCamera], _context: &WriteContext<'_>) -> Vec<String> {
        let said = "it holds only the camera's position, the picture size and the frame rate: no angles, focal length, lens or frames";
        vec![
            said.to_owned(),
            "the list of whistles is empty; fill it in where it is known".to_owned(),
        ]
    }

    fn write(&self, held: &[FrameCamera], context: &WriteContext<'_>) -> ExchangeResult<Files> {
        let recording = &context.options.recording;
        // What a document does not know has to be given and never invented: an invented start would
        // shift every event of the match.
        let match_id = require(
            recording.match_id.as_deref(),
            "the match's id",
            "--match-id",
        )?;
        let start = require(
            recording.start.as_deref(),
            "when the video begins",
            "--start-time",
        )?;
        let perspective = require(
            recording.perspective.as_deref(),
            "the camera's perspective",
            "--perspective",
        )?;
        let rate = require(context.rate, "the frame rate", "--fps")?;
        let mut frames = held.iter();
        let Some(first) = frames.next() else {
            return Ok(Files::default());
        };
        let (pinhole, size) = parts(first).map_err(|why| cannot_hold(first, Format::Cdf, why))?;
        // The position is all that the sheet says of a camera, so that all frames must share it.
        for frame in frames {
            let (other, other_size) =
                parts(frame).map_err(|why| cannot_hold(frame, Format::Cdf, why))?;
            if other_size != size || (other.position_m - pinhole.position_m).amax() > SAME_PLACE_M {
                let why = "a sheet describes one camera; choose one with --camera";
                return Err(cannot_hold(frame, Format::Cdf, why.to_owned()));
            }
        }
        // The schema has `fps` as an integer; 30 for 29.97 would be off by a frame every 33 s.
        if rate.frames % rate.seconds != 0 {
            let why = format!(
                "its frame rates are whole numbers, and {:.2} frames per second is not",
                rate.per_second()
            );
            return Err(cannot_hold(first, Format::Cdf, why));
        }
        let operation = if recording.is_automated {
            "automated"
        } else {
            "manual"
        };
        let at = pinhole.position_m;
        let sheet = json!({
            "match": { "id": match_id },
            "recording": {
                "fps": rate.frames / rate.seconds,
                "resolution": format!("{}x{}", size.width, size.height),
                "start_time": start,
                "type": "fixed camera",
                "operation_type": operation,
                "perspective": perspective,
                "camera": { "x": at.x, "y": at.y, "z": at.z },
            },
            "whistles": [],
        });
        Ok(Files::one(
            "video.json",
            format!("{sheet:#}\n").into_bytes(),
        ))
    }

    fn read(&self, _files: &Files, _options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        Err(ExchangeError::OneWay {
            format: Format::Cdf,
            what: "imported",
            instead: "exported",
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::exchange::export;
    use crate::exchange::tests::{reference, text_of};
    use crate::exchange::{ExportOptions, Format, Rate, Recording};
    use serde_json::{Value, json};
    use std::path::Path;

    fn options() -> ExportOptions {
        let recording = Recording {
            match_id: Some("m1".to_owned()),
            start: Some("2026-03-01T18:59:30Z".to_owned()),
            perspective: Some("camera_1".to_owned()),
            is_automated: false,
        };
        ExportOptions {
            recording,
            ..ExportOptions::default()
        }
    }

    fn refusal(options: &ExportOptions) -> String {
        export(reference().at(Path::new("/")), Format::Cdf, options)
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn the_sheet_has_the_published_keys_and_no_other() {
        let exported = export(reference().at(Path::new("/")), Format::Cdf, &options()).unwrap();
        let sheet: Value = serde_json::from_str(&text_of(&exported.files, "video.json")).unwrap();
        let wanted = json!({
            "match": { "id": "m1" },
            "recording": {
                "fps": 25, "resolution": "1920x1080", "start_time": "2026-03-01T18:59:30Z", "type": "fixed camera",
                "operation_type": "manual", "perspective": "camera_1", "camera": { "x": 0.0, "y": -60.0, "z": 18.0 },
            },
            "whistles": [],
        });
        assert_eq!(sheet, wanted);
    }

    #[test]
    fn missing_values_are_requested_and_a_fractional_rate_is_refused() {
        assert_eq!(
            refusal(&ExportOptions::default()),
            "cdf needs the match's id; give --match-id"
        );
        let mut silent = options();
        silent.recording.start = None;
        assert_eq!(
            refusal(&silent),
            "cdf needs when the video begins; give --start-time"
        );
        let ntsc = ExportOptions {
            rate: Some(Rate::new(30_000, 1001)),
            ..options()
        };
        assert!(
            refusal(&ntsc)
                .ends_with("its frame rates are whole numbers, and 29.97 frames per second is not")
        );
    }
}
