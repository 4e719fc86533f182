// Where a point on the far side of the water appears to stand. World space, metres.
// By default where it is.
//
// appears: in place

fn place(point: vec3f) -> vec3f {
    return point;
}
