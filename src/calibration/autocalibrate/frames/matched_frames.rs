//! Frames of one camera, matched pairwise: the view graph of the search.
//!
//! [`MatchedFrames`] is the largest connected group of the sampled frames. All later stages number
//! frames within that group; only [`MatchedFrames::indices`] leads back to the document.
//! [`FramesAtScale`] is what the matches determine at one focal scale: the relative rotations of
//! the frames, and the paint that several of them show in one direction.

use super::panorama::Panorama;
use super::sampled_frames::{PictureOfFrame, SampledFrame, read_pictures};
use crate::autocalibrate::error::Stop;
use crate::autocalibrate::progress::report;
use crate::autocalibrate::{Abstention, AutocalibrationError, AutocalibrationProgress};
use crate::calibrate::AutocalibratedFrame;
use crate::calibrate::kept::KeepParts;
use rayon::prelude::*;
use std::collections::BTreeMap;
use touchline_core::camera::StatedLens;
use touchline_core::geometry::{ImagePoint, ImageSize, PixelBox, Vec3};
use touchline_core::progress::{Progress, Share};
use touchline_vision::features::Features;
use touchline_vision::media::Picture;
use touchline_vision::paint::{
    GroundDirections, GroundPicture, MarkingPixels, PersistentPoint, persistent_paint,
};
use touchline_vision::track::{
    RelativeRotations, TurnOptions, ViewGraphEdge, adjust_rotations, groups, match_frames_pairwise,
};

/// With fewer directions of persistent paint no camera is found.
const MIN_DIRECTIONS: usize = 150;

/// Fewer frames do not separate persistent paint from what moves.
const MIN_FRAMES: usize = 3;

/// A marking in the picture of a frame that other frames show as well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintPoint {
    pub at: ImagePoint,
    /// As [`MarkingPixel::contrast_px`](touchline_vision::paint::MarkingPixel::contrast_px).
    pub contrast_px: Option<f64>,
}

/// The paint in the picture of a frame.
pub type FramePaint = Vec<PaintPoint>;

/// The largest group of frames that pairwise matches connect, numbered within the group.
pub struct MatchedFrames {
    /// Indices of the frames in the document, ascending.
    pub indices: Vec<usize>,
    /// Indices in the document of the sampled frames outside the group: taken to be another
    /// camera's.
    pub others: Vec<usize>,
    /// Size of all their pictures.
    pub image_size: ImageSize,
    /// Their lens as the document states it.
    pub lens: StatedLens,
    /// The edges of the view graph.
    pub matches: Vec<ViewGraphEdge>,
    /// The marking pixels of each frame.
    pub marking_pixels: Vec<MarkingPixels>,
    /// Masks of each frame: boxes whose pixels do not count.
    pub masks: Vec<Vec<PixelBox>>,
}

/// The frames at one focal scale, with the rotations that fit the pairwise matches.
pub struct FramesAtScale {
    /// The log focal scale: of the factor on the focal lengths that fit the matches best.
    pub log_scale: f64,
    pub rotations: RelativeRotations,
    /// Persistent paint of each frame.
    pub paint: Vec<FramePaint>,
}

impl MatchedFrames {
    /// Matches the sampled frames, unless these matches were kept, and takes the largest connected
    /// group.
    ///
    /// # Errors
    /// Too few frames are connected, the search was stopped, or OpenCV is missing or failed.
    pub fn from_sampled(
        frames: &[SampledFrame],
        parts: &dyn KeepParts,
        progress: &Progress<'_, AutocalibrationProgress>,
    ) -> Result<Self, Stop> {
        let features: Vec<Features> = frames.iter().map(|frame| frame.features.clone()).collect();
        let pairs = frames.len() * frames.len().saturating_sub(1) / 2;
        let of_pairs =
            progress.part(|Share { done, of }| AutocalibrationProgress::Tying { done, of });
        let matches = parts
            .part(
                &format!("matches-{}", frames.len()),
                || match_frames_pairwise(&features, &of_pairs),
                || !progress.is_cancelled(),
            )
            .map_err(AutocalibrationError::Track)?;
        report(
            progress,
            AutocalibrationProgress::Tying {
                done: pairs,
                of: pairs,
            },
        )?;
        let matched = Self::from_matches(frames, &matches)?;
        report(
            progress,
            AutocalibrationProgress::Matched {
                frames: matched.indices.clone(),
                others: matched.others.clone(),
                links: matched
                    .matches
                    .iter()
                    .map(|edge| ([edge.first, edge.second], edge.agreeing))
                    .collect(),
            },
        )?;
        Ok(matched)
    }

    /// Keeps the largest group of frames of one size that `matches` connect.
    pub fn from_matches(
        frames: &[SampledFrame],
        matches: &[ViewGraphEdge],
    ) -> Result<Self, Abstention> {
        // Frames of different sizes are different cameras, even if they match. The groups come
        // largest first.
        let of_one_size: Vec<ViewGraphEdge> = matches
            .iter()
            .filter(|pair| frames[pair.first].image_size() == frames[pair.second].image_size())
            .cloned()
            .collect();
        let group = groups(frames.len(), &of_one_size)
            .into_iter()
            .next()
            .unwrap_or_default();
        if group.len() < MIN_FRAMES {
            return Err(Abstention::NotConnected {
                frames: frames.len(),
                connected: group.len(),
            });
        }
        let others = (0..frames.len()).filter(|frame| group.binary_search(frame).is_err());
        Ok(Self {
            indices: group.iter().map(|&frame| frames[frame].index).collect(),
            others: others.map(|frame| frames[frame].index).collect(),
            image_size: frames[group[0]].image_size(),
            lens: StatedLens::default(),
            matches: renumber_matches(matches, &group),
            marking_pixels: group
                .iter()
                .map(|&frame| frames[frame].marking_pixels.clone())
                .collect(),
            masks: group
                .iter()
                .map(|&frame| frames[frame].masks.clone())
                .collect(),
        })
    }

    /// The same frames with the lens that the document states for pictures of a size; those of
    /// another size have the usual one.
    pub fn with_lens(self, lens: StatedLens, of_size: ImageSize) -> Self {
        if self.image_size == of_size {
            Self { lens, ..self }
        } else {
            self
        }
    }

    /// The number within the group of a frame, from its index in the document.
    pub fn number_of(&self, index: usize) -> Option<usize> {
        self.indices.iter().position(|other| *other == index)
    }

    /// Looks at the pictures of some frames in parallel, each made ready with its masks. None for a
    /// frame whose picture cannot be read. All these pictures are in memory at a time.
    pub fn look_at_pictures<T: Send>(
        &self,
        frames: &[AutocalibratedFrame],
        picture: PictureOfFrame<'_>,
        look: impl Fn(&AutocalibratedFrame, &GroundPicture) -> T + Sync,
    ) -> Vec<Option<T>> {
        let indices: Vec<usize> = frames.iter().map(|frame| frame.index).collect();
        let pictures: BTreeMap<usize, Picture> =
            read_pictures(&indices, picture).into_iter().collect();
        let of_frame = |frame: &AutocalibratedFrame| {
            let masks = &self.masks[self.number_of(frame.index)?];
            let ground = GroundPicture::new(pictures.get(&frame.index)?, masks);
            Some(look(frame, &ground))
        };
        frames.par_iter().map(of_frame).collect()
    }

    /// The rotations and the panorama of paint with all focal lengths at `focal_percent` per cent
    /// of those that fit the matches best.
    pub fn at_scale(&self, focal_percent: u32) -> Result<(FramesAtScale, Panorama), Abstention> {
        let focal_scale = f64::from(focal_percent) / 100.0;
        let options = TurnOptions {
            focal_scale,
            ..TurnOptions::with_lens(&self.lens, self.image_size)
        };
        // Rotations, zoom and lens from the matches, at this scale.
        let rotations =
            adjust_rotations(self.indices.len(), &self.matches, self.image_size, &options)
                .map_err(Abstention::NotTurning)?;
        let frames: Vec<_> = self
            .marking_pixels
            .iter()
            .enumerate()
            .map(|(frame, marking_pixels)| (rotations.camera(frame), marking_pixels.clone()))
            .collect();
        // Paint that several frames show in one direction.
        let points = persistent_paint(&frames);
        let directions: Vec<Vec3> = points.iter().map(|point| point.direction).collect();
        let panorama = Panorama::new(&directions, GroundDirections::from_frames(&frames));
        if panorama.directions.len() < MIN_DIRECTIONS {
            return Err(Abstention::LittlePaint {
                places: panorama.directions.len(),
            });
        }
        let paint = paint_of_frames(&points, self.marking_pixels.len());
        Ok((
            FramesAtScale {
                log_scale: focal_scale.ln(),
                rotations,
                paint,
            },
            panorama,
        ))
    }
}

/// The matches between the frames of a group (ascending), renumbered within it. Matches with other
/// frames are left out.
pub fn renumber_matches(matches: &[ViewGraphEdge], group: &[usize]) -> Vec<ViewGraphEdge> {
    matches
        .iter()
        .filter_map(|pair| {
            Some(ViewGraphEdge {
                first: group.binary_search(&pair.first).ok()?,
                second: group.binary_search(&pair.second).ok()?,
                ..pair.clone()
            })
        })
        .collect()
}

/// Sorts persistent points by frame.
fn paint_of_frames(points: &[PersistentPoint], num_frames: usize) -> Vec<FramePaint> {
    let mut paint = vec![FramePaint::new(); num_frames];
    for point in points {
        paint[point.frame].push(PaintPoint {
            at: point.stroke.at,
            contrast_px: point.stroke.contrast_px,
        });
    }
    paint
}

#[cfg(test)]
impl From<ImagePoint> for PaintPoint {
    /// Paint of which only the position is known.
    fn from(at: ImagePoint) -> Self {
        Self {
            at,
            contrast_px: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autocalibrate::rotating_camera::{
        IMAGE_SIZE, bare_frame, exact_match, exact_matches,
    };
    use touchline_core::testing::pixel_box;

    /// Sampled frames with indices 20, 21, …
    fn sampled(count: usize) -> Vec<SampledFrame> {
        (0..count)
            .map(|frame| bare_frame(20 + frame, IMAGE_SIZE))
            .collect()
    }

    #[test]
    fn the_largest_connected_group_is_kept_and_the_others_are_named() {
        // Frames 0 and 6 match nothing; 1 to 3 are connected, and so are 4 and 5.
        let matches: Vec<ViewGraphEdge> = [(1, 2), (2, 3), (4, 5)]
            .iter()
            .filter_map(|&(first, second)| exact_match(first, second))
            .collect();
        let matched = MatchedFrames::from_matches(&sampled(7), &matches).unwrap();
        assert_eq!(matched.indices, [21, 22, 23]);
        assert_eq!(matched.others, [20, 24, 25, 26]);
        let pairs: Vec<(usize, usize)> = matched
            .matches
            .iter()
            .map(|pair| (pair.first, pair.second))
            .collect();
        assert_eq!(pairs, [(0, 1), (1, 2)], "numbered within the group");
        assert_eq!(matched.matches[0].matches, matches[0].matches);
        assert_eq!(
            (matched.number_of(22), matched.number_of(24)),
            (Some(1), None)
        );
        assert_eq!((matched.marking_pixels.len(), matched.masks.len()), (3, 3));
    }

    #[test]
    fn two_frames_are_too_few() {
        let matches = [exact_match(0, 1).unwrap()];
        let refused = MatchedFrames::from_matches(&sampled(4), &matches).err();
        assert_eq!(
            refused,
            Some(Abstention::NotConnected {
                frames: 4,
                connected: 2
            })
        );
        let refused = MatchedFrames::from_matches(&[], &[]).err();
        assert_eq!(
            refused,
            Some(Abstention::NotConnected {
                frames: 0,
                connected: 0
            })
        );
    }

    #[test]
    fn frames_of_another_size_are_another_cameras() {
        let mut frames = sampled(5);
        frames[2] = bare_frame(22, ImageSize::new(640, 360));
        let matches: Vec<ViewGraphEdge> = exact_matches()
            .into_iter()
            .filter(|pair| pair.second < 5)
            .collect();
        let matched = MatchedFrames::from_matches(&frames, &matches).unwrap();
        assert_eq!((matched.others, matched.image_size), (vec![22], IMAGE_SIZE));
    }

    #[test]
    fn masks_stay_with_their_frames() {
        let mut frames = sampled(4);
        let mask = pixel_box(0.0, 0.0, 200.0, 40.0);
        frames[3].masks = vec![mask];
        let matches: Vec<ViewGraphEdge> = [(1, 2), (2, 3)]
            .iter()
            .filter_map(|&(first, second)| exact_match(first, second))
            .collect();
        let matched = MatchedFrames::from_matches(&frames, &matches).unwrap();
        assert_eq!(matched.masks, [vec![], vec![], vec![mask]]);
    }

    #[test]
    fn frames_without_paint_show_too_little() {
        let matched = MatchedFrames::from_matches(&sampled(7), &exact_matches()).unwrap();
        let refused = matched.at_scale(100).err();
        assert_eq!(refused, Some(Abstention::LittlePaint { places: 0 }));
    }
}
