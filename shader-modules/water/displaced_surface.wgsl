// Where a camera ray meets the waves themselves: the first crossing. World space, metres.
// A ray that stays on its side of the waves meets nothing, nor does one that rises and skims crests for
// longer than `march_steps` reach.
//
// provides: meet
// needs: geometry/ray, water/body, water/march, water/meeting, water/shape
// slots: surface
// number march_steps: 1 to 256, step 1
// number newton_steps: 1 to 16, step 1
// domain: meet(ray.origin -1e4 to 1e4 from 1e-6, ray.direction unit) against waves

// Steps of rays that may run along the waves, and of those too steep for it.
override march_steps: i32 = 128;
override newton_steps: i32 = 8;

fn meet(ray: Ray) -> Meeting {
    let side = water.camera_side;
    let steepest = 1.01 * water.slope_bound * length(ray.direction.xy);
    let steep = -side * ray.direction.z > steepest;
    let march = march_to_waves(ray, side, steep, select(march_steps, newton_steps, steep));
    let normal = shape_normal(Shape(0.0, march.gradient, vec3f(0.0)));
    return Meeting(march.point, normal, march.found);
}
