//! Points tracked through a clip.

use touchline_core::geometry::{ImagePoint, ImageSize, PixelBox};

/// One point of the scene, tracked through consecutive frames.
#[derive(Clone, Debug, PartialEq)]
pub struct PointTrack {
    /// The first frame that shows it, as an index into the clip.
    pub first: usize,
    /// Its position in that frame and in each following one, px.
    pub points: Vec<ImagePoint>,
}

/// All points tracked through a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct PointTracks {
    /// The size of all frames, px.
    pub image_size: ImageSize,
    /// Number of frames processed.
    pub frames: usize,
    /// In the order in which the tracks begin.
    pub tracks: Vec<PointTrack>,
}

impl PointTracks {
    /// The tracks outside the masks; `masks` has those of each frame. A track that enters a mask
    /// ends, and a new one begins where it leaves the mask, because a point under a graphic is not
    /// tracked reliably.
    #[must_use]
    pub fn outside(&self, masks: &[Vec<PixelBox>]) -> Self {
        // One pass over the observations. `is_followed` says whether the last one of this track was
        // outside the masks; then the last of the new tracks is its continuation.
        let mut tracks: Vec<PointTrack> = Vec::with_capacity(self.tracks.len());
        for track in &self.tracks {
            let mut is_followed = false;
            for (frame, point) in (track.first..).zip(&track.points) {
                let is_open = masks
                    .get(frame)
                    .is_none_or(|masks| !masks.iter().any(|mask| mask.contains(*point)));
                match tracks.last_mut().filter(|_| is_followed) {
                    Some(last) if is_open => last.points.push(*point),
                    None if is_open => tracks.push(PointTrack {
                        first: frame,
                        points: vec![*point],
                    }),
                    _ => {}
                }
                is_followed = is_open;
            }
        }
        // A part of a track begins later than the track; the order by begin is restored.
        tracks.sort_by_key(|track| track.first);
        Self { tracks, ..*self }
    }

    /// For each frame the tracks that show it, each with the index of the observation within the
    /// track.
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

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::testing::pixel_box;

    #[test]
    fn a_point_that_passes_under_a_mask_is_another_one_behind_it() {
        let points = (0..6)
            .map(|at| ImagePoint::new(10.0 * f64::from(at), 5.0))
            .collect();
        let track = PointTrack { first: 2, points };
        let tracks = PointTracks {
            image_size: ImageSize::new(64, 36),
            frames: 8,
            tracks: vec![track.clone()],
        };
        let mask = pixel_box(18.0, 0.0, 14.0, 20.0);
        let left = tracks.outside(&vec![vec![mask]; 8]);
        let lengths: Vec<_> = left
            .tracks
            .iter()
            .map(|track| (track.first, track.points.len()))
            .collect();
        assert_eq!(lengths, [(2, 2), (6, 2)]);
        assert_eq!(left.tracks[1].points[0], track.points[4]);
        assert_eq!(tracks.outside(&[]), tracks);
        let only_one = tracks.outside(&[vec![], vec![], vec![PixelBox { x: 0.0, ..mask }]]);
        assert_eq!((only_one.tracks.len(), only_one.tracks[0].first), (1, 3));
    }
}
