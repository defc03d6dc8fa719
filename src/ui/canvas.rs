//! Canvases of the render room inside the window.
