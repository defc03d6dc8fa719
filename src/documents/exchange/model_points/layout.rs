//! The layouts of files with points of models.

use super::json_map::JsonMap;
use super::pnlcalib::PnlCalibPoints;
use super::rf_detr::RfDetr;
use super::scored::{ScoredCoco, ScoredTable, ScoredYolo};
use crate::exchange::click_formats::clicked_frame::ClickFormat;
use crate::exchange::error::ExchangeResult;
use crate::exchange::format::Format;
use crate::exchange::format_options::{Direction, FormatOption};
use crate::exchange::imports::import_clicks::import_clicks;
use crate::exchange::imports::imported::Imported;
use crate::exchange::options::ImportOptions;
use crate::exchange::registry::refuse_not_taken;
use std::path::Path;
use strum::{EnumString, IntoStaticStr, VariantArray};

/// A layout of files with points of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, EnumString, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
#[non_exhaustive]
pub enum PointLayout {
    /// `PnLCalib`'s and No Bells Just Whistles' points and lines, one JSON file a picture.
    #[strum(serialize = "pnlcalib")]
    PnlCalib,
    /// Predictions of Ultralytics' pose models.
    YoloPose,
    /// COCO keypoints or results with a probability as the third number of a point.
    Coco,
    /// `inference`'s JSON, one file a picture.
    RfDetr,
    /// A JSON map: picture, label, point.
    JsonMap,
    /// A table: frame, label, x, y, and p or `sigma_px`.
    Table,
}

impl PointLayout {
    fn reader(self) -> &'static dyn ClickFormat {
        match self {
            Self::PnlCalib => &PnlCalibPoints,
            Self::YoloPose => &ScoredYolo,
            Self::Coco => &ScoredCoco,
            Self::RfDetr => &RfDetr,
            Self::JsonMap => &JsonMap,
            Self::Table => &ScoredTable,
        }
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Refuses options that it does not take.
    ///
    /// # Errors
    /// One of them is such an option; the formats that take it are named.
    pub fn refuse_options(
        self,
        given: impl IntoIterator<Item = FormatOption>,
    ) -> ExchangeResult<()> {
        let taken = self.reader().about().import_options;
        let what = format!("--points in the layout {}", self.name());
        let is_taken = |option| taken.contains(&option);
        refuse_not_taken(given, is_taken, &what, Direction::Import)
    }
}

/// Reads a file or folder of a model's points as a document. Its frames are new: what the points
/// give is a suggestion until a person accepts it. `options` names the
/// [model](ImportOptions::model).
///
/// # Errors
/// It cannot be read, is damaged, or has labels that mean nothing.
pub fn import_points(
    path: &Path,
    layout: PointLayout,
    options: &ImportOptions,
) -> ExchangeResult<Imported> {
    let folder = crate::exchange::imports::import::folder_of(path);
    import_clicks(path, &folder, Format::Points, layout.reader(), options)
}
