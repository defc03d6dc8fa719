// One mip level from the next larger one: each pixel is the mean of the 2×2 pixels below it.

@group(0) @binding(0) var larger: texture_2d<f32>;
@group(0) @binding(1) var smooth_sampler: sampler;

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) unit: vec2f,
}

@vertex
fn vs_mipmap(@builtin(vertex_index) index: u32) -> Varying {
    let unit = vec2f(f32(index & 1u), f32(index >> 1u));
    var out: Varying;
    out.position = vec4f(unit.x * 2.0 - 1.0, 1.0 - unit.y * 2.0, 0.0, 1.0);
    out.unit = unit;
    return out;
}

@fragment
fn fs_mipmap(in: Varying) -> @location(0) vec4f {
    return textureSampleLevel(larger, smooth_sampler, in.unit, 0.0);
}
