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
            wgsl: concat!(include_str!("view.wgsl"), include_str!($name)),
        }
    };
}

/// The camera's picture.
pub const PICTURE: Shader = on_canvas!("picture.wgsl");
/// Filled areas.
pub const FILL: Shader = on_canvas!("fill.wgsl");
/// The map of uncertainty.
pub const HEAT: Shader = on_canvas!("heat.wgsl");
/// Lines and curves.
pub const STROKE: Shader = on_canvas!("stroke.wgsl");
/// A layer over what is drawn already.
pub const COMPOSITE: Shader = on_canvas!("composite.wgsl");
/// Marks of clicks and landmarks.
pub const MARKER: Shader = on_canvas!("marker.wgsl");
/// A picture at half its size.
pub const MIPMAP: Shader = Shader {
    name: "mipmap.wgsl",
    wgsl: include_str!("mipmap.wgsl"),
};

/// Every shader of the program, for those who want to check them.
pub const SHADERS: &[Shader] = &[PICTURE, FILL, HEAT, STROKE, COMPOSITE, MARKER, MIPMAP];

#[cfg(test)]
mod tests {
    use super::SHADERS;
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    use std::fs;

    #[test]
    fn every_shader_is_valid() {
        for shader in SHADERS {
            let module = naga::front::wgsl::parse_str(shader.wgsl).unwrap_or_else(|error| {
                panic!("{}: {}", shader.name, error.emit_to_string(shader.wgsl))
            });
            // No optional capability: the shaders run on whatever adapter there is.
            Validator::new(ValidationFlags::all(), Capabilities::empty())
                .validate(&module)
                .unwrap_or_else(|error| {
                    panic!("{}: {}", shader.name, error.emit_to_string(shader.wgsl))
                });
            assert_eq!(
                module
                    .entry_points
                    .iter()
                    .filter(|e| e.stage == naga::ShaderStage::Fragment)
                    .count(),
                1
            );
        }
    }

    #[test]
    fn no_shader_is_forgotten() {
        let folder = env!("CARGO_MANIFEST_DIR");
        let mut files: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| !["view.wgsl", "lib.rs", "Cargo.toml"].contains(&name.as_str()))
            .collect();
        let mut known: Vec<&str> = SHADERS.iter().map(|shader| shader.name).collect();
        files.sort();
        known.sort_unstable();
        assert_eq!(files, known);
    }
}
