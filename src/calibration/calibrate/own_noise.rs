//! The annotator's own click noise, from blind re-clicks of gold frames, and the resulting σ of
//! clicks.
//!
//! A field template states for each landmark l the 1-σ `σ_l` of people's clicks about its nominal
//! position. It has two causes: the clicking, which is independent in every click, and the
//! landmark's position (paint is wide, fields are not painted to the centimetre), which is the same
//! in every frame. On 142 real frames of three matches the position caused 0.47, 0.55 and 0.51 of
//! `σ_l²`, so half of `σ_l²` is attributed to clicking and half to the position. Repeats show only
//! the clicking. With f the annotator's click noise as a multiple of the usual one, the solve uses
//!
//! `σ_l'² = ½ σ_l² + ½ f_l² σ_l²`
//!
//! so that usual click noise changes nothing, and perfectly repeatable clicks still have the error
//! of the position.
//!
//! - f² = (ν₀ + ν s²) / (ν₀ + ν): s is the robust scale ([`ClickScatter`]) of all differences in
//!   units of the usual click noise √½ `σ_l`, ν its degrees of freedom, ν₀ = 4 those of the prior:
//!   annotators differ by a factor of about 1.4. 1/f² is the posterior mean under a χ² likelihood
//!   and its conjugate prior.
//! - `f_l`² = (ν₁ f² + `ν_l` `s_l`²) / (ν₁ + `ν_l`) for a landmark with eight repeats or more, ν₁ =
//!   10: one annotator's noise on single landmarks departs from the template's ratios by a factor
//!   of about 1.25. f for all others and for lines.

use std::collections::BTreeMap;
use touchline_core::field::{CLICKING_SHARE, FieldError, LandmarkId};
use touchline_core::geometry::Vec2;
use touchline_core::score::ClickScatter;
use touchline_documents::document::{ClickNoise, Document, DocumentAt, Extra, Fields};

/// Minimum number of repeats for an estimate of the noise: the smallest for which the ends of the
/// 95 % interval differ by less than a factor of two.
pub const ENOUGH_REPEATS: usize = 12;

/// Minimum number of repeats for a separate factor of a landmark.
const ENOUGH_OF_LANDMARK: usize = 8;
/// ν₀: degrees of freedom of the prior on an annotator's factor.
const ANNOTATOR_PRIOR: f64 = 4.0;
/// ν₁: degrees of freedom of the prior on a landmark's factor.
const LANDMARK_PRIOR: f64 = 10.0;

/// The annotator's click noise as estimated from the repeats of a document.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnNoise {
    /// Frames with repeats.
    pub frames: usize,
    /// Repeats that can be compared with an earlier click.
    pub repeats: usize,
    /// 1-σ of a click in each direction, px at 1920 px width; none if there are too few repeats.
    pub noise: Option<ClickScatter>,
    /// The same for x and for y.
    pub noise_by_axis: [Option<ClickScatter>; 2],
    /// The offset of each such repeat from the first click, in the document's order.
    pub offsets: Vec<RepeatOffset>,
    /// The noise of each landmark, in the order of their names.
    pub landmarks: Vec<LandmarkNoise>,
    /// The noise that the solve uses; none if there are too few repeats.
    pub click_noise: Option<ClickNoise>,
}

/// The offset of a repeated click.
#[derive(Clone, Debug, PartialEq)]
pub struct RepeatOffset {
    /// The frame's index in the document.
    pub frame: usize,
    /// The index of the label's click in it; none if that was deleted.
    pub click: Option<usize>,
    /// The landmark that was clicked again.
    pub landmark: LandmarkId,
    /// From the label's click (or the first repeat) to this one, px at 1920 px width. Both have
    /// noise.
    pub offset_px: Vec2,
}

/// The click noise on one landmark.
#[derive(Clone, Debug, PartialEq)]
pub struct LandmarkNoise {
    /// The landmark.
    pub landmark: LandmarkId,
    /// Number of repeats.
    pub repeats: usize,
    /// 1-σ of a click on it, px at 1920 px width; none if there are too few repeats.
    pub noise: Option<ClickScatter>,
}

impl OwnNoise {
    /// Estimates the noise from a document's repeats.
    ///
    /// # Errors
    /// One of its fields is not valid.
    pub fn estimate(document: DocumentAt<'_>) -> Result<Self, FieldError> {
        let places: Vec<usize> = (0..document.frames.len())
            .filter(|index| !document.frames[*index].repeats.is_empty())
            .collect();
        if places.is_empty() {
            Ok(Self::default())
        } else {
            Ok(Self::estimate_from_frames(
                &document,
                &Fields::as_stated(document)?,
                places,
            ))
        }
    }

    /// The same where the frames with repeats are known, by their indices, ascending. The fields
    /// must be as their templates state.
    pub fn estimate_from_frames(
        document: &Document,
        fields: &Fields,
        places: impl IntoIterator<Item = usize>,
    ) -> Self {
        let mut found = Self::default();
        let (mut all, mut normalised) = (Vec::new(), Vec::new());
        let mut by_landmark: BTreeMap<LandmarkId, [Vec<Vec2>; 2]> = BTreeMap::new();
        for (index, frame) in places
            .into_iter()
            .filter_map(|index| Some((index, document.frames.get(index)?)))
        {
            found.frames += 1;
            let scale = frame.image_size.scale_from_1920();
            let field = fields.for_frame(document, frame);
            for repeated in frame.repeated_clicks() {
                // The offsets from the first click are for display: they are not independent. The
                // estimate uses `differences`, each click against the mean of those before it,
                // scaled so that each has the variance of one click.
                let first = repeated.clicks[0];
                found
                    .offsets
                    .extend(repeated.clicks.iter().skip(1).map(|click| RepeatOffset {
                        frame: index,
                        click: repeated.labelled,
                        landmark: repeated.landmark.clone(),
                        offset_px: click.offset_from(first) / scale,
                    }));
                // A landmark that the field lacks has no stated σ to normalise by.
                let stated = field
                    .landmark(repeated.landmark.as_str())
                    .map(|landmark| landmark.click_sigma_px);
                let [of_landmark, of_landmark_normalised] =
                    by_landmark.entry(repeated.landmark.clone()).or_default();
                for difference in repeated.differences().map(|difference| difference / scale) {
                    all.push(difference);
                    of_landmark.push(difference);
                    if let Some(stated) = stated {
                        let in_usual_sigmas = difference / (CLICKING_SHARE.sqrt() * stated);
                        normalised.push(in_usual_sigmas);
                        of_landmark_normalised.push(in_usual_sigmas);
                    }
                }
            }
        }
        // x and y share one σ; separate values are for display only.
        found.repeats = all.len();
        found.noise = ClickScatter::from_differences(&all);
        found.noise_by_axis =
            [0, 1].map(|axis| ClickScatter::along(all.iter().map(|difference| difference[axis])));
        found.click_noise = found
            .noise
            .and_then(|noise| click_noise(&noise, &normalised, &by_landmark));
        found.landmarks = by_landmark
            .into_iter()
            .filter(|(_, [differences, _])| !differences.is_empty())
            .map(|(landmark, [differences, _])| LandmarkNoise {
                landmark,
                repeats: differences.len(),
                noise: ClickScatter::from_differences(&differences),
            })
            .collect();
        found
    }

    /// Number of further repeats needed for an estimate.
    pub const fn missing(&self) -> usize {
        ENOUGH_REPEATS.saturating_sub(self.repeats)
    }
}

/// The click noise for the solve; `normalised` differences are in units of the usual click noise √½
/// `σ_l`.
fn click_noise(
    noise: &ClickScatter,
    normalised: &[Vec2],
    by_landmark: &BTreeMap<LandmarkId, [Vec<Vec2>; 2]>,
) -> Option<ClickNoise> {
    let seen =
        ClickScatter::from_differences(normalised).filter(|seen| seen.pairs >= ENOUGH_REPEATS)?;
    let factor = shrunk_towards(1.0, ANNOTATOR_PRIOR, &seen);
    // Landmarks with few repeats have too uncertain a scale of their own and use the annotator's
    // factor.
    let own = by_landmark.iter().filter_map(|(id, [_, normalised])| {
        let seen = ClickScatter::from_differences(normalised)
            .filter(|seen| seen.pairs >= ENOUGH_OF_LANDMARK)?;
        let own_factor = shrunk_towards(factor, LANDMARK_PRIOR, &seen);
        Some((id.as_str().to_owned(), own_factor))
    });
    // The factors are for the solve; σ in px and its interval are for display.
    Some(ClickNoise {
        in_use: true,
        factor,
        factor_by_landmark: own.collect(),
        sigma_px: noise.sigma,
        sigma_interval_95_px: noise.interval_95,
        repeats: noise.pairs,
        extra: Extra::new(),
    })
}

/// The posterior scale √((ν₀ f₀² + ν s²) / (ν₀ + ν)): f₀ is the prior's scale with ν₀ degrees of
/// freedom, s the measured one with ν.
fn shrunk_towards(prior: f64, prior_freedom: f64, seen: &ClickScatter) -> f64 {
    let sum = prior_freedom * prior * prior + seen.freedom * seen.sigma * seen.sigma;
    (sum / (prior_freedom + seen.freedom)).sqrt()
}
