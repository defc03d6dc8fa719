//! A camera together with the field that it shows.

use crate::camera::PtzCamera;
use crate::field::FieldModel;

/// A camera and the field that is drawn with it. The true and the estimated view may differ in
/// both: for example, a crown in only one of the fields moves its lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldView<'a> {
    /// The field.
    pub field: &'a FieldModel,
    /// The camera.
    pub camera: &'a PtzCamera,
}

/// For each name in `from`, its index in `to`; none if it is missing there. In lists of one
/// template the indices agree, so that index is tried first.
pub(super) fn same_names<'a, T>(
    from: &[T],
    to: &[T],
    name: impl Fn(&T) -> &str + 'a,
) -> Vec<Option<usize>> {
    from.iter()
        .enumerate()
        .map(|(index, item)| {
            let wanted = name(item);
            if to.get(index).is_some_and(|other| name(other) == wanted) {
                Some(index)
            } else {
                to.iter().position(|other| name(other) == wanted)
            }
        })
        .collect()
}
