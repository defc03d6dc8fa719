//! Reports progress and results while a match is labelled: a bar for each step, and messages.

use super::track::TrackingReport;
use crate::cli::terminal::messages::{Messages, StepBar};
use std::sync::{Mutex, PoisonError};
use touchline_calibration::calibrate::{AutocalibratedCamera, describe_size};
use touchline_calibration::pipelines::{
    LearningProgress, MatchEvent, RecognisedCamera, VenueEvent,
};
use touchline_core::geometry::pluralise;
use touchline_core::progress::Share;

/// Length of the bar of a search. Its steps count differently, so that it shows their share.
const PARTS: usize = 1000;

/// Reports the events of labelling a match. Events may come from any thread.
pub struct MatchReport {
    messages: Messages,
    shown: Mutex<TerminalDisplay>,
}

/// What the terminal shows.
struct TerminalDisplay {
    bar: StepBar,
    tracking: TrackingReport,
}

impl MatchReport {
    /// A reporter that has not shown anything.
    pub const fn new(messages: Messages) -> Self {
        Self {
            messages,
            shown: Mutex::new(TerminalDisplay {
                bar: StepBar::new(messages),
                tracking: TrackingReport::new(messages),
            }),
        }
    }

    /// Reports one event.
    pub fn on_event(&self, event: MatchEvent) {
        let messages = self.messages;
        // A panic in another thread leaves at worst a stale bar, which is no reason to panic here.
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        // The bar goes before a message, which would run into its line otherwise.
        match event {
            MatchEvent::FindingShots(Share { done, of }) => {
                let bar = shown.bar.of("Finding the shots", of);
                bar.set_position(done as u64);
            }
            MatchEvent::Shots {
                shots,
                transitions,
                without_field,
            } => {
                shown.bar.clear();
                if shots > 1 {
                    let between = pluralise(transitions, "transition");
                    messages.note(&format!(
                        "{shots} shots, {between} between them, {without_field} without a field"
                    ));
                }
            }
            MatchEvent::Venue(VenueEvent::Trying { venue }) => {
                let bar = shown.bar.of("Comparing with the venues", PARTS);
                bar.set_message(venue);
            }
            MatchEvent::Venue(VenueEvent::Refused { venue, camera, why }) => {
                shown.bar.clear();
                messages.note(&format!("venue {venue}, camera {camera}: {why}"));
            }
            MatchEvent::Venue(VenueEvent::Recognised(recognised)) => {
                shown.bar.clear();
                messages.note(&describe_recognised(&recognised));
            }
            MatchEvent::Searching(progress) => {
                let bar = shown.bar.of("Finding the camera", PARTS);
                bar.set_message(progress.to_string());
                bar.set_position((progress.share_of_step() * PARTS as f64) as u64);
            }
            MatchEvent::Unreadable { frame, error } => {
                shown.bar.clear();
                messages.frame_failed(&frame, &error.to_string());
            }
            MatchEvent::Found {
                camera,
                found,
                separate_frames,
                ..
            } => {
                shown.bar.clear();
                if let Some(count) = separate_frames {
                    let frames = pluralise(count, "frame");
                    messages.note(&format!("{frames} of another camera, {camera}:"));
                }
                describe_found(&found, messages);
            }
            MatchEvent::Joined { camera, frames, .. } => {
                shown.bar.clear();
                messages.note(&format!(
                    "{} that match none of these: {camera} again, at the same place",
                    pluralise(frames, "frame")
                ));
            }
            MatchEvent::FromClicks { camera, base } => {
                shown.bar.clear();
                if let Some(base) = base {
                    let (at, sigma) = (base.position_m, base.sigma.position_m);
                    messages.note(&format!(
                        "{camera}: from its clicks and the paint of the frames tracked from them: position \
                         ({:.2}, {:.2}, {:.2}) ± ({:.2}, {:.2}, {:.2}) m",
                        at.x, at.y, at.z, sigma.x, sigma.y, sigma.z
                    ));
                }
            }
            MatchEvent::NotFound {
                document,
                camera,
                why,
                separate_frames,
            } => {
                shown.bar.clear();
                let why = why.describe(&document);
                let of_another = separate_frames.map_or_else(String::new, |count| {
                    format!("{} of another camera, ", pluralise(count, "frame"))
                });
                messages.note(&format!("{of_another}{camera}: not found: {why}"));
            }
            MatchEvent::Learning(LearningProgress::Features { done, of }) => {
                let bar = shown.bar.of("Learning from the frames found", of);
                bar.set_position(done as u64);
            }
            // The bar of the features, which is full by then, stays while the forest is trained on
            // them.
            MatchEvent::Learning(LearningProgress::Training(_)) => {}
            MatchEvent::Asking { done, of } => {
                let bar = shown.bar.of("Solving the other frames", of);
                bar.set_position(done as u64);
            }
            MatchEvent::Tracking(event) => {
                shown.bar.clear();
                shown.tracking.on_event(event);
            }
        }
    }
}

/// What is said of a camera of a venue that was recognised.
fn describe_recognised(recognised: &RecognisedCamera) -> String {
    let RecognisedCamera {
        venue,
        camera,
        change,
        tried,
        answered,
        aligned,
        nats,
    } = recognised;
    format!(
        "venue {venue}, camera {camera}: {change}; {answered} of {tried} frames show what it saw, \
         {aligned} of them lie on their paint, evidence {nats:.0} nats"
    )
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
    // Shares of paint and lines are measured by the search of a panorama alone, not on courts and
    // with the camera of a venue.
    if evidence.lines.is_empty() {
        let frames = pluralise(evidence.frames, "frame");
        messages.note(&format!("{frames}; evidence {:.0} nats", evidence.nats));
        return;
    }
    if let Some(aspect) = &evidence.pixel_aspect {
        messages.note(&aspect.to_string());
    }
    messages.note(&format!(
        "{}; evidence {:.0} nats{}, {:.0} % of the paint explained, {:.0} % of the lines seen ({} by name), \
         paint {:.2} px off its lines, parts of the frames {:.2} m apart",
        pluralise(evidence.frames, "frame"),
        evidence.nats,
        evidence
            .runner_up_nats
            .map_or_else(String::new, |nats| format!(" (next best position {nats:.0})")),
        100.0 * evidence.explained,
        100.0 * evidence.visible,
        evidence.lines.len(),
        evidence.residual_px,
        evidence.parts_m,
    ));
}
