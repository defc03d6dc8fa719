//! The foreign formats by name, and what each declares of itself.

use super::format_options::FormatOption;

/// A format of an import or export.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Format {
    /// This program's own: one JSON file.
    Json,
    /// Camera files of the SoccerNet challenges.
    SoccerNet,
    /// Line annotations of the SoccerNet challenges.
    SoccerNetLines,
    /// A table with one row per frame.
    Csv,
    /// Keypoints for Ultralytics' pose models.
    YoloPose,
    /// COCO keypoints.
    Coco,
    /// CVAT's XML 1.1.
    Cvat,
    /// Label Studio's JSON.
    LabelStudio,
    /// labelme's JSON, one file per image.
    Labelme,
    /// A table with a point a row.
    Points,
    /// Homographies of the World Cup 2014 set.
    Wc14,
    /// Homographies of the TS-WorldCup set.
    TsWorldCup,
    /// Homographies as JSON lines that state their direction and units.
    Homography,
    /// Tables of homographies that do not say what they are.
    Homographies,
    /// `BroadTrack`'s JSON.
    BroadTrack,
    /// COLMAP's text files.
    Colmap,
    /// OpenCV's YAML, one file per frame.
    OpenCv,
    /// A USD stage as text.
    Usda,
    /// `OpenTrackIO` samples, one per line.
    OpenTrackIo,
    /// `FreeD` packets.
    FreeD,
    /// The contents of `FreeD` packets, as a table.
    FreeDCsv,
    /// `DeepSport`'s basketball cameras.
    DeepSport,
    /// Nuke's camera track.
    Chan,
    /// Arrays of the FIFA Skeletal Tracking tasks.
    Fifa,
    /// Focal lengths frame by frame, as recorders write them.
    Lens,
    /// The Common Data Format's sheet of a video.
    Cdf,
    /// Cameras of `PnLCalib`, No Bells Just Whistles and `TVCalib`.
    PnlCalib,
    /// The MATLAB files of the two-point method's authors.
    AuthorsMat,
}

/// What a format is, as its file declares it beside reading and writing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct About {
    /// Its name on the command line.
    pub name: &'static str,
    /// Its description in one line.
    pub title: &'static str,
    /// World, angles, units, pixels.
    pub conventions: &'static str,
    /// Who reads it.
    pub users: &'static str,
    /// What an export loses, in a few words; none where the format is only read.
    pub loses: Option<&'static str>,
    /// What its file is usually called; none where an export makes a folder.
    pub file: Option<&'static str>,
    /// The description of its files in errors: "camera files".
    pub files: &'static str,
    /// The endings of the files that are read; none where the format is only written.
    pub endings: &'static [&'static str],
    /// The options that its export takes, beside the choice of frames.
    pub export_options: &'static [FormatOption],
    /// The options that its import takes.
    pub import_options: &'static [FormatOption],
}
