// A frame: smoothed by its mipmaps when smaller, bilinear up to 400 %, its bare pixels beyond.

@group(1) @binding(0) var pixels: texture_2d<f32>;
@group(1) @binding(1) var smooth_sampler: sampler;

struct Instance {
    // The picture, image px. Its texture has fewer when the picture is larger than the device allows.
    @location(0) size: vec2f,
    // Brightness, contrast, gamma: 1 as it is.
    @location(1) look: vec3f,
    // The mip level that suits the scale.
    @location(2) level: f32,
    // 1: bare pixels, 0: smooth.
    @location(3) bare: u32,
}

struct Varying {
    @builtin(position) position: vec4f,
    // 0 to 1 across the picture.
    @location(0) unit: vec2f,
    @location(1) @interpolate(flat) look: vec3f,
    @location(2) @interpolate(flat) level: f32,
    @location(3) @interpolate(flat) bare: u32,
}

@vertex
fn vs_picture(@builtin(vertex_index) index: u32, picture: Instance) -> Varying {
    let unit = unit_corner(index);
    var out: Varying;
    out.position = clip_from_canvas(canvas_from_image(unit * picture.size));
    out.unit = unit;
    out.look = picture.look;
    out.level = picture.level;
    out.bare = picture.bare;
    return out;
}

@fragment
fn fs_picture(in: Varying) -> @location(0) vec4f {
    var colour: vec4f;
    if in.bare == 1u {
        let size = vec2i(textureDimensions(pixels));
        let texel = vec2i(floor(in.unit * vec2f(size)));
        colour = textureLoad(pixels, clamp(texel, vec2i(0), size - 1), 0);
    } else {
        colour = textureSampleLevel(pixels, smooth_sampler, in.unit, in.level);
    }
    var shown = colour.rgb;
    if in.look.y != 1.0 {
        shown = clamp((shown - 0.5) * in.look.y + 0.5, vec3f(0.0), vec3f(1.0));
    }
    if in.look.z != 1.0 {
        shown = pow(shown, vec3f(1.0 / in.look.z));
    }
    return premultiplied(vec4f(min(shown * in.look.x, vec3f(1.0)), colour.a));
}
