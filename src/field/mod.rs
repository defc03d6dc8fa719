//! Field models: named landmarks, lines and arcs of a sport's field, in `world` metres.

mod model;

pub use model::{Curve, FieldLine, FieldModel, Landmark, LandmarkId, LineId, PaintEdge};
