//! Recognises frames of one video that one camera took, although each states a place of its own.
//!
//! Sensors on a tripod waver by millimetres, programs that calibrate frame by frame by centimetres
//! to metres, and both roll by a little. A camera of the document for each frame would be thousands
//! that no one can track or refine together. Such frames get one base: the median of their places,
//! and the pan axis that fits them best. What each of them states is kept beside it.
//!
//! 1. Frames follow each other in time if their numbers are of one run and what they look at
//!    changes little from one to the next: stills of twenty matches are numbered, too.
//! 2. A gap between places, wider than the step from frame to frame explains, parts two cameras.
//! 3. Places that drift without coming back, or spread widely for their distance from the field,
//!    are those of a camera that moves. It has no base. What each frame errs by itself, as second
//!    differences in time show, is neither.

use super::frame_camera::{CommonBase, FrameCamera, Pinhole};
use super::into_document::{Exactness, ROUNDING_RAD, View, pan_axis};
use crate::document::Moment;
use std::collections::BTreeMap;
use touchline_core::camera::{BaseSigma, CameraBase, PtzCamera};
use touchline_core::geometry::{Vec3, median, pluralise};
use touchline_core::solve::base::shared_places;

/// Fewer frames are no video.
const FEWEST_FRAMES: usize = 5;

/// Frames follow each other if their optical axes turn by less than this from one to the next, rad:
/// the median. A broadcast camera pans by .5° or less in a frame, stills of a match by 15°.
const MOST_TURN_RAD: f64 = 0.05;

/// Places of one camera have no wider gap along an axis than this, m, and than this multiple of the
/// median step from one frame to the next. Two cameras of one video stand farther apart.
const LEAST_GAP_M: f64 = 0.5;
const GAP_OVER_STEP: f64 = 3.0;

/// Rounds in which frames are parted along each axis; places of real cameras need two.
const MOST_ROUNDS: usize = 10;

/// Of a camera that stands, the places spread (1 σ) along each axis by at most this share of their
/// distance from the middle of the field, and drift by at most that one from beginning to end.
const MOST_SPREAD: f64 = 0.05;
const MOST_DRIFT: f64 = 0.02;

/// Programs that calibrate frame by frame trade the distance for the focal length, and err anew
/// in each frame: such places may spread by this share of the distance, 1 σ.
const MOST_NOISE: f64 = 0.15;

/// A spread of up to this multiple of what each frame errs by itself is nothing else: of five to
/// ten frames neither is known better.
const SPREAD_OVER_NOISE: f64 = 1.5;

/// A drift of up to this many σ of the difference of two parts' median places is none.
const DRIFT_SIGMAS: f64 = 3.0;

/// The σ of the median of many normally distributed values over that of their mean: √(π/2).
const MEDIAN_OVER_MEAN: f64 = 1.2533;

/// A drift comes back if its ends are nearer to each other than this share of its extent.
const RETURNS: f64 = 0.7;

/// Number of parts of a video, the median places of which show whether it drifts.
const PARTS: usize = 8;

/// Places that spread by less (1 σ) are as exact as any that is stated, m.
const EXACT_PLACE_M: f64 = 5e-3;

/// σ of normally distributed errors as a multiple of their median absolute deviation.
const SIGMA_OVER_MAD: f64 = 1.4826;

/// Gives frames of one video that waver about a place the base that they share. Frames with one
/// exact base, and those of a camera that moves, stay without; the notes say which these are.
pub fn find_common_bases(views: &mut [View], exact: Exactness) -> Vec<String> {
    let mut notes = Vec::new();
    let mut number = 0;
    for sequence in sequences(views) {
        for part in split_at_gaps(views, sequence) {
            if part.len() < FEWEST_FRAMES || have_one_base(views, &part, exact) {
                continue;
            }
            let Some(spread) = Spread::measure(views, &part) else {
                continue;
            };
            if let Some(how) = spread.describe_movement() {
                notes.push(format!(
                    "{} {how}: a camera that moves, and each frame has one of its own",
                    describe_part(views, &part)
                ));
                continue;
            }
            let Some(base) = common_base(views, &part, exact, &spread) else {
                continue;
            };
            notes.push(format!(
                "{} waver about one place by ±{:.3} m and roll by ±{:.3}°: they are of one camera, \
                 and each keeps its own numbers; `mend` or `refine-base` puts them on that place",
                describe_part(views, &part),
                spread.sigma_m.amax(),
                roll_sigma(views, &part, &base).to_degrees()
            ));
            for index in part {
                views[index].0.common_base = Some(CommonBase { number, base });
            }
            number += 1;
        }
    }
    notes
}

/// The frames of the videos, by index in the order of time.
fn sequences(views: &[View]) -> Vec<Vec<usize>> {
    let mut runs: BTreeMap<_, Vec<(Moment<'_>, usize)>> = BTreeMap::new();
    for (index, (frame, size, _)) in views.iter().enumerate() {
        if let Some(moment) = moment_of(frame) {
            let of_camera = (frame.camera.as_deref(), size.width, size.height);
            let run = runs.entry((of_camera, moment.run())).or_default();
            run.push((moment, index));
        }
    }
    let mut found: Vec<Vec<usize>> = Vec::new();
    for (_, mut run) in runs {
        run.sort_unstable();
        let frames: Vec<usize> = run.into_iter().map(|(_, index)| index).collect();
        if frames.len() >= FEWEST_FRAMES && follow_each_other(views, &frames) {
            found.push(frames);
        }
    }
    // In the order of the file, in which cameras are numbered and named.
    found.sort_by_key(|frames| frames.iter().copied().min());
    found
}

/// Where a frame is in time: its number in its video, else that in its image's name.
fn moment_of(frame: &FrameCamera) -> Option<Moment<'_>> {
    match (frame.frame_index, &frame.image) {
        (Some(number), _) => {
            let video = frame.video.as_deref().unwrap_or_default();
            Some(Moment::in_video(video, number))
        }
        (None, Some(image)) => Moment::from_name(image),
        (None, None) => None,
    }
}

/// Whether the cameras of frames in the order of time look nearly where the one before looks.
fn follow_each_other(views: &[View], frames: &[usize]) -> bool {
    let axis = |index: usize| views[index].2.cam_from_world.row(2).transpose();
    let mut angles: Vec<f64> = frames
        .windows(2)
        .map(|pair| axis(pair[0]).cross(&axis(pair[1])).norm())
        .collect();
    median(&mut angles).is_some_and(|angle| angle <= MOST_TURN_RAD)
}

/// The frames of a sequence by the places between which there are gaps, each in the order of time.
fn split_at_gaps(views: &[View], sequence: Vec<usize>) -> Vec<Vec<usize>> {
    let place = |index: usize| views[index].2.position_m;
    // How much places differ from frame to frame does not depend on how many cameras there are.
    let mut steps: Vec<f64> = sequence
        .windows(2)
        .map(|pair| (place(pair[0]) - place(pair[1])).norm())
        .collect();
    let step_m = median(&mut steps).unwrap_or(0.0);
    let gap_m = LEAST_GAP_M.max(GAP_OVER_STEP * step_m);
    let mut parts = vec![sequence];
    // A gap along one axis may show only once another axis has parted the frames.
    for _ in 0..MOST_ROUNDS {
        let before = parts.len();
        for axis in 0..3 {
            parts = parts
                .into_iter()
                .flat_map(|mut part| {
                    part.sort_by(|a, b| place(*a)[axis].total_cmp(&place(*b)[axis]));
                    let near = |a: &usize, b: &usize| place(*b)[axis] - place(*a)[axis] <= gap_m;
                    let apart = part.chunk_by(near).map(<[usize]>::to_vec);
                    apart.collect::<Vec<_>>()
                })
                .collect();
        }
        if parts.len() == before {
            break;
        }
    }
    for part in &mut parts {
        // The sequence was in the order of time, which the moments still say.
        part.sort_unstable_by_key(|index| (moment_of(&views[*index].0), *index));
    }
    parts.sort_by_key(|part| part.iter().copied().min());
    parts
}

/// Whether frames share a place and a pan axis to the last digits that the format has.
fn have_one_base(views: &[View], part: &[usize], exact: Exactness) -> bool {
    let first = views[part[0]].2.position_m;
    let is_there = |index: &usize| (views[*index].2.position_m - first).amax() <= exact.place_m;
    let angle_rad = exact.angle_rad.max(ROUNDING_RAD);
    part.iter().all(is_there) && pan_axis(&pinholes(views, part), angle_rad).is_some()
}

fn pinholes<'a>(views: &'a [View], part: &[usize]) -> Vec<&'a Pinhole> {
    part.iter().map(|index| &views[*index].2).collect()
}

/// How the places of a part of a video are spread.
struct Spread {
    /// The median along each axis, m.
    middle_m: Vec3,
    /// 1 σ along each axis from the median absolute deviation, m.
    sigma_m: Vec3,
    /// What each frame errs by itself along each axis, 1 σ, m.
    noise_m: Vec3,
    /// From the beginning to the end, m.
    drift_m: f64,
    /// A drift that such errors alone make, m.
    drift_of_noise_m: f64,
    /// Whether the places come back.
    returns: bool,
}

impl Spread {
    fn measure(views: &[View], part: &[usize]) -> Option<Self> {
        let places: Vec<Vec3> = part
            .iter()
            .map(|index| views[*index].2.position_m)
            .collect();
        let middle_m = median_place(&places)?;
        let off: Vec<Vec3> = places
            .iter()
            .map(|place| (place - middle_m).abs())
            .collect();
        let sigma_m = SIGMA_OVER_MAD * median_place(&off)?;
        let noise_m = noise_of(&places).unwrap_or_default();
        let of_part = places.len().div_ceil(PARTS).max(2);
        let of_parts: Vec<Vec3> = places.chunks(of_part).filter_map(median_place).collect();
        let (first, last) = (of_parts.first()?, of_parts.last()?);
        let farthest = |from: &Vec3| {
            let away = of_parts.iter().map(|place| (place - from).norm());
            away.fold(0.0, f64::max)
        };
        let extent_m = of_parts.iter().map(farthest).fold(0.0, f64::max);
        let drift_m = (last - first).norm();
        let of_two_parts = MEDIAN_OVER_MEAN * (2.0 / of_part as f64).sqrt();
        Some(Self {
            middle_m,
            sigma_m,
            noise_m,
            drift_m,
            drift_of_noise_m: DRIFT_SIGMAS * of_two_parts * noise_m.norm(),
            returns: drift_m <= RETURNS * extent_m,
        })
    }

    /// What shows that the camera moves; none of a camera that stands.
    fn describe_movement(&self) -> Option<String> {
        let away_m = self.middle_m.norm();
        let [x, y, z] = <[f64; 3]>::from(self.middle_m);
        let about = format!("about ({x:.1}, {y:.1}, {z:.1}) m");
        let most_drift_m = MOST_DRIFT * away_m + self.drift_of_noise_m;
        let is_spread = (0..3).any(|axis| {
            let is_noise = self.sigma_m[axis] <= SPREAD_OVER_NOISE * self.noise_m[axis];
            let most_spread = if is_noise { MOST_NOISE } else { MOST_SPREAD };
            self.sigma_m[axis] > most_spread * away_m
        });
        if !self.returns && self.drift_m > most_drift_m {
            Some(format!(
                "drift by {:.1} m {about} without coming back",
                self.drift_m
            ))
        } else if is_spread {
            Some(format!(
                "are spread by ±{:.1} m {about}",
                self.sigma_m.amax()
            ))
        } else {
            None
        }
    }
}

/// What each place errs by itself along each axis, 1 σ, m: a camera that moves steadily has no
/// second differences in time. None of fewer than three places.
fn noise_of(places: &[Vec3]) -> Option<Vec3> {
    let seconds = places
        .windows(3)
        .map(|three| three[0] - 2.0 * three[1] + three[2]);
    let seconds: Vec<Vec3> = seconds.map(|second| second.abs()).collect();
    // The squares of 1, 2 and 1 sum up to 6.
    Some(SIGMA_OVER_MAD / 6.0_f64.sqrt() * median_place(&seconds)?)
}

fn median_place(places: &[Vec3]) -> Option<Vec3> {
    let along = |axis: usize| {
        let mut values: Vec<f64> = places.iter().map(|place| place[axis]).collect();
        median(&mut values)
    };
    Some(Vec3::new(along(0)?, along(1)?, along(2)?))
}

/// The base that frames share: their median place, and the pan axis that all of them have, else the
/// one that fits them best.
fn common_base(
    views: &[View],
    part: &[usize],
    exact: Exactness,
    spread: &Spread,
) -> Option<CameraBase> {
    let pinholes = pinholes(views, part);
    let principal_point = pinholes.first()?.principal_point;
    let is_exact = spread.sigma_m.amax() <= EXACT_PLACE_M;
    let axis = pan_axis(&pinholes, exact.angle_rad);
    let mut base = CameraBase::new(
        spread.middle_m,
        CameraBase::rotation_about(&axis.unwrap_or_else(Vec3::z)),
        principal_point,
    );
    if is_exact && axis.is_some() {
        return Some(base);
    }
    let cameras: Option<Vec<PtzCamera>> = pinholes.iter().map(|view| view.ptz_camera()).collect();
    let places = shared_places(&cameras?);
    let shared = &places.first()?.base;
    if axis.is_none() {
        base.base_from_world = shared.base_from_world;
    }
    // Whoever calibrated frames that waver erred in all of them alike, too; a sensor did not.
    if !is_exact {
        base.sigma = BaseSigma {
            position_m: shared.sigma.position_m,
            rotation: shared.sigma.rotation,
            ..BaseSigma::default()
        };
    }
    Some(base)
}

/// 1 σ of how much frames roll on a base, rad.
fn roll_sigma(views: &[View], part: &[usize], base: &CameraBase) -> f64 {
    let axis = -base.base_from_world.row(1).transpose();
    let mut rolls: Vec<f64> = part
        .iter()
        .map(|index| views[*index].2.cam_from_world.row(0).transpose().dot(&axis))
        .map(f64::abs)
        .collect();
    SIGMA_OVER_MAD * median(&mut rolls).unwrap_or(0.0)
}

/// How many frames, and the first of them.
fn describe_part(views: &[View], part: &[usize]) -> String {
    let first = &views[part[0]].0.name;
    format!(
        "the places of {} from {first} on",
        pluralise(part.len(), "frame")
    )
}

#[cfg(test)]
mod tests;
