//! Evidence for and against a base that was found from frames alone.
//!
//! Two shares are counted in the pictures: paint that lies on a predicted line, and predicted line
//! on open ground that shows paint. A field of another sport or size, or a wrong pose, may score
//! well on one of them, hardly on both.

use super::joint::JointAdjustment;
use crate::autocalibrate::Doubt;
use crate::autocalibrate::frames::matched_frames::{FramePaint, PaintPoint};
use crate::autocalibrate::search::places::relative_size;
use crate::calibrate::{AutocalibratedCamera, AutocalibrationEvidence};
use crate::evidence::Evidence;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::ImageSize;
use touchline_core::markings::{LineSample, SampleOptions, sample_lines};
use touchline_vision::paint::{MarkingPixels, PixelContent};

/// Paint lies on a line within this distance from its edge, px at 1920 px width.
const WITHIN_PX: f64 = 4.0;

/// The distance of samples along a line, px at 1920 px width, and how far along it paint may lie
/// from the nearest one.
const SPACING_PX: f64 = 12.0;
const ALONG_PX: f64 = 18.0;

/// A line is missing if at least [`MIN_SAMPLES`] of its samples, [`SPACING_PX`] apart and summed
/// over all frames, should be visible and less than the share [`MIN_OF_LINE`] is. A field of
/// another size, or one that is shifted, explains most lines and leaves one out. Right answers on
/// three real and four drawn matches saw 0.42 and more of each line; a wrong one saw none of some.
const MIN_SAMPLES: f64 = 40.0;
const MIN_OF_LINE: f64 = 0.3;

/// With less evidence a base is rejected, nats.
pub const MIN_NATS: f64 = 150.0;

/// The reasons to reject a base; none for a right answer.
pub fn doubts_of(camera: &AutocalibratedCamera) -> Vec<Doubt> {
    const MIN_LINES: usize = 5;
    /// On a soccer pitch.
    const MAX_PARTS_M: f64 = 2.0;
    // Heads are levelled to a degree or two, but a camera that is put up for one match, or held in
    // place by a clamp, leans more: a real one behind a goal is rolled by 5.3°.
    const MAX_ROLL_DEG: f64 = 6.0;
    let evidence = &camera.evidence;
    let roll_deg = camera.base.angles().roll.degrees();
    let mut doubts = Vec::new();
    let mut reject_if = |wrong: bool, doubt: Doubt| {
        if wrong {
            doubts.push(doubt);
        }
    };
    // What keeps the evidence low is said, not the number.
    let [explained, visible] = [evidence.explained, evidence.visible];
    reject_if(
        evidence.nats < MIN_NATS,
        if evidence.lines.len() < MIN_LINES {
            Doubt::FewLines {
                lines: evidence.lines.len(),
            }
        } else if explained < visible {
            Doubt::Unexplained {
                share: 1.0 - explained,
            }
        } else {
            Doubt::Unseen {
                share: 1.0 - visible,
            }
        },
    );
    reject_if(
        !evidence.missing.is_empty(),
        Doubt::LinesMissing {
            lines: evidence.missing.clone(),
        },
    );
    // An infinite distance means that some part of the frames gave no position at all.
    let parts_m = evidence.parts_m;
    if parts_m.is_finite() {
        let max_m = MAX_PARTS_M * relative_size(&camera.field);
        reject_if(parts_m > max_m, Doubt::PartsDisagree { parts_m });
    } else {
        reject_if(
            true,
            Doubt::Unconfirmed {
                frames: evidence.frames,
            },
        );
    }
    reject_if(roll_deg.abs() > MAX_ROLL_DEG, Doubt::Leans { roll_deg });
    if let Some([length_m, width_m]) = evidence.other_size_m {
        doubts.push(Doubt::OtherSize { length_m, width_m });
    }
    doubts
}

/// Measures the evidence for a base that was adjusted to the paint of frames.
pub fn measure_evidence(
    joint: &JointAdjustment,
    paint: &[FramePaint],
    marking_pixels: &[MarkingPixels],
) -> AutocalibrationEvidence {
    let field = &joint.field;
    let frames: Vec<usize> = (0..marking_pixels.len())
        .filter(|frame| joint.ptz[*frame].is_some())
        .collect();
    // Count in each frame that has a camera.
    let counts: Vec<Counts> = frames
        .par_iter()
        .filter_map(|&frame| {
            let camera = PtzCamera::new(joint.base, joint.ptz[frame]?);
            Some(Counts::count(
                field,
                &camera,
                &paint[frame],
                &marking_pixels[frame],
            ))
        })
        .collect();
    // Sum over frames before dividing: a frame counts by how much paint and line it shows.
    let sum = |of: &dyn Fn(&Counts) -> usize| counts.iter().map(of).sum::<usize>() as f64;
    let share = |some: f64, all: f64| if all > 0.0 { some / all } else { 0.0 };
    let name = |line: usize| field.lines[line].id.as_str().to_owned();
    let lines: BTreeSet<usize> = counts
        .iter()
        .flat_map(|counts| counts.lines.iter().copied())
        .collect();
    // Whether a line is missing is decided over all frames together.
    let of_lines: Vec<&[LineCounts]> = counts
        .iter()
        .map(|counts| counts.of_line.as_slice())
        .collect();
    AutocalibrationEvidence {
        frames: frames.len(),
        nats: weigh(joint, marking_pixels).nats(),
        explained: share(sum(&|counts| counts.explained), sum(&|counts| counts.paint)),
        visible: share(
            counts.iter().map(|counts| counts.total().seen).sum(),
            counts.iter().map(|counts| counts.total().predicted).sum(),
        ),
        runner_up_nats: None,
        lines: lines.into_iter().map(name).collect(),
        missing: labels(field, &missing(field, &of_lines)),
        residual_px: joint.residual_px(),
        parts_m: joint.parts_m,
        other_size_m: None,
        pixel_aspect: None,
    }
}

/// Weighs the marking pixels of all frames that have a camera.
fn weigh(joint: &JointAdjustment, marking_pixels: &[MarkingPixels]) -> Evidence {
    let frames = joint.ptz.iter().zip(marking_pixels);
    let cameras: Vec<(PtzCamera, &MarkingPixels)> = frames
        .filter_map(|(ptz, pixels)| Some((PtzCamera::new(joint.base, (*ptz)?), pixels)))
        .collect();
    Evidence::weigh(&joint.field, &cameras)
}

/// The lines that the cameras should show on open ground and do not, by index.
pub fn missing_lines(field: &FieldModel, looking: &[(PtzCamera, &MarkingPixels)]) -> Vec<usize> {
    let of_frame = |(camera, marking_pixels): &(PtzCamera, &MarkingPixels)| {
        LineCounts::count(
            field,
            &samples_of(field, camera, marking_pixels.size()),
            marking_pixels,
        )
    };
    let counts: Vec<Vec<LineCounts>> = looking.par_iter().map(of_frame).collect();
    missing(field, &counts.iter().map(Vec::as_slice).collect::<Vec<_>>())
}

/// The labels of some lines of a field.
pub fn labels(field: &FieldModel, lines: &[usize]) -> Vec<String> {
    let of_lines = lines.iter().map(|line| field.lines[*line].label.clone());
    of_lines.collect()
}

/// The missing lines ([`MIN_SAMPLES`]), by index. Those that end on the long sides are excepted.
fn missing(field: &FieldModel, of_frames: &[&[LineCounts]]) -> Vec<usize> {
    let is_missing = |line: &usize| {
        let sum = |of: fn(&LineCounts) -> f64| -> f64 {
            of_frames.iter().map(|lines| of(&lines[*line])).sum()
        };
        let (predicted, seen) = (sum(|counts| counts.predicted), sum(|counts| counts.seen));
        predicted >= MIN_SAMPLES
            && seen < MIN_OF_LINE * predicted
            && !ends_on_long_sides(field, *line)
    };
    (0..field.lines.len()).filter(is_missing).collect()
}

/// Samples of the field's lines in a camera's picture, [`SPACING_PX`] apart.
fn samples_of(field: &FieldModel, camera: &PtzCamera, size: ImageSize) -> Vec<LineSample> {
    sample_lines(
        field,
        camera,
        size,
        &SampleOptions {
            spacing_px: SPACING_PX * size.scale_from_1920(),
            border_px: 4.0,
        },
    )
}

/// Whether a line ends on the long sides of the field, as the touchlines, the goal lines and the
/// halfway line do. Mowing stripes end there as well, and boards stand behind them, so that the
/// right camera may see little of their paint: in one broadcast, whose camera stands on the halfway
/// line, too little of that.
fn ends_on_long_sides(field: &FieldModel, line: usize) -> bool {
    const WITHIN_M: f64 = 0.2;
    let curve = field.lines[line].paint_centre;
    [0.0, 1.0]
        .into_iter()
        .all(|end| (curve.point_at(end).y.abs() - 0.5 * field.width_m).abs() < WITHIN_M)
}

/// Counts of paint and line samples in one frame.
struct Counts {
    paint: usize,
    explained: usize,
    /// By index of the line in the field.
    of_line: Vec<LineCounts>,
    /// The lines that count as visible in this frame.
    lines: Vec<usize>,
}

/// The samples of a line that lie on open ground, and those among them that lie on paint. Each
/// counts by its detectability ([`LineSample::detectability`]): that a far and narrow line is not
/// seen says little.
#[derive(Clone, Copy, Default)]
struct LineCounts {
    predicted: f64,
    seen: f64,
    /// Number of samples on paint.
    num_seen: usize,
}

impl LineCounts {
    /// Counts the samples of each line of a field in one frame. Samples on anything but ground or
    /// paint (players, boards) are no evidence either way.
    fn count(
        field: &FieldModel,
        samples: &[LineSample],
        marking_pixels: &MarkingPixels,
    ) -> Vec<Self> {
        let mut of_line = vec![Self::default(); field.lines.len()];
        for sample in samples {
            let counts = &mut of_line[sample.line];
            match marking_pixels.classify(sample.image) {
                PixelContent::Stroke => {
                    counts.predicted += sample.detectability();
                    counts.seen += sample.detectability();
                    counts.num_seen += 1;
                }
                PixelContent::Ground => counts.predicted += sample.detectability(),
                PixelContent::Other => {}
            }
        }
        of_line
    }
}

impl Counts {
    /// Sums over all lines.
    fn total(&self) -> LineCounts {
        let lines = self.of_line.iter();
        LineCounts {
            predicted: lines.clone().map(|counts| counts.predicted).sum(),
            seen: lines.clone().map(|counts| counts.seen).sum(),
            num_seen: lines.map(|counts| counts.num_seen).sum(),
        }
    }

    /// Counts the paint and the line samples of one frame.
    fn count(
        field: &FieldModel,
        camera: &PtzCamera,
        paint: &FramePaint,
        marking_pixels: &MarkingPixels,
    ) -> Self {
        /// A line counts as visible if at least this many of its samples are.
        const OF_LINE: usize = 6;
        let size = marking_pixels.size();
        let samples = samples_of(field, camera, size);
        let [within_px, spacing_px, along_px] =
            [WITHIN_PX, SPACING_PX, ALONG_PX].map(|px| px * size.scale_from_1920());
        // Hash the samples into cells of their spacing. Paint within that of a sample is in the
        // same cell or one of its eight neighbours.
        let cell = |x: f64, y: f64| {
            let [column, row] = [x, y].map(|px| (px / spacing_px).floor() as i64);
            (column, row)
        };
        let mut near: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
        for (index, sample) in samples.iter().enumerate() {
            near.entry(cell(sample.image.x, sample.image.y))
                .or_default()
                .push(index);
        }
        // Paint is explained if it lies close to a sample across the line; along the line one and a
        // half times the spacing of samples is allowed.
        let on_line = |paint: &&PaintPoint| {
            let (column, row) = cell(paint.at.x, paint.at.y);
            let cells = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (column + dx, row + dy)));
            cells
                .filter_map(|cell| near.get(&cell))
                .flatten()
                .any(|&index| {
                    let off = paint.at.offset_from(samples[index].image);
                    off.dot(&samples[index].normal).abs()
                        <= within_px + 0.5 * samples[index].width_px
                        && off.norm() <= along_px
                })
        };
        // Both directions: paint on lines, and lines with paint.
        let explained = paint.iter().filter(on_line).count();
        let of_line = LineCounts::count(field, &samples, marking_pixels);
        let lines = (0..of_line.len())
            .filter(|line| of_line[*line].num_seen >= OF_LINE)
            .collect();
        Self {
            paint: paint.len(),
            explained,
            of_line,
            lines,
        }
    }
}
