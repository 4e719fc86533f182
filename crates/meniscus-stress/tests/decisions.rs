//! Decisions are excused where rounding of what is compared explains them, and not where digits were lost.

mod common;

use common::program;
use meniscus_stress::{Domain, Effort, Range, Resources, Subject};

/// The largest error / (1 + condition) that a hunt finds.
fn worst(source: &str) -> f64 {
    let function = program(source).function("f").expect("compiles");
    let ranges = [Range::Log(1e-3, 1e3), Range::Log(1e-3, 1e3)];
    let domain = Domain::new(&function, &ranges).expect("a domain");
    let resources = Resources::new();
    let subject = Subject {
        function: &function,
        domain: &domain,
        resources: &resources,
        nearby: &[],
        elsewhere: None,
        truth: None,
    };
    let effort = Effort {
        random: 4000,
        special: 500,
        climb: 4000,
        ..Effort::default()
    };
    subject.hunt(&effort).expect("runs").scaled.max
}

#[test]
fn a_jump_where_a_product_passes_a_bound_is_excused() {
    let source = "fn f(a: f32, b: f32) -> f32 {
        return select(1.0, 2.0, a * b < 0.7);
    }";
    assert!(worst(source) <= 4.01);
}

#[test]
fn a_whole_number_of_steps_is_excused() {
    let source = "fn f(a: f32, b: f32) -> f32 {
        return floor(a / b);
    }";
    assert!(worst(source) <= 4.01);
}

#[test]
fn a_jump_that_lost_digits_decide_is_not_excused() {
    let source = "fn f(a: f32, b: f32) -> f32 {
        let rest = (a + b) - a;
        return select(1.0, 2.0, rest < 0.99 * b);
    }";
    assert!(worst(source) > 1e3);
}
