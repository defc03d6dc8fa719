//! How the overlay looks.

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
