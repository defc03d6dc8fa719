//! Cameras as other programs give them: one for each frame, most nearly right, some off over a
//! stretch, some absurd.

use rand::{RngExt as _, SeedableRng as _};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;
use touchline::camera::{BaseAngles, CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline::document::{
    Camera, CameraId, Document, FramePtz, FrameStatus, Solution, SolutionSource,
};
use touchline::geometry::{Angle, Vec3};

/// How wrong the given cameras are.
#[derive(Clone, Copy)]
pub struct Faults {
    /// 1-σ of each frame's position along each axis, m.
    pub position_m: Vec3,
    /// 1-σ of its pan and tilt, degrees.
    pub turn_deg: f64,
    /// 1-σ of its focal length, a share.
    pub focal: f64,
    /// The share of frames that are 10 to 60 px off, in stretches.
    pub off: f64,
    /// The share of frames with an absurd camera.
    pub absurd: f64,
    /// Whether all cameras are mirrored.
    pub mirrored: bool,
    /// The frames of a close-up, from the first to before the second: their cameras are invented.
    pub close_up: [usize; 2],
}

/// A clip whose program is good: small scatter, two bad stretches.
pub const GOOD: Faults = Faults {
    position_m: Vec3::new(0.15, 0.3, 0.15),
    turn_deg: 0.04,
    focal: 0.004,
    off: 0.2,
    absurd: 0.05,
    mirrored: false,
    close_up: [0, 0],
};

/// Cameras that scatter from frame to frame.
pub const SCATTERED: Faults = Faults {
    position_m: Vec3::new(0.3, 0.6, 0.3),
    turn_deg: 0.5,
    focal: 0.02,
    off: 0.0,
    absurd: 0.1,
    mirrored: false,
    close_up: [0, 0],
};

/// The length of a bad stretch, frames.
const STRETCH: usize = 20;

/// Gives each frame of a document its true camera with these faults, without its lens.
pub fn give(document: &mut Document, truth: &[PtzCamera], faults: &Faults, seed: u64) {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let stretches = (faults.off * truth.len() as f64 / STRETCH as f64).round() as usize;
    // Stretches do not touch each other.
    let parts = stretches.max(1);
    let begins: Vec<usize> = (0..stretches)
        .map(|part| {
            let [from, to] = [part, part + 1].map(|part| part * truth.len() / parts);
            random.random_range(from..(to - STRETCH).max(from + 1))
        })
        .collect();
    let mut turned_px = vec![[0.0; 2]; truth.len()];
    for begin in begins {
        let [pan, tilt] = [0, 1].map(|_| {
            let px = random.random_range(10.0..60.0_f64) / 2.0_f64.sqrt();
            if random.random_bool(0.5) { px } else { -px }
        });
        for off in turned_px.iter_mut().skip(begin).take(STRETCH) {
            *off = [pan, tilt];
        }
    }
    document.cameras.clear();
    for (index, camera) in truth.iter().enumerate() {
        let mut normal = || random.sample::<f64, _>(StandardNormal);
        let ptz = camera.ptz();
        let turn =
            |deg: f64, px: f64| Angle::from_degrees(deg) + Angle::from_radians(px / ptz.focal_px);
        let mut given = Ptz {
            pan: ptz.pan + turn(faults.turn_deg * normal(), turned_px[index][0]),
            tilt: ptz.tilt + turn(faults.turn_deg * normal(), turned_px[index][1]),
            focal_px: ptz.focal_px * (1.0 + faults.focal * normal()),
        };
        let off_m = Vec3::from_fn(|axis, _| faults.position_m[axis] * normal());
        let mut base = CameraBase {
            position_m: camera.base().position_m + off_m,
            distortion: FocalCurve::NONE,
            ..*camera.base()
        };
        if random.random_bool(faults.absurd) {
            match index % 3 {
                0 => given.focal_px = 3e6,
                1 => base.position_m.z = -4.0,
                _ => base.position_m *= 9.0,
            }
        }
        if faults.mirrored {
            let reflection = Vec3::new(-1.0, 1.0, 1.0);
            base.position_m.component_mul_assign(&reflection);
            let reflect = touchline::geometry::Mat3::from_diagonal(&reflection);
            base.base_from_world = reflect * base.base_from_world * reflect;
            given.pan = -given.pan;
        }
        let id = CameraId::from(format!("main-{index}").as_str());
        let frame = &mut document.frames[index];
        let mut own = Camera::new(id.clone(), frame.image_size);
        own.set_base(&base);
        document.cameras.push(own.into());
        frame.camera = id;
        frame.ptz = Some(FramePtz::new(given, None));
        frame.status = FrameStatus::Suggested;
        frame.solution = Some(Solution {
            source: Some(SolutionSource::Import),
            ..Solution::default()
        });
    }
    invent(document, faults.close_up, seed);
}

/// Gives some frames cameras that nobody filmed with.
fn invent(document: &mut Document, [from, to]: [usize; 2], seed: u64) {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    for index in from..to {
        let mut within = |most: f64| random.random_range(-most..most);
        let at_m = Vec3::new(within(40.0), -70.0 + within(30.0), 20.0 + within(12.0));
        let turn = BaseAngles {
            heading: Angle::from_degrees(within(20.0)),
            ..BaseAngles::default()
        };
        let base = CameraBase {
            distortion: FocalCurve::NONE,
            ..CameraBase::new(
                at_m,
                turn.base_from_world(),
                document.frames[index].image_size.centre(),
            )
        };
        let ptz = Ptz::from_degrees(within(30.0), -14.0 + within(6.0), 1500.0 + within(700.0));
        let id = document.frames[index].camera.clone();
        document.camera_mut(&id).unwrap().set_base(&base);
        document.frames[index].ptz = Some(FramePtz::new(ptz, None));
    }
}
