//! Which frames stand where in the strip.

use crate::app::OpenProject;
use crate::app::session::Filter;
use crate::project::Clip;
use std::ops::Range;

/// Between two frames of a shot, points.
const GAP: f32 = 4.0;
/// Before the first frame of a shot, points; its name stands there.
pub const SHOT_GAP: f32 = 18.0;

/// The frames that a filter shows, side by side, with a wider gap before each shot.
pub struct Strip<'a> {
    /// Places in the document.
    pub frames: Vec<usize>,
    /// Where each shot begins, within `frames`, and its name.
    shots: Vec<(usize, Option<&'a Clip>)>,
    item: f32,
}

impl<'a> Strip<'a> {
    /// Lays the frames of a document out, `item` points wide each.
    pub fn new(open: &'a OpenProject, filter: Filter, item: f32) -> Self {
        let mut frames = Vec::new();
        let mut shots: Vec<(usize, Option<&Clip>)> = Vec::new();
        for (index, frame) in open.document.frames.iter().enumerate() {
            if filter.shows(frame) {
                let clip = frame.clip.as_ref();
                if shots.last().is_none_or(|(_, last)| *last != clip) {
                    shots.push((frames.len(), clip));
                }
                frames.push(index);
            }
        }
        Self { frames, shots, item }
    }

    /// The width of the whole strip, points.
    pub fn width(&self) -> f32 {
        self.frames.len().checked_sub(1).map_or(0.0, |last| self.left(last) + self.item + GAP)
    }

    /// Where a frame begins, points from the strip's start.
    pub fn left(&self, at: usize) -> f32 {
        let shot = self.shots.partition_point(|(begin, _)| *begin <= at);
        at as f32 * (self.item + GAP) + shot as f32 * SHOT_GAP
    }

    /// Where a frame of the document stands.
    pub fn place_of(&self, frame: usize) -> Option<usize> {
        self.frames.binary_search(&frame).ok()
    }

    /// The frames between two places, points, and one more on each side.
    pub fn within(&self, left: f32, right: f32) -> Range<usize> {
        let count = self.frames.len();
        let first = partition(count, |at| self.left(at) + self.item < left);
        let last = partition(count, |at| self.left(at) <= right);
        first.saturating_sub(1)..(last + 1).min(count)
    }

    /// What stands before the first frame of a shot; none within a shot, and none if nothing belongs to a shot.
    pub fn shot_beginning_at(&self, at: usize) -> Option<String> {
        let shot = self.shots.binary_search_by_key(&at, |(begin, _)| *begin).ok()?;
        let named = self.shots.len() > 1 || self.shots[0].1.is_some();
        named.then(|| self.shots[shot].1.map_or_else(|| "no shot".to_owned(), |clip| format!("shot {clip}")))
    }
}

/// How many of the first `count` numbers `is_before` holds for; it holds for a beginning of them.
fn partition(count: usize, is_before: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, count);
    while low < high {
        let middle = usize::midpoint(low, high);
        if is_before(middle) { low = middle + 1 } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Opened;
    use crate::geometry::ImageSize;
    use crate::project::{Document, FieldSpec, Frame, FrameStatus};

    fn open(clips: &[i64]) -> OpenProject {
        let mut document = Document::new(FieldSpec::new("soccer"));
        for (index, clip) in clips.iter().enumerate() {
            let mut frame = Frame::from_image("a.jpg", "main".into(), ImageSize::new(64, 36));
            frame.clip = Some(Clip::Number(*clip));
            frame.status = if index % 2 == 0 { FrameStatus::New } else { FrameStatus::Reference };
            document.frames.push(frame.into());
        }
        OpenProject::new(Opened::new(document, "/match/project.json"))
    }

    #[test]
    fn shots_stand_apart_and_only_what_is_in_view_is_laid_out() {
        let open = open(&[1, 1, 1, 2, 2, 3]);
        let strip = Strip::new(&open, Filter::All, 100.0);
        assert_eq!(strip.frames, [0, 1, 2, 3, 4, 5]);
        assert!((strip.left(1) - strip.left(0) - 104.0).abs() < 1e-3);
        assert!((strip.left(3) - strip.left(2) - 104.0 - SHOT_GAP).abs() < 1e-3);
        assert_eq!(strip.shot_beginning_at(3).as_deref(), Some("shot 2"));
        assert_eq!(strip.shot_beginning_at(4), None);
        assert_eq!(strip.within(0.0, 90.0), 0..2);
        assert_eq!(strip.within(250.0, 300.0), 1..4);
        assert_eq!(strip.within(1e6, 2e6), 5..6);
    }

    #[test]
    fn a_filter_leaves_frames_out_and_a_lack_of_shots_shows_none() {
        let open = open(&[1, 1, 1, 2]);
        let strip = Strip::new(&open, Filter::Status(FrameStatus::Reference), 100.0);
        assert_eq!(strip.frames, [1, 3]);
        assert_eq!((strip.place_of(3), strip.place_of(2)), (Some(1), None));
        assert!(Strip::new(&open, Filter::Status(FrameStatus::Rejected), 100.0).frames.is_empty());
    }
}
