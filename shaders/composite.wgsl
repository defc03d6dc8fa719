// A finished group of strokes onto the canvas, faded as one.

@group(1) @binding(0) var strokes: texture_2d<f32>;

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) canvas: vec2f,
    @location(1) @interpolate(flat) opacity: f32,
}

struct Instance {
    // Nothing shows outside this box: left, top, right, bottom, image px.
    @location(0) clip: vec4f,
    @location(1) opacity: f32,
}

@vertex
fn vs_composite(@builtin(vertex_index) index: u32, group: Instance) -> Varying {
    let low = clamp(canvas_from_image(group.clip.xy), vec2f(0.0), view.size);
    let high = clamp(canvas_from_image(group.clip.zw), vec2f(0.0), view.size);
    var out: Varying;
    out.canvas = mix(low, high, unit_corner(index));
    out.position = clip_from_canvas(out.canvas);
    out.opacity = group.opacity;
    return out;
}

@fragment
fn fs_composite(in: Varying) -> @location(0) vec4f {
    return textureLoad(strokes, vec2i(floor(in.canvas)), 0) * in.opacity;
}
