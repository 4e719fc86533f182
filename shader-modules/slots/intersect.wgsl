// What a ray behind the water meets. `texel`: where to look first in the seen buffers.
// World space, metres. By default nothing.
//
// needs: geometry/ray, geometry/hit

fn intersect(ray: Ray, texel: vec2f) -> Hit {
    return Hit(vec3f(0.0), vec3f(0.0), vec3f(0.0), -1.0, texel, 0.0, false);
}
