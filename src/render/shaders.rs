//! The shaders as text. The view's declarations stand before each one that draws on a canvas.

/// A shader and the name it goes by in error messages.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// Its file's name.
    pub name: &'static str,
    /// Its WGSL.
    pub wgsl: &'static str,
}

macro_rules! on_canvas {
    ($name:literal) => {
        Shader {
            name: $name,
            wgsl: concat!(include_str!("../../shaders/view.wgsl"), include_str!(concat!("../../shaders/", $name))),
        }
    };
}

pub(super) const PICTURE: Shader = on_canvas!("picture.wgsl");
pub(super) const FILL: Shader = on_canvas!("fill.wgsl");
pub(super) const HEAT: Shader = on_canvas!("heat.wgsl");
pub(super) const STROKE: Shader = on_canvas!("stroke.wgsl");
pub(super) const COMPOSITE: Shader = on_canvas!("composite.wgsl");
pub(super) const MARKER: Shader = on_canvas!("marker.wgsl");
pub(super) const MIPMAP: Shader = Shader { name: "mipmap.wgsl", wgsl: include_str!("../../shaders/mipmap.wgsl") };

/// Every shader of the program, for those who want to check them.
pub const SHADERS: &[Shader] = &[PICTURE, FILL, HEAT, STROKE, COMPOSITE, MARKER, MIPMAP];
