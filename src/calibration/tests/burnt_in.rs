//! Score bugs, logos and lower thirds are neither trained on nor matched, with no mask drawn.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use touchline_core::camera::PanTilt;
use touchline_core::geometry::{ImagePoint, ImageSize};
use touchline_core::testing::TestBase;
use touchline_core::testing::seeded::rng;
use touchline_vision::features::{BurntIn, Descriptor, Features, burnt_in};
use touchline_vision::testing::{SIZE, add, base, descriptor, empty};

/// Things in the stadium, by their rays, and things on the screen, by their places.
struct World {
    stadium: Vec<(Descriptor, PanTilt)>,
    screen: Vec<(Descriptor, ImagePoint)>,
}

impl World {
    /// A graphic of 40 features in a box of 260 × 30 px.
    fn new(rng: &mut Pcg64Mcg) -> Self {
        let ray = |rng: &mut Pcg64Mcg| {
            PanTilt::from_degrees(rng.random_range(-50.0..50.0), rng.random_range(-22.0..2.0))
        };
        let place = |rng: &mut Pcg64Mcg| {
            ImagePoint::new(rng.random_range(60.0..320.0), rng.random_range(30.0..60.0))
        };
        Self {
            stadium: (0..3000).map(|_| (descriptor(rng), ray(rng))).collect(),
            screen: (0..40).map(|_| (descriptor(rng), place(rng))).collect(),
        }
    }

    /// What a camera sees, the features of the screen last.
    fn view(&self, pan_deg: f64, with_graphic: bool, rng: &mut Pcg64Mcg) -> Features {
        let camera = base().aim(pan_deg, -10.0, 1900.0);
        let stadium = self
            .stadium
            .iter()
            .filter_map(|(what, ray)| Some((what, camera.image_from_ray(*ray).ok()?)));
        let screen = self
            .screen
            .iter()
            .filter(|_| with_graphic)
            .map(|(what, at)| (what, *at));
        let mut features = empty();
        for (what, at) in stadium.filter(|(_, at)| SIZE.contains(*at)).chain(screen) {
            let point = ImagePoint::new(
                at.x + rng.random_range(-0.2..0.2),
                at.y + rng.random_range(-0.2..0.2),
            );
            add(&mut features, what, point, rng);
        }
        features
    }
}

fn find_graphics(pictures: &[Features]) -> BurntIn {
    burnt_in(&pictures.iter().collect::<Vec<_>>(), &|_, _, _| true)
}

#[test]
fn two_pictures_tell_what_stands_still() {
    let mut rng = rng("two_pictures_tell_what_stands_still");
    let world = World::new(&mut rng);
    let pictures = [-4.0, 9.0].map(|pan_deg| world.view(pan_deg, true, &mut rng));
    let found = find_graphics(&pictures);
    for (features, burnt) in pictures.iter().zip(&found.features) {
        let on_screen = features.len() - world.screen.len()..features.len();
        let caught = burnt
            .iter()
            .filter(|feature| on_screen.contains(feature))
            .count();
        assert!(caught >= 38, "{caught} of 40");
        // What the stadium shows behind the graphic may go with it.
        assert!(
            burnt.len() - caught <= 30,
            "{} of the stadium",
            burnt.len() - caught
        );
    }
    let [graphic] = &found.graphics[..] else {
        panic!("{:?}", found.graphics)
    };
    assert_eq!((graphic.first, graphic.last), (0, 1));
    let held = world
        .screen
        .iter()
        .filter(|(_, at)| graphic.pixel_box.contains(*at))
        .count();
    assert!(
        held == 40 && graphic.pixel_box.width < 310.0 && graphic.pixel_box.height < 70.0,
        "{graphic:?}"
    );
}

#[test]
fn a_still_camera_is_no_graphic() {
    let mut rng = rng("a_still_camera_is_no_graphic");
    let world = World::new(&mut rng);
    let once = world.view(2.0, true, &mut rng);
    assert_eq!(
        find_graphics(&[once.clone(), once.clone()]).features,
        [Vec::<usize>::new(), Vec::new()],
        "the same picture twice"
    );
    // Again with noise, and moved by a few px: the picture as a whole hardly moved.
    for moved_deg in [0.0, 0.02, 0.1, 0.2] {
        let pictures = [once.clone(), world.view(2.0 + moved_deg, true, &mut rng)];
        assert_eq!(
            find_graphics(&pictures),
            BurntIn {
                features: vec![vec![], vec![]],
                graphics: vec![]
            },
            "{moved_deg}°"
        );
    }
}

#[test]
fn pictures_that_tell_nothing_give_nothing() {
    let mut rng = rng("pictures_that_tell_nothing_give_nothing");
    let world = World::new(&mut rng);
    let one = world.view(0.0, true, &mut rng);
    let empty = empty();
    let other_size = Features {
        image_size: ImageSize::new(1920, 1080),
        ..world.view(12.0, true, &mut rng)
    };
    let unmasked = [-8.0, 0.0, 7.0]
        .map(|pan_deg| world.view(pan_deg, false, &mut rng))
        .to_vec();
    for pictures in [
        vec![],
        vec![one.clone()],
        vec![one.clone(), empty],
        vec![one, other_size],
        unmasked,
    ] {
        let found = find_graphics(&pictures);
        assert!(
            found.graphics.is_empty() && found.features.iter().all(Vec::is_empty),
            "{found:?}"
        );
        assert_eq!(found.features.len(), pictures.len());
    }
}

#[test]
fn a_graphic_has_the_pictures_that_show_it() {
    let mut rng = rng("a_graphic_has_the_pictures_that_show_it");
    let world = World::new(&mut rng);
    let pictures: Vec<Features> = (0..8)
        .map(|i| world.view(7.0 * f64::from(i) - 25.0, (2..6).contains(&i), &mut rng))
        .collect();
    let found = find_graphics(&pictures);
    let [graphic] = &found.graphics[..] else {
        panic!("{:?}", found.graphics)
    };
    assert_eq!((graphic.first, graphic.last), (2, 5));
    let with: Vec<bool> = found
        .features
        .iter()
        .map(|burnt| burnt.len() >= 30)
        .collect();
    assert_eq!(with, [false, false, true, true, true, true, false, false]);
}

#[test]
fn pairs_count_only_where_the_cameras_moved() {
    let mut rng = rng("pairs_count_only_where_the_cameras_moved");
    let world = World::new(&mut rng);
    let pictures = [-4.0, 9.0].map(|pan_deg| world.view(pan_deg, true, &mut rng));
    let found = burnt_in(&[&pictures[0], &pictures[1]], &|_, _, _| false);
    assert!(found.graphics.is_empty() && found.features.iter().all(Vec::is_empty));
}

/// Drawn frames with score bug, lower third and logo, and no mask.
#[cfg(feature = "opencv")]
mod drawn {
    use touchline_core::camera::{CameraBase, PtzCamera};
    use touchline_core::field::builtin;
    use touchline_core::geometry::ImageSize;
    use touchline_core::progress::Progress;
    use touchline_core::testing::TestBase;
    use touchline_vision::features::{FeatureOptions, Features, burnt_in, extract};
    use touchline_vision::media::Picture;
    use touchline_vision::relocalize::{
        Forest, NotFound, Pose, RelocalizeOptions, Samples, SeenRange, TrainOptions, relocalize,
        train,
    };
    use touchline_vision::synthetic::{
        FrameOptions, Graphics, Preset, Stadium, StadiumOptions, stadium,
    };

    const SIZE: ImageSize = ImageSize::new(640, 360);
    const ALL: Graphics = Graphics {
        score_bug: true,
        lower_third: true,
        watermark: true,
        ..Graphics::NONE
    };

    struct Match {
        scene: Stadium,
        base: CameraBase,
    }

    impl Match {
        fn new() -> Self {
            let template = builtin("soccer").unwrap();
            let field = template.model(&template.default_params(), 0.0).unwrap();
            let scene = stadium(&StadiumOptions::new(field, 7));
            Self {
                scene,
                base: Preset::Easy.shoot().main_camera(SIZE),
            }
        }

        fn camera(&self, pan_deg: f64) -> PtzCamera {
            self.base.aim(pan_deg, -11.0, 1100.0)
        }

        fn features(&self, pan_deg: f64, time_s: f64, graphics: Graphics) -> Features {
            let options = FrameOptions {
                time_s,
                graphics,
                ..FrameOptions::default()
            };
            let drawn = self
                .scene
                .render(&self.camera(pan_deg), SIZE, &options)
                .image;
            let rgba: Vec<u8> = drawn
                .pixels()
                .flat_map(|pixel| [pixel[0], pixel[1], pixel[2], 255])
                .collect();
            extract(
                &Picture::new(SIZE, rgba).unwrap(),
                &[],
                &FeatureOptions::default(),
            )
            .unwrap()
        }

        /// A forest of references with all graphics; what is burnt in is used only if
        /// `with_graphics`.
        fn forest(&self, pans_deg: &[f64], with_graphics: bool) -> (Forest, SeenRange) {
            let cameras: Vec<PtzCamera> = pans_deg
                .iter()
                .map(|&pan_deg| self.camera(pan_deg))
                .collect();
            let pictures: Vec<Features> = (0_u8..)
                .zip(pans_deg)
                .map(|(i, &pan_deg)| self.features(pan_deg, 3.0 * f64::from(i), ALL))
                .collect();
            let mut burnt =
                burnt_in(&pictures.iter().collect::<Vec<_>>(), &|_, _, _| true).features;
            if with_graphics {
                burnt.iter_mut().for_each(Vec::clear);
            }
            let mut samples = Samples::new();
            for ((camera, features), burnt) in cameras.iter().zip(&pictures).zip(&burnt) {
                let taught = (0..features.len()).filter(|feature| !burnt.contains(feature));
                samples.add_frame(taught.map(|feature| {
                    let ray = camera
                        .ray_from_image(features.keypoints[feature].point)
                        .unwrap();
                    (features.descriptors[feature], ray)
                }));
            }
            let seen =
                SeenRange::from_cameras(&cameras.iter().map(PtzCamera::ptz).collect::<Vec<_>>())
                    .unwrap();
            (
                train(&samples, &TrainOptions::default(), &Progress::default()).unwrap(),
                seen,
            )
        }

        fn answer(
            &self,
            request: &Features,
            (forest, seen): (&Forest, &SeenRange),
        ) -> Result<Pose, NotFound> {
            relocalize(
                request,
                forest,
                seen,
                &self.base,
                &RelocalizeOptions::default(),
            )
            .pose
        }
    }

    fn off_deg(pose: &Pose, pan_deg: f64) -> f64 {
        (pose.ptz.pan.degrees() - pan_deg).abs()
    }

    #[test]
    fn a_graphic_in_one_reference_is_no_answer_elsewhere() {
        let game = Match::new();
        let (forest, seen) = game.forest(&[-14.0], true);
        let elsewhere = game.features(30.0, 20.0, ALL);
        // The case is real: by its features alone the picture is sure to be the reference's.
        let unchecked = SeenRange {
            cameras: Vec::new(),
            ..seen.clone()
        };
        let deceived = game
            .answer(&elsewhere, (&forest, &unchecked))
            .expect("the graphics agree with each other");
        assert!(
            off_deg(&deceived, -14.0) < 0.1 && deceived.confidence > 0.9,
            "{deceived:?}"
        );
        let error = game.answer(&elsewhere, (&forest, &seen)).unwrap_err();
        assert!(matches!(error, NotFound::StandsStill { .. }), "{error}");
        // Where the stadium can be seen it answers, however many features stand still.
        for pan_deg in [-18.0, -10.0] {
            let found = game
                .answer(&game.features(pan_deg, 9.0, ALL), (&forest, &seen))
                .unwrap();
            assert!(off_deg(&found, pan_deg) < 0.05, "{pan_deg}: {found:?}");
        }
        // The camera did not move: everything stands still, and nothing is dropped.
        let found = game
            .answer(&game.features(-14.0, 9.0, ALL), (&forest, &seen))
            .unwrap();
        assert!(off_deg(&found, -14.0) < 0.02, "{found:?}");
    }

    #[test]
    fn a_graphic_in_two_references_is_not_trained_on() {
        let game = Match::new();
        let (taught, seen) = game.forest(&[-16.0, 4.0], false);
        let elsewhere = game.features(36.0, 20.0, ALL);
        let unchecked = SeenRange {
            cameras: Vec::new(),
            ..seen.clone()
        };
        assert!(
            game.answer(&elsewhere, (&taught, &unchecked)).is_err(),
            "nothing that stands still was learnt"
        );
        for pan_deg in [-20.0, -12.0, 1.0, 8.0] {
            let found = game
                .answer(&game.features(pan_deg, 9.0, ALL), (&taught, &seen))
                .unwrap();
            assert!(off_deg(&found, pan_deg) < 0.05, "{pan_deg}: {found:?}");
        }
    }
}

/// Videos that are drawn frame by frame on request: what is found by itself, and from which
/// frame to which.
#[cfg(feature = "opencv")]
mod videos {
    use std::cell::Cell;
    use std::path::Path;
    use touchline_calibration::proposals::{FeatureStore, FoundMask, FramePictures, find_burnt_in};
    use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
    use touchline_core::field::builtin;
    use touchline_core::geometry::{ImageSize, PixelBox};
    use touchline_core::progress::Progress;
    use touchline_documents::document::{Document, Frame, VideoFrame, document_from_bytes};
    use touchline_vision::features::FeatureOptions;
    use touchline_vision::media::{FrameRef, MediaError, Picture, ReadFrames};
    use touchline_vision::synthetic::{
        FrameOptions, Graphics, PathStep, Preset, ShootOptions, Stadium, StadiumOptions,
        camera_path, stadium,
    };

    const SIZE: ImageSize = ImageSize::new(480, 270);
    const FRAMES: usize = 400;
    const FRAMES_PER_S: f64 = 12.5;
    const BUG: Graphics = Graphics {
        score_bug: true,
        ..Graphics::NONE
    };

    struct DrawnVideo {
        scene: Stadium,
        base: CameraBase,
        path: Vec<PathStep>,
        graphics: Graphics,
        /// How many pictures were requested.
        read: Cell<usize>,
    }

    impl DrawnVideo {
        fn new(seed: u64, preset: Preset, graphics: Graphics) -> Self {
            let template = builtin("soccer").unwrap();
            let field = template.model(&template.default_params(), 0.0).unwrap();
            let shoot = ShootOptions {
                step_s: 1.0 / FRAMES_PER_S,
                ..preset.shoot()
            };
            let scene = stadium(&StadiumOptions {
                daylight: shoot.daylight,
                ..StadiumOptions::new(field, seed)
            });
            let base = shoot.main_camera(SIZE);
            let path = camera_path(&scene, &base, SIZE, &shoot, FRAMES);
            Self {
                scene,
                base,
                path,
                graphics,
                read: Cell::new(0),
            }
        }

        /// Makes it one of a few frames in which the camera rotates by this much in all.
        fn turn_slowly(&mut self, frames: usize, [pan_deg, tilt_deg]: [f64; 2], focal_px: f64) {
            let start = self.path[0].ptz;
            self.path.truncate(frames);
            for (index, step) in self.path.iter_mut().enumerate() {
                let share = index as f64 / (frames - 1) as f64;
                let (pan, tilt) = (
                    start.pan.degrees() + share * pan_deg,
                    start.tilt.degrees() + share * tilt_deg,
                );
                step.ptz = Ptz::from_degrees(pan, tilt, focal_px);
            }
        }

        fn find_masks(&mut self) -> Vec<FoundMask> {
            let mut document: Document = document_from_bytes(
                br#"{"format": "touchline", "version": 1, "field": {"template": "soccer", "params": {}}, "frames": [],
                    "cameras": [{"id": "main", "image_size_px": [480, 270], "principal_point_px": [240, 135]}]}"#,
            )
            .unwrap();
            let camera = document.cameras[0].id.clone();
            for index in 0..self.path.len() as u64 {
                let video = VideoFrame::new("match.mp4", index, Some(index as f64 / FRAMES_PER_S));
                document
                    .frames
                    .push(Frame::from_video(video, camera.clone(), SIZE).into());
            }
            let store = FeatureStore::in_memory();
            let folder = Path::new("nowhere");
            let pictures = FramePictures {
                document: &document,
                folder,
                options: FeatureOptions::default(),
                store: &store,
            };
            find_burnt_in(&pictures, self, &Progress::default()).unwrap()
        }
    }

    impl ReadFrames for DrawnVideo {
        fn read(&mut self, frame: &FrameRef) -> Result<Picture, MediaError> {
            let FrameRef::Video { index, .. } = frame else {
                panic!("{frame} is of no video")
            };
            self.read.set(self.read.get() + 1);
            let step = &self.path[*index];
            let options = FrameOptions {
                time_s: step.time_s,
                graphics: self.graphics,
                ..FrameOptions::default()
            };
            let drawn = self
                .scene
                .render(&PtzCamera::new(self.base, step.ptz), SIZE, &options)
                .image;
            let rgba: Vec<u8> = drawn
                .pixels()
                .flat_map(|pixel| [pixel[0], pixel[1], pixel[2], 255])
                .collect();
            Ok(Picture::new(SIZE, rgba).unwrap())
        }
    }

    /// The share of a box that another covers.
    fn covered_share(of: &PixelBox, by: &PixelBox) -> f64 {
        let along = |a: f64, a_length: f64, b: f64, b_length: f64| {
            ((a + a_length).min(b + b_length) - a.max(b)).max(0.0)
        };
        along(of.x, of.width, by.x, by.width) * along(of.y, of.height, by.y, by.height)
            / (of.width * of.height)
    }

    #[test]
    fn a_banner_for_a_while_and_a_faint_watermark_are_found() {
        let at_s = |frame: f64| frame / FRAMES_PER_S;
        let graphics = Graphics {
            watermark: true,
            watermark_share: 0.15,
            ticker_s: Some([at_s(100.0), at_s(200.0)]),
            ..BUG
        };
        let mut video = DrawnVideo::new(5, Preset::Paper, graphics);
        let found = video.find_masks();
        let truth = graphics.boxes(SIZE, at_s(150.0));
        let masks: Vec<PixelBox> = found.iter().map(|found| found.mask.pixel_box).collect();
        for mask in &masks {
            assert!(
                truth.iter().any(|of| covered_share(mask, of) >= 0.5),
                "{mask:?} is no graphic"
            );
        }
        let of = |truth: PixelBox| {
            found
                .iter()
                .filter(move |found| covered_share(&found.mask.pixel_box, &truth) >= 0.5)
        };
        for (&truth, ranged) in truth.iter().zip([false, false, true]) {
            let covered: f64 = of(truth)
                .map(|mask| covered_share(&truth, &mask.mask.pixel_box))
                .sum();
            // Of a banner that few views show only what stands is found: its text moves.
            let least = if ranged { 0.25 } else { 0.6 };
            assert!(covered > least, "{covered} of {truth:?} in {found:?}");
            assert!(
                of(truth)
                    .all(|mask| (mask.mask.from.is_some() && mask.mask.to.is_some()) == ranged),
                "{found:?}"
            );
        }
        // Half a second to slide in, and out.
        let banner = of(truth[2]).next().unwrap();
        let (from, to) = (banner.mask.from.unwrap(), banner.mask.to.unwrap());
        assert!(
            (100..=107).contains(&from) && (193..=200).contains(&to),
            "{from} to {to}"
        );
        assert!(
            video.read.get() < 85,
            "{} pictures were read",
            video.read.get()
        );
    }

    #[test]
    fn a_camera_that_stands_nearly_still_tells_nothing() {
        // Drawing takes the time: without a graphic only where the camera moves least.
        for (turn_deg, focal_px, graphics) in [
            ([1.0, 0.0], 425.0, &[Graphics::NONE, BUG][..]),
            ([0.0, 1.0], 500.0, &[BUG]),
            ([2.0, 0.3], 500.0, &[BUG]),
        ] {
            for &graphics in graphics {
                let mut video = DrawnVideo::new(1, Preset::Paper, graphics);
                video.turn_slowly(30, turn_deg, focal_px);
                for found in video.find_masks() {
                    let truth = graphics.boxes(SIZE, 0.0);
                    let is_one = truth
                        .iter()
                        .any(|of| covered_share(&found.mask.pixel_box, of) >= 0.5);
                    assert!(is_one, "{turn_deg:?}°: {found:?} is no graphic");
                }
            }
        }
    }

    #[test]
    fn nothing_is_found_where_nothing_is_burnt_in() {
        assert_eq!(
            DrawnVideo::new(9, Preset::Hard, Graphics::NONE).find_masks(),
            []
        );
    }
}
