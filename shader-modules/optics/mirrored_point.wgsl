// A point mirrored in the water's rest plane. World space, metres.
//
// needs: water/body
// domain: mirrored_point(point -1e4 to 1e4 from 1e-6)

fn mirrored_point(point: vec3f) -> vec3f {
    return vec3f(point.xy, 2.0 * water.level - point.z);
}
