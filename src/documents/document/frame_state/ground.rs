//! What a frame's camera is good for on the ground: which part of the field its picture shows, how
//! exactly places are known there, and whether speeds can be taken from them.
//!
//! A person who stands is put elsewhere in every frame by as much as the cameras err. What all
//! frames of a camera share (its place, its lens) hardly moves that person, what each frame has of
//! its own does. So a frame that is good for a map need not be good for speeds.

use super::super::{
    Clip, Document, DocumentAt, Extra, Fields, Frame, FrameStatus, Ground, GroundGrade,
};
use rayon::prelude::*;
use std::collections::BTreeMap;
use touchline_core::camera::PtzCamera;
use touchline_core::field::{FieldError, FieldModel};
use touchline_core::geometry::{ImageSize, Vec2, Vec3};
use touchline_core::score::visible_outline;
use touchline_core::solve::{Uncertainty, covariance_in_radians, covariance_of_four_points};

/// An error in the plane is at most so many σ (the root of the covariance's trace) with a
/// probability of 95 %: 1.73 where it is alike in all directions, 1.96 where it lies along one.
const WITHIN_95: f64 = 1.96;
/// The error of a place within which a map is good, m.
const MAP_M: f64 = 0.5;
/// The speed of a standing point within which speeds are good, m/s.
const SPEED_M_S: f64 = 0.1;
/// Speeds are taken over about a second, as data of players are smoothed before anyone takes
/// speeds from them: the frame that is nearest to this time away, within the limits, s.
const OVER_S: f64 = 1.0;
const SHORTEST_S: f64 = 0.5;
const LONGEST_S: f64 = 2.0;
/// A camera that is wrong with a higher probability than this holds no limit at 95 %.
const LEAST_CONFIDENCE: f64 = 0.95;

/// What no solve states: paint and points are seen beside their place by a part of a pixel, which
/// wanders with the view. Each frame is known no better than by four points with this σ, px of the
/// picture itself. Cameras tracked through drawn clips of 640 × 360 are 0.5 to 0.7 px off, and
/// move by as much in a second, where 0.1 px is stated.
const UNSEEN_PX: f64 = 0.5;

/// A solved frame and the uncertainty of its camera.
struct Known {
    index: usize,
    time_s: Option<f64>,
    camera: PtzCamera,
    /// None where none is stated, or the camera is not believed.
    uncertainty: Option<Uncertainty>,
}

impl DocumentAt<'_> {
    /// What the camera of each frame is good for on the ground, in the order of the frames; none
    /// for a frame that is not solved, or rejected.
    ///
    /// # Errors
    /// A field of the document is not valid.
    pub fn ground_of_frames(self) -> Result<Vec<Option<Ground>>, FieldError> {
        Ok(ground_of_frames(self.document, &Fields::as_stated(self)?))
    }
}

fn ground_of_frames(document: &Document, fields: &Fields) -> Vec<Option<Ground>> {
    let known: Vec<Option<Known>> = document
        .frames
        .par_iter()
        .enumerate()
        .map(|(index, frame)| find_known(document, frame, index))
        .collect();
    let mut clips: BTreeMap<_, Vec<Known>> = BTreeMap::new();
    for one in known.into_iter().flatten() {
        let frame = &document.frames[one.index];
        let clip: (Option<&str>, &str, Option<&Clip>) = (
            frame.video.as_ref().map(|video| &*video.path),
            frame.camera.as_str(),
            frame.clip.as_ref(),
        );
        clips.entry(clip).or_default().push(one);
    }
    let mut grounds = vec![None; document.frames.len()];
    for mut clip in clips.into_values() {
        // Frames whose time is not known stand at the front, where no search finds them.
        clip.sort_by(|a, b| compare_times(a.time_s, b.time_s));
        let of_clip: Vec<(usize, Ground)> = clip
            .par_iter()
            .map(|one| {
                let frame = &document.frames[one.index];
                let field = fields.for_frame(document, frame);
                (one.index, ground_of(one, &clip, field, frame.image_size))
            })
            .collect();
        for (index, ground) in of_clip {
            grounds[index] = Some(ground);
        }
    }
    grounds
}

fn compare_times(one: Option<f64>, other: Option<f64>) -> std::cmp::Ordering {
    let time = |time_s: Option<f64>| time_s.unwrap_or(f64::NEG_INFINITY);
    time(one).total_cmp(&time(other))
}

/// A frame's camera and what is known of its error; none where it has none.
fn find_known(document: &Document, frame: &Frame, index: usize) -> Option<Known> {
    let camera = document.ptz_camera(frame)?;
    if frame.status == FrameStatus::Rejected {
        return None;
    }
    let solution = frame.solution.as_ref();
    let confidence = solution.and_then(|solution| solution.confidence);
    // A person who accepted the camera has answered what the probability asks.
    let is_believed = frame.status == FrameStatus::Reference
        || confidence.is_none_or(|confidence| confidence >= LEAST_CONFIDENCE);
    // Without the frame's own part the total stands for it, which states too much.
    let own = solution.and_then(|solution| solution.own_covariance.or(solution.covariance));
    let uncertainty = own.filter(|_| is_believed).and_then(|own| {
        let unseen = covariance_of_four_points(&camera, frame.image_size, UNSEEN_PX);
        let own = covariance_in_radians(&own) + unseen;
        Uncertainty::from_covariance(&camera, own, frame.image_size).ok()
    });
    let time_s = frame.video.as_ref().and_then(|video| video.pts_s);
    Some(Known {
        index,
        time_s: time_s.filter(|time_s| time_s.is_finite()),
        camera,
        uncertainty,
    })
}

fn ground_of(one: &Known, clip: &[Known], field: &FieldModel, size: ImageSize) -> Ground {
    let points = middle_of_picture(&one.camera, field, size);
    let sigma_m = largest(&points, |point| {
        let error = one.uncertainty?.ground_error(&one.camera, point)?;
        Some(error.sigma_m())
    });
    let grade = match sigma_m {
        Some(sigma_m) if WITHIN_95 * sigma_m <= MAP_M => {
            let speed_m_s = false_speed_m_s(one, clip, &points);
            if speed_m_s.is_some_and(|speed_m_s| WITHIN_95 * speed_m_s <= SPEED_M_S) {
                GroundGrade::Speed
            } else {
                GroundGrade::Map
            }
        }
        _ => GroundGrade::None,
    };
    let outline = visible_outline(field, &one.camera, size);
    Ground {
        grade,
        sigma_m,
        visible_area_m: outline.into_iter().map(to_centimetres).collect(),
        extra: Extra::new(),
    }
}

/// A point with as many digits as such an outline is worth.
fn to_centimetres(point: Vec2) -> [f64; 2] {
    // Adding zero makes a zero of a negative one.
    <[f64; 2]>::from(point).map(|coordinate| (coordinate * 100.0).round() / 100.0 + 0.0)
}

/// Points of the field in the middle third of the picture, at most nine.
fn middle_of_picture(camera: &PtzCamera, field: &FieldModel, size: ImageSize) -> Vec<Vec3> {
    /// Cells along a side; those in the middle third are counted from the third one on.
    const CELLS: u32 = 9;
    let middle = CELLS / 3..CELLS / 3 * 2;
    let cells = middle
        .clone()
        .flat_map(|column| middle.clone().map(move |row| [column, row]));
    cells
        .filter_map(|cell| camera.plane_from_image(size.cell_centre(cell, [CELLS; 2]), 0.0))
        .filter(|point| {
            point.x.abs() <= field.length_m / 2.0 && point.y.abs() <= field.width_m / 2.0
        })
        .collect()
}

/// The largest value at some points; none without points, or where one has none.
fn largest(points: &[Vec3], value: impl Fn(Vec3) -> Option<f64>) -> Option<f64> {
    let values: Option<Vec<f64>> = points.iter().map(|point| value(*point)).collect();
    values?
        .into_iter()
        .reduce(f64::max)
        .filter(|m| m.is_finite())
}

/// 1-σ of the speed at which points of a frame seem to move, against the frames a second before
/// and after it, m/s; none where there are none, or one of them is not known.
fn false_speed_m_s(one: &Known, clip: &[Known], points: &[Vec3]) -> Option<f64> {
    let time_s = one.time_s?;
    let partners = [time_s - OVER_S, time_s + OVER_S]
        .into_iter()
        .filter_map(|wanted_s| nearest_in_time(clip, wanted_s))
        .filter(|partner| {
            let apart_s = partner
                .time_s
                .map_or(0.0, |other_s| (other_s - time_s).abs());
            (SHORTEST_S..=LONGEST_S).contains(&apart_s)
        });
    let speeds: Option<Vec<f64>> = partners
        .map(|partner| {
            let apart_s = (partner.time_s? - time_s).abs();
            largest(points, |point| {
                let here = one.uncertainty?.ground_error(&one.camera, point)?;
                let there = partner.uncertainty?.ground_error(&partner.camera, point)?;
                Some(here.sigma_of_move_m(&there) / apart_s)
            })
        })
        .collect();
    speeds?.into_iter().reduce(f64::max)
}

/// The frame of a clip, sorted by time, that is nearest to a time.
fn nearest_in_time(clip: &[Known], wanted_s: f64) -> Option<&Known> {
    let after = clip.partition_point(|known| known.time_s.is_none_or(|time_s| time_s < wanted_s));
    let candidates = [after.checked_sub(1), Some(after)];
    candidates
        .into_iter()
        .filter_map(|index| clip.get(index?))
        .filter(|known| known.time_s.is_some())
        .min_by(|a, b| {
            let away = |known: &Known| known.time_s.map_or(f64::INFINITY, |s| (s - wanted_s).abs());
            away(a).total_cmp(&away(b))
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Camera, Solution, VideoFrame};
    use crate::testing::{new_frame, ptz_at, soccer_document};
    use std::path::Path;
    use touchline_core::camera::{BaseSigma, CameraBase};
    use touchline_core::testing::{SIZE, base_at};

    /// A clip of three seconds that pans; every frame is known like four points with this σ (px),
    /// the camera's place to `place_m`.
    fn clip(sigma_px: f64, place_m: f64) -> Document {
        let mut document = soccer_document();
        let mut camera = Camera::new("main".into(), SIZE);
        let sigma = BaseSigma {
            position_m: Vec3::repeat(place_m),
            ..BaseSigma::default()
        };
        let base = base_at([0.0, -60.0, 18.0], SIZE);
        camera.set_base(&CameraBase { sigma, ..base });
        document.cameras.push(camera.into());
        for index in 0..76_u32 {
            let mut frame = new_frame("1.jpg", SIZE);
            frame.image = None;
            frame.id = format!("{index}").as_str().into();
            frame.video = Some(VideoFrame::new(
                "a.mp4",
                u64::from(index),
                Some(f64::from(index) * 0.04),
            ));
            frame.status = FrameStatus::Suggested;
            frame.ptz = ptz_at(f64::from(index) * 0.1 - 4.0, -14.0, 5000.0);
            let camera = document.cameras[0].ptz_camera(&frame).unwrap();
            let own = covariance_of_four_points(&camera, SIZE, sigma_px);
            let known = Uncertainty::from_covariance(&camera, own, SIZE).unwrap();
            frame.solution = Some(Solution {
                covariance: Some(known.ptz_covariance_deg()),
                own_covariance: Some(known.own_covariance_deg()),
                ..Solution::default()
            });
            document.frames.push(frame.into());
        }
        document
    }

    fn grounds(document: &Document) -> Vec<Option<Ground>> {
        document.at(Path::new("")).ground_of_frames().unwrap()
    }

    /// The grade of the frame in the middle of a clip.
    fn grade(document: &Document) -> GroundGrade {
        grounds(document)[38].as_ref().unwrap().grade
    }

    #[test]
    fn what_frames_share_costs_a_map_and_no_speed() {
        assert_eq!(grade(&clip(0.2, 0.0)), GroundGrade::Speed);
        assert_eq!(
            grade(&clip(0.2, 0.15)),
            GroundGrade::Speed,
            "a common error"
        );
        assert_eq!(
            grade(&clip(3.0, 0.0)),
            GroundGrade::Map,
            "errors of each frame"
        );
        assert_eq!(grade(&clip(0.2, 30.0)), GroundGrade::None);
        assert_eq!(grade(&clip(40.0, 0.0)), GroundGrade::None);
        let [alone, shared] = [0.0, 0.15].map(|place_m| {
            let ground = grounds(&clip(0.2, place_m)).swap_remove(38).unwrap();
            ground.sigma_m.unwrap()
        });
        assert!(shared > 2.0 * alone, "{shared} {alone}");
    }

    #[test]
    fn a_grade_needs_times_uncertainty_and_belief() {
        let good = clip(0.2, 0.0);
        let changed = |change: &dyn Fn(&mut Frame)| {
            let mut document = good.clone();
            for frame in &mut document.frames {
                change(frame);
            }
            document
        };
        let without_times = changed(&|frame| {
            let number = frame.video_frame_index().unwrap();
            frame.video = Some(VideoFrame::new("a.mp4", number, None));
        });
        assert_eq!(grade(&without_times), GroundGrade::Map);
        // A second has only its end in another clip.
        let cut = changed(&|frame| {
            let number = frame.video_frame_index().unwrap();
            frame.clip = Some(Clip::Number(i64::from(number > 45)));
        });
        assert_eq!(grade(&cut), GroundGrade::Speed, "the second before it");
        let short = changed(&|frame| {
            let number = frame.video_frame_index().unwrap();
            frame.clip = Some(Clip::Number(number as i64 / 10));
        });
        assert_eq!(grade(&short), GroundGrade::Map);
        let doubted = changed(&|frame| frame.solution.as_mut().unwrap().confidence = Some(0.6));
        assert_eq!(grade(&doubted), GroundGrade::None);
        let accepted = changed(&|frame| {
            frame.solution.as_mut().unwrap().confidence = Some(0.6);
            frame.status = FrameStatus::Reference;
        });
        assert_eq!(grade(&accepted), GroundGrade::Speed);
        let imported = changed(&|frame| frame.solution = None);
        let ground = grounds(&imported).swap_remove(38).unwrap();
        assert_eq!((ground.grade, ground.sigma_m), (GroundGrade::None, None));
        assert!(
            ground.visible_area_m.len() >= 4,
            "it follows from the camera alone"
        );
        let rejected = changed(&|frame| frame.status = FrameStatus::Rejected);
        assert!(grounds(&rejected).iter().all(Option::is_none));
    }

    #[test]
    fn a_dataset_states_it_and_a_second_one_states_it_anew() {
        let mut document = clip(0.2, 0.0);
        let dataset = document.at(Path::new("")).to_dataset().unwrap();
        let stated = |document: &Document| document.frames[38].solution.clone().unwrap().ground;
        assert_eq!(stated(&dataset).unwrap().grade, GroundGrade::Speed);
        let text = crate::document::document_to_string(&dataset).unwrap();
        let again = crate::document::document_from_bytes(text.as_bytes()).unwrap();
        assert_eq!(again, dataset);
        document = dataset;
        document.frames[38].status = FrameStatus::Rejected;
        let dataset = document.at(Path::new("")).to_dataset().unwrap();
        assert_eq!(stated(&dataset), None);
    }
}
