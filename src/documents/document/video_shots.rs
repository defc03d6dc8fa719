//! The shots of one video: found or marked, changed cut by cut, written into the document.
//!
//! A document stores the shots twice: `shots` has the cuts and how they were found, and each
//! frame's `clip` has the shot that it belongs to. [`VideoShots::write`] keeps both consistent.

use super::{Clip, Document, Extra, Frame, Shot, ShotEnd, ShotKind};
use std::collections::BTreeMap;
use thiserror::Error;

/// The shots of one video in order, without gaps between the first frame and the last.
#[derive(Clone, Debug, PartialEq)]
pub struct VideoShots {
    video: String,
    starts: Vec<Start>,
    last: u64,
}

/// A shot and its first frame.
#[derive(Clone, Debug, PartialEq)]
struct Start {
    from: u64,
    shot: Shot,
    /// The `clip` of its frames.
    clip: Clip,
}

/// The cuts that a search found in a video.
#[derive(Clone, Copy, Debug)]
pub struct FoundCuts<'a> {
    /// The index of the video's last frame.
    pub last: u64,
    /// The first frame of every shot but the first, and how it was found.
    pub cuts: &'a [(u64, ShotKind)],
    /// The first frames of the shots that the document had when the search began.
    pub known: &'a [u64],
}

/// A fade is at most this long, frames: a second at 25 Hz.
const FADE_FRAMES: u64 = 25;

/// Why a cut cannot be changed as wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ShotsError {
    /// The frame begins a shot already.
    #[error("a shot begins at frame {frame} already")]
    IsCut {
        /// The frame.
        frame: u64,
    },
    /// No shot begins there, or the first one does.
    #[error("no cut is before frame {frame}")]
    NoCut {
        /// The frame.
        frame: u64,
    },
    /// A cut cannot pass another one or leave the video.
    #[error(
        "the cut before frame {cut} lies between frames {from} and {to} and cannot be moved to {frame}"
    )]
    BeyondNeighbours {
        /// The first frame of its shot.
        cut: u64,
        /// The frame to which it was to be moved.
        frame: u64,
        /// The first frame that it can go to.
        from: u64,
        /// The last.
        to: u64,
    },
}

impl VideoShots {
    /// The shots of a video as a search found them: `cuts` has the first frame of every shot but
    /// the first, and how it was found; `last` is the video's last frame.
    pub fn from_cuts(
        document: &Document,
        video: &str,
        last: u64,
        cuts: &[(u64, ShotKind)],
    ) -> Self {
        // In order and each frame once, as a hard cut if it was found as that, too: two shots that
        // begin at one frame would leave the first one without frames.
        let mut inside: Vec<(u64, ShotKind)> = cuts
            .iter()
            .copied()
            .filter(|(from, _)| (1..=last).contains(from))
            .collect();
        inside.sort_unstable();
        inside.dedup_by_key(|(from, _)| *from);
        // One search for a free number, because it visits all frames of the document.
        let free = free_number(document, &[]);
        let starts = std::iter::once((0, ShotKind::Cut)).chain(inside);
        let starts = starts.enumerate().map(|(index, (from, kind))| Start {
            from,
            shot: shot(kind),
            clip: Clip::Number(free.saturating_add(index as i64)),
        });
        Self {
            video: video.to_owned(),
            starts: starts.collect(),
            last,
        }
    }

    /// The shots of a video as a search found them, with what people have marked in the document
    /// that it is written to: their cuts stay, and a cut of `known`, those of the time when the
    /// search began, that they have removed or moved since does not come back.
    pub fn from_search(document: &Document, video: &str, found: FoundCuts<'_>) -> Self {
        let marked = Self::from_document(document, video);
        let marked_starts = marked.as_ref().map_or(&[][..], |marked| &marked.starts);
        let is_start = |from: u64| marked_starts.iter().any(|start| start.from == from);
        let mut by_hand: Vec<u64> = marked_starts
            .iter()
            .filter(|start| start.shot.kind == ShotKind::ByHand)
            .map(|start| start.from)
            .collect();
        by_hand.sort_unstable();
        // A fade has no exact frame: the one that a person chose within it stands for it, or for
        // the end of the transition that it is in.
        let is_marked = |from: u64, kind: ShotKind| {
            let within = match kind {
                ShotKind::Fade | ShotKind::Transition => FADE_FRAMES,
                ShotKind::Cut | ShotKind::ByHand => 0,
            };
            by_hand.iter().any(|cut| cut.abs_diff(from) <= within)
        };
        let is_removed = |from: u64| found.known.contains(&from) && !is_start(from);
        let kept = found.cuts.iter().copied();
        let cuts: Vec<(u64, ShotKind)> = kept
            .filter(|(from, kind)| !is_marked(*from, *kind) && !is_removed(*from))
            .chain(by_hand.iter().map(|from| (*from, ShotKind::ByHand)))
            .collect();
        let last = marked
            .as_ref()
            .map_or(found.last, |marked| found.last.max(marked.last));
        let mut shots = Self::from_cuts(document, video, last, &cuts);
        // A shot that begins where one of the document does is that shot; any other is a part of
        // one, filmed by the same camera.
        for start in &mut shots.starts {
            let around = marked_starts.partition_point(|marked| marked.from <= start.from);
            let Some(marked) = around.checked_sub(1).map(|at| &marked_starts[at]) else {
                continue;
            };
            if marked.from == start.from {
                let kind = start.shot.kind;
                *start = marked.clone();
                if start.shot.kind != ShotKind::ByHand {
                    start.shot.kind = kind;
                }
            } else {
                start.shot.camera.clone_from(&marked.shot.camera);
            }
        }
        shots
    }

    /// The shots of a video that a document has; none where it has none.
    pub fn from_document(document: &Document, video: &str) -> Option<Self> {
        let numbers = numbers(document, video);
        let mut last = numbers.last()?.0;
        let mut starts: Vec<Start> = Vec::new();
        for shot in &document.shots {
            let (Some(from), Some(to)) = (
                end(document, &shot.from, video),
                end(document, &shot.to, video),
            ) else {
                continue;
            };
            // The shot's name is that of its first frame in the document. A document of some frames
            // may have none of a shot; `write` gives such shots names.
            let first = numbers.get(first_from(from, &numbers));
            let first = first.filter(|(number, _)| *number <= to);
            let clip = first.and_then(|(_, position)| document.frames[*position].clip.clone());
            last = last.max(to);
            starts.push(Start {
                from,
                shot: shot.clone(),
                clip: clip.unwrap_or(Clip::Number(0)),
            });
        }
        starts.sort_by_key(|start| start.from);
        starts.dedup_by_key(|start| start.from);
        (!starts.is_empty()).then(|| Self {
            video: video.to_owned(),
            starts,
            last,
        })
    }

    /// The first frame of every shot, and how it was found.
    pub fn starts(&self) -> impl ExactSizeIterator<Item = (u64, ShotKind)> {
        self.starts
            .iter()
            .map(|start| (start.from, start.shot.kind))
    }

    /// The first frame of the shot that a frame belongs to.
    pub fn start_of(&self, frame: u64) -> u64 {
        self.starts
            .iter()
            .rev()
            .map(|start| start.from)
            .find(|from| *from <= frame)
            .unwrap_or(0)
    }

    /// Begins a new shot at a frame; the shot that contained the frame ends before it.
    ///
    /// # Errors
    /// One begins there already.
    pub fn add(&mut self, document: &Document, frame: u64) -> Result<(), ShotsError> {
        let at = self.starts.partition_point(|start| start.from < frame);
        if frame == 0 || self.starts.get(at).is_some_and(|start| start.from == frame) {
            return Err(ShotsError::IsCut { frame });
        }
        let clip = self.free_clip(document);
        // The new shot is the end of the one that is divided, so its camera is the same.
        let mut new = shot(ShotKind::ByHand);
        new.camera = at
            .checked_sub(1)
            .and_then(|before| self.starts[before].shot.camera.clone());
        self.starts.insert(
            at,
            Start {
                from: frame,
                shot: new,
                clip,
            },
        );
        Ok(())
    }

    /// Joins the shot that begins at a frame with the one before it. A transition between the two
    /// goes as well, because nothing would end it.
    ///
    /// # Errors
    /// None begins there, or it is the first one.
    pub fn remove(&mut self, frame: u64) -> Result<(), ShotsError> {
        let at = self.cut_at(frame)?;
        self.starts.remove(at);
        if self.starts[at - 1].shot.kind == ShotKind::Transition && at > 1 {
            self.starts.remove(at - 1);
        }
        Ok(())
    }

    /// Moves the first frame of a shot to another one, on the user's request.
    ///
    /// # Errors
    /// None begins there, or another one begins before the frame wanted or after it.
    pub fn move_cut(&mut self, cut: u64, frame: u64) -> Result<(), ShotsError> {
        // `cut_at` never returns the first shot, so there is one before.
        let at = self.cut_at(cut)?;
        let from = self.starts[at - 1].from + 1;
        let to = self
            .starts
            .get(at + 1)
            .map_or(self.last, |next| next.from - 1);
        if !(from..=to).contains(&frame) {
            return Err(ShotsError::BeyondNeighbours {
                cut,
                frame,
                from,
                to,
            });
        }
        if frame != cut {
            self.starts[at].from = frame;
            // The beginning of a transition that was moved is still that of a transition.
            if self.starts[at].shot.kind != ShotKind::Transition {
                self.starts[at].shot.kind = ShotKind::ByHand;
            }
        }
        Ok(())
    }

    fn cut_at(&self, frame: u64) -> Result<usize, ShotsError> {
        let at = self.starts.iter().position(|start| start.from == frame);
        at.filter(|at| *at > 0).ok_or(ShotsError::NoCut { frame })
    }

    /// A clip that no shot uses.
    fn free_clip(&self, document: &Document) -> Clip {
        Clip::Number(free_number(document, &self.starts))
    }

    /// Replaces the document's shots of this video, and stores each frame's shot in the frame.
    pub fn write(mut self, document: &mut Document) {
        // `from_document` gives one and the same name to all shots of which it finds no frame. Each
        // gets its own here, because a name stands for one shot.
        for at in 0..self.starts.len() {
            if self.starts[..at]
                .iter()
                .any(|before| before.clip == self.starts[at].clip)
            {
                self.starts[at].clip = self.free_clip(document);
            }
        }
        // A plain number means a frame of the document's first video. With several videos, ends are
        // the ids of frames, and a shot without frames cannot be stated.
        let is_only_video = document.frames.iter().all(|frame| {
            frame
                .video
                .as_ref()
                .is_none_or(|video| video.path == self.video)
        });
        let of_others: Vec<Shot> = document
            .shots
            .iter()
            .filter(|shot| end(document, &shot.from, &self.video).is_none())
            .cloned()
            .collect();
        let numbers = numbers(document, &self.video);
        let mut shots = Vec::new();
        for (at, start) in self.starts.iter().enumerate() {
            let to = self
                .starts
                .get(at + 1)
                .map_or(self.last, |next| next.from - 1);
            // Starts ascend and `last` is no less than any, so `begin <= behind`.
            let begin = first_from(start.from, &numbers);
            let behind = first_from(to.saturating_add(1), &numbers);
            let inside = &numbers[begin..behind];
            let ends = if is_only_video {
                Some((ShotEnd::VideoFrame(start.from), ShotEnd::VideoFrame(to)))
            } else {
                let ends = inside.first().zip(inside.last());
                ends.map(|((_, from), (_, to))| {
                    (frame_end(document, *from), frame_end(document, *to))
                })
            };
            shots.extend(ends.map(|(from, to)| Shot {
                from,
                to,
                ..start.shot.clone()
            }));
            for &(_, position) in inside {
                if document.frames[position].clip.as_ref() != Some(&start.clip) {
                    document.frames[position].clip = Some(start.clip.clone());
                }
            }
        }
        document.shots = of_others.into_iter().chain(shots).collect();
    }
}

/// Whether each frame of a document lies in a transition between two shots; such frames show two
/// pictures or none, and get no camera.
pub fn frames_in_transitions(document: &Document) -> Vec<bool> {
    let mut inside = vec![false; document.frames.len()];
    for (place, shot) in shots_of_frames(document).into_iter().enumerate() {
        inside[place] = shot.is_some_and(|shot| document.shots[shot].kind == ShotKind::Transition);
    }
    inside
}

/// For each frame of a document, the index of the shot that the document lists it in.
pub fn shots_of_frames(document: &Document) -> Vec<Option<usize>> {
    // The shots of each video, by their first frames.
    let mut of_video: BTreeMap<&str, Vec<(u64, u64, usize)>> = BTreeMap::new();
    for (index, shot) in document.shots.iter().enumerate() {
        let video = match &shot.from {
            ShotEnd::VideoFrame(_) => document.frames.first_video(),
            ShotEnd::Frame(id) => document
                .frames
                .by_id(id)
                .and_then(|frame| frame.video_path()),
        };
        let Some(video) = video else { continue };
        let ends = end(document, &shot.from, video).zip(end(document, &shot.to, video));
        if let Some((from, to)) = ends {
            of_video.entry(video).or_default().push((from, to, index));
        }
    }
    for shots in of_video.values_mut() {
        shots.sort_unstable();
    }
    let shot_of = |frame: &Frame| {
        let video = frame.video.as_ref()?;
        let shots = of_video.get(video.path.as_str())?;
        let behind = shots.partition_point(|(from, ..)| *from <= video.frame_index);
        let (_, to, index) = shots[behind.checked_sub(1)?];
        (video.frame_index <= to).then_some(index)
    };
    document.frames.iter().map(|frame| shot_of(frame)).collect()
}

/// The number after all clip numbers of a document's frames and of these shots.
fn free_number(document: &Document, starts: &[Start]) -> i64 {
    let of_frames = document
        .frames
        .iter()
        .filter_map(|frame| frame.clip.as_ref());
    let most = of_frames
        .chain(starts.iter().map(|start| &start.clip))
        .filter_map(|clip| match clip {
            Clip::Number(number) => Some(*number),
            Clip::Name(_) => None,
        })
        .max();
    most.unwrap_or(0).saturating_add(1)
}

/// A shot whose ends are not known yet.
fn shot(kind: ShotKind) -> Shot {
    Shot {
        from: ShotEnd::VideoFrame(0),
        to: ShotEnd::VideoFrame(0),
        camera: None,
        kind,
        content: None,
        extra: Extra::new(),
    }
}

/// The number of a frame in a video; none if it belongs to another video or to none.
fn number(frame: &Frame, video: &str) -> Option<u64> {
    frame
        .video
        .as_ref()
        .filter(|of| of.path == video)
        .map(|of| of.frame_index)
}

/// The numbers of a document's frames in a video, with the frames' positions, in the order of the
/// video.
fn numbers(document: &Document, video: &str) -> Vec<(u64, usize)> {
    let numbered = document.frames.iter().enumerate();
    let mut numbers: Vec<(u64, usize)> = numbered
        .filter_map(|(position, frame)| Some((number(frame, video)?, position)))
        .collect();
    numbers.sort_unstable();
    numbers
}

/// A frame of a document as the end of a shot.
fn frame_end(document: &Document, position: usize) -> ShotEnd {
    ShotEnd::Frame(document.frames[position].id.clone())
}

/// The index of the first frame with at least this number in the video.
fn first_from(number: u64, numbers: &[(u64, usize)]) -> usize {
    numbers.partition_point(|(known, _)| *known < number)
}

/// The number of a shot's end in a video; none if it belongs to another video. A plain number
/// refers to the first video.
fn end(document: &Document, end: &ShotEnd, video: &str) -> Option<u64> {
    match end {
        ShotEnd::VideoFrame(frame) => (document.frames.first_video()? == video).then_some(*frame),
        ShotEnd::Frame(id) => number(document.frames.by_id(id)?, video),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::VideoFrame;
    use crate::testing::soccer_document;
    use touchline_core::geometry::ImageSize;

    /// Every `step`-th of the first 12 frames of each video.
    fn document(videos: &[&str], step: usize) -> Document {
        let mut document = soccer_document();
        for video in videos {
            for index in (0..12).step_by(step) {
                let video = VideoFrame::new(video, index, None);
                document
                    .frames
                    .push(Frame::from_video(video, "main".into(), ImageSize::new(64, 36)).into());
            }
        }
        document
    }

    fn clips(document: &Document) -> Vec<String> {
        document
            .frames
            .iter()
            .map(|frame| {
                frame
                    .clip
                    .as_ref()
                    .map_or_else(String::new, ToString::to_string)
            })
            .collect()
    }

    fn spans(document: &Document) -> Vec<(u64, u64, ShotKind)> {
        let number = |end: &ShotEnd| {
            if let ShotEnd::VideoFrame(number) = end {
                *number
            } else {
                panic!("an id")
            }
        };
        document
            .shots
            .iter()
            .map(|shot| (number(&shot.from), number(&shot.to), shot.kind))
            .collect()
    }

    #[test]
    fn cuts_are_found_added_moved_and_removed() {
        let mut document = document(&["a.mp4"], 1);
        VideoShots::from_cuts(
            &document,
            "a.mp4",
            11,
            &[(4, ShotKind::Cut), (8, ShotKind::Fade)],
        )
        .write(&mut document);
        let found = [
            (0, 3, ShotKind::Cut),
            (4, 7, ShotKind::Cut),
            (8, 11, ShotKind::Fade),
        ];
        assert_eq!(spans(&document), found);
        assert_eq!(clips(&document).concat(), "111122223333");

        let mut shots = VideoShots::from_document(&document, "a.mp4").unwrap();
        assert_eq!(
            (shots.start_of(3), shots.start_of(4), shots.start_of(11)),
            (0, 4, 8)
        );
        assert_eq!(shots.add(&document, 4), Err(ShotsError::IsCut { frame: 4 }));
        assert_eq!(shots.remove(0), Err(ShotsError::NoCut { frame: 0 }));
        assert_eq!(shots.remove(5), Err(ShotsError::NoCut { frame: 5 }));
        assert_eq!(
            shots.move_cut(4, 8),
            Err(ShotsError::BeyondNeighbours {
                cut: 4,
                frame: 8,
                from: 1,
                to: 7
            })
        );
        shots.move_cut(8, 10).unwrap();
        shots.add(&document, 6).unwrap();
        shots.write(&mut document);
        assert_eq!(clips(&document).concat(), "111122444433");
        let by_hand = [(6, 9, ShotKind::ByHand), (10, 11, ShotKind::ByHand)];
        assert_eq!(spans(&document)[2..], by_hand);

        let mut shots = VideoShots::from_document(&document, "a.mp4").unwrap();
        shots.remove(6).unwrap();
        shots.write(&mut document);
        assert_eq!(clips(&document).concat(), "111122222233");
    }

    #[test]
    fn what_people_marked_stays_when_a_search_ends() {
        let found = |known| FoundCuts {
            last: 11,
            cuts: &[(4, ShotKind::Cut), (8, ShotKind::Cut)],
            known,
        };
        let mut document = document(&["a.mp4"], 1);
        VideoShots::from_search(&document, "a.mp4", found(&[])).write(&mut document);
        assert_eq!(clips(&document).concat(), "111122223333");
        // Another search began; meanwhile one cut is added, one removed, one moved.
        let mut shots = VideoShots::from_document(&document, "a.mp4").unwrap();
        shots.add(&document, 2).unwrap();
        shots.starts[1].shot.camera = Some("side".into());
        shots.remove(4).unwrap();
        shots.move_cut(8, 9).unwrap();
        shots.write(&mut document);
        let by_people = (spans(&document), clips(&document));
        VideoShots::from_search(&document, "a.mp4", found(&[0, 4, 8])).write(&mut document);
        assert_eq!((spans(&document), clips(&document)), by_people);
        // A search that began after that finds what was removed before; it keeps what was added.
        VideoShots::from_search(&document, "a.mp4", found(&[0, 2, 9])).write(&mut document);
        let starts: Vec<_> = spans(&document).iter().map(|span| span.0).collect();
        assert_eq!(starts, [0, 2, 4, 8, 9]);
        assert_eq!(document.shots[2].camera, Some("side".into()));
        assert_eq!(clips(&document).concat().len(), 12, "each frame has a shot");
    }

    #[test]
    fn the_frame_that_a_person_chose_stands_for_a_fade() {
        let mut document = document(&["a.mp4"], 1);
        let mut shots = VideoShots::from_cuts(&document, "a.mp4", 11, &[]);
        shots.add(&document, 7).unwrap();
        shots.write(&mut document);
        let found = FoundCuts {
            last: 11,
            cuts: &[(6, ShotKind::Cut), (8, ShotKind::Fade)],
            known: &[],
        };
        VideoShots::from_search(&document, "a.mp4", found).write(&mut document);
        let starts: Vec<_> = spans(&document).iter().map(|span| span.0).collect();
        assert_eq!(starts, [0, 6, 7]);
    }

    #[test]
    fn a_transition_has_its_frames_and_goes_with_its_cut() {
        let mut document = document(&["a.mp4"], 1);
        let cuts = [(3, ShotKind::Transition), (6, ShotKind::Fade)];
        VideoShots::from_cuts(&document, "a.mp4", 11, &cuts).write(&mut document);
        let found = [
            (0, 2, ShotKind::Cut),
            (3, 5, ShotKind::Transition),
            (6, 11, ShotKind::Fade),
        ];
        assert_eq!(spans(&document), found);
        let inside: Vec<usize> = (0..12)
            .filter(|at| frames_in_transitions(&document)[*at])
            .collect();
        assert_eq!(inside, [3, 4, 5]);
        let mut shots = VideoShots::from_document(&document, "a.mp4").unwrap();
        shots.move_cut(3, 4).unwrap();
        shots.write(&mut document);
        assert_eq!(spans(&document)[1], (4, 5, ShotKind::Transition));
        // Without the cut at its end, nothing would end the transition.
        let mut shots = VideoShots::from_document(&document, "a.mp4").unwrap();
        shots.remove(6).unwrap();
        shots.write(&mut document);
        assert_eq!(spans(&document), [(0, 11, ShotKind::Cut)]);
        assert!(!frames_in_transitions(&document).contains(&true));
    }

    #[test]
    fn a_document_of_some_frames_keeps_the_numbers_of_the_video() {
        let mut document = document(&["a.mp4"], 5);
        VideoShots::from_cuts(
            &document,
            "a.mp4",
            11,
            &[(7, ShotKind::Fade), (3, ShotKind::Cut), (7, ShotKind::Cut)],
        )
        .write(&mut document);
        assert_eq!(
            spans(&document),
            [
                (0, 2, ShotKind::Cut),
                (3, 6, ShotKind::Cut),
                (7, 11, ShotKind::Cut)
            ]
        );
        assert_eq!(clips(&document).concat(), "123");
        assert_eq!(
            VideoShots::from_document(&document, "a.mp4")
                .unwrap()
                .starts()
                .map(|(from, _)| from)
                .collect::<Vec<_>>(),
            [0, 3, 7]
        );
    }

    #[test]
    fn shots_of_two_videos_are_distinguished() {
        let mut document = document(&["a.mp4", "b.mp4"], 4);
        VideoShots::from_cuts(&document, "a.mp4", 11, &[(8, ShotKind::Cut)]).write(&mut document);
        VideoShots::from_cuts(&document, "b.mp4", 11, &[(4, ShotKind::Cut)]).write(&mut document);
        assert_eq!(clips(&document).concat(), "112344");
        let starts = |video| {
            VideoShots::from_document(&document, video)
                .unwrap()
                .starts()
                .map(|(from, _)| from)
                .collect::<Vec<_>>()
        };
        assert_eq!((starts("a.mp4"), starts("b.mp4")), (vec![0, 8], vec![0, 4]));
        assert_eq!(VideoShots::from_document(&document, "c.mp4"), None);
    }
}
