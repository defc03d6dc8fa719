//! The floor of a court: planks, mats, hard court, clay or ice, what is painted on it below the
//! lines, and how it mirrors the lamps and the stands.

use super::courts::Court;
use super::coverage::{comb, inside, strip};
use super::light::{Light, hex, mix};
use super::paint::Paint;
use super::ray::{PlaneHit, Ray};
use super::text::rasterise;
use super::texture::{Texture, hash, sub_seed, survives, unit, value_noise};
use touchline_core::field::{FieldModel, Template, builtin};
use touchline_core::geometry::Vec3;

/// How a surface looks from near and from afar.
#[derive(Debug)]
pub(super) struct Finish {
    /// Grain: size along x and y, m, and strength.
    pub grain: &'static [(f32, f32, f32)],
    /// Boards or sheets along x: width and length, m, and how much their tone differs.
    boards: [f32; 3],
    /// How dark the seams between them are, 0 to 1.
    seam: f32,
    /// How much of the mirror image a varnish of this kind throws back, 0 to 1.
    gloss: f32,
    /// How much the mirror image is smeared, px.
    smear_px: f64,
    /// How much of the lines' paint is left.
    pub paint_left: f32,
}

/// Width of a seam, m.
const SEAM_M: f64 = 0.003;

/// The finishes, in the order of `Surface`.
const SURFACES: [Finish; 6] = [
    Finish {
        grain: &[(2.5, 3.0, 0.04), (0.5, 0.02, 0.06), (0.12, 0.008, 0.06)],
        boards: [0.07, 1.6, 0.13],
        seam: 0.45,
        gloss: 0.75,
        smear_px: 20.0,
        paint_left: 1.0,
    },
    Finish {
        grain: &[(4.0, 4.0, 0.05), (0.6, 0.6, 0.03), (0.05, 0.05, 0.05)],
        boards: [0.0; 3],
        seam: 0.0,
        gloss: 0.12,
        smear_px: 24.0,
        paint_left: 1.0,
    },
    Finish {
        grain: &[
            (3.0, 5.0, 0.07),
            (2.4, 0.08, 0.07),
            (0.3, 0.25, 0.07),
            (0.06, 0.06, 0.1),
        ],
        boards: [0.0; 3],
        seam: 0.0,
        gloss: 0.0,
        smear_px: 1.0,
        paint_left: 0.86,
    },
    Finish {
        grain: &[(5.0, 5.0, 0.03), (1.3, 0.04, 0.02), (0.05, 1.1, 0.02)],
        boards: [0.0; 3],
        seam: 0.0,
        gloss: 0.9,
        smear_px: 30.0,
        paint_left: 0.95,
    },
    Finish {
        grain: &[(3.0, 3.0, 0.03), (0.04, 0.04, 0.04)],
        boards: [1.8, 15.0, 0.025],
        seam: 0.3,
        gloss: 0.3,
        smear_px: 40.0,
        paint_left: 1.0,
    },
    Finish {
        grain: &[],
        boards: [0.0; 3],
        seam: 0.0,
        gloss: 0.0,
        smear_px: 1.0,
        paint_left: 1.0,
    },
];

/// Lines of one colour: of the court itself or of another on the same floor.
#[derive(Clone, Debug)]
pub(super) struct LineLayer {
    paint: Paint,
    pub colour: Light,
    centre: Vec3,
    is_across: bool,
}

impl LineLayer {
    /// The painted lines of a field, where the field itself lies.
    pub const fn new(paint: Paint, colour: Light) -> Self {
        Self {
            paint,
            colour,
            centre: Vec3::new(0.0, 0.0, 0.0),
            is_across: false,
        }
    }

    /// The share of a pixel that is painted.
    pub fn share(&self, hit: &PlaneHit) -> f32 {
        let hit = PlaneHit {
            point: self.in_own_frame(hit.point - self.centre),
            by_x: self.in_own_frame(hit.by_x),
            by_y: self.in_own_frame(hit.by_y),
            ..*hit
        };
        self.paint.share(&hit) as f32
    }

    /// A vector of the floor in the court's own frame.
    fn in_own_frame(&self, of_floor: Vec3) -> Vec3 {
        if self.is_across {
            // Its x axis lies along −y of the floor.
            Vec3::new(-of_floor.y, of_floor.x, of_floor.z)
        } else {
            of_floor
        }
    }
}

/// The lines of a court and, below them, those of other sports on its floor.
pub(super) fn line_layers(court: &Court, field: &FieldModel) -> Vec<LineLayer> {
    let own_colour = |id: &str| court.lines.iter().position(|(word, _)| id.contains(word));
    // One layer for each colour, so that each has its own paint.
    let own = court.lines.iter().enumerate().map(|(index, (_, colour))| {
        let paint = Paint::new(field, |id| own_colour(id) == Some(index));
        LineLayer::new(paint, hex(*colour))
    });
    let mut layers = Vec::new();
    for other in court.others {
        // A template that ships with the program is read; were it broken, its lines would be
        // missing.
        let Ok(field) = builtin(other.template).and_then(Template::default_model) else {
            continue;
        };
        let paint = Paint::new(&field, |_| true);
        layers.extend(other.centres_m.iter().map(|[x, y]| LineLayer {
            paint: paint.clone(),
            colour: hex(other.colour),
            centre: Vec3::new(*x, *y, 0.0),
            is_across: other.is_across,
        }));
    }
    layers.extend(own);
    layers
}

/// A rectangle along the axes: its middle and half its sides, m.
#[derive(Clone, Copy, Debug)]
struct Area {
    middle: Vec3,
    half: Vec3,
}

impl Area {
    /// The area between two landmarks at opposite corners; `end` stands for `@` in their names.
    fn between(corners: [&str; 2], end: &str, field: &FieldModel) -> Option<Self> {
        let [a, b] = corners.map(|name| field.landmark(&name.replace('@', end)));
        let (a, b) = (a?.nominal_m, b?.nominal_m);
        Some(Self {
            middle: 0.5 * (a + b),
            half: 0.5 * (a - b).abs(),
        })
    }

    fn share(&self, hit: &PlaneHit) -> f32 {
        let offset = hit.point - self.middle;
        // Exact for a box filter along each axis.
        let across_x = strip(offset.x, self.half.x, hit.reach(Vec3::x()));
        let across_y = strip(offset.y, self.half.y, hit.reach(Vec3::y()));
        (across_x * across_y) as f32
    }
}

/// The floor of a court, without its lines.
#[derive(Clone, Debug)]
pub(super) struct Floor {
    seed: u32,
    pub finish: &'static Finish,
    inside: Light,
    around: Light,
    area_colour: Light,
    court: Area,
    areas: Vec<Area>,
    /// Radius of the corners of a rink with boards, m.
    rink_corner_m: Option<f64>,
    logo_m: f64,
    logo: Texture,
}

/// Texels of the logo along its diameter.
const LOGO_TEXELS: usize = 320;

impl Floor {
    pub fn new(seed: u64, court: &Court, field: &FieldModel) -> Self {
        let seed = sub_seed(seed, 0xF100);
        // The seed chooses one of the sport's floors.
        let (surface, colours) = court.floors[hash(seed, 7, 7) as usize % court.floors.len()];
        // The finish is that of its surface, the colours are the hall's.
        let (finish, [inside, around, area_colour]) = (&SURFACES[surface as usize], colours);
        let half = Vec3::new(0.5 * field.length_m, 0.5 * field.width_m, 0.0);
        let areas = court.areas.iter();
        Self {
            seed,
            finish,
            inside: hex(inside),
            around: hex(around),
            area_colour: hex(area_colour),
            court: Area {
                middle: Vec3::zeros(),
                half: half.add_scalar(court.margin_m),
            },
            areas: areas
                .flat_map(|corners| {
                    ["left", "right"].map(|end| Area::between(*corners, end, field))
                })
                .flatten()
                .collect(),
            rink_corner_m: field.params.get("corner_radius_m").copied(),
            logo_m: court.logo_m,
            logo: logo(seed, hex(area_colour)),
        }
    }

    /// Whether a place lies beyond the boards of a rink.
    pub fn is_beyond_rink(&self, point: Vec3) -> bool {
        self.rink_corner_m.is_some_and(|radius_m| {
            let out = [0, 1].map(|axis| point[axis].abs() - (self.court.half[axis] - radius_m));
            let corner = out[0].max(0.0).hypot(out[1].max(0.0));
            corner > radius_m
        })
    }

    /// The reflectance of the floor under a pixel, where `turf` is that of grass.
    pub fn albedo(&self, hit: &PlaneHit, turf: impl FnOnce() -> Light) -> Light {
        let is_turf = self.finish.grain.is_empty();
        let mut colour = if is_turf {
            turf()
        } else {
            mix(self.around, self.inside, self.court.share(hit)) * self.tone(hit)
        };
        let area_colour = if is_turf {
            self.area_colour
        } else {
            self.area_colour * self.tone(hit)
        };
        for area in &self.areas {
            colour = mix(colour, area_colour, 0.93 * area.share(hit));
        }
        self.with_logo(hit, colour)
    }

    /// How bright the material is here, about 1.
    fn tone(&self, hit: &PlaneHit) -> f32 {
        let (x, y) = (hit.point.x as f32, hit.point.y as f32);
        let (reach_x, reach_y) = (hit.reach(Vec3::x()) as f32, hit.reach(Vec3::y()) as f32);
        let mut tone = grain_tone(self.seed, self.finish.grain, [x, y], [reach_x, reach_y]);
        let [width, length, strength] = self.finish.boards;
        if width > 0.0 {
            // Rows are offset against each other, so that the ends of boards do not meet.
            let row = (y / width).floor() as i32;
            let offset = unit(hash(self.seed, row, 3)) * length;
            let board = hash(self.seed, row, ((x + offset) / length).floor() as i32);
            let left = survives(reach_y, width);
            tone += strength * left * (2.0 * unit(board) - 1.0);
            let seam = comb(f64::from(y), f64::from(width), SEAM_M, f64::from(reach_y)) as f32;
            tone *= 1.0 - self.finish.seam * left.max(0.2) * seam;
        }
        tone
    }

    fn with_logo(&self, hit: &PlaneHit, floor: Light) -> Light {
        if self.logo_m == 0.0 {
            return floor;
        }
        let away_m = hit.point.xy().norm() - self.logo_m;
        let (reach_x, reach_y) = (hit.reach(Vec3::x()), hit.reach(Vec3::y()));
        let share = inside(away_m as f32, reach_x.max(reach_y) as f32);
        if share == 0.0 {
            return floor;
        }
        let texels_per_m = 0.5 * LOGO_TEXELS as f64 / self.logo_m;
        let picture = self.logo.sample(
            ((hit.point.x + self.logo_m) * texels_per_m) as f32,
            ((self.logo_m - hit.point.y) * texels_per_m) as f32,
            (reach_x * texels_per_m) as f32,
            (reach_y * texels_per_m) as f32,
        );
        mix(floor, picture, 0.95 * share)
    }

    /// What the floor mirrors: the ray from below it, and the share of its light that comes back.
    pub fn mirror(&self, ray: &Ray) -> Option<(Ray, f32)> {
        if self.finish.gloss == 0.0 {
            return None;
        }
        // The camera below the floor sees what the camera above it sees in the mirror. Schlick's
        // approximation of Fresnel's share, with 0.04 at right angles for varnish and ice ("An
        // inexpensive BRDF model for physically-based rendering", 1994).
        // The cosine of the angle from the normal.
        let steepness = (-ray.direction.z / ray.direction.norm()) as f32;
        let share = 0.04 + 0.96 * (1.0 - steepness.clamp(0.0, 1.0)).powi(5);
        let mirrored = Ray {
            origin: mirror_in_floor(ray.origin),
            direction: mirror_in_floor(ray.direction),
            by_x: mirror_in_floor(ray.by_x) * self.finish.smear_px,
            by_y: mirror_in_floor(ray.by_y) * self.finish.smear_px,
        };
        Some((mirrored, share * self.finish.gloss))
    }
}

/// The mirror image of a point or direction in the plane z = 0.
fn mirror_in_floor(of: Vec3) -> Vec3 {
    Vec3::new(of.x, of.y, -of.z)
}

/// Octaves of noise, each as far as the pixel leaves it: grain finer than a pixel fades to its
/// mean, 0, instead of aliasing.
pub(super) fn grain_tone(
    seed: u32,
    grain: &[(f32, f32, f32)],
    [x, y]: [f32; 2],
    [reach_x, reach_y]: [f32; 2],
) -> f32 {
    let mut tone = 1.0;
    for (octave, (size_x, size_y, strength)) in grain.iter().enumerate() {
        let left = survives(reach_x, *size_x) * survives(reach_y, *size_y);
        if left > 0.0 {
            let seed = seed ^ (octave as u32 + 1).wrapping_mul(0x0123_4567);
            // Turned a little, so that the lattice does not line up with the lines.
            let (u, v) = (x + 0.13 * y, y - 0.13 * x);
            tone += strength * left * value_noise(seed, u / size_x, v / size_y);
        }
    }
    tone
}

/// The lamps under the ceiling of a hall, mirrored by a floor: how bright they are along a ray.
pub(super) fn ceiling_lamps(ray: &Ray) -> Light {
    // Rows of lamps of 1.4 × 0.8 m, 14 m up, 9 m apart along the hall and 6 m across; 8 is their
    // light where paper in full light is 1.
    let Some(hit) = ray.meets(Vec3::z() * 14.0, Vec3::z()) else {
        return Light::zeros();
    };
    let along = comb(hit.point.x, 9.0, 1.4, hit.reach(Vec3::x()));
    let across = comb(hit.point.y, 6.0, 0.8, hit.reach(Vec3::y()));
    Light::repeat((8.0 * along * across) as f32)
}

/// The logo of the hall: a ring with a word across it.
fn logo(seed: u32, colour: Light) -> Texture {
    // Names that belong to no club.
    let words = ["HARBOUR", "NORTH", "OLD TOWN", "LAKESIDE"];
    let word = rasterise(words[seed as usize % words.len()], 38.0, 3.0);
    let half = LOGO_TEXELS as f32 / 2.0;
    let (left, top) = (
        (LOGO_TEXELS as i64 - word.width as i64) / 2,
        (LOGO_TEXELS as i64 - word.height as i64) / 2,
    );
    let white = hex(0xEE_EEEA);
    Texture::paint(LOGO_TEXELS, LOGO_TEXELS, |x, y| {
        let away = (x as f32 + 0.5 - half).hypot(y as f32 + 0.5 - half) / half;
        let ring = inside((away - 0.86).abs() - 0.05, 0.01);
        let ink = ring.max(word.at(x as i64 - left, y as i64 - top));
        mix(colour * 0.8, white, ink)
    })
}
