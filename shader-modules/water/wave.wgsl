// A plane wave, A sin(k · x + φ), φ holding the time's part.
//
// needs: water/shape, water/sine
// domain: Wave(wave_vector -20 to 20 from 1e-3, amplitude 0 to 1, phase 0 to 6.2831)
// domain: with_wave(at -1e4 to 1e4 from 1e-6)

// `wave_vector`: k, 1/m; `amplitude`: A, metres; `phase`: φ, radians.
struct Wave {
    wave_vector: vec2f,
    amplitude: f32,
    phase: f32,
}

// A shape with a wave added to it, at a place of the rest plane (metres).
fn with_wave(shape: Shape, wave: Wave, at: vec2f) -> Shape {
    let k = wave.wave_vector;
    // In this order drivers that rearrange sums (`dot(k, at) + phase`) leave it as it is.
    let angle = k.x * at.x + (k.y * at.y + wave.phase);
    let circle = wave.amplitude * cosine_and_sine(angle);
    let along = circle.y * k;
    return Shape(
        shape.height + circle.y,
        shape.gradient + circle.x * k,
        shape.bend - vec3f(along.x * k, along.y * k.y),
    );
}
