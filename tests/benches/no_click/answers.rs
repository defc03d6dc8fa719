//! What was answered, held against the truth.

use std::fmt;
use std::path::Path;
use std::time::Instant;
use touchline::autocalibrate::{
    Abstention, AutocalibrationAnswer, camera_without_clicks, find_camera,
};
use touchline::calibrate::{AutocalibratedCamera, record_found};
use touchline::camera::PtzCamera;
use touchline::document::{Click, Document};
use touchline::field::{FieldLine, FieldModel, Landmark};
use touchline::geometry::{ImagePoint, ImageSize, Vec3};
use touchline::markings::project_landmarks;
use touchline::media::FrameReader;
use touchline::progress::Progress;
use touchline::proposals::read_picture;

/// Every answered frame's overlay is at most so far off at the worst place of the ground that it
/// shows, px of the picture.
const RIGHT_PX: f64 = 5.0;

/// Frames that are looked at, as the program does where nothing else is asked for.
const LOOK_AT: usize = 40;

/// How many answers were of which kind.
#[derive(Clone, Copy, Default)]
pub struct Tally {
    pub right: usize,
    pub wrong: usize,
    pub abstained: usize,
}

impl Tally {
    pub fn add(&mut self, other: &Self) {
        self.right += other.right;
        self.wrong += other.wrong;
        self.abstained += other.abstained;
    }

    /// How many inputs were asked.
    pub fn num_tried(&self) -> usize {
        self.right + self.wrong + self.abstained
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} tried: {} right, {} wrong shown as good, {} abstained",
            self.num_tried(),
            self.right,
            self.wrong,
            self.abstained
        )
    }
}

/// How an answer is asked for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// Clicks are not read.
    WithoutClicks,
    /// Clicks say where the camera stands.
    FewClicks,
}

/// The answer to a document's frames, and how long it took, s.
pub fn answer(document: &Document, folder: &Path, way: Way) -> (AutocalibrationAnswer, f64) {
    let start = Instant::now();
    let mut reader = FrameReader::new();
    let mut picture =
        |index: usize| read_picture(&mut reader, &document.frames[index], folder).ok();
    let camera = &document.cameras[0].id;
    let progress = Progress::default();
    let answer = match way {
        Way::WithoutClicks => camera_without_clicks(
            document.at(folder),
            camera,
            LOOK_AT,
            &mut picture,
            &progress,
        ),
        Way::FewClicks => find_camera(
            document.at(folder),
            camera,
            LOOK_AT,
            &mut picture,
            &progress,
        ),
    };
    let answer = answer.unwrap();
    (answer, start.elapsed().as_secs_f64())
}

/// A document with two clicks, on the two landmarks of the ground that lie farthest apart of all
/// that some frames show; people's clicks scatter.
pub fn two_clicked(
    document: &Document,
    frames: impl Iterator<Item = usize>,
    truth: &[PtzCamera],
    field: &FieldModel,
) -> Document {
    const SCATTER_PX: [(f64, f64); 2] = [(1.6, -1.2), (-0.9, 1.8)];
    let mut seen: Vec<(usize, ImagePoint, &Landmark)> = Vec::new();
    for index in frames {
        let (camera, size) = (&truth[index], document.frames[index].image_size);
        let shown = project_landmarks(field, camera, size, 0.0).into_iter();
        let shown = shown.map(|shown| (index, shown.image, &field.landmarks[shown.landmark]));
        seen.extend(shown.filter(|(_, _, landmark)| landmark.nominal_m.z == 0.0));
    }
    let apart =
        |(one, other): &(usize, usize)| (seen[*one].2.nominal_m - seen[*other].2.nominal_m).norm();
    let pairs =
        (0..seen.len()).flat_map(|one| (one + 1..seen.len()).map(move |other| (one, other)));
    let farthest = pairs.max_by(|a, b| apart(a).total_cmp(&apart(b)));
    let mut clicked = document.clone();
    for (place, (dx, dy)) in farthest
        .map(|(one, other)| [one, other])
        .into_iter()
        .flatten()
        .zip(SCATTER_PX)
    {
        let (index, image, landmark) = seen[place];
        let at = ImagePoint::new(image.x + dx, image.y + dy);
        clicked.frames[index]
            .clicks
            .push(Click::landmark(landmark.id.clone(), at));
    }
    clicked
}

/// Where a place of the real field lies on the field of an answer that assumes a length which the
/// frames do not show: as far from the end that they show. Its origin, the middle of the field, is
/// then half the difference off, and so is everything that is told from it.
fn offset_of_seen_end(
    found: &AutocalibratedCamera,
    truth: &[PtzCamera],
    field: &FieldModel,
) -> Vec3 {
    if !found
        .sizes
        .iter()
        .any(|size| size.name == "length_m" && size.is_open)
    {
        return Vec3::zeros();
    }
    let half_m = 0.5 * (found.field.length_m - field.length_m);
    let middle = |camera: &PtzCamera| camera.plane_from_image(camera.base().principal_point, 0.0);
    let x_m: f64 = truth.iter().filter_map(middle).map(|ground| ground.x).sum();
    Vec3::new(half_m * x_m.signum(), 0.0, 0.0)
}

/// How far off each answered frame is at the worst place of the ground that it shows, px.
pub fn worst_px(
    document: &Document,
    found: &AutocalibratedCamera,
    truth: &[PtzCamera],
    field: &FieldModel,
) -> Vec<(usize, f64)> {
    let moved = offset_of_seen_end(found, truth, field);
    let of_frame = |answered: AnsweredFrame| {
        let AnsweredFrame {
            index,
            size,
            camera: found,
        } = answered;
        let exact = &truth[index];
        let (columns, rows) = (8, 6);
        let pixels = (0..columns * rows).map(|place| {
            let share = |at: u32, of: u32| (f64::from(at) + 0.5) / f64::from(of);
            ImagePoint::new(
                share(place % columns, columns) * f64::from(size.width),
                share(place / columns, rows) * f64::from(size.height),
            )
        });
        let apart = |pixel: ImagePoint| {
            let on_field =
                |at: &Vec3| at.x.abs() < 0.5 * field.length_m && at.y.abs() < 0.5 * field.width_m;
            let ground = exact.plane_from_image(pixel, 0.0).filter(on_field)?;
            Some(
                found
                    .image_from_world(ground + moved)
                    .map_or(f64::INFINITY, |image| image.distance_px(pixel)),
            )
        };
        (index, pixels.filter_map(apart).fold(0.0, f64::max))
    };
    let answered = answered_frames(document, found).into_iter();
    answered.map(of_frame).collect()
}

/// A frame that an answer gives a camera, as it stands in the document.
struct AnsweredFrame {
    index: usize,
    size: ImageSize,
    camera: PtzCamera,
}

/// The frames of a document that an answer gives a camera.
fn answered_frames(document: &Document, found: &AutocalibratedCamera) -> Vec<AnsweredFrame> {
    let mut recorded = document.clone();
    let camera = document.cameras[0].id.clone();
    record_found(&mut recorded, &camera, found);
    let of_frame = |index: usize| {
        let frame = &recorded.frames[index];
        Some(AnsweredFrame {
            index,
            size: frame.image_size,
            camera: recorded.ptz_camera(frame)?,
        })
    };
    (0..recorded.frames.len()).filter_map(of_frame).collect()
}

/// How far off the lines of the answered frames are at the worst place, px: from where a line of the
/// real field is seen to the nearest point of the same line of the answer. Infinite without any
/// answered frame.
fn worst_line_px(
    document: &Document,
    found: &AutocalibratedCamera,
    truth: &[PtzCamera],
    field: &FieldModel,
) -> f64 {
    const SAMPLES: u32 = 100;
    let mut worst_px = 0.0_f64;
    let answered = answered_frames(document, found);
    let mut sizes = found.sizes.iter();
    let is_width_open = sizes.any(|size| size.name == "width_m" && size.is_open);
    // What moves with a width that is said to be open is not compared: touchlines and corner arcs.
    let moves_with_width = |line: &FieldLine| {
        is_width_open && line.curve.point_at(0.5).y.abs() > 0.5 * field.width_m - 1.5
    };
    for frame in &answered {
        for (line, mine) in field.lines.iter().zip(&found.field.lines) {
            if moves_with_width(line) {
                continue;
            }
            let seen = seen_line(&truth[frame.index], field, line, SAMPLES).into_iter();
            let drawn = seen_line(&frame.camera, &found.field, mine, 4 * SAMPLES);
            for at in seen.filter(|at| frame.size.contains(*at)) {
                worst_px = worst_px.max(distance_from_polyline_px(at, &drawn));
            }
        }
    }
    if answered.is_empty() {
        f64::INFINITY
    } else {
        worst_px
    }
}

/// Where a camera sees a line of a field, evenly sampled.
fn seen_line(
    camera: &PtzCamera,
    field: &FieldModel,
    line: &FieldLine,
    samples: u32,
) -> Vec<ImagePoint> {
    let at = |step: u32| {
        let along = f64::from(step) / f64::from(samples);
        let ground = field.world_from_nominal(line.paint_centre.point_at(along));
        camera.image_from_world(ground).ok()
    };
    (0..=samples).filter_map(at).collect()
}

/// The distance of a point from the nearest segment of a polyline, px.
fn distance_from_polyline_px(at: ImagePoint, polyline: &[ImagePoint]) -> f64 {
    polyline
        .windows(2)
        .map(|ends| at.distance_from_segment_px(ends[0], ends[1]))
        .fold(f64::INFINITY, f64::min)
}

/// What has to lie within [`RIGHT_PX`] in an answer that is right.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Measured {
    /// Every place of the ground, measured from the middle of the field.
    Ground,
    /// Every line. A field whose size is a decimetre off has its middle off as well, which a near
    /// camera sees as 20 px although all lines lie on their paint.
    Lines,
}

/// One line of a table, and what kind of answer it was. `truth` is none where nothing can be right.
pub fn judge_answer(
    document: &Document,
    answer: &AutocalibrationAnswer,
    truth: Option<(&[PtzCamera], &FieldModel)>,
    measured: Measured,
) -> (String, Tally) {
    let judge = |found: &AutocalibratedCamera| {
        let Some((truth, field)) = truth else {
            return (f64::INFINITY, "nothing is right".to_owned());
        };
        let frames = worst_px(document, found, truth, field);
        let worst_line_px = worst_line_px(document, found, truth, field);
        let moved = offset_of_seen_end(found, truth, field);
        let off =
            |exact: &PtzCamera| (found.base.position_m - exact.base().position_m - moved).norm();
        let off_m = truth.first().map_or(f64::NAN, off);
        let worst = frames
            .iter()
            .copied()
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((0, f64::INFINITY));
        let says = format!(
            "{off_m:.2} m off (σ {:.2}), size {:+.2} {:+.2} m (σ {:?}), lines {:.1} px, worst {:.1} px (frame {}), {} of {} frames answered, {} snapped, over: {}",
            found.base.sigma.position_m.norm(),
            found.field.length_m - field.length_m,
            found.field.width_m - field.width_m,
            found
                .sizes
                .iter()
                .map(|size| format!("{:.2}", size.error.sigma_m))
                .collect::<Vec<_>>(),
            worst_line_px,
            worst.1,
            worst.0,
            frames.len(),
            truth.len(),
            found.aligned_frame_count(),
            over(&frames, found),
        );
        let px = match measured {
            Measured::Ground => worst.1,
            Measured::Lines => worst_line_px,
        };
        (px, format!("{says}; {}", speaks(found)))
    };
    match answer {
        AutocalibrationAnswer::Found(found) => {
            let (worst, says) = judge(found);
            let right = worst <= RIGHT_PX;
            let tally = Tally {
                right: usize::from(right),
                wrong: usize::from(!right),
                ..Tally::default()
            };
            (
                format!("{}: {says}", if right { "right" } else { "WRONG" }),
                tally,
            )
        }
        AutocalibrationAnswer::Abstained { why, .. } => {
            let best = match why {
                Abstention::Uncertain {
                    best: Some(best), ..
                } => judge(best).1,
                _ => String::new(),
            };
            (
                format!("abstained: {why} [{best}]"),
                Tally {
                    abstained: 1,
                    ..Tally::default()
                },
            )
        }
    }
}

/// The frames that are not right.
fn over(frames: &[(usize, f64)], found: &AutocalibratedCamera) -> String {
    let is_snapped = |index: usize| {
        found
            .frames
            .iter()
            .any(|frame| frame.index == index && frame.snapped.is_some())
    };
    let over: Vec<String> = frames
        .iter()
        .filter(|(_, px)| *px > RIGHT_PX)
        .map(|(index, px)| {
            format!(
                "{index}{}={px:.1}",
                if is_snapped(*index) { "s" } else { "" }
            )
        })
        .collect();
    if over.is_empty() {
        "none".to_owned()
    } else {
        over.join(" ")
    }
}

/// What speaks for an answer.
fn speaks(found: &AutocalibratedCamera) -> String {
    let evidence = &found.evidence;
    format!(
        "{:.0} nats (next {:.0}), explained {:.2}, visible {:.2}, {} lines, {:.2} px, parts {:.2} m",
        evidence.nats,
        evidence.runner_up_nats.unwrap_or(f64::NAN),
        evidence.explained,
        evidence.visible,
        evidence.lines.len(),
        evidence.residual_px,
        evidence.parts_m
    )
}
