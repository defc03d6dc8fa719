//! Writes an estimated base into a document, with the crown and the fitted size of its field.

use super::{rounded_m, state_errors};
use touchline_core::camera::CameraBase;
use touchline_core::solve::base::FittedSize;
use touchline_documents::document::{CameraId, Document, FieldSize, FieldSpec};

/// Writes a base into a camera, and the crown and a fitted size into its field.
///
/// With several cameras, each gets a field of its own where one of these changes: they may be at
/// different venues.
pub(in crate::calibrate) fn write_base(
    document: &mut Document,
    camera: &CameraId,
    base: &CameraBase,
    crown_m: f64,
    sizes: &[FittedSize],
) {
    let Some(known) = document.camera_mut(camera) else {
        return;
    };
    // What is open of the size is an error of all that the base draws.
    let mut base = *base;
    state_errors(&mut base, sizes);
    known.set_base(&base);
    set_field_size(document, camera, sizes);
    if document.field_of_camera(camera).crown_m() != crown_m
        && let Some(field) = own_field_mut(document, camera)
    {
        field.set_crown_m(crown_m);
    }
}

/// Writes a fitted size into the field of a camera. With several cameras, each gets a field of its
/// own. A size that the frames do not show changes nothing.
pub(crate) fn set_field_size(document: &mut Document, camera: &CameraId, sizes: &[FittedSize]) {
    if sizes.iter().all(|size| size.is_open) {
        return;
    }
    if let Some(field) = own_field_mut(document, camera) {
        set_size(field, sizes);
    }
}

/// The field that a camera looks at, to change it for this camera alone: where it shares the
/// document's with others, it gets a copy of that first. None if the document has no such camera.
fn own_field_mut<'a>(document: &'a mut Document, camera: &CameraId) -> Option<&'a mut FieldSpec> {
    let has_own = document.camera(camera)?.field.is_some();
    if !has_own && document.cameras.len() == 1 {
        return Some(&mut document.field);
    }
    let shared = document.field.clone();
    Some(document.camera_mut(camera)?.field.get_or_insert(shared))
}

/// Writes a fitted size into a field.
fn set_size(field: &mut FieldSpec, sizes: &[FittedSize]) {
    // What the frames do not show stays as it was assumed.
    for size in sizes.iter().filter(|size| !size.is_open) {
        let value_m = rounded_m(size.value_m);
        field.params.insert(size.name.clone(), value_m);
    }
    if !sizes.is_empty() && sizes.iter().all(|size| !size.is_open) {
        field.size = Some(FieldSize::Fitted);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::SizeError;
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::base_at;
    use touchline_documents::document::Camera;
    use touchline_documents::testing::match_from;

    const IMAGE_SIZE: ImageSize = ImageSize::new(1920, 1080);

    fn base() -> CameraBase {
        base_at([0.0, -62.0, 17.0], IMAGE_SIZE)
    }

    /// Two cameras that share the document's field.
    fn two_cameras() -> Document {
        let mut document = match_from(&base(), IMAGE_SIZE);
        document
            .cameras
            .push(Camera::new("second".into(), IMAGE_SIZE).into());
        document
    }

    fn length(is_open: bool) -> FittedSize {
        FittedSize {
            name: "length_m".to_owned(),
            assumed_m: 105.0,
            value_m: 102.0,
            error: SizeError::alone(0.3),
            is_open,
        }
    }

    #[test]
    fn a_size_that_no_frame_shows_leaves_the_shared_field_to_its_cameras() {
        let before = two_cameras();
        let mut document = before.clone();
        set_field_size(&mut document, &"main".into(), &[length(true)]);
        assert_eq!(document, before);
        set_field_size(&mut document, &"main".into(), &[length(false)]);
        assert_eq!(document.field, before.field);
        let own = document.field_of_camera(&"main".into());
        assert_eq!(own.params["length_m"], 102.0);
    }

    #[test]
    fn the_crown_of_one_camera_does_not_raise_the_field_of_another() {
        let mut document = two_cameras();
        write_base(&mut document, &"main".into(), &base(), 0.0, &[]);
        assert_eq!(document.cameras[0].field, None, "it has not changed");
        write_base(&mut document, &"main".into(), &base(), 0.15, &[]);
        assert_eq!(document.field_of_camera(&"main".into()).crown_m(), 0.15);
        assert_eq!(document.field_of_camera(&"second".into()).crown_m(), 0.0);
        // A camera by itself needs no field of its own.
        document.cameras.truncate(1);
        document.cameras[0].field = None;
        write_base(&mut document, &"main".into(), &base(), 0.15, &[]);
        assert_eq!(document.field.crown_m(), 0.15);
        assert_eq!(document.cameras[0].field, None);
    }
}
