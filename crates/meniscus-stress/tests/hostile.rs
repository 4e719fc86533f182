//! What a user may write must not overflow, hang or panic: it runs, or says why not.

mod common;

use std::fmt::Write as _;

use common::program;
use meniscus_stress::{Column, Lanes, Resources, Trap};

fn refused(source: &str, name: &str) -> String {
    match program(source).function(name) {
        Err(Trap::Unsupported(unsupported)) => {
            assert!(
                unsupported.site.span.is_some(),
                "{unsupported} has no place"
            );
            unsupported.construct
        }
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("runs"),
    }
}

#[test]
fn calls_that_double_with_every_level_are_refused() {
    let mut source = "fn g0(x: f32) -> f32 { return sqrt(x); }\n".to_owned();
    for i in 1..40 {
        let _ = writeln!(
            source,
            "fn g{i}(x: f32) -> f32 {{ return g{0}(x) + g{0}(x + 1.0); }}",
            i - 1
        );
    }
    assert!(refused(&source, "g39").contains("so large"));
    assert!(program(&source).function("g8").is_ok());
}

#[test]
fn calls_and_blocks_nested_too_deep_are_refused() {
    let mut source = "fn g0(x: f32) -> f32 { return sqrt(x); }\n".to_owned();
    for i in 1..60 {
        let _ = writeln!(source, "fn g{i}(x: f32) -> f32 {{ return g{}(x); }}", i - 1);
    }
    assert!(refused(&source, "g59").contains("calls nested deeper"));
    let chain: String = (0..110)
        .map(|i| format!("if x > {i}.5 {{ y = {i}.0; }} else "))
        .collect();
    let source = format!("fn f(x: f32) -> f32 {{ var y = 0.0; {chain} {{ y = x; }} return y; }}");
    let x = Lanes::<f32>::scalars(&[0.25, 50.75, 200.0]);
    let found = program(&source)
        .function("f")
        .expect("compiles")
        .call(&[x], 3, &Resources::new());
    assert_eq!(found.expect("runs").floats(0), Some(&[0.25, 0.0, 0.0][..]));
}

#[test]
fn huge_values_are_refused() {
    let source = "fn f(i: u32) -> f32 { var a: array<array<f32, 5000>, 5000>; return a[i][i]; }";
    assert!(refused(source, "f").contains("more than 65536 numbers"));
    let source = "var<workgroup> a: array<array<f32, 20000>, 1000>;
        fn f(i: u32) -> f32 { return a[i][i]; }";
    assert!(refused(source, "f").contains("more than 65536 numbers"));
}

#[test]
fn what_is_not_there_is_named() {
    let cases = [
        (
            "fn f(x: f64) -> f64 { return x; }",
            "a floating-point number of 64 bits",
        ),
        (
            "fn f(x: i64) -> i64 { return x; }",
            "a signed integer of 64 bits",
        ),
        (
            "@group(0) @binding(0) var t: texture_multisampled_2d<f32>;
            fn f() -> f32 { return textureLoad(t, vec2i(0), 0).x; }",
            "a multisampled texture",
        ),
        (
            "@group(0) @binding(0) var t: texture_cube<f32>;
            @group(0) @binding(1) var s: sampler;
            fn f() -> f32 { return textureSampleLevel(t, s, vec3f(1), 0).x; }",
            "a cube texture",
        ),
    ];
    for (source, construct) in cases {
        match program(source).function("f") {
            Err(Trap::Unsupported(unsupported)) => assert_eq!(unsupported.construct, construct),
            other => panic!("{other:?}"),
        }
    }
    let pointer = "fn f(p: ptr<function, f32>) -> f32 { return *p; }";
    let error = program(pointer)
        .function("f")
        .expect_err("a pointer")
        .to_string();
    assert!(
        error.contains("with the pointer `p` as an argument"),
        "{error}"
    );
}

#[test]
fn an_override_without_a_value_is_named() {
    let source = "override taps: i32; fn f() -> i32 { return taps; }";
    assert_eq!(refused(source, "f"), "`override taps` without a value");
}

#[test]
fn every_bit_pattern_goes_through_every_function() {
    // Nothing panics, whatever the bits; results are numbers, infinities or NaN.
    let source = "fn f(a: f32, b: f32, n: i32) -> vec4f {
        var v = vec4f(pow(a, b), atan2(a, b), a % b, ldexp(a, n));
        v += vec4f(f32(n / i32(b)), f32(u32(a) % u32(n)), f32(n << u32(n)), f32(i32(a)));
        v += refract(normalize(v), normalize(v.wzyx), b) + smoothstep(v, v.yzwx, v.zwxy);
        v += vec4f(tan(a), exp2(b), acosh(a), atanh(b)) + frexp(v).fract + modf(v).whole;
        return v + vec4f(f32(pack4x8snorm(v)), f32(extractBits(n, u32(n), u32(n))), quantizeToF16(a), v[n]);
    }";
    let program = program(source);
    let function = program.function("f").expect("compiles");
    let mut chance = common::Chance::new(13);
    let mut specials = vec![
        0.0,
        -0.0,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        1e-45,
    ];
    specials.extend((0..1000).map(|_| f32::from_bits(chance.bits())));
    let shifted: Vec<f32> = specials.iter().rev().copied().collect();
    let ints: Vec<i32> = specials.iter().map(|x| x.to_bits() as i32).collect();
    let count = specials.len();
    let arguments = [
        Lanes::<f32>::scalars(&specials),
        Lanes::scalars(&shifted),
        Lanes {
            columns: vec![Column::Sint(ints)],
        },
    ];
    function
        .call(&arguments, count, &Resources::new())
        .expect("f32");
    let other = |run: &dyn Fn() -> Result<(), Trap>| run().expect("runs");
    let resources = Resources::new();
    other(&|| {
        let a: Vec<_> = arguments
            .iter()
            .map(Lanes::converted::<meniscus_stress::Interval>)
            .collect();
        let found = function.call(&a, count, &resources)?;
        let bounds = found.floats(0).expect("floats");
        assert!(
            bounds.iter().all(|b| b.low <= b.high),
            "an interval out of order"
        );
        Ok(())
    });
    other(&|| {
        let a: Vec<_> = arguments
            .iter()
            .map(Lanes::converted::<meniscus_stress::DoubleDouble>)
            .collect();
        function.call(&a, count, &resources).map(drop)
    });
    other(&|| {
        let a: Vec<_> = arguments
            .iter()
            .map(Lanes::converted::<meniscus_stress::Dual>)
            .collect();
        function.call(&a, count, &resources).map(drop)
    });
    other(&|| {
        let a: Vec<_> = arguments
            .iter()
            .map(Lanes::converted::<meniscus_stress::Stochastic>)
            .collect();
        function.call(&a, count, &resources).map(drop)
    });
    for lane in 0..count {
        function
            .trace(&arguments, lane, &resources, 16.0)
            .expect("traces");
    }
    assert!(
        function.trace(&arguments, count, &resources, 16.0).is_err(),
        "there is no such lane"
    );
}
