//! The field's markings as a camera sees them.
