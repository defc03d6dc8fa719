//! The σ of a model's point of which only the probability is known.

use touchline_core::geometry::ImageSize;

/// 1-σ of a point of probability 1 in each direction, px at 1920 px width, beside what the field's
/// own landmarks are off.
///
/// Measured on the points that `PnLCalib` publishes for 186 broadcast pictures: each of the 2,516
/// points that its network found was compared with a homography of the others. The medians of their
/// distances, as σ in each direction at 1920 px, beside 1.4 px of the landmarks themselves:
///
/// | probability | .1–.3 | .3–.4 | .4–.5 | .5–.6 | .6–.7 | .7–.8 |
/// |---|---|---|---|---|---|---|
/// | measured | 6.6 | 3.9 | 3.5 | 2.9 | 2.7 | 3.0 |
/// | 2.2 / √p | 4.9 | 3.7 | 3.3 | 3.0 | 2.7 | 2.5 |
const SIGMA_AT_ONE_PX: f64 = 2.2;

/// Points less probable than this have the σ of this probability: 22 px.
const LEAST_PROBABILITY: f64 = 0.01;

/// 1-σ of a model's point by its probability p, px of the picture: 2.2 px / √p at 1920 px width.
pub fn sigma_by_probability_px(probability: f64, size: ImageSize) -> f64 {
    SIGMA_AT_ONE_PX * size.scale_from_1920() / probability.max(LEAST_PROBABILITY).sqrt()
}
