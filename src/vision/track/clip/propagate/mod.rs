//! Propagation: the camera of a frame from that of its neighbour, by the points that both show.
//!
//! The rotating camera sees a static point in one direction of `base`, which is estimated as the
//! mean over the frames so far. Pan, tilt and focal length of the next frame are those that project
//! all directions onto the tracked points. A point that does not stand still, such
//! as one on a player or a scrolling board, disagrees with the fit; after three disagreements it is
//! excluded (`march.rs`).

mod march;
mod one_frame;

use super::super::pose_problem::PosePrior;
use super::{ClipCamera, PointTracks};
use march::March;
use touchline_core::camera::Ptz;

/// The conditions under which propagation goes on to the next frame. Lengths are in px at 1920 px
/// width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PropagateOptions {
    /// Maximum distance of a tracked point from the projection of its direction; a point farther
    /// off is an outlier. Default: 3.
    pub agrees_px: f64,
    /// Minimum number of inliers. Default: 20.
    pub min_points: usize,
    /// Minimum share of inliers among the points seen. Default: 0.4.
    pub min_share: f64,
    /// The inliers must extend over at least this share of the picture's width and height. Default:
    /// 0.25.
    pub min_spread: f64,
}

impl Default for PropagateOptions {
    fn default() -> Self {
        Self {
            agrees_px: 3.0,
            min_points: 20,
            min_share: 0.4,
            min_spread: 0.25,
        }
    }
}

/// Why propagation stopped before a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PropagationStop {
    /// The frame that could not be reached, as an index into the clip.
    pub frame: usize,
    /// Its neighbour, the last frame that was reached.
    pub from: usize,
    /// Tracked points with a known direction that the unreached frame shows.
    pub seen: usize,
    /// The inliers among them: points that one rotation and one zoom explain.
    pub agreeing: usize,
}

/// The cameras of a clip's frames after propagation.
#[derive(Clone, Debug, PartialEq)]
pub struct PropagatedClip {
    /// The camera of each frame; `None` for a frame that was not reached.
    pub ptz: Vec<Option<Ptz>>,
    /// The distance between the camera propagated from the known frame before and the one from the
    /// known frame after: px, mean over the corners and the centre of the picture. `None` if only
    /// one side reached the frame.
    pub apart_px: Vec<Option<f64>>,
    /// Where propagation stopped and no other known frame helped, in frame order.
    pub stops: Vec<PropagationStop>,
    /// For each track whether its point moves in the scene; such tracks are outliers.
    pub moving: Vec<bool>,
}

/// Propagates the known cameras forwards and backwards through the clip; each frame takes the
/// result from the nearest known frame.
///
/// If several priors name one frame, the first of them is its known camera.
pub fn propagate(
    camera: &ClipCamera,
    tracks: &PointTracks,
    priors: &[PosePrior],
    options: &PropagateOptions,
) -> PropagatedClip {
    let frames = tracks.frames;
    let mut march = March::new(camera, tracks, options);
    // Known cameras, sorted by frame. Priors of frames outside the clip are ignored. The sort is
    // stable: of several priors of one frame the first stays.
    let within = priors.iter().filter(|prior| prior.frame < frames);
    let mut known: Vec<(usize, Ptz)> = within
        .map(|prior| (prior.frame, camera.with_known_focal(prior.frame, prior.ptz)))
        .collect();
    known.sort_by_key(|(frame, _)| *frame);
    known.dedup_by_key(|(frame, _)| *frame);
    // From every known frame, propagate to the neighbouring known frames, these included: what
    // arrives there from both sides shows the accumulated drift.
    let mut forth: Vec<Option<(usize, Ptz)>> = vec![None; frames];
    let mut back = forth.clone();
    for (place, &(frame, ptz)) in known.iter().enumerate() {
        let next = known.get(place + 1).map_or(frames, |next| next.0 + 1);
        let before = place.checked_sub(1).map_or(0, |before| known[before].0);
        for (to, at) in march.propagate(frame, ptz, frame + 1..next) {
            forth[to] = Some((frame, at));
        }
        for (to, at) in march.propagate(frame, ptz, (before..frame).rev()) {
            back[to] = Some((frame, at));
        }
    }
    // Where both directions reached a frame, the nearer known frame wins, because drift grows with
    // the number of steps.
    let mut propagated = PropagatedClip {
        ptz: vec![None; frames],
        apart_px: vec![None; frames],
        stops: Vec::new(),
        moving: Vec::new(),
    };
    for frame in 0..frames {
        propagated.ptz[frame] = match (forth[frame], back[frame]) {
            (Some(forth), Some(back)) => {
                propagated.apart_px[frame] = Some(march.apart_px(frame, forth.1, back.1));
                let is_forth_nearer = frame - forth.0 <= back.0 - frame;
                Some(if is_forth_nearer { forth.1 } else { back.1 })
            }
            (one, other) => one.or(other).map(|(_, ptz)| ptz),
        };
    }
    // Known frames keep their cameras. A stop is worth reporting only if no other known frame
    // reached that frame.
    for (frame, ptz) in known {
        propagated.ptz[frame] = Some(ptz);
    }
    march
        .stops
        .retain(|stop| propagated.ptz[stop.frame].is_none());
    march.stops.sort_by_key(|stop| (stop.frame, stop.from));
    propagated.stops = march.stops;
    propagated.moving = march.moving;
    propagated
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track::{AdjustOptions, ClipLens, PointTrack, PriorSource, adjust_clip};
    use touchline_core::camera::{CameraBase, FocalCurve, PtzCamera};
    use touchline_core::geometry::{ImagePoint, Mat3, Vec3};
    use touchline_core::testing::{SIZE, base_at};

    const FRAMES: usize = 40;

    fn base() -> CameraBase {
        base_at([0.0, -60.0, 18.0], SIZE)
    }

    /// A camera that pans by some degrees from frame to frame.
    fn pointed(frame: usize, pan_deg: f64) -> Ptz {
        Ptz::from_degrees(pan_deg * frame as f64, -12.0, 2400.0)
    }

    /// Points of the scene all over the picture of frame 0, as the turning camera sees them.
    fn scene(pan_deg: f64) -> Vec<PointTrack> {
        let camera = |frame: usize| PtzCamera::new(base().at_origin(), pointed(frame, pan_deg));
        let starts = (0..15).flat_map(|column| (0..12).map(move |row| (column, row)));
        let seen = |(column, row): (u32, u32)| {
            let at = ImagePoint::new(
                60.0 + 128.0 * f64::from(column),
                40.0 + 90.0 * f64::from(row),
            );
            let ray = camera(0).ray_from_image(at).unwrap();
            let points = (0..FRAMES)
                .map(|frame| camera(frame).image_from_ray(ray).unwrap())
                .collect();
            PointTrack { first: 0, points }
        };
        starts.map(seen).collect()
    }

    /// Points of players that run about in the picture, each its own way.
    fn players(count: u32) -> Vec<PointTrack> {
        let run = |player: u32| {
            let (start, way) = (f64::from(player), 2.4 * f64::from(player));
            let (x, y) = (
                (start * 97.0) % 1600.0 + 160.0,
                (start * 53.0) % 800.0 + 140.0,
            );
            let at = |frame: usize| {
                let far = 3.0 * frame as f64;
                ImagePoint::new(x + far * way.cos(), y + far * way.sin())
            };
            PointTrack {
                first: 0,
                points: (0..FRAMES).map(at).collect(),
            }
        };
        (0..count).map(run).collect()
    }

    /// A score bug in a corner: many sharp points that stand still.
    fn graphic() -> Vec<PointTrack> {
        let corner = (0..20).flat_map(|column| (0..8).map(move |row| (column, row)));
        let still = |(column, row): (u32, u32)| {
            let at = ImagePoint::new(
                80.0 + 15.0 * f64::from(column),
                50.0 + 12.0 * f64::from(row),
            );
            PointTrack {
                first: 0,
                points: vec![at; FRAMES],
            }
        };
        corner.map(still).collect()
    }

    /// How far the tracked cameras are off at most, degrees of pan; every frame has to be reached.
    fn carry_off_deg(tracks: Vec<PointTrack>, pan_deg: f64) -> f64 {
        let tracks = PointTracks {
            image_size: SIZE,
            frames: FRAMES,
            tracks,
        };
        let known = PosePrior::from_covariance(
            0,
            pointed(0, pan_deg),
            &Mat3::identity(),
            PriorSource::Person,
        );
        let propagated = propagate(
            &ClipCamera::new(base()),
            &tracks,
            &[known],
            &PropagateOptions::default(),
        );
        assert_eq!(propagated.stops, [], "every frame is reached");
        let off = |(frame, ptz): (usize, &Option<Ptz>)| {
            ptz.unwrap()
                .pan
                .turn_from(pointed(frame, pan_deg).pan)
                .degrees()
                .abs()
        };
        propagated
            .ptz
            .iter()
            .enumerate()
            .map(off)
            .fold(0.0, f64::max)
    }

    #[test]
    fn a_camera_that_stands_still_is_carried_however_many_players_run() {
        let tracks = [scene(0.0), players(120)].concat();
        let off_deg = carry_off_deg(tracks, 0.0);
        assert!(off_deg < 0.01, "{off_deg}");
    }

    #[test]
    fn a_camera_that_turns_is_followed_past_a_graphic_and_players() {
        for pan_deg in [0.05, 0.3] {
            let tracks = [scene(pan_deg), graphic(), players(60)].concat();
            let off_deg = carry_off_deg(tracks, pan_deg);
            assert!(off_deg < 0.03, "{pan_deg}: {off_deg}");
        }
    }

    /// A zoom in a clip, with the lens that each frame has.
    fn zooming() -> (ClipCamera, Vec<Ptz>) {
        let focal_px = |frame: usize| 2400.0 * 1.004_f64.powi(frame as i32);
        let lens = |frame: usize| ClipLens {
            principal_point: ImagePoint::new(960.0 + 0.4 * frame as f64, 530.0),
            distortion: FocalCurve {
                k2_per_k1_squared: 20.0,
                ..FocalCurve::constant(0.1 + 0.003 * frame as f64)
            },
            focal_px: Some(focal_px(frame)),
        };
        let lenses = (0..FRAMES).map(|frame| Some(lens(frame))).collect();
        let ptz = |frame: usize| {
            Ptz::from_degrees(
                0.1 * frame as f64,
                -12.0 + 0.02 * frame as f64,
                focal_px(frame),
            )
        };
        (
            ClipCamera::with_lenses(base(), lenses),
            (0..FRAMES).map(ptz).collect(),
        )
    }

    #[test]
    fn known_lenses_are_kept_and_pan_and_tilt_found_under_them() {
        let (camera, truth) = zooming();
        let starts = (0..15).flat_map(|column| (0..12).map(move |row| (column, row)));
        let seen = |(column, row): (u32, u32)| {
            let at = ImagePoint::new(
                60.0 + 128.0 * f64::from(column),
                40.0 + 90.0 * f64::from(row),
            );
            let ray = camera.at_origin(0, truth[0]).ray_from_image(at).unwrap();
            let points = truth.iter().enumerate();
            let points = points
                .map(|(frame, ptz)| camera.at_origin(frame, *ptz).image_from_ray(ray).unwrap())
                .collect();
            PointTrack { first: 0, points }
        };
        let tracks = PointTracks {
            image_size: SIZE,
            frames: FRAMES,
            tracks: starts.map(seen).collect(),
        };
        let sigma = 1e-6;
        let covariance =
            Mat3::from_diagonal(&Vec3::new(sigma, sigma, 1.0).map(|sigma| sigma * sigma));
        let known = PosePrior::from_covariance(0, truth[0], &covariance, PriorSource::Person);
        let propagated = propagate(&camera, &tracks, &[known], &PropagateOptions::default());
        let adjusted = adjust_clip(
            &camera,
            &tracks,
            &propagated,
            &[known],
            &AdjustOptions::default(),
        )
        .unwrap();
        for (frame, truth) in truth.iter().enumerate() {
            let (propagated, adjusted) = (
                propagated.ptz[frame].unwrap(),
                adjusted.frames[frame].unwrap(),
            );
            for ptz in [propagated, adjusted.ptz] {
                assert_eq!(ptz.focal_px, truth.focal_px, "frame {frame}");
                let off_deg = (ptz.pan - truth.pan)
                    .degrees()
                    .hypot((ptz.tilt - truth.tilt).degrees());
                assert!(off_deg < 1e-6, "frame {frame}: {off_deg}");
            }
            assert!(
                adjusted.covariance[(2, 2)].sqrt() < 0.01,
                "{}",
                adjusted.covariance
            );
        }
    }
}
