//! How far a search for cameras is, as its card shows it.

use crate::app::operations::{OperationStep, clip_tracking};
use crate::app::sentence;
use std::sync::{Arc, Mutex, PoisonError};
use touchline_calibration::autocalibrate::{AutocalibrationProgress, SearchedPanorama};
use touchline_calibration::pipelines::{LearningProgress, MatchEvent, TrackingEvent};
use touchline_core::progress::Share;

/// Makes steps of the events of a search. The panorama comes with some events, and is shown with
/// those that follow.
#[derive(Debug, Default)]
pub struct SearchSteps {
    panorama: Mutex<Option<Arc<SearchedPanorama>>>,
}

impl SearchSteps {
    /// The step of the search for one camera.
    pub fn of_search(&self, event: &AutocalibrationProgress) -> OperationStep {
        let share = Some(event.share_of_step() as f32);
        let step = OperationStep::new(sentence(&event.to_string()), share);
        let mut known = self.panorama.lock().unwrap_or_else(PoisonError::into_inner);
        match event {
            // The frames of another camera, or more of them.
            AutocalibrationProgress::Looking { .. } => *known = None,
            AutocalibrationProgress::Trying { panorama, .. } => known.clone_from(panorama),
            _ => {}
        }
        let panorama = known.clone();
        OperationStep { panorama, ..step }
    }

    /// The step of the search for all cameras of a video. None for events between two steps.
    pub fn of_match(&self, event: &MatchEvent) -> Option<OperationStep> {
        let (step, done) = match event {
            MatchEvent::Searching(event) => return Some(self.of_search(event)),
            MatchEvent::Tracking(TrackingEvent::Progress(step)) => {
                return Some(clip_tracking::step_of(step));
            }
            MatchEvent::FindingShots(done) => ("Looking for cuts".to_owned(), Some(*done)),
            MatchEvent::Learning(LearningProgress::Features { done, of }) => (
                "Learning from the frames that were found".to_owned(),
                Some(Share::new(*done, *of)),
            ),
            MatchEvent::Asking { done, of } => (
                "Answering the other shots".to_owned(),
                Some(Share::new(*done, *of)),
            ),
            MatchEvent::Tracking(TrackingEvent::Refining(camera)) => (
                format!("Refining the base of {} on the paint", camera.as_str()),
                None,
            ),
            _ => return None,
        };
        Some(OperationStep::new(step, done.map(Share::fraction)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::base_at;

    #[test]
    fn a_panorama_is_shown_until_another_camera_is_searched() {
        let panorama = Arc::new(SearchedPanorama {
            base: base_at([0.0, -60.0, 15.0], ImageSize::new(64, 36)),
            field: None,
            frames: Vec::new(),
            paint: Vec::new(),
        });
        let steps = SearchSteps::default();
        let shown = |event| steps.of_search(&event).panorama;
        let [done, of] = [1, 5];
        let trying = AutocalibrationProgress::Trying {
            places: 7,
            done,
            of,
            panorama: Some(Arc::clone(&panorama)),
        };
        assert_eq!(shown(AutocalibrationProgress::Gathering), None);
        assert_eq!(shown(trying), Some(Arc::clone(&panorama)));
        assert_eq!(
            shown(AutocalibrationProgress::Adjusting { done, of }),
            Some(panorama)
        );
        assert_eq!(shown(AutocalibrationProgress::Looking { done, of }), None);
    }
}
