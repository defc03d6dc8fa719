//! What exports say that cameras of tracked clips are good for, against clips that are drawn: a frame
//! graded for speeds must not move what stands, one graded for maps must not misplace it.
//!
//! `TOUCHLINE_GRADES=1,2,11@1280x720` draws clips of these seeds in place of one, where it is stated
//! of that size, for the figures of `tests/benches/clips.md`.
#![cfg(feature = "opencv")]

use crate::drawn::draw;
use crate::program::touchline;
use std::path::Path;
use touchline::camera::PtzCamera;
use touchline::document::{Click, Document, Frame, FrameStatus, Ground, GroundGrade, VideoFrame};
use touchline::geometry::{Vec2, Vec3};
use touchline_core::testing::ground_landmarks;
use touchline_core::testing::seeded::{self, normal};
use touchline_documents::testing::{load, save};

/// Two seconds.
const FRAMES: usize = 52;
const STEP_S: f64 = 0.04;
/// The size of the pictures where none is stated.
const SIZE: &str = "640x360";

/// A clip tracked from three frames with six rough clicks each, and its truth; with the times that
/// frames of a video have.
fn tracked(folder: &Path, clip: &str) -> (Document, Document) {
    let (seed, size) = clip.split_once('@').unwrap_or((clip, SIZE));
    draw(
        folder,
        &format!(
            "--frames {FRAMES} --step {STEP_S} --seed {seed} --size {size} --preset paper \
             --graphics score-bug"
        ),
    );
    let folder = folder.join("match");
    let truth = load(folder.join("truth.json"));
    let field = truth.field.model(&folder).unwrap();
    let mut rng = seeded::rng("grades of drawn clips");
    let mut asked = truth.clone();
    for (index, frame) in asked.frames.iter_mut().enumerate() {
        let frame: &mut Frame = frame;
        let camera = truth.ptz_camera(&truth.frames[index]).unwrap();
        (frame.status, frame.ptz, frame.solution) = (FrameStatus::New, None, None);
        frame.clicks.clear();
        if !index.is_multiple_of(FRAMES / 2) && index != FRAMES - 1 {
            continue;
        }
        frame.status = FrameStatus::Reference;
        for (_, landmark, exact) in ground_landmarks(&field, &camera) {
            let image = exact.translate(Vec2::new(normal(&mut rng), normal(&mut rng)) * 0.5);
            if frame.image_size.contains(image) && frame.clicks.len() < 6 {
                frame
                    .clicks
                    .push(Click::landmark(landmark.id.clone(), image));
            }
        }
    }
    save(folder.join("ask.json"), &asked);
    touchline(&folder, "solve ask.json -o solved.json --force").done();
    touchline(&folder, "track solved.json -o tracked.json --force").done();
    let mut found = load(folder.join("tracked.json"));
    for (index, frame) in found.frames.iter_mut().enumerate() {
        let time_s = index as f64 * STEP_S;
        frame.video = Some(VideoFrame::new("clip.mp4", index as u64, Some(time_s)));
    }
    (truth, found)
}

/// Where a camera puts a ground point that the true one shows, off that point, m.
fn off_m(truth: &PtzCamera, found: &PtzCamera, point: Vec3) -> Option<Vec3> {
    let shown = truth.image_from_world(point).ok()?;
    Some(found.plane_from_image(shown, 0.0)? - point)
}

/// How far points in the middle third of a frame are off at most, m, and how fast they move against
/// the frames a second before and after, m/s.
fn measured(truth: &Document, found: &Document, index: usize) -> Option<(f64, f64)> {
    let cameras = |index: usize| {
        Some((
            truth.ptz_camera(truth.frames.get(index)?)?,
            found.ptz_camera(found.frames.get(index)?)?,
        ))
    };
    let (real, guess) = cameras(index)?;
    let size = truth.frames.get(index)?.image_size;
    let second = (1.0 / STEP_S) as usize;
    let partners = [index.checked_sub(second), Some(index + second)];
    let mut worst = (0.0_f64, 0.0_f64);
    for cell in (3..6).flat_map(|column| (3..6).map(move |row| [column, row])) {
        let Some(point) = real.plane_from_image(size.cell_centre(cell, [9, 9]), 0.0) else {
            continue;
        };
        if point.x.abs() > 52.5 || point.y.abs() > 34.0 {
            continue;
        }
        let here = off_m(&real, &guess, point)?;
        worst.0 = worst.0.max(here.norm());
        for (real, guess) in partners.into_iter().filter_map(|other| cameras(other?)) {
            let moved = off_m(&real, &guess, point)? - here;
            worst.1 = worst.1.max(moved.norm());
        }
    }
    Some(worst)
}

#[test]
fn frames_graded_for_speeds_and_maps_keep_what_they_promise() {
    let seeds = std::env::var("TOUCHLINE_GRADES").unwrap_or_else(|_| "11".to_owned());
    let (mut maps, mut off, mut speeds, mut fast) = (0, 0, 0, 0);
    for seed in seeds.split(',') {
        let place = tempfile::tempdir().unwrap();
        let (truth, found) = tracked(place.path(), seed);
        let grounds = found.at(place.path()).ground_of_frames().unwrap();
        let mut counts = [0; 3];
        for (index, ground) in grounds.iter().enumerate() {
            let grade = ground
                .as_ref()
                .map_or(GroundGrade::None, |Ground { grade, .. }| *grade);
            counts[grade as usize] += 1;
            if grade == GroundGrade::None {
                continue;
            }
            let (off_m, speed_m_s) = measured(&truth, &found, index).unwrap();
            maps += 1;
            off += usize::from(off_m > 0.5);
            if grade == GroundGrade::Speed {
                speeds += 1;
                fast += usize::from(speed_m_s > 0.1);
            }
        }
        println!("seed {seed}: {counts:?} frames graded none, map, speed");
    }
    println!("{off} of {maps} places off 0.5 m, {fast} of {speeds} frames faster than 0.1 m/s");
    assert!(maps > 30, "{maps} frames are graded");
    assert!(
        20 * fast <= speeds,
        "{fast} of {speeds} faster than 0.1 m/s"
    );
    assert!(20 * off <= maps, "{off} of {maps} off by more than 0.5 m");
}
