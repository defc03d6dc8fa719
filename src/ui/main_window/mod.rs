//! The window as a whole: it is opened here, gives each panel its part, passes keys and pointer
//! input on, and hands the actions of all panels to the application. File dialogs of the system are
//! opened from here, too. What a panel shows is written in the panel's own file.

mod files;
mod focus;
mod input_queue;
mod key_stroke;
pub mod keys;
pub mod layout;
pub mod shell;
pub mod window;
