// The smallest rotation that carries one unit vector to another.
// Rodrigues' formula, written without angles. Opposite vectors have no smallest rotation: the
// result is finite then, and of no use.
//
// domain: rotate_between(v unit, source unit, goal unit)

// `v` turned as `source` is turned to reach `goal`; both are unit vectors.
fn rotate_between(v: vec3f, source: vec3f, goal: vec3f) -> vec3f {
    let axis = cross(source, goal);
    let cosine = dot(source, goal);
    let turned = cross(axis, v);
    return v + turned + cross(axis, turned) / max(1.0 + cosine, 1e-6);
}
