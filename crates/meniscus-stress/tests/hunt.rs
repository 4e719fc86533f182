//! The hunt finds what is bad, leaves alone what is good, and says which is which.

mod common;

use common::program;
use meniscus_stress::{
    Case, Domain, Effort, Findings, Function, Range, Relation, Resources, Subject, Truth,
    WORST_KEPT,
};

fn effort(random: usize) -> Effort {
    Effort {
        random,
        special: 2000,
        climb: 6000,
        ..Effort::default()
    }
}

fn hunted(
    source: &str,
    name: &str,
    ranges: &[Range],
    effort: &Effort,
    truth: Option<&Truth<'_>>,
) -> (Function, Findings) {
    let function = program(source).function(name).expect("compiles");
    let domain = Domain::new(&function, ranges).expect("a domain");
    let resources = Resources::new();
    let subject = Subject {
        function: &function,
        domain: &domain,
        resources: &resources,
        nearby: &[],
        elsewhere: None,
        truth,
    };
    let findings = subject.hunt(effort).expect("runs");
    (function, findings)
}

const FRESNEL: &str = "
fn fresnel(cosine: f32, n: f32) -> f32 {
    let g = sqrt(n * n - 1.0 + cosine * cosine);
    let s = (g - cosine) / (g + cosine);
    let p = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0);
    return 0.5 * s * s * (1.0 + p * p);
}";

/// The same by angles and Snell's law.
fn fresnel_truth(x: &[f64]) -> Vec<f64> {
    let (cos_i, n) = (x[0], x[1]);
    let sin_t = (1.0 - cos_i * cos_i).max(0.0).sqrt() / n;
    let cos_t = ((1.0 - sin_t) * (1.0 + sin_t)).sqrt();
    let across = (cos_i - n * cos_t) / (cos_i + n * cos_t);
    let along = (n * cos_i - cos_t) / (n * cos_i + cos_t);
    vec![0.5 * (across * across + along * along)]
}

#[test]
fn a_sound_function_comes_out_clean() {
    let ranges = [Range::Linear(0.001, 1.0), Range::Linear(1.2, 2.5)];
    let truth: &Truth<'_> = &fresnel_truth;
    let (_, found) = hunted(FRESNEL, "fresnel", &ranges, &effort(20_000), Some(truth));
    assert_eq!(
        (found.non_finite, found.untrusted, found.branches),
        (0, 0, 0)
    );
    assert!(found.inputs >= 26_000);
    assert!(
        found.rounding.median < 4.0 && found.scaled.max < 16.0,
        "{found:?}"
    );
    // Two derivations of the same law: no method error beyond f64's own rounding.
    assert!(found.method.expect("a truth").max < 1e-4, "{found:?}");
    assert_eq!(found.enclosed, 1.0);
    assert!(found.proven >= found.rounding.max, "a proven bound bounds");
    assert_eq!(found.worst.len(), WORST_KEPT);
}

#[test]
fn an_unfinished_iteration_is_a_method_error() {
    let source = "fn root(x: f32) -> f32 {
        var y = 0.5 * (1.0 + x);
        for (var i = 0; i < 2; i++) { y = 0.5 * (y + x / y); }
        return y;
    }";
    let truth: &Truth<'_> = &|x: &[f64]| vec![x[0].sqrt()];
    let (_, found) = hunted(
        source,
        "root",
        &[Range::Log(0.1, 10.0)],
        &effort(5000),
        Some(truth),
    );
    assert!(found.rounding.max < 4.0, "{found:?}");
    assert!(found.method.expect("a truth").max > 1e4, "{found:?}");
    assert!(found.total.max > 1e4, "{found:?}");
}

#[test]
fn an_ill_conditioned_problem_is_told_from_a_bad_formula() {
    let wide = [Range::Log(1e-3, 1e3), Range::Log(1e-3, 1e3)];
    // The difference itself is exact; its inputs' errors grow, and that is the problem's nature.
    let difference = "fn f(a: f32, b: f32) -> f32 { return (a * 1.1) - (b * 1.1); }";
    let (_, found) = hunted(difference, "f", &wide, &effort(20_000), None);
    assert!(
        found.rounding.max > 1e3 && found.scaled.max < 4.0,
        "{found:?}"
    );
    // Here the problem is tame and the formula is not.
    let bad = "fn f(a: f32, b: f32) -> f32 { return (a + b) - a; }";
    let (_, found) = hunted(bad, "f", &wide, &effort(20_000), None);
    assert!(
        found.condition.max < 1.5 && found.scaled.max > 1e3,
        "{found:?}"
    );
}

#[test]
fn deliberately_bad_functions_are_caught_on_the_right_line() {
    let bad = [
        (
            "fn f(x: f32, d: f32) -> f32 {\n    let inner = d - (d - x);\n    return inner;\n}",
            vec![Range::Log(1e-4, 1e4), Range::Log(1e-4, 1e4)],
            1,
        ),
        (
            "fn f(b: f32, c: f32) -> f32 {\n    let root = sqrt(b * b + c);\n    return root - b;\n}",
            vec![Range::Log(1e-2, 1e4), Range::Log(1e-2, 1e2)],
            2,
        ),
        (
            "fn f(v: vec3f) -> vec3f {\n    let half = 0.5 * v;\n    return normalize(half);\n}",
            vec![Range::Bits(-1e4, 1e4)],
            2,
        ),
        (
            "fn f(a: vec3f, b: vec3f) -> f32 {\n    let cosine = dot(a, b);\n    return acos(cosine);\n}",
            vec![Range::Unit, Range::Unit],
            2,
        ),
    ];
    for (source, ranges, line) in bad {
        let (function, found) = hunted(source, "f", &ranges, &effort(4000), None);
        assert!(
            found.scaled.max > 64.0 || found.non_finite > 0,
            "not caught: {source}"
        );
        let domain = Domain::new(&function, &ranges).expect("a domain");
        let lanes = domain.lanes(&function, &[found.worst[0].input.clone()]);
        let trace = function
            .trace(&lanes, 0, &Resources::new(), 16.0)
            .expect("runs");
        // What is not finite in f64 either does not part from it.
        let site = trace.first.map(|first| first.site).or(trace.not_finite);
        let start = site
            .and_then(|site| site.span)
            .expect("a place to blame")
            .start;
        assert_eq!(source[..start].matches('\n').count(), line, "{source}");
    }
}

#[test]
fn the_adversary_finds_worse_than_chance() {
    // Bad where 1.1 x cancels against 7: one number in two hundred million.
    let source = "fn f(x: f32) -> f32 { return abs(x * 1.1 - 7.0); }";
    let ranges = [Range::Bits(1e-3, 1e6)];
    let chance = Effort {
        climb: 0,
        special: 0,
        ..effort(12_000)
    };
    let (_, by_chance) = hunted(source, "f", &ranges, &chance, None);
    let half = Effort {
        climb: 8000,
        special: 0,
        ..effort(4_000)
    };
    let (_, by_climbing) = hunted(source, "f", &ranges, &half, None);
    assert!(
        by_climbing.rounding.max > 8.0 * by_chance.rounding.max,
        "{by_climbing:?} {by_chance:?}"
    );
}

#[test]
fn relations_lead_to_where_it_is_critical() {
    let source = "fn f(x: f32, y: f32) -> f32 { return sqrt(max(x * x - y * y, 0.0)); }";
    let function = program(source).function("f").expect("compiles");
    let ranges = || [Range::Linear(1.0, 2.0), Range::Linear(1.0, 2.0)];
    let near = Relation {
        leaf: 1,
        share: 0.5,
        place: Box::new(|x| x[0]),
    };
    let plain = Domain::new(&function, &ranges()).expect("a domain");
    let related = Domain::new(&function, &ranges())
        .and_then(|d| d.with(near))
        .expect("a domain");
    let mut rng = fastrand::Rng::with_seed(3);
    let mut close = |domain: &Domain| {
        let draws = (0..2000).map(|_| domain.numbers(&domain.draw(&mut rng)));
        draws.filter(|x| (x[1] / x[0] - 1.0).abs() < 1e-4).count()
    };
    assert!(close(&plain) < 20);
    assert!(close(&related) > 300);
}

#[test]
fn domains_refuse_what_makes_no_sense() {
    let source =
        "fn f(v: vec2f, n: i32, on: bool, x: f32) -> f32 { return select(x, v.y, on) + f32(n); }";
    let function = program(source).function("f").expect("compiles");
    let domain = |v, n, on, x| Domain::new(&function, &[v, n, on, x]).is_some();
    let (unit, whole, truth) = (Range::Unit, Range::Whole(-3, 3), Range::Whole(0, 1));
    let real = Range::Log(0.1, 1.0);
    assert!(domain(
        unit.clone(),
        whole.clone(),
        truth.clone(),
        real.clone()
    ));
    assert!(!domain(
        unit.clone(),
        whole.clone(),
        whole.clone(),
        real.clone()
    ));
    assert!(!domain(
        unit.clone(),
        real.clone(),
        truth.clone(),
        real.clone()
    ));
    assert!(!domain(
        unit.clone(),
        whole.clone(),
        truth.clone(),
        Range::Log(-1.0, 1.0)
    ));
    assert!(!domain(
        unit.clone(),
        whole.clone(),
        truth.clone(),
        Range::Linear(2.0, 1.0)
    ));
    assert!(!domain(
        unit.clone(),
        whole.clone(),
        truth.clone(),
        Range::Bits(0.0, f32::INFINITY)
    ));
    assert!(!domain(unit.clone(), whole, truth, unit));
    assert!(Domain::new(&function, &[real]).is_none());
}

#[test]
fn everything_drawn_changed_or_special_is_inside() {
    let source = "fn f(v: vec3f, n: u32, x: f32, y: f32) -> f32 { return x + y + v.z + f32(n); }";
    let function = program(source).function("f").expect("compiles");
    let ranges = [
        Range::Unit,
        Range::Whole(2, 9),
        Range::Bits(-1e-3, 5.0),
        Range::Log(-10.0, -0.1),
    ];
    let domain = Domain::new(&function, &ranges).expect("a domain");
    let mut rng = fastrand::Rng::with_seed(1);
    let mut inputs = domain.special(3000, &mut rng);
    assert_eq!(inputs.len(), 3000);
    for _ in 0..3000 {
        let mut input = domain.draw(&mut rng);
        inputs.push(input.clone());
        for _ in 0..5 {
            input = domain.changed(&input, &mut rng);
        }
        inputs.push(input);
    }
    for input in inputs {
        let x = domain.numbers(&input);
        let length = x[..3].iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((length - 1.0).abs() < 2e-7, "{x:?}");
        assert!((2.0..=9.0).contains(&x[3]), "{x:?}");
        assert!((f64::from(-1e-3_f32)..=5.0).contains(&x[4]), "{x:?}");
        assert!((-10.0..=f64::from(-0.1_f32)).contains(&x[5]), "{x:?}");
    }
}

#[test]
fn the_worst_inputs_come_back_from_a_file_as_bad_as_they_were() {
    let ranges = [Range::Linear(0.001, 1.0), Range::Linear(1.2, 2.5)];
    let (function, found) = hunted(FRESNEL, "fresnel", &ranges, &effort(3000), None);
    let text = ron::to_string(&found.worst).expect("writes");
    let cases: Vec<Case> = ron::from_str(&text).expect("reads");
    assert_eq!(cases, found.worst);
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
    let again = subject.again(&cases).expect("runs");
    assert_eq!(again.worst, found.worst);
    assert_eq!(again.scaled.max, found.scaled.max);
}

#[test]
fn equal_seeds_find_equal_things() {
    let ranges = [Range::Linear(0.001, 1.0), Range::Linear(1.2, 2.5)];
    let [one, same] = [7, 7].map(|seed| {
        hunted(
            FRESNEL,
            "fresnel",
            &ranges,
            &Effort {
                seed,
                ..effort(2000)
            },
            None,
        )
        .1
    });
    let other = hunted(
        FRESNEL,
        "fresnel",
        &ranges,
        &Effort {
            seed: 8,
            ..effort(2000)
        },
        None,
    )
    .1;
    assert_eq!(one, same);
    assert_ne!(one.worst, other.worst);
}

#[test]
fn nothing_is_left_out_of_an_exhaustive_run() {
    let source = "fn f(x: f32) -> f32 { if x == 1.5 { return 9.0; } return sqrt(x); }";
    let function = program(source).function("f").expect("compiles");
    let domain = Domain::new(&function, &[Range::Bits(1.0, 2.0)]).expect("a domain");
    let resources = Resources::new();
    let subject = Subject {
        function: &function,
        domain: &domain,
        resources: &resources,
        nearby: &[],
        elsewhere: None,
        truth: None,
    };
    let found = subject.exhaust(1.0, 2.0).expect("runs");
    assert_eq!(found.inputs, (1 << 23) + 1);
    assert!(found.max > 0.49 && found.max <= 0.5, "{found:?}");
    let source = "fn f(x: f32) -> f32 { return x / (x - 1.25); }";
    let function = program(source).function("f").expect("compiles");
    let subject = Subject {
        function: &function,
        ..subject
    };
    assert_eq!(subject.exhaust(1.0, 1.5).expect("runs").non_finite, 1);
}
