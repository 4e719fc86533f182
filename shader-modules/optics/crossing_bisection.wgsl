// Where light crosses flat water by halving the distance. For comparison only: it always converges,
// one bit a step, and knows the crossing to a part of the whole distance rather than of itself.
//
// provides: crossing
// needs: optics/flat_crossing, water/body
// number steps: 1 to 64, step 1
// domain: crossing(low 0.3 to 30 log, high 0.01 to 10 log, apart 0.05 to 200 log) against crossing

override steps: i32 = 24;

fn crossing(low: f32, high: f32, apart: f32) -> Crossing {
    let n = water.larger_index;
    let f = max(low, 1e-12);
    let s = max(high, 1e-12);
    var least = 0.0;
    var most = apart;
    for (var i = 0; i < steps; i++) {
        let x = 0.5 * (least + most);
        let y = apart - x;
        let short = x * inverseSqrt(x * x + f * f) < n * y * inverseSqrt(y * y + s * s);
        least = select(least, x, short);
        most = select(x, most, short);
    }
    let u = 0.5 * (least + most) / f;
    return Crossing(u, inverseSqrt(n * n + water.root_high * u * (water.root_high * u)));
}
