//! The readers and writers of all formats of cameras and clicks.

use super::format::Format;
use crate::exchange::camera_formats::broadtrack::BroadTrack;
use crate::exchange::camera_formats::cdf::Cdf;
use crate::exchange::camera_formats::chan::Chan;
use crate::exchange::camera_formats::colmap::Colmap;
use crate::exchange::camera_formats::csv_table::Csv;
use crate::exchange::camera_formats::deepsport::DeepSport;
use crate::exchange::camera_formats::fifa::Fifa;
use crate::exchange::camera_formats::freed::{FreeD, FreeDCsv};
use crate::exchange::camera_formats::homography_files::{HomographyLines, TsWorldCup, Wc14};
use crate::exchange::camera_formats::opencv_yaml::OpenCvYaml;
use crate::exchange::camera_formats::opentrackio::OpenTrackIo;
use crate::exchange::camera_formats::soccernet::{PnlCalib, SoccerNet};
use crate::exchange::camera_formats::usda::Usda;
use crate::exchange::cameras::camera_format::CameraFormat;
use crate::exchange::click_formats::clicked_frame::ClickFormat;
use crate::exchange::click_formats::coco::Coco;
use crate::exchange::click_formats::cvat::Cvat;
use crate::exchange::click_formats::label_studio::LabelStudio;
use crate::exchange::click_formats::labelme::Labelme;
use crate::exchange::click_formats::soccernet_lines::SoccerNetLines;
use crate::exchange::click_formats::yolo_pose::YoloPose;

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
