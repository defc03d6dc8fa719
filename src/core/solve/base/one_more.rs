//! Which further frame would improve a base that was estimated from few frames.

use super::adjust::adjust_base;
use super::{AdjustOptions, BaseModel, CameraClicks, FrameClicks};
use crate::camera::{CameraBase, Ptz, PtzCamera};
use crate::field::{FieldModel, Landmark};
use crate::geometry::{Angle, AngleRange, ImageSize};
use crate::solve::Observation;
use serde::Serialize;
use std::fmt;

/// The number of points assumed on the further frame.
const POINTS: usize = 4;

/// A frame is recommended if it reduces the position's 1-σ to at most this fraction.
const WORTH_A_FRAME: f64 = 0.8;

/// The further frame that would improve a base most.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OneMoreFrame {
    /// On which side of the used frames it looks.
    pub side: BesideFrames,
    /// The current 1-σ of the position, m.
    pub now_m: f64,
    /// The predicted 1-σ with four points on that frame, m.
    pub then_m: f64,
}

/// A side of the frames from which a base was estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BesideFrames {
    /// Farther to the left than the leftmost.
    Left,
    /// Farther to the right than the rightmost.
    Right,
}

impl fmt::Display for OneMoreFrame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let side = match self.side {
            BesideFrames::Left => "left",
            BesideFrames::Right => "right",
        };
        write!(
            f,
            "one more frame on the {side} with {POINTS} points would take the position from ±{:.2} m to about ±{:.2} m",
            self.now_m, self.then_m
        )
    }
}

/// The further frame, half a picture to the left or to the right of the existing ones, that would
/// reduce the position's uncertainty clearly and most, if one does. The uncertainty is predicted by
/// an adjustment with exact points in that frame. `known_m` is the 1-σ of the position as stated
/// now; the prediction scales it.
pub(super) fn one_more_frame(
    clicks: &CameraClicks<'_>,
    base: &CameraBase,
    ptz: &[Option<Ptz>],
    (model, options): (&BaseModel, &AdjustOptions),
    known_m: f64,
) -> Option<OneMoreFrame> {
    let seen = AngleRange::smallest(ptz.iter().flatten().map(|ptz| ptz.pan))?;
    let prediction = Prediction {
        clicks,
        base,
        model,
        options,
    };
    // The relative gain is predicted; it scales the σ that is stated now.
    let now = prediction.position_sigma_m(clicks.frames, ptz);
    let sides = [BesideFrames::Left, BesideFrames::Right]
        .into_iter()
        .filter_map(|side| {
            let there = view_beside(ptz, &seen, side, clicks.image_size)?;
            let share = prediction.position_sigma_m_with(there, ptz)? / now;
            (share <= WORTH_A_FRAME).then_some(OneMoreFrame {
                side,
                now_m: known_m,
                then_m: share * known_m,
            })
        });
    sides.min_by(|a, b| a.then_m.total_cmp(&b.then_m))
}

/// The outermost frame on a side, panned outwards by half its field of view; none without a frame.
///
/// `seen` are the pans of all frames.
fn view_beside(
    ptz: &[Option<Ptz>],
    seen: &AngleRange,
    side: BesideFrames,
    image_size: ImageSize,
) -> Option<Ptz> {
    let at = match side {
        BesideFrames::Left => seen.start(),
        BesideFrames::Right => seen.end(),
    };
    let (_, outermost) = ptz
        .iter()
        .flatten()
        .map(|ptz| (ptz.pan.turn_from(at).abs().radians(), ptz))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    // Half a view further out, the new frame shares half of its picture with the outermost one and
    // shows what none has shown.
    let half_view =
        Angle::from_radians((0.5 * f64::from(image_size.width) / outermost.focal_px).atan());
    let pan = match side {
        BesideFrames::Left => at - half_view,
        BesideFrames::Right => at + half_view,
    };
    Some(Ptz {
        pan: pan.wrap(),
        ..*outermost
    })
}

/// The adjustment that predicts how certain the position is with one more frame.
struct Prediction<'a> {
    clicks: &'a CameraClicks<'a>,
    base: &'a CameraBase,
    model: &'a BaseModel,
    options: &'a AdjustOptions,
}

impl Prediction<'_> {
    /// 1-σ of the position after an adjustment to some frames, m. The estimated noise scale is
    /// divided out, because exact points of the new frame would make the noise seem smaller than it
    /// is.
    fn position_sigma_m(&self, frames: &[FrameClicks], ptz: &[Option<Ptz>]) -> f64 {
        let clicks = CameraClicks {
            frames,
            ..*self.clicks
        };
        let adjusted = adjust_base(&clicks, self.base, ptz, self.model, self.options);
        (adjusted.position_covariance.trace() / adjusted.noise_scale).sqrt()
    }

    /// The same with exact points of one more frame, which have the usual click noise as their σ.
    /// None if that frame shows too few.
    fn position_sigma_m_with(&self, there: Ptz, ptz: &[Option<Ptz>]) -> Option<f64> {
        let camera = PtzCamera::new(*self.base, there);
        let observations = points_shown(self.clicks.field, &camera, self.clicks.image_size)?;
        let (mut frames, mut ptz) = (self.clicks.frames.to_vec(), ptz.to_vec());
        frames.push(FrameClicks {
            observations,
            start: None,
        });
        ptz.push(Some(there));
        Some(self.position_sigma_m(&frames, &ptz))
    }
}

/// Exact clicks on the landmarks nearest to the corners of a picture; none where it shows fewer
/// than four.
fn points_shown(
    field: &FieldModel,
    camera: &PtzCamera,
    image_size: ImageSize,
) -> Option<Vec<Observation>> {
    let mut shown: Vec<Observation> = field
        .landmarks
        .iter()
        .filter_map(|landmark| exact_click(field, landmark, camera, image_size))
        .collect();
    // One landmark for each corner, taken out of the list, so that none is chosen twice. With none
    // left for a corner the frame shows too few.
    let mut chosen = Vec::with_capacity(POINTS);
    for corner in image_size.corners() {
        let (_, nearest) = (0..shown.len())
            .map(|index| (shown[index].image.distance_px(corner), index))
            .min_by(|a, b| a.0.total_cmp(&b.0))?;
        chosen.push(shown.swap_remove(nearest));
    }
    Some(chosen)
}

/// A click on a landmark exactly where a camera shows it; none outside the picture.
fn exact_click(
    field: &FieldModel,
    landmark: &Landmark,
    camera: &PtzCamera,
    image_size: ImageSize,
) -> Option<Observation> {
    let image = camera
        .image_from_world(field.landmark_in_world(landmark))
        .ok()?;
    let click =
        Observation::from_landmark(field, landmark.id.as_str(), image, image_size, 0).ok()?;
    image_size.contains(image).then_some(click)
}
