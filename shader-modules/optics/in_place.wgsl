// No transform: every point stands where it is. World space, metres.
//
// provides: place
// appears: in place
// domain: place(point -1e4 to 1e4 from 1e-6)

fn place(point: vec3f) -> vec3f {
    return point;
}
