// Whether something may stand on a ray's way to its hit that the seen buffers hide there. `texel`:
// where the ray's origin, on the water, appears in them. By default nothing does.
//
// needs: geometry/ray, geometry/hit

fn occluded(ray: Ray, hit: Hit, texel: vec2f) -> bool {
    return false;
}
