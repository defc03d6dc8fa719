//! Checks that a forest and a document have the same camera bases.

use thiserror::Error;
use touchline_core::camera::CameraBase;
use touchline_documents::document::{Camera, Document};
use touchline_vision::relocalize::ForestModel;

/// Tolerance between two bases, m, px and as matrix entries, for the digits that are rounded when a
/// document is written.
const SAME_BASE: f64 = 1e-6;

/// Why a forest cannot be used with a document.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum BaseMismatch {
    /// The forest's own document lacks the base of its camera.
    #[error("the forest does not hold the base of its camera {camera}")]
    Unknown {
        /// The camera's name.
        camera: String,
    },
    /// The document's camera has another base.
    #[error(
        "camera {camera}: its position, rotation, principal point or lens is not the one that the forest was trained with; \
         train the forest again"
    )]
    Differs {
        /// The camera's name.
        camera: String,
    },
}

/// Gives cameras of the document that have no base that of the forest. `of_forest` is the document
/// stored in the forest.
///
/// # Errors
/// A camera has another base, with which the rays of the forest are wrong.
pub fn adopt_bases(
    document: &mut Document,
    of_forest: &Document,
    model: &ForestModel,
) -> Result<(), BaseMismatch> {
    for forest in &model.cameras {
        let id = forest.camera.as_str().into();
        let known = of_forest.camera(&id).and_then(Camera::base);
        let known = known.ok_or_else(|| BaseMismatch::Unknown {
            camera: forest.camera.clone(),
        })?;
        // A forest may have been trained on more cameras than this document has.
        let Some(camera) = document.camera_mut(&id) else {
            continue;
        };
        match camera.base() {
            None => camera.set_base(&known),
            Some(base) if differs(&base, &known) => {
                return Err(BaseMismatch::Differs {
                    camera: forest.camera.clone(),
                });
            }
            Some(_) => {}
        }
    }
    Ok(())
}

fn differs(one: &CameraBase, other: &CameraBase) -> bool {
    // Lenses are compared by their effect at two focal lengths, because they are functions of the
    // focal length.
    (one.position_m - other.position_m).amax() > SAME_BASE
        || (one.base_from_world - other.base_from_world).amax() > SAME_BASE
        || one.principal_point.distance_px(other.principal_point) > SAME_BASE
        || (one.distortion.pixel_aspect - other.distortion.pixel_aspect).abs() > SAME_BASE
        || [1000.0, 5000.0].iter().any(|&focal_px| {
            let apart = one.distortion.at(focal_px) - other.distortion.at(focal_px);
            apart.abs() > SAME_BASE
        })
}
