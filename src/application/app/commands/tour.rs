//! A tour of five steps on the demo match. The user does each step; it is over when the document
//! shows the result.

use crate::app::{Command, Keymap};
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{Document, Frame, FrameId, FrameStatus};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TourStep {
    /// The user places and names a first point.
    FirstPoint,
    /// The user places a second point, and the lines appear.
    SecondPoint,
    /// The user moves a point, and the lines follow.
    Refine,
    /// The user accepts the frame.
    Accept,
    /// The user accepts or rejects the next frame.
    Decide,
    /// All steps are done.
    Finished,
}

impl TourStep {
    /// The steps that the user does, in order.
    pub const ALL: [Self; 5] = [
        Self::FirstPoint,
        Self::SecondPoint,
        Self::Refine,
        Self::Accept,
        Self::Decide,
    ];

    /// The number of the step, from 1; none after the last.
    pub fn number(self) -> Option<usize> {
        Self::ALL
            .iter()
            .position(|step| *step == self)
            .map(|place| place + 1)
    }

    /// What to do, in a few words.
    pub const fn title(self) -> &'static str {
        match self {
            Self::FirstPoint => "Place a point",
            Self::SecondPoint => "Place a second one, far away",
            Self::Refine => "Refine a point",
            Self::Accept => "Accept the frame",
            Self::Decide => "Decide about the next frame",
            Self::Finished => "That is the whole method",
        }
    }

    /// How to do it.
    pub fn text(self, keys: &Keymap) -> String {
        let key = |command| keys.key_or_name(command);
        match self {
            Self::FirstPoint => "Click a spot where two lines meet, such as a corner of the penalty area. Then choose its name \
                                 from the list: press its digit, or type letters of the name. (Dashed lines, \
                                 if there are any, are a proposal: they come in step 5.)"
                .to_owned(),
            Self::SecondPoint => "Two points far apart determine pan, tilt and focal length, since the camera's position is known. \
                                  The field's lines then appear. Two points always agree, a wrong one too: only lines that \
                                  lie on the paint show that both are right."
                .to_owned(),
            Self::Refine => "Drag one of the points by a few pixels, or select it and use the arrow keys: the loupe shows the \
                             exact pixel, and the lines follow. Put it where they lie on the paint; while they do \
                             not, a point is wrong."
                .to_owned(),
            Self::Accept => format!(
                "Look at the lines and read the verdict on the right. Then press {}: the frame becomes a reference, and the \
                 next frame to do is shown.",
                key(Command::Accept)
            ),
            Self::Decide => format!(
                "Dashed lines are a camera that the program proposes: {} accepts it, a click corrects it, {} and a digit \
                 reject the frame. Without a proposal, label the frame as you did the first, or reject it.",
                key(Command::Accept),
                key(Command::Reject)
            ),
            Self::Finished => format!(
                "With your own footage, the base of the camera comes first: the guide tells how ({}). {} exports the labels.",
                key(Command::Guide),
                key(Command::Export)
            ),
        }
    }
}

/// The state of the document as the tour sees it.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::app) struct TourView {
    /// The shown frame.
    pub frame: Option<FrameId>,
    /// Its points, px.
    pub points: Vec<ImagePoint>,
    /// Whether its points determine a camera.
    pub solved: bool,
    /// Number of named points in all frames.
    pub named: usize,
    /// Number of accepted frames.
    pub references: usize,
    /// Number of accepted and rejected frames.
    pub decided: usize,
}

impl TourView {
    /// The state of a document; `solved` is about the shown frame.
    pub fn from_document(document: &Document, shown: Option<&Frame>, solved: bool) -> Self {
        let references = count_frames(document, FrameStatus::Reference);
        Self {
            frame: shown.map(|frame| frame.id.clone()),
            points: shown
                .map(|frame| frame.clicks.iter().map(|click| click.image).collect())
                .unwrap_or_default(),
            solved,
            named: document
                .frames
                .iter()
                .flat_map(|frame| &frame.clicks)
                .filter(|click| click.target.is_some())
                .count(),
            references,
            decided: references + count_frames(document, FrameStatus::Rejected),
        }
    }
}

/// The number of frames with a status.
fn count_frames(document: &Document, status: FrameStatus) -> usize {
    let frames = document.frames.iter();
    frames.filter(|frame| frame.status == status).count()
}

/// A tour in progress.
#[derive(Clone, Debug, PartialEq)]
pub struct Tour {
    step: TourStep,
    /// The state when the step began.
    since: TourView,
    /// Whether the user has taken a point in this step.
    took_point: bool,
}

impl Tour {
    /// Starts with the first step.
    pub(in crate::app) const fn begin(seen: TourView) -> Self {
        Self {
            step: TourStep::FirstPoint,
            since: seen,
            took_point: false,
        }
    }

    /// The present step.
    pub const fn step(&self) -> TourStep {
        self.step
    }

    /// Registers that the user takes a point to drag it, or nudges it.
    pub(in crate::app) const fn point_taken(&mut self) {
        self.took_point = true;
    }

    /// Advances to the next step if the present one is done.
    pub(in crate::app) fn look(&mut self, seen: TourView) {
        // A step is done when the document shows its result, however the user came there.
        let since = &self.since;
        let (done, next) = match self.step {
            TourStep::FirstPoint => (seen.named > since.named, TourStep::SecondPoint),
            TourStep::SecondPoint => (seen.named > since.named && seen.solved, TourStep::Refine),
            TourStep::Refine => {
                let same = seen.frame == since.frame && seen.points.len() == since.points.len();
                (
                    same && self.took_point && seen.points != since.points,
                    TourStep::Accept,
                )
            }
            TourStep::Accept => (seen.references > since.references, TourStep::Decide),
            TourStep::Decide => (seen.decided > since.decided, TourStep::Finished),
            TourStep::Finished => return,
        };
        // *Refine* compares positions of points, so its starting state is renewed when the user
        // goes to another frame, or a point is added or removed. The same applies until the user
        // takes a point, so that an automatic move onto the paint does not count.
        let begins_anew = self.step == TourStep::Refine
            && (!self.took_point
                || seen.frame != since.frame
                || seen.points.len() != since.points.len());
        if done || begins_anew {
            self.since = seen;
            self.took_point = false;
        }
        if done {
            self.step = next;
        }
    }
}
