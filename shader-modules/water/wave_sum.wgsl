// The water's shape as a sum of plane waves.
// h = Σ A sin(k · x + φ), φ holding the time's part. Metres, radians.
//
// provides: surface
// needs: water/shape, water/sine
// domain: surface(at -1e3 to 1e3 from 1e-6)

struct Wave {
    wave_vector: vec2f,
    amplitude: f32,
    phase: f32,
}

var<storage, read> waves: array<Wave>;

// More terms than this are not looked at.
const MOST_WAVES = 256u;

fn surface(at: vec2f) -> Shape {
    var shape = Shape(0.0, vec2f(0.0));
    let count = min(arrayLength(&waves), MOST_WAVES);
    for (var i = 0u; i < count; i++) {
        let wave = waves[i];
        let angle = dot(wave.wave_vector, at) + wave.phase;
        let circle = wave.amplitude * cosine_and_sine(angle);
        shape.height += circle.y;
        shape.gradient += circle.x * wave.wave_vector;
    }
    return shape;
}
