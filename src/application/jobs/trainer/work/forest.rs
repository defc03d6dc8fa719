//! The steps that make the forest, and what follows from them.
//!
//! The trainer recalls a stored forest or trains a new one. It measures the accuracy of each and
//! lowers the stated probabilities where they are too high. It drops the forest, and what was found
//! out with it, when references are changed or withdrawn.

use super::{Work, catch_panic};
use crate::app::{ForestFacts, TrainerStatus};
use crate::jobs::trainer::backend::{Backend, ForestAccuracy, TrainedModel};
use crate::jobs::trainer::mailbox::{StopCondition, Watch};
use std::convert::identity;
use std::sync::Arc;
use std::time::{Duration, Instant};
use touchline_calibration::proposals::{Coverage, Quality, TrainingSet};
use touchline_core::progress::Progress;
use touchline_documents::document::FrameId;
use touchline_vision::relocalize::ForestModel;

/// Maximum time that proposals take precedence over the next training.
const LONGEST_TURN: Duration = Duration::from_secs(20);

/// The forest in use.
pub(super) struct Forest {
    pub(super) model: Arc<ForestModel>,
    pub(super) training_set: TrainingSet,
}

impl<C: Backend> Work<C> {
    /// Drops what was found out about references that were changed or withdrawn.
    pub(super) fn forget_changed(&mut self, before: &TrainingSet) {
        self.status.suspects = self
            .status
            .suspects
            .iter()
            .filter(|suspect| self.is_unchanged(&suspect.frame, before))
            .cloned()
            .collect();
        self.status.failed = self
            .status
            .failed
            .iter()
            .filter(|failed| self.is_unchanged(&failed.frame, before))
            .cloned()
            .collect();
    }

    /// Whether the training sample of a frame is in the training set `before` and in that of now.
    fn is_unchanged(&self, id: &FrameId, before: &TrainingSet) -> bool {
        let Some(position) = self.document.frames.position_of(id) else {
            return false;
        };
        let sample = TrainingSet::from_frames(&self.document, &[position]);
        before.contains(&sample) && self.training_set.contains(&sample)
    }

    /// Drops the forest: no training sample is left.
    pub(super) fn forget(&mut self) {
        // All its samples were withdrawn: answers of this and all earlier forests are unreliable.
        if self.forest.take().is_some() {
            self.answer_cache.trust_from(self.generation + 1);
        }
        self.status = TrainerStatus {
            references: self.status.references,
            withheld: self.status.withheld,
            answered: self.status.answered,
            not_kept: self.status.not_kept.take(),
            ..TrainerStatus::default()
        };
    }

    /// Looks for a forest that an earlier run of the program stored.
    pub(super) fn recall(&mut self) {
        self.recalled = true;
        let (backend, training_set) = (&mut self.backend, &self.training_set);
        let recalled = catch_panic("reading the forest", || backend.recall(training_set));
        match recalled.and_then(identity) {
            Ok(Some(model)) => {
                let facts = ForestFacts {
                    references: self.training_frames.frames.len(),
                    ..facts(&model)
                };
                // The forest already answered in an earlier run; what was discarded then stays
                // discarded.
                self.answer_cache
                    .keep_refusing(self.generation, self.generation + 1);
                self.take_forest(model, self.training_set.clone(), facts);
            }
            Ok(None) => {}
            // Not fatal: a new forest is trained instead.
            Err(trouble) => self.status.trouble = Some(trouble),
        }
    }

    /// Trains a forest; ends early if a training sample is changed or withdrawn.
    pub(super) fn learn(&mut self) {
        let begun = Instant::now();
        let (document, training_frames) =
            (self.document.clone(), self.training_frames.frames.clone());
        let training_set = self.training_set.clone();
        let watch = Watch::new(
            &self.mailbox,
            &self.status,
            self.orders.edition,
            StopCondition::Unlearnt(training_set.clone()),
        );
        let backend = &mut self.backend;
        let learnt = catch_panic("learning", || {
            let progress = Progress::new(|doing| watch.notify(doing));
            backend.learn(&document, &training_frames, &training_set, &progress)
        });
        match learnt.and_then(identity) {
            Ok(None) => {}
            Ok(Some(TrainedModel {
                model,
                features,
                failed,
            })) => {
                let took = begun.elapsed();
                let facts = ForestFacts {
                    references: training_frames.len() - failed.len(),
                    features,
                    took: Some(took),
                    ..facts(&model)
                };
                self.status.failed = failed.into();
                self.status.trouble = None;
                // As much time for proposals as the training took: training and proposals then get
                // half the time each, however often references are added.
                self.turn_until = Instant::now() + took.min(LONGEST_TURN);
                self.take_forest(model, training_set, facts);
            }
            Err(trouble) => {
                self.status.trouble = Some(trouble);
                self.failed = Some(training_set);
            }
        }
        self.status.not_kept = self.backend.not_kept();
    }

    /// Puts a forest into use under a new generation.
    fn take_forest(&mut self, model: ForestModel, training_set: TrainingSet, facts: ForestFacts) {
        self.generation += 1;
        // If it lacks samples of the one before, something was withdrawn: earlier answers are
        // unreliable.
        if self
            .forest
            .as_ref()
            .is_some_and(|before| !training_set.contains(&before.training_set))
        {
            self.answer_cache.trust_from(self.generation);
        }
        self.status.forest = Some(ForestFacts {
            generation: self.generation,
            ..facts
        });
        self.forest = Some(Forest {
            model: Arc::new(model),
            training_set,
        });
        self.survey();
    }

    /// Measures the accuracy of the forest by leaving references out.
    pub(super) fn measure(&mut self) {
        let document = self.document.clone();
        let training_frames = &self.training_frames.frames;
        let watch = Watch::new(
            &self.mailbox,
            &self.status,
            self.orders.edition,
            StopCondition::Changed(self.training_set.clone()),
        );
        let backend = &mut self.backend;
        let measured = catch_panic("measuring quality", || {
            let progress = Progress::new(|doing| watch.notify(doing));
            backend.measure(&document, training_frames, &progress)
        });
        // If this ended early, or the training set has changed, it is measured again.
        match measured {
            Ok(None) => return,
            Ok(Some(_)) if !watch.is_wanted() => return,
            Ok(Some(ForestAccuracy { quality, suspects })) => {
                if let Some(quality) = &quality {
                    self.bound(quality);
                }
                self.status.quality = quality.map(Arc::new);
                self.status.suspects = suspects.into();
            }
            Err(trouble) => self.status.trouble = Some(trouble),
        }
        // After `bound`, which begins a generation: the same trees need no second measurement. A
        // measurement that panicked counts, too, as it would panic again.
        self.measured = self.generation;
    }

    /// Lowers the forest's stated probabilities if references that were left out got wrong answers
    /// stated as certain. The result is a new generation, so that earlier answers are queried
    /// again.
    fn bound(&mut self, quality: &Quality) {
        let shown = quality.confident_answers();
        let (Some(forest), Some(facts)) = (&self.forest, &self.status.forest) else {
            return;
        };
        // Every answer that was stated as certain is right: nothing has to be lowered.
        if shown.right == shown.certain {
            return;
        }
        let mut model = (*forest.model).clone();
        quality.bound(&self.document, &mut model);
        let (training_set, facts) = (forest.training_set.clone(), *facts);
        self.answer_cache
            .keep_refusing(self.generation, self.generation + 1);
        self.take_forest(model, training_set, facts);
    }

    /// Maps what the references of each camera see.
    fn survey(&mut self) {
        let training_frames = &self.training_frames.frames;
        let document = self.document.at(self.backend.folder());
        let measured = catch_panic("mapping the references", || {
            Coverage::measure_cameras(document, training_frames)
        });
        // The forest answers without the map, too. A map of other references would mislead.
        let coverage = measured.unwrap_or_else(|trouble| {
            self.status.trouble = Some(trouble);
            Vec::new()
        });
        self.status.coverage = coverage.into();
    }
}

/// The size of a forest.
fn facts(model: &ForestModel) -> ForestFacts {
    let cameras = model.cameras.iter();
    ForestFacts {
        trees: cameras.clone().map(|camera| camera.forest.trees()).sum(),
        leaves: cameras.map(|camera| camera.forest.leaves()).sum(),
        ..ForestFacts::default()
    }
}
