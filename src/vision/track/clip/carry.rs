//! Carrying: a frame's camera from that of the frame beside it, by the points that both show.
//!
//! A point is taken as a direction in which the camera sees it, the mean of what the frames so far
//! say. The next frame's pan, tilt and focal length are those that put all directions where the
//! points are. What is not still, such as a player or a moving board, disagrees and is left out
//! from then on.

use super::super::pose_prior::{PosePrior, moved};
use super::super::pose_problem::KNOWN_FOCAL_SIGMA;
use super::camera::ClipCamera;
use super::{PointTrack, PointTracks};
use nalgebra::{SMatrix, SVector};
use std::collections::BTreeSet;
use touchline_core::camera::{CameraBase, PanTilt, Ptz, PtzCamera, image_space_distances_px};
use touchline_core::field::FieldElement;
use touchline_core::geometry::{ImagePoint, Vec2, Vec3, median};
use touchline_core::solve::{
    BlockEquations, Linearised, Loss, Problem, Residual, Stopping, minimise,
};

/// When a frame is no longer carried on to. Lengths are px at 1920 px width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarryOptions {
    /// A point farther from where its direction puts it is none of the scene. 3 by default.
    pub agrees_px: f64,
    /// So many points agree at least. 20 by default.
    pub min_points: usize,
    /// Such a share of the points seen agrees at least. .4 by default.
    pub min_share: f64,
    /// The points that agree cover at least this share of the picture's width and height. .25 by
    /// default.
    pub min_spread: f64,
}

impl Default for CarryOptions {
    fn default() -> Self {
        Self {
            agrees_px: 3.0,
            min_points: 20,
            min_share: 0.4,
            min_spread: 0.25,
        }
    }
}

/// Why cameras were not carried into a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarryStop {
    /// The frame that could not be reached, by its place in the clip.
    pub frame: usize,
    /// The frame beside it, which was.
    pub from: usize,
    /// Points that could be followed between the two.
    pub seen: usize,
    /// Those of them that one turn and one zoom explain.
    pub agreeing: usize,
}

/// The cameras of a clip's frames as they were carried.
#[derive(Clone, Debug, PartialEq)]
pub struct Carried {
    /// Each frame's camera; none for one that was not reached.
    pub ptz: Vec<Option<Ptz>>,
    /// How far apart the cameras are that were carried from the known one before and from the one
    /// after, px in the mean over the picture; none where only one side reached the frame.
    pub apart_px: Vec<Option<f64>>,
    /// Where it stopped, in the order of the frames.
    pub stops: Vec<CarryStop>,
    /// The tracks that are of something that moves, by their places.
    pub moving: Vec<bool>,
}

/// Disagreeing this often, a point is of something that moves.
const STRIKES: u8 = 3;

/// A point that has moved by no more since it was first seen may be of a graphic, px at 1920 px
/// width.
const MOVED_PX: f64 = 1.0;

/// The scales of the robust loss, one after the other, px at 1920 px width.
const SCALES_PX: [f64; 4] = [24.0, 6.0, 2.0, 1.0];

/// Carries the cameras that are known to all frames that can be reached from them, each from the
/// nearest one.
#[must_use]
pub fn carry(
    camera: &ClipCamera,
    tracks: &PointTracks,
    priors: &[PosePrior],
    options: &CarryOptions,
) -> Carried {
    let frames = tracks.frames;
    let mut march = March {
        camera,
        tracks,
        by_frame: tracks.by_frame(),
        px: tracks.image_size.scale_from_1920(),
        options,
        moving: vec![false; tracks.tracks.len()],
        stops: Vec::new(),
    };
    let within = priors.iter().filter(|prior| prior.frame < frames);
    let mut known: Vec<(usize, Ptz)> = within
        .map(|prior| (prior.frame, camera.with_known_focal(prior.frame, prior.ptz)))
        .collect();
    known.sort_by_key(|(frame, _)| *frame);
    known.dedup_by_key(|(frame, _)| *frame);
    let mut forth: Vec<Option<(usize, Ptz)>> = vec![None; frames];
    let mut back = forth.clone();
    for (place, &(frame, ptz)) in known.iter().enumerate() {
        let next = known.get(place + 1).map_or(frames, |next| next.0 + 1);
        let before = place.checked_sub(1).map_or(0, |before| known[before].0);
        for (to, at) in march.carried(frame, ptz, frame + 1..next) {
            forth[to] = Some((frame, at));
        }
        for (to, at) in march.carried(frame, ptz, (before..frame).rev()) {
            back[to] = Some((frame, at));
        }
    }
    let mut carried = Carried {
        ptz: vec![None; frames],
        apart_px: vec![None; frames],
        stops: Vec::new(),
        moving: Vec::new(),
    };
    for frame in 0..frames {
        let nearer = match (forth[frame], back[frame]) {
            (Some(forth), Some(back)) => {
                carried.apart_px[frame] = Some(march.apart_px(frame, forth.1, back.1));
                if frame - forth.0 <= back.0 - frame {
                    Some(forth.1)
                } else {
                    Some(back.1)
                }
            }
            (one, other) => one.or(other).map(|(_, ptz)| ptz),
        };
        carried.ptz[frame] = nearer;
    }
    for (frame, ptz) in known {
        carried.ptz[frame] = Some(ptz);
    }
    march.stops.retain(|stop| carried.ptz[stop.frame].is_none());
    march.stops.sort_by_key(|stop| (stop.frame, stop.from));
    carried.stops = march.stops;
    carried.moving = march.moving;
    carried
}

struct March<'a> {
    camera: &'a ClipCamera,
    tracks: &'a PointTracks,
    by_frame: Vec<Vec<(usize, usize)>>,
    /// Px of these frames in a px at 1920 px width.
    px: f64,
    options: &'a CarryOptions,
    moving: Vec<bool>,
    stops: Vec<CarryStop>,
}

/// What is known of a point so far.
#[derive(Clone, Copy, Default)]
struct Direction {
    /// The sum of the directions in which frames saw it, `base`.
    sum: Vec3,
    /// Where it was first seen, px.
    first: ImagePoint,
    strikes: u8,
}

impl March<'_> {
    /// The cameras of frames that follow a known one, up to the first that cannot be reached.
    fn carried(
        &mut self,
        from: usize,
        ptz: Ptz,
        frames: impl Iterator<Item = usize>,
    ) -> Vec<(usize, Ptz)> {
        let mut directions: Vec<Direction> = vec![Direction::default(); self.tracks.tracks.len()];
        self.learn(&mut directions, from, ptz, &[]);
        let (mut last, mut found) = ((from, ptz), Vec::new());
        for frame in frames {
            match self.next(&mut directions, frame, last.1) {
                Ok(ptz) => {
                    found.push((frame, ptz));
                    last = (frame, ptz);
                }
                Err((seen, agreeing)) => {
                    self.stops.push(CarryStop {
                        frame,
                        from: last.0,
                        seen,
                        agreeing,
                    });
                    break;
                }
            }
        }
        found
    }

    fn point(&self, (track, place): (usize, usize)) -> ImagePoint {
        let followed: &PointTrack = &self.tracks.tracks[track];
        followed.points[place]
    }

    /// A frame's camera; else how many points were seen, and how many agree with the best one.
    fn next(
        &mut self,
        directions: &mut [Direction],
        frame: usize,
        from: Ptz,
    ) -> Result<Ptz, (usize, usize)> {
        let known: Vec<(usize, Sighting)> = self.by_frame[frame]
            .iter()
            .filter(|(track, _)| directions[*track].sum != Vec3::zeros() && !self.moving[*track])
            .map(|&seen| {
                let direction = directions[seen.0].sum.normalize();
                (
                    seen.0,
                    Sighting {
                        direction,
                        image: self.point(seen),
                        sigma_px: self.px,
                    },
                )
            })
            .collect();
        let moved_px = |(track, sighting): &(usize, Sighting)| {
            sighting.image.distance_px(directions[*track].first) / self.px
        };
        let sightings: Vec<Sighting> = known.iter().map(|(_, sighting)| *sighting).collect();
        let (moving, still): (Vec<_>, Vec<_>) =
            known.iter().partition(|it| moved_px(it) > MOVED_PX);
        let [moving, still] = [moving, still].map(|some: Vec<(usize, Sighting)>| {
            some.into_iter().map(|(_, it)| it).collect::<Vec<_>>()
        });
        let from = self.camera.with_known_focal(frame, from);
        let turned = self.turned_camera(frame, from, &moving, &still);
        let is_turning = turned.is_some();
        let ptz = turned.unwrap_or_else(|| self.fitted(frame, from, &sightings));
        let camera = self.camera.at_origin(frame, ptz);
        let agrees = |sighting: &Sighting| self.agrees(&camera, sighting);
        let agreeing: Vec<ImagePoint> = sightings
            .iter()
            .filter(|it| agrees(it))
            .map(|it| it.image)
            .collect();
        let enough =
            (self.options.min_share * sightings.len() as f64).max(self.options.min_points as f64);
        if (agreeing.len() as f64) < enough || !self.spread(&agreeing) || !ptz.is_finite() {
            return Err((sightings.len(), agreeing.len()));
        }
        let stands = |it: &(usize, Sighting)| is_turning && moved_px(it) <= MOVED_PX;
        let off_px = |sighting: &Sighting| {
            sighting
                .value(&camera)
                .map_or(f64::INFINITY, |off| off.norm() / self.px)
        };
        let disagrees =
            |it: &&(usize, Sighting)| !agrees(&it.1) || stands(it) && off_px(&it.1) > MOVED_PX;
        let wrong: Vec<usize> = known
            .iter()
            .filter(disagrees)
            .map(|(track, _)| *track)
            .collect();
        for &track in &wrong {
            directions[track].strikes += 1;
            self.moving[track] |= directions[track].strikes >= STRIKES;
        }
        self.learn(directions, frame, ptz, &wrong);
        Ok(ptz)
    }

    /// The camera that the moving points agree with, where they say that it turns; none where it
    /// stands still.
    ///
    /// Two things stand still in a picture: the scene while the camera does, and a burnt-in graphic
    /// always. Two things move: the scene while the camera turns, and players always. Shares of
    /// points do not tell them apart, because players give many. But the scene is all over the
    /// picture and moves as one, while a graphic lies in a corner and players run each their own
    /// way. So the camera turns if the moving points that agree on one turn and zoom are seen in
    /// more parts of the picture than those that stand still.
    fn turned_camera(
        &self,
        frame: usize,
        from: Ptz,
        moving: &[Sighting],
        still: &[Sighting],
    ) -> Option<Ptz> {
        if moving.len() < self.options.min_points {
            return None;
        }
        let ptz = self.fitted(frame, from, moving);
        let camera = self.camera.at_origin(frame, ptz);
        let agreeing = moving
            .iter()
            .filter(|sighting| self.agrees(&camera, sighting));
        (self.parts_of_picture(agreeing) > self.parts_of_picture(still.iter())).then_some(ptz)
    }

    /// Whether a camera puts a point where it is seen.
    fn agrees(&self, camera: &PtzCamera, sighting: &Sighting) -> bool {
        sighting
            .value(camera)
            .is_some_and(|off| off.norm() <= self.options.agrees_px * self.px)
    }

    /// In how many parts of the picture points lie.
    fn parts_of_picture<'s>(&self, sightings: impl Iterator<Item = &'s Sighting>) -> usize {
        const COLUMNS: f64 = 12.0;
        const ROWS: f64 = 7.0;
        let (width, height) = (
            f64::from(self.tracks.image_size.width),
            f64::from(self.tracks.image_size.height),
        );
        let part = |at: ImagePoint| {
            (
                (at.x / width * COLUMNS) as i32,
                (at.y / height * ROWS) as i32,
            )
        };
        sightings
            .map(|sighting| part(sighting.image))
            .collect::<BTreeSet<_>>()
            .len()
    }

    /// The camera that most points agree with.
    fn fitted(&self, frame: usize, from: Ptz, sightings: &[Sighting]) -> Ptz {
        let start = self.turned(frame, from, sightings);
        let (base, known_focal) = (
            self.camera.base_at(frame).at_origin(),
            self.camera.focal_px_at(frame).map(KnownFocal),
        );
        SCALES_PX.into_iter().fold(start, |ptz, scale_px| {
            let problem = OneFrame {
                base: &base,
                known_focal,
                sightings,
                loss: Loss::Cauchy { c: scale_px },
            };
            let until = Stopping {
                max_iterations: 12,
                short_step: 1e-8,
                small_gain: 1e-7,
            };
            self.camera
                .with_known_focal(frame, minimise(&problem, ptz, until).state)
        })
    }

    /// A start for a frame's camera: turned as the points moved in the middle.
    fn turned(&self, frame: usize, from: Ptz, sightings: &[Sighting]) -> Ptz {
        let camera = self.camera.at_origin(frame, from);
        let off: Vec<Vec2> = sightings
            .iter()
            .filter_map(|sighting| sighting.value(&camera))
            .collect();
        let along = |axis: usize| {
            median(&mut off.iter().map(|by| by[axis]).collect::<Vec<_>>()).unwrap_or(0.0)
        };
        // The residual is predicted minus seen: the camera turns towards where points came from.
        moved(
            from,
            Vec3::new(along(0) / from.focal_px, -along(1) / from.focal_px, 0.0),
        )
    }

    /// Whether points lie all over the picture.
    fn spread(&self, points: &[ImagePoint]) -> bool {
        let range = |of: fn(&ImagePoint) -> f64| {
            let (low, high) = points
                .iter()
                .map(of)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
                    (low.min(at), high.max(at))
                });
            high - low
        };
        let size = self.tracks.image_size;
        let least = self.options.min_spread;
        range(|at| at.x) >= least * f64::from(size.width)
            && range(|at| at.y) >= least * f64::from(size.height)
    }

    /// What a frame says about the directions of its points, those of some tracks (in rising order)
    /// left out.
    fn learn(&self, directions: &mut [Direction], frame: usize, ptz: Ptz, except: &[usize]) {
        let camera = self.camera.at_origin(frame, ptz);
        for &seen in self.by_frame[frame]
            .iter()
            .filter(|(track, _)| except.binary_search(track).is_err())
        {
            let direction = &mut directions[seen.0];
            let at = self.point(seen);
            if let Ok(ray) = camera.ray_from_image(at) {
                if direction.sum == Vec3::zeros() {
                    direction.first = at;
                }
                direction.sum += ray.direction();
            }
        }
    }

    /// How far apart two cameras' pictures of a frame are, px in the mean over the corners and the
    /// middle.
    fn apart_px(&self, frame: usize, one: Ptz, other: Ptz) -> f64 {
        let [one, other] = [one, other].map(|ptz| self.camera.at_origin(frame, ptz));
        let size = self.tracks.image_size;
        let points = size.corners().into_iter().chain([size.centre()]);
        // A wide turn may take a corner out of the other camera's sight: the rest says enough.
        let seen: Vec<f64> = image_space_distances_px(&one, &other, points)
            .filter(|px| px.is_finite())
            .collect();
        if seen.is_empty() {
            f64::INFINITY
        } else {
            seen.iter().sum::<f64>() / seen.len() as f64
        }
    }
}

/// A frame's own three numbers.
struct OneFrame<'a> {
    /// At the origin.
    base: &'a CameraBase,
    known_focal: Option<KnownFocal>,
    sightings: &'a [Sighting],
    loss: Loss,
}

impl Problem for OneFrame<'_> {
    type State = Ptz;
    type Equations = BlockEquations<0, 3>;

    fn equations(&self, at: &Ptz) -> BlockEquations<0, 3> {
        let camera = PtzCamera::new(*self.base, *at);
        let mut equations = BlockEquations::zero();
        if let Some(known) = &self.known_focal {
            equations.add(known, &camera, Loss::Squared);
        }
        for sighting in self.sightings {
            equations.add(sighting, &camera, self.loss);
        }
        equations
    }

    fn stepped(&self, from: &Ptz, step: &Vec3) -> Ptz {
        moved(*from, *step)
    }
}

/// A focal length that is known, px: as a measurement that outweighs all points.
#[derive(Clone, Copy)]
struct KnownFocal(f64);

impl Residual<1, 0, 3> for KnownFocal {
    type State = PtzCamera;

    fn element(&self) -> Option<FieldElement> {
        None
    }

    fn sigma(&self) -> f64 {
        KNOWN_FOCAL_SIGMA
    }

    fn value(&self, at: &PtzCamera) -> Option<SVector<f64, 1>> {
        Some(SVector::<f64, 1>::new((at.ptz().focal_px / self.0).ln()))
    }

    fn linearised(&self, at: &PtzCamera) -> Option<Linearised<1, 0, 3>> {
        let by_own = SMatrix::<f64, 1, 3>::new(0.0, 0.0, 1.0);
        Some(Linearised {
            value: self.value(at)?,
            by_shared: SMatrix::zeros(),
            by_own,
        })
    }
}

/// A known direction as a frame shows it.
#[derive(Clone, Copy)]
struct Sighting {
    /// Unit, `base`.
    direction: Vec3,
    image: ImagePoint,
    sigma_px: f64,
}

impl Residual<2, 0, 3> for Sighting {
    /// At the origin, looking along its base.
    type State = PtzCamera;

    fn element(&self) -> Option<FieldElement> {
        None
    }

    fn sigma(&self) -> f64 {
        self.sigma_px
    }

    fn value(&self, at: &PtzCamera) -> Option<Vec2> {
        Some(
            at.image_from_ray(PanTilt::from_direction(self.direction))
                .ok()?
                .offset_from(self.image),
        )
    }

    fn linearised(&self, at: &PtzCamera) -> Option<Linearised<2, 0, 3>> {
        let here = at.image_from_direction_jacobian(self.direction).ok()?;
        let mut by_own = here.by_ptz;
        by_own.column_mut(2).scale_mut(at.ptz().focal_px);
        Some(Linearised {
            value: here.point.offset_from(self.image),
            by_shared: SMatrix::zeros(),
            by_own,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::track::{AdjustOptions, ClipLens, PriorSource, adjust_clip};
    use touchline_core::camera::{BaseAngles, FocalCurve};
    use touchline_core::geometry::{ImageSize, Mat3};

    const SIZE: ImageSize = ImageSize::new(1920, 1080);
    const FRAMES: usize = 40;

    fn base() -> CameraBase {
        CameraBase::new(
            Vec3::new(0.0, -60.0, 18.0),
            BaseAngles::default().base_from_world(),
            SIZE.centre(),
        )
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

    /// How far the carried cameras are off at most, degrees of pan; every frame has to be reached.
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
        let carried = carry(
            &ClipCamera::new(base()),
            &tracks,
            &[known],
            &CarryOptions::default(),
        );
        assert_eq!(carried.stops, [], "every frame is reached");
        let off = |(frame, ptz): (usize, &Option<Ptz>)| {
            ptz.unwrap()
                .pan
                .turn_from(pointed(frame, pan_deg).pan)
                .degrees()
                .abs()
        };
        carried.ptz.iter().enumerate().map(off).fold(0.0, f64::max)
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
        let carried = carry(&camera, &tracks, &[known], &CarryOptions::default());
        let adjusted = adjust_clip(
            &camera,
            &tracks,
            &carried,
            &[known],
            &AdjustOptions::default(),
        )
        .unwrap();
        for (frame, truth) in truth.iter().enumerate() {
            let (carried, adjusted) =
                (carried.ptz[frame].unwrap(), adjusted.frames[frame].unwrap());
            for ptz in [carried, adjusted.ptz] {
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
