// One intersection for rays that pass through the water, another for those that it reflects.
// They are told apart by their direction: a reflected ray stays on the camera's side.
//
// provides: intersect
// needs: geometry/ray, geometry/hit, water/body
// slots: behind: intersect, before: intersect
// domain: intersect(texel -100 to 1e4)

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    if water.camera_side * ray.direction.z > 0.0 {
        return before(ray, texel);
    }
    return behind(ray, texel);
}
