//! The setting of the paper's synthetic experiment: the camera, the ranges of its parameters, and
//! the points that it sees.

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;
use touchline::camera::{CameraBase, Ptz, PtzCamera};
use touchline::field::{FieldError, FieldModel, YARD_M, builtin};
use touchline::geometry::{ImagePoint, ImageSize, Mat3, Vec2, Vec3, rotation};

/// Size of the pictures.
pub const SIZE: ImageSize = ImageSize::new(1280, 720);
/// The ranges of pan and tilt (degrees) and focal length (px).
const PAN_DEG: [f64; 2] = [15.0, 75.0];
const TILT_DEG: [f64; 2] = [-14.0, -5.0];
const FOCAL_PX: [f64; 2] = [1500.0, 5000.0];
/// Number of rays in a picture.
pub const RAYS: usize = 200;
/// Share of the rays to points outside the field, by the paper.
pub const OUTSIDE: f64 = 0.9;
/// Length and width of the paper's field, yards.
pub const FIELD_YD: [f64; 2] = [118.0, 70.0];
/// Half the length and width of the field, m; and the distance of boards and stands from it, m.
const HALF_FIELD_M: [f64; 2] = [53.9496, 32.004];
const AROUND_M: f64 = 8.0;

/// A random generator for one part of an experiment, which `place` identifies. Different places
/// give independent numbers.
pub fn rng(seed: u64, place: [u64; 2]) -> Pcg64Mcg {
    // Multiply and shift, with the constants of SplitMix64, so that neighbouring places get
    // unrelated seeds.
    let mut mixed = seed;
    for number in place {
        mixed = (mixed ^ number.wrapping_add(0x9e37_79b9_7f4a_7c15))
            .wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed ^= mixed >> 29;
    }
    Pcg64Mcg::seed_from_u64(mixed)
}

/// The base of the published sequence `soccer2_seq2`, with the origin moved from the field's corner
/// to its centre. The camera is low behind the corner and looks across the field.
pub fn base() -> CameraBase {
    let position_m = Vec3::new(
        114.32318 - HALF_FIELD_M[0],
        1.114215 - HALF_FIELD_M[1],
        6.375646,
    );
    let base_from_world: Mat3 =
        rotation::from_rotation_vector(Vec3::new(1.230319, 1.129962, -1.157628));
    CameraBase::new(position_m, base_from_world, SIZE.centre())
}

/// A soccer field of this length and width, yards, without a crown.
///
/// # Errors
/// The template allows no such size.
pub fn field_of_yards(sides_yd: [f64; 2]) -> Result<FieldModel, FieldError> {
    let names = ["length_m", "width_m"].map(str::to_owned);
    let sides_m = sides_yd.map(|side| side * YARD_M);
    builtin("soccer")?.model(&names.into_iter().zip(sides_m).collect(), 0.0)
}

/// A camera pose drawn uniformly from the ranges.
pub fn random_ptz(rng: &mut Pcg64Mcg) -> Ptz {
    // Pan, tilt, focal length: another order would draw other cameras from the same seed.
    let mut within = |[from, to]: [f64; 2]| rng.random_range(from..to);
    Ptz::from_degrees(within(PAN_DEG), within(TILT_DEG), within(FOCAL_PX))
}

/// A standard normal number.
pub fn normal(rng: &mut Pcg64Mcg) -> f64 {
    rng.sample(StandardNormal)
}

/// Three independent standard normal numbers.
pub fn normals(rng: &mut Pcg64Mcg) -> Vec3 {
    Vec3::from_fn(|_, _| normal(rng))
}

/// A pixel and the world point that it shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correspondence {
    pub image: ImagePoint,
    pub world: Vec3,
    /// Whether the point is on the field.
    pub on_field: bool,
}

impl Correspondence {
    /// Adds normal noise to both coordinates of the pixel, with this 1-σ, px.
    pub fn noisy(&self, sigma_px: f64, rng: &mut Pcg64Mcg) -> Self {
        let offset = Vec2::new(normal(rng), normal(rng)) * sigma_px;
        Self {
            image: self.image.translate(offset),
            ..*self
        }
    }
}

/// The world points at [`RAYS`] random pixels. Nine in ten are outside the field, unless the
/// picture shows too little of the outside; then others fill up.
pub fn correspondences(camera: &PtzCamera, rng: &mut Pcg64Mcg) -> Vec<Correspondence> {
    let outside = (RAYS as f64 * OUTSIDE) as usize;
    let (mut wanted, mut spare) = (Vec::with_capacity(RAYS), Vec::new());
    // What is still wanted, by whether the point lies on the field.
    let mut counts = [outside, RAYS - outside];
    // A limit, because a picture full of the field never shows enough of the outside.
    for _ in 0..20 * RAYS {
        if wanted.len() == RAYS {
            break;
        }
        let (x, y) = (
            rng.random_range(0.0..f64::from(SIZE.width)),
            rng.random_range(0.0..f64::from(SIZE.height)),
        );
        let Some(correspondence) = correspondence(camera, ImagePoint::new(x, y)) else {
            continue;
        };
        let count = &mut counts[usize::from(correspondence.on_field)];
        if *count > 0 {
            *count -= 1;
            wanted.push(correspondence);
        } else if spare.len() < RAYS {
            spare.push(correspondence);
        }
    }
    // Too many of one kind are better than fewer rays.
    let missing = RAYS - wanted.len();
    wanted.extend(spare.into_iter().take(missing));
    wanted
}

/// The world point at a pixel: on the ground if that is nearer than the boards, otherwise on the
/// vertical wall of boards and stands.
fn correspondence(camera: &PtzCamera, image: ImagePoint) -> Option<Correspondence> {
    let from = camera.base().position_m;
    let direction = camera.world_direction_from_image(image).ok()?;
    // The distance to the wall that the ray goes towards, along each axis, in lengths of
    // `direction`. A ray that is parallel to a wall divides by 0 and is infinitely far from it.
    let to_wall = (0..2)
        .map(|axis| {
            let wall = (HALF_FIELD_M[axis] + AROUND_M).copysign(direction[axis]);
            (wall - from[axis]) / direction[axis]
        })
        .filter(|distance| *distance > 0.0)
        .fold(f64::INFINITY, f64::min);
    // Rays that do not fall meet no ground.
    let to_ground = if direction.z < 0.0 {
        -from.z / direction.z
    } else {
        f64::INFINITY
    };
    let world = from + direction * to_wall.min(to_ground);
    let on_field =
        to_ground < to_wall && (0..2).all(|axis| world[axis].abs() <= HALF_FIELD_M[axis]);
    world
        .iter()
        .all(|x| x.is_finite())
        .then_some(Correspondence {
            image,
            world,
            on_field,
        })
}
