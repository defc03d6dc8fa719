//! How far a search for cameras is, as its card shows it.

use crate::app::operations::{UnderWay, clip_tracking};
use crate::app::{Command, sentence};
use std::sync::{Arc, Mutex, PoisonError};
use touchline_calibration::autocalibrate::{AutocalibrationProgress, SearchedPanorama};
use touchline_calibration::pipelines::{LearningProgress, MatchEvent, TrackingEvent};
use touchline_core::progress::Share;

/// The present step of a search for one camera, or for all cameras of a video.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchStep {
    /// What is being done, in one sentence.
    step: String,
    /// The share of the step that is done, 0 to 1; none if it is unknown.
    share: Option<f32>,
    /// The panorama of the camera that is being searched; none while its frames are not matched.
    panorama: Option<Arc<SearchedPanorama>>,
}

impl SearchStep {
    fn new(step: &str, share: Option<f32>) -> Self {
        Self {
            step: sentence(step),
            share,
            panorama: None,
        }
    }

    /// The card of a search that is at this step; none before the first.
    pub(super) fn under_way(step: Option<&Self>, job: &str, stop: Command) -> UnderWay {
        let Some(at) = step else {
            return UnderWay::new(job, "Opening the pictures", stop);
        };
        UnderWay {
            panorama: at.panorama.clone(),
            ..UnderWay::new(job, &at.step, stop).with_share(at.share)
        }
    }
}

/// Makes steps of the events of a search. The panorama comes with some events, and is shown with
/// those that follow.
#[derive(Debug, Default)]
pub struct SearchSteps {
    panorama: Mutex<Option<Arc<SearchedPanorama>>>,
}

impl SearchSteps {
    /// The step of the search for one camera.
    pub fn of_search(&self, event: &AutocalibrationProgress) -> SearchStep {
        let step = SearchStep::new(&event.to_string(), Some(event.share_of_step() as f32));
        let mut known = self.panorama.lock().unwrap_or_else(PoisonError::into_inner);
        match event {
            // The frames of another camera, or more of them.
            AutocalibrationProgress::Looking { .. } => *known = None,
            AutocalibrationProgress::Trying { panorama, .. } => known.clone_from(panorama),
            _ => {}
        }
        let panorama = known.clone();
        SearchStep { panorama, ..step }
    }

    /// The step of the search for all cameras of a video. None for events between two steps.
    pub fn of_match(&self, event: &MatchEvent) -> Option<SearchStep> {
        Some(match event {
            MatchEvent::Searching(event) => self.of_search(event),
            MatchEvent::FindingShots(done) => {
                SearchStep::new("looking for cuts", Some(done.fraction()))
            }
            MatchEvent::Learning(LearningProgress::Features { done, of }) => {
                let share = Share::new(*done, *of).fraction();
                SearchStep::new("learning from the frames that were found", Some(share))
            }
            MatchEvent::Asking { done, of } => {
                let share = Share::new(*done, *of).fraction();
                SearchStep::new("answering the other shots", Some(share))
            }
            MatchEvent::Tracking(TrackingEvent::Progress(step)) => {
                let share = clip_tracking::share_of(step);
                SearchStep::new(&clip_tracking::describe_progress(step), share)
            }
            MatchEvent::Tracking(TrackingEvent::Refining(camera)) => {
                let camera = camera.as_str();
                SearchStep::new(&format!("refining the base of {camera} on the paint"), None)
            }
            _ => return None,
        })
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
