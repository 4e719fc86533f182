// Where a ray enters an axis-aligned box.
// The slab test; Ize 2013, "Robust BVH Ray Traversal", JCGT 2(2): the far distance is enlarged by
// the rounding of both, so that no box is missed which a triangle on its face fills. World space,
// metres.
//
// domain: box_inverse(direction unit)
// domain: box_entry(origin -1e4 to 1e4 from 1e-6, inverse -1e20 to 1e20 from 1, low -1e4 to 1e4 from 1e-6, high -1e4 to 1e4 from 1e-6, farthest 0 to 1e30)

// 1 / direction, finite: a ray along an axis plane is taken to leave it very far away.
fn box_inverse(direction: vec3f) -> vec3f {
    let tiny = abs(direction) < vec3f(1e-20);
    return select(1.0 / direction, select(vec3f(1e20), vec3f(-1e20), direction < vec3f(0.0)), tiny);
}

// The distance at which the box is entered, 0 from within; 1e30 where the ray misses it or enters
// it only beyond `farthest`.
fn box_entry(origin: vec3f, inverse: vec3f, low: vec3f, high: vec3f, farthest: f32) -> f32 {
    let to_low = (low - origin) * inverse;
    let to_high = (high - origin) * inverse;
    let nearer = min(to_low, to_high);
    let farther = max(to_low, to_high);
    let enters = max(max(nearer.x, nearer.y), max(nearer.z, 0.0));
    let leaves = min(min(farther.x, farther.y), min(farther.z, farthest)) * 1.0000005;
    return select(1e30, enters, enters <= leaves);
}
