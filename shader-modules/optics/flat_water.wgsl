// How points behind flat water appear to an eye.
// Liu, Han, Fei 2020, broad phase, with the direction and origin corrected. World space, metres.
//
// needs: optics/flat_crossing, water/body
// slots: crossing
// domain: apparent_point(point -1e4 to 1e4 from 1e-6, eye -1e4 to 1e4 from 1e-6)

// Depths relative to the rest plane and the crossing between an eye and a point.
struct FlatPath {
    // Distance of the eye from the plane, and of the point, which is negative on the eye's side.
    eye_depth: f32,
    point_depth: f32,
    // Horizontal, from eye to point.
    offset: vec2f,
    crossing: Crossing,
    // Whether the eye is on the side of the lower refractive index.
    eye_low: bool,
}

fn flat_path(point: vec3f, eye: vec3f) -> FlatPath {
    let eye_depth = max(water.camera_side * (eye.z - water.level), 0.0);
    let point_depth = water.camera_side * (water.level - point.z);
    let offset = point.xy - eye.xy;
    let eye_low = water.relative_index >= 1.0;
    let behind = max(point_depth, 0.0);
    let low = select(behind, eye_depth, eye_low);
    let high = select(eye_depth, behind, eye_low);
    return FlatPath(eye_depth, point_depth, offset, crossing(low, high, length(offset)), eye_low);
}

// The apparent position on the vertical through the point: the straightened camera ray passes
// through it. Points on the eye's side stay where they are.
fn apparent_point(point: vec3f, eye: vec3f) -> vec3f {
    let path = flat_path(point, eye);
    if path.point_depth <= 0.0 {
        return point;
    }
    let ratio = select(1.0 / path.crossing.shrink, path.crossing.shrink, path.eye_low);
    return vec3f(point.xy, water.level - water.camera_side * path.point_depth * ratio);
}
