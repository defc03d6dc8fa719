//! The cameras of the FIFA Skeletal Tracking tasks: one archive of `NumPy` arrays per video, with
//! one row per frame.
//!
//! | array | shape | what it is |
//! |---|---|---|
//! | `K` | (n, 3, 3) | f, principal point; square pixels, no skew; pixel centres at whole numbers |
//! | `k` | (n, 2 or more) | OpenCV's k1, k2, p1, p2, k3 on normalised coordinates; all but k1 and k2 are zero |
//! | `R` | (1 or n, 3, 3) | camera from world: x right, y down, z ahead in the camera; x along the pitch, y away, z up in the world |
//! | `t` | (1 or n, 3) | −R C, m; the origin is the pitch's centre on the ground |
//!
//! The tasks give `R` and `t` of the first frame only. Every other frame is then read with a known
//! lens and unknown pan and tilt. Each frame has its own lens and principal point, because in such
//! files both change with the zoom, and not linearly. The files state no picture size; those of the
//! tasks are of 1920 × 1080 px. Source: the description of the data in the tasks' starter kit, and
//! the projection in its baseline.

use super::camera_format::{CameraFormat, WriteContext, has_ending};
use super::error::{ExchangeError, Problem};
use super::files::Files;
use super::frame_camera::{FrameCamera, KnownLens, Pinhole, Shown};
use super::held::parts;
use super::into_document::{Exactness, View, document_of, unsolved_frame};
use super::npy::Array;
use super::npz::{Npz, written};
use super::options::{ImportOptions, Pixels, Rotations};
use super::picture_size::SizeSource;
use super::values::are_oblong_pixels;
use crate::document::{Camera, CameraId, Document, FieldSpec, Frame, FrameLens, FramePtz};
use std::collections::BTreeMap;
use std::path::Path;
use touchline_core::camera::Radial;
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec3};

/// The format.
pub struct Fifa;

/// The size of the tasks' pictures.
const SET_SIZE: ImageSize = ImageSize::new(1920, 1080);
/// The name of an exported file, without its extension.
const STEM: &str = "cameras";
/// The arrays that are read.
const ARRAYS: [&str; 4] = ["K", "k", "R", "t"];
/// The coefficients that an export writes for a frame: k1, k2, p1, p2, k3.
const COEFFICIENTS: usize = 5;
/// The maximum number of frames of a file: five hours at 50 frames per second.
const MAX_FRAMES: usize = 900_000;

/// The name of a frame by its video and number.
fn name_of(video: &str, index: usize) -> String {
    format!("{video}#{index:06}")
}

/// The shape of an array in a message.
fn shape_text(shape: &[usize]) -> String {
    let sides: Vec<String> = shape.iter().map(ToString::to_string).collect();
    format!("({})", sides.join(", "))
}

/// Refuses an array of another shape.
fn check_shape(
    name: &str,
    array: &Array,
    is_right: bool,
    wanted: &'static str,
) -> Result<(), Problem> {
    if is_right {
        return Ok(());
    }
    Err(Problem::Kind {
        what: format!("the shape of {name}"),
        wanted,
        found: shape_text(&array.shape),
    })
}

/// The arrays of a file, with shapes that fit together.
struct Sequence {
    calibrations: Array,
    distortions: Array,
    /// Rotations and translations, equal in number.
    poses: Option<(Array, Array)>,
    frames: usize,
}

impl Sequence {
    fn read(bytes: &[u8]) -> Result<Self, Problem> {
        let archive = Npz::open(bytes)?;
        let (calibrations, distortions) = (archive.array("K")?, archive.array("k")?);
        let frames = calibrations.shape.first().copied().unwrap_or(0);
        let has_k = calibrations.shape == [frames, 3, 3] && (1..=MAX_FRAMES).contains(&frames);
        check_shape(
            "K",
            &calibrations,
            has_k,
            "(frames, 3, 3), at most 900 000 frames,",
        )?;
        let is_right =
            matches!(distortions.shape[..], [rows, numbers] if rows == frames && numbers >= 2);
        check_shape(
            "k",
            &distortions,
            is_right,
            "(frames, 2 or 5), as many frames as K has,",
        )?;
        let poses = match (archive.find("R")?, archive.find("t")?) {
            (None, None) => None,
            (Some(rotations), Some(translations)) => {
                let count = rotations.shape.first().copied().unwrap_or(0);
                let is_right = rotations.shape == [count, 3, 3] && (count == 1 || count == frames);
                check_shape("R", &rotations, is_right, "(1, 3, 3) or (frames, 3, 3)")?;
                let is_right = translations.shape == [count, 3];
                check_shape(
                    "t",
                    &translations,
                    is_right,
                    "(1, 3) or (frames, 3), as R has,",
                )?;
                Some((rotations, translations))
            }
            (Some(_), None) => return Err(Problem::Missing("the array t".to_owned())),
            (None, Some(_)) => return Err(Problem::Missing("the array R".to_owned())),
        };
        Ok(Self {
            calibrations,
            distortions,
            poses,
            frames,
        })
    }

    /// The projection of a frame: a camera if the file has its rotation and translation, else its
    /// lens.
    fn shown(&self, frame: usize) -> Result<Shown, Problem> {
        let lens = lens_of(self.calibrations.row(frame), self.distortions.row(frame))?;
        if let Some((rotations, translations)) = &self.poses
            && let &[x, y, z] = translations.row(frame)
        {
            let cam_from_world = Mat3::from_row_slice(rotations.row(frame));
            let position_m = -(cam_from_world.transpose() * Vec3::new(x, y, z));
            let pinhole = Pinhole {
                cam_from_world,
                position_m,
                ..lens.unpointed()
            };
            return Ok(Shown::Camera(pinhole.checked("the camera")?));
        }
        lens.unpointed()
            .checked("the camera")
            .map(|_| Shown::Lens(lens))
    }
}

/// The lens that a frame's rows of `K` and `k` state.
fn lens_of(calibration: &[f64], distortion: &[f64]) -> Result<KnownLens, Problem> {
    let &[fx, skew, cx, a, fy, cy, b, c, scale] = calibration else {
        return Err(Problem::Count {
            what: "K".to_owned(),
            wanted: 9,
            found: calibration.len(),
        });
    };
    if !calibration
        .iter()
        .chain(distortion)
        .all(|number| number.is_finite())
    {
        return Err(Problem::NotFinite("a number of K or k".to_owned()));
    }
    if are_oblong_pixels(fx, fy) || [skew, a, b, c] != [0.0; 4] || scale != 1.0 {
        let what = format!(
            "K with focal lengths of {fx} and {fy} px, skew {skew} and last row {b}, {c}, {scale}"
        );
        return Err(Problem::Unsupported {
            what,
            why: "pixels must be square, without skew",
        });
    }
    if let Some(other) = distortion.iter().skip(2).find(|number| **number != 0.0) {
        let what = format!("a distortion coefficient of {other} beyond k1 and k2");
        return Err(Problem::Unsupported {
            what,
            why: "the document's lens has k1 and k2 only",
        });
    }
    let shift = Pixels::Centre.to_corner_px();
    Ok(KnownLens {
        focal_px: fx,
        principal_point: ImagePoint::new(cx + shift, cy + shift),
        radial: Radial {
            k1: distortion[0],
            k2: distortion[1],
        },
    })
}

/// The arrays of some frames.
fn arrays_of(held: &[FrameCamera]) -> Vec<(&'static str, Array)> {
    let shift = Pixels::Centre.to_corner_px();
    let (mut calibrations, mut distortions) = (Vec::new(), Vec::new());
    let (mut rotations, mut translations) = (Vec::new(), Vec::new());
    for frame in held {
        let lens = match frame.shown {
            Shown::Camera(pinhole) => {
                rotations.extend(pinhole.cam_from_world.transpose().iter());
                translations.extend(pinhole.translation().iter());
                pinhole.known_lens()
            }
            Shown::Lens(lens) => lens,
            Shown::Ground(_) | Shown::Nothing => continue,
        };
        let (cx, cy) = (
            lens.principal_point.x - shift,
            lens.principal_point.y - shift,
        );
        calibrations.extend([
            lens.focal_px,
            0.0,
            cx,
            0.0,
            lens.focal_px,
            cy,
            0.0,
            0.0,
            1.0,
        ]);
        distortions.extend([lens.radial.k1, lens.radial.k2, 0.0, 0.0, 0.0]);
    }
    let (frames, poses) = (distortions.len() / COEFFICIENTS, translations.len() / 3);
    vec![
        (
            "K",
            Array {
                shape: vec![frames, 3, 3],
                values: calibrations,
            },
        ),
        (
            "k",
            Array {
                shape: vec![frames, COEFFICIENTS],
                values: distortions,
            },
        ),
        (
            "R",
            Array {
                shape: vec![poses, 3, 3],
                values: rotations,
            },
        ),
        (
            "t",
            Array {
                shape: vec![poses, 3],
                values: translations,
            },
        ),
    ]
}

impl CameraFormat for Fifa {
    fn hold(
        &self,
        frame: &FrameCamera,
        index: usize,
        context: &WriteContext<'_>,
    ) -> Result<FrameCamera, String> {
        let (pinhole, _) = parts(frame)?;
        let is_open = context.options.rotations == Rotations::First && index > 0;
        let shown = if is_open {
            Shown::Lens(pinhole.known_lens())
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
        let numbered = frames
            .iter()
            .enumerate()
            .filter_map(|(row, frame)| Some((row, frame.frame_index?)));
        let mut others = numbered.filter(|(row, number)| *row as u64 != *number);
        let first = others.next();
        let note = first.map(|(row, number)| {
            format!("rows carry no frame numbers: row {row} is frame {number} of the video, for frames without a camera have no row")
        });
        note.into_iter().collect()
    }

    fn write(
        &self,
        held: &[FrameCamera],
        _context: &WriteContext<'_>,
    ) -> Result<Files, ExchangeError> {
        Ok(Files::one(
            &format!("{STEM}.npz"),
            written(&arrays_of(held)),
        ))
    }

    fn wanted(&self) -> &'static str {
        "archives of arrays (.npz)"
    }

    fn is_wanted(&self, name: &str) -> bool {
        has_ending(name, "npz")
    }

    fn unread(&self, files: &Files) -> Vec<String> {
        let sorted = files.sorted();
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

    fn read(
        &self,
        files: &Files,
        options: &ImportOptions,
    ) -> Result<Vec<FrameCamera>, ExchangeError> {
        files.read_all(|name, bytes| {
            let sequence = Sequence::read(bytes)?;
            let stem = Path::new(name)
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy();
            let video = format!("{stem}.mp4");
            let size = options.size.unwrap_or(SET_SIZE);
            let frame = |index: usize| {
                let shown = sequence
                    .shown(index)
                    .map_err(|problem| problem.at_frame(index))?;
                Ok(FrameCamera {
                    video: Some(video.clone()),
                    frame_index: Some(index as u64),
                    ..FrameCamera::new(&name_of(&video, index), Some(size), shown)
                })
            };
            (0..sequence.frames)
                .map(frame)
                .collect::<Result<Vec<_>, Problem>>()
        })
    }
}

/// A document in which every frame has a lens of its own.
///
/// Frames with one position and one pan axis share a camera, whatever their lenses. The camera's
/// lens is that of its first frame. Frames of which only the lens is known belong to the first
/// camera of their video; they have the status `new` and no `ptz`.
fn document_with_lenses(field: FieldSpec, frames: &[View], exact: Exactness) -> Document {
    let mut posed: Vec<View> = frames
        .iter()
        .filter(|(frame, _, _)| frame.pinhole().is_some())
        .cloned()
        .collect();
    if let Some(first) = posed.first().map(|(_, _, view)| view.known_lens()) {
        for (_, _, view) in &mut posed {
            (view.principal_point, view.lens) = (first.principal_point, first.radial);
        }
    }
    let mut document = document_of(field, &posed, exact);

    // Merge both kinds back in the order of the file: `solved` has the posed frames in that order.
    let mut solved: std::vec::IntoIter<Frame> = document
        .frames
        .iter()
        .map(|frame| Frame::clone(frame))
        .collect::<Vec<_>>()
        .into_iter();
    let mut camera_of_video: BTreeMap<Option<String>, CameraId> = BTreeMap::new();
    let mut made = Vec::with_capacity(frames.len());
    for (read, size, view) in frames {
        let lens = FrameLens::new(view.focal_px, view.principal_point, view.lens);
        let frame = if read.pinhole().is_some() {
            solved.next().map(|frame| {
                let ptz = frame.ptz.as_ref().map(FramePtz::ptz);
                let recorded = Some(view.lens).filter(|lens| !lens.is_none());
                Frame {
                    ptz: ptz.map(|ptz| FramePtz::new(ptz, recorded)),
                    ..frame
                }
            })
        } else {
            let camera = camera_of_video
                .get(&read.video)
                .cloned()
                .unwrap_or_else(|| "main".into());
            if !document.cameras.iter().any(|known| known.id == camera) {
                document
                    .cameras
                    .push(Camera::new(camera.clone(), *size).into());
            }
            Some(unsolved_frame(read, camera, *size))
        };
        if let Some(frame) = frame {
            camera_of_video
                .entry(read.video.clone())
                .or_insert_with(|| frame.camera.clone());
            made.push(
                Frame {
                    lens: Some(lens),
                    ..frame
                }
                .into(),
            );
        }
    }
    document.frames = made.into_iter().collect();
    document
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::FrameStatus;
    use crate::exchange::tests::{awkward, exported, reference};
    use crate::exchange::{ExportOptions, Exported, Format, export, import};

    /// The arrays of an export.
    fn arrays(exported: &Exported) -> BTreeMap<String, Array> {
        let bytes = exported.files.get("cameras.npz").unwrap();
        let archive = Npz::open(bytes).unwrap();
        archive
            .names()
            .map(|name| (name.to_owned(), archive.array(name).unwrap()))
            .collect()
    }

    /// The document of an archive's bytes.
    fn imported(name: &str, bytes: &[u8]) -> Document {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        import(&path, Format::Fifa, &ImportOptions::default())
            .unwrap()
            .document
    }

    #[test]
    fn the_reference_camera_has_the_published_numbers() {
        let exported = exported(&reference(), Format::Fifa);
        let arrays = arrays(&exported);
        assert_eq!(arrays["K"].shape, [1, 3, 3]);
        assert_eq!(
            arrays["K"].values,
            [2410.0, 0.0, 959.5, 0.0, 2410.0, 539.5, 0.0, 0.0, 1.0]
        );
        assert_eq!(
            (&arrays["k"].shape[..], arrays["k"].values[0]),
            (&[1, 5][..], 0.0661)
        );
        for (found, wanted) in arrays["t"].values.iter().zip([
            -12.986376836286173,
            6.279379503790085,
            60.95837440182727,
        ]) {
            assert!((found - wanted).abs() < 1e-12, "{arrays:?}");
        }
        assert!(
            exported.notes[0].starts_with("rows carry no frame numbers: row 0 is frame 412"),
            "{:?}",
            exported.notes
        );
    }

    #[test]
    fn awkward_cameras_come_back_with_a_lens_a_frame() {
        let exported = exported(&awkward(), Format::Fifa);
        assert!(
            exported.loss.is_none() && exported.worst_px < 1e-6,
            "{exported:?}"
        );
        let document = imported("ARG_CRO.npz", exported.files.get("cameras.npz").unwrap());
        assert_eq!((document.cameras.len(), document.frames.len()), (1, 12));
        let video = document.frames[3].video.as_ref().unwrap();
        assert_eq!((video.path.as_str(), video.frame_index), ("ARG_CRO.mp4", 3));
        for (frame, before) in document.frames.iter().zip(&awkward().frames) {
            let (lens, camera) = (
                frame.lens.as_ref().unwrap(),
                awkward().pointed(before).unwrap(),
            );
            assert_eq!(
                (lens.focal_px, lens.radial()),
                (camera.ptz().focal_px, camera.lens())
            );
            assert_eq!(frame.ptz.as_ref().unwrap().lens(), Some(lens.radial()));
        }
    }

    #[test]
    fn frames_without_a_rotation_keep_their_lens_and_have_no_pan_and_tilt() {
        let options = ExportOptions {
            rotations: Rotations::First,
            ..ExportOptions::default()
        };
        let exported = export(awkward().at(Path::new("/")), Format::Fifa, &options).unwrap();
        assert_eq!(
            (
                arrays(&exported)["K"].shape[0],
                &arrays(&exported)["t"].shape[..]
            ),
            (12, &[1, 3][..])
        );
        let document = imported("a.npz", exported.files.get("cameras.npz").unwrap());
        let solved: Vec<bool> = document
            .frames
            .iter()
            .map(|frame| frame.ptz.is_some())
            .collect();
        assert_eq!(solved, [vec![true], vec![false; 11]].concat());
        assert_eq!(document.cameras.len(), 1);
        let truth = awkward();
        for (frame, before) in document.frames.iter().zip(&truth.frames).skip(1) {
            assert_eq!(
                (frame.status, frame.camera.as_str()),
                (FrameStatus::New, "main")
            );
            let (base, camera) = (
                document.cameras[0].base_for(frame).unwrap(),
                truth.pointed(before).unwrap(),
            );
            let focal_px = camera.ptz().focal_px;
            assert_eq!(frame.lens.as_ref().unwrap().focal_px, focal_px);
            assert_eq!(
                (base.distortion.radial_at(focal_px).k1, base.principal_point),
                (camera.lens().k1, camera.base().principal_point)
            );
        }
    }

    #[test]
    fn a_file_without_any_rotation_gives_a_camera_without_a_base() {
        let mut arrays = arrays_of(&[FrameCamera::new("a", None, Shown::Lens(lens()))]);
        arrays.truncate(2);
        let document = imported("a.npz", &written(&arrays));
        assert!(document.cameras.len() == 1 && document.cameras[0].base().is_none());
        assert_eq!(document.frames[0].lens.as_ref().unwrap().focal_px, 3000.0);
    }

    fn lens() -> KnownLens {
        KnownLens {
            focal_px: 3000.0,
            principal_point: ImagePoint::new(960.0, 540.0),
            radial: Radial { k1: 0.2, k2: 1.5 },
        }
    }

    /// A frame's arrays.
    fn good() -> BTreeMap<&'static str, Array> {
        let camera = Pinhole {
            position_m: Vec3::new(0.0, -70.0, 15.0),
            ..lens().unpointed()
        };
        arrays_of(&[FrameCamera::new("a", None, Shown::Camera(camera))])
            .into_iter()
            .collect()
    }

    #[test]
    fn damaged_arrays_are_named_in_one_line() {
        let with_value = |name: &'static str, at: usize, value: f64| {
            let mut arrays = good();
            arrays.get_mut(name).unwrap().values[at] = value;
            arrays
        };
        let with_shape = |name: &'static str, shape: &[usize]| {
            let mut arrays = good();
            let values = vec![1.0; shape.iter().product()];
            arrays.insert(
                name,
                Array {
                    shape: shape.to_vec(),
                    values,
                },
            );
            arrays
        };
        let without = |name: &str| {
            let mut arrays = good();
            arrays.remove(name);
            arrays
        };
        for (arrays, wanted) in [
            (without("K"), "the array K is missing"),
            (without("k"), "the array k is missing"),
            (without("R"), "the array R is missing"),
            (without("t"), "the array t is missing"),
            (
                with_shape("K", &[3, 3]),
                "the shape of K: (frames, 3, 3), at most 900 000 frames, is expected, found (3, 3)",
            ),
            (
                with_shape("K", &[0, 3, 3]),
                "the shape of K: (frames, 3, 3), at most 900 000 frames, is expected, found (0, 3, 3)",
            ),
            (
                with_shape("k", &[2, 5]),
                "the shape of k: (frames, 2 or 5), as many frames as K has, is expected, found (2, 5)",
            ),
            (
                with_shape("R", &[2, 3, 3]),
                "the shape of R: (1, 3, 3) or (frames, 3, 3) is expected, found (2, 3, 3)",
            ),
            (
                with_shape("t", &[3]),
                "the shape of t: (1, 3) or (frames, 3), as R has, is expected, found (3)",
            ),
            (
                with_value("K", 0, f64::NAN),
                "frame 0: a number of K or k is not a finite number",
            ),
            (
                with_value("K", 4, 2900.0),
                "frame 0: K with focal lengths of 3000 and 2900 px, skew 0 and last row 0, 0, 1 cannot be read: pixels must be square, without skew",
            ),
            (
                with_value("k", 2, 0.01),
                "frame 0: a distortion coefficient of 0.01 beyond k1 and k2 cannot be read: the document's lens has k1 and k2 only",
            ),
            (
                with_value("k", 0, 0.0),
                "frame 0: k2 = 1.5 without k1 of the camera cannot be read: the lens model ties k2 to k1",
            ),
            (
                with_value("R", 0, f64::NAN),
                "frame 0: a number of the camera is not a finite number",
            ),
            (
                with_value("R", 0, 0.5),
                "frame 0: the rotation of the camera is not a rotation: its rows are off by 7.5e-1",
            ),
            (
                with_value("t", 2, f64::INFINITY),
                "frame 0: a number of the camera is not a finite number",
            ),
        ] {
            let arrays: Vec<(&str, Array)> = arrays.into_iter().collect();
            let files = Files::one("a.npz", written(&arrays));
            let error = Fifa
                .read(&files, &ImportOptions::default())
                .unwrap_err()
                .to_string();
            assert_eq!(error, format!("a.npz: {wanted}"));
        }
    }

    #[test]
    fn arrays_that_are_not_read_are_named() {
        let mut arrays: Vec<(&str, Array)> = good().into_iter().collect();
        arrays.push((
            "Rt",
            Array {
                shape: vec![1],
                values: vec![0.0],
            },
        ));
        assert_eq!(
            Fifa.unread(&Files::one("a.npz", written(&arrays))),
            ["not read: Rt"]
        );
    }
}
