//! How far apart two documents see the ground at given image points, m.
//!
//! Who calibrates to measure players asks for metres on the ground, where they stand, not for
//! degrees or for metres at landmarks. For each point of a picture both cameras give a point on the
//! ground (z = 0); their distance is the error. Without given points, those of a regular grid in
//! which the true camera sees the field are taken.

use super::evaluation::{EvaluationError, fields_of};
use super::matching::match_frames;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::borrow::Cow;
use std::fmt::Write as _;
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, pluralise, quantile};
use touchline_core::score::{field_grid, ground_error_m};
use touchline_documents::document::{DocumentAt, Fields, FrameStatus};
use touchline_documents::exchange::PicturePoints;

/// The columns of the grid.
const COLUMNS: u32 = 16;

/// The distances on the ground between the points that two documents' cameras see.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundComparison {
    /// The frames of which both documents have a camera and that have a point, in the truth's
    /// order. Rejected frames of the truth are left out.
    pub frames: Vec<FrameOnGround>,
    /// Whether the points were given; else they are those of a grid over the visible field.
    pub is_given: bool,
    /// The given points at which the true camera sees no ground.
    pub without_ground: usize,
}

/// The distances of one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameOnGround {
    /// Name of the frame in messages.
    pub name: String,
    /// The distance at each point at which the true camera sees ground, m; infinite where the
    /// estimate sees none.
    pub distances_m: Vec<f64>,
}

/// Median, 95th percentile and count of distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundError {
    /// How many points there are.
    pub count: usize,
    /// m.
    pub median_m: f64,
    /// m.
    pub p95_m: f64,
}

/// Compares what two documents' cameras see on the ground at given points, or at those of a grid.
///
/// # Errors
/// A field of the truth is not valid.
pub fn compare_on_ground(
    truth: DocumentAt<'_>,
    estimate: DocumentAt<'_>,
    points: Option<&PicturePoints>,
) -> Result<GroundComparison, EvaluationError> {
    let comparison = Comparison {
        truth,
        estimate,
        fields: fields_of(truth, "truth")?,
        points,
    };
    // Frames are compared in parallel; `collect` returns them in the truth's order.
    let partners = match_frames(truth, estimate);
    let compared: Vec<(FrameOnGround, usize)> = partners
        .par_iter()
        .enumerate()
        .filter_map(|(index, partner)| comparison.frame(index, (*partner)?))
        .collect();
    let without_ground = compared.iter().map(|(_, without)| without).sum();
    let frames = compared.into_iter().map(|(frame, _)| frame);
    Ok(GroundComparison {
        frames: frames
            .filter(|frame| !frame.distances_m.is_empty())
            .collect(),
        is_given: points.is_some(),
        without_ground,
    })
}

/// Two documents, and the points at which they are compared.
struct Comparison<'a> {
    truth: DocumentAt<'a>,
    estimate: DocumentAt<'a>,
    /// The fields of the truth.
    fields: Fields,
    points: Option<&'a PicturePoints>,
}

impl Comparison<'_> {
    /// The distances of a frame of the truth and its partner, and at how many of the given points
    /// the true camera sees no ground; none where one has no camera, the truth rejects the frame or
    /// the pictures differ in size.
    fn frame(&self, index: usize, partner: usize) -> Option<(FrameOnGround, usize)> {
        let frame = self.truth.frames.get(index)?;
        let other = self.estimate.frames.get(partner)?;
        let pair = CameraPair {
            truth: self.truth.ptz_camera(frame)?,
            estimate: self.estimate.ptz_camera(other)?,
            field: self.fields.for_frame(&self.truth, frame),
            size: frame.image_size,
        };
        if frame.status == FrameStatus::Rejected || frame.image_size != other.image_size {
            return None;
        }
        let points = self.points.map_or_else(
            || Cow::Owned(pair.grid()),
            |points| Cow::Borrowed(points.for_frame(frame, index)),
        );
        // The truth decides which points show ground. Where only the estimate sees none, the error
        // is infinite and not left out: a camera that looks into the sky would otherwise score
        // best.
        let distances_m = pair.distances_m(&points);
        let without_ground = points.len() - distances_m.len();
        let name = frame.name();
        Some((FrameOnGround { name, distances_m }, without_ground))
    }
}

/// The cameras of one picture.
struct CameraPair<'a> {
    truth: PtzCamera,
    estimate: PtzCamera,
    field: &'a FieldModel,
    size: ImageSize,
}

impl CameraPair<'_> {
    /// The points of a grid at which the true camera sees the field.
    fn grid(&self) -> Vec<ImagePoint> {
        field_grid(self.field, &self.truth, self.size, COLUMNS)
    }

    /// The distances at those points at which the true camera sees ground, m.
    fn distances_m(&self, points: &[ImagePoint]) -> Vec<f64> {
        points
            .iter()
            .filter_map(|point| self.distance_m(*point))
            .collect()
    }

    /// The distance at one point, m; none where the true camera sees no ground.
    fn distance_m(&self, point: ImagePoint) -> Option<f64> {
        let at = self.truth.plane_from_image(point, 0.0)?;
        Some(ground_error_m(&self.estimate, point, at).unwrap_or(f64::INFINITY))
    }
}

impl GroundError {
    /// None without a distance.
    pub fn from_distances(distances_m: &[f64]) -> Option<Self> {
        let mut sorted = distances_m.to_vec();
        // Infinite distances are sorted to the end and count in both quantiles.
        sorted.sort_by(f64::total_cmp);
        (!sorted.is_empty()).then(|| Self {
            count: sorted.len(),
            median_m: quantile(&sorted, 0.5),
            p95_m: quantile(&sorted, 0.95),
        })
    }

    fn to_json(self) -> Value {
        json!({ "count": self.count, "median_m": self.median_m, "p95_m": self.p95_m })
    }
}

impl GroundComparison {
    /// The error over the points of all frames; none where there is no point.
    pub fn error(&self) -> Option<GroundError> {
        let all: Vec<f64> = self
            .frames
            .iter()
            .flat_map(|frame| frame.distances_m.iter().copied())
            .collect();
        GroundError::from_distances(&all)
    }

    /// All of it, for scripts. Distances that are not finite are null.
    pub fn to_json(&self) -> Value {
        let frames = self.frames.iter().filter_map(|frame| {
            let mut value = GroundError::from_distances(&frame.distances_m)?.to_json();
            value["frame"] = json!(frame.name);
            Some(value)
        });
        let frames: Vec<Value> = frames.collect();
        json!({
            "points": if self.is_given { "given" } else { "grid" },
            "without_ground": self.without_ground,
            "all": self.error().map(GroundError::to_json),
            "frames": frames,
        })
    }

    /// The error in one line, for people.
    pub fn to_text(&self) -> String {
        let (point, of_grid) = if self.is_given {
            ("given point", "")
        } else {
            ("point", " of a grid over the visible field")
        };
        let Some(error) = self.error() else {
            return format!(
                "On the ground: no {point}s{of_grid} in frames of which both have a camera.\n"
            );
        };
        let mut text = format!(
            "On the ground, at {}{of_grid} in {}: median {:.3} m, 95 % within {:.3} m.",
            pluralise(error.count, point),
            pluralise(self.frames.len(), "frame"),
            error.median_m,
            error.p95_m
        );
        if self.is_given && self.without_ground > 0 {
            // Writing to a string cannot fail.
            let _ = write!(
                text,
                " At {} the truth sees no ground.",
                self.without_ground
            );
        }
        text.push('\n');
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use touchline_core::camera::Ptz;
    use touchline_core::geometry::Vec3;
    use touchline_core::testing::turned_base;
    use touchline_documents::document::{Document, Frame, FramePtz, VideoFrame};
    use touchline_documents::exchange::read_picture_points;
    use touchline_documents::testing::match_from;

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    /// Two frames of a camera 100 m above the ground that looks down: a pixel is 0.1 m wide.
    fn from_above(x_m: f64, focal_px: f64) -> Document {
        let position = Vec3::new(x_m, 0.0, 100.0);
        let mut document = match_from(&turned_base(position, [0.0, -90.0, 0.0], SIZE), SIZE);
        for index in 0..2 {
            let video = VideoFrame::new("match.mp4", index, None);
            let ptz = Ptz::from_degrees(0.0, 0.0, focal_px);
            let frame = Frame {
                ptz: Some(FramePtz::new(ptz, None)),
                ..Frame::from_video(video, "main".into(), SIZE)
            };
            document.frames.push(frame.into());
        }
        document
    }

    fn compare(estimate: &Document, points: Option<&str>) -> GroundComparison {
        let folder = tempfile::tempdir().unwrap();
        let points = points.map(|text| {
            let path = folder.path().join("points.csv");
            std::fs::write(&path, text).unwrap();
            read_picture_points(&path).unwrap()
        });
        let truth = from_above(0.0, 1000.0);
        let at = Path::new("/match");
        compare_on_ground(truth.at(at), estimate.at(at), points.as_ref()).unwrap()
    }

    #[test]
    fn a_camera_moved_by_half_a_metre_is_half_a_metre_off_everywhere() {
        let compared = compare(&from_above(0.5, 1000.0), None);
        let error = compared.error().unwrap();
        // Of 16 × 9 cells 14 × 9 show the field.
        assert_eq!((compared.frames.len(), error.count), (2, 2 * 14 * 9));
        assert!((error.median_m - 0.5).abs() < 1e-9 && (error.p95_m - 0.5).abs() < 1e-9);
        assert_eq!(compared.to_json()["points"], "grid");
    }

    #[test]
    fn a_longer_focal_length_scales_distances_from_the_middle() {
        // At 100, 200 and 300 px from the middle are 10, 20 and 30 m; with a focal length longer by
        // a quarter 8, 16 and 24 m.
        let points = "frame,x,y\n0,740,360\n0,840,360\n1,940,360\n1,640,360\n";
        let compared = compare(&from_above(0.0, 1250.0), Some(points));
        let distances_m: Vec<f64> = compared
            .frames
            .iter()
            .flat_map(|frame| frame.distances_m.clone())
            .collect();
        for (distance_m, wanted) in distances_m.iter().zip([2.0, 4.0, 6.0, 0.0]) {
            assert!((distance_m - wanted).abs() < 1e-9, "{distances_m:?}");
        }
        let error = compared.error().unwrap();
        assert!((error.median_m - 3.0).abs() < 1e-9);
        // Between the third and the fourth of four, at 0.95 · 3.
        assert!((error.p95_m - 5.7).abs() < 1e-9, "{error:?}");
        assert_eq!(
            compared.to_text(),
            "On the ground, at 4 given points in 2 frames: median 3.000 m, 95 % within 5.700 m.\n"
        );
    }

    #[test]
    fn rejected_frames_and_those_without_a_camera_or_points_are_left_out() {
        let mut estimate = from_above(0.5, 1000.0);
        let mut truth = from_above(0.0, 1000.0);
        truth.frames[1].status = FrameStatus::Rejected;
        let at = Path::new("/match");
        let compared = compare_on_ground(truth.at(at), estimate.at(at), None).unwrap();
        assert_eq!(compared.frames.len(), 1, "one is rejected");
        estimate.frames[0].ptz = None;
        assert_eq!(compare(&estimate, None).frames.len(), 1);
        let compared = compare(&estimate, Some("frame,x,y\n0,640,360\n"));
        assert_eq!((compared.frames.len(), compared.error()), (0, None));
        let one = compare(&estimate, Some("frame,x,y\n1,640,360\n")).to_text();
        assert!(
            one.starts_with("On the ground, at 1 given point in 1 frame:"),
            "{one}"
        );
        assert!(compared.to_json()["all"].is_null());
    }
}
