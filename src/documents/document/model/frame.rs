//! A frame of the document: where its picture is, its clicks, its solution.

use super::adapters::{self, finite};
use crate::document::{CameraId, Click, Extra, FrameId, FrameLens, FramePtz, Repeat, Solution};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use strum::{EnumString, IntoStaticStr, VariantArray};
use touchline_core::camera::CameraBase;
use touchline_core::geometry::{ImageSize, PixelBox};
use touchline_vision::media::FrameRef;

/// A frame: a picture, what people clicked in it, and how the camera was pointed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Frame {
    /// The id that edits, suggestions and undo refer to; unique within the document.
    #[serde(default, skip_serializing_if = "FrameId::is_missing")]
    pub id: FrameId,
    /// Counts its edits.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub revision: u64,
    /// The image file, relative to the document's folder or absolute; none for a frame that only a
    /// video has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub image: Option<String>,
    /// Its camera.
    pub camera: CameraId,
    /// The video frame it is, if it comes from a video.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub video: Option<VideoFrame>,
    /// SHA-256 of the image file, hexadecimal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
    /// The size of the picture, px.
    #[cfg_attr(
        feature = "schema",
        schemars(with = "[u32; 2]", inner(range(min = 1, max = 65535)))
    )]
    #[serde(rename = "image_size_px", with = "adapters::image_size")]
    pub image_size: ImageSize,
    /// How far it has come.
    pub status: FrameStatus,
    /// Why it is not calibratable.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<RejectReason>,
    /// The shot it belongs to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clip: Option<Clip>,
    /// The user's comment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comment: Option<String>,
    /// Whether its clicks are used to estimate the base of its camera.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub use_for_base: bool,
    /// The user's choice whether it is used for training. Without a choice it is used, unless it is
    /// a suggestion or has the verdict Wrong.
    #[serde(default, alias = "teaches", skip_serializing_if = "Option::is_none")]
    pub use_for_training: Option<bool>,
    /// It is clicked again, blind.
    #[serde(default, skip_serializing_if = "is_no")]
    pub gold: bool,
    /// Who changed it last, and when.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub edited: Option<Edited>,
    /// What people clicked, in their order.
    #[serde(default, deserialize_with = "clicks")]
    pub clicks: Vec<Click>,
    /// Points of models that a person took away: no labels, kept for the makers of the models.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub refused_points: Vec<Click>,
    /// Landmarks that were clicked again, blind, to measure the annotator's click noise; not
    /// labels.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub repeats: Vec<Repeat>,
    /// Boxes that are excluded from feature detection in this frame: players.
    #[cfg_attr(feature = "schema", schemars(with = "Vec<[f64; 4]>"))]
    #[serde(
        rename = "masks_px",
        default,
        with = "adapters::boxes",
        skip_serializing_if = "Vec::is_empty"
    )]
    pub masks: Vec<PixelBox>,
    /// The name that the frame has in the files of another program that its camera or clicks came
    /// from, without folders and ending; none where it is that of its picture. Exports use it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub labels_name: Option<String>,
    /// What its lens is known to be before it is solved; none: as its camera's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lens: Option<FrameLens>,
    /// Pan, tilt and focal length; none: unsolved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ptz: Option<FramePtz>,
    /// How `ptz` came about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solution: Option<Solution>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

/// The maximum number of clicks of a frame, because all pairs of clicks are compared.
pub const MAX_CLICKS: usize = 1000;

/// Reads clicks, at most [`MAX_CLICKS`].
fn clicks<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Click>, D::Error> {
    let clicks = Vec::<Click>::deserialize(deserializer)?;
    if clicks.len() > MAX_CLICKS {
        let found = clicks.len();
        return Err(D::Error::custom(format_args!(
            "{found} clicks in a frame, and {MAX_CLICKS} are the most; take some away"
        )));
    }
    Ok(clicks)
}

/// A frame of a video.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct VideoFrame {
    /// The video file, relative to the document's folder or absolute.
    pub path: String,
    /// The decoded frame, counted from 0.
    pub frame_index: u64,
    /// Its time from the stream's start, s.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub pts_s: Option<f64>,
    /// What the file is recognised by, where that is known: the first 32 hexadecimal digits of the
    /// SHA-256 of its size (eight bytes, big-endian), its first MB and its last MB.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file_id: Option<Arc<str>>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

/// How far a frame has come.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Serialize,
    Deserialize,
    EnumString,
    IntoStaticStr,
    VariantArray,
)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum FrameStatus {
    /// Not looked at yet.
    #[default]
    New,
    /// Begun, but not accepted.
    Draft,
    /// Solved by the forest or by tracking, not yet looked at.
    Suggested,
    /// Accepted by the annotator.
    Reference,
    /// Not calibratable.
    Rejected,
}

impl FrameStatus {
    /// Every status, in the order in which a frame goes through them.
    pub const ALL: &[Self] = Self::VARIANTS;

    /// The name in documents.
    pub fn as_str(self) -> &'static str {
        self.into()
    }
}

/// Why a frame is not calibratable.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, VariantArray,
)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RejectReason {
    /// A close-up.
    CloseUp,
    /// A replay.
    Replay,
    /// Another camera.
    OtherCamera,
    /// A graphic covers it.
    Graphic,
    /// Too blurred.
    Blur,
    /// Too little of the field is in view.
    TooLittleField,
}

impl RejectReason {
    /// Every reason, in the order of the window's keys 1 to 6.
    pub const ALL: &[Self] = Self::VARIANTS;
}

/// The name of a shot: a number or a word.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum Clip {
    /// A number.
    Number(i64),
    /// A word.
    Name(String),
}

impl fmt::Display for Clip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Name(name) => name.fmt(f),
        }
    }
}

/// The last change of a frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Edited {
    /// The annotator's name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by: Option<String>,
    /// When, as in RFC 3339: `2026-05-01T18:30:00Z`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<String>,
    /// How long it was worked on altogether, s.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// The program that did it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

const fn yes() -> bool {
    true
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde asks for a function of a reference"
)]
const fn is_yes(value: &bool) -> bool {
    *value
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde asks for a function of a reference"
)]
const fn is_no(value: &bool) -> bool {
    !*value
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde asks for a function of a reference"
)]
const fn is_zero(revision: &u64) -> bool {
    *revision == 0
}

impl Frame {
    /// The revision of this frame after its next edit. It wraps around after the largest number, so
    /// that it always differs.
    pub(in crate::document) const fn next_revision(&self) -> u64 {
        self.revision.wrapping_add(1)
    }

    /// A frame that is an image file, new.
    pub fn from_image(image: &str, camera: CameraId, image_size: ImageSize) -> Self {
        Self {
            id: FrameId::from_picture(Some(image), None),
            revision: 0,
            image: Some(image.to_owned()),
            camera,
            video: None,
            sha256: None,
            image_size,
            status: FrameStatus::New,
            reason: None,
            clip: None,
            comment: None,
            use_for_base: true,
            use_for_training: None,
            gold: false,
            edited: None,
            clicks: Vec::new(),
            refused_points: Vec::new(),
            repeats: Vec::new(),
            masks: Vec::new(),
            labels_name: None,
            lens: None,
            ptz: None,
            solution: None,
            extra: Extra::new(),
        }
    }

    /// A frame of a video, new.
    pub fn from_video(video: VideoFrame, camera: CameraId, image_size: ImageSize) -> Self {
        let id = FrameId::from_picture(None, Some((&video.path, video.frame_index)));
        Self {
            id,
            image: None,
            video: Some(video),
            ..Self::from_image("", camera, image_size)
        }
    }

    /// Whether another frame has the same contents, regardless of the revisions.
    pub fn has_content_of(&self, other: &Self) -> bool {
        // Equal frames are compared without a copy. For the others a copy takes our revision, so
        // that the derived comparison covers all other keys.
        self == other
            || *self
                == Self {
                    revision: self.revision,
                    ..other.clone()
                }
    }

    /// The base of its camera with its own [lens](Self::lens), where it has one.
    pub fn base_from(&self, base: &CameraBase) -> CameraBase {
        self.lens
            .as_ref()
            .map_or(*base, |lens| lens.base_with(base))
    }

    /// The id derived from its picture.
    pub(in crate::document) fn id_of_picture(&self) -> FrameId {
        let video = self
            .video
            .as_ref()
            .map(|video| (video.path.as_str(), video.frame_index));
        FrameId::from_picture(self.image.as_deref(), video)
    }

    /// Its name in messages: the image's path, else the video's and the frame's number
    /// (`match.mp4#412`).
    pub fn name(&self) -> String {
        match (&self.image, &self.video) {
            (Some(image), _) => image.clone(),
            (None, Some(video)) => format!("{}#{}", video.path, video.frame_index),
            (None, None) => "a frame without a picture".to_owned(),
        }
    }

    /// The path of the image file, given the document's folder.
    pub fn image_path(&self, folder: &Path) -> Option<PathBuf> {
        self.image.as_ref().map(|image| folder.join(image))
    }

    /// The path of its video as the document writes it; none where it has no video.
    pub fn video_path(&self) -> Option<&str> {
        self.video.as_ref().map(|video| video.path.as_str())
    }

    /// Its number in its video, counted from 0; none where it has no video.
    pub fn video_frame_index(&self) -> Option<u64> {
        self.video.as_ref().map(|video| video.frame_index)
    }

    /// Its number for the user, at a position of the document: that of its video frame, else its
    /// position; both from 0.
    pub fn number_at(&self, position: usize) -> u64 {
        self.video_frame_index().unwrap_or(position as u64)
    }

    /// The source of its pixels, given the document's folder: its image file, else its video frame.
    pub fn picture_source(&self, folder: &Path) -> Option<FrameRef> {
        if let Some(path) = self.image_path(folder) {
            return Some(FrameRef::image(path));
        }
        // A number beyond the address space is no frame of any video: there is no picture then.
        let video = self.video.as_ref()?;
        Some(FrameRef::video(
            video.file_path(folder),
            usize::try_from(video.frame_index).ok()?,
        ))
    }
}

impl VideoFrame {
    /// A frame of a video by its number and time.
    pub fn new(path: &str, frame_index: u64, pts_s: Option<f64>) -> Self {
        Self {
            path: path.to_owned(),
            frame_index,
            pts_s,
            file_id: None,
            extra: Extra::new(),
        }
    }

    /// Whether a file that is recognised by `file_id` is another video than the one that was
    /// labelled; false where one of the two is not known.
    pub fn is_of_other_file(&self, file_id: Option<&str>) -> bool {
        let ids = self.file_id.as_deref().zip(file_id);
        ids.is_some_and(|(stated, found)| !stated.eq_ignore_ascii_case(found))
    }

    /// The path of the video file, given the document's folder.
    pub fn file_path(&self, folder: &Path) -> PathBuf {
        folder.join(&self.path)
    }
}
