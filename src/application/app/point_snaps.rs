//! Points that were placed or dropped and wait to be moved onto the paint that they name.

use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{Click, Frame, FrameId, Shared, Step, Target};

/// Points that wait to be moved onto the paint, and the order that is under way.
#[derive(Debug, Default)]
pub(super) struct PointSnaps {
    tickets: u64,
    under_way: Option<Asked>,
    waiting: Vec<Placed>,
    /// The last click that is to stay where it is: also once it gets its name.
    exact: Option<(FrameId, usize)>,
}

/// A point that somebody placed.
#[derive(Clone, Debug, PartialEq)]
struct Placed {
    frame: FrameId,
    landmark: Target,
    at: ImagePoint,
}

impl Placed {
    fn is(&self, click: &Click) -> bool {
        click.snapped_sigma_px.is_none() && click.image == self.at && click.target.as_ref() == Some(&self.landmark)
    }
}

/// What an order is about.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Asked {
    ticket: u64,
    /// The frame as it was then.
    pub frame: Shared<Frame>,
    /// The step of undo that placed the last of the points.
    pub step: Option<Step>,
}

impl PointSnaps {
    /// A click was placed, moved or named; `exactly`: it is to stay where it is.
    pub(super) fn placed(&mut self, frame: &Frame, index: usize, exactly: bool) {
        let here = (frame.id.clone(), index);
        if exactly {
            // One that named itself as it was placed waits already.
            if let Some(click) = frame.clicks.get(index) {
                self.waiting.retain(|placed| placed.frame != frame.id || !placed.is(click));
            }
            self.exact = Some(here);
            return;
        }
        self.exact.take_if(|exact| *exact == here);
        self.wait(frame, index);
    }

    /// A click got its name: it waits, unless it is to stay where it is.
    pub(super) fn named(&mut self, frame: &Frame, index: usize) {
        let is_exact = self.exact.as_ref().is_some_and(|(id, click)| (id, *click) == (&frame.id, index));
        if !is_exact {
            self.wait(frame, index);
        }
    }

    fn wait(&mut self, frame: &Frame, index: usize) {
        let Some(click) = frame.clicks.get(index) else { return };
        let Some(landmark @ Target::Landmark(_)) = &click.target else { return };
        let placed = Placed { frame: frame.id.clone(), landmark: landmark.clone(), at: click.image };
        if placed.is(click) && !self.waiting.contains(&placed) {
            self.waiting.push(placed);
        }
    }

    /// What is to be looked for next in the shown frame: a ticket, and the clicks; none while an order is under way. Points of
    /// frames that were left wait no longer.
    pub(super) fn next(&mut self, frame: &Shared<Frame>, step: Option<&Step>) -> Option<(u64, Vec<usize>)> {
        self.waiting.retain(|placed| placed.frame == frame.id);
        if self.under_way.is_some() {
            return None;
        }
        let waits = |click: &Click| self.waiting.iter().any(|placed| placed.is(click));
        let clicks: Vec<usize> =
            frame.clicks.iter().enumerate().filter(|(_, click)| waits(click)).map(|(index, _)| index).collect();
        self.waiting.clear();
        if clicks.is_empty() {
            return None;
        }
        self.tickets += 1;
        let step = step.filter(|step| step.frame.as_ref() == Some(&frame.id)).cloned();
        self.under_way = Some(Asked { ticket: self.tickets, frame: frame.clone(), step });
        Some((self.tickets, clicks))
    }

    /// What the order of a ticket was about, once.
    pub(super) fn take(&mut self, ticket: u64) -> Option<Asked> {
        self.under_way.take_if(|asked| asked.ticket == ticket)
    }

    /// Another document: reports of orders before are passed over.
    pub(super) fn for_another(&self) -> Self {
        Self { tickets: self.tickets, ..Self::default() }
    }
}
