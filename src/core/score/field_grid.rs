//! A regular grid of pixels in which a picture shows the field.

use super::ground::field_corners;
use crate::camera::PtzCamera;
use crate::field::FieldModel;
use crate::geometry::{ImagePoint, ImageSize};

/// The centres of the cells of a grid over the picture in which it shows the playing area.
///
/// The grid has `columns` cells in a row, as nearly square as whole numbers allow. A cell counts if
/// the ray of its centre meets the plane z = 0 between the field's outer lines. The crown of a few
/// centimetres is neglected.
pub fn field_grid(
    field: &FieldModel,
    camera: &PtzCamera,
    size: ImageSize,
    columns: u32,
) -> Vec<ImagePoint> {
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    let rows = (f64::from(columns) * height / width).round().max(1.0) as u32;
    size.cell_centres(columns, rows)
        .filter(|point| shows_field(field, camera, *point))
        .collect()
}

/// Whether a pixel shows the playing area.
fn shows_field(field: &FieldModel, camera: &PtzCamera, point: ImagePoint) -> bool {
    // Corners 0 and 2 are opposite: the smallest and the largest coordinates.
    let [low, _, high, _] = field_corners(field);
    camera.plane_from_image(point, 0.0).is_some_and(|ground| {
        (low.x..=high.x).contains(&ground.x) && (low.y..=high.y).contains(&ground.y)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec3;
    use crate::testing::{TestBase, soccer, turned_base};

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    /// A camera 100 m above a point, which looks down; a pixel is 0.1 m wide.
    fn above(x_m: f64) -> PtzCamera {
        let position = Vec3::new(x_m, 0.0, 100.0);
        turned_base(position, [0.0, -90.0, 0.0], SIZE).aim(0.0, 0.0, 1000.0)
    }

    #[test]
    fn cells_beside_the_field_are_left_out() {
        let field = soccer();
        // The picture shows 128 × 72 m; the field has 105 × 68 m. Cells are 8 m wide: of 16 columns
        // those whose centres lie within 52.5 m of the middle, of 9 rows those within 34 m.
        assert_eq!(field_grid(&field, &above(0.0), SIZE, 16).len(), 14 * 9);
        let shifted = field_grid(&field, &above(60.0), SIZE, 16);
        assert_eq!(
            shifted.len(),
            7 * 9,
            "the right half shows nothing of the field"
        );
        assert!(shifted.iter().all(|point| point.x < 640.0));
        assert!(field_grid(&field, &above(500.0), SIZE, 16).is_empty());
    }
}
