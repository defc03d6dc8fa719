//! Options of exports and imports.

use super::rate::Rate;
use super::timecode::Timecode;
use crate::document::{CameraId, FieldSpec, FrameStatus, Stage, resolve_path};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use strum::{EnumString, IntoStaticStr, VariantArray};
use touchline_core::geometry::ImageSize;

/// The choice of frames to export.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameChoice {
    /// Only frames of these statuses; empty: all that are solved (for clicks: all that have some)
    /// and not rejected.
    pub statuses: Vec<FrameStatus>,
    /// Only frames of these cameras; empty: all.
    pub cameras: Vec<CameraId>,
    /// Only frames whose solution has at least this confidence, or none stated.
    pub min_confidence: Option<f64>,
}

impl FrameChoice {
    /// Every frame, rejected ones too.
    pub fn everything() -> Self {
        Self {
            statuses: FrameStatus::ALL.to_vec(),
            ..Self::default()
        }
    }

    /// Frames that the user clicked or accepted; unreviewed suggestions are excluded.
    pub fn reviewed_frames() -> Self {
        Self {
            statuses: vec![FrameStatus::Reference, FrameStatus::Draft],
            ..Self::default()
        }
    }
}

/// Which frames are exported, and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExportOptions {
    /// Which frames.
    pub frames: FrameChoice,
    /// What happens where frames are missing between solved frames of a video.
    pub gaps: Gaps,
    /// The stage in whose axes tracks are written; none: that of their camera, if it has one, else
    /// the field's axes.
    pub stage: Option<Stage>,
    /// The timecode of the video's first frame; none: 00:00:00:00.
    pub start: Option<Timecode>,
    /// The size of picture that cameras are rescaled to: SoccerNet's evaluator wants 960 × 540.
    pub size: Option<ImageSize>,
    /// SoccerNet lines as the game state challenge names them, without the space behind
    /// `Goal left post left`.
    pub game_state: bool,
    /// Whether homographies are those of undistorted pictures, instead of the best fit to the
    /// pictures as they are.
    pub undistorted: bool,
    /// The names of keypoints.
    pub names: KeypointNames,
    /// Whether keypoints outside the picture are written as well, where the format can store them.
    pub keep_outside: bool,
    /// The source of points.
    pub points: PointSource,
    /// The frame rate; none: derived from the frames' times.
    pub rate: Option<Rate>,
    /// The width of the sensor, mm, where the document does not know it.
    pub sensor_width_mm: Option<f64>,
    /// How FreeD's zoom value says the focal length.
    pub zoom: Zoom,
    /// The frames for which rotation and translation are written, where the format allows to omit
    /// them.
    pub rotations: Rotations,
    /// Metadata of the video as a recording of a match.
    pub recording: Recording,
}

/// Metadata of a video that a document does not contain and some formats need.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Recording {
    /// The match's id in the other files about it.
    pub match_id: Option<String>,
    /// When the video begins, UTC: `2026-03-01T18:59:30Z`.
    pub start: Option<String>,
    /// Which of a stadium's cameras it is: `camera_1`, `tactical_wide`, `broadcast`, ….
    pub perspective: Option<String>,
    /// Whether the camera is operated automatically.
    pub is_automated: bool,
}

impl Recording {
    /// The perspectives that the Common Data Format knows.
    pub const PERSPECTIVES: [&str; 8] = [
        "tactical_wide",
        "camera_1",
        "high_behind_right",
        "high_behind_left",
        "cable_camera",
        "16m_right",
        "16m_left",
        "broadcast",
    ];

    /// Whether a text is a time in UTC such as `2026-03-01T18:59:30Z`.
    pub fn is_start(text: &str) -> bool {
        // jiff also reads offsets such as +01:00, which the Common Data Format does not allow.
        text.ends_with('Z') && text.parse::<jiff::Timestamp>().is_ok()
    }
}

/// What happens where frames are missing between solved frames of a video. They are only filled on
/// request.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gaps {
    /// They stay missing.
    #[default]
    Keep,
    /// Gaps of up to this many frames get interpolated cameras, marked as such.
    Interpolate(u64),
    /// A gap begins a new take with its own files.
    Takes,
}

/// The frames for which rotation and translation are written, in formats that allow to omit them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, EnumString, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "lowercase")]
pub enum Rotations {
    /// All frames.
    #[default]
    All,
    /// The first frame; for the others only the lens.
    First,
}

/// How files are read.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportOptions {
    /// The field of the new document.
    pub field: FieldSpec,
    /// The folder of the images; none: beside the files.
    pub images: Option<PathBuf>,
    /// The size of the pictures, where neither the file nor an image gives it.
    pub size: Option<ImageSize>,
    /// The size that the pictures had before they were stretched to that of the labels; none: they
    /// were not.
    pub stretched_from: Option<ImageSize>,
    /// The size of the frames of the video to which imported frames may be attached. What has no
    /// image is rescaled to it, from [`size`](Self::size) if that is given, where the proportions
    /// agree.
    pub video_size: Option<ImageSize>,
    /// The pixel convention, where the format does not define it; none: the usual one of the
    /// format.
    pub pixels: Option<Pixels>,
    /// The meaning of labels.
    pub map: LabelMap,
    /// Whether labels without a meaning are skipped.
    pub skip_unmapped: bool,
    /// The annotator whose annotations are read, where a file has several.
    pub annotator: Option<String>,
    /// How FreeD's zoom value says the focal length.
    pub zoom: Option<Zoom>,
    /// The width of the sensor, mm.
    pub sensor_width_mm: Option<f64>,
    /// Whether the distortion that a file states has been taken out of the pictures.
    pub undistorted: bool,
    /// Whether boxes of people become masks of their frames.
    pub masks: bool,
    /// What homographies mean that do not say it.
    pub homographies: HomographyOptions,
    /// The model that found the points; none where people placed them.
    pub model: Option<PointModel>,
}

/// The model whose points are read.
#[derive(Clone, Debug, PartialEq)]
pub struct PointModel {
    /// Its name; the origin of its points is `model:` and this.
    pub name: String,
    /// Points of a lower probability are left out.
    pub min_probability: f64,
}

impl Default for ImportOptions {
    fn default() -> Self {
        Self {
            field: FieldSpec::new("soccer"),
            images: None,
            size: None,
            stretched_from: None,
            video_size: None,
            pixels: None,
            map: LabelMap::default(),
            skip_unmapped: false,
            annotator: None,
            zoom: None,
            sensor_width_mm: None,
            undistorted: false,
            masks: false,
            homographies: HomographyOptions::default(),
            model: None,
        }
    }
}

impl ImportOptions {
    /// What takes coordinates of labels to the corner convention, px: nothing where the user does
    /// not say how they count.
    pub(super) fn shift_to_corner_px(&self) -> f64 {
        self.pixels.unwrap_or(Pixels::Corner).to_corner_px()
    }

    /// The size of the video's frames, where labels for pictures of `size` have to be rescaled to
    /// it. A size that is given beside a video is that of the labels.
    pub(super) fn video_to_fit(&self, size: ImageSize) -> Option<ImageSize> {
        self.video_size
            .filter(|video| *video != size && size.factor_to(*video).is_some())
    }

    /// The size of pictures that are not there: the video's, or the given one if that has other
    /// proportions.
    pub(super) fn picture_size(&self) -> Option<ImageSize> {
        let given = self.size.or(self.video_size)?;
        Some(self.video_to_fit(given).unwrap_or(given))
    }

    /// The options for reading files: the size of the video where no other is given.
    #[must_use]
    pub(super) fn with_any_size(&self) -> Self {
        Self {
            size: self.size.or(self.video_size),
            ..self.clone()
        }
    }

    /// The folder of the pictures: the given one, else that of the files.
    pub(super) fn images_folder(&self, folder: &Path) -> PathBuf {
        self.images
            .as_ref()
            .map_or_else(|| folder.to_path_buf(), |images| resolve_path(images))
    }
}

/// The origin of pixel coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pixels {
    /// (0, 0) is the top-left corner of the picture.
    Corner,
    /// (0, 0) is the middle of the first pixel.
    Centre,
}

impl Pixels {
    /// The shift of a coordinate to the corner convention, px.
    pub const fn to_corner_px(self) -> f64 {
        match self {
            Self::Corner => 0.0,
            Self::Centre => 0.5,
        }
    }
}

/// The source of the points of a click format.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PointSource {
    /// The users' clicks.
    #[default]
    Clicked,
    /// Landmarks and lines projected by the cameras of solved frames.
    Projected,
}

/// The names of keypoints in training data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, EnumString, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum KeypointNames {
    /// This program's landmarks, in its order.
    #[default]
    Touchline,
    /// The 32 points of Roboflow's `SoccerPitchConfiguration`, by index.
    #[strum(serialize = "roboflow-32")]
    Roboflow32,
}

/// How FreeD's raw zoom value says the focal length.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Zoom {
    /// The focal length in px itself.
    #[default]
    FocalPx,
    /// The focal length in mm × 100, by the width of the sensor.
    FocalMmX100,
    /// A table of raw values and focal lengths, px, both rising or one falling; linear between.
    Table(Vec<(f64, f64)>),
}

/// The meaning of labels of other tools: a landmark or line of the field, or nothing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum LabelMap {
    /// Labels are this program's names.
    #[default]
    Touchline,
    /// The 32 points of Roboflow by index, from 0.
    Roboflow32,
    /// The 32 points of Roboflow by the captions that its pictures show, "01" to "32".
    Roboflow32Captions,
    /// SoccerNet's classes of lines.
    SoccerNet,
    /// A user's own map; none for labels to be ignored.
    Own(BTreeMap<String, Option<String>>),
}

/// How homographies are read that do not say what they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HomographyOptions {
    /// The plane that they map to or from.
    pub plan: Option<GroundPlan>,
    /// Their direction, where the plan leaves it open.
    pub direction: Option<MatrixDirection>,
    /// The column of the matrix; none: found by its name.
    pub matrix_column: Option<String>,
    /// The column of the frame's name; none: found by its name.
    pub name_column: Option<String>,
}

/// A plane with coordinates of the ground, as makers of homographies use one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, EnumString, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "lowercase")]
pub enum GroundPlan {
    /// Metres from the field's centre, x to the right, y away from the camera.
    #[strum(serialize = "centre-m")]
    CentreMetres,
    /// Metres from the far left corner, x to the right, y towards the camera.
    #[strum(serialize = "corner-m")]
    CornerMetres,
    /// The template of the World Cup 2014 set: yards from the far left corner, y to the camera.
    #[strum(serialize = "wc14")]
    WorldCup2014,
    /// The court of `ShuttleSet`: px of a drawing whose y runs along the court, the far back line
    /// above. A camera looks along the court.
    ShuttleSet,
}

impl GroundPlan {
    /// The field that it is usually of.
    pub const fn usual_field(self) -> &'static str {
        match self {
            Self::ShuttleSet => "badminton",
            _ => "soccer",
        }
    }
}

/// The direction of a matrix between a picture and the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq, EnumString, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "snake_case")]
pub enum MatrixDirection {
    /// From the picture to the ground.
    PitchFromImage,
    /// From the ground to the picture.
    ImageFromPitch,
}
