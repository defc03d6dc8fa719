//! The figures of relocalization: accuracy and times side by side, printed as Markdown.
//!
//! Not a divan bench: what counts is the accuracy over whole sets of frames, the times beside it. Needs the folder of real
//! frames in `TOUCHLINE_DATA`; `cargo bench --bench relocalize [rendered] [candidates] [scouting]`.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout, reason = "a bench says what failed by failing")]

use rayon::prelude::*;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;
use touchline::camera::{CameraBase, PanTilt, Ptz};
use touchline::features::{FeatureCache, FeatureKey, FeatureOptions, Features, extract};
use touchline::geometry::{ImagePoint, ImageSize, rotation};
use touchline::media::{load_image, sha256_of_file};
use touchline::project::{Document, Frame, read};
use touchline::relocalize::{
    Forest, PoseOptions, PredictOptions, RayCandidate, RayMatches, RelocalizeOptions, Relocalized, Samples, Search,
    SeenRange, TrainOptions, pose_from_candidates, relocalize, train,
};

fn main() {
    let Some(data) = std::env::var_os("TOUCHLINE_DATA").map(PathBuf::from) else {
        println!("skipped: TOUCHLINE_DATA names no folder of real frames");
        return;
    };
    let asked: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let wants = |name: &str| asked.is_empty() || asked.iter().any(|argument| argument == name);
    if wants("candidates") {
        candidates(&data);
    }
    if wants("rendered") {
        rendered(&data);
    }
    if wants("scouting") {
        scouting(&data);
    }
}

fn document(path: &Path) -> Document {
    read(path).unwrap().1
}

/// The features of a frame, from the cache in the build folder if they are there; and how long finding them took.
fn features_of(document: &Document, folder: &Path, frame: &Frame, options: &FeatureOptions) -> (Features, f64) {
    let cache = FeatureCache::new(&Path::new(env!("CARGO_TARGET_TMPDIR")).join("features"), 1 << 30);
    let path = frame.image_path(folder).unwrap();
    let masks = &document.camera_of(frame).unwrap().masks;
    let key = FeatureKey::new(&sha256_of_file(&path).unwrap(), options, masks);
    if let Some(features) = cache.get(&key) {
        return (features, f64::NAN);
    }
    let picture = load_image(&path).unwrap();
    let start = Instant::now();
    let features = extract(&picture, masks, options).unwrap();
    let ms = start.elapsed().as_secs_f64() * 1e3;
    cache.put(&key, &features).unwrap();
    (features, ms)
}

struct Set {
    document: Document,
    features: Vec<Features>,
}

impl Set {
    fn of(path: &Path, options: &FeatureOptions) -> Self {
        let document = document(path);
        let folder = path.parent().unwrap();
        let found: Vec<(Features, f64)> =
            document.frames.par_iter().map(|frame| features_of(&document, folder, frame, options)).collect();
        let mut ms: Vec<f64> = found.iter().map(|found| found.1).filter(|ms| ms.is_finite()).collect();
        if !ms.is_empty() {
            println!("features of {}: median {:.0} ms a frame", path.display(), quantile(&mut ms, 0.5));
        }
        Self { document, features: found.into_iter().map(|found| found.0).collect() }
    }

    fn truth(&self, frame: usize) -> Ptz {
        self.document.frames[frame].ptz.as_ref().unwrap().ptz()
    }

    fn base(&self, frame: usize) -> CameraBase {
        let frame = &self.document.frames[frame];
        self.document.camera_of(frame).unwrap().base_for(frame).unwrap()
    }

    /// What some frames teach, and where they looked.
    fn samples(&self, frames: &[usize]) -> (Samples, SeenRange) {
        let mut samples = Samples::new();
        for &frame in frames {
            let camera = self.document.pointed(&self.document.frames[frame]).unwrap();
            let features = &self.features[frame];
            let rays = features.keypoints.iter().map(|keypoint| camera.ray_from_image(keypoint.point));
            let pairs = rays.zip(&features.descriptors);
            samples.add_frame(pairs.filter_map(|(ray, descriptor)| Some((*descriptor, ray.ok()?))));
        }
        let seen: Vec<Ptz> = frames.iter().map(|&frame| self.truth(frame)).collect();
        (samples, SeenRange::of(&seen).unwrap())
    }
}

fn grown(samples: &Samples, options: &TrainOptions) -> (Forest, f64) {
    let start = Instant::now();
    let forest = train(samples, options, &|_| ControlFlow::Continue(())).unwrap();
    (forest, start.elapsed().as_secs_f64())
}

fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values
        .get(((values.len() as f64 * share) as usize).min(values.len().saturating_sub(1)))
        .copied()
        .unwrap_or(f64::NAN)
}

fn rotation_error_deg(a: Ptz, b: Ptz) -> f64 {
    let turned = |ptz: Ptz| rotation::q_tilt(ptz.tilt) * rotation::q_pan(ptz.pan);
    rotation::angle_between(&turned(a), &turned(b)).degrees()
}

fn rendered(data: &Path) {
    let options = FeatureOptions::default();
    let teachers = Set::of(&data.join("rendered/train.json"), &options);
    let tests = Set::of(&data.join("rendered/test-truth.json"), &options);
    let all: Vec<usize> = (0..teachers.features.len()).collect();
    let (samples, seen) = teachers.samples(&all);
    println!("\n## rendered: {} references, {} samples\n", samples.frames(), samples.len());
    println!(
        "| trees learn from | leaves per tree | rays within 0.5° of all / of gated | predict ms | pose ms | found | rotation error median / 90 % (deg) | focal error median / 90 % (px) |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for frames_per_tree in [Some(30), None] {
        let (forest, seconds) = grown(&samples, &TrainOptions { frames_per_tree, ..TrainOptions::default() });
        let learnt = frames_per_tree.map_or("all".to_owned(), |count| count.to_string());
        println!("<!-- {learnt}: trained in {seconds:.3} s, {} leaves -->", forest.leaves());
        for leaves_per_tree in [1, 4, 8, 16, 32, 64] {
            let predict = PredictOptions { leaves_per_tree, ..PredictOptions::default() };
            let rays = rays_within(&forest, &tests, &predict);
            let options = RelocalizeOptions { predict, ..RelocalizeOptions::default() };
            let answers: Vec<Relocalized> = (0..tests.features.len())
                .map(|frame| relocalize(&tests.features[frame], &forest, &seen, &tests.base(frame), &options))
                .collect();
            let found = answers.iter().filter(|answer| answer.pose.is_ok()).count();
            let errors = |of: &dyn Fn(Ptz, Ptz) -> f64| -> Vec<f64> {
                let pairs = answers.iter().enumerate();
                pairs
                    .filter_map(|(frame, answer)| Some(of(answer.pose.as_ref().ok()?.ptz, tests.truth(frame))))
                    .collect()
            };
            let mut turned = errors(&rotation_error_deg);
            let mut focal = errors(&|a, b| (a.focal_px - b.focal_px).abs());
            let mut predict_ms: Vec<f64> =
                answers.iter().map(|answer| answer.predict_time.as_secs_f64() * 1e3).collect();
            let mut pose_ms: Vec<f64> = answers.iter().map(|answer| answer.pose_time.as_secs_f64() * 1e3).collect();
            println!(
                "| {learnt} | {leaves_per_tree} | {rays} | {:.2} | {:.2} | {found}/{} | {:.5} / {:.5} | {:.3} / {:.3} |",
                quantile(&mut predict_ms, 0.5),
                quantile(&mut pose_ms, 0.5),
                answers.len(),
                quantile(&mut turned, 0.5),
                quantile(&mut turned, 0.9),
                quantile(&mut focal, 0.5),
                quantile(&mut focal, 0.9),
            );
        }
    }
}

/// The share of features whose likeliest ray is within half a degree of the truth, of all features and of those with rays.
fn rays_within(forest: &Forest, tests: &Set, options: &PredictOptions) -> String {
    let (mut all, mut gated, mut right) = (0, 0, 0);
    let (mut search, mut candidates) = (Search::default(), Vec::new());
    for (frame, features) in tests.features.iter().enumerate() {
        let camera = tests.document.pointed(&tests.document.frames[frame]).unwrap();
        for (keypoint, descriptor) in features.keypoints.iter().zip(&features.descriptors) {
            forest.predict(descriptor, options, &mut search, &mut candidates);
            all += 1;
            let Some(best) = candidates.first() else { continue };
            gated += 1;
            right += usize::from(camera.ray_from_image(keypoint.point).unwrap().angle_to(best.ray).degrees() < 0.5);
        }
    }
    format!("{:.3} / {:.3}", f64::from(right as u32) / f64::from(all), f64::from(right as u32) / f64::from(gated))
}

fn candidates(data: &Path) {
    let document = document(&data.join("rendered/train.json"));
    let base = CameraBase { principal_point: ImagePoint::new(640.5, 360.5), ..document.cameras[0].base().unwrap() };
    let (mut turned, mut focal, mut ms) = (Vec::new(), Vec::new(), Vec::new());
    for number in 0..30 {
        let text = std::fs::read_to_string(data.join(format!("rendered/candidates/{number:05}.txt"))).unwrap();
        let numbers: Vec<f64> = text.split_whitespace().map(|word| word.parse().unwrap()).collect();
        let truth = Ptz::from_degrees(numbers[0], numbers[1], numbers[2]);
        let mut matches = RayMatches::new();
        let mut at = 4;
        while at < numbers.len() {
            let point = ImagePoint::new(numbers[at] + 0.5, numbers[at + 1] + 0.5);
            let count = numbers[at + 2] as usize;
            let rays = numbers[at + 3..at + 3 + 2 * count].as_chunks::<2>().0.iter();
            let rays: Vec<RayCandidate> = rays
                .map(|[pan, tilt]| RayCandidate { ray: PanTilt::from_degrees(*pan, *tilt), squared_distance: 0.1 })
                .collect();
            matches.push(point, &rays);
            at += 3 + 2 * count;
        }
        let start = Instant::now();
        let pose = pose_from_candidates(&matches, &base, ImageSize::new(1280, 720), &PoseOptions::default());
        ms.push(start.elapsed().as_secs_f64() * 1e3);
        match pose {
            Ok(pose) => {
                turned.push(rotation_error_deg(pose.ptz, truth));
                focal.push((pose.ptz.focal_px - truth.focal_px).abs());
            }
            Err(reason) => println!("candidates {number}: {reason}"),
        }
    }
    println!("\n## candidates: {} of 30 found\n", turned.len());
    println!(
        "rotation error {:.4} / {:.4} deg, focal error {:.2} / {:.2} px (median / 90 %), {:.2} ms a frame",
        quantile(&mut turned, 0.5),
        quantile(&mut turned, 0.9),
        quantile(&mut focal, 0.5),
        quantile(&mut focal, 0.9),
        quantile(&mut ms, 0.5),
    );
}

fn scouting(data: &Path) {
    println!("\n## scouting: every clip answered by the others\n");
    println!(
        "| match | frames | found | within 5 / 10 / 20 px of all | confident and wrong (> 20 px) | features ms | predict ms | pose ms |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let (mut every, mut found_all, mut wrong_all) = (Vec::new(), 0, 0);
    for name in ["08fd33", "42ba34", "d82e7a"] {
        let set = Set::of(&data.join(format!("scouting-{name}/fit-k1.json")), &FeatureOptions::default());
        let field = set.document.field.model(data).unwrap();
        let usable: Vec<usize> = (0..set.features.len()).filter(|&i| set.document.frames[i].ptz.is_some()).collect();
        let mut clips: Vec<_> = usable.iter().map(|&i| set.document.frames[i].clip.clone()).collect();
        clips.sort();
        clips.dedup();
        let (mut errors, mut found, mut wrong) = (Vec::new(), 0, 0);
        let (mut predict_ms, mut pose_ms) = (Vec::new(), Vec::new());
        for clip in clips {
            let (asked, teachers): (Vec<usize>, Vec<usize>) =
                usable.iter().copied().partition(|&i| set.document.frames[i].clip == clip);
            let (samples, seen) = set.samples(&teachers);
            let (forest, _) = grown(&samples, &TrainOptions::default());
            for frame in asked {
                let answer =
                    relocalize(&set.features[frame], &forest, &seen, &set.base(frame), &RelocalizeOptions::default());
                predict_ms.push(answer.predict_time.as_secs_f64() * 1e3);
                pose_ms.push(answer.pose_time.as_secs_f64() * 1e3);
                let error = match &answer.pose {
                    Ok(pose) => {
                        found += 1;
                        click_error_px(&set, frame, pose.ptz, &field)
                    }
                    Err(reason) => {
                        let name = set.document.frames[frame].name();
                        println!("<!-- {name}: {reason} -->");
                        f64::INFINITY
                    }
                };
                if let Ok(pose) = &answer.pose
                    && error > 10.0
                {
                    let name = set.document.frames[frame].name();
                    println!(
                        "<!-- {name}: {error:.1} px, confidence {:.3}, {} places, {} inliers -->",
                        pose.confidence,
                        pose.places,
                        pose.inliers.len()
                    );
                    wrong += usize::from(error > 20.0);
                }
                errors.push(error);
            }
        }
        row(name, &errors, found, wrong, &mut predict_ms, &mut pose_ms);
        every.extend(errors);
        found_all += found;
        wrong_all += wrong;
    }
    row("all", &every, found_all, wrong_all, &mut [], &mut []);
}

fn row(name: &str, errors: &[f64], found: usize, wrong: usize, predict_ms: &mut [f64], pose_ms: &mut [f64]) {
    let within = |px: f64| 100.0 * errors.iter().filter(|error| **error <= px).count() as f64 / errors.len() as f64;
    println!(
        "| {name} | {} | {found} | {:.1} / {:.1} / {:.1} % | {wrong} | – | {:.2} | {:.2} |",
        errors.len(),
        within(5.0),
        within(10.0),
        within(20.0),
        quantile(predict_ms, 0.5),
        quantile(pose_ms, 0.5),
    );
}

/// The median distance of a frame's clicks from their landmarks in a camera, px.
fn click_error_px(set: &Set, frame: usize, ptz: Ptz, field: &touchline::field::FieldModel) -> f64 {
    let camera = touchline::camera::PtzCamera::new(set.base(frame), ptz);
    let observations = touchline::project::observations(&set.document.frames[frame], field).unwrap();
    let mut distances: Vec<f64> = observations
        .iter()
        .filter_map(|observation| match observation.target {
            touchline::solve::Target::Landmark(at) => {
                Some(camera.image_from_world(at).map_or(f64::INFINITY, |image| image.distance_px(observation.image)))
            }
            touchline::solve::Target::Line(_) => None,
        })
        .collect();
    quantile(&mut distances, 0.5)
}
