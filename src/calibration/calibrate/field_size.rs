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
    if let Some(shared) = shared
        && let Some(known) = document.camera_mut(camera)
    {
        known.field.get_or_insert(shared);
    }
    if let Some(field) = field_of_camera_mut(document, camera) {
        set_size(field, sizes);
    }
}

/// The field that a camera looks at, its own or else the document's, to change it; none if the
/// document has no such camera.
pub(super) fn field_of_camera_mut<'a>(
    document: &'a mut Document,
    camera: &CameraId,
) -> Option<&'a mut FieldSpec> {
    if document.camera(camera)?.field.is_some() {
        document.camera_mut(camera)?.field.as_mut()
    } else {
        Some(&mut document.field)
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
