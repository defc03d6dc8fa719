//! The frames that the paper's authors published, if a user has them.

use super::documents::{Gathered, OwnDocument};
use super::{FrameSet, SetKind, Split};
use crate::ExperimentError;
use crate::given::folder_with;
use crate::progress::{Progress, step_counter};
use crate::setting::FIELD_YD;
use std::ops::Range;
use std::path::{Path, PathBuf};
use touchline::exchange::read_authors_folder;

/// The two published sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PublishedKind {
    /// Sequences of one match. Each is tested with the others as references.
    Highlights,
    /// Games. Every other frame of a game is used for training, the others for testing.
    WorldCup,
}

impl PublishedKind {
    /// A part of the folder's name.
    const fn in_name(self) -> &'static str {
        match self {
            Self::Highlights => "highlight",
            Self::WorldCup => "world",
        }
    }

    /// The other set.
    const fn other(self) -> Self {
        match self {
            Self::Highlights => Self::WorldCup,
            Self::WorldCup => Self::Highlights,
        }
    }

    /// Length and width of the field, yards, if the data contains no model of it: those that the
    /// authors state.
    const fn field_yd(self) -> [f64; 2] {
        match self {
            Self::Highlights => FIELD_YD,
            Self::WorldCup => [115.0, 74.0],
        }
    }
}

/// The folder of a set: the given one, unless its name is that of the other set, or a subfolder
/// with the set's name.
pub fn published_folder(data: &Path, kind: PublishedKind) -> Option<PathBuf> {
    let name = |folder: &Path| {
        folder
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .to_lowercase()
    };
    let holds_annotations = |folder: &Path| {
        let mut entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.any(|entry| {
            entry
                .file_name()
                .to_string_lossy()
                .to_lowercase()
                .ends_with("_anno.mat")
        })
    };
    folder_with(data, |folder| {
        // A folder that the user names may be called anything but the other set. Below it only a
        // folder of the set's own name counts.
        let named = if folder == data {
            !name(folder).contains(kind.other().in_name())
        } else {
            name(folder).contains(kind.in_name())
        };
        named && holds_annotations(folder)
    })
}

/// Reads the published frames and extracts their features.
///
/// # Errors
/// An annotation or a picture cannot be read, or no frame can be tested against another.
pub fn read_published(
    folder: &Path,
    kind: PublishedKind,
    progress: Progress,
) -> Result<FrameSet, ExperimentError> {
    let read = read_authors_folder(folder, kind.field_yd())?;
    // The authors' files become a document, so that features are found by the code for own frames.
    let own = OwnDocument {
        name: String::new(),
        document: read.document,
        folder: folder.to_path_buf(),
    };
    let mut gathered = Gathered::default();
    let range = gathered.add(&own, &step_counter(own.document.frames.len(), progress))?;
    let (splits, whole) = splits(&gathered, &range, kind);
    // Without a test frame every mean of the report would be the mean of nothing.
    if splits.is_empty() {
        return Err(ExperimentError::NothingToTest {
            folder: folder.to_path_buf(),
        });
    }
    let [length, width] = read.field_yd;
    let source = if read.field_model.is_some() {
        "its own model"
    } else {
        "no model found, the size that the paper states"
    };
    let protocol = match (kind, whole) {
        (PublishedKind::Highlights, true) => {
            "Each sequence is tested against the frames of all others."
        }
        (PublishedKind::Highlights, false) => {
            "Each sequence is tested against the frames of all others from its camera; where there is none, every other frame is \
             used for training, the rest for testing."
        }
        (PublishedKind::WorldCup, _) => {
            "Every other frame of a game is used for training, the rest for testing."
        }
    };
    Ok(FrameSet {
        kind: SetKind::Published,
        seed: 0,
        title: format!(
            "the authors' published data, {} frames in {} sequences; field {length} × {width} yards ({source}); frames and full \
             cameras agree within {:.4}°",
            gathered.frames.len(),
            splits.len(),
            read.worst_turn.degrees(),
        ),
        protocol: protocol.to_owned(),
        frames: gathered.frames,
        splits,
    })
}

/// The splits, and whether every sequence has others of its camera as references.
fn splits(gathered: &Gathered, range: &Range<usize>, kind: PublishedKind) -> (Vec<Split>, bool) {
    let mut splits = Vec::new();
    let mut whole = true;
    for camera in gathered.cameras(range.clone()) {
        let clips = gathered.clips(range.clone(), camera);
        // A single sequence of a camera has no other one to train on.
        let apart = kind == PublishedKind::Highlights && clips.len() > 1;
        whole &= apart;
        for clip in clips {
            let of_clip = gathered.frames_of_camera(range.clone(), camera, |other| other == clip);
            let (training_frames, test_frames) = if apart {
                (
                    gathered.frames_of_camera(range.clone(), camera, |other| other != clip),
                    of_clip,
                )
            } else {
                (
                    // Half of each game trains, as in the paper; alternating, so that both halves
                    // see all of it.
                    of_clip.iter().copied().step_by(2).collect(),
                    of_clip.iter().copied().skip(1).step_by(2).collect(),
                )
            };
            splits.push(Split {
                name: clip.to_owned(),
                training_frames,
                test_frames,
            });
        }
    }
    splits
        .retain(|split: &Split| !split.training_frames.is_empty() && !split.test_frames.is_empty());
    (splits, whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mat_writer::{CAMERA, frame, sequence};
    use std::fs;

    /// Two sequences of three frames each, with their images.
    fn write_sequences(folder: &Path) {
        for name in ["seq1", "seq2"] {
            fs::create_dir_all(folder.join(name)).unwrap();
            for image in ["1.png", "2.png", "3.png"] {
                image::RgbImage::new(64, 36)
                    .save(folder.join(name).join(image))
                    .unwrap();
            }
            let frames = ["1.png", "2.png", "3.png"]
                .map(|image| frame(image, CAMERA))
                .into();
            fs::write(
                folder.join(format!("{name}_anno.mat")),
                sequence(frames, true),
            )
            .unwrap();
        }
    }

    #[test]
    fn folders_are_found_by_name_and_sequences_are_split() {
        let root = tempfile::tempdir().unwrap();
        let (data, highlights) = (root.path(), root.path().join("highlights"));
        write_sequences(&highlights);
        let found = |data: &Path, kind| published_folder(data, kind);
        assert_eq!(
            found(data, PublishedKind::Highlights),
            Some(highlights.clone())
        );
        assert_eq!(found(data, PublishedKind::WorldCup), None);
        assert_eq!(
            found(&highlights, PublishedKind::Highlights),
            Some(highlights.clone())
        );
        assert_eq!(found(&highlights, PublishedKind::WorldCup), None);

        let set = read_published(&highlights, PublishedKind::Highlights, &|_, _| {}).unwrap();
        assert_eq!(
            (set.kind, set.names()),
            (SetKind::Published, vec!["seq1", "seq2"])
        );
        assert!(set.title.starts_with(
            "the authors' published data, 6 frames in 2 sequences; field 118 × 70 yards"
        ));
        assert_eq!(
            (
                &set.splits[0].training_frames[..],
                &set.splits[0].test_frames[..]
            ),
            (&[3, 4, 5][..], &[0, 1, 2][..])
        );
        let set = read_published(&highlights, PublishedKind::WorldCup, &|_, _| {}).unwrap();
        assert_eq!(
            (
                &set.splits[1].training_frames[..],
                &set.splits[1].test_frames[..]
            ),
            (&[3, 5][..], &[4][..])
        );

        fs::remove_file(highlights.join("seq2/2.png")).unwrap();
        let error = read_published(&highlights, PublishedKind::Highlights, &|_, _| {})
            .unwrap_err()
            .to_string();
        assert!(error.contains("seq2/2.png"), "{error}");
    }

    #[test]
    fn frames_of_which_none_can_be_tested_are_refused() {
        let data = tempfile::tempdir().unwrap();
        fs::create_dir(data.path().join("seq1")).unwrap();
        image::RgbImage::new(64, 36)
            .save(data.path().join("seq1/1.png"))
            .unwrap();
        let one_frame = sequence(vec![frame("1.png", CAMERA)], true);
        fs::write(data.path().join("seq1_anno.mat"), one_frame).unwrap();
        for kind in [PublishedKind::Highlights, PublishedKind::WorldCup] {
            let error = read_published(data.path(), kind, &|_, _| {}).unwrap_err();
            assert!(
                matches!(error, ExperimentError::NothingToTest { .. }),
                "{error}"
            );
        }
    }
}
