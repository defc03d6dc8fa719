//! Advice where to label next, as one sentence for the panels, the status row and the command line.

use crate::app::App;
use touchline_calibration::proposals::{LabelAdvice, LabelNext};

impl App {
    /// How many frames lack an answer, and which frame to label next: the frame to which the
    /// command "Where to label next" goes. None if every frame has an answer.
    pub fn where_to_label(&self) -> Option<String> {
        let open = self.open()?;
        where_to_label(&self.review().advice, |frame| {
            format!("frame {}", open.frame_number(frame))
        })
    }
}

/// How many frames lack an answer or have an uncertain one, and which frame to label next. None if
/// every frame has an answer. `name` returns the name of a frame by its index.
pub fn where_to_label(advice: &LabelAdvice, name: impl Fn(usize) -> String) -> Option<String> {
    let without = match advice.unanswered {
        0 => None,
        1 => Some("1 frame has no answer".to_owned()),
        frames => Some(format!("{frames} frames have no answer")),
    };
    let unsure = match advice.uncertain {
        0 => None,
        1 => Some("1 uncertain".to_owned()),
        proposals => Some(format!("{proposals} uncertain")),
    };
    let all = advice.unanswered + advice.uncertain;
    let which = match (without, unsure) {
        (None, None) => return None,
        (Some(which), None) | (None, Some(which)) => which,
        (Some(without), Some(unsure)) => format!("{without}, {unsure}"),
    };
    // Advice needs features, hence a picture of at least one of the frames.
    let Some(LabelNext {
        frame,
        pan_deg,
        shared_by,
        missing_pan_deg,
    }) = advice.next
    else {
        let whose = if all == 1 {
            "its picture"
        } else {
            "their pictures"
        };
        return Some(format!("{which}: {whose} cannot be read."));
    };
    let name = name(frame);
    Some(match (pan_deg, missing_pan_deg) {
        (Some(pan_deg), _) if all == 1 => {
            format!("{which}: {name} (pan\u{a0}{}).", whole_degrees(pan_deg))
        }
        (Some(pan_deg), _) => {
            let one_of = if (2..all).contains(&shared_by) {
                format!("one of {shared_by} ")
            } else {
                String::new()
            };
            format!(
                "{which}: label {name}, {one_of}near pan\u{a0}{}.",
                whole_degrees(pan_deg)
            )
        }
        (None, Some(pan_deg)) if all > 1 => {
            let pan = whole_degrees(pan_deg);
            format!("{which}: label {name}. No reference looks near pan\u{a0}{pan}.")
        }
        (None, _) => format!("{which}: label {name}."),
    })
}

/// Degrees as text, with a minus sign at which no line breaks.
pub fn whole_degrees(degrees: f64) -> String {
    let sign = if degrees.round() < 0.0 { "−" } else { "" };
    format!("{sign}{:.0}°", degrees.round().abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_to_label_says_how_many_wait_and_where_they_look() {
        let next = |pan_deg, shared_by| LabelNext {
            frame: 3,
            pan_deg,
            shared_by,
            missing_pan_deg: Some(-31.4),
        };
        let said = |unanswered, uncertain, next| {
            where_to_label(
                &LabelAdvice {
                    unanswered,
                    uncertain,
                    next,
                },
                |frame| format!("frame {frame}"),
            )
        };
        let near = Some(next(Some(40.2), 12));
        assert_eq!(
            said(14, 0, near).unwrap(),
            "14 frames have no answer: label frame 3, one of 12 near pan\u{a0}40°."
        );
        assert_eq!(
            said(12, 0, near).unwrap(),
            "12 frames have no answer: label frame 3, near pan\u{a0}40°."
        );
        assert_eq!(
            said(14, 2, Some(next(None, 9))).unwrap(),
            "14 frames have no answer, 2 uncertain: label frame 3. No reference looks near pan\u{a0}−31°."
        );
        assert_eq!(
            said(0, 1, near).unwrap(),
            "1 uncertain: frame 3 (pan\u{a0}40°)."
        );
        assert_eq!(
            said(1, 0, Some(next(None, 1))).unwrap(),
            "1 frame has no answer: label frame 3."
        );
        assert_eq!(
            said(2, 0, None).unwrap(),
            "2 frames have no answer: their pictures cannot be read."
        );
        assert_eq!(said(0, 0, None), None);
    }
}
