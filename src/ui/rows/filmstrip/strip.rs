//! The layout of the filmstrip: which cells it has, and where.
//!
//! The layout is computed from a few values of each frame ([`Part`]). They are remembered, and
//! after an edit only those of changed frames are computed again. If none of them differs, the
//! layout stays.

use egui::{Id, Ui};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use touchline_application::app::OpenProject;
use touchline_application::app::session::Filter;
use touchline_documents::document::{Clip, Frame, FrameChanges, Frames};

/// Gap between two frames of a shot, points.
const GAP: f32 = 4.0;
/// Gap before the first frame of a shot, with the shot's name, points.
pub const SHOT_GAP: f32 = 18.0;
/// Minimum number of consecutive frames without an answer that fold into one cell.
const FOLDED: usize = 4;

/// A cell of the strip. Frames are given by their positions in the document.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StripCell {
    Frame(usize),
    /// A run of frames of one shot without an answer from the forest.
    Unanswered {
        /// The first frame.
        first: usize,
        /// The last frame.
        last: usize,
        /// The frame in the middle of those that the filter shows.
        middle: usize,
        /// Their number. Fewer than `last - first + 1` if the filter hides some.
        count: usize,
    },
}

impl StripCell {
    /// The position in the document of its first frame.
    pub const fn first(self) -> usize {
        match self {
            Self::Frame(first) | Self::Unanswered { first, .. } => first,
        }
    }

    /// The position in the document of its last frame.
    const fn last(self) -> usize {
        match self {
            Self::Frame(frame) => frame,
            Self::Unanswered { last, .. } => last,
        }
    }
}

/// The frames that a filter shows, side by side, with a wider gap before each shot.
pub struct Strip {
    /// The cells in order.
    pub cells: Vec<StripCell>,
    /// For each shot, the index of its first cell and its name.
    shots: Vec<(usize, Option<Clip>)>,
    /// Width of a cell, points.
    item: f32,
}

/// What a layout depends on, besides the frames.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LaidOutFor {
    filter: Filter,
    /// The shown frame, if it would be folded otherwise.
    unfolded: Option<usize>,
    item: f32,
}

/// The values of all frames on which the layout depends. The frames of a long video are scattered
/// over the memory, so reading all of them for each frame of the window would be slow.
#[derive(Clone, Debug, Default)]
struct Parts {
    frames: Frames,
    of_frames: Vec<Part>,
    /// A number for each shot.
    clips: BTreeMap<Option<Clip>, usize>,
}

/// The values of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Part {
    is_shown: bool,
    may_fold: bool,
    clip: usize,
}

impl Parts {
    /// The values of all frames.
    fn from_frames(frames: &Frames, filter: Filter) -> Self {
        let mut parts = Self {
            frames: frames.clone(),
            ..Self::default()
        };
        parts.of_frames = frames
            .iter()
            .map(|frame| parts.part_of(frame, filter))
            .collect();
        parts
    }

    /// Computes the values of the frames that have changed. Returns whether a cell may have moved.
    fn follow(&mut self, frames: &Frames, filter: Filter) -> bool {
        let FrameChanges::At(changed) = frames.changes_since(&self.frames) else {
            *self = Self::from_frames(frames, filter);
            return true;
        };
        self.frames = frames.clone();
        // All changed values are stored, also after the first that differs.
        let mut is_other = false;
        for at in changed {
            let part = self.part_of(&frames[at], filter);
            is_other |= std::mem::replace(&mut self.of_frames[at], part) != part;
        }
        is_other
    }

    /// The values of one frame. A new shot gets the next number.
    fn part_of(&mut self, frame: &Frame, filter: Filter) -> Part {
        let clip = self.clips.get(&frame.clip).copied().unwrap_or_else(|| {
            let next = self.clips.len();
            self.clips.insert(frame.clip.clone(), next);
            next
        });
        Part {
            is_shown: filter.shows(frame),
            may_fold: may_fold(filter, frame),
            clip,
        }
    }
}

impl Strip {
    /// The layout as [`Self::new`] computes it. The last one is returned again as long as its cells
    /// stay where they are.
    pub fn get_or_lay_out(
        ui: &Ui,
        open: &OpenProject,
        filter: Filter,
        shown: usize,
        item: f32,
    ) -> Arc<Self> {
        type StripMemory = Option<(LaidOutFor, Parts, Arc<Strip>)>;
        let memory = Id::unique("filmstrip as laid out");
        let frames = &open.document.frames;
        // The layout depends on the shown frame only if that frame would be folded.
        let unfolded = frames
            .get(shown)
            .filter(|frame| may_fold(filter, frame))
            .map(|_| shown);
        let now = LaidOutFor {
            filter,
            unfolded,
            item,
        };
        let known = ui
            .data_mut(|data| data.remove_temp::<StripMemory>(memory))
            .flatten();
        // Values of another filter are of no use: which frames are shown and folded depends on it.
        let known = known.filter(|known| known.0.filter == filter);
        let (parts, kept) = match known {
            Some((before, mut parts, strip)) => {
                let is_other = parts.follow(frames, filter);
                (parts, Some(strip).filter(|_| !is_other && before == now))
            }
            None => (Parts::from_frames(frames, filter), None),
        };
        let strip = kept.unwrap_or_else(|| Arc::new(Self::new(&parts, shown, item)));
        ui.data_mut(|data| {
            data.insert_temp::<StripMemory>(memory, Some((now, parts, Arc::clone(&strip))))
        });
        strip
    }

    /// Lays frames out in cells that are `item` points wide. The `shown` frame is never folded.
    fn new(parts: &Parts, shown: usize, item: f32) -> Self {
        let mut cells: Vec<StripCell> = Vec::new();
        // Number of cells at the end of `cells` that may be folded.
        let mut run = 0;
        let mut shots = Vec::new();
        let mut shot = None;
        for (index, part) in parts
            .of_frames
            .iter()
            .enumerate()
            .filter(|(_, part)| part.is_shown)
        {
            // A new shot ends the run: cells of two shots never fold together.
            if shot.replace(part.clip) != Some(part.clip) {
                fold(&mut cells, std::mem::take(&mut run));
                shots.push((cells.len(), parts.frames[index].clip.clone()));
            }
            if index != shown && part.may_fold {
                run += 1;
            } else {
                fold(&mut cells, std::mem::take(&mut run));
            }
            cells.push(StripCell::Frame(index));
        }
        fold(&mut cells, run);
        Self { cells, shots, item }
    }

    /// Width of the whole strip, points.
    pub fn width(&self) -> f32 {
        self.cells
            .len()
            .checked_sub(1)
            .map_or(0.0, |last| self.left_end(last) + self.item + GAP)
    }

    /// Left end of a cell, points from the strip's start.
    pub fn left_end(&self, at: usize) -> f32 {
        // The number of shots that begin at this cell or before it. Each has a wider gap in front.
        let shot = self.shots.partition_point(|(begin, _)| *begin <= at);
        at as f32 * (self.item + GAP) + shot as f32 * SHOT_GAP
    }

    /// The cell that has a frame of the document.
    pub fn place_of(&self, frame: usize) -> Option<usize> {
        // Cells are in the order of the document: the first that does not end before the frame is
        // the only candidate.
        let at = self.cells.partition_point(|cell| cell.last() < frame);
        let is_there = match *self.cells.get(at)? {
            StripCell::Frame(here) => here == frame,
            StripCell::Unanswered { first, .. } => first <= frame,
        };
        is_there.then_some(at)
    }

    /// The cells between two positions of the strip in points, and one more on each side.
    pub fn within(&self, left: f32, right: f32) -> Range<usize> {
        let count = self.cells.len();
        let first = partition(count, |at| self.left_end(at) + self.item < left);
        let last = partition(count, |at| self.left_end(at) <= right);
        first.saturating_sub(1)..(last + 1).min(count)
    }

    /// The first cell that begins at or after a position of the strip, points.
    pub fn first_from(&self, left: f32) -> usize {
        partition(self.cells.len(), |at| self.left_end(at) < left)
    }

    /// How far a window of `width` points that is scrolled to `offset` must be scrolled to show a
    /// cell and some of its neighbours, points. It moves no farther than necessary.
    pub fn offset_showing(&self, at: usize, offset: f32, width: f32) -> f32 {
        // One and a half neighbours on each side, if they fit.
        let margin = (1.5 * self.item).min((width - self.item) / 2.0).max(0.0);
        let (first, last) = (
            self.left_end(at) - margin,
            self.left_end(at) + self.item + margin,
        );
        // The offset is raised until the right neighbours are in view and then lowered until the
        // left ones are. If the window is too narrow for both, the left end decides.
        let needed = offset.max((last - width).min(first)).min(first);
        needed.clamp(0.0, (self.width() - width).max(0.0))
    }

    /// The name to show before a cell, if a shot begins with it and any frame belongs to a shot.
    pub fn shot_beginning_at(&self, at: usize) -> Option<String> {
        let shot = self
            .shots
            .binary_search_by_key(&at, |(begin, _)| *begin)
            .ok()?;
        let named = self.shots.len() > 1 || self.shots[0].1.is_some();
        named.then(|| {
            self.shots[shot]
                .1
                .as_ref()
                .map_or_else(|| "no shot".to_owned(), |clip| format!("shot {clip}"))
        })
    }
}

/// Whether a frame may be folded: it has no answer, and the filter does not ask for such frames.
fn may_fold(filter: Filter, frame: &Frame) -> bool {
    filter != Filter::Unanswered && frame.is_unanswered()
}

/// Folds the last `run` cells into one, if they are enough.
fn fold(cells: &mut Vec<StripCell>, run: usize) {
    if run < FOLDED {
        return;
    }
    // The cells of the run are still single frames; `new` folds a run before it begins another.
    let begin = cells.len() - run;
    let [first, middle, last] = [0, (run - 1) / 2, run - 1].map(|at| cells[begin + at].last());
    cells.truncate(begin);
    cells.push(StripCell::Unanswered {
        first,
        last,
        middle,
        count: run,
    });
}

/// Number of indices below `count` for which `is_before` is true. It must be true for a prefix of
/// them, as in [`slice::partition_point`].
fn partition(count: usize, is_before: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, count);
    while low < high {
        let middle = usize::midpoint(low, high);
        if is_before(middle) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{FrameStatus, SolutionSource};
    use touchline_documents::testing::{new_frame, soccer_document, solved_by};

    fn open(clips: &[i64]) -> OpenProject {
        let mut document = soccer_document();
        for (index, clip) in clips.iter().enumerate() {
            let mut frame = new_frame("a.jpg", ImageSize::new(64, 36));
            frame.clip = Some(Clip::Number(*clip));
            frame.status = if index % 2 == 0 {
                FrameStatus::New
            } else {
                FrameStatus::Reference
            };
            document.frames.push(frame.into());
        }
        OpenProject::with_document(document)
    }

    fn laid_out(open: &OpenProject, filter: Filter, shown: usize) -> Strip {
        Strip::new(
            &Parts::from_frames(&open.document.frames, filter),
            shown,
            100.0,
        )
    }

    #[test]
    fn shots_stand_apart_and_only_what_is_in_view_is_laid_out() {
        let open = open(&[1, 1, 1, 2, 2, 3]);
        let strip = laid_out(&open, Filter::All, 0);
        assert_eq!(strip.cells, [0, 1, 2, 3, 4, 5].map(StripCell::Frame));
        assert!((strip.left_end(1) - strip.left_end(0) - 104.0).abs() < 1e-3);
        assert!((strip.left_end(3) - strip.left_end(2) - 104.0 - SHOT_GAP).abs() < 1e-3);
        assert_eq!(strip.shot_beginning_at(3).as_deref(), Some("shot 2"));
        assert_eq!(strip.shot_beginning_at(4), None);
        assert_eq!(strip.within(0.0, 90.0), 0..2);
        assert_eq!(strip.within(250.0, 300.0), 1..4);
        assert_eq!(strip.within(1e6, 2e6), 5..6);
    }

    #[test]
    fn the_strip_is_scrolled_no_farther_than_it_takes_to_show_a_frame() {
        let open = open(&[1; 100]);
        let strip = laid_out(&open, Filter::All, 0);
        assert_eq!(strip.offset_showing(1, 0.0, 500.0), 0.0, "it is in view");
        let far = strip.offset_showing(50, 0.0, 500.0);
        assert!(
            (far + 500.0 - (strip.left_end(50) + 250.0)).abs() < 1e-3,
            "two more than the frame on its right"
        );
        assert_eq!(strip.offset_showing(50, far, 500.0), far, "it stays");
        assert!((strip.offset_showing(20, far, 500.0) - (strip.left_end(20) - 150.0)).abs() < 1e-3);
        assert_eq!(
            strip.offset_showing(99, 0.0, 500.0),
            strip.width() - 500.0,
            "no farther than the end"
        );
        assert_eq!(strip.offset_showing(0, far, 500.0), 0.0);
        let narrow = strip.offset_showing(50, 0.0, 40.0);
        assert!(
            narrow <= strip.left_end(50) && strip.left_end(50) < narrow + 100.0,
            "no room for it, but it is what is seen"
        );
    }

    #[test]
    fn a_filter_leaves_frames_out_and_a_lack_of_shots_shows_none() {
        let open = open(&[1, 1, 1, 2]);
        let strip = laid_out(&open, Filter::Status(FrameStatus::Reference), 0);
        assert_eq!(strip.cells, [1, 3].map(StripCell::Frame));
        assert_eq!((strip.place_of(3), strip.place_of(2)), (Some(1), None));
        assert!(
            laid_out(&open, Filter::Status(FrameStatus::Rejected), 0)
                .cells
                .is_empty()
        );
    }

    #[test]
    fn the_strip_is_laid_out_again_only_where_a_cell_moves() {
        let mut open = open(&[1; 10]);
        let references = Filter::Status(FrameStatus::Reference);
        let [mut all, mut some] = [Filter::All, references]
            .map(|filter| Parts::from_frames(&open.document.frames, filter));
        let mut follows = |open: &OpenProject| {
            let (parts, frames) = ([&mut all, &mut some], &open.document.frames);
            let of = |(parts, filter): (&mut Parts, Filter)| {
                let is_other = parts.follow(frames, filter);
                assert_eq!(
                    parts.of_frames,
                    Parts::from_frames(frames, filter).of_frames
                );
                is_other
            };
            parts
                .into_iter()
                .zip([Filter::All, references])
                .map(of)
                .collect::<Vec<_>>()
        };
        open.document.frames[4].status = FrameStatus::Reference;
        assert_eq!(
            follows(&open),
            [false, true],
            "every frame is shown whatever its status"
        );
        open.document.frames[4].gold = true;
        assert_eq!(follows(&open), [false, false]);
        open.document.frames[4].clip = Some(Clip::Number(2));
        assert_eq!(follows(&open), [true, true], "another shot begins");
        open.document.frames.pop();
        assert_eq!(follows(&open), [true, true]);
    }

    #[test]
    fn frames_without_an_answer_fold_within_their_shot_but_not_the_shown_one() {
        let mut open = open(&[1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2]);
        for index in 1..11 {
            let frame = &mut open.document.frames[index];
            frame.status = FrameStatus::New;
            frame.solution = solved_by(SolutionSource::Forest);
        }
        let fold = |first: usize, last| StripCell::Unanswered {
            first,
            last,
            middle: first.midpoint(last),
            count: last - first + 1,
        };
        let strip = laid_out(&open, Filter::All, 0);
        assert_eq!(strip.cells, [StripCell::Frame(0), fold(1, 5), fold(6, 10)]);
        assert_eq!(
            [0, 1, 5, 6, 10, 11].map(|frame| strip.place_of(frame)),
            [0, 1, 1, 2, 2, 9].map(|at| (at < 9).then_some(at))
        );
        assert_eq!(strip.shot_beginning_at(2).as_deref(), Some("shot 2"));
        let shown = laid_out(&open, Filter::All, 6);
        assert_eq!(
            shown.cells,
            [
                StripCell::Frame(0),
                fold(1, 5),
                StripCell::Frame(6),
                fold(7, 10)
            ]
        );
        let middle = laid_out(&open, Filter::All, 3);
        assert_eq!(middle.cells.len(), 7, "two and two are too few to fold");
        assert_eq!(laid_out(&open, Filter::Unanswered, 0).cells.len(), 10);
        open.document.frames[3].status = FrameStatus::Reference;
        let around_a_hidden_one = StripCell::Unanswered {
            first: 1,
            last: 5,
            middle: 2,
            count: 4,
        };
        let to_do = laid_out(&open, Filter::ToDo, 0);
        assert_eq!(to_do.cells[1], around_a_hidden_one);
    }
}
