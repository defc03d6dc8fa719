//! Labels that do not quite fit each other are made to, by what the pictures share.

use rand_pcg::Pcg64Mcg;
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::geometry::{Angle, Mat3, Vec3};
use touchline_core::testing::seeded::{normal, rng};
use touchline_vision::features::Features;
use touchline_vision::relocalize::{Label, Misfit, Reference, adjust_labels};
use touchline_vision::testing::{SIZE, base, picture, scene};

/// 1-σ of a label: a few px in pan and tilt, and of focal length.
const SIGMAS: [f64; 3] = [1.2e-3, 1.2e-3, 12.0];

const COUNT: usize = 12;

/// Surplus equations of a reference of four clicks.
const SURPLUS: f64 = 5.0;

fn looks(i: usize) -> Ptz {
    Ptz::from_degrees(
        -15.0 + 2.5 * i as f64,
        -10.0 - (i % 2) as f64,
        1800.0 + 100.0 * (i % 3) as f64,
    )
}

/// A label that is off by so many of its sigmas.
fn off(ptz: Ptz, by: Vec3) -> Ptz {
    Ptz {
        pan: ptz.pan + Angle::from_radians(by.x * SIGMAS[0]),
        tilt: ptz.tilt + Angle::from_radians(by.y * SIGMAS[1]),
        focal_px: ptz.focal_px + by.z * SIGMAS[2],
    }
}

/// By how many of a label's sigmas a camera is off.
fn in_sigmas(found: Ptz, truth: Ptz) -> Vec3 {
    let (pan, tilt) = (
        found.pan.turn_from(truth.pan).radians(),
        (found.tilt - truth.tilt).radians(),
    );
    Vec3::new(
        pan / SIGMAS[0],
        tilt / SIGMAS[1],
        (found.focal_px - truth.focal_px) / SIGMAS[2],
    )
}

/// Labels off by so many sigmas, aligned: by how many sigmas they are off then, and the covariance
/// stated of that, in sigmas too.
fn align(rng: &mut Pcg64Mcg, offs: &[Vec3], misfit: Option<Misfit>) -> Vec<(Vec3, Mat3)> {
    let scene = scene(rng);
    let pictures: Vec<Features> = (0..offs.len())
        .map(|i| picture(&scene, looks(i), rng))
        .collect();
    let references: Vec<Reference> = (0..)
        .zip(pictures.iter().zip(offs))
        .map(|(i, (features, by))| Reference {
            features,
            camera: PtzCamera::new(base(), off(looks(i), *by)),
        })
        .collect();
    let covariance = Mat3::from_diagonal(&Vec3::from(SIGMAS.map(|sigma| sigma * sigma)));
    let found = adjust_labels(&references, &vec![Label { covariance, misfit }; offs.len()]);
    let units = Mat3::from_diagonal(&Vec3::from(SIGMAS.map(f64::recip)));
    (0..)
        .zip(found)
        .map(|(i, (ptz, covariance))| (in_sigmas(ptz, looks(i)), units * covariance * units))
        .collect()
}

fn errors(rng: &mut Pcg64Mcg, sigma: f64) -> Vec<Vec3> {
    (0..COUNT)
        .map(|_| Vec3::from_fn(|_, _| sigma * normal(rng)))
        .collect()
}

/// Clicks that scatter as they are supposed to.
const USUAL: Option<Misfit> = Some(Misfit {
    chi_squared: SURPLUS,
    expected: SURPLUS,
});

#[test]
fn aligned_labels_are_better_and_say_by_how_much() {
    let mut rng = rng("aligned_labels_are_better_and_say_by_how_much");
    let (mut before, mut after, mut in_stated) = (0.0, 0.0, 0.0);
    let draws = 8;
    for _ in 0..draws {
        let offs = errors(&mut rng, 1.0);
        before += offs.iter().map(Vec3::norm_squared).sum::<f64>();
        for (off, covariance) in align(&mut rng, &offs, USUAL) {
            after += off.norm_squared();
            in_stated += off.dot(&(covariance.try_inverse().unwrap() * off));
        }
    }
    let stated = (in_stated / (3 * COUNT * draws) as f64).sqrt();
    assert!(after < before / 4.0, "{before} {after}");
    assert!(
        (0.6..1.3).contains(&stated),
        "errors are {stated} of what is stated"
    );
}

#[test]
fn clicks_that_scatter_more_than_usual_are_known_by_it() {
    let mut rng = rng("clicks_that_scatter_more_than_usual_are_known_by_it");
    let trace = |found: &[(Vec3, Mat3)]| {
        found
            .iter()
            .map(|(_, covariance)| covariance.trace())
            .sum::<f64>()
    };
    let offs = errors(&mut rng, 1.0);
    let as_usual = trace(&align(&mut rng.clone(), &offs, USUAL));
    let twice: Vec<Vec3> = offs.iter().map(|off| off * 2.0).collect();
    let scattered = Some(Misfit {
        chi_squared: 4.0 * SURPLUS,
        expected: SURPLUS,
    });
    let ratio = trace(&align(&mut rng.clone(), &twice, scattered)) / as_usual;
    assert!((2.5..4.5).contains(&ratio), "{ratio}");
    // What rests on no clicks is taken as it says.
    let stored = trace(&align(&mut rng, &offs, None)) / as_usual;
    assert!((0.7..1.5).contains(&stored), "{stored}");
}

#[test]
fn a_wrong_label_moves_no_other() {
    let mut rng = rng("a_wrong_label_moves_no_other");
    let mut offs = errors(&mut rng, 0.3);
    offs[4] = Vec3::new(40.0, 0.0, 0.0);
    let found = align(&mut rng, &offs, USUAL);
    for (i, (off, _)) in found.iter().enumerate() {
        let expected = if i == 4 { offs[4] } else { Vec3::zeros() };
        assert!((off - expected).norm() < 1.5, "{i}: {off}");
    }
}

#[test]
fn a_label_without_neighbours_stays_as_it_is() {
    assert_eq!(adjust_labels(&[], &[]), []);
    let nothing = Features {
        image_size: SIZE,
        ..Features::default()
    };
    let camera = PtzCamera::new(base(), looks(3));
    let label = Label {
        covariance: Mat3::from_diagonal(&Vec3::new(1e-6, 1e-6, 100.0)),
        misfit: None,
    };
    let found = adjust_labels(
        &[Reference {
            features: &nothing,
            camera,
        }; 2],
        &[label; 2],
    );
    assert_eq!(found.len(), 2);
    for (ptz, covariance) in found {
        assert_eq!(ptz, looks(3));
        assert!(
            (covariance - label.covariance).norm() < 1e-9 * label.covariance.norm(),
            "{covariance}"
        );
    }
}

#[test]
fn labels_that_say_nothing_stay_as_they_are() {
    let nothing = Features {
        image_size: SIZE,
        ..Features::default()
    };
    let references = [0, 1].map(|i| Reference {
        features: &nothing,
        camera: PtzCamera::new(base(), looks(i)),
    });
    for covariance in [
        Mat3::zeros(),
        Mat3::repeat(f64::NAN),
        Mat3::repeat(f64::INFINITY),
    ] {
        let found = adjust_labels(
            &references,
            &[Label {
                covariance,
                misfit: USUAL,
            }; 2],
        );
        assert_eq!(
            [found[0].0, found[1].0],
            [looks(0), looks(1)],
            "{covariance}"
        );
        assert!(
            found
                .iter()
                .all(|(_, stated)| stated.norm().total_cmp(&covariance.norm()).is_eq()),
            "{covariance}"
        );
    }
}
