//! Points followed through a clip.

use crate::geometry::{ImagePoint, ImageSize};

/// One point of the scene, in frame after frame.
#[derive(Clone, Debug, PartialEq)]
pub struct PointTrack {
    /// The first frame that shows it, by its place in the clip.
    pub first: usize,
    /// Where it is in that frame and in each one after, px.
    pub points: Vec<ImagePoint>,
}

/// All points followed through a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct PointTracks {
    /// The size of all frames, px.
    pub image_size: ImageSize,
    /// How many frames were looked at.
    pub frames: usize,
    /// In the order in which they begin.
    pub tracks: Vec<PointTrack>,
}

impl PointTracks {
    /// For each frame the tracks that show it, each with the place of the frame in it.
    pub(super) fn by_frame(&self) -> Vec<Vec<(usize, usize)>> {
        let mut frames = vec![Vec::new(); self.frames];
        for (track, followed) in self.tracks.iter().enumerate() {
            for place in 0..followed.points.len() {
                frames[followed.first + place].push((track, place));
            }
        }
        frames
    }
}
