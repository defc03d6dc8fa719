//! The agreement of two annotators: comparison of two documents of the same frames.
//!
//! Neither document is the truth. Clicks on the same landmarks, the names given to the same points,
//! and the cameras are compared. Clicks on lines are not, because they may lie anywhere on their
//! line. All distances are px at 1920 px width, so that pictures of all sizes count alike. Offsets
//! point from the first document to the second.

mod frame;

pub use frame::{CameraAgreement, ClickPair, FrameAgreement, NameDispute};

use super::matching::match_frames;
use frame::{ComparedFrame, frame_agreement};
use std::collections::BTreeMap;
use touchline_core::field::{FieldError, LandmarkId};
use touchline_core::geometry::Vec2;
use touchline_core::geometry::quantile;
use touchline_core::score::{ClickScatter, Summary};
use touchline_documents::document::{DocumentAt, Fields, Frame, FrameStatus};

/// The agreement of two annotators.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// The frames that both have labelled, in the first's order.
    pub frames: Vec<FrameAgreement>,
    /// The frames that only one of them has labelled.
    pub lone: Vec<LoneFrame>,
    /// By landmark, in descending order of the median distance.
    pub landmarks: Vec<LandmarkAgreement>,
    /// Distances of the clicks on the same landmarks, px; none without any.
    pub distances: Option<Summary>,
    /// The click noise of one annotator, px, if both have the same; none if there are too few
    /// clicks. A landmark that the two understand differently counts as noise.
    pub noise: Option<ClickScatter>,
    /// The same along x (to the right) and along y (down).
    pub noise_by_axis: [Option<ClickScatter>; 2],
    /// Number of clicks with equal positions to the last digit: one document copied them from the
    /// other. They take no part in distances and noise.
    pub copies: usize,
}

/// A frame that only one of the two has labelled.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoneFrame {
    /// Name of the frame in messages.
    pub name: String,
    /// Its indices in the first and in the second document; none where it is missing.
    pub frames: [Option<usize>; 2],
    /// Whether it is labelled in the first document, else in the second.
    pub by_first: bool,
    /// Whether the other annotator marked it as not calibratable.
    pub rejected: bool,
}

/// The agreement on one landmark.
#[derive(Clone, Debug, PartialEq)]
pub struct LandmarkAgreement {
    /// Id of the landmark.
    pub landmark: LandmarkId,
    /// Number of frames.
    pub pairs: usize,
    /// The median distance, px.
    pub median_px: f64,
    /// 90th percentile of the distance, px.
    pub p90_px: f64,
    /// Median offset from the first to the second, px. It is large if the annotators understand the
    /// landmark differently.
    pub offset_px: Vec2,
    /// Click noise of one annotator, px; none if there are too few frames.
    pub noise: Option<ClickScatter>,
}

impl Agreement {
    /// Click noise of one annotator, as a sentence.
    pub fn describe_noise(&self) -> String {
        let copies = match self.copies {
            0 => String::new(),
            1 => " 1 click is a copy and is not counted.".to_owned(),
            copies => format!(" {copies} clicks are copies and are not counted."),
        };
        let Some(noise) = &self.noise else {
            return format!(
                "Too few clicks on the same landmarks to estimate the click noise.{copies}"
            );
        };
        let [low, high] = noise.interval_95;
        let aside = match noise.set_aside {
            0 => String::new(),
            1 => " 1 pair lies too far apart to be noise and is left out.".to_owned(),
            pairs => format!(" {pairs} pairs lie too far apart to be noise and are left out."),
        };
        format!(
            "Click noise of one annotator: {:.2} px in each direction (95 %: {low:.2} to {high:.2}; {} pairs), if both \
             click equally well.{aside}{copies}",
            noise.sigma, noise.pairs
        )
    }

    /// Whether there is anything to compare apart from copies.
    pub fn says_something(&self) -> bool {
        self.distances.is_some() || self.frames.iter().any(|frame| !frame.names.is_empty())
    }
}

/// Compares two documents. Frames are matched by the location of their pictures, by SHA-256, or by
/// name.
///
/// # Errors
/// A field of the first document is not valid.
pub fn agreement(first: DocumentAt<'_>, second: DocumentAt<'_>) -> Result<Agreement, FieldError> {
    let fields = Fields::from_document(first)?;
    let partners = match_frames(first, second);
    let mut frames = Vec::new();
    let mut lone = Vec::new();
    let mut met = vec![false; second.frames.len()];
    for (index, (one, partner)) in first.frames.iter().zip(&partners).enumerate() {
        let other = partner.map(|partner| &*second.frames[partner]);
        // A matched frame is settled here even if neither has labelled it.
        if let Some(partner) = partner {
            met[*partner] = true;
        }
        // Both labelled: compare. One only: list it.
        let labelled = (is_labelled(one), other.is_some_and(is_labelled));
        match (labelled, partner, other) {
            ((true, true), Some(partner), Some(other)) => {
                let field = fields.for_frame(&first, one);
                let seen = ComparedFrame {
                    document: &first,
                    frame: one,
                    index,
                };
                let seen_by_other = ComparedFrame {
                    document: &second,
                    frame: other,
                    index: *partner,
                };
                frames.push(frame_agreement(&seen, &seen_by_other, field));
            }
            ((true, false), ..) => lone.push(lone_frame(one, other, [Some(index), *partner], true)),
            ((false, true), ..) => {
                lone.extend(
                    other.map(|other| lone_frame(other, Some(one), [Some(index), *partner], false)),
                );
            }
            _ => {}
        }
    }
    // Frames of the second document without a partner.
    for (index, other) in second
        .frames
        .iter()
        .enumerate()
        .filter(|(index, other)| !met[*index] && is_labelled(other))
    {
        lone.push(lone_frame(other, None, [None, Some(index)], false));
    }
    Ok(summarise(frames, lone))
}

/// Whether an annotator has labelled anything in the frame.
fn is_labelled(frame: &Frame) -> bool {
    let named = frame.clicks.iter().any(|click| click.target.is_some());
    match frame.status {
        FrameStatus::Rejected => false,
        FrameStatus::Reference => named || frame.ptz.is_some(),
        FrameStatus::New | FrameStatus::Draft | FrameStatus::Suggested => named,
    }
}

/// The entry of a frame that only one annotator has labelled.
fn lone_frame(
    frame: &Frame,
    other: Option<&Frame>,
    frames: [Option<usize>; 2],
    by_first: bool,
) -> LoneFrame {
    let rejected = other.is_some_and(|other| other.status == FrameStatus::Rejected);
    LoneFrame {
        name: frame.name(),
        frames,
        by_first,
        rejected,
    }
}

/// Computes the statistics of all frames and of each landmark. Copied clicks are left out, because
/// they are not independent measurements.
fn summarise(frames: Vec<FrameAgreement>, lone: Vec<LoneFrame>) -> Agreement {
    // Two people never click the same fraction of a pixel: such a pair was copied with the
    // document, and would make the annotators seem to agree.
    let (copies, own): (Vec<&ClickPair>, Vec<&ClickPair>) = frames
        .iter()
        .flat_map(|frame| &frame.clicks)
        .partition(|pair| pair.is_copy());
    let copies = copies.len();
    let differences: Vec<Vec2> = own.iter().map(|pair| pair.difference()).collect();
    let distances: Vec<f64> = own.iter().map(|pair| pair.apart_px()).collect();
    let mut by_landmark: BTreeMap<&LandmarkId, Vec<&ClickPair>> = BTreeMap::new();
    for pair in own {
        by_landmark.entry(&pair.landmark).or_default().push(pair);
    }
    let mut landmarks: Vec<LandmarkAgreement> = by_landmark
        .into_iter()
        .map(|(landmark, pairs)| landmark_agreement(landmark, &pairs))
        .collect();
    // A stable sort: equal medians stay in the order of the names, so that the table is the same
    // each time.
    landmarks.sort_by(|a, b| b.median_px.total_cmp(&a.median_px));
    Agreement {
        landmarks,
        // The bootstrap has a fixed seed: the same documents give the same report.
        distances: Summary::from_values(&distances, 0),
        noise: ClickScatter::from_differences(&differences),
        noise_by_axis: [0, 1]
            .map(|axis| ClickScatter::along(differences.iter().map(|difference| difference[axis]))),
        copies,
        frames,
        lone,
    }
}

/// The statistics of one landmark.
fn landmark_agreement(landmark: &LandmarkId, pairs: &[&ClickPair]) -> LandmarkAgreement {
    let distances = sorted_values(pairs, ClickPair::apart_px);
    let differences: Vec<Vec2> = pairs.iter().map(|pair| pair.difference()).collect();
    LandmarkAgreement {
        landmark: landmark.clone(),
        pairs: pairs.len(),
        median_px: quantile(&distances, 0.5),
        p90_px: quantile(&distances, 0.9),
        offset_px: Vec2::new(
            quantile(&sorted_values(pairs, |pair| pair.offset_px.x), 0.5),
            quantile(&sorted_values(pairs, |pair| pair.offset_px.y), 0.5),
        ),
        noise: ClickScatter::from_differences(&differences),
    }
}

/// A value of each pair, in ascending order.
fn sorted_values(pairs: &[&ClickPair], value: impl Fn(&ClickPair) -> f64) -> Vec<f64> {
    let mut values: Vec<f64> = pairs.iter().map(|pair| value(pair)).collect();
    values.sort_by(f64::total_cmp);
    values
}
