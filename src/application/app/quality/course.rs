//! Pan, tilt and focal length of a camera's frames over time.

use crate::app::review::disagrees;
use crate::app::window_state::choices::TimeAxis;
use touchline_calibration::calibrate::Disagreements;
use touchline_core::geometry::AngleRange;
use touchline_documents::document::{CameraId, Clip, Document, Frame, FrameStatus};

/// Minimum share of the whole time that a view shows.
const SMALLEST_SHARE: f64 = 1e-5;

/// The quantities shown over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Pan, degrees, positive to the right.
    Pan,
    /// Tilt, degrees, positive upwards.
    Tilt,
    /// Focal length, px of the frame.
    Focal,
}

impl Quantity {
    /// All quantities, from top to bottom.
    pub const ALL: [Self; 3] = [Self::Pan, Self::Tilt, Self::Focal];

    /// The label, with the unit.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Pan => "Pan, degrees",
            Self::Tilt => "Tilt, degrees",
            Self::Focal => "Focal length, px",
        }
    }

    /// The name of the step of undo that changes it.
    pub const fn edit_step(self) -> &'static str {
        match self {
            Self::Pan => "Set pan",
            Self::Tilt => "Set tilt",
            Self::Focal => "Set focal length",
        }
    }
}

/// The status of a frame, as the curve distinguishes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PointKind {
    /// New, or solved and not reviewed.
    Draft,
    /// Suggested and not reviewed.
    Suggested,
    /// Accepted.
    Reference,
}

impl PointKind {
    /// All kinds, in the order of drawing.
    pub const ALL: [Self; 3] = [Self::Draft, Self::Suggested, Self::Reference];

    /// The status with the same colour.
    pub const fn status(self) -> FrameStatus {
        match self {
            Self::Draft => FrameStatus::Draft,
            Self::Suggested => FrameStatus::Suggested,
            Self::Reference => FrameStatus::Reference,
        }
    }

    /// The kind of a frame; none if it is rejected.
    fn from_frame(frame: &Frame) -> Option<Self> {
        match frame.status {
            FrameStatus::New | FrameStatus::Draft => Some(Self::Draft),
            FrameStatus::Suggested => Some(Self::Suggested),
            FrameStatus::Reference => Some(Self::Reference),
            FrameStatus::Rejected => None,
        }
    }
}

/// A frame with a camera, as a point of the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoursePoint {
    /// The index of the frame in the document.
    pub frame: usize,
    /// The time, in the unit of the axis.
    pub at: f64,
    /// Pan and tilt in degrees, focal length in px of the frame. Pan is unwrapped, so that it does
    /// not jump at ±180°: see [`AngleRange::unwrap_angle`].
    pub values: [f64; 3],
    /// 1-σ of the values, where the frame states it.
    pub sigma: Option<[f64; 3]>,
    /// The same values of the camera that the frame was imported with, if mending replaced it.
    pub imported: Option<[f64; 3]>,
    /// The frame's status.
    pub kind: PointKind,
    /// The number of the shot along the axis. Points with the same number are joined by a line.
    pub shot: usize,
    /// Distance from what the neighbours predict, px at 1920 px width; none without two neighbours.
    pub apart_px: Option<f64>,
    /// Whether the frame disagrees with its neighbours; see [`disagrees`].
    pub stands_out: bool,
}

impl CoursePoint {
    /// One of the values.
    pub const fn value(&self, quantity: Quantity) -> f64 {
        self.values[quantity as usize]
    }
}

/// Pan, tilt and focal length of a camera's frames over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    /// The unit of time. Video time only if every frame has it.
    pub axis: TimeAxis,
    /// Whether all frames of the camera belong to one video and have a time.
    pub has_video_time: bool,
    /// The times of the camera's first and last frame; none without frames.
    pub whole: Option<[f64; 2]>,
    /// The frames with a camera, ascending in time, without rejected ones.
    pub points: Vec<CoursePoint>,
    /// The times between the last frame of a shot and the first of the next one.
    pub cuts: Vec<f64>,
    /// The indices of the points that disagree with their neighbours, largest distance first.
    pub standing_out: Vec<usize>,
}

impl Course {
    /// Computes the course of a camera. `found` has the disagreements of all frames of the
    /// document.
    pub fn compute(
        document: &Document,
        found: &Disagreements,
        camera: &CameraId,
        axis: TimeAxis,
    ) -> Self {
        let frames: Vec<(usize, &Frame)> = document
            .frames
            .iter()
            .enumerate()
            .filter(|(_, frame)| frame.camera == *camera)
            .map(|(index, frame)| (index, &**frame))
            .collect();
        let has_video_time = has_video_time(&frames);
        let axis = if has_video_time {
            axis
        } else {
            TimeAxis::Frame
        };
        let mut timed: Vec<(f64, usize, &Frame)> = frames
            .into_iter()
            .map(|(index, frame)| (time_on_axis(axis, index, frame), index, frame))
            .collect();
        timed.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        // The smallest range that contains all pans determines where the angle is unwrapped.
        let pans = timed
            .iter()
            .filter_map(|(_, _, frame)| Some(frame.ptz.as_ref()?.ptz().pan));
        let seen = AngleRange::smallest(pans).unwrap_or(AngleRange::FULL);
        let mut course = Self {
            axis,
            has_video_time,
            whole: whole(&timed),
            points: Vec::new(),
            cuts: Vec::new(),
            standing_out: Vec::new(),
        };
        // A cut lies where the clip changes. Frames without a camera count for it, too, although
        // they give no point: otherwise a line would join points across their cut.
        let mut before: Option<(f64, Option<&Clip>)> = None;
        for (at, index, frame) in timed {
            if let Some((then, clip)) = before
                && clip != frame.clip.as_ref()
            {
                course.cuts.push(f64::midpoint(then, at));
            }
            before = Some((at, frame.clip.as_ref()));
            let (Some(ptz), Some(kind)) = (&frame.ptz, PointKind::from_frame(frame)) else {
                continue;
            };
            let disagreement = found.for_frame(index);
            course.points.push(CoursePoint {
                frame: index,
                at,
                values: [
                    seen.unwrap_angle(ptz.ptz().pan).degrees(),
                    ptz.tilt_deg,
                    ptz.focal_px,
                ],
                sigma: sigma(frame),
                imported: imported_values(document, frame, &seen),
                kind,
                shot: course.cuts.len(),
                apart_px: disagreement.map(|found| found.apart_px),
                stands_out: disagreement.as_ref().is_some_and(disagrees),
            });
        }
        course.standing_out = (0..course.points.len())
            .filter(|&point| course.points[point].stands_out)
            .collect();
        let apart_px = |point: &usize| course.points[*point].apart_px.unwrap_or(0.0);
        course
            .standing_out
            .sort_by(|a, b| apart_px(b).total_cmp(&apart_px(a)));
        course
    }

    /// The number of points of a kind.
    pub fn count(&self, kind: PointKind) -> usize {
        self.points
            .iter()
            .filter(|point| point.kind == kind)
            .count()
    }

    /// The points within a span of time, including both ends.
    pub fn within(&self, span: [f64; 2]) -> &[CoursePoint] {
        let from = self.points.partition_point(|point| point.at < span[0]);
        let upto = self.points.partition_point(|point| point.at <= span[1]);
        &self.points[from.min(upto)..upto]
    }

    /// The time of a frame of the document. With video time: none if the frame has no point.
    pub fn at_of(&self, frame: usize) -> Option<f64> {
        match self.axis {
            TimeAxis::Frame => Some(frame as f64),
            TimeAxis::Video => self
                .points
                .iter()
                .find(|point| point.frame == frame)
                .map(|point| point.at),
        }
    }
}

/// 1-σ of pan, tilt and focal length.
fn sigma(frame: &Frame) -> Option<[f64; 3]> {
    let covariance = frame.solution.as_ref()?.covariance?;
    Some(covariance.diagonal().map(f64::sqrt).into())
}

/// Pan, tilt and focal length of the camera that a frame was imported with: where it looks, on the
/// base that the frame has now.
fn imported_values(document: &Document, frame: &Frame, seen: &AngleRange) -> Option<[f64; 3]> {
    let imported = frame.solution.as_ref()?.imported.as_ref()?;
    let base = document.camera_of(frame)?.base_for(frame)?;
    let looks = imported.ptz_on(&base);
    let pan = seen.unwrap_angle(looks.pan);
    Some([pan.degrees(), looks.tilt.degrees(), looks.focal_px])
}

/// The position of a frame on a time axis: its index, or its time in the video, s.
fn time_on_axis(axis: TimeAxis, index: usize, frame: &Frame) -> f64 {
    match axis {
        TimeAxis::Frame => index as f64,
        TimeAxis::Video => frame
            .video
            .as_ref()
            .and_then(|video| video.pts_s)
            .unwrap_or(0.0),
    }
}

fn has_video_time(frames: &[(usize, &Frame)]) -> bool {
    let mut videos = frames.iter().map(|(_, frame)| frame.video.as_ref());
    let Some(Some(first)) = videos.next() else {
        return false;
    };
    first.pts_s.is_some()
        && videos.all(|video| {
            video.is_some_and(|video| video.pts_s.is_some() && video.path == first.path)
        })
}

/// The first and last time. A single time is extended by 0.5 on both sides.
fn whole(timed: &[(f64, usize, &Frame)]) -> Option<[f64; 2]> {
    let (from, upto) = (timed.first()?.0, timed.last()?.0);
    Some(if from < upto {
        [from, upto]
    } else {
        [from - 0.5, upto + 0.5]
    })
}

/// Magnifies a span of time by `factor`; the time `around` keeps its position. None if the result
/// is the whole.
pub fn zoom_span(span: [f64; 2], whole: [f64; 2], around: f64, factor: f64) -> Option<[f64; 2]> {
    let smallest = ((whole[1] - whole[0]) * SMALLEST_SHARE).max(1e-3);
    // `around` keeps its share of the span. It is clamped, as the pointer may be outside.
    let length = ((span[1] - span[0]) / factor).max(smallest);
    let share = ((around - span[0]) / (span[1] - span[0])).clamp(0.0, 1.0);
    let from = around.clamp(span[0], span[1]) - share * length;
    within_whole([from, from + length], whole)
}

/// Shifts a span of time into the whole. None if it is at least as long as the whole.
pub fn within_whole(span: [f64; 2], whole: [f64; 2]) -> Option<[f64; 2]> {
    let length = span[1] - span[0];
    // Written as a negation, so that NaN means the whole, too.
    if !(length < whole[1] - whole[0]) {
        return None;
    }
    let from = span[0].clamp(whole[0], whole[1] - length);
    Some([from, from + length])
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::testing::{SIZE, base_at};
    use touchline_documents::document::VideoFrame;
    use touchline_documents::testing::{match_from, ptz_at};

    /// A slow pan of one camera through two shots of six frames.
    fn document() -> Document {
        let mut document = match_from(&base_at([0.0, -60.0, 18.0], SIZE), SIZE);
        for index in 0..12_u32 {
            let video = VideoFrame::new("m.mp4", u64::from(index), Some(0.04 * f64::from(index)));
            let mut frame = Frame::from_video(video, "main".into(), SIZE);
            frame.clip = Some(Clip::Number(i64::from(index / 6)));
            frame.ptz = ptz_at(0.1 * f64::from(index), -10.0, 2000.0);
            frame.status = FrameStatus::Suggested;
            document.frames.push(frame.into());
        }
        document
    }

    fn course(document: &Document, axis: TimeAxis) -> Course {
        Course::compute(
            document,
            &Disagreements::from_document(document),
            &"main".into(),
            axis,
        )
    }

    #[test]
    fn a_frame_off_its_neighbours_way_stands_out_and_its_neighbours_do_not() {
        let mut document = document();
        assert!(course(&document, TimeAxis::Frame).standing_out.is_empty());
        for (frame, tilt_deg) in [(2, -11.5), (9, -14.0)] {
            document.frames[frame].ptz = ptz_at(0.0, tilt_deg, 2000.0);
        }
        let found = course(&document, TimeAxis::Frame);
        assert_eq!(found.standing_out, [9, 2], "the farthest off first");
        assert!(found.points[9].apart_px > found.points[2].apart_px);
        assert!((found.points[9].value(Quantity::Tilt) + 14.0).abs() < 1e-12);
    }

    #[test]
    fn shots_are_parted_and_what_has_no_camera_or_is_rejected_is_left_out() {
        let mut document = document();
        document.frames[0].ptz = None;
        document.frames[1].status = FrameStatus::Rejected;
        document.frames[7].status = FrameStatus::Reference;
        let found = course(&document, TimeAxis::Frame);
        assert_eq!(found.cuts, [5.5]);
        let shots: Vec<usize> = found.points.iter().map(|point| point.shot).collect();
        assert_eq!(shots, [0, 0, 0, 0, 1, 1, 1, 1, 1, 1]);
        assert_eq!(
            (
                found.count(PointKind::Reference),
                found.count(PointKind::Suggested)
            ),
            (1, 9)
        );
        assert_eq!(
            found.whole,
            Some([0.0, 11.0]),
            "frames without a camera have their place in time, too"
        );
        assert_eq!(found.within([3.0, 5.0]).len(), 3);
        assert_eq!(found.within([5.2, 5.1]).len(), 0);
    }

    #[test]
    fn time_is_the_videos_only_where_every_frame_knows_it() {
        let mut document = document();
        let video = course(&document, TimeAxis::Video);
        assert_eq!((video.axis, video.has_video_time), (TimeAxis::Video, true));
        assert!(
            (video.points[11].at - 0.44).abs() < 1e-12
                && video.at_of(11) == Some(video.points[11].at)
        );
        document.frames[4].video = Some(VideoFrame::new("m.mp4", 4, None));
        let numbers = course(&document, TimeAxis::Video);
        assert_eq!(
            (numbers.axis, numbers.has_video_time),
            (TimeAxis::Frame, false)
        );
        assert_eq!(numbers.points[11].at, 11.0);
        assert_eq!(
            Course::compute(
                &document,
                &Disagreements::from_document(&document),
                &"other".into(),
                TimeAxis::Frame
            ),
            Course::default()
        );
    }

    #[test]
    fn a_span_is_enlarged_around_the_pointer_and_stays_within_the_whole() {
        let whole = [0.0, 100.0];
        assert_eq!(zoom_span(whole, whole, 20.0, 2.0), Some([10.0, 60.0]));
        assert_eq!(
            zoom_span([10.0, 60.0], whole, 20.0, 0.5),
            None,
            "back to the whole"
        );
        assert_eq!(
            zoom_span([80.0, 100.0], whole, 100.0, 0.5),
            Some([60.0, 100.0])
        );
        let [from, upto] = zoom_span([50.0, 50.01], whole, 50.0, 1e9).unwrap();
        assert!(upto - from >= 1e-3 - 1e-12, "not for ever");
        assert_eq!(within_whole([-5.0, 5.0], whole), Some([0.0, 10.0]));
        assert_eq!(within_whole([95.0, 105.0], whole), Some([90.0, 100.0]));
        assert_eq!(within_whole([-5.0, 105.0], whole), None);
    }
}
