//! The line check: tests a camera against the paint that it predicts.
//!
//! # Method
//!
//! The field's lines are sampled as the camera predicts them, and the picture is searched for
//! ridges within 12 px across each sample (`sightings.rs`). Two numbers are combined by logistic
//! regression into the probability that the camera is right within 10 px:
//!
//! * the agreement, the share of open samples with paint, weighted by distance. It falls for
//!   cameras that are wrong by more than a few px, because their lines cross bare ground. Samples
//!   of lines narrower than a pixel count less
//!   ([`detectability`](touchline_core::markings::LineSample::detectability)).
//! * the distance between two cameras that two halves of the samples give. It rises where ridges
//!   belong to something else, because unrelated ridges do not agree on one correction.
//!
//! The rest of [`LineCheck`] describes the fit and finds fields of another size.

use super::alignment::{LinearisedCamera, RidgeAlignment, StepPx};
use super::ground_on_field::ground_on_field;
use super::sightings::{LineObservations, SampleContent, SamplingDistances};
use super::unexplained::unexplained_share;
use crate::paint::GroundPicture;
use std::collections::BTreeMap;
use touchline_core::camera::{Ptz, PtzCamera, image_space_distances_px};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, Vec3, median_high};
use touchline_core::markings::{FEWEST_OPEN, LineVerdict};

/// Maximum distance of paint from where the camera predicts it, px at 1920 px width.
const REACH_PX: f64 = 12.0;

/// Distance between samples of a line, px at 1920 px width.
const SPACING_PX: f64 = 16.0;

/// A ridge at this distance counts 1/2, px at 1920 px width.
const HALF_PX: f64 = 4.0;

/// Number of consecutive samples that belong to the same half. Neighbours share errors, so that
/// alternating single samples would give two halves with the same errors.
const BLOCK: usize = 6;

/// The result of a line check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineCheck {
    /// Number of samples of lines that the camera predicts in the picture.
    pub predicted: usize,
    /// Number of samples with a ridge of paint near by.
    pub found: usize,
    /// Number of samples with open ground and no paint.
    pub bare: usize,
    /// Median distance of the ridges from where they are predicted, px; infinite without a ridge.
    pub offset_px: f64,
    /// Median signed offset along the normals that point down in the picture, px: positive if paint
    /// lies below the drawn line. Infinite without a ridge.
    pub bias_px: f64,
    /// Distance between the overlays of the cameras that two halves of the samples give, px.
    pub halves_px: f64,
    /// Share of the paint on the playing area that no predicted line explains. None if there is too
    /// little paint.
    pub unexplained: Option<f64>,
    /// Share of open samples with paint, for the line with the least. None if no line has enough
    /// open samples.
    pub emptiest: Option<f64>,
    /// Share of open samples with paint, each weighted by its distance.
    pub agreement: f64,
    /// Probability, from the paint alone, that the camera is right within 10 px at 1920 px width.
    pub score: f64,
}

/// A line with a smaller share of paint may lie beside its paint.
const EMPTY_LINE: f64 = 0.3;
/// Such a line lies beside its paint if the unexplained share exceeds the first number plus the
/// second times the line's own share of paint.
const UNEXPLAINED_LIMIT: [f64; 2] = [0.1, 0.5];

impl LineCheck {
    /// Whether one part of the field lies on its paint and another part beside it, as happens if
    /// the field is longer or shorter than assumed.
    ///
    /// Either sign alone occurs in correct pictures. Of 568 pictures of three broadcasts, 71 had a
    /// line less than a third of which was seen, with at most 0.17 of the paint unexplained; none
    /// had both signs. In another broadcast, whose centre circle lay 40 px or more off, all 34
    /// pictures have both, at assumed lengths of 101 m and of 105 m.
    pub fn is_of_other_field(&self) -> bool {
        let Some((seen, alone)) = self.emptiest.zip(self.unexplained) else {
            return false;
        };
        seen < EMPTY_LINE && alone > UNEXPLAINED_LIMIT[0] + UNEXPLAINED_LIMIT[1] * seen
    }

    /// The number of samples on open ground.
    pub const fn num_open(&self) -> usize {
        self.found + self.bare
    }

    /// Whether enough samples are on open ground for a verdict.
    pub const fn can_say(&self) -> bool {
        self.num_open() >= FEWEST_OPEN
    }

    /// The verdict that the score and the number of open samples allow.
    pub fn verdict(&self) -> LineVerdict {
        LineVerdict::from_score(self.score, self.num_open())
    }
}

/// Tests a camera against the paint of a picture.
pub fn check_lines(ground: &GroundPicture, field: &FieldModel, camera: &PtzCamera) -> LineCheck {
    let ground = &*ground_on_field(ground, field, camera);
    let size = ground.size();
    let scale = size.scale_from_1920();
    let sightings = observe_lines(ground, field, camera);
    // Distances of the ridges nearest to the predicted lines, and the agreement by a Lorentzian
    // weight.
    let mut offsets = Vec::new();
    let mut biases = Vec::new();
    let mut weighed = 0.0;
    for (index, sample) in sightings.samples.iter().enumerate() {
        let Some(ridge) = sightings.nearest(index, 0.0) else {
            continue;
        };
        let near = 1.0 / (1.0 + (ridge.offset_px / (HALF_PX * scale)).powi(2));
        weighed += sample.detectability() * near;
        offsets.push(ridge.offset_px.abs());
        // y points down in the picture: a normal of negative y points up.
        biases.push(if sample.normal.y < 0.0 {
            -ridge.offset_px
        } else {
            ridge.offset_px
        });
    }
    let (found, bare) = (offsets.len(), sightings.bare());
    // Both halves are aligned from the camera itself, with a loss from a coarse scale to a fine
    // one.
    let around = LinearisedCamera::new(camera.base(), camera.ptz(), size.width);
    let pull = RidgeAlignment::new(&around, &sightings, scale);
    let halves_px = halves_apart_px(
        &pull,
        &around,
        StepPx::zeros(),
        &[6.0 * scale, 4.0 * scale, 3.0 * scale],
        size,
    );
    // Signs of a field of another size; they do not enter the score. On a floor, seams, letters and
    // lines of other sports are explained by no camera.
    let unexplained = if ground.surface().is_turf() {
        unexplained_share(ground, field, camera, &sightings.samples)
    } else {
        None
    };
    let emptiest = emptiest_line(&sightings);
    let open = open_weight(&sightings);
    let agreement = if open > 0.0 { weighed / open } else { 0.0 };
    LineCheck {
        predicted: sightings.samples.len(),
        found,
        bare,
        offset_px: median(offsets),
        bias_px: median(biases),
        halves_px,
        unexplained,
        emptiest,
        agreement,
        score: score(agreement, halves_px / scale, open),
    }
}

/// Of each line of a field, whether a camera draws it onto its paint, as far as a motion of the
/// ground along a direction (`world`) would show: at least half of its open samples show paint, and
/// the median of their displacements along that direction is at most `within_px` where the line
/// would move most. Only samples that would move at least half as much count, and only lines that
/// move by `telling_px` for each metre. Lines that are hidden, or not in the picture, are not known
/// to be on their paint. Distances are in px of the picture.
pub fn lines_on_paint(
    ground: &GroundPicture,
    field: &FieldModel,
    camera: &PtzCamera,
    (along, telling_px): (Vec3, f64),
    within_px: f64,
) -> Vec<bool> {
    let ground = &*ground_on_field(ground, field, camera);
    let sightings = observe_lines(ground, field, camera);
    let samples = sightings.samples.iter();
    let motions = samples.map(|sample| sample.motion_px_per_m(camera, along).unwrap_or(0.0));
    let motions: Vec<f64> = motions.collect();
    let mut largest = vec![0.0_f64; field.lines.len()];
    for (sample, motion) in sightings.samples.iter().zip(&motions) {
        largest[sample.line] = largest[sample.line].max(motion.abs());
    }

    // The displacement along the direction that the ridge of each sample stands for, m.
    let mut displaced_m: Vec<Vec<f64>> = vec![Vec::new(); field.lines.len()];
    let mut bare = vec![0; field.lines.len()];
    for (index, (sample, motion)) in sightings.samples.iter().zip(&motions).enumerate() {
        if motion.abs() >= 0.5 * largest[sample.line].max(telling_px) {
            let ridge = sightings.nearest(index, 0.0);
            displaced_m[sample.line].extend(ridge.map(|ridge| ridge.offset_px / motion));
            bare[sample.line] += usize::from(sightings.seen[index] == SampleContent::Bare);
        }
    }
    let lines = displaced_m.into_iter().zip(bare).zip(largest);
    lines
        .map(|((displaced_m, bare), largest)| {
            let is_seen = largest >= telling_px && displaced_m.len() >= bare.max(1);
            is_seen && median(displaced_m).abs() * largest <= within_px
        })
        .collect()
}

/// The paint near the lines that a camera predicts.
fn observe_lines(
    ground: &GroundPicture,
    field: &FieldModel,
    camera: &PtzCamera,
) -> LineObservations {
    let scale = ground.size().scale_from_1920();
    let look = SamplingDistances {
        reach_px: REACH_PX * scale,
        spacing_px: SPACING_PX * scale,
        step_px: 1.0,
    };
    LineObservations::search(ground, field, camera, look)
}

/// The open samples, each by its detectability.
fn open_weight(sightings: &LineObservations) -> f64 {
    let samples = sightings.samples.iter().zip(&sightings.seen);
    let open = samples.filter(|(_, seen)| **seen != SampleContent::Hidden);
    open.map(|(sample, _)| sample.detectability()).sum()
}

/// Minimum number of open samples of a line, each by its detectability. A shorter line may be
/// covered by something of the ground's colours.
const LONG_LINE: f64 = 12.0;

/// The smallest share of a line's open samples that have paint.
fn emptiest_line(sightings: &LineObservations) -> Option<f64> {
    let mut lines: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    // Hidden samples count for neither: they say nothing about the line.
    for (sample, seen) in sightings.samples.iter().zip(&sightings.seen) {
        let (found, bare) = lines.entry(sample.line).or_default();
        match seen {
            SampleContent::Paint(_) => *found += sample.detectability(),
            SampleContent::Bare => *bare += sample.detectability(),
            SampleContent::Hidden => {}
        }
    }
    let long = lines
        .into_values()
        .filter(|(found, bare)| found + bare >= LONG_LINE);
    long.map(|(found, bare)| found / (found + bare))
        .min_by(f64::total_cmp)
}

/// Logistic regression for the log odds that a camera is right within 10 px at 1920 px width:
/// constant; weight of agreement − 1/2; weight of the logarithm of the halves' distance in units of
/// 2 px. The latter two are shrunk where few samples are open.
///
/// Maximum likelihood over 142 frames of three real matches, with the camera from users' clicks and
/// 36 cameras each that are 3 to 840 px off. The unexplained share adds nothing to these.
const LOG_ODDS: [f64; 3] = [-0.65, 9.6, -1.46];

/// Number of open samples at which the weights are half of those for very many samples.
const HALF_WEIGHT_SAMPLES: f64 = 20.0;

/// The halves' distance is limited to this range, px at 1920 px width.
const HALVES_PX: (f64, f64) = (0.3, 30.0);

/// The halves' distance that leaves the odds unchanged, px at 1920 px width.
const NEUTRAL_HALVES_PX: f64 = 2.0;

/// The probability that a camera is right, from the agreement, the halves' distance in px at
/// 1920 px width, and the weight of the open samples; see [`LOG_ODDS`].
fn score(agreement: f64, halves_px: f64, open: f64) -> f64 {
    // Shrinks the evidence towards the constant where few samples are open.
    let known = open / (open + HALF_WEIGHT_SAMPLES);
    // The logarithm, because the halves' distance ranges over two orders of magnitude.
    let halves = (halves_px.clamp(HALVES_PX.0, HALVES_PX.1) / NEUTRAL_HALVES_PX).ln();
    let log_odds = LOG_ODDS[0] + known * (LOG_ODDS[1] * (agreement - 0.5) + LOG_ODDS[2] * halves);
    1.0 / (1.0 + (-log_odds).exp())
}

/// Distance between the overlays of two cameras, each aligned with one half of the samples, px
/// (median over the picture). The halves alternate in blocks of [`BLOCK`] samples.
pub(super) fn halves_apart_px(
    pull: &RidgeAlignment,
    around: &LinearisedCamera,
    from: StepPx,
    scales_px: &[f64],
    size: ImageSize,
) -> f64 {
    // Without clicks, which both halves would share.
    let [even, odd] = [0, 1].map(|half| {
        around.ptz_after(&pull.align(from, scales_px, None, |sample| sample / BLOCK % 2 == half))
    });
    overlays_apart_px(&PtzCamera::new(*around.camera.base(), even), odd, size)
}

/// Distance between the overlays of two cameras with one base, px: the median over a grid of 5 × 5
/// points of the picture. Infinite if the second camera does not see most of what the first one
/// sees.
pub fn overlays_apart_px(camera: &PtzCamera, other: Ptz, size: ImageSize) -> f64 {
    const PLACES: u32 = 5;
    let other = PtzCamera::new(*camera.base(), other);
    let grid = size.cell_centres(PLACES, PLACES);
    median(image_space_distances_px(camera, &other, grid).collect())
}

/// The high median; infinite if there are no values.
fn median(mut values: Vec<f64>) -> f64 {
    median_high(&mut values).unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::drawn::{PICTURE, SIZE, camera, draw_field, soccer, truth};
    use touchline_core::camera::CameraBase;
    use touchline_core::field::builtin;

    #[test]
    fn the_right_camera_is_supported_and_wrong_ones_are_contradicted() {
        let field = soccer();
        let ground = GroundPicture::new(&PICTURE, &[]);
        let right = check_lines(&ground, &field, &truth());
        assert_eq!(right.verdict(), LineVerdict::Supports, "{right:?}");
        assert!(
            right.offset_px < 0.2 && right.bias_px.abs() < 0.1 && right.halves_px < 0.2,
            "{right:?}"
        );
        assert!(
            right.unexplained.is_some_and(|share| share < 0.1),
            "{right:?}"
        );
        for (pan_deg, tilt_deg, focal_px) in [
            (6.0, -14.0, 1500.0),
            (4.0, -15.0, 1500.0),
            (4.0, -14.0, 1700.0),
        ] {
            let wrong = check_lines(&ground, &field, &camera(pan_deg, tilt_deg, focal_px));
            assert_eq!(wrong.verdict(), LineVerdict::Contradicts, "{wrong:?}");
            assert!(
                wrong.unexplained.is_some_and(|share| share > 0.2),
                "{wrong:?}"
            );
        }
    }

    #[test]
    fn a_field_of_another_length_lies_on_its_paint_in_part() {
        // From the centre circle to the penalty area.
        let pointed = camera(20.0, -13.0, 1500.0);
        let picture = draw_field(&soccer(), &pointed, SIZE);
        let ground = GroundPicture::new(&picture, &[]);
        assert!(!check_lines(&ground, &soccer(), &pointed).is_of_other_field());
        // Fourteen metres shorter, and the camera as far from the right goal line as before.
        let length_m = soccer().length_m - 14.0;
        let shorter = builtin("soccer")
            .unwrap()
            .model(&[("length_m".to_owned(), length_m)].into(), 0.1)
            .unwrap();
        let base = *pointed.base();
        let moved = CameraBase {
            position_m: base.position_m - Vec3::new(7.0, 0.0, 0.0),
            ..base
        };
        let check = check_lines(&ground, &shorter, &PtzCamera::new(moved, pointed.ptz()));
        assert!(check.is_of_other_field(), "{check:?}");
    }

    /// A camera that has moved with the right end draws the circle beside its paint.
    #[test]
    fn each_line_lies_on_its_paint_or_beside_it() {
        let pointed = camera(20.0, -13.0, 1500.0);
        let field = soccer();
        let ground = GroundPicture::new(&draw_field(&field, &pointed, SIZE), &[]);
        let on_paint = |field: &FieldModel, camera: &PtzCamera| -> Vec<String> {
            let on_paint = lines_on_paint(&ground, field, camera, (Vec3::x(), 2.0), 2.0);
            let lines = field.lines.iter().zip(on_paint);
            lines
                .filter(|(_, is_on_paint)| *is_on_paint)
                .map(|(line, _)| line.id.as_str().to_owned())
                .collect()
        };
        let right = on_paint(&field, &pointed);
        assert!(
            right.contains(&"centre_circle".to_owned())
                && right.contains(&"goal_line_right".to_owned()),
            "{right:?}"
        );
        assert!(
            !right.contains(&"goal_line_left".to_owned()),
            "it is not in the picture"
        );
        // The length is off by 1 m, so the circle by 0.5 m.
        let sizes = [("length_m".to_owned(), field.length_m - 1.0)].into();
        let shorter = builtin("soccer").unwrap().model(&sizes, 0.1).unwrap();
        let base = CameraBase {
            position_m: pointed.base().position_m - Vec3::new(0.5, 0.0, 0.0),
            ..*pointed.base()
        };
        let beside = on_paint(&shorter, &PtzCamera::new(base, pointed.ptz()));
        assert!(!beside.contains(&"centre_circle".to_owned()), "{beside:?}");
        assert!(beside.contains(&"goal_line_right".to_owned()), "{beside:?}");
    }

    #[test]
    fn the_bias_tells_on_which_side_the_paint_lies() {
        let field = soccer();
        let ground = GroundPicture::new(&PICTURE, &[]);
        // 2 px: the camera looks higher than it does, so all paint lies below what it predicts.
        let by_deg = (2.0_f64 / 1500.0).to_degrees();
        let lower = check_lines(&ground, &field, &camera(4.0, -14.0 - by_deg, 1500.0));
        let higher = check_lines(&ground, &field, &camera(4.0, -14.0 + by_deg, 1500.0));
        assert!(
            lower.bias_px > 1.0 && higher.bias_px < -1.0,
            "{} {}",
            lower.bias_px,
            higher.bias_px
        );
    }

    #[test]
    fn where_no_paint_is_predicted_or_all_is_hidden_nothing_is_said() {
        let field = soccer();
        let away = check_lines(
            &GroundPicture::new(&PICTURE, &[]),
            &field,
            &camera(180.0, -14.0, 1500.0),
        );
        assert_eq!(
            (away.predicted, away.verdict()),
            (0, LineVerdict::CannotSay)
        );
        let (width, height) = (f64::from(SIZE.width), f64::from(SIZE.height));
        let all = touchline_core::geometry::PixelBox {
            x: 0.0,
            y: 0.0,
            width,
            height,
        };
        let hidden = check_lines(&GroundPicture::new(&PICTURE, &[all]), &field, &truth());
        assert_eq!(
            (hidden.found, hidden.bare, hidden.verdict()),
            (0, 0, LineVerdict::CannotSay)
        );
    }
}
