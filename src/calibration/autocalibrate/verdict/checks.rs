//! The final checks that a camera has to pass before it becomes the answer.
//!
//! The evidence of the joint adjustment ([`crate::autocalibrate::adjustment::evidence`]) comes from the coarse paint by which
//! the camera was found. These checks use each frame's own picture at full resolution: how many
//! frames agree with it, whether a predicted line is missing, and whether a click contradicts it.

use super::faint_lines::LinesInMean;
use crate::autocalibrate::error::Stop;
use crate::autocalibrate::field_prior::FieldPrior;
use crate::autocalibrate::frames::matched_frames::MatchedFrames;
use crate::autocalibrate::search::clicked::GroundClick;
use crate::autocalibrate::{Abstention, Doubt};
use crate::calibrate::{AutocalibratedCamera, AutocalibratedFrame, UNSTEADY_SHARE};
use std::collections::BTreeMap;
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::geometry::Vec3;
use touchline_core::solve::base::FittedSize;
use touchline_core::solve::{Observation, SolveContext, solve_frame};
use touchline_documents::document::Frames;
use touchline_vision::paint::MarkingPixels;

/// Minimum share of the frames that agree with the painted lines of their own pictures. Right
/// answers had 0.9 and more on real and drawn matches, wrong ones 0.5 and less.
pub const MIN_ALIGNED: f64 = 0.75;

/// Where fewer frames agree, their line checks have to state this in the mean … A frame agrees from
/// 0.8 on, and many frames of a poor clip lie just below: the means of right cameras are 0.75 to
/// 0.85 there. It is not enough alone: a wrong camera had 0.79.
const MIN_MEAN_CHECK: f64 = 0.75;

/// … and at least this share of the lines is seen in the mean of all frames, of at least so many.
const MIN_SEEN_IN_MEAN: f64 = 0.75;
const MIN_LINES_IN_MEAN: usize = 6;

/// The same before the base is refined, of the frames that it was found from: a position that is
/// nearly right is still brought onto its lines.
const MIN_ALIGNED_BEFORE_REFINING: f64 = 0.5;

/// With a runner-up that explains nearly as much, at least this share agrees with the answer …
pub const MIN_ALIGNED_WITH_RUNNER_UP: f64 = 0.85;

/// … and at most this share with the runner-up.
const MAX_ALIGNED_OF_RUNNER_UP: f64 = 0.65;

/// A click farther than this from the projection of its landmark contradicts the camera, px at 1920
/// px width.
const CONTRADICTING_PX: f64 = 25.0;

/// A click this near to the projection of its landmark confirms the camera, px at 1920 px width: a
/// click is 2 to 3 px off, in small pictures two to three times that, and the projection a few px.
/// Landmarks of a wrong camera were 30 px off in the median (drawn clip 27 of the bowl).
const CONFIRMING_PX: f64 = 15.0;

/// Two clicks confirm a camera if their landmarks are at least this far apart, m, or this share of
/// the field's diagonal where that is less: no two points of a badminton court are 20 m apart. One
/// end of a field can lie on its paint while the other does not …
const CONFIRMING_APART_M: f64 = 20.0;
const CONFIRMING_APART_SHARE: f64 = 0.4;

/// … and if at least this number of lines is seen in the mean of all frames. Fewer leave the rest
/// of the field open, of which clicks on two places say little: a camera on a low mast, 1.7 m off on
/// a field 2.2 m too short, had both clicks on their landmarks and three lines in the mean (drawn
/// clip 9 of the bowl); right ones had five and eight.
pub const MIN_LINES_WITH_CLICKS: usize = 5;

/// Abstains, with the reasons to reject the best candidate.
pub fn uncertain(doubts: Vec<Doubt>, best: AutocalibratedCamera) -> Stop {
    Abstention::Uncertain {
        doubts,
        best: Some(Box::new(best)),
    }
    .into()
}

/// The number of frames whose agreement with the camera counts: those whose picture was compared
/// with it, and those that it was found from. A search leaves out frames with little paint on their
/// lines, and of a wrong camera these are the ones that contradict it.
fn num_compared(camera: &AutocalibratedCamera) -> usize {
    line_check_scores(camera)
        .count()
        .max(camera.evidence.frames)
}

/// The scores of the line checks, of all frames that were compared with the camera.
fn line_check_scores(camera: &AutocalibratedCamera) -> impl Iterator<Item = f64> {
    let frames = camera.frames.iter();
    frames.filter_map(AutocalibratedFrame::line_check_score)
}

/// The share of aligned frames, of a number of frames.
fn aligned_share(camera: &AutocalibratedCamera, of: usize) -> f64 {
    camera.aligned_frame_count() as f64 / of.max(1) as f64
}

/// Whether the frames together confirm a camera with which too few of them agree one by one.
pub fn is_confirmed_in_mean(camera: &AutocalibratedCamera, lines: &LinesInMean) -> bool {
    let sum_of_checks: f64 = line_check_scores(camera).sum();
    let mean_check = sum_of_checks / num_compared(camera).max(1) as f64;
    let num_lines = lines.seen.len() + lines.absent.len();
    mean_check >= MIN_MEAN_CHECK
        && num_lines >= MIN_LINES_IN_MEAN
        && lines.seen.len() as f64 >= MIN_SEEN_IN_MEAN * num_lines as f64
}

/// The reason to reject a camera with which too small a share of its frames agrees.
pub fn few_aligned(camera: &AutocalibratedCamera, min_share: f64) -> Option<Doubt> {
    few_aligned_of(camera, num_compared(camera), min_share)
}

/// The same before the base is refined, when a camera that is nearly right is beside the lines of
/// frames that it was not found from.
pub fn few_aligned_before_refining(camera: &AutocalibratedCamera) -> Option<Doubt> {
    few_aligned_of(camera, camera.evidence.frames, MIN_ALIGNED_BEFORE_REFINING)
}

fn few_aligned_of(camera: &AutocalibratedCamera, frames: usize, min_share: f64) -> Option<Doubt> {
    let snapped = camera.aligned_frame_count();
    (aligned_share(camera, frames) < min_share).then_some(Doubt::FewSnapped { snapped, frames })
}

/// Whether the frames' own pictures contradict a runner-up.
pub fn is_refuted(runner_up: &AutocalibratedCamera) -> bool {
    aligned_share(runner_up, runner_up.evidence.frames) <= MAX_ALIGNED_OF_RUNNER_UP
}

/// The reason to reject a camera whose frames do not determine the size of the field: the lines
/// that they do not show, or the position itself, may be off by metres.
pub fn open_size(camera: &AutocalibratedCamera) -> Option<Doubt> {
    let open = camera.sizes.iter().find(|size| size.is_open)?;
    Some(size_doubt(open))
}

/// The reason to reject a camera if its frames show a length of the field, but not the same one each
/// time that it is measured. A length that they do not show at all is no such reason.
///
/// The 1-σ of a length that they show exceeds [`UNSTEADY_SHARE`] where the coarse paint and the
/// frames' own pictures, or one fit and the next, give other lengths: of drawn clip 9 of the bowl
/// 103.6 and 115.6 m (104.4 m is right), and 24 of 30 frames agreed with the latter. Of right
/// cameras it was 0.67 m at most.
pub fn unsteady_size(camera: &AutocalibratedCamera) -> Option<Doubt> {
    let worst_m = UNSTEADY_SHARE * camera.field.width_m;
    let is_unsteady = |size: &&FittedSize| !size.is_open && size.error.sigma_m > worst_m;
    camera.sizes.iter().find(is_unsteady).map(size_doubt)
}

fn size_doubt(size: &FittedSize) -> Doubt {
    Doubt::SizeOpen {
        name: size.name.clone(),
        value_m: size.value_m,
        sigma_m: size.error.sigma_m,
    }
}

/// The reason to reject a camera whose field has an unusual size, where the document does not state
/// one.
pub fn unusual_size(camera: &AutocalibratedCamera, prior: &FieldPrior) -> Option<Doubt> {
    let unusual = prior.unusual_length(&camera.field)?;
    Some(Doubt::UnusualSize {
        name: unusual.name,
        value_m: unusual.value_m,
    })
}

/// The frames of a camera, each with the marking pixels of its picture.
pub fn cameras_and_pictures<'a>(
    camera: &AutocalibratedCamera,
    matched: &'a MatchedFrames,
) -> Vec<(PtzCamera, &'a MarkingPixels)> {
    let looking = |frame: &AutocalibratedFrame| {
        let marking_pixels = &matched.marking_pixels[matched.number_of(frame.index)?];
        Some((PtzCamera::new(camera.base, frame.ptz), marking_pixels))
    };
    camera.frames.iter().filter_map(looking).collect()
}

/// A click in a frame of a camera, compared with its landmark.
struct ClickOffset<'a> {
    click: &'a GroundClick,
    /// The position of the landmark, m.
    landmark_m: Vec3,
    /// The distance of the click from the projection of its landmark, px of the frame.
    off_px: f64,
    /// The same at 1920 px width.
    off_px_at_1920: f64,
}

/// The views of a camera's frames, by their index in the document.
fn answered_views(camera: &AutocalibratedCamera) -> BTreeMap<usize, Ptz> {
    let frames = camera.frames.iter();
    frames
        .map(|frame| (frame.index, frame.best_ptz()))
        .collect()
}

/// The views from a camera's base, by their own clicks alone, of the frames that have enough of
/// them to contradict it.
fn views_by_clicks(
    camera: &AutocalibratedCamera,
    clicks: &[GroundClick],
    frames: &Frames,
) -> BTreeMap<usize, Ptz> {
    /// Two clicks fit pan, tilt and focal length on any base.
    const MIN_CONTRADICTING: usize = 3;
    // The clicks of each frame, as observations of landmarks on the camera's field.
    let mut of_frames: BTreeMap<usize, Vec<Observation>> = BTreeMap::new();
    for (index, click) in clicks.iter().enumerate() {
        let (name, size) = (click.landmark.as_str(), frames[click.frame].image_size);
        let seen = Observation::from_landmark(&camera.field, name, click.image, size, index);
        of_frames.entry(click.frame).or_default().extend(seen.ok());
    }
    of_frames.retain(|_, seen| seen.len() >= MIN_CONTRADICTING);
    // The base stays as it is: only where the frame looks is open.
    let view = |(frame, seen): (usize, Vec<Observation>)| {
        let context = SolveContext::new(frames[frame].image_size);
        Some((frame, solve_frame(&camera.base, &seen, &context).ok()?.ptz))
    };
    of_frames.into_iter().filter_map(view).collect()
}

/// Compares the clicks with the projections of their landmarks. `clicks` use the indices of the
/// document. Clicks in frames without a view, or on landmarks that the camera's field lacks, say
/// nothing.
fn click_offsets<'a>(
    camera: &'a AutocalibratedCamera,
    views: BTreeMap<usize, Ptz>,
    clicks: &'a [GroundClick],
    frames: &'a Frames,
) -> impl Iterator<Item = ClickOffset<'a>> {
    clicks.iter().filter_map(move |click| {
        let view = *views.get(&click.frame)?;
        let landmark = camera.field.landmark(click.landmark.as_str())?;
        let landmark_m = camera.field.landmark_in_world(landmark);
        let seen = PtzCamera::new(camera.base, view).image_from_world(landmark_m);
        // A landmark behind the camera cannot be seen where it was clicked.
        let off_px = seen.map_or(f64::INFINITY, |seen| seen.distance_px(click.image));
        Some(ClickOffset {
            click,
            landmark_m,
            off_px,
            off_px_at_1920: off_px / frames[click.frame].image_size.scale_from_1920(),
        })
    })
}

/// The reason to reject a camera that a click contradicts, for the first such click. A frame that
/// the camera does not answer is looked at from its base: the clicks of the frame choose the view.
pub fn contradicting_click(
    camera: &AutocalibratedCamera,
    clicks: &[GroundClick],
    frames: &Frames,
) -> Option<Doubt> {
    // What the paint of a frame says of its view comes before its clicks.
    let mut views = views_by_clicks(camera, clicks, frames);
    views.extend(answered_views(camera));
    click_offsets(camera, views, clicks, frames)
        .find(|offset| offset.off_px_at_1920 > CONTRADICTING_PX)
        .map(|offset| Doubt::ClickContradicts {
            landmark: offset.click.landmark.as_str().to_owned(),
            frame: frames[offset.click.frame].name(),
            off_px: offset.off_px,
        })
}

/// Whether clicks confirm a camera that was found without them: two landmarks far apart lie where
/// it projects them.
pub fn is_confirmed_by_clicks(
    camera: &AutocalibratedCamera,
    clicks: &[GroundClick],
    frames: &Frames,
) -> bool {
    let near_m: Vec<Vec3> = click_offsets(camera, answered_views(camera), clicks, frames)
        .filter(|offset| offset.off_px_at_1920 <= CONFIRMING_PX)
        .map(|offset| offset.landmark_m)
        .collect();
    let field = &camera.field;
    let diagonal_m = field.length_m.hypot(field.width_m);
    let apart_m = CONFIRMING_APART_M.min(CONFIRMING_APART_SHARE * diagonal_m);
    let is_far_from = |one: &Vec3| near_m.iter().any(|other| (other - one).norm() >= apart_m);
    near_m.iter().any(is_far_from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autocalibrate::adjustment::evidence::missing_lines;
    use crate::autocalibrate::rotating_camera::{
        IMAGE_SIZE, document, hypothesis, matched_views, matched_views_with_pixels, soccer,
    };
    use touchline_core::camera::SizeError;
    use touchline_core::geometry::{Angle, ImagePoint, Vec2};
    use touchline_core::markings::project_landmarks;

    #[test]
    fn frames_that_are_not_aligned_are_counted() {
        let mut camera = hypothesis(&soccer().assumed).camera;
        camera.evidence.frames = 7;
        assert_eq!(
            few_aligned(&camera, MIN_ALIGNED),
            Some(Doubt::FewSnapped {
                snapped: 0,
                frames: 7
            })
        );
        assert_eq!(few_aligned(&camera, 0.0), None);
        assert!(is_refuted(&camera));
    }

    /// Frames that the search left out count where their pictures contradict the camera.
    #[test]
    fn frames_that_the_camera_was_not_found_from_count_once_it_is_refined() {
        let mut camera = hypothesis(&soccer().assumed).camera;
        camera.evidence.frames = 3;
        for frame in &mut camera.frames {
            frame.unaligned_score = Some(0.1);
        }
        let few = |frames: usize| Some(Doubt::FewSnapped { snapped: 0, frames });
        assert_eq!(few_aligned_before_refining(&camera), few(3));
        assert_eq!(few_aligned(&camera, MIN_ALIGNED), few(7));
    }

    #[test]
    fn frames_that_agree_together_confirm_a_camera_whose_lines_are_seen() {
        let mut camera = hypothesis(&soccer().assumed).camera;
        camera.evidence.frames = 7;
        let lines = |num_seen: usize, num_absent: usize| LinesInMean {
            seen: (0..num_seen).collect(),
            absent: (0..num_absent).collect(),
        };
        assert!(
            !is_confirmed_in_mean(&camera, &lines(9, 0)),
            "no line check"
        );
        for frame in &mut camera.frames {
            frame.unaligned_score = Some(0.78);
        }
        assert!(is_confirmed_in_mean(&camera, &lines(9, 2)));
        assert!(
            !is_confirmed_in_mean(&camera, &lines(9, 4)),
            "lines are absent"
        );
        assert!(
            !is_confirmed_in_mean(&camera, &lines(5, 0)),
            "too few lines"
        );
        camera.frames[0].unaligned_score = None;
        assert!(
            !is_confirmed_in_mean(&camera, &lines(9, 2)),
            "0.67 in the mean"
        );
    }

    #[test]
    fn a_length_that_the_frames_do_not_show_or_not_steadily_is_a_doubt() {
        let mut camera = hypothesis(&soccer().assumed).camera;
        assert_eq!(open_size(&camera), None);
        let size = |name: &str, sigma_m: f64, is_open: bool| FittedSize {
            name: name.to_owned(),
            assumed_m: 105.0,
            value_m: 104.0,
            error: SizeError::alone(sigma_m),
            is_open,
        };
        let doubt = |name: &str, sigma_m: f64| {
            Some(Doubt::SizeOpen {
                name: name.to_owned(),
                value_m: 104.0,
                sigma_m,
            })
        };
        camera.sizes = vec![size("length_m", 0.5, false), size("width_m", 2.5, true)];
        assert_eq!(open_size(&camera), doubt("width_m", 2.5));
        assert_eq!(unsteady_size(&camera), None);

        camera.sizes[0].cover_error(6.0);
        assert_eq!(unsteady_size(&camera), doubt("length_m", 6.0));
    }

    #[test]
    fn a_field_of_an_unusual_size_is_a_doubt() {
        let mut prior = soccer();
        let mut camera = hypothesis(&prior.assumed).camera;
        let mut doubt_at = |length_m, width_m| {
            camera.field = prior.with_lengths(&[length_m, width_m]).unwrap();
            unusual_size(&camera, &prior)
        };
        assert_eq!(doubt_at(101.0, 75.0), None);
        // 84 m are not tried: the search stops at 79.25 m.
        let (name, value_m) = ("width_m".to_owned(), 79.25);
        assert_eq!(
            doubt_at(101.0, 84.0),
            Some(Doubt::UnusualSize { name, value_m })
        );
        // A stated size is that of the venue, however unusual.
        prior.is_known = true;
        assert_eq!(unusual_size(&camera, &prior), None);
    }

    #[test]
    fn a_click_beside_where_the_camera_has_its_landmark_contradicts_it() {
        let (camera, document) = (hypothesis(&soccer().assumed).camera, document());
        let (frame, landmark) = (
            &camera.frames[3],
            camera.field.landmark("centre_mark").unwrap(),
        );
        let seen = PtzCamera::new(camera.base, frame.ptz)
            .image_from_world(camera.field.landmark_in_world(landmark))
            .unwrap();
        let click = |frame: usize, landmark: &str, off_px: f64| GroundClick {
            frame,
            landmark: landmark.into(),
            image: seen.translate(Vec2::new(0.6, 0.8) * off_px),
        };
        let doubt = |clicks: &[GroundClick]| contradicting_click(&camera, clicks, &document.frames);

        // In a picture of 960 px width the limit is half of 25 px.
        let near = click(frame.index, "centre_mark", 12.0);
        assert_eq!(doubt(std::slice::from_ref(&near)), None);
        let Some(Doubt::ClickContradicts {
            landmark,
            frame: name,
            off_px,
        }) = doubt(&[near, click(frame.index, "centre_mark", 13.0)])
        else {
            panic!("the second click is too far away");
        };
        assert_eq!(
            (landmark.as_str(), name.as_str()),
            ("centre_mark", "13.png")
        );
        assert!((off_px - 13.0).abs() < 1e-9, "{off_px}");

        // Clicks in another frame, or on a landmark that the field lacks, are ignored.
        assert_eq!(
            doubt(&[
                click(2, "centre_mark", 400.0),
                click(frame.index, "centre_of_gravity", 400.0)
            ]),
            None
        );
    }

    /// The landmarks of the ground that a frame of a camera shows, as clicks.
    fn clicks_on_all(camera: &AutocalibratedCamera, frame: usize) -> Vec<GroundClick> {
        let frame = &camera.frames[frame];
        let looking = PtzCamera::new(camera.base, frame.ptz);
        let landmarks = project_landmarks(&camera.field, &looking, IMAGE_SIZE, 0.0);
        let clicks = landmarks.iter().map(|shown| GroundClick {
            frame: frame.index,
            landmark: camera.field.landmarks[shown.landmark].id.clone(),
            image: shown.image,
        });
        let on_ground = |click: &GroundClick| {
            let landmark = camera.field.landmark(click.landmark.as_str());
            landmark.is_some_and(touchline_core::field::Landmark::is_on_ground)
        };
        clicks.filter(on_ground).collect()
    }

    #[test]
    fn clicks_in_a_frame_without_an_answer_contradict_another_place_of_the_camera() {
        let (mut camera, document) = (hypothesis(&soccer().assumed).camera, document());
        let clicks = clicks_on_all(&camera, 3);
        assert!(clicks.len() >= 3, "{clicks:?}");
        camera.frames.remove(3);
        let doubt = |camera: &AutocalibratedCamera, clicks: &[GroundClick]| {
            contradicting_click(camera, clicks, &document.frames)
        };
        assert_eq!(doubt(&camera, &clicks), None);
        camera.base.position_m.x += 15.0;
        let off = doubt(&camera, &clicks);
        assert!(
            matches!(off, Some(Doubt::ClickContradicts { .. })),
            "{off:?}"
        );
        // Two clicks fit any place.
        assert_eq!(doubt(&camera, &clicks[..2]), None);
    }

    #[test]
    fn two_clicks_far_apart_where_the_camera_has_their_landmarks_confirm_it() {
        let (camera, document) = (hypothesis(&soccer().assumed).camera, document());
        // Two landmarks that one frame shows, at least 30 m apart.
        let shown = |frame: usize| clicks_on_all(&camera, frame);
        let all: Vec<GroundClick> = (0..camera.frames.len()).flat_map(shown).collect();
        let frames = &document.frames;
        assert!(is_confirmed_by_clicks(&camera, &all, frames));
        assert!(
            !is_confirmed_by_clicks(&camera, &all[..1], frames),
            "one click"
        );
        // 16 px at 1920 px width are 8 px in these pictures.
        let mut off = all.clone();
        for click in &mut off {
            click.image = click.image.translate(Vec2::new(8.0, 0.0));
        }
        assert!(!is_confirmed_by_clicks(&camera, &off, frames), "8 px off");
        let same = [all[0].clone(), all[0].clone()];
        assert!(
            !is_confirmed_by_clicks(&camera, &same, frames),
            "one landmark"
        );
    }

    #[test]
    fn a_click_on_what_the_camera_has_behind_it_contradicts_it() {
        let (mut camera, document) = (hypothesis(&soccer().assumed).camera, document());
        camera.frames[3].ptz.pan = camera.frames[3].ptz.pan + Angle::from_degrees(180.0);
        let image = ImagePoint::new(480.0, 270.0);
        let click = GroundClick {
            frame: camera.frames[3].index,
            landmark: "centre_mark".into(),
            image,
        };
        let doubt = contradicting_click(&camera, &[click], &document.frames);
        assert!(
            matches!(
                doubt,
                Some(Doubt::ClickContradicts {
                    off_px: f64::INFINITY,
                    ..
                })
            ),
            "{doubt:?}"
        );
    }

    fn missing(camera: &AutocalibratedCamera, matched: &MatchedFrames) -> Vec<usize> {
        missing_lines(&camera.field, &cameras_and_pictures(camera, matched))
    }

    #[test]
    fn nothing_is_missing_where_no_open_ground_is_seen() {
        let mut camera = hypothesis(&soccer().assumed).camera;
        camera.frames.clear();
        assert_eq!(missing(&camera, &matched_views()), [0; 0]);
    }

    #[test]
    fn nothing_is_missing_in_pictures_that_show_all_lines() {
        let camera = hypothesis(&soccer().assumed).camera;
        assert_eq!(
            missing(
                &camera,
                &matched_views_with_pixels(&camera.field, &[0, 1, 2, 3, 4, 5, 6])
            ),
            [0; 0]
        );
    }

    #[test]
    fn lines_are_missing_in_pictures_of_bare_turf() {
        let camera = hypothesis(&soccer().assumed).camera;
        let missing = missing(&camera, &matched_views());
        assert!(missing.len() >= 4, "{missing:?}");
    }
}
