// z of the waves' own surface. World space, metres.
//
// provides: level
// needs: water/body
// slots: surface

fn level(at: vec2f) -> f32 {
    return water.level + surface(at).height;
}
