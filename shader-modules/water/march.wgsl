// Where a ray that runs along one side of the waves meets them first. World space, metres.
// The height over the surface falls no faster than the slope bound allows, nor than the parabola
// through its value and slope with the bound on curvature: steps to where the later of the two
// reaches 0 cannot overshoot. A steep ray, which falls faster than any wave does and so crosses
// them once, is followed from the rest plane by Chebyshev's method (Newton's with the surface's bend),
// which mostly needs two looks. Both share one loop, since processors that run pixels side by side
// go through every loop for all of them. The last step of either is to the crossing itself, so that
// no residue is left; nothing is told apart that rounding of the place would not.
//
// needs: geometry/ray, water/body, water/shape
// slots: surface
// domain: march_to_waves(ray.origin -1e4 to 1e4 from 1e-6, ray.direction unit, side is 1, steep is 0, steps is 96)

// Beyond this distance along a ray there is no water, metres: the horizon of an eye 78 km up, where
// floats no longer tell waves apart.
const WATER_ENDS = 1e6;

// `point`, on the waves, and the waves' `gradient` there. Without `found`, the ray stays on its side
// until it leaves the waves' band, or rises and skims crests for longer than its steps reach, and
// both are 0. A ray that falls meets the waves for sure: where its steps end, at the latest.
struct WaveMarch {
    point: vec3f,
    gradient: vec2f,
    found: bool,
}

// How far a ray surely stays above waves that are `gap` under it: they close in at `rate`, which no
// wave changes faster than by `bend`, and never faster than `closing`.
fn safe_step(gap: f32, rate: f32, bend: f32, closing: f32) -> f32 {
    let root = sqrt(rate * rate + 2.0 * bend * gap);
    let parabola = select((root - rate) / bend, 2.0 * gap / max(root + rate, 1e-20), rate > 0.0);
    return max(parabola, gap / max(closing, 1e-9));
}

// `side`: 1 where the ray runs above the surface, −1 under it. `steps`: at most 256.
fn march_to_waves(ray: Ray, side: f32, steep: bool, steps: i32) -> WaveMarch {
    // Heights are counted from the water towards the ray's side, so that one case is left.
    let height = side * (ray.origin.z - water.level);
    let fall = -side * ray.direction.z;
    let ahead = ray.direction.xy;
    let along = length(ahead);
    // The quickest that ray and waves can come together, and that this can change.
    let closing = water.slope_bound * along + fall;
    let bend = max(water.curvature_bound * along * along, 1e-9);
    // Where the ray crosses the rest plane, or enters the band that the waves reach; and leaves it.
    var t = max((height - select(water.height_bound, 0.0, steep)) / max(fall, 1e-30), 0.0);
    let above_band = (water.height_bound - height) / max(-fall, 1e-30);
    let limit = min(select(WATER_ENDS, above_band, fall < 0.0), WATER_ENDS);
    let from_origin = dot(abs(ray.origin), vec3f(1.0));
    var left = select(0, steps, closing > 0.0 && t <= limit);
    var found = false;
    var shape = Shape(0.0, vec2f(0.0), vec3f(0.0));
    var step = 0.0;
    for (var i = 0; i < 256; i++) {
        if i >= left {
            break;
        }
        let at = ray.origin + t * ray.direction;
        shape = surface(at.xy);
        let gap = side * (at.z - water.level - shape.height);
        // How fast it closes, and how that speed grows: gap − rate t − ½ growth t² from here on.
        let rate = fall + side * dot(shape.gradient, ahead);
        let growth = side * dot(shape_turn(shape, ahead), ahead);
        let newton = gap / max(rate, 1e-20);
        let chebyshev = newton * clamp(1.0 - 0.5 * growth * newton / max(rate, 1e-20), 0.5, 2.0);
        // What rounding of the place may be taken for.
        let close = 4e-7 * (from_origin + t);
        // A ray that starts behind the surface by more has met it.
        let arrived = gap <= select(-close, rate * close, rate > 0.0);
        let march = max(safe_step(max(gap, 0.0), rate, bend, closing), close);
        // A march that has arrived is past the crossing by no more than its shortest step.
        let back = select(min(close, t), t, steep);
        step = select(march, max(chebyshev, -back), steep || arrived);
        // A steep ray's step leaves a gap of the third order in it.
        found = select(arrived, bend * step * step <= 4e-7 * t, steep);
        left = select(left, 0, found || t + step > limit);
        t += step;
    }
    if !found {
        if fall <= 0.0 || t > limit {
            return WaveMarch(vec3f(0.0), vec2f(0.0), false);
        }
        // Its steps have ended: where they last looked.
        t -= step;
        step = 0.0;
    }
    // The waves tell the height more exactly than the ray does, which may come from far.
    let turn = shape_turn(shape, step * ahead);
    let height_there = shape.height + step * dot(shape.gradient + 0.5 * turn, ahead);
    let place = ray.origin.xy + t * ahead;
    return WaveMarch(vec3f(place, water.level + height_there), shape.gradient + turn, true);
}
