//! The picture in the middle of the window and everything that is done on it with pointer and keys:
//! the viewport, the loupe, naming a new click, masks, and the reasons for rejecting a frame. It
//! translates input into actions. How a picture is placed on the screen is in `drawing`.

mod loupe;
mod masks;
mod naming;
pub mod rejecting;
pub mod typing;
pub mod viewport;
