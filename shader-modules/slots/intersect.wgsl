// What a ray behind the water meets. `texel`: where to look first in the seen buffers.
// World space, metres. By default nothing.
//
// needs: geometry/ray, geometry/hit

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    return no_hit(ray, texel);
}
