//! References that contradict each other are found, and the wrong one named.

use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::testing::TestBase;
use touchline_core::testing::seeded::rng;
use touchline_vision::features::Features;
use touchline_vision::relocalize::{
    Contradiction, ContradictionOptions, Reference, contradictions, suspects,
};
use touchline_vision::testing::{SIZE, base, picture, scene};

/// Six references from left to right, labelled as they look, but for what `mislabel` does.
fn contradictions_of(name: &str, mislabel: impl Fn(usize, Ptz) -> Ptz) -> Vec<Contradiction> {
    let mut rng = rng(name);
    let scene = scene(&mut rng);
    let looks = |i: usize| {
        Ptz::from_degrees(
            -15.0 + 6.0 * i as f64,
            -10.0,
            1800.0 + 200.0 * (i % 3) as f64,
        )
    };
    let pictures: Vec<Features> = (0..6)
        .map(|i| picture(&scene, looks(i), &mut rng))
        .collect();
    let references: Vec<Reference> = pictures
        .iter()
        .enumerate()
        .map(|(i, features)| Reference {
            features,
            camera: PtzCamera::new(base(), mislabel(i, looks(i))),
        })
        .collect();
    contradictions(&references, &ContradictionOptions::default())
}

#[test]
fn right_labels_agree() {
    assert_eq!(contradictions_of("right_labels_agree", |_, ptz| ptz), []);
}

#[test]
fn a_wrong_pan_is_found_with_its_size_and_named() {
    let two_degrees = |i: usize, ptz: Ptz| {
        if i == 2 {
            Ptz::from_degrees(ptz.pan.degrees() + 2.0, ptz.tilt.degrees(), ptz.focal_px)
        } else {
            ptz
        }
    };
    let found = contradictions_of("a_wrong_pan_is_found_with_its_size_and_named", two_degrees);
    assert!(
        found.len() >= 2 && found.iter().all(|pair| pair.references.contains(&2)),
        "{found:?}"
    );
    assert!(found.is_sorted_by(|a, b| a.disagreement_px >= b.disagreement_px));
    for pair in &found {
        // 2° are some 70 px at 2000 px of focal length, half as much again at 1920 px width, and
        // more in the corners.
        assert!(
            (80.0..160.0).contains(&pair.disagreement_px) && pair.shared > 30,
            "{pair:?}"
        );
    }
    assert_eq!(suspects(&found), [2]);
}

#[test]
fn a_label_that_looks_the_other_way_is_found_though_nothing_there_contradicts_it() {
    let other_way = |i: usize, ptz: Ptz| {
        if i == 1 {
            Ptz::from_degrees(-80.0, -10.0, ptz.focal_px)
        } else {
            ptz
        }
    };
    let found = contradictions_of("a_label_that_looks_the_other_way_is_found", other_way);
    assert!(found.len() >= 2 && suspects(&found) == [1], "{found:?}");
    assert!(found[0].disagreement_px > 2000.0, "{found:?}");
    let exchanged = |i: usize, ptz: Ptz| match i {
        0 => Ptz::from_degrees(15.0, -10.0, ptz.focal_px),
        5 => Ptz::from_degrees(-15.0, -10.0, ptz.focal_px),
        _ => ptz,
    };
    let found = contradictions_of("two_labels_are_exchanged", exchanged);
    let mut named = suspects(&found);
    named.sort_unstable();
    assert_eq!(named, [0, 5], "{found:?}");
}

#[test]
fn a_wrong_focal_length_is_found_and_nothing_is_said_without_common_views() {
    let longer = |i: usize, ptz: Ptz| Ptz {
        focal_px: ptz.focal_px * if i == 4 { 1.1 } else { 1.0 },
        ..ptz
    };
    let found = contradictions_of("a_wrong_focal_length_is_found", longer);
    assert!(!found.is_empty() && suspects(&found) == [4], "{found:?}");
    assert_eq!(contradictions(&[], &ContradictionOptions::default()), []);
    let nothing = Features {
        image_size: SIZE,
        ..Features::default()
    };
    let blank = Reference {
        features: &nothing,
        camera: base().aim(0.0, -10.0, 2000.0),
    };
    assert_eq!(
        contradictions(&[blank, blank], &ContradictionOptions::default()),
        []
    );
    assert_eq!(suspects(&[]), [] as [usize; 0]);
}
