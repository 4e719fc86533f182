//! The number systems keep what they promise.

mod common;

use common::{Chance, call, program};
use meniscus_stress::{
    Column, DoubleDouble, Dual, Elementary, Interval, Lanes, Resources, Scalar, Stochastic,
};

const FORMULAS: [&str; 9] = [
    "a * b - c",
    "(a + b) / (c + 4.0)",
    "sqrt(a * a + b * b)",
    "sin(a) * cos(b) + tan(0.3 * c)",
    "exp(-a * a) + log(2.5 + b)",
    "pow(2.5 + a, b) + atan2(c, 2.5 + b)",
    "inverseSqrt(1.0 + a * a) * sinh(b) - tanh(c)",
    "mix(a, b, c) + smoothstep(-1.0, 2.0, a) + asin(0.4 * a) - acos(0.4 * b) * atan(c)",
    "dot(normalize(vec3f(a, b, 1.5)), refract(vec3f(0.6, 0.0, -0.8), vec3f(0.0, 0.0, 1.0), 0.75))",
];

fn formula(text: &str) -> meniscus_stress::Program {
    program(&format!(
        "fn f(a: f32, b: f32, c: f32) -> f32 {{ return {text}; }}"
    ))
}

fn inputs(seed: u64, count: usize) -> [Vec<f32>; 3] {
    let mut chance = Chance::new(seed);
    std::array::from_fn(|_| (0..count).map(|_| chance.within(-2.0, 2.0)).collect())
}

fn evaluated<S: Scalar>(text: &str, inputs: &[Vec<f32>; 3]) -> Vec<S> {
    let arguments = inputs.each_ref().map(|x| Lanes::<S>::scalars(x));
    call(&formula(text), "f", &arguments)
        .floats(0)
        .expect("floats")
        .to_vec()
}

fn dd(x: f64) -> DoubleDouble {
    DoubleDouble::new(x, 0.0)
}

/// Relative distance; absolute below 1.
fn apart(a: DoubleDouble, b: DoubleDouble) -> f64 {
    a.minus(b).to_f64().abs() / b.to_f64().abs().max(1.0)
}

#[test]
fn double_double_has_31_digits() {
    let mut chance = Chance::new(1);
    let third = dd(1.0).over(dd(3.0));
    assert!(apart(third.times(dd(3.0)), dd(1.0)) < 1e-31);
    // √2 = 1.41421356237309504880168872420969807857…; the nearest f64 is too large by 9.667…e-17.
    let right = DoubleDouble::new(std::f64::consts::SQRT_2, -9.667_293_313_452_913e-17);
    assert!(apart(dd(2.0).root(), right) < 1e-31);
    for _ in 0..2000 {
        let a = dd(f64::from(chance.log(1e-3, 1e3))).plus(dd(1e-18 * f64::from(chance.bits())));
        let b = dd(f64::from(chance.log(1e-3, 1e3))).over(dd(3.0));
        assert!(apart(a.over(b).times(b), a) < 4e-31, "division");
        assert!(apart(a.root().times(a.root()), a) < 4e-31, "root");
        assert!(apart(a.plus(b).minus(b), a) < 1e-28, "sum");
        let difference = a.times(a).minus(b.times(b));
        assert!(
            apart(a.plus(b).times(a.minus(b)), difference) < 1e-25,
            "squares"
        );
    }
}

#[test]
fn double_double_functions_are_each_others_inverses() {
    use Elementary::{Acos, Acosh, Asin, Asinh, Atan, Atanh, Cos, Cosh, Exp, Exp2, Log, Log2};
    use Elementary::{Sin, Sinh, Tan, Tanh};
    let mut chance = Chance::new(4);
    let pairs = [
        (Exp, Log),
        (Exp2, Log2),
        (Sin, Asin),
        (Tan, Atan),
        (Sinh, Asinh),
        (Tanh, Atanh),
    ];
    for _ in 0..300 {
        let x = dd(f64::from(chance.within(-1.2, 1.2))).over(dd(3.0_f64.sqrt()));
        for (there, back) in pairs {
            let returned = x.elementary(there).elementary(back);
            assert!(
                apart(returned, x) < 1e-29,
                "{there:?} of {x:?} returns {returned:?}"
            );
        }
        let positive = x.magnitude().plus(dd(0.1));
        assert!(apart(positive.elementary(Cos).elementary(Acos), positive) < 1e-28);
        assert!(apart(positive.elementary(Cosh).elementary(Acosh), positive) < 1e-28);
        let (sin, cos) = (x.elementary(Sin), x.elementary(Cos));
        assert!(apart(sin.times(sin).plus(cos.times(cos)), dd(1.0)) < 1e-30);
        let square = positive.power(dd(0.5));
        assert!(apart(square, positive.root()) < 1e-29);
    }
}

#[test]
fn every_function_agrees_with_f64_in_double_double() {
    let mut chance = Chance::new(9);
    for function in Elementary::ALL {
        for _ in 0..500 {
            let x = match function {
                Elementary::Asin | Elementary::Acos | Elementary::Atanh => {
                    chance.within(-0.99, 0.99)
                }
                Elementary::Acosh => chance.within(1.0, 50.0),
                Elementary::Log | Elementary::Log2 => chance.log(1e-30, 1e30),
                _ => chance.within(-20.0, 20.0),
            };
            let right = function.of(f64::from(x));
            let found = dd(f64::from(x)).elementary(function).to_f64();
            let ulps = (found - right).abs() / (right.abs() * f64::EPSILON).max(1e-15);
            assert!(ulps < 8.0, "{function:?} of {x}: {found} is not {right}");
        }
    }
}

#[test]
fn f64_and_double_double_agree_where_nothing_cancels() {
    let inputs = inputs(21, 500);
    for text in FORMULAS {
        let (double, exact) = (
            evaluated::<f64>(text, &inputs),
            evaluated::<DoubleDouble>(text, &inputs),
        );
        for (a, b) in double.iter().zip(&exact) {
            let scale = b.to_f64().abs().max(1.0);
            assert!(
                (a - b.to_f64()).abs() <= 1e-13 * scale,
                "{text}: {a} is not {b:?}"
            );
        }
    }
}

#[test]
fn intervals_enclose_double_double() {
    let inputs = inputs(22, 2000);
    for text in FORMULAS {
        let enclosures = evaluated::<Interval>(text, &inputs);
        let exact = evaluated::<DoubleDouble>(text, &inputs);
        for (within, x) in enclosures.iter().zip(&exact) {
            let above = x.minus(dd(within.low));
            let below = dd(within.high).minus(*x);
            assert!(
                above.high >= 0.0 && below.high >= 0.0,
                "{text}: {x:?} is outside {within:?}"
            );
            assert!(
                within.width() < 1e-12 * (1.0 + within.high.abs()),
                "{text}: {within:?} is wide"
            );
        }
    }
}

#[test]
fn each_operation_rounds_outward() {
    let mut chance = Chance::new(6);
    let mut wide =
        || f64::from(chance.within(0.5, 2.0)) + 1e-9 * f64::from(chance.within(0.0, 1.0));
    type Both<S> = fn(S, S) -> S;
    let operations: [(&str, Both<Interval>, Both<DoubleDouble>); 6] = [
        ("plus", Scalar::plus, Scalar::plus),
        ("minus", Scalar::minus, Scalar::minus),
        ("times", Scalar::times, Scalar::times),
        ("over", Scalar::over, Scalar::over),
        ("root", |a, _| a.root(), |a, _| a.root()),
        ("fused", |a, b| a.fused(b, a), |a, b| a.fused(b, a)),
    ];
    for _ in 0..500 {
        let (a, b) = (wide(), wide());
        for (name, interval, exact) in operations {
            let within = interval(Interval::from_f64(a), Interval::from_f64(b));
            let x = exact(dd(a), dd(b));
            let inside =
                dd(within.low).minus(x).high <= 0.0 && x.minus(dd(within.high)).high <= 0.0;
            assert!(
                inside,
                "{name} of {a:e}, {b:e}: {x:?} is outside {within:?}"
            );
        }
    }
}

#[test]
fn intervals_of_wide_arguments_enclose_every_point() {
    let mut chance = Chance::new(5);
    for text in FORMULAS {
        let program = formula(text);
        let function = program.function("f").expect("compiles");
        for _ in 0..50 {
            let ends: [[f32; 2]; 3] = std::array::from_fn(|_| {
                let middle = chance.within(-2.0, 2.0);
                [middle, middle + chance.within(0.0, 0.4)]
            });
            let wide = ends.map(|[low, high]| Lanes {
                columns: vec![Column::Float(vec![Interval::new(
                    f64::from(low),
                    f64::from(high),
                )])],
            });
            let enclosure = function.call(&wide, 1, &Resources::new()).expect("runs");
            let enclosure = enclosure.floats(0).expect("floats")[0];
            let points: [Vec<f32>; 3] = ends.map(|[low, high]| {
                (0..64)
                    .map(|_| chance.within(low, high).clamp(low, high))
                    .collect()
            });
            for value in evaluated::<f64>(text, &points) {
                let inside = enclosure.low - 1e-12 <= value && value <= enclosure.high + 1e-12;
                assert!(
                    inside || value.is_nan(),
                    "{text}: {value} is outside {enclosure:?}"
                );
            }
        }
    }
}

#[test]
fn intervals_tell_where_they_cannot_decide() {
    let program = program("fn f(a: f32) -> f32 { if a < 1.0 { return a; } return 2.0 * a; }");
    let arguments = Lanes {
        columns: vec![Column::Float(vec![
            Interval::new(0.5, 0.9),
            Interval::new(0.9, 1.1),
            Interval::new(1.2, 1.3),
        ])],
    };
    let function = program.function("f").expect("compiles");
    let outcome = function
        .run(&[arguments], 3, &Resources::new())
        .expect("runs");
    assert_eq!(outcome.undecided, [1]);
}

#[test]
fn duals_are_the_limit_of_difference_quotients() {
    let inputs = inputs(23, 300);
    for text in FORMULAS {
        for direction in 0..3 {
            let arguments: Vec<Lanes<Dual>> = inputs
                .iter()
                .enumerate()
                .map(|(i, x)| {
                    let slope = if i == direction { 1.0 } else { 0.0 };
                    let dual = x.iter().map(|&x| Dual::new(f64::from(x), slope)).collect();
                    Lanes {
                        columns: vec![Column::Float(dual)],
                    }
                })
                .collect();
            let found = call(&formula(text), "f", &arguments);
            // A step exact in f64, around inputs exact in f32.
            let step = f64::exp2(-20.0);
            let moved = |by: f64| -> Vec<f64> {
                let arguments: Vec<Lanes<f64>> = inputs
                    .iter()
                    .enumerate()
                    .map(|(i, x)| {
                        let by = if i == direction { by } else { 0.0 };
                        let moved = x.iter().map(|&x| f64::from(x) + by).collect();
                        Lanes {
                            columns: vec![Column::Float(moved)],
                        }
                    })
                    .collect();
                call(&formula(text), "f", &arguments)
                    .floats(0)
                    .expect("floats")
                    .to_vec()
            };
            let (above, below) = (moved(step), moved(-step));
            for (lane, dual) in found.floats(0).expect("floats").iter().enumerate() {
                let quotient = (above[lane] - below[lane]) / (2.0 * step);
                let error = (dual.slope - quotient).abs() / (1.0 + quotient.abs());
                assert!(
                    error < 2e-5,
                    "{text} along {direction}: {} is not {quotient}",
                    dual.slope
                );
            }
        }
    }
}

#[test]
fn stochastic_rounding_is_right_on_average_and_repeatable() {
    // A sum whose every step rounds: always down in f32's rounding to nearest.
    let source =
        "fn f(x: f32) -> f32 { var s = 1.0; for (var i = 0; i < 1000; i++) { s += x; } return s; }";
    let program = program(source);
    let x = f32::EPSILON / 4.0;
    let run = || {
        Stochastic::seed(5);
        let lanes = call(&program, "f", &[Lanes::<Stochastic>::scalars(&[x; 64])]);
        lanes.floats(0).expect("floats").to_vec()
    };
    let found = run();
    assert_eq!(found, run());
    let mean = found.iter().map(|s| s.to_f64() - 1.0).sum::<f64>() / 64.0;
    let right = 1000.0 * f64::from(x);
    assert!(
        (mean / right - 1.0).abs() < 0.05,
        "{mean} is not near {right}"
    );
    let nearest = call(&program, "f", &[Lanes::<f32>::scalars(&[x])]);
    assert_eq!(nearest.floats(0), Some(&[1.0][..]));
}
