// z of the waves' own surface. World space, metres.
//
// provides: level
// needs: water/body
// slots: surface
// domain: level(at -1e4 to 1e4 from 1e-6)

fn level(at: vec2f) -> f32 {
    return water.level + surface(at).height;
}
