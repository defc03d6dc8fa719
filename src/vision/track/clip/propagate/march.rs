//! The march from a known frame to its neighbours: frame by frame, until one cannot be reached.
//!
//! The march keeps an estimate of each point's direction. At each frame it fits the camera, decides
//! whether the camera rotates, accepts or rejects the frame, and adds the frame's rays to the
//! directions. A point that disagrees in [`STRIKES`] frames is taken to move in the scene, and the
//! march leaves it out from then on.

use super::super::super::pose_problem::apply_offset;
use super::super::{ClipCamera, PointTrack, PointTracks};
use super::one_frame::{Correspondence, KnownFocal, OneFrame};
use super::{PropagateOptions, PropagationStop};
use crate::features::count_cells;
use touchline_core::camera::{Ptz, PtzCamera, image_space_distances_px};
use touchline_core::geometry::{ImagePoint, Vec2, Vec3, median};
use touchline_core::solve::{Loss, Residual, Stopping, minimise};

/// A point that disagrees in this many frames is taken to move in the scene.
const STRIKES: u8 = 3;

/// A point whose image has moved by no more than this since it was first seen may belong to a
/// burnt-in graphic, px at 1920 px width.
const MOVED_PX: f64 = 1.0;

/// The scales of the Cauchy loss, from coarse to fine, px at 1920 px width. A coarse scale keeps a
/// poor start from being trapped by outliers.
const SCALES_PX: [f64; 4] = [24.0, 6.0, 2.0, 1.0];

/// The run of propagation through a clip, from known frame to known frame.
pub(super) struct March<'a> {
    camera: &'a ClipCamera,
    tracks: &'a PointTracks,
    /// Track and index within it of all observations of each frame.
    by_frame: Vec<Vec<(usize, usize)>>,
    /// Image px per px at 1920 px width.
    px: f64,
    options: &'a PropagateOptions,
    /// Tracks found to move in the scene, in any run so far.
    pub moving: Vec<bool>,
    pub stops: Vec<PropagationStop>,
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

impl<'a> March<'a> {
    /// Before the first run: no point is known to move.
    pub fn new(
        camera: &'a ClipCamera,
        tracks: &'a PointTracks,
        options: &'a PropagateOptions,
    ) -> Self {
        Self {
            camera,
            tracks,
            by_frame: tracks.by_frame(),
            px: tracks.image_size.scale_from_1920(),
            options,
            moving: vec![false; tracks.tracks.len()],
            stops: Vec::new(),
        }
    }

    /// Propagates from a known camera through `frames`, up to the first frame that cannot be
    /// reached.
    ///
    /// Directions are estimated anew, because they depend on the camera at the start. Points that
    /// were found to move stay excluded in later runs.
    pub fn propagate(
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
        // The last camera is the start for the next frame. The first frame that is not reached ends
        // the run: from a wrong start the frames after it would be wrong as well.
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
        // Correspondences: points that have a direction and are not known to move, in the order of
        // their tracks.
        let known: Vec<(usize, Correspondence)> = self.by_frame[frame]
            .iter()
            .filter(|(track, _)| directions[*track].sum != Vec3::zeros() && !self.moving[*track])
            .map(|&seen| {
                let correspondence = Correspondence {
                    direction: directions[seen.0].sum.normalize(),
                    image: self.point(seen),
                    sigma_px: self.px,
                };
                (seen.0, correspondence)
            })
            .collect();
        // Separate points that moved in the image since they were first seen from those that did
        // not; see `fit_turning_camera`.
        let (mut correspondences, mut moving, mut still) = (Vec::new(), Vec::new(), Vec::new());
        for (track, correspondence) in &known {
            correspondences.push(*correspondence);
            if self.moved_px(&directions[*track], correspondence) > MOVED_PX {
                moving.push(*correspondence);
            } else {
                still.push(*correspondence);
            }
        }
        // Image motion decides whether the camera rotates. A rotating camera is fitted to the
        // moving points alone: points that stand still in the image are partly of burnt-in graphics
        // and would pull the fit towards no motion. A camera at rest is fitted to all points.
        let from = self.camera.with_known_focal(frame, from);
        let turned = self.fit_turning_camera(frame, from, &moving, &still);
        let is_turning = turned.is_some();
        let ptz = turned.unwrap_or_else(|| self.fit_camera(frame, from, &correspondences));
        let camera = self.camera.at_origin(frame, ptz);
        // Accept the frame only if the inliers are many, a large share, and spread over the
        // picture: a few points in a corner do not determine the focal length. A frame of another
        // shot fails here.
        let agreeing: Vec<ImagePoint> = correspondences
            .iter()
            .filter(|it| self.agrees(&camera, it))
            .map(|it| it.image)
            .collect();
        let enough = (self.options.min_share * correspondences.len() as f64)
            .max(self.options.min_points as f64);
        if (agreeing.len() as f64) < enough || !self.spread(&agreeing) || !ptz.is_finite() {
            return Err((correspondences.len(), agreeing.len()));
        }
        // Count a strike against each outlier. While the camera rotates, a point that stands still
        // in the image and fits worse than 1 px (at 1920) is of a graphic, even within `agrees_px`.
        let wrong: Vec<usize> = known
            .iter()
            .filter(|(track, correspondence)| {
                let stands =
                    is_turning && self.moved_px(&directions[*track], correspondence) <= MOVED_PX;
                !self.agrees(&camera, correspondence)
                    || stands && self.off_px(&camera, correspondence) > MOVED_PX
            })
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
    fn fit_turning_camera(
        &self,
        frame: usize,
        from: Ptz,
        moving: &[Correspondence],
        still: &[Correspondence],
    ) -> Option<Ptz> {
        if moving.len() < self.options.min_points {
            return None;
        }
        let ptz = self.fit_camera(frame, from, moving);
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

    /// The distance by which a point's image has moved since it was first seen, px at 1920 px
    /// width.
    fn moved_px(&self, direction: &Direction, correspondence: &Correspondence) -> f64 {
        correspondence.image.distance_px(direction.first) / self.px
    }

    /// The distance of an observation from where a camera projects its direction, px at 1920 px
    /// width; infinite beyond the lens model.
    fn off_px(&self, camera: &PtzCamera, correspondence: &Correspondence) -> f64 {
        correspondence
            .value(camera)
            .map_or(f64::INFINITY, |off| off.norm() / self.px)
    }

    /// The number of cells of a 12 × 7 grid over the picture that contain an observation. Many
    /// points in one place count once.
    fn parts_of_picture<'s>(
        &self,
        correspondences: impl Iterator<Item = &'s Correspondence>,
    ) -> usize {
        const GRID: (usize, usize) = (12, 7);
        let points = correspondences.map(|correspondence| correspondence.image);
        count_cells(points, self.tracks.image_size, GRID)
    }

    /// The camera that most observations agree with.
    ///
    /// Minimises the Cauchy loss at scales from coarse to fine, each from the result of the last
    /// (graduated non-convexity; Blake and Zisserman: "Visual Reconstruction", 1987). If the focal
    /// length is known, [`KnownFocal`] holds it in the fit; its tiny remainder is removed after
    /// each scale.
    fn fit_camera(&self, frame: usize, from: Ptz, correspondences: &[Correspondence]) -> Ptz {
        let start = self.initial_camera(frame, from, correspondences);
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
    fn initial_camera(&self, frame: usize, from: Ptz, correspondences: &[Correspondence]) -> Ptz {
        let camera = self.camera.at_origin(frame, from);
        let off: Vec<Vec2> = correspondences
            .iter()
            .filter_map(|correspondence| correspondence.value(&camera))
            .collect();
        let [right, down] = [0, 1].map(|axis| {
            median(&mut off.iter().map(|by| by[axis]).collect::<Vec<_>>()).unwrap_or(0.0)
        });
        // Residuals are predicted minus observed. Panning right moves the prediction left, tilting
        // up moves it down (image y points down). Small angles near the image centre are accurate
        // enough for a start.
        apply_offset(
            from,
            Vec3::new(right / from.focal_px, -down / from.focal_px, 0.0),
        )
    }

    /// Whether points extend over `min_spread` of both sides of the picture.
    fn spread(&self, points: &[ImagePoint]) -> bool {
        let size = self.tracks.image_size;
        let least = self.options.min_spread;
        extent(points.iter().map(|at| at.x)) >= least * f64::from(size.width)
            && extent(points.iter().map(|at| at.y)) >= least * f64::from(size.height)
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
            // Rays of all frames so far are summed; the direction is normalised when it is used. A
            // point beyond the lens model adds none.
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
    pub fn apart_px(&self, frame: usize, one: Ptz, other: Ptz) -> f64 {
        let [one, other] = [one, other].map(|ptz| self.camera.at_origin(frame, ptz));
        let size = self.tracks.image_size;
        let points = size.corners().into_iter().chain([size.centre()]);
        // After a large rotation the other camera may not see a corner; the other points suffice.
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

/// The difference of the greatest and the least of some numbers; −∞ without any.
fn extent(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
        (low.min(at), high.max(at))
    });
    high - low
}
