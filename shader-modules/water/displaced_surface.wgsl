// Where a camera ray meets the waves themselves: the first crossing. World space, metres.
// A ray that falls more steeply than any wave crosses them once, near the rest plane, and Newton's
// method finds it from there. Others march. A ray that stays on its side of the waves meets
// nothing.
//
// provides: meet
// needs: geometry/ray, water/body, water/march, water/meeting, water/shape
// slots: surface
// number march_steps: 1 to 256, step 1
// number newton_steps: 1 to 16, step 1
// domain: meet(ray.origin -100 to 100 from 1e-6, ray.direction unit)

override march_steps: i32 = 128;
override newton_steps: i32 = 8;

fn meet(ray: Ray) -> Meeting {
    // Heights are counted from the water towards the camera's side, so that one case is left.
    let side = water.camera_side;
    let height = side * (ray.origin.z - water.level);
    let fall = -side * ray.direction.z;
    let along = length(ray.direction.xy);
    let way = max(fall, 1e-9);
    // Where the ray crosses the rest plane, or enters the band that the waves reach.
    if fall > 1.01 * water.slope_bound * along {
        var t = max(height / way, 0.0);
        for (var i = 0; i < newton_steps; i++) {
            let at = ray.origin + t * ray.direction;
            let shape = surface(at.xy);
            let gap = side * (at.z - water.level - shape.height);
            let change = gap / max(fall + side * dot(shape.gradient, ray.direction.xy), 1e-9);
            t = max(t + change, 0.0);
            // The step leaves a gap of the second order in it, which may be as small as rounding.
            if water.curvature_bound * change * change <= 4e-7 * (1.0 + t) {
                break;
            }
        }
        let point = ray.origin + t * ray.direction;
        return Meeting(point, shape_normal(surface(point.xy)), t < 1e9);
    }
    let start = max((height - water.height_bound) / way, 0.0);
    let march = march_to_waves(ray, side, start, march_steps);
    let point = ray.origin + march.distance * ray.direction;
    return Meeting(point, shape_normal(march.shape), march.found && march.distance < 1e9);
}
