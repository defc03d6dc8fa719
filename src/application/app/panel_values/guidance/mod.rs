//! The next step for the user, as the status row shows it.
//!
//! It goes from what the user is in the middle of to what the shown frame lacks. What a camera
//! without a base needs is said here, too; what the clicks of the frame determine so far, in
//! `labelling.rs`.

mod labelling;

use super::progress::{ALL_DONE, missing_references};
use crate::app::window_state::session::{Mode, reason_label};
use crate::app::{App, Command};
use labelling::guide_labelling;
use touchline_calibration::calibrate::{LANDMARKS_ALONE, points_alone};
use touchline_core::geometry::pluralise;
use touchline_documents::document::{Frame, FrameStatus, Target};

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
/// The first case that applies decides: reading a document, no document, the quality page, an
/// action that was begun, an estimated base, work that will answer the shown frame, and then its
/// state.
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
    if app.session.quality.open {
        // The page takes the place of the side panel, in which the work is shown otherwise.
        if let Some(work) = app.under_way().first() {
            let text = format!("{}. {}", work.job, work.step);
            return Guidance::say(text).with_button("Stop", work.stop);
        }
        let key = app.settings.keys.key_or_name(Command::QualityPage);
        return Guidance::say(format!(
            "Click a point to look at its frame; {key} or Esc goes back to the picture."
        ));
    }
    // From what the user is in the middle of to what the frame lacks.
    begun(app)
        .or_else(|| guide_base_estimate(app))
        .or_else(|| playing(app))
        .or_else(|| stretch(app))
        .or_else(|| {
            app.session
                .is_next_on_line()
                .then(|| Guidance::say("Click a spot on a line, then name the line."))
        })
        .or_else(|| other_picture(app))
        .or_else(|| guide_unnamed_click(frame))
        .or_else(|| guide_awaited_frame(app))
        // An accepted frame still needs a base, which is then more urgent than the next frame.
        .or_else(|| {
            guide_without_base(app, frame).filter(|_| frame.status == FrameStatus::Reference)
        })
        .or_else(|| guide_decided_frame(app, frame))
        .or_else(|| guide_without_base(app, frame))
        .unwrap_or_else(|| guide_labelling(app, frame))
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

/// Running work will answer the frame, so that no click is needed.
fn guide_awaited_frame(app: &App) -> Option<Guidance> {
    let says = app.awaited_answer()?;
    let next = app.settings.keys.key_or_name(Command::NextNeedsMe);
    Some(Guidance::say(format!(
        "{says} Review others meanwhile ({next}); a click here goes before it."
    )))
}

/// Suggestions are reviewed by playing them.
fn playing(app: &App) -> Option<Guidance> {
    let is_playing = app.session.video.playing;
    if !is_playing || app.why_not(Command::StopAtWrong).is_some() {
        return None;
    }
    let wrong = app.settings.keys.key_or_name(Command::StopAtWrong);
    let text = format!(
        "Watch the lines. {wrong} stops where they begin to be off and accepts what was before."
    );
    Some(Guidance::say(text).with_button("Wrong from here", Command::StopAtWrong))
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
            let (says, does) = if app.has_next_match() {
                ("Next match", Command::NextMatch)
            } else {
                ("Export…", Command::Export)
            };
            Some(Guidance::say(ALL_DONE).with_button(says, does))
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
            format!("Accepted. N goes to the next of {left} to do.")
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
    if app.operations.is_estimating_base() {
        return Some(Guidance::say(
            "The base is being estimated; its lines are shown before it is used.",
        ));
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

/// The camera has no base: what this frame can add to it. The card in the side panel says what is
/// missing as a whole, and has the buttons.
fn guide_without_base(app: &App, frame: &Frame) -> Option<Guidance> {
    if app.current().base.is_some() || frame.status == FrameStatus::Rejected {
        return None;
    }
    if app.base_readiness().is_enough() {
        let text = "These frames are enough to estimate the base. More frames improve it.";
        return Some(Guidance::say(text));
    }
    // What the points of this frame lack: a few more, nothing, or all of them.
    let here = points_alone(frame);
    Some(Guidance::say(match LANDMARKS_ALONE.saturating_sub(here) {
        missing @ 1..LANDMARKS_ALONE => format!(
            "{here} of {LANDMARKS_ALONE} landmarks or lines here; {missing} more, spread over the \
             picture."
        ),
        0 => "This frame has enough points. Next: a frame that looks elsewhere.".to_owned(),
        _ => format!(
            "First the program must know where the camera stands. Click {LANDMARKS_ALONE} \
             landmarks here, or have it found."
        ),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{Action, EditAction, Navigation, PointerAction};
    use touchline_core::camera::{Ptz, PtzCamera};
    use touchline_core::geometry::{ImagePoint, ImageSize};
    use touchline_core::testing::{landmark_in, turned_base};
    use touchline_documents::document::{Camera, RejectReason};
    use touchline_documents::testing::{WithFrames, soccer_document};

    const SIZE: ImageSize = ImageSize::new(1280, 720);

    pub(super) fn camera(ptz: Ptz) -> PtzCamera {
        PtzCamera::new(turned_base([0.0, -60.0, 18.0], [0.0, -2.0, 0.0], SIZE), ptz)
    }

    pub(super) fn opened(with_base: bool, frames: usize) -> App {
        let mut document = soccer_document();
        let mut main = Camera::new("main".into(), SIZE);
        if with_base {
            main.set_base(camera(Ptz::from_degrees(0.0, 0.0, 1.0)).base());
        }
        document.cameras.push(main.into());
        App::with_document(document.with_numbered(frames, SIZE))
    }

    /// Clicks a landmark where a camera projects it.
    pub(super) fn click(app: &mut App, landmark: &str, pointed: &PtzCamera) {
        let field = app.current().field().unwrap().clone();
        let at = landmark_in(pointed, &field, landmark);
        app.update(Action::Edit(EditAction::Pick(Target::Landmark(
            landmark.into(),
        ))));
        app.update(Action::Pointer(PointerAction::Press { at, on: None }));
        app.update(Action::Pointer(PointerAction::Release));
    }

    pub(super) fn said(app: &App) -> String {
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
    fn a_camera_without_a_base_asks_for_one_and_counts() {
        let pointed = camera(Ptz::from_degrees(0.0, -12.0, 1000.0));
        let mut app = opened(false, 4);
        let missing = app.missing_base().unwrap();
        assert_eq!(missing.views, [None; 3]);
        assert_eq!(missing.why_no_search.is_none(), cfg!(feature = "opencv"));
        assert!(
            said(&app).starts_with("First the program must know"),
            "{}",
            said(&app)
        );
        for landmark in [
            "centre_mark",
            "halfway_far",
            "centre_circle_left",
            "centre_circle_right",
        ] {
            click(&mut app, landmark, &pointed);
        }
        assert_eq!(
            said(&app),
            "This frame has enough points. Next: a frame that looks elsewhere."
        );
        let missing = app.missing_base().unwrap();
        assert_eq!(
            missing.views,
            [None, Some(0), None],
            "its clicks are in the middle"
        );
    }
}
