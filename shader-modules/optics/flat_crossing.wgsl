// Where light between two points crosses flat water.
// Fermat's path as a root in u, the tangent of the ray's angle on the side of the lower index:
// f u + s u / √(N² + M u²) = d with M = N² − 1. Two Halley steps from a seed within 41 % of the
// root; every input gives a finite result. The error is within 4 ulp times (1 + condition): near
// the critical distance d = s / √M the problem itself is badly conditioned, as (s/f)^⅔.
//
// needs: optics/crossing_seed, water/body
// domain: flat_crossing(low 1e-3 to 1e3 log, high 1e-3 to 1e3 log, apart 1e-3 to 3e3 log near high / water.root_high) against crossing

// `tangent`: u. `shrink`: 1 / √(N² + M u²), the ratio of the tangents on the two sides.
struct Crossing {
    tangent: f32,
    shrink: f32,
}

// `low`: distance from the plane on the side of the lower refractive index (f), `high`: on the
// other side (s), `apart`: horizontal distance (d); metres, none negative.
fn flat_crossing(low: f32, high: f32, apart: f32) -> Crossing {
    let n = water.larger_index;
    let root = max(water.root_high, 1e-15);
    let m = root * root;
    let least = 1e-15 * (low + high + apart) + 1e-30;
    let f = max(low, least);
    let s = max(high, least);
    let d = max(apart, 1e-18);
    let u0 = crossing_seed(f, s, d, n, root);
    var u = u0;
    for (var i = 0; i < 2; i++) {
        let r = inverseSqrt(n * n + m * u * u);
        let q = s * n * n * r * r * r;
        let slope = f + q;
        let t = (f * u + s * u * r - d) / slope;
        u -= t / (1.0 + 1.5 * t * q * m * u * r * r / slope);
        u = clamp(u, 0.7 * u0, 1.2 * u0);
    }
    return Crossing(u, inverseSqrt(n * n + m * u * u));
}
