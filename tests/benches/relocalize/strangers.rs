//! Matches that nobody has tuned the program on: drawn at night, in the rain of a coarse codec, with worn paint, on small fields,
//! from behind a goal, the far side or the roof, with graphics over them; labelled by three to six frames of a few clicks, no mask
//! drawn, base and forest as the program makes them. The truth is exact.

use super::set::quantile;
use image::codecs::jpeg::JpegEncoder;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use touchline::calibrate::{BaseProblem, solve_document};
use touchline::camera::{BaseAngles, CameraBase, FocalCurve, PtzCamera};
use touchline::document::{Camera, CameraId, Click, Document, FieldSpec, Frame, FrameStatus, Target};
use touchline::features::FeatureOptions;
use touchline::field::{FieldModel, builtin};
use touchline::geometry::{Angle, ImageSize, PixelBox, Vec3};
use touchline::media::FrameReader;
use touchline::proposals::{
    Answer, FeatureStore, FramePictures, LearnOptions, LineEvidence, Proposal, TrainingFrames, find_burnt_in, learn,
    measure, overlay_error_px, propose, study,
};
use touchline::relocalize::RelocalizeOptions;
use touchline::solve::Uncertainty;
use touchline::solve::base::BaseOptions;
use touchline::synthetic::{
    ClickOptions, ClickTarget, Daylight, FrameOptions, Graphics, Preset, ShootOptions, StadiumOptions, camera_path,
    drawn_clicks, stadium,
};

const SIZE: ImageSize = ImageSize::new(960, 540);

/// Frames asked of each match.
const ASKED: usize = 12;

/// χ² with two degrees of freedom of a 68 % region.
const REGION: f64 = 2.28;

/// A match.
struct Stranger {
    name: &'static str,
    seed: u64,
    references: usize,
    /// Where the camera stands, m, and its heading, degrees.
    position_m: [f64; 3],
    heading_deg: f64,
    field_m: [f64; 2],
    attendance: f64,
    paint_left: f64,
    graphics: Graphics,
    shoot: ShootOptions,
}

const MAIN: Stranger = Stranger {
    name: "",
    seed: 0,
    references: 4,
    position_m: [1.5, -66.0, 18.0],
    heading_deg: 0.0,
    field_m: [105.0, 68.0],
    attendance: 0.93,
    paint_left: 1.0,
    graphics: Graphics::NONE,
    shoot: Preset::Paper.shoot(),
};

const BUG: Graphics = Graphics { score_bug: true, ..Graphics::NONE };
const ALL: Graphics = Graphics { score_bug: true, lower_third: true, watermark: true, ..Graphics::NONE };
const PAPER: ShootOptions = Preset::Paper.shoot();
const HARD: ShootOptions = Preset::Hard.shoot();
const NIGHT: ShootOptions = ShootOptions { daylight: Daylight::Floodlit, noise_levels: 4.0, jpeg_quality: 70, ..PAPER };
const WIDE: ShootOptions = ShootOptions { focal_px_at_1280: [800.0, 1800.0], ..PAPER };
const LONG: ShootOptions = ShootOptions { focal_px_at_1280: [2600.0, 6000.0], ..PAPER };
const BARREL: ShootOptions = ShootOptions {
    distortion_at_1280: FocalCurve { at_focal_px: 1333.0, value: -0.1, per_1000_px: 0.1, ..FocalCurve::NONE },
    ..PAPER
};
const PINCUSHION: ShootOptions = ShootOptions {
    distortion_at_1280: FocalCurve { at_focal_px: 1333.0, value: 0.06, per_1000_px: 0.05, ..FocalCurve::NONE },
    ..PAPER
};

fn strangers() -> Vec<Stranger> {
    vec![
        Stranger { name: "night", seed: 101, shoot: NIGHT, graphics: BUG, ..MAIN },
        Stranger { name: "night, three references", seed: 102, references: 3, shoot: NIGHT, ..MAIN },
        Stranger { name: "night from the roof", seed: 103, position_m: [-8.0, -72.0, 38.0], shoot: NIGHT, ..MAIN },
        Stranger { name: "worn paint", seed: 104, paint_left: 0.35, references: 5, ..MAIN },
        Stranger { name: "paint nearly gone", seed: 105, paint_left: 0.12, ..MAIN },
        Stranger { name: "worn paint, low sun", seed: 106, paint_left: 0.4, shoot: HARD, references: 6, ..MAIN },
        Stranger { name: "small field", seed: 107, field_m: [90.0, 50.0], ..MAIN },
        Stranger { name: "large field", seed: 108, field_m: [115.0, 75.0], references: 5, ..MAIN },
        Stranger { name: "all graphics", seed: 109, graphics: ALL, ..MAIN },
        Stranger { name: "all graphics, three references", seed: 110, graphics: ALL, references: 3, ..MAIN },
        Stranger { name: "empty stands", seed: 111, attendance: 0.0, ..MAIN },
        Stranger {
            name: "empty stands, two thirds of the paint",
            seed: 112,
            attendance: 0.05,
            paint_left: 0.6,
            ..MAIN
        },
        Stranger {
            name: "the far side",
            seed: 113,
            position_m: [4.0, 64.0, 17.0],
            heading_deg: 180.0,
            references: 5,
            ..MAIN
        },
        Stranger {
            name: "the far side at night",
            seed: 114,
            position_m: [-12.0, 70.0, 24.0],
            heading_deg: 180.0,
            shoot: NIGHT,
            ..MAIN
        },
        Stranger {
            name: "behind the left goal",
            seed: 115,
            position_m: [-88.0, 2.0, 20.0],
            heading_deg: 90.0,
            references: 5,
            ..MAIN
        },
        Stranger {
            name: "behind the right goal, low",
            seed: 116,
            position_m: [82.0, -5.0, 11.0],
            heading_deg: -90.0,
            references: 6,
            ..MAIN
        },
        Stranger { name: "a corner", seed: 117, position_m: [-60.0, -52.0, 16.0], heading_deg: 45.0, ..MAIN },
        Stranger { name: "low by the halfway line", seed: 118, position_m: [0.0, -58.0, 8.0], ..MAIN },
        Stranger { name: "wide lens", seed: 119, shoot: WIDE, ..MAIN },
        Stranger { name: "long lens", seed: 120, shoot: LONG, references: 6, ..MAIN },
        Stranger { name: "barrel", seed: 121, shoot: BARREL, ..MAIN },
        Stranger { name: "pincushion, three references", seed: 122, shoot: PINCUSHION, references: 3, ..MAIN },
        Stranger { name: "the hardest: low sun, blur, graphics", seed: 123, shoot: HARD, graphics: ALL, ..MAIN },
        Stranger {
            name: "the 16 m line: three references, far left",
            seed: 124,
            position_m: [-30.0, -60.0, 14.0],
            references: 3,
            ..MAIN
        },
    ]
}

/// What came of a match.
#[derive(Default)]
struct Outcome {
    asked: usize,
    answered: usize,
    /// Of each answer: the stated confidence, the median error at landmarks in view and the greatest error of the
    /// overlay, px at 1920 px width.
    answers: Vec<[f64; 3]>,
    /// Of each landmark in view: χ² by the stated covariance.
    chi_squared: Vec<f64>,
    /// Graphics that were found, all, and boxes that are none.
    graphics: [usize; 2],
    false_masks: usize,
}

impl Outcome {
    fn add(&mut self, other: Self) {
        self.asked += other.asked;
        self.answered += other.answered;
        self.answers.extend(other.answers);
        self.chi_squared.extend(other.chi_squared);
        self.graphics = [0, 1].map(|at| self.graphics[at] + other.graphics[at]);
        self.false_masks += other.false_masks;
    }

    fn row(&self, name: &str, note: &str) {
        let count = |stated: f64, off_px: f64| {
            self.answers.iter().filter(|[confidence, error, _]| *confidence >= stated && *error > off_px).count()
        };
        let certain = self.answers.iter().filter(|[confidence, ..]| *confidence >= 0.95).count();
        let near = self.answers.iter().filter(|[_, error, _]| *error <= 10.0).count();
        let held = self.chi_squared.iter().filter(|chi_squared| **chi_squared <= REGION).count();
        let rms = (self.chi_squared.iter().map(|chi_squared| chi_squared.min(25.0)).sum::<f64>()
            / (2.0 * self.chi_squared.len() as f64))
            .sqrt();
        println!(
            "| {name} | {} | {} | {near} | {} of {certain} | {} | {:.1} | {:.0} %, {rms:.2} | {} of {}, {} |{note}",
            self.asked,
            self.answered,
            count(0.95, 10.0),
            count(0.5, 20.0),
            quantile(&mut self.answers.iter().map(|answer| answer[1]).collect::<Vec<_>>(), 0.5),
            100.0 * held as f64 / self.chi_squared.len().max(1) as f64,
            self.graphics[0],
            self.graphics[1],
            self.false_masks,
        );
    }
}

/// All matches, one after the other; `only` leaves all out but those whose name holds it.
pub fn strangers_footage(only: Option<&str>) {
    println!("\n## strangers: drawn matches that nothing was tuned on, three to six references, no mask\n");
    println!(
        "| match | asked | answered | within 10 px | ≥ .95 and > 10 px | ≥ .5 and > 20 px | median px | 68 % regions hold, rms z | \
         graphics found, false masks |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut all = Outcome::default();
    for stranger in strangers().into_iter().filter(|of| only.is_none_or(|only| of.name.contains(only))) {
        let drawn = Drawn::new(&stranger);
        let (outcome, note) = drawn.asked();
        outcome.row(stranger.name, &note);
        all.add(outcome);
    }
    all.row("**all**", "");
}

/// A drawn match as a document, and its truth.
struct Drawn {
    folder: PathBuf,
    document: Document,
    field: FieldModel,
    cameras: Vec<PtzCamera>,
    graphics: Vec<PixelBox>,
}

impl Drawn {
    fn new(of: &Stranger) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("strangers").join(of.seed.to_string());
        fs::create_dir_all(&folder).unwrap();
        let mut spec = FieldSpec::new("soccer");
        spec.params.insert("length_m".to_owned(), of.field_m[0]);
        spec.params.insert("width_m".to_owned(), of.field_m[1]);
        let template = builtin("soccer").unwrap();
        let mut params = template.default_params();
        params.extend(spec.params.clone());
        let field = template.model(&params, 0.0).unwrap();
        let options = StadiumOptions {
            daylight: of.shoot.daylight,
            attendance: of.attendance,
            paint_left: of.paint_left,
            ..StadiumOptions::new(field.clone(), of.seed)
        };
        let scene = stadium(&options);
        let angles = BaseAngles { heading: Angle::from_degrees(of.heading_deg), ..BaseAngles::default() };
        let position_m = Vec3::new(of.position_m[0], of.position_m[1], of.position_m[2]);
        let base = CameraBase {
            distortion: of.shoot.main_camera(SIZE).distortion,
            ..CameraBase::new(position_m, angles.base_from_world(), SIZE.centre())
        };
        let shoot = ShootOptions { step_s: 2.3, ..of.shoot };
        let count = ASKED + of.references;
        let mut document = Document::new(spec);
        document.cameras.push(Camera::new(CameraId::from("main"), SIZE).into());
        let mut cameras = Vec::new();
        for (index, step) in camera_path(&scene, &base, SIZE, &shoot, count).iter().enumerate() {
            let camera = PtzCamera::new(base, step.ptz);
            let frame_options = FrameOptions { graphics: of.graphics, ..shoot.frame(index, step, SIZE, of.seed) };
            let drawn = scene.render(&camera, SIZE, &frame_options);
            let mut bytes = Vec::new();
            JpegEncoder::new_with_quality(&mut bytes, shoot.jpeg_quality).encode_image(&drawn.image).unwrap();
            let name = format!("{index:02}.jpg");
            fs::write(folder.join(&name), bytes).unwrap();
            let mut frame = Frame::from_image(&name, CameraId::from("main"), SIZE);
            let is_reference = (index * of.references) / count != ((index + 1) * of.references) / count;
            if is_reference {
                let hidden: Vec<PixelBox> =
                    drawn.movers.iter().map(|mover| mover.area).chain(drawn.graphics.iter().copied()).collect();
                let clicking =
                    ClickOptions { landmarks: 4 + index % 3, lines: 1, sigma_px: 1.0, seed: of.seed + index as u64 };
                frame.clicks = drawn_clicks(&field, &camera, SIZE, &hidden, &clicking)
                    .into_iter()
                    .map(|click| match click.target {
                        ClickTarget::Landmark(id) => Click::new(Target::Landmark(id), click.image),
                        ClickTarget::Line(id) => Click::new(Target::Line(id), click.image),
                    })
                    .collect();
                frame.status = FrameStatus::Reference;
            }
            document.frames.push(frame.into());
            cameras.push(camera);
        }
        Self { folder, document, field, cameras, graphics: of.graphics.boxes(SIZE, 0.0) }
    }

    /// What the program makes of it, and a remark.
    fn asked(mut self) -> (Outcome, String) {
        let asked: Vec<usize> = (0..self.document.frames.len())
            .filter(|&index| self.document.frames[index].status != FrameStatus::Reference)
            .collect();
        let mut outcome = Outcome { asked: asked.len(), ..Outcome::default() };
        outcome.graphics[1] = self.graphics.len();
        let camera = self.document.cameras[0].id.clone();
        let estimate =
            BaseProblem::of(self.document.at(&self.folder), &camera).map_err(|error| error.to_string()).and_then(
                |problem| problem.estimate(&self.document, &BaseOptions::default()).map_err(|error| error.to_string()),
            );
        let estimate = match estimate {
            Ok(estimate) => estimate,
            Err(error) => return (outcome, format!(" no base: {error}")),
        };
        estimate.write_camera(&mut self.document);
        solve_document(&mut self.document, &self.folder, &|| ()).unwrap();
        let store = FeatureStore::in_memory();
        let options = FeatureOptions::default();
        let going_on = || ControlFlow::Continue(());
        let mut reader = FrameReader::new();
        let pictures = FramePictures { document: &self.document, folder: &self.folder, options, store: &store };
        let masks = find_burnt_in(&pictures, &mut reader, &going_on).unwrap();
        for truth in &self.graphics {
            outcome.graphics[0] += usize::from(masks.iter().any(|mask| truth.contains(mask.mask.pixel_box.centre())));
        }
        let is_false = |found: &PixelBox| !self.graphics.iter().any(|truth| truth.contains(found.centre()));
        outcome.false_masks = masks.iter().filter(|mask| is_false(&mask.mask.pixel_box)).count();
        // As the question in the window is answered: kept.
        for mask in masks {
            self.document.camera_mut(&camera).unwrap().ranged_masks.push(mask.mask);
        }
        let pictures = FramePictures { document: &self.document, folder: &self.folder, options, store: &store };
        let training = TrainingFrames::of_solved(&self.document).frames;
        let studied = study(&pictures, &mut reader, &training, &going_on).unwrap();
        let learning = LearnOptions::default();
        let Ok(mut model) = learn(&self.document, &studied, &learning, &|_| going_on()) else {
            return (outcome, " nothing learnt".to_owned());
        };
        let relocalizing = RelocalizeOptions::default();
        if let Some(quality) = measure(&pictures, &mut reader, &training, &learning, &relocalizing, &|_, _| going_on())
        {
            quality.bound(&self.document, &mut model);
        }
        let proposals = pictures.each(&mut reader, &asked, |index, _, found| {
            ControlFlow::Continue(propose(&self.document, index, found, (&model, 0), &relocalizing))
        });
        let mut proposals: Vec<Proposal> = proposals.unwrap();
        let at = self.document.at(&self.folder);
        let evidence = LineEvidence::of(at, &mut reader, false).unwrap();
        evidence.judge(at, &mut reader, &mut proposals, relocalizing.pose.min_confidence);
        let mut note = format!(" {}", estimate.model);
        for (&index, proposal) in asked.iter().zip(&proposals) {
            let Ok(answer) = &proposal.outcome else { continue };
            outcome.answered += 1;
            let [error_px, worst_px] = self.against_truth(index, answer, &mut outcome.chi_squared);
            outcome.answers.push([answer.confidence, error_px, worst_px]);
            if error_px > 10.0 {
                note.push_str(&format!("; frame {index} {error_px:.1} px, stated {:.3}", answer.confidence));
            }
        }
        (outcome, note)
    }

    /// The median error at landmarks in view and the greatest of the overlay, px at 1920 px width; χ² of each landmark.
    fn against_truth(&self, index: usize, answer: &Answer, chi_squared: &mut Vec<f64>) -> [f64; 2] {
        let truth = &self.cameras[index];
        let frame = &self.document.frames[index];
        let base = self.document.camera_of(frame).unwrap().base_for(frame).unwrap();
        let camera = PtzCamera::new(base, answer.ptz.ptz());
        let stated = Uncertainty::of_stored(&camera, &answer.covariance, SIZE);
        let mut errors = Vec::new();
        for landmark in &self.field.landmarks {
            let at = self.field.landmark_in_world(landmark);
            let (Ok(seen), Ok(found)) = (truth.image_from_world(at), camera.image_from_world(at)) else { continue };
            if !SIZE.contains(seen) {
                continue;
            }
            let off = seen.offset_from(found);
            errors.push(off.norm() / SIZE.scale_from_1920());
            let covariance = stated.and_then(|stated| stated.overlay_at_world(&camera, at));
            chi_squared.extend(covariance.and_then(|covariance| Some(off.dot(&(covariance.try_inverse()? * off)))));
        }
        let worst_px = overlay_error_px(truth, &camera, SIZE);
        let error_px = if errors.is_empty() { worst_px } else { quantile(&mut errors, 0.5) };
        [error_px, worst_px]
    }
}
