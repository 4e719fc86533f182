// What a ray meets.

// `position`: world space, metres. `normal`: unit geometric normal, towards the outside of the
// object. `shading_normal`: unit. `object`: its id. `texel`: where it appears in the seen buffers.
// `residual`: an estimate of the error, in pixels of the seen buffers; 0 where nothing is known.
// Without `found`, the ray meets nothing and the rest is zero.
struct Hit {
    position: vec3f,
    normal: vec3f,
    shading_normal: vec3f,
    object: f32,
    texel: vec2f,
    residual: f32,
    found: bool,
}
