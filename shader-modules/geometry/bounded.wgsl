// A cheap intersection where its residual is within a bound, an exact one elsewhere.
// The residual estimates the error of every pixel without a reference; what meets nothing, or leaves
// the seen buffers, has the largest residual. It is blind to what may hide on the way there: that is
// asked of `occluded`. A bound of 0 leaves nothing to the cheap one.
//
// provides: intersect
// needs: geometry/ray, geometry/hit
// slots: first: intersect, then: intersect, occluded
// number bound_px: 0 to 64 px, step 0.05
// domain: intersect(texel -100 to 1e4)
// identity when not waves: exactly

override bound_px: f32 = 0.25;

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    let hit = first(ray, texel);
    if hit.residual < bound_px && !occluded(ray, hit, texel) {
        return hit;
    }
    return then(ray, texel);
}
