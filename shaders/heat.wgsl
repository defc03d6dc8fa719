// A heat map over the picture: a small grid of levels from border to border, smoothed, and coloured by a scale of five colours.

@group(1) @binding(0) var levels: texture_2d<f32>;

struct Instance {
    // The picture, image px.
    @location(0) size: vec2f,
    @location(1) opacity: f32,
    // The colours of the levels 0, 1/4, 1/2, 3/4 and 1.
    @location(2) colour0: vec4f,
    @location(3) colour1: vec4f,
    @location(4) colour2: vec4f,
    @location(5) colour3: vec4f,
    @location(6) colour4: vec4f,
}

struct Varying {
    @builtin(position) position: vec4f,
    // 0 to 1 across the picture.
    @location(0) unit: vec2f,
    @location(1) @interpolate(flat) opacity: f32,
    @location(2) @interpolate(flat) colour0: vec4f,
    @location(3) @interpolate(flat) colour1: vec4f,
    @location(4) @interpolate(flat) colour2: vec4f,
    @location(5) @interpolate(flat) colour3: vec4f,
    @location(6) @interpolate(flat) colour4: vec4f,
}

@vertex
fn vs_heat(@builtin(vertex_index) index: u32, heat: Instance) -> Varying {
    let unit = unit_corner(index);
    var out: Varying;
    out.position = clip_from_canvas(canvas_from_image(unit * heat.size));
    out.unit = unit;
    out.opacity = heat.opacity;
    out.colour0 = heat.colour0;
    out.colour1 = heat.colour1;
    out.colour2 = heat.colour2;
    out.colour3 = heat.colour3;
    out.colour4 = heat.colour4;
    return out;
}

// A crossing's level, 0 to 1: a low and a high byte.
fn crossing(at: vec2i) -> f32 {
    let inside = clamp(at, vec2i(0), vec2i(textureDimensions(levels)) - 1);
    let bytes = textureLoad(levels, inside, 0).rg;
    return (bytes.r + 256.0 * bytes.g) / 257.0;
}

// The level between the crossings, exactly: a sampler's weights have 8 bits, which shows in the lines.
fn level_at(unit: vec2f) -> f32 {
    let place = unit * vec2f(textureDimensions(levels) - 1u);
    let first = vec2i(floor(place));
    let part = fract(place);
    let above = mix(crossing(first), crossing(first + vec2i(1, 0)), part.x);
    let below = mix(crossing(first + vec2i(0, 1)), crossing(first + vec2i(1, 1)), part.x);
    return mix(above, below, part.y);
}

@fragment
fn fs_heat(in: Varying) -> @location(0) vec4f {
    let place = 4.0 * level_at(in.unit);
    var colour = mix(in.colour0, in.colour1, clamp(place, 0.0, 1.0));
    colour = mix(colour, in.colour2, clamp(place - 1.0, 0.0, 1.0));
    colour = mix(colour, in.colour3, clamp(place - 2.0, 0.0, 1.0));
    colour = mix(colour, in.colour4, clamp(place - 3.0, 0.0, 1.0));
    // A thin dark line where one colour's level is reached, so that the map can be read off without colours.
    let from_level = abs(place - round(place)) / max(fwidth(place), 1e-5);
    let line = coverage(0.5 - from_level) * step(0.5, place) * step(place, 3.999);
    return premultiplied(vec4f(colour.rgb * (1.0 - 0.5 * line), in.opacity * (1.0 + 0.4 * line)));
}
