// Takes it that nothing hides from the seen buffers on a ray's way: what the slot does by default,
// for variants that leave a test out.
//
// provides: occluded
// needs: geometry/ray, geometry/hit
// domain: occluded(texel -100 to 1e4)

fn occluded(ray: Ray, hit: Hit, texel: vec2f) -> bool {
    return false;
}
