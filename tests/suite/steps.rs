//! No step makes an answer worse: cameras of a drawn clip, known through a wrong lens, go through the commands in random order.
#![cfg(feature = "opencv")]

use crate::drawn_clip::{document, drawn_clip, landmark_errors_px, write};
use crate::program::touchline;
use crate::seeded;
use rand::seq::IndexedRandom;
use touchline::document::{Document, Frame};
use touchline::geometry::{ImagePoint, Vec2};

/// The commands between which an annotator chooses.
const STEPS: [&str; 4] = ["track", "track --refine-base", "refine-base --markings", "snap"];

/// Steps of each story.
const LENGTH: usize = 3;

/// What a frame is off by is measured to this, px of a frame 640 px wide: landmarks at a picture's border weigh as much as those in its
/// middle, which paint and points hold.
const NOISE_PX: f64 = 1.0;

/// How the lens of the document differs from the one that drew the pictures.
#[derive(Clone, Copy, Debug)]
enum Lens {
    /// Its distortion by 2 % of the distance to the middle, at the corner.
    Bent,
    /// Its principal point by 50 px of a frame 1920 px wide.
    OffCentre,
}

impl Lens {
    fn apply(self, document: &mut Document) {
        let camera = document.cameras[0].id.clone();
        let mut base = document.camera(&camera).unwrap().base().unwrap();
        match self {
            Self::Bent => {
                let focal_px = document.frames[0].ptz.as_ref().unwrap().focal_px;
                let corner = base.principal_point.offset_from(ImagePoint::new(0.0, 0.0));
                base.distortion.value += 0.02 * (focal_px / corner.norm()).powi(2);
            }
            Self::OffCentre => base.principal_point = base.principal_point.moved(Vec2::new(50.0, 0.0) / 3.0),
        }
        document.camera_mut(&camera).unwrap().set_base(&base);
    }
}

fn confidence(frame: &Frame) -> Option<f64> {
    frame.solution.as_ref()?.confidence
}

fn has_reason(frame: &Frame) -> bool {
    frame.solution.as_ref().is_some_and(|solution| !solution.warnings.is_empty())
}

/// The middle one of a frame's landmark errors, px.
fn off_px(document: &Document, truth: &Document, frame: usize) -> Option<f64> {
    let mut errors = landmark_errors_px(document, truth, frame)?;
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() / 2).copied()
}

#[test]
fn no_step_makes_a_camera_worse_than_it_states_nor_doubts_it_without_a_reason() {
    let stories = std::env::var("TOUCHLINE_STORIES").map_or(1, |count| count.parse::<usize>().unwrap());
    let mut rng = seeded::rng("no_step_makes_a_camera_worse");
    let place = tempfile::tempdir().unwrap();
    let truth = drawn_clip(place.path());
    let folder = place.path().join("match");
    for lens in std::iter::repeat_n([Lens::Bent, Lens::OffCentre], stories).flatten() {
        let mut before = document(&folder.join("ask.json"));
        lens.apply(&mut before);
        let mut story = format!("{lens:?}");
        for _ in 0..LENGTH {
            let step = STEPS.choose(&mut rng).unwrap();
            story = format!("{story}; {step}");
            let (command, options) = step.split_once(' ').unwrap_or((step, ""));
            write(&folder.join("before.json"), &before);
            let ran = touchline(&folder, &format!("{command} before.json {options} -o after.json --force"));
            if ran.code == 2 {
                // It says why it cannot, and nothing is written.
                continue;
            }
            let after = document(&folder.join("after.json"));
            for index in 0..truth.frames.len() {
                compare((&before, &after), &truth, index, &story);
            }
            before = after;
        }
    }
}

/// Whether a step left a frame's camera as good as it was.
fn compare((before, after): (&Document, &Document), truth: &Document, index: usize, story: &str) {
    let (was, is) = (&before.frames[index], &after.frames[index]);
    let (Some(was_px), Some(is_px)) = (off_px(before, truth, index), off_px(after, truth, index)) else { return };
    let stated_px = is.solution.as_ref().and_then(|solution| solution.worst_corner_sigma_px).unwrap_or(0.0);
    assert!(is_px <= was_px + NOISE_PX.max(stated_px), "{story}: frame {index} went from {was_px} to {is_px} px");
    if confidence(was).is_some_and(|confidence| confidence >= 0.9) && confidence(is).is_some_and(|now| now < 0.5) {
        assert!(has_reason(is), "{story}: frame {index} is doubted without a reason");
    }
}
