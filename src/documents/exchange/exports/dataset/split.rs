//! Splits a dataset into training, validation and test parts by whole clips, cameras or matches,
//! with a seed.

use super::options::{SplitBy, Splitting};
use crate::document::Frame;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// A part of a dataset.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, strum::Display, strum::IntoStaticStr,
)]
#[strum(serialize_all = "lowercase")]
pub enum Split {
    /// For training.
    Train,
    /// For choosing hyperparameters and models.
    Validation,
    /// For the final evaluation.
    Test,
}

impl Split {
    /// Every part, in order.
    pub const ALL: [Self; 3] = [Self::Train, Self::Validation, Self::Test];
}

/// The match of a frame, as far as the document shows it: its video, else the folder of its image.
pub fn match_of(frame: &Frame) -> String {
    if let Some(video) = &frame.video {
        return video.path.clone();
    }
    let image = frame
        .image
        .as_deref()
        .unwrap_or_default()
        .replace('\\', "/");
    let folder = image.rsplit_once('/').map_or("", |(folder, _)| folder);
    // `./a` and `a` are one folder.
    let parts: Vec<&str> = folder.split('/').filter(|part| *part != ".").collect();
    parts.join("/")
}

/// The key of a frame's group; groups are never divided.
fn group_of(frame: &Frame, by: SplitBy) -> Vec<String> {
    let camera = frame.camera.as_str().to_owned();
    match by {
        SplitBy::Match => vec![match_of(frame)],
        SplitBy::Camera => vec![camera],
        SplitBy::Clip => {
            vec![
                match_of(frame),
                camera,
                frame
                    .clip
                    .as_ref()
                    .map(ToString::to_string)
                    .unwrap_or_default(),
            ]
        }
    }
}

/// The split of each frame. Groups are shuffled by the seed. Each split with a share first gets one
/// group, then each further group goes to the split that lacks most frames.
pub fn split(frames: &[&Frame], splitting: Splitting) -> Vec<Split> {
    let mut groups: BTreeMap<Vec<String>, Vec<usize>> = BTreeMap::new();
    for (index, frame) in frames.iter().enumerate() {
        groups
            .entry(group_of(frame, splitting.by))
            .or_default()
            .push(index);
    }
    let mut shuffled: Vec<([u8; 32], Vec<usize>)> = groups
        .into_iter()
        .map(|(group, frames)| (key(splitting.seed, &group), frames))
        .collect();
    shuffled.sort();
    // Shares of 0 : 0 : 0 give everything to the first split.
    let all: f64 = splitting.shares.iter().map(|share| f64::from(*share)).sum();
    let wanted = splitting
        .shares
        .map(|share| f64::from(share) / all.max(1.0) * frames.len() as f64);
    let mut assigned = [0.0; 3];
    let mut of_frame = vec![Split::Train; frames.len()];
    // The split that lacks most frames comes nearest to its share with whole groups.
    for (_, members) in shuffled {
        let to = next_split(splitting.shares, wanted, assigned);
        assigned[to] += members.len() as f64;
        for member in members {
            of_frame[member] = Split::ALL[to];
        }
    }
    of_frame
}

/// The split of the next group: the first of those with a share that has no frame yet, else the one
/// that lacks most frames.
fn next_split(shares: [u32; 3], wanted: [f64; 3], assigned: [f64; 3]) -> usize {
    let with_share = (0..Split::ALL.len()).filter(|split| shares[*split] > 0);
    // With few groups the largest share would take all of them; a split with a share gets one
    // first, so that a test set exists.
    let empty = with_share.clone().find(|split| assigned[*split] == 0.0);
    let missing = [0, 1, 2].map(|split: usize| wanted[split] - assigned[split]);
    empty
        .or_else(|| with_share.max_by(|a, b| missing[*a].total_cmp(&missing[*b])))
        .unwrap_or(0)
}

/// The sort key of a group in the shuffled order: a hash of seed and group, so that added groups do
/// not reorder the others.
fn key(seed: u64, group: &[String]) -> [u8; 32] {
    // The length before each part keeps ("ab", "c") and ("a", "bc") apart.
    let mut digest = Sha256::new();
    digest.update(seed.to_le_bytes());
    for part in group {
        digest.update((part.len() as u64).to_le_bytes());
        digest.update(part.as_bytes());
    }
    digest.finalize().into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Clip;
    use touchline_core::geometry::ImageSize;

    fn frames(clips: i64, of_each: i64) -> Vec<Frame> {
        let frame = |clip: i64, index: i64| {
            let image = format!("images/{clip}_{index}.jpg");
            Frame {
                clip: Some(Clip::Number(clip)),
                ..Frame::from_image(&image, "main".into(), ImageSize::new(64, 36))
            }
        };
        (0..clips)
            .flat_map(|clip| (0..of_each).map(move |index| frame(clip, index)))
            .collect()
    }

    fn counts(frames: &[Frame], splitting: Splitting) -> [usize; 3] {
        let splits = split(&frames.iter().collect::<Vec<_>>(), splitting);
        Split::ALL.map(|wanted| splits.iter().filter(|split| **split == wanted).count())
    }

    #[test]
    fn a_clip_is_never_divided_and_shares_are_met_as_far_as_clips_allow() {
        let frames = frames(40, 10);
        let splits = split(&frames.iter().collect::<Vec<_>>(), Splitting::default());
        for clip in splits.chunks(10) {
            assert!(clip.iter().all(|split| *split == clip[0]));
        }
        assert_eq!(counts(&frames, Splitting::default()), [320, 40, 40]);
        assert_eq!(
            counts(
                &frames,
                Splitting {
                    shares: [1, 0, 1],
                    ..Splitting::default()
                }
            ),
            [200, 0, 200]
        );
        let by_match = Splitting {
            by: SplitBy::Match,
            ..Splitting::default()
        };
        assert_eq!(
            counts(&frames, by_match),
            [400, 0, 0],
            "all images are of one folder"
        );
    }

    #[test]
    fn few_clips_still_leave_something_for_the_test() {
        assert_eq!(counts(&frames(3, 5), Splitting::default()), [5, 5, 5]);
        assert_eq!(counts(&frames(1, 5), Splitting::default()), [5, 0, 0]);
    }

    #[test]
    fn another_seed_divides_otherwise_and_the_same_seed_the_same() {
        let frames = frames(20, 2);
        let of = |seed| {
            split(
                &frames.iter().collect::<Vec<_>>(),
                Splitting {
                    seed,
                    ..Splitting::default()
                },
            )
        };
        assert_eq!(of(7), of(7));
        assert_ne!(of(7), of(8));
    }
}
