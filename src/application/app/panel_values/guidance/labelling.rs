//! The next step while a frame is labelled: what its clicks determine so far, what its camera is if
//! it comes from elsewhere, and which click helps most.

use super::Guidance;
use crate::app::{App, Command};
use touchline_calibration::calibrate::CalibrationError;
use touchline_core::solve::{ClickResidual, SolveError, Verdict};
use touchline_documents::document::{Frame, FrameStatus, SolutionSource};

/// The frame is being labelled: what the clicks determine so far.
pub(super) fn guide_labelling(app: &App, frame: &Frame) -> Guidance {
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
    use super::super::tests::{camera, click, opened, said};
    use super::*;
    use crate::app::{Action, Opened};
    use touchline_core::camera::Ptz;
    use touchline_documents::testing::{ptz_at, solved_by};

    #[test]
    fn a_proposal_says_what_the_dashes_mean() {
        let mut app = opened(true, 1);
        let mut document = app.open().unwrap().document.clone();
        document.frames[0].ptz = ptz_at(5.0, -9.0, 1800.0);
        document.frames[0].status = FrameStatus::Suggested;
        document.frames[0].solution = solved_by(SolutionSource::Forest);
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
        frame.ptz = ptz_at(0.3, -10.0, 1000.0);
        frame.solution = solved_by(SolutionSource::Markings);
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
