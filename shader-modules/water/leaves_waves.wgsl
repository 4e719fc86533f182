// Where a ray that starts on the waves meets them again: out through a trough, or in at a crest.
// World space, metres. The ray runs on the side of the surface that it turns to at its start. One
// that skims crests for longer than `leave_steps` reach is taken not to meet them.
//
// provides: leave
// needs: geometry/ray, water/march, water/meeting, water/shape
// slots: surface
// number leave_steps: 1 to 256, step 1
// domain: leave(ray.origin -100 to 100 from 1e-6, ray.direction unit)

override leave_steps: i32 = 96;

fn leave(ray: Ray) -> Meeting {
    let normal = shape_normal(surface(ray.origin.xy));
    let side = select(-1.0, 1.0, dot(ray.direction, normal) > 0.0);
    let march = march_to_waves(ray, side, 0.0, leave_steps);
    let point = ray.origin + march.distance * ray.direction;
    return Meeting(point, shape_normal(march.shape), march.found);
}
