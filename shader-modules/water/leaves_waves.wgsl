// Where a ray that starts on the waves meets them again: out through a trough, or in at a crest.
// World space, metres. The ray runs on the side of the surface that it turns to at its start. The
// height over the surface falls no faster than the slope bound allows, and no faster than a
// parabola with the bound on curvature: steps to where the later of the two reaches 0 cannot
// overshoot, and close to a crossing they are Newton's. A ray that skims crests for longer than
// `leave_steps` is taken not to meet them.
//
// provides: leave
// needs: geometry/ray, water/body, water/meeting, water/shape
// slots: surface
// number leave_steps: 1 to 256, step 1

override leave_steps: i32 = 48;

fn leave(ray: Ray) -> Meeting {
    var shape = surface(ray.origin.xy);
    let side = select(-1.0, 1.0, dot(ray.direction, shape_normal(shape)) > 0.0);
    let climb = side * ray.direction.z;
    let along = length(ray.direction.xy);
    // How much steeper the ray may be met than it climbs; none if it outruns all waves.
    let closing = water.slope_bound * along - climb;
    let bend = max(water.curvature_bound * along * along, 1e-9);
    let start = side * (ray.origin.z - water.level);
    // Above the band that the waves reach, a climbing ray has left them.
    let limit = select(1e6, (water.height_bound - start) / max(climb, 1e-9), climb > 0.0);
    var t = 0.0;
    var steps = select(0, leave_steps, closing > 0.0);
    var found = false;
    var point = ray.origin;
    for (var i = 0; i < 256; i++) {
        if i >= steps {
            break;
        }
        point = ray.origin + t * ray.direction;
        shape = surface(point.xy);
        let gap = side * (point.z - water.level - shape.height);
        let rate = climb - side * dot(shape.gradient, ray.direction.xy);
        found = rate < 0.0 && gap <= 1e-6 * (1.0 + t);
        let above = max(gap, 0.0);
        let root = sqrt(rate * rate + 2.0 * bend * above);
        let parabola = select((rate + root) / bend, 2.0 * above / max(root - rate, 1e-20), rate < 0.0);
        let step = max(max(parabola, above / max(closing, 1e-9)), 1e-6 * (1.0 + t));
        steps = select(steps, 0, found || t + step > limit);
        t += select(step, 0.0, found);
    }
    return Meeting(point, shape_normal(shape), found);
}
