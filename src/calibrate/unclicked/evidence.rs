//! What speaks for a base that was found from frames alone, and whether that is enough.

use super::UnclickedError;
use super::joint::{FramePaint, Joint};
use crate::camera::PtzCamera;
use crate::field::FieldModel;
use crate::geometry::ImagePoint;
use crate::markings::{SampleOptions, sample_lines};
use crate::paint::{Shown, Strokes};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Paint and line belong together within this distance, px at 1920 px width.
const WITHIN_PX: f64 = 4.0;

/// What speaks for a base.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct UnclickedEvidence {
    /// Frames that it was found from.
    pub frames: usize,
    /// The share of the paint that stays that lies on a line of the field.
    pub explained: f64,
    /// The share of the lines that should be seen on open ground and are.
    pub visible: f64,
    /// Explained times visible of the best other place.
    pub rival: f64,
    /// The lines of the field that were seen, by name.
    pub lines: Vec<String>,
    /// The median distance of paint from its line, px at 1920 px width.
    pub residual_px: f64,
    /// How far the bases of the two halves of the frames lie apart, m; infinite where one has none.
    pub halves_m: f64,
}

impl UnclickedEvidence {
    /// How much of paint and lines belongs together, 0 to 1.
    #[must_use]
    pub fn score(&self) -> f64 {
        self.explained * self.visible
    }

    /// Whether it is enough.
    pub(super) fn check(&self, joint: &Joint) -> Result<(), UnclickedError> {
        const MIN_EXPLAINED: f64 = 0.6;
        const MIN_VISIBLE: f64 = 0.6;
        const OVER_RIVAL: f64 = 1.35;
        const MIN_LINES: usize = 5;
        const MAX_RESIDUAL_PX: f64 = 1.5;
        const MAX_HALVES_M: f64 = 2.0;
        const MAX_ROLL_DEG: f64 = 1.5;
        let angles = joint.base.angles();
        let mut against = Vec::new();
        let mut ask = |wrong: bool, reason: String| {
            if wrong {
                against.push(reason);
            }
        };
        ask(
            self.explained < MIN_EXPLAINED,
            format!("{:.0} % of the paint lies on no line", 100.0 * (1.0 - self.explained)),
        );
        ask(
            self.visible < MIN_VISIBLE,
            format!("{:.0} % of the lines are not seen where they should be", 100.0 * (1.0 - self.visible)),
        );
        ask(self.score() < OVER_RIVAL * self.rival, "another place explains the paint nearly as well".to_owned());
        ask(self.lines.len() < MIN_LINES, format!("only {} lines are seen", self.lines.len()));
        ask(self.residual_px > MAX_RESIDUAL_PX, format!("paint lies {:.1} px off its lines", self.residual_px));
        ask(self.halves_m > MAX_HALVES_M, format!("two halves of the frames disagree by {:.1} m", self.halves_m));
        ask(angles.roll.degrees().abs() > MAX_ROLL_DEG, format!("the camera would lean by {:.1}", angles.roll));
        if against.is_empty() { Ok(()) } else { Err(UnclickedError::Uncertain { reason: against.join("; ") }) }
    }
}

/// What speaks for a base adjusted to the paint of frames.
pub(super) fn of(field: &FieldModel, joint: &Joint, paint: &[FramePaint], strokes: &[Strokes]) -> UnclickedEvidence {
    let frames: Vec<usize> = (0..strokes.len()).filter(|frame| joint.ptz[*frame].is_some()).collect();
    let counts: Vec<Counts> = frames
        .par_iter()
        .filter_map(|&frame| {
            let camera = PtzCamera::new(joint.base, joint.ptz[frame]?);
            Some(Counts::of(&joint.field(field), &camera, &paint[frame], &strokes[frame]))
        })
        .collect();
    let sum = |of: &dyn Fn(&Counts) -> usize| counts.iter().map(of).sum::<usize>() as f64;
    let share = |some: f64, all: f64| if all > 0.0 { some / all } else { 0.0 };
    let lines: BTreeSet<usize> = counts.iter().flat_map(|counts| counts.lines.iter().copied()).collect();
    UnclickedEvidence {
        frames: frames.len(),
        explained: share(sum(&|counts| counts.explained), sum(&|counts| counts.paint)),
        visible: share(sum(&|counts| counts.seen), sum(&|counts| counts.predicted)),
        rival: 0.0,
        lines: lines.into_iter().map(|line| field.lines[line].id.as_str().to_owned()).collect(),
        residual_px: joint.residual_px(),
        halves_m: joint.halves_m,
    }
}

/// Paint and lines of one frame, counted.
struct Counts {
    paint: usize,
    explained: usize,
    predicted: usize,
    seen: usize,
    /// Lines of which enough was seen.
    lines: Vec<usize>,
}

impl Counts {
    fn of(field: &FieldModel, camera: &PtzCamera, paint: &FramePaint, strokes: &Strokes) -> Self {
        /// A line is seen if this many of its samples are.
        const OF_LINE: usize = 6;
        let size = strokes.size();
        let samples = sample_lines(field, camera, size, &SampleOptions { spacing_px: 8.0, border_px: 4.0 });
        let within_px = WITHIN_PX * size.scale_from_1920();
        // Samples by where they are, in cells as wide as paint may be off.
        let cell = |x: f64, y: f64| ((x / 8.0).floor() as i64, (y / 8.0).floor() as i64);
        let mut near: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
        for (index, sample) in samples.iter().enumerate() {
            near.entry(cell(sample.image.x, sample.image.y)).or_default().push(index);
        }
        let on_line = |at: &&ImagePoint| {
            let (column, row) = cell(at.x, at.y);
            let cells = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (column + dx, row + dy)));
            cells.filter_map(|cell| near.get(&cell)).flatten().any(|&index| {
                let off = at.offset_from(samples[index].image);
                off.dot(&samples[index].normal).abs() <= within_px + 0.5 * samples[index].width_px && off.norm() <= 12.0
            })
        };
        let explained = paint.iter().filter(on_line).count();
        let mut of_line = vec![0_usize; field.lines.len()];
        let (mut predicted, mut seen) = (0, 0);
        for sample in &samples {
            match strokes.shown(sample.image) {
                Shown::Stroke => {
                    (predicted, seen) = (predicted + 1, seen + 1);
                    of_line[sample.line] += 1;
                }
                Shown::Ground => predicted += 1,
                Shown::Other => {}
            }
        }
        let lines = (0..of_line.len()).filter(|line| of_line[*line] >= OF_LINE).collect();
        Self { paint: paint.len(), explained, predicted, seen, lines }
    }
}
