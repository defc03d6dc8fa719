//! One annotated sequence: its cameras, checked and converted to this program's conventions.

use super::AuthorsError;
use super::mat_file::read_mat;
use super::mat_value::{MatValue, find_by_name};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::files::read_named;
use touchline_core::geometry::rotation::{angle_between, from_rotation_vector};
use touchline_core::geometry::{Angle, ImagePoint, ImageSize, Mat3, PixelBox, Vec3};

/// The shift from their principal point, whose origin is the first pixel's centre, to corner
/// coordinates, px.
const CORNER_FROM_CENTRE: f64 = 0.5;
/// The maximum difference between a frame's full camera and the base with its pan and tilt; a
/// larger one means a different convention.
const MOST_APART_DEG: f64 = 0.5;
const MOST_APART_M: f64 = 0.5;
/// The maximum size of a MAT file that is read, bytes: feature files beside the annotations are
/// large.
pub(super) const MAX_MAT_BYTES: u64 = 256 << 20;
/// The suffix of a file's name after the sequence's name.
const SUFFIX: &str = "_anno";

/// A sequence of frames from one camera.
#[derive(Clone, Debug)]
pub struct AuthorsSequence {
    /// Its name: the file's, `seq3` of `seq3_anno.mat`.
    pub name: String,
    /// The base in the world of the file, m, whose origin is the near left corner of the field.
    pub base_from_corner: CameraBase,
    /// The box of the score strip, px.
    pub logo: Option<PixelBox>,
    /// Folders that may contain the images, the likeliest first.
    pub image_folders: Vec<PathBuf>,
    /// The frames.
    pub frames: Vec<AuthorsFrame>,
    /// The largest angle between a frame's full camera and the base with its pan and tilt.
    pub worst_turn: Angle,
}

/// A frame of a sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct AuthorsFrame {
    /// The image file's name.
    pub image: String,
    /// Pan, tilt and focal length.
    pub ptz: Ptz,
}

/// Reads a sequence; none where the file has no `annotation`, such as a model of the field or
/// features.
///
/// # Errors
/// The file cannot be read, or does not have the structure of the authors' files.
pub fn read_authors_sequence(path: &Path) -> Result<Option<AuthorsSequence>, AuthorsError> {
    let bytes = read_named(path, MAX_MAT_BYTES).map_err(|source| AuthorsError::Read {
        path: path.to_path_buf(),
        source,
    })?;
    let variables =
        read_mat(&bytes, &["annotation", "meta"]).map_err(|source| AuthorsError::Mat {
            path: path.to_path_buf(),
            source,
        })?;
    let Some(annotation) = find_by_name(&variables, "annotation") else {
        return Ok(None);
    };
    let meta = find_by_name(&variables, "meta")
        .and_then(MatValue::structures)
        .and_then(<[_]>::first)
        .ok_or_else(|| missing(path, "meta"))?;
    // The base is stated once for the file, in `meta`; each frame adds pan, tilt and focal length,
    // and repeats its full camera, which is compared with them.
    let position_m = meta_vector(meta, "cc", path)?;
    let base_rotation = meta_vector(meta, "base_rotation", path)?;
    let frames = annotation
        .structures()
        .ok_or_else(|| missing(path, "structures in annotation"))?;

    let name = name_of(path);
    let mut sequence = AuthorsSequence {
        base_from_corner: CameraBase::new(
            position_m,
            from_rotation_vector(base_rotation),
            ImagePoint::new(0.0, 0.0),
        ),
        logo: find_by_name(meta, "logo_bbox")
            .and_then(MatValue::numbers)
            .and_then(logo),
        image_folders: image_folders(path, &name, meta),
        frames: Vec::with_capacity(frames.len()),
        worst_turn: Angle::ZERO,
        name,
    };
    for (index, fields) in frames.iter().enumerate() {
        let annotation = Annotation::from_fields(fields)
            .map_err(|what| missing(path, &format!("{what} in annotation {}", index + 1)))?;
        // The principal point is stated with each frame alone; it belongs to the base, and `check`
        // compares it with that of the others.
        if index == 0 {
            sequence.base_from_corner.principal_point = annotation.principal_point;
        }
        let turn = sequence.check(path, &annotation)?;
        if turn > sequence.worst_turn {
            sequence.worst_turn = turn;
        }
        sequence.frames.push(AuthorsFrame {
            image: annotation.image.to_owned(),
            ptz: annotation.ptz,
        });
    }
    if sequence.frames.is_empty() {
        return Err(missing(path, "a frame in annotation"));
    }
    Ok(Some(sequence))
}

/// The error that something is not in a file.
fn missing(path: &Path, what: &str) -> AuthorsError {
    AuthorsError::Missing {
        path: path.to_path_buf(),
        what: what.to_owned(),
    }
}

/// The three numbers of a field of `meta`.
fn meta_vector(
    meta: &[(Arc<str>, MatValue)],
    name: &str,
    path: &Path,
) -> Result<Vec3, AuthorsError> {
    find_by_name(meta, name)
        .and_then(MatValue::numbers)
        .and_then(vector)
        .ok_or_else(|| missing(path, &format!("three numbers meta.{name}")))
}

/// What `annotation` states of a frame.
struct Annotation<'a> {
    image: &'a str,
    /// The full camera: principal point, focal length, rotation vector, centre.
    camera: &'a [f64],
    /// That of the camera, in corner coordinates.
    principal_point: ImagePoint,
    ptz: Ptz,
}

impl<'a> Annotation<'a> {
    /// Reads the fields of a frame; the error names what is missing.
    fn from_fields(fields: &'a [(Arc<str>, MatValue)]) -> Result<Self, &'static str> {
        let image = find_by_name(fields, "image_name")
            .and_then(MatValue::words)
            .ok_or("image_name")?;
        let mut parts = Path::new(image).components();
        if !parts.all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
            return Err("an image_name within the folder");
        }
        let camera = find_by_name(fields, "camera")
            .and_then(MatValue::numbers)
            .filter(|numbers| is_row(numbers, 9))
            .ok_or("nine numbers of a camera")?;
        let ptz = find_by_name(fields, "ptz")
            .and_then(MatValue::numbers)
            .filter(|numbers| is_row(numbers, 3))
            .ok_or("pan, tilt and focal length (ptz)")?;
        if !(ptz[2] > 0.0) {
            return Err("a focal length above 0");
        }
        let principal_point = ImagePoint::new(
            camera[0] + CORNER_FROM_CENTRE,
            camera[1] + CORNER_FROM_CENTRE,
        );
        // Without an image, the picture size is derived from the principal point.
        if ![principal_point.x, principal_point.y]
            .iter()
            .all(|middle| ImageSize::is_side_px(2.0 * middle - 1.0))
        {
            return Err("a principal point in the middle of a picture");
        }
        Ok(Self {
            image,
            camera,
            principal_point,
            ptz: Ptz::from_degrees(ptz[0], ptz[1], ptz[2]),
        })
    }
}

impl AuthorsSequence {
    /// Checks that a frame's full camera agrees with the base and the frame's pan and tilt, and
    /// returns the angle between them.
    fn check(&self, path: &Path, annotation: &Annotation<'_>) -> Result<Angle, AuthorsError> {
        let camera = annotation.camera;
        // This program's formulas on the authors' numbers against their full camera: a sign, an
        // order of axes or a unit that is read wrongly shows here as degrees or metres.
        let pointed = PtzCamera::new(self.base_from_corner, annotation.ptz);
        let cam_from_world: Mat3 = from_rotation_vector(Vec3::new(camera[3], camera[4], camera[5]));
        let turn = angle_between(&pointed.cam_from_world(), &cam_from_world);
        let apart_m =
            (Vec3::new(camera[6], camera[7], camera[8]) - self.base_from_corner.position_m).norm();
        let (path, image) = (path.to_path_buf(), annotation.image.to_owned());
        if !(turn.degrees() <= MOST_APART_DEG && apart_m <= MOST_APART_M) {
            return Err(AuthorsError::Disagrees {
                path,
                image,
                turn_deg: turn.degrees(),
                apart_m,
            });
        }
        let off_px = annotation
            .principal_point
            .distance_px(self.base_from_corner.principal_point);
        if !(off_px < CORNER_FROM_CENTRE) {
            return Err(AuthorsError::OtherPrincipalPoint {
                path,
                image,
                off_px,
            });
        }
        Ok(turn)
    }

    /// The path of a frame's image: in the first folder that contains it, else in the likeliest.
    pub(super) fn image_path(&self, image: &str) -> PathBuf {
        let there = self
            .image_folders
            .iter()
            .map(|folder| folder.join(image))
            .find(|path| path.is_file());
        there
            .or_else(|| Some(self.image_folders.first()?.join(image)))
            .unwrap_or_else(|| PathBuf::from(image))
    }
}

fn name_of(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    stem.strip_suffix(SUFFIX).unwrap_or(&stem).to_owned()
}

/// The candidate folders beside the file: one with the sequence's name, those named in `meta`,
/// `images`, and the file's own folder.
fn image_folders(path: &Path, name: &str, meta: &[(Arc<str>, MatValue)]) -> Vec<PathBuf> {
    let beside = path.parent().unwrap_or(Path::new(""));
    let stated = ["base_dir", "seq"]
        .into_iter()
        .filter_map(|key| find_by_name(meta, key)?.words());
    // `base_dir` is a path on the authors' machine: only its last part is used.
    let stated = stated.filter_map(|words| words.rsplit(['/', '\\']).find(|part| !part.is_empty()));
    let folders = [name].into_iter().chain(stated).chain(["images", ""]);
    let mut folders: Vec<PathBuf> = folders
        .filter(|folder| *folder != "..")
        .map(|folder| beside.join(folder))
        .collect();
    folders.dedup();
    folders
}

fn is_row(numbers: &[f64], length: usize) -> bool {
    numbers.len() == length && numbers.iter().all(|number| number.is_finite())
}

fn vector(numbers: &[f64]) -> Option<Vec3> {
    is_row(numbers, 3).then(|| Vec3::from_column_slice(numbers))
}

/// A box from x, y, width and height in MATLAB's pixels, which are numbered from 1; it covers the
/// pixels `x : x + width`, both ends included.
fn logo(numbers: &[f64]) -> Option<PixelBox> {
    let &[x, y, width, height] = numbers else {
        return None;
    };
    let covers = is_row(numbers, 4) && width > 0.0 && height > 0.0;
    covers.then_some(PixelBox::new(x - 1.0, y - 1.0, width + 1.0, height + 1.0))
}
