//! The frames of a document on one line, as plain data: progress, suggestions and their doubt,
//! shots.

use touchline_core::markings::LineVerdict;
use touchline_documents::document::{
    Document, Frame, FrameChanges, FrameStatus, Frames, Shot, ShotKind, VideoShots,
};

/// The frames of a document, divided into as many parts of equal length as the screen has room for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timeline {
    /// Number of frames.
    pub frames: usize,
    /// The parts, in the order of the frames.
    pub parts: Vec<TimelinePart>,
    /// The first frames of shots, in order, except for the first shot of the video.
    pub cuts: Vec<TimelineCut>,
}

/// The state of a document of which a timeline was made.
#[derive(Clone, Debug)]
pub struct TimelineSource {
    frames: Frames,
    shots: Vec<Shot>,
}

impl TimelineSource {
    /// The state of a document. Frames are shared, not copied.
    pub fn from_document(document: &Document) -> Self {
        Self {
            frames: document.frames.clone(),
            shots: document.shots.clone(),
        }
    }
}

/// Summary of the frames of one part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TimelinePart {
    /// Number of frames.
    pub frames: u32,
    /// Number of references.
    pub references: u32,
    /// Number of suggestions.
    pub suggestions: u32,
    /// Number of frames that have clicks and are not accepted.
    pub drafts: u32,
    /// Number of frames that cannot be calibrated.
    pub rejected: u32,
    /// The least favourable verdict of the paint on a suggestion among them, where one is recorded.
    pub paint: Option<LineVerdict>,
    /// Greatest doubt about one of them, 0 to 1: for a suggestion 1 − confidence; 1 for a frame
    /// without an answer.
    pub doubt: f64,
}

/// The first frame of a shot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimelineCut {
    /// Index of the frame in the document.
    pub position: usize,
    /// Index of the frame in its video.
    pub frame_index: u64,
    /// How the cut was found.
    pub kind: ShotKind,
}

impl Timeline {
    /// Summarises a document in at most `parts` parts; the shots are those of `video`.
    pub fn from_document(document: &Document, video: &str, parts: usize) -> Self {
        let frames = document.frames.len();
        let count = parts.min(frames);
        let mut timeline = Self {
            frames,
            parts: vec![TimelinePart::default(); count],
            cuts: Vec::new(),
        };
        // A cut is shown at the first frame of the document that lies in the new shot or after it.
        // The document may lack the first frame of a shot, or the whole shot.
        let mut starts = VideoShots::from_document(document, video)
            .into_iter()
            .flat_map(|shots| shots.starts().collect::<Vec<_>>())
            .skip(1);
        let mut next = starts.next();
        for (position, frame) in document.frames.iter().enumerate() {
            timeline.parts[position * count / frames].add(frame);
            let number = frame
                .video
                .as_ref()
                .filter(|of| of.path == video)
                .map(|of| of.frame_index);
            while let (Some((from, kind)), Some(number)) = (next, number)
                && from <= number
            {
                timeline.cuts.push(TimelineCut {
                    position,
                    frame_index: from,
                    kind,
                });
                next = starts.next();
            }
        }
        timeline
    }

    /// The timeline of `document`, updated from this one, which was made of `before`: only parts
    /// with changed frames are summarised again. `None` if cuts may have moved or too many frames
    /// have changed; then [`Self::from_document`] is needed.
    pub fn follow_changes(&self, document: &Document, before: &TimelineSource) -> Option<Self> {
        let FrameChanges::At(changed) = document.frames.changes_since(&before.frames) else {
            return None;
        };
        let has_moved_frame = changed
            .iter()
            .any(|at| document.frames[*at].video != before.frames[*at].video);
        if document.shots != before.shots || has_moved_frame {
            return None;
        }
        // Sums can be added to but the greatest doubt cannot be taken back, so that whole parts are
        // summarised again. `changed` is ascending, so that equal parts are neighbours.
        let mut timeline = self.clone();
        let count = self.parts.len();
        let mut parts: Vec<usize> = changed
            .into_iter()
            .map(|at| at * count / self.frames)
            .collect();
        parts.dedup();
        for part in parts {
            let mut summed = TimelinePart::default();
            document
                .frames
                .range(self.first_frame_of(part)..self.first_frame_of(part + 1))
                .for_each(|frame| summed.add(frame));
            timeline.parts[part] = summed;
        }
        Some(timeline)
    }

    /// The index of the first frame of a part; of the part behind the last one, the number of
    /// frames. The least position for which `position * parts / frames` is the part.
    fn first_frame_of(&self, part: usize) -> usize {
        (part * self.frames).div_ceil(self.parts.len())
    }

    /// The interval of a part, as shares of the whole length.
    pub fn span_of_part(&self, part: usize) -> [f64; 2] {
        let count = self.parts.len().max(1) as f64;
        [part as f64 / count, (part + 1) as f64 / count]
    }

    /// The middle of a frame, as a share of the whole length.
    pub fn share_of(&self, position: usize) -> f64 {
        (position as f64 + 0.5) / self.frames.max(1) as f64
    }

    /// The beginning of a frame, as a share of the whole length.
    pub fn beginning_of(&self, position: usize) -> f64 {
        position as f64 / self.frames.max(1) as f64
    }

    /// The frame at a share of the whole length; beyond the ends the first or the last.
    pub fn frame_at(&self, share: f64) -> usize {
        ((share.max(0.0) * self.frames as f64) as usize).min(self.frames.saturating_sub(1))
    }
}

impl TimelinePart {
    fn add(&mut self, frame: &Frame) {
        self.frames += 1;
        match frame.status {
            FrameStatus::New => {}
            FrameStatus::Draft => self.drafts += 1,
            FrameStatus::Suggested => self.suggestions += 1,
            FrameStatus::Reference => self.references += 1,
            FrameStatus::Rejected => self.rejected += 1,
        }
        if frame.status == FrameStatus::Suggested {
            self.paint = self.paint.into_iter().chain(frame.paint_verdict()).min();
        }
        self.doubt = self.doubt.max(doubt(frame));
    }
}

/// Doubt about a frame, 0 to 1 (see [`TimelinePart::doubt`]).
fn doubt(frame: &Frame) -> f64 {
    if frame.is_unanswered() {
        return 1.0;
    }
    let confidence = frame.confidence();
    confidence
        .filter(|_| frame.status == FrameStatus::Suggested)
        .map_or(0.0, |confidence| (1.0 - confidence).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{PaintEvidence, Solution, VideoFrame};
    use touchline_documents::testing::{ptz_at, soccer_document};

    fn document() -> Document {
        let mut document = soccer_document();
        for index in 0..10 {
            let video = VideoFrame::new("match.mp4", index, None);
            document
                .frames
                .push(Frame::from_video(video, "main".into(), ImageSize::new(64, 36)).into());
        }
        VideoShots::from_cuts(&document, "match.mp4", 9, &[(6, ShotKind::Fade)])
            .write(&mut document);
        document
    }

    #[test]
    fn parts_sum_their_frames_up() {
        let mut document = document();
        document.frames[1].status = FrameStatus::Reference;
        document.frames[2].status = FrameStatus::Suggested;
        document.frames[2].solution = Some(Solution {
            confidence: Some(0.7),
            line_check: Some(PaintEvidence {
                score: 0.01,
                bare: 100,
                ..PaintEvidence::default()
            }),
            ..Solution::default()
        });
        document.frames[2].ptz = ptz_at(0.0, -9.0, 900.0);
        for frame in 8..10 {
            document.frames[frame].status = FrameStatus::Rejected;
        }
        let timeline = Timeline::from_document(&document, "match.mp4", 5);
        assert_eq!((timeline.frames, timeline.parts.len()), (10, 5));
        let first = TimelinePart {
            frames: 2,
            references: 1,
            ..TimelinePart::default()
        };
        assert_eq!(timeline.parts[0], first);
        assert!(
            timeline.parts[1].suggestions == 1 && (timeline.parts[1].doubt - 0.3).abs() < 1e-12
        );
        let verdicts = timeline.parts.iter().map(|part| part.paint);
        let contradicted = Some(LineVerdict::Contradicts);
        assert_eq!(
            verdicts.collect::<Vec<_>>(),
            [None, contradicted, None, None, None]
        );
        assert_eq!(
            (timeline.parts[4].rejected, timeline.parts[3].rejected),
            (2, 0)
        );
        assert_eq!(
            timeline.cuts,
            [TimelineCut {
                position: 6,
                frame_index: 6,
                kind: ShotKind::Fade
            }]
        );
        assert_eq!(
            Timeline::from_document(&document, "match.mp4", 500)
                .parts
                .len(),
            10
        );
        assert_eq!(
            Timeline::from_document(&soccer_document(), "match.mp4", 5).parts,
            []
        );
    }

    #[test]
    fn a_summary_follows_changed_frames() {
        for parts in [1, 3, 5, 10] {
            let mut document = document();
            let (before, known) = (
                TimelineSource::from_document(&document),
                Timeline::from_document(&document, "match.mp4", parts),
            );
            document.frames[0].status = FrameStatus::Reference;
            document.frames[7].status = FrameStatus::Draft;
            let anew = Timeline::from_document(&document, "match.mp4", parts);
            assert_ne!(anew, known);
            assert_eq!(known.follow_changes(&document, &before), Some(anew));
            document.frames[7].video = Some(VideoFrame::new("match.mp4", 70, None));
            assert_eq!(
                known.follow_changes(&document, &before),
                None,
                "a cut may lie elsewhere"
            );
        }
        let mut document = document();
        let (before, known) = (
            TimelineSource::from_document(&document),
            Timeline::from_document(&document, "match.mp4", 5),
        );
        VideoShots::from_cuts(&document, "match.mp4", 9, &[(3, ShotKind::Cut)])
            .write(&mut document);
        assert_eq!(known.follow_changes(&document, &before), None);
    }

    #[test]
    fn places_and_frames_lead_to_each_other() {
        let timeline = Timeline::from_document(&document(), "match.mp4", 5);
        for frame in 0..10 {
            assert_eq!(timeline.frame_at(timeline.share_of(frame)), frame);
        }
        assert_eq!(
            (
                timeline.frame_at(-0.2),
                timeline.frame_at(1.0),
                timeline.frame_at(7.0)
            ),
            (0, 9, 9)
        );
        assert_eq!(timeline.span_of_part(4), [0.8, 1.0]);
    }
}
