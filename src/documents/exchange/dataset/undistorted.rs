//! Pictures and documents without lens distortion.

use crate::document::{Camera, Document, Frame};
use rayon::prelude::*;
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::{ImagePoint, ImageSize, Vec2};
use touchline_vision::media::{MediaError, Picture};

/// The picture that the same camera would take without distortion: same size, focal length and
/// principal point. Pixels that the distorted picture does not show are black.
///
/// # Errors
/// The size of the picture cannot be addressed.
pub fn undistort_picture(picture: &Picture, camera: &PtzCamera) -> Result<Picture, MediaError> {
    let size = picture.size();
    let (focal_px, principal_point, lens) = (
        camera.ptz().focal_px,
        camera.base().principal_point,
        camera.lens(),
    );
    let fold = lens.fold_radius_squared();
    let row = |y: u32| {
        (0..size.width).flat_map(move |x| {
            // Inverse mapping: distort the ideal point of each pixel of the result and sample the
            // picture there. The forward direction of the lens model is closed-form.
            let pixel = ImagePoint::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let ideal: Vec2 = pixel.offset_from(principal_point) / focal_px;
            let radius_squared = ideal.norm_squared();
            if radius_squared >= fold {
                return [0, 0, 0, 255];
            }
            let distorted = ideal * lens.stretch(radius_squared) * focal_px;
            sample(
                picture,
                size,
                ImagePoint::new(
                    principal_point.x + distorted.x,
                    principal_point.y + distorted.y,
                ),
            )
        })
    };
    let rgba: Vec<u8> = (0..size.height)
        .into_par_iter()
        .flat_map_iter(row)
        .collect();
    Picture::new(size, rgba)
}

/// The colour at a point, interpolated bilinearly between the four nearest pixel centres; black
/// outside the picture.
fn sample(picture: &Picture, size: ImageSize, at: ImagePoint) -> [u8; 4] {
    if !size.contains(at) {
        return [0, 0, 0, 255];
    }
    let (x, y) = (at.x - 0.5, at.y - 0.5);
    let (left, top) = (x.floor(), y.floor());
    let (to_right, to_below) = (x - left, y - top);
    let colour = |column: f64, row: f64| {
        let column = column.clamp(0.0, f64::from(size.width - 1)) as u32;
        let row = row.clamp(0.0, f64::from(size.height - 1)) as u32;
        picture.pixel(column, row).unwrap_or([0, 0, 0, 255])
    };
    let corners = [
        colour(left, top),
        colour(left + 1.0, top),
        colour(left, top + 1.0),
        colour(left + 1.0, top + 1.0),
    ];
    std::array::from_fn(|channel| {
        let [a, b, c, d] = corners.map(|corner| f64::from(corner[channel]));
        let above = a + (b - a) * to_right;
        let below = c + (d - c) * to_right;
        (above + (below - above) * to_below).round() as u8
    })
}

/// A document in the pixels of undistorted pictures: without a lens and with clicks undistorted.
/// Frames without a known camera are removed; so are masks, because boxes do not stay boxes, and
/// clicks without an undistorted position.
pub fn undistort_document(document: &Document) -> Document {
    let mut plain = document.clone();
    plain
        .frames
        .retain(|frame| document.ptz_camera(frame).is_some());
    for (frame, distorted) in plain.frames.iter_mut().zip(
        document
            .frames
            .iter()
            .filter(|frame| document.ptz_camera(frame).is_some()),
    ) {
        if let Some(camera) = document.ptz_camera(distorted) {
            straighten(frame, &camera);
        }
    }
    for camera in &mut plain.cameras {
        let camera: &mut Camera = camera;
        camera.distortion = None;
        camera.masks.clear();
        camera.ranged_masks.clear();
    }
    plain
}

fn straighten(frame: &mut Frame, camera: &PtzCamera) {
    let straight = |point: ImagePoint| {
        let ideal = camera.cam_plane_from_image(point).ok()? * camera.ptz().focal_px;
        let centre = camera.base().principal_point;
        Some(ImagePoint::new(centre.x + ideal.x, centre.y + ideal.y))
    };
    let is_shown = frame
        .clicks
        .iter()
        .all(|click| straight(click.image).is_some());
    if !is_shown && let Some(solution) = &mut frame.solution {
        // Indices of clicks are no longer valid.
        solution.disputed.clear();
        for warning in &mut solution.warnings {
            warning.clicks.clear();
            warning.renames.clear();
        }
    }
    frame.clicks.retain_mut(|click| {
        straight(click.image)
            .map(|point| click.image = point)
            .is_some()
    });
    frame.repeats.clear();
    frame.masks.clear();
    if let Some(ptz) = &mut frame.ptz {
        (ptz.k1, ptz.k2) = (None, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Click;
    use crate::exchange::tests::{SIZE, awkward};

    /// A picture with a bright spot where the camera shows a point: after undistortion it is where
    /// a camera without a lens shows it.
    #[test]
    fn a_spot_lands_where_a_camera_without_a_lens_shows_it() {
        let mut document = awkward();
        let camera = document.ptz_camera(&document.frames[3]).unwrap();
        let spot = ImagePoint::new(1700.0, 160.0);
        document.frames[3].clicks = vec![Click::landmark("centre_mark".into(), spot)];
        let plain = undistort_document(&document);
        let wanted = plain.frames[3].clicks[0].image;
        assert!(
            wanted.distance_px(spot) > 8.0,
            "the lens bends there: {wanted:?}"
        );
        let mut rgba = Picture::with_colour(SIZE, [0, 0, 0, 255]).rgba().to_vec();
        for (y, x) in (150_usize..170).flat_map(|y| (1690_usize..1710).map(move |x| (y, x))) {
            let at = 4 * (y * SIZE.width as usize + x);
            rgba[at..at + 3].fill(255);
        }
        let straight = undistort_picture(&Picture::new(SIZE, rgba).unwrap(), &camera).unwrap();
        let (mut sum, mut x_sum, mut y_sum) = (0.0, 0.0, 0.0);
        for y in 0..SIZE.height {
            for x in 0..SIZE.width {
                let bright = f64::from(straight.pixel(x, y).unwrap()[0]);
                (sum, x_sum, y_sum) = (
                    sum + bright,
                    x_sum + bright * (f64::from(x) + 0.5),
                    y_sum + bright * (f64::from(y) + 0.5),
                );
            }
        }
        let found = ImagePoint::new(x_sum / sum, y_sum / sum);
        assert!(found.distance_px(wanted) < 0.1, "{found:?} {wanted:?}");
        let bare = plain.ptz_camera(&plain.frames[3]).unwrap();
        assert!(bare.lens().is_none());
    }

    #[test]
    fn without_a_lens_every_pixel_stays() {
        let mut document = awkward();
        document.cameras[0].distortion = None;
        let camera = document.ptz_camera(&document.frames[0]).unwrap();
        let small = ImageSize::new(16, 9);
        let picture = Picture::new(
            small,
            (0..576)
                .map(|value| {
                    if value % 4 == 3 {
                        255
                    } else {
                        (value % 251) as u8
                    }
                })
                .collect(),
        );
        let picture = picture.unwrap();
        assert_eq!(undistort_picture(&picture, &camera).unwrap(), picture);
    }
}
