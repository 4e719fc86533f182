// A first guess at where light crosses flat water, within −15 % and +41 % of the root for every
// ratio of the distances. With G = d√M − s it is the larger root of a rational bound on the path:
// A = max(fN − G, 0)(s + fN + d√M) / (Nd)², u₀ = √(1 / (A + M/N² (2fN/s)^⅔) + (max(G, 0) / (f√M))²).
// Metres; every input gives a finite result.
//
// domain: crossing_seed(low 1e-3 to 1e3 log, high 1e-3 to 1e3 log, apart 1e-3 to 3e3 log, index 1.0001 to 2.5, root 0.0142 to 2.3)

// `low`, `high`, `apart`: as of the slot `crossing`, positive. `index`: N, the larger refractive
// index relative to the smaller; `root`: √(N² − 1). The result is the tangent of the ray's angle on
// the side of the lower index.
fn crossing_seed(low: f32, high: f32, apart: f32, index: f32, root: f32) -> f32 {
    let g = apart * root - high;
    let near = low * index;
    let sum = high + near + apart * root;
    let rising = max(near - g, 0.0) / (index * apart) * (sum / (index * apart));
    let ratio = root / index;
    let critical = ratio * ratio * pow(2.0 * near / high, 2.0 / 3.0);
    let beyond = max(g, 0.0) / (low * root);
    return sqrt(1.0 / (rising + critical) + beyond * beyond);
}
