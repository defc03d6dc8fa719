//! The kinds of features, and the frames of a set described with each.

use crate::ExperimentError;
use crate::matching::DescriptorRows;
use crate::sets::{FrameSet, KnownFrame, as_picture};
use crate::surf::{SQUARED_SCALE, extract_surf};
use rayon::prelude::*;
use touchline::features::{
    BinaryDescriptor, BinaryKind, Features, MAX_SQUARED_DISTANCE, extract_binary, spread,
};
use touchline::media::{FrameReader, Picture};
use touchline::relocalize::PredictOptions;

/// Maximum number of features in a picture, as SIFT's default.
pub const MOST_FEATURES: usize = 1000;

/// SURF's gate: the maximum squared distance of unit descriptors. SIFT's, 0.2, would be none, since
/// SURF's distances are smaller. This one lets as many unrelated features pass. Measured with 1000
/// features in each of five pictures of three other broadcasts (`scouting-*`): compared with the
/// other broadcasts' pictures, 9.0 % have a neighbour within 0.05 with SURF (99.6 % within 0.2), and
/// 8.8 % within 0.2 with SIFT. Of the right neighbours in the same pictures at 0.86 of their size,
/// 85 % pass with SURF and 99 % with SIFT.
const SURF_GATE: f32 = 0.05;

/// Maximum distance of nearest neighbours of bits, as a share of the largest possible distance.
/// Unrelated descriptors differ in half of their bits.
const BINARY_NEIGHBOUR_GATE: f32 = 0.15;

/// Number of SURF features extracted, relative to the maximum: spreading then chooses among them.
/// As for ORB and AKAZE.
const SURPLUS: usize = 3;

/// Number of pictures in memory.
const BATCH: usize = 16;

/// A kind of features.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeatureKind {
    Sift,
    Surf,
    Orb,
    Akaze,
}

impl FeatureKind {
    pub const ALL: [Self; 4] = [Self::Sift, Self::Surf, Self::Orb, Self::Akaze];

    /// Its name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sift => "SIFT",
            Self::Surf => "SURF",
            Self::Orb => "ORB",
            Self::Akaze => "AKAZE",
        }
    }

    /// The maximum squared distance of unit descriptors. For SIFT it is the program's, which is the
    /// paper's, and bits as bytes are scaled to it (`BinaryDescriptor::as_bytes`).
    fn unit_gate(self) -> f32 {
        match self {
            Self::Surf => SURF_GATE,
            Self::Sift | Self::Orb | Self::Akaze => PredictOptions::default().max_squared_distance,
        }
    }

    /// Squared distances of the stored descriptors, relative to those of unit length.
    const fn scale_of_squares(self) -> f32 {
        match self {
            Self::Surf => SQUARED_SCALE,
            Self::Sift | Self::Orb | Self::Akaze => 1.0,
        }
    }

    /// A forest's maximum squared distance, of descriptors as they are stored.
    pub fn forest_gate(self) -> f32 {
        self.unit_gate() * self.scale_of_squares()
    }
}

/// A set of frames whose features are of one kind, and whose test frames are those to be queried.
pub struct Described {
    pub kind: FeatureKind,
    /// The set. The descriptors of binary features are 128 of their bits, as bytes.
    pub set: FrameSet,
    compared: SearchableDescriptors,
}

/// The descriptors of all frames, in the form in which neighbours are searched.
enum SearchableDescriptors {
    Numbers(Vec<DescriptorRows>),
    Bits(Vec<Vec<BinaryDescriptor>>, BinaryKind),
}

/// The distance between two descriptors, as a share of the largest possible one, and the index of
/// the neighbour.
pub type Neighbour = (f32, usize);

impl Described {
    /// Describes all frames of a set, and keeps one test frame in `stride`.
    ///
    /// # Errors
    /// A picture cannot be read, or its features cannot be extracted.
    pub fn from_set(
        set: &FrameSet,
        kind: FeatureKind,
        stride: usize,
    ) -> Result<Self, ExperimentError> {
        let mut set = set.clone();
        for split in &mut set.splits {
            // Before the features are extracted: all frames may train, and only these are tested.
            let queried = split.test_frames.iter().copied().step_by(stride);
            split.test_frames = queried.collect();
        }
        let compared = match kind {
            // A set's own features are SIFT.
            FeatureKind::Sift => SearchableDescriptors::numbers_of(&set),
            FeatureKind::Surf => {
                let found = with_pictures(&set, |known, picture| {
                    let found = extract_surf(picture, known.used_masks(), SURPLUS * MOST_FEATURES);
                    Ok(keep_spread(&found, MOST_FEATURES))
                })?;
                for (known, features) in set.frames.iter_mut().zip(found) {
                    known.features = features;
                }
                SearchableDescriptors::numbers_of(&set)
            }
            FeatureKind::Orb => describe_in_bits(&mut set, BinaryKind::Orb)?,
            FeatureKind::Akaze => describe_in_bits(&mut set, BinaryKind::Akaze)?,
        };
        Ok(Self {
            kind,
            set,
            compared,
        })
    }

    /// For each feature of a frame, the nearest feature of another frame; none if that has no
    /// features.
    pub fn neighbours(&self, frame: usize, other: usize) -> Vec<Option<Neighbour>> {
        match &self.compared {
            SearchableDescriptors::Numbers(rows) if rows[other].is_empty() => {
                vec![None; rows[frame].len()]
            }
            SearchableDescriptors::Numbers(rows) => {
                // As a share of the largest distance, so that numbers and bits have gates of one
                // kind.
                let largest = MAX_SQUARED_DISTANCE * self.kind.scale_of_squares();
                crate::matching::nearest(&rows[frame], &rows[other])
                    .iter()
                    .map(|found| Some((found.squared_distance / largest, found.feature)))
                    .collect()
            }
            SearchableDescriptors::Bits(frames, kind) => {
                let nearest = |query: &BinaryDescriptor| {
                    let others = frames[other].iter().enumerate();
                    let (bits, feature) = others
                        // Of equal distances the first feature: bits often have some.
                        .map(|(feature, other)| (query.distance(other), feature))
                        .min()?;
                    Some((bits as f32 / kind.bits() as f32, feature))
                };
                frames[frame].iter().map(nearest).collect()
            }
        }
    }

    /// The maximum distance of neighbours, as a share of the largest possible one.
    pub fn neighbour_gate(&self) -> f32 {
        match self.compared {
            SearchableDescriptors::Numbers(_) => self.kind.unit_gate() / MAX_SQUARED_DISTANCE,
            SearchableDescriptors::Bits(..) => BINARY_NEIGHBOUR_GATE,
        }
    }
}

impl SearchableDescriptors {
    fn numbers_of(set: &FrameSet) -> Self {
        let frames = set.frames.iter();
        Self::Numbers(
            frames
                .map(|known| DescriptorRows::from_descriptors(&known.features.descriptors))
                .collect(),
        )
    }
}

/// Puts binary features in place of a set's own: as bytes for the forests. Returns all their bits.
fn describe_in_bits(
    set: &mut FrameSet,
    kind: BinaryKind,
) -> Result<SearchableDescriptors, ExperimentError> {
    let found = with_pictures(set, |known, picture| {
        let masks = known.used_masks();
        Ok(extract_binary(picture, masks, kind, MOST_FEATURES)?)
    })?;
    let mut bits = Vec::with_capacity(found.len());
    for (known, found) in set.frames.iter_mut().zip(found) {
        let descriptors = found.descriptors.iter();
        known.features = Features {
            image_size: found.image_size,
            keypoints: found.keypoints,
            descriptors: descriptors.map(|bits| bits.as_bytes(kind)).collect(),
        };
        // Neighbours compare all bits, forests see 128 of them as bytes.
        bits.push(found.descriptors);
    }
    Ok(SearchableDescriptors::Bits(bits, kind))
}

/// Calls the function for each frame with its picture, in parallel.
fn with_pictures<T: Send>(
    set: &FrameSet,
    of_frame: impl Fn(&KnownFrame, &Picture) -> Result<T, ExperimentError> + Sync,
) -> Result<Vec<T>, ExperimentError> {
    let mut reader = FrameReader::new();
    let mut all = Vec::with_capacity(set.frames.len());
    // A batch at a time, because all decoded pictures of a set would fill the memory.
    for batch in set.frames.chunks(BATCH) {
        // Read sequentially, because a video decoder has one position.
        let pictures: Vec<_> = batch
            .iter()
            .map(|known| known.picture(&mut reader))
            .collect::<Result<_, _>>()?;
        let found = batch
            .par_iter()
            .zip(pictures)
            .map(|(known, picture)| of_frame(known, &as_picture(picture)?));
        all.extend(found.collect::<Result<Vec<T>, ExperimentError>>()?);
    }
    Ok(all)
}

/// Keeps at most `most` features, spread over the picture by the rule that the program applies to
/// SIFT, ORB and AKAZE. Without it, SURF alone would spend its features on the crowd.
fn keep_spread(features: &Features, most: usize) -> Features {
    let kept = spread(&features.keypoints, features.image_size, most);
    Features {
        image_size: features.image_size,
        keypoints: kept.iter().map(|&at| features.keypoints[at]).collect(),
        descriptors: kept.iter().map(|&at| features.descriptors[at]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline::features::{DESCRIPTOR_BYTES, Descriptor, Keypoint};
    use touchline::geometry::{ImagePoint, ImageSize};

    #[test]
    fn a_crowded_corner_does_not_take_all_surf_features() {
        let keypoint = |x: f64, strength: f32| Keypoint {
            point: ImagePoint::new(x, 50.0),
            size_px: 4.0,
            strength,
        };
        let strong = (0..900).map(|i| keypoint(10.0, 2000.0 - i as f32));
        let weak = (0..100).map(|i| keypoint(700.0, 100.0 - i as f32));
        let keypoints: Vec<Keypoint> = strong.chain(weak).collect();
        let features = Features {
            image_size: ImageSize::new(800, 500),
            descriptors: vec![Descriptor([0; DESCRIPTOR_BYTES]); keypoints.len()],
            keypoints,
        };
        let kept = keep_spread(&features, 400);
        let far = kept.keypoints.iter().filter(|kept| kept.point.x > 600.0);
        assert_eq!((kept.len(), far.count()), (400, 40));
        assert_eq!(
            kept.keypoints[0], features.keypoints[0],
            "the strongest first"
        );
        assert_eq!(keep_spread(&features, 1000), features, "few are all kept");
    }

    #[test]
    fn the_gate_of_surf_is_on_the_scale_of_its_bytes() {
        let [sift, surf, orb, akaze] = FeatureKind::ALL.map(FeatureKind::forest_gate);
        assert_eq!([sift, orb, akaze], [0.2; 3]);
        assert!((surf - SURF_GATE / 8.0).abs() < 1e-5, "{surf}");
    }
}
