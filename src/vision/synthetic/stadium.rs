//! The stadium: what a ray sees of it, and the pictures that a camera takes of a match in it.

use super::boards::Boards;
use super::body::Kits;
use super::bowl::{Bowl, BowlHit};
use super::courts::boards_m;
use super::crowd::Crowd;
use super::floor::ceiling_lamps;
use super::grass::Ground;
use super::light::{Light, Lighting, mix};
use super::options::{Moment, StadiumOptions};
use super::play::{Play, Squad};
use super::props::{Prop, fixtures};
use super::ray::{PlaneHit, Ray};
use super::texture::sub_seed;
use touchline_core::field::FieldModel;
use touchline_core::geometry::Vec3;

/// A drawn stadium with its match: grass, painted lines, boards, stands, goals, flags, players.
#[derive(Clone, Debug)]
pub struct Stadium {
    pub(super) options: StadiumOptions,
    pub(super) play: Play,
    pub(super) kits: Kits,
    pub(super) lighting: Lighting,
    pub(super) fixtures: Vec<Prop>,
    ground: Ground,
    boards: Boards,
    bowl: Bowl,
    crowd: Crowd,
}

/// Builds a stadium; the same options build the same one.
pub fn stadium(options: &StadiumOptions) -> Stadium {
    let field = &options.field;
    let squad = options
        .scene
        .court()
        .map_or(Squad::SOCCER, |court| court.squad);
    let kits = Kits::from_seed(sub_seed(options.seed, 0x4175));
    Stadium {
        play: Play::new(options.seed, field.length_m, field.width_m, squad),
        lighting: Lighting::new(options.daylight, field),
        fixtures: fixtures(options),
        ground: Ground::new(options),
        boards: Boards::new(options.seed, field, boards_m(options.scene)),
        bowl: Bowl::new(field),
        crowd: Crowd::new(
            options.seed,
            options.attendance,
            kits.home.shirt,
            kits.away.shirt,
        ),
        kits,
        options: options.clone(),
    }
}

/// What a ray sees of what stands still.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayHit {
    pub light: Light,
    pub depth: f64,
    /// Pixels that see different surfaces share an edge, which is then drawn more finely.
    pub surface: u8,
}

/// [`RayHit::surface`] of the grass.
pub(super) const GRASS: u8 = 1;
const APRON: u8 = 2;
const SKY: u8 = 3;
const BOWL: u8 = 4;
const BOARDS: u8 = 16;

impl Stadium {
    /// The options it was built from.
    pub const fn options(&self) -> &StadiumOptions {
        &self.options
    }

    /// The field, as it is painted.
    pub const fn field(&self) -> &FieldModel {
        &self.options.field
    }

    /// The same stadium at another moment: ground, lines, stands and players are as they were.
    /// Moments add up: of people and boards that changed before, those stay changed that do not
    /// change again.
    #[must_use]
    pub fn at(&self, moment: &Moment) -> Self {
        let mut stadium = self.clone();
        let occasion = self.options.seed.wrapping_add(moment.occasion);
        stadium
            .boards
            .change(sub_seed(occasion, 0xB0C4), moment.boards_changed as f32);
        stadium.crowd.change(sub_seed(occasion, 0xC2D4), moment);
        stadium
    }

    /// The ground, stands, boards and sky along a ray.
    pub(super) fn look(&self, ray: &Ray) -> RayHit {
        // The order spares work: boards hide the ground behind them, the grass inside the boards
        // lies before all stands, and only the rest needs the bowl.
        let ground = self.ground_along(ray);
        if let Some(board) = self
            .boards
            .meets(ray)
            .filter(|b| ground.is_none_or(|g| b.at.depth < g.depth))
        {
            let surface = BOARDS.saturating_add(self.boards.number(&board));
            return RayHit {
                light: self.boards.colour(&board),
                depth: board.at.depth,
                surface,
            };
        }
        if let Some(hit) = ground.filter(|hit| self.ground.is_inside_boards(hit.point)) {
            return self.lit_ground(ray, &hit, GRASS);
        }
        let stands = self.bowl.meets(ray);
        match (ground, stands) {
            (Some(ground), stands)
                if stands.is_none_or(|stands| ground.depth < stands.at.depth) =>
            {
                self.lit_ground(ray, &ground, APRON)
            }
            (_, Some(stands)) => self.lit_stands(&stands),
            _ => RayHit {
                light: self.lighting.sky_in(ray.direction),
                depth: f64::INFINITY,
                surface: SKY,
            },
        }
    }

    fn lit_ground(&self, ray: &Ray, hit: &PlaneHit, surface: u8) -> RayHit {
        let mut light = self
            .ground
            .albedo(hit)
            .component_mul(&self.lighting.on_ground(hit.point));
        let floor = self.ground.floor_at(hit.point).filter(|_| surface == GRASS);
        // What a smooth floor throws back lies over its own colour.
        if let Some((mirrored, share)) = floor.and_then(|floor| floor.mirror(ray)) {
            light = mix(light, self.mirror_image(&mirrored), share);
        }
        RayHit {
            light,
            depth: hit.depth,
            surface,
        }
    }

    /// What a floor mirrors: the boards, the stands, and the lamps of a hall.
    fn mirror_image(&self, ray: &Ray) -> Light {
        let lamps = match self.options.scene.court() {
            Some(court) if court.is_hall => ceiling_lamps(ray),
            _ => Light::zeros(),
        };
        // The nearest first: boards hide the stands behind them.
        let around = match (self.boards.meets(ray), self.bowl.meets(ray)) {
            (Some(board), _) => self.boards.colour(&board),
            (None, Some(stands)) => self.lit_stands(&stands).light,
            (None, None) => self.lighting.sky_in(ray.direction),
        };
        around + lamps
    }

    fn lit_stands(&self, hit: &BowlHit) -> RayHit {
        let light = self.crowd.colour(hit) * self.lighting.stands;
        RayHit {
            light,
            depth: hit.at.depth,
            surface: BOWL + hit.part as u8,
        }
    }

    /// Where a ray meets the ground, crowned as the field is.
    pub(super) fn ground_along(&self, ray: &Ray) -> Option<PlaneHit> {
        let field = &self.options.field;
        let mut hit = ray.meets(Vec3::zeros(), Vec3::z())?;
        if field.crown_m == 0.0 {
            return Some(hit);
        }
        // Newton on the height above the crowned ground; its slope is a hundredth of the ray's, so
        // four steps are plenty.
        let slope = |y: f64| {
            if y.abs() < 0.5 * field.width_m {
                -8.0 * field.crown_m * y / field.width_m.powi(2)
            } else {
                0.0
            }
        };
        for _ in 0..4 {
            let point = ray.at(hit.depth);
            let above = point.z - field.ground_z(point.y);
            let depth = hit.depth - above / (ray.direction.z - slope(point.y) * ray.direction.y);
            hit = ray.on_plane(depth, Vec3::new(0.0, -slope(point.y), 1.0));
        }
        (hit.depth > 1e-3).then_some(hit)
    }
}
