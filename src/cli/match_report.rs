//! Reports progress and results while a match is labelled: a bar for each step, and messages.

use super::messages::Messages;
use super::track::TrackingReport;
use indicatif::ProgressBar;
use std::sync::{Mutex, PoisonError};
use touchline_calibration::calibrate::{AutocalibratedCamera, describe_size};
use touchline_calibration::pipelines::{LearningProgress, MatchEvent};

/// Length of the bar of a search. Its steps count differently, so that it shows their share.
const PARTS: usize = 1000;

/// Reports the events of labelling a match. Events may come from any thread.
pub struct MatchReport {
    messages: Messages,
    shown: Mutex<TerminalDisplay>,
}

/// What the terminal shows.
struct TerminalDisplay {
    /// The bar of the current step, with the text that it began with.
    bar: Option<(&'static str, ProgressBar)>,
    tracking: TrackingReport,
}

impl MatchReport {
    /// A reporter that has not shown anything.
    pub const fn new(messages: Messages) -> Self {
        Self {
            messages,
            shown: Mutex::new(TerminalDisplay {
                bar: None,
                tracking: TrackingReport::new(messages),
            }),
        }
    }

    /// Reports one event.
    pub fn hear(&self, event: MatchEvent) {
        let messages = self.messages;
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        match event {
            MatchEvent::Searching(progress) => {
                let bar = shown.bar_of(messages, "Finding the camera", PARTS);
                bar.set_message(progress.to_string());
                bar.set_position((progress.share_of_step() * PARTS as f64) as u64);
            }
            MatchEvent::Unreadable { frame, error } => {
                messages.frame_failed(&frame, &error.to_string());
            }
            MatchEvent::Found {
                camera,
                found,
                separate_frames,
            } => {
                shown.clear();
                if let Some(count) = separate_frames {
                    messages.note(&format!("{count} frames are of another camera, {camera}:"));
                }
                describe_found(&found, messages);
            }
            MatchEvent::OtherNotFound {
                document,
                camera,
                why,
                separate_frames,
            } => {
                shown.clear();
                let why = why.describe(&document);
                messages.note(&format!(
                    "{separate_frames} frames are of another camera, {camera}: {why}"
                ));
            }
            MatchEvent::Learning(LearningProgress::Features { done, of }) => {
                shown
                    .bar_of(messages, "Learning from the frames found", of)
                    .set_position(done as u64);
            }
            MatchEvent::Learning(LearningProgress::Training(_)) => {}
            MatchEvent::Asking { done, of } => {
                shown
                    .bar_of(messages, "Solving the other frames", of)
                    .set_position(done as u64);
            }
            MatchEvent::Tracking(event) => {
                shown.clear();
                shown.tracking.hear(event);
            }
        }
    }
}

impl TerminalDisplay {
    /// The bar of a step. Removes the bar of the step before.
    fn bar_of(&mut self, messages: Messages, what: &'static str, count: usize) -> &ProgressBar {
        if self.bar.as_ref().is_some_and(|(shown, _)| *shown != what) {
            self.clear();
        }
        &self
            .bar
            .get_or_insert_with(|| (what, messages.progress(count, what)))
            .1
    }

    fn clear(&mut self) {
        if let Some((_, bar)) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

impl Drop for TerminalDisplay {
    fn drop(&mut self) {
        self.clear();
    }
}

/// Reports the camera that was found, and the evidence for it.
fn describe_found(found: &AutocalibratedCamera, messages: Messages) {
    for size in &found.sizes {
        messages.note(&describe_size(size));
    }
    let (at, sigma, evidence) = (
        found.base.position_m,
        found.base.sigma.position_m,
        &found.evidence,
    );
    messages.note(&format!(
        "position ({:.2}, {:.2}, {:.2}) ± ({:.2}, {:.2}, {:.2}) m, crown {:.2} m",
        at.x, at.y, at.z, sigma.x, sigma.y, sigma.z, found.field.crown_m
    ));
    messages.note(&format!(
        "{} frames; {:.0} % of the paint explained, {:.0} % of the lines seen ({} by name), next best answer {:.0} % of this \
         one, paint {:.2} px off its lines, parts of the frames {:.2} m apart",
        evidence.frames,
        100.0 * evidence.explained,
        100.0 * evidence.visible,
        evidence.lines.len(),
        100.0 * evidence.rival / evidence.score(),
        evidence.residual_px,
        evidence.parts_m,
    ));
}
