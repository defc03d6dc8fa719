//! Frames of one camera, matched pairwise.

use super::error::Stop;
use super::joint::FramePaint;
use super::search::Panorama;
use super::traces::FrameTraces;
use super::{Abstention, UnclickedError, UnclickedProgress, WatchUnclicked};
use std::sync::Arc;
use touchline_core::geometry::{ImageSize, Vec3};
use touchline_vision::features::Features;
use touchline_vision::paint::{PersistentPoint, SeenGround, Strokes, persistent_paint};
use touchline_vision::track::{Tie, TrackError, TurnOptions, Turns, adjust_turns, groups, tie_frames};

/// The largest group of frames that pairwise matches connect, numbered within the group.
pub(super) struct MatchedFrames {
    /// Their indices among the sampled frames.
    pub indices: Vec<usize>,
    /// Of their pictures.
    pub size: ImageSize,
    pub matches: Arc<Vec<Tie>>,
    pub strokes: Vec<Strokes>,
}

/// The paint of frames turned in some way.
pub(super) struct GatheredPaint {
    pub panorama: Panorama,
    /// The paint that stays, of each frame.
    pub of_frames: Vec<FramePaint>,
}

impl MatchedFrames {
    /// Of frames that were looked at.
    ///
    /// # Errors
    /// Too few hang together, the search was stopped, or OpenCV is missing or refused.
    pub fn from_traces(frames: &[FrameTraces], watch: WatchUnclicked<'_>) -> Result<Self, Stop> {
        let features: Vec<Features> = frames.iter().map(|frame| frame.features.clone()).collect();
        let pairs = frames.len() * frames.len().saturating_sub(1) / 2;
        let ties = tie_frames(&features, &|done, of| watch(UnclickedProgress::Tying { done, of }))
            .map_err(UnclickedError::Track)?;
        if watch(UnclickedProgress::Tying { done: pairs, of: pairs }).is_break() {
            return Err(UnclickedError::Stopped.into());
        }
        let group = largest_group(frames, &ties)?;
        let size = frames[group[0]].size();
        let place = |frame: usize| group.binary_search(&frame).ok();
        let inside = |tie: &Tie| Some(Tie { first: place(tie.first)?, second: place(tie.second)?, ..tie.clone() });
        let strokes = group.iter().map(|frame| frames[*frame].strokes.clone()).collect();
        let ties = Arc::new(ties.iter().filter_map(inside).collect());
        Ok(Self { indices: group, size, matches: ties, strokes })
    }

    /// How the frames are turned, with focal lengths of so many per cent of what the ties say.
    pub fn relative_rotations(&self, focal_percent: u32) -> Result<Turns, TrackError> {
        let options = TurnOptions { focal_scale: f64::from(focal_percent) / 100.0, ..TurnOptions::default() };
        adjust_turns(self.indices.len(), &self.matches, self.size, &options)
    }

    /// The paint of the frames turned as stated.
    pub fn gather_paint(&self, turns: &Turns) -> Result<GatheredPaint, Abstention> {
        /// Directions of paint without which nothing can be found.
        const LEAST: usize = 150;
        let frames: Vec<_> =
            self.strokes.iter().enumerate().map(|(frame, strokes)| (turns.camera(frame), strokes.clone())).collect();
        let points = persistent_paint(&frames);
        let directions: Vec<Vec3> = points.iter().map(|point| point.direction).collect();
        let panorama = Panorama::of(&directions, SeenGround::of(&frames));
        if panorama.directions.len() < LEAST {
            return Err(Abstention::LittlePaint { places: panorama.directions.len() });
        }
        Ok(GatheredPaint { panorama, of_frames: paint_of_frames(&points, self.strokes.len()) })
    }
}

/// The largest group of frames of one size that hang together.
fn largest_group(frames: &[FrameTraces], ties: &[Tie]) -> Result<Vec<usize>, Abstention> {
    /// Fewer frames hardly show what is drawn on the ground and what is not.
    const LEAST: usize = 3;
    let same_size: Vec<Tie> =
        ties.iter().filter(|tie| frames[tie.first].size() == frames[tie.second].size()).cloned().collect();
    let group = groups(frames.len(), &same_size).into_iter().next().unwrap_or_default();
    if group.len() < LEAST {
        return Err(Abstention::NotTied { frames: frames.len(), tied: group.len() });
    }
    Ok(group)
}

fn paint_of_frames(points: &[PersistentPoint], frames: usize) -> Vec<FramePaint> {
    let mut paint = vec![FramePaint::new(); frames];
    for point in points {
        paint[point.frame].push(point.stroke.at);
    }
    paint
}
