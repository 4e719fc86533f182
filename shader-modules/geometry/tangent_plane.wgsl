// Where a refracted ray meets the tangent plane of the surface seen near it.
// Liu, Han, Fei 2020, narrow phase, eq. 3. World space, metres. A ray that runs along the plane, or
// meets it behind its origin, is taken to meet the seen point itself. Where nothing is seen there
// is no hit.
//
// provides: intersect
// needs: geometry/ray, geometry/hit, screen/seen
// slots: reproject

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    let seen = seen_at(texel);
    if seen.object < 0.0 {
        return no_hit(ray, texel);
    }
    let slope = dot(seen.normal, ray.direction);
    let offset = dot(seen.normal, seen.position - ray.origin);
    var position = seen.position;
    // |slope| ≥ 1e-4 and one sign: the quotient is finite and positive.
    if slope * offset > 0.0 && abs(slope) > 1e-4 {
        position = ray.origin + (offset / slope) * ray.direction;
    }
    return Hit(position, seen.normal, seen.shading_normal, seen.object, reproject(position), 0.0, true, ray.direction);
}
