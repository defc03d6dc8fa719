//! A map over pan and tilt for judging an autocalibrated camera: the ground that its frames show,
//! the persistent paint, and the field's lines as the base predicts them. If paint and lines
//! coincide, the base is right, which a user sees at a glance.

use touchline_core::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{Angle, ImagePoint, ImageSize};
use touchline_vision::media::Picture;

/// What the map is drawn from.
#[derive(Clone, Copy, Debug)]
pub struct PaintMapScene<'a> {
    pub base: &'a CameraBase,
    /// The field, with the size and crown that autocalibration found; none during a search that
    /// has not placed it yet.
    pub field: Option<&'a FieldModel>,
    /// Pan, tilt and focal length of each frame, and the size of its picture.
    pub frames: &'a [(Ptz, ImageSize)],
    /// Directions of persistent paint.
    pub paint: &'a [PanTilt],
}

/// The mapping between pan and tilt and the pixels of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintMapFrame {
    /// Size of the map, px.
    pub size: ImageSize,
    left: Angle,
    top: Angle,
    px_per_degree: f64,
}

/// Maximum width and height of a map, px.
const MOST_PX: [f64; 2] = [2400.0, 1000.0];

/// Margin around the corners of the frames, degrees.
const MARGIN_DEG: f64 = 1.0;

/// Colours of ground that no frame shows, ground that some frame shows, paint, and the field's
/// lines.
const UNSEEN: [u8; 4] = [24, 27, 31, 255];
const SEEN: [u8; 4] = [44, 70, 50, 255];
const PAINT: [u8; 4] = [235, 238, 235, 255];
const LINE: [u8; 4] = [255, 138, 36, 255];

/// Whether ground is shown by a frame is decided for squares of this size, px.
const SQUARE_PX: usize = 6;

impl PaintMapFrame {
    /// The mapping that just contains all frames. `None` without frames.
    pub fn from_scene(scene: &PaintMapScene<'_>) -> Option<Self> {
        // Pan is measured from the first frame's, so that a range across ±180° stays one interval.
        let middle = scene.frames.first()?.0.pan;
        let (mut pan, mut tilt) = (
            [f64::INFINITY, f64::NEG_INFINITY],
            [f64::INFINITY, f64::NEG_INFINITY],
        );
        for (ptz, size) in scene.frames {
            let camera = PtzCamera::new(*scene.base, *ptz);
            // The extremes of pan lie in the corners. Those of tilt may lie in the middle of the
            // upper or lower border: from there to a corner the tilt of a ray comes nearer to 0.
            let [x, height] = [size.centre().x, f64::from(size.height)];
            let middles = [ImagePoint::new(x, 0.0), ImagePoint::new(x, height)];
            for point in size.corners().into_iter().chain(middles) {
                // A point without a ray lies beyond the fold of the lens model.
                let Ok(ray) = camera.ray_from_image(point) else {
                    continue;
                };
                for (range, degrees) in [
                    (&mut pan, ray.pan.turn_from(middle).degrees()),
                    (&mut tilt, ray.tilt.degrees()),
                ] {
                    *range = [range[0].min(degrees), range[1].max(degrees)];
                }
            }
        }
        let [wide, high] = [pan, tilt].map(|range| range[1] - range[0] + 2.0 * MARGIN_DEG);
        // Without any ray the ranges are still infinite.
        if !(wide.is_finite() && high.is_finite()) {
            return None;
        }
        let px_per_degree = (MOST_PX[0] / wide).min(MOST_PX[1] / high);
        let pixels = |degrees: f64| (degrees * px_per_degree).ceil().max(1.0) as u32;
        Some(Self {
            size: ImageSize::new(pixels(wide), pixels(high)),
            left: middle + Angle::from_degrees(pan[0] - MARGIN_DEG),
            top: Angle::from_degrees(tilt[1] + MARGIN_DEG),
            px_per_degree,
        })
    }

    /// The point of the map for a ray, px.
    pub fn map_from_ray(&self, ray: PanTilt) -> ImagePoint {
        // Turn from the middle of the map: a turn is at most 180°, so that one from the left edge
        // would not reach the right part of a wide map.
        let middle_deg = 0.5 * f64::from(self.size.width) / self.px_per_degree;
        let middle = self.left + Angle::from_degrees(middle_deg);
        let right_deg = middle_deg + ray.pan.turn_from(middle).degrees();
        ImagePoint::new(
            right_deg * self.px_per_degree,
            (self.top - ray.tilt).degrees() * self.px_per_degree,
        )
    }

    pub fn ray_from_map(&self, at: ImagePoint) -> PanTilt {
        PanTilt {
            pan: (self.left + Angle::from_degrees(at.x / self.px_per_degree)).wrap(),
            tilt: self.top - Angle::from_degrees(at.y / self.px_per_degree),
        }
    }

    /// The outlines of the frames on the map.
    pub fn outlines<'a>(
        &'a self,
        scene: &'a PaintMapScene<'_>,
    ) -> impl Iterator<Item = [ImagePoint; 4]> + 'a {
        scene.frames.iter().filter_map(|(ptz, size)| {
            let camera = PtzCamera::new(*scene.base, *ptz);
            let mut corners = size.corners();
            for corner in &mut corners {
                *corner = self.map_from_ray(camera.ray_from_image(*corner).ok()?);
            }
            Some(corners)
        })
    }

    /// The index of the frame that shows a point of the map nearest to its centre. `None` if no
    /// frame shows it.
    pub fn frame_at(&self, scene: &PaintMapScene<'_>, at: ImagePoint) -> Option<usize> {
        let ray = self.ray_from_map(at);
        let frames = scene
            .frames
            .iter()
            .enumerate()
            .filter_map(|(place, (ptz, size))| {
                let camera = PtzCamera::new(*scene.base, *ptz);
                Some((place, distance_from_centre_px(&camera, *size, ray)?))
            });
        frames
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(place, _)| place)
    }
}

/// How far from the picture's centre a camera sees a direction, px at 1920 px width. `None` if it
/// does not see it.
fn distance_from_centre_px(camera: &PtzCamera, size: ImageSize, ray: PanTilt) -> Option<f64> {
    let seen = camera
        .image_from_ray(ray)
        .ok()
        .filter(|seen| size.contains(*seen))?;
    Some(seen.distance_px(size.centre()) / size.scale_from_1920())
}

/// Draws the map: ground, paint, lines, each over the one before.
pub fn paint_map_picture(scene: &PaintMapScene<'_>, frame: &PaintMapFrame) -> Option<Picture> {
    let (width, height) = (frame.size.width as usize, frame.size.height as usize);
    let mut rgba = UNSEEN.repeat(width * height);
    let mut dot = |column: usize, row: usize, colour: [u8; 4]| {
        if column < width && row < height {
            let at = 4 * (row * width + column);
            rgba[at..at + 4].copy_from_slice(&colour);
        }
    };
    // A square of the ground was seen if a frame shows its centre. Squares, not pixels, because
    // each is compared with all frames.
    for row in (0..height).step_by(SQUARE_PX) {
        for column in (0..width).step_by(SQUARE_PX) {
            let middle = 0.5 * SQUARE_PX as f64;
            let at = ImagePoint::new(column as f64 + middle, row as f64 + middle);
            if frame.frame_at(scene, at).is_some() {
                (0..SQUARE_PX * SQUARE_PX).for_each(|place| {
                    dot(column + place % SQUARE_PX, row + place / SQUARE_PX, SEEN);
                });
            }
        }
    }
    // A sample of paint covers 3 × 3 pixels, so that a single one is visible; the lines are thinner
    // and remain distinguishable on it.
    for ray in scene.paint {
        if let Some((column, row)) = pixel_at(frame.map_from_ray(*ray)) {
            (0..9).for_each(|place| {
                dot(
                    (column + place % 3).saturating_sub(1),
                    (row + place / 3).saturating_sub(1),
                    PAINT,
                );
            });
        }
    }
    for at in line_pieces(scene, frame).into_iter().flatten() {
        if let Some((column, row)) = pixel_at(at) {
            dot(column, row, LINE);
            dot(column, row + 1, LINE);
        }
    }
    Picture::new(frame.size, rgba).ok()
}

/// Column and row of the pixel at a point of the map. `None` left of the map or above it.
fn pixel_at(at: ImagePoint) -> Option<(usize, usize)> {
    (at.x >= 0.0 && at.y >= 0.0).then_some((at.x as usize, at.y as usize))
}

/// The painted lines of the field on the map, cut into pieces that lie within it. Points are about
/// 1 px apart.
pub fn line_pieces(scene: &PaintMapScene<'_>, frame: &PaintMapFrame) -> Vec<Vec<ImagePoint>> {
    const SPACING_M: f64 = 0.1;
    let mut pieces = Vec::new();
    let Some(field) = scene.field else {
        return pieces;
    };
    for line in field.lines.iter().filter(|line| line.painted) {
        let count = (line.paint_centre.length_m() / SPACING_M).ceil().max(1.0);
        let mut piece = Vec::new();
        for step in 0..=count as usize {
            let mut at = line.paint_centre.point_at(step as f64 / count);
            // The paint lies on the crowned ground. The map shows rays, so no lens is involved.
            at.z = field.ground_z(at.y);
            let at = frame.map_from_ray(PanTilt::from_direction(
                scene.base.base_from_world_point(at),
            ));
            // Pieces end where the line leaves the map.
            if frame.size.contains(at) {
                piece.push(at);
            } else if !piece.is_empty() {
                pieces.push(std::mem::take(&mut piece));
            }
        }
        pieces.extend(Some(piece).filter(|piece| !piece.is_empty()));
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::testing::{base_at, soccer};

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    fn base() -> CameraBase {
        base_at([0.0, -60.0, 15.0], SIZE)
    }

    #[test]
    fn the_map_shows_paint_under_the_lines_and_leads_to_the_frame() {
        let (base, field) = (base(), soccer());
        // Also across the back, where pan wraps.
        for turned in [0.0, 178.0] {
            let frames = [-15.0, 0.0, 15.0]
                .map(|pan| (Ptz::from_degrees(pan + turned, -13.0, 1400.0), SIZE));
            let paint = [PanTilt::from_degrees(turned, -15.0)];
            let scene = PaintMapScene {
                base: &base,
                field: Some(&field),
                frames: &frames,
                paint: &paint,
            };
            let map = PaintMapFrame::from_scene(&scene).unwrap();
            assert!(
                map.size.width <= 2400
                    && map.size.height <= 1000
                    && map.size.width > map.size.height,
                "{map:?}"
            );
            let at = map.map_from_ray(paint[0]);
            let back = map.ray_from_map(at);
            assert!(back.pan.turn_from(paint[0].pan).degrees().abs() < 1e-9);
            assert_eq!(map.frame_at(&scene, at), Some(1));
            assert_eq!(map.frame_at(&scene, ImagePoint::new(-5.0, 3.0)), None);
            let picture = paint_map_picture(&scene, &map).unwrap();
            let colours: std::collections::BTreeSet<[u8; 4]> = picture
                .rgba()
                .chunks_exact(4)
                .map(|pixel| [pixel[0], pixel[1], pixel[2], pixel[3]])
                .collect();
            assert!(
                colours.contains(&PAINT) && colours.contains(&SEEN),
                "{turned}"
            );
            assert_eq!(colours.contains(&LINE), turned == 0.0);
        }
    }

    #[test]
    fn a_map_contains_its_frames_also_if_it_is_wider_than_half_a_turn() {
        let (base, field) = (base(), soccer());
        let frames = [0.0, -100.0, 100.0].map(|pan| (Ptz::from_degrees(pan, -13.0, 1400.0), SIZE));
        let scene = PaintMapScene {
            base: &base,
            field: Some(&field),
            frames: &frames,
            paint: &[],
        };
        let map = PaintMapFrame::from_scene(&scene).unwrap();
        for (index, (ptz, size)) in frames.iter().enumerate() {
            let camera = PtzCamera::new(base, *ptz);
            let lowest = ImagePoint::new(size.centre().x, f64::from(size.height));
            for at in size.corners().into_iter().chain([lowest]) {
                let at = map.map_from_ray(camera.ray_from_image(at).unwrap());
                assert!(map.size.contains(at), "frame {index}: {at:?} in {map:?}");
            }
            let middle = map.map_from_ray(camera.ray_from_image(size.centre()).unwrap());
            assert_eq!(map.frame_at(&scene, middle), Some(index));
        }
    }

    #[test]
    fn without_frames_there_is_no_map() {
        let (base, field) = (base(), soccer());
        assert!(
            PaintMapFrame::from_scene(&PaintMapScene {
                base: &base,
                field: Some(&field),
                frames: &[],
                paint: &[]
            })
            .is_none()
        );
    }
}
