//! The right line is blamed.

mod common;

use common::program;
use meniscus_stress::{Lanes, Resources, Trace};

fn traced(source: &str, name: &str, arguments: &[Lanes<f32>]) -> Trace {
    let function = program(source)
        .function(name)
        .unwrap_or_else(|e| panic!("{e}"));
    function
        .trace(arguments, 0, &Resources::new(), 16.0)
        .unwrap_or_else(|e| panic!("{e}"))
}

/// The line that is blamed first.
fn blamed<'s>(source: &'s str, trace: &Trace) -> &'s str {
    let first = trace.first.as_ref().expect("something to blame");
    let start = first.site.span.clone().expect("a place").start;
    let line = source[..start].matches('\n').count();
    source.lines().nth(line).expect("a line").trim()
}

fn scalars(values: &[f32]) -> Vec<Lanes<f32>> {
    values.iter().map(|&v| Lanes::scalars(&[v])).collect()
}

#[test]
fn cancellation_is_blamed_on_the_difference() {
    let source = "
fn crossing(a: f32, b: f32, d: f32) -> f32 {
    let share = a / (a + b);
    let x = d * share;
    let rest = d - x;
    return rest * 2.0;
}";
    let trace = traced(source, "crossing", &scalars(&[1.0, 1e-6, 3.3]));
    assert_eq!(blamed(source, &trace), "let rest = d - x;");
    assert_eq!(trace.first.expect("first").site.function, "crossing");
}

#[test]
fn the_naive_quadratic_is_blamed_on_its_numerator() {
    let source = "
fn root(a: f32, b: f32, c: f32) -> f32 {
    let discriminant = b * b - 4.0 * a * c;
    return (-b + sqrt(discriminant)) / (2.0 * a);
}
fn outer(b: f32) -> f32 { return root(1.0, b, 1.0) + 1.0e-9; }";
    let trace = traced(source, "outer", &scalars(&[3000.1]));
    assert_eq!(
        blamed(source, &trace),
        "return (-b + sqrt(discriminant)) / (2.0 * a);"
    );
    assert_eq!(trace.first.expect("first").site.function, "root");
}

#[test]
fn an_unguarded_normalize_is_blamed() {
    let source = "
fn direction(v: vec3f) -> vec3f {
    let twice = v * 2.0;
    return normalize(twice);
}";
    let trace = traced(
        source,
        "direction",
        &[Lanes::vectors(&[[1e-30, 2e-30, 1e-30]])],
    );
    assert_eq!(blamed(source, &trace), "return normalize(twice);");
    let value = trace.value.floats(0).expect("floats")[0];
    assert!(!value.single.is_finite() && value.double.is_finite());
}

#[test]
fn acos_of_a_dot_product_is_blamed() {
    let source = "
fn angle(a: vec3f, b: vec3f) -> f32 {
    let cosine = dot(a, b);
    return acos(cosine);
}";
    let (sin, cos) = (0.0007_f32, (1.0 - 0.0007_f32 * 0.0007).sqrt());
    let arguments = [
        Lanes::vectors(&[[0.6, 0.8, 0.0]]),
        Lanes::vectors(&[[0.6 * cos, 0.8 * cos, sin]]),
    ];
    let trace = traced(source, "angle", &arguments);
    assert_eq!(blamed(source, &trace), "return acos(cosine);");
}

#[test]
fn sound_arithmetic_blames_nobody() {
    let source = "
fn fresnel(cosine: f32, n: f32) -> f32 {
    let g = sqrt(n * n - 1.0 + cosine * cosine);
    let s = (g - cosine) / (g + cosine);
    let p = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0);
    return 0.5 * s * s * (1.0 + p * p);
}";
    for cosine in [0.01, 0.3, 0.9, 1.0] {
        let trace = traced(source, "fresnel", &scalars(&[cosine, 1.333]));
        assert_eq!(trace.first, None, "at {cosine}");
        assert!(trace.branches.is_empty());
    }
}

#[test]
fn branches_that_go_different_ways_are_told() {
    let source = "
fn f(x: f32) -> f32 {
    let y = x * 10.0;
    if y == 1.0 { return 5.0; }
    return y;
}";
    // 0.1 is a little more than a tenth in f32: the product rounds to 1 in f32 alone.
    let trace = traced(source, "f", &scalars(&[0.1]));
    let span = trace.branches[0].span.clone().expect("a place");
    assert_eq!(&source[span], "y == 1.0");
}
