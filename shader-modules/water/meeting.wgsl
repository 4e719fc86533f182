// Where a camera ray meets the water.

// `point`: world space, metres. `normal`: unit, upwards. Without `found` there is no water ahead.
struct Meeting {
    point: vec3f,
    normal: vec3f,
    found: bool,
}
