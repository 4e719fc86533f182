//! The flat-water crossing in WGSL against bisection: two independent solutions.

mod common;

use common::{Chance, call, program};
use meniscus_stress::{DoubleDouble, Interval, Lanes, Scalar};

/// Newton's method in the tangent of the air angle, from below.
const CROSSING: &str = "
fn crossing(f: f32, s: f32, d: f32, n: f32) -> f32 {
    let m = n * n - 1.0;
    var u = max(n * d / (s + f * n), (d - s / sqrt(m)) / f);
    for (var i = 0; i < 16; i++) {
        let r = inverseSqrt(n * n + m * u * u);
        let height = f * u + s * u * r - d;
        let slope = f + s * n * n * r * r * r;
        u -= height / slope;
    }
    return f * u;
}";

/// Solves Snell's law sin α = n sin β for the crossing by halving, in the crossing itself.
fn bisected(f: f64, s: f64, d: f64, n: f64) -> f64 {
    let (mut low, mut high) = (0.0, d);
    for _ in 0..200 {
        let x = 0.5 * (low + high);
        let air = x / x.hypot(f);
        let water = (d - x) / (d - x).hypot(s);
        if air < n * water { low = x } else { high = x }
    }
    0.5 * (low + high)
}

fn inputs(count: usize) -> [Vec<f32>; 4] {
    let mut chance = Chance::new(31);
    let mut column = |low, high| (0..count).map(|_| chance.log(low, high)).collect();
    [
        column(0.3, 30.0),
        column(0.01, 10.0),
        column(0.05, 200.0),
        column(1.1, 2.4),
    ]
}

fn solved<S: Scalar>(inputs: &[Vec<f32>; 4]) -> Vec<S> {
    let arguments = inputs.each_ref().map(|c| Lanes::<S>::scalars(c));
    call(&program(CROSSING), "crossing", &arguments)
        .floats(0)
        .expect("floats")
        .to_vec()
}

#[test]
fn f64_evaluation_agrees_with_bisection() {
    let inputs = inputs(3000);
    let found = solved::<f64>(&inputs);
    for lane in 0..found.len() {
        let [f, s, d, n] = [0, 1, 2, 3].map(|i| f64::from(inputs[i][lane]));
        let right = bisected(f, s, d, n);
        let error = (found[lane] - right).abs() / d;
        assert!(
            error < 1e-14,
            "f {f}, s {s}, d {d}, n {n}: {} is not {right}",
            found[lane]
        );
    }
}

#[test]
fn f32_evaluation_is_backward_stable() {
    let inputs = inputs(3000);
    let (single, double) = (solved::<f32>(&inputs), solved::<f64>(&inputs));
    for lane in 0..single.len() {
        let error = (f64::from(single[lane]) - double[lane]).abs();
        let bound = 4.0 * f64::from(f32::EPSILON) * f64::from(inputs[2][lane]);
        assert!(error <= bound, "{error} beyond {bound}");
    }
}

#[test]
fn double_double_confirms_f64() {
    let inputs = inputs(300);
    let (double, exact) = (solved::<f64>(&inputs), solved::<DoubleDouble>(&inputs));
    for lane in 0..double.len() {
        let difference = exact[lane]
            .minus(DoubleDouble::from_f64(double[lane]))
            .to_f64();
        assert!(difference.abs() < f64::exp2(-40.0) * double[lane]);
    }
}

#[test]
fn intervals_of_the_bracket_stay_around_the_truth() {
    // One step of the method, without iteration: the enclosure is meaningful there.
    let source = "fn bound(f: f32, s: f32, d: f32, n: f32) -> f32 {
        return f * max(n * d / (s + f * n), (d - s / sqrt(n * n - 1.0)) / f);
    }";
    let inputs = inputs(500);
    let arguments = inputs.each_ref().map(|c| Lanes::<Interval>::scalars(c));
    let found = call(&program(source), "bound", &arguments);
    for (lane, bound) in found.floats(0).expect("floats").iter().enumerate() {
        let [f, s, d, n] = [0, 1, 2, 3].map(|i| f64::from(inputs[i][lane]));
        assert!(bound.high.is_finite());
        assert!(
            bound.low <= bisected(f, s, d, n) * (1.0 + 1e-12),
            "a lower bound of the root"
        );
    }
}
