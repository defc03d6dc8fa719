//! Synthetic frames along the motion of a real broadcast camera. A few of them train a forest,
//! which relocalizes the others.

use crate::progress::{Progress, step_counter};
use crate::report::Report;
use crate::report::statistics::range_of;
use crate::scoring::answers::{FoundCamera, FrameAnswer, Tally, frame_table, tally_table};
use crate::scoring::forests::{ForestKind, Trained};
use crate::sets::{FrameSet, MOTION_FILE, RealMotion, motion};
use crate::{ExperimentError, ExperimentOptions};
use std::path::Path;
use touchline::camera::Ptz;
use touchline::document::{Camera, Document, FieldSpec, Frame, FramePtz};
use touchline::evaluate::{evaluate, evaluation_tables};
use touchline::geometry::AngleRange;
use touchline::report::Table;
use touchline::report::figure::{Axis, Figure, Line, Mark, Series};

/// Runs the experiment on the motion in a folder.
///
/// # Errors
/// The motion cannot be read, or the frames cannot be drawn.
pub fn run(
    options: &ExperimentOptions,
    folder: &Path,
    progress: Progress,
) -> Result<Report, ExperimentError> {
    let real = RealMotion::read(&folder.join(MOTION_FILE))?;
    let stride = options.full_or_quick(1, 22);
    let every = options.full_or_quick(30, 3);
    let drawn = real.ptz.len().div_ceil(stride);
    let set = motion(
        &real,
        [stride, every],
        options,
        &step_counter(drawn, progress),
    )?;
    let kind = ForestKind::Default;
    let mut answers =
        Trained::train(&set, 0, &kind.training(set.seed)).ask_plainly(&kind.asking(set.seed));
    // Curves over time need the order of the frames, and answers come by split.
    answers.sort_by_key(|answer| answer.frame);

    let mut report = Report::new("motion", "Motion: a real broadcast camera's path, drawn");
    let place = real.base.position_m;
    report.text(&format!(
        "Frames: {}. {} The camera and its pan, tilt and focal length are those of {} consecutive frames published with \
         \"Pan-tilt-zoom SLAM for Sports Videos\" (Lu, Chen, Little, BMVC 2019); it stands low behind a corner, {:.1} m along \
         and {:.1} m across from the centre mark, {:.1} m up. The pictures are drawn: their truth is exact, and what is found \
         in them says nothing of how real pictures look.",
        set.title,
        set.protocol,
        real.ptz.len(),
        place.x,
        place.y,
        place.z
    ));
    let pans = AngleRange::smallest(real.ptz.iter().map(|ptz| ptz.pan)).unwrap_or(AngleRange::FULL);
    // Unwrapped within the arc of the whole motion, so that a curve does not jump at ±180°.
    let pan_deg = |ptz: &Ptz| pans.unwrap_angle(ptz.pan).degrees();
    report.table("path", "The motion.", path_table(&real.ptz, &pan_deg));
    report.table(
        "all",
        "All tested frames.",
        tally_table(
            ("set", "set"),
            &[("drawn".into(), Tally::from_answers(answers.iter()))],
        ),
    );
    report.data(
        "frames",
        "Every tested frame.",
        frame_table(std::slice::from_ref(&set), [("default", &answers[..])]),
    );
    report.text(&evaluation_text(&set, &answers)?);
    // The number in the published file, of which every `stride`-th frame is drawn.
    let number = |frame: usize| (frame * stride) as f64;
    for (stem, label, of) in [
        ("pan", "pan (°)", &pan_deg as &dyn Fn(&Ptz) -> f64),
        ("tilt", "tilt (°)", &|ptz| ptz.tilt.degrees()),
        ("focal", "focal length (px)", &|ptz| ptz.focal_px),
    ] {
        let truth = set
            .frames
            .iter()
            .enumerate()
            .map(|(frame, known)| [number(frame), of(&known.truth.ptz())]);
        let taught = set.splits[0]
            .training_frames
            .iter()
            .map(|&frame| [number(frame), of(&set.frames[frame].truth.ptz())]);
        let answers = answers
            .iter()
            .filter_map(|answer| Some([number(answer.frame), of(&answer.found?.camera.ptz())]));
        // In a full run, one answer in ten: more marks would hide the curve.
        let answers = answers.step_by(options.full_or_quick(10, 1));
        let figure = Figure::new("", Axis::linear("frame"), Axis::linear(label))
            .with(Series::new("truth", 0, truth.collect()).with_mark(Mark::None))
            .with(
                Series::new("training", 3, taught.collect())
                    .with_line(Line::None)
                    .with_mark(Mark::Square),
            )
            .with(
                Series::new("answer", 2, answers.collect())
                    .with_line(Line::None)
                    .with_mark(Mark::Cross),
            );
        let caption = format!(
            "The {label} of the drawn frames, and the answers (of many, one in ten is shown)."
        );
        report.figure(stem, &caption, figure);
    }
    for (stem, label, of) in [
        (
            "rotation",
            "rotation error (°)",
            (|found| Some(found.error.rotation.degrees())) as fn(&FoundCamera) -> Option<f64>,
        ),
        ("focal-error", "focal length error (px)", |found| {
            Some(found.error.focal_px.abs())
        }),
        ("iou", "1 − IoU", |found| Some(1.0 - found.iou?)),
    ] {
        let points = answers
            .iter()
            .filter_map(|answer| Some([number(answer.frame), of(&answer.found?)?]));
        let figure = Figure::new("", Axis::linear("frame"), Axis::log(label))
            .with(Series::new("", 1, points.collect()).with_mark(Mark::None));
        report.figure(stem, &format!("Drawn frames: {label} over time."), figure);
    }
    Ok(report)
}

/// The range of each parameter and its largest step. `pan_deg` gives a pan that is continuous
/// across ±180°.
fn path_table(ptz: &[Ptz], pan_deg: &dyn Fn(&Ptz) -> f64) -> Table {
    let mut table = Table::new(&[
        ("parameter", "parameter"),
        ("least", "least"),
        ("greatest", "greatest"),
        ("step", "largest change between frames"),
    ]);
    for (name, of) in [
        ("pan (°)", pan_deg),
        ("tilt (°)", &|ptz: &Ptz| ptz.tilt.degrees()),
        ("focal length (px)", &|ptz: &Ptz| ptz.focal_px),
    ] {
        let values: Vec<f64> = ptz.iter().map(of).collect();
        let [least, greatest] = range_of(values.iter().copied());
        let step = values
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).abs())
            .fold(0.0, f64::max);
        table.push(vec![
            name.into(),
            least.into(),
            greatest.into(),
            step.into(),
        ]);
    }
    table
}

/// The results as `touchline evaluate` measures them.
fn evaluation_text(set: &FrameSet, answers: &[FrameAnswer]) -> Result<String, ExperimentError> {
    let Some(known) = set.frames.first() else {
        return Ok(String::new());
    };
    // Two documents as a user would have them, with the truth and with the answers. `evaluate` then
    // measures by its own code, apart from the errors above.
    let mut field = FieldSpec::new("soccer");
    field.params.extend([
        ("length_m".to_owned(), known.field.length_m),
        ("width_m".to_owned(), known.field.width_m),
    ]);
    let size = known.features.image_size;
    let mut camera = Camera::new("drawn".into(), size);
    camera.set_base(known.truth.base());
    let mut documents = [(); 2].map(|()| Document::new(field.clone()));
    for document in &mut documents {
        document.cameras.push(camera.clone().into());
    }
    let [truth, estimate] = &mut documents;
    for answer in answers {
        let frame = Frame::from_image(&format!("{}.jpg", answer.frame), camera.id.clone(), size);
        let pointed = |ptz: Ptz| Frame {
            ptz: Some(FramePtz::new(ptz, None)),
            ..frame.clone()
        };
        truth
            .frames
            .push(pointed(set.frames[answer.frame].truth.ptz()).into());
        estimate
            .frames
            // A refused frame is missing in the estimate, which lowers the completeness.
            .extend(answer.found.map(|found| pointed(found.camera.ptz()).into()));
    }
    let evaluation = evaluate(truth.at(Path::new("")), estimate.at(Path::new("")))?;
    let tables = evaluation_tables(&evaluation.groups(0)[..1], Table::to_markdown);
    Ok(format!("As `touchline evaluate` measures it: {tables}"))
}
