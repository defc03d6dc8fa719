//! Distances of clicks from the projections of what they name, compared with the distances that
//! click noise explains.

use rayon::prelude::*;
use std::collections::BTreeMap;
use touchline_calibration::calibrate::observations;
use touchline_core::field::FieldModel;
use touchline_core::geometry::quantile;
use touchline_core::score::{median_normal_size, median_rayleigh, rayleigh_share};
use touchline_core::solve::Observation;
use touchline_documents::document::{CameraId, Document, Fields, Frame, FrameStatus, Target};

/// Approximate number of bins of a histogram.
const BINS: usize = 24;
/// The scale of a histogram extends to this quantile of the errors,
const NEARLY_ALL: f64 = 0.95;
/// times this factor.
const FARTHER: f64 = 1.2;
/// Nearly all errors of correct clicks are below this multiple of their median. (A Rayleigh
/// distribution has 94 % of its mass below it.)
const NEARLY_ALL_OF_RIGHT: f64 = 2.0;
/// Number of unknowns of a frame: pan, tilt, focal length.
const UNKNOWNS: usize = 3;

/// The error of a named click.
#[derive(Clone, Debug, PartialEq)]
pub struct ClickError {
    /// The index of the frame in the document.
    pub frame: usize,
    /// The index of the click in the frame.
    pub click: usize,
    /// The landmark or line that it names.
    pub target: Target,
    /// Whether it was held out of the solve.
    pub check: bool,
    /// Distance from the projection of what it names, px at 1920 px width. Infinite if the camera
    /// does not see that.
    pub error_px: f64,
    /// Expected median of such errors if all names are right, px at 1920 px width: from the click
    /// noise of the landmark or line. It is lower for clicks that took part in the solve, because
    /// the camera was fitted to them.
    pub expected_px: f64,
}

/// The errors of the named clicks in a camera's frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClickErrors {
    /// The errors that are informative, in the document's order.
    pub clicks: Vec<ClickError>,
    /// Number of frames that have as many equations as unknowns, so that their errors say nothing.
    pub without_evidence: usize,
    /// Statistics of the clicks that took part in solves; none if there are no such clicks.
    pub used: Option<Spread>,
    /// Statistics of the check clicks, with the same width of bins.
    pub held_out: Option<Spread>,
}

/// Statistics of errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// Number of errors.
    pub count: usize,
    /// Median, px at 1920 px width.
    pub median_px: f64,
    /// 90 % quantile, px at 1920 px width.
    pub most_px: f64,
    pub histogram: Histogram,
}

impl ClickErrors {
    /// Computes the errors in a camera's solved frames that are not rejected. Frames are processed
    /// in parallel.
    pub fn compute(document: &Document, fields: &Fields, camera: &CameraId) -> Self {
        let of_frames: Vec<OfFrame> = document
            .frames
            .par_iter()
            .enumerate()
            .filter(|(_, frame)| counts(frame, camera))
            .filter_map(|(index, frame)| {
                OfFrame::compute(document, index, frame, fields.for_frame(document, frame))
            })
            .collect();
        let without_evidence = of_frames.iter().filter(|of| !of.is_evident).count();
        let clicks = of_frames.into_iter().flat_map(|of| of.clicks).collect();
        let mut found = Self {
            clicks,
            without_evidence,
            ..Self::default()
        };
        let step_px = Histogram::step_for(&found.clicks);
        [found.used, found.held_out] = [false, true].map(|check| found.spread(check, step_px));
        found
    }

    /// Statistics of the check clicks (`check`) or of the others. None without any.
    fn spread(&self, check: bool, step_px: f64) -> Option<Spread> {
        let those = || self.clicks.iter().filter(|click| click.check == check);
        let [median_px, most_px] = middle_and_most(those().map(|click| click.error_px))?;
        Some(Spread {
            count: those().count(),
            median_px,
            most_px,
            histogram: Histogram::from_errors(those(), step_px),
        })
    }
}

/// Whether the clicks of a frame count for the statistics of a camera.
fn counts(frame: &Frame, camera: &CameraId) -> bool {
    frame.camera == *camera && frame.status != FrameStatus::Rejected && !frame.clicks.is_empty()
}

/// The errors of one frame's clicks.
struct OfFrame {
    /// The informative errors.
    clicks: Vec<ClickError>,
    /// False if clicks took part in the solve but nothing is over-determined.
    is_evident: bool,
}

impl OfFrame {
    /// The errors of a frame. None if the frame has no camera, or a click names something that its
    /// field lacks.
    fn compute(
        document: &Document,
        index: usize,
        frame: &Frame,
        field: &FieldModel,
    ) -> Option<Self> {
        let camera = document.ptz_camera(frame)?;
        // A frame with a click that its field lacks was never solved.
        let observed = observations(frame, field).ok()?;
        let used = || observed.iter().filter(|observation| !observation.check);
        let equations: usize = used().map(Observation::equations).sum();
        // Two clicks alone are no evidence, also if they give more than three equations; the
        // verdict uses the same rule.
        let evident = equations > UNKNOWNS && used().count() > 2;
        // With n equations and 3 unknowns, the expected mean squared residual of the fit is 1 − 3/n
        // of the variance.
        let fitted = (equations.saturating_sub(UNKNOWNS) as f64 / equations.max(1) as f64).sqrt();
        let scale = frame.image_size.scale_from_1920();
        let clicks = observed
            .iter()
            .filter(|observation| evident || observation.check)
            .filter_map(|observation| {
                let target = frame.clicks.get(observation.click)?.target.clone()?;
                let share = if observation.check { 1.0 } else { fitted };
                Some(ClickError {
                    frame: index,
                    click: observation.click,
                    target,
                    check: observation.check,
                    error_px: observation
                        .distance_px(&camera)
                        .map_or(f64::INFINITY, |px| px / scale),
                    expected_px: share * usual_px(observation) / scale,
                })
            })
            .collect();
        Some(Self {
            clicks,
            is_evident: evident || used().count() == 0,
        })
    }
}

/// Median distance of correct clicks from what they name, px of the frame. Two equations: a
/// Rayleigh distribution; one (a point on a line): the absolute value of a normal distribution.
fn usual_px(observation: &Observation) -> f64 {
    let median = if observation.equations() == 2 {
        median_rayleigh()
    } else {
        median_normal_size()
    };
    median * observation.sigma_px
}

/// The share of distances below `limit_px`, for a Rayleigh distribution with the median
/// `median_px`. Points on lines are treated the same way, as an approximation.
fn share_below(limit_px: f64, median_px: f64) -> f64 {
    if median_px > 0.0 {
        rayleigh_share(limit_px / median_px * median_rayleigh())
    } else {
        1.0
    }
}

/// Median and 90 % quantile of errors, px; none without any.
pub(super) fn middle_and_most(errors: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    let mut sorted: Vec<f64> = errors.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    (!sorted.is_empty()).then(|| [quantile(&sorted, 0.5), quantile(&sorted, 0.9)])
}

/// A histogram of errors, with the expected one of correct clicks.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Width of a bin, px at 1920 px width.
    pub step_px: f64,
    /// The bins from 0 on. The last one contains all larger errors.
    pub bins: Vec<Bin>,
    /// Expected number in each bin if all names were right.
    pub expected: Vec<f64>,
}

/// The errors in one bin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bin {
    /// Their number.
    pub count: usize,
    /// The indices of frame and click of the largest one.
    pub worst: Option<(usize, usize)>,
    worst_px: f64,
}

impl Histogram {
    /// The width of a bin, px: 1, 2 or 5 times a power of ten, and so large that the histogram
    /// contains nearly all errors and nearly all correct clicks would be in it.
    fn step_for(errors: &[ClickError]) -> f64 {
        let mut sorted: Vec<f64> = errors
            .iter()
            .map(|click| click.error_px)
            .filter(|px| px.is_finite())
            .collect();
        sorted.sort_by(f64::total_cmp);
        // A quantile, because a few gross errors would squeeze all others into one bin.
        let nearly_all = if sorted.is_empty() {
            0.0
        } else {
            quantile(&sorted, NEARLY_ALL)
        };
        let right = errors
            .iter()
            .map(|click| NEARLY_ALL_OF_RIGHT * click.expected_px)
            .fold(0.0, f64::max);
        let reach_px = FARTHER * nearly_all.max(right);
        let steps =
            (-1..4).flat_map(|power| [1.0, 2.0, 5.0].map(|factor| factor * 10f64.powi(power)));
        steps
            .into_iter()
            .find(|step| step * BINS as f64 >= reach_px)
            .unwrap_or(1e4)
    }

    /// Computes a histogram of `errors` with bins of `step_px`.
    fn from_errors<'a>(errors: impl IntoIterator<Item = &'a ClickError>, step_px: f64) -> Self {
        let mut bins = vec![Bin::default(); BINS + 1];
        // Clicks are grouped by their expected median, of which there are few different ones: one
        // for each combination of landmark and number of clicks. Its bits are the key.
        let mut noises: BTreeMap<u64, f64> = BTreeMap::new();
        for click in errors {
            *noises.entry(click.expected_px.to_bits()).or_default() += 1.0;
            // The conversion saturates, so that an infinite error goes into the last bin.
            let bin = &mut bins[((click.error_px / step_px) as usize).min(BINS)];
            bin.count += 1;
            if bin.worst.is_none() || click.error_px > bin.worst_px {
                (bin.worst, bin.worst_px) = (Some((click.frame, click.click)), click.error_px);
            }
        }
        let below = |bin: usize| expected_below(&noises, bin as f64 * step_px);
        let all: f64 = noises.values().sum();
        let expected = (0..=BINS)
            .map(|bin| if bin < BINS { below(bin + 1) } else { all } - below(bin))
            .collect();
        Self {
            step_px,
            bins,
            expected,
        }
    }

    /// The number of errors in the fullest bin.
    pub fn highest(&self) -> usize {
        self.bins.iter().map(|bin| bin.count).max().unwrap_or(0)
    }
}

/// How many errors below `limit_px` correct clicks would have. `noises` is the number of clicks for
/// each expected median, whose bits are the key.
fn expected_below(noises: &BTreeMap<u64, f64>, limit_px: f64) -> f64 {
    noises
        .iter()
        .map(|(median, count)| count * share_below(limit_px, f64::from_bits(*median)))
        .sum()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::path::Path;
    use touchline_core::camera::{Ptz, PtzCamera};
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::{base_at, soccer};
    use touchline_documents::document::{Click, FramePtz};
    use touchline_documents::testing::{match_from, new_frame};

    const SIZE: ImageSize = ImageSize::new(960, 540);

    /// A document with frames whose clicks are displaced to the right by the given distances, px of
    /// the frame.
    pub fn document(frames: &[&[(&str, f64, bool)]]) -> Document {
        let base = base_at([0.0, -62.0, 17.0], SIZE);
        let ptz = Ptz::from_degrees(0.0, -14.0, 900.0);
        let field = soccer();
        let mut document = match_from(&base, SIZE);
        for clicks in frames {
            let mut frame = new_frame("a.jpg", SIZE);
            frame.ptz = Some(FramePtz::new(ptz, None));
            for &(name, off_px, check) in *clicks {
                let world = field.landmark_in_world(field.landmark(name).unwrap());
                let mut at = PtzCamera::new(base, ptz).image_from_world(world).unwrap();
                at.x += off_px;
                frame.clicks.push(Click {
                    check,
                    ..Click::landmark(name.into(), at)
                });
            }
            document.frames.push(frame.into());
        }
        document
    }

    pub fn errors(document: &Document) -> ClickErrors {
        ClickErrors::compute(
            document,
            &Fields::from_document(document.at(Path::new(""))).unwrap(),
            &"main".into(),
        )
    }

    const THREE: [(&str, f64, bool); 3] = [
        ("centre_mark", 1.0, false),
        ("halfway_far", 0.5, false),
        ("centre_circle_left", 0.0, false),
    ];

    #[test]
    fn errors_are_given_at_1920_px_and_relative_to_the_noise_of_clicks() {
        let found = errors(&document(&[&THREE, &[("centre_mark", 3.0, true)]]));
        let off: Vec<f64> = found
            .clicks
            .iter()
            .map(|click| (click.error_px * 10.0).round() / 10.0)
            .collect();
        assert_eq!(off, [2.0, 1.0, 0.0, 6.0], "a picture of half the width");
        let sigma_px = soccer().landmark("centre_mark").unwrap().click_sigma_px;
        assert!((found.clicks[3].expected_px - median_rayleigh() * sigma_px).abs() < 1e-9);
        let fitted = (3.0_f64 / 6.0).sqrt();
        assert!((found.clicks[0].expected_px - fitted * median_rayleigh() * sigma_px).abs() < 1e-9);
        let (used, held_out) = (found.used.unwrap(), found.held_out.unwrap());
        assert_eq!(
            (used.count, held_out.count, found.without_evidence),
            (3, 1, 0)
        );
        assert!((used.median_px - 1.0).abs() < 1e-6 && (held_out.most_px - 6.0).abs() < 1e-6);
    }

    #[test]
    fn two_clicks_are_no_evidence_but_a_check_click_beside_them_is() {
        let two = [
            ("centre_mark", 0.0, false),
            ("halfway_far", 0.0, false),
            ("centre_circle_left", 2.0, true),
        ];
        let found = errors(&document(&[&two]));
        assert_eq!((found.clicks.len(), found.without_evidence), (1, 1));
        assert!(found.clicks[0].check && found.clicks[0].click == 2);
        let mut rejected = document(&[&THREE]);
        rejected.frames[0].status = FrameStatus::Rejected;
        assert_eq!(errors(&rejected), ClickErrors::default());
    }

    #[test]
    fn the_histogram_counts_every_error_and_the_last_bin_takes_the_rest() {
        let mut clicks = errors(&document(&[&THREE, &THREE])).clicks;
        clicks[5].error_px = f64::INFINITY;
        let step_px = Histogram::step_for(&clicks);
        assert!(
            step_px < 0.7 && step_px * BINS as f64 > 2.4,
            "2.0 px and more in 24 bins: {step_px}"
        );
        let histogram = Histogram::from_errors(&clicks, step_px);
        assert_eq!(histogram.bins.iter().map(|bin| bin.count).sum::<usize>(), 6);
        assert_eq!(
            (histogram.bins[BINS].count, histogram.bins[BINS].worst),
            (1, Some((1, 2)))
        );
        assert_eq!(histogram.highest(), 2);
        assert!((histogram.expected.iter().sum::<f64>() - 6.0).abs() < 1e-9);
        assert!(
            (share_below(3.0, 3.0) - 0.5).abs() < 1e-12,
            "half lie below the median"
        );
        assert_eq!(Histogram::step_for(&[]), 0.1);
        assert_eq!(middle_and_most([4.0, 1.0, 2.0]), Some([2.0, 3.6]));
        assert_eq!(middle_and_most([]), None);
    }
}
