//! Inputs that have no right answer, or hardly one: what is shown as good all the same is wrong.

use super::answers::{Measured, Tally, Way, answer, judge_answer};
use super::drawing::{Drawn, Shot, draw, shots};
use super::gate::Rate;
use super::matches::{base, shoot, soccer};
use std::ops::Range;
use std::path::Path;
use touchline::camera::{CameraBase, Ptz, PtzCamera};
use touchline::document::{FieldSize, FieldSpec};
use touchline::field::{Curve, FieldModel, builtin};
use touchline::geometry::{Angle, Vec3};
use touchline::synthetic::{FrameOptions, Preset, Stadium, StadiumOptions, stadium};

/// What is drawn of each input.
const FRAMES: usize = 16;
const PRESET: Preset = Preset::Paper;
const SEED: u64 = 77;

/// An input, drawn.
pub struct Input {
    drawn: Drawn,
    /// The field as it is painted, where an answer can be right.
    field: Option<FieldModel>,
}

/// Draws an input into a folder.
type Draw = fn(&Path) -> Input;

/// The inputs by name.
pub const INPUTS: [(&str, Draw); 14] = [
    ("an American football field", |folder| {
        other_sport(folder, "american_football_nfl")
    }),
    ("a handball court", |folder| other_sport(folder, "handball")),
    ("a crowd without a pitch", crowd),
    (
        "a training pitch with a second set of lines across",
        training,
    ),
    ("a pitch with boxes of another size", other_boxes),
    ("frames of two cameras", two_cameras),
    ("a camera that moves along the touchline", moving),
    ("ten frames of one view", one_view),
    ("100 × 64 m, said to be 105 × 68", |folder| {
        pinned_input(folder, [100.0, 64.0], [105.0, 68.0])
    }),
    ("100 × 64 m, said to be 110 × 75", |folder| {
        pinned_input(folder, [100.0, 64.0], [110.0, 75.0])
    }),
    ("105 × 68 m, said to be 103 × 68", |folder| {
        pinned_input(folder, [105.0, 68.0], [103.0, 68.0])
    }),
    ("frames of one end only", |folder| {
        one_end(folder, [105.0, 68.0])
    }),
    ("frames of one end only, 107.5 × 68 m", |folder| {
        one_end(folder, [107.5, 68.0])
    }),
    ("frames of one end only, 101 × 66 m", |folder| {
        one_end(folder, [101.0, 66.0])
    }),
];

/// Silence is as good as a right answer here, and a wrong one is what the inputs are drawn for.
pub const RATE: Rate = Rate::never_wrong(INPUTS.len());

pub fn bad_inputs(pictures: &Path, numbers: Range<usize>) -> Tally {
    println!("\n## inputs that must fail\n\n| input | answer | s |\n|---|---|---|");
    let mut all = Tally::default();
    for number in numbers {
        let (name, draw) = INPUTS[number];
        let folder = pictures.join(format!("refused-{number:02}"));
        let input = draw(&folder);
        let (answer, seconds) = answer(&input.drawn.document, &folder, Way::WithoutClicks);
        let truth = input
            .field
            .as_ref()
            .map(|field| (&*input.drawn.truth, field));
        let (says, tally) = judge_answer(&input.drawn.document, &answer, truth, Measured::Ground);
        println!("| {name} | {says} | {seconds:.0} |");
        all.add(&tally);
    }
    println!("\n{all}");
    all
}

const MAIN: Vec3 = Vec3::new(-8.0, -64.0, 17.0);

fn scene(field: &FieldModel) -> Stadium {
    let daylight = PRESET.shoot().daylight;
    stadium(&StadiumOptions {
        daylight,
        ..StadiumOptions::new(field.clone(), SEED)
    })
}

fn quality() -> u8 {
    PRESET.shoot().jpeg_quality
}

fn draw_input(folder: &Path, scene: &Stadium, shots: &[Shot], truth: Option<FieldModel>) -> Input {
    Input {
        drawn: draw(
            folder,
            &[(scene, shots)],
            quality(),
            FieldSpec::new("soccer"),
        ),
        field: truth,
    }
}

fn main_shots(scene: &Stadium) -> Vec<Shot> {
    shots(scene, &base(PRESET, MAIN), &shoot(PRESET), FRAMES, SEED)
}

fn other_sport(folder: &Path, template: &str) -> Input {
    let scene = scene(&builtin(template).unwrap().default_model().unwrap());
    draw_input(folder, &scene, &main_shots(&scene), None)
}

/// The camera looks at the stands.
fn crowd(folder: &Path) -> Input {
    let scene = scene(&soccer(105.0, 68.0, 0.1));
    let look = |index: usize| Shot {
        camera: PtzCamera::new(
            base(PRESET, MAIN),
            Ptz::from_degrees(-20.0 + 2.5 * index as f64, 6.0, 1400.0),
        ),
        options: FrameOptions {
            time_s: index as f64,
            ..FrameOptions::default()
        },
    };
    draw_input(
        folder,
        &scene,
        &(0..FRAMES).map(look).collect::<Vec<_>>(),
        None,
    )
}

/// A second, smaller field painted across the first.
fn training(folder: &Path) -> Input {
    let mut field = soccer(105.0, 68.0, 0.0);
    let turned = |at: Vec3| Vec3::new(-0.62 * at.y, 0.62 * at.x, at.z);
    let others = field.lines.iter().filter(|line| line.painted).map(|line| {
        let mut line = line.clone();
        for curve in [&mut line.curve, &mut line.paint_centre] {
            *curve = match *curve {
                Curve::Segment { from, to } => Curve::Segment {
                    from: turned(from),
                    to: turned(to),
                },
                Curve::Arc {
                    centre,
                    radius_m,
                    start,
                    sweep,
                } => Curve::Arc {
                    centre: turned(centre),
                    radius_m: 0.62 * radius_m,
                    start: start + Angle::from_degrees(90.0),
                    sweep,
                },
            };
        }
        line
    });
    let others: Vec<_> = others.collect();
    field.lines.extend(others);
    let scene = scene(&field);
    draw_input(
        folder,
        &scene,
        &main_shots(&scene),
        Some(soccer(105.0, 68.0, 0.0)),
    )
}

/// Everything within the boundary is stretched: penalty areas, circle and goal areas are no soccer
/// field's.
fn other_boxes(folder: &Path) -> Input {
    let mut field = soccer(105.0, 68.0, 0.0);
    let half_length_m = 0.5 * field.length_m;
    let stretched = |at: Vec3| {
        let from_end = half_length_m - at.x.abs();
        Vec3::new(
            at.x.signum() * (half_length_m - 1.3 * from_end).max(0.0),
            at.y,
            at.z,
        )
    };
    for line in field.lines.iter_mut().filter(|line| line.painted) {
        for curve in [&mut line.curve, &mut line.paint_centre] {
            match curve {
                Curve::Segment { from, to } => (*from, *to) = (stretched(*from), stretched(*to)),
                Curve::Arc { radius_m, .. } => *radius_m *= 1.25,
            }
        }
    }
    let scene = scene(&field);
    draw_input(folder, &scene, &main_shots(&scene), None)
}

fn two_cameras(folder: &Path) -> Input {
    let field = soccer(105.0, 68.0, 0.1);
    let scene = scene(&field);
    let of = |position_m: Vec3, seed: u64| {
        shots(
            &scene,
            &base(PRESET, position_m),
            &shoot(PRESET),
            FRAMES,
            seed,
        )
    };
    let (first, second) = (of(MAIN, 1), of(Vec3::new(38.0, -58.0, 11.0), 2));
    let mixed: Vec<Shot> = first
        .into_iter()
        .zip(second)
        .flat_map(|(one, other)| [one, other])
        .collect();
    draw_input(folder, &scene, &mixed, Some(field))
}

fn moving(folder: &Path) -> Input {
    let field = soccer(105.0, 68.0, 0.1);
    let scene = scene(&field);
    let moved = |(index, shot): (usize, Shot)| {
        let position_m = MAIN + Vec3::new(1.5 * index as f64, 0.0, 0.0);
        let base = CameraBase {
            position_m,
            ..*shot.camera.base()
        };
        Shot {
            camera: PtzCamera::new(base, shot.camera.ptz()),
            ..shot
        }
    };
    let shots: Vec<Shot> = main_shots(&scene)
        .into_iter()
        .enumerate()
        .map(moved)
        .collect();
    draw_input(folder, &scene, &shots, None)
}

/// The camera rests on the centre circle.
fn one_view(folder: &Path) -> Input {
    let field = soccer(105.0, 68.0, 0.1);
    let scene = scene(&field);
    let mut shots = main_shots(&scene);
    shots.truncate(10);
    let first = shots[0].camera;
    for (index, shot) in shots.iter_mut().enumerate() {
        let hand = Angle::from_degrees(0.02 * index as f64);
        let ptz = first.ptz();
        shot.camera = PtzCamera::new(
            *first.base(),
            Ptz {
                pan: ptz.pan + hand,
                ..ptz
            },
        );
    }
    draw_input(folder, &scene, &shots, Some(field))
}

fn pinned_input(folder: &Path, [length_m, width_m]: [f64; 2], said: [f64; 2]) -> Input {
    let field = soccer(length_m, width_m, 0.1);
    let scene = scene(&field);
    let mut spec = FieldSpec::new("soccer");
    for (name, value) in ["length_m", "width_m"].into_iter().zip(said) {
        spec.params.insert(name.to_owned(), value);
    }
    spec.size = Some(FieldSize::Confirmed);
    Input {
        drawn: draw(folder, &[(&scene, &main_shots(&scene))], quality(), spec),
        field: Some(field),
    }
}

/// The camera stays on one penalty area.
fn one_end(folder: &Path, [length_m, width_m]: [f64; 2]) -> Input {
    let field = soccer(length_m, width_m, 0.1);
    let scene = scene(&field);
    let base = base(PRESET, MAIN);
    let look = |(index, shot): (usize, Shot)| {
        let turn = index as f64;
        let ptz = Ptz::from_degrees(
            42.0 + 6.0 * (1.3 * turn).sin(),
            -12.0 + 1.5 * (0.7 * turn).cos(),
            1500.0,
        );
        Shot {
            camera: PtzCamera::new(base, ptz),
            ..shot
        }
    };
    let shots: Vec<Shot> = main_shots(&scene)
        .into_iter()
        .enumerate()
        .map(look)
        .collect();
    draw_input(folder, &scene, &shots, Some(field))
}
