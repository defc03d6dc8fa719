//! What the answer depends on: drawn matches with fewer frames, of a part of the pitch, and with
//! longer lenses.

use super::answers::{Measured, Tally, Way, answer, judge_answer};
use super::drawing::{SIZE, Shot, draw, shots};
use super::gate::Rate;
use super::matches::{DrawnMatch, base, shoot};
use std::path::Path;
use touchline::camera::PtzCamera;
use touchline::document::FieldSpec;
use touchline::field::FieldModel;
use touchline::geometry::Vec3;
use touchline::synthetic::{StadiumOptions, stadium};

/// One match of each of two presets.
const MATCHES: [usize; 2] = [4, 5];

/// Few frames and long lenses may leave too little to see for an answer; none may be wrong.
pub const RATE: Rate = Rate::never_wrong(MATCHES.len() * VARIED.len());

/// Frames unless their number is what differs.
const FRAMES: usize = 20;

/// What differs from a match as it is.
#[derive(Clone, Copy)]
enum Varied {
    Frames(usize),
    /// The frames that look nearest to the middle of all views, as a share of the way between the
    /// outermost.
    Views(f64),
    /// Focal lengths are so many times as long.
    Lens(f64),
}

const VARIED: [Varied; 11] = [
    Varied::Frames(5),
    Varied::Frames(10),
    Varied::Frames(20),
    Varied::Frames(40),
    Varied::Views(0.25),
    Varied::Views(0.5),
    Varied::Views(0.75),
    Varied::Lens(0.7),
    Varied::Lens(1.4),
    Varied::Lens(2.0),
    Varied::Lens(2.8),
];

/// Asks every match with everything that differs.
pub fn spread(pictures: &Path) -> Tally {
    println!(
        "\n## what the answer depends on, {}x{}\n",
        SIZE.width, SIZE.height
    );
    println!(
        "| match | | frames | of the pitch seen | focal length, px | answer | s |\n|---|---|---|---|---|---|---|"
    );
    let mut all = Tally::default();
    for number in MATCHES {
        let DrawnMatch {
            field,
            position_m,
            preset,
            seed,
        } = DrawnMatch::of(number);
        let shoot = shoot(preset);
        let options = StadiumOptions {
            daylight: shoot.daylight,
            ..StadiumOptions::new(field.clone(), seed)
        };
        let scene = stadium(&options);
        let of_frames =
            |frames: usize| shots(&scene, &base(preset, position_m), &shoot, frames, seed);
        for (place, varied) in VARIED.into_iter().enumerate() {
            let (shots, says) = match varied {
                Varied::Frames(frames) => (of_frames(frames), format!("{frames} frames")),
                // Of more frames, so that as many remain.
                Varied::Views(share) => {
                    let asked = (FRAMES as f64 / share) as usize;
                    (
                        nearest(of_frames(asked)),
                        format!("the middle {:.0} % of the views", 100.0 * share),
                    )
                }
                Varied::Lens(times) => (
                    longer(of_frames(FRAMES), times),
                    format!("{times} times the focal length"),
                ),
            };
            let folder = pictures.join(format!("spread-{number:02}-{place:02}"));
            let drawn = draw(
                &folder,
                &[(&scene, &shots)],
                shoot.jpeg_quality,
                FieldSpec::new("soccer"),
            );
            let (answer, seconds) = answer(&drawn.document, &folder, Way::WithoutClicks);
            let (answered, tally) = judge_answer(
                &drawn.document,
                &answer,
                Some((&drawn.truth, &field)),
                Measured::Ground,
            );
            let mut focal_px: Vec<f64> = shots
                .iter()
                .map(|shot| shot.camera.ptz().focal_px)
                .collect();
            focal_px.sort_by(f64::total_cmp);
            println!(
                "| {number} {preset:?} | {says} | {} | {:.0} % | {:.0} to {:.0} | {answered} | {seconds:.0} |",
                shots.len(),
                100.0 * share_seen(&drawn.truth, &field),
                focal_px[0],
                focal_px[focal_px.len() - 1]
            );
            all.add(&tally);
        }
    }
    println!("\n{all}");
    all
}

/// [`FRAMES`] of some frames, those that look nearest to the middle one of all pans, in their order.
fn nearest(shots: Vec<Shot>) -> Vec<Shot> {
    let pan = |shot: &Shot| shot.camera.ptz().pan.degrees();
    let mut pans: Vec<f64> = shots.iter().map(pan).collect();
    pans.sort_by(f64::total_cmp);
    let middle = pans[pans.len() / 2];
    let mut off: Vec<f64> = pans.iter().map(|pan| (pan - middle).abs()).collect();
    off.sort_by(f64::total_cmp);
    let within = off[FRAMES.min(off.len()) - 1];
    shots
        .into_iter()
        .filter(|shot| (pan(shot) - middle).abs() <= within)
        .take(FRAMES)
        .collect()
}

fn longer(mut shots: Vec<Shot>, times: f64) -> Vec<Shot> {
    for shot in &mut shots {
        let mut ptz = shot.camera.ptz();
        ptz.focal_px *= times;
        shot.camera = PtzCamera::new(*shot.camera.base(), ptz);
    }
    shots
}

/// The share of the pitch that the frames show together.
fn share_seen(cameras: &[PtzCamera], field: &FieldModel) -> f64 {
    let (columns, rows) = (42, 27);
    let at = |index: usize, of: usize, length_m: f64| {
        ((index as f64 + 0.5) / of as f64 - 0.5) * length_m
    };
    let cells = (0..columns * rows).map(|cell| {
        Vec3::new(
            at(cell % columns, columns, field.length_m),
            at(cell / columns, rows, field.width_m),
            0.0,
        )
    });
    let is_seen = |place: &Vec3| {
        cameras.iter().any(|camera| {
            camera
                .image_from_world(*place)
                .is_ok_and(|at| SIZE.contains(at))
        })
    };
    cells.filter(is_seen).count() as f64 / (columns * rows) as f64
}
