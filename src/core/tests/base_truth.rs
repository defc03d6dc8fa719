//! The base from the clicks of many frames, against known truth.

use nalgebra::SMatrix;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::Mutex;
use touchline_core::camera::{CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::field::{FieldModel, builtin};
use touchline_core::geometry::{ImagePoint, Vec2, Vec3};
use touchline_core::progress::Progress;
use touchline_core::solve::Observation;
use touchline_core::solve::base::{
    AdjustOptions, AdjustedBase, BaseError, BaseEstimate, BaseModel, BaseOptions, BaseProgress,
    BesideFrames, CameraClicks, CrownModel, FrameClicks, LensModel, adjust_base, estimate_base,
    estimate_base_on_paint,
};
use touchline_core::testing::seeded::{self, normal};
use touchline_core::testing::{SIZE, turned_base};

/// The soccer field of the usual size.
pub fn field(crown_m: f64) -> FieldModel {
    builtin("soccer")
        .unwrap()
        .model(&BTreeMap::new(), crown_m)
        .unwrap()
}

/// A lens that follows the focal length.
const LENS: FocalCurve = FocalCurve {
    at_focal_px: 2000.0,
    value: -0.03,
    per_1000_px: 0.2,
    ..FocalCurve::NONE
};

fn true_base(distortion: FocalCurve) -> CameraBase {
    CameraBase {
        distortion,
        ..turned_base([2.0, -66.0, 19.0], [0.0, -0.4, 0.3], SIZE)
    }
}

/// Frames that look along the field, with at most `most` clicks each, of 1-σ `noise_px`.
fn frames(
    base: &CameraBase,
    field: &FieldModel,
    count: usize,
    most: usize,
    noise_px: f64,
    rng: &mut Pcg64Mcg,
) -> (Vec<FrameClicks>, Vec<Ptz>) {
    let (mut frames, mut truth) = (Vec::new(), Vec::new());
    while frames.len() < count {
        let share = (frames.len() as f64 + rng.random_range(0.0..1.0)) / count as f64;
        let ptz = Ptz::from_degrees(
            -32.0 + 64.0 * share,
            rng.random_range(-14.0..-11.0),
            rng.random_range(1600.0f64.ln()..3400.0f64.ln()).exp(),
        );
        let camera = PtzCamera::new(*base, ptz);
        let mut observations: Vec<Observation> = Vec::new();
        for landmark in &field.landmarks {
            let Ok(exact) = camera.image_from_world(field.landmark_in_world(landmark)) else {
                continue;
            };
            let image = exact.translate(Vec2::new(normal(rng), normal(rng)) * noise_px);
            if SIZE.contains(image) && landmark.nominal_m.z == 0.0 {
                let seen = Observation::from_landmark(field, landmark.id.as_str(), image, SIZE, 0)
                    .unwrap();
                observations.push(Observation {
                    sigma_px: noise_px.max(0.01),
                    ..seen
                });
            }
        }
        while observations.len() > most {
            observations.swap_remove(rng.random_range(0..observations.len()));
        }
        if observations.len() < 6.min(most) {
            continue;
        }
        for (click, observation) in observations.iter_mut().enumerate() {
            observation.click = click;
        }
        frames.push(FrameClicks {
            observations,
            start: None,
        });
        truth.push(ptz);
    }
    (frames, truth)
}

fn options_of(lens: LensModel, crown: CrownModel) -> BaseOptions {
    BaseOptions {
        lens: Some(lens),
        crown: Some(crown),
        ..BaseOptions::default()
    }
}

/// The base of a camera whose principal point is the middle of its pictures.
fn centred_base(
    field: &FieldModel,
    frames: &[FrameClicks],
    options: &BaseOptions,
) -> Result<BaseEstimate, BaseError> {
    estimate_base(
        &CameraClicks::with_centred_principal_point(field, frames, SIZE),
        None,
        options,
        &Progress::default(),
    )
}

/// The base of a camera without distortion on flat ground, adjusted from a start.
fn adjusted_pinhole(
    field: &FieldModel,
    frames: &[FrameClicks],
    start: &CameraBase,
    ptz: &[Option<Ptz>],
) -> AdjustedBase {
    let pinhole = BaseModel {
        lens: LensModel::Pinhole,
        crown: CrownModel::Fixed(0.0),
        principal_point: None,
    };
    let clicks = CameraClicks::with_centred_principal_point(field, frames, SIZE);
    adjust_base(&clicks, start, ptz, &pinhole, &AdjustOptions::default())
}

#[test]
fn a_frame_in_which_nothing_was_seen_holds_nothing_back() {
    let mut rng = seeded::rng("a_frame_in_which_nothing_was_seen_holds_nothing_back");
    let field = field(0.0);
    let base = true_base(FocalCurve::NONE);
    let (mut frames, truth) = frames(&base, &field, 6, 8, 0.5, &mut rng);
    let mut ptz: Vec<Option<Ptz>> = truth.into_iter().map(Some).collect();
    let start = CameraBase {
        position_m: base.position_m + Vec3::new(0.5, -1.0, 0.4),
        ..base
    };
    let without = adjusted_pinhole(&field, &frames, &start, &ptz);
    assert!(
        (without.base.position_m - base.position_m).norm() < 0.3,
        "{:?}",
        without.base.position_m
    );
    frames.insert(
        2,
        FrameClicks {
            observations: Vec::new(),
            start: None,
        },
    );
    ptz.insert(2, Some(Ptz::from_degrees(1.0, -12.0, 2000.0)));
    let with = adjusted_pinhole(&field, &frames, &start, &ptz);
    assert_eq!(with.base, without.base);
    assert_eq!((with.ptz[2], with.ptz.iter().flatten().count()), (None, 6));
}

#[test]
fn frames_of_one_click_make_no_base_more_certain() {
    let mut rng = seeded::rng("frames_of_one_click_make_no_base_more_certain");
    let field = field(0.0);
    let base = true_base(FocalCurve::NONE);
    let (mut frames, truth) = frames(&base, &field, 11, 8, 0.5, &mut rng);
    let ptz: Vec<Option<Ptz>> = truth.into_iter().map(Some).collect();
    let without = adjusted_pinhole(&field, &frames[..6], &base, &ptz[..6]).position_covariance;
    for frame in &mut frames[6..] {
        frame.observations.truncate(1);
    }
    let with = adjusted_pinhole(&field, &frames, &base, &ptz).position_covariance;
    let off = (with - without).amax() / without.amax();
    assert!(off < 0.1, "{with} {without}");
}

#[test]
fn the_model_is_chosen_alike_if_only_every_fifth_frame_has_paint() {
    let mut rng = seeded::rng("the_model_is_chosen_alike_if_only_every_fifth_frame_has_paint");
    let field = field(0.0);
    let base = true_base(LENS);
    let (seen, truth) = frames(&base, &field, 15, 12, 0.5, &mut rng);
    let estimated = |frames: &[FrameClicks], ptz: &[Option<Ptz>]| {
        estimate_base_on_paint(
            &CameraClicks::with_centred_principal_point(&field, frames, SIZE),
            frames,
            (&base, ptz),
            &BaseOptions::default(),
            &Progress::default(),
        )
        .unwrap()
    };
    let alone: Vec<Option<Ptz>> = truth.iter().copied().map(Some).collect();
    let without = estimated(&seen, &alone);
    let follows = [LensModel::K1Focal, LensModel::K1FocalK2];
    assert!(follows.contains(&without.model.lens), "{:?}", without.model);

    let unseen = FrameClicks {
        observations: Vec::new(),
        start: None,
    };
    let of_five = |frame| {
        [
            frame,
            unseen.clone(),
            unseen.clone(),
            unseen.clone(),
            unseen.clone(),
        ]
    };
    let frames: Vec<FrameClicks> = seen.into_iter().flat_map(of_five).collect();
    let ptz: Vec<Option<Ptz>> = truth.iter().flat_map(|ptz| [Some(*ptz); 5]).collect();
    let with = estimated(&frames, &ptz);
    assert_eq!((with.base, with.scores), (without.base, without.scores));
}

#[test]
fn exact_clicks_give_the_exact_base() {
    let mut rng = seeded::rng("exact_clicks_give_the_exact_base");
    let field = field(0.0);
    let base = true_base(FocalCurve::NONE);
    let (frames, truth) = frames(&base, &field, 8, 12, 0.0, &mut rng);
    let options = options_of(LensModel::Pinhole, CrownModel::Fixed(0.0));
    let found = centred_base(&field, &frames, &options).unwrap();
    assert!(
        (found.base.position_m - base.position_m).norm() < 1e-4,
        "{:?}",
        found.base.position_m
    );
    let turned = found.base.rotation_from(&base);
    assert!(turned.norm() < 1e-5, "{turned:?} {:?}", found.base);
    for (fit, truth) in found.frames.iter().zip(truth) {
        let ptz = fit.unwrap().ptz;
        assert!(
            (ptz.pan - truth.pan).abs().degrees() < 1e-4
                && (ptz.focal_px - truth.focal_px).abs() < 1e-2
        );
    }
    assert!(found.disputed.is_empty() && found.mirrored.is_empty());
}

/// (truth − estimate) / stated sigma of the position's three coordinates.
fn z_scores(found: &CameraBase, truth: &CameraBase) -> Vec3 {
    (found.position_m - truth.position_m).component_div(&found.sigma.position_m)
}

#[test]
fn the_position_is_as_good_as_its_sigma_says() {
    let mut rng = seeded::rng("the_position_is_as_good_as_its_sigma_says");
    let field = field(0.12);
    let base = true_base(LENS);
    let options = options_of(LensModel::K1Focal, CrownModel::Free);
    for count in [5, 10, 30] {
        let (mut squares, trials) = (0.0, 6);
        for _ in 0..trials {
            let (frames, _) = frames(&base, &field, count, 10, 2.0, &mut rng);
            let found = centred_base(&field, &frames, &options).unwrap();
            let z = z_scores(&found.base, &base);
            assert!(z.amax() < 4.0, "{count} frames: {z:?}");
            squares += z.norm_squared() / f64::from(trials) / 3.0;
        }
        // Landmarks of real grounds lie off their places and these do not: a little is stated on
        // top.
        assert!(
            (0.05..1.5).contains(&squares),
            "{count} frames: mean z² {squares:.2}"
        );
    }
}

/// The least sigma of the position that clicks of known noise allow (Cramér and Rao), m: pinhole,
/// flat ground, every frame's own parameters eliminated.
fn bound_m(base: &CameraBase, field: &FieldModel, frames: &[FrameClicks], truth: &[Ptz]) -> Vec3 {
    let mut information = SMatrix::<f64, 5, 5>::zeros();
    for (frame, ptz) in frames.iter().zip(truth) {
        let camera = PtzCamera::new(*base, *ptz);
        let (mut shared, mut own) = (SMatrix::<f64, 5, 5>::zeros(), SMatrix::<f64, 3, 3>::zeros());
        let mut cross = SMatrix::<f64, 5, 3>::zeros();
        for click in &frame.observations {
            let Some(at) = click.shape.point() else {
                continue;
            };
            assert_eq!(at.z, 0.0, "{}", field.template);
            let here = camera.image_from_world_jacobian(at).unwrap();
            let (by_base, weight) = (here.by_base.fixed_columns::<5>(0), click.sigma_px.powi(-2));
            shared += by_base.transpose() * by_base * weight;
            cross += by_base.transpose() * here.by_ptz * weight;
            own += here.by_ptz.transpose() * here.by_ptz * weight;
        }
        information += shared - cross * own.try_inverse().unwrap() * cross.transpose();
    }
    information
        .try_inverse()
        .unwrap()
        .diagonal()
        .fixed_rows::<3>(0)
        .map(f64::sqrt)
}

#[test]
fn the_position_is_within_three_sigmas_of_the_bound_with_and_without_gross_errors() {
    let mut rng = seeded::rng(
        "the_position_is_within_three_sigmas_of_the_bound_with_and_without_gross_errors",
    );
    let field = field(0.0);
    let base = true_base(FocalCurve::NONE);
    let options = options_of(LensModel::Pinhole, CrownModel::Fixed(0.0));
    for (count, spoiled) in [(5, false), (10, false), (30, false), (10, true), (30, true)] {
        let (mut squares, trials) = (0.0, 4);
        for _ in 0..trials {
            let (mut clicked, truth) = frames(&base, &field, count, 12, 2.0, &mut rng);
            let good = if spoiled {
                spoil(&mut clicked, &mut rng).1
            } else {
                clicked.clone()
            };
            let found = centred_base(&field, &clicked, &options).unwrap();
            let z = (found.base.position_m - base.position_m)
                .component_div(&bound_m(&base, &field, &good, &truth));
            assert!(z.amax() < 3.0, "{count} frames, spoiled {spoiled}: {z:?}");
            squares += z.norm_squared() / f64::from(trials) / 3.0;
        }
        println!(
            "{count} frames, gross errors {spoiled}: error / bound {:.2} (rms)",
            squares.sqrt()
        );
    }
}

/// Moves a tenth of the clicks far away; which ones, and the frames without them.
fn spoil(
    frames: &mut [FrameClicks],
    rng: &mut Pcg64Mcg,
) -> (Vec<(usize, usize)>, Vec<FrameClicks>) {
    let (mut wrong, mut good) = (Vec::new(), frames.to_vec());
    for (index, frame) in frames.iter_mut().enumerate() {
        for (click, observation) in frame.observations.iter_mut().enumerate() {
            if rng.random_bool(0.1) {
                let far = Vec2::new(
                    rng.random_range(60.0..300.0),
                    rng.random_range(-200.0..200.0),
                );
                let moved = observation.image.translate(far);
                observation.image =
                    ImagePoint::new(moved.x.clamp(0.0, 1920.0), moved.y.clamp(0.0, 1080.0));
                wrong.push((index, click));
            }
        }
        good[index]
            .observations
            .retain(|click| !wrong.contains(&(index, click.click)));
    }
    (wrong, good)
}

#[test]
fn gross_errors_in_a_tenth_of_the_clicks_survive_and_are_named() {
    let mut rng = seeded::rng("gross_errors_in_a_tenth_of_the_clicks_survive_and_are_named");
    let field = field(0.1);
    let base = true_base(FocalCurve {
        at_focal_px: 2000.0,
        value: -0.04,
        per_1000_px: 0.2,
        ..FocalCurve::NONE
    });
    let (mut frames, _) = frames(&base, &field, 20, 12, 2.0, &mut rng);
    let (wrong, _) = spoil(&mut frames, &mut rng);
    let found = centred_base(&field, &frames, &BaseOptions::default()).unwrap();
    assert!(
        z_scores(&found.base, &base).amax() < 4.0,
        "{:?}",
        found.base
    );
    let named: Vec<(usize, usize)> = found
        .disputed
        .iter()
        .map(|click| (click.frame, click.click))
        .collect();
    let missed = wrong.iter().filter(|click| !named.contains(click)).count();
    let false_alarms = named.iter().filter(|click| !wrong.contains(click)).count();
    assert!(
        missed <= wrong.len() / 20 && false_alarms <= 1,
        "{missed} missed, {false_alarms} false of {wrong:?}"
    );
}

#[test]
fn what_cannot_be_estimated_says_why() {
    let mut rng = seeded::rng("what_cannot_be_estimated_says_why");
    let field = field(0.0);
    let base = true_base(FocalCurve::NONE);
    let estimate =
        |frames: &[FrameClicks]| centred_base(&field, frames, &BaseOptions::default()).unwrap_err();
    assert!(matches!(
        estimate(&[]),
        BaseError::NoStart {
            frames: 0,
            most_landmarks: 0
        }
    ));
    let (three, _) = frames(&base, &field, 4, 3, 1.0, &mut rng);
    let error = estimate(&three);
    assert!(
        matches!(
            error,
            BaseError::NoStart {
                frames: 4,
                most_landmarks: 3
            }
        ),
        "{error}"
    );
    assert!(
        error
            .to_string()
            .contains("click four or more that are not on one line")
    );
    // Names dealt out at random.
    let (mut nonsense, _) = frames(&base, &field, 5, 8, 1.0, &mut rng);
    for frame in &mut nonsense {
        for observation in &mut frame.observations {
            observation.image =
                ImagePoint::new(rng.random_range(0.0..1920.0), rng.random_range(0.0..1080.0));
        }
    }
    let error = estimate(&nonsense);
    assert!(
        matches!(
            error,
            BaseError::NoFit { .. } | BaseError::NoStart { .. } | BaseError::Undetermined { .. }
        ),
        "{error}"
    );
}

#[test]
fn landmarks_on_one_line_and_a_single_view_are_reported() {
    let mut rng = seeded::rng("landmarks_on_one_line_and_one_view_alone_are_told");
    let field = field(0.0);
    let base = true_base(FocalCurve::NONE);
    let (many, _) = frames(&base, &field, 8, 40, 1.0, &mut rng);
    let on_halfway_line = |click: &Observation| click.shape.point().is_some_and(|at| at.x == 0.0);
    let mut one_line = many.clone();
    for frame in &mut one_line {
        frame.observations.retain(on_halfway_line);
    }
    assert!(
        one_line.iter().any(|frame| frame.observations.len() > 3),
        "four of them are on it"
    );
    let error = centred_base(&field, &one_line, &BaseOptions::default()).unwrap_err();
    assert!(matches!(error, BaseError::NoStart { .. }), "{error}");
    assert!(
        error.to_string().contains("that are not on one line"),
        "{error}"
    );

    let options = options_of(LensModel::Pinhole, CrownModel::Fixed(0.0));
    let estimate = |frames: &[FrameClicks]| centred_base(&field, frames, &options).unwrap();
    assert_eq!(estimate(&many).one_view(), None);
    let same = vec![many[3].clone(); 5];
    let reported = estimate(&same).one_view().unwrap();
    assert!(
        reported.starts_with("all 5 frames look the same way (pan within 0.0°)"),
        "{reported}"
    );
}

#[test]
fn few_frames_on_one_side_ask_for_one_on_the_other() {
    let mut rng = seeded::rng("few_frames_on_one_side_ask_for_one_on_the_other");
    let field = field(0.0);
    // From left to right.
    let (many, _) = frames(&true_base(FocalCurve::NONE), &field, 8, 4, 2.0, &mut rng);
    let options = options_of(LensModel::Pinhole, CrownModel::Fixed(0.0));
    let estimate = |frames: &[FrameClicks]| centred_base(&field, frames, &options).unwrap();
    for (few, side) in [
        (&many[4..7], BesideFrames::Left),
        (&many[1..4], BesideFrames::Right),
    ] {
        let advised = estimate(few).one_more_frame.unwrap();
        assert_eq!(advised.side, side, "{advised}");
        assert!(
            advised.then_m <= 0.8 * advised.now_m && advised.then_m > 0.0,
            "{advised}"
        );
    }
    assert_eq!(
        estimate(&many).one_more_frame,
        None,
        "eight frames are enough"
    );
}

#[test]
fn an_estimation_counts_its_adjustments_and_ends_when_it_is_cancelled() {
    let mut rng = seeded::rng("an_estimation_counts_its_adjustments");
    let (frames, _) = frames(
        &true_base(FocalCurve::NONE),
        &field(0.0),
        8,
        8,
        1.0,
        &mut rng,
    );
    let estimate = |patience: usize| {
        let reported: Mutex<Vec<BaseProgress>> = Mutex::new(Vec::new());
        let progress = Progress::new(|progress: BaseProgress| {
            reported.lock().unwrap().push(progress);
            if progress.done < patience {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        });
        let options = BaseOptions::default();
        let found = estimate_base(
            &CameraClicks::with_centred_principal_point(&field(0.0), &frames, SIZE),
            None,
            &options,
            &progress,
        );
        drop(progress);
        (found, reported.into_inner().unwrap())
    };
    let (found, reported) = estimate(usize::MAX);
    assert!(found.is_ok());
    let mut counted: Vec<usize> = reported.iter().map(|progress| progress.done).collect();
    counted.sort_unstable();
    assert_eq!(
        counted,
        (1..=reported[0].total).collect::<Vec<_>>(),
        "each adjustment is reported, up to the last"
    );
    let (stopped, reported) = estimate(3);
    assert_eq!(stopped, Err(BaseError::Stopped));
    assert!(reported.len() < reported[0].total);
}
