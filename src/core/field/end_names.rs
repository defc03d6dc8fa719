//! The names of a field as they look from behind its end.
//!
//! Templates name near, far, left and right for a camera in the main stand. Who clicks a picture
//! from behind the left end and names it as it looks calls the left end near, and the far side
//! left: `corner_near_left` is what templates call `corner_far_left`. From behind the right end it
//! is the same, as fields look alike after half a turn.

use super::{FieldElement, FieldModel, LandmarkId, LineId};

impl FieldElement {
    /// The element that is meant by the name of this one if it was given as the picture looks from
    /// behind an end. The same where its name says nothing of both directions, or where the field
    /// has no such element.
    #[must_use]
    pub fn named_behind_an_end(self, field: &FieldModel) -> Self {
        let named = |id: &str, of: &dyn Fn(&str) -> Option<Self>| {
            name_behind_an_end(id).and_then(|meant| of(&meant))
        };
        let line = |id: &str| field.lines.iter().position(|line| line.id.as_str() == id);
        let meant = match self {
            Self::Landmark(index) => field
                .landmarks
                .get(index)
                .and_then(|landmark| named(landmark.id.as_str(), &|id| field.landmark_element(id))),
            Self::Line(index) => field
                .lines
                .get(index)
                .and_then(|of| named(of.id.as_str(), &|id| line(id).map(Self::Line))),
            Self::Paint(_) => None,
        };
        meant.unwrap_or(self)
    }
}

impl LandmarkId {
    /// The landmark that is meant by this name if it was given as the picture looks from behind an
    /// end; none if it is the same, or if the field has no such landmark.
    #[must_use]
    pub fn named_behind_an_end(&self, field: &FieldModel) -> Option<Self> {
        let meant = name_behind_an_end(self.as_str())?;
        field.landmark(&meant).map(|landmark| landmark.id.clone())
    }
}

impl LineId {
    /// The line that is meant by this name if it was given as the picture looks from behind an end;
    /// none if it is the same, or if the field has no such line.
    #[must_use]
    pub fn named_behind_an_end(&self, field: &FieldModel) -> Option<Self> {
        let meant = name_behind_an_end(self.as_str())?;
        let mut lines = field.lines.iter();
        lines
            .find(|line| line.id.as_str() == meant)
            .map(|line| line.id.clone())
    }
}

/// The template's name for what is called `name` from behind the left end. None if `name` does not
/// say both near or far and left or right.
fn name_behind_an_end(name: &str) -> Option<String> {
    let mut words: Vec<&str> = name.split('_').collect();
    let place = |of: [&str; 2]| words.iter().position(|word| of.contains(word));
    let (depth, side) = (place(["near", "far"])?, place(["left", "right"])?);
    let (is_near, is_left) = (words[depth] == "near", words[side] == "left");
    words[depth] = if is_left { "far" } else { "near" };
    words[side] = if is_near { "left" } else { "right" };
    Some(words.join("_"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::builtin;

    /// A picture from behind the left end has the far side on its left, and the left end below.
    #[test]
    fn corners_named_as_they_look_are_those_of_the_template_turned_by_a_quarter() {
        for (looks, is) in [
            ("corner_near_left", "corner_far_left"),
            ("corner_near_right", "corner_near_left"),
            ("corner_far_left", "corner_far_right"),
            ("corner_far_right", "corner_near_right"),
            ("yard_line_left_20_near", "yard_line_left_20_far"),
        ] {
            assert_eq!(name_behind_an_end(looks).as_deref(), Some(is));
        }
        assert_eq!(name_behind_an_end("service_t_left"), None);
        let tennis = builtin("tennis").unwrap().default_model().unwrap();
        let centre = LandmarkId::from("centre_mark_left");
        assert_eq!(centre.named_behind_an_end(&tennis), None);
        for landmark in &tennis.landmarks {
            let element = tennis.landmark_element(landmark.id.as_str()).unwrap();
            let back = (0..4).fold(element, |at, _| at.named_behind_an_end(&tennis));
            assert_eq!(back, element, "four quarters are a whole turn");
        }
    }
}
