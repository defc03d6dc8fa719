// What every layer shares: where the picture lies on the canvas. This text stands before each of the other shaders.
//
// Two spaces: `image`, px of the picture, and `canvas`, physical px of what is drawn on. Both have (0, 0) at the top-left
// corner and the first pixel's centre at (0.5, 0.5). Colours stay in gamma space and leave premultiplied.

struct View {
    // canvas px per image px.
    scale: f32,
    // canvas px per point, the unit of line widths and marker sizes.
    pixels_per_point: f32,
    // Where the picture's top-left corner lies, canvas px.
    offset: vec2f,
    // The canvas, px.
    size: vec2f,
}

@group(0) @binding(0) var<uniform> view: View;

fn canvas_from_image(p: vec2f) -> vec2f {
    return p * view.scale + view.offset;
}

fn clip_from_canvas(p: vec2f) -> vec4f {
    let unit = p / view.size * 2.0 - 1.0;
    return vec4f(unit.x, -unit.y, 0.0, 1.0);
}

// The corners of a quad drawn as a triangle strip of four vertices: (0,0) (1,0) (0,1) (1,1).
fn unit_corner(index: u32) -> vec2f {
    return vec2f(f32(index & 1u), f32(index >> 1u));
}

fn premultiplied(colour: vec4f) -> vec4f {
    return vec4f(colour.rgb * colour.a, colour.a);
}

// The share of a pixel that an edge covers, `inside` px away from the pixel's centre towards the inside.
fn coverage(inside: f32) -> f32 {
    return clamp(inside + 0.5, 0.0, 1.0);
}
