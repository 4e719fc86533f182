// What a ray meets.
//
// needs: geometry/ray
// domain: Hit(position -1e4 to 1e4 from 1e-6, normal unit, shading_normal unit, object 0 to 1e4, texel -100 to 1e4, residual 0 to 1e6, direction unit)
// domain: no_hit(texel -1e4 to 1e4 from 1e-6)

// `position`: world space, metres. `normal`: unit geometric normal, towards the outside of the
// object. `shading_normal`: unit. `object`: its id. `texel`: where it appears in the seen buffers.
// `residual`: an estimate of the error, in pixels of the seen buffers; 0 where nothing is known.
// `direction`: the unit direction in which the ray arrives, or leaves the scene; it may have been
// bent on its way. Without `found`, the ray meets nothing and the rest is zero.
struct Hit {
    position: vec3f,
    normal: vec3f,
    shading_normal: vec3f,
    object: f32,
    texel: vec2f,
    residual: f32,
    found: bool,
    direction: vec3f,
}

// The hit of a ray that meets nothing.
fn no_hit(ray: Ray, texel: vec2f) -> Hit {
    return Hit(vec3f(0.0), vec3f(0.0), vec3f(0.0), -1.0, texel, 0.0, false, ray.direction);
}
