//! What a camera's base leaves open of its field's length or width, as documents state it.

use super::adapters::finite;
use crate::document::Extra;
use serde::{Deserialize, Serialize};
use touchline_core::camera::{SHARED_PARAMETERS, SharedError, SizeError};

/// The error of one dimension of the field, and what goes with it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SizeSigma {
    /// 1-σ of the dimension, m.
    #[serde(serialize_with = "finite")]
    pub sigma_m: f64,
    /// Lines up to this distance from the middle stay where they are, m.
    #[serde(default, serialize_with = "finite")]
    pub still_m: f64,
    /// Lines from this distance on go with the end, half a metre for each metre, m.
    #[serde(default, serialize_with = "finite")]
    pub end_m: f64,
    /// How the base changes per metre of the dimension: position x, y, z (m), rotation about x, y
    /// (rad), k₁, its slope per 1000 px, crown (m), principal point x, y (px). Further numbers mean
    /// nothing, missing ones are zero.
    #[serde(default, serialize_with = "finite")]
    pub base_by_m: Vec<f64>,
    /// Unknown keys.
    #[serde(flatten)]
    pub extra: Extra,
}

impl SizeSigma {
    /// As the document states an error; none where the dimension is known.
    pub fn new(error: &SizeError) -> Option<Self> {
        (error.sigma_m > 0.0).then(|| Self {
            sigma_m: error.sigma_m,
            still_m: error.still_m,
            end_m: error.end_m,
            base_by_m: error.base_by_m.iter().copied().collect(),
            extra: Extra::new(),
        })
    }
}

impl From<&SizeSigma> for SizeError {
    fn from(stated: &SizeSigma) -> Self {
        let numbers = stated.base_by_m.iter().take(SHARED_PARAMETERS);
        let mut base_by_m = SharedError::zeros();
        for (by_m, stated) in base_by_m.iter_mut().zip(numbers) {
            *by_m = *stated;
        }
        Self {
            sigma_m: stated.sigma_m,
            still_m: stated.still_m,
            end_m: stated.end_m,
            base_by_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Camera, FieldSize, FieldSpec};
    use crate::testing::soccer_document;
    use touchline_core::camera::{BaseSigma, CameraBase};
    use touchline_core::testing::{SIZE, base_at};

    fn open_length() -> SizeError {
        let mut error = SizeError {
            still_m: 9.15,
            end_m: 32.35,
            ..SizeError::alone(7.5)
        };
        (error.base_by_m[0], error.base_by_m[3]) = (0.5, 0.001);
        error
    }

    fn camera_of_open_length(name: &str) -> Camera {
        let mut camera = Camera::new(name.into(), SIZE);
        camera.set_base(&CameraBase {
            sigma: BaseSigma {
                size: [open_length(), SizeError::default()],
                ..BaseSigma::default()
            },
            ..base_at([0.0, -60.0, 18.0], SIZE)
        });
        camera
    }

    #[test]
    fn what_is_open_of_a_length_is_written_and_read_again() {
        let camera = camera_of_open_length("main");
        let text = serde_json::to_string(&camera).unwrap();
        assert!(
            text.contains(r#""length":{"sigma_m":7.5,"still_m":9.15,"#),
            "{text}"
        );
        assert!(!text.contains(r#""width":"#), "a known width has no key");
        let read: Camera = serde_json::from_str(&text).unwrap();
        assert_eq!(read.base().unwrap().sigma.size[0], open_length());
        // Fewer numbers than parameters are those of the first.
        let short: SizeSigma = serde_json::from_str(r#"{"sigma_m":2,"base_by_m":[0.5]}"#).unwrap();
        assert_eq!(SizeError::from(&short).base_by_m[0], 0.5);
        assert!(serde_json::from_str::<SizeSigma>(r#"{"still_m":9.15}"#).is_err());
    }

    #[test]
    fn a_size_that_a_person_states_is_open_no_more() {
        let mut document = soccer_document();
        document.cameras.push(camera_of_open_length("main").into());
        document.cameras.push(camera_of_open_length("other").into());
        document.cameras[1].field = Some(FieldSpec::new("soccer"));
        let is_open = |document: &crate::document::Document| {
            [0, 1].map(|index| document.cameras[index].states_open_size())
        };
        let mut same = document.field.clone();
        same.extra.insert("note".to_owned(), "x".into());
        document.state_field(None, same);
        assert_eq!(
            is_open(&document),
            [true, true],
            "nothing was said of the size"
        );

        let confirmed = FieldSpec {
            size: Some(FieldSize::Confirmed),
            ..document.field.clone()
        };
        document.state_field(Some(&"main".into()), confirmed.clone());
        assert_eq!(is_open(&document), [false, true]);
        assert_eq!(document.field, confirmed);
        document.state_field(Some(&"other".into()), confirmed);
        assert_eq!(is_open(&document), [false, false]);
    }
}
