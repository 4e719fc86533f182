// Where light crosses flat water by a fixed point: the depth behind the water is foreshortened as
// the last ray was bent, and the ray drawn straight to it. For comparison only: it gains about one
// digit in two steps in steep views, and next to nothing near the critical distance.
//
// provides: crossing
// needs: optics/flat_crossing, water/body
// number steps: 1 to 64, step 1
// domain: crossing(low 0.3 to 30 log, high 0.01 to 10 log, apart 0.05 to 200 log) against crossing

override steps: i32 = 4;

fn crossing(low: f32, high: f32, apart: f32) -> Crossing {
    let n = water.larger_index;
    let f = max(low, 1e-12);
    var shrink = 1.0 / n;
    var u = 0.0;
    for (var i = 0; i < steps; i++) {
        u = apart / (f + high * shrink);
        shrink = inverseSqrt(n * n + water.root_high * u * (water.root_high * u));
    }
    return Crossing(u, shrink);
}
