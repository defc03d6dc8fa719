//! The view, the journal and undo after any sequence of events.

use super::{Desk, base, document, proposal, suggest_camera};
use crate::proposals::Proposal;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{Click, Frame, FrameStatus, SolutionSource};

/// An event of a project.
#[derive(Clone, Copy, Debug)]
enum Happening {
    /// The forest answers for a frame: a pan, or no camera.
    Answer(usize, Option<f64>),
    /// Another forest is trained.
    Learn,
    /// Cameras are tracked from a frame to the frames after it.
    Carry(usize, f64),
    /// Autocalibration finds the camera at a height, with its frames.
    Find(f64, f64),
    /// The user discards the batch that a frame shows.
    Discard(usize),
    Accept(usize),
    Comment(usize, u8),
    Click(usize, f64),
    /// The base moves to a height, and the suggestions for the old one are withdrawn.
    Move(f64),
    Undo,
    Redo,
    /// The document is written and opened again with its history.
    Reopen,
}

fn happenings() -> impl Strategy<Value = Vec<Happening>> {
    let (frame, number) = (0usize..4, (0u8..4).prop_map(f64::from));
    let pan = prop_oneof![1 => Just(None), 3 => number.clone().prop_map(Some)];
    prop::collection::vec(
        prop_oneof![
            4 => (frame.clone(), pan).prop_map(|(frame, pan)| Happening::Answer(frame, pan)),
            1 => Just(Happening::Learn),
            2 => (frame.clone(), number.clone()).prop_map(|(frame, pan)| Happening::Carry(frame, pan)),
            1 => (number.clone(), number.clone()).prop_map(|(more_m, pan)| Happening::Find(18.0 + more_m, pan)),
            2 => frame.clone().prop_map(Happening::Discard),
            2 => frame.clone().prop_map(Happening::Accept),
            1 => (frame.clone(), 0u8..4).prop_map(|(frame, text)| Happening::Comment(frame, text)),
            2 => (frame, number.clone()).prop_map(|(frame, x)| Happening::Click(frame, x)),
            1 => number.prop_map(|more_m| Happening::Move(18.0 + more_m)),
            3 => Just(Happening::Undo),
            2 => Just(Happening::Redo),
            1 => Just(Happening::Reopen),
        ],
        1..40,
    )
}

impl Desk {
    fn happen(&mut self, happening: Happening) {
        match happening {
            Happening::Answer(frame, pan_deg) => {
                self.suggest(&[Proposal {
                    generation: self.generation,
                    ..proposal(&self.now, frame, pan_deg)
                }]);
            }
            Happening::Learn => self.generation += 1,
            Happening::Carry(first, pan_deg) => {
                let cameras: Vec<_> = (first..self.now.frames.len())
                    .map(|frame| (frame, pan_deg))
                    .collect();
                self.carry(&cameras);
            }
            Happening::Find(height_m, pan_deg) => self.edit("Find the camera", |document| {
                document.cameras[0].set_base(&base(height_m));
                for frame in document.frames.iter_mut().filter(|frame| frame.is_open()) {
                    suggest_camera(frame, pan_deg, SolutionSource::Markings);
                }
            }),
            Happening::Discard(frame) => {
                if let Some(batch) = self.project.batch_shown_in(&self.now.frames[frame]) {
                    self.discard(batch);
                }
            }
            Happening::Accept(frame) if self.now.frames[frame].ptz.is_none() => {}
            Happening::Accept(frame) => self.accept(frame),
            Happening::Comment(frame, text) => {
                self.edit("Comment", |document| {
                    document.frames[frame].comment = Some(text.to_string());
                });
            }
            Happening::Click(frame, x) => self.edit("Click", |document| {
                document.frames[frame]
                    .clicks
                    .push(Click::without_name(ImagePoint::new(x, 1.0)));
                document.frames[frame].status = FrameStatus::Draft;
            }),
            Happening::Move(height_m) => self.edit("Move camera", |document| {
                document.cameras[0].set_base(&base(height_m));
                for frame in &mut document.frames {
                    **frame = frame.without_suggestion();
                }
            }),
            Happening::Undo => drop(self.step(true)),
            Happening::Redo => drop(self.step(false)),
            Happening::Reopen => self.reopen(),
        }
    }
}

/// Number of random cases per property. The seeds are fixed.
fn trials(seed: u64) -> ProptestConfig {
    ProptestConfig {
        rng_seed: RngSeed::Fixed(seed),
        ..ProptestConfig::with_cases(96)
    }
}

proptest! {
    #![proptest_config(trials(0x7072_6f6a))]
    #[test]
    fn the_view_is_what_people_did_with_what_is_suggested(happenings in happenings()) {
        let mut desk = Desk::of(document(4));
        for happening in happenings {
            let (edited, step) = (desk.project.edited_document().clone(), desk.history.next_undo().cloned());
            desk.happen(happening);
            desk.check();
            if matches!(happening, Happening::Answer(..) | Happening::Carry(..) | Happening::Discard(_)) {
                prop_assert_eq!(desk.project.edited_document(), &edited, "people did nothing");
                prop_assert_eq!(desk.history.next_undo(), step.as_ref());
            }
        }
        while desk.step(true) {
            desk.check();
        }
        for (frame, start) in desk.project.edited_document().frames.iter().zip(&desk.start.frames) {
            prop_assert_eq!(Frame { revision: 0, ..(**frame).clone() }, (**start).clone());
        }
    }

    #[test]
    fn a_batch_that_is_discarded_leaves_no_trace(happenings in happenings(), first in 0usize..4, pan_deg in 5.0f64..9.0) {
        let mut desk = Desk::of(document(4));
        for happening in happenings {
            desk.happen(happening);
        }
        let before = desk.now.clone();
        let cameras: Vec<_> = (first..4).map(|frame| (frame, pan_deg)).collect();
        let batch = desk.carry(&cameras);
        let shows_it = |desk: &Desk, frame: &Frame| desk.project.batch_shown_in(frame) == Some(batch);
        let given = desk.now.frames.iter().filter(|frame| shows_it(&desk, frame)).count();
        let discarded = desk.discard(batch);
        prop_assert_eq!(discarded.emptied + discarded.given_back, given);
        prop_assert_eq!(&desk.now, &before);
        prop_assert!(!desk.now.frames.iter().any(|frame| shows_it(&desk, frame)));
        desk.check();
    }
}
