//! Cameras that look along ±180° or ±90° of pan: on the far side and behind the goals everything is
//! as on the main stand.

use std::path::Path;
use touchline_application::app::naming::{NamingScene, TakenName, candidates};
use touchline_application::app::quality::{Course, Quantity, TimeAxis};
use touchline_calibration::calibrate::{Disagreements, FrameLookup, calibrate, choose_gold};
use touchline_calibration::proposals::{Coverage, LabelNext, label_advice};
use touchline_core::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use touchline_core::field::Symmetry;
use touchline_core::geometry::{Angle, ImagePoint, ImageSize, Vec3};
use touchline_core::progress::Progress;
use touchline_core::solve::{Observation, WarningCode};
use touchline_core::testing::{base_at, soccer};
use touchline_documents::document::{
    Camera, Click, Clip, Document, Frame, FramePtz, FrameStatus, Solution, SolutionSource,
    SolutionWarning, Target, VideoFrame,
};
use touchline_documents::testing::match_from;
use touchline_vision::relocalize::SeenRange;

const SIZE: ImageSize = ImageSize::new(1280, 720);

/// A place to film from.
#[derive(Clone, Copy, Debug)]
struct FilmingPosition {
    name: &'static str,
    base: CameraBase,
    /// The pan towards the field's centre.
    centre: Angle,
}

impl FilmingPosition {
    fn new(name: &'static str, position_m: [f64; 3]) -> Self {
        let base = base_at(position_m, SIZE);
        Self {
            name,
            base,
            centre: PanTilt::from_direction(base.base_from_world_point(Vec3::zeros())).pan,
        }
    }

    /// The main stand first.
    fn all() -> [Self; 4] {
        [
            Self::new("main stand", [2.0, -64.0, 17.0]),
            Self::new("far side", [-2.0, 64.0, 17.0]),
            Self::new("left goal", [-82.0, 1.0, 17.0]),
            Self::new("right goal", [82.0, 1.0, 17.0]),
        ]
    }

    /// A camera that looks this far to the right of the field's centre.
    fn looks(&self, right_deg: f64) -> Ptz {
        Ptz {
            pan: (self.centre + Angle::from_degrees(right_deg)).wrap(),
            ..Ptz::from_degrees(0.0, -11.0, 1500.0)
        }
    }

    fn document(&self) -> Document {
        match_from(&self.base, SIZE)
    }

    /// A frame of one video that looks this far to the right.
    fn frame(&self, number: u64, right_deg: f64, status: FrameStatus) -> Frame {
        let video = VideoFrame::new("m.mp4", number, Some(0.04 * number as f64));
        let mut frame = Frame::from_video(video, "main".into(), SIZE);
        frame.ptz = Some(FramePtz::new(self.looks(right_deg), None));
        frame.status = status;
        frame
    }

    /// The landmarks that a camera here shows, with where.
    fn visible_landmarks(&self, ptz: Ptz) -> Vec<(String, ImagePoint)> {
        let field = soccer();
        let camera = PtzCamera::new(self.base, ptz);
        let image = |landmark| {
            camera
                .image_from_world(field.landmark_in_world(landmark))
                .ok()
        };
        let shown = field
            .landmarks
            .iter()
            .filter_map(|mark| Some((mark.id.as_str().to_owned(), image(mark)?)));
        shown.filter(|(_, image)| SIZE.contains(*image)).collect()
    }

    /// What a frame with all landmarks clicked is warned of as being implausible, were it the
    /// document's next one.
    fn implausible(&self, document: &Document, frame: Frame, ptz: Ptz) -> Option<String> {
        let shown = self.visible_landmarks(ptz);
        assert!(shown.len() >= 3, "{}: {shown:?}", self.name);
        let clicks = shown
            .iter()
            .map(|(id, image)| Click::landmark(id.as_str().into(), *image));
        let mut document = document.clone();
        document.frames.push(
            Frame {
                clicks: clicks.collect(),
                ptz: None,
                ..frame
            }
            .into(),
        );
        let index = document.frames.len() - 1;
        let solved = calibrate(
            &document,
            &FrameLookup::from_document(&document),
            &document.frames[index],
            &soccer(),
            index,
        )
        .unwrap();
        assert!(
            solved.ptz.pan.turn_from(ptz.pan).abs().degrees() < 1e-6,
            "{}",
            self.name
        );
        let warning = solved
            .warnings
            .into_iter()
            .find(|warning| warning.code == WarningCode::Implausible);
        warning.map(|warning| warning.message)
    }
}

#[test]
fn only_what_lies_beyond_the_accepted_frames_is_out_of_the_usual() {
    for place in FilmingPosition::all() {
        let mut document = place.document();
        for number in 0..9 {
            let right_deg = 2.0 * number as f64 - 8.0;
            document.frames.push(
                place
                    .frame(1000 * number, right_deg, FrameStatus::Reference)
                    .into(),
            );
        }
        let clicked = || place.frame(50_000, 0.0, FrameStatus::Draft);
        for right_deg in [-9.0, -1.0, 0.5, 9.0] {
            let said = place.implausible(&document, clicked(), place.looks(right_deg));
            assert_eq!(said, None, "{} {right_deg}", place.name);
        }
        for right_deg in [-26.0, 26.0] {
            let [pan, from, upto] =
                [right_deg, -8.0, 8.0].map(|right_deg| place.looks(right_deg).pan);
            let said = place
                .implausible(&document, clicked(), place.looks(right_deg))
                .unwrap();
            let expected = format!("pan {pan:.1}, accepted frames have {from:.1} to {upto:.1}");
            assert!(said.contains(&expected), "{}: {said}", place.name);
        }
    }
}

#[test]
fn a_camera_that_pans_over_the_seam_does_not_jump() {
    for place in FilmingPosition::all() {
        let mut document = place.document();
        for number in 0..20 {
            document.frames.push(
                place
                    .frame(number, 0.4 * number as f64 - 4.0, FrameStatus::Draft)
                    .into(),
            );
        }
        let clicked = || place.frame(20, 0.0, FrameStatus::Draft);
        assert_eq!(
            place.implausible(&document, clicked(), place.looks(4.0)),
            None,
            "{}",
            place.name
        );
        let said = place
            .implausible(&document, clicked(), place.looks(-9.0))
            .unwrap();
        assert!(
            said.contains("Pan differs by 12.6° from the next frame"),
            "{}: {said}",
            place.name
        );
    }
}

/// The names for the second click of a frame that nothing else is known of, in their order; the
/// right one's rank.
fn names(place: &FilmingPosition, right_deg: f64) -> (Vec<String>, usize) {
    let (field, ptz) = (soccer(), place.looks(right_deg));
    let shown = place.visible_landmarks(ptz);
    let left = shown.iter().min_by(|a, b| a.1.x.total_cmp(&b.1.x)).unwrap();
    let right = shown.iter().max_by(|a, b| a.1.x.total_cmp(&b.1.x)).unwrap();
    let scene = NamingScene {
        looks: None,
        field: &field,
        image_size: SIZE,
        base: Some(&place.base),
        camera: None,
        named: &[Observation::from_landmark(&field, &left.0, left.1, SIZE, 0).unwrap()],
        taken: &[TakenName {
            target: Target::Landmark(left.0.as_str().into()),
            click: 0,
        }],
        neighbours: &[],
        other_shots: &[],
        neighbour_clicks: &[],
    };
    let names: Vec<String> = candidates(&scene, right.1, false)
        .iter()
        .map(|candidate| candidate.target.as_str().to_owned())
        .collect();
    let rank = names.iter().position(|name| *name == right.0).unwrap();
    (names, rank)
}

#[test]
fn names_are_ranked_alike_from_every_side() {
    let [main, far, left, right] = FilmingPosition::all();
    for right_deg in [-20.0, -3.0, 4.0, 15.0] {
        // The far side sees what the main stand sees of the field turned by half a turn.
        let (field, (on_main, rank)) = (soccer(), names(&main, right_deg));
        let turned = on_main.iter().map(|name| {
            let twin = Symmetry::Turn180
                .landmark_twin(&field, field.landmark(name).unwrap())
                .unwrap();
            twin.id.as_str().to_owned()
        });
        // Farther down stand names that contradict the other click: these have no one best camera.
        assert_eq!(
            names(&far, right_deg).0[..4],
            turned.take(4).collect::<Vec<_>>(),
            "{right_deg}"
        );
        assert!(rank < 3, "{right_deg}: {rank} of {on_main:?}");
        for end in [left, right] {
            let (found, rank) = names(&end, right_deg);
            assert!(rank < 3, "{} {right_deg}: {rank} of {found:?}", end.name);
        }
    }
}

#[test]
fn the_map_of_what_references_see_is_the_same_from_the_far_side() {
    let [main, far, left, right] = FilmingPosition::all();
    let coverage = |place: &FilmingPosition| {
        let mut document = place.document();
        for (number, right_deg) in [-30.0, -10.0, 2.0].into_iter().enumerate() {
            document.frames.push(
                place
                    .frame(number as u64, right_deg, FrameStatus::Reference)
                    .into(),
            );
        }
        Coverage::measure(&document, &soccer(), &"main".into(), &[0, 1, 2]).unwrap()
    };
    let (on_main, on_far) = (coverage(&main), coverage(&far));
    assert_eq!(on_main.cells, on_far.cells);
    assert!((on_main.pan.width() - on_far.pan.width()).abs().degrees() < 1e-9);
    for found in [on_main, on_far, coverage(&left), coverage(&right)] {
        assert!(found.pan.width().degrees() < 140.0, "{:?}", found.pan);
        assert!(
            found
                .cells
                .iter()
                .any(|cell| cell.references == 0 && cell.field),
            "some of the field is missing"
        );
        assert!(found.cells.iter().any(|cell| cell.references > 1));
        let missing = Angle::from_degrees(found.missing_pan_deg.unwrap());
        assert!(
            found.pan.contains(missing) && missing == missing.wrap(),
            "{missing}"
        );
    }
}

#[test]
fn the_next_label_is_where_most_wait_also_across_the_seam() {
    let next = |place: &FilmingPosition| -> LabelNext {
        let mut document = place.document();
        // Six on either side of the field's centre, within one view, and seven far to the left,
        // apart from each other.
        let waiting = [-1.5, -1.0, -0.5, 0.5, 1.0, 1.5].map(|right_deg| (1, right_deg));
        let apart =
            [-140.0, -125.0, -110.0, -95.0, -80.0, -65.0, -50.0].map(|right_deg| (2, right_deg));
        for (number, (clip, right_deg)) in waiting.into_iter().chain(apart).enumerate() {
            let mut frame = place.frame(number as u64, right_deg, FrameStatus::Suggested);
            frame.clip = Some(Clip::Number(clip));
            frame.ptz = Some(FramePtz::new(
                Ptz {
                    focal_px: 5000.0,
                    ..place.looks(right_deg)
                },
                None,
            ));
            let mut solution = Solution {
                source: Some(SolutionSource::Forest),
                ..Solution::default()
            };
            solution.confidence = Some(0.5);
            solution.warnings = vec![SolutionWarning::new("coverage", "few".to_owned())];
            frame.solution = Some(solution);
            document.frames.push(frame.into());
        }
        label_advice(&document, &[]).next.unwrap()
    };
    for place in FilmingPosition::all() {
        let found = next(&place);
        assert_eq!(found.shared_by, 6, "{}: {found:?}", place.name);
        let right = Angle::from_degrees(found.pan_deg.unwrap())
            .turn_from(place.centre)
            .degrees();
        assert!(right.abs() < 1.6, "{}: {right}", place.name);
    }
}

#[test]
fn a_pan_over_time_has_no_jump() {
    for place in FilmingPosition::all() {
        let mut document = place.document();
        for number in 0..30 {
            document.frames.push(
                place
                    .frame(number, 1.5 * number as f64 - 20.0, FrameStatus::Suggested)
                    .into(),
            );
        }
        let course = Course::compute(
            &document,
            &Disagreements::from_document(&document),
            &"main".into(),
            TimeAxis::Frame,
        );
        assert!(course.standing_out.is_empty(), "{}", place.name);
        for pair in course.points.windows(2) {
            let step = pair[1].value(Quantity::Pan) - pair[0].value(Quantity::Pan);
            assert!((step - 1.5).abs() < 1e-9, "{}: {step}", place.name);
        }
    }
}

#[test]
fn gold_frames_spread_over_the_circle() {
    for place in FilmingPosition::all() {
        let mut document = place.document();
        let rights = [-1.0, 1.0, 0.5, -0.5, 0.0, 20.0, -20.0, 1.5, 10.0, -10.0];
        for (number, right_deg) in rights.into_iter().enumerate() {
            let mut frame = place.frame(number as u64, right_deg, FrameStatus::Reference);
            frame.clicks = vec![Click::landmark("centre_mark".into(), SIZE.centre())];
            document.frames.push(frame.into());
        }
        let chosen = choose_gold(&document);
        assert!(
            [5, 6, 8, 9].iter().all(|index| chosen.contains(index)),
            "{}: {chosen:?}",
            place.name
        );
    }
}

#[test]
fn answers_across_the_seam_are_plausible() {
    for place in FilmingPosition::all() {
        let taught = [-6.0, -3.0, -1.0, 2.0].map(|right_deg| place.looks(right_deg));
        let seen = SeenRange::from_cameras(&taught).unwrap();
        assert!(
            (seen.pan_deg.end() - seen.pan_deg.start() - 8.0).abs() < 1e-9,
            "{}: {seen:?}",
            place.name
        );
        let plausible = seen.plausible();
        for (right_deg, may_be) in [
            (-35.9, true),
            (0.5, true),
            (31.9, true),
            (-36.1, false),
            (32.1, false),
        ] {
            assert_eq!(
                plausible.contains(&place.looks(right_deg)),
                may_be,
                "{} {right_deg}",
                place.name
            );
        }
    }
}

/// A forest is trained on frames of a drawn match that look further left, and queried for frames
/// that look further right.
#[cfg(feature = "opencv")]
#[test]
fn frames_drawn_from_every_side_are_found_again() {
    use touchline_core::geometry::rotation::{angle_between, q_pan, q_tilt};
    use touchline_vision::features::{FeatureOptions, extract};
    use touchline_vision::media::Picture;
    use touchline_vision::relocalize::{
        RelocalizeOptions, Samples, TrainOptions, relocalize, train,
    };
    use touchline_vision::synthetic::{CameraMotion, PathStep, Preset, StadiumOptions, stadium};

    const SMALL: ImageSize = ImageSize::new(640, 360);
    let scene = stadium(&StadiumOptions::new(soccer(), 5));
    let shoot = Preset::Easy.shoot();
    // Drawing takes its time: a seam in the middle of what is taught, and a camera behind a goal.
    let [_, far, _, right_goal] = FilmingPosition::all();
    for place in [far, right_goal] {
        let base = CameraBase {
            principal_point: SMALL.centre(),
            ..place.base
        };
        let camera = |right_deg| {
            PtzCamera::new(
                base,
                Ptz {
                    focal_px: 700.0,
                    ..place.looks(right_deg)
                },
            )
        };
        let features = |number: usize, camera: &PtzCamera| {
            let step = PathStep {
                time_s: 3.0,
                ptz: camera.ptz(),
                motion: CameraMotion::default(),
            };
            let drawn = scene
                .render(camera, SMALL, &shoot.frame(number, &step, SMALL, 5))
                .image;
            let rgba: Vec<u8> = drawn
                .pixels()
                .flat_map(|pixel| [pixel[0], pixel[1], pixel[2], 255])
                .collect();
            extract(
                &Picture::new(SMALL, rgba).unwrap(),
                &[],
                &FeatureOptions::default(),
            )
            .unwrap()
        };
        let taught = [-15.0, -8.0, -1.5].map(camera);
        let mut samples = Samples::new();
        for (number, camera) in taught.iter().enumerate() {
            let found = features(number, camera);
            let rays = found
                .keypoints
                .iter()
                .map(|keypoint| camera.ray_from_image(keypoint.point).unwrap());
            samples.add_frame(found.descriptors.iter().copied().zip(rays));
        }
        let seen = SeenRange::from_cameras(&taught.map(|camera| camera.ptz())).unwrap();
        let forest = train(&samples, &TrainOptions::default(), &Progress::default()).unwrap();
        for (number, right_deg) in [-11.0, 3.0].into_iter().enumerate() {
            let truth = camera(right_deg);
            let query = features(10 + number, &truth);
            let answer = relocalize(&query, &forest, &seen, &base, &RelocalizeOptions::default());
            let found = answer
                .pose
                .unwrap_or_else(|reason| panic!("{} {right_deg}: {reason}", place.name))
                .ptz;
            let turned = |ptz: Ptz| q_tilt(ptz.tilt) * q_pan(ptz.pan);
            let off = angle_between(&turned(found), &turned(truth.ptz())).degrees();
            assert!(off < 0.1, "{} {right_deg}: {off}°", place.name);
        }
    }
}

#[test]
fn coverage_is_reported_for_each_camera() {
    let [main, far, ..] = FilmingPosition::all();
    let mut document = main.document();
    let mut second = Camera::new("far".into(), SIZE);
    second.set_base(&far.base);
    document.cameras.push(second.into());
    document
        .frames
        .push(main.frame(0, 0.0, FrameStatus::Reference).into());
    let mut frame = far.frame(1, 0.0, FrameStatus::Reference);
    frame.camera = "far".into();
    document.frames.push(frame.into());
    let found = Coverage::measure_cameras(document.at(Path::new("")), &[0, 1]);
    assert_eq!(found.len(), 2);
    assert_eq!(found[0].cells, found[1].cells);
}
