// No transform: every point stands where it is. World space, metres.
//
// provides: place

fn place(point: vec3f) -> vec3f {
    return point;
}
