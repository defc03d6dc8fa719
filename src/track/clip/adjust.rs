//! One adjustment of a clip: pan, tilt and focal length of every frame and the direction of every followed point, from all
//! sightings and anchors at once.

use super::anchor::{Anchor, by_focal_px};
use super::problem::{Clip, ClipState, Seen};
use super::{Carried, PointTracks};
use crate::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use crate::geometry::{Mat3, Vec3, median};
use crate::solve::{Loss, Stopping, minimise};

/// How a clip is adjusted. Lengths are px at 1920 px width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdjustOptions {
    /// 1-σ of a followed point before the clip itself has told it. .3 by default.
    pub point_sigma_px: f64,
    /// It is never taken as smaller. .05 by default.
    pub min_sigma_px: f64,
    /// Beyond so many sigmas a point hardly counts. 3 by default.
    pub loss_sigmas: f64,
    /// A point's errors in neighbouring frames are alike, so that its sightings count for fewer than they are, by this factor. 4 by
    /// default.
    pub sightings_alike: f64,
    /// Steps at most. 15 by default.
    pub max_iterations: usize,
}

impl Default for AdjustOptions {
    fn default() -> Self {
        Self { point_sigma_px: 0.3, min_sigma_px: 0.05, loss_sigmas: 3.0, sightings_alike: 4.0, max_iterations: 15 }
    }
}

/// A frame as the whole clip sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdjustedFrame {
    /// Pan, tilt, focal length.
    pub ptz: Ptz,
    /// The covariance of (pan rad, tilt rad, focal length px), the base taken as exact.
    pub covariance: Mat3,
}

/// A clip after its adjustment.
#[derive(Clone, Debug, PartialEq)]
pub struct AdjustedClip {
    /// None for a frame that was not reached.
    pub frames: Vec<Option<AdjustedFrame>>,
    /// 1-σ of a followed point along one axis, as the clip itself tells it, px.
    pub sigma_px: f64,
    /// By how much the points had to be taken as less exact than that, so that the anchors hold; 1 where the two agree.
    pub widened: f64,
}

/// Adjusts the frames that were reached.
///
/// None if nothing holds the clip: no anchor, or one that has no covariance.
#[must_use]
pub fn adjust_clip(
    base: &CameraBase,
    tracks: &PointTracks,
    carried: &Carried,
    anchors: &[Anchor],
    options: &AdjustOptions,
) -> Option<AdjustedClip> {
    let mut row_of = vec![None; tracks.frames];
    let mut start = Vec::new();
    for (frame, ptz) in carried.ptz.iter().enumerate() {
        if let Some(ptz) = ptz {
            row_of[frame] = Some(start.len());
            start.push(*ptz);
        }
    }
    let points = seen(tracks, &carried.moving, &row_of);
    let anchors: Vec<(usize, Anchor, Mat3)> = anchors
        .iter()
        .filter_map(|anchor| Some((row_of.get(anchor.frame).copied().flatten()?, *anchor, anchor.information()?)))
        .collect();
    if anchors.is_empty() {
        return None;
    }
    let mut first: Vec<usize> = (0..start.len()).collect();
    for point in &points {
        let least = point.sightings.first().map_or(0, |(row, _)| *row);
        for (row, _) in &point.sightings {
            first[*row] = first[*row].min(least);
        }
    }
    let px = tracks.image_size.scale_from_1920();
    let alike = options.sightings_alike.sqrt();
    let mut problem = Clip {
        base: base.at_origin(),
        points: &points,
        anchors: &anchors,
        first: &first,
        sigma_px: options.point_sigma_px * px * alike,
        loss: Loss::Cauchy { c: options.loss_sigmas / alike },
    };
    let until = |max_iterations| Stopping { max_iterations, short_step: 1e-9, small_gain: 1e-8 };
    let state = ClipState { directions: directions(&problem, &start), ptz: start };
    let rough = minimise(&problem, state, until(options.max_iterations));
    let mut off: Vec<f64> = problem.residuals(&rough.state).filter_map(|(_, off)| Some(off?.norm_squared())).collect();
    // The median of the squares of two numbers with 1-σ s is 2 ln 2 s².
    let sigma_px = (median(&mut off).unwrap_or(0.0) / (2.0 * 2f64.ln())).sqrt().max(options.min_sigma_px * px);
    problem.sigma_px = sigma_px * alike;
    let mut fine = minimise(&problem, rough.state, until(options.max_iterations));
    let mut widened = 1.0;
    for _ in 0..WIDENINGS {
        let contradiction = contradiction(&anchors, &fine.state);
        if contradiction <= CONTRADICTED {
            break;
        }
        widened *= contradiction.sqrt().clamp(1.5, 4.0);
        problem.sigma_px = sigma_px * alike * widened;
        problem.loss = Loss::Cauchy { c: options.loss_sigmas / (alike * widened) };
        fine = minimise(&problem, fine.state, until(options.max_iterations));
    }
    let covariances = fine.equations.covariances()?;
    let frames = row_of.iter().map(|row| {
        let row = (*row)?;
        let ptz = fine.state.ptz[row];
        Some(AdjustedFrame { ptz, covariance: by_focal_px(&covariances[row], ptz.focal_px) })
    });
    Some(AdjustedClip { frames: frames.collect(), sigma_px, widened })
}

/// The anchors' mean square distance per number, in sigmas², from which on the points are taken as less exact.
const CONTRADICTED: f64 = 1.5;

/// How often they are.
const WIDENINGS: usize = 8;

/// How much the cameras contradict what is known of them: 1 where the anchors scatter as they state. A lens or a base that is a
/// little off bends all points alike, which is no scatter; only the anchors show it, and then they hold.
fn contradiction(anchors: &[(usize, Anchor, Mat3)], at: &ClipState) -> f64 {
    let squares = |(row, anchor, information): &(usize, Anchor, Mat3)| {
        let offset = anchor.offset(at.ptz[*row]);
        offset.dot(&(information * offset)) / 3.0
    };
    let mut squares: Vec<f64> = anchors.iter().map(squares).collect();
    // Of a χ² of three the median is .789 of the mean.
    median(&mut squares).unwrap_or(0.0) / 0.789
}

/// The points that at least two of the reached frames show and that do not move.
fn seen(tracks: &PointTracks, moving: &[bool], row_of: &[Option<usize>]) -> Vec<Seen> {
    let still = tracks.tracks.iter().zip(moving).filter(|(_, moving)| !**moving);
    let of_track = |(track, _): (&super::PointTrack, &bool)| {
        let sightings: Vec<_> = track
            .points
            .iter()
            .enumerate()
            .filter_map(|(place, point)| Some((row_of[track.first + place]?, *point)))
            .collect();
        (sightings.len() > 1).then_some(Seen { sightings })
    };
    still.filter_map(of_track).collect()
}

/// Where each point lies by the frames that show it.
fn directions(problem: &Clip<'_>, ptz: &[Ptz]) -> Vec<Vec3> {
    let cameras: Vec<PtzCamera> = ptz.iter().map(|ptz| PtzCamera::new(problem.base, *ptz)).collect();
    let of_point = |point: &Seen| {
        let rays = point.sightings.iter().filter_map(|(row, at)| cameras[*row].ray_from_image(*at).ok());
        let sum: Vec3 = rays.map(PanTilt::direction).sum();
        sum.try_normalize(1e-9).unwrap_or_else(Vec3::z)
    };
    problem.points.iter().map(of_point).collect()
}
