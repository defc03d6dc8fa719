//! Changes of the document as a whole, and of its cameras: opening, saving and leaving, versions of
//! other programs, the sport, shots, numbers that are typed, and which camera a frame has. Clicks
//! and decisions about single frames are changed in the rooms beside this one.

mod cameras;
mod document;
mod field_draft;
mod leaving;
mod numbers;
mod outside;
mod shots;
mod sport;
