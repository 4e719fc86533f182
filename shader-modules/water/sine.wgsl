// Sine and cosine together, for the price of one, and as exact on every driver.
// The angle is reduced to ±π/4 with π/2 in three parts (Cody and Waite 1980), then Taylor's series to
// the ninth and eighth power: below half a unit in the last place there. Radians.
//
// domain: cosine_and_sine(angle -3e5 to 3e5 from 1e-9) against circle

// x: cosine, y: sine.
fn cosine_and_sine(angle: f32) -> vec2f {
    let turns = round(angle * 0.63661977);
    // The first two parts have few bits, so that their products are exact up to 2^12 quarter turns.
    let reduced = ((angle - turns * 1.5703125) - turns * 4.837512969970703e-4) - turns * 7.549789948768648e-8;
    // Where angles are too large for that, what rounding leaves must not blow the series up.
    let r = clamp(reduced, -1.0, 1.0);
    let z = r * r;
    let sine = r + r * z * (-1.6666667e-1 + z * (8.3333333e-3 + z * (-1.9841270e-4 + z * 2.7557319e-6)));
    let cosine = 1.0 + z * (-0.5 + z * (4.1666667e-2 + z * (-1.3888889e-3 + z * 2.4801587e-5)));
    let quarter = i32(turns) & 3;
    let swapped = select(vec2f(cosine, sine), vec2f(sine, cosine), (quarter & 1) == 1);
    let signs = vec2f(select(1.0, -1.0, quarter == 1 || quarter == 2), select(1.0, -1.0, quarter >= 2));
    return swapped * signs;
}
