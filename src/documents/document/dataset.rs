//! A document as a dataset, for users of the labels.

use super::{Click, Document, DocumentAt, Frame, Ground, SolutionWarning};
use touchline_core::field::FieldError;
use touchline_core::solve::WarningCode;

impl DocumentAt<'_> {
    /// The document as a dataset ([`Document::into_dataset`]) that states what its cameras are
    /// good for on the ground.
    ///
    /// # Errors
    /// A field of the document is not valid.
    pub fn to_dataset(self) -> Result<Document, FieldError> {
        let grounds = self.ground_of_frames()?;
        let mut dataset = self.document.clone().into_dataset();
        dataset.state_ground(grounds);
        Ok(dataset)
    }
}

impl Document {
    /// The document as a dataset: without unnamed clicks (indices of clicks are updated), and with
    /// a warning at every solved frame whose field's size is assumed, and at no other.
    #[must_use]
    pub fn into_dataset(mut self) -> Self {
        for frame in &mut self.frames {
            if frame.clicks.iter().any(|click| click.target.is_none()) {
                frame.retain_clicks(|_, click| click.target.is_some());
            }
        }
        self.report_assumed_sizes();
        self
    }

    /// States what the camera of every frame is good for on the ground, and nothing where a frame
    /// has none; `grounds` are in the order of the frames ([`DocumentAt::ground_of_frames`]).
    pub fn state_ground(&mut self, grounds: Vec<Option<Ground>>) {
        for (frame, ground) in self.frames.iter_mut().zip(grounds) {
            let stated = frame
                .solution
                .as_ref()
                .and_then(|known| known.ground.as_ref());
            if stated != ground.as_ref() {
                frame.solution.get_or_insert_default().ground = ground;
            }
        }
    }

    /// Adds a warning to every solved frame whose field's size is assumed.
    fn report_assumed_sizes(&mut self) {
        let code = WarningCode::FieldAssumed.as_str();
        for index in 0..self.frames.len() {
            // By index, because the message depends on the whole document while the frame changes.
            let frame = &self.frames[index];
            let message = self.field_of(frame).describe_assumed_size();
            let message = message.filter(|_| frame.ptz.is_some());
            let has_warning = frame
                .solution
                .as_ref()
                .is_some_and(|solution| solution.warnings.iter().any(|known| known.code == code));
            if message.is_none() && !has_warning {
                continue;
            }
            // An earlier warning of this kind is replaced: exporting twice must not state it
            // twice, and a size that was confirmed since is assumed no longer.
            let solution = self.frames[index].solution.get_or_insert_default();
            solution.warnings.retain(|warning| warning.code != code);
            solution
                .warnings
                .extend(message.map(|message| SolutionWarning::new(code, message)));
        }
    }
}

impl Frame {
    /// Keeps some of its clicks, chosen by their indices; the solution's indices of clicks are
    /// updated.
    pub fn retain_clicks(&mut self, stays: impl Fn(usize, &Click) -> bool) {
        // The new index of each click that stays: the number of those before it.
        let mut staying = 0..;
        let new_indices: Vec<Option<usize>> = self
            .clicks
            .iter()
            .enumerate()
            .map(|(index, click)| stays(index, click).then(|| staying.next()).flatten())
            .collect();
        let mut new_index = new_indices.iter();
        self.clicks
            .retain(|_| new_index.next().is_some_and(Option::is_some));
        if let Some(solution) = &mut self.solution {
            solution
                .disputed
                .retain_mut(|click| renumber(click, &new_indices));
            for warning in &mut solution.warnings {
                warning
                    .clicks
                    .retain_mut(|click| renumber(click, &new_indices));
                warning
                    .renames
                    .retain_mut(|rename| renumber(&mut rename.click, &new_indices));
            }
        }
    }
}

/// Replaces the index of a click by its new one. False if that click was removed.
fn renumber(click: &mut usize, new_indices: &[Option<usize>]) -> bool {
    let Some(new_index) = new_indices.get(*click).copied().flatten() else {
        return false;
    };
    *click = new_index;
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::FieldSize;
    use crate::testing::{a_match, new_frame, ptz_at};
    use touchline_core::geometry::ImageSize;

    #[test]
    fn a_dataset_says_so_at_every_solved_frame_once() {
        let size = ImageSize::new(1920, 1080);

        let mut document = a_match(size);
        for _ in 0..2 {
            document.frames.push(new_frame("a.jpg", size).into());
        }
        document.frames[0].ptz = ptz_at(0.0, -10.0, 2000.0);
        let warnings = |document: &Document| -> Vec<Vec<String>> {
            let solutions = document
                .frames
                .iter()
                .map(|frame| frame.solution.clone().unwrap_or_default());
            solutions
                .map(|solution| {
                    solution
                        .warnings
                        .into_iter()
                        .map(|warning| warning.code)
                        .collect()
                })
                .collect()
        };
        let again = document.clone().into_dataset().into_dataset();
        assert_eq!(warnings(&again), [vec!["field_assumed".to_owned()], vec![]]);
        assert_eq!(
            again.frames[0]
                .solution
                .as_ref()
                .unwrap()
                .warnings_of_frame()
                .count(),
            0
        );
        for mut stated in [document, again] {
            stated.field.size = Some(FieldSize::Confirmed);
            assert_eq!(
                warnings(&stated.into_dataset()),
                [vec![], Vec::<String>::new()]
            );
        }
    }
}
