//! A tour of five steps on the demo match. Each step is done by the person; it is over when the
//! document shows so.

use super::{Command, Keymap};
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{Document, Frame, FrameId, FrameStatus};

/// A step of the tour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TourStep {
    /// A first point is placed and named.
    FirstPoint,
    /// A second one, and the lines appear.
    SecondPoint,
    /// A point is moved, and the lines follow.
    Refine,
    /// The frame becomes a reference.
    Accept,
    /// The next frame is decided.
    Decide,
    /// All is done.
    Finished,
}

impl TourStep {
    /// The steps that a person does, in order.
    pub const ALL: [Self; 5] = [
        Self::FirstPoint,
        Self::SecondPoint,
        Self::Refine,
        Self::Accept,
        Self::Decide,
    ];

    /// Its place among the steps, from 1; none once all are done.
    #[must_use]
    pub fn number(self) -> Option<usize> {
        Self::ALL
            .iter()
            .position(|step| *step == self)
            .map(|place| place + 1)
    }

    /// What the person does, in a few words.
    #[must_use]
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

    /// How it is done.
    #[must_use]
    pub fn text(self, keys: &Keymap) -> String {
        let key = |command| keys.shown(command);
        match self {
            Self::FirstPoint => "Click a spot where two lines meet, such as a corner of the penalty area. Then choose its name \
                                 from the list: press its digit, or type letters of the name. (Dashed lines, \
                                 if there are any, are a proposal: they come in step 5.)"
                .to_owned(),
            Self::SecondPoint => "Two points determine pan, tilt and focal length, because this camera's position is known. \
                                  The farther apart they are, the better. The field's lines then appear over the picture."
                .to_owned(),
            Self::Refine => "Drag one of the points by a few pixels, or select it and use the arrow keys: the loupe shows the \
                             exact pixel, and the lines follow. Put it where the lines match."
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

/// What the tour looks at.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sight {
    /// The frame that is shown.
    pub frame: Option<FrameId>,
    /// Its points.
    pub points: Vec<ImagePoint>,
    /// It has a camera from its points.
    pub solved: bool,
    /// Points with a name, of all frames.
    pub named: usize,
    /// Accepted frames.
    pub references: usize,
    /// Accepted and rejected frames.
    pub decided: usize,
}

impl Sight {
    /// What a document shows.
    pub fn of(document: &Document, shown: Option<&Frame>, solved: bool) -> Self {
        let count = |wanted: &dyn Fn(&Frame) -> bool| {
            document.frames.iter().filter(|frame| wanted(frame)).count()
        };
        let references = count(&|frame| frame.status == FrameStatus::Reference);
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
            decided: references + count(&|frame| frame.status == FrameStatus::Rejected),
        }
    }
}

/// A tour under way.
#[derive(Clone, Debug, PartialEq)]
pub struct Tour {
    step: TourStep,
    /// What was seen when the step began.
    since: Sight,
    /// A point was taken up in this step.
    took_point: bool,
}

impl Tour {
    /// The first step.
    pub(super) const fn begin(seen: Sight) -> Self {
        Self {
            step: TourStep::FirstPoint,
            since: seen,
            took_point: false,
        }
    }

    /// What is to be done.
    #[must_use]
    pub const fn step(&self) -> TourStep {
        self.step
    }

    /// A person takes hold of a point, or nudges it.
    pub(super) const fn point_taken(&mut self) {
        self.took_point = true;
    }

    /// Goes on where the step is done.
    pub(super) fn look(&mut self, seen: Sight) {
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
        // Another frame was gone to, or a point came or went: what is moved from here on counts.
        // So does what snapping did to the points before anybody took hold of one.
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
