// A symbol of constant size on the screen, from its signed distance; core and rim in one go.

struct Instance {
    // image px.
    @location(0) at: vec2f,
    // From the centre to the outermost point of the core, width of its lines, width of the rim; points.
    @location(1) radius: f32,
    @location(2) line: f32,
    @location(3) rim_width: f32,
    // 0 cross, 1 ring, 2 dot, 3 diamond.
    @location(4) shape: u32,
    @location(5) colour: vec4f,
    @location(6) rim_colour: vec4f,
}

struct Varying {
    @builtin(position) position: vec4f,
    // From the marker's centre, canvas px.
    @location(0) local: vec2f,
    // Radius, line, rim; canvas px.
    @location(1) @interpolate(flat) measures: vec3f,
    @location(2) @interpolate(flat) shape: u32,
    @location(3) @interpolate(flat) colour: vec4f,
    @location(4) @interpolate(flat) rim_colour: vec4f,
}

// The cross leaves this share of its radius open around the centre.
const CROSS_OPEN: f32 = 0.36;

@vertex
fn vs_marker(@builtin(vertex_index) index: u32, marker: Instance) -> Varying {
    let measures = vec3f(marker.radius, marker.line, marker.rim_width) * view.pixels_per_point;
    let reach = measures.x + measures.z + 1.0;
    var out: Varying;
    out.local = (unit_corner(index) * 2.0 - 1.0) * reach;
    out.position = clip_from_canvas(canvas_from_image(marker.at) + out.local);
    out.measures = measures;
    out.shape = marker.shape;
    out.colour = marker.colour;
    out.rim_colour = marker.rim_colour;
    return out;
}

// The signed distance to a shape's core, negative inside.
fn distance_to(shape: u32, p: vec2f, radius: f32, line: f32) -> f32 {
    let half_line = line / 2.0;
    switch shape {
        case 0u: {
            // Folded into one arm, which lies along +x.
            let q = abs(p);
            let arm = select(q, q.yx, q.y > q.x);
            let nearest = clamp(arm.x, radius * CROSS_OPEN + half_line, max(radius - half_line, radius * CROSS_OPEN + half_line));
            return length(arm - vec2f(nearest, 0.0)) - half_line;
        }
        case 1u: {
            return abs(length(p) - (radius - half_line)) - half_line;
        }
        case 2u: {
            return length(p) - radius;
        }
        default: {
            let q = abs(p);
            return abs((q.x + q.y - radius) * 0.70710678 + half_line) - half_line;
        }
    }
}

@fragment
fn fs_marker(in: Varying) -> @location(0) vec4f {
    let distance = distance_to(in.shape, in.local, in.measures.x, in.measures.y);
    let core = premultiplied(in.colour) * coverage(-distance);
    let rim = premultiplied(in.rim_colour) * coverage(in.measures.z - distance);
    return core + rim * (1.0 - core.a);
}
