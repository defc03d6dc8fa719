//! Field models: named landmarks, lines and arcs of a sport's field, in `world` metres.
//!
//! A [`Template`] is a sport's field with its parameters open; [`Template::model`] fills them in
//! for a venue. The templates that come with the program are found by [`builtin`], a user's own by
//! [`template_named`].
//!
//! Frames, signs and units: [`crate::conventions`].

mod build;
mod crossings;
mod crown;
mod element;
mod error;
mod expression;
mod file;
mod load;
mod misnaming;
mod model;
mod parts;
mod read;
mod svg;
mod symmetry;
mod template;
mod variants;

pub use crown::Crown;
pub use element::FieldElement;
pub use error::FieldError;
pub use expression::{Expression, ExpressionError};
pub use load::{builtin, builtin_text};
pub use misnaming::Misnaming;
pub use model::{Curve, FieldLine, FieldModel, Landmark, LandmarkId, LineId, PaintEdge};
pub use symmetry::Symmetry;
pub use template::{Dimension, Param, Template};
// For the crates above alone: no promise to other programs.
#[doc(hidden)]
pub use {
    load::{builtin_names, template_named, template_text},
    model::CLICKING_SHARE,
    svg::svg,
    template::{MAX_CROWN_M, YARD_M},
};
