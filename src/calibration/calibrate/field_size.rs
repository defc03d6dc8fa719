//! Writes a fitted field size into a document.

use touchline_core::solve::base::FittedSize;
use touchline_documents::document::{CameraId, Document, FieldSize, FieldSpec};

/// Writes a fitted size into the field of a camera. With several cameras, each gets a field of its
/// own.
pub(crate) fn set_field_size(document: &mut Document, camera: &CameraId, sizes: &[FittedSize]) {
    if sizes.is_empty() {
        return;
    }
    let shared = (document.cameras.len() > 1).then(|| document.field.clone());
    let Some(known) = document.camera_mut(camera) else {
        return;
    };
    if let Some(shared) = shared {
        known.field.get_or_insert(shared);
    }
    let field = if known.field.is_some() {
        known.field.as_mut()
    } else {
        Some(&mut document.field)
    };
    if let Some(field) = field {
        set_size(field, sizes);
    }
}

/// Writes a fitted size into a field.
pub(crate) fn set_size(field: &mut FieldSpec, sizes: &[FittedSize]) {
    // What the frames do not show stays as it was assumed.
    for size in sizes.iter().filter(|size| !size.is_open) {
        // Clicks do not determine it better than to a centimetre.
        let value_m = (size.value_m * 100.0).round() / 100.0;
        field.params.insert(size.name.clone(), value_m);
    }
    if !sizes.is_empty() && sizes.iter().all(|size| !size.is_open) {
        field.size = Some(FieldSize::Fitted);
    }
}
