//! The identity of a training set, by which the program decides whether to train a forest again.

use serde_json::json;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::geometry::hex;
use touchline_documents::document::{CameraId, Document};

/// Digests of everything in the references that the forest depends on: pictures, masks and cameras.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TrainingSet {
    training_samples: BTreeSet<[u8; 16]>,
}

impl TrainingSet {
    /// The training set of some frames of a document.
    pub fn from_frames(document: &Document, training_frames: &[usize]) -> Self {
        let mut cameras = BTreeMap::<&CameraId, String>::new();
        let mut training_samples = BTreeSet::new();
        for frame in training_frames
            .iter()
            .filter_map(|&index| document.frames.get(index))
        {
            // Digest the serialised inputs. Cameras are serialised once each.
            let camera = cameras.entry(&frame.camera).or_insert_with(|| {
                document
                    .camera_of(frame)
                    .and_then(|camera| serde_json::to_string(camera).ok())
                    .unwrap_or_default()
            });
            let masks: Vec<[f64; 4]> = frame
                .masks
                .iter()
                .map(|m| [m.x, m.y, m.width, m.height])
                .collect();
            let sample = json!([
                frame.image,
                frame.video,
                frame.sha256,
                masks,
                frame.ptz,
                camera
            ]);
            // Most frames have the lens of their camera. Only a lens of a frame's own is added, so
            // that the forests of all other documents keep their digests.
            let lens = frame.lens.as_ref();
            let lens = lens.and_then(|lens| serde_json::to_string(lens).ok());
            // Half of a digest: that two references share 16 bytes by chance can be neglected.
            let digest = Sha256::digest(sample.to_string() + &lens.unwrap_or_default());
            training_samples.extend(digest.first_chunk::<16>());
        }
        Self { training_samples }
    }

    /// Whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.training_samples.is_empty()
    }

    /// Whether it contains all of `other`: then a forest of `other` is incomplete, but not wrong.
    pub fn contains(&self, other: &Self) -> bool {
        self.training_samples.is_superset(&other.training_samples)
    }

    /// A fingerprint of the set, 32 hexadecimal digits.
    pub fn fingerprint(&self) -> String {
        let mut digest = Sha256::new();
        // The set is sorted, so the fingerprint does not depend on the order of the frames.
        for sample in &self.training_samples {
            digest.update(sample);
        }
        hex(&digest.finalize()[..16])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::camera::Radial;
    use touchline_core::geometry::{ImagePoint, ImageSize};
    use touchline_core::testing::pixel_box;
    use touchline_documents::document::FrameLens;
    use touchline_documents::testing::{a_match, new_frame, ptz_at};

    fn document() -> Document {
        let size = ImageSize::new(640, 360);

        let mut document = a_match(size);
        for index in 0..3 {
            let mut frame = new_frame(&format!("{index}.jpg"), size);
            frame.ptz = ptz_at(f64::from(index), -9.0, 900.0);
            document.frames.push(frame.into());
        }
        document
    }

    #[test]
    fn more_contains_less_and_any_change_is_another() {
        let document = document();
        let (two, three) = (
            TrainingSet::from_frames(&document, &[0, 1]),
            TrainingSet::from_frames(&document, &[1, 0, 2]),
        );
        assert!(three.contains(&two) && !two.contains(&three));
        assert_eq!(
            TrainingSet::from_frames(&document, &[1, 0]).fingerprint(),
            two.fingerprint()
        );
        assert_ne!(three.fingerprint(), two.fingerprint());
        assert!(TrainingSet::from_frames(&document, &[7]).is_empty());

        let changes: [fn(&mut Document); 5] = [
            |document| document.frames[0].ptz.as_mut().unwrap().pan_deg += 1e-9,
            |document| {
                document.frames[0].masks.push(pixel_box(1.0, 1.0, 9.0, 9.0));
            },
            |document| {
                document.cameras[0]
                    .masks
                    .push(pixel_box(1.0, 1.0, 9.0, 9.0));
            },
            |document| document.frames[0].sha256 = Some("ab".to_owned()),
            |document| {
                let middle = ImagePoint::new(320.0, 180.0);
                document.frames[0].lens = Some(FrameLens::new(900.0, middle, Radial::k1(0.1)));
            },
        ];
        for change in changes {
            let mut changed = document.clone();
            change(&mut changed);
            assert!(!TrainingSet::from_frames(&changed, &[0, 1, 2]).contains(&two));
        }
        let mut commented = document.clone();
        commented.frames[0].comment = Some("rain".to_owned());
        assert_eq!(TrainingSet::from_frames(&commented, &[0, 1]), two);
    }
}
