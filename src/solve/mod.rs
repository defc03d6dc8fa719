//! From observations to parameters: one problem a file.
