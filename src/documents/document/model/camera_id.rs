//! The name of a camera.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;

/// The name of a camera, unique within a document.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(transparent)]
pub struct CameraId(Arc<str>);

impl CameraId {
    /// The name as the document writes it.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl From<&str> for CameraId {
    fn from(name: &str) -> Self {
        Self(name.into())
    }
}

impl fmt::Display for CameraId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}
