//! The dataset card: what a new user must know before using the dataset.

use super::frames_table::count_clicks;
use super::matches::match_names;
use super::options::{DatasetOptions, Pictures};
use super::plan::{DatasetDone, PlannedFrame};
use super::split::{Split, match_of};
use crate::document::{Click, DocumentAt, FieldSize, Fields, Frame, FramePtz, Frames, Solution};
use crate::exchange::error::ExchangeError;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use touchline_core::field::FieldModel;
use touchline_core::geometry::quantile;

/// The inputs of the card.
pub struct Card<'a> {
    /// The document of the dataset.
    pub dataset: DocumentAt<'a>,
    /// The original document, with the original paths of the frames.
    pub original: DocumentAt<'a>,
    /// The frames of the dataset.
    pub frames: &'a [&'a PlannedFrame],
    /// The options of the dataset.
    pub options: &'a DatasetOptions,
    /// What was written.
    pub done: &'a DatasetDone,
}

/// The card as Markdown.
///
/// # Errors
/// The document's field is not valid.
pub fn card(card: &Card<'_>) -> Result<String, ExchangeError> {
    let fields = Fields::from_document(card.original)?;
    let mut text = String::from("# Camera calibration dataset\n");
    text.push_str(
        "\nFrames of pan-tilt-zoom sports cameras with people's clicks on the field and each frame's camera. `dataset.json` is the \
         whole of it (schema: `schema.json`); `touchline_dataset.py` reads it with numpy; `sha256sum -c manifest.sha256` checks it.\n",
    );
    counts(card, &mut text);
    fields_of(card, &fields, &mut text);
    text.push_str(CONVENTIONS);
    if card.options.undistorted {
        text.push_str(
            "- `undistorted/` has the same pictures without lens distortion (same size, focal length and principal point; black where the lens saw nothing) and a `dataset.json` of its own, with clicks moved accordingly and cameras without distortion.\n",
        );
    }
    quality(card, &fields, &mut text);
    provenance(card, &mut text);
    Ok(text)
}

const CONVENTIONS: &str = "\n## Conventions\n
- World: origin at the field's centre, x right along its length seen from the main camera, y away from that camera, z up, metres.
- Pixels: (0, 0) is the top-left corner of the picture, pixel centres at +0.5. OpenCV and COCO count from the first pixel's centre: take 0.5 off.
- x_cam = R (X - C); camera x right, y down, z forward. R = R_tilt R_pan base_from_world; pan positive right, tilt positive up, degrees.
- Distortion: x_d = x (1 + k1 r^2 + k2 r^4) on normalised coordinates.
- `label` in `frames.csv`: `clicked` (a person's clicks), `snapped` (aligned to the painted lines), `tracked`, `suggested` (neither looked at by a person), \
`tracked_and_accepted`, `suggested_and_accepted` (proposed by the program, accepted by a person), \
`points`, `points_and_accepted` (of another program's model), `imported`, `set_by_hand`, `interpolated`, \
`clicks_only` (no camera). A click with `snapped_sigma_px` was moved to the paint; one with `check` was held out of the solve.
";

/// A name from another person's file as Markdown that shows it: no HTML, link, code or line break.
fn escape(name: &str) -> String {
    let mut text = String::with_capacity(name.len());
    for letter in name.chars() {
        match letter {
            '&' => text.push_str("&amp;"),
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '[' | ']' | '`' | '\\' => text.extend(['\\', letter]),
            _ if letter.is_control() => text.push(' '),
            _ => text.push(letter),
        }
    }
    text
}

/// A Markdown table of names and counts.
fn table(head: [&str; 2], rows: impl IntoIterator<Item = (String, String)>, text: &mut String) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "\n| {} | {} |\n|---|---|", head[0], head[1]);
    for (name, value) in rows {
        let _ = writeln!(text, "| {} | {value} |", name.replace('|', "\\|"));
    }
}

/// A table of how often each key occurs, in the order of the keys; nothing where there is no key.
fn table_of_counts<K: Ord>(
    head: [&str; 2],
    keys: impl Iterator<Item = K>,
    name: impl Fn(&K) -> String,
    text: &mut String,
) {
    let mut counts: BTreeMap<K, usize> = BTreeMap::new();
    for key in keys {
        *counts.entry(key).or_default() += 1;
    }
    if !counts.is_empty() {
        let rows = counts.iter();
        table(
            head,
            rows.map(|(key, count)| (name(key), count.to_string())),
            text,
        );
    }
}

fn counts(card: &Card<'_>, text: &mut String) {
    let frames = &card.dataset.document.frames;
    let solved = frames.iter().filter(|frame| frame.ptz.is_some());
    let rows = [
        ("frames", card.frames.len()),
        ("pictures", card.done.pictures),
        ("with a camera", solved.count()),
        ("clicks", count_all_clicks(frames, |_| true)),
        (
            "of them on lines",
            count_all_clicks(frames, Click::is_on_line),
        ),
        (
            "held out (check)",
            count_all_clicks(frames, |click| click.check),
        ),
        (
            "moved to the paint",
            count_all_clicks(frames, |click| click.snapped_sigma_px.is_some()),
        ),
        ("requested and left out", card.done.left_out.len()),
    ];
    text.push_str("\n## Counts\n");
    table(
        ["what", "how many"],
        rows.map(|(name, count)| (name.to_owned(), count.to_string())),
        text,
    );
    if let Some(splitting) = card.options.splitting {
        let rows = Split::ALL
            .into_iter()
            .zip(card.done.counts)
            .map(|(split, count)| (split.to_string(), count.to_string()));
        table(["split", "frames"], rows, text);
        let [train, validation, test] = splitting.shares;
        let _ = writeln!(
            text,
            "\nSplit {train} : {validation} : {test} by {}, which is never split; seed {}.",
            splitting.by, splitting.seed
        );
    }
    table_of_counts(
        ["label", "frames"],
        card.frames.iter().map(|frame| frame.origin),
        ToString::to_string,
        text,
    );
    table_of_counts(
        ["status", "frames"],
        frames.iter().map(|frame| frame.status),
        |status| status.as_str().to_owned(),
        text,
    );
    table_of_counts(
        ["camera", "frames"],
        frames.iter().map(|frame| &frame.camera),
        |camera| escape(camera.as_str()),
        text,
    );
}

/// The number of clicks of all frames for which a condition is true.
fn count_all_clicks(frames: &Frames, is_counted: impl Fn(&Click) -> bool) -> usize {
    count_clicks(frames.iter().map(|frame| &**frame), is_counted)
}

fn fields_of(card: &Card<'_>, fields: &Fields, text: &mut String) {
    text.push_str("\n## Field\n\n");
    let document = card.original.document;
    // Several cameras may be of one field; a line for each different one, in the order of the text.
    let mut said = BTreeSet::new();
    for frame in &document.frames {
        let (spec, model) = (document.field_of(frame), fields.for_frame(document, frame));
        let size = match spec.size() {
            FieldSize::Assumed if spec.assumed_size().is_some() => {
                "**assumed**: not confirmed by a person; a wrong size looks like a wrong camera"
            }
            FieldSize::Assumed => "fixed by the rules, or by the template",
            FieldSize::Confirmed => "confirmed by a person",
            FieldSize::Fitted => "fitted to the clicks",
            FieldSize::Other(_) => "stated in terms that this program does not know",
        };
        said.insert(format!(
            "- {}, {} × {} m, crown {} m; its size is {size}.\n",
            escape(&spec.template),
            in_millimetres(model.length_m),
            in_millimetres(model.width_m),
            in_millimetres(spec.crown_m())
        ));
    }
    text.extend(said);
}

/// Rounded to a millimetre, because fitted values have sixteen digits.
fn in_millimetres(metres: f64) -> f64 {
    (metres * 1000.0).round() / 1000.0
}

/// Median, 95 % quantile and maximum of distances in px, with the number of frames that have one.
fn spread(mut values: Vec<f64>, of: usize) -> String {
    if values.is_empty() {
        return format!("not known in any of {of}");
    }
    values.sort_by(f64::total_cmp);
    let largest = values.last().copied().unwrap_or_default();
    format!(
        "median {:.2} px, 95 % below {:.2} px, largest {largest:.2} px; known in {} of {of}",
        quantile(&values, 0.5),
        quantile(&values, 0.95),
        values.len()
    )
}

/// Median, 5 % quantile and minimum of probabilities, with the number of frames that have one.
fn probabilities(mut values: Vec<f64>, of: usize) -> String {
    if values.is_empty() {
        return format!("not known in any of {of}");
    }
    values.sort_by(f64::total_cmp);
    format!(
        "median {:.2}, 5 % below {:.2}, smallest {:.2}; known in {} of {of}",
        quantile(&values, 0.5),
        quantile(&values, 0.05),
        values[0],
        values.len()
    )
}

/// Reprojection errors of landmark clicks, px: of those used in the solve, and of those held out.
fn misses(card: &Card<'_>, fields: &Fields) -> [Vec<f64>; 2] {
    let document = card.original.document;
    let mut misses = [Vec::new(), Vec::new()];
    for frame in &document.frames {
        let Some(camera) = document.ptz_camera(frame) else {
            continue;
        };
        let field: &FieldModel = fields.for_frame(document, frame);
        // Points of lines are left out: how far they are from a line says nothing about the place
        // along it.
        for click in &frame.clicks {
            let target = click
                .target
                .as_ref()
                .filter(|target| target.line().is_none());
            let Some(target) = target else {
                continue;
            };
            let landmark = field
                .landmarks
                .iter()
                .find(|landmark| landmark.id.as_str() == target.as_str());
            let Some(landmark) = landmark else {
                continue;
            };
            if let Ok(shown) = camera.image_from_world(field.landmark_in_world(landmark)) {
                misses[usize::from(click.check)].push(shown.distance_px(click.image));
            }
        }
    }
    misses
}

fn quality(card: &Card<'_>, fields: &Fields, text: &mut String) {
    let frames = &card.dataset.document.frames;
    let of = frames.len();
    let [solved, held_out] = misses(card, fields);
    // Of how many clicks the two figures could be known, by `check` as `misses` has it.
    let clicks: [usize; 2] = [false, true].map(|check| {
        count_all_clicks(frames, |click| {
            click.target.is_some() && !click.is_on_line() && click.check == check
        })
    });
    let sizes: BTreeSet<[u32; 2]> = frames.iter().map(|frame| frame.image_size.into()).collect();
    let sizes: Vec<String> = sizes
        .into_iter()
        .map(|[width, height]| format!("{width} × {height}"))
        .collect();
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "\n## Quality\n\npx are of pictures of {}. Each figure says in how many frames (or of how many clicks) it is known; what is not known is not counted as good.\n",
        sizes.join(", ")
    );
    let rows = [
        (
            "clicks on landmarks from the camera's overlay",
            spread(solved, clicks[0]),
        ),
        ("the same of held-out clicks", spread(held_out, clicks[1])),
        (
            "residual of a frame (rms)",
            spread(solution_values(frames, |solution| solution.rms_px), of),
        ),
        (
            "1-σ of the overlay at the worst corner",
            spread(
                solution_values(frames, |solution| solution.worst_corner_sigma_px),
                of,
            ),
        ),
        (
            "confidence (overlay within 10 px at 1920 px width)",
            probabilities(solution_values(frames, |solution| solution.confidence), of),
        ),
        (
            "the same by the painted lines alone",
            probabilities(
                solution_values(frames, |solution| {
                    solution.line_check.as_ref().map(|check| check.score)
                }),
                of,
            ),
        ),
    ];
    table(
        ["figure", "value"],
        rows.map(|(name, value)| (name.to_owned(), value)),
        text,
    );
    let solved = frames.iter().filter_map(|frame| frame.solution.as_ref());
    table_of_counts(
        ["places on the ground are good for", "frames"],
        solved.filter_map(|known| Some(known.ground.as_ref()?.grade.as_str())),
        |grade| (*grade).to_owned(),
        text,
    );
    // A frame counts once for each kind of warning, however often it has one.
    let solutions = frames.iter().filter_map(|frame| frame.solution.as_ref());
    let warned = solutions.flat_map(|solution| {
        let codes = solution
            .warnings
            .iter()
            .map(|warning| warning.code.as_str());
        codes.collect::<BTreeSet<&str>>()
    });
    table_of_counts(
        ["warning", "frames"],
        warned,
        |code| format!("`{}`", code.replace(['`', '\n', '\r'], " ")),
        text,
    );
    let clicked: BTreeSet<&str> = frames
        .iter()
        .flat_map(|frame| frame.clicks.iter())
        .filter_map(|click| click.target.as_ref())
        .map(crate::document::Target::as_str)
        .collect();
    let rows = [
        ("pan, degrees", ptz_range(frames, |ptz| ptz.pan_deg)),
        ("tilt, degrees", ptz_range(frames, |ptz| ptz.tilt_deg)),
        ("focal length, px", ptz_range(frames, |ptz| ptz.focal_px)),
        (
            "different landmarks and lines clicked",
            clicked.len().to_string(),
        ),
    ];
    table(
        ["coverage", "value"],
        rows.map(|(name, value)| (name.to_owned(), value)),
        text,
    );
}

/// A number of the solutions, of those frames that state it.
fn solution_values(frames: &Frames, value: fn(&Solution) -> Option<f64>) -> Vec<f64> {
    frames
        .iter()
        .filter_map(|frame| frame.solution.as_ref().and_then(value))
        .collect()
}

/// The smallest and the largest value of pan, tilt or focal length, in words.
fn ptz_range(frames: &Frames, value: fn(&FramePtz) -> f64) -> String {
    let values: Vec<f64> = frames
        .iter()
        .filter_map(|frame| frame.ptz.as_ref().map(value))
        .collect();
    if values.is_empty() {
        return "not known".to_owned();
    }
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    format!("{low:.1} to {high:.1}")
}

/// The name of a frame's match, of which some lie in the document's folder itself.
fn describe_match(frame: &Frame, names: &BTreeMap<String, String>) -> String {
    names
        .get(&match_of(frame))
        .filter(|name| !name.is_empty())
        .cloned()
        .unwrap_or_else(|| "(the document's folder)".to_owned())
}

fn provenance(card: &Card<'_>, text: &mut String) {
    text.push_str("\n## Provenance\n");
    let frames = &card.original.document.frames;
    let names = match_names(frames.iter().map(|frame| &**frame));
    let matches = frames.iter().map(|frame| describe_match(frame, &names));
    let name = |of_match: &String| escape(of_match);
    table_of_counts(["video or folder", "frames"], matches, name, text);
    let annotators: BTreeSet<String> = frames
        .iter()
        .filter_map(|frame| frame.edited.as_ref()?.by.clone())
        .collect();
    let annotators: Vec<String> = annotators.into_iter().collect();
    let annotators = if annotators.is_empty() {
        "not stated".to_owned()
    } else {
        escape(&annotators.join(", "))
    };
    let pictures = match card.options.pictures {
        Pictures::Copied => "copies of the files that were labelled; frames of videos are decoded",
        Pictures::Linked => {
            "hard links to the files that were labelled; frames of videos are decoded"
        }
        Pictures::Extracted => {
            "decoded from the videos (from the image files where there is no video) and written anew"
        }
        Pictures::Left => "not part of this dataset; `dataset.json` says where they lie",
    };
    let licence = card
        .options
        .licence
        .as_deref()
        .unwrap_or("not stated; ask whoever gave you this dataset before you use it");
    let _ = write!(
        text,
        "\n- Written by {}.\n- Pictures: {pictures}.\n- Annotators: {annotators}.\n- Click noise: {}.\n\n## Licence\n\n{licence}\n",
        crate::document::generator(),
        card.original
            .document
            .click_noise_in_use()
            .map_or_else(|| "the template's".to_owned(), |noise| noise.describe()),
    );
}

#[cfg(test)]
mod tests {
    use super::escape;

    #[test]
    fn a_name_is_shown_and_never_run() {
        let shown = escape("<script>a & b</script>\n[x](http://a) `c` main_2");
        let expected = "&lt;script&gt;a &amp; b&lt;/script&gt; \\[x\\](http://a) \\`c\\` main_2";
        assert_eq!(shown, expected);
    }
}
