//! How far bases of real cameras say they are to be trusted.

use crate::parts::{Test, frames_folder, tests};
use std::path::Path;
use touchline::field::FieldElement;
use touchline::progress::Progress;
use touchline::solve::Observation;
use touchline::solve::base::{BaseOptions, CameraClicks, FrameClicks, estimate_base};
use touchline_core::testing::SIZE;

pub const TESTS: &[Test] = tests![
    [Frames] real_bases_from_halves_agree_within_what_they_state;
];

/// Real cameras: the stated sigma against what a base from half of the landmarks, or of the frames,
/// says otherwise.
fn real_bases_from_halves_agree_within_what_they_state() {
    let data = frames_folder();
    for set in ["08fd33", "42ba34", "d82e7a"] {
        let read = |name: &str| {
            touchline::store::read(&data.join(format!("scouting-{set}/{name}.json")))
                .unwrap()
                .1
        };
        let document = read("clicks");
        let field = document.field.model(Path::new(".")).unwrap();
        let all: Vec<FrameClicks> = document
            .frames
            .iter()
            .map(|frame| FrameClicks {
                observations: touchline::calibrate::observations(frame, &field).unwrap(),
                start: None,
            })
            .collect();
        let estimate = |frames: &[FrameClicks]| {
            estimate_base(
                &CameraClicks::with_centred_principal_point(&field, frames, SIZE),
                None,
                &BaseOptions::default(),
                &Progress::default(),
            )
            .unwrap()
        };
        let whole = estimate(&all);
        let fitted = read("fit-k1").cameras[0].base().unwrap().position_m;
        let independent = whole.position_covariance.diagonal().map(f64::sqrt);
        let score = whole
            .scores
            .iter()
            .find(|score| score.model == whole.model)
            .unwrap();
        println!(
            "{set}: {:.3?} ± {:.3?} m; adjustment ± {:.3?}, jackknife over frames ± {:.3?}; off fit-k1 by {:.3?}",
            whole.base.position_m.as_slice(),
            whole.base.sigma.position_m.as_slice(),
            independent.as_slice(),
            score
                .spread
                .diagonal()
                .map(f64::sqrt)
                .fixed_rows::<3>(0)
                .as_slice(),
            (whole.base.position_m - fitted).as_slice()
        );
        let kept = |keep: &dyn Fn(usize, &Observation) -> bool| -> Vec<FrameClicks> {
            let part = |(index, frame): (usize, &FrameClicks)| FrameClicks {
                observations: frame
                    .observations
                    .iter()
                    .filter(|click| keep(index, click))
                    .copied()
                    .collect(),
                start: None,
            };
            all.iter().enumerate().map(part).collect()
        };
        let number = |click: &Observation| match click.element.unwrap() {
            FieldElement::Landmark(index) => index,
            FieldElement::Line(_) | FieldElement::Paint(_) => 0,
        };
        for (what, one, two) in [
            (
                "frames",
                kept(&|index, _| index % 2 == 0),
                kept(&|index, _| index % 2 == 1),
            ),
            (
                "landmarks",
                kept(&|_, click| number(click) % 2 == 0),
                kept(&|_, click| number(click) % 2 == 1),
            ),
        ] {
            let (one, two) = (estimate(&one).base, estimate(&two).base);
            let apart = one.position_m - two.position_m;
            let sigma = (one.sigma.position_m.component_mul(&one.sigma.position_m)
                + two.sigma.position_m.component_mul(&two.sigma.position_m))
            .map(f64::sqrt);
            let z = apart.component_div(&sigma);
            println!(
                "  halves of the {what}: apart by {:.3?} m, stated ± {:.3?} m, z {:.2?}",
                apart.as_slice(),
                sigma.as_slice(),
                z.as_slice()
            );
            // 3.5 for the height from half of the landmarks of 42ba34, with the principal point
            // free.
            assert!(z.amax() < 3.6, "{set}, {what}: {z:?}");
        }
    }
}
