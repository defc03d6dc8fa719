//! Field models: named landmarks, lines and arcs of a sport's field, in `world` metres.
//!
//! A [`Template`] is a sport's field with its parameters open; [`Template::model`] fills them in
//! for a venue. The templates that come with the program are found by [`builtin`], a user's own by
//! [`template_named`].
//!
//! Frames, signs and units: [`crate::conventions`].

mod build;
mod builtin;
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

pub use builtin::{builtin, builtin_names, template_named};
pub use crown::Crown;
pub use element::FieldElement;
pub use error::FieldError;
pub use expression::{Expression, ExpressionError};
pub use misnaming::Misnaming;
pub use model::{
    CLICKING_SHARE, Curve, FieldLine, FieldModel, Landmark, LandmarkId, LineId, PaintEdge,
};
pub use svg::svg;
pub use symmetry::Symmetry;
pub use template::{Dimension, MAX_CROWN_M, Param, Template, YARD_M};
