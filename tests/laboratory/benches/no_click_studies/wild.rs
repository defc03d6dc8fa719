//! Clips from the wild: broadcasts as people share them, re-encoded, with graphics, boards that
//! change and smoke.
//!
//! Nobody has clicked or measured anything in them. Whether an answer is right is seen by its
//! panorama: paint that stays lies on the field's lines. The positions of the answers that were
//! seen to be right are written down here, so that they stay right.

use super::answers::{Tally, Way, answer};
use super::gate::Rate;
use super::real::{RIGHT_M, heading};
use super::video_document::document_of_video;
use std::path::Path;
use touchline::autocalibrate::AutocalibrationAnswer;
use touchline::document::FieldSpec;
use touchline::geometry::Vec3;
use touchline::media::FrameSource;

/// A clip of soccer.
struct WildClip {
    name: &'static str,
    /// The answer that was seen to be right; none where none was given.
    right: Option<SeenRight>,
}

/// Where the camera of a right answer stands.
struct SeenRight {
    position_m: [f64; 3],
    /// Its 1-σ, m: larger than [`RIGHT_M`] where a clip shows one end of the pitch through a long
    /// lens.
    sigma_m: f64,
}

const fn right(name: &'static str, position_m: [f64; 3], sigma_m: f64) -> WildClip {
    WildClip {
        name,
        right: Some(SeenRight {
            position_m,
            sigma_m,
        }),
    }
}

const fn without_answer(name: &'static str) -> WildClip {
    WildClip { name, right: None }
}

const CLIPS: [WildClip; 8] = [
    right("germany-italy", [1.97, -73.32, 17.52], 1.3),
    right("udinese-cagliari-50fps", [0.44, -88.97, 21.21], 1.2),
    right("estudiantes-patronato", [1.29, -72.70, 27.82], 2.1),
    right("psg-marseille-smoke", [-0.70, -74.65, 21.64], 0.6),
    right("brighton-liverpool", [0.67, -69.67, 16.20], 3.2),
    right("chelsea-milan", [0.16, -51.96, 10.97], 0.5),
    right("behind-goal-tactical", [-118.83, -1.67, 40.03], 1.2),
    without_answer("goal-close"),
];

/// Those that are right stay right; `chelsea-milan` is near the limit of frames that have to agree.
/// The others are not counted: what they answer has to be looked at.
pub const RATE: Rate = Rate {
    tried: 7,
    right: 6,
    wrong: 0,
};

/// All clips, each as a document of its frames in which nothing is known.
pub fn clips(data: &Path) -> Tally {
    heading("clips from the wild");
    let mut all = Tally::default();
    for WildClip { name, right } in &CLIPS {
        let video = format!("wild/{name}.mp4");
        let FrameSource::Video(info) = FrameSource::open(&data.join(&video)).unwrap() else {
            continue;
        };
        let document = document_of_video(&video, &info, FieldSpec::new("soccer"), 1);
        let (answer, seconds) = answer(&document, data, Way::WithoutClicks);
        let (says, tally) = judge(&answer, right.as_ref());
        println!(
            "| {name} | {} | {says} | {seconds:.0} |",
            document.frames.len()
        );
        if right.is_some() {
            all.add(&tally);
        }
    }
    println!("\n{all}");
    all
}

/// What an answer says, and of which kind it is.
fn judge(answer: &AutocalibrationAnswer, right: Option<&SeenRight>) -> (String, Tally) {
    let mut tally = Tally::default();
    let says = match answer {
        AutocalibrationAnswer::Found(found) => {
            let at_m: Vec<String> = found
                .base
                .position_m
                .iter()
                .map(|m| format!("{m:.2}"))
                .collect();
            let at = format!(
                "camera at ({}) m, {} of {} frames snapped",
                at_m.join(", "),
                found.aligned_frame_count(),
                found.frames.len()
            );
            match right {
                None => format!("{at}; its panorama has to be looked at"),
                Some(right) => {
                    let off_m = (found.base.position_m - Vec3::from(right.position_m)).norm();
                    let is_right = off_m <= RIGHT_M.max(right.sigma_m);
                    (tally.right, tally.wrong) = (usize::from(is_right), usize::from(!is_right));
                    format!(
                        "{}: {at}, {off_m:.2} m from where it was",
                        if is_right { "right" } else { "WRONG" }
                    )
                }
            }
        }
        AutocalibrationAnswer::Abstained { why, .. } => {
            tally.abstained = 1;
            format!("abstained: {why}")
        }
    };
    (says, tally)
}
