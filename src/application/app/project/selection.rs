//! Several frames at once: the selection on the filmstrip, and the frames that a change applies to.

use crate::app::OpenProject;
pub use crate::app::window_state::choices::{Scope, Selecting};
use crate::app::window_state::session::Session;
use std::collections::BTreeSet;

impl Scope {
    /// The indices of the frames in the scope.
    pub fn frames(self, open: &OpenProject, session: &Session) -> Vec<usize> {
        let Some(shown) = open.frame(session.frame) else {
            return Vec::new();
        };
        let of_camera = open
            .document
            .frames
            .iter()
            .enumerate()
            .filter(|(_, frame)| frame.camera == shown.camera);
        match self {
            Self::Frame => vec![session.frame],
            Self::Selected => session.frames_selected.iter().copied().collect(),
            Self::Shot if shown.clip.is_none() => Vec::new(),
            Self::Shot => of_camera
                .filter(|(_, frame)| frame.clip == shown.clip)
                .map(|(index, _)| index)
                .collect(),
            Self::Onwards => of_camera
                .map(|(index, _)| index)
                .filter(|index| *index >= session.frame)
                .collect(),
        }
    }
}

/// The first and the last of each run of places that follow each other; the places ascend.
pub fn runs_of(places: impl Iterator<Item = usize>) -> Vec<[usize; 2]> {
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for place in places {
        match runs.last_mut() {
            Some([_, last]) if *last + 1 == place => *last = place,
            _ => runs.push([place; 2]),
        }
    }
    runs
}

/// The selection after a click on a frame of the filmstrip. A single frame is no selection; it is
/// just the shown frame.
pub(in crate::app) fn after_click(
    open: &OpenProject,
    session: &Session,
    frame: usize,
    how: Selecting,
) -> BTreeSet<usize> {
    let mut selected = session.frames_selected.clone();
    match how {
        Selecting::Range => {
            let (first, last) = (session.frame.min(frame), session.frame.max(frame));
            selected = (first..=last)
                .filter(|index| {
                    let frame = open.frame(*index);
                    frame.is_some_and(|frame| session.filter.shows(frame))
                })
                .collect();
        }
        Selecting::Toggle => {
            // The shown frame is the first of a selection that begins here.
            if selected.is_empty() {
                selected.insert(session.frame);
            }
            if !selected.remove(&frame) {
                selected.insert(frame);
            }
        }
    }
    if selected.len() < 2 {
        selected.clear();
    }
    selected
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::window_state::session::Filter;
    use crate::app::{Action, App, Navigation, ViewAction};
    use touchline_core::geometry::ImageSize;
    use touchline_documents::document::{Clip, FrameStatus};
    use touchline_documents::testing::{a_match, new_frame};

    fn app() -> App {
        let size = ImageSize::new(64, 36);
        let mut document = a_match(size);
        for index in 0..8 {
            let mut frame = new_frame("a.jpg", size);
            frame.clip = Some(Clip::Number(i64::from(index >= 5)));
            frame.status = if index == 3 {
                FrameStatus::Rejected
            } else {
                FrameStatus::New
            };
            document.frames.push(frame.into());
        }
        App::with_document(document)
    }

    fn selected(app: &App) -> Vec<usize> {
        app.session.frames_selected.iter().copied().collect()
    }

    #[test]
    fn shift_takes_a_range_and_ctrl_one_more_or_less() {
        let mut app = app();
        app.update(Action::Navigate(Navigation::GoTo(1)));
        app.update(Action::Navigate(Navigation::SelectFrame {
            frame: 4,
            how: Selecting::Range,
        }));
        assert_eq!(selected(&app), [1, 2, 3, 4]);
        app.update(Action::Navigate(Navigation::SelectFrame {
            frame: 2,
            how: Selecting::Toggle,
        }));
        app.update(Action::Navigate(Navigation::SelectFrame {
            frame: 6,
            how: Selecting::Toggle,
        }));
        assert_eq!(selected(&app), [1, 3, 4, 6]);
        app.update(Action::Navigate(Navigation::SelectFrame {
            frame: 0,
            how: Selecting::Range,
        }));
        assert_eq!(selected(&app), [0, 1]);
        app.update(Action::Navigate(Navigation::SelectFrame {
            frame: 0,
            how: Selecting::Toggle,
        }));
        assert!(selected(&app).is_empty(), "a lone frame is no selection");
        app.update(Action::View(ViewAction::SetFilter(Filter::ToDo)));
        app.update(Action::Navigate(Navigation::SelectFrame {
            frame: 4,
            how: Selecting::Range,
        }));
        assert_eq!(
            selected(&app),
            [1, 2, 4],
            "what the filter hides is not meant"
        );
        app.update(Action::Navigate(Navigation::SelectFrame {
            frame: 99,
            how: Selecting::Toggle,
        }));
        assert_eq!(selected(&app), [1, 2, 4]);
    }

    #[test]
    fn a_scope_names_its_frames() {
        let mut app = app();
        app.update(Action::Navigate(Navigation::GoTo(5)));
        let frames = |scope: Scope| scope.frames(app.open().unwrap(), &app.session);
        assert_eq!(
            Scope::ALL.map(frames),
            [vec![5], vec![], vec![5, 6, 7], vec![5, 6, 7]]
        );
    }
}
