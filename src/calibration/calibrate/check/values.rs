//! Checks of a document that need no pictures.

use super::fault::{Fault, Problem};
use super::plausible::{check_place, check_view, lens_folds};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, PixelBox};
use touchline_documents::document::{
    Camera, Document, DocumentAt, FieldSpec, Frame, FrameStatus, ShotEnd, StoredClickNoise, Target,
};

/// Everything wrong with a document that shows without its pictures, in the document's order.
pub fn check_values(document: DocumentAt<'_>) -> Vec<Problem> {
    let mut problems = Vec::new();
    let mut fields = Fields {
        folder: document.folder,
        known: Vec::new(),
    };
    let mut problem = |place: String, fault| {
        problems.push(Problem {
            place,
            frame: None,
            fault,
        });
    };
    // What the whole document shares: field, click noise and shots.
    if let Err(message) = fields.model(&document.field) {
        problem("field".to_owned(), Fault::Field { message });
    }
    if let Some(message) = document
        .click_noise
        .as_ref()
        .and_then(StoredClickNoise::fault)
    {
        problem("click_noise".to_owned(), Fault::ClickNoise { message });
    }
    for (index, shot) in document.shots.iter().enumerate() {
        for end in [&shot.from, &shot.to] {
            if let ShotEnd::Frame(id) = end
                && document.frames.by_id(id).is_none()
            {
                problem(
                    format!("shots[{index}]"),
                    Fault::UnknownFrame { id: id.to_string() },
                );
            }
        }
    }
    // Each camera by itself.
    let mut names = BTreeSet::new();
    for camera in &document.cameras {
        let place = format!("camera {}", camera.id);
        if !names.insert(&camera.id) {
            problem(place.clone(), Fault::DuplicateCamera);
        }
        if let Some(Err(message)) = camera.field.as_ref().map(|field| fields.model(field)) {
            problem(place.clone(), Fault::Field { message });
        }
        check_camera(camera, &mut |fault| problem(place.clone(), fault));
        check_place(camera, &mut |fault| problem(place.clone(), fault));
    }
    // Each frame, with its clicks and its solution.
    let duplicates = duplicates(&document);
    for (index, frame) in document.frames.iter().enumerate() {
        let mut problem = |fault| problems.push(Problem::in_frame(index, frame, fault));
        if let Some(first) = duplicates[index] {
            problem(Fault::DuplicateFrame { first });
        }
        check_frame(
            &document,
            frame,
            fields.model(document.field_of(frame)).ok(),
            &mut problem,
        );
    }
    problems
}

/// The models of the fields that a document uses; each is built once.
struct Fields<'a> {
    folder: &'a Path,
    known: Vec<(FieldSpec, Result<FieldModel, String>)>,
}

impl Fields<'_> {
    fn model(&mut self, spec: &FieldSpec) -> Result<&FieldModel, String> {
        // Compared by value and one after the other: a document has few different fields.
        let at = self
            .known
            .iter()
            .position(|(known, _)| known == spec)
            .unwrap_or_else(|| {
                let model = spec.model(self.folder).map_err(|error| error.to_string());
                self.known.push((spec.clone(), model));
                self.known.len() - 1
            });
        self.known[at].1.as_ref().map_err(Clone::clone)
    }
}

/// For each frame the index of the first one with the same image or the same frame of a video; none
/// for that first one itself.
fn duplicates(document: &Document) -> Vec<Option<usize>> {
    // `or_insert` returns the index of the first frame with a key. The first frame finds itself,
    // and the filter removes that.
    let (mut images, mut videos) = (BTreeMap::new(), BTreeMap::new());
    let firsts = document.frames.iter().enumerate().map(|(index, frame)| {
        let image = frame
            .image
            .as_ref()
            .map(|image| *images.entry(image).or_insert(index));
        let video = frame
            .video
            .as_ref()
            .map(|video| (&video.path, video.frame_index));
        let video = video.map(|video| *videos.entry(video).or_insert(index));
        image
            .into_iter()
            .chain(video)
            .filter(|first| *first < index)
            .min()
    });
    firsts.collect()
}

fn check_camera(camera: &Camera, problem: &mut dyn FnMut(Fault)) {
    // `Camera::base` needs both, so a typing error in one key silently leaves the camera without a
    // base.
    match (camera.position_m, camera.base_from_world) {
        (Some(_), None) => problem(Fault::HalfABase {
            missing: "base_from_world",
        }),
        (None, Some(_)) => problem(Fault::HalfABase {
            missing: "position_m",
        }),
        _ => {}
    }
    if camera.base().is_some_and(|base| !base.is_finite()) {
        problem(Fault::NotFinite {
            what: "the base".to_owned(),
        });
    }
    if !camera.principal_point.is_finite() {
        problem(Fault::NotFinite {
            what: "principal_point_px".to_owned(),
        });
    }
    for (key, value) in camera
        .distortion
        .iter()
        .flat_map(|distortion| &distortion.extra)
    {
        if changes_picture(value) {
            problem(Fault::UnusedDistortion { key: key.clone() });
        }
    }
    for (what, value) in [
        ("click_noise_px", camera.click_noise_px),
        ("sensor_width_mm", camera.sensor_width_mm),
    ] {
        if let Some(value) = value.filter(|value| *value <= 0.0) {
            problem(Fault::NotPositive { what, value });
        }
    }
    // Masks for all frames and for ranges of frames.
    let masks: Vec<PixelBox> = camera
        .masks
        .iter()
        .chain(camera.ranged_masks.iter().map(|mask| &mask.pixel_box))
        .copied()
        .collect();
    check_masks(&masks, camera.image_size, problem);
}

/// Whether an unknown value of a distortion would change the picture: a number other than zero is a
/// coefficient, a word is a user's note.
fn changes_picture(value: &Value) -> bool {
    value.is_object() || value.is_array() || value.as_f64().is_some_and(|x| x != 0.0)
}

fn check_masks(masks: &[PixelBox], picture: ImageSize, problem: &mut dyn FnMut(Fault)) {
    for (mask, pixel_box) in masks.iter().enumerate() {
        if !covers_some_of(pixel_box, picture) {
            problem(Fault::EmptyMask { mask });
        }
    }
}

/// Whether a mask has an area, part of it inside the picture.
fn covers_some_of(mask: &PixelBox, picture: ImageSize) -> bool {
    let (right, bottom) = (mask.x + mask.width, mask.y + mask.height);
    mask.width > 0.0
        && mask.height > 0.0
        && right > 0.0
        && bottom > 0.0
        && mask.x < f64::from(picture.width)
        && mask.y < f64::from(picture.height)
}

/// Checks what is stored of the frame besides its clicks: the hash of its file and its last change.
fn check_record(frame: &Frame, problem: &mut dyn FnMut(Fault)) {
    if frame.sha256.as_ref().is_some_and(|text| !is_sha256(text)) {
        problem(Fault::NoSha256);
    }
    let Some(edited) = &frame.edited else { return };
    if let Some(at) = edited
        .at
        .as_ref()
        .filter(|at| at.parse::<jiff::Timestamp>().is_err())
    {
        problem(Fault::NoTime { stated: at.clone() });
    }
    if let Some(value) = edited.seconds.filter(|seconds| *seconds < 0.0) {
        problem(Fault::Negative {
            what: "edited.seconds",
            value,
        });
    }
}

fn is_sha256(text: &str) -> bool {
    text.len() == 64 && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}

fn check_frame(
    document: &Document,
    frame: &Frame,
    field: Option<&FieldModel>,
    problem: &mut dyn FnMut(Fault),
) {
    check_record(frame, problem);
    if frame.image.is_none() && frame.video.is_none() {
        problem(Fault::NoPicture);
    }
    // Its camera: present, of the same picture size, with a plausible lens.
    match document.camera_of(frame) {
        None => problem(Fault::UnknownCamera {
            camera: frame.camera.as_str().to_owned(),
        }),
        Some(camera) if camera.image_size != frame.image_size => {
            problem(Fault::CameraSize {
                frame: frame.image_size,
                camera: camera.image_size,
            });
        }
        Some(camera) => check_lens(camera, frame, problem),
    }
    // Its status: what it requires must be there.
    match frame.status {
        FrameStatus::Reference | FrameStatus::Suggested if frame.ptz.is_none() => {
            problem(Fault::Unsolved {
                status: frame.status,
            });
        }
        FrameStatus::Rejected if frame.reason.is_none() => problem(Fault::NoReason),
        _ => {}
    }
    if let Some(paint) = frame.evidence_against_acceptance() {
        problem(Fault::OffPaint {
            found: paint.found,
            open: paint.open(),
        });
    }
    check_view(document, frame, field, problem);
    check_clicks(frame, field, problem);
    check_repeats(frame, field, problem);
    check_masks(&frame.masks, frame.image_size, problem);
    check_solution(frame, problem);
}

/// Every corner of a solved frame must have a ray; where the lens model folds inside the picture,
/// one does not.
fn check_lens(camera: &Camera, frame: &Frame, problem: &mut dyn FnMut(Fault)) {
    let Some(ptz) = &frame.ptz else { return };
    if !ptz.ptz().is_finite() {
        problem(Fault::NotFinite {
            what: "ptz".to_owned(),
        });
        return;
    }
    if let Some(pointed) = camera.ptz_camera(frame)
        && lens_folds(&pointed, frame.image_size)
    {
        problem(Fault::LensFolds { k1: pointed.k1() });
    }
}

fn check_clicks(frame: &Frame, field: Option<&FieldModel>, problem: &mut dyn FnMut(Fault)) {
    for (click, here) in frame.clicks.iter().enumerate() {
        match &here.target {
            None => problem(Fault::UnnamedClick { click }),
            Some(Target::Landmark(id)) => {
                let name = id.as_str();
                if field.is_some_and(|field| field.landmark(name).is_none()) {
                    problem(Fault::UnknownLandmark {
                        click,
                        name: name.to_owned(),
                    });
                }
                // A landmark is one point, so that a second click on it contradicts the first. A
                // line may have several clicks.
                let before = frame.clicks[..click]
                    .iter()
                    .position(|other| other.target == here.target);
                if let Some(first) = before {
                    problem(Fault::DuplicateLandmark {
                        first,
                        second: click,
                        name: name.to_owned(),
                    });
                }
            }
            Some(Target::Line(id)) => {
                if field.is_some_and(|field| field.line(id.as_str()).is_none()) {
                    problem(Fault::UnknownLine {
                        click,
                        name: id.as_str().to_owned(),
                    });
                }
            }
        }
        if !here.image.is_finite() {
            problem(Fault::NotFinite {
                what: format!("click {}", click + 1),
            });
        } else if !frame.image_size.contains(here.image) {
            let picture = frame.image_size;
            problem(Fault::ClickOutside {
                click,
                x: here.image.x,
                y: here.image.y,
                picture,
            });
        }
    }
}

fn check_repeats(frame: &Frame, field: Option<&FieldModel>, problem: &mut dyn FnMut(Fault)) {
    for (repeat, here) in frame.repeats.iter().enumerate() {
        if field.is_some_and(|field| field.landmark(here.landmark.as_str()).is_none()) {
            problem(Fault::UnknownLandmarkAgain {
                repeat,
                name: here.landmark.as_str().to_owned(),
            });
        }
        if !frame.image_size.contains(here.image) {
            problem(Fault::RepeatOutside {
                repeat,
                x: here.image.x,
                y: here.image.y,
                picture: frame.image_size,
            });
        }
    }
}

fn check_solution(frame: &Frame, problem: &mut dyn FnMut(Fault)) {
    let Some(solution) = &frame.solution else {
        return;
    };
    let clicks = frame.clicks.len();
    // Warnings, suggested names and disputed clicks refer to clicks by index.
    let renamed = solution
        .warnings
        .iter()
        .flat_map(|warning| warning.renames.iter().map(|rename| &rename.click));
    let warned_of = solution.warnings.iter().flat_map(|warning| &warning.clicks);
    // The largest index that is out of range stands for all.
    let spoken_of = solution.disputed.iter().chain(warned_of).chain(renamed);
    if let Some(&click) = spoken_of.filter(|click| **click >= clicks).max() {
        problem(Fault::NoSuchClick { click, clicks });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_documents::document::Edited;
    use touchline_documents::testing::new_frame;

    /// What is said of a frame that was worked on for so long.
    fn faults_of_seconds(seconds: f64) -> Vec<String> {
        let mut frame = new_frame("1.jpg", ImageSize::new(64, 36));
        frame.edited = Some(Edited {
            seconds: Some(seconds),
            ..Edited::default()
        });
        let mut found = Vec::new();
        check_record(&frame, &mut |fault| found.push(fault.to_string()));
        found
    }

    #[test]
    fn a_frame_may_have_taken_no_time_but_not_less() {
        assert_eq!(faults_of_seconds(0.0), [""; 0]);
        assert_eq!(
            faults_of_seconds(-2.0),
            ["edited.seconds is -2, expected zero or more; remove it"]
        );
    }
}
