//! Real frames. People's clicks measure the answers; the method is given the pictures alone.

use super::answers::{Measured, Tally, Way, answer, judge_answer};
use super::gate::Rate;
use super::video_document::document_of_video;
use std::path::Path;
use touchline::autocalibrate::{Abstention, AutocalibrationAnswer};
use touchline::calibrate::{
    AutocalibratedCamera, BaseProblem, observations, record_found, solve_document,
};
use touchline::document::{CameraId, Clip, Document, FieldSpec, Frame, Frames};
use touchline::media::FrameSource;
use touchline::progress::Progress;
use touchline::solve::base::BaseOptions;
use touchline::store::read;

/// The matches.
const MATCHES: [&str; 3] = ["d82e7a", "08fd33", "42ba34"];

/// Whole matches have frames enough: one that is not found is a loss.
pub const MATCHES_RATE: Rate = Rate {
    tried: MATCHES.len(),
    right: MATCHES.len(),
    wrong: 0,
};

/// Videos and mixed frames: nobody has measured the former, and the latter may be refused.
pub const OTHERS_RATE: Rate = Rate::never_wrong(5);

/// Two clips show too little for an answer: one has two frames, the other no end of the pitch.
/// Those that are right stay right.
pub const CLIPS_RATE: Rate = Rate {
    tried: 18,
    right: 16,
    wrong: 0,
};

/// A frame whose clicks have near and far mixed up throughout: nothing can be measured against it.
const MIRRORED: &str = "42ba34_9_2";

/// An answer is right if it stands so near to the base of the clicks, m, and the median of its
/// distances at them is so small, px.
pub const RIGHT_M: f64 = 2.0;
const RIGHT_PX: f64 = 5.0;

/// A match with people's clicks, and the same without anything that people did.
struct Clicked {
    clicked: Document,
    bare: Document,
}

impl Clicked {
    /// A match, or one clip of it. The base comes from all clicks of the match.
    fn of(data: &Path, name: &str, clip: Option<&Clip>) -> Self {
        let folder = folder(data, name);
        let mut clicked = read(&folder.join("clicks.json")).unwrap().1;
        let camera = clicked.cameras[0].id.clone();
        let problem = BaseProblem::from_document(clicked.at(&folder), &camera).unwrap();
        problem
            .estimate(&clicked, &BaseOptions::default(), &Progress::default())
            .unwrap()
            .write_camera(&mut clicked);
        solve_document(&mut clicked, &folder, &Progress::default()).unwrap();
        if let Some(clip) = clip {
            clicked
                .frames
                .retain(|frame| frame.clip.as_ref() == Some(clip));
        }
        let bare = without_people(&clicked);
        Self { clicked, bare }
    }

    /// The distances at people's clicks, px, frame by frame: on the field that the document says.
    fn distances(&self, document: &Document, folder: &Path) -> Vec<(String, Vec<f64>)> {
        let field = document.at(folder).model_of(&document.field).unwrap();
        let of_frame = |(frame, clicked): (&Frame, &Frame)| {
            let camera = document.ptz_camera(frame)?;
            let seen = observations(clicked, &field).unwrap();
            Some((
                frame.name(),
                seen.iter()
                    .filter_map(|seen| seen.distance_px(&camera))
                    .collect(),
            ))
        };
        let frames = document.frames.iter().zip(&self.clicked.frames);
        let measured = frames.filter(|(frame, _)| !frame.name().contains(MIRRORED));
        measured
            .filter_map(|(frame, clicked)| of_frame((frame, clicked)))
            .collect()
    }

    fn judge(&self, found: &AutocalibratedCamera, folder: &Path) -> (bool, String) {
        let mut recorded = self.bare.clone();
        let camera = recorded.cameras[0].id.clone();
        record_found(&mut recorded, &camera, found);
        let (found_px, clicked_px) = (
            self.distances(&recorded, folder),
            self.distances(&self.clicked, folder),
        );
        let all = |frames: &[(String, Vec<f64>)]| {
            frames
                .iter()
                .flat_map(|(_, px)| px.clone())
                .collect::<Vec<_>>()
        };
        let [median, most] = [0.5, 0.9].map(|share| quantile(all(&found_px), share));
        let [clicked_median, clicked_most] =
            [0.5, 0.9].map(|share| quantile(all(&clicked_px), share));
        let far: Vec<String> = found_px
            .iter()
            .map(|(name, px)| (name, quantile(px.clone(), 0.5)))
            .filter(|(_, px)| *px > 10.0)
            .map(|(name, px)| format!("{name} {px:.1}"))
            .collect();
        let exact = self.clicked.cameras[0].base().unwrap().position_m;
        let off_m = (found.base.position_m - exact).norm();
        let says = format!(
            "{off_m:.2} m off (σ {:.2}), field {:.1} × {:.1} m, {median:.2} / {most:.2} px at {} clicks (base from clicks {clicked_median:.2} / \
             {clicked_most:.2}), {} of {} frames, {} snapped, {:.0} nats (next {:.0}), explained {:.2}, visible {:.2}, paint {:.2} px, parts {:.2} m, over 10 px: {far:?}",
            found.base.sigma.position_m.norm(),
            found.field.length_m,
            found.field.width_m,
            all(&found_px).len(),
            found.frames.len(),
            self.bare.frames.len(),
            found.aligned_frame_count(),
            found.evidence.nats,
            found.evidence.runner_up_nats.unwrap_or(f64::NAN),
            found.evidence.explained,
            found.evidence.visible,
            found.evidence.residual_px,
            found.evidence.parts_m,
        );
        (off_m <= RIGHT_M && median <= RIGHT_PX, says)
    }

    /// One line of a table, and what kind of answer it was.
    fn print_answer(&self, name: &str, folder: &Path) -> Tally {
        let (answer, seconds) = answer(&self.bare, folder, Way::WithoutClicks);
        let mut tally = Tally::default();
        let says = match &answer {
            AutocalibrationAnswer::Found(found) => {
                let (right, says) = self.judge(found, folder);
                (tally.right, tally.wrong) = (usize::from(right), usize::from(!right));
                format!("{}: {says}", if right { "right" } else { "WRONG" })
            }
            AutocalibrationAnswer::Abstained { why, .. } => {
                tally.abstained = 1;
                let best = match why {
                    Abstention::Uncertain {
                        best: Some(best), ..
                    } => self.judge(best, folder).1,
                    _ => String::new(),
                };
                format!("abstained: {why} [{best}]")
            }
        };
        println!(
            "| {name} | {} | {says} | {seconds:.0} |",
            self.bare.frames.len()
        );
        tally
    }
}

fn folder(data: &Path, name: &str) -> std::path::PathBuf {
    data.join(format!("scouting-{name}"))
}

fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = (share * values.len().saturating_sub(1) as f64).round() as usize;
    values.get(at).copied().unwrap_or(f64::NAN)
}

/// A document of the same frames in which nobody did anything.
fn without_people(document: &Document) -> Document {
    let mut bare = Document::new(document.field.clone());
    let camera = &document.cameras[0];
    bare.cameras
        .push(touchline::document::Camera::new(camera.id.clone(), camera.image_size).into());
    for frame in &document.frames {
        let image = frame.image.as_deref().unwrap();
        bare.frames
            .push(Frame::from_image(image, camera.id.clone(), frame.image_size).into());
    }
    bare
}

/// Begins a table of answers.
pub fn heading(name: &str) {
    println!("\n## {name}\n\n| frames of | frames | answer | s |\n|---|---|---|---|");
}

/// Whole matches.
pub fn matches(data: &Path) -> Tally {
    heading("real matches");
    let mut all = Tally::default();
    for name in MATCHES {
        all.add(&Clicked::of(data, name, None).print_answer(name, &folder(data, name)));
    }
    println!("\n{all}");
    all
}

/// Each clip alone.
pub fn clips(data: &Path) -> Tally {
    heading("real clips");
    let mut all = Tally::default();
    for name in MATCHES {
        let whole = Clicked::of(data, name, None);
        let mut clips: Vec<Clip> = whole
            .clicked
            .frames
            .iter()
            .filter_map(|frame| frame.clip.clone())
            .collect();
        clips.sort();
        clips.dedup();
        for clip in clips {
            let of_clip = Clicked::of(data, name, Some(&clip));
            all.add(&of_clip.print_answer(&format!("{name} clip {clip}"), &folder(data, name)));
        }
    }
    println!("\n{all}");
    all
}

/// Videos, and two matches in one folder. Where nothing measures an answer it is printed and not
/// counted.
pub fn others(data: &Path) -> Tally {
    heading("other real frames");
    let mut all = Tally::default();
    for (name, video, field, can_be_right) in [
        ("video-soccer", "video-soccer/match.mp4", "soccer", true),
        (
            "video-basketball",
            "video-basketball/clip.mp4",
            "basketball_nba",
            true,
        ),
        (
            "video-basketball as soccer",
            "video-basketball/clip.mp4",
            "soccer",
            false,
        ),
        (
            "video-soccer as basketball",
            "video-soccer/match.mp4",
            "basketball_nba",
            false,
        ),
    ] {
        let FrameSource::Video(info) = FrameSource::open(&data.join(video)).unwrap() else {
            continue;
        };
        let stride = (info.decoded_frames / 40).max(1);
        let document = document_of_video(video, &info, FieldSpec::new(field), stride);
        let (answer, seconds) = answer(&document, data, Way::WithoutClicks);
        let (says, tally) = judge_answer(&document, &answer, None, Measured::Ground);
        let says = if let (true, AutocalibrationAnswer::Found(found)) = (can_be_right, &answer) {
            let at_m: Vec<String> = found
                .base
                .position_m
                .iter()
                .map(|m| format!("{m:.2}"))
                .collect();
            format!(
                "camera at ({}) m, whose panorama has to be looked at",
                at_m.join(", ")
            )
        } else {
            says
        };
        println!(
            "| {name} | {} | {says} | {seconds:.0} |",
            document.frames.len()
        );
        if !(can_be_right && tally.wrong > 0) {
            all.add(&tally);
        }
    }
    let mixed = mixed_matches(data);
    let (answer, seconds) = answer(&mixed, data, Way::WithoutClicks);
    let (says, tally) = match &answer {
        AutocalibrationAnswer::Found(found) => of_one_match(data, &mixed, found),
        _ => judge_answer(&mixed, &answer, None, Measured::Ground),
    };
    println!(
        "| d82e7a and 08fd33 mixed | {} | {says} | {seconds:.0} |",
        mixed.frames.len()
    );
    all.add(&tally);
    println!("\n{all}");
    all
}

/// Frames of two matches as one camera's.
fn mixed_matches(data: &Path) -> Document {
    let mut mixed: Option<Document> = None;
    for name in ["d82e7a", "08fd33"] {
        let bare = Clicked::of(data, name, None).bare;
        let into = mixed.get_or_insert_with(|| Document {
            frames: Frames::default(),
            ..bare.clone()
        });
        for frame in &bare.frames {
            let image = format!("scouting-{name}/{}", frame.image.as_deref().unwrap());
            into.frames
                .push(Frame::from_image(&image, frame.camera.clone(), frame.image_size).into());
        }
    }
    mixed.unwrap()
}

/// An answer to mixed frames is right if its frames are of one match and its base is that match's.
fn of_one_match(data: &Path, mixed: &Document, found: &AutocalibratedCamera) -> (String, Tally) {
    let of = |name: &str| {
        found
            .frames
            .iter()
            .filter(|frame| mixed.frames[frame.index].name().contains(name))
            .count()
    };
    let counts = ["d82e7a", "08fd33"].map(of);
    let name = if counts[0] >= counts[1] {
        "d82e7a"
    } else {
        "08fd33"
    };
    let exact = Clicked::of(data, name, None)
        .clicked
        .camera(&CameraId::from("main"))
        .unwrap()
        .base()
        .unwrap();
    let off_m = (found.base.position_m - exact.position_m).norm();
    let right = counts.contains(&0) && off_m <= RIGHT_M;
    let says = format!(
        "{}: frames of each {counts:?}, {off_m:.2} m off",
        if right { "right" } else { "WRONG" }
    );
    (
        says,
        Tally {
            right: usize::from(right),
            wrong: usize::from(!right),
            ..Tally::default()
        },
    )
}
