// Triangles of filled areas, with a soft edge half a px to either side of the border.

struct Vertex {
    // image px.
    @location(0) at: vec2f,
    // Where the soft edge moves the vertex, canvas px.
    @location(1) shift: vec2f,
    @location(2) colour: vec4f,
}

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) colour: vec4f,
}

@vertex
fn vs_fill(vertex: Vertex) -> Varying {
    var out: Varying;
    out.position = clip_from_canvas(canvas_from_image(vertex.at) + vertex.shift);
    out.colour = premultiplied(vertex.colour);
    return out;
}

@fragment
fn fs_fill(in: Varying) -> @location(0) vec4f {
    return in.colour;
}
