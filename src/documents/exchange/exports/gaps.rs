//! Frames that are missing between solved frames of a video: they are interpolated and marked as
//! such, or split the export into takes.

use super::choose::{NOT_SOLVED, is_chosen};
use super::exported::Exported;
use crate::document::{
    Camera, Document, DocumentAt, Frame, FrameId, FrameLens, FramePtz, FrameStatus, Frames, Shared,
    Solution, SolutionSource, VideoFrame,
};
use crate::exchange::error::ExchangeError;
use crate::exchange::files::Files;
use crate::exchange::options::FrameChoice;
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::camera::Radial;
use touchline_core::geometry::{ImagePoint, pluralise};

/// The chosen frames, and interpolated cameras for gaps of up to `most` frames between two solved
/// frames of the same video, camera and clip. Pan, tilt and the logarithm of the focal length are
/// interpolated linearly in time. A gap that contains a rejected frame, a frame of another camera
/// or clip, or one with a camera that was not chosen, is not filled. Gaps that were not filled are
/// reported in a note.
pub fn interpolate_gaps(
    document: &Document,
    choice: &FrameChoice,
    most: u64,
) -> (Document, Option<String>) {
    let by_number: ByNumber<'_> = document
        .frames
        .iter()
        .filter_map(|frame| {
            let video = frame.video.as_ref()?;
            Some(((video.path.as_str(), video.frame_index), &**frame))
        })
        .collect();
    // The new frames of each gap, by the frame before it.
    let mut filled: BTreeMap<FrameId, Vec<Frame>> = BTreeMap::new();
    let (mut long, mut held) = (0_usize, 0_usize);
    for run in runs(document, choice) {
        for pair in run.windows(2) {
            let (before, after) = (pair[0], pair[1]);
            let missing = missing_between(before, after);
            if missing == 0 {
                continue;
            }
            if missing > most {
                long += 1;
                continue;
            }
            match between(document, &by_number, before, after) {
                Some(between) => drop(filled.insert(before.id.clone(), between)),
                None => held += 1,
            }
        }
    }
    let mut frames: Vec<Shared<Frame>> = Vec::new();
    // Frames that were there without a camera are in `filled` with one, behind the frame before
    // their gap, and nowhere else.
    let new: BTreeSet<&FrameId> = filled.values().flatten().map(|frame| &frame.id).collect();
    for frame in document
        .frames
        .iter()
        .filter(|frame| is_chosen(frame, choice) && !new.contains(&frame.id))
    {
        frames.push(frame.clone());
        frames.extend(
            filled
                .get(&frame.id)
                .into_iter()
                .flatten()
                .cloned()
                .map(Shared::from),
        );
    }
    let reasons = [
        (
            long,
            format!("longer than {}", pluralise(most as usize, "frame")),
        ),
        (
            held,
            "with a rejected frame, or one of another camera or clip or that was not requested"
                .to_owned(),
        ),
    ];
    let reasons: Vec<String> = reasons
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, why)| format!("{} {why}", pluralise(count, "gap")))
        .collect();
    let note = (!reasons.is_empty()).then(|| format!("not filled: {}", reasons.join(", ")));
    (
        Document {
            frames: frames.into_iter().collect(),
            ..document.clone()
        },
        note,
    )
}

/// The frames of a document by their video and their number in it.
type ByNumber<'a> = BTreeMap<(&'a str, u64), &'a Frame>;

/// The number of video frames between two frames.
fn missing_between(before: &Frame, after: &Frame) -> u64 {
    let number = after.video_frame_index().unwrap_or(0);
    number
        .saturating_sub(before.video_frame_index().unwrap_or(0))
        .saturating_sub(1)
}

/// The chosen, solved frames of each video, camera and clip, by their numbers.
fn runs<'a>(document: &'a Document, choice: &FrameChoice) -> Vec<Vec<&'a Frame>> {
    let mut runs: BTreeMap<_, Vec<(u64, &Frame)>> = BTreeMap::new();
    for frame in document
        .frames
        .iter()
        .filter(|frame| is_chosen(frame, choice) && frame.ptz.is_some())
    {
        if let Some(video) = &frame.video {
            let run = runs
                .entry((&video.path, &frame.camera, &frame.clip))
                .or_default();
            run.push((video.frame_index, frame));
        }
    }
    runs.into_values().map(sort_by_number).collect()
}

/// The frames of a run in the order of their numbers.
fn sort_by_number(mut run: Vec<(u64, &Frame)>) -> Vec<&Frame> {
    run.sort_by_key(|(number, _)| *number);
    run.into_iter().map(|(_, frame)| frame).collect()
}

/// The interpolated frames between two; none if one of the frames there is rejected, is of another
/// camera or clip, or is solved.
fn between(
    document: &Document,
    by_number: &ByNumber<'_>,
    before: &Frame,
    after: &Frame,
) -> Option<Vec<Frame>> {
    let (first, last) = (before.video.as_ref()?, after.video.as_ref()?);
    let path = first.path.as_str();
    let numbers = first.frame_index + 1..last.frame_index;
    // A person rejected what is there, or chose other frames: neither is to be invented anew. A
    // frame of another camera or clip shows that there is a cut within the gap.
    let is_other = |frame: &Frame| {
        frame.camera != before.camera || frame.clip.is_some() && frame.clip != before.clip
    };
    if by_number
        .range((path, numbers.start)..(path, numbers.end))
        .any(|(_, frame)| {
            frame.status == FrameStatus::Rejected || frame.ptz.is_some() || is_other(frame)
        })
    {
        return None;
    }
    let camera = document.camera_of(before)?;
    numbers
        .map(|number| {
            let there = by_number.get(&(path, number)).copied();
            frame_at(number, there, before, after, camera)
        })
        .collect()
}

/// A frame with an interpolated camera.
fn frame_at(
    number: u64,
    there: Option<&Frame>,
    before: &Frame,
    after: &Frame,
    camera: &Camera,
) -> Option<Frame> {
    let (first, last) = (before.video.as_ref()?, after.video.as_ref()?);
    let share = (number - first.frame_index) as f64 / (last.frame_index - first.frame_index) as f64;
    let (from, to) = (before.ptz.as_ref()?, after.ptz.as_ref()?);
    let mut ptz = from.ptz().interpolate(&to.ptz(), share);
    // A lens that the frame itself states is known; else one between those of its neighbours.
    let stated = there.and_then(|frame| frame.lens.clone());
    let lens = stated.or_else(|| lens_between(before, after, share, ptz.focal_px));
    if let Some(lens) = &lens {
        ptz.focal_px = lens.focal_px;
    }
    // A camera with a curve knows its k₁ at any focal length; only where there is none, the frames
    // state their own.
    let radial = match &lens {
        Some(lens) => Some(lens.radial()),
        None => camera.curve().map(|curve| curve.radial_at(ptz.focal_px)),
    };
    let mut solved = FramePtz::new(ptz, radial);
    if radial.is_none() {
        solved.k1 = from
            .k1
            .zip(to.k1)
            .map(|(from, to)| at_share(from, to, share));
    }
    let pts_s = first
        .pts_s
        .zip(last.pts_s)
        .map(|(from, to)| at_share(from, to, share));
    // A frame of the document keeps its image, clicks and id.
    let frame = there.cloned().unwrap_or_else(|| Frame {
        clip: before.clip.clone(),
        ..Frame::from_video(
            VideoFrame {
                file_id: first.file_id.clone(),
                ..VideoFrame::new(&first.path, number, pts_s)
            },
            before.camera.clone(),
            before.image_size,
        )
    });
    let source = Some(SolutionSource::Interpolated);
    Some(Frame {
        status: FrameStatus::Suggested,
        ptz: Some(solved),
        lens,
        solution: Some(Solution {
            source,
            ..Solution::default()
        }),
        ..frame
    })
}

/// The lens between those that two frames state themselves, at a focal length; none where one of
/// them states none.
fn lens_between(before: &Frame, after: &Frame, share: f64, focal_px: f64) -> Option<FrameLens> {
    let (from, to) = (before.lens.as_ref()?, after.lens.as_ref()?);
    let (from_point, to_point) = (from.principal_point, to.principal_point);
    let (from_radial, to_radial) = (from.radial(), to.radial());
    Some(FrameLens::new(
        focal_px,
        ImagePoint::new(
            at_share(from_point.x, to_point.x, share),
            at_share(from_point.y, to_point.y, share),
        ),
        Radial {
            k1: at_share(from_radial.k1, to_radial.k1, share),
            k2: at_share(from_radial.k2, to_radial.k2, share),
            pixel_aspect: at_share(from_radial.pixel_aspect, to_radial.pixel_aspect, share),
        },
    ))
}

/// The value at a share of the way from one to another.
fn at_share(from: f64, to: f64, share: f64) -> f64 {
    from + (to - from) * share
}

/// Exports each take separately: a run of chosen, solved frames with consecutive numbers. Frames
/// without a number form one take.
///
/// # Errors
/// Those of `export`.
pub fn in_takes(
    at: DocumentAt<'_>,
    choice: &FrameChoice,
    export: &dyn Fn(DocumentAt<'_>) -> Result<Exported, ExchangeError>,
) -> Result<Exported, ExchangeError> {
    // Takes by the positions of their frames: a long video may have thousands of takes, each of
    // which must not search all frames.
    let frames = &at.document.frames;
    let mut takes: Vec<Vec<usize>> = Vec::new();
    for run in runs(at.document, choice) {
        takes.extend(
            run.chunk_by(|before, after| is_successor(after, before))
                .map(|take| positions_of(take, frames)),
        );
    }
    let known: BTreeSet<usize> = takes.iter().flatten().copied().collect();
    let rest: Vec<&Frame> = frames
        .iter()
        .enumerate()
        .filter(|(position, _)| !known.contains(position))
        .map(|(_, frame)| &**frame)
        .collect();
    // The rest is a take where it has a camera to write; and where there is no other take, so that
    // the export says why there is nothing.
    let has_numberless = rest
        .iter()
        .any(|frame| frame.ptz.is_some() && is_chosen(frame, choice));
    let is_rest_written = has_numberless || takes.is_empty();
    if is_rest_written {
        takes.push(positions_of(&rest, frames));
    }
    let mut whole: Option<Exported> = None;
    for (index, take) in takes.iter().enumerate() {
        let of_take = take.iter().filter_map(|position| frames.get(*position));
        let document = Document {
            frames: of_take.cloned().collect(),
            ..at.document.clone()
        };
        let exported = export(document.at(at.folder))?;
        let number = index + 1;
        let mut files = Files::default();
        for (name, bytes) in exported.files.sorted_entries() {
            files.add(format!("take{number:03}/{name}"), bytes);
        }
        whole = Some(match whole {
            None => Exported {
                files,
                in_takes: true,
                ..exported
            },
            Some(whole) => append_take(whole, exported, &files),
        });
    }
    // There is at least one take, so that this error does not occur.
    let mut whole =
        whole.ok_or_else(|| super::choose::nothing(crate::exchange::format::Format::Json, &[]))?;
    // No take names the frames between the takes.
    if !is_rest_written {
        let unsolved = rest.iter().filter(|frame| is_chosen(frame, choice));
        whole
            .left_out
            .extend(unsolved.map(|frame| (frame.name(), NOT_SOLVED.to_owned())));
    }
    Ok(whole)
}

/// The positions of some frames of a document, in its order.
fn positions_of(some: &[&Frame], frames: &Frames) -> Vec<usize> {
    let positions = some
        .iter()
        .filter_map(|frame| frames.position_of(&frame.id));
    let mut positions: Vec<usize> = positions.collect();
    positions.sort_unstable();
    positions
}

/// Whether a frame is the next one of the video after another.
fn is_successor(frame: &Frame, before: &Frame) -> bool {
    let numbers = before.video_frame_index().zip(frame.video_frame_index());
    // The largest number has no successor, where a plain sum would overflow.
    numbers.is_some_and(|(before, number)| before.checked_add(1) == Some(number))
}

/// The takes so far, joined with one more.
fn append_take(mut whole: Exported, take: Exported, files: &Files) -> Exported {
    for (name, bytes) in files.sorted_entries() {
        whole.files.add(name, bytes);
    }
    whole.frames += take.frames;
    whole.left_out.extend(take.left_out);
    whole.worst_px = whole.worst_px.max(take.worst_px);
    whole.loss = match (whole.loss, take.loss) {
        (Some(known), Some(loss)) => Some(known.join(loss)),
        (known, loss) => known.or(loss),
    };
    for note in take.notes {
        if !whole.notes.contains(&note) {
            whole.notes.push(note);
        }
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Clip;
    use crate::exchange::export;
    use crate::exchange::tests::{document, text_of};
    use crate::exchange::{ExportOptions, Format, Gaps, Loss};
    use std::path::Path;
    use touchline_core::camera::{BaseAngles, CameraBase, FocalCurve, Ptz};
    use touchline_core::geometry::{ImageSize, Vec3};

    const NOT_FILLED: &str = "not filled: 1 gap with a rejected frame, or one of another camera or \
                              clip or that was not requested";

    /// Frames 412, 413, 416 and 440 of a video, without images.
    fn gappy() -> Document {
        let base = CameraBase::new(
            Vec3::new(0.0, -60.0, 18.0),
            BaseAngles::default().base_from_world(),
            ImageSize::new(1920, 1080).centre(),
        );
        let mut document = document(
            &base,
            &[
                (-2.0, -11.0, 2000.0),
                (-1.0, -11.0, 2000.0),
                (2.0, -10.0, 4000.0),
                (9.0, -10.0, 3000.0),
            ],
        );
        for (frame, number) in document.frames.iter_mut().zip([412, 413, 416, 440]) {
            frame.image = None;
            frame.video = Some(VideoFrame::new(
                "match.mp4",
                number,
                Some(number as f64 / 25.0),
            ));
        }
        document
    }

    #[test]
    fn short_gaps_are_filled_on_request_and_every_filled_frame_says_so() {
        let (filled, note) = interpolate_gaps(&gappy(), &FrameChoice::default(), 5);
        assert_eq!(
            note.as_deref(),
            Some("not filled: 1 gap longer than 5 frames")
        );
        let numbers: Vec<u64> = filled
            .frames
            .iter()
            .filter_map(|frame| frame.video_frame_index())
            .collect();
        assert_eq!(
            numbers,
            [412, 413, 414, 415, 416, 440],
            "the long gap stays"
        );
        let ptz = filled.frames[2].ptz.as_ref().unwrap();
        assert!(
            (ptz.pan_deg - 0.0).abs() < 1e-12 && (ptz.tilt_deg + 32.0 / 3.0).abs() < 1e-12,
            "{ptz:?}"
        );
        assert!(
            (ptz.focal_px - 2000.0 * 2.0_f64.powf(1.0 / 3.0)).abs() < 1e-9,
            "{ptz:?}"
        );
        assert!(
            (filled.frames[2].video.as_ref().unwrap().pts_s.unwrap() - 414.0 / 25.0).abs() < 1e-12
        );
        for (frame, is_filled) in filled
            .frames
            .iter()
            .zip([false, false, true, true, false, false])
        {
            let source = frame.source();
            assert_eq!(source == Some(SolutionSource::Interpolated), is_filled);
        }
        assert_eq!(
            interpolate_gaps(&gappy(), &FrameChoice::default(), 1)
                .0
                .frames,
            gappy().frames
        );
        assert_eq!(
            interpolate_gaps(&gappy(), &FrameChoice::default(), 50).1,
            None
        );
    }

    #[test]
    fn a_gap_with_a_rejected_frame_stays() {
        let mut document = gappy();
        let mut rejected = Frame::from_video(
            VideoFrame::new("match.mp4", 414, None),
            "main".into(),
            ImageSize::new(1920, 1080),
        );
        rejected.status = FrameStatus::Rejected;
        document.frames.push(rejected.into());
        let (filled, note) = interpolate_gaps(&document, &FrameChoice::default(), 50);
        assert_eq!(
            filled
                .frames
                .iter()
                .filter(|frame| frame.ptz.is_some())
                .count(),
            27,
            "the other gap is filled"
        );
        assert_eq!(note.as_deref(), Some(NOT_FILLED));
    }

    #[test]
    fn a_gap_with_a_frame_of_another_camera_or_clip_stays() {
        for (camera, clip) in [("behind_goal", None), ("main", Some(Clip::Number(2)))] {
            let mut document = gappy();
            let other = Frame {
                clip,
                ..Frame::from_video(
                    VideoFrame::new("match.mp4", 414, None),
                    camera.into(),
                    ImageSize::new(1920, 1080),
                )
            };
            document.frames.push(other.clone().into());
            let (filled, note) = interpolate_gaps(&document, &FrameChoice::default(), 5);
            let kept = filled.frames.iter().find(|frame| frame.id == other.id);
            assert!(kept.is_some_and(|frame| **frame == other), "{camera}");
            let solved = filled.frames.iter().filter(|frame| frame.ptz.is_some());
            assert_eq!(solved.count(), 4, "{camera}");
            let expected = NOT_FILLED.replace(": ", ": 1 gap longer than 5 frames, ");
            assert_eq!(note.as_deref(), Some(&*expected));
        }
    }

    #[test]
    fn pan_takes_the_short_way_round() {
        let mut document = gappy();
        document.frames[1].ptz = Some(FramePtz::new(Ptz::from_degrees(179.0, -10.0, 2000.0), None));
        document.frames[2].ptz = Some(FramePtz::new(
            Ptz::from_degrees(-178.0, -10.0, 2000.0),
            None,
        ));
        let (filled, _) = interpolate_gaps(&document, &FrameChoice::default(), 5);
        // 180 and −180 degrees are one direction.
        assert!((filled.frames[2].ptz.as_ref().unwrap().pan_deg.abs() - 180.0).abs() < 1e-9);
        assert!((filled.frames[3].ptz.as_ref().unwrap().pan_deg + 179.0).abs() < 1e-9);
    }

    #[test]
    fn a_filled_frame_has_a_lens_between_those_that_its_neighbours_state() {
        let mut document = gappy();
        for (index, x, k1) in [(1, 950.0, 0.1), (2, 980.0, 0.4)] {
            let focal_px = document.frames[index].ptz.as_ref().unwrap().focal_px;
            let radial = Radial {
                k1,
                k2: 0.0,
                ..Radial::default()
            };
            let lens = FrameLens::new(focal_px, ImagePoint::new(x, 540.0), radial);
            document.frames[index].lens = Some(lens);
        }
        let (filled, _) = interpolate_gaps(&document, &FrameChoice::default(), 5);
        let camera = filled.ptz_camera(&filled.frames[2]).unwrap();
        assert!((camera.base().principal_point.x - 960.0).abs() < 1e-9);
        assert!((camera.lens().k1 - 0.2).abs() < 1e-12);
    }

    #[test]
    fn tracks_are_written_with_their_gaps_filled_or_take_by_take() {
        let document = gappy();
        let with = |gaps| ExportOptions {
            gaps,
            ..ExportOptions::default()
        };
        let export = |gaps| export(document.at(Path::new("/")), Format::Csv, &with(gaps)).unwrap();
        let filled = export(Gaps::Interpolate(2));
        let text = text_of(&filled.files, "cameras.csv");
        let flags: Vec<&str> = text
            .lines()
            .skip(1)
            .map(|line| line.split(',').nth(7).unwrap())
            .collect();
        assert_eq!(flags, ["0", "0", "1", "1", "0", "0"]);
        assert!(
            filled
                .notes
                .contains(&"interpolated: 2 frames, the first 414, the last 415".to_owned()),
            "{:?}",
            filled.notes
        );
        let takes = export(Gaps::Takes);
        let names: Vec<(&str, usize)> = takes
            .files
            .sorted_entries()
            .into_iter()
            .map(|(name, bytes)| {
                (
                    name,
                    std::str::from_utf8(bytes).unwrap().lines().count() - 1,
                )
            })
            .collect();
        assert_eq!(
            names,
            [
                ("take001/cameras.csv", 2),
                ("take002/cameras.csv", 1),
                ("take003/cameras.csv", 1)
            ]
        );
        assert!(takes.is_folder() && takes.frames == 4);
        assert_eq!(export(Gaps::Keep).frames, 4);
    }

    #[test]
    fn frames_without_a_camera_are_named_in_takes_as_in_one_file() {
        let mut document = gappy();
        document.frames[2].ptz = None;
        let left_out = [Gaps::Keep, Gaps::Takes].map(|gaps| {
            let options = ExportOptions {
                gaps,
                ..ExportOptions::default()
            };
            let at = document.at(Path::new("/"));
            export(at, Format::Csv, &options).unwrap().left_out
        });
        let named = [(document.frames[2].name(), NOT_SOLVED.to_owned())];
        assert_eq!(left_out, [named.clone(), named]);
    }

    #[test]
    fn the_loss_of_takes_is_that_of_all_of_them() {
        let mut document = gappy();
        let camera: &mut Camera = &mut document.cameras[0];
        let base = CameraBase {
            distortion: FocalCurve::constant(0.0661),
            ..camera.base().unwrap()
        };
        camera.set_base(&base);
        let loss = |gaps| {
            let options = ExportOptions {
                gaps,
                ..ExportOptions::default()
            };
            let at = document.at(Path::new("/"));
            export(at, Format::Usda, &options).unwrap().loss.unwrap()
        };
        let [whole, takes] = [Gaps::Keep, Gaps::Takes].map(loss);
        assert_eq!(
            (takes.frames, &takes.what[..]),
            (4, &["lens distortion"][..])
        );
        assert!((takes.rms_px - whole.rms_px).abs() < 1e-9 * whole.rms_px);
        assert_eq!(
            Loss {
                rms_px: whole.rms_px,
                ..takes
            },
            whole
        );
    }
}
