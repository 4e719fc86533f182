// The colour of rays that pass through the water from one place, of those that it reflects from another.
// They are told apart by their direction: a reflected ray stays on the camera's side.
//
// provides: colour
// needs: geometry/ray, geometry/hit, water/body
// slots: behind: colour, before: colour
// domain: colour()
// domain: shown()

fn colour(hit: Hit, ray: Ray) -> vec3f {
    if water.camera_side * ray.direction.z > 0.0 {
        return before(hit, ray);
    }
    return behind(hit, ray);
}

fn shown(hit: Hit, ray: Ray) -> vec4f {
    if water.camera_side * ray.direction.z > 0.0 {
        return before_shown(hit, ray);
    }
    return behind_shown(hit, ray);
}
