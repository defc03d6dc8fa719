//! Whether a forest and a document mean the same cameras.

use thiserror::Error;
use touchline_core::camera::CameraBase;
use touchline_documents::document::{Camera, Document};
use touchline_vision::relocalize::ForestModel;

/// How far numbers of a base may differ, m and px: digits that were rounded when a document was
/// written.
const SAME_BASE: f64 = 1e-6;

/// Why a forest does not serve a document.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum BaseMismatch {
    /// The forest's own document lacks it.
    #[error("the forest does not hold the base of its camera {camera}")]
    Unknown {
        /// The camera's name.
        camera: String,
    },
    /// The camera stands, looks or distorts otherwise by now.
    #[error(
        "camera {camera}: its position, rotation, principal point or lens is not the one that the forest was trained with; \
         train the forest again"
    )]
    Differs {
        /// The camera's name.
        camera: String,
    },
}

/// Cameras of the document without a base take over the forest's, which `of_forest` holds.
///
/// # Errors
/// A camera has another base: the forest is useless then.
pub fn adopt_bases(
    document: &mut Document,
    of_forest: &Document,
    model: &ForestModel,
) -> Result<(), BaseMismatch> {
    for forest in &model.cameras {
        let name = || forest.camera.clone();
        let id = forest.camera.as_str().into();
        let known = of_forest.camera(&id).and_then(Camera::base);
        let known = known.ok_or_else(|| BaseMismatch::Unknown { camera: name() })?;
        let Some(camera) = document.camera_mut(&id) else {
            continue;
        };
        match camera.base() {
            None => camera.set_base(&known),
            Some(base) if differs(&base, &known) => {
                return Err(BaseMismatch::Differs { camera: name() });
            }
            Some(_) => {}
        }
    }
    Ok(())
}

fn differs(one: &CameraBase, other: &CameraBase) -> bool {
    let lens = |base: &CameraBase, focal_px: f64| base.distortion.at(focal_px);
    (one.position_m - other.position_m).amax() > SAME_BASE
        || (one.base_from_world - other.base_from_world).amax() > SAME_BASE
        || one.principal_point.distance_px(other.principal_point) > SAME_BASE
        || [1000.0, 5000.0]
            .iter()
            .any(|&focal_px| (lens(one, focal_px) - lens(other, focal_px)).abs() > SAME_BASE)
}
