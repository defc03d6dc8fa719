//! Proposals as the program makes them, line check included, without a single mask, against
//! people's clicks: how many frames are answered, how often certain answers are wrong, and whether
//! the stated σ is true.

use super::proposed::propose_all;
use super::scouting::{MATCHES, document, is_usable};
use super::set::quantile;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64Mcg;
use std::path::{Path, PathBuf};
use touchline::calibrate::observations;
use touchline::camera::PtzCamera;
use touchline::document::{Document, Fields};
use touchline::features::FeatureOptions;
use touchline::geometry::rotation::{angle_between, q_pan, q_tilt};
use touchline::media::FrameReader;
use touchline::proposals::{
    Answer, FeatureStore, FramePictures, LineEvidence, Proposal, WorkFolder,
};
use touchline::solve::Uncertainty;

/// χ² with two degrees of freedom of a 68 % region.
const REGION: f64 = 2.28;

/// Which references a frame is asked of: those of other clips,
#[derive(Clone, Copy, Debug, PartialEq)]
enum References {
    /// all of them,
    All,
    /// without those whose axis is within 8° of the frame's,
    Apart,
    /// or so many.
    Few(usize),
}

/// A frame that was asked.
struct QueriedFrame {
    name: String,
    /// The answer; none where it was not given.
    answer: Option<Answer>,
    /// The median distance of its clicks from their landmarks in the answer's camera, px at 1920 px
    /// width.
    error_px: f64,
    /// Of each click: χ² of its distance by the stated covariance and the click's own, and by the
    /// former alone.
    chi_squared: Vec<[f64; 2]>,
}

/// A match without masks.
struct Match {
    folder: PathBuf,
    document: Document,
    store: FeatureStore,
    usable: Vec<usize>,
}

impl Match {
    fn of(data: &Path, name: &str) -> Self {
        let mut document = document(data, name);
        for camera in &mut document.cameras {
            camera.masks.clear();
            camera.ranged_masks.clear();
        }
        for frame in &mut document.frames {
            frame.masks.clear();
        }
        let usable = (0..document.frames.len())
            .filter(|&index| is_usable(&document.frames[index]))
            .collect();
        let beside = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.json"));
        let store = FeatureStore::on_disk(&WorkFolder::beside(&beside));
        Self {
            folder: data.join(format!("scouting-{name}")),
            document,
            store,
            usable,
        }
    }

    fn pictures(&self) -> FramePictures<'_> {
        let options = FeatureOptions::default();
        FramePictures {
            document: &self.document,
            folder: &self.folder,
            options,
            store: &self.store,
        }
    }

    /// How far the axes of two frames are apart, degrees.
    fn apart_deg(&self, one: usize, other: usize) -> f64 {
        let turned = |index: usize| {
            let ptz = self.document.frames[index].ptz.as_ref().unwrap().ptz();
            q_tilt(ptz.tilt) * q_pan(ptz.pan)
        };
        angle_between(&turned(one), &turned(other)).degrees()
    }

    /// Every frame asked of references of other clips; of few references every `every`-th frame.
    fn queries(&self, references: References, every: usize, is_snapped: bool) -> Vec<QueriedFrame> {
        let clip = |index: usize| self.document.frames[index].clip.clone();
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let mut groups: Vec<(Vec<usize>, Vec<usize>)> = Vec::new();
        for &frame in self.usable.iter().step_by(every) {
            let others = self
                .usable
                .iter()
                .copied()
                .filter(|&other| clip(other) != clip(frame));
            let mut training: Vec<usize> = match references {
                References::Apart => others
                    .filter(|&other| self.apart_deg(frame, other) >= 8.0)
                    .collect(),
                References::All | References::Few(_) => others.collect(),
            };
            if let References::Few(count) = references {
                training.shuffle(&mut rng);
                training.truncate(count);
                training.sort_unstable();
            }
            match groups.iter_mut().find(|(_, known)| *known == training) {
                Some((asked, _)) => asked.push(frame),
                None => groups.push((vec![frame], training)),
            }
        }
        let at = self.document.at(&self.folder);
        let mut reader = FrameReader::new();
        let evidence = LineEvidence::from_document(at, &mut reader, is_snapped).unwrap();
        let mut all = Vec::new();
        for (asked, training) in groups {
            let Ok(proposals) =
                propose_all(&self.pictures(), &mut reader, &evidence, &training, &asked)
            else {
                continue;
            };
            all.extend(
                proposals
                    .into_iter()
                    .map(|proposal| self.against_clicks(proposal)),
            );
        }
        all
    }

    fn against_clicks(&self, proposal: Proposal) -> QueriedFrame {
        let frame = &**self.document.frames.by_id(&proposal.frame).unwrap();
        let name = frame.name();
        let answer = match proposal.outcome {
            Ok(answer) => answer,
            Err(reason) => {
                println!("<!-- {name}: {reason} -->");
                return QueriedFrame {
                    name,
                    answer: None,
                    error_px: f64::INFINITY,
                    chi_squared: Vec::new(),
                };
            }
        };
        let fields = Fields::from_document(self.document.at(&self.folder)).unwrap();
        let base = self
            .document
            .camera_of(frame)
            .unwrap()
            .base_for(frame)
            .unwrap();
        let camera = PtzCamera::new(base, answer.ptz.ptz());
        let stated = Uncertainty::from_own(&camera, &answer.own_covariance, frame.image_size).ok();
        let (mut distances, mut chi_squared) = (Vec::new(), Vec::new());
        for click in observations(frame, fields.for_frame(&self.document, frame)).unwrap() {
            let Some(at) = click.shape.point() else {
                continue;
            };
            let Ok(image) = camera.image_from_world(at) else {
                continue;
            };
            let off = click.image.offset_from(image);
            distances.push(off.norm());
            let Some(overlay) = stated.and_then(|stated| stated.overlay_at_world(&camera, at))
            else {
                continue;
            };
            let noise = nalgebra::Matrix2::identity() * click.sigma_px.powi(2);
            chi_squared.push(
                [overlay + noise, overlay]
                    .map(|covariance| off.dot(&(covariance.try_inverse().unwrap() * off))),
            );
        }
        let error_px = quantile(&mut distances, 0.5) / frame.image_size.scale_from_1920();
        QueriedFrame {
            name,
            answer: Some(answer),
            error_px,
            chi_squared,
        }
    }
}

/// The figures, match by match and together.
pub fn trust(data: &Path) {
    println!("\n## trust: proposals without masks against people's clicks\n");
    println!(
        "| references | match | frames | answered | within 10 px of all | stated ≥ .5 and > 20 px off | ≥ .95 and > 10 px off | \
         68 % regions hold, rms z: with the click's own noise / without | stated σ, median px |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let matches = MATCHES.map(|name| Match::of(data, name));
    for (label, references, every, is_snapped) in [
        ("all of other clips", References::All, 1, false),
        ("none within 8°", References::Apart, 1, false),
        ("two", References::Few(2), 2, false),
        ("all of other clips, snapped", References::All, 1, true),
        ("none within 8°, snapped", References::Apart, 1, true),
        ("two, snapped", References::Few(2), 2, true),
    ] {
        let mut all = Vec::new();
        for (name, of) in MATCHES.iter().zip(&matches) {
            let asked = of.queries(references, every, is_snapped);
            row(label, name, &asked.iter().collect::<Vec<_>>());
            all.extend(asked);
        }
        row(label, "**all**", &all.iter().collect::<Vec<_>>());
    }
}

fn row(label: &str, name: &str, asked: &[&QueriedFrame]) {
    let given: Vec<(&Answer, &QueriedFrame)> = asked
        .iter()
        .filter_map(|asked| Some((asked.answer.as_ref()?, *asked)))
        .collect();
    let share = |count: usize, of: usize| 100.0 * count as f64 / of.max(1) as f64;
    let near = asked.iter().filter(|asked| asked.error_px <= 10.0).count();
    let wrong = given
        .iter()
        .filter(|(answer, asked)| answer.confidence >= 0.5 && asked.error_px > 20.0)
        .count();
    let certain: Vec<_> = given
        .iter()
        .filter(|(answer, _)| answer.confidence >= 0.95)
        .collect();
    let certain_off = certain
        .iter()
        .filter(|(_, asked)| asked.error_px > 10.0)
        .count();
    let true_sigma = |which: usize| {
        let all: Vec<f64> = given
            .iter()
            .flat_map(|(_, asked)| asked.chi_squared.iter().map(|both| both[which]))
            .collect();
        let held = all
            .iter()
            .filter(|chi_squared| **chi_squared <= REGION)
            .count();
        // People's clicks hold a few that are plainly wrong: beyond 5 σ they tell of the click.
        let usual: Vec<f64> = all
            .iter()
            .copied()
            .filter(|chi_squared| *chi_squared <= 25.0 || which == 1)
            .collect();
        let rms = (usual.iter().sum::<f64>() / (2.0 * usual.len() as f64)).sqrt();
        format!("{:.1} %, {rms:.2}", share(held, all.len()))
    };
    let mut sigmas: Vec<f64> = given
        .iter()
        .map(|(answer, _)| answer.worst_corner_sigma_px)
        .collect();
    let mut errors: Vec<f64> = given.iter().map(|(_, asked)| asked.error_px).collect();
    println!(
        "| {label} | {name} | {} | {} ({:.1} %) | {:.1} % | {wrong} | {certain_off} of {} ({:.1} %) | {} / {} | {:.1} | {:.2} |",
        asked.len(),
        given.len(),
        share(given.len(), asked.len()),
        share(near, asked.len()),
        certain.len(),
        share(certain_off, certain.len()),
        true_sigma(0),
        true_sigma(1),
        quantile(&mut sigmas, 0.5),
        quantile(&mut errors, 0.5),
    );
    for (answer, asked) in given.iter().filter(|(_, asked)| asked.error_px > 10.0) {
        let sigma_px = answer.evidence.labelled_sigma_px;
        println!(
            "<!-- {}: {:.1} px off, stated {:.3}, ±{sigma_px:.1} px -->",
            asked.name, asked.error_px, answer.confidence
        );
    }
}
