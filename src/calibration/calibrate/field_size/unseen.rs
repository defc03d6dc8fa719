//! What the known cameras of a field leave open of its length and width, and what that does to a
//! picture.
//!
//! A camera that has seen one part of a field is right there whatever the size of the field is: base
//! and part move together. Lines of other parts move relative to it: the two ends by half of the
//! error of the length each, relative to the middle. A pitch of 101 m that is assumed to be 105 m
//! long projects the goals of a broadcast 70 px beside their paint where its key frames show the
//! middle alone, and nothing in those shows it.
//!
//! Each line that is seen gives its own position along the axis on which the length moves it, with a
//! 1-σ of displaced paint and of the picture's resolution. A line moves by a known share of a change
//! of the length, so a straight line through positions over shares has the length as its slope, and
//! what is seen moves as the mean share. The variance of the slope, joined with that of the rules,
//! is what remains open: all of it where one part alone is seen.

use super::OpenSize;
use super::alone_sigma_m;
use touchline_core::camera::{CameraBase, Ptz, PtzCamera};
use touchline_core::field::{FieldError, FieldLine, FieldModel};
use touchline_core::geometry::{ImageSize, Vec3, median_high, subsample};
use touchline_core::markings::{SampleOptions, sample_lines};
use touchline_core::solve::base::{SizeParam, usual_displacement_m};
use touchline_documents::document::{Camera, DocumentAt, Frame, FrameStatus, Target};

/// Distance between samples of a line, px at 1920 px width.
const SPACING_PX: f64 = 16.0;

/// Minimum number of samples that show the position of a line, or of lines together.
const ENOUGH_SAMPLES: usize = 6;

/// Samples that move by less along their normal do not show the size, px at 1920 px width per
/// metre of their line's motion.
pub(in crate::calibrate) const TELLING_PX: f64 = 4.0;

/// 1-σ with which the picture of a known camera shows the position of a line, px at 1920 px width.
pub(in crate::calibrate) const LINE_SIGMA_PX: f64 = 2.0;

/// How far a line may likely lie from where the assumed length puts it, as a share of the σ of the
/// rules: 2.5 m at the end of a soccer pitch, whose length is then 5 m another one.
const LIKELY_SHARE: f64 = 1.0 / 3.0;

/// A landmark lies on a line within this distance, m.
const ON_LINE_M: f64 = 0.1;

/// Maximum number of known frames that are looked at, spread evenly over the document.
const MAX_KNOWN: usize = 200;

/// The lengths at which the lines in a picture are predicted where a length is open, in σ from the
/// assumed one: a line may enter the picture only at another length.
const SIGMAS: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];

/// Of each line of a field whether it is known to lie where it is drawn: as far as its length, and
/// as far as its width moves it.
pub(in crate::calibrate) type MarkedLines = [Vec<bool>; 2];

/// The lines that a known frame stands for.
pub(in crate::calibrate) enum SeenLines {
    /// All in its picture.
    InPicture,
    /// Those that are marked.
    Marked(MarkedLines),
}

impl SeenLines {
    /// Whether it shows how the length (`axis` 0) or the width (1) moves a line.
    fn shows(&self, line: usize, axis: usize) -> bool {
        match self {
            Self::InPicture => true,
            Self::Marked(lines) => lines[axis].get(line).copied().unwrap_or(false),
        }
    }
}

/// A length of a field as a known camera leaves it, and how the lines of the field move with it.
pub(in crate::calibrate) struct UnseenSize {
    size: OpenSize,
    /// The assumed lengths of the field, in the order of `size.params`, m.
    values_m: Vec<f64>,
    /// The index of this length among them.
    index: usize,
    /// The direction along which it moves lines.
    axis: Vec3,
    /// Motion of each line along the axis per metre of the length: 0.5 at the right or far end, 0 in
    /// the middle, −0.5 at the left or near end.
    by_line: Vec<f64>,
    /// The same of what the known cameras have seen, and with it of the base.
    by_seen: f64,
    /// Whether they have seen any line that moves. If not, it is not known with what the base goes.
    is_base_held: bool,
    /// 1-σ of the length from the rules and from what the known cameras have seen, m.
    sigma_m: f64,
    /// Root mean square of the error of the assumed length, m.
    error_m: f64,
    /// The field at each likely length, and the motion of the base.
    likely: Vec<(FieldModel, Vec3)>,
}

impl UnseenSize {
    /// What the frames of a camera leave open of the size of its field. `seen` gives, by index and
    /// frame, the lines that a known frame stands for; of one with clicks, these are the lines with
    /// clicks. Rejected ones say nothing. Empty without a base, or if the rules fix the size.
    ///
    /// # Errors
    /// The field is not valid.
    pub fn from_known_frames(
        at: DocumentAt<'_>,
        camera: &Camera,
        seen: &dyn Fn(usize, &Frame) -> Option<SeenLines>,
    ) -> Result<Vec<Self>, FieldError> {
        let Some(base) = camera.base() else {
            return Ok(Vec::new());
        };
        let spec = at.document.field_of_camera(&camera.id);
        let field = at.model_of(spec)?;
        let size = OpenSize::of(at, spec, &field)?;
        let frames = at.document.frames.iter().enumerate();
        let known = frames.filter(|(_, frame)| {
            frame.camera == camera.id && frame.status != FrameStatus::Rejected
        });
        let known: Vec<KnownFrame> = known
            .filter_map(|(index, frame)| KnownFrame::new(frame, seen(index, frame)?, &base, &field))
            .collect();
        let known: Vec<_> = subsample(known, MAX_KNOWN).collect();
        let lengths = 0..size.params.len();
        Ok(lengths
            .filter_map(|index| Self::new(size.clone(), index, &base, &field, &known))
            .collect())
    }

    /// None if the template has no field one step away.
    fn new(
        size: OpenSize,
        index: usize,
        base: &CameraBase,
        field: &FieldModel,
        known: &[KnownFrame],
    ) -> Option<Self> {
        let param = &size.params[index];
        let axis = if param.name == "length_m" {
            Vec3::x()
        } else {
            Vec3::y()
        };
        // A base that states its error of the length was estimated from frames that may not be
        // among the known ones.
        let stated_m = base.sigma.size[usize::from(axis.y != 0.0)].sigma_m;
        let prior_m = Some(stated_m).filter(|sigma_m| *sigma_m > 0.0);
        let sigma_m = prior_m.map_or(param.sigma_m, |sigma_m| sigma_m.min(param.sigma_m));
        let values_m = size.params.iter().map(|param| param.assumed_m).collect();
        let mut unseen = Self {
            size,
            values_m,
            index,
            axis,
            by_line: Vec::new(),
            by_seen: 0.0,
            is_base_held: false,
            sigma_m,
            error_m: sigma_m,
            likely: Vec::new(),
        };
        unseen.by_line = unseen.motions_of_lines()?;
        unseen.see_lines(field, known);
        let is_open = unseen.is_open();
        let sigmas = SIGMAS
            .into_iter()
            .filter(|sigmas| is_open || *sigmas == 0.0);
        unseen.likely = sigmas
            .filter_map(|sigmas| unseen.at_length(unseen.assumed_m() + sigmas * unseen.sigma_m))
            .collect();
        Some(unseen)
    }

    /// Joins what is known of the length with the lines that cameras have seen.
    fn see_lines(&mut self, field: &FieldModel, known: &[KnownFrame]) {
        // The motion of each line in the picture that shows it best, px at 1920 px width per metre.
        let mut shown = vec![0.0_f64; self.by_line.len()];
        let axis = usize::from(self.axis.y != 0.0);
        let reach = self.axis * (LIKELY_SHARE * self.param().sigma_m);
        for KnownFrame {
            camera,
            image,
            seen,
        } in known
        {
            // A line that the assumed length puts just inside the picture may lie outside it: it is
            // seen only if it is in the picture wherever it may likely be.
            let is_inside = |at: Vec3| {
                let seen = camera.image_from_world(at);
                seen.is_ok_and(|seen| image.contains(seen))
            };
            let mut moves: Vec<Vec<f64>> = vec![Vec::new(); shown.len()];
            for sample in telling_samples(field, camera, *image, self.axis) {
                let is_shown = seen.shows(sample.line, axis);
                if is_shown && is_inside(sample.at - reach) && is_inside(sample.at + reach) {
                    moves[sample.line].push(sample.px_per_m / image.scale_from_1920());
                }
            }
            for (shown, moves) in shown.iter_mut().zip(&mut moves) {
                moves.sort_by(|one, other| other.total_cmp(one));
                *shown = shown.max(moves.get(ENOUGH_SAMPLES - 1).copied().unwrap_or(0.0));
            }
        }
        // Regression of the lines' positions on their shares of the length's change.
        let displaced_m = usual_displacement_m(field.width_m);
        let seen = shown.iter().zip(&self.by_line);
        let weighted: Vec<(f64, f64)> = seen
            .filter(|(px_per_m, _)| **px_per_m >= TELLING_PX)
            .map(|(px_per_m, by)| {
                let variance = displaced_m.powi(2) + (LINE_SIGMA_PX / px_per_m).powi(2);
                (variance.recip(), *by)
            })
            .collect();
        let sum: f64 = weighted.iter().map(|(weight, _)| weight).sum();
        self.is_base_held = sum > 0.0;
        if self.is_base_held {
            self.by_seen = weighted.iter().map(|(weight, by)| weight * by).sum::<f64>() / sum;
        }
        let information: f64 = weighted
            .iter()
            .map(|(weight, by)| weight * (by - self.by_seen).powi(2))
            .sum();
        self.sigma_m = (self.sigma_m.powi(-2) + information).sqrt().recip();
        self.error_m = self.sigma_m;
    }

    /// The length as a parameter of the field.
    pub fn param(&self) -> &SizeParam {
        &self.size.params[self.index]
    }

    /// Whether the known cameras have seen a part of the field with which the base goes.
    pub const fn is_base_held(&self) -> bool {
        self.is_base_held
    }

    /// Whether the known cameras leave the length open.
    pub fn is_open(&self) -> bool {
        self.param().is_open_at(self.sigma_m)
    }

    /// The assumed length, m.
    pub fn assumed_m(&self) -> f64 {
        self.values_m[self.index]
    }

    /// Takes in a measurement of the length with its 1-σ, m. The lines stay where the assumed length
    /// puts them, so that its distance from the measured one is an error, too.
    pub fn take_measured(&mut self, value_m: f64, sigma_m: f64) {
        self.error_m = sigma_m.hypot(value_m - self.assumed_m());
    }

    /// The field at another length, clamped to what the rules allow, and the translation of the base
    /// from which what is seen projects as before, m.
    pub fn at_length(&self, length_m: f64) -> Option<(FieldModel, Vec3)> {
        let length_m = length_m.clamp(self.param().min_m, self.param().max_m);
        let mut values_m = self.values_m.clone();
        values_m[self.index] = length_m;
        let field = self.size.field_with_lengths(&values_m)?;
        Some((field, self.base_shift(length_m)))
    }

    /// Translation of the base with what it has seen, m.
    pub fn base_shift(&self, length_m: f64) -> Vec3 {
        self.axis * (self.by_seen * (length_m - self.assumed_m()))
    }

    /// 1-σ of a measurement on paint at least, m: the error of the base is common to all frames.
    pub fn least_sigma_m(&self) -> f64 {
        self.likely
            .first()
            .map_or(0.0, |(field, _)| alone_sigma_m(field))
    }

    /// 1-σ in a picture of the lines that do not move with what was seen, px; 0 if it shows none of
    /// them at any likely length.
    pub fn sigma_px(&self, base: &CameraBase, ptz: Ptz, image: ImageSize) -> f64 {
        self.motion_px(base, ptz, image) * self.error_m
    }

    /// By how much a metre of length moves the lines in a picture relative to what was seen, px; 0
    /// if it shows none of them at any likely length.
    pub fn motion_px(&self, base: &CameraBase, ptz: Ptz, image: ImageSize) -> f64 {
        // The median over the samples of each length, the largest over the lengths: lines that may
        // be in the picture count.
        let motions = self.likely.iter().filter_map(|(field, shift_m)| {
            self.median_motion_px(
                field,
                &PtzCamera::new(move_base(base, *shift_m), ptz),
                image,
            )
        });
        motions.fold(0.0, f64::max)
    }

    /// The median motion of the lines in a picture relative to what was seen, px per metre of
    /// length. None if too few samples move.
    fn median_motion_px(
        &self,
        field: &FieldModel,
        camera: &PtzCamera,
        image: ImageSize,
    ) -> Option<f64> {
        let moves = telling_samples(field, camera, image, self.axis)
            .into_iter()
            .map(|it| it.px_per_m * (self.by_line[it.line] - self.by_seen).abs());
        // An end moves by half of the length's error, hence half the threshold.
        let mut telling: Vec<f64> = moves
            .filter(|px| *px >= TELLING_PX / 2.0 * image.scale_from_1920())
            .collect();
        median_high(&mut telling).filter(|_| telling.len() >= ENOUGH_SAMPLES)
    }

    /// The motion of each line per metre of the length, from a difference at its midpoint. None if
    /// the template has no other field near by.
    fn motions_of_lines(&self) -> Option<Vec<f64>> {
        const STEP_SIGMAS: f64 = 0.1;
        let step_m = STEP_SIGMAS * self.sigma_m;
        let (smaller, _) = self.at_length(self.assumed_m() - step_m)?;
        let (larger, _) = self.at_length(self.assumed_m() + step_m)?;
        // Lengths are clamped to the rules, so the actual step may be shorter.
        let name = &self.param().name;
        let by_m = larger.params.get(name)? - smaller.params.get(name)?;
        let is_comparable = by_m > 0.0 && smaller.lines.len() == larger.lines.len();
        let lines = smaller.lines.iter().zip(&larger.lines);
        let motions = lines.map(|(smaller, larger)| {
            let [from, to] = [smaller, larger].map(|line| line.paint_centre.point_at(0.5));
            (to - from).dot(&self.axis) / by_m
        });
        is_comparable.then(|| motions.collect())
    }
}

/// A frame with a camera that is known.
struct KnownFrame {
    camera: PtzCamera,
    image: ImageSize,
    /// The lines that it stands for. A frame whose camera comes from clicks says nothing of lines
    /// without any: the end that was clicked is right, whatever the length, and the circle at the
    /// edge of the picture is drawn beside its paint.
    seen: SeenLines,
}

impl KnownFrame {
    /// None without a camera.
    fn new(frame: &Frame, seen: SeenLines, base: &CameraBase, field: &FieldModel) -> Option<Self> {
        let places: Vec<Vec3> = frame
            .clicks
            .iter()
            .filter_map(|click| match &click.target {
                Some(Target::Landmark(id)) => field.landmark(id.as_str()),
                _ => None,
            })
            .map(|landmark| landmark.nominal_m)
            .collect();
        let is_clicked = |line: &FieldLine| {
            let on_line = |at: &Vec3| line.curve.distance_m(*at) < ON_LINE_M;
            let mut targets = frame.clicks.iter().map(|click| &click.target);
            let names = |target: &Option<Target>| *target == Some(Target::Line(line.id.clone()));
            targets.any(names) || places.iter().any(on_line)
        };
        Some(Self {
            camera: PtzCamera::new(frame.base_from(base), frame.ptz.as_ref()?.ptz()),
            image: frame.image_size,
            seen: if frame.is_solved_by_clicks() {
                let lines: Vec<bool> = field.lines.iter().map(is_clicked).collect();
                SeenLines::Marked([lines.clone(), lines])
            } else {
                seen
            },
        })
    }
}

/// A base at another place.
pub(super) fn move_base(base: &CameraBase, by_m: Vec3) -> CameraBase {
    CameraBase {
        position_m: base.position_m + by_m,
        ..*base
    }
}

/// A sample of a line in a picture.
struct TellingSample {
    line: usize,
    /// Its place, `world`, m.
    at: Vec3,
    /// Its motion along its normal in the picture per metre of motion along an axis, px.
    px_per_m: f64,
}

/// Samples of the lines in a picture, and how an axis moves them.
fn telling_samples(
    field: &FieldModel,
    camera: &PtzCamera,
    image: ImageSize,
    axis: Vec3,
) -> Vec<TellingSample> {
    let options = SampleOptions {
        spacing_px: SPACING_PX * image.scale_from_1920(),
        ..SampleOptions::default()
    };
    let samples = sample_lines(field, camera, image, &options).into_iter();
    let moved = samples.filter_map(|sample| {
        Some(TellingSample {
            line: sample.line,
            at: sample.at,
            px_per_m: sample.motion_px_per_m(camera, axis)?.abs(),
        })
    });
    moved.collect()
}
