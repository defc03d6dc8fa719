//! The base of a few frames of a camera anywhere around a field, against known truth.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use touchline_core::camera::{CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::field::{FieldModel, builtin};
use touchline_core::geometry::{Angle, ImagePoint, ImageSize, Vec2, Vec3};
use touchline_core::progress::Progress;
use touchline_core::solve::Observation;
use touchline_core::solve::base::{
    BaseEstimate, BaseOptions, BasePriors, CameraClicks, FrameClicks, PixelAspect, estimate_base,
    estimate_base_on_paint,
};
use touchline_core::testing::seeded::{self, normal};
use touchline_core::testing::{SIZE, soccer};

/// A kind of place: the template, and the camera's position, `world`, m.
struct Place {
    name: &'static str,
    template: &'static str,
    position_m: [f64; 3],
}

const PLACES: [Place; 6] = [
    Place {
        name: "main stand",
        template: "soccer",
        position_m: [2.0, -66.0, 19.0],
    },
    Place {
        name: "opposite stand",
        template: "soccer",
        position_m: [-5.0, 70.0, 17.0],
    },
    Place {
        name: "behind a goal",
        template: "soccer",
        position_m: [-85.0, 3.0, 14.0],
    },
    Place {
        name: "at a corner",
        template: "soccer",
        position_m: [68.0, -52.0, 16.0],
    },
    Place {
        name: "behind a baseline",
        template: "tennis",
        position_m: [-26.0, 0.5, 9.0],
    },
    Place {
        name: "beside a court",
        template: "basketball_fiba",
        position_m: [1.0, 24.0, 8.0],
    },
];

/// A base at a place with what the priors expect of cameras: up to 3° of lean along the direction
/// to the field, less than half of it across, a usual lens, an axis off the picture's middle.
fn usual_base(position_m: Vec3, rng: &mut Pcg64Mcg) -> CameraBase {
    let priors = BasePriors::default();
    let view = (-position_m.xy()).normalize();
    let along = priors.pitch.radians() * normal(rng).clamp(-3.0, 3.0);
    let across = priors.roll.radians() * normal(rng);
    let lean = view * along + Vec2::new(view.y, -view.x) * across;
    let up = Vec3::new(lean.x, lean.y, 1.0).normalize();
    let off_px = Vec2::new(normal(rng), normal(rng)) * priors.principal_point_px;
    let centre = SIZE.centre().translate(off_px);
    let base = CameraBase::new(position_m, CameraBase::rotation_about(&up), centre);
    let usual = priors.usual_lens(SIZE);
    CameraBase {
        distortion: FocalCurve {
            value: usual.value + priors.k1.1 * normal(rng),
            per_1000_px: usual.per_1000_px + priors.k1_slope.1 * normal(rng),
            ..usual
        },
        ..base.in_pan_gauge().0
    }
}

/// A view of some point of the field.
fn view(field: &FieldModel, base: &CameraBase, rng: &mut Pcg64Mcg) -> Ptz {
    let target = Vec3::new(
        rng.random_range(-0.4..0.4) * field.length_m,
        rng.random_range(-0.3..0.3) * field.width_m,
        0.0,
    );
    let to = target - base.position_m;
    Ptz {
        pan: Angle::from_radians(to.x.atan2(to.y)),
        tilt: Angle::from_radians((to.z / to.xy().norm()).atan()),
        focal_px: rng.random_range(1500.0..2600.0),
    }
}

/// A frame of a camera that looks at some point of the field, its clicks missed by their sigmas;
/// none where it shows too little.
fn frame(field: &FieldModel, base: &CameraBase, rng: &mut Pcg64Mcg) -> Option<FrameClicks> {
    let ptz = view(field, base, rng);
    let camera = PtzCamera::new(*base, ptz);
    let mut observations: Vec<Observation> = Vec::new();
    for landmark in &field.landmarks {
        let at = field.landmark_in_world(landmark);
        let Ok(exact) = camera.image_from_world(at) else {
            continue;
        };
        let click = observations.len();
        let seen =
            Observation::from_landmark(field, landmark.id.as_str(), exact, SIZE, click).unwrap();
        let image = exact.translate(Vec2::new(normal(rng), normal(rng)) * seen.sigma_px);
        if SIZE.contains(image) && landmark.nominal_m.z == 0.0 {
            observations.push(Observation { image, ..seen });
        }
    }
    (observations.len() >= 5).then_some(FrameClicks {
        observations,
        start: None,
    })
}

/// The root of the mean squared error of a place's rotation, sigmas, over some documents of 3 to 11
/// frames.
fn rotation_z(place: &Place, documents: usize) -> f64 {
    let mut rng = seeded::rng(place.name);
    let field = builtin(place.template).unwrap().default_model().unwrap();
    let mut squares = Vec::new();
    while squares.len() < documents {
        let base = usual_base(Vec3::from(place.position_m), &mut rng);
        let count = rng.random_range(3..=11);
        let frames: Vec<FrameClicks> = std::iter::repeat_with(|| frame(&field, &base, &mut rng))
            .take(40 * count)
            .flatten()
            .take(count)
            .collect();
        let clicks = CameraClicks::with_centred_principal_point(&field, &frames, SIZE);
        let found =
            estimate_base(&clicks, None, &BaseOptions::default(), &Progress::default()).unwrap();
        assert_eq!(found.pixel_aspect, None, "{}", place.name);
        let error = found.base.rotation_from(&base).xy();
        let covariance = found.base.sigma.covariance();
        let of_rotation = covariance.fixed_view::<2, 2>(3, 3).into_owned();
        squares.push(0.5 * error.dot(&(of_rotation.try_inverse().unwrap() * error)));
    }
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Each place alone, and all together: the mean of 16 squares scatters by a third.
#[test]
fn a_few_frames_state_the_lean_of_a_camera_at_any_place() {
    let zs = PLACES.map(|place| (place.name, rotation_z(&place, 8)));
    let all = (zs.iter().map(|(_, z)| z * z).sum::<f64>() / 6.0).sqrt();
    assert!(zs.iter().all(|(_, z)| (0.4..1.5).contains(z)), "{zs:?}");
    assert!((0.7..1.3).contains(&all), "{all:.2} of {zs:?}");
}

/// The estimate of some frames of a main stand whose pictures were scaled down the picture, with the
/// aspect of their pixels as it is stated.
fn estimate_of_scaled(
    count: usize,
    (down, stated): (f64, f64),
    rng: &mut Pcg64Mcg,
) -> (BaseEstimate, f64) {
    let field = soccer();
    let base = usual_base(Vec3::from(PLACES[0].position_m), rng);
    let mut frames: Vec<FrameClicks> = std::iter::repeat_with(|| frame(&field, &base, rng))
        .take(40 * count)
        .flatten()
        .take(count)
        .collect();
    let scaled = |at: ImagePoint| ImagePoint::new(at.x, at.y * down);
    for click in frames.iter_mut().flat_map(|frame| &mut frame.observations) {
        click.image = scaled(click.image);
    }
    let clicks = CameraClicks {
        image_size: ImageSize::new(SIZE.width, (f64::from(SIZE.height) * down) as u32),
        principal_point: scaled(SIZE.centre()),
        pixel_aspect: stated,
        ..CameraClicks::with_centred_principal_point(&field, &frames, SIZE)
    };
    let found = estimate_base(&clicks, None, &BaseOptions::default(), &Progress::default());
    (found.unwrap(), base.position_m.z)
}

#[test]
fn scaled_pictures_are_told_and_their_base_is_not_sure() {
    let mut rng = seeded::rng("scaled_pictures_are_told_and_their_base_is_not_sure");
    for count in [6, 12, 24] {
        for down in [16.0 / 9.0, 4.0 / 3.0, 0.7556] {
            let (found, height_m) = estimate_of_scaled(count, (down, 1.0), &mut rng);
            let aspect = found.pixel_aspect.unwrap();
            let off_sigmas = (aspect.value - down).abs() / aspect.sigma;
            assert!(off_sigmas < 3.0, "{count} frames, {down:.2}: {aspect:?}");
            // The height is off by the scaling, and says so.
            let off_m = (found.base.position_m.z - height_m).abs();
            let sigma_m = found.base.sigma.position_m.z;
            assert!(
                off_m > 3.0 && off_m < 2.0 * sigma_m,
                "{off_m} ± {sigma_m} m"
            );
        }
    }
}

#[test]
fn a_stated_aspect_of_the_pixels_gives_the_true_height_and_a_wrong_one_is_told() {
    let mut rng = seeded::rng("a_stated_aspect_of_the_pixels_gives_the_true_height");
    for down in [16.0 / 9.0, 0.7556] {
        let (found, height_m) = estimate_of_scaled(12, (down, down), &mut rng);
        assert_eq!(found.pixel_aspect, None, "{down:.2}");
        assert_eq!(found.base.distortion.pixel_aspect, down);
        let (off_m, sigma_m) = (
            (found.base.position_m.z - height_m).abs(),
            found.base.sigma.position_m.z,
        );
        assert!(
            off_m < 3.0 * sigma_m && sigma_m < 1.0,
            "{off_m} ± {sigma_m} m"
        );
        let (found, _) = estimate_of_scaled(12, (1.0, 1.0 / down), &mut rng);
        let aspect = found.pixel_aspect.unwrap();
        assert_eq!(aspect.stated, 1.0 / down);
        assert!(
            (aspect.value - 1.0).abs() < 3.0 * aspect.sigma,
            "{aspect:?}"
        );
        assert!(
            aspect.to_string().contains("Correct pixel_aspect"),
            "{aspect}"
        );
    }
}

/// The paint of a frame: places on the lines, found to half a pixel.
fn painted(field: &FieldModel, base: &CameraBase, ptz: Ptz, rng: &mut Pcg64Mcg) -> FrameClicks {
    const PLACES_OF_LINE: u32 = 12;
    let camera = PtzCamera::new(*base, ptz);
    let mut observations = Vec::new();
    for (index, line) in field.lines.iter().enumerate() {
        let places = (0..PLACES_OF_LINE).filter_map(|place| {
            let share = f64::from(place) / f64::from(PLACES_OF_LINE - 1);
            let exact = camera.image_from_world(line.paint_centre.point_at(share));
            let image = (exact.ok()?).translate(Vec2::new(normal(rng), normal(rng)) * 0.5);
            let seen = Observation::from_paint(field, index, image, 0.5, place as usize)?;
            SIZE.contains(image).then_some(seen)
        });
        observations.extend(places);
    }
    FrameClicks {
        observations,
        start: None,
    }
}

/// What the paint alone says of the pixels where the picture was cut to a width about its middle and
/// then scaled down the picture.
fn aspect_by_paint(width: u32, down: f64, rng: &mut Pcg64Mcg) -> Option<PixelAspect> {
    let field = soccer();
    let base = CameraBase::new(
        Vec3::new(2.0, -66.0, 19.0),
        CameraBase::rotation_about(&Vec3::z()),
        SIZE.centre(),
    );
    let views: Vec<Ptz> = std::iter::repeat_with(|| view(&field, &base, rng))
        .take(12)
        .collect();
    let cut_px = 0.5 * f64::from(SIZE.width - width);
    let scaled = |at: ImagePoint| ImagePoint::new(at.x - cut_px, at.y * down);
    let frames: Vec<FrameClicks> = views
        .iter()
        .map(|ptz| {
            let mut frame = painted(&field, &base, *ptz, rng);
            for place in &mut frame.observations {
                place.image = scaled(place.image);
            }
            frame
        })
        .collect();
    // From the camera of the picture as it was, standing higher by the scaling.
    let mut start = base;
    start.position_m.z *= down;
    start.principal_point = scaled(SIZE.centre());
    let ptz: Vec<Option<Ptz>> = views
        .iter()
        .map(|view| {
            Some(Ptz {
                tilt: view.tilt * down,
                ..*view
            })
        })
        .collect();
    let nothing = vec![FrameClicks::default(); frames.len()];
    let clicks = CameraClicks {
        image_size: ImageSize::new(width, (f64::from(SIZE.height) * down) as u32),
        principal_point: start.principal_point,
        ..CameraClicks::with_centred_principal_point(&field, &nothing, SIZE)
    };
    let found = estimate_base_on_paint(
        &clicks,
        &frames,
        (&start, &ptz),
        &BaseOptions::default(),
        &Progress::default(),
    );
    found.unwrap().pixel_aspect
}

#[test]
fn paint_alone_tells_pictures_of_a_usual_proportion_that_were_scaled_to_another() {
    let mut rng = seeded::rng("paint_alone_tells_pictures");
    for down in [16.0 / 9.0, 4.0 / 3.0, 0.7556] {
        let aspect = aspect_by_paint(SIZE.width, down, &mut rng).unwrap();
        assert!(
            (aspect.value / down).ln().abs() < 0.1,
            "{down:.2}: {aspect:?}"
        );
    }
    // Square pixels: the picture as it was, and one that was cut to 4:3.
    assert_eq!(aspect_by_paint(SIZE.width, 1.0, &mut rng), None);
    assert_eq!(aspect_by_paint(1440, 1.0, &mut rng), None);
}
