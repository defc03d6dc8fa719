//! A drawn clip with exact cameras, and how far found ones are off.
#![cfg(feature = "opencv")]

use crate::drawn::draw;
use std::path::Path;
use touchline::document::{Document, Frame, FrameStatus, Solution};
use touchline::field::{Landmark, LandmarkId};
use touchline::geometry::{ImagePoint, Mat3, Vec3};
use touchline_core::testing::soccer;
use touchline_documents::testing::{load, save};

/// A drawn clip at 25 frames a second with graphics that no mask covers; its first and last frame
/// are known.
pub fn drawn_clip(folder: &Path) -> Document {
    draw(
        folder,
        "--frames 30 --step 0.04 --seed 4 --size 640x360 --preset easy --graphics score-bug --unmasked",
    );
    let truth = load(folder.join("match/truth.json"));
    let mut asked = truth.clone();
    let last = asked.frames.len() - 1;
    for (index, frame) in asked.frames.iter_mut().enumerate() {
        let frame: &mut Frame = frame;
        frame.clicks.clear();
        frame.solution = None;
        if index == 0 || index == last {
            frame.status = FrameStatus::Reference;
            let covariance = Some(Mat3::from_diagonal(&Vec3::new(1e-4, 1e-4, 0.25)));
            frame.solution = Some(Solution {
                covariance,
                ..Solution::default()
            });
        } else {
            (frame.status, frame.ptz) = (FrameStatus::New, None);
        }
    }
    save(folder.join("match/ask.json"), &asked);
    truth
}

/// Where a frame shows the landmarks of the field.
pub fn visible_landmarks(truth: &Document, frame: usize) -> Vec<(LandmarkId, ImagePoint)> {
    let field = soccer();
    let camera = truth.ptz_camera(&truth.frames[frame]).unwrap();
    let seen = |landmark: &Landmark| {
        let at = camera
            .image_from_world(field.landmark_in_world(landmark))
            .ok()?;
        let inside = (20.0..620.0).contains(&at.x) && (20.0..340.0).contains(&at.y);
        inside.then(|| (landmark.id.clone(), at))
    };
    field.landmarks.iter().filter_map(seen).collect()
}

/// How far the landmarks that a frame shows are off, px; none where the frame has no camera.
pub fn landmark_errors_px(found: &Document, truth: &Document, frame: usize) -> Option<Vec<f64>> {
    let camera = found.ptz_camera(&found.frames[frame])?;
    let field = found.at(Path::new("")).model_of(&found.field).unwrap();
    let off_px = |(landmark, at): (LandmarkId, ImagePoint)| {
        let landmark = field.landmark(landmark.as_str()).unwrap();
        camera
            .image_from_world(field.landmark_in_world(landmark))
            .unwrap()
            .distance_px(at)
    };
    Some(
        visible_landmarks(truth, frame)
            .into_iter()
            .map(off_px)
            .collect(),
    )
}
