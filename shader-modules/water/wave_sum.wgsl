// The water's shape as a sum of plane waves.
// h = Σ A sin(k · x + φ), φ holding the time's part. Metres, radians.
//
// provides: surface
// needs: water/body, water/shape, water/wave
// domain: surface(at -1e4 to 1e4 from 1e-6)

// The terms that the block of the water has room for.
const MOST_WAVES = 64u;

fn surface(at: vec2f) -> Shape {
    var shape = Shape(0.0, vec2f(0.0), vec3f(0.0));
    let count = min(water.wave_count, MOST_WAVES);
    for (var i = 0u; i < count; i++) {
        shape = with_wave(shape, water.waves[i], at);
    }
    return shape;
}
