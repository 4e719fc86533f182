// Whether a ray meets the waves again before its hit, so that what flat water shows says nothing of it.
// World space, metres. Rays that do not are tested further.
//
// provides: occluded
// needs: geometry/ray, geometry/hit
// slots: leave, further: occluded
// domain: occluded(texel -100 to 1e4)

fn occluded(ray: Ray, hit: Hit, texel: vec2f) -> bool {
    let met = leave(ray);
    let to_hit = select(1e30, dot(hit.position - ray.origin, ray.direction), hit.found);
    if met.found && dot(met.point - ray.origin, ray.direction) < to_hit {
        return true;
    }
    return further(ray, hit, texel);
}
