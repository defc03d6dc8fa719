// A finished group of strokes onto the canvas, faded as one.

@group(1) @binding(0) var strokes: texture_2d<f32>;

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) canvas: vec2f,
    @location(1) @interpolate(flat) opacity: f32,
}

@vertex
fn vs_composite(@builtin(vertex_index) index: u32, @location(0) opacity: f32) -> Varying {
    var out: Varying;
    out.canvas = unit_corner(index) * view.size;
    out.position = clip_from_canvas(out.canvas);
    out.opacity = opacity;
    return out;
}

@fragment
fn fs_composite(in: Varying) -> @location(0) vec4f {
    return textureLoad(strokes, vec2i(floor(in.canvas)), 0) * in.opacity;
}
