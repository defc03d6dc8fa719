//! A frame's camera as exchange formats store it: one rotation, one centre and one lens, without a
//! base and pan and tilt.

use crate::document::{FrameStatus, Ground, SolutionSource};
use nalgebra::Rotation3;
use touchline_core::camera::{CameraBase, FocalCurve, PIXEL_ASPECTS, Ptz, PtzCamera, Radial};
use touchline_core::geometry::rotation::{
    ROTATION_TOLERANCE, distance_from_rotation, nearest_rotation,
};
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, Vec3};

use crate::exchange::error::Problem;
use crate::exchange::rate::Rate;

/// Where a camera shows no ground, the point in the middle is taken to be this far away, m.
const AWAY_M: f64 = 60.0;

/// The projection of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrameProjection {
    /// By a camera.
    Camera(Pinhole),
    /// By a homography from the ground (world x and y, m) to the picture (px, corner convention).
    Ground(Mat3),
    /// By a camera whose pan and tilt are unknown; only its lens is known.
    Lens(KnownLens),
    /// By a camera that could not be read.
    Nothing,
}

/// The lens of a frame whose pan and tilt are not known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownLens {
    /// px.
    pub focal_px: f64,
    /// px, corner convention.
    pub principal_point: ImagePoint,
    /// On normalised coordinates.
    pub radial: Radial,
}

/// A pinhole camera with radial distortion, in the conventions of the document.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinhole {
    /// The rotation from `world` to `cam`.
    pub cam_from_world: Mat3,
    /// The centre of projection in `world`, m.
    pub position_m: Vec3,
    /// px.
    pub focal_px: f64,
    /// px, corner convention.
    pub principal_point: ImagePoint,
    /// On normalised coordinates.
    pub lens: Radial,
}

/// A frame of an import or export.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameCamera {
    /// Its name in the format; unique within a file.
    pub name: String,
    /// The name of its files, where another program gave it one.
    pub labels_name: Option<String>,
    /// Its image as the document or the file has it; none for a frame of a video only.
    pub image: Option<String>,
    /// The name of its camera; none where the format has none.
    pub camera: Option<String>,
    /// The file name of the video that it is a frame of; none where the format does not say.
    pub video: Option<String>,
    /// The size of the picture; none where the format does not say.
    pub size: Option<ImageSize>,
    /// Its projection.
    pub shown: FrameProjection,
    /// The video frame, counted from 0.
    pub frame_index: Option<u64>,
    /// Its time from the stream's start, s.
    pub pts_s: Option<f64>,
    /// Frames a second of its video, where the times of the video's frames say so.
    pub rate: Option<Rate>,
    /// Status, source and quality of its camera.
    pub record: Record,
    /// How far its camera is at most from the file's own, which no document can have, px.
    pub off_px: f64,
    /// What a user should know of how its file is taken.
    pub remark: Option<&'static str>,
    /// Why it has no camera, where its file is damaged.
    pub unreadable: Option<Unreadable>,
    /// The base that it shares with other frames, whose places waver about it.
    pub common_base: Option<CommonBase>,
}

/// A base that the frames of one camera share, although each states a place of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommonBase {
    /// Tells it from the others of an import.
    pub number: usize,
    /// The base; its lens is not stated.
    pub base: CameraBase,
}

/// Further data of a frame besides its camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Its status in the document.
    pub status: FrameStatus,
    /// The source of its solution.
    pub source: Option<SolutionSource>,
    /// Pan and tilt in the document's base.
    pub ptz: Option<Ptz>,
    /// 1-σ of pan (degrees), tilt (degrees) and focal length (px).
    pub sigma: Option<[f64; 3]>,
    /// 1-σ of the overlay at the worst corner, px.
    pub worst_corner_sigma_px: Option<f64>,
    /// px.
    pub rms_px: Option<f64>,
    /// 0 to 1.
    pub confidence: Option<f64>,
    /// What it is good for on the ground, for formats that state it.
    pub ground: Option<Ground>,
    /// Clicks on landmarks, by name, in px of the picture as it is written; held-out points are not
    /// included.
    pub clicks: Vec<(String, ImagePoint)>,
}

/// Why a frame has no camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Unreadable {
    /// Its file; none where other frames are read from the same file.
    pub file: Option<String>,
    /// What is wrong there.
    pub problem: String,
}

impl FrameCamera {
    /// A frame of which only a name and a camera are known.
    pub fn new(name: &str, size: Option<ImageSize>, shown: FrameProjection) -> Self {
        Self {
            name: name.to_owned(),
            image: None,
            camera: None,
            video: None,
            size,
            shown,
            labels_name: None,
            frame_index: None,
            pts_s: None,
            rate: None,
            record: Record::default(),
            off_px: 0.0,
            remark: None,
            unreadable: None,
            common_base: None,
        }
    }

    /// The same frame under another name.
    #[must_use]
    pub fn with_name(&self, name: String) -> Self {
        Self {
            name,
            ..self.clone()
        }
    }

    /// The camera; none for a homography, a lens, or where it could not be read.
    pub const fn pinhole(&self) -> Option<&Pinhole> {
        match &self.shown {
            FrameProjection::Camera(pinhole) => Some(pinhole),
            FrameProjection::Ground(_) | FrameProjection::Lens(_) | FrameProjection::Nothing => {
                None
            }
        }
    }

    /// The image of a world point, px; none behind the camera, and for a homography none off the
    /// ground.
    pub fn image_from_world(&self, point_in_world: Vec3) -> Option<ImagePoint> {
        match &self.shown {
            FrameProjection::Camera(pinhole) => {
                pinhole.ptz_camera()?.image_from_world(point_in_world).ok()
            }
            // A homography is of the plane z = 0. A point at infinity of the picture gives a
            // division by zero, which `is_finite` catches.
            FrameProjection::Ground(image_from_ground) => {
                if point_in_world.z != 0.0 {
                    return None;
                }
                let image = image_from_ground * Vec3::new(point_in_world.x, point_in_world.y, 1.0);
                Some(ImagePoint::new(image.x / image.z, image.y / image.z))
                    .filter(|point| point.is_finite())
            }
            FrameProjection::Lens(_) | FrameProjection::Nothing => None,
        }
    }
}

impl KnownLens {
    /// A camera with this lens at the origin that looks along the z axis of `world`.
    pub fn camera_at_origin(&self) -> Pinhole {
        Pinhole {
            cam_from_world: Mat3::identity(),
            position_m: Vec3::zeros(),
            focal_px: self.focal_px,
            principal_point: self.principal_point,
            lens: self.radial,
        }
    }
}

impl Pinhole {
    /// Its lens alone.
    pub const fn known_lens(&self) -> KnownLens {
        KnownLens {
            focal_px: self.focal_px,
            principal_point: self.principal_point,
            radial: self.lens,
        }
    }

    /// The camera of a frame at its pan, tilt and focal length.
    pub fn from_ptz_camera(camera: &PtzCamera) -> Self {
        Self {
            cam_from_world: camera.cam_from_world(),
            position_m: camera.base().position_m,
            focal_px: camera.ptz().focal_px,
            principal_point: camera.base().principal_point,
            lens: camera.lens(),
        }
    }

    /// Checks a camera that was read: all numbers finite, the focal length positive, the position
    /// plausible. The rotation is orthogonalised.
    ///
    /// # Errors
    /// One of them is not; `what` names the frame.
    pub fn validate(self, what: &str) -> Result<Self, Problem> {
        // NaN and infinity first: every comparison below would let a NaN pass or refuse it with the
        // wrong words.
        let numbers = [
            self.focal_px,
            self.principal_point.x,
            self.principal_point.y,
            self.lens.k1,
            self.lens.k2,
            self.lens.pixel_aspect,
        ];
        if !numbers
            .iter()
            .chain(self.position_m.iter())
            .all(|number| number.is_finite())
        {
            return Err(Problem::NotFinite(format!("a number of {what}")));
        }
        if !(self.focal_px > 0.0) {
            let what = format!("the focal length of {what}");
            return Err(Problem::out_of_range(what, self.focal_px, "above 0"));
        }
        if !PIXEL_ASPECTS.contains(&self.lens.pixel_aspect) {
            return Err(Problem::OutOfRange {
                what: format!("the pixels' aspect, fy / fx, of {what}"),
                value: self.lens.pixel_aspect,
                wanted: "0.25 to 4",
            });
        }
        if self.position_m.amax() > FARTHEST_M {
            let what = format!("a coordinate of the position of {what}");
            return Err(Problem::out_of_range(
                what,
                self.position_m.amax(),
                "within 100 km, in metres",
            ));
        }
        let away_px = self
            .principal_point
            .x
            .abs()
            .max(self.principal_point.y.abs());
        if away_px > FARTHEST_PX {
            let what = format!("a coordinate of the principal point of {what}");
            return Err(Problem::out_of_range(what, away_px, "within a million px"));
        }
        // The document has k₂ as a multiple of k₁² (`FocalCurve`), so that it cannot state k₂
        // alone. The second check is of that multiple, which overflows for a tiny k₁.
        if self.lens.k1 == 0.0 && self.lens.k2 != 0.0 {
            let what = format!("k2 = {} without k1 of {what}", self.lens.k2);
            return Err(Problem::not_supported(
                what,
                "in the lens model k2 depends on k1",
            ));
        }
        if self.curve().is_none_or(|curve| !curve.is_finite()) {
            let what = format!(
                "k1 = {:e} with k2 = {:e} of {what}",
                self.lens.k1, self.lens.k2
            );
            return Err(Problem::not_supported(
                what,
                "no real lens distorts like that",
            ));
        }
        // Numbers with few digits are nearly a rotation, and the nearest rotation is meant. A
        // matrix that is farther away was read in the wrong way, which no rounding explains.
        let distance = distance_from_rotation(&self.cam_from_world);
        if !(distance <= ROTATION_TOLERANCE) {
            return Err(Problem::NotRotation {
                what: format!("the rotation of {what}"),
                distance,
            });
        }
        let exact = distance <= EXACT_ROTATION;
        let cam_from_world = if exact {
            self.cam_from_world
        } else {
            nearest_rotation(&self.cam_from_world)
        };
        Ok(Self {
            cam_from_world,
            ..self
        })
    }

    /// The same as a [`PtzCamera`] at pan and tilt 0. None where k₂ is given without k₁.
    pub fn ptz_camera(&self) -> Option<PtzCamera> {
        // The whole rotation becomes that of the base, so that pan and tilt are 0. No gauge is
        // needed to project points.
        let base = CameraBase {
            distortion: self.curve()?,
            ..CameraBase::new(self.position_m, self.cam_from_world, self.principal_point)
        };
        Some(PtzCamera::new(
            base,
            Ptz::from_degrees(0.0, 0.0, self.focal_px),
        ))
    }

    /// The camera at another place, aimed at the point that it showed in the middle and zoomed to
    /// show it as large.
    #[must_use]
    pub fn move_to(&self, place_m: Vec3) -> Self {
        let axis = self.cam_from_world.row(2).transpose();
        let to_ground_m = -self.position_m.z / axis.z;
        let away_m = if to_ground_m > 0.0 && to_ground_m < 10.0 * AWAY_M {
            to_ground_m
        } else {
            AWAY_M
        };
        let point = self.position_m + axis * away_m;
        // The vector product of two unit vectors is the turn itself as long as it is small.
        let turn = (point - place_m).normalize().cross(&axis);
        Self {
            cam_from_world: self.cam_from_world * Rotation3::new(turn).matrix(),
            position_m: place_m,
            focal_px: self.focal_px * (point - place_m).norm() / away_m,
            ..*self
        }
    }

    /// Its lens as a curve that is constant over the focal length.
    pub fn curve(&self) -> Option<FocalCurve> {
        FocalCurve::through(self.lens)
    }

    /// The translation of `cam_from_world`, t = −R C, m.
    pub fn translation(&self) -> Vec3 {
        -(self.cam_from_world * self.position_m)
    }

    /// The homography from the ground (z = 0; x, y in m, 1) to the picture (px) without distortion:
    /// `K [r₁ r₂ t]`.
    pub fn image_from_ground(&self) -> Mat3 {
        // The columns of the rotation for x and y, and the translation: the third column drops out
        // for z = 0 (Hartley and Zisserman, Multiple View Geometry, section 8.1.1).
        let calibration = Mat3::new(
            self.focal_px,
            0.0,
            self.principal_point.x,
            0.0,
            self.focal_px * self.lens.pixel_aspect,
            self.principal_point.y,
            0.0,
            0.0,
            1.0,
        );
        let plane = Mat3::from_columns(&[
            self.cam_from_world.column(0).into_owned(),
            self.cam_from_world.column(1).into_owned(),
            self.translation(),
        ]);
        calibration * plane
    }

    /// The same camera in a picture scaled by a factor. The lens stays, because its coefficients
    /// are on normalised coordinates.
    #[must_use]
    pub fn scale_by(&self, factor: f64) -> Self {
        Self {
            focal_px: self.focal_px * factor,
            principal_point: ImagePoint::new(
                self.principal_point.x * factor,
                self.principal_point.y * factor,
            ),
            ..*self
        }
    }
}

/// A matrix nearer to a rotation than this is not orthogonalised, so that its digits are kept.
const EXACT_ROTATION: f64 = 1e-14;
/// The maximum coordinate of a position, m; a larger one was probably stored in other units.
const FARTHEST_M: f64 = 1e5;
/// The maximum coordinate of a principal point, px. That of a crop may lie far outside of it.
const FARTHEST_PX: f64 = 1e6;
