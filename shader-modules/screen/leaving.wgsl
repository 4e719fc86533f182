// Where a line on the screen leaves a rectangle. Texels, or whatever its corners are in.
//
// domain: leaving_parts(at 0 to 672 from 1e-3, way -1e4 to 1e4 from 1e-3, low is 0 0, high is 672 392)
// domain: leaving_part(at 0 to 672 from 1e-3, way -1e4 to 1e4 from 1e-3, low is 0 0, high is 672 392)
// domain: leaving_place(at 0 to 672 from 1e-3, way -1e4 to 1e4 from 1e-3, low is 0 0, high is 672 392)

// How far along `way`, as parts of it, the sides are met that lie in its direction, one along each
// axis; 1 along an axis that it hardly moves on.
fn leaving_parts(at: vec2f, way: vec2f, low: vec2f, high: vec2f) -> vec2f {
    let bound = select(low, high, way > vec2f(0.0));
    let still = abs(way) < vec2f(1e-6);
    return select((bound - at) / select(way, vec2f(1.0), still), vec2f(1.0), still);
}

// How far along `way` the rectangle is left; at most 1.
fn leaving_part(at: vec2f, way: vec2f, low: vec2f, high: vec2f) -> f32 {
    let parts = leaving_parts(at, way, low, high);
    return clamp(min(parts.x, parts.y), 0.0, 1.0);
}

// Where that is. A side that is met has its very coordinate: a sum would lie beside it by a rounding,
// and rounding would decide what is shown there.
fn leaving_place(at: vec2f, way: vec2f, low: vec2f, high: vec2f) -> vec2f {
    let parts = leaving_parts(at, way, low, high);
    let part = clamp(min(parts.x, parts.y), 0.0, 1.0);
    let bound = select(low, high, way > vec2f(0.0));
    return select(at + part * way, bound, parts <= vec2f(part));
}
