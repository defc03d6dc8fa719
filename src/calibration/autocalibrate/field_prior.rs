//! The prior on the field: its size, or the sizes that the rules allow.

use crate::calibrate::{AutocalibratedCamera, OpenSize};
use touchline_core::camera::{CameraBase, Ptz};
use touchline_core::field::{FieldError, FieldModel};
use touchline_core::geometry::ImageSize;
use touchline_core::solve::base::{
    AdjustOptions, BaseModel, BasePriors, FittedSize, FrameClicks, SizeParam, SizeStart,
};
use touchline_documents::document::{CROWN, CameraId, DocumentAt};

/// 1-σ of usual sizes as a share of the prior's: 2.5 m for the length of a soccer pitch, 3.75 m for
/// its width. Without a click a line can be taken for another one, so that unusual sizes have to be
/// stated.
const USUAL_SHARE: f64 = 1.0 / 3.0;

/// Lengths within this distance of the assumed one are usual, in 1-σ of usual sizes: a soccer pitch
/// of 97.5 to 112.5 m by 57 to 79 m. A size that is not stated is searched among these alone. On a
/// drawn clip whose far touchline is thinner than a pixel, the foot of the boards 10 m behind it
/// was taken for the touchline while all sizes that the rules allow were searched: 88.8 ± 0.3 m.
const USUAL_SIGMAS: f64 = 3.0;

/// A length this near to a limit of what is usual was stopped by it, in 1-σ of usual sizes: 0.3 m
/// for the length of a soccer pitch.
const AT_LIMIT_SIGMAS: f64 = 0.12;

/// The search starts from the assumed size and from sizes that differ from it by this share of the
/// range that is usual. A fit of the size converges from half that far.
const LEVEL_SHARE: f64 = 0.25;

/// Step between neighbouring sizes, in 1-σ of usual sizes: 2.5 m for the length of a soccer pitch.
const STEP_SIGMAS: f64 = 1.0;

/// A length of a field that the rules leave open, m.
pub(super) struct OpenLength {
    /// Its name in documents.
    pub name: String,
    pub value_m: f64,
    /// Mean and 1-σ of usual sizes, m.
    pub assumed_m: f64,
    pub sigma_m: f64,
}

impl OpenLength {
    /// Whether it reaches or exceeds the limit of what is usual.
    pub fn is_unusual(&self) -> bool {
        (self.value_m - self.assumed_m).abs() > (USUAL_SIGMAS - AT_LIMIT_SIGMAS) * self.sigma_m
    }
}

/// The field that a camera is searched on, and how its size may differ.
pub(super) struct FieldPrior {
    /// The field of the document, with the usual crown if the document states none.
    pub assumed: FieldModel,
    /// None if the rules fix the size.
    open: Option<OpenSize>,
    /// Whether the document states the size; another one is then fitted only to test it.
    pub is_known: bool,
}

impl FieldPrior {
    /// The field of a document's camera. Its size is open where the document only assumes it.
    pub fn from_document(document: DocumentAt<'_>, camera: &CameraId) -> Result<Self, FieldError> {
        let spec = document.field_of_camera(camera);
        let mut assumed = document.model_of(spec)?;
        // The height above the ground determines how far away a low camera sees a line. Grass
        // pitches are crowned, so start with the usual crown.
        if assumed.may_be_crowned() && !spec.params.contains_key(CROWN) {
            assumed.crown_m = BasePriors::default().crown_m.0;
        }
        let is_known = spec.is_size_stated();
        let mut open = OpenSize::of(document, spec, &assumed)?;
        for param in &mut open.params {
            param.sigma_m *= USUAL_SHARE;
            if !is_known {
                let reach_m = USUAL_SIGMAS * param.sigma_m;
                param.min_m = param.min_m.max(param.assumed_m - reach_m);
                param.max_m = param.max_m.min(param.assumed_m + reach_m);
            }
        }
        Ok(Self {
            assumed,
            open: Some(open).filter(|open| !open.params.is_empty()),
            is_known,
        })
    }

    /// The assumed size first, then, if the size is unknown, the corners of a box around it.
    pub fn search_fields(&self) -> Vec<FieldModel> {
        let mut levels = vec![self.assumed.clone()];
        if let Some(open) = self.open.as_ref().filter(|_| !self.is_known) {
            // Bit i of `corner` chooses between a smaller and a larger value of length i.
            let corners = (0..1_usize << open.params.len()).filter_map(|corner| {
                let value = |(index, param): (usize, &SizeParam)| {
                    let sign = if corner >> index & 1 == 0 { -1.0 } else { 1.0 };
                    param.assumed_m + sign * LEVEL_SHARE * (param.max_m - param.min_m)
                };
                open.field_with_lengths(
                    &open
                        .params
                        .iter()
                        .enumerate()
                        .map(value)
                        .collect::<Vec<_>>(),
                )
            });
            levels.extend(corners);
        }
        levels
    }

    /// Fields that are one step longer, shorter, wider or narrower than a field, within the limits.
    /// They keep its crown.
    pub fn neighbouring_sizes(&self, field: &FieldModel) -> Vec<FieldModel> {
        let Some(open) = &self.open else {
            return Vec::new();
        };
        let params = open.params_of(field);
        let here: Vec<f64> = params.iter().map(|param| param.assumed_m).collect();
        let steps =
            (0..here.len()).flat_map(|param| [-STEP_SIGMAS, STEP_SIGMAS].map(|by| (param, by)));
        let moved = steps.filter_map(|(param, by)| {
            let mut moved = here.clone();
            moved[param] += by * params[param].sigma_m;
            let allowed = params[param].min_m..=params[param].max_m;
            allowed
                .contains(&moved[param])
                .then(|| open.resize(field, &moved))
                .flatten()
        });
        moved.collect()
    }

    /// Gives a camera's field the assumed value of each length that its frames do not show, as it is
    /// recorded, and moves the camera with what they show. Whether there are any: pan, tilt and focal
    /// length of its frames are then still those of the other base.
    pub fn assume_open_lengths(&self, camera: &mut AutocalibratedCamera) -> bool {
        let stated = |size: &FittedSize| {
            if size.is_open {
                size.assumed_m
            } else {
                size.value_m
            }
        };
        let values: Vec<f64> = camera.sizes.iter().map(stated).collect();
        let has_open = camera.sizes.iter().any(|size| size.is_open);
        let open = self.open.as_ref().filter(|_| has_open);
        let Some(field) = open.and_then(|open| open.resize(&camera.field, &values)) else {
            return false;
        };
        camera.field = field;
        for size in camera.sizes.iter_mut().filter(|size| size.is_open) {
            camera.base.position_m += size.position_shift_m(size.assumed_m);
            size.value_m = size.assumed_m;
        }
        true
    }

    /// The open lengths, with the values that `field` has.
    pub fn open_lengths(&self, field: &FieldModel) -> Vec<OpenLength> {
        let Some(open) = &self.open else {
            return Vec::new();
        };
        let of = |(here, param): (SizeParam, &SizeParam)| OpenLength {
            name: here.name,
            value_m: here.assumed_m,
            assumed_m: param.assumed_m,
            sigma_m: param.sigma_m,
        };
        open.params_of(field)
            .into_iter()
            .zip(&open.params)
            .map(of)
            .collect()
    }

    /// The first length of a field that reaches the limit of what is usual, where the document
    /// states no size.
    pub fn unusual_length(&self, field: &FieldModel) -> Option<OpenLength> {
        let lengths = self.is_size_unknown().then(|| self.open_lengths(field));
        lengths?.into_iter().find(OpenLength::is_unusual)
    }

    /// The field with these lengths, in their order, clamped to what the rules allow; none if the
    /// template has no field of that size.
    pub fn with_lengths(&self, values_m: &[f64]) -> Option<FieldModel> {
        self.open.as_ref()?.field_with_lengths(values_m)
    }

    /// Whether the rules allow other sizes.
    pub const fn allows_other_sizes(&self) -> bool {
        self.open.is_some()
    }

    /// Whether the rules allow other sizes and the document does not state one.
    pub const fn is_size_unknown(&self) -> bool {
        self.allows_other_sizes() && !self.is_known
    }

    /// Fits the size of the field to paint, starting from a base and frames that were adjusted at
    /// another size. Returns the field of the fitted size, with its crown unchanged, and the fitted
    /// lengths.
    pub fn fit_size(
        &self,
        field: &FieldModel,
        taken: &[FrameClicks],
        base: &CameraBase,
        ptz: &[Option<Ptz>],
        model: &BaseModel,
        (image_size, options): (ImageSize, &AdjustOptions),
    ) -> Option<(FieldModel, Vec<FittedSize>)> {
        let open = self.open.as_ref()?;
        let start = SizeStart {
            field,
            frames: taken,
            base,
            ptz,
            model,
            image_size,
            options,
        };
        let sizes = open.fit(&start);
        let values_m: Vec<f64> = sizes.iter().map(|size| size.value_m).collect();
        let field = open
            .resize(field, &values_m)
            .filter(|_| !sizes.is_empty())?;
        Some((field, sizes))
    }
}
