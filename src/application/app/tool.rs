//! The tools of the picture: what a press in it does.

/// What a press in the picture does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Places a point, or drags the point, landmark or line under it.
    #[default]
    Point,
    /// Selects and drags points and moves the picture; places nothing.
    Select,
    /// Places a point on a line.
    Line,
    /// Places a check point: it is left out of the solve, and its error is shown.
    Check,
    /// Draws a mask: a box that is excluded from feature detection.
    Mask,
}
