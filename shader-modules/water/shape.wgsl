// The height of the water at a place, its slope, and how it bends.
//
// domain: Shape(height -10 to 10 from 1e-6, gradient -10 to 10 from 1e-6, bend -100 to 100 from 1e-6)
// domain: shape_normal()
// domain: shape_turn(way -100 to 100 from 1e-6)

// `height` over the rest plane, metres; `gradient`: its derivatives along x and y; `bend`: its second
// derivatives xx, xy and yy, 1/m.
struct Shape {
    height: f32,
    gradient: vec2f,
    bend: vec3f,
}

// Unit normal, upwards.
fn shape_normal(shape: Shape) -> vec3f {
    return normalize(vec3f(-shape.gradient, 1.0));
}

// How the gradient changes on a horizontal way, metres: to first order.
fn shape_turn(shape: Shape, way: vec2f) -> vec2f {
    return vec2f(dot(shape.bend.xy, way), dot(shape.bend.yz, way));
}
