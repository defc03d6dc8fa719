//! The rows and strips around the picture: menus at the top, tools at the left, and below the
//! picture timeline, filmstrip, messages and status. The tour's bar is one of them. Side panels and
//! dialogs have folders of their own.

pub mod filmstrip;
pub mod menu;
pub mod notices;
pub mod status;
pub mod timeline;
pub mod tools;
pub mod tour;
