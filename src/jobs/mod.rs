//! The only detached threads.
