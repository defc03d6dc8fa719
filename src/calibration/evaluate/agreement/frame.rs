//! The agreement of two annotators on one frame.

use touchline_core::camera::PtzCamera;
use touchline_core::field::{FieldModel, LandmarkId};
use touchline_core::geometry::{Angle, ImagePoint, ImageSize, Vec2};
use touchline_core::score::{camera_error, iou_part};
use touchline_documents::document::{Document, Frame, FrameStatus, Target};

/// Two clicks nearer than this show the same point, px at 1920 px width: five sigmas of the
/// difference of two ordinary clicks.
const SAME_SPOT_PX: f64 = 15.0;

/// If a corner of the picture shows no ground within this distance, it is represented by a point
/// that far along its ray, m.
const FAR_M: f64 = 300.0;

/// The agreement of two annotators on a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameAgreement {
    /// Name of the frame in messages.
    pub name: String,
    /// Its indices in the first and in the second document.
    pub frames: [usize; 2],
    /// The landmarks that both clicked.
    pub clicks: Vec<ClickPair>,
    /// The landmarks that only the first clicked, and only the second.
    pub lone_clicks: [Vec<LandmarkId>; 2],
    /// Points that the two name differently.
    pub names: Vec<NameDispute>,
    /// The difference of their cameras; none unless both frames have one that a person made or
    /// accepted.
    pub cameras: Option<CameraAgreement>,
    /// Whether the pictures differ in size; the frame is then not compared.
    pub sizes_differ: bool,
}

/// A landmark that both clicked.
#[derive(Clone, Debug, PartialEq)]
pub struct ClickPair {
    /// Id of the landmark.
    pub landmark: LandmarkId,
    /// Indices of the click in the first document's frame and in the second's.
    pub clicks: [usize; 2],
    /// Offset from the first's click to the second's, px at 1920 px width.
    pub offset_px: Vec2,
}

/// A point that two annotators name differently, for example one as a near and the other as a far
/// landmark.
#[derive(Clone, Debug, PartialEq)]
pub struct NameDispute {
    /// Its name by the first and by the second annotator.
    pub names: [LandmarkId; 2],
    /// Indices of the click in the first document's frame and in the second's.
    pub clicks: [usize; 2],
    /// Distance of the two clicks, px at 1920 px width.
    pub apart_px: f64,
}

/// The difference of two cameras of a frame: the second minus the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraAgreement {
    /// Intersection over union of the part of the field that the picture shows; none if it shows
    /// nothing of the field.
    pub iou_part: Option<f64>,
    /// Distance between the projections of what the worst corner of the picture shows, px at 1920
    /// px width; infinite if the other camera does not see it.
    pub worst_corner_px: f64,
    /// Difference of the optical axes' pan.
    pub pan: Angle,
    /// Difference of the optical axes' tilt.
    pub tilt: Angle,
    /// Difference of the focal lengths, per cent of the first.
    pub focal_percent: f64,
}

impl FrameAgreement {
    /// The largest distance of a pair of clicks, px at 1920 px width; none without any.
    pub fn largest_px(&self) -> Option<f64> {
        self.clicks.iter().map(ClickPair::apart_px).reduce(f64::max)
    }
}

impl ClickPair {
    /// The distance, px at 1920 px width.
    pub fn apart_px(&self) -> f64 {
        self.offset_px.norm()
    }

    /// Whether both positions are equal to the last digit.
    pub fn is_copy(&self) -> bool {
        self.offset_px == Vec2::zeros()
    }

    /// The offset divided by √2: each coordinate then has the variance of a single click, since
    /// that of a difference is twice as large.
    pub(super) fn difference(&self) -> Vec2 {
        self.offset_px / std::f64::consts::SQRT_2
    }
}

/// A frame of one of the two documents.
pub(super) struct ComparedFrame<'a> {
    pub document: &'a Document,
    pub frame: &'a Frame,
    pub index: usize,
}

impl ComparedFrame<'_> {
    /// The clicks on landmarks: id, position, and index in the frame.
    fn landmarks(&self) -> Vec<(&LandmarkId, ImagePoint, usize)> {
        let clicks = self.frame.clicks.iter().enumerate();
        clicks
            .filter_map(|(index, click)| match &click.target {
                Some(Target::Landmark(id)) if click.image.is_finite() => {
                    Some((id, click.image, index))
                }
                _ => None,
            })
            .collect()
    }

    /// The camera that this annotator made or accepted.
    fn camera(&self) -> Option<PtzCamera> {
        // Suggestions and rejected frames do not state what the annotator thinks.
        let own = !matches!(
            self.frame.status,
            FrameStatus::Suggested | FrameStatus::Rejected
        );
        self.document.ptz_camera(self.frame).filter(|_| own)
    }
}

/// Compares two frames of the same picture. `field` is that of the first document.
pub(super) fn frame_agreement(
    first: &ComparedFrame<'_>,
    second: &ComparedFrame<'_>,
    field: &FieldModel,
) -> FrameAgreement {
    let size = first.frame.image_size;
    let mut found = FrameAgreement {
        name: first.frame.name(),
        frames: [first.index, second.index],
        clicks: Vec::new(),
        lone_clicks: Default::default(),
        names: Vec::new(),
        cameras: None,
        sizes_differ: second.frame.image_size != size,
    };
    if found.sizes_differ {
        return found;
    }
    let scale = size.scale_from_1920();
    // Pair clicks on the same landmark; those without a partner are listed apart.
    let (ones, others) = (first.landmarks(), second.landmarks());
    for (id, at, click) in first_on_each(&ones) {
        match others.iter().find(|(other, ..)| other == id) {
            Some((_, other_at, other_click)) => found.clicks.push(ClickPair {
                landmark: (*id).clone(),
                clicks: [*click, *other_click],
                offset_px: other_at.offset_from(*at) / scale,
            }),
            None => found.lone_clicks[0].push((*id).clone()),
        }
    }
    found.lone_clicks[1] = first_on_each(&others)
        .filter(|(id, ..)| !ones.iter().any(|(other, ..)| other == id))
        .map(|(id, ..)| (*id).clone())
        .collect();
    let cameras = (first.camera(), second.camera());
    // Whether two landmarks coincide in the picture depends on the camera. Either annotator's
    // camera is exact enough.
    found.names = name_disputes(&ones, &others, scale, |a, b| {
        let camera = cameras.0.as_ref().or(cameras.1.as_ref());
        camera.is_some_and(|camera| lie_together(camera, field, a, b, scale))
    });
    if let (Some(one), Some(other)) = cameras {
        let error = camera_error(&one, &other);
        found.cameras = Some(CameraAgreement {
            iou_part: iou_part(field, &one, &other, size),
            worst_corner_px: worst_corner_px(&one, &other, size) / scale,
            pan: error.pan,
            tilt: error.tilt,
            focal_percent: error.focal_percent,
        });
    }
    found
}

/// The first click on each landmark. A second one on the same landmark contradicts it, as `check`
/// reports, and is no further measurement.
fn first_on_each<'a, 'b>(
    clicks: &'b [(&'a LandmarkId, ImagePoint, usize)],
) -> impl Iterator<Item = &'b (&'a LandmarkId, ImagePoint, usize)> {
    clicks
        .iter()
        .enumerate()
        .filter(move |(place, (id, ..))| clicks[..*place].iter().all(|(before, ..)| before != id))
        .map(|(_, click)| click)
}

/// Pairs of clicks at one point with different names. A click is not disputed if the other
/// annotator clicked the same name there as well, nor if the picture shows both landmarks at one
/// point.
fn name_disputes(
    ones: &[(&LandmarkId, ImagePoint, usize)],
    others: &[(&LandmarkId, ImagePoint, usize)],
    scale: f64,
    lie_together: impl Fn(&LandmarkId, &LandmarkId) -> bool,
) -> Vec<NameDispute> {
    // A dispute names two clicks at one point. Clicks that lie farther apart show different points,
    // even where one of the names is wrong.
    let limit_px = SAME_SPOT_PX * scale;
    let mut found = Vec::new();
    for (id, at, click) in ones
        .iter()
        .filter(|(id, at, _)| !has_namesake_near(id, *at, others, limit_px))
    {
        // The nearest click of the other with another name that is disputed as well.
        let near = others
            .iter()
            .filter(|(other, _, _)| other != id)
            .filter(|(other, there, _)| !has_namesake_near(other, *there, ones, limit_px))
            .map(|(other, there, other_click)| (there.distance_px(*at), *other, *other_click))
            .filter(|(apart, other, _)| *apart <= limit_px && !lie_together(id, other))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((apart, other, other_click)) = near {
            let names = [(*id).clone(), other.clone()];
            found.push(NameDispute {
                names,
                clicks: [*click, other_click],
                apart_px: apart / scale,
            });
        }
    }
    found
}

/// Whether one of some clicks on the same landmark lies within `limit_px` of a point.
fn has_namesake_near(
    id: &LandmarkId,
    at: ImagePoint,
    among: &[(&LandmarkId, ImagePoint, usize)],
    limit_px: f64,
) -> bool {
    among
        .iter()
        .any(|(other, there, _)| *other == id && there.distance_px(at) <= limit_px)
}

/// Whether a camera projects two landmarks so close together that clicks do not separate them.
fn lie_together(
    camera: &PtzCamera,
    field: &FieldModel,
    a: &LandmarkId,
    b: &LandmarkId,
    scale: f64,
) -> bool {
    // Twice the distance within which clicks show one point: each of the two clicks may lie that
    // far from its own landmark.
    let [a, b] = [a, b].map(|id| {
        let landmark = field.landmark(id.as_str())?;
        camera
            .image_from_world(field.landmark_in_world(landmark))
            .ok()
    });
    a.zip(b)
        .is_some_and(|(a, b)| a.distance_px(b) <= 2.0 * SAME_SPOT_PX * scale)
}

/// The distance, px, between a corner of the picture and the projection by the other camera of the
/// ground point that the first one shows there, for the worst corner.
fn worst_corner_px(one: &PtzCamera, other: &PtzCamera, size: ImageSize) -> f64 {
    size.corners()
        .into_iter()
        .map(|corner| corner_distance_px(one, other, corner).unwrap_or(f64::INFINITY))
        .fold(0.0, f64::max)
}

/// [`worst_corner_px`] for one corner; none if one of the cameras does not show the point.
fn corner_distance_px(one: &PtzCamera, other: &PtzCamera, corner: ImagePoint) -> Option<f64> {
    // Above the horizon a corner has no ground, and just below it the ground is so far away that a
    // tiny tilt moves it by kilometres. There a point at a fixed distance compares the directions.
    let position = one.base().position_m;
    // The ground point at the corner, if it is near enough, else a point far along the ray.
    let seen = one
        .plane_from_image(corner, 0.0)
        .filter(|point| (point - position).norm() <= FAR_M)
        .or_else(|| {
            let direction = one.world_direction_from_image(corner).ok()?;
            Some(position + direction.normalize() * FAR_M)
        })?;
    let image = other.image_from_world(seen).ok()?;
    Some(image.distance_px(corner))
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::testing::soccer;
    use touchline_documents::document::Click;
    use touchline_documents::testing::{new_frame, soccer_document};

    /// A frame with clicks on these landmarks, at these x.
    fn frame_with(clicks: &[(&str, f64)]) -> Frame {
        let mut frame = new_frame("1.jpg", ImageSize::new(1920, 1080));
        for (name, x) in clicks {
            let click = Click::landmark((*name).into(), ImagePoint::new(*x, 500.0));
            frame.clicks.push(click);
        }
        frame
    }

    #[test]
    fn a_landmark_that_is_clicked_twice_counts_once() {
        let document = soccer_document();
        let field = soccer();
        let one = frame_with(&[("centre_mark", 900.0), ("centre_mark", 1200.0)]);
        let other = frame_with(&[
            ("centre_mark", 902.0),
            ("halfway_far", 905.0),
            ("halfway_far", 300.0),
        ]);
        let [one, other] = [&one, &other].map(|frame| ComparedFrame {
            document: &document,
            frame,
            index: 0,
        });
        let found = frame_agreement(&one, &other, &field);
        let clicks: Vec<[usize; 2]> = found.clicks.iter().map(|pair| pair.clicks).collect();
        assert_eq!(clicks, [[0_usize, 0]]);
        let [lone, other_lone] = found.lone_clicks;
        assert_eq!((lone.len(), other_lone.len()), (0, 1));
        assert_eq!(other_lone[0].as_str(), "halfway_far");
    }
}
