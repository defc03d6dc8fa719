//! The next step for the user, as the status row shows it.

use super::progress::{ALL_DONE, missing_references};
use crate::app::window_state::session::{Mode, reason_label};
use crate::app::{App, Command};
use touchline_calibration::calibrate::{CalibrationError, LANDMARKS_ALONE, points_alone};
use touchline_core::geometry::pluralise;
use touchline_core::solve::{ClickResidual, SolveError, Verdict};
use touchline_documents::document::{Frame, FrameStatus, SolutionSource, Target};

/// The next step, and commands that help with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Guidance {
    /// One or two sentences.
    pub text: String,
    /// Labels and commands of the buttons.
    pub offers: Vec<(&'static str, Command)>,
}

impl Guidance {
    fn say(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            offers: Vec::new(),
        }
    }

    fn with_button(mut self, says: &'static str, command: Command) -> Self {
        self.offers.push((says, command));
        self
    }
}

/// The next step for the user.
///
/// The first case that applies decides: reading a document, no document, running work, the quality
/// page, an action that was begun, an estimated base, and then the state of the shown frame.
#[must_use]
pub fn next_step(app: &App) -> Guidance {
    if let Some(opening) = &app.session.disk.opening {
        return Guidance::say(opening.clone());
    }
    if app.open().is_none() {
        return Guidance::say("Open a video, a folder of frames or a project, or drop one here.");
    }
    let Some(frame) = app.frame() else {
        return Guidance::say("This document has no frames. Open a folder of frames or a video.");
    };
    if let Some(under_way) = app
        .operations
        .under_way()
        .filter(|_| app.session.mode == Mode::Idle)
    {
        return Guidance::say(under_way.text).with_button("Stop", under_way.stop);
    }
    if app.session.quality.open {
        let key = app.settings.keys.key_or_name(Command::QualityPage);
        return Guidance::say(format!(
            "Click a point to look at its frame; {key} or Esc goes back to the picture."
        ));
    }
    // From what the user is in the middle of to what the frame lacks.
    begun(app)
        .or_else(|| guide_base_estimate(app))
        .or_else(|| stretch(app))
        .or_else(|| {
            app.session
                .is_next_on_line()
                .then(|| Guidance::say("Click a spot on a line, then name the line."))
        })
        .or_else(|| other_picture(app))
        .or_else(|| guide_unnamed_click(frame))
        // An accepted frame still needs a base, which is then more urgent than the next frame.
        .or_else(|| no_base(app, frame).filter(|_| frame.status == FrameStatus::Reference))
        .or_else(|| guide_decided_frame(app, frame))
        .or_else(|| no_base(app, frame))
        .unwrap_or_else(|| clicks(app, frame))
}

/// The user has begun something.
fn begun(app: &App) -> Option<Guidance> {
    Some(Guidance::say(match &app.session.mode {
        Mode::Idle => return None,
        Mode::Dragging { .. } => {
            "Release the button where the point belongs. Esc puts it back.".to_owned()
        }
        Mode::Naming(naming) if naming.listed_candidates().is_empty() => {
            format!(
                "Nothing matches “{}”. Press Backspace or Esc.",
                naming.typed
            )
        }
        Mode::Naming(_) => {
            "What is it? 1–5 chooses, letters filter, Enter takes the first.".to_owned()
        }
        Mode::Placing(target) => {
            format!("Click {} in the picture. Esc cancels.", app.label(target))
        }
        Mode::Rejecting { whole_shot } => {
            let what = if *whole_shot {
                "this shot"
            } else {
                "this frame"
            };
            format!("Why is {what} not calibratable? Choose with 1–6, Esc cancels.")
        }
        Mode::ClickingAgain(round) => {
            let target = round
                .target()
                .map(|target| app.label(&Target::Landmark(target.landmark.clone())))?;
            let skip = app.settings.keys.key_or_name(Command::SkipAgain);
            format!("Click {target}, as you would label it. {skip} skips it, Esc ends the round.")
        }
        Mode::Editing => "Enter keeps the number, Esc restores it.".to_owned(),
    }))
}

/// Frames that are selected: what is accepted now are these.
fn stretch(app: &App) -> Option<Guidance> {
    let count = app.stretch_size()?;
    let (open, selected) = (app.open()?, &app.session.frames_selected);
    let (first, last) = (*selected.first()?, *selected.last()?);
    let keys = &app.settings.keys;
    let text = format!(
        "{} selected, {} to {}. {} counts those on the painted lines, {} lets go.",
        pluralise(count, "frame"),
        open.frame_number(first),
        open.frame_number(last),
        keys.key_or_name(Command::Accept),
        keys.key_or_name(Command::Cancel)
    );
    Some(Guidance::say(text).with_button("Accept…", Command::AcceptStretch))
}

/// The frame is accepted or rejected.
fn guide_decided_frame(app: &App, frame: &Frame) -> Option<Guidance> {
    match frame.status {
        FrameStatus::Rejected => {
            let why = frame
                .reason
                .map(|reason| format!(": {}", reason_label(reason).to_lowercase()))
                .unwrap_or_default();
            Some(Guidance::say(format!(
                "Not calibratable{why}. X removes the mark, N goes on."
            )))
        }
        FrameStatus::Reference if app.open().is_some_and(|open| open.counts().to_do == 0) => {
            Some(Guidance::say(ALL_DONE).with_button("Export…", Command::Export))
        }
        FrameStatus::Reference => {
            let label_next = app.review().advice.next.is_some() && only_labels_help(app);
            Some(match app.where_to_label().filter(|_| label_next) {
                Some(text) => Guidance::say(text).with_button("Go there", Command::NextUnanswered),
                None => Guidance::say(reference_text(app)),
            })
        }
        FrameStatus::New | FrameStatus::Draft | FrameStatus::Suggested => None,
    }
}

/// The text for an accepted frame.
fn reference_text(app: &App) -> String {
    let Some(open) = app.open() else {
        return String::new();
    };
    let (left, missing) = (open.counts().to_do, missing_references(open.counts()));
    let label = app.frame().is_some_and(|frame| {
        frame.status == FrameStatus::Reference && !frame.is_used_for_training()
    });
    match missing {
        _ if label => {
            format!("Accepted (not used for training). N goes to the next of {left} to do.")
        }
        0 => format!("Reference. N goes to the next of {left} to do; a click here changes it."),
        missing => {
            format!(
                "Reference saved. {missing} more, spread left to right, and proposals become useful."
            )
        }
    }
}

/// Whether only frames without an answer are to do. Then a label elsewhere helps more than going
/// through them.
fn only_labels_help(app: &App) -> bool {
    app.open()
        .is_some_and(|open| open.counts().to_do == open.counts().unanswered)
}

/// The picture is not the one that was labelled, so that any work would refer to another moment.
fn other_picture(app: &App) -> Option<Guidance> {
    app.other_picture(app.session.frame)?;
    Some(Guidance::say(
        "This is not the picture that was labelled. Put the right file in its place and open the project again.",
    ))
}

/// A click of the frame has no name.
fn guide_unnamed_click(frame: &Frame) -> Option<Guidance> {
    let index = frame.unnamed_click()?;
    let text = format!(
        "Point {} has no name. Name it, or delete it with Del.",
        index + 1
    );
    Some(Guidance::say(text).with_button("Name it", Command::NameNext))
}

/// A base is being estimated, or waits for the user's decision.
fn guide_base_estimate(app: &App) -> Option<Guidance> {
    if let Some(under_way) = app.operations.base_under_way() {
        return Some(Guidance::say(under_way.text).with_button("Stop", under_way.stop));
    }
    app.operations.proposed_base()?;
    let proposal = app.current().proposal.as_ref();
    let is_drawn = proposal.is_some_and(|proposal| proposal.camera.is_some());
    // Only a camera that has a base has another one to look at.
    let held = if app.current().base.is_some() {
        app.settings.keys.with_key(Command::Compare, |key| {
            format!(
                "Lines and numbers are those of the estimated base. Hold {key} for the current one."
            )
        })
    } else {
        String::new()
    };
    Some(Guidance::say(match proposal {
        None => "The estimated base is of another camera. Go to one of its frames to see it.",
        Some(_) if !is_drawn => {
            "This frame has no points to draw the estimated base with. Step to one that has."
        }
        Some(_) if held.is_empty() => {
            "Lines and numbers are those of the estimated base. Step through the frames and check them."
        }
        Some(_) => held.as_str(),
    }))
}

/// The camera has no base: what is needed for it.
fn no_base(app: &App, frame: &Frame) -> Option<Guidance> {
    if app.current().base.is_some() || frame.status == FrameStatus::Rejected {
        return None;
    }
    let ready = app.base_readiness();
    if ready.is_enough() {
        let text = format!(
            "{} are enough to estimate the base. More frames improve it.",
            pluralise(ready.wide, "frame")
        );
        return Some(
            Guidance::say(text).with_button("Estimate the base now", Command::EstimateBase),
        );
    }
    // What the points of this frame lack: a few more, nothing, or all of them.
    let here = points_alone(frame);
    let text = match LANDMARKS_ALONE.saturating_sub(here) {
        missing @ 1..LANDMARKS_ALONE => {
            format!(
                "{here} of {LANDMARKS_ALONE} landmarks or lines here; {missing} more, spread over the picture. {}",
                ready.describe()
            )
        }
        0 => format!(
            "This frame has enough points. Now one that looks elsewhere. {}",
            ready.describe()
        ),
        _ => format!("Two clicks need a known camera. {}", ready.describe()),
    };
    // Other ways to a base: automatic, from another document, by hand, or from too few frames.
    let mut guidance = Guidance::say(text);
    if ready.frames == 0 && app.why_not(Command::FindCamera).is_none() {
        guidance = guidance.with_button("Find the camera automatically", Command::FindCamera);
    }
    guidance = guidance.with_button("Load a camera", Command::LoadCamera);
    guidance = if ready.wide == 0 {
        guidance.with_button("Enter it", Command::CameraPanel)
    } else {
        guidance.with_button("Estimate anyway", Command::EstimateBase)
    };
    Some(guidance)
}

/// The frame is being labelled: what the clicks determine so far.
fn clicks(app: &App, frame: &Frame) -> Guidance {
    let current = app.current();
    if current.by_hand {
        return Guidance::say(
            "Numbers set manually. Enter accepts them; placing a point solves from the points again.",
        );
    }
    if frame.is_snapped() {
        return Guidance::say(snapped_frame_text(app, frame));
    }
    // While the clicks do not suffice, say what is missing, unless the frame shows a proposal,
    // which the last arm explains.
    match &current.solution {
        Some(Ok(_)) => Guidance::say(
            match current
                .judgement
                .as_ref()
                .map(|judgement| judgement.verdict)
            {
                Some(Verdict::Wrong) => {
                    "There is a contradiction: read the verdict before you accept."
                }
                Some(Verdict::Check) if current.next_clicks.is_empty() => {
                    "Check the lines, then press Enter to accept."
                }
                Some(Verdict::Check) => {
                    "Check the lines, then press Enter to accept. One more point far away helps."
                }
                Some(Verdict::Good) | None => {
                    "Press Enter to accept and go on. Drag a point to refine it."
                }
            },
        ),
        Some(Err(CalibrationError::Solve(SolveError::TooFewObservations { equations })))
            if proposal_source(frame).is_none() =>
        {
            Guidance::say(match equations {
                0 => first_point().to_owned(),
                1 => "One point on a line. Now a spot you see exactly, far from it.".to_owned(),
                _ => format!("Now one far away: {} px or more.", far_px(frame)),
            })
        }
        Some(Err(error)) if proposal_source(frame).is_none() => {
            Guidance::say(format!("No camera yet: {error}."))
        }
        _ => match proposal_source(frame) {
            Some(_) if frame.is_hopeless() => {
                Guidance::say(format!("No proposal that holds. {}", first_point()))
            }
            Some(_) => Guidance::say(format!(
                "Dashed = proposed{}. Enter takes it, a click corrects it, X rejects it.",
                if frame.is_snapped_proposal() {
                    " and aligned to the painted lines"
                } else {
                    ""
                }
            )),
            None if frame.is_unanswered() => {
                Guidance::say(format!("No proposal here. {}", first_point()))
            }
            None if current.camera.is_some() => Guidance::say(given_camera_text(app)),
            None => Guidance::say(first_point()),
        },
    }
}

/// The text for a frame without clicks whose camera came with the document.
fn given_camera_text(app: &App) -> &'static str {
    if app.is_contradicted(app.session.frame) {
        return "The painted lines lie elsewhere: drag a drawn line or ring to where it belongs.";
    }
    "This camera came with the document. Enter accepts it, a drawn line or ring can be dragged."
}

/// The text for a frame whose camera is aligned to the painted lines.
fn snapped_frame_text(app: &App, frame: &Frame) -> String {
    let residuals = app
        .current()
        .residuals
        .iter()
        .filter_map(ClickResidual::distance_px);
    let points = match residuals.max_by(f64::total_cmp) {
        Some(farthest_px) => format!("; points within {farthest_px:.1} px"),
        None => String::new(),
    };
    let (means, then) = match frame.status {
        FrameStatus::Suggested => (
            "Dashed = proposed and aligned",
            "Enter takes it, a click corrects it, X rejects it.",
        ),
        _ => (
            "Aligned",
            "Enter accepts it, a click solves from the points.",
        ),
    };
    let before = if app.before_snap().is_some() {
        let keys = &app.settings.keys;
        keys.with_key(Command::Snap, |key| format!(" Hold {key}: before."))
    } else {
        String::new()
    };
    format!("{means} to the painted lines{points}. {then}{before}")
}

const fn first_point() -> &'static str {
    "Click a spot you see exactly. Best: where circle and halfway line meet."
}

/// Recommended distance between two points: 800 px, or 60 % of the width of a small picture.
fn far_px(frame: &Frame) -> u32 {
    800.min(frame.image_size.width / 10 * 6)
}

/// The source of the frame's camera, if it is neither from clicks nor set by hand.
fn proposal_source(frame: &Frame) -> Option<SolutionSource> {
    frame.ptz.as_ref()?;
    frame
        .source()
        .filter(|source| matches!(source, SolutionSource::Forest | SolutionSource::Tracking))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{Action, EditAction, Navigation, Opened, PointerAction};
    use touchline_core::camera::{BaseAngles, CameraBase, Ptz, PtzCamera};
    use touchline_core::geometry::{Angle, ImagePoint, ImageSize, Vec3};
    use touchline_documents::document::{
        Camera, Document, FieldSpec, FramePtz, RejectReason, Solution, Target,
    };

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    fn camera(ptz: Ptz) -> PtzCamera {
        let down = BaseAngles {
            pitch: Angle::from_degrees(-2.0),
            ..BaseAngles::default()
        };
        PtzCamera::new(
            CameraBase::new(
                Vec3::new(0.0, -60.0, 18.0),
                down.base_from_world(),
                SIZE.centre(),
            ),
            ptz,
        )
    }

    fn opened(with_base: bool, frames: usize) -> App {
        let mut document = Document::new(FieldSpec::new("soccer"));
        let mut main = Camera::new("main".into(), SIZE);
        if with_base {
            main.set_base(camera(Ptz::from_degrees(0.0, 0.0, 1.0)).base());
        }
        document.cameras.push(main.into());
        for index in 0..frames {
            document
                .frames
                .push(Frame::from_image(&format!("{index}.jpg"), "main".into(), SIZE).into());
        }
        App::with_document(document)
    }

    /// Clicks a landmark where a camera projects it.
    fn click(app: &mut App, landmark: &str, pointed: &PtzCamera) {
        let field = app.current().field().unwrap().clone();
        let at = pointed
            .image_from_world(field.landmark_in_world(field.landmark(landmark).unwrap()))
            .unwrap();
        app.update(Action::Edit(EditAction::Pick(Target::Landmark(
            landmark.into(),
        ))));
        app.update(Action::Pointer(PointerAction::Press { at, on: None }));
        app.update(Action::Pointer(PointerAction::Release));
    }

    fn said(app: &App) -> String {
        next_step(app).text
    }

    #[test]
    fn a_frame_is_led_from_the_first_click_to_the_reference() {
        let pointed = camera(Ptz::from_degrees(0.0, -10.0, 1000.0));
        assert!(said(&App::default()).starts_with("Open a video"));
        let mut app = opened(true, 5);
        assert!(said(&app).starts_with("Click a spot you see exactly."));
        click(&mut app, "centre_circle_halfway_near", &pointed);
        assert_eq!(said(&app), "Now one far away: 768 px or more.");
        click(&mut app, "penalty_area_far_left_front", &pointed);
        assert!(
            app.current().click_solution().is_some(),
            "{:?}",
            app.current().solution
        );
        assert!(said(&app).contains("Enter to accept"), "{}", said(&app));
        app.update(Action::Command(Command::AcceptAndStay));
        assert_eq!(
            said(&app),
            "Reference saved. 2 more, spread left to right, and proposals become useful."
        );
        app.update(Action::Command(Command::Reject));
        assert!(said(&app).starts_with("Why is this frame not calibratable?"));
        app.update(Action::Edit(EditAction::RejectAs(RejectReason::Blur)));
        app.update(Action::Navigate(Navigation::GoTo(0)));
        assert_eq!(
            said(&app),
            "Not calibratable: blur. X removes the mark, N goes on."
        );
    }

    #[test]
    fn a_camera_without_a_base_asks_for_one_and_counts() {
        let pointed = camera(Ptz::from_degrees(0.0, -12.0, 1000.0));
        let mut app = opened(false, 4);
        let step = next_step(&app);
        assert!(step.text.ends_with("Done: 0 of 3."), "{}", step.text);
        assert!(
            step.offers
                .contains(&("Load a camera", Command::LoadCamera)),
            "{step:?}"
        );
        let by_itself = ("Find the camera automatically", Command::FindCamera);
        assert_eq!(
            step.offers[0] == by_itself,
            cfg!(feature = "opencv"),
            "{step:?}"
        );
        for landmark in [
            "centre_mark",
            "halfway_far",
            "centre_circle_left",
            "centre_circle_right",
        ] {
            click(&mut app, landmark, &pointed);
        }
        assert!(said(&app).ends_with("Done: 1 of 3."), "{}", said(&app));
    }

    #[test]
    fn an_unnamed_point_comes_before_anything_else() {
        let mut app = opened(true, 1);
        app.update(Action::Pointer(PointerAction::Press {
            at: ImagePoint::new(300.0, 400.0),
            on: None,
        }));
        assert!(said(&app).starts_with("Release the button"));
        app.update(Action::Pointer(PointerAction::Release));
        assert!(said(&app).starts_with("What is it?"), "{}", said(&app));
        app.update(Action::Navigate(Navigation::TypeName("zzz".to_owned())));
        assert!(said(&app).starts_with("Nothing matches “zzz”."));
        app.session.mode = Mode::Idle;
        assert!(said(&app).starts_with("Point 1 has no name"));
        // The button names the point that the text mentions, whichever is selected.
        app.update(Action::Pointer(PointerAction::Press {
            at: ImagePoint::new(600.0, 300.0),
            on: None,
        }));
        app.update(Action::Pointer(PointerAction::Release));
        app.session.mode = Mode::Idle;
        app.session.points.selected = Some(1);
        let (_, offered) = next_step(&app).offers[0];
        app.update(Action::Command(offered));
        assert_eq!(app.session.points.selected, Some(0));
        assert!(matches!(&app.session.mode, Mode::Naming(naming) if naming.click == 0));
    }

    #[test]
    fn a_proposal_says_what_the_dashes_mean() {
        let mut app = opened(true, 1);
        let mut document = app.open().unwrap().document.clone();
        document.frames[0].ptz = Some(FramePtz::new(Ptz::from_degrees(5.0, -9.0, 1800.0), None));
        document.frames[0].status = FrameStatus::Suggested;
        document.frames[0].solution = Some(Solution {
            source: Some(SolutionSource::Forest),
            ..Solution::default()
        });
        app.update(Action::Opened(Box::new(Opened::new(
            document,
            "/match/project.json",
        ))));
        assert!(said(&app).starts_with("Dashed = proposed."));
    }

    #[test]
    fn a_snapped_frame_says_what_its_lines_are_and_how_far_the_points_lie_from_them() {
        let pointed = camera(Ptz::from_degrees(0.0, -10.0, 1000.0));
        let mut app = opened(true, 1);
        click(&mut app, "centre_circle_halfway_near", &pointed);
        click(&mut app, "penalty_area_far_left_front", &pointed);
        let mut document = app.open().unwrap().document.clone();
        let frame = &mut document.frames[0];
        // 0.3° to the right of the points' solution: 5 px at the centre, more towards the borders.
        frame.ptz = Some(FramePtz::new(Ptz::from_degrees(0.3, -10.0, 1000.0), None));
        frame.solution = Some(Solution {
            source: Some(SolutionSource::Markings),
            ..Solution::default()
        });
        app.update(Action::Opened(Box::new(Opened::new(
            document.clone(),
            "/match/project.json",
        ))));
        let residuals = [0, 1].map(|click| {
            app.current()
                .residual(click)
                .and_then(ClickResidual::distance_px)
                .unwrap()
        });
        assert!(
            residuals.iter().all(|px| (5.0..7.0).contains(px)),
            "{residuals:?}"
        );
        let farthest_px = residuals[0].max(residuals[1]);
        let text = format!(
            "Aligned to the painted lines; points within {farthest_px:.1} px. Enter accepts it"
        );
        assert!(said(&app).starts_with(&text), "{}", said(&app));
        document.frames[0].clicks.clear();
        document.frames[0].status = FrameStatus::Suggested;
        app.update(Action::Opened(Box::new(Opened::new(
            document,
            "/match/project.json",
        ))));
        let text = said(&app);
        assert!(
            text.starts_with("Dashed = proposed and aligned to the painted lines. Enter takes it"),
            "{text}"
        );
    }
}
