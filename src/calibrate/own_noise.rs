//! The annotator's own click noise, from blind re-clicks of gold frames, and what it makes of the clicks' sigmas.
//!
//! A field template states for each landmark l how far people's clicks lie from its nominal place, 1-σ `σ_l`. Two things make
//! it: the hand, anew with every click, and the place (paint is wide, grounds are not painted to the centimetre), the same in
//! every frame. On 142 real frames of three matches the place was worth 0.47, 0.55 and 0.51 `σ_l²`, so half of `σ_l²` is
//! taken for the hand and half for the place. Repeats show the hand and nothing of the place. With f the annotator's hand as a
//! multiple of the usual one, the solve uses
//!
//! `σ_l'² = ½ σ_l² + ½ f_l² σ_l²`
//!
//! so that a hand like everybody's changes nothing, and one that never trembles still misses the place.
//!
//! - f² = (ν₀ + ν s²) / (ν₀ + ν): s is the robust scale ([`ClickNoise`]) of all differences in units of the usual hand
//!   √½ `σ_l`, ν what it is worth in degrees of freedom, ν₀ = 4 what is known beforehand: people's hands differ by a factor of
//!   about 1.4. It is the mean of 1/f² under a χ² likelihood and its conjugate prior, turned round.
//! - `f_l`² = (ν₁ f² + `ν_l` `s_l`²) / (ν₁ + `ν_l`) for a landmark with eight repeats and more, ν₁ = 10: how a hand fares
//!   differs between landmarks by a factor of about 1.25 from what the template says. f for all others and for lines.

use crate::document::{DocumentAt, Extra, Fields, HAND_SHARE, Hand};
use crate::field::{FieldError, LandmarkId};
use crate::geometry::Vec2;
use crate::score::ClickNoise;
use std::collections::BTreeMap;

/// From so many repeats on the noise can be used: the fewest for which the ends of the interval of a normal hand differ by
/// less than a factor of two.
pub const ENOUGH_REPEATS: usize = 12;

/// From so many repeats on a landmark has a factor of its own.
const ENOUGH_OF_LANDMARK: usize = 8;
/// ν₀: what is known of a hand beforehand, in degrees of freedom.
const KNOWN_OF_HANDS: f64 = 4.0;
/// ν₁: what is known of a landmark beforehand.
const KNOWN_OF_LANDMARKS: f64 = 10.0;

/// What the repeats of a document say about its annotator's hand.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnNoise {
    /// Frames with repeats.
    pub frames: usize,
    /// Repeats that can be compared with an earlier click.
    pub repeats: usize,
    /// 1-σ of a click in each direction, px at 1920 px width; none while the repeats are too few to tell.
    pub noise: Option<ClickNoise>,
    /// The same to the right and downwards.
    pub noise_by_axis: [Option<ClickNoise>; 2],
    /// Every such repeat against the first click, in the document's order.
    pub offsets: Vec<RepeatOffset>,
    /// By landmark, in the order of their names.
    pub landmarks: Vec<LandmarkNoise>,
    /// What the solve would use; none while the repeats are too few.
    pub hand: Option<Hand>,
}

/// Where a repeat lies.
#[derive(Clone, Debug, PartialEq)]
pub struct RepeatOffset {
    /// The frame, by its place in the document.
    pub frame: usize,
    /// The label's click in it; none where that is gone.
    pub click: Option<usize>,
    /// What was clicked again.
    pub landmark: LandmarkId,
    /// From the label's click (or the first repeat) to this one, px at 1920 px width: both scatter.
    pub offset_px: Vec2,
}

/// What the repeats of one landmark say.
#[derive(Clone, Debug, PartialEq)]
pub struct LandmarkNoise {
    /// Which.
    pub landmark: LandmarkId,
    /// How many repeats.
    pub repeats: usize,
    /// 1-σ of a click on it, px at 1920 px width; none while the repeats are too few to tell.
    pub noise: Option<ClickNoise>,
}

impl OwnNoise {
    /// What a document's repeats say.
    ///
    /// # Errors
    /// One of its fields is not valid.
    pub fn of(document: DocumentAt<'_>) -> Result<Self, FieldError> {
        let mut found = Self { frames: 0, ..Self::default() };
        if document.frames.iter().all(|frame| frame.repeats.is_empty()) {
            return Ok(found);
        }
        let fields = Fields::as_stated(document)?;
        let (mut all, mut in_hands) = (Vec::new(), Vec::new());
        let mut by_landmark: BTreeMap<LandmarkId, [Vec<Vec2>; 2]> = BTreeMap::new();
        for (index, frame) in document.frames.iter().enumerate().filter(|(_, frame)| !frame.repeats.is_empty()) {
            found.frames += 1;
            let scale = frame.image_size.scale_from_1920();
            let field = fields.of_frame(&document, frame);
            for repeated in frame.repeated_clicks() {
                let first = repeated.clicks[0];
                found.offsets.extend(repeated.clicks.iter().skip(1).map(|click| RepeatOffset {
                    frame: index,
                    click: repeated.labelled,
                    landmark: repeated.landmark.clone(),
                    offset_px: click.offset_from(first) / scale,
                }));
                let stated = field.landmark(repeated.landmark.as_str()).map(|landmark| landmark.click_sigma_px);
                let [of_landmark, of_landmark_in_hands] = by_landmark.entry(repeated.landmark.clone()).or_default();
                for difference in repeated.differences().map(|difference| difference / scale) {
                    all.push(difference);
                    of_landmark.push(difference);
                    if let Some(stated) = stated {
                        let in_hand = difference / (HAND_SHARE.sqrt() * stated);
                        in_hands.push(in_hand);
                        of_landmark_in_hands.push(in_hand);
                    }
                }
            }
        }
        found.repeats = all.len();
        found.noise = ClickNoise::of(&all);
        found.noise_by_axis = [0, 1].map(|axis| ClickNoise::along(all.iter().map(|difference| difference[axis])));
        found.hand = found.noise.and_then(|noise| hand(&noise, &in_hands, &by_landmark));
        found.landmarks = by_landmark
            .into_iter()
            .filter(|(_, [differences, _])| !differences.is_empty())
            .map(|(landmark, [differences, _])| LandmarkNoise {
                landmark,
                repeats: differences.len(),
                noise: ClickNoise::of(&differences),
            })
            .collect();
        Ok(found)
    }

    /// How many more repeats are needed before the noise can be used.
    #[must_use]
    pub const fn missing(&self) -> usize {
        ENOUGH_REPEATS.saturating_sub(self.repeats)
    }
}

fn hand(noise: &ClickNoise, in_hands: &[Vec2], by_landmark: &BTreeMap<LandmarkId, [Vec<Vec2>; 2]>) -> Option<Hand> {
    let seen = ClickNoise::of(in_hands).filter(|seen| seen.pairs >= ENOUGH_REPEATS)?;
    let factor = drawn_towards(1.0, KNOWN_OF_HANDS, &seen);
    let own_factor = |in_hands: &[Vec2]| {
        let seen = ClickNoise::of(in_hands).filter(|seen| seen.pairs >= ENOUGH_OF_LANDMARK)?;
        Some(drawn_towards(factor, KNOWN_OF_LANDMARKS, &seen))
    };
    let own = by_landmark.iter();
    let own = own.filter_map(|(id, [_, in_hands])| Some((id.as_str().to_owned(), own_factor(in_hands)?)));
    Some(Hand {
        in_use: true,
        hand_factor: factor,
        hand_factor_by_landmark: own.collect(),
        sigma_px: noise.sigma,
        sigma_interval_95_px: noise.interval_95,
        repeats: noise.pairs,
        extra: Extra::new(),
    })
}

/// What was seen, drawn towards what is known beforehand, each by its worth.
fn drawn_towards(known: f64, known_worth: f64, seen: &ClickNoise) -> f64 {
    let sum = known_worth * known * known + seen.worth * seen.sigma * seen.sigma;
    (sum / (known_worth + seen.worth)).sqrt()
}
