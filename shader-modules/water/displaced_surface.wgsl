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
    // Heights are counted from the water towards the camera's side, so that one case is left.
    let side = water.camera_side;
    let height = side * (ray.origin.z - water.level);
    let fall = -side * ray.direction.z;
    // The quickest that the ray and the waves can come together.
    let quickest = max(fall + water.slope_bound * length(ray.direction.xy), 1e-9);
    // No water is above its bound: where the ray enters, and leaves, the waves' band.
    let enters = max((height - water.height_bound) / max(fall, 1e-9), 0.0);
    let leaves = select(1e9, (height + water.height_bound) / max(fall, 1e-9), fall > 0.0);
    var t = select(0.0, enters, height > water.height_bound);
    var gap = 1e9;
    for (var i = 0; i < march_steps && gap > 1e-4 * t && t <= leaves; i++) {
        let at = ray.origin + t * ray.direction;
        gap = side * (at.z - water.level - surface(at.xy).height);
        t += max(gap, 0.0) / quickest;
    }
    for (var i = 0; i < 3; i++) {
        let at = ray.origin + t * ray.direction;
        let shape = surface(at.xy);
        gap = side * (at.z - water.level - shape.height);
        let rate = fall + side * dot(shape.gradient, ray.direction.xy);
        t = max(t + gap / select(quickest, rate, rate > 0.05 * quickest), 0.0);
    }
    let point = ray.origin + t * ray.direction;
    // The ray passed over the waves where it is not close to them in the end.
    return Meeting(point, shape_normal(surface(point.xy)), abs(gap) < 1e-4 * t + 1e-5 && t < 1e9);
}
