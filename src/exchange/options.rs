//! What an export or import may be told.

use crate::document::{CameraId, FieldSpec, FrameStatus};
use crate::geometry::ImageSize;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Which frames are exported, and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExportOptions {
    /// Only frames of these statuses; empty: all that are solved (for clicks: all that have some) and not rejected.
    pub statuses: Vec<FrameStatus>,
    /// Only frames of these cameras; empty: all.
    pub cameras: Vec<CameraId>,
    /// Only frames whose solution has at least this confidence, or none stated.
    pub min_confidence: Option<f64>,
    /// The size of picture that cameras are rescaled to: SoccerNet's evaluator wants 960 × 540.
    pub size: Option<ImageSize>,
    /// SoccerNet lines as the game state challenge names them, without the space behind `Goal left post left`.
    pub game_state: bool,
    /// Homographies of pictures whose distortion has been taken out, instead of those that come nearest in the pictures as they
    /// are.
    pub undistorted: bool,
    /// The names of keypoints.
    pub names: KeypointNames,
    /// Keypoints outside of the picture are written too, where the format can hold them.
    pub keep_outside: bool,
    /// Where points come from.
    pub points: PointSource,
    /// Frames a second; none: from the frames' times.
    pub rate: Option<Rate>,
    /// The width of the sensor, mm, where the document does not know it.
    pub sensor_width_mm: Option<f64>,
    /// How FreeD's zoom value says the focal length.
    pub zoom: Zoom,
    /// What is known of the video as a recording of a match.
    pub recording: Recording,
}

/// What a document does not know of a video and some formats want.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Recording {
    /// The match's id in the other files about it.
    pub match_id: Option<String>,
    /// When the video begins, UTC: `2026-03-01T18:59:30Z`.
    pub start: Option<String>,
    /// Which of a stadium's cameras it is: `camera_1`, `tactical_wide`, `broadcast`, ….
    pub perspective: Option<String>,
    /// No person turned the camera.
    pub is_automated: bool,
}

/// How files are read.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportOptions {
    /// The field of the document that is made.
    pub field: FieldSpec,
    /// The folder of the images; none: beside the files.
    pub images: Option<PathBuf>,
    /// The size of the pictures, where neither file nor image says it.
    pub size: Option<ImageSize>,
    /// Where pixels are counted from, where the format leaves it open; none: as the format usually has it.
    pub pixels: Option<Pixels>,
    /// What labels mean.
    pub map: LabelMap,
    /// Labels without meaning are left out.
    pub skip_unmapped: bool,
    /// Whose annotations are read, where a file has several.
    pub annotator: Option<String>,
    /// How FreeD's zoom value says the focal length.
    pub zoom: Option<Zoom>,
    /// The width of the sensor, mm.
    pub sensor_width_mm: Option<f64>,
}

impl Default for ImportOptions {
    fn default() -> Self {
        Self {
            field: FieldSpec::new("soccer"),
            images: None,
            size: None,
            pixels: None,
            map: LabelMap::default(),
            skip_unmapped: false,
            annotator: None,
            zoom: None,
            sensor_width_mm: None,
        }
    }
}

/// Where pixels are counted from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pixels {
    /// (0, 0) is the top-left corner of the picture.
    Corner,
    /// (0, 0) is the middle of the first pixel.
    Centre,
}

impl Pixels {
    /// What is added to a coordinate to count it from the corner, px.
    #[must_use]
    pub const fn to_corner_px(self) -> f64 {
        match self {
            Self::Corner => 0.0,
            Self::Centre => 0.5,
        }
    }
}

/// A frame rate as a ratio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rate {
    /// Frames.
    pub frames: u32,
    /// In this many seconds.
    pub seconds: u32,
}

impl Rate {
    /// The rates of broadcasts and films.
    const USUAL: [Self; 9] = [
        Self::new(24_000, 1001),
        Self::new(24, 1),
        Self::new(25, 1),
        Self::new(30_000, 1001),
        Self::new(30, 1),
        Self::new(50, 1),
        Self::new(60_000, 1001),
        Self::new(60, 1),
        Self::new(100, 1),
    ];

    /// So many frames in so many seconds.
    #[must_use]
    pub const fn new(frames: u32, seconds: u32) -> Self {
        Self { frames, seconds }
    }

    /// Frames a second.
    #[must_use]
    pub fn per_second(self) -> f64 {
        f64::from(self.frames) / f64::from(self.seconds)
    }

    /// The usual rate within 0.02 % of a measured one.
    #[must_use]
    pub fn nearest(per_second: f64) -> Option<Self> {
        let off = |rate: &Self| (rate.per_second() / per_second - 1.0).abs();
        let nearest = Self::USUAL.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
        (off(&nearest) < 2e-4).then_some(nearest)
    }

    /// `25`, `29.97` or `30000/1001`.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        if let Some((frames, seconds)) = text.split_once('/') {
            let (frames, seconds) = (frames.parse().ok()?, seconds.parse().ok()?);
            return (frames > 0 && seconds > 0).then_some(Self { frames, seconds });
        }
        let per_second: f64 = text.parse().ok()?;
        if per_second.fract() == 0.0 && (1.0..=1000.0).contains(&per_second) {
            return Some(Self::new(per_second as u32, 1));
        }
        Self::nearest(per_second)
    }
}

/// Where the points of a format of clicks come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PointSource {
    /// Where people clicked.
    #[default]
    Clicked,
    /// Where the cameras of solved frames show landmarks and lines.
    Projected,
}

/// The names of keypoints in training data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum KeypointNames {
    /// This program's landmarks, in its order.
    #[default]
    Touchline,
    /// The 32 points of Roboflow's `SoccerPitchConfiguration`, by index.
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

/// What labels of other tools mean: a landmark or line of the field, or nothing.
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
    /// A user's own; none for labels that mean nothing here.
    Own(BTreeMap<String, Option<String>>),
}

#[cfg(test)]
mod tests {
    use super::Rate;

    #[test]
    fn rates_are_read_as_people_write_them() {
        assert_eq!(Rate::parse("25"), Some(Rate::new(25, 1)));
        assert_eq!(Rate::parse("29.97"), Some(Rate::new(30_000, 1001)));
        assert_eq!(Rate::parse("30000/1001"), Some(Rate::new(30_000, 1001)));
        assert_eq!(Rate::nearest(23.9763), Some(Rate::new(24_000, 1001)));
        for bad in ["0", "1/0", "27.3", "fast", "-25"] {
            assert_eq!(Rate::parse(bad), None, "{bad}");
        }
    }
}
