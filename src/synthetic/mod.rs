//! A drawn match with exact truth.
