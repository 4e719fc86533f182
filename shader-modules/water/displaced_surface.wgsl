// Where a camera ray meets the waves themselves: the first crossing. World space, metres.
// A ray that falls more steeply than any wave crosses them once, near the rest plane, and
// Chebyshev's method (Newton's with the surface's bend) finds it from there: two looks at the surface
// are mostly enough. Others march: the height over the surface falls no faster than the slope bound
// allows, nor than the parabola through its value and slope with the bound on curvature, so that
// steps to where the later of the two reaches 0 cannot overshoot. Both take their steps in one loop,
// since processors that run pixels side by side go through every loop for all of them. A ray that
// stays on its side of the waves meets nothing.
//
// provides: meet
// needs: geometry/ray, water/body, water/meeting, water/shape
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
    let ahead = ray.direction.xy;
    let along = length(ahead);
    let steep = fall > 1.01 * water.slope_bound * along;
    // The quickest that ray and waves can come together, and that this can change.
    let closing = water.slope_bound * along + fall;
    let bend = max(water.curvature_bound * along * along, 1e-9);
    // Where the ray crosses the rest plane, or enters the band that the waves reach; and leaves it.
    var t = max((height - select(water.height_bound, 0.0, steep)) / max(fall, 1e-9), 0.0);
    let limit = select(1e9, (water.height_bound - height) / max(-fall, 1e-9), fall < 0.0);
    var left = select(select(0, march_steps, closing > 0.0 && t <= limit), newton_steps, steep);
    var found = steep;
    var gradient = vec2f(0.0);
    for (var i = 0; i < 256; i++) {
        if i >= left {
            break;
        }
        let at = ray.origin + t * ray.direction;
        let shape = surface(at.xy);
        let gap = side * (at.z - water.level - shape.height);
        // How fast it closes, and how that speed grows: gap − rate t + ½ growth t² from here on.
        let rate = fall + side * dot(shape.gradient, ahead);
        let growth = -side * dot(shape_turn(shape, ahead), ahead);
        let newton = gap / max(rate, 1e-9);
        let chebyshev = newton * clamp(1.0 + 0.5 * growth * newton / max(rate, 1e-9), 0.5, 2.0);
        // What rounding of the place may be taken for.
        let least = 3e-7 * (1.0 + t);
        let arrived = rate > 0.0 && gap <= least;
        let above = max(gap, 0.0);
        let root = sqrt(rate * rate + 2.0 * bend * above);
        let parabola = select((root - rate) / bend, 2.0 * above / max(root + rate, 1e-20), rate > 0.0);
        let march = max(max(parabola, above / max(closing, 1e-9)), least);
        let step = select(select(march, 0.0, arrived), max(chebyshev, -t), steep);
        gradient = shape.gradient + shape_turn(shape, step * ahead);
        // A steep ray's step leaves a gap of the third order in it.
        let close = select(arrived, bend * step * step <= 4e-7 * (1.0 + t), steep);
        found = steep || arrived;
        left = select(left, 0, close || t + step > limit);
        t += step;
    }
    let normal = shape_normal(Shape(0.0, gradient, vec3f(0.0)));
    return Meeting(ray.origin + t * ray.direction, normal, found && t < 1e9);
}
