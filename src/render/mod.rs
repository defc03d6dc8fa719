//! The wgpu layers: frame picture, anti-aliased lines, points; on screen and off.
