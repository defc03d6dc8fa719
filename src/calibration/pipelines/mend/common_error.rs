//! Errors that all given cameras have in common.

use crate::calibrate::describe_size;
use std::fmt;
use touchline_core::camera::CameraBase;
use touchline_core::geometry::{ImagePoint, median};
use touchline_core::solve::base::FittedSize;
use touchline_documents::document::{CameraId, Document, Frame};

/// A fitted length of the field contradicts the assumed one if it differs by more than this many σ,
/// and by more than half a metre, which the paint of real pitches does.
const OTHER_SIZE_SIGMAS: f64 = 3.0;
const OTHER_SIZE_M: f64 = 0.5;

/// A lens that moves the corners of the picture by less is not worth a word, px at 1920 px width.
const SMALL_LENS_PX: f64 = 10.0;

/// An error that all given cameras have in common.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum CommonError {
    /// They are cameras of the mirrored field.
    Mirrored,
    /// They belong to frames of the video that come later by this number (earlier, if negative)
    /// than the likeliest numbering says.
    Shifted(i64),
    /// They leave out a lens that moves the corners of the picture, or state another one.
    Lens {
        /// By how much, px at 1920 px width: the median over the frames.
        corner_px: f64,
    },
    /// The painted lines indicate another size of the field.
    FieldSize(FittedSize),
}

impl fmt::Display for CommonError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mirrored => f.write_str("the given cameras are mirrored left to right"),
            Self::Shifted(frames) => write!(
                f,
                "the given cameras fit the frames that come {} by {}",
                if *frames > 0 { "later" } else { "earlier" },
                frames.unsigned_abs()
            ),
            Self::Lens { corner_px } => write!(
                f,
                "the given cameras leave out a lens that moves the corners by {corner_px:.0} px"
            ),
            Self::FieldSize(size) => write!(
                f,
                "the painted lines indicate another field: {}",
                describe_size(size)
            ),
        }
    }
}

impl CommonError {
    /// The lengths of the field that contradict the assumed ones.
    pub(super) fn from_field_sizes(sizes: &[FittedSize]) -> impl Iterator<Item = Self> {
        // Both conditions: paint that determines a length to a centimetre still lies half a metre
        // off on real pitches, and a vague length is far off by chance.
        let others = sizes.iter().filter(|size| {
            let off_m = (size.value_m - size.assumed_m).abs();
            !size.is_open && off_m > OTHER_SIZE_M && off_m > OTHER_SIZE_SIGMAS * size.error.sigma_m
        });
        others.cloned().map(Self::FieldSize)
    }

    /// The lens that a base has and another one lacks, if it matters in the frames of its camera.
    pub(super) fn from_lens_difference(
        document: &Document,
        camera: &CameraId,
        given: &CameraBase,
        found: &CameraBase,
    ) -> Option<Self> {
        let of_camera = document
            .frames
            .iter()
            .filter(|frame| frame.camera == *camera);
        let mut moved: Vec<f64> = of_camera
            .filter_map(|frame| corner_moved_px(frame, given, found))
            .collect();
        // The median over the frames, because the lens moves the corners most at one end of the
        // zoom.
        let corner_px = median(&mut moved)?;
        (corner_px >= SMALL_LENS_PX).then_some(Self::Lens { corner_px })
    }
}

/// How far a corner of a frame's picture moves from one lens to the other, px at 1920 px width;
/// none without a camera.
fn corner_moved_px(frame: &Frame, given: &CameraBase, found: &CameraBase) -> Option<f64> {
    let focal_px = frame.ptz.as_ref()?.focal_px;
    // The corner lies at a radius r of the ideal picture and is displaced by the lens to
    // r · stretch(r²), in focal lengths.
    let corner = found.principal_point.distance_px(ImagePoint::new(0.0, 0.0));
    let radius = corner / focal_px;
    let [before, after] = [given, found].map(|base| {
        let lens = base.distortion.radial_at(focal_px);
        corner * lens.stretch(radius * radius)
    });
    Some((after - before).abs() / frame.image_size.scale_from_1920())
}
