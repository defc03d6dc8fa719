//! Clips from the wild: broadcasts as people share them, re-encoded, with graphics, boards that change and smoke.
//!
//! Nobody has clicked or measured anything in them. Whether an answer is right is seen by its panorama: paint that stays lies on the
//! field's lines. The positions of the answers that were seen to be right are written down here, so that they stay right.

use super::answers::{Tally, Way, answer};
use super::drawing::document_of_video;
use super::gate::Rate;
use super::real::{RIGHT_M, heading};
use std::path::Path;
use touchline::autocalibrate::AutocalibrationAnswer;
use touchline::document::FieldSpec;
use touchline::geometry::Vec3;
use touchline::media::FrameSource;

/// A clip of soccer.
struct WildClip {
    name: &'static str,
    /// Where the answer stands that was seen to be right, m; none where none was given.
    position_m: Option<[f64; 3]>,
}

const CLIPS: [WildClip; 8] = [
    WildClip { name: "germany-italy", position_m: Some([1.97, -73.32, 17.52]) },
    WildClip { name: "udinese-cagliari-50fps", position_m: Some([0.44, -88.97, 21.21]) },
    WildClip { name: "estudiantes-patronato", position_m: Some([1.29, -72.70, 27.82]) },
    WildClip { name: "psg-marseille-smoke", position_m: Some([-0.70, -74.65, 21.64]) },
    WildClip { name: "chelsea-milan", position_m: None },
    WildClip { name: "goal-close", position_m: None },
    WildClip { name: "brighton-liverpool", position_m: None },
    WildClip { name: "behind-goal-tactical", position_m: None },
];

/// Those that are right stay right. The others are not counted: what they answer has to be looked at.
pub const RATE: Rate = Rate { tried: 4, right: 4, wrong: 0 };

/// All clips, each as a document of its frames in which nothing is known.
pub fn clips(data: &Path) -> Tally {
    heading("clips from the wild");
    let mut all = Tally::default();
    for WildClip { name, position_m } in CLIPS {
        let video = format!("wild/{name}.mp4");
        let FrameSource::Video(info) = FrameSource::open(&data.join(&video)).unwrap() else { continue };
        let document = document_of_video(&video, &info, FieldSpec::new("soccer"), 1);
        let (answer, seconds) = answer(&document, data, Way::WithoutClicks);
        let (says, tally) = judged(&answer, position_m.map(Vec3::from));
        println!("| {name} | {} | {says} | {seconds:.0} |", document.frames.len());
        if position_m.is_some() {
            all.add(&tally);
        }
    }
    println!("\n{all}");
    all
}

/// What an answer says, and of which kind it is.
fn judged(answer: &AutocalibrationAnswer, right_m: Option<Vec3>) -> (String, Tally) {
    let mut tally = Tally::default();
    let says = match answer {
        AutocalibrationAnswer::Found(found) => {
            let at_m: Vec<String> = found.base.position_m.iter().map(|m| format!("{m:.2}")).collect();
            let at = format!(
                "camera at ({}) m, {} of {} frames snapped",
                at_m.join(", "),
                found.snapped_count(),
                found.frames.len()
            );
            match right_m.map(|right_m| (found.base.position_m - right_m).norm()) {
                None => format!("{at}; its panorama has to be looked at"),
                Some(off_m) => {
                    let is_right = off_m <= RIGHT_M;
                    (tally.right, tally.wrong) = (usize::from(is_right), usize::from(!is_right));
                    format!("{}: {at}, {off_m:.2} m from where it was", if is_right { "right" } else { "WRONG" })
                }
            }
        }
        AutocalibrationAnswer::Two { .. } => {
            tally.two = 1;
            "two answers".to_owned()
        }
        AutocalibrationAnswer::Abstained(why) => {
            tally.abstained = 1;
            format!("abstained: {why}")
        }
    };
    (says, tally)
}
