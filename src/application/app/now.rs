//! What is going on, for the cards at the top of the side panel: the work that runs, the work that
//! will answer the shown frame, and what is missing for a base.

use crate::app::operations::UnderWay;
use crate::app::session::SidePanel;
use crate::app::trainer::TrainerActivity;
use crate::app::{App, Command};
use std::time::Duration;
use touchline_calibration::calibrate::{BaseReadiness, LANDMARKS_ALONE, points_alone};
use touchline_core::geometry::{pluralise, thousands};
use touchline_documents::document::{Frame, FrameId, FrameStatus, Target};

/// The trainer has a card if it needs at least this long. It runs for a moment after every
/// acceptance, and a card that comes and goes would move the panel each time.
const TRAINING_SHOWN: Duration = Duration::from_secs(10);

/// What a camera without a base lacks.
#[derive(Clone, Debug, PartialEq)]
pub struct MissingBase {
    /// Why the camera cannot be found without clicks; none if that can be tried.
    pub why_no_search: Option<&'static str>,
    /// What the clicks contribute so far.
    pub ready: BaseReadiness,
    /// The positions of frames with enough clicks, by the part of the field that is clicked: left,
    /// centre, right. A second frame of one part takes the next free place.
    pub views: [Option<usize>; 3],
    /// Why the last search found no camera, and the frame in which clicks help most.
    pub no_answer: Option<(String, Option<FrameId>)>,
    /// Whether lines are drawn that come from the clicks of the shown frame alone.
    pub lines_from_this_frame: bool,
}

impl App {
    /// The work that the user waits for, with its progress.
    pub fn under_way(&self) -> Vec<UnderWay> {
        self.operations
            .under_way()
            .chain(self.training_under_way())
            .collect()
    }

    fn training_under_way(&self) -> Option<UnderWay> {
        if self.session.panel == SidePanel::Trainer {
            // The panel shows the same.
            return None;
        }
        let status = &self.session.trainer.status;
        status.left.filter(|left| *left >= TRAINING_SHOWN)?;
        let share = status.doing.share()?.fraction();
        let step = status.doing.describe();
        let job = "Training and proposing";
        Some(UnderWay::new(job, step, Command::PauseTrainer).with_share(Some(share)))
    }

    /// What is missing for a base of the shown frame's camera. None if it has one, or if one is
    /// being looked for or waits for a decision.
    pub fn missing_base(&self) -> Option<MissingBase> {
        let open = self.open.as_ref()?;
        let camera = &self.frame()?.camera;
        let search = &self.operations.camera_search;
        if self.current.base.is_some() || self.operations.is_base_open() {
            return None;
        }
        let no_answer = search.no_answer.as_ref();
        let no_answer = no_answer.filter(|none| none.camera == *camera);
        let no_answer = no_answer.map(|none| (none.why.clone(), none.frame.clone()));
        let frames = open.document.frames.iter().enumerate();
        let wide = frames.filter(|(_, frame)| {
            frame.camera == *camera
                && frame.is_used_for_base()
                && points_alone(frame) >= LANDMARKS_ALONE
        });
        let mut views = [None; 3];
        for (index, frame) in wide {
            let place = self.clicked_third(frame).unwrap_or(1);
            // The part that is clicked, then the others from left to right.
            let place = [place, 0, 1, 2].into_iter().find(|at| views[*at].is_none());
            let Some(place) = place else { break };
            views[place] = Some(index);
        }
        Some(MissingBase {
            why_no_search: self.why_not(Command::FindCamera),
            ready: self.current.readiness,
            views,
            no_answer,
            lines_from_this_frame: self.current.preview.is_some(),
        })
    }

    /// The third of the field's length in which the middle of a frame's clicks lies, from the left.
    fn clicked_third(&self, frame: &Frame) -> Option<usize> {
        let field = self.current.field()?;
        let along: Vec<f64> = frame
            .clicks
            .iter()
            .filter_map(|click| match click.target.as_ref()? {
                Target::Landmark(id) => field.landmark(id.as_str()),
                Target::Line(_) => None,
            })
            .map(|landmark| field.landmark_in_world(landmark).x)
            .collect();
        let middle = along.iter().sum::<f64>() / along.len() as f64;
        // The origin of the field is its centre.
        let third = 1.5 + 3.0 * middle / field.length_m;
        middle.is_finite().then(|| third.clamp(0.0, 2.9) as usize)
    }

    /// Which running work will give the shown frame its camera, in one sentence. None if none will,
    /// or if the user has begun to click the frame.
    pub fn awaited_answer(&self) -> Option<String> {
        let (open, frame) = (self.open.as_ref()?, self.frame()?);
        if !frame.is_open() || !frame.clicks.is_empty() {
            return None;
        }
        if let Some((job, answers)) = self.operations.answering(frame) {
            let frames = open.document.frames.iter();
            let count = frames
                .filter(|frame| frame.is_open() && answers(frame))
                .count();
            return Some(match count {
                0 | 1 => format!("{job} for this frame."),
                _ => format!("{job} for {} frames, this one too.", thousands(count)),
            });
        }
        let doing = self.session.trainer.status.doing;
        let will_answer = matches!(
            doing,
            TrainerActivity::Features(_)
                | TrainerActivity::Training(_)
                | TrainerActivity::Proposing(_)
        );
        let waits = frame.status == FrameStatus::New && !frame.is_unanswered();
        (will_answer && waits && self.current.base.is_some()).then(|| {
            let references = self.session.trainer.status.references;
            format!(
                "The forest of {} will look at this frame.",
                pluralise(references, "reference")
            )
        })
    }
}
