// Shades the point that a ray meets, rather than fetch what was drawn near it.
// World space, metres. Where the ray meets nothing it sees the sky.
//
// provides: colour
// needs: geometry/ray, geometry/hit, shading/surface_point, sky/gradient
// slots: shade
// domain: shown()

fn colour(hit: Hit, ray: Ray) -> vec3f {
    if !hit.found {
        return sky_colour(hit.direction);
    }
    let facing = select(-1.0, 1.0, dot(hit.normal, hit.direction) <= 0.0);
    return shade(SurfacePoint(hit.position, hit.shading_normal, hit.normal, facing, u32(hit.object)));
}

fn shown(hit: Hit, ray: Ray) -> vec4f {
    return select(vec4f(0.0, 0.0, 0.0, -1.0), vec4f(hit.position, hit.object), hit.found);
}
