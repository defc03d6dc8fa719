//! What a field's length that nobody has confirmed leaves open in a picture.
//!
//! A camera that has seen one end of a field lies right there whatever the length is: base and end
//! move together. What is drawn from the field's middle or from its other end moves against them,
//! by half of what the length is wrong, or by all of it. A pitch of 101 m taken for 105 m puts the
//! centre circle of a broadcast 130 px beside its paint, and nothing at the seen end tells.

use super::size_fit::OpenSize;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, Vec2, Vec3, median_high};
use touchline_core::markings::{SampleOptions, sample_lines};

/// The name of the length among a field's parameters.
pub(super) const LENGTH: &str = "length_m";

/// The distance between samples of a line, px at 1920 px width.
const SPACING_PX: f64 = 16.0;

/// As many samples of lines show where they lie.
const ENOUGH_SAMPLES: usize = 6;

/// Samples that move by less along their normal tell nothing of the length, px at 1920 px width for
/// each metre of it.
const TELLING_PX: f64 = 4.0;

/// Lengths at which a line may enter the picture, in σ of the length.
const SIGMAS: [f64; 5] = [-2.0, -1.0, 0.0, 1.0, 2.0];

/// How the lines of a field move with its length, and which end a camera has seen.
pub(super) struct UnseenLength {
    base: CameraBase,
    size: OpenSize,
    values_m: Vec<f64>,
    /// Which of the field's parameters the length is.
    length: usize,
    end: End,
    /// How far each line moves along x for each metre by which the field is longer, m.
    by_line: Vec<f64>,
    /// The field and the base at lengths that are likely.
    likely: Vec<(FieldModel, CameraBase)>,
}

/// The end of the field that a camera lies right at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    /// At positive x.
    Right,
    /// At negative x.
    Left,
}

impl End {
    /// How far this end moves along x for each metre by which the field is longer, m.
    const fn shift(self) -> f64 {
        match self {
            Self::Right => 0.5,
            Self::Left => -0.5,
        }
    }
}

impl UnseenLength {
    /// Of a camera that shows a field with these cameras; none where the length is prescribed, or
    /// where the cameras show lines that move against each other with it, so that it is seen.
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
        let lengths = SIGMAS.map(|sigmas| unseen.assumed_m() + sigmas * unseen.sigma_m());
        unseen.likely = lengths
            .into_iter()
            .filter_map(|length_m| unseen.at_length(length_m))
            .collect();
        Some(unseen)
    }

    /// 1-σ of the length where nobody has measured it, m.
    pub fn sigma_m(&self) -> f64 {
        self.size.params[self.length].sigma_m
    }

    /// The length that was assumed, m.
    pub fn assumed_m(&self) -> f64 {
        self.values_m[self.length]
    }

    /// The shortest and the longest that the rules allow, m.
    pub fn limits_m(&self) -> (f64, f64) {
        let param = &self.size.params[self.length];
        (param.min_m, param.max_m)
    }

    /// The field at another length, and the base that lies as before at the end that was seen.
    pub fn at_length(&self, length_m: f64) -> Option<(FieldModel, CameraBase)> {
        let mut values_m = self.values_m.clone();
        values_m[self.length] = length_m;
        let field = self.size.sized(&values_m)?;
        Some((
            field,
            CameraBase {
                position_m: self.base.position_m + self.base_shift(length_m),
                ..self.base
            },
        ))
    }

    /// How far the base moves with the end that was seen, m.
    pub fn base_shift(&self, length_m: f64) -> Vec3 {
        Vec3::new(self.end.shift() * (length_m - self.assumed_m()), 0.0, 0.0)
    }

    /// 1-σ by which the lines that are not tied to the seen end lie off in a picture, px; 0 where
    /// it shows none of them, at any length that is likely.
    pub fn sigma_px(&self, ptz: Ptz, image: ImageSize) -> f64 {
        let of_length = |(field, base): &(FieldModel, CameraBase)| {
            let samples = telling_samples(field, &PtzCamera::new(*base, ptz), image).into_iter();
            let moves = samples
                .map(|(line, px_per_m)| px_per_m * (self.by_line[line] - self.end.shift()).abs());
            let mut telling: Vec<f64> = moves
                .filter(|px| *px >= TELLING_PX / 2.0 * image.scale_from_1920())
                .collect();
            median_high(&mut telling).filter(|_| telling.len() >= ENOUGH_SAMPLES)
        };
        self.likely.iter().filter_map(of_length).fold(0.0, f64::max) * self.sigma_m()
    }

    /// How far each line moves along x for each metre by which the field is longer, m.
    fn shifts_of_lines(&self) -> Option<Vec<f64>> {
        const STEP_M: f64 = 0.5;
        let at = |by_m: f64| {
            self.at_length(self.assumed_m() + by_m)
                .map(|(field, _)| field)
        };
        let (shorter, longer) = (at(-STEP_M)?, at(STEP_M)?);
        let (from, to) = (shorter.length_m, longer.length_m);
        let middle =
            |field: &FieldModel, line: usize| field.lines[line].paint_centre.point_at(0.5).x;
        let shift = |line: usize| (middle(&longer, line) - middle(&shorter, line)) / (to - from);
        (to > from && shorter.lines.len() == longer.lines.len())
            .then(|| (0..longer.lines.len()).map(shift).collect())
    }
}

/// The samples of the lines in a picture: which line, and how far it moves along its normal where
/// it moves along x by a metre, px.
fn telling_samples(field: &FieldModel, camera: &PtzCamera, image: ImageSize) -> Vec<(usize, f64)> {
    const STEP_M: f64 = 0.05;
    let options = SampleOptions {
        spacing_px: SPACING_PX * image.scale_from_1920(),
        ..SampleOptions::default()
    };
    let samples = sample_lines(field, camera, image, &options).into_iter();
    let moved = samples.filter_map(|sample| {
        let beside = camera
            .image_from_world(sample.at + Vec3::new(STEP_M, 0.0, 0.0))
            .ok()?;
        let move_px = Vec2::new(beside.x - sample.image.x, beside.y - sample.image.y);
        Some((sample.line, (move_px.dot(&sample.normal) / STEP_M).abs()))
    });
    moved.collect()
}
