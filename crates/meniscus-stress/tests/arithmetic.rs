//! `f32` in WGSL is `f32` in Rust, bit for bit; integers follow WGSL.

mod common;

use common::{Chance, call, program};
use meniscus_stress::{Column, Lanes, Settings};

fn same_bits(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// Compares a function of three numbers with Rust on random finite bits.
fn agrees(wgsl: &str, native: impl Fn(f32, f32, f32) -> f32) {
    let source = format!("fn f(a: f32, b: f32, c: f32) -> f32 {{ return {wgsl}; }}");
    let mut chance = Chance::new(7);
    let mut pick = |_| {
        // Half of them near each other in size, so that sums are not all trivial.
        if chance.bits().is_multiple_of(2) {
            chance.finite()
        } else {
            chance.within(-9.0, 9.0)
        }
    };
    let columns: [Vec<f32>; 3] = std::array::from_fn(|_| (0..1000).map(&mut pick).collect());
    let arguments = columns.each_ref().map(|c| Lanes::<f32>::scalars(c));
    let found = call(&program(&source), "f", &arguments);
    for (i, &found) in found.floats(0).expect("floats").iter().enumerate() {
        let [a, b, c] = [columns[0][i], columns[1][i], columns[2][i]];
        let right = native(a, b, c);
        assert!(
            same_bits(found, right),
            "{wgsl} of {a:e}, {b:e}, {c:e}: {found:e}, not {right:e}"
        );
    }
}

#[test]
fn operators_are_those_of_rust() {
    agrees("a + b * c", |a, b, c| a + b * c);
    agrees("(a - b) / c", |a, b, c| (a - b) / c);
    agrees("-a", |a, _, _| -a);
    agrees("a % b", |a, b, _| a - b * (a / b).trunc());
    agrees("select(a, b, a < c)", |a, b, c| if a < c { b } else { a });
    agrees("f32(a >= b) + f32(a != c)", |a, b, c| {
        f32::from(u8::from(a >= b)) + f32::from(u8::from(a != c))
    });
}

#[test]
fn built_in_functions_are_those_of_rust() {
    agrees("sqrt(abs(a))", |a, _, _| a.abs().sqrt());
    agrees("inverseSqrt(abs(a))", |a, _, _| 1.0 / a.abs().sqrt());
    agrees("floor(a) + ceil(b) + trunc(c)", |a, b, c| {
        a.floor() + b.ceil() + c.trunc()
    });
    agrees("round(a)", |a, _, _| a.round_ties_even());
    agrees("fract(a)", |a, _, _| a - a.floor());
    agrees("min(a, b) + max(b, c)", |a, b, c| a.min(b) + b.max(c));
    agrees("clamp(a, -1.0, 2.0)", |a, _, _| a.clamp(-1.0, 2.0));
    agrees("saturate(a)", |a, _, _| a.clamp(0.0, 1.0));
    agrees("fma(a, b, c)", f32::mul_add);
    agrees("mix(a, b, c)", |a, b, c| a * (1.0 - c) + b * c);
    agrees("step(a, b)", |a, b, _| if a <= b { 1.0 } else { 0.0 });
    agrees("sign(a)", |a, _, _| {
        if a > 0.0 {
            1.0
        } else if a < 0.0 {
            -1.0
        } else {
            a
        }
    });
    agrees("exp(a) + log(abs(b))", |a, b, _| {
        f64::from(a).exp() as f32 + f64::from(b.abs()).ln() as f32
    });
    agrees("smoothstep(1.0, 3.0, a)", |a, _, _| {
        let t = ((a - 1.0) / (3.0 - 1.0)).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    });
    agrees("ldexp(frexp(a).fract, frexp(a).exp)", |a, _, _| a);
    agrees("modf(a).fract + modf(a).whole", |a, _, _| {
        a - a.trunc() + a.trunc()
    });
    agrees(
        "unpack2x16float(pack2x16float(vec2f(a, b))).y",
        |_, b, _| half::f16::from_f32(b).to_f32(),
    );
    agrees("quantizeToF16(a)", |a, _, _| {
        half::f16::from_f32(a).to_f32()
    });
    agrees("bitcast<f32>(bitcast<u32>(a) & 0xfffff000u)", |a, _, _| {
        f32::from_bits(a.to_bits() & 0xffff_f000)
    });
}

#[test]
fn vectors_and_matrices_are_their_formulas() {
    agrees("dot(vec3f(a, b, c), vec3f(b, c, a))", |a, b, c| {
        a * b + b * c + c * a
    });
    agrees("length(vec2f(a, b))", |a, b, _| (a * a + b * b).sqrt());
    agrees("cross(vec3f(a, b, c), vec3f(c, a, b)).y", |a, b, c| {
        c * c - a * b
    });
    agrees("normalize(vec3f(a, b, c)).z", |a, b, c| {
        c / (a * a + b * b + c * c).sqrt()
    });
    agrees("reflect(vec2f(a, b), vec2f(b, c)).x", |a, b, c| {
        a - 2.0 * (b * a + c * b) * b
    });
    agrees("(mat2x2f(a, b, c, a) * vec2f(b, c)).y", |a, b, c| {
        b * b + a * c
    });
    agrees("(vec2f(b, c) * mat2x2f(a, b, c, a)).y", |a, b, c| {
        b * c + c * a
    });
    agrees(
        "(mat2x2f(a, b, c, a) * mat2x2f(c, a, b, c))[1].x",
        |a, b, c| a * b + c * c,
    );
    agrees("transpose(mat2x3f(a, b, c, c, a, b))[2].x", |_, _, c| c);
    agrees("determinant(mat2x2f(a, b, c, a))", |a, b, c| a * a - b * c);
    agrees("vec4f(a, b, c, a).zyx.y", |_, b, _| b);
    agrees(
        "faceForward(vec2f(a, b), vec2f(b, c), vec2f(c, a)).x",
        |a, b, c| {
            if b * c + c * a < 0.0 { a } else { -a }
        },
    );
}

#[test]
fn determinants_of_larger_matrices_multiply() {
    let source = "fn f(s: vec4f, t: vec4f) -> vec2f {
        let a = mat4x4f(s, t, s.wzyx + vec4f(1, 2, 0, 5), vec4f(1, 0, 3, 2));
        let b = mat4x4f(t.yxwz, s, vec4f(2, 1, 1, 0), t + vec4f(0, 1, 0, 3));
        return vec2f(determinant(a * b), determinant(a) * determinant(b));
    }";
    let mut chance = Chance::new(3);
    let mut vectors = || -> Vec<[f32; 4]> {
        (0..100)
            .map(|_| std::array::from_fn(|_| chance.within(-2.0, 2.0)))
            .collect()
    };
    let arguments = [
        Lanes::<f64>::vectors(&vectors()),
        Lanes::vectors(&vectors()),
    ];
    let both = call(&program(source), "f", &arguments);
    let (product, factors) = (
        both.floats(0).expect("floats"),
        both.floats(1).expect("floats"),
    );
    for (a, b) in product.iter().zip(factors) {
        assert!((a - b).abs() <= 1e-10 * (1.0 + b.abs()), "{a} is not {b}");
    }
}

#[test]
fn refraction_follows_snell_and_reflects_totally() {
    let source = "fn f(i: vec2f, ratio: f32) -> vec2f { return refract(i, vec2f(0, 1), ratio); }";
    let angles = [0.1_f32, 0.5, 1.0, 1.4];
    for ratio in [0.75_f32, 1.333] {
        let incident: Vec<_> = angles.iter().map(|a| [a.sin(), -a.cos()]).collect();
        let arguments = [
            Lanes::<f64>::vectors(&incident),
            Lanes::scalars(&[ratio; 4]),
        ];
        let out = call(&program(source), "f", &arguments);
        for (i, angle) in angles.iter().enumerate() {
            let (x, y) = (out.floats(0).expect("x")[i], out.floats(1).expect("y")[i]);
            let sin = f64::from(ratio) * f64::from(incident[i][0]);
            if sin > 1.0 {
                assert_eq!((x, y), (0.0, 0.0), "at {angle} with ratio {ratio}");
            } else {
                assert!((x - sin).abs() < 1e-7, "{x} is not {sin}");
                assert!((y + (1.0 - sin * sin).sqrt()).abs() < 1e-6);
            }
        }
    }
}

fn ints(source: &str, a: &[i32], b: &[i32]) -> Vec<i32> {
    let source = format!("fn f(a: i32, b: i32) -> i32 {{ return {source}; }}");
    let column = |v: &[i32]| Lanes::<f32> {
        columns: vec![Column::Sint(v.to_vec())],
    };
    match call(&program(&source), "f", &[column(a), column(b)])
        .columns
        .remove(0)
    {
        Column::Sint(found) => found,
        other => panic!("{other:?}"),
    }
}

#[test]
fn integers_follow_wgsl_where_rust_would_panic() {
    let (low, high) = (i32::MIN, i32::MAX);
    assert_eq!(
        ints("a / b", &[7, 7, low, -7], &[0, 2, -1, 2]),
        [7, 3, low, -3]
    );
    assert_eq!(
        ints("a % b", &[7, 7, low, -7], &[0, 4, -1, 2]),
        [0, 3, 0, -1]
    );
    assert_eq!(ints("a + b", &[high], &[1]), [low]);
    assert_eq!(ints("a << u32(b)", &[1, 1, 1], &[3, 32, 33]), [8, 1, 2]);
    assert_eq!(ints("a >> u32(b)", &[-8], &[1]), [-4]);
    assert_eq!(
        ints("abs(a) + sign(b)", &[low, -3], &[-9, 4]),
        [low.wrapping_sub(1), 4]
    );
    assert_eq!(
        ints("countOneBits(a) + firstLeadingBit(b)", &[7, 0], &[8, -1]),
        [6, -1]
    );
    assert_eq!(ints("extractBits(a, 4u, 4u)", &[0x7a5], &[0]), [-6]);
    assert_eq!(
        ints("insertBits(a, b, 4u, 8u)", &[0x0f0f], &[0xff]),
        [0x0fff]
    );
    assert_eq!(ints("clamp(a, -2, b)", &[-5, 5], &[3, 3]), [-2, 3]);
    assert_eq!(ints("i32(u32(a) / 2u)", &[-2], &[0]), [high]);
}

#[test]
fn conversions_to_integers_saturate() {
    let source = "fn f(x: f32) -> vec2i { return vec2i(i32(x), i32(u32(x))); }";
    let x = [-1e20_f32, -1.9, -0.0, 2.9, 3e9, 1e20, f32::NAN];
    let found = call(&program(source), "f", &[Lanes::<f32>::scalars(&x)]);
    // Saturation is to the largest f32 that is an integer of that kind.
    let (most, wide) = (2_147_483_520, 4_294_967_040_u32 as i32);
    let signed = vec![i32::MIN, -1, 0, 2, most, most, 0];
    let unsigned = vec![0, 0, 0, 2, 3_000_000_000_u32 as i32, wide, 0];
    assert_eq!(
        found.columns,
        [Column::Sint(signed), Column::Sint(unsigned)]
    );
}

#[test]
fn packing_and_unpacking_are_inverse_up_to_a_step() {
    let source = "fn f(v: vec4f) -> vec4f {
        let s = unpack4x8snorm(pack4x8snorm(v));
        let u = unpack2x16unorm(pack2x16unorm(v.zw));
        return vec4f(s.xy, u);
    }";
    let mut chance = Chance::new(5);
    let v: Vec<[f32; 4]> = (0..200)
        .map(|_| std::array::from_fn(|i| chance.within(if i < 2 { -1.0 } else { 0.0 }, 1.0)))
        .collect();
    let back = call(&program(source), "f", &[Lanes::<f32>::vectors(&v)]);
    for (lane, v) in v.iter().enumerate() {
        for (i, half_step) in [0.5 / 127.0, 0.5 / 127.0, 0.5 / 65535.0, 0.5 / 65535.0]
            .iter()
            .enumerate()
        {
            let error = (back.columns[i].as_f64(lane) - f64::from(v[i])).abs();
            assert!(error <= half_step + 1e-7, "component {i}: {error}");
        }
    }
}

#[test]
fn fma_can_be_two_roundings() {
    let source = "fn f(a: f32, b: f32, c: f32) -> f32 { return fma(a, b, c); }";
    let (a, b) = (1.0 + f32::EPSILON, 1.0 - f32::EPSILON);
    let arguments = [a, b, -1.0].map(|x| Lanes::<f32>::scalars(&[x]));
    let settings = Settings {
        fused: false,
        ..Settings::default()
    };
    let separate = call(&common::program_with(source, settings), "f", &arguments);
    let fused = call(&program(source), "f", &arguments);
    assert_eq!(separate.floats(0), Some(&[a * b - 1.0][..]));
    assert_eq!(fused.floats(0), Some(&[a.mul_add(b, -1.0)][..]));
    assert_ne!(separate, fused);
}

#[test]
fn overrides_take_their_value_or_the_one_set() {
    let source = "override n: i32 = 3; override scale: f32 = 0.5; override twice = 2 * n;
        const table = array<f32, 3>(1.0, 2.0, 4.0);
        fn f(i: u32) -> f32 { return scale * f32(twice) + table[i]; }";
    let index = Lanes::<f32> {
        columns: vec![Column::Uint(vec![0, 1, 2, 3])],
    };
    let plain = call(&program(source), "f", std::slice::from_ref(&index));
    assert_eq!(plain.floats(0), Some(&[4.0, 5.0, 7.0, 7.0][..]));
    let numbers = [("n".to_owned(), 10.0), ("scale".to_owned(), 2.0)].into();
    let settings = Settings {
        numbers,
        ..Settings::default()
    };
    let set = call(&common::program_with(source, settings), "f", &[index]);
    assert_eq!(set.floats(0), Some(&[41.0, 42.0, 44.0, 44.0][..]));
}
