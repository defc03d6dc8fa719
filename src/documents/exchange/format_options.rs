//! The options of exports and imports that some formats take and others do not.
//!
//! Each format declares what it takes ([`About`](super::About)). Any other option that a user gives
//! is refused: an option that is ignored makes wrong data, and nothing shows it.

use strum::VariantArray as _;

/// An option that only some formats take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, strum::IntoStaticStr, strum::VariantArray)]
#[strum(serialize_all = "kebab-case")]
#[non_exhaustive]
pub enum FormatOption {
    /// The size of the pictures.
    Size,
    /// Names of lines as the game state challenge has them.
    Variant,
    /// Homographies of undistorted pictures.
    Undistorted,
    /// The names of keypoints.
    Names,
    /// Points where the camera shows the landmarks.
    Projected,
    /// Points outside of the picture.
    Outside,
    /// Cameras for frames that are missing.
    Interpolate,
    /// A file for each run of frames.
    Takes,
    /// The timecode of the first frame.
    Start,
    /// Frames a second.
    Fps,
    /// The width of the sensor.
    SensorMm,
    /// The match's id.
    MatchId,
    /// When the video begins.
    StartTime,
    /// Which of a stadium's cameras it is.
    Perspective,
    /// Whether no person turned the camera.
    Automated,
    /// The origin of a stage.
    StageOrigin,
    /// The heading of a stage.
    StageHeading,
    /// The frames that have a rotation.
    Rotations,
    /// The meaning of zoom values.
    Zoom,
    /// The folder of the pictures.
    Images,
    /// Where pixels are counted from.
    Pixels,
    /// The meaning of labels.
    Map,
    /// Labels without a meaning are left out.
    SkipUnmapped,
    /// Whose annotations are read.
    Annotator,
    /// The field's template.
    Field,
    /// A parameter of the field.
    Set,
    /// A camera for each picture.
    EachOwnCamera,
    /// The size of the pictures before they were stretched.
    StretchedFrom,
    /// The plane of homographies.
    Template,
    /// The direction of homographies.
    Direction,
    /// The columns of a table.
    Columns,
    /// Boxes of people as masks.
    Masks,
}

use FormatOption::{
    EachOwnCamera, Field, Images, Interpolate, Map, Names, Outside, Pixels, Projected, Set, Size,
    SkipUnmapped, StretchedFrom, Takes, Undistorted,
};

/// What every export of cameras takes.
pub(super) const CAMERAS_OUT: &[FormatOption] = &[Size, Interpolate, Takes];
/// What every import of cameras takes.
pub(super) const CAMERAS_IN: &[FormatOption] = &[Field, Set, Images, Size];
/// What exports of homographies take.
pub(super) const HOMOGRAPHIES_OUT: &[FormatOption] = &[Size, Interpolate, Takes, Undistorted];
/// What exports of points take.
pub(super) const POINTS_OUT: &[FormatOption] = &[Size, Projected, Outside];
/// What exports of named keypoints take.
pub(super) const KEYPOINTS_OUT: &[FormatOption] = &[Size, Projected, Outside, Names];
/// What imports of labels in pixels take.
pub(super) const LABELS_IN: &[FormatOption] = &[
    Field,
    Set,
    Images,
    Size,
    Pixels,
    Map,
    SkipUnmapped,
    EachOwnCamera,
    StretchedFrom,
];

/// Whether files are written or read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// They are written.
    Export,
    /// They are read.
    Import,
}

impl FormatOption {
    /// Every option.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::VARIANTS.iter().copied()
    }

    /// Its name on the command line, behind two hyphens.
    pub fn name(self) -> &'static str {
        self.into()
    }
}
