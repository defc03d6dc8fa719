//! The next step while the base of a camera is missing, is being estimated, or has been estimated
//! and waits for the user's decision.

use super::Guidance;
use crate::app::{App, Command};
use touchline_calibration::calibrate::{LANDMARKS_ALONE, points_alone};
use touchline_documents::document::{Frame, FrameStatus};

/// A base is being estimated, or waits for the user's decision.
pub(super) fn guide_base_estimate(app: &App) -> Option<Guidance> {
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
pub(super) fn guide_without_base(app: &App, frame: &Frame) -> Option<Guidance> {
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
    use super::super::tests::{camera, click, opened, said};
    use touchline_core::camera::Ptz;

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
