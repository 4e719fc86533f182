// What a pixel shows that looks through the water.
//
// needs: geometry/ray, geometry/hit, screen/target, sky/gradient
// slots: meet, deflect, intersect, colour
// domain: the pixels of a picture

// What stands before the water, with reversed depth.
var front_depth: texture_depth_2d;

struct Redirected {
    ray: Ray,
    hit: Hit,
    // Whether water is seen here, and whether anything of this pass is.
    wet: bool,
    kept: bool,
}

// The pixel's ray meets the water, is deflected, and meets something behind.
fn redirected(pixel: vec2f) -> Redirected {
    let ray = view_ray(view_target, pixel);
    let depth = textureLoad(front_depth, vec2i(pixel), 0);
    let met = meet(ray);
    let wet = met.found && view_is_nearer(view_target, met.point, depth);
    if !wet {
        return Redirected(ray, no_hit(ray, pixel), false, depth == 0.0);
    }
    let behind = deflect(Ray(met.point, ray.direction), met.normal);
    return Redirected(behind.ray, intersect(behind.ray, seen_texel(pixel)), true, true);
}

// Where a pixel lies in the seen buffers, which have a guard band around the picture; texels.
fn seen_texel(pixel: vec2f) -> vec2f {
    return pixel + 0.5 * (view_target.seen_size - view_target.size);
}

// Its light, linear RGB: the sky's where neither water nor anything before it is seen.
fn redirected_colour(redirected: Redirected) -> vec4f {
    if !redirected.wet {
        return vec4f(sky_colour(redirected.ray.direction), 1.0);
    }
    return vec4f(colour(redirected.hit, redirected.ray), 1.0);
}

// The world point (metres) and object id of that light; the id is −1 for the sky.
fn redirected_shown(redirected: Redirected) -> vec4f {
    if !redirected.wet {
        return vec4f(0.0, 0.0, 0.0, -1.0);
    }
    return shown(redirected.hit, redirected.ray);
}
