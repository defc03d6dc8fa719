//! Pictures and documents without lens distortion.

use crate::document::{Camera, Document, Frame};
use rayon::prelude::*;
use touchline_core::camera::{PtzCamera, Radial};
use touchline_core::geometry::{ImagePoint, ImageSize, Vec2};
use touchline_vision::media::{MediaError, Picture};

/// The picture that the same camera would take without distortion: same size, focal length,
/// principal point and pixels. Pixels that the distorted picture does not show are black.
///
/// # Errors
/// The size of the picture cannot be addressed.
pub fn undistort_picture(picture: &Picture, camera: &PtzCamera) -> Result<Picture, MediaError> {
    let size = picture.size();
    let lens = camera.lens();
    let distorted = &DistortedPicture {
        picture,
        focal_px: camera.ptz().focal_px,
        principal_point: camera.base().principal_point,
        lens,
        fold_radius_squared: lens.fold_radius_squared(),
    };
    // Row by row on all threads; the order of the rows stays.
    let rgba: Vec<u8> = (0..size.height)
        .into_par_iter()
        .flat_map_iter(|y| (0..size.width).flat_map(move |x| distorted.undistorted_pixel(x, y)))
        .collect();
    Picture::new(size, rgba)
}

/// The colour of pixels that the distorted picture does not show.
const BLACK: [u8; 4] = [0, 0, 0, 255];

/// A picture and the lens that it was taken with.
struct DistortedPicture<'a> {
    picture: &'a Picture,
    focal_px: f64,
    principal_point: ImagePoint,
    lens: Radial,
    /// The squared radius, on normalised coordinates, from which on the lens model folds back.
    fold_radius_squared: f64,
}

impl DistortedPicture<'_> {
    /// The colour of a pixel of the picture without distortion.
    fn undistorted_pixel(&self, x: u32, y: u32) -> [u8; 4] {
        // Inverse mapping: distort the ideal point of each pixel of the result and sample the
        // picture there. The forward direction of the lens model is closed-form.
        let pixel = ImagePoint::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let ideal: Vec2 = self
            .lens
            .square_from_pixels(pixel.offset_from(self.principal_point))
            / self.focal_px;
        let radius_squared = ideal.norm_squared();
        if radius_squared >= self.fold_radius_squared {
            return BLACK;
        }
        let distorted = self
            .lens
            .pixels_from_square(ideal * self.lens.stretch(radius_squared) * self.focal_px);
        let at = ImagePoint::new(
            self.principal_point.x + distorted.x,
            self.principal_point.y + distorted.y,
        );
        sample(self.picture, at)
    }
}

/// The colour at a point, interpolated bilinearly between the four nearest pixel centres; black
/// outside the picture.
fn sample(picture: &Picture, at: ImagePoint) -> [u8; 4] {
    if !picture.size().contains(at) {
        return BLACK;
    }
    // From the corner convention to indices of pixel centres.
    let (x, y) = (at.x - 0.5, at.y - 0.5);
    let (left, top) = (x.floor(), y.floor());
    let (to_right, to_below) = (x - left, y - top);
    let corners = [
        nearest_colour(picture, left, top),
        nearest_colour(picture, left + 1.0, top),
        nearest_colour(picture, left, top + 1.0),
        nearest_colour(picture, left + 1.0, top + 1.0),
    ];
    std::array::from_fn(|channel| {
        let [a, b, c, d] = corners.map(|corner| f64::from(corner[channel]));
        let above = a + (b - a) * to_right;
        let below = c + (d - c) * to_right;
        (above + (below - above) * to_below).round() as u8
    })
}

/// The colour of a pixel; beyond an edge of the picture, that of the pixel at the edge.
fn nearest_colour(picture: &Picture, column: f64, row: f64) -> [u8; 4] {
    let ImageSize { width, height } = picture.size();
    let column = column.clamp(0.0, f64::from(width - 1)) as u32;
    let row = row.clamp(0.0, f64::from(height - 1)) as u32;
    picture.pixel(column, row).unwrap_or(BLACK)
}

/// A document in the pixels of undistorted pictures: without a lens and with clicks undistorted.
/// Frames without a known camera are removed; so are masks, because boxes do not stay boxes, and
/// clicks without an undistorted position.
pub fn undistort_document(document: &Document) -> Document {
    let mut plain = document.clone();
    plain
        .frames
        .retain(|frame| document.ptz_camera(frame).is_some());
    // The cameras of the original document still have their lenses.
    for frame in &mut plain.frames {
        let frame: &mut Frame = frame;
        if let Some(camera) = document.ptz_camera(frame) {
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

/// Moves a frame's clicks to the undistorted picture and removes what has no place there.
fn straighten(frame: &mut Frame, camera: &PtzCamera) {
    // Warnings and disputes refer to clicks by their position, which changes where a click is
    // removed.
    let is_shown = frame
        .clicks
        .iter()
        .all(|click| undistort_point(click.image, camera).is_some());
    if !is_shown && let Some(solution) = &mut frame.solution {
        solution.disputed.clear();
        for warning in &mut solution.warnings {
            warning.clicks.clear();
            warning.renames.clear();
        }
    }
    frame.clicks.retain_mut(|click| {
        undistort_point(click.image, camera)
            .map(|point| click.image = point)
            .is_some()
    });
    frame.repeats.clear();
    frame.masks.clear();
    // A frame states k₁ and k₂ with its solution, with a lens of its own, or both.
    if let Some(ptz) = &mut frame.ptz {
        (ptz.k1, ptz.k2) = (None, None);
    }
    if let Some(lens) = &mut frame.lens {
        (lens.k1, lens.k2) = (None, None);
    }
}

/// The place of a point in the undistorted picture, px; none where the lens model has no inverse.
fn undistort_point(point: ImagePoint, camera: &PtzCamera) -> Option<ImagePoint> {
    // The ideal point on the plane at depth 1, drawn with the same focal length and principal
    // point.
    let ideal = camera.cam_plane_from_image(point).ok()? * camera.ptz().focal_px;
    let ideal = camera.lens().pixels_from_square(ideal);
    let centre = camera.base().principal_point;
    Some(ImagePoint::new(centre.x + ideal.x, centre.y + ideal.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Click, FrameLens};
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
    fn a_lens_of_the_frame_itself_is_taken_off_too() {
        let mut document = awkward();
        let radial = Radial {
            k1: -0.2,
            k2: 0.0,
            ..Radial::default()
        };
        document.frames[3].lens = Some(FrameLens::new(2130.0, SIZE.centre(), radial));
        let plain = undistort_document(&document);
        let camera = plain.ptz_camera(&plain.frames[3]).unwrap();
        assert!(camera.lens().is_none());
        assert_eq!(camera.base().principal_point, SIZE.centre());
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
