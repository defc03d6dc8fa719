//! The readers and writers of all formats of cameras and clicks.

use super::broadtrack::BroadTrack;
use super::camera_format::CameraFormat;
use super::cdf::Cdf;
use super::chan::Chan;
use super::clicked_frame::ClickFormat;
use super::coco::Coco;
use super::colmap::Colmap;
use super::csv_table::Csv;
use super::cvat::Cvat;
use super::deepsport::DeepSport;
use super::fifa::Fifa;
use super::format::Format;
use super::freed::{FreeD, FreeDCsv};
use super::homography_files::{HomographyLines, TsWorldCup, Wc14};
use super::label_studio::LabelStudio;
use super::labelme::Labelme;
use super::opencv_yaml::OpenCvYaml;
use super::opentrackio::OpenTrackIo;
use super::soccernet::{PnlCalib, SoccerNet};
use super::soccernet_lines::SoccerNetLines;
use super::usda::Usda;
use super::yolo_pose::YoloPose;

/// The reader and writer of a format of cameras; none for formats of clicks and for whole
/// documents.
#[must_use]
pub fn camera_format(format: Format) -> Option<&'static dyn CameraFormat> {
    Some(match format {
        Format::SoccerNet => &SoccerNet,
        Format::PnlCalib => &PnlCalib,
        Format::Csv => &Csv,
        Format::Wc14 => &Wc14,
        Format::TsWorldCup => &TsWorldCup,
        Format::Homography => &HomographyLines,
        Format::BroadTrack => &BroadTrack,
        Format::Colmap => &Colmap,
        Format::OpenCv => &OpenCvYaml,
        Format::Usda => &Usda,
        Format::OpenTrackIo => &OpenTrackIo,
        Format::FreeD => &FreeD,
        Format::FreeDCsv => &FreeDCsv,
        Format::DeepSport => &DeepSport,
        Format::Chan => &Chan,
        Format::Fifa => &Fifa,
        Format::Cdf => &Cdf,
        _ => return None,
    })
}

/// The reader and writer of a format of clicks; none for formats of cameras and for whole
/// documents.
#[must_use]
pub fn click_format(format: Format) -> Option<&'static dyn ClickFormat> {
    Some(match format {
        Format::SoccerNetLines => &SoccerNetLines,
        Format::YoloPose => &YoloPose,
        Format::Coco => &Coco,
        Format::Cvat => &Cvat,
        Format::LabelStudio => &LabelStudio,
        Format::Labelme => &Labelme,
        _ => return None,
    })
}
