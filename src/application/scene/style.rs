//! How the overlay and the picture below it look.

use serde::{Deserialize, Serialize};

/// Colour, width and opacity of the overlay.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct OverlayStyle {
    /// Red, green, blue, 0–255.
    pub colour: [u8; 3],
    /// The width of a line on the screen, points.
    pub width: f32,
    /// 0 is invisible, 1 solid.
    pub opacity: f32,
    /// The dark rim that keeps a line readable on any grass, points on each side.
    pub outline: f32,
    /// Draw the landmarks as small rings once there is a solution.
    pub landmarks: bool,
    /// Draw what separates a click from its solution ten times as long, to see which way it points.
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

/// How bright a picture is shown. Only how: its pixels, and what is measured in them, stay.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PictureLook {
    /// The factor of every value; 1: as it is.
    pub brightness: f32,
    /// The factor of every difference from a middle grey; 1: as it is.
    pub contrast: f32,
    /// Values `v` of 0 to 1 become `v^(1/gamma)`; 1: as they are.
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
    /// What each number may be.
    pub const RANGE: std::ops::RangeInclusive<f32> = 0.25..=4.0;

    /// As it is, but darker or brighter.
    #[must_use]
    pub fn of_brightness(brightness: f32) -> Self {
        Self {
            brightness,
            ..Self::default()
        }
    }

    /// The same, darker or brighter.
    #[must_use]
    pub const fn dimmed(self, factor: f32) -> Self {
        Self {
            brightness: self.brightness * factor,
            ..self
        }
    }

    /// Numbers from a file edited by hand, brought into their range.
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
