//! The JSON schema of a template, before its contents are checked.

use super::Expression;
use serde::de::{self, Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;

/// The format name in every template file.
pub const FORMAT: &str = "touchline-field";
/// The newest version of the format.
pub const VERSION: u64 = 1;

/// The part of a file that determines whether the rest can be read.
#[derive(serde::Deserialize)]
#[serde(expecting = "a field template, which is a JSON object")]
pub struct Header {
    pub format: Option<String>,
    pub version: Option<u64>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TemplateFile {
    #[serde(rename = "format")]
    _format: String,
    #[serde(rename = "version")]
    _version: u64,
    pub name: String,
    pub title: String,
    #[serde(default)]
    pub notes: Vec<String>,
    pub params: Ordered<ParamFile>,
    #[serde(default)]
    pub dimensions: Ordered<DimensionFile>,
    pub extent_m: [Formula; 2],
    #[serde(default)]
    pub symmetry: Vec<String>,
    #[serde(default = "default_click_sigma_px")]
    pub click_sigma_px: f64,
    pub landmarks: Vec<LandmarkFile>,
    pub lines: Vec<LineFile>,
}

/// The default click noise: 2 px at 1920 px width.
fn default_click_sigma_px() -> f64 {
    2.0
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParamFile {
    pub label: String,
    pub unit: String,
    pub default: Formula,
    pub min: Formula,
    pub max: Formula,
    #[serde(default = "varies")]
    pub varies: bool,
    pub source: String,
}

const fn varies() -> bool {
    true
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DimensionFile {
    pub value: Formula,
    pub source: String,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LandmarkFile {
    pub id: String,
    pub label: String,
    pub code: String,
    pub at: Vec<Formula>,
    pub click_sigma_px: Option<f64>,
    pub spot_diameter_m: Option<Formula>,
    #[serde(default)]
    pub unmarked: bool,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LineFile {
    pub id: String,
    pub label: String,
    pub code: String,
    pub from: Option<PointFile>,
    pub through: Option<PointFile>,
    pub to: Option<PointFile>,
    pub centre: Option<PointFile>,
    pub radius_m: Option<Formula>,
    pub width_m: Formula,
    pub edge: Option<String>,
    pub inside: Option<PointFile>,
    pub painted: Option<bool>,
    pub dash_m: Option<[Formula; 2]>,
}

/// A number, or an expression in a string. Its text is kept and parsed later, where an error can
/// name its place.
#[derive(Clone)]
pub enum Formula {
    Number(f64),
    Text(String),
}

impl Formula {
    /// The expression, or what is wrong with the text.
    pub fn expression(&self) -> Result<Expression, super::ExpressionError> {
        match self {
            Self::Number(value) => Ok(Expression::number(*value)),
            Self::Text(text) => Expression::parse(text),
        }
    }

    /// As written.
    pub fn text(&self) -> String {
        match self {
            Self::Number(value) => value.to_string(),
            Self::Text(text) => text.clone(),
        }
    }
}

/// A landmark's name, or two or three coordinates.
pub enum PointFile {
    Landmark(String),
    Coordinates(Vec<Formula>),
}

/// A JSON object in the order of the file, every key once.
pub struct Ordered<T>(pub Vec<(String, T)>);

impl<T> Default for Ordered<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Ordered<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OrderedVisitor<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for OrderedVisitor<T> {
            type Value = Ordered<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object of named entries")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                // A map type would take the last of two equal keys without a word.
                let mut entries: Vec<(String, T)> = Vec::new();
                while let Some(key) = map.next_key::<String>()? {
                    if entries.iter().any(|(known, _)| *known == key) {
                        return Err(de::Error::custom(format!("{key:?} is given twice")));
                    }
                    entries.push((key, map.next_value()?));
                }
                Ok(Ordered(entries))
            }
        }
        deserializer.deserialize_map(OrderedVisitor(PhantomData))
    }
}

/// By hand: an untagged enum would say neither what was found nor what was expected.
impl<'de> Deserialize<'de> for Formula {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct FormulaVisitor;
        impl Visitor<'_> for FormulaVisitor {
            type Value = Formula;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or an expression in quotes")
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Formula, E> {
                Ok(Formula::Number(value))
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Formula, E> {
                Ok(Formula::Number(value as f64))
            }

            fn visit_u64<E: de::Error>(self, value: u64) -> Result<Formula, E> {
                Ok(Formula::Number(value as f64))
            }

            fn visit_str<E: de::Error>(self, text: &str) -> Result<Formula, E> {
                Ok(Formula::Text(text.to_owned()))
            }
        }
        deserializer.deserialize_any(FormulaVisitor)
    }
}

impl<'de> Deserialize<'de> for PointFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct PointVisitor;
        impl<'de> Visitor<'de> for PointVisitor {
            type Value = PointFile;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a landmark's name or its coordinates [x, y] or [x, y, z]")
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<PointFile, E> {
                Ok(PointFile::Landmark(name.to_owned()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<PointFile, A::Error> {
                let mut coordinates = Vec::new();
                while let Some(coordinate) = seq.next_element()? {
                    coordinates.push(coordinate);
                }
                Ok(PointFile::Coordinates(coordinates))
            }
        }
        deserializer.deserialize_any(PointVisitor)
    }
}
