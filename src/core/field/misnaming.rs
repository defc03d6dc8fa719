//! Names of points that say the wrong side in a whole picture.
//!
//! Templates name near, far, left and right for a camera in the main stand. Who clicks a picture
//! from behind the left end and names it as it looks calls the left end near, and the far side
//! left: `corner_near_left` is what templates call `corner_far_left`. From behind the right end it
//! is the same, as fields look alike after half a turn. Who takes left for right, or near for far,
//! names a mirror image of the field, which no camera shows.

use super::{FieldElement, FieldModel, LandmarkId, LineId};

/// How names say the wrong sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Misnaming {
    /// As the picture looks from behind an end.
    BehindAnEnd,
    /// Left for right.
    LeftForRight,
    /// Near for far.
    NearForFar,
}

impl Misnaming {
    /// Every one.
    pub const ALL: [Self; 3] = [Self::BehindAnEnd, Self::LeftForRight, Self::NearForFar];

    /// The element that is meant by the name of another one. The same where its name says nothing
    /// of the sides in question, or where the field has no such element.
    pub fn meant_element(self, named: FieldElement, field: &FieldModel) -> FieldElement {
        let meant = match named {
            FieldElement::Landmark(index) => {
                let landmark = field.landmarks.get(index);
                landmark
                    .and_then(|landmark| self.meant_landmark(&landmark.id, field))
                    .and_then(|id| field.landmark_element(id.as_str()))
            }
            FieldElement::Line(index) => field.lines.get(index).and_then(|line| {
                let meant = self.meant_line(&line.id, field)?;
                let mut lines = field.lines.iter();
                lines
                    .position(|line| line.id == meant)
                    .map(FieldElement::Line)
            }),
            FieldElement::Paint(_) => None,
        };
        meant.unwrap_or(named)
    }

    /// The landmark that is meant by a name; none if it is the same, or if the field has no such
    /// landmark.
    pub fn meant_landmark(self, named: &LandmarkId, field: &FieldModel) -> Option<LandmarkId> {
        let meant = self.meant_name(named.as_str())?;
        field.landmark(&meant).map(|landmark| landmark.id.clone())
    }

    /// The line that is meant by a name; none if it is the same, or if the field has no such line.
    pub fn meant_line(self, named: &LineId, field: &FieldModel) -> Option<LineId> {
        let meant = self.meant_name(named.as_str())?;
        let mut lines = field.lines.iter();
        lines
            .find(|line| line.id.as_str() == meant)
            .map(|line| line.id.clone())
    }

    /// The template's name for what is called `name`. None if `name` does not say the sides in
    /// question.
    fn meant_name(self, name: &str) -> Option<String> {
        let mut words: Vec<&str> = name.split('_').collect();
        let place = |of: [&str; 2]| words.iter().position(|word| of.contains(word));
        let (depth, side) = (place(["near", "far"]), place(["left", "right"]));
        match self {
            Self::BehindAnEnd => {
                let (depth, side) = (depth?, side?);
                let (is_near, is_left) = (words[depth] == "near", words[side] == "left");
                words[depth] = if is_left { "far" } else { "near" };
                words[side] = if is_near { "left" } else { "right" };
            }
            Self::LeftForRight => {
                let side = side?;
                words[side] = if words[side] == "left" {
                    "right"
                } else {
                    "left"
                };
            }
            Self::NearForFar => {
                let depth = depth?;
                words[depth] = if words[depth] == "near" {
                    "far"
                } else {
                    "near"
                };
            }
        }
        Some(words.join("_"))
    }
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
            let meant = Misnaming::BehindAnEnd.meant_name(looks);
            assert_eq!(meant.as_deref(), Some(is));
        }
        let end = Misnaming::BehindAnEnd;
        assert_eq!(end.meant_name("service_t_left"), None);
        let tennis = builtin("tennis").unwrap().default_model().unwrap();
        let centre = LandmarkId::from("centre_mark_left");
        assert_eq!(end.meant_landmark(&centre, &tennis), None);
        for (misnaming, times) in Misnaming::ALL.into_iter().zip([4, 2, 2]) {
            for landmark in &tennis.landmarks {
                let element = tennis.landmark_element(landmark.id.as_str()).unwrap();
                let back = (0..times).fold(element, |at, _| misnaming.meant_element(at, &tennis));
                assert_eq!(back, element, "{misnaming:?}: a whole turn, or back");
            }
        }
    }

    #[test]
    fn left_for_right_and_near_for_far_exchange_one_word_each() {
        for (name, other_side, other_depth) in [
            (
                "corner_near_left",
                Some("corner_near_right"),
                Some("corner_far_left"),
            ),
            ("service_t_left", Some("service_t_right"), None),
            ("halfway_far", None, Some("halfway_near")),
            ("centre_mark", None, None),
        ] {
            let meant = |misnaming: Misnaming| misnaming.meant_name(name);
            assert_eq!(meant(Misnaming::LeftForRight).as_deref(), other_side);
            assert_eq!(meant(Misnaming::NearForFar).as_deref(), other_depth);
        }
    }
}
