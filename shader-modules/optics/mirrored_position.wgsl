// Where a point on the camera's side appears in flat water as in a mirror: as far behind the rest
// plane as it is before it. World space, metres.
//
// provides: place
// appears: mirrored
// needs: optics/mirrored_point
// domain: place(point -1e4 to 1e4 from 1e-6)

fn place(point: vec3f) -> vec3f {
    return mirrored_point(point);
}
