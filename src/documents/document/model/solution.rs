//! What a solve says about a frame.

use super::adapters::{self, finite};
use crate::document::{Extra, Ground, ImportedCamera, Target};
use serde::{Deserialize, Serialize};
use touchline_core::camera::{Ptz, Radial};
use touchline_core::geometry::Mat3;
use touchline_core::markings::LineVerdict;
use touchline_core::solve::{IdentityFinding, Name, Verdict, WarningCode};

/// Pan, tilt and focal length of a frame in the document's units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FramePtz {
    /// Positive to the right, degrees in (−180, 180].
    #[cfg_attr(feature = "schema", schemars(with = "f64"))]
    #[serde(with = "adapters::degrees")]
    pub pan_deg: f64,
    /// Positive up, degrees in (−180, 180].
    #[cfg_attr(feature = "schema", schemars(with = "f64"))]
    #[serde(with = "adapters::degrees")]
    pub tilt_deg: f64,
    /// px of the frame.
    #[cfg_attr(feature = "schema", schemars(with = "f64", extend("exclusiveMinimum" = 0)))]
    #[serde(with = "adapters::positive")]
    pub focal_px: f64,
    /// The k₁ that was used. It is input only where the camera has no curve.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub k1: Option<f64>,
    /// The k₂ that was used, where it is not zero: a record, never an input.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub k2: Option<f64>,
    /// The camera of this frame as another program gave it, if that stands not quite on the base
    /// of its camera: sensors on a tripod, and programs that calibrate a video frame by frame,
    /// state a place and a roll for every frame. The frame is drawn, exported and compared with
    /// it; pan, tilt and focal length beside it are the nearest ones on the base.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imported: Option<Box<ImportedCamera>>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

impl FramePtz {
    /// The record of a solved frame and of the lens that was used.
    pub fn new(ptz: Ptz, lens: Option<Radial>) -> Self {
        Self {
            // Documents state angles in (−180°, 180°]; inside, a camera may have gone round
            // further.
            pan_deg: ptz.pan.wrap().degrees(),
            tilt_deg: ptz.tilt.wrap().degrees(),
            focal_px: ptz.focal_px,
            k1: lens.map(|lens| lens.k1),
            k2: lens.map(|lens| lens.k2).filter(|k2| *k2 != 0.0),
            imported: None,
            extra: Extra::new(),
        }
    }

    /// The lens that was used, where it is recorded.
    pub fn lens(&self) -> Option<Radial> {
        Some(Radial {
            k1: self.k1?,
            k2: self.k2.unwrap_or(0.0),
            ..Radial::default()
        })
    }

    /// The same as the mathematics has it.
    pub const fn ptz(&self) -> Ptz {
        Ptz::from_degrees(self.pan_deg, self.tilt_deg, self.focal_px)
    }
}

/// How a frame's `ptz` came about and how good it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Solution {
    /// Covariance in the order `pan_deg`, `tilt_deg`, `focal_px` (deg², deg·px, px²).
    #[cfg_attr(feature = "schema", schemars(with = "Option<[[f64; 3]; 3]>"))]
    #[serde(
        default,
        with = "adapters::optional_matrix",
        skip_serializing_if = "Option::is_none"
    )]
    pub covariance: Option<Mat3>,
    /// The same by the frame's own evidence alone (clicks, paint, features, points), with the
    /// camera's base taken as exact. The total is computed from it, never the reverse; documents
    /// written before it was kept lack it.
    #[cfg_attr(feature = "schema", schemars(with = "Option<[[f64; 3]; 3]>"))]
    #[serde(
        default,
        with = "adapters::optional_matrix",
        skip_serializing_if = "Option::is_none"
    )]
    pub own_covariance: Option<Mat3>,
    /// Root mean square of the residuals, px; none where the clicks leave nothing to compare.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub rms_px: Option<f64>,
    /// 1-σ of the overlay at the worst corner of the picture, px.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub worst_corner_sigma_px: Option<f64>,
    /// What the camera is good for on the ground, where an export stated it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ground: Option<Ground>,
    /// What it was solved from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<SolutionSource>,
    /// The probability that the overlay is right within 10 px at 1920 px width.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub confidence: Option<f64>,
    /// How many samples of painted lines took part, where they did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub samples: Option<usize>,
    /// What the paint of the picture says about the camera, if it was checked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line_check: Option<PaintEvidence>,
    /// The camera that it had before a person corrected it with clicks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub proposed: Option<Proposed>,
    /// The camera that another program gave the frame, where another one replaced it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imported: Option<ImportedCamera>,
    /// What finding it took.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timings_ms: Option<TimingsMs>,
    /// The verdict on the clicks when they were solved; none in older documents, and in frames
    /// without clicks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
    /// Indices of the clicks that disagree with the others.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub disputed: Vec<usize>,
    /// What a person should know.
    #[serde(default)]
    pub warnings: Vec<SolutionWarning>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

/// A camera that the program proposed, or that was imported. A frame keeps it when a person
/// corrects it: fewer clicks than decide by themselves start from it, and without clicks it holds
/// again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Proposed {
    /// How the camera was pointed.
    #[serde(flatten)]
    pub ptz: FramePtz,
    /// Who proposed it.
    pub source: SolutionSource,
    /// The probability that it is right.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub confidence: Option<f64>,
    /// Its covariance in the order `pan_deg`, `tilt_deg`, `focal_px`.
    #[cfg_attr(feature = "schema", schemars(with = "Option<[[f64; 3]; 3]>"))]
    #[serde(
        default,
        with = "adapters::optional_matrix",
        skip_serializing_if = "Option::is_none"
    )]
    pub covariance: Option<Mat3>,
    /// The same with the camera's base taken as exact.
    #[cfg_attr(feature = "schema", schemars(with = "Option<[[f64; 3]; 3]>"))]
    #[serde(
        default,
        with = "adapters::optional_matrix",
        skip_serializing_if = "Option::is_none"
    )]
    pub own_covariance: Option<Mat3>,
    /// 1-σ of its overlay at the worst corner of the picture, px.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub worst_corner_sigma_px: Option<f64>,
}

impl PaintEvidence {
    /// Places of the lines that lie open.
    pub const fn open(&self) -> usize {
        self.found + self.bare
    }

    /// What the paint says.
    pub fn verdict(&self) -> LineVerdict {
        LineVerdict::from_score(self.score, self.open())
    }
}

/// What the painted lines of a picture say about a camera.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PaintEvidence {
    /// The probability that the camera is right within 10 px at 1920 px width, by the paint alone.
    #[serde(serialize_with = "finite")]
    pub score: f64,
    /// Places of the lines that the camera puts into the picture.
    pub predicted: usize,
    /// Those with paint near by.
    pub found: usize,
    /// Those that show open ground and no paint.
    pub bare: usize,
    /// The median distance of the paint from where it is predicted, px.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub offset_px: Option<f64>,
    /// The median of how far the paint lies below the lines that are predicted, across them, px.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub bias_px: Option<f64>,
    /// How far apart the overlays are that two halves of the paint would give, px.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub halves_px: Option<f64>,
    /// The share of the paint on the playing area that no predicted line explains.
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    pub unexplained: Option<f64>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

/// What a relocalization took, ms.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TimingsMs {
    /// Finding the features, without reading the picture.
    #[serde(default, serialize_with = "finite")]
    pub features: f64,
    /// Asking the forest.
    #[serde(default, serialize_with = "finite")]
    pub predict: f64,
    /// Finding the pose.
    #[serde(default, serialize_with = "finite")]
    pub pose: f64,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

/// What a frame was solved from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SolutionSource {
    /// A person's clicks.
    Clicks,
    /// Points of another program's model alone.
    Points,
    /// The pan-tilt forest.
    Forest,
    /// A neighbouring frame's motion.
    Tracking,
    /// The painted markings.
    Markings,
    /// A foreign file.
    Import,
    /// Numbers that a person set by hand.
    Manual,
    /// The solved frames before and after it.
    Interpolated,
}

/// Something about a solution that a person should know.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SolutionWarning {
    /// `separation`, `swapped`, `mirrored`, `wrong_line`, `two_roots`, …; the list may grow.
    pub code: String,
    /// One line: what, the number, the way out.
    pub message: String,
    /// Indices of the clicks it is about.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clicks: Vec<usize>,
    /// Names that fit better: all of them together mend what the warning is about.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub renames: Vec<BetterName>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

impl Solution {
    /// The warnings about this frame itself: all but the one that its field's size is assumed.
    pub fn warnings_of_frame(&self) -> impl Iterator<Item = &SolutionWarning> {
        self.warnings
            .iter()
            .filter(|warning| warning.code != WarningCode::FieldAssumed.as_str())
    }
}

impl SolutionWarning {
    /// A warning about the frame as a whole.
    pub fn new(code: &str, message: String) -> Self {
        Self {
            code: code.to_owned(),
            message,
            clicks: Vec::new(),
            renames: Vec::new(),
            extra: Extra::new(),
        }
    }
}

/// A name that fits a click better than its own.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BetterName {
    /// Which click, from 0.
    pub click: usize,
    /// What it seems to show.
    #[serde(flatten)]
    pub target: Target,
}

impl BetterName {
    /// Every name that a finding would change.
    pub fn all(found: &IdentityFinding) -> impl Iterator<Item = Self> + '_ {
        found.renames.iter().map(|rename| Self {
            click: rename.click,
            target: Target::from(&rename.name),
        })
    }
}

impl From<&Name> for Target {
    fn from(name: &Name) -> Self {
        match name {
            Name::Landmark(id) => Self::Landmark(id.clone()),
            Name::Line(id) => Self::Line(id.clone()),
        }
    }
}
