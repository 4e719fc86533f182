// The water's shape as a sum of more plane waves than a uniform block holds, read from storage.
// h = Σ A sin(k · x + φ), φ holding the time's part. Metres, radians.
//
// provides: surface
// needs: water/shape, water/wave
// domain: surface(at -1e4 to 1e4 from 1e-6)

var<storage, read> waves: array<Wave>;

// Loops have to end: no more terms than this are looked at.
const MOST_WAVES = 4096u;

fn surface(at: vec2f) -> Shape {
    var shape = Shape(0.0, vec2f(0.0), vec3f(0.0));
    let count = min(arrayLength(&waves), MOST_WAVES);
    for (var i = 0u; i < count; i++) {
        shape = with_wave(shape, waves[i], at);
    }
    return shape;
}
