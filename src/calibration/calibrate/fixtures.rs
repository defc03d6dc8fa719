//! What tests of several files begin with.

use touchline_core::camera::CameraBase;
use touchline_core::geometry::ImageSize;
use touchline_documents::document::{Camera, Document, FieldSpec};

/// A document of a soccer field and one camera, `main`, with this base and pictures of this size.
pub fn document_with(base: &CameraBase, image_size: ImageSize) -> Document {
    let mut document = Document::new(FieldSpec::new("soccer"));
    let mut camera = Camera::new("main".into(), image_size);
    camera.set_base(base);
    document.cameras.push(camera.into());
    document
}
