// One test for rays that pass through the water, another for those that it reflects.
// They are told apart by their direction: a reflected ray stays on the camera's side.
//
// provides: occluded
// needs: geometry/ray, geometry/hit, water/body
// slots: behind: occluded, before: occluded
// domain: occluded(texel -100 to 1e4)

fn occluded(ray: Ray, hit: Hit, texel: vec2f) -> bool {
    if water.camera_side * ray.direction.z > 0.0 {
        return before(ray, hit, texel);
    }
    return behind(ray, hit, texel);
}
