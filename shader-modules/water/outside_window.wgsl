// Whether a ray passes through the waves where flat water would mirror all: outside Snell's window, where
// no point of the far side appears, so that the seen buffers tell nothing of what stands on its way.
// The window's very rim counts as outside: what lies there is drawn to within a part of a pixel. World
// space, metres. Rays inside are tested further.
//
// provides: occluded
// needs: geometry/ray, geometry/hit, screen/target, water/body
// slots: further: occluded
// domain: occluded(texel -100 to 1e4)

// What the window is narrowed to, of the squared tangent at its rim: about a pixel.
const WITHIN = 0.996;

fn occluded(ray: Ray, hit: Hit, texel: vec2f) -> bool {
    let way = ray.origin - view_target.eye;
    let mirrored = dot(way.xy, way.xy) * water.root_high * water.root_high > WITHIN * way.z * way.z;
    return water.relative_index < 1.0 && mirrored || further(ray, hit, texel);
}
