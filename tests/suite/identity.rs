//! Mistakes in names: found, and not invented.

use crate::seeded::{self, normal};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use std::collections::BTreeMap;
use touchline::camera::{BaseAngles, BaseSigma, CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline::field::{FieldModel, builtin};
use touchline::geometry::{ImageSize, Vec2, Vec3};
use touchline::solve::{
    IdentityFinding, IdentityKind, Name, Observation, SolveContext, Target, check_identity, solve_frame,
};

const SIZE: ImageSize = ImageSize::new(1920, 1080);

fn field() -> FieldModel {
    builtin("soccer").unwrap().model(&BTreeMap::new(), 0.15).unwrap()
}

fn nominal_base() -> CameraBase {
    CameraBase {
        distortion: FocalCurve { at_focal_px: 2000.0, value: -0.03, per_1000_px: 0.2 },
        sigma: BaseSigma { position_m: Vec3::new(0.05, 0.15, 0.05), rotation: Vec3::zeros() },
        ..CameraBase::new(Vec3::new(2.0, -64.0, 18.0), BaseAngles::default().base_from_world(), SIZE.centre())
    }
}

/// A frame of `count` clicks with realistic noise, seen from a base that is slightly off, and the names of its landmarks.
fn labels(field: &FieldModel, count: usize, rng: &mut Pcg64Mcg) -> (Vec<Observation>, Vec<usize>) {
    loop {
        let nominal = nominal_base();
        let off = Vec3::from_fn(|_, _| normal(rng)).component_mul(&nominal.sigma.position_m);
        let base = CameraBase { position_m: nominal.position_m + off, ..nominal };
        let ptz = Ptz::from_degrees(
            rng.random_range(-33.0..33.0),
            rng.random_range(-15.0..-10.0),
            rng.random_range(1600.0f64.ln()..3500.0f64.ln()).exp(),
        );
        let camera = PtzCamera::new(base, ptz);
        let mut seen: Vec<(Observation, usize)> = Vec::new();
        for (index, landmark) in field.landmarks.iter().enumerate().filter(|(_, landmark)| landmark.nominal_m.z == 0.0)
        {
            let Ok(exact) = camera.image_from_world(field.landmark_in_world(landmark)) else { continue };
            let observation = Observation::of_landmark(field, landmark.id.as_str(), exact, SIZE, 0).unwrap();
            let image = exact.moved(Vec2::new(normal(rng), normal(rng)) * observation.sigma_px);
            if SIZE.contains(image) {
                seen.push((Observation { image, ..observation }, index));
            }
        }
        while seen.len() > count {
            seen.swap_remove(rng.random_range(0..seen.len()));
        }
        let widest = seen.iter().map(|(click, _)| click.image.distance_px(seen[0].0.image)).fold(0.0, f64::max);
        if seen.len() == count && widest > 400.0 {
            for (click, (observation, _)) in seen.iter_mut().enumerate() {
                observation.click = click;
            }
            return seen.into_iter().unzip();
        }
    }
}

fn identify(field: &FieldModel, clicks: &[Observation]) -> Option<IdentityFinding> {
    let context = SolveContext::new(SIZE);
    let solution = solve_frame(&nominal_base(), clicks, &context).ok()?;
    check_identity(&nominal_base(), field, clicks, &solution, &context)
}

fn renamed(click: &Observation, field: &FieldModel, landmark: usize) -> Observation {
    Observation { target: Target::Landmark(field.landmark_in_world(&field.landmarks[landmark])), ..*click }
}

/// Whether a finding gives every click its true name.
fn mends(finding: &IdentityFinding, field: &FieldModel, named: &[usize], truth: &[usize]) -> bool {
    let mut mended = named.to_vec();
    for rename in &finding.renames {
        let Name::Landmark(id) = &rename.name else { return false };
        mended[rename.click] = field.landmarks.iter().position(|landmark| landmark.id == *id).unwrap();
    }
    mended == truth
}

#[test]
fn right_names_raise_no_alarm() {
    let mut rng = seeded::rng("right_names_raise_no_alarm");
    let field = field();
    let (mut alarms, trials) = (0, 1500);
    for trial in 0..trials {
        let (clicks, _) = labels(&field, 4 + trial % 9, &mut rng);
        alarms += usize::from(identify(&field, &clicks).is_some());
    }
    assert!(alarms <= trials / 100, "{alarms} false alarms of {trials}");
}

#[test]
fn one_swap_or_one_wrong_landmark_is_found_and_mended() {
    let mut rng = seeded::rng("one_swap_or_one_wrong_landmark_is_found_and_mended");
    let field = field();
    for swap in [true, false] {
        let (mut found, mut mended, trials) = (0, 0, 600);
        for trial in 0..trials {
            let (mut clicks, truth) = labels(&field, 4 + trial % 9, &mut rng);
            let mut named = truth.clone();
            let i = rng.random_range(0..clicks.len());
            if swap {
                let j = (i + rng.random_range(1..clicks.len())) % clicks.len();
                named.swap(i, j);
            } else {
                named[i] = loop {
                    let other = rng.random_range(0..field.landmarks.len());
                    if !named.contains(&other) && field.landmarks[other].nominal_m.z == 0.0 {
                        break other;
                    }
                };
            }
            for (click, landmark) in clicks.iter_mut().zip(&named) {
                *click = renamed(click, &field, *landmark);
            }
            let finding = identify(&field, &clicks);
            found += usize::from(finding.is_some());
            let right = finding.as_ref().is_some_and(|finding| mends(finding, &field, &named, &truth));
            mended += usize::from(right);
            if right && swap {
                assert_eq!(finding.unwrap().kind, IdentityKind::Swapped);
            }
        }
        println!("swap {swap}: {found} found, {mended} mended of {trials}");
        assert!(
            100 * found >= 95 * trials && 100 * mended >= 93 * trials,
            "swap {swap}: {found}, {mended} of {trials}"
        );
    }
}

/// With two clicks and a base the one surplus equation is all there is; what it sees is measured here.
#[test]
fn two_clicks_say_what_they_can() {
    let mut rng = seeded::rng("two_clicks_say_what_they_can");
    let field = field();
    let (mut alarms, mut swaps_found, trials) = (0, 0, 1000);
    for _ in 0..trials {
        let (clicks, truth) = labels(&field, 2, &mut rng);
        alarms += usize::from(identify(&field, &clicks).is_some_and(|finding| finding.certain));
        let swapped = [renamed(&clicks[0], &field, truth[1]), renamed(&clicks[1], &field, truth[0])];
        swaps_found += usize::from(match solve_frame(&nominal_base(), &swapped, &SolveContext::new(SIZE)) {
            Ok(_) => identify(&field, &swapped).is_some_and(|finding| finding.kind == IdentityKind::Swapped),
            Err(_) => true,
        });
    }
    println!("two clicks: {alarms} false alarms, {swaps_found} swaps found or refused, of {trials}");
    assert!(alarms <= trials / 100, "{alarms} false alarms");
    assert!(swaps_found * 10 > trials * 8, "{swaps_found} swaps found");
}

#[test]
fn a_mirrored_frame_is_found() {
    let mut rng = seeded::rng("a_mirrored_frame_is_found");
    let field = field();
    for symmetry in touchline::field::Symmetry::ALL {
        let (clicks, truth) = labels(&field, 9, &mut rng);
        let twin = |index: usize| symmetry.landmark_twin(&field, &field.landmarks[index]).unwrap();
        let wrong: Vec<Observation> = clicks
            .iter()
            .zip(&truth)
            .map(|(click, index)| Observation {
                target: Target::Landmark(field.landmark_in_world(twin(*index))),
                ..*click
            })
            .collect();
        let finding = identify(&field, &wrong).unwrap();
        assert_eq!(finding.kind, IdentityKind::Mirrored(symmetry));
        assert!(finding.certain && finding.renamed_px < 6.0 && finding.warning().message.contains("Check "));
    }
}

#[test]
fn a_click_on_the_neighbouring_line_is_found() {
    let field = field();
    let camera = PtzCamera::new(nominal_base(), Ptz::from_degrees(28.0, -12.0, 2200.0));
    let mut clicks = Vec::new();
    for name in ["penalty_mark_right", "penalty_arc_far_right", "corner_far_right", "penalty_area_near_right_front"] {
        let at = field.landmark_in_world(field.landmark(name).unwrap());
        let image = camera.image_from_world(at).unwrap();
        clicks.push(Observation::of_landmark(&field, name, image, SIZE, clicks.len()).unwrap());
    }
    let on =
        |name: &str| camera.image_from_world(field.world_from_nominal(field.line(name).unwrap().curve.point_at(0.4)));
    let image = on("goal_area_right_far").unwrap();
    clicks.push(Observation::of_line(&field, "penalty_area_right_far", image, SIZE, 4).unwrap());
    let finding = identify(&field, &clicks).unwrap();
    assert_eq!(finding.renames.len(), 1, "{finding:?}");
    assert_eq!((finding.renames[0].click, finding.renames[0].name.as_str()), (4, "goal_area_right_far"));
    assert!(finding.warning().message.starts_with("Point 5 fits elsewhere: "), "{}", finding.warning());
}
