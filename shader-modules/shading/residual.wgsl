// Shows the estimate of a pixel's error as a grey, instead of a colour: linear, 0 for 2⁻²⁰ pixels and
// less, 1 for 2²⁰ and more, a fortieth for each doubling. `shown` is the point that the ray meets.
//
// provides: colour
// needs: geometry/ray, geometry/hit
// domain: colour()
// domain: shown()

fn colour(hit: Hit, ray: Ray) -> vec3f {
    return vec3f(0.5 + log2(clamp(hit.residual, 1e-9, 1e9)) / 40.0);
}

fn shown(hit: Hit, ray: Ray) -> vec4f {
    return select(vec4f(0.0, 0.0, 0.0, -1.0), vec4f(hit.position, hit.object), hit.found);
}
