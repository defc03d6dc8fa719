//! The document as a whole.

use super::{Camera, CameraId, Extra, FieldSize, Frame, Frames, Shared, Shot, StoredClickNoise, adapters};
use crate::camera::PtzCamera;
use crate::field::{FieldError, FieldModel, Template, template_named};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::Path;

/// The value of `format` in every document of this program.
pub const FORMAT_NAME: &str = "touchline";
/// The newest `version` that this program reads, and the one it writes.
pub const DOCUMENT_VERSION: u64 = 1;

/// The parameter that every template takes: how much the middle is higher than the touchlines, m.
const CROWN: &str = "crown_m";

/// The value of `generator` in documents that this program writes.
#[must_use]
pub fn generator() -> String {
    format!("touchline {}", env!("CARGO_PKG_VERSION"))
}

/// A project or dataset: a field, cameras, frames.
///
/// Cloning is cheap: cameras and frames are shared until one is written to, so undo keeps whole documents.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// Who wrote the file that was read; the program writes its own name.
    pub generator: String,
    /// The conventions in words, for people.
    pub conventions: Map<String, Value>,
    /// The field, unless a camera has its own.
    pub field: FieldSpec,
    /// The cameras.
    pub cameras: Vec<Shared<Camera>>,
    /// The frames, in the order in which a person steps through them.
    pub frames: Frames,
    /// What its clicks scatter by.
    pub click_noise: Option<StoredClickNoise>,
    /// The shots of its videos, where somebody or the program marked them.
    pub shots: Vec<Shot>,
    /// Unknown keys.
    pub extra: Extra,
}

/// Which field: a template and its parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldSpec {
    /// The template's name: `soccer`.
    pub template: String,
    /// Its parameters by name, such as `length_m` and `crown_m`; absent ones take the template's defaults.
    #[serde(default, with = "adapters::numbers_by_name")]
    pub params: BTreeMap<String, f64>,
    /// Where its size comes from: `assumed` (also where it is absent), `confirmed`, `fitted`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<FieldSize>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

impl FieldSpec {
    /// A template with its defaults.
    #[must_use]
    pub fn new(template: &str) -> Self {
        Self { template: template.to_owned(), params: BTreeMap::new(), size: None, extra: Extra::new() }
    }

    /// The template is a file of the user's own, not a built-in one.
    #[must_use]
    pub fn is_file(&self) -> bool {
        Path::new(&self.template).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
    }

    /// How much the middle is higher than the touchlines, m.
    #[must_use]
    pub fn crown_m(&self) -> f64 {
        self.params.get(CROWN).copied().unwrap_or(0.0)
    }

    /// Sets the crown; a flat field without the key stays without it.
    pub fn set_crown_m(&mut self, crown_m: f64) {
        if crown_m != self.crown_m() {
            self.params.insert(CROWN.to_owned(), crown_m);
        }
    }

    /// The field with its parameters filled in; `folder` is the document's, for a template of the user's own.
    ///
    /// # Errors
    /// There is no such template, or it does not take a parameter or its value.
    pub fn model(&self, folder: &Path) -> Result<FieldModel, FieldError> {
        let mut params = self.params.clone();
        let crown_m = params.remove(CROWN).unwrap_or(0.0);
        self.template(folder)?.model(&params, crown_m)
    }

    /// Its template; `folder` is the document's.
    ///
    /// # Errors
    /// There is no such template.
    pub fn template(&self, folder: &Path) -> Result<Template, FieldError> {
        template_named(&self.template, folder)
    }
}

impl Document {
    /// An empty document on a field.
    #[must_use]
    pub fn new(field: FieldSpec) -> Self {
        Self {
            generator: generator(),
            conventions: conventions(),
            field,
            cameras: Vec::new(),
            frames: Frames::new(),
            click_noise: None,
            shots: Vec::new(),
            extra: Extra::new(),
        }
    }

    /// Whether two differ in their frames at most.
    pub(crate) fn same_beside_frames(&self, other: &Self) -> bool {
        *self == Self { generator: self.generator.clone(), frames: self.frames.clone(), ..other.clone() }
    }

    /// A camera by name.
    #[must_use]
    pub fn camera(&self, id: &CameraId) -> Option<&Camera> {
        self.cameras.iter().find(|camera| camera.id == *id).map(|camera| &**camera)
    }

    /// A camera by name, to change it.
    pub fn camera_mut(&mut self, id: &CameraId) -> Option<&mut Camera> {
        self.cameras.iter_mut().find(|camera| camera.id == *id).map(|camera| &mut **camera)
    }

    /// The camera that took a frame.
    #[must_use]
    pub fn camera_of(&self, frame: &Frame) -> Option<&Camera> {
        self.camera(&frame.camera)
    }

    /// The field that a frame shows: its camera's own, else the document's.
    #[must_use]
    pub fn field_of(&self, frame: &Frame) -> &FieldSpec {
        self.camera_of(frame).and_then(|camera| camera.field.as_ref()).unwrap_or(&self.field)
    }

    /// The camera as a solved frame has it pointed.
    #[must_use]
    pub fn pointed(&self, frame: &Frame) -> Option<PtzCamera> {
        self.camera_of(frame)?.pointed(frame)
    }

    /// The document as a dataset: the same without unnamed clicks (indices of clicks follow), and with a warning
    /// at every solved frame whose field's size is assumed.
    #[must_use]
    pub fn to_dataset(&self) -> Self {
        let mut dataset = self.clone();
        for frame in &mut dataset.frames {
            if frame.clicks.iter().any(|click| click.target.is_none()) {
                frame.drop_unnamed_clicks();
            }
        }
        dataset.tell_assumed_sizes();
        dataset
    }
}

impl Frame {
    /// Drops the unnamed clicks; the solution's indices of clicks follow.
    fn drop_unnamed_clicks(&mut self) {
        let mut kept = 0;
        let new_index: Vec<Option<usize>> = self
            .clicks
            .iter()
            .map(|click| {
                click.target.as_ref()?;
                kept += 1;
                Some(kept - 1)
            })
            .collect();
        self.clicks.retain(|click| click.target.is_some());
        let renumber = |indices: &mut Vec<usize>| {
            *indices = indices.iter().filter_map(|&index| new_index.get(index).copied().flatten()).collect();
        };
        if let Some(solution) = &mut self.solution {
            renumber(&mut solution.disputed);
            for warning in &mut solution.warnings {
                renumber(&mut warning.clicks);
                warning.renames.retain_mut(|rename| {
                    let kept = new_index.get(rename.click).copied().flatten();
                    rename.click = kept.unwrap_or(rename.click);
                    kept.is_some()
                });
            }
        }
    }
}

/// The conventions as every document states them.
pub(super) fn conventions() -> Map<String, Value> {
    [
        (
            "world",
            "origin field centre; x right along the length seen from the main camera; y away from it; z up; metres",
        ),
        ("image", "(0,0) is the top-left corner of the image; x right, y down; pixel centres at +0.5"),
        ("rotation", "cam_from_world = Q_tilt(tilt) Q_pan(pan) base_from_world; x right, y down, z forward"),
        ("angles", "degrees; pan positive right, tilt positive up"),
    ]
    .into_iter()
    .map(|(key, text)| (key.to_owned(), Value::from(text)))
    .collect()
}
