// The water's shape above a place of the rest plane (metres). By default flat.
//
// needs: water/shape
// when many_waves: water/long_wave_sum
// when waves: water/wave_sum

fn surface(at: vec2f) -> Shape {
    return Shape(0.0, vec2f(0.0), vec3f(0.0));
}
