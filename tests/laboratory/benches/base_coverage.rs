//! Whether what is stated of a base holds: cameras are drawn, bases estimated from clicked frames,
//! and the overlay of further frames is compared with the truth at places that nobody clicked.
//!
//! `cargo bench --profile dev --bench base_coverage -- [--bases N]`. Lens, crown and principal
//! point are drawn from their priors, clicks with each landmark's own noise. A row says how often
//! the truth lies within the stated 68 % region (χ² of two degrees of freedom), and how often
//! beyond two stated σ.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    missing_docs,
    reason = "a bench prints, and fails by stopping"
)]

#[allow(dead_code, reason = "other benches have sections")]
#[path = "../../benches/arguments.rs"]
mod arguments;

use arguments::Arguments;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use touchline::camera::{BaseAngles, CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline::field::{FieldElement, FieldModel, builtin};
use touchline::geometry::rotation::from_rotation_vector;
use touchline::geometry::{Angle, ImagePoint, ImageSize, Vec2, Vec3, median};
use touchline::progress::Progress;
use touchline::solve::base::{BaseOptions, BasePriors, CameraClicks, FrameClicks, estimate_base};
use touchline::solve::{Observation, SolveContext, solve_frame};

const SIZE: ImageSize = ImageSize::new(1920, 1080);

/// Frames of each drawn camera that the base is not estimated from.
const FURTHER: usize = 6;

/// χ² of two degrees of freedom: 68.27 % and 95.45 %.
const WITHIN_68: f64 = 2.2957;
const WITHIN_2_SIGMA: f64 = 6.1801;

/// Where cameras stand.
#[derive(Clone, Copy)]
struct CameraSite {
    name: &'static str,
    position_m: [f64; 3],
    heading_deg: f64,
    pan_deg: f64,
    tilt_deg: [f64; 2],
    focal_px: [f64; 2],
    lean_deg: f64,
}

const PLACES: [CameraSite; 3] = [
    CameraSite {
        name: "main stand",
        position_m: [0.0, -75.0, 18.0],
        heading_deg: 0.0,
        pan_deg: 35.0,
        tilt_deg: [-16.0, -9.0],
        focal_px: [1800.0, 4500.0],
        lean_deg: 0.4,
    },
    CameraSite {
        name: "behind the goal",
        position_m: [-95.0, 0.0, 20.0],
        heading_deg: 90.0,
        pan_deg: 15.0,
        tilt_deg: [-18.0, -10.0],
        focal_px: [1500.0, 3000.0],
        lean_deg: 1.5,
    },
    CameraSite {
        name: "corner",
        position_m: [-75.0, -55.0, 15.0],
        heading_deg: 52.0,
        pan_deg: 20.0,
        tilt_deg: [-14.0, -8.0],
        focal_px: [1500.0, 3500.0],
        lean_deg: 1.5,
    },
];

struct Draw {
    rng: Pcg64Mcg,
}

impl Draw {
    fn normal(&mut self, mean: f64, sigma: f64) -> f64 {
        Normal::new(mean, sigma).unwrap().sample(&mut self.rng)
    }

    fn between(&mut self, range: [f64; 2]) -> f64 {
        self.rng.random_range(range[0]..range[1])
    }

    /// A camera at a place, and its field, with lens, crown and principal point from their priors.
    fn camera(&mut self, place: &CameraSite) -> (CameraBase, FieldModel) {
        let priors = BasePriors::default();
        let [x, y, z] = place.position_m;
        let position_m = Vec3::new(
            x + self.normal(0.0, 3.0),
            y + self.normal(0.0, 3.0),
            z + self.normal(0.0, 1.5),
        );
        let upright = BaseAngles {
            heading: Angle::from_degrees(place.heading_deg),
            ..BaseAngles::default()
        };
        let lean = |draw: &mut Self| draw.normal(0.0, place.lean_deg).to_radians();
        let leaning = from_rotation_vector(Vec3::new(lean(self), lean(self), 0.0));
        let centre = SIZE.centre();
        let off = Vec2::new(
            self.normal(0.0, priors.principal_point_px),
            self.normal(0.0, priors.principal_point_px),
        );
        let distortion = FocalCurve {
            at_focal_px: 2000.0,
            value: self.normal(priors.k1.0, priors.k1.1),
            per_1000_px: self.normal(priors.k1_slope.0, priors.k1_slope.1),
            k2_per_k1_squared: FocalCurve::WITHOUT_FOLD,
            ..FocalCurve::NONE
        };
        let base = CameraBase::new(
            position_m,
            upright.base_from_world() * leaning,
            centre.translate(off),
        );
        let crown_m = self.normal(priors.crown_m.0, priors.crown_m.1).max(0.0);
        let field = FieldModel {
            crown_m,
            ..builtin("soccer").unwrap().default_model().unwrap()
        };
        (CameraBase { distortion, ..base }, field)
    }

    /// Clicks of a frame that shows enough landmarks: at most `most` of them.
    fn frame(
        &mut self,
        base: &CameraBase,
        field: &FieldModel,
        place: &CameraSite,
        most: usize,
    ) -> (Ptz, FrameClicks) {
        loop {
            let pan = self.between([-place.pan_deg, place.pan_deg]);
            let pan = pan
                + if place.heading_deg == 0.0 {
                    0.0
                } else {
                    place.heading_deg
                };
            let ptz = Ptz::from_degrees(
                pan,
                self.between(place.tilt_deg),
                self.between(place.focal_px),
            );
            let camera = PtzCamera::new(in_gauge(base), ptz);
            let mut clicks = self.clicks(&camera, field);
            if clicks.len() < 4 {
                continue;
            }
            while clicks.len() > most {
                let out = self.rng.random_range(0..clicks.len());
                clicks.remove(out);
            }
            return (
                ptz,
                FrameClicks {
                    observations: clicks,
                    start: None,
                },
            );
        }
    }

    fn clicks(&mut self, camera: &PtzCamera, field: &FieldModel) -> Vec<Observation> {
        let mut clicks = Vec::new();
        let flat = FieldModel {
            crown_m: 0.13,
            ..field.clone()
        };
        for landmark in field
            .landmarks
            .iter()
            .filter(|landmark| landmark.nominal_m.z == 0.0)
        {
            let Ok(seen) = camera.image_from_world(field.landmark_in_world(landmark)) else {
                continue;
            };
            if !SIZE.contains(seen) {
                continue;
            }
            let noise = Vec2::new(
                self.normal(0.0, landmark.click_sigma_px),
                self.normal(0.0, landmark.click_sigma_px),
            );
            let name = landmark.id.as_str();
            clicks.extend(Observation::from_landmark(
                &flat,
                name,
                seen.translate(noise),
                SIZE,
                clicks.len(),
            ));
        }
        clicks
    }
}

/// The base in the pan gauge that estimates have.
fn in_gauge(base: &CameraBase) -> CameraBase {
    base.in_pan_gauge().0
}

#[derive(Default)]
struct Counts {
    places: usize,
    within_68: usize,
    beyond_2: usize,
    failed: usize,
    stated_px: Vec<f64>,
    off_px: Vec<f64>,
}

impl Counts {
    fn add(mut self, other: Self) -> Self {
        self.places += other.places;
        self.within_68 += other.within_68;
        self.beyond_2 += other.beyond_2;
        self.failed += other.failed;
        self.stated_px.extend(other.stated_px);
        self.off_px.extend(other.off_px);
        self
    }
}

/// One drawn camera: its base from some frames, and what is stated of further ones.
fn measure(place: &CameraSite, frames: usize, most: usize, seed: u64) -> Counts {
    let mut draw = Draw {
        rng: Pcg64Mcg::seed_from_u64(seed),
    };
    let (truth, field) = draw.camera(place);
    let clicked: Vec<FrameClicks> = (0..frames)
        .map(|_| draw.frame(&truth, &field, place, 8).1)
        .collect();
    let nominal = FieldModel {
        crown_m: 0.13,
        ..field.clone()
    };
    let mut counts = Counts::default();
    let Ok(found) = estimate_base(
        &CameraClicks::with_centred_principal_point(&nominal, &clicked, SIZE),
        None,
        &BaseOptions::default(),
        &Progress::default(),
    ) else {
        counts.failed = 1;
        return counts;
    };
    let crowned = FieldModel {
        crown_m: found.crown_m,
        ..field.clone()
    };
    for _ in 0..FURTHER {
        let (ptz, clicks) = draw.frame(&truth, &field, place, most);
        let true_camera = PtzCamera::new(in_gauge(&truth), ptz);
        let on_found_field = |click: &Observation| {
            let FieldElement::Landmark(landmark) = click.element? else {
                return None;
            };
            Observation::from_landmark(
                &crowned,
                nominal.landmarks[landmark].id.as_str(),
                click.image,
                SIZE,
                click.click,
            )
            .ok()
        };
        let moved: Vec<Observation> = clicks
            .observations
            .iter()
            .filter_map(on_found_field)
            .collect();
        let Ok(solved) = solve_frame(&found.base, &moved, &SolveContext::new(SIZE)) else {
            continue;
        };
        let camera = PtzCamera::new(found.base, solved.ptz);
        for (column, row) in (0..6).flat_map(|column| (0..4).map(move |row| (column, row))) {
            let at = ImagePoint::new(
                160.0 + 320.0 * f64::from(column),
                135.0 + 270.0 * f64::from(row),
            );
            let Some(ground) = true_camera
                .plane_from_image(at, 0.0)
                .filter(|at| on_field(&field, at))
            else {
                continue;
            };
            let [drawn, shown] = [&crowned, &field]
                .map(|field| Vec3::new(ground.x, ground.y, height_m(field, ground.y)));
            let (Ok(drawn_px), Ok(shown_px)) = (
                camera.image_from_world(drawn),
                true_camera.image_from_world(shown),
            ) else {
                continue;
            };
            let Some(stated) = solved.uncertainty.overlay_at_world(&camera, drawn) else {
                continue;
            };
            let off = drawn_px.offset_from(shown_px);
            let squared = off.dot(&(stated.try_inverse().unwrap() * off));
            counts.places += 1;
            counts.within_68 += usize::from(squared <= WITHIN_68);
            counts.beyond_2 += usize::from(squared > WITHIN_2_SIGMA);
            counts.stated_px.push(stated.trace().sqrt());
            counts.off_px.push(off.norm());
        }
    }
    counts
}

fn on_field(field: &FieldModel, at: &Vec3) -> bool {
    at.x.abs() <= 0.5 * field.length_m && at.y.abs() <= 0.5 * field.width_m
}

fn height_m(field: &FieldModel, y_m: f64) -> f64 {
    -field.crown_m * field.crown().drop_share(y_m)
}

fn main() {
    let bases = Arguments::of_process().number("--bases", 60) as u64;
    println!(
        "| camera | clicked frames | clicks of a further frame | within 68 % | beyond 2 σ | stated px | off px | no base |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for place in PLACES {
        for (frames, most) in [(3, 6), (8, 6), (20, 6), (20, 2)] {
            let seeds = (0..bases)
                .into_par_iter()
                .map(|seed| measure(&place, frames, most, 1000 * frames as u64 + seed));
            let mut counts = seeds.reduce(Counts::default, Counts::add);
            let share = |count: usize| 100.0 * count as f64 / counts.places.max(1) as f64;
            let (within, beyond) = (share(counts.within_68), share(counts.beyond_2));
            let [stated, off] = [&mut counts.stated_px, &mut counts.off_px]
                .map(|px| median(px).unwrap_or(f64::NAN));
            println!(
                "| {} | {frames} | {most} | {within:.1} % | {beyond:.1} % | {stated:.2} | {off:.2} | {} of {bases} |",
                place.name, counts.failed
            );
        }
    }
}
