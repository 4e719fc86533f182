// Where a camera ray meets the water. World space, metres.
// By default on the rest plane, with the normal of the waves above that point.
//
// needs: geometry/ray, water/body, water/meeting, water/shape
// slots: surface
// when displaced: water/displaced_surface

fn meet(ray: Ray) -> Meeting {
    let height = ray.origin.z - water.level;
    // A level ray gives an infinite or undefined distance, and no meeting.
    let distance = -height / ray.direction.z;
    if !(distance > 0.0 && distance < 1e9) {
        return Meeting(vec3f(0.0), vec3f(0.0, 0.0, 1.0), false);
    }
    // On the plane to the last bit, from however far the ray comes.
    let point = vec3f(ray.origin.xy + distance * ray.direction.xy, water.level);
    return Meeting(point, shape_normal(surface(point.xy)), true);
}
