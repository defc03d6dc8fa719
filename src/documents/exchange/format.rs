//! The foreign formats by name, and what each declares of itself.

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
    /// Homographies of the World Cup 2014 set.
    Wc14,
    /// Homographies of the TS-WorldCup set.
    TsWorldCup,
    /// Homographies as JSON lines that state their direction and units.
    Homography,
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
    /// The options of exports and imports that it takes beside those of all cameras or all clicks.
    pub options: &'static [FormatOption],
}

/// An option that only some formats take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormatOption {
    /// Homographies of undistorted pictures.
    Undistorted,
    /// Metadata of the recording, and its frame rate.
    Recording,
    /// Those of a track over time: what happens to missing frames, and the frame rate.
    Track,
    /// The width of the sensor.
    Sensor,
    /// The timecode of the first frame.
    Start,
    /// The meaning of zoom values.
    Zoom,
    /// The axes of a stage.
    Stage,
    /// The names of Roboflow's keypoints.
    Roboflow,
    /// The names of lines of the game state challenge.
    GameState,
}
