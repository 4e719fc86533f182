// z of the water that rays meet, at a place of the rest plane (metres). By default the rest plane.
//
// needs: water/body
// when displaced: water/wave_level

fn level(at: vec2f) -> f32 {
    return water.level;
}
