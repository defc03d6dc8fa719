//! A frame: rays for what stands still, finer at edges; then shadows, people, goals and nets; then
//! the camera.

use super::lens::{Exposure, Pixel, still};
use super::light::Light;
use super::options::FrameOptions;
use super::props::{Mover, Prop, movers};
use super::ray::{Ray, RayCaster};
use super::solid::Touch;
use super::stadium::{GRASS, RayHit, Stadium};
use image::{GrayImage, RgbImage};
use rayon::prelude::*;
use std::ops::Range;
use touchline_core::camera::PtzCamera;
use touchline_core::geometry::{ImagePoint, ImageSize, PixelBox, Vec3};

/// A rendered frame with its ground truth.
#[derive(Clone, Debug)]
pub struct RenderedFrame {
    /// The picture.
    pub image: RgbImage,
    /// 255 where a player, an official or the ball covers a tenth of the pixel or more, else 0.
    pub mover_mask: GrayImage,
    /// Whoever moves and is in the picture, with the box of what is seen of them, px; nearest last.
    pub movers: Vec<SeenMover>,
    /// The boxes of the graphics that were drawn, px.
    pub graphics: Vec<PixelBox>,
}

/// A player, an official or the ball in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenMover {
    /// Who or what it is.
    pub mover: Mover,
    /// What it covers, px.
    pub area: PixelBox,
}

/// The side of the grid of samples in a pixel on an edge.
const EDGE_SAMPLES: usize = 4;
/// A mover counts from this share of a pixel on.
const MASK_FROM: f32 = 0.1;

impl Stadium {
    /// The picture that a camera takes. The geometry is exact: every pixel is the ray of its centre
    /// (of a grid of rays at edges), through the lens model. The bytes do not depend on the number
    /// of threads.
    pub fn render(
        &self,
        camera: &PtzCamera,
        image_size: ImageSize,
        options: &FrameOptions,
    ) -> RenderedFrame {
        let caster = RayCaster::new(camera);
        let mut props: Vec<PlacedProp> = Vec::new();
        props.extend(
            self.fixtures
                .iter()
                .cloned()
                .filter_map(|prop| PlacedProp::new(prop, camera, image_size)),
        );
        if options.players {
            let people = movers(&self.play, &self.kits, self.field(), options.time_s);
            props.extend(
                people
                    .into_iter()
                    .filter_map(|prop| PlacedProp::new(prop, camera, image_size)),
            );
        }
        // Farthest first: nearer ones are laid over them.
        props.sort_by(|a, b| b.depth.total_cmp(&a.depth));
        let shadows = self.shadows(&props, camera, image_size);

        // First pass: what the ray of each pixel's centre sees of what stands still. Rows are
        // independent of each other, here and below, which is why threads do not matter.
        let width = image_size.width as usize;
        let blank = RayHit {
            light: Light::zeros(),
            depth: 0.0,
            surface: 0,
        };
        let mut hits = vec![blank; width * image_size.height as usize];
        hits.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            for (x, hit) in row.iter_mut().enumerate() {
                if let Some(ray) = caster.ray_of_pixel(x, y) {
                    *hit = self.look(&ray);
                }
            }
        });
        // Second pass, which needs the neighbours of the first: finer samples where surfaces meet,
        // then shadows on the grass, then what stands on it.
        let mut exposure = Exposure {
            size: image_size,
            pixels: vec![Pixel::zeros(); hits.len()],
        };
        exposure
            .pixels
            .par_chunks_mut(width)
            .enumerate()
            .for_each(|(y, row)| {
                for (x, pixel) in row.iter_mut().enumerate() {
                    let hit = hits[y * width + x];
                    let light = if on_edge(&hits, width, x, y) {
                        self.fine(&caster, x, y)
                    } else {
                        hit.light
                    };
                    *pixel = still(light);
                }
                for shadow in shadows.iter().filter(|shadow| shadow.rows.contains(&y)) {
                    self.darken(shadow, &caster, &hits[y * width..(y + 1) * width], row, y);
                }
                for prop in props.iter().filter(|prop| prop.rows.contains(&y)) {
                    self.cover(prop, &caster, &hits[y * width..(y + 1) * width], row, y);
                }
            });
        let movers = props
            .par_iter()
            .filter_map(|prop| prop.visible_mover(&caster, &hits, width, self))
            .collect();

        // The camera: blur in linear light, then development. Graphics are laid over the developed
        // picture, since no lens sees them. The mask is blurred with the picture: it is the fourth
        // channel.
        if options.shutter_s > 0.0 {
            exposure = exposure.with_motion_blur(camera, options);
        }
        if options.defocus_px > 0.0 {
            exposure = exposure.with_defocus(options.defocus_px);
        }
        let mut image = exposure.develop(options);
        options
            .graphics
            .draw(&mut image, self.options.seed, &self.kits, options.time_s);
        let graphics = options.graphics.boxes(image_size, options.time_s);
        let bytes = exposure
            .pixels
            .iter()
            .map(|pixel| if pixel.w >= MASK_FROM { 255 } else { 0 })
            .collect();
        let mover_mask =
            GrayImage::from_raw(image_size.width, image_size.height, bytes).unwrap_or_default();
        RenderedFrame {
            image,
            mover_mask,
            movers,
            graphics,
        }
    }

    /// A pixel on an edge: the mean of a grid of rays.
    fn fine(&self, caster: &RayCaster<'_>, x: usize, y: usize) -> Light {
        let step = 1.0 / EDGE_SAMPLES as f64;
        let mut sum = Light::zeros();
        for sample in 0..EDGE_SAMPLES * EDGE_SAMPLES {
            let (i, j) = (
                (sample % EDGE_SAMPLES) as f64,
                (sample / EDGE_SAMPLES) as f64,
            );
            let point = ImagePoint::new(x as f64 + (i + 0.5) * step, y as f64 + (j + 0.5) * step);
            if let Some(ray) = caster.ray(point) {
                sum += self.look(&ray).light;
            }
        }
        sum / (EDGE_SAMPLES * EDGE_SAMPLES) as f32
    }

    /// Lays a prop over a row of the picture, where nothing that stands still hides it.
    fn cover(
        &self,
        prop: &PlacedProp,
        caster: &RayCaster<'_>,
        hits: &[RayHit],
        row: &mut [Pixel],
        y: usize,
    ) {
        let mut touches = Vec::with_capacity(16);
        for x in prop.columns.clone() {
            let Some(ray) = caster.ray_of_pixel(x, y) else {
                continue;
            };
            prop.touches(&ray, hits[x].depth, self, &mut touches);
            if touches.is_empty() {
                continue;
            }
            // Nearest first, each covers its share of what the ones before have left: edges of
            // different parts are taken as independent of each other.
            let (mut light, mut left) = (Light::zeros(), 1.0);
            for touch in &touches {
                light += touch.light * (touch.share * left);
                left *= 1.0 - touch.share;
            }
            let mover = if prop.prop.mover.is_some() {
                1.0 - left
            } else {
                0.0
            };
            row[x] = row[x] * left + Pixel::new(light.x, light.y, light.z, mover);
        }
    }

    /// The shadows of everything that throws one: the lamps' and, round the feet, the sky's.
    fn shadows<'a>(
        &self,
        props: &'a [PlacedProp],
        camera: &PtzCamera,
        image_size: ImageSize,
    ) -> Vec<Shadow<'a>> {
        let mut shadows = Vec::new();
        for prop in props.iter().filter(|prop| prop.prop.throws_shadow) {
            let (centre, radius) = prop.prop.bounds();
            for (lamp, towards) in self
                .lighting
                .lamps
                .iter()
                .map(|lamp| lamp.towards)
                .enumerate()
            {
                // The shadow of a point of this height above the middle of the prop's foot.
                let falls = |height: f64| {
                    let away = towards * (height / towards.z);
                    Vec3::new(centre.x - away.x, centre.y - away.y, 0.0)
                };
                let ends = [falls(0.0), falls(centre.z + radius)];
                if let Some((columns, rows)) = area(&ends, radius, camera, image_size) {
                    shadows.push(Shadow {
                        prop: &prop.prop,
                        lamp,
                        columns,
                        rows,
                    });
                }
            }
        }
        shadows
    }

    fn darken(
        &self,
        shadow: &Shadow<'_>,
        caster: &RayCaster<'_>,
        hits: &[RayHit],
        row: &mut [Pixel],
        y: usize,
    ) {
        // Shadows fall on the grass only. That of a body is as dark as that of its darkest stick,
        // not the product of all, because the sticks overlap.
        let lamp = &self.lighting.lamps[shadow.lamp];
        for x in shadow.columns.clone() {
            if hits[x].surface != GRASS {
                continue;
            }
            let Some(ray) = caster.ray_of_pixel(x, y) else {
                continue;
            };
            let Some(ground) = self.ground_along(&ray) else {
                continue;
            };
            let blur_m = 0.03 + ground.depth * ray.pixel_at_unit_depth();
            let hidden = shadow
                .prop
                .sticks
                .iter()
                .map(|stick| stick.shadow(ground.point, lamp.towards, blur_m))
                .fold(0.0, f32::max);
            // Near the feet a body hides a part of the sky, too; every lamp's shadow carries its
            // part of that.
            let parts = self.lighting.lamps.len() as f32;
            let foot = shadow.foot_distance_m(ground.point) as f32;
            let sky_hidden = 0.55 * (-(foot / 0.32).powi(2)).exp() / parts;
            if hidden <= 0.0 && sky_hidden < 0.01 {
                continue;
            }
            // The pixel has the light of all lamps and the sky; it keeps the share that is not
            // lost. The sky alone makes `all` positive.
            let all = self.lighting.on_ground(ground.point);
            let lost = self.lighting.lamp_on_ground(lamp, ground.point) * hidden
                + self.lighting.sky() * sky_hidden;
            let kept = (all - lost).component_div(&all);
            row[x] = row[x].component_mul(&kept.push(1.0));
        }
    }
}

/// Whether a pixel sees another surface than one of its neighbours.
fn on_edge(hits: &[RayHit], width: usize, x: usize, y: usize) -> bool {
    let height = hits.len() / width;
    let here = hits[y * width + x].surface;
    let (left, right) = (x.saturating_sub(1), (x + 1).min(width - 1));
    (y.saturating_sub(1)..=(y + 1).min(height - 1))
        .any(|row| (left..=right).any(|column| hits[row * width + column].surface != here))
}

/// The pixels that may see something near these points: columns and rows.
fn area(
    points: &[Vec3],
    radius_m: f64,
    camera: &PtzCamera,
    image_size: ImageSize,
) -> Option<(Range<usize>, Range<usize>)> {
    // The image of a sphere about each point, a tenth larger for the lens and the oblique view, and
    // 2 px for soft rims. What is partly behind the camera is not drawn.
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for point in points {
        let image = camera.image_from_world(*point).ok()?;
        let reach_px = 2.0
            + 1.1 * camera.ptz().focal_px * radius_m / (point - camera.base().position_m).norm();
        for (axis, at) in [image.x, image.y].into_iter().enumerate() {
            low[axis] = low[axis].min(at - reach_px);
            high[axis] = high[axis].max(at + reach_px);
        }
    }
    let range = |axis: usize, end: u32| {
        let clip = |at: f64| at.clamp(0.0, f64::from(end)) as usize;
        clip(low[axis])..clip(high[axis].ceil())
    };
    let (columns, rows) = (range(0, image_size.width), range(1, image_size.height));
    (!columns.is_empty() && !rows.is_empty()).then_some((columns, rows))
}

/// A prop and where it may be in the picture.
struct PlacedProp {
    prop: Prop,
    depth: f64,
    columns: Range<usize>,
    rows: Range<usize>,
}

impl PlacedProp {
    fn new(prop: Prop, camera: &PtzCamera, image_size: ImageSize) -> Option<Self> {
        let (centre, radius) = prop.bounds();
        let (columns, rows) = area(&[centre], radius, camera, image_size)?;
        let depth = camera.cam_from_world_point(centre).z;
        Some(Self {
            prop,
            depth,
            columns,
            rows,
        })
    }

    /// What a ray meets of it before `limit`, nearest first.
    fn touches(&self, ray: &Ray, limit: f64, stadium: &Stadium, touches: &mut Vec<Touch>) {
        touches.clear();
        let sticks = self
            .prop
            .sticks
            .iter()
            .filter_map(|stick| stick.touch(ray, &stadium.lighting));
        let sheets = self
            .prop
            .sheets
            .iter()
            .filter_map(|sheet| sheet.touch(ray, &stadium.lighting));
        touches.extend(sticks.chain(sheets).filter(|touch| touch.depth < limit));
        touches.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    }

    /// Where it is seen, if it moves.
    fn visible_mover(
        &self,
        caster: &RayCaster<'_>,
        hits: &[RayHit],
        width: usize,
        stadium: &Stadium,
    ) -> Option<SeenMover> {
        // Every pixel is examined once more, because the picture does not tell who covers it.
        // Movers that stand before this one are not subtracted. Without a pixel the box stays
        // inverted, and the subtraction below yields none.
        let mover = self.prop.mover?;
        let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
        let mut touches = Vec::with_capacity(16);
        for y in self.rows.clone() {
            for x in self.columns.clone() {
                let Some(ray) = caster.ray_of_pixel(x, y) else {
                    continue;
                };
                self.touches(&ray, hits[y * width + x].depth, stadium, &mut touches);
                let left: f32 = touches.iter().map(|touch| 1.0 - touch.share).product();
                if 1.0 - left >= MASK_FROM {
                    low = [low[0].min(x), low[1].min(y)];
                    high = [high[0].max(x + 1), high[1].max(y + 1)];
                }
            }
        }
        let area = PixelBox::new(
            low[0] as f64,
            low[1] as f64,
            high[0].checked_sub(low[0])? as f64,
            high[1].checked_sub(low[1])? as f64,
        );
        Some(SeenMover { mover, area })
    }
}

/// The shadow of one prop in one lamp's light.
struct Shadow<'a> {
    prop: &'a Prop,
    lamp: usize,
    columns: Range<usize>,
    rows: Range<usize>,
}

impl Shadow<'_> {
    /// From a place on the ground to the nearest stick that touches it, m.
    fn foot_distance_m(&self, point: Vec3) -> f64 {
        self.prop
            .sticks
            .iter()
            .map(|stick| stick.to)
            .filter(|end| end.z - point.z < 0.25)
            .map(|end| (end - point).xy().norm())
            .fold(f64::INFINITY, f64::min)
    }
}
