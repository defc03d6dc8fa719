//! What people's clicks on real frames say of landmarks and names.

use crate::parts::{Test, frames_folder, tests};
use crate::program::touchline;
use std::collections::BTreeMap;
use touchline::document::{Click, Document, document_from_bytes, document_to_string};
use touchline::geometry::Vec3;
use touchline::store::read;
use touchline_core::testing::soccer;

pub const TESTS: &[Test] = tests![
    [Frames] real_documents_survive_the_round_trip;
    [Frames] on_real_frames_the_place_is_worth_half_of_what_templates_state;
    [Frames] wrong_names_among_real_clicks_are_marked;
    [Frames] real_clicks_give_a_real_camera;
];

fn real_documents_survive_the_round_trip() {
    let data = frames_folder();
    for folder in ["scouting-d82e7a", "scouting-08fd33", "scouting-42ba34"] {
        for file in ["clicks.json", "fit-k1.json", "fit-pinhole.json"] {
            let bytes = std::fs::read(data.join(folder).join(file)).unwrap();
            let document = document_from_bytes(&bytes).unwrap();
            let text = document_to_string(&document).unwrap();
            let again = document_from_bytes(text.as_bytes()).unwrap();
            assert_eq!(
                (&again.frames, &again.cameras),
                (&document.frames, &document.cameras)
            );
        }
    }
}

/// Residuals of the clicks on each landmark along one axis, in the template's sigmas; far-off
/// clicks left out.
fn residuals_by_landmark(document: &Document, axis: usize) -> BTreeMap<String, Vec<f64>> {
    let field = soccer();
    let mut found: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for frame in document
        .frames
        .iter()
        .filter(|frame| !frame.name().contains("42ba34_9_2"))
    {
        let Some(camera) = document.ptz_camera(frame) else {
            continue;
        };
        for click in &frame.clicks {
            let Some(landmark) = click
                .target
                .as_ref()
                .and_then(|target| field.landmark(target.as_str()))
            else {
                continue;
            };
            let Ok(at) = camera.image_from_world(field.landmark_in_world(landmark)) else {
                continue;
            };
            let off = click.image.offset_from(at);
            if off.norm() < 10.0 {
                found
                    .entry(landmark.id.to_string())
                    .or_default()
                    .push(off[axis] / landmark.click_sigma_px);
            }
        }
    }
    found.retain(|_, residuals| residuals.len() >= 4);
    found
}

fn on_real_frames_the_place_is_worth_half_of_what_templates_state() {
    let data = frames_folder();
    for (name, expected) in [("d82e7a", 0.47), ("08fd33", 0.55), ("42ba34", 0.51)] {
        let bytes = std::fs::read(data.join(format!("scouting-{name}/fit-k1.json"))).unwrap();
        let document = document_from_bytes(&bytes).unwrap();
        let (mut clicks, mut place) = (0.0, 0.0);
        for residuals in [0, 1]
            .into_iter()
            .flat_map(|axis| residuals_by_landmark(&document, axis).into_values())
        {
            let count = residuals.len() as f64;
            let mean = residuals.iter().sum::<f64>() / count;
            let variance = residuals
                .iter()
                .map(|off| (off - mean).powi(2))
                .sum::<f64>()
                / (count - 1.0);
            clicks += count;
            // The variance of one-way random effects, by moments.
            place += count * (mean * mean - variance / count);
        }
        assert!(
            (place / clicks - expected).abs() < 0.02,
            "{name}: {:.3} of sigma squared",
            place / clicks
        );
    }
}

/// Whether near and far are different spots for what a click shows.
fn has_a_twin(click: &Click) -> bool {
    let name = click.target.as_ref().unwrap().as_str();
    name.contains("near") || name.contains("far")
}

/// The frame whose near and far names are all exchanged, and the one click that is 25 px off.
fn wrong_names_among_real_clicks_are_marked() {
    let data = frames_folder();
    let folder = tempfile::tempdir().unwrap();
    let clicks = data
        .join("scouting-42ba34/clicks.json")
        .canonicalize()
        .unwrap();
    touchline(
        folder.path(),
        &format!("refine-base {} -o out.json", clicks.display()),
    )
    .done();
    let (_, refined, _) = read(&folder.path().join("out.json")).unwrap();
    let published = read(&data.join("scouting-42ba34/fit-k1.json")).unwrap().1;
    let mut warned = 0;
    for (frame, known) in refined.frames.iter().zip(&published.frames) {
        let solution = frame.solution.as_ref().unwrap();
        let about_names = |code: &str| ["swapped", "mirrored", "wrong_line"].contains(&code);
        if frame.name().contains("42ba34_9_2") {
            let mirrored = solution
                .warnings
                .iter()
                .find(|warning| warning.code == "mirrored")
                .unwrap();
            assert_eq!(
                mirrored.renames.len(),
                frame
                    .clicks
                    .iter()
                    .filter(|click| has_a_twin(click))
                    .count(),
                "{mirrored:?}"
            );
            continue;
        }
        warned += usize::from(
            solution
                .warnings
                .iter()
                .any(|warning| about_names(&warning.code)),
        );
        for click in known
            .solution
            .iter()
            .flat_map(|solution| &solution.disputed)
        {
            assert!(
                solution.disputed.contains(click),
                "{}: {:?}",
                frame.name(),
                solution.disputed
            );
        }
    }
    assert_eq!(
        warned,
        0,
        "false alarms among {} other frames",
        refined.frames.len()
    );
}

fn real_clicks_give_a_real_camera() {
    let data = frames_folder();
    let folder = tempfile::tempdir().unwrap();
    let clicks = data
        .join("scouting-d82e7a/clicks.json")
        .canonicalize()
        .unwrap();
    touchline(
        folder.path(),
        &format!("refine-base {} -o out.json", clicks.display()),
    )
    .done();
    let (_, refined, _) = read(&folder.path().join("out.json")).unwrap();
    assert!(refined.frames.iter().all(|frame| frame.ptz.is_some()));
    assert!((refined.cameras[0].position_m.unwrap() - Vec3::new(2.9, -65.0, 20.4)).norm() < 0.6);
}
