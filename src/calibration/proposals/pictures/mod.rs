//! Pictures of a document's frames and their features: reading, extraction in batches from coarse
//! to fine, and a store that keeps them beside the document. Training and queries both take
//! features from here. What the features mean is not known here.

pub mod batches;
pub mod features;
pub mod picture;
pub mod store;
pub mod used_features;
