//! What the search for a camera says to the user: the camera that it found, or why it found none,
//! the view that is missing, and the clicks that would replace it.

use touchline_calibration::autocalibrate::{Abstention, Doubt, WantedClicks};
use touchline_calibration::calibrate::{AutocalibratedCamera, describe_size};
use touchline_core::field::LandmarkId;
use touchline_core::solve::base::FittedSize;
use touchline_documents::document::Document;

/// The result in two sentences: position, its 1-σ, and how many frames agree with their own paint.
pub fn describe_found(found: &AutocalibratedCamera) -> String {
    let sigma = found.base.sigma.position_m;
    let (aligned, frames) = (found.aligned_frame_count(), found.frames.len());
    let assumed: String = found
        .sizes
        .iter()
        .filter(|size| size.is_open)
        .map(describe_assumed)
        .collect();
    let pixels = found
        .evidence
        .pixel_aspect
        .map_or_else(String::new, |aspect| format!(" But {aspect}."));
    format!(
        "Camera found: {}, known to ±{:.1} m. {aligned} of {frames} frames match their painted \
         lines. Check a few, then accept.{assumed}{pixels}",
        describe_place(found),
        sigma.norm()
    )
}

/// A further sentence for a length of the field that the frames do not determine.
fn describe_assumed(size: &FittedSize) -> String {
    format!(" The field's {}.", describe_size(size))
}

/// The position of a camera, as text.
fn describe_place(found: &AutocalibratedCamera) -> String {
    let at = found.base.position_m;
    format!(
        "{:.1} m high, {:.1} m from the middle of the field",
        at.z,
        at.x.hypot(at.y)
    )
}

/// The reason for an abstention and a remedy, as text.
pub(super) fn describe_abstention(why: &Abstention, clicks_that_help: &str) -> String {
    let (why_not, missing) = (why_not(why), missing_view(why));
    format!("No camera was found: {why_not}. {missing}, or {clicks_that_help}.")
}

/// The reason for an abstention, as a part of a sentence.
fn why_not(why: &Abstention) -> String {
    match why {
        Abstention::Uncertain { doubts, .. } => {
            let doubts: Vec<String> = doubts.iter().map(Doubt::to_string).collect();
            format!("the best answer is not certain ({})", doubts.join("; "))
        }
        Abstention::NotConnected { frames, connected } => {
            format!("only {connected} of {frames} frames overlap with each other")
        }
        Abstention::LittlePaint { places } => {
            format!("only {places} places of paint agree between the frames")
        }
        other => other.to_string(),
    }
}

fn missing_view(why: &Abstention) -> String {
    match why {
        Abstention::NotConnected { .. } => {
            "Add frames in which the camera pans from one view to the next, all of one camera that \
             does not move"
                .to_owned()
        }
        Abstention::LittlePaint { .. } => {
            "Add wide frames: the centre circle and both penalty areas".to_owned()
        }
        Abstention::Uncertain { doubts, .. } => view_missing(doubts),
        Abstention::NoCourt => {
            "Check the field's sport, add pictures that show more of it".to_owned()
        }
        _ => "Check that the field's sport is the one in the pictures".to_owned(),
    }
}

/// The clicks in frames of `document` that would replace the missing view. `label` returns the
/// label of a landmark.
pub(super) fn clicks_that_help(
    why: &Abstention,
    clicks: Option<&WantedClicks>,
    document: &Document,
    label: impl Fn(&LandmarkId) -> String,
) -> String {
    match (why, clicks) {
        (Abstention::NotConnected { .. } | Abstention::NotTurning(_), _) => {
            "click 4 landmarks on 2 wide frames".to_owned()
        }
        (_, Some(clicks)) => {
            let landmarks = clicks.describe_landmarks(|id| format!("“{}”", label(id)));
            let number = document.frames[clicks.frame].number_at(clicks.frame);
            format!("click {landmarks} on frame {number} and look again")
        }
        (_, None) => "click 2 landmarks far from each other and look again".to_owned(),
    }
}

/// The view that would resolve the doubts.
fn view_missing(doubts: &[Doubt]) -> String {
    let lines = doubts.iter().find_map(|doubt| match doubt {
        Doubt::LinesMissing { lines } => Some(lines.join(", ")),
        _ => None,
    });
    if let Some(lines) = lines {
        return format!("A view of {lines} is missing: add frames that show it");
    }
    // Paint that no line of the field explains, or that lies beside the lines, points to a wrong
    // field.
    let points_to_field = doubts
        .iter()
        .any(|doubt| matches!(doubt, Doubt::Unexplained { .. }));
    if points_to_field {
        return "Check the field's size and sport, and whether other lines are painted there; add wide frames"
            .to_owned();
    }
    "Wide views of both ends and of the middle are missing: add such frames".to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{Frame, VideoFrame};
    use touchline_documents::testing::soccer_document;

    #[test]
    fn the_frame_to_click_in_has_the_number_that_the_window_shows() {
        let mut document = soccer_document();
        for index in [0, 25, 50] {
            let video = VideoFrame::new("match.mp4", index, None);
            let frame = Frame::from_video(video, "main".into(), ImageSize::new(64, 36));
            document.frames.push(frame.into());
        }
        let clicks = WantedClicks {
            frame: 2,
            landmarks: 2,
            named: Vec::new(),
        };
        let why = Abstention::NothingFits;
        let says = clicks_that_help(&why, Some(&clicks), &document, |_| String::new());
        assert_eq!(
            says,
            "click 2 landmarks far from each other on frame 50 and look again"
        );
    }
}
