//! A folder of annotated sequences as a document.

use super::mat_file::read_mat;
use super::mat_value::{MatValue, find_by_name};
use super::sequence::{AuthorsSequence, MAX_MAT_BYTES, read_authors_sequence};
use super::{AuthorsError, MatError};
use crate::document::resolve_path;
use crate::document::{
    Camera, CameraId, Clip, Document, FieldSpec, Frame, FramePtz, FrameStatus, path_between,
};
use std::path::{Path, PathBuf};
use std::{fs, io};
use touchline_core::camera::CameraBase;
use touchline_core::field::YARD_M;
use touchline_core::files::read_named;
use touchline_core::geometry::{Angle, ImageSize, Vec3};
use touchline_vision::media;

/// Bases that differ by at most this are one camera, in m and in entries of the rotation.
const SAME_BASE: f64 = 1e-6;
/// The folder with models of the field, in the sequences' folder or beside it.
const MODELS: &str = "util";

/// The variable of a field's model.
const MODEL_SIZE: &str = "model_size";

/// The sequences of a folder.
#[derive(Clone, Debug)]
pub struct AuthorsFolder {
    /// Their frames, solved, as references; a camera for each base, a clip for each sequence. Paths
    /// start from the folder.
    pub document: Document,
    /// Length and width of the field, yards.
    pub field_yd: [f64; 2],
    /// The model of the field that was found; none if the size is the given one.
    pub field_model: Option<PathBuf>,
    /// The largest angle between a frame's full camera and the base with its pan and tilt.
    pub worst_turn: Angle,
}

/// Reads every sequence of a folder, by name. `field_yd` is the field's length and width where no
/// model is found, yards.
///
/// # Errors
/// There is no sequence, or one cannot be read or is damaged.
pub fn read_authors_folder(
    folder: &Path,
    field_yd: [f64; 2],
) -> Result<AuthorsFolder, AuthorsError> {
    let folder = &resolve_path(folder);
    let mut sequences = Vec::new();
    // Files without `annotation`, such as a model of the field or features, give no sequence.
    for path in mat_files(folder)? {
        sequences.extend(read_authors_sequence(&path)?);
    }
    if sequences.is_empty() {
        return Err(AuthorsError::NoSequences {
            folder: folder.clone(),
        });
    }
    let model = field_model(folder)?;
    let field_yd = model.as_ref().map_or(field_yd, |(_, size_yd)| *size_yd);
    let [length_m, width_m] = field_yd.map(|yards| yards * YARD_M);
    let mut field = FieldSpec::new("soccer");
    field.params.extend([
        ("length_m".to_owned(), length_m),
        ("width_m".to_owned(), width_m),
    ]);
    let mut document = Document::new(field);
    for sequence in &sequences {
        add(
            &mut document,
            sequence,
            folder,
            Vec3::new(0.5 * length_m, 0.5 * width_m, 0.0),
        );
    }
    Ok(AuthorsFolder {
        document,
        field_yd,
        field_model: model.map(|(path, _)| path),
        worst_turn: sequences.iter().map(|sequence| sequence.worst_turn).fold(
            Angle::ZERO,
            |worst, turn| if turn > worst { turn } else { worst },
        ),
    })
}

/// The MAT files of a folder, by name.
fn mat_files(folder: &Path) -> Result<Vec<PathBuf>, AuthorsError> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(|source| cannot_list(folder, source))? {
        let path = entry.map_err(|source| cannot_list(folder, source))?.path();
        if path.is_file()
            && path
                .extension()
                .is_some_and(|extension| extension.eq_ignore_ascii_case("mat"))
        {
            files.push(path);
        }
    }
    alphanumeric_sort::sort_path_slice(&mut files);
    Ok(files)
}

/// The error that a folder's files cannot be listed.
fn cannot_list(folder: &Path, source: io::Error) -> AuthorsError {
    // The usual mistake is to name a file of the folder.
    let is_file = source.kind() == io::ErrorKind::NotADirectory;
    let source = if is_file {
        io::Error::other("it is a file; give the folder that it lies in")
    } else {
        source
    };
    AuthorsError::Read {
        path: folder.to_path_buf(),
        source,
    }
}

/// The first file with a `model_size`, in the folder, in its `util` or in the `util` beside it.
/// Within one folder, files whose names share the longest prefix with the folder's name come first.
fn field_model(folder: &Path) -> Result<Option<(PathBuf, [f64; 2])>, AuthorsError> {
    let name = folder
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase();
    let beside = folder.parent().map(|parent| parent.join(MODELS));
    for place in [
        Some(folder.to_path_buf()),
        Some(folder.join(MODELS)),
        beside,
    ]
    .into_iter()
    .flatten()
    {
        if !place.is_dir() {
            continue;
        }
        // `util` may have models of several fields, named like the folders of their sequences.
        let mut files = mat_files(&place)?;
        files.sort_by_key(|path| std::cmp::Reverse(common_prefix_letters(&name, path)));
        for path in files {
            let bytes = read_named(&path, MAX_MAT_BYTES).map_err(|source| AuthorsError::Read {
                path: path.clone(),
                source,
            })?;
            let found = model_size(&bytes).map_err(|source| AuthorsError::Mat {
                path: path.clone(),
                source,
            })?;
            if let Some(size_yd) = found {
                return Ok(Some((path, size_yd)));
            }
        }
    }
    Ok(None)
}

/// The number of letters with which both a folder's name (in lower case) and a file's name begin.
fn common_prefix_letters(folder_name: &str, file: &Path) -> usize {
    let stem = file
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase();
    folder_name
        .chars()
        .zip(stem.chars())
        .take_while(|(a, b)| a == b)
        .count()
}

/// Length and width of a field's model, yards: the larger number is the length.
fn model_size(bytes: &[u8]) -> Result<Option<[f64; 2]>, MatError> {
    let variables = read_mat(bytes, &[MODEL_SIZE])?;
    let Some(&[a, b]) = find_by_name(&variables, MODEL_SIZE).and_then(MatValue::numbers) else {
        return Ok(None);
    };
    Ok((a > 0.0 && b > 0.0 && a.is_finite() && b.is_finite()).then(|| [a.max(b), a.min(b)]))
}

/// Adds a sequence; `middle_m` is the field's middle from its corner.
fn add(document: &mut Document, sequence: &AuthorsSequence, folder: &Path, middle_m: Vec3) {
    let base = CameraBase {
        position_m: sequence.base_from_corner.position_m - middle_m,
        ..sequence.base_from_corner
    };
    let images: Vec<PathBuf> = sequence
        .frames
        .iter()
        .map(|frame| sequence.image_path(&frame.image))
        .collect();
    // Without images, the picture size is twice the principal point, which is their middle. It was
    // shifted by half a pixel to the corner, which is taken off again; `Annotation` checked that
    // the result is a size.
    let middle = sequence.base_from_corner.principal_point;
    let by_centre = ImageSize::new((2.0 * middle.x - 1.0) as u32, (2.0 * middle.y - 1.0) as u32);
    let size = images
        .first()
        .and_then(|path| media::image_size(path).ok())
        .unwrap_or(by_centre);
    let camera = camera_of(document, &base, size, sequence);
    // People annotated these frames, so that they are references.
    for (frame, image) in sequence.frames.iter().zip(&images) {
        let added = Frame {
            status: FrameStatus::Reference,
            clip: Some(Clip::Name(sequence.name.clone())),
            ptz: Some(FramePtz::new(frame.ptz, None)),
            masks: sequence.logo.into_iter().collect(),
            ..Frame::from_image(&path_between(folder, image), camera.clone(), size)
        };
        document.frames.push(added.into());
    }
}

/// The camera with this base; made if there is none yet.
fn camera_of(
    document: &mut Document,
    base: &CameraBase,
    size: ImageSize,
    sequence: &AuthorsSequence,
) -> CameraId {
    let known = document.cameras.iter().find(|camera| {
        camera.image_size == size
            && camera.base().is_some_and(|known| {
                (known.position_m - base.position_m).amax() < SAME_BASE
                    && (known.base_from_world - base.base_from_world).amax() < SAME_BASE
                    && known.principal_point == base.principal_point
            })
    });
    if let Some(known) = known {
        return known.id.clone();
    }
    let mut camera = Camera::new(sequence.name.as_str().into(), size);
    camera.set_base(base);
    let id = camera.id.clone();
    document.cameras.push(camera.into());
    id
}
