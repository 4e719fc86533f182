// How far a ray runs along one side of the waves before it meets them.
// The height over the surface falls no faster than the slope bound allows, and no faster than the
// parabola through its value and slope with the bound on curvature. Steps to where the later of
// the two reaches 0 cannot overshoot, and close to a crossing they are Newton's: it is reached from
// outside, to the limits of single precision. World space, metres.
//
// needs: geometry/ray, water/body, water/shape
// slots: surface
// domain: march_to_waves(ray.origin -100 to 100 from 1e-6, ray.direction unit, side is 1, start 0 to 100, steps is 96)

// `distance`: along the ray. `shape`: the water's there. Without `found` the ray stays on its side
// until it leaves the waves' band, or for longer than its steps reach.
struct WaveMarch {
    distance: f32,
    shape: Shape,
    found: bool,
}

// `side`: 1 where the ray runs above the surface, −1 under it. `start`: a distance before which it
// does not meet the waves. `steps`: at most 256.
fn march_to_waves(ray: Ray, side: f32, start: f32, steps: i32) -> WaveMarch {
    let climb = side * ray.direction.z;
    let along = length(ray.direction.xy);
    // The quickest that ray and waves can come together.
    let closing = water.slope_bound * along - climb;
    let bend = max(water.curvature_bound * along * along, 1e-9);
    // Beyond the band that the waves reach there is nothing to meet.
    let height = side * (ray.origin.z - water.level);
    let limit = select(1e9, (water.height_bound - height) / max(climb, 1e-9), climb > 0.0);
    var t = start;
    var left = select(0, steps, closing > 0.0 && start <= limit);
    var found = false;
    var shape = Shape(0.0, vec2f(0.0), vec3f(0.0));
    for (var i = 0; i < 256; i++) {
        if i >= left {
            break;
        }
        let point = ray.origin + t * ray.direction;
        shape = surface(point.xy);
        let gap = side * (point.z - water.level - shape.height);
        let rate = climb - side * dot(shape.gradient, ray.direction.xy);
        // What rounding of the place may be taken for.
        let least = 3e-7 * (1.0 + t);
        found = rate < 0.0 && gap <= least;
        let above = max(gap, 0.0);
        let root = sqrt(rate * rate + 2.0 * bend * above);
        let parabola = select((rate + root) / bend, 2.0 * above / max(root - rate, 1e-20), rate < 0.0);
        let step = max(max(parabola, above / max(closing, 1e-9)), least);
        left = select(left, 0, found || t + step > limit);
        t += select(step, 0.0, found);
    }
    return WaveMarch(t, shape, found);
}
