//! Given cameras put on one place by their numbers alone, where there is no picture to compare them
//! with.
//!
//! 1. Impossible and mirrored cameras are recognized as with pictures, and the place that the
//!    others share becomes the camera of all frames.
//! 2. Smoothness. A frame whose camera lies farther from those of its neighbours than they lie
//!    apart loses it, the farthest first, until all agree ([`Disagreements`]).
//! 3. Short gaps are interpolated.
//!
//! No claim of a confidence follows from this: a stretch of frames that are wrong alike is smooth.

use super::given::given_cameras;
use super::places::{Shots, mirror_back};
use super::{MendError, count_usable};
use crate::calibrate::{Disagreement, Disagreements, withdraw};
use std::collections::BTreeMap;
use std::path::Path;
use touchline_core::solve::base::SharedPlace;
use touchline_documents::document::{
    Camera, Clip, Document, Fields, Frame, FrameId, FramePtz, FrameStatus, Solution, SolutionSource,
};

/// A camera is out of line if it is farther than this from what its neighbours predict, px at
/// 1920 px width, and farther than they are apart. Programs that calibrate frames one by one
/// scatter by 10 px.
const OUT_OF_LINE_PX: f64 = 20.0;

/// The longest gap that is interpolated, frames of the video. Within a second a camera may look
/// elsewhere.
const LONGEST_GAP: f64 = 12.0;

/// What became of given cameras without pictures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MendedNumbers {
    /// Number of frames that came with a camera.
    pub came: usize,
    /// Number of impossible cameras among them.
    pub impossible: usize,
    /// Number of mirrored cameras among them.
    pub mirrored: usize,
    /// Number of cameras that are out of line with those of their neighbours.
    pub out_of_line: usize,
    /// Number of frames whose camera was interpolated.
    pub interpolated: usize,
    /// The places that the cameras share.
    pub places: Vec<SharedPlace>,
    /// The frames that have no camera.
    pub left: Vec<FrameId>,
}

/// Mends the given cameras of a document without its pictures. Frames that people decided on keep
/// their cameras.
///
/// # Errors
/// There is nothing to mend, the cameras have no place in common, or the field of a camera is not
/// valid; the document is then unchanged.
pub fn mend_numbers(document: &mut Document, folder: &Path) -> Result<MendedNumbers, MendError> {
    let fields = Fields::from_document(document.at(folder))?;
    let given = given_cameras(document, &fields);
    let cameras = count_usable(&given)?;
    // All frames are one shot, since only pictures show cuts.
    let shots = Shots::new(document, Vec::new(), &given).ok_or(MendError::NoPlace { cameras })?;
    let given = mirror_back(&given, &shots.places);
    // On a copy: an error leaves the document as it is.
    let mut mended = document.clone();
    join_shots(&mut mended);
    shots.place_cameras(&mut mended, &given, None);
    let out_of_line = drop_out_of_line(&mut mended);
    let interpolated = interpolate_gaps(&mut mended);
    let left = mended.frames.iter().filter(|frame| frame.ptz.is_none());
    let result = MendedNumbers {
        came: given.iter().filter(|given| !given.is_missing()).count(),
        impossible: given.iter().filter(|given| given.fault().is_some()).count(),
        mirrored: given.iter().filter(|given| given.is_mirrored()).count(),
        out_of_line,
        interpolated,
        left: left.map(|frame| frame.id.clone()).collect(),
        places: shots.places,
    };
    *document = mended;
    Ok(result)
}

/// Puts frames that belong to neither a shot nor a video into one shot: cameras of single files are
/// those of a sequence, in the order of the files.
fn join_shots(document: &mut Document) {
    for index in 0..document.frames.len() {
        let frame = &document.frames[index];
        if frame.clip.is_none() && frame.video.is_none() {
            document.frames[index].clip = Some(Clip::Number(1));
        }
    }
}

/// Takes away the cameras that are out of line with those of their neighbours, the farthest first:
/// its neighbours seem out of line only as long as it is there. Returns their number.
fn drop_out_of_line(document: &mut Document) -> usize {
    let mut disagreements = Disagreements::from_document(document);
    let all: Vec<usize> = (0..document.frames.len()).collect();
    let mut out = BTreeMap::new();
    update_out_of_line(document, &disagreements, &all, &mut out);
    // Each round removes one camera, so the loop ends. Only the neighbours of the removed one are
    // compared anew.
    let mut dropped = 0;
    while let Some(index) = farthest_frame(&out) {
        withdraw(&mut document.frames[index]);
        out.remove(&index);
        dropped += 1;
        let edition = disagreements.edition();
        disagreements.update(document);
        let changed = disagreements.changes_since(edition).unwrap_or(&all);
        update_out_of_line(document, &disagreements, changed, &mut out);
    }
    dropped
}

/// Updates `out`, the frames whose cameras are out of line with their distances in px, at some
/// frames of the document.
fn update_out_of_line(
    document: &Document,
    disagreements: &Disagreements,
    frames: &[usize],
    out: &mut BTreeMap<usize, f64>,
) {
    for &index in frames {
        let found = disagreements.for_frame(index).filter(is_out_of_line);
        out.remove(&index);
        if let Some(found) = found.filter(|_| document.frames[index].is_open()) {
            out.insert(index, found.apart_px);
        }
    }
}

/// The frame with the greatest distance, of equal ones the last.
fn farthest_frame(out: &BTreeMap<usize, f64>) -> Option<usize> {
    let worst = out.iter().max_by(|(_, a), (_, b)| a.total_cmp(b));
    worst.map(|(index, _)| *index)
}

fn is_out_of_line(found: &Disagreement) -> bool {
    found.apart_px > OUT_OF_LINE_PX && found.apart_px > found.neighbours_px
}

/// Interpolates pan, tilt and the logarithm of the focal length over short gaps between frames of
/// one shot. Frames of other shots within a gap are left alone. Returns the number of filled
/// frames.
fn interpolate_gaps(document: &mut Document) -> usize {
    // A person found the camera of a rejected frame wrong, so it is no end of a gap.
    let solved: Vec<usize> = (0..document.frames.len())
        .filter(|index| {
            let frame = &document.frames[*index];
            frame.ptz.is_some() && frame.status != FrameStatus::Rejected
        })
        .collect();
    let mut filled = 0;
    for pair in solved.windows(2) {
        let [before, after] = [pair[0], pair[1]];
        let [first, last] = [before, after].map(|index| &document.frames[index]);
        let ends = [first, last].map(|frame| frame.ptz.as_ref().map(FramePtz::ptz));
        let [Some(from), Some(to)] = ends else {
            continue;
        };
        let (start, end) = (first.number_at(before) as f64, last.number_at(after) as f64);
        if !are_of_one_shot(first, last) || (end - start).abs() - 1.0 > LONGEST_GAP {
            continue;
        }
        let base = document.camera(&first.camera).and_then(Camera::base);
        let missing: Vec<(usize, f64)> = (before + 1..after)
            .filter_map(|index| {
                let frame = &document.frames[index];
                let share = (frame.number_at(index) as f64 - start) / (end - start);
                let is_missing = frame.is_open() && are_of_one_shot(first, frame);
                // A document may list the frames of a video in any order.
                (is_missing && (0.0..=1.0).contains(&share)).then_some((index, share))
            })
            .collect();
        // The camera is taken to move uniformly from one end of the gap to the other.
        for (index, share) in missing {
            let ptz = from.interpolate(&to, share);
            let frame = &mut document.frames[index];
            let lens = base.map(|base| base.distortion.radial_at(ptz.focal_px));
            frame.point(ptz, lens.unwrap_or_default());
            frame.status = FrameStatus::Suggested;
            frame.solution = Some(Solution {
                source: Some(SolutionSource::Interpolated),
                ..Solution::default()
            });
            filled += 1;
        }
    }
    filled
}

/// Whether two frames are of the same camera, clip and video.
fn are_of_one_shot(one: &Frame, other: &Frame) -> bool {
    one.camera == other.camera && one.clip == other.clip && one.video_path() == other.video_path()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::{BaseAngles, CameraBase, Ptz, Radial};
    use touchline_core::geometry::{ImageSize, Vec3};
    use touchline_documents::document::{CameraId, FieldSpec, VideoFrame};

    const SIZE: ImageSize = ImageSize::new(1920, 1080);

    /// Frames of a camera that pans by 0.3° a frame; each has a camera of its own, 2 cm beside the
    /// common place.
    fn document(frames: usize) -> Document {
        let mut document = Document::new(FieldSpec::new("soccer"));
        for index in 0..frames {
            let id = CameraId::from(format!("main-{index}").as_str());
            let mut camera = Camera::new(id.clone(), SIZE);
            let off_m = 0.02 * (index % 3) as f64;
            camera.set_base(&CameraBase::new(
                Vec3::new(1.0 + off_m, -70.0, 18.0),
                BaseAngles::default().base_from_world(),
                SIZE.centre(),
            ));
            document.cameras.push(camera.into());
            let mut frame = Frame::from_image(&format!("{index:03}.jpg"), id, SIZE);
            let pan_deg = -6.0 + 0.3 * index as f64;
            frame.point(Ptz::from_degrees(pan_deg, -12.0, 2400.0), Radial::default());
            frame.status = FrameStatus::Suggested;
            frame.solution = Some(Solution {
                source: Some(SolutionSource::Import),
                ..Solution::default()
            });
            document.frames.push(frame.into());
        }
        document
    }

    fn pan_deg(document: &Document, index: usize) -> f64 {
        let ptz = document.frames[index].ptz.as_ref().unwrap().ptz();
        ptz.pan.degrees()
    }

    #[test]
    fn cameras_out_of_line_are_replaced_by_those_between_their_neighbours() {
        let mut document = document(40);
        document.frames[10].point(Ptz::from_degrees(12.0, -12.0, 2400.0), Radial::default());
        document.frames[20].point(Ptz::from_degrees(0.0, -12.0, 3.0e6), Radial::default());
        let mended = mend_numbers(&mut document, Path::new("/match")).unwrap();
        assert_eq!(
            (mended.came, mended.impossible, mended.out_of_line),
            (40, 1, 1)
        );
        assert_eq!((mended.interpolated, mended.left.len()), (2, 0));
        assert_eq!(document.cameras.len(), 1);
        for index in 0..40 {
            let expected = -6.0 + 0.3 * index as f64;
            let off_deg = (pan_deg(&document, index) - expected).abs();
            assert!(off_deg < 0.1, "{index}: {off_deg}");
        }
        let source = |index: usize| document.frames[index].source();
        assert_eq!(source(10), Some(SolutionSource::Interpolated));
        assert_eq!(source(11), Some(SolutionSource::Import));
    }

    #[test]
    fn long_gaps_stay_and_are_named() {
        let mut document = document(60);
        for index in 20..40 {
            document.frames[index].point(Ptz::from_degrees(0.0, -12.0, 3.0e6), Radial::default());
        }
        let mended = mend_numbers(&mut document, Path::new("/match")).unwrap();
        assert_eq!((mended.impossible, mended.interpolated), (20, 0));
        assert_eq!(mended.left.len(), 20);
        assert_eq!(mended.left[0], document.frames[20].id);
    }

    #[test]
    fn frames_of_other_shots_in_a_gap_stay_as_they_are() {
        let changes: [fn(&mut Frame); 3] = [
            |frame| frame.camera = "beside".into(),
            |frame| frame.clip = Some(Clip::Number(2)),
            |frame| frame.video = Some(VideoFrame::new("other.mp4", 0, None)),
        ];
        for change in changes {
            let mut document = document(4);
            let main = document.frames[0].camera.clone();
            for frame in &mut document.frames {
                frame.camera.clone_from(&main);
            }
            for index in [1, 2] {
                withdraw(&mut document.frames[index]);
            }
            change(&mut document.frames[2]);
            let before = document.frames[2].clone();
            assert_eq!(interpolate_gaps(&mut document), 1);
            assert_eq!(document.frames[2], before);
            assert!((pan_deg(&document, 1) + 5.7).abs() < 1e-9);
        }
    }

    #[test]
    fn a_gap_is_as_long_as_it_is_in_the_video() {
        for (numbers, filled) in [([0, 3, 9, 12], 2), ([0, 30, 90, 120], 0)] {
            let mut document = document(4);
            let main = document.frames[0].camera.clone();
            for (frame, number) in document.frames.iter_mut().zip(numbers) {
                frame.camera.clone_from(&main);
                frame.video = Some(VideoFrame::new("match.mp4", number, None));
            }
            for index in [1, 2] {
                withdraw(&mut document.frames[index]);
            }
            assert_eq!(interpolate_gaps(&mut document), filled, "{numbers:?}");
            if filled > 0 {
                // A quarter of the way from -6° to -5.1°.
                assert!((pan_deg(&document, 1) + 5.775).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_rejected_camera_is_no_end_of_a_gap() {
        let mut document = document(5);
        let main = document.frames[0].camera.clone();
        for frame in &mut document.frames {
            frame.camera.clone_from(&main);
        }
        for index in [1, 2] {
            withdraw(&mut document.frames[index]);
        }
        document.frames[3].point(Ptz::from_degrees(40.0, -12.0, 2400.0), Radial::default());
        document.frames[3].status = FrameStatus::Rejected;
        assert_eq!(interpolate_gaps(&mut document), 2);
        assert!((pan_deg(&document, 1) + 5.7).abs() < 1e-9);
    }

    #[test]
    fn nothing_possible_is_an_error_and_changes_nothing() {
        let mut document = document(5);
        for frame in &mut document.frames {
            frame.point(Ptz::from_degrees(0.0, -12.0, 3.0e6), Radial::default());
        }
        let before = document.clone();
        let error = mend_numbers(&mut document, Path::new("/match")).unwrap_err();
        assert!(
            matches!(error, MendError::NonePossible { cameras: 5, .. }),
            "{error}"
        );
        assert_eq!(document, before);
    }
}
