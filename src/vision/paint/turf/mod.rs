//! The ground in a picture: which part shows the field and its surroundings, which colours it has
//! in any light, and how bright the turf is around a point. The search for paint builds on this.
//! Lines and cameras are not known here.

pub mod ground;
pub mod ground_area;
pub mod surface;
pub mod turf_levels;
