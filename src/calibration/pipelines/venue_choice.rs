//! Which camera of the venues that a user has took the frames of a match.

use super::kept_search::SearchEnd;
use super::match_labels::{Labelling, MatchEvent};
use super::venue_trial::VenueAnswer;
use super::venues::{RecognisedCamera, Venue, VenueEvent, VenueRefusal};
use crate::autocalibrate::{AutocalibrationError, frames_of_fields, spread_over_shots_and_clicks};
use crate::calibrate::AutocalibratedCamera;
use std::collections::BTreeSet;
use std::sync::Arc;
use touchline_documents::document::{CameraId, Clip, FrameStatus};

/// Number of frames that are tried with each camera of the venues.
const TRIED: usize = 16;
/// Answers of two venues at places farther apart are two answers, m.
const SAME_PLACE_M: f64 = 1.5;
/// The best answer has to be better than one from another place by this much, nats.
const RUNNER_UP_NATS: f64 = 100.0;

impl Labelling<'_> {
    /// The camera of a venue that took the frames of `camera`, if there is one: the end of a search
    /// that was not needed, and the camera. The document then has the venue's field.
    ///
    /// # Errors
    /// The work was cancelled.
    pub(in crate::pipelines) fn find_in_venues(
        &mut self,
        camera: &CameraId,
    ) -> Result<Option<(SearchEnd, Arc<AutocalibratedCamera>)>, AutocalibrationError> {
        let options = self.options;
        if options.venues.is_empty() {
            return Ok(None);
        }
        // Features of a frame are extracted once, whatever the number of venues.
        let frames = self.frames_to_try(camera);
        let store = self.feature_store();
        let mut answers: Vec<(String, CameraId, VenueAnswer)> = Vec::new();
        for of_venue in options.venues.iter().flat_map(Venue::cameras) {
            let (venue, id) = (of_venue.venue.name.clone(), of_venue.camera.id.clone());
            let answer = self.try_venue(of_venue, camera, &frames, &store);
            if self.progress.is_cancelled() {
                return Err(AutocalibrationError::Stopped);
            }
            match answer {
                Ok(answer) => answers.push((venue, id, answer)),
                Err(why) => self.report_refusal(venue, id, why),
            }
        }
        // The best, unless another one answers nearly as well from another place.
        answers.sort_by(|(.., a), (.., b)| b.found.evidence.nats.total_cmp(&a.found.evidence.nats));
        let mut answers = answers.into_iter();
        let Some((venue, id, mut best)) = answers.next() else {
            return Ok(None);
        };
        let (at_m, nats) = (best.found.base.position_m, best.found.evidence.nats);
        let elsewhere =
            answers.find(|(.., other)| (other.found.base.position_m - at_m).norm() > SAME_PLACE_M);
        let runner_up_nats = elsewhere.as_ref().map(|(.., it)| it.found.evidence.nats);
        best.found.evidence.runner_up_nats = runner_up_nats;
        if let (Some((other, ..)), Some(of_other)) = (elsewhere, runner_up_nats)
            && nats < of_other + RUNNER_UP_NATS
        {
            let why = VenueRefusal::RunnerUp {
                nats,
                other,
                of_other,
            };
            self.report_refusal(venue, id, why);
            return Ok(None);
        }
        let recognised = RecognisedCamera {
            venue,
            camera: id,
            change: best.change,
            tried: frames.len(),
            answered: best.answered,
            aligned: best.found.frames.len(),
            nats,
        };
        let event = VenueEvent::Recognised(recognised);
        let _ = self.progress.report(MatchEvent::Venue(event));
        let end = self.end_of_trial(&frames, &best.found);
        // Another camera may look at another field.
        if self.document.cameras.len() == 1 {
            self.document.field = best.field;
        } else if let Some(camera) = self.document.camera_mut(camera) {
            camera.field = Some(best.field);
        }
        Ok(Some((end, Arc::new(best.found))))
    }

    fn report_refusal(&self, venue: String, camera: CameraId, why: VenueRefusal) {
        let event = VenueEvent::Refused { venue, camera, why };
        let _ = self.progress.report(MatchEvent::Venue(event));
    }

    /// The frames that are tried: a spread over the shots of a camera that show a field, and frames
    /// with clicks, which must not contradict what is found.
    fn frames_to_try(&self, camera: &CameraId) -> Vec<usize> {
        let frames = self.document.frames.iter().enumerate();
        let of_camera: Vec<usize> = frames
            .filter(|(_, frame)| frame.camera == *camera && frame.status != FrameStatus::Rejected)
            .map(|(index, _)| index)
            .collect();
        // Close-ups and transitions would only cost time.
        let of_fields = frames_of_fields(self.document, &of_camera);
        let is_clicked = |index: &&usize| !self.document.frames[**index].clicks.is_empty();
        let clicked: Vec<usize> = of_fields.iter().filter(is_clicked).copied().collect();
        spread_over_shots_and_clicks(self.document, &of_fields, &clicked, TRIED)
    }

    /// What a search would have said of the frames: those of shots without an answer are another
    /// camera's. A frame of a shot in which others are answered is this one's all the same.
    fn end_of_trial(&self, frames: &[usize], found: &AutocalibratedCamera) -> SearchEnd {
        let all = &self.document.frames;
        let answered = found.frames.iter();
        let known: BTreeSet<Option<&Clip>> = answered
            .map(|frame| all[frame.index].clip.as_ref())
            .collect();
        let (searched, others): (Vec<usize>, Vec<usize>) = frames
            .iter()
            .partition(|at| known.contains(&all[**at].clip.as_ref()));
        SearchEnd {
            stages: 1,
            searched,
            others,
            ..SearchEnd::default()
        }
    }
}
