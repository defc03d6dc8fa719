//! Actions of the pointer over the picture.

use touchline_core::geometry::ImagePoint;
use touchline_documents::document::Target;

/// An action of the pointer over the picture. Its effect depends on the mode.
#[derive(Clone, Debug, PartialEq)]
pub enum PointerAction {
    /// The pointer moved to a point, px of the picture, or left the picture.
    Hover(Option<ImagePoint>),
    /// The primary button was pressed on the picture.
    Press {
        /// The point, px of the picture.
        at: ImagePoint,
        /// The index of the click under the pointer, if any.
        on: Option<usize>,
    },
    /// The primary button went down on a landmark or line that is drawn over the picture and can be
    /// dragged.
    Grab {
        /// Where, px of the picture.
        at: ImagePoint,
        /// What is drawn there.
        element: Target,
    },
    /// The pointer moved with the button down.
    Drag(ImagePoint),
    /// The button was released.
    Release,
    /// The button was released with Alt down: the point stays where it is, even if its landmark is
    /// painted nearby.
    ReleaseExactly,
}
