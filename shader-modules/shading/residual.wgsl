// Shows the estimate of a pixel's error as a grey, instead of a colour: linear, 0 for 2⁻²⁰ pixels and
// less, 1 for 2²⁰ and more, a fortieth for each doubling. `shown` is the point that the ray meets.
//
// provides: colour
// needs: geometry/ray, geometry/hit
// domain: colour()
// domain: shown()

fn colour(hit: Hit, ray: Ray) -> vec3f {
    // Scaled first: ½ + log₂(residual) / 40 would lose its digits next to 0.
    return vec3f(log2(clamp(hit.residual * 1048576.0, 1.0, 1099511627776.0)) / 40.0);
}

fn shown(hit: Hit, ray: Ray) -> vec4f {
    return select(vec4f(0.0, 0.0, 0.0, -1.0), vec4f(hit.position, hit.object), hit.found);
}
