// A point of a solid surface that is to be shaded.
//
// domain: SurfacePoint(position -1e4 to 1e4 from 1e-6, normal unit, geometric_normal unit, facing is 1, object is 0)

// `position`: world space, metres. `normal` (for shading) and `geometric_normal`: unit, towards the
// outside. `facing`: 1 if it is seen from outside, −1 from inside. `object`: its id.
struct SurfacePoint {
    position: vec3f,
    normal: vec3f,
    geometric_normal: vec3f,
    facing: f32,
    object: u32,
}
