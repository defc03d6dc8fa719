//! Two broadcast videos with score bugs, watermarks and boards that change, labelled by a few
//! clicked frames and without a mask: what is proposed for all other frames. There is no truth:
//! each answer is held against the frames before and after it, and against its painted lines, and
//! the documents are written for people to look at.

use super::proposed::propose_all;
use super::set::quantile;
use std::path::Path;
use touchline::calibrate::{BaseProblem, solve_document};
use touchline::camera::PtzCamera;
use touchline::document::{Document, Frame, VideoFrame, document_from_bytes};
use touchline::features::FeatureOptions;
use touchline::markings::LineVerdict;
use touchline::media::{FrameReader, FrameSource};
use touchline::progress::Progress;
use touchline::proposals::{
    Answer, FeatureStore, FramePictures, LineEvidence, TrainingFrames, WorkFolder, overlay_error_px,
};
use touchline::solve::base::BaseOptions;
use touchline::store::{Location, write_document};

/// The clicked frames of the videos.
const CLICKED: [(&str, &str); 2] = [
    ("soccer", include_str!("clicks/soccer.json")),
    ("basketball", include_str!("clicks/basketball.json")),
];

/// Both videos, every `every`-th frame asked.
pub fn videos(data: &Path, every: usize) {
    println!("\n## videos: a few clicked frames, no mask\n");
    println!(
        "| video | frames asked | answered | lowest confidence, at least .95 | painted lines support, contradict, cannot say | \
         off the way between the frames before and after, median / 90 % / worst (px) |"
    );
    println!("|---|---|---|---|---|---|");
    for (name, clicks) in CLICKED {
        video(data, name, clicks, every);
    }
}

fn video(data: &Path, name: &str, clicks: &str, every: usize) {
    let mut document = label_document(data, clicks);
    let clicked = document.frames.len();
    add_frames(&mut document, data, every);
    let store_at =
        WorkFolder::beside(&Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.json")));
    let store = FeatureStore::on_disk(&store_at);
    let pictures = FramePictures {
        document: &document,
        folder: data,
        options: FeatureOptions::default(),
        store: &store,
    };
    let mut reader = FrameReader::new();
    let training = TrainingFrames::from_solved_frames(&document).frames;
    let asked: Vec<usize> = (clicked..document.frames.len()).collect();
    let evidence = LineEvidence::from_document(document.at(data), &mut reader, false).unwrap();
    let proposals = propose_all(&pictures, &mut reader, &evidence, &training, &asked).unwrap();
    let features_s: f64 = proposals
        .iter()
        .map(|proposal| proposal.timings.features.as_secs_f64())
        .sum();
    println!(
        "<!-- features: {:.1} ms a frame, by the clock; less where they were in the store -->",
        1e3 * features_s / proposals.len() as f64
    );
    let answers: Vec<Option<&Answer>> = proposals
        .iter()
        .map(|proposal| proposal.outcome.as_ref().ok())
        .collect();
    row(&document, name, &answers);
    let mut proposed = document.clone();
    for proposal in &proposals {
        if let Err(reason) = &proposal.outcome {
            println!(
                "<!-- {}: {reason} -->",
                document.frames.by_id(&proposal.frame).unwrap().name()
            );
        }
        proposal.record(proposed.frames.by_id_mut(&proposal.frame).unwrap());
    }
    let out = Location::for_new_document(
        &Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("proposed-{name}.json")),
    )
    .unwrap();
    write_document(&out, &proposed.relocate(data, out.folder()), true).unwrap();
    println!("<!-- written: {} -->", out.file().display());
}

/// The clicked frames with the base that the program finds.
fn label_document(data: &Path, clicks: &str) -> Document {
    let mut document = document_from_bytes(clicks.as_bytes()).unwrap();
    let camera = document.cameras[0].id.clone();
    let problem = BaseProblem::from_document(document.at(data), &camera).unwrap();
    problem
        .estimate(&document, &BaseOptions::default(), &Progress::default())
        .unwrap()
        .write_camera(&mut document);
    solve_document(&mut document, data, &Progress::default()).unwrap();
    document
}

/// The frames of the video that nobody clicked.
fn add_frames(document: &mut Document, data: &Path, every: usize) {
    let first = document.frames[0].clone();
    let video = first.video.as_ref().unwrap();
    let rate = video.frame_index as f64 / video.pts_s.unwrap();
    let count = FrameSource::open(&data.join(&video.path)).unwrap().len() as u64;
    let rate = if rate.is_finite() {
        rate
    } else {
        document.frames[1]
            .video
            .as_ref()
            .map_or(25.0, |v| v.frame_index as f64 / v.pts_s.unwrap())
    };
    let known: Vec<u64> = document
        .frames
        .iter()
        .map(|frame| frame.video.as_ref().unwrap().frame_index)
        .collect();
    for index in (0..count)
        .step_by(every)
        .filter(|index| !known.contains(index))
    {
        let video = VideoFrame::new(&video.path, index, Some(index as f64 / rate));
        document
            .frames
            .push(Frame::from_video(video, first.camera.clone(), first.image_size).into());
    }
}

fn row(document: &Document, name: &str, answers: &[Option<&Answer>]) {
    let given: Vec<&Answer> = answers.iter().flatten().copied().collect();
    let lowest = given
        .iter()
        .map(|answer| answer.confidence)
        .fold(1.0, f64::min);
    let certain = given
        .iter()
        .filter(|answer| answer.confidence >= 0.95)
        .count();
    let verdicts = |verdict| {
        given
            .iter()
            .filter(|answer| {
                answer
                    .line_check
                    .is_some_and(|check| check.verdict() == verdict)
            })
            .count()
    };
    let camera = document.cameras[0].base().unwrap();
    let mut jumps: Vec<f64> = Vec::new();
    for [before, this, after] in answers.array_windows() {
        let [Some(before), Some(this), Some(after)] = [before, this, after] else {
            continue;
        };
        let [before, this, after] = [before, this, after].map(|answer| answer.ptz.ptz());
        let mut between = before;
        between.pan = before.pan + after.pan.turn_from(before.pan) * 0.5;
        between.tilt = (before.tilt + after.tilt) * 0.5;
        between.focal_px = (before.focal_px * after.focal_px).sqrt();
        let (between, this) = (
            PtzCamera::new(camera, between),
            PtzCamera::new(camera, this),
        );
        jumps.push(overlay_error_px(
            &between,
            &this,
            document.frames[0].image_size,
        ));
    }
    println!(
        "| {name} | {} | {} | {lowest:.3}, {certain} | {}, {}, {} | {:.2} / {:.2} / {:.2} |",
        answers.len(),
        given.len(),
        verdicts(LineVerdict::Supports),
        verdicts(LineVerdict::Contradicts),
        verdicts(LineVerdict::CannotSay),
        quantile(&mut jumps.clone(), 0.5),
        quantile(&mut jumps.clone(), 0.9),
        quantile(&mut jumps, 1.0),
    );
}
