//! Reads published homographies of broadcast frames.
//!
//! There are two forms: one JSON file with all frames (`train_val.json`: template to picture,
//! template 115 × 74 yards), or a folder with a text file for each frame (`N.homographyMatrix`:
//! picture to template, template 114.83 × 74.37 yards). In both, the template's origin is the far
//! left corner and its y axis points towards the camera; pixel coordinates are 0 at the first
//! pixel's centre. The results map world (m) to picture (px, corner convention).

use crate::ExperimentError;
use crate::given::MAX_GIVEN_BYTES;
use crate::setting::field_of_yards;
use serde::Deserialize;
use std::fs;
use std::path::{Path, PathBuf};
use touchline::exchange::template_from_ground;
use touchline::field::FieldModel;
use touchline::files::read_named_text;
use touchline::geometry::{ImageSize, Mat3};

/// The file with all homographies.
const JSON_FILE: &str = "train_val.json";
/// The extension of a text file.
const ENDING: &str = "homographyMatrix";
/// Size of all pictures, px.
pub const SIZE: ImageSize = ImageSize::new(1280, 720);
/// Length and width of the templates, yards.
const JSON_TEMPLATE_YD: [f64; 2] = [115.0, 74.0];
const TEXT_TEMPLATE_YD: [f64; 2] = [114.83, 74.37];
/// Offset from pixel coordinates with 0 at a pixel's centre to corner coordinates, px.
const CORNER_FROM_CENTRE: f64 = 0.5;

/// A published set of homographies.
pub struct Homographies {
    /// The field, of the template's size.
    pub field: FieldModel,
    /// Length and width of the template, yards.
    pub template_yd: [f64; 2],
    /// Frames by name: the homography from the ground (world x and y, m) to the picture (px, corner
    /// convention).
    pub frames: Vec<(String, Mat3)>,
}

/// Whether a folder contains homographies.
pub fn holds_homographies(folder: &Path) -> bool {
    folder.join(JSON_FILE).is_file() || text_files(folder).is_ok_and(|files| !files.is_empty())
}

/// Reads the homographies of a folder.
///
/// # Errors
/// A file cannot be read or has another format.
pub fn read_homographies(folder: &Path) -> Result<Homographies, ExperimentError> {
    // The JSON file has all frames, so that text files beside it are not read.
    let json = folder.join(JSON_FILE);
    let (template_yd, frames) = if json.is_file() {
        (JSON_TEMPLATE_YD, read_json(&json)?)
    } else {
        (TEXT_TEMPLATE_YD, read_text(folder)?)
    };
    let template_from_ground = template_from_ground(template_yd);
    // From the right: metres to yards of the template, the published homography, and from pixel
    // centres to the corner convention.
    let in_world = |h: Mat3| {
        Mat3::new_translation(&nalgebra::Vector2::repeat(CORNER_FROM_CENTRE))
            * h
            * template_from_ground
    };
    let frames = frames
        .into_iter()
        .map(|(name, image_from_template)| (name, in_world(image_from_template)))
        .collect();
    Ok(Homographies {
        field: field_of_yards(template_yd)?,
        template_yd,
        frames,
    })
}

#[derive(Deserialize)]
struct JsonFile {
    frames: Vec<JsonFrame>,
}

#[derive(Deserialize)]
struct JsonFrame {
    image: String,
    homography_as_stored: [[f64; 3]; 3],
}

fn wrong(path: &Path, reason: &dyn ToString) -> ExperimentError {
    ExperimentError::Given {
        path: path.to_path_buf(),
        reason: reason.to_string(),
    }
}

/// Reads the JSON file: the frames' names and homographies from template to picture.
fn read_json(path: &Path) -> Result<Vec<(String, Mat3)>, ExperimentError> {
    let text = read_named_text(path, MAX_GIVEN_BYTES).map_err(|error| wrong(path, &error))?;
    let file: JsonFile = serde_json::from_str(&text).map_err(|error| wrong(path, &error))?;
    let of = |frame: JsonFrame| {
        (
            frame.image,
            Mat3::from_fn(|row, column| frame.homography_as_stored[row][column]),
        )
    };
    let frames: Vec<(String, Mat3)> = file.frames.into_iter().map(of).collect();
    if frames.is_empty() {
        Err(wrong(path, &"it holds no frames"))
    } else {
        Ok(frames)
    }
}

/// The text files, sorted by their numbers.
fn text_files(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path
            .extension()
            .is_some_and(|extension| extension == ENDING)
        {
            files.push(path);
        }
    }
    // 10 after 9: the order of the set is that of the numbers, and frames of a match are neighbours
    // in it.
    alphanumeric_sort::sort_path_slice(&mut files);
    Ok(files)
}

/// Reads the text files and inverts their homographies to the direction from template to picture.
fn read_text(folder: &Path) -> Result<Vec<(String, Mat3)>, ExperimentError> {
    let one = |path: PathBuf| {
        let text = read_named_text(&path, MAX_GIVEN_BYTES).map_err(|error| wrong(&path, &error))?;
        let numbers: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
        let numbers = numbers.map_err(|error| wrong(&path, &error))?;
        if numbers.len() != 9 {
            return Err(wrong(
                &path,
                &format!("nine numbers are wanted, there are {}", numbers.len()),
            ));
        }
        // Text files have the direction from the picture to the template.
        let image_from_template = Mat3::from_row_slice(&numbers).try_inverse();
        let image_from_template =
            image_from_template.ok_or_else(|| wrong(&path, &"the homography is singular"))?;
        let name = path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        Ok((format!("{name}.jpg"), image_from_template))
    };
    text_files(folder)
        .map_err(|error| wrong(folder, &error))?
        .into_iter()
        .map(one)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline::geometry::Vec2;
    use touchline::score::PlaneView;

    #[test]
    fn both_forms_mean_the_same_and_y_runs_down() {
        // A template yard is ten pixels; its far left corner is at (100, 50), measured from the
        // first pixel's centre.
        let image_from_template = Mat3::new(10.0, 0.0, 100.0, 0.0, 10.0, 50.0, 0.0, 0.0, 1.0);
        let folder = tempfile::tempdir().unwrap();
        let rows: Vec<Vec<f64>> = image_from_template
            .row_iter()
            .map(|row| row.iter().copied().collect())
            .collect();
        let json =
            serde_json::json!({ "frames": [{ "image": "1.jpg", "homography_as_stored": rows }] });
        fs::write(folder.path().join(JSON_FILE), json.to_string()).unwrap();
        let read = read_homographies(folder.path()).unwrap();
        let view = PlaneView::new(&read.frames[0].1, SIZE).unwrap();
        let far_left = view
            .image_from_ground(Vec2::new(-57.5 * 0.9144, 37.0 * 0.9144))
            .unwrap();
        assert!(
            (far_left.x - 100.5).hypot(far_left.y - 50.5) < 1e-9,
            "{far_left:?}"
        );
        let near_left = view
            .image_from_ground(Vec2::new(-57.5 * 0.9144, -37.0 * 0.9144))
            .unwrap();
        assert!(
            (near_left.x - 100.5).hypot(near_left.y - 790.5) < 1e-9,
            "{near_left:?}"
        );

        fs::remove_file(folder.path().join(JSON_FILE)).unwrap();
        let back = image_from_template.try_inverse().unwrap();
        let rows = back
            .row_iter()
            .map(|row| row.iter().map(f64::to_string).collect::<Vec<_>>().join(" "));
        fs::write(
            folder.path().join("7.homographyMatrix"),
            rows.collect::<Vec<_>>().join("\n"),
        )
        .unwrap();
        let read = read_homographies(folder.path()).unwrap();
        assert_eq!(
            (read.frames[0].0.as_str(), read.template_yd),
            ("7.jpg", TEXT_TEMPLATE_YD)
        );
        let view = PlaneView::new(&read.frames[0].1, SIZE).unwrap();
        let far_left = view
            .image_from_ground(Vec2::new(-0.5 * 114.83 * 0.9144, 0.5 * 74.37 * 0.9144))
            .unwrap();
        assert!(
            (far_left.x - 100.5).hypot(far_left.y - 50.5) < 1e-9,
            "{far_left:?}"
        );

        for text in ["1 2 3", "1 2 3 4 5 6 7 8 nine", "0 0 0 0 0 0 0 0 0"] {
            fs::write(folder.path().join("7.homographyMatrix"), text).unwrap();
            assert!(
                matches!(
                    read_homographies(folder.path()),
                    Err(ExperimentError::Given { .. })
                ),
                "{text}"
            );
        }
    }
}
