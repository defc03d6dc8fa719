//! Settings for the look of the overlay and the picture below it.

use serde::{Deserialize, Serialize};

/// Colour, width and opacity of the overlay.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct OverlayStyle {
    /// Red, green, blue, 0–255.
    pub colour: [u8; 3],
    /// Width of a line on screen, points.
    pub width: f32,
    /// 0 is invisible, 1 solid.
    pub opacity: f32,
    /// Width of the dark rim that keeps a line readable on any grass, points on each side.
    pub outline: f32,
    /// Whether to draw landmarks as small rings when there is a solution.
    pub landmarks: bool,
    /// Whether to draw the residual of a click ten times as long, so that its direction shows.
    pub residuals_times_ten: bool,
}

impl Default for OverlayStyle {
    fn default() -> Self {
        Self {
            colour: [255, 221, 64],
            width: 2.0,
            opacity: 0.8,
            outline: 1.0,
            landmarks: true,
            residuals_times_ten: false,
        }
    }
}

/// Brightness, contrast and gamma of the shown picture. They do not affect what is measured in it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PictureLook {
    /// Factor of all values; 1 leaves them unchanged.
    pub brightness: f32,
    /// Factor of the difference from a middle grey; 1 leaves it unchanged.
    pub contrast: f32,
    /// Values `v` from 0 to 1 become `v^(1/gamma)`; 1 leaves them unchanged.
    pub gamma: f32,
}

impl Default for PictureLook {
    fn default() -> Self {
        Self {
            brightness: 1.0,
            contrast: 1.0,
            gamma: 1.0,
        }
    }
}

impl PictureLook {
    /// Range of each of the three numbers.
    pub const RANGE: std::ops::RangeInclusive<f32> = 0.25..=4.0;

    /// A look with only the brightness changed.
    pub fn from_brightness(brightness: f32) -> Self {
        Self {
            brightness,
            ..Self::default()
        }
    }

    /// This look, with the brightness multiplied by `factor`.
    #[must_use]
    pub const fn dim(self, factor: f32) -> Self {
        Self {
            brightness: self.brightness * factor,
            ..self
        }
    }

    /// This look with each number clamped to [`Self::RANGE`], or 1 if it is not finite. The
    /// settings file may have been edited by hand.
    #[must_use]
    pub const fn within_limits(self) -> Self {
        const fn within(value: f32) -> f32 {
            if value.is_finite() {
                value.clamp(*PictureLook::RANGE.start(), *PictureLook::RANGE.end())
            } else {
                1.0
            }
        }
        Self {
            brightness: within(self.brightness),
            contrast: within(self.contrast),
            gamma: within(self.gamma),
        }
    }
}
