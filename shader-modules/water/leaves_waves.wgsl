// Where a ray that starts on the waves meets them again: out through a trough, or in at a crest.
// World space, metres. The ray runs on the side of the surface that it turns to at its start. One that
// rises from it and skims crests for longer than `leave_steps` reach is taken not to meet them.
//
// provides: leave
// needs: geometry/ray, water/march, water/meeting, water/shape
// slots: surface
// number leave_steps: 1 to 256, step 1
// domain: leave(ray.origin -1e4 to 1e4 from 1e-6, ray.direction unit)

override leave_steps: i32 = 96;

fn leave(ray: Ray) -> Meeting {
    let climb = ray.direction.z - dot(surface(ray.origin.xy).gradient, ray.direction.xy);
    let march = march_to_waves(ray, select(-1.0, 1.0, climb > 0.0), false, leave_steps);
    let normal = shape_normal(Shape(0.0, march.gradient, vec3f(0.0)));
    return Meeting(march.point, normal, march.found);
}
