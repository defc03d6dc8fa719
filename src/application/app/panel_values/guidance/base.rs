//! The next step while the base of a camera is missing, is being estimated, or has been estimated
//! and waits for the user's decision.

use super::Guidance;
use crate::app::{App, Command};
use touchline_calibration::calibrate::{LANDMARKS_ALONE, points_alone};
use touchline_core::geometry::pluralise;
use touchline_documents::document::{Frame, FrameStatus};

/// A base is being estimated, or waits for the user's decision.
pub(super) fn guide_base_estimate(app: &App) -> Option<Guidance> {
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
pub(super) fn guide_without_base(app: &App, frame: &Frame) -> Option<Guidance> {
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

#[cfg(test)]
mod tests {
    use super::super::next_step;
    use super::super::tests::{camera, click, opened, said};
    use super::*;
    use touchline_core::camera::Ptz;

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
}
