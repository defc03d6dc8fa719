//! Export of clicks to a foreign format, verified by reading them back.

use super::choose::{NOT_SOLVED, is_chosen, nothing, other_proportions, refuse_same_names};
use super::exported::Exported;
use crate::document::{Click, DocumentAt, Fields, Frame, FrameStatus, Target};
use crate::exchange::cameras::camera_format::file_stem;
use crate::exchange::cameras::picture_size::has_same_proportions;
use crate::exchange::click_formats::clicked_frame::{
    ClickContext, ClickFormat, ClickedFrame, LabelReading, LabelledFrame, read_labels,
};
use crate::exchange::click_formats::labels::Meaning;
use crate::exchange::error::ExchangeError;
use crate::exchange::files::{Files, base_name};
use crate::exchange::format::Format;
use crate::exchange::imports::import_clicks::{drop_repeated_landmarks, note_repeated};
use crate::exchange::options::{ExportOptions, ImportOptions, PointSource};
use std::collections::BTreeMap;
use std::sync::Arc;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, pluralise};
use touchline_core::markings::{MarkingOptions, project_landmarks, project_lines};

/// The number of points of a curve that is written as a line: about as many as `SoccerNet`'s
/// annotators set on a circle.
const CURVE_POINTS: usize = 9;

/// The clicks of a document in a format, verified by reading them back.
///
/// # Errors
/// There is nothing to export, two frames would have one name, or the files do not read back as
/// they were meant.
pub fn export_clicks(
    at: DocumentAt<'_>,
    format: Format,
    click_format: &dyn ClickFormat,
    options: &ExportOptions,
) -> Result<Exported, ExchangeError> {
    let (document, fields) = (at.document, Fields::from_document(at)?);
    let mut left_out = Vec::new();
    let mut of_field: Option<Arc<FieldModel>> = None;
    let mut chosen: Vec<ClickedFrame> = Vec::new();
    for frame in document
        .frames
        .iter()
        .filter(|frame| is_chosen(frame, &options.frames))
    {
        let field = fields.for_frame(document, frame);
        // The points, and why there are none if that is so.
        let (clicks, why_none): (Vec<Click>, &str) = match options.points {
            PointSource::Clicked => clicks_of(frame),
            PointSource::Projected => match document.ptz_camera(frame) {
                Some(camera) => (
                    project_to_clicks(field, &camera, frame.image_size),
                    "its camera shows nothing of the field",
                ),
                None => (Vec::new(), NOT_SOLVED),
            },
        };
        // Labels are names of one sport; the size of the field does not matter to them.
        let is_other_sport = of_field
            .as_ref()
            .is_some_and(|known| known.template != field.template);
        if clicks.is_empty() || is_other_sport {
            let why = if clicks.is_empty() {
                why_none
            } else {
                "it shows another sport"
            };
            left_out.push((frame.name(), why.to_owned()));
            continue;
        }
        let shown = ClickedFrame {
            name: String::new(),
            image: file_of(frame),
            size: frame.image_size,
            clicks,
        };
        match rescale(shown, options.size) {
            Ok(shown) => chosen.push(shown),
            Err(why) => {
                left_out.push((frame.name(), why));
                continue;
            }
        }
        of_field.get_or_insert_with(|| Arc::clone(field));
    }
    let Some(field) = of_field else {
        return Err(nothing(format, &left_out));
    };
    let context = ClickContext {
        options,
        field: &field,
    };
    // Only clicks that the format can store are compared with what is read back; the notes count
    // the others. The name in the format may depend on the image, so that it is set here.
    let mut dropped = Dropped::default();
    let mut twice = BTreeMap::new();
    for frame in &mut chosen {
        frame.name = click_format.name_of(frame);
        let size = frame.size;
        frame
            .clicks
            .retain(|click| dropped.keeps(click, size, click_format, &context));
        if !click_format.holds_repeated_landmarks() {
            drop_repeated_landmarks(&mut frame.clicks, &mut twice);
        }
    }
    // A frame without a label left would be an example of a picture that shows no field.
    let emptied = chosen.extract_if(.., |frame| frame.clicks.is_empty());
    left_out.extend(emptied.map(|frame| {
        let why = format!("none of its clicks can be written as {format}");
        (frame.image, why)
    }));
    if chosen.is_empty() {
        return Err(nothing(format, &left_out));
    }

    // Names must be unique, because the files are verified by name.
    let names = chosen.iter();
    refuse_same_names(names.map(|frame| (frame.name.as_str(), frame.image.as_str())))?;
    let files = click_format.write(&chosen, &context)?;
    let worst_px = prove(format, click_format, &files, &chosen, &context)?;
    let mut notes = dropped.notes(format, click_format);
    if options.size.is_some() && click_format.has_shares_alone() {
        notes.push("points are shares of the picture, the same for every size".to_owned());
    }
    notes.extend(note_repeated(&twice));
    Ok(Exported {
        format,
        frames: chosen.len(),
        left_out,
        loss: None,
        notes,
        worst_px,
        in_takes: false,
        dataset: None,
        files,
    })
}

/// The clicks of a frame that are a person's or that a person accepted, and why there are none if
/// that is so.
fn clicks_of(frame: &Frame) -> (Vec<Click>, &'static str) {
    let is_accepted = frame.status == FrameStatus::Reference;
    let labels = frame
        .clicks
        .iter()
        .filter(|click| click.target.is_some() && (is_accepted || !click.is_by_model()));
    let why_none = if frame.has_points_of_models_alone() {
        "it has points of a model alone, which no person accepted"
    } else {
        "it has no clicks"
    };
    (labels.cloned().collect(), why_none)
}

/// A frame with its clicks on a picture of another size, or why that is not possible.
fn rescale(frame: ClickedFrame, size: Option<ImageSize>) -> Result<ClickedFrame, String> {
    let Some(size) = size.filter(|size| *size != frame.size) else {
        return Ok(frame);
    };
    if !has_same_proportions(size, frame.size) {
        return Err(other_proportions(frame.size));
    }
    let factor = f64::from(size.width) / f64::from(frame.size.width);
    let clicks = frame.clicks.into_iter();
    let clicks = clicks.map(|click| Click {
        image: ImagePoint::new(click.image.x * factor, click.image.y * factor),
        ..click
    });
    Ok(ClickedFrame {
        clicks: clicks.collect(),
        size,
        ..frame
    })
}

/// The file name of a frame's picture.
fn file_of(frame: &Frame) -> String {
    if let Some(image) = &frame.image {
        return base_name(image).to_owned();
    }
    let video = frame.video.as_ref();
    let stem = video.map(|video| file_stem(&video.path));
    format!(
        "{}_{:06}.jpg",
        stem.unwrap_or_default(),
        video.map_or(0, |video| video.frame_index)
    )
}

/// Landmarks and points of lines as a camera projects them.
fn project_to_clicks(field: &FieldModel, camera: &PtzCamera, size: ImageSize) -> Vec<Click> {
    let landmarks = project_landmarks(field, camera, size, 0.0).into_iter();
    let landmarks = landmarks
        .map(|shown| Click::landmark(field.landmarks[shown.landmark].id.clone(), shown.image));
    // Only what lies in the picture, as a person could have clicked it.
    let within = MarkingOptions {
        margin_px: 0.0,
        ..MarkingOptions::default()
    };
    let lines = project_lines(field, camera, size, &within);
    let lines = lines.iter().flat_map(|polyline| {
        let id = &field.lines[polyline.line].id;
        subsample_polyline(&polyline.points)
            .into_iter()
            .map(move |point| Click::line(id.clone(), point))
    });
    landmarks.chain(lines).collect()
}

/// A subsample of a polyline: its ends, and points evenly spaced over its vertices.
fn subsample_polyline(points: &[ImagePoint]) -> Vec<ImagePoint> {
    // Whole steps among the vertices, with both ends: of `last` = 20 and 8 steps the vertices 0, 2,
    // 5, 7, 10, 12, 15, 17, 20. A straight line has two vertices, which both stay.
    let last = points.len().saturating_sub(1);
    let steps = last.min(CURVE_POINTS - 1);
    (0..=steps)
        .filter_map(|step| points.get(step * last / steps.max(1)).copied())
        .collect()
}

/// The clicks that a format cannot store.
#[derive(Default)]
struct Dropped {
    kind: usize,
    outside: usize,
    checks: usize,
}

impl Dropped {
    fn keeps(
        &mut self,
        click: &Click,
        size: ImageSize,
        format: &dyn ClickFormat,
        context: &ClickContext<'_>,
    ) -> bool {
        if !format.holds(click, context) {
            self.kind += 1;
            return false;
        }
        let keeps_outside = context.options.keep_outside && format.holds_outside();
        if !keeps_outside && !size.contains(click.image) {
            self.outside += 1;
            return false;
        }
        self.checks += usize::from(click.check);
        true
    }

    fn notes(&self, format: Format, click_format: &dyn ClickFormat) -> Vec<String> {
        let hint = if click_format.holds_outside() {
            " (--outside keep)"
        } else {
            ""
        };
        [
            (
                self.kind,
                "click",
                format!("on something that {format} has no name for, left out"),
            ),
            (
                self.outside,
                "click",
                format!("outside of the picture, left out{hint}"),
            ),
            (
                self.checks,
                "check click",
                format!("not marked as such, because {format} cannot"),
            ),
        ]
        .into_iter()
        .filter(|(count, ..)| *count > 0)
        .map(|(count, what, how)| format!("{} {how}", pluralise(count, what)))
        .collect()
    }
}

/// Reads the files back and compares every click. Returns the largest distance, px.
fn prove(
    format: Format,
    click_format: &dyn ClickFormat,
    files: &Files,
    frames: &[ClickedFrame],
    context: &ClickContext<'_>,
) -> Result<f64, ExchangeError> {
    // Formats ask for the size of a picture by the frame's name or by the picture's.
    let sizes: BTreeMap<&str, ImageSize> = frames
        .iter()
        .flat_map(|frame| [&frame.name, &frame.image].map(|name| (name.as_str(), frame.size)))
        .collect();
    let reading = LabelReading {
        options: &ImportOptions::default(),
        sizes: &|name| sizes.get(name).copied(),
    };
    let (read, _) = read_labels(click_format, files, &reading)?;
    let by_name: BTreeMap<&str, &LabelledFrame> = read
        .iter()
        .map(|frame| (frame.name.as_str(), frame))
        .collect();
    let labels = click_format.own_labels();
    let mut worst_px = 0.0_f64;
    for frame in frames {
        let again = by_name
            .get(frame.name.as_str())
            .ok_or_else(|| reads_back_otherwise(frame, format))?;
        let mut left: Vec<(Target, ImagePoint)> = Vec::new();
        for mark in &again.marks {
            match labels.meaning(&mark.label, context.field)? {
                Meaning::Target(target) => left.push((target, mark.image)),
                Meaning::Nothing | Meaning::Unknown => {
                    return Err(reads_back_otherwise(frame, format));
                }
            }
        }
        for click in &frame.clicks {
            // A line has several clicks with one name, so each click is matched with the nearest
            // mark of its name.
            let nearest = (0..left.len())
                .min_by(|a, b| {
                    distance_px(&left[*a], click).total_cmp(&distance_px(&left[*b], click))
                })
                .ok_or_else(|| reads_back_otherwise(frame, format))?;
            // A mark on something else is infinitely far away, so that a missing one fails the test
            // below.
            let off_px = distance_px(&left.swap_remove(nearest), click);
            let allowed_px = click_format.resolution_px();
            if !(off_px <= allowed_px) {
                let what = click
                    .target
                    .as_ref()
                    .map(|target| target.as_str().to_owned())
                    .unwrap_or_default();
                return Err(ExchangeError::ReadsBackElsewhere {
                    frame: frame.image.clone(),
                    format,
                    what,
                    off_px,
                    allowed_px,
                });
            }
            worst_px = worst_px.max(off_px);
        }
        // A mark that no click gave.
        if !left.is_empty() {
            return Err(reads_back_otherwise(frame, format));
        }
    }
    Ok(worst_px)
}

/// The error that the marks of a frame are not those that were written.
fn reads_back_otherwise(frame: &ClickedFrame, format: Format) -> ExchangeError {
    ExchangeError::ReadsBackOtherwise {
        frame: frame.image.clone(),
        format,
    }
}

/// The distance of a mark from a click, px; infinite if it is on something else.
fn distance_px((target, point): &(Target, ImagePoint), click: &Click) -> f64 {
    if Some(target) == click.target.as_ref() {
        point.distance_px(click.image)
    } else {
        f64::INFINITY
    }
}
