//! The information that a format loses, as distances in px of the pictures.

use crate::exchange::cameras::frame_camera::{FrameCamera, FrameProjection};
use std::fmt;
use touchline_core::camera::Radial;
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImagePoint, ImageSize, Vec3, pluralise};

/// The number of points of each line that are compared.
const LINE_POINTS: usize = 9;
/// Differences below this are rounding, px.
const ROUNDING_PX: f64 = 1e-7;

/// Something that a format leaves out.
#[derive(Clone, Debug, PartialEq)]
pub struct Loss {
    /// What is lost: "lens distortion".
    pub what: Vec<&'static str>,
    /// The number of frames that lose it.
    pub frames: usize,
    /// Root mean square of the distances by which visible points of the field move, over these
    /// frames, px.
    pub rms_px: f64,
    /// The largest such distance, px.
    pub worst_px: f64,
    /// The frame with the largest distance.
    pub worst_frame: String,
    /// The number of visible points off the ground, which a homography cannot project.
    pub off_ground: usize,
    /// The number of distances that the root mean square is of.
    pub(super) distances: usize,
}

impl Loss {
    /// The loss of these frames and of others together.
    pub(in crate::exchange) fn join(mut self, other: Self) -> Self {
        // Root mean squares are joined through the sums of squares that they are of.
        let [sum, other_sum] =
            [&self, &other].map(|loss| loss.rms_px.powi(2) * loss.distances as f64);
        self.distances += other.distances;
        self.rms_px = rms(sum + other_sum, self.distances);
        if other.worst_px > self.worst_px {
            (self.worst_px, self.worst_frame) = (other.worst_px, other.worst_frame);
        }
        self.what.extend(other.what);
        self.what.sort_unstable();
        self.what.dedup();
        self.frames += other.frames;
        self.off_ground += other.off_ground;
        self
    }
}

/// The root mean square of `count` numbers with this sum of squares; 0 of none.
fn rms(sum: f64, count: usize) -> f64 {
    if count > 0 {
        (sum / count as f64).sqrt()
    } else {
        0.0
    }
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            what,
            frames,
            rms_px,
            worst_px,
            worst_frame,
            off_ground,
            distances: _,
        } = self;
        write!(
            f,
            "not held: {} ({}); ",
            what.join(", "),
            pluralise(*frames, "frame")
        )?;
        write!(
            f,
            "points of the field move by {rms_px:.2} px rms, at most {worst_px:.2} px in {worst_frame}"
        )?;
        if *off_ground > 0 {
            write!(
                f,
                "; {} off the ground left out",
                pluralise(*off_ground, "point")
            )?;
        }
        Ok(())
    }
}

/// A point of the field.
#[derive(Clone, Copy)]
struct FieldPoint {
    /// Its position on the crowned ground, `world`, m.
    in_world: Vec3,
    /// Its nominal position, m: homographies map the field's plan.
    nominal: Vec3,
}

impl FieldPoint {
    fn from_nominal(nominal: Vec3, field: &FieldModel) -> Self {
        Self {
            in_world: field.world_from_nominal(nominal),
            nominal,
        }
    }

    /// Its image in a frame.
    fn image_in(&self, frame: &FrameCamera) -> Option<ImagePoint> {
        frame.image_from_world(if frame.pinhole().is_some() {
            self.in_world
        } else {
            self.nominal
        })
    }
}

/// Landmarks and points of lines.
fn points_of(field: &FieldModel) -> Vec<FieldPoint> {
    let landmarks = field
        .landmarks
        .iter()
        .map(|landmark| FieldPoint::from_nominal(landmark.nominal_m, field));
    // Ends and points between them: a lens moves the middle of a line and its ends differently.
    let shares = (0..LINE_POINTS).map(|step| step as f64 / (LINE_POINTS - 1) as f64);
    let lines = field
        .lines
        .iter()
        .flat_map(|line| shares.clone().map(move |share| line.curve.point_at(share)))
        .map(|nominal| FieldPoint::from_nominal(nominal, field));
    landmarks.chain(lines).collect()
}

/// The points of the field that are visible in a frame, with their pixels.
fn visible<'a>(
    frame: &'a FrameCamera,
    points: &'a [FieldPoint],
) -> impl Iterator<Item = (FieldPoint, ImagePoint)> + 'a {
    points
        .iter()
        .filter_map(|point| Some((*point, point.image_in(frame)?)))
        .filter(|(_, image)| frame.size.is_none_or(|size| size.contains(*image)))
}

/// The loss between frames and what a format keeps of them; none where nothing is lost.
pub fn loss_between(
    frames: &[FrameCamera],
    held: &[FrameCamera],
    field: &FieldModel,
) -> Option<Loss> {
    let points = points_of(field);
    let mut loss = Loss {
        what: Vec::new(),
        frames: 0,
        rms_px: 0.0,
        worst_px: 0.0,
        worst_frame: String::new(),
        off_ground: 0,
        distances: 0,
    };

    // Compare the visible points of each frame under the frame's camera and under what is kept of
    // it.
    let mut sum = 0.0;
    for (frame, kept) in frames.iter().zip(held) {
        let what = differences(frame, kept);
        // Frames that lose nothing would only dilute the root mean square of the others.
        if what.is_empty() {
            continue;
        }
        loss.frames += 1;
        loss.what.extend(what);
        let is_ground = matches!(kept.shown, FrameProjection::Ground(_));
        let mut moved = 0.0_f64;
        for (point, image) in visible(frame, &points) {
            if is_ground && point.nominal.z != 0.0 {
                loss.off_ground += 1;
                continue;
            }
            let Some(there) = point.image_in(kept) else {
                continue;
            };
            let off_px = there.distance_px(image);
            sum += off_px * off_px;
            loss.distances += 1;
            moved = moved.max(off_px);
        }
        if moved > loss.worst_px {
            (loss.worst_px, loss.worst_frame) = (moved, frame.name.clone());
        }
    }
    loss.what.sort_unstable();
    loss.what.dedup();
    loss.rms_px = rms(sum, loss.distances);
    (loss.worst_px > ROUNDING_PX || loss.off_ground > 0).then_some(loss)
}

/// The largest distance (px) by which ground points move in these frames if the ground is assumed
/// flat, as readers of cameras do.
pub fn crown_off_px(frames: &[FrameCamera], field: &FieldModel) -> f64 {
    let points: Vec<FieldPoint> = points_of(field)
        .into_iter()
        .filter(|point| point.nominal.z == 0.0)
        .collect();
    let off_px = frames.iter().flat_map(|frame| {
        visible(frame, &points).filter_map(|(point, image)| {
            Some(frame.image_from_world(point.nominal)?.distance_px(image))
        })
    });
    off_px.fold(0.0, f64::max)
}

/// The kinds of difference between a frame and what is kept of it.
fn differences(frame: &FrameCamera, kept: &FrameCamera) -> Vec<&'static str> {
    // What is kept is a homography then.
    let (Some(from), Some(to)) = (frame.pinhole(), kept.pinhole()) else {
        let is_distorted = frame
            .pinhole()
            .is_some_and(|pinhole| !pinhole.lens.is_none());
        return if is_distorted {
            vec!["points off the ground", "lens distortion"]
        } else {
            vec!["points off the ground"]
        };
    };
    let off_centre = from.principal_point.distance_px(to.principal_point) > ROUNDING_PX;
    // Entries of a rotation: 1e-9 is far below a pixel at any focal length.
    let turned = (from.cam_from_world - to.cam_from_world).amax() > 1e-9;
    let in_pixels_of_to = Radial {
        pixel_aspect: to.lens.pixel_aspect,
        ..from.lens
    };
    [
        (in_pixels_of_to != to.lens, "lens distortion"),
        (from.lens != in_pixels_of_to, "pixels that are not square"),
        (off_centre, "the principal point"),
        (turned, "the rotation's roll"),
        (from.focal_px != to.focal_px, "the focal length"),
    ]
    .into_iter()
    .filter_map(|(differs, what)| differs.then_some(what))
    .collect()
}

/// The landmark that moves most between two frames, with its distance, px. Only landmarks within
/// the picture or near it are compared; one that only the first frame shows has an infinite
/// distance.
pub fn farthest_landmark(
    frame: &FrameCamera,
    other: &FrameCamera,
    field: &FieldModel,
) -> (String, f64) {
    let mut farthest = (String::new(), 0.0);
    // A homography and the camera made from it are compared on the field's plan.
    let is_ground = frame.pinhole().is_none() || other.pinhole().is_none();
    for landmark in &field.landmarks {
        let point = if is_ground {
            landmark.nominal_m
        } else {
            field.landmark_in_world(landmark)
        };
        let Some(image) = frame
            .image_from_world(point)
            .filter(|image| is_near(*image, frame.size))
        else {
            continue;
        };
        // NaN counts as infinite: it would compare as neither larger nor smaller than the others.
        let off_px = other
            .image_from_world(point)
            .map(|there| there.distance_px(image))
            .filter(|off_px| off_px.is_finite())
            .unwrap_or(f64::INFINITY);
        if off_px > farthest.1 {
            farthest = (landmark.id.to_string(), off_px);
        }
    }
    farthest
}

/// Whether a point lies in the picture, or outside by at most the picture's own size. Farther out,
/// points may be near the camera's plane, where the rounding of an angle moves them arbitrarily
/// far.
fn is_near(image: ImagePoint, size: Option<ImageSize>) -> bool {
    size.is_none_or(|size| {
        let (width, height) = (f64::from(size.width), f64::from(size.height));
        (-width..=2.0 * width).contains(&image.x) && (-height..=2.0 * height).contains(&image.y)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::cameras::frame_camera::Pinhole;
    use std::slice::from_ref;
    use touchline_core::field::builtin;
    use touchline_core::geometry::Mat3;

    /// A camera behind the near touchline that looks at the middle of the field, 30° down.
    fn camera(lens: Radial, focal_px: f64) -> FrameCamera {
        let size = ImageSize::new(1920, 1080);
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        let pinhole = Pinhole {
            cam_from_world: Mat3::new(1.0, 0.0, 0.0, 0.0, -sin, -cos, 0.0, cos, -sin),
            position_m: Vec3::new(0.0, -60.0 * cos, 60.0 * sin),
            focal_px,
            principal_point: size.centre(),
            lens,
        };
        FrameCamera::new("a", Some(size), FrameProjection::Camera(pinhole))
    }

    #[test]
    fn frames_that_lose_nothing_do_not_dilute_what_the_others_lose() {
        let field = builtin("soccer").unwrap().default_model().unwrap();
        let bare = camera(Radial::default(), 2000.0);
        let with_lens = camera(
            Radial {
                k1: 0.1,
                k2: 0.0,
                ..Radial::default()
            },
            2000.0,
        );
        let alone = loss_between(from_ref(&with_lens), from_ref(&bare), &field).unwrap();
        let both = loss_between(&[with_lens, bare.clone()], &[bare.clone(), bare], &field).unwrap();
        assert_eq!((alone.rms_px, alone.frames), (both.rms_px, both.frames));
    }

    #[test]
    fn a_landmark_that_is_nowhere_is_farther_than_all_others() {
        let field = builtin("soccer").unwrap().default_model().unwrap();
        let frame = camera(Radial::default(), 2000.0);
        let (_, off_px) = farthest_landmark(&frame, &camera(Radial::default(), f64::NAN), &field);
        assert_eq!(off_px, f64::INFINITY);
    }

    #[test]
    fn losses_of_other_frames_are_joined() {
        let loss = |what, worst_px: f64, distances| Loss {
            what: vec![what],
            frames: 2,
            rms_px: 0.5 * worst_px,
            worst_px,
            worst_frame: format!("{worst_px}"),
            off_ground: 3,
            distances,
        };
        let joined = loss("lens distortion", 2.0, 30).join(loss("points off the ground", 6.0, 10));
        assert_eq!(
            joined.to_string(),
            "not held: lens distortion, points off the ground (4 frames); \
             points of the field move by 1.73 px rms, at most 6.00 px in 6; \
             6 points off the ground left out"
        );
    }
}
