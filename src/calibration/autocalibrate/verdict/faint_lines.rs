//! Lines that are too faint for any single picture, seen in the mean of all of them.
//!
//! A far line may be a fifth of a pixel wide, and re-encoding or filming off a screen takes what
//! contrast it has. No picture shows it to a detector, so it would count as missing, which speaks
//! against a camera. Averaged along the line and over all frames it stands out ([`LineContrast`]):
//! where the camera predicts it, the mean is brighter than on either side. Where no line is, one
//! side is as bright: an edge, such as that of a mowing stripe, a shadow or a board, is no line.

use crate::autocalibrate::frames::matched_frames::MatchedFrames;
use crate::autocalibrate::frames::sampled_frames::{MAX_PICTURES_IN_MEMORY, PictureOfFrame};
use crate::calibrate::{AutocalibratedCamera, AutocalibratedFrame};
use touchline_core::camera::PtzCamera;
use touchline_core::markings::{SampleOptions, sample_lines};
use touchline_vision::paint::{GroundPicture, LineContrast};

/// Minimum contrast of a line with the brighter side, grey levels. Of 130 lines of nine right
/// cameras 124 have it in the mean of 30 frames, 119 have 1.0. Beside lines 2 % of the profiles
/// reach it from the sides and corners of a pitch, 14 % from behind a goal, where other lines are
/// near.
const MIN_CONTRAST: f64 = 0.5;

/// With fewer places a mean says nothing.
const MIN_PLACES: usize = 100;

/// Distance between two places of the profile across a line, px.
const STEP_PX: f64 = 0.5;

/// The profile has this number of places on either side of the line, and its own. A line is where
/// the camera predicts it if one of them shows it: the far lines of a right camera may be 2 px off.
const STEPS_ON_A_SIDE: usize = 4;
const NUM_PLACES: usize = 2 * STEPS_ON_A_SIDE + 1;

/// The profile across a line.
type Profile = [LineContrast; NUM_PLACES];

/// What the mean of all frames shows of some lines, by index of the line in the field. Lines that
/// too few frames show are in neither list.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct LinesInMean {
    pub seen: Vec<usize>,
    pub absent: Vec<usize>,
}

/// Looks for all lines of the field in the mean of all frames.
pub fn find_lines_in_mean(
    camera: &AutocalibratedCamera,
    matched: &MatchedFrames,
    picture: PictureOfFrame<'_>,
) -> LinesInMean {
    let mut found = LinesInMean::default();
    let profiles = sum_profiles(camera, matched, picture);
    for (line, profile) in profiles.iter().enumerate() {
        match is_line(profile) {
            Some(true) => found.seen.push(line),
            Some(false) => found.absent.push(line),
            None => {}
        }
    }
    found
}

/// The profiles across the lines of the field, summed over all frames.
fn sum_profiles(
    camera: &AutocalibratedCamera,
    matched: &MatchedFrames,
    picture: PictureOfFrame<'_>,
) -> Vec<Profile> {
    let num_lines = camera.field.lines.len();
    let mut sums = vec![[LineContrast::default(); NUM_PLACES]; num_lines];
    for frames in camera.frames.chunks(MAX_PICTURES_IN_MEMORY) {
        // Added in the order of the frames, so that the sum does not depend on the threads.
        let of_frames = matched.look_at_pictures(frames, picture, |frame, ground| {
            profiles(camera, frame, ground)
        });
        for of_frame in of_frames.into_iter().flatten() {
            for (sum, profile) in sums.iter_mut().zip(of_frame) {
                for (sum, contrast) in sum.iter_mut().zip(profile) {
                    *sum += contrast;
                }
            }
        }
    }
    sums
}

/// The profiles across the lines of the field in the picture of one frame.
///
/// Distances are larger in pictures of more than 960 px width, where blur is wider.
fn profiles(
    camera: &AutocalibratedCamera,
    frame: &AutocalibratedFrame,
    ground: &GroundPicture,
) -> Vec<Profile> {
    let options = SampleOptions {
        spacing_px: 4.0,
        border_px: 8.0,
    };
    let looking = PtzCamera::new(camera.base, frame.best_ptz());
    let samples = sample_lines(&camera.field, &looking, ground.size(), &options);
    let scale = (2.0 * ground.size().scale_from_1920()).max(1.0);
    let mut profiles = vec![[LineContrast::default(); NUM_PLACES]; camera.field.lines.len()];
    for sample in &samples {
        for (index, contrast) in profiles[sample.line].iter_mut().enumerate() {
            let offset_px = scale * STEP_PX * (index as f64 - STEPS_ON_A_SIDE as f64);
            contrast.add(ground, sample, offset_px, scale);
        }
    }
    profiles
}

/// Whether the profile across a line shows one. None if the line has too few places to say; beside
/// thick paint, where the turf to compare with is paint itself, there may be fewer.
fn is_line(profile: &Profile) -> Option<bool> {
    let has_enough = |contrast: &LineContrast| contrast.num_places() >= MIN_PLACES;
    let is_seen = |contrast: &LineContrast| {
        has_enough(contrast) && contrast.mean().is_some_and(|mean| mean >= MIN_CONTRAST)
    };
    has_enough(&profile[STEPS_ON_A_SIDE]).then(|| profile.iter().any(is_seen))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autocalibrate::rotating_camera::{
        IMAGE_SIZE, draw_picture, hypothesis, matched_views, ptz, soccer,
    };
    use rayon::prelude::*;
    use touchline_core::field::FieldModel;
    use touchline_core::geometry::Angle;
    use touchline_vision::media::Picture;
    use touchline_vision::paint::MarkingPixels;

    const TURF: [f64; 3] = [60.0, 120.0, 60.0];

    /// The pictures of all views, with the paint this share as bright above the turf as it is, and
    /// with noise of up to three grey levels.
    fn faint_pictures(field: &FieldModel, share: f64) -> Vec<Picture> {
        let drawn = ptz().into_par_iter().enumerate().map(|(view, ptz)| {
            let mut state = 1 + view as u32;
            let drawn = draw_picture(field, ptz);
            let faint = drawn.rgba().chunks_exact(4).flat_map(|pixel| {
                // A linear congruential generator (Numerical Recipes).
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let noise = f64::from(state >> 16) / 65_536.0 * 6.0 - 3.0;
                let channel = |index: usize| {
                    let above = f64::from(pixel[index]) - TURF[index];
                    (TURF[index] + share * above + noise).round() as u8
                };
                [channel(0), channel(1), channel(2), 255]
            });
            Picture::new(IMAGE_SIZE, faint.collect()).unwrap()
        });
        drawn.collect()
    }

    /// What a camera that is turned up by an angle has of its lines in some pictures.
    fn look_turned(pictures: &[Picture], by_deg: f64) -> LinesInMean {
        let (mut camera, matched) = (hypothesis(&soccer().assumed).camera, matched_views());
        for frame in &mut camera.frames {
            frame.ptz.tilt = frame.ptz.tilt + Angle::from_degrees(by_deg);
        }
        let first = camera.frames[0].index;
        find_lines_in_mean(&camera, &matched, &mut |index| {
            pictures.get(index - first).cloned()
        })
    }

    #[test]
    fn lines_below_the_noise_are_seen_in_the_mean_of_all_frames() {
        let pictures = faint_pictures(&soccer().assumed, 0.03);
        let found = look_turned(&pictures, 0.0);
        assert!(found.seen.len() >= 3 * found.absent.len(), "{found:?}");
        assert!(found.seen.len() >= 9, "{found:?}");
        // A detector sees next to nothing of them in one picture.
        let num_detected = |picture: &Picture| {
            MarkingPixels::detect(&GroundPicture::new(picture, &[]))
                .points
                .len()
        };
        let plain = draw_picture(&soccer().assumed, ptz()[3]);
        let (faint, plain) = (num_detected(&pictures[3]), num_detected(&plain));
        assert!(10 * faint < plain, "{faint} of {plain}");
    }

    #[test]
    fn a_camera_that_looks_beside_its_lines_does_not_see_them() {
        let pictures = faint_pictures(&soccer().assumed, 0.03);
        // 0.2° are 4 px and more.
        let found = look_turned(&pictures, 0.2);
        assert!(found.absent.len() >= 2 * found.seen.len(), "{found:?}");
    }

    #[test]
    fn bare_turf_shows_no_lines() {
        let pictures = faint_pictures(&soccer().assumed, 0.0);
        assert_eq!(look_turned(&pictures, 0.0).seen, [0; 0]);
    }

    #[test]
    fn pictures_that_cannot_be_read_say_nothing() {
        assert_eq!(look_turned(&[], 0.0), LinesInMean::default());
    }
}
