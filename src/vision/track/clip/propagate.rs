//! Propagation: the camera of a frame from that of its neighbour, by the points that both show.
//!
//! The rotating camera sees a static point in one direction of `base`, which is estimated as the
//! mean over the frames so far. Pan, tilt and focal length of the next frame are those that project
//! all directions onto the tracked points. A point that does not stand still, such as one on a
//! player or a scrolling board, disagrees with the fit; after [`STRIKES`] disagreements it is
//! excluded.

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

/// A point that disagrees in this many frames is taken to move in the scene.
const STRIKES: u8 = 3;

/// A point whose image has moved by no more than this since it was first seen may belong to a
/// burnt-in graphic, px at 1920 px width.
const MOVED_PX: f64 = 1.0;

/// The scales of the Cauchy loss, from coarse to fine, px at 1920 px width. A coarse scale keeps a
/// poor start from being trapped by outliers.
const SCALES_PX: [f64; 4] = [24.0, 6.0, 2.0, 1.0];

/// Propagates the known cameras forwards and backwards through the clip; each frame takes the
/// result from the nearest known frame.
///
/// If several priors name one frame, the first of them is its known camera.
#[must_use]
pub fn propagate(
    camera: &ClipCamera,
    tracks: &PointTracks,
    priors: &[PosePrior],
    options: &PropagateOptions,
) -> PropagatedClip {
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
    // Known cameras, sorted by frame. Priors of frames outside the clip are ignored.
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
        for (to, at) in march.propagated(frame, ptz, frame + 1..next) {
            forth[to] = Some((frame, at));
        }
        for (to, at) in march.propagated(frame, ptz, (before..frame).rev()) {
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
        let nearer = match (forth[frame], back[frame]) {
            (Some(forth), Some(back)) => {
                propagated.apart_px[frame] = Some(march.apart_px(frame, forth.1, back.1));
                if frame - forth.0 <= back.0 - frame {
                    Some(forth.1)
                } else {
                    Some(back.1)
                }
            }
            (one, other) => one.or(other).map(|(_, ptz)| ptz),
        };
        propagated.ptz[frame] = nearer;
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

struct March<'a> {
    camera: &'a ClipCamera,
    tracks: &'a PointTracks,
    /// Track and index within it of all observations of each frame.
    by_frame: Vec<Vec<(usize, usize)>>,
    /// Image px per px at 1920 px width.
    px: f64,
    options: &'a PropagateOptions,
    /// Tracks found to move in the scene, in any run so far.
    moving: Vec<bool>,
    stops: Vec<PropagationStop>,
}

/// The estimate of a point's direction so far.
#[derive(Clone, Copy, Default)]
struct Direction {
    /// The sum of the unit directions in which frames saw it, `base`; zero before the first.
    sum: Vec3,
    /// Its first position in the image, px.
    first: ImagePoint,
    /// Number of frames in which it was an outlier.
    strikes: u8,
}

impl March<'_> {
    /// Propagates from a known camera through `frames`, up to the first frame that cannot be
    /// reached.
    ///
    /// Directions are estimated anew, because they depend on the camera at the start. Points that
    /// were found to move stay excluded in later runs.
    fn propagated(
        &mut self,
        from: usize,
        ptz: Ptz,
        frames: impl Iterator<Item = usize>,
    ) -> Vec<(usize, Ptz)> {
        // The known frame gives the first ray of every point that it shows; each frame reached adds
        // one.
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
                    self.stops.push(PropagationStop {
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

    /// The camera of a frame, or, as an error, the number of points seen and of those that agree
    /// with the best camera found.
    fn next(
        &mut self,
        directions: &mut [Direction],
        frame: usize,
        from: Ptz,
    ) -> Result<Ptz, (usize, usize)> {
        // Correspondences: points whose direction is known and that are not known to move.
        let known: Vec<(usize, Correspondence)> = self.by_frame[frame]
            .iter()
            .filter(|(track, _)| directions[*track].sum != Vec3::zeros() && !self.moving[*track])
            .map(|&seen| {
                let direction = directions[seen.0].sum.normalize();
                (
                    seen.0,
                    Correspondence {
                        direction,
                        image: self.point(seen),
                        sigma_px: self.px,
                    },
                )
            })
            .collect();
        // Separate points that moved in the image since they were first seen from those that did
        // not; see `turned_camera`.
        let moved_px = |(track, correspondence): &(usize, Correspondence)| {
            correspondence.image.distance_px(directions[*track].first) / self.px
        };
        let correspondences: Vec<Correspondence> = known
            .iter()
            .map(|(_, correspondence)| *correspondence)
            .collect();
        let (moving, still): (Vec<_>, Vec<_>) =
            known.iter().partition(|it| moved_px(it) > MOVED_PX);
        let [moving, still] = [moving, still].map(|some: Vec<(usize, Correspondence)>| {
            some.into_iter().map(|(_, it)| it).collect::<Vec<_>>()
        });
        // Image motion decides whether the camera rotates. A rotating camera is fitted to the
        // moving points alone: points that stand still in the image are partly of burnt-in graphics
        // and would pull the fit towards no motion. A camera at rest is fitted to all points.
        let from = self.camera.with_known_focal(frame, from);
        let turned = self.turned_camera(frame, from, &moving, &still);
        let is_turning = turned.is_some();
        let ptz = turned.unwrap_or_else(|| self.fitted(frame, from, &correspondences));
        let camera = self.camera.at_origin(frame, ptz);
        // Accept the frame only if the inliers are many, a large share, and spread over the
        // picture: a few points in a corner do not determine the focal length.
        let agrees = |correspondence: &Correspondence| self.agrees(&camera, correspondence);
        let agreeing: Vec<ImagePoint> = correspondences
            .iter()
            .filter(|it| agrees(it))
            .map(|it| it.image)
            .collect();
        let enough = (self.options.min_share * correspondences.len() as f64)
            .max(self.options.min_points as f64);
        if (agreeing.len() as f64) < enough || !self.spread(&agreeing) || !ptz.is_finite() {
            return Err((correspondences.len(), agreeing.len()));
        }
        // Count a strike against each outlier. While the camera rotates, a point that stands still
        // in the image and fits worse than 1 px (at 1920) is of a graphic, even within `agrees_px`.
        let stands = |it: &(usize, Correspondence)| is_turning && moved_px(it) <= MOVED_PX;
        let off_px = |correspondence: &Correspondence| {
            correspondence
                .value(&camera)
                .map_or(f64::INFINITY, |off| off.norm() / self.px)
        };
        let disagrees = |it: &&(usize, Correspondence)| {
            !agrees(&it.1) || stands(it) && off_px(&it.1) > MOVED_PX
        };
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

    /// The camera fitted to the moving points if the camera rotates or zooms; `None` if it is at
    /// rest.
    ///
    /// Two things stand still in the image: the scene while the camera is at rest, and a burnt-in
    /// graphic always. Two things move: the scene while the camera rotates, and players always.
    /// Shares of points do not separate these cases, because players have many points. But the
    /// scene fills the picture and moves as one, while a graphic occupies a corner and players move
    /// independently. So the camera is rotating if the moving points that agree on one rotation and
    /// zoom occupy more cells of the picture than the points that stand still.
    fn turned_camera(
        &self,
        frame: usize,
        from: Ptz,
        moving: &[Correspondence],
        still: &[Correspondence],
    ) -> Option<Ptz> {
        if moving.len() < self.options.min_points {
            return None;
        }
        let ptz = self.fitted(frame, from, moving);
        let camera = self.camera.at_origin(frame, ptz);
        let agreeing = moving
            .iter()
            .filter(|correspondence| self.agrees(&camera, correspondence));
        (self.parts_of_picture(agreeing) > self.parts_of_picture(still.iter())).then_some(ptz)
    }

    /// Whether a camera projects a direction to within `agrees_px` of its observation.
    fn agrees(&self, camera: &PtzCamera, correspondence: &Correspondence) -> bool {
        correspondence
            .value(camera)
            .is_some_and(|off| off.norm() <= self.options.agrees_px * self.px)
    }

    /// The number of cells of a 12 × 7 grid over the picture that contain an observation.
    fn parts_of_picture<'s>(
        &self,
        correspondences: impl Iterator<Item = &'s Correspondence>,
    ) -> usize {
        const COLUMNS: f64 = 12.0;
        const ROWS: f64 = 7.0;
        let (width, height) = (
            f64::from(self.tracks.image_size.width),
            f64::from(self.tracks.image_size.height),
        );
        // Distinct cells, so that many points in one place count once.
        let part = |at: ImagePoint| {
            (
                (at.x / width * COLUMNS) as i32,
                (at.y / height * ROWS) as i32,
            )
        };
        correspondences
            .map(|correspondence| part(correspondence.image))
            .collect::<BTreeSet<_>>()
            .len()
    }

    /// The camera that most observations agree with.
    ///
    /// Minimises the Cauchy loss at scales from coarse to fine, each from the result of the last
    /// (graduated non-convexity; Blake and Zisserman: "Visual Reconstruction", 1987). If the focal
    /// length is known, [`KnownFocal`] holds it in the fit; its tiny remainder is removed after
    /// each scale.
    fn fitted(&self, frame: usize, from: Ptz, correspondences: &[Correspondence]) -> Ptz {
        let start = self.turned(frame, from, correspondences);
        let (base, known_focal) = (
            self.camera.base_at(frame).at_origin(),
            self.camera.focal_px_at(frame).map(KnownFocal),
        );
        SCALES_PX.into_iter().fold(start, |ptz, scale_px| {
            let problem = OneFrame {
                base: &base,
                known_focal,
                correspondences,
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

    /// A start for a frame's camera: the last one, panned and tilted by the median motion of the
    /// points.
    fn turned(&self, frame: usize, from: Ptz, correspondences: &[Correspondence]) -> Ptz {
        let camera = self.camera.at_origin(frame, from);
        let off: Vec<Vec2> = correspondences
            .iter()
            .filter_map(|correspondence| correspondence.value(&camera))
            .collect();
        let along = |axis: usize| {
            median(&mut off.iter().map(|by| by[axis]).collect::<Vec<_>>()).unwrap_or(0.0)
        };
        // Residuals are predicted minus observed. Panning right moves the prediction left, tilting
        // up moves it down (image y points down). Small angles near the image centre are accurate
        // enough for a start.
        moved(
            from,
            Vec3::new(along(0) / from.focal_px, -along(1) / from.focal_px, 0.0),
        )
    }

    /// Whether points extend over `min_spread` of both sides of the picture.
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

    /// Adds a frame's rays to the directions of its points, except those of the tracks in `except`,
    /// which ascend.
    fn learn(&self, directions: &mut [Direction], frame: usize, ptz: Ptz, except: &[usize]) {
        let camera = self.camera.at_origin(frame, ptz);
        for &seen in self.by_frame[frame]
            .iter()
            .filter(|(track, _)| except.binary_search(track).is_err())
        {
            let direction = &mut directions[seen.0];
            let at = self.point(seen);
            // Rays of all frames so far are summed; the direction is normalised when it is used.
            if let Ok(ray) = camera.ray_from_image(at) {
                if direction.sum == Vec3::zeros() {
                    direction.first = at;
                }
                direction.sum += ray.direction();
            }
        }
    }

    /// The distance between two cameras of a frame: pixels are back-projected by the first and
    /// projected by the second, px, mean over the corners and the centre. Infinite if no pixel can
    /// be compared.
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

/// The adjustment of one frame's pan, tilt and log focal length, with known directions.
struct OneFrame<'a> {
    /// The base with its position at the origin, so that the camera projects directions.
    base: &'a CameraBase,
    known_focal: Option<KnownFocal>,
    correspondences: &'a [Correspondence],
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
        for correspondence in self.correspondences {
            equations.add(correspondence, &camera, self.loss);
        }
        equations
    }

    fn stepped(&self, from: &Ptz, step: &Vec3) -> Ptz {
        moved(*from, *step)
    }
}

/// A known focal length, px, as a measurement of ln f that outweighs all points.
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

/// A correspondence: a known direction, and where a frame shows it.
#[derive(Clone, Copy)]
struct Correspondence {
    /// Unit, `base`.
    direction: Vec3,
    image: ImagePoint,
    sigma_px: f64,
}

impl Residual<2, 0, 3> for Correspondence {
    /// The camera at the origin; pan, tilt and focal length are its parameters.
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
        // ∂/∂(ln f) = f ∂/∂f.
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
