//! Tracking of points from picture to picture.

use super::super::TrackError;
#[cfg(feature = "opencv")]
use super::flow::FlowPicture;
use crate::media::Picture;
use touchline_core::geometry::{ImagePoint, ImageSize, PixelBox};
#[cfg(feature = "opencv")]
use touchline_core::geometry::{Vec2, median};

/// Options of a [`PointFollower`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowOptions {
    /// Target number of points tracked at once. Default: 320.
    pub points: usize,
    /// New points are detected when fewer than this share of them remains. Default: 0.8.
    pub refill: f64,
    /// Maximum length of a track in frames, because tracks drift; its point may be detected anew.
    /// Default: 60.
    pub longest: usize,
    /// Wider pictures are reduced by the smallest integer factor that fits, px. Default: 2000.
    pub max_width: u32,
}

impl Default for FollowOptions {
    fn default() -> Self {
        Self {
            points: 320,
            refill: 0.8,
            longest: 60,
            max_width: 2000,
        }
    }
}

/// Tracks points through the pictures of a clip, which are added in order.
pub struct PointFollower {
    #[cfg_attr(
        not(feature = "opencv"),
        expect(dead_code, reason = "flow needs OpenCV")
    )]
    options: FollowOptions,
    tracks: PointTracks,
    #[cfg(feature = "opencv")]
    last: Option<Last>,
}

/// The last picture, and the points alive in it.
#[cfg(feature = "opencv")]
struct Last {
    picture: FlowPicture,
    alive: Vec<Alive>,
}

/// A point that is being tracked, px of the reduced picture.
#[cfg(feature = "opencv")]
#[derive(Clone, Copy)]
struct Alive {
    track: usize,
    at: ImagePoint,
    /// Its last displacement; `None` for a new point.
    moved: Option<Vec2>,
    /// Number of frames until its track ends.
    left: usize,
}

impl PointFollower {
    /// A tracker without any points.
    pub const fn new(image_size: ImageSize, options: FollowOptions) -> Self {
        Self {
            options,
            tracks: PointTracks {
                image_size,
                frames: 0,
                tracks: Vec::new(),
            },
            #[cfg(feature = "opencv")]
            last: None,
        }
    }

    /// Number of pictures that the points were tracked through.
    pub const fn frames(&self) -> usize {
        self.tracks.frames
    }

    /// All tracks so far.
    pub fn into_tracks(self) -> PointTracks {
        self.tracks
    }

    /// Tracks the points into the next picture and returns how many were found there. Points inside
    /// a mask are dropped, and none is detected in one.
    ///
    /// # Errors
    /// OpenCV returned an error, or the program was built without it.
    #[cfg(not(feature = "opencv"))]
    pub fn add(&mut self, _: &Picture, _: &[PixelBox]) -> Result<usize, TrackError> {
        Err(TrackError::WithoutOpenCv)
    }
}

/// Minimum distance between points, as a share of the picture's width.
#[cfg(feature = "opencv")]
const DISTANCE_SHARE: f64 = 0.016;

#[cfg(feature = "opencv")]
impl PointFollower {
    /// Tracks the points into the next picture and returns how many were found there. Points inside
    /// a mask are dropped, and none is detected in one.
    ///
    /// # Errors
    /// OpenCV returned an error.
    pub fn add(&mut self, picture: &Picture, masks: &[PixelBox]) -> Result<usize, TrackError> {
        self.follow(picture, masks)
            .map_err(|error| TrackError::from_opencv(&error))
    }

    /// [`Self::add`], with OpenCV's error.
    fn follow(&mut self, picture: &Picture, masks: &[PixelBox]) -> opencv::Result<usize> {
        // Reduce and normalise the picture. The work is in px of the reduced one; only tracks are
        // in px of the full picture.
        let factor = picture.size().width.div_ceil(self.options.max_width).max(1);
        let full_px = f64::from(factor);
        let masks: Vec<PixelBox> = masks
            .iter()
            .map(|mask| mask.scale_by(1.0 / full_px))
            .collect();
        let mut grey = crate::media::grey_reduced(picture, factor);
        even_out(&mut grey);
        let picture = FlowPicture::from_grey(&grey)?;
        let frame = self.tracks.frames;
        self.tracks.frames += 1;
        // Track the points into this picture and append them to their tracks. A point that is lost
        // ends its track: without a gap, a track is a list of positions of consecutive frames.
        let mut alive = match self.last.take() {
            Some(last) => last.track_into(&picture, &masks)?,
            None => Vec::new(),
        };
        for point in &alive {
            self.tracks.tracks[point.track]
                .points
                .push(scale_point(point.at, full_px));
        }
        // End tracks at their age limit, then detect new points if too few remain.
        let found = alive.len();
        alive.retain(|point| point.left > 0);
        if (alive.len() as f64) < self.options.refill * self.options.points as f64 {
            let taken: Vec<ImagePoint> = alive.iter().map(|point| point.at).collect();
            let distance_px = DISTANCE_SHARE * f64::from(grey.size.width);
            let corners = picture.corners(self.options.points, distance_px, &taken, &masks)?;
            for (place, at) in corners.into_iter().enumerate() {
                let track = self.tracks.tracks.len();
                self.tracks.tracks.push(PointTrack {
                    first: frame,
                    points: vec![scale_point(at, full_px)],
                });
                // Tracks that begin together end at different ages, between half and all of
                // `longest`: otherwise all points would be replaced in one frame, and nothing would
                // connect the frames around it.
                let longest = self.options.longest;
                let left = (longest / 2 + (place * 7) % (longest / 2 + 1)).max(1);
                alive.push(Alive {
                    track,
                    at,
                    moved: None,
                    left,
                });
            }
        }
        self.last = Some(Last { picture, alive });
        Ok(found)
    }
}

#[cfg(feature = "opencv")]
impl Last {
    /// The points that are found in the next picture outside the masks.
    fn track_into(self, into: &FlowPicture, masks: &[PixelBox]) -> opencv::Result<Vec<Alive>> {
        // Guess: the point moves on as it did last; a new point moves as the median of the others.
        // So the search begins near the point in a fast pan, too.
        let usual = Vec2::new(self.median_motion_px(0), self.median_motion_px(1));
        let points: Vec<_> = self
            .alive
            .iter()
            .map(|point| (point.at, point.at.translate(point.moved.unwrap_or(usual))))
            .collect();
        let found = self.picture.track_into(into, &points)?;
        let alive = self.alive.iter().zip(found).filter_map(|(point, found)| {
            let at = found.filter(|at| !masks.iter().any(|mask| mask.contains(*at)))?;
            Some(point.move_to(at))
        });
        Ok(alive.collect())
    }

    /// The median of the points' last displacements along one axis; 0 if all points are new.
    fn median_motion_px(&self, axis: usize) -> f64 {
        let mut moved: Vec<f64> = self
            .alive
            .iter()
            .filter_map(|point| Some(point.moved?[axis]))
            .collect();
        median(&mut moved).unwrap_or(0.0)
    }
}

#[cfg(feature = "opencv")]
impl Alive {
    /// The point as the next frame shows it, at `at`.
    fn move_to(&self, at: ImagePoint) -> Self {
        Self {
            at,
            moved: Some(at.offset_from(self.at)),
            left: self.left - 1,
            ..*self
        }
    }
}

/// Mean and standard deviation to which every picture is normalised, grey levels. Optical flow
/// assumes that a point keeps its brightness, but the iris changes that of the whole picture.
#[cfg(feature = "opencv")]
const LEVEL: f64 = 110.0;
#[cfg(feature = "opencv")]
const CONTRAST: f64 = 45.0;

/// Normalises the mean and the standard deviation of a picture.
#[cfg(feature = "opencv")]
fn even_out(grey: &mut crate::media::GreyPicture) {
    let count = grey.values.len().max(1) as f64;
    // By the histogram: 256 values instead of every pixel, and a table for the new levels. A
    // picture of one colour has no contrast to stretch, hence the minimum of one grey level.
    let mut numbers = [0_u32; 256];
    for value in &grey.values {
        numbers[usize::from(*value)] += 1;
    }
    let mean = histogram_sum(&numbers, |value| value) / count;
    let variance = histogram_sum(&numbers, |value| (value - mean).powi(2)) / count;
    let scatter = variance.sqrt().max(1.0);
    let levels: [u8; 256] = std::array::from_fn(|value| {
        ((value as f64 - mean) * (CONTRAST / scatter) + LEVEL)
            .round()
            .clamp(0.0, 255.0) as u8
    });
    for value in &mut grey.values {
        *value = levels[usize::from(*value)];
    }
}

/// The sum over all pixels of a function of their grey level; `numbers` counts the pixels of each.
#[cfg(feature = "opencv")]
fn histogram_sum(numbers: &[u32; 256], function: impl Fn(f64) -> f64) -> f64 {
    numbers
        .iter()
        .enumerate()
        .map(|(level, number)| function(level as f64) * f64::from(*number))
        .sum()
}

#[cfg(feature = "opencv")]
fn scale_point(at: ImagePoint, by: f64) -> ImagePoint {
    ImagePoint::new(at.x * by, at.y * by)
}

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
