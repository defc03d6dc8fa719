//! Every shader is valid WGSL for every adapter, and says what its file says.

use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::fs;
use std::path::Path;
use touchline::render::SHADERS;

#[test]
fn every_shader_is_valid() {
    for shader in SHADERS {
        let module = naga::front::wgsl::parse_str(shader.wgsl)
            .unwrap_or_else(|error| panic!("{}: {}", shader.name, error.emit_to_string(shader.wgsl)));
        // No optional capability: the shaders run on whatever adapter there is.
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|error| panic!("{}: {}", shader.name, error.emit_to_string(shader.wgsl)));
        assert_eq!(module.entry_points.iter().filter(|e| e.stage == naga::ShaderStage::Fragment).count(), 1);
    }
}

#[test]
fn no_shader_is_forgotten() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let mut files: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name != "view.wgsl")
        .collect();
    let mut known: Vec<&str> = SHADERS.iter().map(|shader| shader.name).collect();
    files.sort();
    known.sort_unstable();
    assert_eq!(files, known);
}
