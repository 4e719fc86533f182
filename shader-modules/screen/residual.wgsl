// How far a sampled point is from a ray, as an estimate of a pixel's error.
//
// needs: geometry/ray, screen/target, water/body
// domain: residual_px(point -1e4 to 1e4 from 1e-6)
// domain: is_seen(texel -1e4 to 1e4 from 1e-6)

// A place that is outside the seen buffers, or shows nothing, tells nothing: the largest residual.
const UNKNOWN_RESIDUAL = 1e6;

// What is added where another object is seen than the one that was asked for, pixels.
const OTHER_OBJECT = 1e3;

// The distance of a point from a ray behind the water, in pixels of the seen buffers: divided by
// what a pixel covers there, at the ray's apparent distance from the eye. World space, metres.
fn residual_px(ray: Ray, point: vec3f) -> f32 {
    let offset = point - ray.origin;
    let along = max(dot(offset, ray.direction), 0.0);
    let apart = length(offset - along * ray.direction);
    let reach = length(ray.origin - view_target.eye) + along / water.relative_index;
    return min(apart * view_target.focal / max(reach, 1e-6), UNKNOWN_RESIDUAL);
}

// Whether a place lies within the seen buffers, in texels.
fn is_seen(texel: vec2f) -> bool {
    return all(texel >= vec2f(0.0)) && all(texel < view_target.seen_size);
}
