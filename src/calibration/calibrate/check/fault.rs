//! The kinds of errors in a document.

use std::fmt;
use thiserror::Error;
use touchline_core::geometry::{ImageSize, pluralise};
use touchline_documents::document::{Frame, FrameStatus};

/// An error in a document, and where it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Where it is: `frames[3] (images/0003.jpg)`, `camera main`, `field`.
    pub place: String,
    /// The frame's index in the document, if it concerns one.
    pub frame: Option<usize>,
    /// The error.
    pub fault: Fault,
}

impl Problem {
    /// An error in the frame at an index of its document.
    pub(super) fn in_frame(index: usize, frame: &Frame, fault: Fault) -> Self {
        Self {
            place: format!("frames[{index}] ({})", frame.name()),
            frame: Some(index),
            fault,
        }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.fault)
    }
}

/// A picture size in the form of the messages.
fn size(size: ImageSize) -> String {
    format!("{} × {} px", size.width, size.height)
}

/// An error in a document. Clicks are counted from 0 here and from 1 in messages.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Fault {
    /// Two cameras have the same name.
    #[error("another camera has this name too; rename one")]
    DuplicateCamera,
    /// A coefficient of the lens that this program does not use.
    #[error("distortion.{key} is not used by this program; overlays are computed without it")]
    UnusedDistortion {
        /// The key in the document.
        key: String,
    },
    /// Position or rotation of the base is missing.
    #[error("{missing} is missing, so the base is not known")]
    HalfABase {
        /// The key that is missing.
        missing: &'static str,
    },
    /// The field's template or parameters are not valid.
    #[error("{message}")]
    Field {
        /// The error of the field.
        message: String,
    },
    /// The clicks give a better camera on the document's base than the one that is stored.
    #[error(
        "the stored camera misses its clicks by {stored_px:.1} px, and they give one within {rms_px:.1} px: the base or the field \
         has changed since; solve the frame again"
    )]
    StaleSolution {
        /// Root mean square residual of the stored camera, px.
        stored_px: f64,
        /// Root mean square residual of the camera that the clicks give, px.
        rms_px: f64,
    },
    /// An accepted camera whose lines are not where its picture shows paint.
    #[error(
        "accepted, but the paint contradicts its camera ({found} of {open} open places of its lines show paint); look at it again"
    )]
    OffPaint {
        /// Number of open positions on its lines with paint.
        found: usize,
        /// Number of open positions on its lines.
        open: usize,
    },
    /// A number is NaN or infinite, or a focal length is not positive.
    #[error("{what} is not a finite number; enter it again")]
    NotFinite {
        /// The quantity that is not finite.
        what: String,
    },
    /// A quantity that can only be above zero.
    #[error("{what} is {value}, expected a number above zero")]
    NotPositive {
        /// The key in the document.
        what: &'static str,
        /// The value.
        value: f64,
    },
    /// A quantity that cannot be below zero.
    #[error("{what} is {value}, expected zero or more; remove it")]
    Negative {
        /// The key in the document.
        what: &'static str,
        /// The value.
        value: f64,
    },
    /// The hash of the image file is not a SHA-256.
    #[error("sha256 is not 64 hexadecimal digits; remove it")]
    NoSha256,
    /// The time of the last change is not a time.
    #[error("edited.at {stated:?} is not a time such as 2026-05-01T18:30:00Z")]
    NoTime {
        /// The stored text.
        stated: String,
    },
    /// A shot begins or ends at a frame that is not in the document.
    #[error("names the frame {id}, which the document does not have")]
    UnknownFrame {
        /// The id of that frame.
        id: String,
    },
    /// A box of pixels with no area, or outside the picture.
    #[error("mask {} covers no pixel of the picture", .mask + 1)]
    EmptyMask {
        /// The index of the mask.
        mask: usize,
    },
    /// Two frames show the same picture.
    #[error("the same picture as frames[{first}]; remove one")]
    DuplicateFrame {
        /// The index of the first frame with it.
        first: usize,
    },
    /// The frame has neither an image nor a video.
    #[error("has neither an image nor a video")]
    NoPicture,
    /// The frame's camera is not in the document.
    #[error("its camera {camera:?} is not in the document")]
    UnknownCamera {
        /// The camera's name.
        camera: String,
    },
    /// The clicks fit another camera of the document.
    #[error(
        "its clicks are {own_rms_px:.1} px off with its camera, {rms_px:.1} px with {camera:?}; assign it to that one"
    )]
    OtherCamera {
        /// The name of the camera that fits.
        camera: String,
        /// Root mean square residual with that camera, px.
        rms_px: f64,
        /// Root mean square residual with its own camera, px.
        own_rms_px: f64,
    },
    /// The base fits the frames before one and not those after.
    #[error(
        "stopped fitting at {frame} ({before_px:.0} px before, {after_px:.0} px since); assign the frames from there on to a new camera"
    )]
    StoppedFitting {
        /// The name of the first frame that does not fit.
        frame: String,
        /// Median residual of the clicks before it, px.
        before_px: f64,
        /// Median residual of the clicks from it on, px.
        after_px: f64,
    },
    /// The frame and its camera disagree about the size of the picture.
    #[error("{} where its camera has {}; assign it to a camera of its own size", size(*frame), size(*camera))]
    CameraSize {
        /// The size that the frame states, px.
        frame: ImageSize,
        /// The size that the camera states, px.
        camera: ImageSize,
    },
    /// A landmark that the field does not have.
    #[error("click {} names the landmark {name:?}, which the field does not have; `touchline fields` lists them", .click + 1)]
    UnknownLandmark {
        /// The index of the click in its frame, from 0.
        click: usize,
        /// The name in the document.
        name: String,
    },
    /// A line that the field does not have.
    #[error("click {} names the line {name:?}, which the field does not have; `touchline fields` lists them", .click + 1)]
    UnknownLine {
        /// The index of the click in its frame, from 0.
        click: usize,
        /// The name in the document.
        name: String,
    },
    /// A click without a name.
    #[error("click {} has no name yet; name it or delete it", .click + 1)]
    UnnamedClick {
        /// The index of the click in its frame, from 0.
        click: usize,
    },
    /// A landmark clicked twice in one frame.
    #[error("clicks {} and {} both name the landmark {name:?}; delete one", .first + 1, .second + 1)]
    DuplicateLandmark {
        /// The index of the first of them.
        first: usize,
        /// The index of the second.
        second: usize,
        /// The name in the document.
        name: String,
    },
    /// A click outside the picture.
    #[error("click {} at ({x:.2}, {y:.2}) lies outside the picture of {}", .click + 1, size(*picture))]
    ClickOutside {
        /// The index of the click in its frame, from 0.
        click: usize,
        /// Its x, px.
        x: f64,
        /// Its y, px.
        y: f64,
        /// The size of the picture, px.
        picture: ImageSize,
    },
    /// The document's click noise is not readable or not plausible.
    #[error("click_noise: {message}; click the gold frames again or remove it")]
    ClickNoise {
        /// The reason.
        message: String,
    },
    /// A blind click on a landmark that the field does not have.
    #[error("repeat {} names the landmark {name:?}, which the field does not have; `touchline fields` lists them", .repeat + 1)]
    UnknownLandmarkAgain {
        /// The index of the repeat, from 0.
        repeat: usize,
        /// The name in the document.
        name: String,
    },
    /// A blind click outside the picture.
    #[error("repeat {} at ({x:.2}, {y:.2}) lies outside the picture of {}", .repeat + 1, size(*picture))]
    RepeatOutside {
        /// The index of the repeat, from 0.
        repeat: usize,
        /// Its x, px.
        x: f64,
        /// Its y, px.
        y: f64,
        /// The size of the picture, px.
        picture: ImageSize,
    },
    /// The status requires a camera, but the frame has none.
    #[error("is {} but has no ptz; solve it", status.as_str())]
    Unsolved {
        /// The status of the frame.
        status: FrameStatus,
    },
    /// A rejected frame without a reason.
    #[error("is rejected without a reason")]
    NoReason,
    /// The lens model folds inside the picture, so that part of it has no ray.
    #[error("with k1 = {k1:.4} the lens model folds inside the picture; check the distortion")]
    LensFolds {
        /// k₁ at the frame's focal length.
        k1: f64,
    },
    /// The camera is under the ground.
    #[error("stands {:.1} m under the ground; check its position and the sign of z", -.z_m)]
    UnderGround {
        /// Its height, m.
        z_m: f64,
    },
    /// The camera is too far away to show the field.
    #[error(
        "stands {distance_m:.0} m from the middle of the field; check its position and its unit"
    )]
    FarAway {
        /// Its distance from the middle of the field, m.
        distance_m: f64,
    },
    /// The camera shows no part of the field.
    #[error("its camera does not look at the field; check pan and tilt, or solve it again")]
    LooksElsewhere,
    /// No lens has this focal length.
    #[error(
        "its focal length of {focal_px} px is that of no lens ({shortest:.0} to {longest:.0} px); \
         solve it again"
    )]
    NoSuchFocalLength {
        /// The focal length, px.
        focal_px: f64,
        /// The shortest plausible one for a picture of this width, px.
        shortest: f64,
        /// The longest plausible one, px.
        longest: f64,
    },
    /// No lens distorts like this.
    #[error("no lens distorts like k1 = {k1:.4}; check the distortion")]
    NoSuchLens {
        /// k₁ at the frame's focal length.
        k1: f64,
    },
    /// The solution refers to a click that does not exist.
    #[error("its solution refers to click {}, but there are {clicks}; solve it again", .click + 1)]
    NoSuchClick {
        /// The index of the click in its frame, from 0.
        click: usize,
        /// Number of clicks.
        clicks: usize,
    },
    /// The picture cannot be read.
    #[error("{message}")]
    Picture {
        /// The reader's error.
        message: String,
        /// Whether the file is missing.
        missing: bool,
    },
    /// The picture has another size than the document states.
    #[error("the picture is {}, the document says {}; it is not the one that was labelled", size(*actual), size(*stated))]
    PictureSize {
        /// The size of the file, px.
        actual: ImageSize,
        /// The size that the document states, px.
        stated: ImageSize,
    },
    /// The file's contents have changed since it was labelled.
    #[error("the image changed since it was labelled (its SHA-256 is {actual}); inspect the label")]
    PictureChanged {
        /// The file's SHA-256.
        actual: String,
    },
    /// Another video lies under the name of the one that was labelled.
    #[error(
        "{video} is another video than the one that was labelled; put that one back, or inspect \
         every label"
    )]
    VideoChanged {
        /// The file's name.
        video: String,
    },
    /// The stated time is not that of the stated frame.
    #[error("pts_s {stated} is not the time of frame {index} of the video{}; inspect the label", actual.map_or_else(String::new, |pts| format!(" ({pts:.4})")))]
    VideoTime {
        /// The stated frame, from 0.
        index: u64,
        /// The stated time, s.
        stated: f64,
        /// The time of that frame, s.
        actual: Option<f64>,
    },
    /// Several frames have the same camera although the picture moves between them.
    #[error(
        "from here to {last} ({frames} frames) the camera does not move although the picture does; check these frames"
    )]
    StillCamera {
        /// The name of the last of these frames.
        last: String,
        /// Number of these frames.
        frames: usize,
    },
    /// The video has fewer frames than the stated number.
    #[error(
        "the video has {}, numbered from 0; there is no frame {index}",
        pluralise(*frames, "frame")
    )]
    NoSuchVideoFrame {
        /// The stated frame, from 0.
        index: u64,
        /// Number of frames that can be decoded.
        frames: usize,
    },
}

impl Fault {
    /// The stable name of the error in machine-readable output.
    pub const fn code(&self) -> &'static str {
        match self {
            Self::DuplicateCamera => "duplicate_camera",
            Self::UnusedDistortion { .. } => "unused_distortion",
            Self::HalfABase { .. } => "half_a_base",
            Self::Field { .. } => "field",
            Self::NotFinite { .. } => "not_finite",
            Self::NotPositive { .. } => "not_positive",
            Self::Negative { .. } => "negative",
            Self::NoSha256 => "no_sha256",
            Self::NoTime { .. } => "no_time",
            Self::UnknownFrame { .. } => "unknown_frame",
            Self::EmptyMask { .. } => "empty_mask",
            Self::DuplicateFrame { .. } => "duplicate_frame",
            Self::NoPicture => "no_picture",
            Self::UnknownCamera { .. } => "unknown_camera",
            Self::OtherCamera { .. } => "other_camera",
            Self::StoppedFitting { .. } => "stopped_fitting",
            Self::CameraSize { .. } => "camera_size",
            Self::UnknownLandmark { .. } => "unknown_landmark",
            Self::UnknownLine { .. } => "unknown_line",
            Self::UnnamedClick { .. } => "unnamed_click",
            Self::DuplicateLandmark { .. } => "duplicate_landmark",
            Self::StaleSolution { .. } => "stale_solution",
            Self::OffPaint { .. } => "off_paint",
            Self::ClickOutside { .. } => "click_outside",
            Self::ClickNoise { .. } => "click_noise",
            Self::UnknownLandmarkAgain { .. } => "unknown_landmark_again",
            Self::RepeatOutside { .. } => "repeat_outside",
            Self::Unsolved { .. } => "unsolved",
            Self::NoReason => "no_reason",
            Self::LensFolds { .. } => "lens_folds",
            Self::UnderGround { .. } => "under_ground",
            Self::FarAway { .. } => "far_away",
            Self::LooksElsewhere => "looks_elsewhere",
            Self::NoSuchFocalLength { .. } => "no_such_focal_length",
            Self::NoSuchLens { .. } => "no_such_lens",
            Self::NoSuchClick { .. } => "no_such_click",
            // A missing file has to be found, a damaged one has to be replaced: scripts tell them
            // apart.
            Self::Picture { missing: true, .. } => "missing_picture",
            Self::Picture { .. } => "unreadable_picture",
            Self::PictureSize { .. } => "picture_size",
            Self::PictureChanged { .. } => "picture_changed",
            Self::VideoChanged { .. } => "video_changed",
            Self::VideoTime { .. } => "video_time",
            Self::StillCamera { .. } => "still_camera",
            Self::NoSuchVideoFrame { .. } => "no_such_video_frame",
        }
    }
}
