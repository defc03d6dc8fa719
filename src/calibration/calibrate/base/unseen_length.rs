//! The effect of an unconfirmed field length on a picture.
//!
//! A camera that has seen one end of a field is right there whatever the length is: base and end
//! move together. The lines of the middle and of the other end move relative to them, by half of
//! the error of the length or by all of it. A pitch of 101 m that is assumed to be 105 m long
//! projects the centre circle of a broadcast 130 px beside its paint, and nothing at the seen end
//! shows it.

use super::size_fit::OpenSize;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, Vec2, Vec3, median_high};
use touchline_core::markings::{SampleOptions, sample_lines};

/// The name of the length among a field's parameters.
pub(super) const LENGTH: &str = "length_m";

/// Distance between samples of a line, px at 1920 px width.
const SPACING_PX: f64 = 16.0;

/// Minimum number of samples that show the position of a group of lines.
const ENOUGH_SAMPLES: usize = 6;

/// Samples that move by less along their normal do not show the length, px at 1920 px width per
/// metre of their line's motion along x.
const TELLING_PX: f64 = 4.0;

/// The lengths at which the lines in a picture are predicted, in σ from the assumed length: a line
/// may enter the picture only at another length than the assumed one.
const SIGMAS: [f64; 5] = [-2.0, -1.0, 0.0, 1.0, 2.0];

/// How the lines of a field move with its length, and which end a camera has seen.
pub(in crate::calibrate) struct UnseenLength {
    base: CameraBase,
    size: OpenSize,
    /// The assumed lengths of the field, in the order of `size.params`, m.
    values_m: Vec<f64>,
    /// The index of the length among them.
    length: usize,
    end: End,
    /// dx/dL of each line: its motion along x per metre of the field's length. 0.5 at the right
    /// end, 0 in the middle, −0.5 at the left end.
    by_line: Vec<f64>,
    /// The field and the base at each of [`SIGMAS`].
    likely: Vec<(FieldModel, CameraBase)>,
}

/// The end of the field that a camera has seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    /// At positive x.
    Right,
    /// At negative x.
    Left,
}

impl End {
    /// Motion of this end along x per metre of the field's length.
    const fn shift(self) -> f64 {
        match self {
            Self::Right => 0.5,
            Self::Left => -0.5,
        }
    }
}

impl UnseenLength {
    /// Determines which end a camera with these poses has seen. None if the length is prescribed,
    /// or if the poses show lines of the middle or of both ends: then the length was visible, and
    /// is not unknown. None as well if they show neither.
    pub fn new(
        size: OpenSize,
        field: &FieldModel,
        base: &CameraBase,
        cameras: &[(Ptz, ImageSize)],
    ) -> Option<Self> {
        let length = size.params.iter().position(|param| param.name == LENGTH)?;
        let values_m = size
            .params_of(field)
            .iter()
            .map(|param| param.assumed_m)
            .collect();
        let (by_line, likely) = (Vec::new(), Vec::new());
        let mut unseen = Self {
            base: *base,
            size,
            values_m,
            length,
            end: End::Right,
            by_line,
            likely,
        };
        unseen.by_line = unseen.shifts_of_lines()?;
        // Count the samples on lines of the left end, of the middle and of the right end: dx/dL of
        // −0.5, 0 and 0.5 maps to the indices 0, 1 and 2. Samples of lines nearly parallel to x in
        // the picture do not count, as they slide along themselves.
        let mut seen = [0; 3];
        for &(ptz, image) in cameras {
            let camera = PtzCamera::new(*base, ptz);
            for (line, px_per_m) in telling_samples(field, &camera, image) {
                if px_per_m >= TELLING_PX * image.scale_from_1920() {
                    seen[(2.0 * unseen.by_line[line] + 1.0).round().clamp(0.0, 2.0) as usize] += 1;
                }
            }
        }
        let [left, middle, right] = seen;
        if middle >= ENOUGH_SAMPLES
            || left.min(right) >= ENOUGH_SAMPLES
            || left.max(right) < ENOUGH_SAMPLES
        {
            return None;
        }
        unseen.end = if right > left { End::Right } else { End::Left };
        // At ± 2 σ, lines of the middle may be in the picture that are outside it at the assumed
        // length.
        let lengths = SIGMAS.map(|sigmas| unseen.assumed_length_m() + sigmas * unseen.sigma_m());
        unseen.likely = lengths
            .into_iter()
            .filter_map(|length_m| unseen.at_length(length_m))
            .collect();
        Some(unseen)
    }

    /// 1-σ of the length if it was not measured, m.
    pub fn sigma_m(&self) -> f64 {
        self.size.params[self.length].sigma_m
    }

    /// The assumed length, m.
    pub fn assumed_length_m(&self) -> f64 {
        self.values_m[self.length]
    }

    /// The shortest and the longest length that the rules allow, m.
    pub fn limits_m(&self) -> (f64, f64) {
        let param = &self.size.params[self.length];
        (param.min_m, param.max_m)
    }

    /// The field at another length, clamped to what the rules allow, and the base from which the
    /// seen end projects as before.
    pub fn at_length(&self, length_m: f64) -> Option<(FieldModel, CameraBase)> {
        let (min_m, max_m) = self.limits_m();
        let length_m = length_m.clamp(min_m, max_m);
        let mut values_m = self.values_m.clone();
        values_m[self.length] = length_m;
        let field = self.size.field_with_lengths(&values_m)?;
        Some((
            field,
            CameraBase {
                position_m: self.base.position_m + self.base_shift(length_m),
                ..self.base
            },
        ))
    }

    /// Translation of the base with the end that it has seen, m.
    pub fn base_shift(&self, length_m: f64) -> Vec3 {
        Vec3::new(
            self.end.shift() * (length_m - self.assumed_length_m()),
            0.0,
            0.0,
        )
    }

    /// 1-σ in a picture of the lines that do not move with the seen end, px; 0 if it shows none of
    /// them at any likely length.
    pub fn sigma_px(&self, ptz: Ptz, image: ImageSize) -> f64 {
        // The median over the samples of each length, the largest over the lengths: lines that may
        // be in the picture count.
        let px_per_m = self
            .likely
            .iter()
            .filter_map(|(field, base)| {
                self.median_motion_px(field, &PtzCamera::new(*base, ptz), image)
            })
            .fold(0.0, f64::max);
        px_per_m * self.sigma_m()
    }

    /// The median motion of the lines in a picture relative to the seen end, px per metre of
    /// length. None if too few samples move.
    fn median_motion_px(
        &self,
        field: &FieldModel,
        camera: &PtzCamera,
        image: ImageSize,
    ) -> Option<f64> {
        // The motion of a sample: its motion per metre along x, times the difference of dx/dL. A
        // line of the middle moves by half of the length's error, hence half the threshold.
        let moves = telling_samples(field, camera, image)
            .into_iter()
            .map(|(line, px_per_m)| px_per_m * (self.by_line[line] - self.end.shift()).abs());
        let mut telling: Vec<f64> = moves
            .filter(|px| *px >= TELLING_PX / 2.0 * image.scale_from_1920())
            .collect();
        median_high(&mut telling).filter(|_| telling.len() >= ENOUGH_SAMPLES)
    }

    /// dx/dL of each line, from a central difference at its midpoint. None if the template has no
    /// field one step away.
    fn shifts_of_lines(&self) -> Option<Vec<f64>> {
        const STEP_M: f64 = 0.5;
        let assumed_m = self.assumed_length_m();
        let (shorter, _) = self.at_length(assumed_m - STEP_M)?;
        let (longer, _) = self.at_length(assumed_m + STEP_M)?;
        // Lengths are clamped to the rules, so the actual step may be shorter than 2 × `STEP_M`.
        let (from, to) = (shorter.length_m, longer.length_m);
        let is_comparable = to > from && shorter.lines.len() == longer.lines.len();
        let lines = shorter.lines.iter().zip(&longer.lines);
        let shifts = lines.map(|(shorter, longer)| {
            let [shorter_m, longer_m] =
                [shorter, longer].map(|line| line.paint_centre.point_at(0.5).x);
            (longer_m - shorter_m) / (to - from)
        });
        is_comparable.then(|| shifts.collect())
    }
}

/// Samples of the lines in a picture: the line, and the motion of the sample along its normal in
/// the picture per metre of motion along x, px.
fn telling_samples(field: &FieldModel, camera: &PtzCamera, image: ImageSize) -> Vec<(usize, f64)> {
    const STEP_M: f64 = 0.05;
    let options = SampleOptions {
        spacing_px: SPACING_PX * image.scale_from_1920(),
        ..SampleOptions::default()
    };
    let samples = sample_lines(field, camera, image, &options).into_iter();
    // The derivative of the image point by x, as a forward difference. A motion along the line
    // cannot be seen, so only its component along the normal counts.
    let moved = samples.filter_map(|sample| {
        let beside = camera
            .image_from_world(sample.at + Vec3::new(STEP_M, 0.0, 0.0))
            .ok()?;
        let move_px = Vec2::new(beside.x - sample.image.x, beside.y - sample.image.y);
        Some((sample.line, (move_px.dot(&sample.normal) / STEP_M).abs()))
    });
    moved.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::BaseAngles;
    use touchline_core::field::builtin;

    #[test]
    fn neither_field_nor_base_goes_beyond_the_lengths_that_the_rules_allow() {
        let image = ImageSize::new(640, 360);
        let base = CameraBase::new(
            Vec3::new(3.0, -62.0, 17.0),
            BaseAngles::default().base_from_world(),
            image.centre(),
        );
        let template = builtin("soccer").unwrap();
        let field = template.default_model().unwrap();
        let size = OpenSize::new(template.clone(), &field);
        // The right end alone.
        let looks = [33.0, 35.0, 37.0, 39.0]
            .map(|pan_deg| (Ptz::from_degrees(pan_deg, -12.0, 1066.0), image));
        let unseen = UnseenLength::new(size, &field, &base, &looks).unwrap();
        let (_, longest_m) = unseen.limits_m();
        let (longest, from) = unseen.at_length(longest_m).unwrap();
        let (beyond, from_beyond) = unseen.at_length(longest_m + 40.0).unwrap();
        assert_eq!((longest.length_m, beyond.length_m), (longest_m, longest_m));
        assert_eq!(from_beyond.position_m, from.position_m);
    }
}
