//! Settings of feature extraction.

/// The detector and descriptor of features.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Detector {
    /// SIFT (Lowe, 2004), as in the paper.
    #[default]
    Sift,
    /// ORB (Rublee and others, 2011): corners and bits, much faster, for comparison.
    Orb,
    /// AKAZE (Alcantarilla and others, 2013): bits from a non-linear scale space, for comparison.
    Akaze,
}

impl Detector {
    /// All detectors, in order of their codes.
    pub const ALL: [Self; 3] = [Self::Sift, Self::Orb, Self::Akaze];

    /// The code that files store.
    #[must_use]
    pub const fn code(self) -> u32 {
        self as u32
    }

    /// The detector of a code. None if there is no such detector.
    #[must_use]
    pub fn from_code(code: u32) -> Option<Self> {
        Self::ALL.get(code as usize).copied()
    }
}

/// Settings of feature extraction. A forest stores those that it was trained with and is queried
/// with the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FeatureOptions {
    /// Maximum number of features: the strongest, spread over the picture. 1000 by default.
    pub max_count: u32,
    /// Wider pictures are reduced by the smallest whole factor that brings them to this width or
    /// less, px. 1280 by default: 1080p is halved, which takes a quarter of the time and costs no
    /// measurable accuracy.
    pub max_width_px: u32,
    /// `RootSIFT`: the square root of the histograms' shares, so that Euclidean distances are
    /// Hellinger distances (Arandjelović and Zisserman, CVPR 2012). Plain by default, as in the
    /// paper.
    pub root_sift: bool,
    /// SIFT by default.
    pub detector: Detector,
}

impl Default for FeatureOptions {
    fn default() -> Self {
        Self {
            max_count: 1000,
            max_width_px: 1280,
            root_sift: false,
            detector: Detector::Sift,
        }
    }
}

impl FeatureOptions {
    /// The whole factor by which a picture of this width is reduced.
    #[cfg(feature = "opencv")]
    pub(super) fn reduction(&self, width_px: u32) -> u32 {
        width_px.div_ceil(self.max_width_px.max(1)).max(1)
    }
}

#[cfg(all(test, feature = "opencv"))]
mod tests {
    use super::FeatureOptions;

    #[test]
    fn only_wide_pictures_are_reduced_and_by_whole_factors() {
        let options = FeatureOptions::default();
        for (width, factor) in [(0, 1), (640, 1), (1280, 1), (1281, 2), (1920, 2), (3840, 3)] {
            assert_eq!(options.reduction(width), factor, "{width}");
        }
        assert_eq!(
            FeatureOptions {
                max_width_px: 0,
                ..options
            }
            .reduction(2),
            2
        );
    }
}
