// Where a camera ray meets the waves themselves: the first crossing. World space, metres.
// A ray that falls more steeply than any wave crosses them once, near the rest plane, and Newton's
// method finds it from there. Others march, in steps that cannot overshoot (the height differs by
// at most the slope bound times the way), before Newton's method. A ray that stays on its side of
// the waves meets nothing.
//
// provides: meet
// needs: geometry/ray, water/body, water/meeting, water/shape
// slots: surface
// number march_steps: 1 to 256, step 1
// number newton_steps: 1 to 16, step 1

override march_steps: i32 = 96;
override newton_steps: i32 = 8;

fn meet(ray: Ray) -> Meeting {
    // Heights are counted from the water towards the camera's side, so that one case is left.
    let side = water.camera_side;
    let height = side * (ray.origin.z - water.level);
    let fall = -side * ray.direction.z;
    let along = length(ray.direction.xy);
    // The quickest that the ray and the waves can come together.
    let quickest = max(fall + water.slope_bound * along, 1e-9);
    // Where the ray enters, crosses and leaves the band that the waves reach.
    let way = max(fall, 1e-9);
    let leaves = select(1e9, (height + water.height_bound) / way, fall > 0.0);
    let crosses_once = fall > 1.01 * water.slope_bound * along;
    var t = max(select(height - water.height_bound, height, crosses_once) / way, 0.0);
    var gap = select(1e9, 0.0, crosses_once);
    for (var i = 0; i < march_steps && gap > 1e-4 * t && t <= leaves; i++) {
        let at = ray.origin + t * ray.direction;
        gap = side * (at.z - water.level - surface(at.xy).height);
        t += max(gap, 0.0) / quickest;
    }
    var point = ray.origin + t * ray.direction;
    var shape = surface(point.xy);
    gap = side * (point.z - water.level - shape.height);
    for (var i = 0; i < newton_steps && abs(gap) > 2e-6 * (1.0 + t); i++) {
        let rate = fall + side * dot(shape.gradient, ray.direction.xy);
        t = max(t + gap / select(quickest, rate, rate > 0.05 * quickest), 0.0);
        point = ray.origin + t * ray.direction;
        shape = surface(point.xy);
        gap = side * (point.z - water.level - shape.height);
    }
    // A ray that is not close to the waves in the end passed over them.
    return Meeting(point, shape_normal(shape), abs(gap) < 1e-4 * (1.0 + t) && t < 1e9);
}
