//! The quality of a forest by cross-validation: references are left out together with all others of
//! their shot, and the forest that is trained on the rest is queried for them.
//!
//! Labels are taken as they were clicked. Labels that were adjusted to each other, as for the final
//! forest, would pass information from the references left out to those that are kept.
//!
//! Memory is bounded for any number of references: at most 1000 of them take part, spread evenly.
//! For each only its training samples are kept, shared by all forests, 152 bytes per feature. With
//! 1000 features each that is 150 MB, in addition to one forest at a time and the features of a few
//! pictures.

use super::spread::spread;
use crate::proposals::{FramePictures, LearnOptions, ReferenceSamples, study};
use std::collections::BTreeSet;
use touchline_core::camera::{Ptz, PtzCamera, image_space_distances_px};
use touchline_core::geometry::{ImagePoint, ImageSize, Mat3, median, subsample};
use touchline_core::progress::{Progress, Share};
use touchline_core::solve::RIGHT_PX;
use touchline_documents::document::{Camera, Clip, Document, Frame, FrameId};
use touchline_vision::media::ReadFrames;
use touchline_vision::relocalize::{
    CERTAIN, CertainAnswerCounts, ForestModel, RelocalizeOptions, Samples, SeenRange, Stopped,
    train_without,
};

/// If there is only one shot, references closer in time than this are left out together, s.
const TOGETHER_S: f64 = 5.0;

/// Number of forests that are trained; the groups left out are spread evenly over all groups.
const MOST_GROUPS: usize = 8;

/// Number of references of a left-out shot that are queried.
const MOST_OF_A_SHOT: usize = 4;

/// Number of references that take part, spread evenly over all.
const MOST_REFERENCES: usize = 1000;

/// Number of references with features in memory while samples are collected.
const BATCH: usize = 32;

/// An overlay with a larger error is wrong, px at 1920 px width.
pub const WRONG_PX: f64 = 20.0;

/// The answers of the forest for references that were left out of its training.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// What is left out together.
    pub left_out_by: LeftOutBy,
    /// Number of groups that could be left out; at most eight of them were.
    pub groups: usize,
    /// The references that were queried, in the document's order.
    pub tested: Vec<LeftOut>,
}

/// What is left out together with a reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeftOutBy {
    /// All references of its shot.
    Shot,
    /// All within five seconds.
    Time,
    /// Its neighbours among the references, as no times are known.
    Neighbours,
}

/// A reference that was left out of the training and queried.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// Id of the frame.
    pub frame: FrameId,
    /// Pan of its label, degrees.
    pub pan_deg: f64,
    /// Tilt of its label, degrees.
    pub tilt_deg: f64,
    /// The forest's answer, if it found one.
    pub found: Option<FoundAgain>,
}

/// The forest's answer for a reference left out of its training.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundAgain {
    /// Largest distance of the overlay from the label's over the picture, px at 1920 px width
    /// ([`overlay_error_px`]).
    pub error_px: f64,
    /// The confidence that the forest stated.
    pub confidence: f64,
}

impl Quality {
    /// Number of references for which the forest found an answer.
    pub fn found_count(&self) -> usize {
        self.tested
            .iter()
            .filter(|tested| tested.found.is_some())
            .count()
    }

    /// The median error of the answers, px at 1920 px width; none without answers.
    pub fn median_px(&self) -> Option<f64> {
        median(
            &mut self
                .tested
                .iter()
                .filter_map(|tested| Some(tested.found?.error_px))
                .collect::<Vec<_>>(),
        )
    }

    /// The number of confident answers and of right ones among them, from which the upper bound of
    /// stated confidences follows.
    pub fn confident_answers(&self) -> CertainAnswerCounts {
        let certain = self
            .tested
            .iter()
            .filter_map(|tested| tested.found)
            .filter(|found| found.confidence >= CERTAIN);
        let right = certain.clone().filter(|found| found.error_px <= RIGHT_PX);
        CertainAnswerCounts {
            certain: certain.count() as u32,
            right: right.count() as u32,
        }
    }

    /// Bounds the confidences of a forest by what was measured on its own references.
    pub fn bound(&self, document: &Document, model: &mut ForestModel) {
        // All tested references are of one camera. Nothing was measured of the others, and their
        // confidences stay.
        let measured = self
            .tested
            .first()
            .and_then(|tested| document.frames.by_id(&tested.frame));
        for camera in &mut model.cameras {
            if measured.is_some_and(|frame| frame.camera.as_str() == camera.camera) {
                camera.seen.shown = self.confident_answers();
            }
        }
    }

    /// The references with wrong answers.
    pub fn wrong(&self) -> impl Iterator<Item = &LeftOut> {
        self.tested
            .iter()
            .filter(|tested| tested.found.is_some_and(|found| found.error_px > WRONG_PX))
    }
}

/// A group of references, as indices into [`Collected`]: those left out of the training, and those
/// of them that are queried.
struct Group {
    left_out: BTreeSet<usize>,
    tested: Vec<usize>,
}

/// The training samples of one camera, collected.
#[derive(Default)]
struct Collected {
    samples: Samples,
    /// Indices of the frames in the document.
    frames: Vec<usize>,
    /// Their cameras, and the covariances of these.
    cameras: Vec<(Ptz, Mat3)>,
}

/// Leaves groups of references out in turn and queries the forest for them. None if `progress`
/// cancelled it, or if no group leaves anything to train on. Progress counts groups; while features
/// are extracted it stays at zero.
pub fn measure(
    pictures: &FramePictures<'_>,
    reader: &mut dyn ReadFrames,
    training_frames: &[usize],
    options: &LearnOptions,
    relocalizing: &RelocalizeOptions,
    progress: &Progress<'_, Share>,
) -> Option<Quality> {
    // Only the camera with the most references is measured.
    let document = pictures.document;
    let camera = most_used(document, training_frames)?;
    let base = camera.base()?;
    let of_camera: Vec<usize> = training_frames
        .iter()
        .copied()
        .filter(|&index| document.frames[index].camera == camera.id)
        .collect();
    // Features are not stored by the collection; those of the queried references are extracted
    // again, or come from the store.
    let collected = Collected::from(
        pictures,
        reader,
        &spread(of_camera, MOST_REFERENCES),
        &progress.part(|()| Share::default()),
    )?;
    // A group that contains all references leaves nothing to train on.
    let (left_out_by, mut groups) = groups(document, &collected.frames);
    groups.retain(|group| group.left_out.len() < collected.frames.len());
    let count = groups.len();
    let groups = spread(groups, MOST_GROUPS);
    let mut tested = Vec::new();
    for (done, group) in groups.iter().enumerate() {
        let so_far = Share::new(done, groups.len());
        progress.report(so_far).continue_value()?;
        // Train without the group. A group that leaves no samples is skipped.
        let forest = match train_without(
            &collected.samples,
            &group.left_out,
            &options.train,
            &progress.part(|_| so_far),
        ) {
            Ok(forest) => forest,
            Err(Stopped::NoSamples { .. } | Stopped::TooMany { .. }) => continue,
            Err(Stopped::Cancelled) => return None,
        };
        let Some(seen) = collected.range_without(&group.left_out) else {
            continue;
        };
        // Query the forest for the group and compare with the labels.
        let frames: Vec<usize> = group
            .tested
            .iter()
            .map(|&place| collected.frames[place])
            .collect();
        let ReferenceSamples {
            training_samples, ..
        } = study(pictures, reader, &frames, &progress.part(|()| so_far))?;
        for sample in training_samples {
            let frame = &document.frames[sample.frame];
            let Some(truth) = camera.ptz_camera(frame) else {
                continue;
            };
            let answer = sample.relocalize(&forest, &seen, &base, relocalizing);
            let found = answer.pose.ok().map(|pose| FoundAgain {
                error_px: overlay_error_px(
                    &truth,
                    &PtzCamera::new(base, pose.ptz),
                    frame.image_size,
                ),
                confidence: pose.confidence,
            });
            let (pan_deg, tilt_deg) = (sample.ptz.pan.degrees(), sample.ptz.tilt.degrees());
            tested.push((
                sample.frame,
                LeftOut {
                    frame: frame.id.clone(),
                    pan_deg,
                    tilt_deg,
                    found,
                },
            ));
        }
    }
    // Groups were queried one after the other; return the document's order.
    tested.sort_by_key(|(index, _)| *index);
    let tested: Vec<LeftOut> = tested.into_iter().map(|(_, tested)| tested).collect();
    (!tested.is_empty()).then_some(Quality {
        left_out_by,
        groups: count,
        tested,
    })
}

impl Collected {
    /// Collects the training samples of some frames, in their order, a batch at a time; frames
    /// without rays are left out. None if `progress` cancelled it.
    fn from(
        pictures: &FramePictures<'_>,
        reader: &mut dyn ReadFrames,
        training_frames: &[usize],
        progress: &Progress<'_, ()>,
    ) -> Option<Self> {
        let mut collected = Self::default();
        // The features of a batch are dropped as soon as its samples are copied, which bounds the
        // memory.
        for few in training_frames.chunks(BATCH) {
            let ReferenceSamples {
                training_samples, ..
            } = study(pictures, reader, few, progress)?;
            for sample in training_samples
                .iter()
                .filter(|sample| !sample.fine.rays.is_empty())
            {
                sample.add_to(&mut collected.samples);
                collected.frames.push(sample.frame);
                collected
                    .cameras
                    .push((sample.ptz, sample.label.covariance));
            }
        }
        Some(collected)
    }

    /// The range of cameras of the references that are kept; none without any.
    fn range_without(&self, left_out: &BTreeSet<usize>) -> Option<SeenRange> {
        let kept = self
            .cameras
            .iter()
            .enumerate()
            .filter(|(place, _)| !left_out.contains(place));
        let (cameras, labels): (Vec<Ptz>, Vec<Mat3>) = kept.map(|(_, known)| *known).unzip();
        Some(SeenRange::from_cameras(&cameras)?.with_labels(labels))
    }
}

/// The camera with the most references; the first of equals.
fn most_used<'a>(document: &'a Document, training_frames: &[usize]) -> Option<&'a Camera> {
    let cameras = document.cameras.iter().map(|camera| &**camera);
    cameras.rev().max_by_key(|camera| {
        training_frames
            .iter()
            .filter(|&&index| document.frames[index].camera == camera.id)
            .count()
    })
}

/// The groups to leave out: the shots, if there are several. Otherwise each reference with those
/// near it in time, or, if any time is unknown, with its two neighbours. Frames near in time show
/// nearly the same picture, so a forest that knows one finds the other too easily.
fn groups(document: &Document, collected: &[usize]) -> (LeftOutBy, Vec<Group>) {
    let frames: Vec<&Frame> = collected
        .iter()
        .map(|&index| &*document.frames[index])
        .collect();
    // By shot, if there are several; frames without a shot form one.
    let clips: BTreeSet<Option<&Clip>> = frames.iter().map(|frame| frame.clip.as_ref()).collect();
    if clips.len() > 1 {
        let groups = clips.into_iter().map(|clip| group_of_clip(&frames, clip));
        return (LeftOutBy::Shot, groups.collect());
    }
    // Otherwise by time, if all frames have one, or by order.
    let times_s: Option<Vec<f64>> = frames
        .iter()
        .map(|frame| frame.video.as_ref()?.pts_s)
        .collect();
    let by = if times_s.is_some() {
        LeftOutBy::Time
    } else {
        LeftOutBy::Neighbours
    };
    // Quadratic in the references, of which there are at most a thousand.
    let groups = (0..frames.len()).map(|tested| {
        let others = 0..frames.len();
        let left_out = match &times_s {
            Some(times_s) => others
                .filter(|&other| (times_s[tested] - times_s[other]).abs() <= TOGETHER_S)
                .collect(),
            None => others
                .filter(|&other| tested.abs_diff(other) <= 1)
                .collect(),
        };
        Group {
            tested: vec![tested],
            left_out,
        }
    });
    (by, groups.collect())
}

/// The group that leaves out a shot, and tests a sample of its references.
fn group_of_clip(frames: &[&Frame], clip: Option<&Clip>) -> Group {
    let left_out: BTreeSet<usize> = (0..frames.len())
        .filter(|&index| frames[index].clip.as_ref() == clip)
        .collect();
    Group {
        tested: subsample(&left_out, MOST_OF_A_SHOT).copied().collect(),
        left_out,
    }
}

/// The largest distance between the overlays of two cameras over a grid of 5 × 3 points of the
/// picture, px at 1920 px width; infinite if the second camera does not see a point of the first.
pub fn overlay_error_px(truth: &PtzCamera, found: &PtzCamera, size: ImageSize) -> f64 {
    let (width, height) = (f64::from(size.width), f64::from(size.height));
    // Both edges included, because overlays are farthest apart at the corners.
    let grid = (0..15).map(|index| (f64::from(index % 5) / 4.0, f64::from(index / 5) / 2.0));
    let points = grid.map(|(x, y)| ImagePoint::new(x * width, y * height));
    image_space_distances_px(truth, found, points).fold(0.0, f64::max) / size.scale_from_1920()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::testing::{TestBase, base_at};
    use touchline_documents::document::VideoFrame;
    use touchline_documents::testing::{WithFrames, a_match};

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    fn document(frames: usize) -> Document {
        a_match(SIZE).with_numbered(frames, SIZE)
    }

    fn left_out(document: &Document) -> (LeftOutBy, Vec<Vec<usize>>) {
        let collected: Vec<usize> = (0..document.frames.len()).collect();
        let (by, groups) = groups(document, &collected);
        (
            by,
            groups
                .into_iter()
                .map(|group| group.left_out.into_iter().collect())
                .collect(),
        )
    }

    #[test]
    fn whole_shots_are_left_out_else_five_seconds_else_neighbours() {
        let mut document = document(4);
        assert_eq!(
            left_out(&document),
            (
                LeftOutBy::Neighbours,
                vec![vec![0, 1], vec![0, 1, 2], vec![1, 2, 3], vec![2, 3]]
            )
        );
        for (index, pts_s) in [0.0, 4.0, 8.0, 30.0].into_iter().enumerate() {
            document.frames[index].video =
                Some(VideoFrame::new("a.mp4", index as u64, Some(pts_s)));
        }
        assert_eq!(
            left_out(&document),
            (
                LeftOutBy::Time,
                vec![vec![0, 1], vec![0, 1, 2], vec![1, 2], vec![3]]
            )
        );
        for (index, clip) in [1, 2, 2, 1].into_iter().enumerate() {
            document.frames[index].clip = Some(Clip::Number(clip));
        }
        assert_eq!(
            left_out(&document),
            (LeftOutBy::Shot, vec![vec![0, 3], vec![1, 2]])
        );
    }

    #[test]
    fn many_groups_are_subsampled_from_the_first_to_the_last() {
        let kept = spread((0..100).collect::<Vec<usize>>(), MOST_GROUPS);
        assert_eq!((kept.len(), kept[0], kept[7]), (MOST_GROUPS, 0, 99));
        assert_eq!(spread(vec![4, 5], 2), [4, 5]);
    }

    #[test]
    fn the_error_of_an_overlay_is_that_of_its_worst_place() {
        let camera =
            |pan_deg, focal_px| base_at([0.0, -60.0, 18.0], SIZE).aim(pan_deg, -10.0, focal_px);
        let truth = camera(5.0, 1280.0);
        assert!(overlay_error_px(&truth, &truth, SIZE) < 1e-6);
        // One per cent of focal length moves the corners by one per cent of their distance from the
        // middle.
        let zoomed = overlay_error_px(&truth, &camera(5.0, 1292.8), SIZE);
        assert!((zoomed - 1.5 * 7.34).abs() < 0.05, "{zoomed}");
        assert_eq!(
            overlay_error_px(&truth, &camera(175.0, 1280.0), SIZE),
            f64::INFINITY
        );
    }
}
