//! Real frames: every clip answered by the other clips of its match.

use super::set::{Set, grown, quantile};
use super::time::seconds;
use std::path::Path;
use touchline::calibrate::{BaseProblem, observations, solve_document};
use touchline::camera::Ptz;
use touchline::document::{Document, Frame};
use touchline::features::{FeatureOptions, extract};
use touchline::field::FieldModel;
use touchline::media::load_image;
use touchline::progress::Progress;
use touchline::relocalize::{
    Forest, PoseOptions, RelocalizeOptions, Relocalized, SeenRange, TrainOptions, relocalize,
};
use touchline::solve::base::BaseOptions;
use touchline::store::read;

/// The matches.
pub const MATCHES: [&str; 3] = ["08fd33", "42ba34", "d82e7a"];

/// A match's frames, solved with the base that the program finds from the clicks itself.
pub fn document(data: &Path, name: &str) -> Document {
    let folder = data.join(format!("scouting-{name}"));
    let mut document = read(&folder.join("clicks.json")).unwrap().1;
    let camera = document.cameras[0].id.clone();
    let problem = BaseProblem::from_document(document.at(&folder), &camera).unwrap();
    let estimate = problem
        .estimate(&document, &BaseOptions::default(), &Progress::default())
        .unwrap();
    estimate.write_camera(&mut document);
    solve_document(&mut document, &folder, &Progress::default()).unwrap();
    document
}

/// A frame whose clicks have near and far mixed up throughout: what it says cannot be measured
/// against.
const MIRRORED: &str = "42ba34_9_2";

/// The solved frames of a set with clicks that can be believed.
pub fn usable(set: &Set) -> Vec<usize> {
    set.all()
        .into_iter()
        .filter(|&frame| is_usable(&set.document.frames[frame]))
        .collect()
}

/// Whether a frame is solved and has clicks that can be believed.
pub fn is_usable(frame: &Frame) -> bool {
    frame.ptz.is_some() && !frame.name().contains(MIRRORED)
}

/// A frame that its own clip has not taught.
pub struct ScoutedFrame {
    pub frame: usize,
    pub relocalized: Relocalized,
    /// The median distance of its clicks from their landmarks, px at 1920 px width; infinite
    /// without a camera.
    pub error_px: f64,
}

/// Every frame of a set answered by a forest of the other clips.
pub fn answers(
    set: &Set,
    field: &FieldModel,
    train: &TrainOptions,
    ask: &RelocalizeOptions,
) -> Vec<ScoutedFrame> {
    let usable = usable(set);
    let mut clips: Vec<_> = usable
        .iter()
        .map(|&i| set.document.frames[i].clip.clone())
        .collect();
    clips.sort();
    clips.dedup();
    let mut answers = Vec::new();
    for clip in clips {
        let (asked, training_frames): (Vec<usize>, Vec<usize>) = usable
            .iter()
            .copied()
            .partition(|&i| set.document.frames[i].clip == clip);
        let (samples, seen) = set.samples(&training_frames, usize::MAX);
        let forest = grown(&samples, train);
        answers.extend(
            asked
                .into_iter()
                .map(|frame| answer(set, frame, (&forest, &seen), field, ask)),
        );
    }
    answers
}

pub fn answer(
    set: &Set,
    frame: usize,
    (forest, seen): (&Forest, &SeenRange),
    field: &FieldModel,
    ask: &RelocalizeOptions,
) -> ScoutedFrame {
    let asked = || relocalize(&set.features[frame], forest, seen, &set.base(frame), ask);
    let mut relocalized = asked();
    // The answer is the same each time; the least time is what it costs without other programs.
    for again in [asked(), asked()] {
        relocalized.predict_time = relocalized.predict_time.min(again.predict_time);
        relocalized.pose_time = relocalized.pose_time.min(again.pose_time);
    }
    let error_px = relocalized.pose.as_ref().map_or(f64::INFINITY, |pose| {
        click_error_px(set, frame, pose.ptz, field)
    });
    ScoutedFrame {
        frame,
        relocalized,
        error_px,
    }
}

/// The median distance of a frame's clicks from their landmarks in a camera, px at 1920 px width.
pub fn click_error_px(set: &Set, frame: usize, ptz: Ptz, field: &FieldModel) -> f64 {
    let camera = touchline::camera::PtzCamera::new(set.base(frame), ptz);
    let observed = observations(&set.document.frames[frame], field).unwrap();
    let mut distances: Vec<f64> = observed
        .iter()
        .filter_map(|observation| {
            let at = observation.shape.point()?;
            Some(
                camera
                    .image_from_world(at)
                    .map_or(f64::INFINITY, |image| image.distance_px(observation.image)),
            )
        })
        .collect();
    quantile(&mut distances, 0.5) / set.features[frame].image_size.scale_from_1920()
}

/// Accuracy and time by resolution and number of features.
pub fn accuracy(data: &Path) {
    println!("\n## scouting: every clip answered by the others\n");
    println!(
        "| features | match | frames | answered | within 5 / 10 / 20 px of all | wrong (> 20 px) | median px | features + \
         predict + pose, ms |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let documents = MATCHES.map(|name| document(data, name));
    for (max_width_px, max_count) in [
        (960, 300),
        (960, 600),
        (960, 1000),
        (640, 600),
        (640, 1000),
        (1920, 1000),
    ] {
        let options = FeatureOptions {
            max_width_px,
            max_count,
            ..FeatureOptions::default()
        };
        let (mut all, mut features_time_ms) = (Vec::new(), 0.0);
        for (number, name) in MATCHES.iter().enumerate() {
            let folder = data.join(format!("scouting-{name}"));
            let set = Set::from_document(documents[number].clone(), &folder, &options);
            let field = set.document.field.model(&folder).unwrap();
            let found = answers(
                &set,
                &field,
                &TrainOptions::default(),
                &RelocalizeOptions::default(),
            );
            let label = format!("{max_count} at {max_width_px} px");
            let features_ms = features_ms(&set, &folder, &options);
            features_time_ms += features_ms;
            row(&label, name, &found, features_ms);
            for answer in &found {
                let name = set.document.frames[answer.frame].name();
                match &answer.relocalized.pose {
                    Err(reason) => println!("<!-- {name}: {reason} -->"),
                    Ok(pose) if answer.error_px > 10.0 => println!(
                        "<!-- {name}: {:.1} px, confidence {:.3}, {} places, {} inliers -->",
                        answer.error_px,
                        pose.confidence,
                        pose.places,
                        pose.inliers.len()
                    ),
                    Ok(_) => {}
                }
            }
            all.extend(found);
        }
        row(
            &format!("{max_count} at {max_width_px} px"),
            "**all**",
            &all,
            features_time_ms / MATCHES.len() as f64,
        );
    }
}

/// Accuracy without any mask: as built, and with what stands still on the screen taken for any
/// feature.
pub fn accuracy_without_masks(data: &Path) {
    println!(
        "\n## unmasked: every clip answered by the others, no masks; all references, and only two\n"
    );
    println!(
        "| | match | frames | answered | within 10 px of all / of answered | wrong (> 20 px) | median px |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (keeps_standing, label) in [(true, "standing features kept"), (false, "as built")] {
        for name in MATCHES {
            let folder = data.join(format!("scouting-{name}"));
            let mut set =
                Set::without_masks(document(data, name), &folder, &FeatureOptions::default());
            set.keeps_standing = keeps_standing;
            let field = set.document.field.model(&folder).unwrap();
            let found = answers(
                &set,
                &field,
                &TrainOptions::default(),
                &RelocalizeOptions::default(),
            );
            unmasked_row(label, name, &set, &found);
            let few = answers_of_two(&set, &field);
            unmasked_row(&format!("{label}, two references"), name, &set, &few);
        }
    }
}

fn unmasked_row(label: &str, name: &str, set: &Set, answers: &[ScoutedFrame]) {
    let mut errors: Vec<f64> = answers.iter().map(|answer| answer.error_px).collect();
    let given = errors.iter().filter(|error| error.is_finite()).count();
    let near = errors.iter().filter(|error| **error <= 10.0).count() as f64;
    let wrong = errors
        .iter()
        .filter(|error| error.is_finite() && **error > 20.0)
        .count();
    println!(
        "| {label} | {name} | {} | {given} | {:.1} / {:.1} % | {wrong} | {:.2} |",
        answers.len(),
        100.0 * near / answers.len() as f64,
        100.0 * near / given.max(1) as f64,
        quantile(&mut errors, 0.5)
    );
    for answer in answers.iter().filter(|answer| answer.error_px > 10.0) {
        let frame = set.document.frames[answer.frame].name();
        match &answer.relocalized.pose {
            Err(reason) => println!("<!-- {frame}: {reason} -->"),
            Ok(pose) => println!(
                "<!-- {frame}: {:.1} px, confidence {:.3}, {} places, {} inliers -->",
                answer.error_px,
                pose.confidence,
                pose.places,
                pose.inliers.len()
            ),
        }
    }
}

/// Every frame of a set answered by the first and the last usable frame of the other clips.
fn answers_of_two(set: &Set, field: &FieldModel) -> Vec<ScoutedFrame> {
    let usable = usable(set);
    let clip = |frame: usize| set.document.frames[frame].clip.clone();
    let mut answers = Vec::new();
    for &frame in &usable {
        let others: Vec<usize> = usable
            .iter()
            .copied()
            .filter(|&other| clip(other) != clip(frame))
            .collect();
        let [first, .., last] = others[..] else {
            continue;
        };
        let (samples, seen) = set.samples(&[first, last], usize::MAX);
        let forest = grown(&samples, &TrainOptions::default());
        answers.push(answer(
            set,
            frame,
            (&forest, &seen),
            field,
            &RelocalizeOptions::default(),
        ));
    }
    answers
}

/// What finding the features of a few frames costs on one thread, ms.
fn features_ms(set: &Set, folder: &Path, options: &FeatureOptions) -> f64 {
    let masks = &set.document.cameras[0].masks;
    let frames: Vec<_> = set
        .document
        .frames
        .iter()
        .step_by(set.document.frames.len() / 4)
        .collect();
    let pictures: Vec<_> = frames
        .iter()
        .map(|frame| load_image(&frame.image_path(folder).unwrap()).unwrap())
        .collect();
    let (_, time_s) = seconds(|| {
        pictures
            .iter()
            .filter(|picture| extract(picture, masks, options).is_ok())
            .count()
    });
    time_s * 1e3 / pictures.len() as f64
}

fn row(label: &str, name: &str, answers: &[ScoutedFrame], features_ms: f64) {
    let mut errors: Vec<f64> = answers.iter().map(|answer| answer.error_px).collect();
    let within = |px: f64| {
        100.0 * errors.iter().filter(|error| **error <= px).count() as f64 / errors.len() as f64
    };
    let given = errors.iter().filter(|error| error.is_finite()).count();
    let wrong = errors
        .iter()
        .filter(|error| error.is_finite() && **error > 20.0)
        .count();
    let within = [within(5.0), within(10.0), within(20.0)];
    let ms = |of: fn(&Relocalized) -> std::time::Duration| {
        let mut ms: Vec<f64> = answers
            .iter()
            .map(|answer| of(&answer.relocalized).as_secs_f64() * 1e3)
            .collect();
        quantile(&mut ms, 0.5)
    };
    println!(
        "| {label} | {name} | {} | {given} | {:.1} / {:.1} / {:.1} % | {wrong} | {:.2} | {features_ms:.0} + {:.2} + {:.2} |",
        answers.len(),
        within[0],
        within[1],
        within[2],
        quantile(&mut errors, 0.5),
        ms(|answer| answer.predict_time),
        ms(|answer| answer.pose_time),
    );
}

/// Whatever is found, however unsure: what the confidence is fitted to.
pub fn unsure() -> RelocalizeOptions {
    RelocalizeOptions {
        pose: PoseOptions {
            min_confidence: 0.0,
            ..PoseOptions::default()
        },
        ..RelocalizeOptions::default()
    }
}
