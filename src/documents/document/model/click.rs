//! A click: a point of the picture and its name.

use super::adapters::{self, finite};
use crate::document::{ClickOrigin, Extra};
use serde::{Deserialize, Serialize};
use touchline_core::field::{FieldElement, FieldModel, LandmarkId, LineId};
use touchline_core::geometry::ImagePoint;

/// What of the field a click shows.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// A landmark: the click is its image.
    Landmark(
        #[cfg_attr(feature = "schema", schemars(with = "String"))]
        #[serde(with = "adapters::name")]
        LandmarkId,
    ),
    /// A line, circle or arc: the click lies somewhere on its image.
    Line(
        #[cfg_attr(feature = "schema", schemars(with = "String"))]
        #[serde(with = "adapters::name")]
        LineId,
    ),
}

impl Target {
    /// The name, of either kind.
    pub fn as_str(&self) -> &str {
        match self {
            Self::Landmark(id) => id.as_str(),
            Self::Line(id) => id.as_str(),
        }
    }

    /// The number of equations of a click on it.
    pub const fn equations(&self) -> usize {
        match self {
            Self::Landmark(_) => 2,
            Self::Line(_) => 1,
        }
    }

    /// The line, if it is one.
    pub const fn line(&self) -> Option<&LineId> {
        match self {
            Self::Landmark(_) => None,
            Self::Line(id) => Some(id),
        }
    }

    /// The landmark or line of a field that it names; none if the field lacks it.
    pub fn element(&self, field: &FieldModel) -> Option<FieldElement> {
        match self {
            Self::Landmark(id) => field.landmark_element(id.as_str()),
            Self::Line(id) => field.line_element(id.as_str()),
        }
    }
}

/// A click in a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(try_from = "ClickJson", into = "ClickJson")]
pub struct Click {
    /// What it shows; none while it has no name. A project may contain such a click, a dataset
    /// never does.
    pub target: Option<Target>,
    /// Where it is, px.
    pub image: ImagePoint,
    /// Held out of the solve; only its error is reported.
    pub check: bool,
    /// The program moved it to the painted corner, crossing or spot that it names: 1-σ of that
    /// place in each direction, px. None where it lies where a person placed it.
    pub snapped_sigma_px: Option<f64>,
    /// Who placed it, if no person did.
    pub origin: Option<Box<ClickOrigin>>,
    /// Unknown keys.
    pub extra: Extra,
}

impl Click {
    /// A click on something.
    pub fn new(target: Target, image: ImagePoint) -> Self {
        Self {
            target: Some(target),
            ..Self::without_name(image)
        }
    }

    /// A click on a landmark.
    pub fn landmark(id: LandmarkId, image: ImagePoint) -> Self {
        Self::new(Target::Landmark(id), image)
    }

    /// A click on a line.
    pub fn line(id: LineId, image: ImagePoint) -> Self {
        Self::new(Target::Line(id), image)
    }

    /// Whether it is on a line, circle or arc.
    pub const fn is_on_line(&self) -> bool {
        matches!(self.target, Some(Target::Line(_)))
    }

    /// Whether it is a model's point as the model gave it. A point that a person moved or renamed
    /// is the person's.
    pub fn is_by_model(&self) -> bool {
        self.model_origin().is_some()
    }

    /// The origin of a model's point that no person moved or renamed.
    pub fn model_origin(&self) -> Option<&ClickOrigin> {
        self.origin
            .as_deref()
            .filter(|origin| origin.given.is_none())
    }

    /// 1-σ of its place in each direction, px, where that is known better than for a person's
    /// click: it was aligned to paint, or a model states it.
    pub fn own_sigma_px(&self) -> Option<f64> {
        self.snapped_sigma_px
            .or_else(|| self.model_origin()?.sigma_px)
    }

    /// Makes a model's point a person's before a person moves or renames it: it keeps where the
    /// model had it.
    pub fn take_over(&mut self) {
        if let Some(origin) = &mut self.origin {
            origin.given.get_or_insert(self.image);
        }
    }

    /// A click without a name.
    pub fn without_name(image: ImagePoint) -> Self {
        Self {
            target: None,
            image,
            check: false,
            snapped_sigma_px: None,
            origin: None,
            extra: Extra::new(),
        }
    }
}

// A click as JSON has it: two keys for its name, of which at most one may be present. In the
// program `Target` excludes that both are.
#[derive(Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct ClickJson {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    landmark: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    line: Option<String>,
    #[cfg_attr(feature = "schema", schemars(with = "[f64; 2]"))]
    #[serde(serialize_with = "finite")]
    image_px: ImagePoint,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    check: bool,
    #[serde(serialize_with = "finite", skip_serializing_if = "Option::is_none")]
    snapped_sigma_px: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    origin: Option<Box<ClickOrigin>>,
    #[serde(flatten)]
    extra: Extra,
}

impl TryFrom<ClickJson> for Click {
    type Error = String;

    fn try_from(json: ClickJson) -> Result<Self, String> {
        let target = match (json.landmark, json.line) {
            (Some(landmark), Some(line)) => {
                return Err(format!(
                    "a click names both the landmark {landmark:?} and the line {line:?}"
                ));
            }
            (Some(landmark), None) => Some(Target::Landmark(landmark.as_str().into())),
            (None, Some(line)) => Some(Target::Line(line.as_str().into())),
            (None, None) => None,
        };
        if let Some(sigma_px) = json.snapped_sigma_px.filter(|sigma_px| !(*sigma_px > 0.0)) {
            return Err(format!(
                "the snapped_sigma_px of a click is {sigma_px}, not positive"
            ));
        }
        let ClickJson {
            image_px: image,
            check,
            snapped_sigma_px,
            origin,
            extra,
            ..
        } = json;
        Ok(Self {
            target,
            image,
            check,
            snapped_sigma_px,
            origin,
            extra,
        })
    }
}

impl From<Click> for ClickJson {
    fn from(click: Click) -> Self {
        let (landmark, line) = match click.target {
            Some(Target::Landmark(id)) => (Some(id.as_str().to_owned()), None),
            Some(Target::Line(id)) => (None, Some(id.as_str().to_owned())),
            None => (None, None),
        };
        let Click {
            image: image_px,
            check,
            snapped_sigma_px,
            origin,
            extra,
            ..
        } = click;
        Self {
            landmark,
            line,
            image_px,
            check,
            snapped_sigma_px,
            origin,
            extra,
        }
    }
}
