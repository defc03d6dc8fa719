//! Coarse features first, fine ones where the answer by these is not certain: accuracy and time by
//! what the forest has learnt and by what it is queried.

use super::scouting::{MATCHES, ScoutedFrame, answer, document, usable};
use super::set::{Set, grown, quantile, rotation_error_deg};
use super::time::seconds;
use std::path::Path;
use touchline::document::Document;
use touchline::features::{FeatureOptions, extract};
use touchline::media::load_image;
use touchline::relocalize::{
    CERTAIN, RelocalizeOptions, Relocalized, Samples, SeenRange, TrainOptions, relocalize,
};

/// The resolutions of which a forest learns, or by which it is queried.
#[derive(Clone, Copy)]
enum By {
    Fine,
    Coarse,
    /// The forest learns both; the query is by coarse features first.
    Both,
}

impl By {
    const ALL: [(Self, &str); 3] = [
        (Self::Fine, "fine"),
        (Self::Coarse, "coarse"),
        (Self::Both, "both"),
    ];
}

/// A document with its features at two resolutions.
struct Resolutions {
    coarse: Set,
    fine: Set,
}

impl Resolutions {
    fn new(document: &Document, folder: &Path, options: [FeatureOptions; 2]) -> Self {
        let [coarse, fine] =
            options.map(|options| Set::from_document(document.clone(), folder, &options));
        Self { coarse, fine }
    }

    fn samples(&self, frames: &[usize], by: By) -> (Samples, SeenRange) {
        let mut samples = Samples::new();
        let mut add = |set: &Set| set.samples_into(frames, usize::MAX, &mut samples);
        let seen = match by {
            By::Fine => add(&self.fine),
            By::Coarse => add(&self.coarse),
            By::Both => {
                add(&self.fine);
                add(&self.coarse)
            }
        };
        (samples, seen)
    }
}

/// A frame's answers by coarse and by fine features.
type Answers<T> = [T; 2];

/// The answer that counts, and whether fine features were needed for it.
fn choose<T>(
    [coarse, fine]: &Answers<T>,
    by: By,
    found: impl Fn(&T) -> &Relocalized,
) -> (&T, bool) {
    match by {
        By::Coarse => (coarse, false),
        By::Both if found(coarse).is_certain() => (coarse, false),
        By::Both | By::Fine => (fine, true),
    }
}

fn options(max_width_px: u32) -> FeatureOptions {
    FeatureOptions {
        max_width_px,
        ..FeatureOptions::default()
    }
}

/// Both tables.
pub fn coarse_to_fine(data: &Path) {
    for coarse_px in [480, 640] {
        real_frames(data, coarse_px);
    }
    drawn_frames(data);
}

/// Every clip answered by the others, at 960 px and less.
fn real_frames(data: &Path, coarse_px: u32) {
    let options = [options(coarse_px), options(960)];
    let mut by_forest: [Vec<Answers<ScoutedFrame>>; 3] = Default::default();
    // Decoding, coarse and fine features, ms.
    let mut times: [Vec<f64>; 3] = Default::default();
    for name in MATCHES {
        let folder = data.join(format!("scouting-{name}"));
        let sets = Resolutions::new(&document(data, name), &folder, options);
        let (document, usable) = (&sets.fine.document, usable(&sets.fine));
        for &frame in usable.iter().step_by(6) {
            let path = document.frames[frame].image_path(&folder).unwrap();
            let (picture, decoding_s) = seconds(|| load_image(&path).unwrap());
            let masks = &document.cameras[0].masks;
            let [coarse_s, fine_s] =
                options.map(|options| seconds(|| extract(&picture, masks, &options).unwrap()).1);
            for (times, time_s) in times.iter_mut().zip([decoding_s, coarse_s, fine_s]) {
                times.push(time_s * 1e3);
            }
        }
        let field = document.field.model(&folder).unwrap();
        let clip = |frame: usize| document.frames[frame].clip.clone();
        let mut clips: Vec<_> = usable.iter().map(|&frame| clip(frame)).collect();
        clips.sort();
        clips.dedup();
        for left_out in clips {
            let (queries, training): (Vec<usize>, Vec<usize>) =
                usable.iter().partition(|&&frame| clip(frame) == left_out);
            for ((learnt, _), answers) in By::ALL.into_iter().zip(&mut by_forest) {
                let (samples, seen) = sets.samples(&training, learnt);
                let forest = (&grown(&samples, &TrainOptions::default()), &seen);
                let ask = RelocalizeOptions::default();
                answers.extend(queries.iter().map(|&frame| {
                    [&sets.coarse, &sets.fine].map(|set| answer(set, frame, forest, &field, &ask))
                }));
            }
        }
    }
    let times = times.map(|times| times.iter().sum::<f64>() / times.len() as f64);
    println!("\n## coarse to fine: every clip answered by the others, {coarse_px} and 960 px\n");
    println!(
        "| learnt | queried by | answered | by fine features | within 5 / 10 / 20 px of all | certain and wrong (> 20 px) | \
         median px | decoding + features, ms |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for ((_, learnt), answers) in By::ALL.into_iter().zip(&by_forest) {
        for (by, query) in By::ALL {
            row(&format!("{learnt} | {query}"), answers, by, times);
        }
    }
}

fn row(label: &str, answers: &[Answers<ScoutedFrame>], by: By, [decoding, coarse, fine]: [f64; 3]) {
    let chosen: Vec<(&ScoutedFrame, bool)> = answers
        .iter()
        .map(|answers| choose(answers, by, |answer| &answer.relocalized))
        .collect();
    let mut errors: Vec<f64> = chosen.iter().map(|(answer, _)| answer.error_px).collect();
    let share = |count: usize| count as f64 / chosen.len() as f64;
    let within = |px: f64| 100.0 * share(errors.iter().filter(|error| **error <= px).count());
    let by_fine = chosen.iter().filter(|(_, is_fine)| *is_fine).count();
    let certain_and_wrong = chosen
        .iter()
        .filter(|(answer, _)| answer.relocalized.is_certain() && answer.error_px > 20.0)
        .count();
    let coarse_ms = if matches!(by, By::Fine) { 0.0 } else { coarse };
    println!(
        "| {label} | {} | {by_fine} | {:.1} / {:.1} / {:.1} % | {certain_and_wrong} | {:.2} | {:.0} |",
        errors.iter().filter(|error| error.is_finite()).count(),
        within(5.0),
        within(10.0),
        within(20.0),
        quantile(&mut errors, 0.5),
        decoding + coarse_ms + share(by_fine) * fine,
    );
}

/// Drawn frames of 1280 px against exact truth, at half and at full width.
fn drawn_frames(data: &Path) {
    let folder = data.join("rendered");
    let of = |file: &str| {
        let (_, document, _) = touchline::store::read(&folder.join(file)).unwrap();
        Resolutions::new(&document, &folder, [options(640), options(1280)])
    };
    let (references, tests) = (of("train.json"), of("test-truth.json"));
    println!("\n## coarse to fine: drawn frames, 640 and 1280 px\n");
    println!(
        "| learnt | queried by | answered | certain (≥ {CERTAIN}) | by fine features | rotation error, median / 90 % (deg) | \
         focal error, median / 90 % (px) |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (learnt, learnt_label) in By::ALL {
        let (samples, seen) = references.samples(&references.fine.all(), learnt);
        let forest = grown(&samples, &TrainOptions::default());
        let ask = |set: &Set, frame: usize| {
            let (features, base) = (&set.features[frame], set.base(frame));
            relocalize(
                features,
                &forest,
                &seen,
                &base,
                &RelocalizeOptions::default(),
            )
        };
        let answers: Vec<Answers<Relocalized>> = (0..tests.fine.features.len())
            .map(|frame| [&tests.coarse, &tests.fine].map(|set| ask(set, frame)))
            .collect();
        for (by, query) in By::ALL {
            let (mut turns_deg, mut focal_px) = (Vec::new(), Vec::new());
            let (mut certain, mut by_fine) = (0, 0);
            for (frame, answers) in answers.iter().enumerate() {
                let (answer, is_fine) = choose(answers, by, |answer| answer);
                certain += usize::from(answer.is_certain());
                by_fine += usize::from(is_fine);
                let Ok(pose) = &answer.pose else { continue };
                let truth = tests.fine.truth(frame);
                turns_deg.push(rotation_error_deg(pose.ptz, truth));
                focal_px.push((pose.ptz.focal_px - truth.focal_px).abs());
            }
            println!(
                "| {learnt_label} | {query} | {} | {certain} | {by_fine} | {:.5} / {:.5} | {:.3} / {:.3} |",
                turns_deg.len(),
                quantile(&mut turns_deg, 0.5),
                quantile(&mut turns_deg, 0.9),
                quantile(&mut focal_px, 0.5),
                quantile(&mut focal_px, 0.9),
            );
        }
    }
}
