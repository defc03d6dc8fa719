//! Painted lines of real frames: right cameras told from wrong ones, and snapping.

use crate::parts::{Test, frames_folder, tests};
use crate::program::touchline;
use touchline::camera::{Ptz, PtzCamera};
use touchline::field::FieldModel;
use touchline::geometry::{Angle, ImagePoint, ImageSize};
use touchline::markings::LineVerdict;
use touchline::media::load_image;
use touchline::paint::{
    GroundPicture, PointSnapOptions, SnapOptions, check_lines, snap, snap_point,
};
use touchline_documents::testing::load;

pub const TESTS: &[Test] = tests![
    [Frames] the_paint_tells_right_cameras_from_wrong_ones_and_snapping_comes_back;
    [Frames] points_go_to_painted_spots;
];

/// How far apart the overlays of two cameras are on the playing area, px: the median over the
/// picture.
pub fn apart_px(field: &FieldModel, one: &PtzCamera, other: &PtzCamera, size: ImageSize) -> f64 {
    let at = |index: u32, extent: u32| (f64::from(index % 8) + 0.5) / 8.0 * f64::from(extent);
    let mut distances: Vec<f64> = (0..64)
        .map(|index| ImagePoint::new(at(index, size.width), at(index / 8, size.height)))
        .filter_map(|pixel| {
            let ground = one.plane_from_image(pixel, 0.0)?;
            let on_field =
                ground.x.abs() <= field.length_m / 2.0 && ground.y.abs() <= field.width_m / 2.0;
            on_field.then(|| {
                other
                    .image_from_world(ground)
                    .map_or(f64::INFINITY, |image| image.distance_px(pixel))
            })
        })
        .collect();
    distances.sort_by(f64::total_cmp);
    distances[distances.len() / 2]
}

/// A camera turned and zoomed.
pub fn turn_view(camera: &PtzCamera, pan_px: f64, tilt_px: f64, zoom: f64) -> PtzCamera {
    let ptz = camera.ptz();
    let angle = |px: f64| Angle::from_radians(px / ptz.focal_px);
    let turned = Ptz {
        pan: ptz.pan + angle(pan_px),
        tilt: ptz.tilt + angle(tilt_px),
        focal_px: ptz.focal_px * zoom,
    };
    PtzCamera::new(*camera.base(), turned)
}

fn the_paint_tells_right_cameras_from_wrong_ones_and_snapping_comes_back() {
    let place = tempfile::tempdir().unwrap();
    let clicks = frames_folder().join("scouting-d82e7a/clicks.json");
    touchline(
        place.path(),
        &format!("refine-base {} -o base.json", clicks.display()),
    )
    .done();
    let document = load(place.path().join("base.json"));
    let field = document.field.model(place.path()).unwrap();
    let (mut right, mut wrong, mut back) = (0, 0, 0);
    let frames: Vec<_> = document.frames.iter().step_by(4).collect();
    for frame in &frames {
        let picture = load_image(&frame.image_path(place.path()).unwrap()).unwrap();
        let ground = GroundPicture::new(&picture, &document.masks_of(frame));
        let camera = document.ptz_camera(frame).unwrap();
        right +=
            usize::from(check_lines(&ground, &field, &camera).verdict() == LineVerdict::Supports);
        for (pan_px, tilt_px, zoom) in [
            (60.0, 10.0, 1.0),
            (-20.0, 25.0, 1.0),
            (0.0, 0.0, 1.08),
            (300.0, 0.0, 1.0),
        ] {
            let off = check_lines(&ground, &field, &turn_view(&camera, pan_px, tilt_px, zoom));
            wrong += usize::from(off.verdict() == LineVerdict::Supports);
        }
        let options = SnapOptions::default();
        let near = snap(&ground, &field, camera.base(), camera.ptz(), &[], &options).unwrap();
        let start = turn_view(&camera, 35.0, -25.0, 1.01).ptz();
        let far = snap(&ground, &field, camera.base(), start, &[], &options);
        let pointed = |ptz| PtzCamera::new(*camera.base(), ptz);
        back += usize::from(far.is_ok_and(|far| {
            apart_px(
                &field,
                &pointed(near.ptz),
                &pointed(far.ptz),
                frame.image_size,
            ) < 1.0
        }));
    }
    assert!(
        right >= frames.len() - 1,
        "{right} of {} right cameras are supported",
        frames.len()
    );
    assert_eq!(wrong, 0, "wrong cameras are supported");
    assert!(
        back >= frames.len() - 1,
        "{back} of {} come back",
        frames.len()
    );
}

/// People's clicks on penalty marks and centre marks: what the paint makes of them lies on the
/// marks of a camera that is fitted to everything else.
fn points_go_to_painted_spots() {
    let (mut before, mut after, mut clicks) = (Vec::new(), Vec::new(), 0);
    for set in ["scouting-d82e7a", "scouting-08fd33", "scouting-42ba34"] {
        let place = tempfile::tempdir().unwrap();
        let from = frames_folder().join(set).join("clicks.json");
        let ran = touchline(
            place.path(),
            &format!("refine-base {} --markings -o base.json", from.display()),
        );
        assert!(ran.code <= 1, "{}", ran.stderr);
        let document = load(place.path().join("base.json"));
        let field = document.field.model(place.path()).unwrap();
        for frame in &document.frames {
            let (Some(camera), Some(image)) =
                (document.ptz_camera(frame), frame.image_path(place.path()))
            else {
                continue;
            };
            let on_spots = frame.clicks.iter().filter_map(|click| {
                let landmark = field.landmark(click.target.as_ref()?.as_str())?;
                landmark.spot_diameter_m.map(|_| (landmark, click.image))
            });
            let on_spots: Vec<_> = on_spots.collect();
            if on_spots.is_empty() {
                continue;
            }
            let ground =
                GroundPicture::new(&load_image(&image).unwrap(), &document.masks_of(frame));
            for (landmark, placed) in on_spots {
                clicks += 1;
                let exact = camera
                    .image_from_world(field.landmark_in_world(landmark))
                    .unwrap();
                let options = PointSnapOptions::default();
                if let Some(found) =
                    snap_point(&ground, &field, &camera, landmark, placed, &options)
                {
                    before.push(placed.distance_px(exact));
                    after.push(found.image.distance_px(exact));
                }
            }
        }
    }
    let quantile = |values: &mut Vec<f64>, share: f64| {
        values.sort_by(f64::total_cmp);
        values[((values.len() - 1) as f64 * share) as usize]
    };
    let [was, is] = [&mut before, &mut after].map(|all| (quantile(all, 0.5), quantile(all, 0.9)));
    println!(
        "{clicks} clicks on spots, {} moved: {was:.2?} px off before, {is:.2?} px after (median, 90 %)",
        after.len()
    );
    assert!(
        is.0 < was.0 && is.1 < was.1,
        "{is:?} px after, {was:?} px before"
    );
}
