//! Descriptions of the formats for the user: conventions, and programs that read them.

use super::format::Format;

/// A format in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct About {
    /// World, angles, units, pixels.
    pub conventions: &'static str,
    /// Who reads it.
    pub users: &'static str,
}

/// A row of the table.
const fn about(conventions: &'static str, users: &'static str) -> About {
    About { conventions, users }
}

const SOCCERNET_WORLD: &str =
    "x right, y toward the main camera, z down, m; angles ZXZ in degrees, tilt 0 looks down";
const YARDS: &str = "image → template in yards from the far-left corner, y toward the camera; pixel centres at whole numbers";

impl Format {
    /// What its file is usually called; for a folder the folder.
    #[must_use]
    pub const fn usual_name(self) -> &'static str {
        match self {
            Self::Json => "dataset.json",
            Self::Csv => "cameras.csv",
            Self::Coco => "keypoints.json",
            Self::LabelStudio => "label-studio.json",
            Self::Homography | Self::OpenTrackIo => "cameras.jsonl",
            Self::BroadTrack => "broadtrack.json",
            Self::Usda => "camera.usda",
            Self::FreeD => "camera.freed",
            Self::FreeDCsv => "camera.csv",
            Self::Chan => "camera.chan",
            Self::Fifa => "cameras.npz",
            Self::Cdf => "video.json",
            folder => folder.name(),
        }
    }

    /// The format in words.
    #[must_use]
    pub const fn about(self) -> About {
        match self {
            Self::Json => about(
                "world: origin at the field's centre, x right, y away, z up, m; degrees; pixels from the corner",
                "this program, touchline_dataset.py (numpy)",
            ),
            Self::SoccerNet => about(
                SOCCERNET_WORLD,
                "SoccerNet challenges, sn-calibration, tracklab, TVCalib, PnLCalib, sportlight",
            ),
            Self::SoccerNetLines => about(
                "points as fractions of width and height, by class of line",
                "SoccerNet calibration, game state (--variant gamestate)",
            ),
            Self::Csv => about(
                "touchline's world; R is cam_from_world, H takes undistorted pixels to metres on the pitch",
                "pandas, polars, spreadsheets, analysts",
            ),
            Self::YoloPose => about(
                "points as fractions of width and height; one box per picture",
                "Ultralytics pose models, Roboflow",
            ),
            Self::Coco => about(
                "pixel centres at whole numbers (touchline's − 0.5)",
                "mmpose, Detectron2, FiftyOne, pycocotools",
            ),
            Self::Cvat => about("pixels from the corner", "CVAT"),
            Self::LabelStudio => about("percent of width and height", "Label Studio"),
            Self::Labelme => about("pixels from the corner", "labelme, AnyLabeling"),
            Self::Wc14 => about(YARDS, "World Cup 2014 benchmarks, KpSFR, SCCvSD"),
            Self::TsWorldCup => about(YARDS, "TS-WorldCup benchmarks, KpSFR"),
            Self::Homography => about(
                "pitch ← image in metres, pixels from the corner; each line says so",
                "scripts",
            ),
            Self::BroadTrack => about(
                SOCCERNET_WORLD,
                "BroadTrack, pipelines with cached calibrations",
            ),
            Self::Colmap => about(
                "touchline's world → camera, quaternion; pixels from the corner; one camera per frame",
                "COLMAP, pycolmap, NeRF, 3D Gaussian splats",
            ),
            Self::OpenCv => about(
                "touchline's world → camera, rvec and tvec; pixel centres at whole numbers",
                "OpenCV FileStorage, robotics",
            ),
            Self::Usda => about(
                "y up, centimetres, mm; one stage frame per video frame; a gap starts a new camera",
                "Blender, Houdini, Unreal, usdview",
            ),
            Self::OpenTrackIo => about(
                "touchline's world; pan left positive, order Z X Y; mm on the sensor",
                "Unreal 5.6, disguise, Mo-Sys, stYpe",
            ),
            Self::FreeD => about(
                "pan right positive, 1/32768°, 1/64 mm; zoom in raw steps",
                "virtual studios, Unreal LiveLink, Vizrt",
            ),
            Self::FreeDCsv => about(
                "as FreeD, in degrees and mm, with times",
                "spreadsheets, FreeD players",
            ),
            Self::DeepSport => about("far-left corner, z down, cm", "DeepSport, calib3d"),
            Self::Chan => about(
                "y up, m, rotation order ZXY, vertical field of view in degrees",
                "Nuke, Blender, Natron",
            ),
            Self::Fifa => about(
                "touchline's world → camera, R and t; pixel centres at whole numbers; a lens per frame",
                "FIFA Skeletal Tracking tasks, NumPy",
            ),
            Self::Cdf => about(
                "touchline's world; the camera's position, m",
                "the Common Data Format and its validator",
            ),
            Self::PnlCalib => about(SOCCERNET_WORLD, "PnLCalib, No Bells Just Whistles, TVCalib"),
            Self::AuthorsMat => about(
                "corner of the field, yards and metres, Rodrigues",
                "the two-point method's authors",
            ),
        }
    }
}
