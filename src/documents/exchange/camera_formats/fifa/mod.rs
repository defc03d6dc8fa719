//! The cameras of the FIFA Skeletal Tracking tasks: one archive of `NumPy` arrays per video, with
//! one row per frame.
//!
//! | array | shape | what it is |
//! |---|---|---|
//! | `K` | (n, 3, 3) | fx, fy, principal point; no skew; pixel centres at whole numbers |
//! | `k` | (n, 2 or more) | OpenCV's k1, k2, p1, p2, k3 on normalised coordinates; all but k1 and k2 are zero |
//! | `R` | (1 or n, 3, 3) | camera from world: x right, y down, z ahead in the camera; x along the pitch, y away, z up in the world |
//! | `t` | (1 or n, 3) | −R C, m; the origin is the pitch's centre on the ground |
//!
//! The tasks give `R` and `t` of the first frame only. Every other frame is then read with a known
//! lens and unknown pan and tilt. Each frame has its own lens and principal point, because in such
//! files both change with the zoom, and not linearly. The files state no picture size; those of the
//! tasks are of 1920 × 1080 px. Source: the description of the data in the tasks' starter kit, and
//! the projection in its baseline.

mod arrays;
mod lenses;

use crate::document::{Document, FieldSpec};
use crate::exchange::cameras::camera_format::{
    CameraFormat, HeldFrame, SequenceScope, WriteContext,
};
use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection};
use crate::exchange::cameras::held::{note_several_cameras, parts};
use crate::exchange::cameras::into_document::{Exactness, View};
use crate::exchange::cameras::picture_size::SizeSource;
use crate::exchange::error::{ExchangeResult, Problem};
use crate::exchange::files::{Files, stem};
use crate::exchange::format::About;
use crate::exchange::format_options::{self, FormatOption};
use crate::exchange::options::{ImportOptions, Rotations};
use crate::exchange::syntax::npz::{Npz, archive_to_bytes};
use arrays::{Sequence, arrays_of};
pub(super) use lenses::document_with_lenses;
use touchline_core::geometry::ImageSize;

/// The format.
pub struct Fifa;

/// The size of the tasks' pictures.
const SET_SIZE: ImageSize = ImageSize::new(1920, 1080);
/// The name of an exported file, without its extension.
const STEM: &str = "cameras";
/// The arrays that are read.
const ARRAYS: [&str; 4] = ["K", "k", "R", "t"];

/// The name of a frame by its video and number.
fn name_of(video: &str, index: usize) -> String {
    format!("{video}#{index:06}")
}

impl CameraFormat for Fifa {
    fn about(&self) -> About {
        About {
            name: "fifa",
            title: "FIFA Skeletal Tracking cameras, one .npz per video",
            conventions: "touchline's world → camera, R and t; pixel centres at whole numbers; a lens per frame",
            users: "FIFA Skeletal Tracking tasks, NumPy",
            loses: Some("size of the picture, numbers and times of frames, uncertainty"),
            file: Some("cameras.npz"),
            files: "archives of arrays (.npz)",
            endings: &["npz"],
            export_options: &[
                FormatOption::Size,
                FormatOption::Interpolate,
                FormatOption::Takes,
                FormatOption::Rotations,
            ],
            import_options: format_options::CAMERAS_IN,
        }
    }

    fn hold(&self, frame: &FrameCamera, index: usize, context: &WriteContext<'_>) -> HeldFrame {
        let (pinhole, _) = parts(frame)?;
        // As the tasks give their files: the pose of the first frame alone.
        let is_open = context.options.rotations == Rotations::First && index > 0;
        let shown = if is_open {
            FrameProjection::Lens(pinhole.known_lens())
        } else {
            frame.shown
        };
        Ok(FrameCamera {
            name: name_of(&format!("{STEM}.mp4"), index),
            shown,
            ..frame.clone()
        })
    }

    fn size_source(&self) -> SizeSource {
        SizeSource::Assumed
    }

    fn exactness(&self) -> Exactness {
        // The tasks' rotations and translations have float32 precision: 4e-8, and 5e-6 m at 80 m.
        Exactness {
            angle_rad: 1e-6,
            place_m: 1e-4,
        }
    }

    fn document(&self, field: FieldSpec, frames: &[View]) -> Document {
        document_with_lenses(field, frames, self.exactness())
    }

    fn notes(&self, frames: &[FrameCamera], _context: &WriteContext<'_>) -> Vec<String> {
        // A reader takes the row for the frame's number, so that the first row of another number is
        // worth a note.
        let numbered = frames
            .iter()
            .enumerate()
            .filter_map(|(row, frame)| Some((row, frame.frame_index?)));
        let mut others = numbered.filter(|(row, number)| *row as u64 != *number);
        let first = others.next();
        let note = first.map(|(row, number)| {
            format!("rows carry no frame numbers: row {row} is frame {number} of the video, for frames without a camera have no row")
        });
        note.into_iter()
            .chain(note_several_cameras(frames))
            .collect()
    }

    fn sequence(&self) -> Option<SequenceScope> {
        Some(SequenceScope::All)
    }

    fn write(&self, held: &[FrameCamera], _context: &WriteContext<'_>) -> ExchangeResult<Files> {
        Ok(Files::one(
            &format!("{STEM}.npz"),
            archive_to_bytes(&arrays_of(held)),
        ))
    }

    fn unread(&self, files: &Files) -> Vec<String> {
        let sorted = files.sorted_entries();
        let archives = sorted.iter().filter_map(|(_, bytes)| Npz::open(bytes).ok());
        let mut others: Vec<String> = archives
            .flat_map(|archive| archive.names().map(ToOwned::to_owned).collect::<Vec<_>>())
            .collect();
        others.retain(|name| !ARRAYS.contains(&name.as_str()));
        others.sort_unstable();
        others.dedup();
        if others.is_empty() {
            Vec::new()
        } else {
            vec![format!("not read: {}", others.join(", "))]
        }
    }

    fn read(&self, files: &Files, options: &ImportOptions) -> ExchangeResult<Vec<FrameCamera>> {
        files.read_all(|name, bytes| {
            let sequence = Sequence::read(bytes)?;
            // The tasks name a video and its cameras alike.
            let video = format!("{}.mp4", stem(name));
            let size = options.size.unwrap_or(SET_SIZE);
            (0..sequence.frames)
                .map(|index| read_frame(&sequence, index, &video, size))
                .collect::<Result<Vec<_>, Problem>>()
        })
    }
}

/// A frame of a file; `video` is the file name of the video that it belongs to.
fn read_frame(
    sequence: &Sequence,
    index: usize,
    video: &str,
    size: ImageSize,
) -> Result<FrameCamera, Problem> {
    let (shown, off_px) = sequence
        .projection(index, size)
        .map_err(|problem| problem.at_frame(index))?;
    Ok(FrameCamera {
        video: Some(video.to_owned()),
        frame_index: Some(index as u64),
        off_px,
        ..FrameCamera::new(&name_of(video, index), Some(size), shown)
    })
}

#[cfg(test)]
mod tests;
