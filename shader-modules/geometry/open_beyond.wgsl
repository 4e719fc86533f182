// Takes a hit for none where the seen buffers show nothing at its place: beyond the outlines of objects
// planes go on, and behind the water, seen from below, there is the sky. What lies outside the
// buffers stays. The residual is as large as it was, so that a bound still asks for such a pixel.
//
// provides: intersect
// needs: geometry/ray, geometry/hit, screen/residual, water/body
// slots: solid: intersect
// domain: intersect(texel -100 to 1e4)

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    let hit = solid(ray, texel);
    let behind = water.camera_side * ray.direction.z < 0.0;
    if behind && hit.found && hit.residual >= UNKNOWN_RESIDUAL && is_seen(hit.texel) {
        var nothing = no_hit(ray, hit.texel);
        nothing.residual = hit.residual;
        return nothing;
    }
    return hit;
}
