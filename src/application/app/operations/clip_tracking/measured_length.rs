//! The length of the field, measured while a clip is tracked: it is told to the user, who may take
//! it over. A length that a person stated stays as it is.

use crate::app::operation::AsItWas;
use crate::app::window_state::session::Level;
use crate::app::{App, Command};
use touchline_calibration::calibrate::{BulkChange, LengthOnLines, take_length};
use touchline_core::geometry::pluralise;
use touchline_documents::document::Step;

/// The length of the field that the tracked frames require, as text.
fn describe_length(
    LengthOnLines {
        size,
        frames,
        is_prescribed,
        ..
    }: &LengthOnLines,
) -> String {
    let assumed = if *is_prescribed {
        "m is stated, and stays"
    } else {
        "m was assumed"
    };
    format!(
        "The painted lines of {} indicate a {} of {:.2} ± {:.2} m, where {} {assumed}.",
        pluralise(*frames, "frame"),
        size.name.trim_end_matches("_m"),
        size.value_m,
        size.sigma_m,
        size.assumed_m
    )
}

impl App {
    /// Reports another length of the field that the tracked frames require. Offers to use it if the
    /// document states none.
    pub(super) fn report_length(&mut self, found: LengthOnLines) {
        let text = describe_length(&found);
        if found.is_prescribed {
            self.session.notify(Level::Warning, text);
            return;
        }
        let then = self.open.as_ref().map(|open| (*open.document).clone());
        if let Some(last) = &mut self.operations.clip_tracking.last {
            last.length = then.map(|then| (found, then));
        }
        self.session
            .notify_with(Level::Warning, text, [("Take it", Command::TakeLength)]);
    }

    /// Uses the measured length; one step of undo. Frames with clicks are solved again; the others
    /// must be tracked again.
    pub(super) fn take_measured_length(&mut self) {
        let (Some(open), Some(last)) = (&self.open, &self.operations.clip_tracking.last) else {
            return;
        };
        let Some((found, then)) = &last.length else {
            return;
        };
        let now = &open.document;
        let since = AsItWas { then, now };
        let mut cameras = found.shifts.iter().map(|(camera, _)| camera);
        if !cameras.all(|camera| since.has_base_and_field(camera)) {
            let text = "The base or the field changed in the meantime; the measured length was \
                        discarded.";
            let offers = [("Track again", Command::Track)];
            return self.session.notify_with(Level::Info, text, offers);
        }
        let mut numbers = open.document.clone();
        take_length(&mut numbers, found);
        let change = BulkChange::Numbers(Box::new(numbers));
        self.change_in_bulk(
            Step::on_document("Take the measured length"),
            change,
            |app, _| {
                if let Some(last) = &mut app.operations.clip_tracking.last {
                    last.length = None;
                }
                app.session.retract(Command::TakeLength);
                let text =
                    "The measured length was taken. Track the cameras through the shot again.";
                app.session
                    .notify_with(Level::Info, text, [("Track again", Command::Track)]);
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Action;
    use crate::app::operations::clip_tracking::tests::app;
    use touchline_core::geometry::Vec3;
    use touchline_core::solve::base::FittedSize;

    fn measured(is_prescribed: bool) -> LengthOnLines {
        let (assumed_m, value_m, sigma_m) = (105.0, 101.0, 0.3);
        let name = "length_m".to_owned();
        let size = FittedSize {
            name,
            assumed_m,
            value_m,
            sigma_m,
            position_sigma_m: Vec3::zeros(),
            is_open: false,
        };
        LengthOnLines {
            size,
            shifts: vec![("main".into(), Vec3::new(2.0, 0.0, 0.0))],
            frames: 4,
            is_prescribed,
        }
    }

    #[test]
    fn a_measured_length_is_suggested_and_applied_in_one_step() {
        let mut app = app();
        assert!(app.why_not(Command::TakeLength).is_some());
        app.report_length(measured(false));
        assert!(
            app.session.offers(Command::TakeLength) && app.why_not(Command::TakeLength).is_none()
        );
        let before = (*app.open().unwrap().document).clone();
        app.update(Action::Command(Command::TakeLength));
        let now = |app: &App| {
            let document = &app.open().unwrap().document;
            (
                document.field.params.get("length_m").copied(),
                document.cameras[0].position_m.map(|at| at.x),
            )
        };
        assert_eq!(now(&app), (Some(101.0), Some(3.0)));
        assert!(
            !app.session.offers(Command::TakeLength) && app.why_not(Command::TakeLength).is_some()
        );
        app.update(Action::Command(Command::Undo));
        assert_eq!(*app.open().unwrap().document, before);
    }

    #[test]
    fn a_stated_length_stays() {
        let mut app = app();
        app.report_length(measured(true));
        assert!(app.why_not(Command::TakeLength).is_some());
        let texts: Vec<&str> = app
            .session
            .messages
            .notices
            .iter()
            .map(|notice| notice.text.as_str())
            .collect();
        assert!(
            texts[0].ends_with(
                "indicate a length of 101.00 ± 0.30 m, where 105 m is stated, and stays."
            ),
            "{texts:?}"
        );
    }
}
