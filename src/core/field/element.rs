//! A landmark or a line of a field.

use super::{FieldModel, Symmetry};

/// A landmark or line by its index in the lists of a [`FieldModel`]. A template gives the same
/// lists in the same order whatever its parameters are, so an element means the same thing on a
/// field of another size or crown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FieldElement {
    /// An index into [`FieldModel::landmarks`].
    Landmark(usize),
    /// An index into [`FieldModel::lines`]: the line itself, as defined by the rules.
    Line(usize),
    /// An index into [`FieldModel::lines`]: the middle of the line's paint, which may lie half its
    /// width beside it.
    Paint(usize),
}

impl FieldElement {
    /// Its name in documents; none if the field has no such element.
    pub fn name(self, field: &FieldModel) -> Option<&str> {
        self.texts(field).map(|[name, _, _]| name)
    }

    /// Its label; none if the field has no such element.
    pub fn label(self, field: &FieldModel) -> Option<&str> {
        self.texts(field).map(|[_, label, _]| label)
    }

    /// Its short code, for typing and beside clicks; none if the field has no such element.
    pub fn code(self, field: &FieldModel) -> Option<&str> {
        self.texts(field).map(|[_, _, code]| code)
    }

    /// Its name, label and code.
    fn texts(self, field: &FieldModel) -> Option<[&str; 3]> {
        match self {
            Self::Landmark(index) => field.landmarks.get(index).map(|landmark| {
                [
                    landmark.id.as_str(),
                    landmark.label.as_str(),
                    landmark.code.as_str(),
                ]
            }),
            Self::Line(index) | Self::Paint(index) => field
                .lines
                .get(index)
                .map(|line| [line.id.as_str(), line.label.as_str(), line.code.as_str()]),
        }
    }

    /// The element onto which a symmetry of the field moves this one; none where the field is not
    /// symmetric.
    pub fn twin(self, symmetry: Symmetry, field: &FieldModel) -> Option<Self> {
        match self {
            Self::Landmark(index) => {
                let twin = symmetry.landmark_twin(field, field.landmarks.get(index)?)?;
                field.landmark_element(twin.id.as_str())
            }
            Self::Line(index) => line_twin(symmetry, field, index).map(Self::Line),
            Self::Paint(index) => line_twin(symmetry, field, index).map(Self::Paint),
        }
    }

    /// Every element of the same kind, in the field's order.
    pub fn alike(self, field: &FieldModel) -> impl Iterator<Item = Self> + use<> {
        let (count, element): (usize, fn(usize) -> Self) = match self {
            Self::Landmark(_) => (field.landmarks.len(), Self::Landmark),
            Self::Line(_) => (field.lines.len(), Self::Line),
            Self::Paint(_) => (field.lines.len(), Self::Paint),
        };
        (0..count).map(element)
    }
}

/// The index of the line onto which a symmetry maps a line.
fn line_twin(symmetry: Symmetry, field: &FieldModel, index: usize) -> Option<usize> {
    let twin = symmetry.line_twin(field, field.lines.get(index)?)?;
    field.lines.iter().position(|line| line.id == twin.id)
}

impl FieldModel {
    /// A landmark by name, as an element.
    pub fn landmark_element(&self, id: &str) -> Option<FieldElement> {
        self.landmarks
            .iter()
            .position(|landmark| landmark.id.as_str() == id)
            .map(FieldElement::Landmark)
    }

    /// A line by name, as an element.
    pub fn line_element(&self, id: &str) -> Option<FieldElement> {
        self.lines
            .iter()
            .position(|line| line.id.as_str() == id)
            .map(FieldElement::Line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::builtin;
    use std::collections::BTreeMap;

    #[test]
    fn an_element_is_the_same_landmark_or_line_on_a_field_of_another_size() {
        let template = builtin("soccer").unwrap();
        let usual = template.model(&BTreeMap::new(), 0.0).unwrap();
        let size = BTreeMap::from([("length_m".to_owned(), 100.0), ("width_m".to_owned(), 64.0)]);
        let smaller = template.model(&size, 0.2).unwrap();
        let elements = FieldElement::Landmark(0)
            .alike(&usual)
            .chain(FieldElement::Line(0).alike(&usual));
        for element in elements {
            assert!(element.name(&usual).is_some());
            assert_eq!(element.name(&usual), element.name(&smaller));
            assert_eq!(element.label(&usual), element.label(&smaller));
        }
        assert_eq!(
            FieldElement::Landmark(usual.landmarks.len()).name(&usual),
            None
        );
    }

    #[test]
    fn the_twin_of_a_twin_is_the_element_itself() {
        let field = builtin("soccer")
            .unwrap()
            .model(&BTreeMap::new(), 0.0)
            .unwrap();
        let kinds = [
            FieldElement::Landmark(0),
            FieldElement::Line(0),
            FieldElement::Paint(0),
        ];
        for element in kinds.into_iter().flat_map(|kind| kind.alike(&field)) {
            for symmetry in Symmetry::ALL {
                let twin = element.twin(symmetry, &field).unwrap();
                assert_eq!(twin.twin(symmetry, &field), Some(element));
            }
        }
        let left = field.landmark_element("penalty_mark_left").unwrap();
        assert_eq!(
            left.twin(Symmetry::MirrorX, &field),
            field.landmark_element("penalty_mark_right")
        );
        let far = field.line_element("touchline_far").unwrap();
        assert_eq!(
            far.twin(Symmetry::MirrorY, &field),
            field.line_element("touchline_near")
        );
    }
}
