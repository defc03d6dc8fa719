//! The field from above: the mapping from the field to the map, and the drawing.

use super::drawing::{Area, Colour, Drawing, Marker, MarkerShape, Outline, Stroke, StrokeGroup};
use super::overlay::{OverlayScene, marker_colour};
use rayon::prelude::*;
use touchline_core::camera::PtzCamera;
use touchline_core::field::{Curve, FieldLine, FieldModel};
use touchline_core::geometry::{ImagePoint, ImageSize, Vec3};
use touchline_core::markings::visible_ground;
use touchline_documents::document::Target;
use touchline_vision::media::Picture;

/// Colour of the playing area.
const GRASS: Colour = Colour::rgb(46, 92, 62);
/// Colour around the playing area.
pub const SURROUND: Colour = Colour::rgb(33, 62, 45);
/// Colour of the markings.
const MARKINGS: Colour = Colour::rgb(226, 236, 228);
/// Colour of the rims of outlines and markers.
const RIM: Colour = Colour {
    r: 10,
    g: 14,
    b: 12,
    a: 200,
};
/// Where the picture shows the horizon, the visible ground ends this far from the camera, m.
const REACH_M: f64 = 400.0;

/// The mapping from the field to its map: x to the right and y up, as seen from the −y side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldMap {
    /// Distance of the borders from the field's centre along x and y, m: half the field and a
    /// margin.
    pub reach_m: [f64; 2],
    /// px of the map per metre.
    pub px_per_m: f64,
    /// Whether the map is rotated by 180°, for a camera on the +y side.
    pub turned: bool,
}

impl FieldMap {
    /// The map of a field with a margin on each side.
    pub fn new(field: &FieldModel, margin_m: f64, px_per_m: f64) -> Self {
        let reach_m = [
            field.length_m / 2.0 + margin_m,
            field.width_m / 2.0 + margin_m,
        ];
        Self {
            reach_m,
            px_per_m,
            turned: false,
        }
    }

    /// This map, rotated if necessary so that the camera is at the lower border.
    #[must_use]
    pub fn with_camera_below(self, camera: &PtzCamera) -> Self {
        Self {
            turned: camera.base().position_m.y > 0.0,
            ..self
        }
    }

    /// Size of the map, px.
    pub fn size_px(&self) -> ImageSize {
        let [width, height] = self
            .reach_m
            .map(|reach| (2.0 * reach * self.px_per_m).ceil().clamp(1.0, 16384.0) as u32);
        ImageSize::new(width, height)
    }

    /// −1 if the map is rotated, else 1.
    fn sign(&self) -> f64 {
        if self.turned { -1.0 } else { 1.0 }
    }

    /// The point of the map for a point of the field, px. The height is ignored.
    pub fn map_from_world(&self, point_in_world: Vec3) -> ImagePoint {
        ImagePoint::new(
            (self.reach_m[0] + self.sign() * point_in_world.x) * self.px_per_m,
            (self.reach_m[1] - self.sign() * point_in_world.y) * self.px_per_m,
        )
    }

    /// The point of the nominal ground (z = 0) for a point of the map, m.
    pub fn world_from_map(&self, point: ImagePoint) -> Vec3 {
        Vec3::new(
            self.sign() * (point.x / self.px_per_m - self.reach_m[0]),
            self.sign() * (self.reach_m[1] - point.y / self.px_per_m),
            0.0,
        )
    }

    fn drawing_point(&self, point_in_world: Vec3) -> [f32; 2] {
        let point = self.map_from_world(point_in_world);
        [point.x as f32, point.y as f32]
    }
}

/// The field map, to be drawn in two layers.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldMapDrawing {
    /// The grass, below.
    pub ground: Drawing,
    /// Above: the markings, the visible part of the field, the clicked landmarks.
    pub over: Drawing,
}

pub fn field_map(scene: &OverlayScene<'_>, map: &FieldMap) -> FieldMapDrawing {
    let field = scene.field;
    let (x, y) = (field.length_m / 2.0, field.width_m / 2.0);
    let corners =
        [(-x, -y), (x, -y), (x, y), (-x, y)].map(|(x, y)| map.drawing_point(Vec3::new(x, y, 0.0)));
    let ground = Drawing {
        areas: vec![Area {
            corners: corners.to_vec(),
            colour: GRASS,
        }],
        ..Drawing::default()
    };
    let mut over = Drawing::default();
    let strokes = field
        .lines
        .iter()
        .filter(|line| lies_on_ground(line))
        .flat_map(|line| line.pieces(&line.curve))
        .map(|piece| Stroke {
            points: flatten_curve(&piece, map, scene.zoom),
            colour: MARKINGS,
            width_pt: 1.25,
            outline: None,
            dash: None,
        });
    over.strokes.push(StrokeGroup {
        strokes: strokes.collect(),
        opacity: 0.85,
        clip_px: None,
    });
    if let Some(camera) = scene.camera {
        append_visible(scene, camera, map, &mut over);
    }
    append_clicked(scene, map, &mut over);
    FieldMapDrawing { ground, over }
}

/// A curve as a polyline on the map that deviates by at most 0.1 px of the canvas.
fn flatten_curve(curve: &Curve, map: &FieldMap, zoom: f64) -> Vec<[f32; 2]> {
    let pieces = match curve {
        Curve::Segment { .. } => 1.0,
        Curve::Arc {
            radius_m, sweep, ..
        } => {
            // A chord over the angle α deviates from its arc by r (1 − cos(α/2)).
            let radius_px = (radius_m * map.px_per_m * zoom).max(1.0);
            let step = 2.0 * (1.0 - 0.1 / radius_px).acos();
            (sweep.radians().abs() / step).ceil().clamp(4.0, 1024.0)
        }
    };
    (0..=pieces as u32)
        .map(|piece| map.drawing_point(curve.point_at(f64::from(piece) / pieces)))
        .collect()
}

/// Appends the outline of the ground that the picture shows.
fn append_visible(
    scene: &OverlayScene<'_>,
    camera: &PtzCamera,
    map: &FieldMap,
    over: &mut Drawing,
) {
    let border = visible_ground(scene.field, camera, scene.image_size, REACH_M);
    let corners: Vec<[f32; 2]> = border
        .iter()
        .map(|point| map.drawing_point(*point))
        .collect();
    let Some(first) = corners.first() else { return };
    let [r, g, b] = scene.style.colour;
    let colour = Colour::rgb(r, g, b);
    let points = corners.iter().chain([first]).copied().collect();
    let outline = Some(Outline {
        colour: RIM,
        width_pt: 0.75,
    });
    let stroke = Stroke {
        points,
        colour,
        width_pt: 1.5,
        outline,
        dash: None,
    };
    over.strokes.push(StrokeGroup {
        strokes: vec![stroke],
        opacity: 0.9,
        clip_px: None,
    });
    over.areas.push(Area {
        corners,
        colour: colour.with_alpha(34),
    });
}

/// Appends the clicked landmarks.
fn append_clicked(scene: &OverlayScene<'_>, map: &FieldMap, over: &mut Drawing) {
    for (index, click) in scene.clicks.iter().enumerate() {
        let Some(Target::Landmark(id)) = &click.target else {
            continue;
        };
        let Some(landmark) = scene.field.landmark(id.as_str()) else {
            continue;
        };
        let selected = scene.selected == Some(index);
        let colour = marker_colour(click, scene.disputed.contains(&index), selected);
        over.markers.push(Marker {
            at: map.drawing_point(landmark.nominal_m),
            shape: if click.check {
                MarkerShape::Diamond
            } else {
                MarkerShape::Dot
            },
            colour,
            radius_pt: if selected { 5.5 } else { 4.0 },
            line_pt: 1.5,
            outline: Some(Outline {
                colour: RIM,
                width_pt: 1.0,
            }),
        });
    }
}

/// The frame's picture projected onto the map; transparent where the picture shows nothing. Each
/// pixel of the map is the mean of four samples of the picture.
pub fn picture_from_above(
    picture: &Picture,
    field: &FieldModel,
    camera: &PtzCamera,
    map: &FieldMap,
) -> Picture {
    /// Positions of the samples within a pixel, px.
    const SAMPLES: [(f64, f64); 4] = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)];
    let size = map.size_px();
    let mut rgba = vec![0; 4 * size.width as usize * size.height as usize];
    rgba.par_chunks_exact_mut(4 * size.width as usize)
        .enumerate()
        .for_each(|(row, pixels)| {
            for (column, pixel) in pixels.chunks_exact_mut(4).enumerate() {
                let mut sum = [0.0; 4];
                for (dx, dy) in SAMPLES {
                    // The map is flat and the ground is not: lift the point before projecting it.
                    let on_map = ImagePoint::new(column as f64 + dx, row as f64 + dy);
                    let in_world = field.world_from_nominal(map.world_from_map(on_map));
                    let Ok(in_image) = camera.image_from_world(in_world) else {
                        continue;
                    };
                    let Some([r, g, b]) = bilinear(picture, in_image) else {
                        continue;
                    };
                    for (total, value) in sum.iter_mut().zip([r, g, b, 255.0]) {
                        *total += value;
                    }
                }
                // The mean colour of the samples that lie in the picture; their number gives the
                // opacity.
                if sum[3] > 0.0 {
                    let seen = sum[3] / 255.0;
                    for (byte, total) in pixel.iter_mut().zip([
                        sum[0] / seen,
                        sum[1] / seen,
                        sum[2] / seen,
                        sum[3] / 4.0,
                    ]) {
                        *byte = total.round() as u8;
                    }
                }
            }
        });
    // `rgba` has the length for this size, so that the fallback is never used.
    Picture::new(size, rgba).unwrap_or_else(|_| Picture::with_colour(size, [0; 4]))
}

/// The colour of the picture at a point, interpolated between pixel centres. `None` outside the
/// picture.
fn bilinear(picture: &Picture, at: ImagePoint) -> Option<[f64; 3]> {
    let size = picture.size();
    if !size.contains(at) {
        return None;
    }
    let (x, y) = (at.x - 0.5, at.y - 0.5);
    // The four nearest pixel centres, each weighted by its nearness in both directions. Beyond the
    // outermost centres the border pixels are repeated.
    let (left, top) = (x.floor(), y.floor());
    let (right_share, lower_share) = (x - left, y - top);
    let columns = [left, left + 1.0].map(|x| x.clamp(0.0, f64::from(size.width) - 1.0) as u32);
    let rows = [top, top + 1.0].map(|y| y.clamp(0.0, f64::from(size.height) - 1.0) as u32);
    let corners = [
        (
            picture.pixel(columns[0], rows[0])?,
            (1.0 - right_share) * (1.0 - lower_share),
        ),
        (
            picture.pixel(columns[1], rows[0])?,
            right_share * (1.0 - lower_share),
        ),
        (
            picture.pixel(columns[0], rows[1])?,
            (1.0 - right_share) * lower_share,
        ),
        (
            picture.pixel(columns[1], rows[1])?,
            right_share * lower_share,
        ),
    ];
    Some(std::array::from_fn(|channel| {
        corners
            .iter()
            .map(|(pixel, share)| f64::from(pixel[channel]) * share)
            .sum()
    }))
}

/// Whether a line is visible from above: paint, and lines at z = 0 such as the boards of a rink.
fn lies_on_ground(line: &FieldLine) -> bool {
    line.painted
        || [0.0, 0.5, 1.0]
            .iter()
            .all(|&t| line.curve.point_at(t).z == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::OverlayStyle;
    use std::collections::BTreeMap;
    use touchline_core::field::builtin;
    use touchline_core::testing::{TestBase, turned_base};

    const SIZE: ImageSize = ImageSize::new(640, 360);

    fn field() -> FieldModel {
        builtin("soccer")
            .unwrap()
            .model(&BTreeMap::new(), 0.0)
            .unwrap()
    }

    fn camera(y_m: f64, heading_deg: f64) -> PtzCamera {
        turned_base([0.0, y_m, 18.0], [heading_deg, 0.0, 0.0], SIZE).aim(0.0, -16.0, 900.0)
    }

    #[test]
    fn the_camera_stands_at_the_lower_border() {
        let field = field();
        for (camera, near_left) in [
            (camera(-60.0, 0.0), Vec3::new(-52.5, -34.0, 0.0)),
            (camera(60.0, 180.0), Vec3::new(52.5, 34.0, 0.0)),
        ] {
            let map = FieldMap::new(&field, 5.0, 10.0).with_camera_below(&camera);
            assert_eq!(map.size_px(), ImageSize::new(1150, 780));
            assert_eq!(map.map_from_world(near_left), ImagePoint::new(50.0, 730.0));
            assert!((map.world_from_map(ImagePoint::new(50.0, 730.0)) - near_left).norm() < 1e-12);
        }
    }

    #[test]
    fn the_map_shows_the_markings_and_what_the_picture_shows() {
        let (field, camera, style) = (field(), camera(-60.0, 0.0), OverlayStyle::default());
        let scene = OverlayScene {
            camera: Some(&camera),
            ..OverlayScene::new(&field, SIZE, &style)
        };
        let drawing = field_map(&scene, &FieldMap::new(&field, 5.0, 10.0));
        let on_ground = field
            .lines
            .iter()
            .filter(|line| lies_on_ground(line))
            .count();
        assert_eq!(drawing.over.strokes[0].strokes.len(), on_ground);
        assert!(
            on_ground < field.lines.len(),
            "posts and crossbars are seen from above as nothing"
        );
        assert_eq!(
            (drawing.over.areas.len(), drawing.ground.areas.len()),
            (1, 1)
        );
        let unsolved = field_map(
            &OverlayScene {
                camera: None,
                ..scene
            },
            &FieldMap::new(&field, 5.0, 10.0),
        );
        assert!(unsolved.over.areas.is_empty());
    }

    #[test]
    fn the_picture_lies_on_the_map_where_the_camera_saw_it() {
        let (field, camera) = (field(), camera(-60.0, 0.0));
        let map = FieldMap::new(&field, 5.0, 4.0);
        // Red left of the picture's centre, blue right of it.
        let rgba = (0..SIZE.height).flat_map(|_| {
            (0..SIZE.width).flat_map(|x| {
                if x < 320 {
                    [200, 0, 0, 255]
                } else {
                    [0, 0, 200, 255]
                }
            })
        });
        let picture = Picture::new(SIZE, rgba.collect()).unwrap();
        let above = picture_from_above(&picture, &field, &camera, &map);
        let at = |x_m: f64, y_m: f64| {
            let point = map.map_from_world(Vec3::new(x_m, y_m, 0.0));
            above.pixel(point.x as u32, point.y as u32).unwrap()
        };
        assert_eq!(at(-8.0, 0.0), [200, 0, 0, 255]);
        assert_eq!(at(8.0, 0.0), [0, 0, 200, 255]);
        assert_eq!(at(-50.0, -30.0), [0, 0, 0, 0], "not visible");
    }
}
