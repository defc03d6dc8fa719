//! Drawn matches: cameras from corner to halfway line, fields of all sizes, three presets.

use super::answers::{Measured, Tally, Way, answer, judge_answer, two_clicked};
use super::drawing::{SIZE, draw, shots};
use super::gate::Rate;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use touchline::autocalibrate::AutocalibrationAnswer;
use touchline::camera::CameraBase;
use touchline::document::FieldSpec;
use touchline::field::{FieldModel, builtin};
use touchline::geometry::Vec3;
use touchline::synthetic::{Preset, ShootOptions, StadiumOptions, stadium};

/// All thirty are right. One may lose its answer, as several lie near a limit of doubt, which
/// another processor's rounding can cross; none may be wrong, as nobody looks again at what is
/// shown as good.
pub const RATE: Rate = Rate {
    tried: 30,
    right: 29,
    wrong: 0,
};

/// Two clicks help where there is no answer without one: how often is not known beforehand.
pub const TWO_CLICKS_RATE: Rate = Rate::never_wrong(RATE.tried);

/// Frames of a match, where no other number is asked for.
pub const FRAMES: usize = 20;

/// Seconds between them.
const STEP_S: f64 = 4.7;

/// What is drawn.
pub struct DrawnMatch {
    pub field: FieldModel,
    pub position_m: Vec3,
    pub preset: Preset,
    pub seed: u64,
}

/// A soccer field.
pub fn soccer(length_m: f64, width_m: f64, crown_m: f64) -> FieldModel {
    let params = BTreeMap::from([
        ("length_m".to_owned(), length_m),
        ("width_m".to_owned(), width_m),
    ]);
    builtin("soccer").unwrap().model(&params, crown_m).unwrap()
}

/// How a preset takes pictures, seconds apart.
pub fn shoot(preset: Preset) -> ShootOptions {
    ShootOptions {
        step_s: STEP_S,
        ..preset.shoot()
    }
}

/// The camera of a preset at a place.
pub fn base(preset: Preset, position_m: Vec3) -> CameraBase {
    CameraBase {
        position_m,
        ..preset.shoot().main_camera(SIZE)
    }
}

impl DrawnMatch {
    /// The match of a number: everything spread evenly over what is possible (Weyl sequences of
    /// square roots of primes).
    pub fn of(number: usize) -> Self {
        let spread = |prime: f64, from: f64, to: f64| {
            from + (to - from) * ((number as f64 + 0.5) * prime.sqrt()).fract()
        };
        let field = soccer(
            spread(2.0, 100.0, 110.0),
            spread(3.0, 64.0, 75.0),
            spread(5.0, 0.0, 0.3),
        );
        let behind_m = spread(7.0, 18.0, 45.0);
        let position_m = Vec3::new(
            spread(11.0, -0.5, 0.5) * field.length_m,
            -0.5 * field.width_m - behind_m,
            spread(13.0, 6.0, 30.0),
        );
        let preset = [Preset::Easy, Preset::Paper, Preset::Hard][number % 3];
        Self {
            field,
            position_m,
            preset,
            seed: 1000 + number as u64,
        }
    }
}

/// What was answered without a click, and what with two.
pub struct Answered {
    pub without_clicks: Tally,
    pub two_clicks: Tally,
}

/// The drawn matches, `frames` of each; those that are not found without a click are asked again
/// with two, with `two_clicks` all at once.
pub fn drawn_matches(
    pictures: &Path,
    numbers: Range<usize>,
    frames: usize,
    two_clicks: bool,
) -> Answered {
    println!(
        "\n## drawn: {frames} frames of {}x{}, {STEP_S} s apart\n",
        SIZE.width, SIZE.height
    );
    println!("| match | field, m | camera, m | answer | s |\n|---|---|---|---|---|");
    let mut all = Answered {
        without_clicks: Tally::default(),
        two_clicks: Tally::default(),
    };
    for number in numbers {
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
        let shots = shots(&scene, &base(preset, position_m), &shoot, frames, seed);
        let folder = pictures.join(format!("match-{number:02}"));
        let drawn = draw(
            &folder,
            &[(&scene, &shots)],
            shoot.jpeg_quality,
            FieldSpec::new("soccer"),
        );
        let row = |(says, seconds): (&str, f64)| {
            println!(
                "| {number} {preset:?} | {:.1} × {:.1} | ({:.1}, {:.1}, {:.1}) | {says} | {seconds:.0} |",
                field.length_m, field.width_m, position_m.x, position_m.y, position_m.z
            );
        };
        let mut is_found = false;
        if !two_clicks {
            let (answer, seconds) = answer(&drawn.document, &folder, Way::WithoutClicks);
            let (says, tally) = judge_answer(
                &drawn.document,
                &answer,
                Some((&drawn.truth, &field)),
                Measured::Lines,
            );
            row((&says, seconds));
            all.without_clicks.add(&tally);
            is_found = matches!(answer, AutocalibrationAnswer::Found(_));
        }
        if !is_found {
            let with_clicks =
                two_clicked(&drawn.document, 0..drawn.truth.len(), &drawn.truth, &field);
            let (answer, seconds) = answer(&with_clicks, &folder, Way::FewClicks);
            let (says, tally) = judge_answer(
                &with_clicks,
                &answer,
                Some((&drawn.truth, &field)),
                Measured::Lines,
            );
            row((&format!("two clicks: {says}"), seconds));
            all.two_clicks.add(&tally);
        }
    }
    println!(
        "\nwithout a click: {}\nwith two clicks: {}",
        all.without_clicks, all.two_clicks
    );
    all
}
