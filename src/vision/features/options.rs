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
    pub const fn code(self) -> u32 {
        self as u32
    }

    /// The detector of a code. None if there is no such detector.
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

/// Minimum width of a coarse picture, px. Narrower ones show too few features.
const MIN_COARSE_WIDTH_PX: u32 = 400;

impl FeatureOptions {
    /// All settings, as files store them.
    pub(crate) fn numbers(self) -> [u32; 4] {
        let Self {
            max_count,
            max_width_px,
            root_sift,
            detector,
        } = self;
        [
            max_count,
            max_width_px,
            u32::from(root_sift),
            detector.code(),
        ]
    }

    /// The whole factor by which a picture of this width is reduced.
    pub(super) fn reduction(&self, width_px: u32) -> u32 {
        width_px.div_ceil(self.max_width_px.max(1)).max(1)
    }

    /// The options for a quick first look at a picture of this width: SIFT at half the width that
    /// these options give it (1080p: 480 px), in about a quarter of the time. None if that is below
    /// 400 px, and for other detectors, with which it was not measured.
    ///
    /// A camera found by these features is to be kept only where it is certain
    /// ([`Relocalized::is_certain`](crate::relocalize::Relocalized::is_certain)).
    pub fn coarse(&self, width_px: u32) -> Option<Self> {
        // The width is stated so that `reduction` yields twice the factor: half the width rounded
        // down would yield one more.
        let max_width_px = width_px.div_ceil(2 * self.reduction(width_px));
        (self.detector == Detector::Sift && max_width_px >= MIN_COARSE_WIDTH_PX).then_some(Self {
            max_width_px,
            ..*self
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Detector, FeatureOptions};

    #[test]
    fn the_first_look_has_half_the_width_and_never_too_little() {
        let options = FeatureOptions::default();
        for width in [800, 960, 1280, 1700, 1920, 2560, 3840, 7680] {
            let coarse = options.coarse(width).unwrap();
            let factors = [options, coarse].map(|options| options.reduction(width));
            assert_eq!(factors[1], 2 * factors[0], "{width}");
        }
        let refused = [
            (options, 1366),
            (options, 640),
            (options, 0),
            (
                FeatureOptions {
                    max_width_px: 640,
                    ..options
                },
                1920,
            ),
            (
                FeatureOptions {
                    detector: Detector::Orb,
                    ..options
                },
                1920,
            ),
        ];
        for (options, width) in refused {
            assert_eq!(options.coarse(width), None, "{options:?} {width}");
        }
    }

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
