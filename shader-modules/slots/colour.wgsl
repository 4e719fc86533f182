// The light that comes back along a ray behind the water, linear RGB; and which world point
// (metres) and object id (−1 for none) it shows. By default the sky's.
//
// needs: geometry/ray, geometry/hit, sky/gradient

fn colour(hit: Hit, ray: Ray) -> vec3f {
    return sky_colour(ray.direction);
}

fn shown(hit: Hit, ray: Ray) -> vec4f {
    return vec4f(0.0, 0.0, 0.0, -1.0);
}
