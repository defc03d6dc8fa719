//! Drawn courts whose camera is known.

use super::*;
use crate::autocalibrate::search::places::is_court;
use touchline_core::field::builtin;
use touchline_core::geometry::ImagePoint;
use touchline_core::markings::{SampleOptions, sample_lines};
use touchline_core::testing::turned_base;
use touchline_vision::media::Picture;

const SIZE: ImageSize = ImageSize::new(960, 540);

fn field(name: &str) -> FieldModel {
    builtin(name).unwrap().default_model().unwrap()
}

/// A camera in the stand behind an end of a court, at a multiple of the distance of one of a
/// tennis court.
fn camera(relative: f64, pan_deg: f64) -> PtzCamera {
    let base = turned_base(
        [-33.0 * relative, 0.3 * relative, 8.7 * relative],
        [90.0, 0.0, 0.0],
        SIZE,
    );
    PtzCamera::new(base, Ptz::from_degrees(pan_deg, -14.0, 1400.0))
}

/// The camera of some pictures whose principal point is their middle.
fn find(frames: &[CourtFrame], field: &FieldModel) -> Option<AutocalibratedCamera> {
    find_court_camera(frames, field, TriedLens::default())
}

const WHITE: [u8; 4] = [235, 236, 238, 255];

/// A court of one colour in a surround of another, with its lines in the colours that `paint_of`
/// gives their ids; none where there is but the border of the court.
fn draw(field: &FieldModel, camera: &PtzCamera, paint_of: fn(&str) -> Option<[u8; 4]>) -> Picture {
    const COURT: [u8; 4] = [92, 70, 140, 255];
    const SURROUND: [u8; 4] = [60, 130, 80, 255];
    let pixels = (0..SIZE.height).flat_map(|y| (0..SIZE.width).map(move |x| (x, y)));
    let mut picture: Vec<[u8; 4]> = pixels
        .map(|(x, y)| {
            let at = ImagePoint::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let ground = camera.plane_from_image(at, 0.0);
            let is_inside =
                |at: Vec3| at.x.abs() <= 0.5 * field.length_m && at.y.abs() <= 0.5 * field.width_m;
            if ground.is_some_and(is_inside) {
                COURT
            } else {
                SURROUND
            }
        })
        .collect();
    let options = SampleOptions {
        spacing_px: 0.4,
        border_px: 2.0,
    };
    for sample in sample_lines(field, camera, SIZE, &options) {
        let Some(paint) = paint_of(field.lines[sample.line].id.as_str()) else {
            continue;
        };
        for across in [-0.8, -0.4, 0.0, 0.4, 0.8] {
            let at = sample.image.translate(sample.normal * across);
            picture[at.y as usize * SIZE.width as usize + at.x as usize] = paint;
        }
    }
    Picture::new(SIZE, picture.concat()).unwrap()
}

fn frames(field: &FieldModel, cameras: &[PtzCamera]) -> Vec<CourtFrame> {
    let frame = |(index, camera): (usize, &PtzCamera)| {
        CourtFrame::new(
            index,
            GroundPicture::new(&draw(field, camera, |_| Some(WHITE)), &[]),
        )
    };
    cameras.iter().enumerate().map(frame).collect()
}

#[test]
fn a_still_or_turning_camera_of_a_court_is_found_whatever_the_colours() {
    let tennis = field("tennis");
    for pans_deg in [[0.0, 0.0, 0.0], [-2.0, 0.5, 2.5]] {
        let cameras = pans_deg.map(|pan_deg| camera(1.0, pan_deg));
        let found = find(&frames(&tennis, &cameras), &tennis).unwrap();
        let truth_m = cameras[0].base().position_m;
        let off_m = (found.base.position_m - truth_m).norm();
        assert!(
            off_m < 0.02 * truth_m.norm(),
            "{pans_deg:?}: {:?}",
            found.base
        );
        assert_eq!(found.frames.len(), 3);
        assert!(found.paint.len() > 500, "{}", found.paint.len());
    }
}

#[test]
fn a_court_of_another_sport_is_not_taken_for_it() {
    let pickleball = field("pickleball");
    let pictures = frames(&pickleball, &[camera(0.55, 0.0), camera(0.55, 1.0)]);
    assert!(find(&pictures, &pickleball).is_some());
    for other in ["tennis", "badminton", "volleyball", "padel"] {
        let found = find(&pictures, &field(other));
        assert!(
            found.is_none(),
            "{other}: {:?}",
            found.map(|found| found.base)
        );
    }
}

/// A close-up, say.
fn bare() -> CourtFrame {
    let grey = Picture::with_colour(SIZE, [90, 90, 90, 255]);
    CourtFrame::new(9, GroundPicture::new(&grey, &[]))
}

#[test]
fn pictures_without_a_court_give_no_camera_and_take_none() {
    let tennis = field("tennis");
    assert!(find(&[], &tennis).is_none());
    assert!(find(&[bare()], &tennis).is_none());
    let mut pictures = frames(&tennis, &[camera(1.0, 0.0), camera(1.0, 1.0)]);
    pictures.extend([bare(), bare(), bare()]);
    let found = find(&pictures, &tennis).unwrap();
    assert_eq!(found.frames.len(), 2);
    // One picture alone confirms nothing.
    pictures.remove(0);
    assert!(find(&pictures, &tennis).is_none());
}

/// Boundaries without a line, dark lines: each line says what it can in the tone that it has.
#[test]
fn a_court_with_dark_lines_and_bare_boundaries_is_found() {
    let basketball = field("basketball_nba");
    let paint_of = |id: &str| match id {
        id if id.starts_with("sideline") || id.starts_with("end_line") => None,
        id if id.starts_with("three_point") => Some([30, 24, 60, 255]),
        _ => Some(WHITE),
    };
    let base = turned_base([-1.0, -36.0, 12.0], [0.0, 0.0, 0.0], SIZE);
    let cameras = [-12.0, -10.0]
        .map(|pan_deg| PtzCamera::new(base, Ptz::from_degrees(pan_deg, -18.5, 1500.0)));
    let drawn = |(index, camera): (usize, &PtzCamera)| {
        let picture = draw(&basketball, camera, paint_of);
        CourtFrame::new(index, GroundPicture::new(&picture, &[]))
    };
    let pictures: Vec<CourtFrame> = cameras.iter().enumerate().map(drawn).collect();
    let found = find(&pictures, &basketball).unwrap();
    let off_m = (found.base.position_m - base.position_m).norm();
    assert!(off_m < 1.0, "{:?}", found.base);
}

/// A guess a quarter of a step beside it leads to the principal point and the place.
#[test]
fn the_principal_point_of_a_picture_that_was_cut_is_found_from_a_guess() {
    let tennis = field("tennis");
    let truth = ImagePoint::new(SIZE.centre().x, SIZE.centre().y - 0.175 * 960.0);
    let cut = |pan_deg: f64| {
        let camera = camera(1.0, pan_deg);
        let base = CameraBase {
            principal_point: truth,
            ..*camera.base()
        };
        PtzCamera::new(base, Ptz::from_degrees(pan_deg, -8.0, 1400.0))
    };
    let pictures = frames(&tennis, &[cut(0.0), cut(2.0), cut(-2.0)]);
    let guess = ImagePoint::new(truth.x, SIZE.centre().y - 0.2 * 960.0);
    let guess = TriedLens {
        stated: StatedLens::from_principal_point(guess),
        is_guess: true,
    };
    let found = find_court_camera(&pictures, &tennis, guess).unwrap();
    let off_m = (found.base.position_m - camera(1.0, 0.0).base().position_m).norm();
    assert!(off_m < 1.0, "{:?}", found.base);
    assert!(
        found.base.principal_point.distance_px(truth) < 20.0,
        "{:?}",
        found.base
    );
}

/// Two cameras of one match: that with more pictures is the answer.
#[test]
fn the_camera_of_most_pictures_is_found() {
    let tennis = field("tennis");
    let low = |pan_deg: f64| camera(1.0, pan_deg);
    let base = turned_base([-45.0, 1.0, 14.0], [90.0, 0.0, 0.0], SIZE);
    let high = PtzCamera::new(base, Ptz::from_degrees(0.0, -17.0, 1700.0));
    let found = find(&frames(&tennis, &[low(0.0), high, low(1.0)]), &tennis).unwrap();
    assert!(
        (found.base.position_m.z - 8.7).abs() < 0.4,
        "{:?}",
        found.base
    );
    assert!(find(&frames(&tennis, &[low(0.0), high]), &tennis).is_none());
}

#[test]
fn a_view_is_expressed_with_the_nearer_of_two_opposite_bases() {
    let one = camera(1.0, 3.0);
    for other in [one, one.after_half_turn()] {
        let view = view_from(one.base(), &other);
        assert!(
            (view.pan - Angle::from_degrees(3.0)).degrees().abs() < 1e-9,
            "{view:?}"
        );
        assert!(
            (view.tilt - Angle::from_degrees(-14.0)).degrees().abs() < 1e-9,
            "{view:?}"
        );
    }
}

#[test]
fn courts_are_small_fields() {
    for (name, is_one) in [
        ("tennis", true),
        ("basketball_nba", true),
        ("soccer", false),
    ] {
        assert_eq!(is_court(&field(name)), is_one, "{name}");
    }
}
