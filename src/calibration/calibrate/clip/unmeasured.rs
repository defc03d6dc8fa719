//! What the known cameras of a clip leave open of the size of its field, as far as its own pictures
//! do not measure it.

use super::anchors::is_anchor;
use super::certainty::{DIFFER_PX, PaintVerdict};
use super::error::TrackClipError;
use super::fit::ClipFit;
use crate::calibrate::field_size::on_lines::{
    FRAMES, LengthOnLines, PosedPicture, measure_length, other_length,
};
use crate::calibrate::field_size::unseen::{
    LINE_SIGMA_PX, MarkedLines, SeenLines, TELLING_PX, UnseenSize,
};
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::camera::{Ptz, PtzCamera};
use touchline_core::geometry::{ImageSize, Vec3, subsample};
use touchline_documents::document::Frame;
use touchline_vision::media::ReadFrames;
use touchline_vision::paint::{GroundPicture, lines_on_paint};
use touchline_vision::track::{AdjustedClip, AdjustedFrame};

/// The lines that the camera of a frame stands for if its picture is not looked at.
fn seen_unread(_: usize, frame: &Frame) -> Option<SeenLines> {
    is_anchor(frame).then_some(SeenLines::InPicture)
}

/// A known camera stands for a line if the median of its paint lies within this many of
/// [`LINE_SIGMA_PX`] of it.
const ON_PAINT_SIGMAS: f64 = 2.0;

/// Maximum number of pictures of known frames without clicks that are looked at.
const MAX_LOOKS: usize = 16;

/// The lengths of a clip's field with their errors.
#[derive(Default)]
pub(super) struct Unmeasured {
    sizes: Vec<UnseenSize>,
    /// Measured lengths that differ from the assumed ones.
    pub lengths: Vec<LengthOnLines>,
}

impl Unmeasured {
    /// Determines what the known cameras leave open, and measures it where frames adjusted to
    /// points alone show it. Known cameras that the paint contradicts say nothing.
    pub fn measure(
        fit: &ClipFit<'_>,
        by_points: &AdjustedClip,
        paint: &[PaintVerdict],
        reader: &mut dyn ReadFrames,
    ) -> Result<Self, TrackClipError> {
        let (at, clip) = (fit.pictures.at, fit.pictures.clip);
        let Some(camera) = at.document.camera(&clip.camera) else {
            return Ok(Self::default());
        };
        let contradicted: BTreeSet<usize> = clip
            .frames
            .iter()
            .zip(paint)
            .filter(|(_, verdict)| **verdict == PaintVerdict::Contradicts)
            .filter_map(|(frame, _)| frame.place)
            .collect();
        let right = |place: usize, frame: &Frame| {
            seen_unread(place, frame).filter(|_| !contradicted.contains(&place))
        };
        let mut found = Self {
            sizes: UnseenSize::from_known_frames(at, camera, &right)?,
            lengths: Vec::new(),
        };
        if fit.options.paint_every == 0 {
            return Ok(found);
        }
        // Known frames without clicks are believed to show a length only where their paint does.
        if found.sizes.iter().any(|size| !size.is_open()) {
            let on_paint = lines_on_paint_of_known(fit, reader)?;
            let shown = |place: usize, frame: &Frame| match on_paint.get(&place) {
                Some(lines) => right(place, frame).and(Some(SeenLines::Marked(lines.clone()?))),
                None => right(place, frame),
            };
            found.sizes = UnseenSize::from_known_frames(at, camera, &shown)?;
        }
        let reached: Vec<(usize, AdjustedFrame)> = by_points
            .frames
            .iter()
            .enumerate()
            .filter_map(|(frame, reached)| Some((frame, (*reached)?)))
            .collect();
        let least_px = DIFFER_PX * fit.pictures.size.scale_from_1920();
        for unseen in found.sizes.iter_mut().filter(|unseen| unseen.is_open()) {
            let is_telling = |(frame, reached): &&(usize, AdjustedFrame)| {
                let base = fit.camera.base_at(*frame);
                unseen.sigma_px(&base, reached.ptz, fit.pictures.size) > least_px
            };
            let telling: Vec<&(usize, AdjustedFrame)> = reached.iter().filter(is_telling).collect();
            let mut looks = Vec::new();
            for &&(frame, AdjustedFrame { ptz, covariance }) in subsample(&telling, FRAMES) {
                let shown = fit.pictures.read_masked(reader, frame)?;
                looks.push(PosedPicture {
                    ground: GroundPicture::new(&shown.picture, &shown.masks),
                    base: fit.camera.base_at(frame),
                    ptz,
                    turn_sigma_px: covariance[(0, 0)].max(covariance[(1, 1)]).sqrt() * ptz.focal_px,
                });
            }
            let Some(size) = measure_length(unseen, &looks) else {
                continue;
            };
            unseen.take_measured(size.value_m, size.error.sigma_m);
            let other = other_length(at, &clip.camera, unseen, size, looks.len(), &seen_unread)?;
            found.lengths.extend(other);
        }
        Ok(found)
    }

    /// 1-σ in a picture of the lines that no known camera shows, px.
    pub fn sigma_px(&self, camera: &PtzCamera, image: ImageSize) -> f64 {
        let sizes = self.sizes.iter();
        sizes
            .map(|unseen| unseen.sigma_px(camera.base(), camera.ptz(), image))
            .fold(0.0, f64::hypot)
    }
}

/// Of the known frames of a clip without clicks, by their places in the document, the lines that
/// lie on their paint. Of more than [`MAX_LOOKS`] frames, some are looked at, spread over the
/// directions of the camera; the others get none.
fn lines_on_paint_of_known(
    fit: &ClipFit<'_>,
    reader: &mut dyn ReadFrames,
) -> Result<BTreeMap<usize, Option<MarkedLines>>, TrackClipError> {
    let document = fit.pictures.at.document;
    let frames = fit.pictures.clip.frames.iter().enumerate();
    let mut known: Vec<(usize, usize, Ptz)> = frames
        .filter_map(|(frame, of_clip)| {
            let place = of_clip.place?;
            let known = document.frames.get(place)?;
            let ptz = known.ptz.as_ref()?.ptz();
            (is_anchor(known) && !known.is_solved_by_clicks()).then_some((frame, place, ptz))
        })
        .collect();
    known.sort_by(|one, other| one.2.pan.radians().total_cmp(&other.2.pan.radians()));
    let mut on_paint: BTreeMap<_, _> = known.iter().map(|(_, place, _)| (*place, None)).collect();
    let px = fit.pictures.size.scale_from_1920();
    for &(frame, place, ptz) in subsample(&known, MAX_LOOKS) {
        let shown = fit.pictures.read_masked(reader, frame)?;
        let ground = GroundPicture::new(&shown.picture, &shown.masks);
        let camera = PtzCamera::new(fit.camera.base_at(frame), ptz);
        let lines = [Vec3::x(), Vec3::y()].map(|along| {
            let (telling_px, within_px) = (TELLING_PX * px, ON_PAINT_SIGMAS * LINE_SIGMA_PX * px);
            lines_on_paint(&ground, fit.field, &camera, (along, telling_px), within_px)
        });
        on_paint.insert(place, Some(lines));
    }
    Ok(on_paint)
}

#[cfg(test)]
mod tests {
    use super::super::certainty::{TrackedOverlay, confidence};
    use super::*;
    use crate::calibrate::take_length;
    use std::path::Path;
    use touchline_core::camera::{CameraBase, SizeError};
    use touchline_core::field::builtin;
    use touchline_core::testing::base_at;
    use touchline_documents::document::{
        Click, Document, FieldSize, FramePtz, FrameStatus, SolutionSource, Target,
    };
    use touchline_documents::testing::{match_from, new_frame, solved_by};
    use touchline_vision::media::Picture;
    use touchline_vision::synthetic::{FrameOptions, Stadium, StadiumOptions, stadium};

    const SIZE: ImageSize = ImageSize::new(640, 360);

    fn look(pan_deg: f64) -> Ptz {
        Ptz::from_degrees(pan_deg, -12.0, 1066.0)
    }

    /// The known base of a camera beside the middle of a pitch of 105 m.
    fn base() -> CameraBase {
        base_at([1.0, -62.0, 17.0], SIZE)
    }

    fn pitch_of(length_m: f64) -> Stadium {
        let template = builtin("soccer").unwrap();
        let mut params = template.default_params();
        params.insert("length_m".to_owned(), length_m);
        let field = template.model(&params, 0.0).unwrap();
        stadium(&StadiumOptions::new(field, 7))
    }

    /// A document with accepted frames at some pans, on a pitch of an assumed length.
    fn known_at(base: &CameraBase, pans_deg: &[f64], assumed_m: f64) -> Document {
        let mut document = match_from(base, SIZE);
        document
            .field
            .params
            .insert("length_m".to_owned(), assumed_m);
        for pan_deg in pans_deg {
            let mut frame = new_frame(&format!("{pan_deg}.png"), SIZE);
            frame.ptz = Some(FramePtz::new(look(*pan_deg), None));
            frame.status = FrameStatus::Reference;
            document.frames.push(frame.into());
        }
        document
    }

    /// What known frames leave open of the length.
    fn unseen_length(document: &Document) -> UnseenSize {
        let at = document.at(Path::new(""));
        let sizes = UnseenSize::from_known_frames(at, &document.cameras[0], &seen_unread);
        let mut sizes = sizes.unwrap().into_iter();
        sizes
            .find(|unseen| unseen.param().name == "length_m")
            .unwrap()
    }

    /// The drawn pictures of a camera at some pans, as tracked from `base`.
    fn drawn(
        pitch: &Stadium,
        from: &CameraBase,
        base: &CameraBase,
        pans: &[f64],
    ) -> Vec<PosedPicture> {
        let picture = |pan_deg: &f64| {
            let camera = PtzCamera::new(*from, look(*pan_deg));
            let drawn = pitch.render(&camera, SIZE, &FrameOptions::default()).image;
            let rgba = drawn
                .pixels()
                .flat_map(|at| [at[0], at[1], at[2], 255])
                .collect();
            PosedPicture {
                ground: GroundPicture::new(&Picture::new(SIZE, rgba).unwrap(), &[]),
                base: *base,
                ptz: look(*pan_deg),
                turn_sigma_px: 0.1,
            }
        };
        pans.iter().map(picture).collect()
    }

    /// The confidence in a frame with an otherwise nearly exact overlay.
    fn confidence_at(unseen: &UnseenSize, base: &CameraBase, pan_deg: f64) -> f64 {
        let overlay = TrackedOverlay {
            corner_px: unseen.sigma_px(base, look(pan_deg), SIZE).hypot(0.5),
            apart_px: None,
            paint: PaintVerdict::Agrees,
        };
        confidence(&overlay, SIZE)
    }

    /// On a pitch that is assumed 3 m too short, the middle lies nearer to the right end than it is:
    /// by projection alone it comes into pictures that do not show it.
    #[test]
    fn a_line_that_the_assumed_length_puts_just_inside_the_picture_is_not_seen() {
        let shows_middle = |base: &CameraBase, pan_deg: f64| {
            let camera = PtzCamera::new(*base, look(pan_deg));
            let circle = (0..360).map(|deg| {
                let (y, x) = f64::from(deg).to_radians().sin_cos();
                Vec3::new(x, y, 0.0) * 9.15
            });
            let line = (-34..=34).map(|y| Vec3::new(0.0, f64::from(y), 0.0));
            let mut places = circle.chain(line);
            places.any(|at| (camera.image_from_world(at)).is_ok_and(|at| SIZE.contains(at)))
        };
        let mut moved = base();
        moved.position_m.x -= 1.5;
        let mut deceptive = 0;
        for pan_deg in (0..60).map(|step| 20.0 + 0.25 * f64::from(step)) {
            if !shows_middle(&base(), pan_deg) {
                deceptive += usize::from(shows_middle(&moved, pan_deg));
                let document = known_at(&moved, &[pan_deg], 102.0);
                assert!(unseen_length(&document).is_open(), "{pan_deg}");
            }
        }
        assert!(deceptive > 2, "{deceptive}");
    }

    /// Key frames of the middle do not show the length. The overlay of frames at the ends is off by
    /// half of its error, which a small error hides from every check of the paint.
    #[test]
    fn an_end_that_no_key_frame_shows_is_certain_only_once_the_length_is_measured() {
        let (pitch, ends) = (pitch_of(105.0), [24.0, 27.0, 30.0, 33.0, 36.0]);
        for assumed_m in [101.0, 103.0, 104.2, 105.0, 107.0] {
            let document = known_at(&base(), &[-2.0, -1.0, 0.0, 1.0, 2.0], assumed_m);
            let mut unseen = unseen_length(&document);
            assert!(unseen.is_open(), "the middle shows no length");
            let is_sure = |unseen: &UnseenSize, pan| confidence_at(unseen, &base(), pan) >= 0.9;
            assert!(is_sure(&unseen, 0.0), "{assumed_m}: it is seen");
            let sure = ends.iter().filter(|pan| is_sure(&unseen, **pan)).count();
            assert_eq!(sure, 0, "{assumed_m} m: unmeasured");

            // The paint of the ends measures it, as well as the drawn lines lie on it.
            let looks = drawn(&pitch, &base(), &base(), &ends);
            let size = measure_length(&unseen, &looks).expect("a length");
            let off_m = (size.value_m - 105.0).abs();
            assert!(
                off_m < 0.3 && size.error.sigma_m < 0.5,
                "{assumed_m} m: {size:?}"
            );
            unseen.take_measured(size.value_m, size.error.sigma_m);
            let is_right = (assumed_m - 105.0).abs() < 0.1;
            for pan_deg in ends {
                let sure = is_sure(&unseen, pan_deg);
                assert_eq!(sure, is_right, "{assumed_m} m, {pan_deg}°: {size:?}");
            }
            let at = document.at(Path::new(""));
            let other = other_length(at, &"main".into(), &unseen, size, ends.len(), &seen_unread);
            assert_eq!(other.unwrap().is_some(), !is_right, "{assumed_m} m");
        }
    }

    #[test]
    fn key_frames_of_both_ends_or_of_one_with_the_middle_show_the_length() {
        for pans_deg in [&[-36.0, 36.0][..], &[0.0, 36.0], &[-36.0, 0.0], &[22.0]] {
            let unseen = unseen_length(&known_at(&base(), pans_deg, 104.0));
            assert!(!unseen.is_open(), "{pans_deg:?}");
            let sure = confidence_at(&unseen, &base(), 36.0);
            assert!(sure > 0.9, "{pans_deg:?}: {sure}");
        }
        for pans_deg in [&[34.0, 36.0][..], &[-34.0], &[0.0], &[]] {
            let unseen = unseen_length(&known_at(&base(), pans_deg, 104.0));
            assert!(unseen.is_open(), "{pans_deg:?}");
        }
    }

    /// Clicks at the right end say nothing of the circle at the edge of the same picture.
    #[test]
    fn of_a_clicked_frame_only_the_lines_with_clicks_are_seen() {
        let mut document = known_at(&base(), &[22.0], 104.0);
        let frame: &mut Frame = &mut document.frames[0];
        frame.solution = solved_by(SolutionSource::Clicks);
        let at = SIZE.centre();
        let ends = ["goal_area_far_right_goal_line", "corner_far_right"];
        frame.clicks = ends.map(|id| Click::landmark(id.into(), at)).into();
        assert!(unseen_length(&document).is_open());
        let circle = Click::new(Target::Line("centre_circle".into()), at);
        document.frames[0].clicks.push(circle);
        assert!(!unseen_length(&document).is_open());
    }

    /// A known camera without clicks stands for the lines that lie on their paint.
    #[test]
    fn the_circle_is_seen_only_where_the_paint_shows_it() {
        let document = known_at(&base(), &[22.0], 104.0);
        let at = document.at(Path::new(""));
        let field = at.model_of(&document.field).unwrap();
        let is_open = |is_seen: &dyn Fn(&str) -> bool| {
            let marked = field.lines.iter().map(|line| is_seen(line.id.as_str()));
            let marked: Vec<bool> = marked.collect();
            let seen =
                |_: usize, _: &Frame| Some(SeenLines::Marked([marked.clone(), marked.clone()]));
            let sizes = UnseenSize::from_known_frames(at, &document.cameras[0], &seen).unwrap();
            sizes
                .iter()
                .any(|size| size.param().name == "length_m" && size.is_open())
        };
        assert!(!is_open(&|_| true));
        assert!(is_open(&|line| line.contains("right")));
    }

    #[test]
    fn a_length_that_the_base_was_fitted_with_is_known_as_well_as_the_base_states() {
        let mut fitted = base();
        fitted.sigma.size[0] = SizeError::alone(0.4);
        let unseen = unseen_length(&known_at(&fitted, &[-1.0, 0.0, 1.0], 104.0));
        assert!(!unseen.is_open(), "though no known frame shows an end");
        assert!(unseen_length(&known_at(&base(), &[-1.0, 0.0, 1.0], 104.0)).is_open());
    }

    /// Where the right end was seen, the camera moves with it.
    #[test]
    fn the_paint_of_the_middle_measures_the_length_and_the_camera_moves_with_the_end_it_saw() {
        for (length_m, stated) in [(101.0, None), (108.0, Some(FieldSize::Confirmed))] {
            // On a pitch of 105 m, this base projects the right end as the true one.
            let moved_m = Vec3::x() * ((105.0 - length_m) / 2.0);
            let moved = CameraBase {
                position_m: base().position_m + moved_m,
                ..base()
            };
            let mut document = known_at(&moved, &[33.0, 35.0, 37.0, 39.0], 105.0);
            document.field.size.clone_from(&stated);
            let unseen = unseen_length(&document);
            let middle: Vec<f64> = (13..21).map(f64::from).collect();
            let looks = drawn(&pitch_of(length_m), &base(), &moved, &middle);
            let size = measure_length(&unseen, &looks).expect("a length");
            let off_m = (size.value_m - length_m).abs();
            assert!(off_m < 0.5 && off_m < 2.0 * size.error.sigma_m, "{size:?}");
            let at = document.at(Path::new(""));
            let other = other_length(
                at,
                &"main".into(),
                &unseen,
                size,
                middle.len(),
                &seen_unread,
            );
            let other = other.unwrap().expect("another length");
            assert_eq!(other.is_prescribed, stated.is_some());
            take_length(&mut document, &other);
            assert_eq!(document.field.size, Some(FieldSize::Fitted));
            let off_m = document.cameras[0].position_m.unwrap() - base().position_m;
            assert!(off_m.norm() < 0.25, "{off_m} m off");
        }
    }

    #[test]
    fn neither_field_nor_base_goes_beyond_the_lengths_that_the_rules_allow() {
        let unseen = unseen_length(&known_at(&base(), &[35.0, 37.0], 105.0));
        let longest_m = unseen.param().max_m;
        let (longest, moved_m) = unseen.at_length(longest_m).unwrap();
        let (beyond, moved_beyond_m) = unseen.at_length(longest_m + 40.0).unwrap();
        assert_eq!((longest.length_m, beyond.length_m), (longest_m, longest_m));
        assert_eq!(moved_m, moved_beyond_m);
        assert!(
            (moved_m.x - 0.5 * (longest_m - 105.0)).abs() < 0.01,
            "{moved_m}"
        );
    }

    #[test]
    fn too_few_pictures_give_no_length() {
        let unseen = unseen_length(&known_at(&base(), &[0.0], 105.0));
        let looks = drawn(&pitch_of(105.0), &base(), &base(), &[30.0, 32.0]);
        assert_eq!(measure_length(&unseen, &looks), None);
    }
}
