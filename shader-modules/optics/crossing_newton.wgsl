// Where light crosses flat water by Newton's method in the crossing's own distance, six steps from
// the straight line: Liu, Han, Fei 2020, eq. 1, solved as one would at first. For comparison only:
// it does not converge far beyond the critical distance, and the far side's distance cancels.
//
// provides: crossing
// needs: optics/flat_crossing, water/body
// number steps: 1 to 64, step 1
// domain: crossing(low 0.3 to 30 log, high 0.01 to 10 log, apart 0.05 to 200 log) against crossing

override steps: i32 = 6;

fn crossing(low: f32, high: f32, apart: f32) -> Crossing {
    let n = water.larger_index;
    let f = max(low, 1e-12);
    let s = max(high, 1e-12);
    var x = apart * f / (f + s);
    for (var i = 0; i < steps; i++) {
        let y = apart - x;
        let a = inverseSqrt(x * x + f * f);
        let b = inverseSqrt(y * y + s * s);
        // The derivative is positive, but may be too small for a float.
        let slope = f * a * f * a * a + n * s * b * s * b * b;
        x = clamp(x - (x * a - n * y * b) / max(slope, 1e-30), 0.0, apart);
    }
    let u = x / f;
    return Crossing(u, inverseSqrt(n * n + water.root_high * u * (water.root_high * u)));
}
