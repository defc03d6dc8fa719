//! What the user can start and how the program explains it: the commands that menu, keys and
//! palette list, their keys, other words for them, messages that name commands as remedies, the
//! guide and the tour. What a command does is written in `update`; here are only its name, its
//! sentence and its key.

pub mod command;
pub mod guide;
pub mod keymap;
pub mod notice;
pub mod synonyms;
pub mod tour;
