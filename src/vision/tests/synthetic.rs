//! The drawn match is what it says: the same bytes always, and paint, people and posts exactly
//! where the camera has them.

use image::RgbImage;
use touchline_core::camera::{CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::field::{FieldLine, FieldModel, LineId, builtin};
use touchline_core::geometry::{ImagePoint, ImageSize, Vec2};
use touchline_core::testing::{TestBase, landmark_in};
#[cfg(feature = "opencv")]
use touchline_vision::features::{Descriptor, FeatureOptions, Features, extract};
#[cfg(feature = "opencv")]
use touchline_vision::media::Picture;
use touchline_vision::synthetic::{
    CameraSide, ClickOptions, ClickTarget, FrameOptions, Graphics, Moment, Preset, Scene,
    SceneError, Setting, ShootOptions, Stadium, StadiumOptions, camera_path, generate_clicks,
    stadium,
};

const SMALL: ImageSize = ImageSize::new(320, 180);
const FULL: ImageSize = ImageSize::new(1280, 720);

fn field(crown_m: f64) -> FieldModel {
    let template = builtin("soccer").unwrap();
    template.model(&template.default_params(), crown_m).unwrap()
}

fn scene(seed: u64) -> Stadium {
    stadium(&StadiumOptions::new(field(0.0), seed))
}

fn bare() -> FrameOptions {
    FrameOptions {
        players: false,
        graphics: Graphics::NONE,
        ..FrameOptions::default()
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes_at_any_number_of_threads() {
    let hard = Preset::Hard.shoot();
    let draw = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let scene = stadium(&StadiumOptions {
                daylight: hard.daylight,
                ..StadiumOptions::new(field(0.1), seed)
            });
            let base = hard.main_camera(SMALL);
            let step = camera_path(&scene, &base, SMALL, &hard, 3)[2];
            let options = hard.frame(2, &step, SMALL, seed);
            scene.render(&PtzCamera::new(base, step.ptz), SMALL, &options)
        })
    };
    let (one, four) = (draw(1, 11), draw(4, 11));
    assert_eq!(one.image, four.image);
    assert_eq!(one.mover_mask, four.mover_mask);
    assert_eq!(one.movers, four.movers);
    assert_ne!(one.image, draw(4, 12).image);
}

/// Blue, in which chalk and grass differ most, as linear light.
fn blue(picture: &RgbImage, at: ImagePoint) -> f64 {
    let decode = |x: u32, y: u32| (f64::from(picture.get_pixel(x, y).0[2]) / 255.0).powf(2.2);
    let (x, y) = (at.x - 0.5, at.y - 0.5);
    let (column, row) = (x.floor(), y.floor());
    let (u, v) = (x - column, y - row);
    let (column, row) = (column as u32, row as u32);
    let top = decode(column, row) * (1.0 - u) + decode(column + 1, row) * u;
    let bottom = decode(column, row + 1) * (1.0 - u) + decode(column + 1, row + 1) * u;
    top * (1.0 - v) + bottom * v
}

/// How far the search for paint reaches on both sides of a line, px.
const REACH_PX: f64 = 7.0;

/// The image of a place on a line and the direction across it.
fn crossing(
    camera: &PtzCamera,
    field: &FieldModel,
    line: &FieldLine,
    t: f64,
) -> Option<(ImagePoint, Vec2)> {
    let image = |t: f64| {
        camera
            .image_from_world(field.world_from_nominal(line.paint_centre.point_at(t)))
            .ok()
    };
    let step = 0.05 / line.curve.length_m();
    let along = image(t + step)?.offset_from(image(t - step)?);
    Some((image(t)?, Vec2::new(-along.y, along.x).normalize()))
}

/// Every painted line as a dense row of image points.
fn all_paint(camera: &PtzCamera, field: &FieldModel) -> Vec<(LineId, Vec<ImagePoint>)> {
    let images = |line: &FieldLine| {
        let place =
            |i: u32| field.world_from_nominal(line.paint_centre.point_at(f64::from(i) / 400.0));
        (0..=400)
            .filter_map(|i| camera.image_from_world(place(i)).ok())
            .collect()
    };
    field
        .lines
        .iter()
        .filter(|line| line.painted)
        .map(|line| (line.id.clone(), images(line)))
        .collect()
}

/// How far from where the camera has it the paint is found, px; none where the line is not seen
/// alone.
fn paint_offset(
    picture: &RgbImage,
    camera: &PtzCamera,
    field: &FieldModel,
    all_paint: &[(LineId, Vec<ImagePoint>)],
    line: &FieldLine,
    t: f64,
) -> Option<f64> {
    let (centre, _) = crossing(camera, field, line, t)?;
    let (width, height) = (f64::from(picture.width()), f64::from(picture.height()));
    let margin = REACH_PX + 12.0;
    if !((margin..width - margin).contains(&centre.x)
        && (margin..height - margin).contains(&centre.y))
    {
        return None;
    }
    // Alone: no other paint within reach.
    let others = all_paint.iter().filter(|(id, _)| *id != line.id);
    if others
        .flat_map(|(_, images)| images)
        .any(|image| image.distance_px(centre) < 3.0 * REACH_PX)
    {
        return None;
    }
    // The mean profile over a stretch of the line, so that it does not matter how the pixels'
    // raster falls on it.
    let metres_per_px = camera.base().position_m.norm() / camera.ptz().focal_px;
    let crossings: Vec<(ImagePoint, Vec2)> = (-8..=8)
        .filter_map(|i| {
            crossing(
                camera,
                field,
                line,
                t + f64::from(i) * metres_per_px / line.curve.length_m(),
            )
        })
        .collect();
    let profile: Vec<(f64, f64)> = (-28..=28)
        .map(|i| f64::from(i) * REACH_PX / 28.0)
        .map(|offset| {
            let level = |(centre, across): &(ImagePoint, Vec2)| {
                blue(picture, centre.translate(across * offset))
            };
            (
                offset,
                crossings.iter().map(level).sum::<f64>() / crossings.len() as f64,
            )
        })
        .collect();
    let ends = |range: std::ops::Range<usize>| {
        range.clone().map(|i| profile[i].1).sum::<f64>() / range.len() as f64
    };
    let (left, right) = (ends(0..6), ends(51..57));
    let rise = |(offset, level): &(f64, f64)| {
        level - (left + (right - left) * (offset + REACH_PX) / (2.0 * REACH_PX))
    };
    let peak = profile.iter().map(rise).fold(0.0, f64::max);
    // The grain of the grass stays below a quarter of the paint's peak; a line that does not reach
    // far above is left out.
    let sums = profile.iter().fold((0.0, 0.0), |sums, sample| {
        let weight = (rise(sample) - 0.25 * peak).max(0.0);
        (sums.0 + weight * sample.0, sums.1 + weight)
    });
    (peak > 0.3).then(|| sums.0 / sums.1)
}

#[test]
fn at_another_moment_people_and_boards_change_and_the_pitch_does_not() {
    // Level: stands fill the picture; 16° down: grass and lines do; between them the boards are in
    // the picture.
    const LEVEL: f64 = -2.0;
    const PITCH: f64 = -16.0;
    const BOARDS: f64 = -9.0;

    let scene = scene(3);
    let base = Preset::Easy.shoot().main_camera(SMALL);
    let taken = |moment: &Moment, tilt_deg: f64| {
        let camera = base.aim(4.0, tilt_deg, 900.0);
        scene.at(moment).render(&camera, SMALL, &bare()).image
    };
    let changed = |moment: &Moment, tilt_deg: f64| {
        let (first, then) = (taken(&Moment::default(), tilt_deg), taken(moment, tilt_deg));
        let count = first
            .pixels()
            .zip(then.pixels())
            .filter(|(a, b)| a != b)
            .count();
        count as f64 / f64::from(SMALL.width * SMALL.height)
    };
    let restless = Moment {
        instant: 5,
        restlessness: 1.0,
        ..Moment::default()
    };
    let others = Moment {
        occasion: 2,
        people_changed: 0.5,
        ..Moment::default()
    };
    let boards = Moment {
        occasion: 2,
        boards_changed: 0.5,
        ..Moment::default()
    };
    assert!(changed(&Moment::default(), LEVEL) == 0.0);
    assert!(
        changed(&restless, LEVEL) > 0.3,
        "{}",
        changed(&restless, LEVEL)
    );
    assert!(
        (0.15..0.8).contains(&changed(&others, LEVEL)),
        "{}",
        changed(&others, LEVEL)
    );
    assert!(
        changed(&boards, BOARDS) > 0.005,
        "{}",
        changed(&boards, BOARDS)
    );
    for moment in [restless, others, boards] {
        assert!(changed(&moment, PITCH) == 0.0, "{moment:?}");
    }
    let another = Moment {
        instant: 6,
        ..restless
    };
    assert!(
        taken(&another, LEVEL) != taken(&restless, LEVEL)
            && taken(&another, LEVEL) == taken(&another, LEVEL)
    );
}

#[test]
fn paint_lies_where_the_exact_camera_has_it() {
    for (crown_m, k1) in [(0.0, 0.0), (0.2, -0.12), (0.0, 0.2)] {
        let field = field(crown_m);
        let scene = stadium(&StadiumOptions::new(field.clone(), 3));
        let mut offsets = Vec::new();
        for (pan, tilt, focal) in [
            (-25.0, -13.0, 1700.0),
            (3.0, -14.0, 1500.0),
            (28.0, -12.0, 2200.0),
        ] {
            let base = CameraBase {
                distortion: FocalCurve::constant(k1),
                ..Preset::Easy.shoot().main_camera(FULL)
            };
            let camera = base.aim(pan, tilt, focal);
            let picture = scene.render(&camera, FULL, &bare()).image;
            let all_paint = all_paint(&camera, &field);
            for line in field.lines.iter().filter(|line| line.painted) {
                let offset = |i: u32| {
                    paint_offset(
                        &picture,
                        &camera,
                        &field,
                        &all_paint,
                        line,
                        f64::from(i) / 41.0,
                    )
                };
                offsets.extend((1..41).filter_map(offset));
            }
        }
        offsets.sort_by(f64::total_cmp);
        let at = |share: f64| offsets[((offsets.len() - 1) as f64 * share) as usize];
        println!(
            "crown {crown_m} k1 {k1}: {} samples, 1 % {:.3}, median {:.4}, 99 % {:.3} px",
            offsets.len(),
            at(0.01),
            at(0.5),
            at(0.99)
        );
        assert!(offsets.len() > 150, "only {} samples", offsets.len());
        assert!(at(0.5).abs() < 0.01, "median {}", at(0.5));
        assert!(
            at(0.01) > -0.08 && at(0.99) < 0.08,
            "{} to {}",
            at(0.01),
            at(0.99)
        );
    }
}

#[test]
fn the_mask_holds_every_pixel_of_every_mover() {
    let scene = scene(4);
    let shoot = Preset::Easy.shoot();
    let base = shoot.main_camera(FULL);
    let size = ImageSize::new(640, 360);
    let camera = PtzCamera::new(
        CameraBase {
            principal_point: size.centre(),
            ..base
        },
        Ptz::from_degrees(10.0, -13.0, 800.0),
    );
    let empty = scene.render(
        &camera,
        size,
        &FrameOptions {
            time_s: 30.0,
            ..bare()
        },
    );
    let full = scene.render(
        &camera,
        size,
        &FrameOptions {
            time_s: 30.0,
            players: true,
            ..bare()
        },
    );
    assert!(full.movers.len() >= 10, "{} movers", full.movers.len());
    assert!(empty.movers.is_empty() && empty.mover_mask.pixels().all(|pixel| pixel.0[0] == 0));
    for (x, y, mask) in full.mover_mask.enumerate_pixels() {
        let at = ImagePoint::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let boxed = full.movers.iter().any(|mover| mover.area.contains(at));
        assert!(
            mask.0[0] == 0 || boxed,
            "({x}, {y}) is masked, but in no box"
        );
        // Outside the mask movers only throw shadows, or cover less than a tenth.
        let (with, without) = (full.image.get_pixel(x, y).0, empty.image.get_pixel(x, y).0);
        let brighter =
            (0..3).any(|channel| i16::from(with[channel]) > i16::from(without[channel]) + 40);
        assert!(
            mask.0[0] == 255 || !brighter,
            "({x}, {y}) went from {without:?} to {with:?} outside the mask"
        );
    }
    for mover in &full.movers {
        assert!(mover.area.width >= 1.0 && mover.area.height >= 1.0);
        assert!(
            mover.area.x + mover.area.width <= 640.0 && mover.area.y + mover.area.height <= 360.0
        );
    }
}

#[test]
fn goals_stand_on_their_landmarks() {
    let (scene, field) = (scene(3), field(0.0));
    let base = Preset::Easy.shoot().main_camera(FULL);
    let camera = base.aim(36.0, -11.5, 3000.0);
    let picture = scene.render(&camera, FULL, &bare()).image;
    let place = |id: &str| landmark_in(&camera, &field, id);
    let (base, top) = (place("post_near_right_base"), place("post_near_right_top"));
    // Half-way up the near post the picture is white on the post and not beside it.
    let middle = ImagePoint::new(0.5 * (base.x + top.x), 0.5 * (base.y + top.y));
    let centroid = (-24..=24)
        .map(|i| f64::from(i) * 0.25)
        .fold((0.0, 0.0), |sums, offset| {
            let level = (blue(&picture, middle.translate(Vec2::new(offset, 0.0))) - 0.45).max(0.0);
            (sums.0 + level * offset, sums.1 + level)
        });
    assert!(
        centroid.1 > 1.0 && (centroid.0 / centroid.1).abs() < 1.5,
        "{centroid:?}"
    );
}

#[test]
fn drawn_clicks_are_named_seen_and_as_noisy_as_requested() {
    let (scene, field) = (scene(3), field(0.0));
    let shoot = Preset::Paper.shoot();
    let base = shoot.main_camera(FULL);
    let (mut squares, mut count) = (0.0, 0);
    for (index, step) in camera_path(&scene, &base, FULL, &shoot, 60)
        .iter()
        .enumerate()
    {
        let camera = PtzCamera::new(base, step.ptz);
        let options = ClickOptions {
            landmarks: 4,
            lines: 1,
            sigma_px: 1.5,
            seed: index as u64,
        };
        let clicks = generate_clicks(&field, &camera, FULL, &[], &options);
        assert_eq!(
            clicks,
            generate_clicks(&field, &camera, FULL, &[], &options)
        );
        assert!(clicks.len() <= 5);
        for click in clicks {
            let ClickTarget::Landmark(id) = &click.target else {
                continue;
            };
            let exact = landmark_in(&camera, &field, id.as_str());
            squares += click.image.distance_px(exact).powi(2);
            count += 2;
        }
    }
    let sigma = (squares / f64::from(count)).sqrt();
    assert!(
        count > 200 && (sigma - 1.5).abs() < 0.15,
        "σ {sigma} over {count}"
    );
}

/// At most 2000 features of a picture, at its full size.
#[cfg(feature = "opencv")]
fn features(picture: &RgbImage) -> Features {
    let size = ImageSize::new(picture.width(), picture.height());
    let rgba = image::DynamicImage::from(picture.clone()).into_rgba8();
    let options = FeatureOptions {
        max_count: 2000,
        ..FeatureOptions::default()
    };
    extract(&Picture::new(size, rgba.into_raw()).unwrap(), &[], &options).unwrap()
}

/// The nearest descriptor of other features, if the second nearest is not
/// about as near (Lowe's ratio of 0.8).
#[cfg(feature = "opencv")]
fn distinct_match(descriptor: &Descriptor, others: &[Descriptor]) -> Option<usize> {
    let mut distances: Vec<(u32, usize)> = others
        .iter()
        .enumerate()
        .map(|(index, other)| (descriptor.squared_byte_distance(other), index))
        .collect();
    distances.sort_unstable();
    let [(best, index), (second, _), ..] = distances[..] else {
        return None;
    };
    (f64::from(best) < 0.64 * f64::from(second)).then_some(index)
}

#[cfg(feature = "opencv")]
#[test]
fn features_of_the_stadium_are_found_again_in_another_frame() {
    let scene = scene(5);
    let base = Preset::Paper.shoot().main_camera(FULL);
    let take = |pan: f64, focal_px: f64, time_s: f64| {
        let camera = base.aim(pan, -11.5, focal_px);
        let options = FrameOptions {
            time_s,
            noise_levels: 1.5,
            noise_seed: time_s as u64,
            ..FrameOptions::default()
        };
        (camera, scene.render(&camera, FULL, &options).image)
    };
    let ((from, before), (to, after)) = (take(8.0, 1900.0, 10.0), take(12.0, 2150.0, 14.0));
    let (one, other) = (features(&before), features(&after));
    let (mut matched, mut right) = (0, 0);
    for (keypoint, descriptor) in one.keypoints.iter().zip(&one.descriptors) {
        let Some(index) = distinct_match(descriptor, &other.descriptors) else {
            continue;
        };
        matched += 1;
        let ray = from.ray_from_image(keypoint.point).unwrap();
        let found = other.keypoints[index].point;
        right += usize::from(
            to.image_from_ray(ray)
                .is_ok_and(|image| image.distance_px(found) < 2.0),
        );
    }
    println!(
        "{} features, {matched} matched, {right} of them right",
        one.len()
    );
    assert!(
        one.len() >= 1500 && right >= 150 && right * 10 >= matched * 6,
        "{matched} matched, {right} right"
    );
}

/// The scenes of other sports.
const COURTS: [Scene; 7] = [
    Scene::Basketball,
    Scene::Hockey,
    Scene::Tennis,
    Scene::Badminton,
    Scene::Volleyball,
    Scene::Handball,
    Scene::Football,
];
const SIDES: [CameraSide; 3] = [CameraSide::Side, CameraSide::End, CameraSide::Corner];

/// A court whole in the picture, with the camera that took it.
fn court_picture(scene: Scene, side: CameraSide, size: ImageSize) -> (RgbImage, PtzCamera) {
    let field = builtin(scene.template()).unwrap().default_model().unwrap();
    let still = ShootOptions {
        is_still: true,
        ..Preset::Easy.shoot()
    };
    let setting = Setting::new(scene, Some(side)).unwrap();
    let (base, shoot) = still.in_setting(setting, &field, size, 4);
    let place = stadium(&StadiumOptions {
        scene,
        daylight: shoot.daylight,
        ..StadiumOptions::new(field, 4)
    });
    let path = camera_path(&place, &base, size, &shoot, 2);
    assert_eq!(path[0].ptz, path[1].ptz);
    let camera = PtzCamera::new(base, path[0].ptz);
    (place.render(&camera, size, &bare()).image, camera)
}

/// How much the pixels at `offset` px beside the lines differ from those 5 px to both sides of
/// that, mean over the lines' places in the picture.
fn contrast(picture: &RgbImage, camera: &PtzCamera, field: &FieldModel, offset: f64) -> f64 {
    let (width, height) = (f64::from(picture.width()), f64::from(picture.height()));
    let lines = field.lines.iter().filter(|line| line.painted);
    let places = lines.flat_map(|line| (1..40).map(move |i| (line, f64::from(i) / 40.0)));
    let (mut sum, mut count) = (0.0, 0.0);
    for (line, t) in places {
        let Some((at, across)) = crossing(camera, field, line, t) else {
            continue;
        };
        if (12.0..width - 12.0).contains(&at.x) && (12.0..height - 12.0).contains(&at.y) {
            let level = |away: f64| blue(picture, at.translate(across * (offset + away)));
            sum += (level(0.0) - 0.5 * (level(-5.0) + level(5.0))).abs();
            count += 1.0;
        }
    }
    assert!(count > 50.0, "{count} places in the picture");
    sum / count
}

#[test]
fn each_court_is_drawn_the_same_twice_with_its_lines_where_the_camera_has_them() {
    for (index, scene) in COURTS.into_iter().enumerate() {
        let field = builtin(scene.template()).unwrap().default_model().unwrap();
        // Two of its three cameras, since each picture takes most of a second.
        for side in [SIDES[index % 3], SIDES[(index + 1) % 3]] {
            let size = ImageSize::new(960, 540);
            let (picture, camera) = court_picture(scene, side, size);
            let (here, beside) = (
                contrast(&picture, &camera, &field, 0.0),
                [-2.5, 2.5].map(|offset| contrast(&picture, &camera, &field, offset)),
            );
            assert!(
                beside.iter().all(|beside| here > 1.4 * beside),
                "{scene} from the {side}: {here} on the lines, {beside:?} beside them"
            );
        }
        let again = || court_picture(scene, SIDES[0], SMALL).0;
        assert_eq!(again(), again());
    }
}

#[test]
fn a_scene_without_such_a_camera_and_unknown_names_are_refused() {
    let refused = Setting::new(Scene::Stadium, Some(CameraSide::End));
    assert!(matches!(refused, Err(SceneError::NoCamera { .. })));
    assert!(Setting::new(Scene::Tennis, None).is_ok());
    let unknown = "curling".parse::<Scene>();
    assert!(matches!(unknown, Err(SceneError::UnknownScene(name)) if name == "curling"));
    assert!(matches!(
        "roof".parse::<CameraSide>(),
        Err(SceneError::UnknownSide(_))
    ));
    for scene in COURTS {
        assert_eq!(scene.to_string().parse(), Ok(scene));
    }
}
