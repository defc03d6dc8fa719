//! The window: panels as functions of state.
