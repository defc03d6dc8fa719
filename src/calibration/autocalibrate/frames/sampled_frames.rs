//! The sampled frames, and what is kept of each picture: its features and its marking pixels.

use rayon::prelude::*;
use std::collections::BTreeMap;
use touchline_core::geometry::{ImageSize, PixelBox};
use touchline_vision::features::{FeatureError, FeatureOptions, Features, extract};
use touchline_vision::media::Picture;
use touchline_vision::paint::{GroundPicture, MarkingPixels};

/// Reads the picture of a document's frame, by its index; none if it cannot be read.
pub type PictureOfFrame<'a> = &'a mut dyn FnMut(usize) -> Option<Picture>;

/// Number of pictures in memory at a time.
pub const MAX_PICTURES_IN_MEMORY: usize = 8;

/// A sampled frame, with what is kept of its picture.
#[derive(Clone, Debug)]
pub struct SampledFrame {
    /// Its index in the document.
    pub index: usize,
    /// Boxes whose pixels do not count.
    pub masks: Vec<PixelBox>,
    pub features: Features,
    pub marking_pixels: MarkingPixels,
}

impl SampledFrame {
    /// Extracts features, unless they are known, and marking pixels outside `masks`.
    ///
    /// # Errors
    /// The program was built without OpenCV, or OpenCV refused.
    pub fn from_picture(
        index: usize,
        picture: &Picture,
        masks: Vec<PixelBox>,
        known: Option<Features>,
    ) -> Result<Self, FeatureError> {
        let options = FeatureOptions {
            root_sift: true,
            ..FeatureOptions::default()
        };
        let features = match known {
            Some(features) => features,
            None => extract(picture, &masks, &options)?,
        };
        let marking_pixels = MarkingPixels::detect(&GroundPicture::new(picture, &masks));
        Ok(Self {
            index,
            masks,
            features,
            marking_pixels,
        })
    }

    pub fn image_size(&self) -> ImageSize {
        self.marking_pixels.size()
    }
}

/// Samples some frames in parallel, of which features may be known, by index. Frames whose picture
/// cannot be read are left out.
///
/// # Errors
/// As [`SampledFrame::from_picture`].
pub fn sample_frames(
    indices: &[usize],
    masks_of: impl Fn(usize) -> Vec<PixelBox> + Sync,
    known: &BTreeMap<usize, Features>,
    picture: PictureOfFrame<'_>,
) -> Result<Vec<SampledFrame>, FeatureError> {
    read_pictures(indices, picture)
        .par_iter()
        .map(|(index, picture)| {
            let known = known.get(index).cloned();
            SampledFrame::from_picture(*index, picture, masks_of(*index), known)
        })
        .collect()
}

/// The pictures of some frames, each with the frame's index; those that cannot be read are left
/// out.
pub fn read_pictures(indices: &[usize], picture: PictureOfFrame<'_>) -> Vec<(usize, Picture)> {
    indices
        .iter()
        .filter_map(|index| Some((*index, picture(*index)?)))
        .collect()
}

/// `count` of some frames, evenly spread, in their order; all of them if they are fewer.
pub fn spread_evenly(indices: &[usize], count: usize) -> impl Iterator<Item = usize> {
    let count = count.min(indices.len());
    (0..count).map(move |place| indices[place * indices.len() / count])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sampled_frames_are_spread_over_all_and_none_comes_twice() {
        let indices: Vec<usize> = (100..110).collect();
        let spread = |count: usize| spread_evenly(&indices, count).collect::<Vec<usize>>();
        assert_eq!(spread(4), [100, 102, 105, 107]);
        assert_eq!(spread(10), indices);
        assert_eq!(spread(25), indices, "no more than there are");
        assert_eq!(spread(0), [0; 0]);
        assert_eq!(spread_evenly(&[], 5).count(), 0);
    }

    #[test]
    fn pictures_that_cannot_be_read_are_left_out() {
        let size = ImageSize::new(8, 8);
        let mut requests = Vec::new();
        let mut picture = |index: usize| {
            requests.push(index);
            (index != 4).then(|| Picture::with_colour(size, [0, 0, 0, 255]))
        };
        let read: Vec<usize> = read_pictures(&[3, 4, 9], &mut picture)
            .into_iter()
            .map(|(index, _)| index)
            .collect();
        assert_eq!((read, requests), (vec![3, 9], vec![3, 4, 9]));
    }
}
