//! The pointer over the picture.

use touchline_core::geometry::ImagePoint;

/// What the pointer does over the picture: what has been begun decides what it means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointerAction {
    /// The pointer is over the picture, or left it.
    Hover(Option<ImagePoint>),
    /// The primary button went down on the picture.
    Press {
        /// Where, px of the picture.
        at: ImagePoint,
        /// The click under the pointer, if any.
        on: Option<usize>,
    },
    /// The pointer moved with the button down.
    Drag(ImagePoint),
    /// The button went up.
    Release,
    /// The button went up with Alt held: the point stays where it is, whatever is painted near by.
    ReleaseExactly,
}
