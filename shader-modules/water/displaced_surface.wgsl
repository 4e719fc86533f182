// Where a camera ray meets the waves themselves: the first crossing, found by steps that cannot
// overshoot (the height differs by at most the slope bound times the way) and sharpened by
// Newton's method. World space, metres. A ray that stays above the waves meets nothing.
//
// provides: meet
// needs: geometry/ray, water/body, water/meeting, water/shape
// slots: surface
// number march_steps: 1 to 256, step 1

override march_steps: i32 = 32;

fn meet(ray: Ray) -> Meeting {
    let none = Meeting(vec3f(0.0), vec3f(0.0, 0.0, 1.0), false);
    // Heights are counted from the water towards the camera's side, so that one case is left.
    let side = water.camera_side;
    let height = side * (ray.origin.z - water.level);
    let fall = -side * ray.direction.z;
    let along = length(ray.direction.xy);
    let quickest = fall + water.slope_bound * along;
    if !(quickest > 1e-9) {
        return none;
    }
    // No water is above its bound.
    var t = max((height - water.height_bound) / max(fall, 1e-9), 0.0);
    if fall <= 0.0 && height > water.height_bound {
        return none;
    }
    let farthest = select(1e9, (height + water.height_bound) / max(fall, 1e-9), fall > 0.0);
    var shape = Shape(0.0, vec2f(0.0));
    var gap = 0.0;
    for (var i = 0; i < march_steps; i++) {
        let at = ray.origin + t * ray.direction;
        gap = side * (at.z - water.level - surface(at.xy).height);
        if gap <= 1e-3 * water.height_bound {
            break;
        }
        t = t + gap / quickest;
        if t > farthest {
            break;
        }
    }
    for (var i = 0; i < 3; i++) {
        let at = ray.origin + t * ray.direction;
        shape = surface(at.xy);
        gap = side * (at.z - water.level - shape.height);
        let rate = fall + side * dot(shape.gradient, ray.direction.xy);
        t = max(t + gap / select(quickest, rate, rate > 0.05 * quickest), 0.0);
    }
    if !(t < 1e9) || abs(gap) > 0.1 * water.height_bound + 1e-4 * t {
        return none;
    }
    let point = ray.origin + t * ray.direction;
    return Meeting(point, shape_normal(surface(point.xy)), true);
}
