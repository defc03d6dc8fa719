//! Whether the frames of a camera suffice for estimating its base, and which one to click next.

use std::ops::{AddAssign, SubAssign};
use touchline_core::field::FieldModel;
use touchline_core::geometry::Angle;
use touchline_core::markings::project_landmarks;
use touchline_documents::document::{CameraId, Document, Frame};

/// This number of landmarks on the ground, or of lines with two points each, determines a camera
/// without a known base: each of them gives two equations for the camera's seven unknowns.
pub const LANDMARKS_ALONE: usize = 4;

/// This number of wide frames, left, centre and right, determines a camera's position.
pub const WIDE_FRAMES: usize = 3;

/// What the frames of a camera contribute to its base.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BaseReadiness {
    /// Frames that take part: those with at least one named click.
    pub frames: usize,
    /// Number of named clicks in these frames.
    pub clicks: usize,
    /// Frames with four or more landmarks and lines, which determine a camera by themselves.
    pub wide: usize,
    /// Frames that a person has excluded.
    pub left_out: usize,
}

impl BaseReadiness {
    /// The contribution of one frame.
    pub fn from_frame(frame: &Frame) -> Self {
        let clicks = frame
            .clicks
            .iter()
            .filter(|click| !click.check && click.target.is_some())
            .count();
        if !frame.use_for_base {
            Self {
                left_out: 1,
                ..Self::default()
            }
        } else if frame.is_used_for_base() && clicks > 0 {
            let wide = usize::from(points_alone(frame) >= LANDMARKS_ALONE);
            Self {
                frames: 1,
                clicks,
                wide,
                left_out: 0,
            }
        } else {
            Self::default()
        }
    }

    /// Combines the two values of each field.
    fn each(self, other: Self, of: fn(usize, usize) -> usize) -> Self {
        Self {
            frames: of(self.frames, other.frames),
            clicks: of(self.clicks, other.clicks),
            wide: of(self.wide, other.wide),
            left_out: of(self.left_out, other.left_out),
        }
    }

    /// Whether the base will be well determined.
    pub const fn is_enough(&self) -> bool {
        self.wide >= WIDE_FRAMES
    }

    /// The instruction for the user, with the progress so far.
    pub fn describe(&self) -> String {
        format!(
            "On {WIDE_FRAMES} wide frames (left, centre, right) click {LANDMARKS_ALONE} or more landmarks, or two points on as many lines. \
             Done: {} of {WIDE_FRAMES}.",
            self.wide.min(WIDE_FRAMES)
        )
    }
}

/// The number of landmarks and lines of a frame that count towards [`LANDMARKS_ALONE`].
pub fn points_alone(frame: &Frame) -> usize {
    frame.landmark_clicks() + frame.clicked_line_count()
}

/// The frame of a camera to be clicked next for its base: one that shows enough landmarks of the
/// field, has too few clicks, and looks farthest from those that have enough. Frames whose camera
/// is not known come last. None if there is no such frame.
pub fn next_for_base(document: &Document, camera: &CameraId, field: &FieldModel) -> Option<usize> {
    let of_camera = || {
        document
            .frames
            .iter()
            .enumerate()
            .filter(|(_, frame)| frame.camera == *camera)
    };
    // Frames that suffice are what the others are compared with. Of these, only frames that show
    // enough landmarks can become such a frame.
    let wide: Vec<(usize, Option<Angle>)> = of_camera()
        .filter(|(_, frame)| is_wide(frame))
        .map(|(index, frame)| (index, pan_of(frame)))
        .collect();
    of_camera()
        .filter(|(_, frame)| frame.is_used_for_base() && !is_wide(frame))
        .filter(|(_, frame)| shows_enough(document, frame, field))
        .map(|(index, frame)| (index, distance_from_wide(index, frame, &wide)))
        // `max_by` returns the last of equal elements: reversed, that is the first frame.
        .rev()
        .max_by(|(_, a), (_, b)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)))
        .map(|(index, _)| index)
}

/// Whether a frame counts towards [`WIDE_FRAMES`].
fn is_wide(frame: &Frame) -> bool {
    BaseReadiness::from_frame(frame).wide > 0
}

/// Whether a frame shows as many landmarks as it needs. An unsolved frame may.
fn shows_enough(document: &Document, frame: &Frame, field: &FieldModel) -> bool {
    let seen = document
        .ptz_camera(frame)
        .map(|camera| project_landmarks(field, &camera, frame.image_size, 0.0).len());
    seen.is_none_or(|seen| seen >= LANDMARKS_ALONE)
}

/// The distance of a frame from the nearest wide one (index, pan): in pan (°), else in frames of
/// the document. The base is determined best if the wide frames look in different directions. The
/// flag ranks any known pan above any index.
fn distance_from_wide(index: usize, frame: &Frame, wide: &[(usize, Option<Angle>)]) -> (bool, f64) {
    let by_pan = wide
        .iter()
        .filter_map(|(_, other)| Some(pan_of(frame)?.turn_from((*other)?).degrees().abs()))
        .min_by(f64::total_cmp);
    let by_place = wide
        .iter()
        .map(|(other, _)| index.abs_diff(*other))
        .min()
        .unwrap_or(0);
    (by_pan.is_some(), by_pan.unwrap_or(by_place as f64))
}

fn pan_of(frame: &Frame) -> Option<Angle> {
    frame.ptz.as_ref().map(|ptz| ptz.ptz().pan)
}

impl AddAssign for BaseReadiness {
    fn add_assign(&mut self, other: Self) {
        *self = self.each(other, |a, b| a + b);
    }
}

impl SubAssign for BaseReadiness {
    fn sub_assign(&mut self, other: Self) {
        // Only what was added before is subtracted, so no number falls below zero.
        *self = self.each(other, |a, b| a - b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::{BaseAngles, CameraBase};
    use touchline_core::geometry::{ImagePoint, Vec3};
    use touchline_core::testing::{SIZE, soccer};
    use touchline_documents::document::{Click, FrameStatus};
    use touchline_documents::testing::match_from;
    use touchline_documents::testing::{new_frame, ptz_at};

    #[test]
    fn the_next_frame_for_the_base_looks_where_no_wide_one_does() {
        let field = soccer();
        let turned = BaseAngles {
            pitch: Angle::from_degrees(-2.0),
            ..BaseAngles::default()
        }
        .base_from_world();
        let base = CameraBase::new(Vec3::new(0.0, -60.0, 18.0), turned, SIZE.centre());
        let mut document = match_from(&base, SIZE);
        // The last one is so close up that it shows too few landmarks.
        for (pan_deg, focal_px) in [
            (0.0, 1800.0),
            (-4.0, 1800.0),
            (-22.0, 1800.0),
            (25.0, 1800.0),
            (70.0, 30_000.0),
        ] {
            let mut frame = new_frame("x.jpg", SIZE);
            frame.ptz = ptz_at(pan_deg, -10.0, focal_px);
            frame.status = FrameStatus::Draft;
            document.frames.push(frame.into());
        }
        let next = |document: &Document| next_for_base(document, &"main".into(), &field);
        let make_wide = |document: &mut Document, index: usize| {
            for landmark in [
                "centre_mark",
                "halfway_far",
                "centre_circle_left",
                "centre_circle_right",
            ] {
                let at = ImagePoint::new(100.0, 100.0);
                document.frames[index]
                    .clicks
                    .push(Click::landmark(landmark.into(), at));
            }
        };
        make_wide(&mut document, 0);
        assert_eq!(next(&document), Some(3));
        document.frames[3].use_for_base = false;
        assert_eq!(next(&document), Some(2), "a person left the other one out");
        make_wide(&mut document, 2);
        assert_eq!(next(&document), Some(1));
        make_wide(&mut document, 1);
        assert_eq!(next(&document), None);
        // It is unknown where a frame without a camera looks.
        document.frames[1].clicks.clear();
        document.frames[1].ptz = None;
        assert_eq!(next(&document), Some(1));
    }
}
