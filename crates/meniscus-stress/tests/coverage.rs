//! What of naga's IR runs, and what is refused by name and place: the README's table of constructs
//! holds, and every built-in function that WGSL has gives what mathematics says.

mod common;

use std::collections::BTreeSet;

use common::{call, program};
use meniscus_stress::{Column, Lanes, Trap};
use naga::MathFunction;

const X: f64 = 0.6_f32 as f64;
const Y: f64 = 0.25;

/// WGSL that uses a built-in function on x = 0.6, y = 0.25, n = −20 and u = 0x00F0FF03, and what it
/// gives; none where WGSL has no such function. Of no function is anything left out here.
fn sample(fun: MathFunction) -> Option<(&'static str, f64)> {
    use MathFunction as M;
    let half = f64::from(half::f16::from_f64(X).to_f32());
    let refracted = X * Y;
    Some(match fun {
        M::Abs => ("abs(-x)", X),
        M::Min => ("min(x, y)", Y),
        M::Max => ("max(x, y)", X),
        M::Clamp => ("clamp(x, 0.0, y)", Y),
        M::Saturate => ("saturate(x + 4.0 * y)", 1.0),
        M::Cos => ("cos(x)", X.cos()),
        M::Cosh => ("cosh(x)", X.cosh()),
        M::Sin => ("sin(x)", X.sin()),
        M::Sinh => ("sinh(x)", X.sinh()),
        M::Tan => ("tan(x)", X.tan()),
        M::Tanh => ("tanh(x)", X.tanh()),
        M::Acos => ("acos(x)", X.acos()),
        M::Asin => ("asin(x)", X.asin()),
        M::Atan => ("atan(x)", X.atan()),
        M::Atan2 => ("atan2(x, -y)", X.atan2(-Y)),
        M::Asinh => ("asinh(x)", X.asinh()),
        M::Acosh => ("acosh(x / y)", (X / Y).acosh()),
        M::Atanh => ("atanh(x)", X.atanh()),
        M::Radians => ("radians(x)", X.to_radians()),
        M::Degrees => ("degrees(x)", X.to_degrees()),
        M::Ceil => ("ceil(x)", 1.0),
        M::Floor => ("floor(-x)", -1.0),
        M::Round => ("round(x)", 1.0),
        M::Fract => ("fract(-y)", 0.75),
        M::Trunc => ("trunc(x / -y)", -2.0),
        M::Modf => ("modf(-8.0 * y - y).fract + modf(x / y).whole", 2.0 - Y),
        M::Frexp => ("frexp(y).fract + f32(frexp(y).exp)", 0.5 - 1.0),
        M::Ldexp => ("ldexp(y, n)", Y * f64::exp2(-20.0)),
        M::Exp => ("exp(x)", X.exp()),
        M::Exp2 => ("exp2(x)", X.exp2()),
        M::Log => ("log(x)", X.ln()),
        M::Log2 => ("log2(x)", X.log2()),
        M::Pow => ("pow(x, y)", X.powf(Y)),
        M::Dot => ("dot(vec2f(x, y), vec2f(y, x))", 2.0 * X * Y),
        // Bytes from the lowest: 3, −1, −16, 0 or 3, 255, 240, 0 by 4, 3, 2, 1.
        M::Dot4I8Packed => ("f32(dot4I8Packed(u, 0x01020304u))", -23.0),
        M::Dot4U8Packed => ("f32(dot4U8Packed(u, 0x01020304u))", 1257.0),
        M::Cross => ("cross(vec3f(x, y, 0.0), vec3f(0.0, x, y)).z", X * X),
        M::Distance => ("distance(vec2f(x, y), vec2f(y, x))", (X - Y).hypot(X - Y)),
        M::Length => ("length(vec2f(x, y))", X.hypot(Y)),
        M::Normalize => ("normalize(vec2f(x, y)).y", Y / X.hypot(Y)),
        M::FaceForward => ("faceForward(vec2f(x, y), vec2f(x, y), vec2f(x, y)).x", -X),
        M::Reflect => ("reflect(vec2f(x, y), vec2f(0.0, 1.0)).y", -Y),
        M::Refract => ("refract(vec2f(x, -0.8), vec2f(0.0, 1.0), y).x", refracted),
        M::Sign => ("sign(-x)", -1.0),
        M::Fma => ("fma(x, y, y)", X * Y + Y),
        M::Mix => ("mix(x, y, 0.25)", 0.75 * X + 0.25 * Y),
        M::Step => ("step(y, x)", 1.0),
        M::SmoothStep => ("smoothstep(0.0, 1.0, x)", X * X * (3.0 - 2.0 * X)),
        M::Sqrt => ("sqrt(y)", 0.5),
        M::InverseSqrt => ("inverseSqrt(y)", 2.0),
        M::Transpose => ("transpose(mat2x2f(x, y, 0.0, 1.0))[1].x", Y),
        M::Determinant => ("determinant(mat2x2f(x, y, y, x))", X * X - Y * Y),
        M::QuantizeToF16 => ("quantizeToF16(x)", half),
        M::CountTrailingZeros => ("f32(countTrailingZeros(u & 0xF00000u))", 20.0),
        M::CountLeadingZeros => ("f32(countLeadingZeros(u))", 8.0),
        M::CountOneBits => ("f32(countOneBits(u))", 14.0),
        M::ReverseBits => ("f32(reverseBits(u) >> 24u)", 192.0),
        M::ExtractBits => (
            "f32(extractBits(n, 2u, 30u) + extractBits(n, 0u, 0u))",
            -5.0,
        ),
        M::InsertBits => ("f32(insertBits(u, 5u, 0u, 4u) & 0xFFu)", 5.0),
        M::FirstTrailingBit => ("f32(firstTrailingBit(u << 3u))", 3.0),
        M::FirstLeadingBit => ("f32(firstLeadingBit(u) + u32(firstLeadingBit(n)))", 27.0),
        M::Pack4x8snorm | M::Unpack4x8snorm => (
            "unpack4x8snorm(pack4x8snorm(vec4f(x, y, -x, 1.0))).z",
            -76.0 / 127.0,
        ),
        M::Pack4x8unorm | M::Unpack4x8unorm => (
            "unpack4x8unorm(pack4x8unorm(vec4f(x, y, -x, 1.0))).y",
            64.0 / 255.0,
        ),
        M::Pack2x16snorm | M::Unpack2x16snorm => (
            "unpack2x16snorm(pack2x16snorm(vec2f(x, y))).x",
            19660.0 / 32767.0,
        ),
        M::Pack2x16unorm | M::Unpack2x16unorm => (
            "unpack2x16unorm(pack2x16unorm(vec2f(x, y))).x",
            39321.0 / 65535.0,
        ),
        M::Pack2x16float | M::Unpack2x16float => {
            ("unpack2x16float(pack2x16float(vec2f(y, x))).y", half)
        }
        M::Pack4xI8 | M::Unpack4xI8 => ("f32(unpack4xI8(pack4xI8(vec4i(1, n, 2, 3))).y)", -20.0),
        M::Pack4xU8 | M::Unpack4xU8 => ("f32(unpack4xU8(pack4xU8(vec4u(1u, u, 2u, 3u))).y)", 3.0),
        M::Pack4xI8Clamp => (
            "f32(unpack4xI8(pack4xI8Clamp(vec4i(1, 100 * n, 2, 3))).y)",
            -128.0,
        ),
        M::Pack4xU8Clamp => (
            "f32(unpack4xU8(pack4xU8Clamp(vec4u(1u, u, 2u, 3u))).y)",
            255.0,
        ),
        M::Outer | M::Inverse => return None,
    })
}

/// All of them.
#[rustfmt::skip]
const FUNCTIONS: &[MathFunction] = {
    use MathFunction as M;
    &[
        M::Abs, M::Min, M::Max, M::Clamp, M::Saturate, M::Cos, M::Cosh, M::Sin, M::Sinh, M::Tan, M::Tanh,
        M::Acos, M::Asin, M::Atan, M::Atan2, M::Asinh, M::Acosh, M::Atanh, M::Radians, M::Degrees,
        M::Ceil, M::Floor, M::Round, M::Fract, M::Trunc, M::Modf, M::Frexp, M::Ldexp, M::Exp, M::Exp2,
        M::Log, M::Log2, M::Pow, M::Dot, M::Dot4I8Packed, M::Dot4U8Packed, M::Outer, M::Cross,
        M::Distance, M::Length, M::Normalize, M::FaceForward, M::Reflect, M::Refract, M::Sign, M::Fma,
        M::Mix, M::Step, M::SmoothStep, M::Sqrt, M::InverseSqrt, M::Inverse, M::Transpose,
        M::Determinant, M::QuantizeToF16, M::CountTrailingZeros, M::CountLeadingZeros, M::CountOneBits,
        M::ReverseBits, M::ExtractBits, M::InsertBits, M::FirstTrailingBit, M::FirstLeadingBit,
        M::Pack4x8snorm, M::Pack4x8unorm, M::Pack2x16snorm, M::Pack2x16unorm, M::Pack2x16float,
        M::Pack4xI8, M::Pack4xU8, M::Pack4xI8Clamp, M::Pack4xU8Clamp, M::Unpack4x8snorm,
        M::Unpack4x8unorm, M::Unpack2x16snorm, M::Unpack2x16unorm, M::Unpack2x16float, M::Unpack4xI8,
        M::Unpack4xU8,
    ]
};

#[test]
fn every_built_in_function_gives_what_mathematics_says() {
    for &fun in FUNCTIONS {
        let Some((wgsl, right)) = sample(fun) else {
            continue;
        };
        let source = format!("fn f(x: f32, y: f32, n: i32, u: u32) -> f32 {{ return {wgsl}; }}");
        let program = program(&source);
        let used = expressions(program.module());
        assert!(used.contains(&format!("Math {fun:?}")), "{wgsl}: {used:?}");
        let arguments = [
            Lanes::<f32>::scalars(&[0.6]),
            Lanes::scalars(&[0.25]),
            one(Column::Sint(vec![-20])),
            one(Column::Uint(vec![0x00F0_FF03])),
        ];
        let found = call(&program, "f", &arguments).columns[0].as_f64(0);
        let close = 4.0 * meniscus_stress::ulp::ulp(right);
        assert!(
            (found - right).abs() <= close,
            "{wgsl}: {found}, not {right}"
        );
    }
}

fn one(column: Column<f32>) -> Lanes<f32> {
    Lanes {
        columns: vec![column],
    }
}

/// The first word of what `Debug` says, which is the variant's name.
fn name(of: &impl std::fmt::Debug) -> String {
    let said = format!("{of:?}");
    let end = said.find(|c: char| !c.is_alphanumeric());
    said[..end.unwrap_or(said.len())].to_owned()
}

fn functions(module: &naga::Module) -> impl Iterator<Item = &naga::Function> {
    let entries = module.entry_points.iter().map(|entry| &entry.function);
    module.functions.iter().map(|(_, f)| f).chain(entries)
}

/// Names of the kinds of expressions in a module; of built-in functions also which.
fn expressions(module: &naga::Module) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (_, expression) in functions(module).flat_map(|f| f.expressions.iter()) {
        found.insert(name(expression));
        if let naga::Expression::Math { fun, .. } = expression {
            found.insert(format!("Math {fun:?}"));
        }
    }
    found
}

fn statements(block: &naga::Block, found: &mut BTreeSet<String>) {
    for statement in block.iter() {
        found.insert(name(statement));
        match statement {
            naga::Statement::Block(block) => statements(block, found),
            naga::Statement::If { accept, reject, .. } => {
                statements(accept, found);
                statements(reject, found);
            }
            naga::Statement::Switch { cases, .. } => {
                for case in cases {
                    statements(&case.body, found);
                }
            }
            naga::Statement::Loop {
                body, continuing, ..
            } => {
                statements(body, found);
                statements(continuing, found);
            }
            _ => {}
        }
    }
}

/// Rows of the README's table of constructs: of what, what becomes of it, names.
fn told() -> Vec<(String, String, BTreeSet<String>)> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let readme = std::fs::read_to_string(path).expect("the README");
    let (_, part) = readme
        .split_once("\n## Constructs\n")
        .expect("a part of that title");
    let part = part.split("\n## ").next().unwrap_or(part);
    let row = |line: &str| {
        let mut cells = line.strip_prefix('|')?.split('|').map(str::trim);
        let (of, fate, names) = (cells.next()?, cells.next()?, cells.next()?);
        let names = names.split_whitespace().map(str::to_owned).collect();
        Some((of.to_owned(), fate.to_owned(), names))
    };
    part.lines().filter_map(row).collect()
}

fn names(of: &str, fate: &str) -> BTreeSet<String> {
    let rows = told().into_iter();
    let mut rows = rows.filter(|(o, f, _)| o == of && f == fate);
    rows.next().map(|(_, _, names)| names).unwrap_or_default()
}

/// What runs, in two entry points.
const ALL: &str = "
@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var mixing: sampler;
@group(0) @binding(2) var<storage, read_write> list: array<atomic<u32>>;
@group(0) @binding(3) var kept: texture_storage_2d<rgba32float, write>;
var<workgroup> shared_number: u32;
override factor: f32 = 2.0;
const LIMITS: vec2f = vec2f(0.25, 4.0);

fn helped(x: f32, i: u32) -> vec4f {
    var table = array<f32, 3>(x, -x, factor);
    var sum = vec4f();
    switch i32(i) {
        case 0, 1: { sum.x = table[i]; }
        default: { sum = vec4f(x).wzyx; }
    }
    for (var k = 0u; k < 4u; k++) {
        if k == 2u { continue; }
        if k == 3u { break; }
        { sum[k] += clamp(x, LIMITS[k], 4.0); }
    }
    return select(sum, -sum, any(sum < vec4f(0.5)));
}

@fragment
fn shade(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let seen = textureSample(picture, mixing, at.xy) + textureLoad(picture, vec2u(at.xy), 0);
    let size = textureDimensions(picture);
    let slope = dpdx(at.x);
    if slope > f32(size.x) { discard; }
    return seen * slope + helped(at.x, size.y);
}

@compute @workgroup_size(4)
fn count(@builtin(local_invocation_index) index: u32) {
    let before = atomicAdd(&list[index % arrayLength(&list)], 1u);
    if index == 0u { shared_number = before; }
    workgroupBarrier();
    let all = workgroupUniformLoad(&shared_number);
    textureStore(kept, vec2u(index, 0u), helped(1.5, all));
}
";

#[test]
fn what_the_readme_says_runs_runs() {
    let program = program(ALL);
    for entry in ["shade", "count"] {
        program.entry(entry).unwrap_or_else(|e| panic!("{e}"));
    }
    let used: BTreeSet<String> = expressions(program.module())
        .into_iter()
        .filter(|name| !name.starts_with("Math "))
        .collect();
    assert_eq!(used, names("expressions", "run"));
    let mut used = BTreeSet::new();
    for function in functions(program.module()) {
        statements(&function.body, &mut used);
    }
    assert_eq!(used, names("statements", "run"));
    let run: BTreeSet<String> = FUNCTIONS
        .iter()
        .filter(|fun| sample(**fun).is_some())
        .map(|fun| format!("{fun:?}"))
        .collect();
    assert_eq!(run, names("built-in functions", "run"));
}

#[test]
fn least_and_most_pass_over_what_is_no_number() {
    let source = "fn f(a: f32, b: f32) -> vec3f { return vec3f(min(a, b), max(a, b), clamp(a, -1.0, 1.0)); }";
    let (nan, one) = (f32::NAN, 1.0_f32);
    let arguments = [Lanes::scalars(&[nan, one]), Lanes::scalars(&[one, nan])];
    let found = call::<f32>(&program(source), "f", &arguments);
    for column in &found.columns[..2] {
        assert_eq!(column, &Column::Float(vec![1.0, 1.0]));
    }
    assert!(
        found
            .floats(2)
            .expect("floats")
            .iter()
            .all(|x| x.abs() <= 1.0)
    );
}

/// What is refused: a word of the message, the line that it names, WGSL with an entry point `main` or
/// a function `f`.
const REFUSED: &[(&str, &str, &str)] = &[
    (
        "64 bits",
        "1.0lf",
        "fn f(x: f32) -> f32 {\n    let y = f64(x) + 1.0lf;\n    return f32(y);\n}",
    ),
    (
        "64 bits",
        "1li",
        "fn f(x: f32) -> f32 {\n    let y = i64(x) + 1li;\n    return f32(y);\n}",
    ),
    (
        "16 bits",
        "1.0h",
        "enable f16;\nfn f(x: f32) -> f32 {\n    let y = f16(x) + 1.0h;\n    return f32(y);\n}",
    ),
    (
        "cube texture",
        "textureSampleLevel",
        "@group(0) @binding(0) var sky: texture_cube<f32>;\n@group(0) @binding(1) var mixing: sampler;\n\
         fn f(at: vec3f) -> vec4f {\n    return textureSampleLevel(sky, mixing, at, 0.0);\n}",
    ),
    (
        "multisampled",
        "textureLoad",
        "@group(0) @binding(0) var many: texture_multisampled_2d<f32>;\n\
         fn f(at: vec2u) -> vec4f {\n    return textureLoad(many, at, 1);\n}",
    ),
    (
        "atomic operation on a texture",
        "textureAtomicAdd",
        "@group(0) @binding(0) var counts: texture_storage_2d<r32uint, atomic>;\n\
         fn f(at: vec2u) {\n    textureAtomicAdd(counts, at, 1u);\n}",
    ),
    (
        "subgroup",
        "subgroupAdd",
        "fn f(x: f32) -> f32 {\n    return subgroupAdd(x);\n}",
    ),
    (
        "subgroup",
        "subgroupBallot",
        "fn f(x: f32) -> vec4u {\n    return subgroupBallot(x > 0.0);\n}",
    ),
    (
        "subgroup",
        "subgroupBroadcast",
        "fn f(x: f32) -> f32 {\n    return subgroupBroadcast(x, 1u);\n}",
    ),
];

#[test]
fn what_does_not_run_is_refused_by_name_and_place() {
    let (expressions_told, statements_told) = (
        names("expressions", "refused"),
        names("statements", "refused"),
    );
    assert!(!expressions_told.is_empty() && !statements_told.is_empty());
    let both: BTreeSet<&String> = expressions_told.iter().chain(&statements_told).collect();
    let mut seen = BTreeSet::new();
    for (word, line, source) in REFUSED {
        let program = program(source);
        let mut used = expressions(program.module());
        for function in functions(program.module()) {
            statements(&function.body, &mut used);
        }
        seen.extend(used);
        match program.function("f") {
            Err(Trap::Unsupported(unsupported)) => {
                let said = unsupported.to_string();
                assert!(said.contains(word), "{said}: {source}");
                let span = unsupported.site.span.clone().expect("a place");
                let number = source[..span.start].lines().count().max(1) - 1;
                let from = source[..span.start].rfind('\n').map_or(0, |at| at + 1);
                let at = source[from..].lines().next().unwrap_or_default();
                assert!(at.contains(line), "line {number}, `{at}`: {source}");
            }
            Err(other) => panic!("{other}: {source}"),
            Ok(_) => panic!("runs: {source}"),
        }
    }
    let tried = both.iter().filter(|name| seen.contains(**name)).count();
    assert!(tried >= 5, "{tried} of {both:?}");
    let runs = names("expressions", "run");
    assert!(runs.is_disjoint(&expressions_told), "either runs or not");
}
