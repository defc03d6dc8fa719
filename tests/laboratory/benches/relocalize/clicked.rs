//! Drawn matches whose references a person clicked: what the references' own errors do to the
//! answers, and whether these state it.

use super::proposed::propose_all;
use super::set::quantile;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use touchline::calibrate::{FrameLookup, calibrate};
use touchline::camera::PtzCamera;
use touchline::document::{
    Camera, CameraId, Click, Document, FieldSpec, Frame, FrameStatus, Target,
};
use touchline::features::FeatureOptions;
use touchline::field::FieldModel;
use touchline::geometry::{ImageSize, PixelBox, Vec3};
use touchline::media::FrameReader;
use touchline::proposals::{FeatureStore, FramePictures, LineEvidence, overlay_error_px};
use touchline::score::{SigmaCoverage, squared_mahalanobis};
use touchline::synthetic::{ClickOptions, ClickTarget, Preset, ShootOptions, StadiumOptions};
use touchline::synthetic::{camera_path, generate_clicks, stadium};

const SIZE: ImageSize = ImageSize::new(1280, 720);

/// Frames of a match, and how long after each other, s.
const FRAMES: usize = 160;
const STEP_S: f64 = 0.2;

/// One frame in so many is a reference.
const REFERENCE_EVERY: usize = 10;

/// One frame in so many of the others is asked for.
const ASKED_EVERY: usize = 3;

/// An answer is wrong whose worst corner is off by more, px at 1920 px width.
const WRONG_PX: f64 = 10.0;

/// The 1-σ of a click that a document takes for granted, px at 1280 px width.
const SUPPOSED_PX: f64 = 2.0 * 1280.0 / 1920.0;

/// A drawn match: the base is exact, no frame has a camera.
struct Drawn {
    document: Document,
    field: FieldModel,
    folder: PathBuf,
    truth: Vec<PtzCamera>,
    hidden: Vec<Vec<PixelBox>>,
    store: FeatureStore,
}

impl Drawn {
    fn of(seed: u64) -> Self {
        let spec = FieldSpec::new("soccer");
        let field = spec.model(Path::new("")).unwrap();
        let shoot = ShootOptions {
            step_s: STEP_S,
            ..Preset::Hard.shoot()
        };
        let scene = stadium(&StadiumOptions {
            daylight: shoot.daylight,
            ..StadiumOptions::new(field.clone(), seed)
        });
        let base = shoot.main_camera(SIZE);
        let path = camera_path(&scene, &base, SIZE, &shoot, FRAMES);
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("clicked-{seed}"));
        std::fs::create_dir_all(&folder).unwrap();
        let name = |number: usize| format!("{number:04}.png");
        let hidden = path.par_iter().enumerate().map(|(number, step)| {
            let drawn = scene.render(
                &PtzCamera::new(base, step.ptz),
                SIZE,
                &shoot.frame(number, step, SIZE, seed),
            );
            drawn.image.save(folder.join(name(number))).unwrap();
            drawn
                .movers
                .iter()
                .map(|mover| mover.area)
                .chain(drawn.graphics.iter().copied())
                .collect()
        });
        let hidden = hidden.collect();
        let mut document = Document::new(spec);
        let mut camera = Camera::new(CameraId::from("main"), SIZE);
        camera.set_base(&base);
        document.cameras.push(camera.into());
        let frame = |number| Frame::from_image(&name(number), CameraId::from("main"), SIZE).into();
        document.frames.extend((0..FRAMES).map(frame));
        let truth = path
            .iter()
            .map(|step| PtzCamera::new(base, step.ptz))
            .collect();
        Self {
            document,
            field,
            folder,
            truth,
            hidden,
            store: FeatureStore::in_memory(),
        }
    }

    /// With references of four clicks each, off by so much (1-σ, px).
    fn label_references(&self, sigma_px: f64) -> (Document, Vec<usize>) {
        let mut document = self.document.clone();
        let mut references = Vec::new();
        for number in (0..FRAMES).step_by(REFERENCE_EVERY) {
            let options = ClickOptions {
                landmarks: 4,
                lines: 0,
                sigma_px,
                seed: number as u64,
            };
            let clicks = generate_clicks(
                &self.field,
                &self.truth[number],
                SIZE,
                &self.hidden[number],
                &options,
            );
            let mut frame = Frame::clone(&document.frames[number]);
            frame.clicks = clicks
                .into_iter()
                .map(|click| match click.target {
                    ClickTarget::Landmark(id) => Click::new(Target::Landmark(id), click.image),
                    ClickTarget::Line(id) => Click::new(Target::Line(id), click.image),
                })
                .collect();
            if frame.clicks.len() < 3 {
                continue;
            }
            let Ok(solved) = calibrate(
                &document,
                &FrameLookup::default(),
                &frame,
                &self.field,
                number,
            ) else {
                continue;
            };
            frame.record(&solved);
            frame.status = FrameStatus::Reference;
            *document.frames[number] = frame;
            references.push(number);
        }
        (document, references)
    }
}

/// What came of the answers about a match.
#[derive(Default)]
struct Outcome {
    references: usize,
    asked: usize,
    answered: usize,
    wrong: usize,
    certain: usize,
    certain_and_wrong: usize,
    errors_px: Vec<f64>,
    stated_px: Vec<f64>,
    squared_sigmas: Vec<f64>,
    labels: Vec<f64>,
}

fn outcome_of(drawn: &Drawn, sigma_px: f64) -> Outcome {
    let (document, references) = drawn.label_references(sigma_px);
    let options = FeatureOptions::default();
    let pictures = FramePictures {
        document: &document,
        folder: &drawn.folder,
        options,
        store: &drawn.store,
    };
    let mut reader = FrameReader::new();
    let others = (0..FRAMES).filter(|number| document.frames[*number].is_open());
    let others: Vec<usize> = others.step_by(ASKED_EVERY).collect();
    let evidence =
        LineEvidence::from_document(document.at(&drawn.folder), &mut reader, false).unwrap();
    let proposals = propose_all(&pictures, &mut reader, &evidence, &references, &others).unwrap();
    let mut outcome = Outcome {
        references: references.len(),
        asked: others.len(),
        ..Outcome::default()
    };
    let off = |ptz: touchline::camera::Ptz, number: usize| {
        let truth = drawn.truth[number].ptz();
        Vec3::new(
            ptz.pan.turn_from(truth.pan).degrees(),
            (ptz.tilt - truth.tilt).degrees(),
            ptz.focal_px - truth.focal_px,
        )
    };
    for &number in &references {
        let frame = &document.frames[number];
        let covariance = frame.solution.as_ref().unwrap().covariance.unwrap();
        outcome.labels.extend(squared_mahalanobis(
            off(frame.ptz.as_ref().unwrap().ptz(), number),
            &covariance,
        ));
    }
    for proposal in proposals {
        let number = document.frames.position_of(&proposal.frame).unwrap();
        let Ok(answer) = proposal.outcome else {
            continue;
        };
        let camera = PtzCamera::new(*drawn.truth[number].base(), answer.ptz.ptz());
        let error_px = overlay_error_px(&drawn.truth[number], &camera, SIZE);
        let is_wrong = error_px > WRONG_PX;
        outcome.answered += 1;
        outcome.wrong += usize::from(is_wrong);
        outcome.certain += usize::from(answer.confidence >= 0.95);
        outcome.certain_and_wrong += usize::from(answer.confidence >= 0.95 && is_wrong);
        outcome.errors_px.push(error_px);
        outcome.stated_px.push(answer.worst_corner_sigma_px);
        outcome.squared_sigmas.extend(squared_mahalanobis(
            off(camera.ptz(), number),
            &answer.covariance,
        ));
    }
    outcome
}

/// Each match from references whose clicks are exact, as good as supposed, and worse.
pub fn accuracy() {
    println!("\n## clicked: drawn matches from references of four clicks\n");
    println!(
        "| clicks off by, of what is supposed | match | references | their error over σ | answered | wrong | at .95 or more | wrong of \
         these | off, median px | stated | 68 % regions hold | error over σ |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    for seed in 1..=5 {
        let drawn = Drawn::of(seed);
        for share in [0.0, 1.0, 1.5, 2.0] {
            let mut outcome = outcome_of(&drawn, share * SUPPOSED_PX);
            let coverage = SigmaCoverage::from_squared_distances(&outcome.squared_sigmas).unwrap();
            println!(
                "| {share} | {seed} | {} | {:.2} | {} of {} | {} | {} | {} | {:.2} | {:.2} | {:.0} % | {:.2} |",
                outcome.references,
                SigmaCoverage::from_squared_distances(&outcome.labels)
                    .unwrap()
                    .error_over_sigma,
                outcome.answered,
                outcome.asked,
                outcome.wrong,
                outcome.certain,
                outcome.certain_and_wrong,
                quantile(&mut outcome.errors_px, 0.5),
                quantile(&mut outcome.stated_px, 0.5),
                100.0 * coverage.within_68,
                coverage.error_over_sigma,
            );
        }
    }
}
