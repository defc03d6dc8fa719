// One segment of a polyline: a quad whose pixels know their distance to the segment.
//
// Neighbouring segments share a vertex; the line through it that halves the angle parts their pixels, so that each pixel
// of a stroke is drawn exactly once and joins are neither darker nor open. The pixel's own position (not an interpolated
// one) is tested, hence both segments decide alike; that needs a target whose origin is the canvas's.

struct Instance {
    // The ends, image px.
    @location(0) a: vec2f,
    @location(1) b: vec2f,
    // Which way the stroke goes through each end, half way between its two segments; zero at a loose end.
    @location(2) through_a: vec2f,
    @location(3) through_b: vec2f,
    // Length of the stroke before `a`, image px.
    @location(4) before_a: f32,
    // Half the core's width and the rim beyond it, points.
    @location(5) half_width: f32,
    @location(6) rim_width: f32,
    // Dash and gap, points; a dash of zero and no gap is a line without gaps.
    @location(7) dash: vec2f,
    @location(8) colour: vec4f,
    @location(9) rim_colour: vec4f,
}

struct Varying {
    @builtin(position) position: vec4f,
    // a, b in canvas px.
    @location(0) @interpolate(flat) ends: vec4f,
    @location(1) @interpolate(flat) through: vec4f,
    // Half width (px), length before a (px), dash, gap (px).
    @location(2) @interpolate(flat) measures: vec4f,
    @location(3) @interpolate(flat) colour: vec4f,
}

fn segment(index: u32, s: Instance, half_width_pt: f32, colour: vec4f) -> Varying {
    let a = canvas_from_image(s.a);
    let b = canvas_from_image(s.b);
    let along = normalize(s.b - s.a);
    let across = vec2f(-along.y, along.x);
    let half_width = half_width_pt * view.pixels_per_point;
    // One px more than the paint, for its soft edge.
    let reach = half_width + 1.0;
    let corner = unit_corner(index);
    let end = mix(a - along * reach, b + along * reach, corner.x);
    var out: Varying;
    out.position = clip_from_canvas(end + across * reach * (corner.y * 2.0 - 1.0));
    out.ends = vec4f(a, b);
    out.through = vec4f(s.through_a, s.through_b);
    out.measures = vec4f(half_width, s.before_a * view.scale, s.dash * view.pixels_per_point);
    out.colour = colour;
    return out;
}

@vertex
fn vs_rim(@builtin(vertex_index) index: u32, s: Instance) -> Varying {
    return segment(index, s, s.half_width + s.rim_width, s.rim_colour);
}

@vertex
fn vs_core(@builtin(vertex_index) index: u32, s: Instance) -> Varying {
    return segment(index, s, s.half_width, s.colour);
}

// How far the stroke has come at a position `s` along it, beyond the nearest dash; 0 within a dash.
fn beyond_dash(s: f32, dash: vec2f) -> f32 {
    let period = dash.x + dash.y;
    if period <= 0.0 || dash.y <= 0.0 {
        return 0.0;
    }
    let phase = s - floor(s / period) * period;
    return max(min(phase - dash.x, period - phase), 0.0);
}

@fragment
fn fs_stroke(in: Varying) -> @location(0) vec4f {
    let p = in.position.xy;
    let a = in.ends.xy;
    let b = in.ends.zw;
    if dot(p - a, in.through.xy) < 0.0 {
        discard;
    }
    if any(in.through.zw != vec2f(0.0)) && dot(p - b, in.through.zw) >= 0.0 {
        discard;
    }
    let ab = b - a;
    let length_px = length(ab);
    let on = clamp(dot(p - a, ab) / (length_px * length_px), 0.0, 1.0);
    let off_line = length(p - (a + ab * on));
    let off_dash = beyond_dash(in.measures.y + on * length_px, in.measures.zw);
    let distance = length(vec2f(off_line, off_dash));
    // What a pixel one px wide sees of a band from −half_width to half_width; right for hairlines, too.
    let half_width = in.measures.x;
    let covered = coverage(half_width - distance) - coverage(-half_width - distance);
    return premultiplied(in.colour) * covered;
}
