// Where light crosses flat water, right to the last bits also near the critical distance.
// As the default, but where v = u√M/N > 0.6 with the path written as
// f u − (G + s / (w (w + v))) / √M, w = √(1 + v²), G = d√M − s, of which no part cancels. √M comes
// as a sum of two floats from the host; what products, quotients and sums lose is taken exactly
// by splitting factors into halves of 12 bits, which does not rely on a fused `fma`, and carried
// along. Within 4 ε = 2⁻²¹ of the tangent, relatively.
//
// provides: crossing
// needs: optics/crossing_seed, optics/flat_crossing, water/body
// domain: crossing(low 1e-3 to 1e3 log, high 1e-3 to 1e3 log, apart 1e-3 to 3e3 log near high / water.root_high) against crossing

// The upper 12 bits of a number's significand.
fn crossing_upper(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) & 0xfffff000u);
}

// What rounding takes from the product p = a b. Dekker 1971, "A floating-point technique for
// extending the available precision".
fn crossing_lost(a: f32, b: f32, p: f32) -> f32 {
    let a_upper = crossing_upper(a);
    let b_upper = crossing_upper(b);
    let a_lower = a - a_upper;
    let b_lower = b - b_upper;
    return a_upper * b_upper - p + a_upper * b_lower + a_lower * b_upper + a_lower * b_lower;
}

fn crossing(low: f32, high: f32, apart: f32) -> Crossing {
    let n = water.larger_index;
    let root = max(water.root_high, 1e-15);
    let m = root * root;
    let least = 1e-15 * (low + high + apart) + 1e-30;
    let f = max(low, least);
    let s = max(high, least);
    let d = max(apart, 1e-18);
    let product = d * root;
    let high_part = product - s;
    let held = product - high_part;
    let product_lost = crossing_lost(d, root, product) + d * water.root_low;
    let g_part = (product - (high_part + held)) + (held - s) + product_lost;
    let g = high_part + g_part;
    let g_low = g_part - (g - high_part);
    let u0 = crossing_seed(f, s, d, n, root);
    var u = u0;
    for (var i = 0; i < 2; i++) {
        let r = inverseSqrt(n * n + m * u * u);
        let q = s * n * n * r * r * r;
        let slope = f + q;
        let scaled = u * root;
        let v = scaled / n;
        let v_back = v * n;
        let scaled_lost = crossing_lost(u, root, scaled) + u * water.root_low;
        let v_low = (scaled - v_back - crossing_lost(v, n, v_back) + scaled_lost) / n;
        let w = sqrt(1.0 + v * v);
        let bent = s / (w * (w + v));
        let rise = g + bent;
        let level = rise / root;
        let back = level * root;
        let reach = f * u;
        // What the sum, v and the quotient lost.
        let sum_lost = select(g - (rise - bent), bent - (rise - g), g > bent) + g_low;
        let v_lost = -s * v_low / (w * w * w);
        let level_lost = rise - back - crossing_lost(level, root, back) - level * water.root_low;
        let lost = (sum_lost + v_lost + level_lost) / root;
        let reach_lost = crossing_lost(f, u, reach);
        let far = (reach - level) + (reach_lost - lost);
        // Before it, neither of the two parts cancels against the other.
        let other = u / (n * w);
        let near = select((s * other - d) + reach, (reach - d) + s * other, reach > s * other);
        let gap = select(near + reach_lost, far, v > 0.6);
        let t = gap / slope;
        u -= t / (1.0 + 1.5 * t * q * m * u * r * r / slope);
        u = clamp(u, 0.7 * u0, 1.2 * u0);
    }
    return Crossing(u, inverseSqrt(n * n + m * u * u));
}
