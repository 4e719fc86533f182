// The height and slope of the water at a place.
//
// domain: shape_normal(shape.height -10 to 10 from 1e-6, shape.gradient -10 to 10 from 1e-6)

// `height` over the rest plane, metres; `gradient`: its derivatives along x and y.
struct Shape {
    height: f32,
    gradient: vec2f,
}

// Unit normal, upwards.
fn shape_normal(shape: Shape) -> vec3f {
    return normalize(vec3f(-shape.gradient, 1.0));
}
