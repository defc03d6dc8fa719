//! The ground in a picture: which part shows the field and its surroundings, which colours it has
//! in any light, how bright the turf is around a point, and where nothing stands in front of it.
//! The search for paint builds on this. Lines and cameras are not known here.

pub mod even_areas;
pub mod ground;
pub mod ground_area;
pub mod surface;
pub mod turf_levels;
