//! Features of pictures and the matches between them as bytes.

use super::{Kept, kept};
use touchline_vision::features::{Descriptor, Features, Keypoint};
use touchline_vision::track::ViewGraphEdge;

kept! {
    Keypoint { point, size_px, strength }
    Features { image_size, keypoints, descriptors }
    ViewGraphEdge { first, second, matches, agreeing, second_from_first }
}

impl Kept for Descriptor {
    fn write(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.0);
    }

    fn read(bytes: &mut &[u8]) -> Option<Self> {
        let size = size_of::<Self>();
        Some(Self(bytes.split_off(..size)?.try_into().ok()?))
    }
}
