//! Evaluations per second on one core, in each number system, beside native code.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use meniscus_stress::{
    DoubleDouble, Dual, Function, Interval, Lanes, Program, Resources, Scalar, Settings, Stochastic,
};

const SOURCE: &str = "
fn snell(f: f32, s: f32, d: f32, n: f32) -> f32 {
    let m = n * n - 1.0;
    var u = max(n * d / (s + f * n), (d - s / sqrt(m)) / f);
    for (var i = 0; i < 16; i++) {
        let r = inverseSqrt(n * n + m * u * u);
        let height = f * u + s * u * r - d;
        u -= height / (f + s * n * n * r * r * r);
    }
    return f * u;
}

fn fresnel(cosine: f32, n: f32) -> f32 {
    let g = sqrt(n * n - 1.0 + cosine * cosine);
    let s = (g - cosine) / (g + cosine);
    let p = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0);
    return 0.5 * s * s * (1.0 + p * p);
}";

fn snell(f: f32, s: f32, d: f32, n: f32) -> f32 {
    let m = n * n - 1.0;
    let mut u = (n * d / (s + f * n)).max((d - s / m.sqrt()) / f);
    for _ in 0..16 {
        let r = 1.0 / (n * n + m * u * u).sqrt();
        let height = f * u + s * u * r - d;
        u -= height / (f + s * n * n * r * r * r);
    }
    f * u
}

fn fresnel(cosine: f32, n: f32) -> f32 {
    let g = (n * n - 1.0 + cosine * cosine).sqrt();
    let s = (g - cosine) / (g + cosine);
    let p = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0);
    0.5 * s * s * (1.0 + p * p)
}

const COUNT: usize = 4096;

fn column(low: f32, high: f32) -> Vec<f32> {
    (0..COUNT)
        .map(|i| low + (high - low) * (i as f32 * 0.618_034).fract())
        .collect()
}

fn evaluate<S: Scalar>(criterion: &mut Criterion, function: &Function, inputs: &[Vec<f32>]) {
    let arguments: Vec<_> = inputs.iter().map(|c| Lanes::<S>::scalars(c)).collect();
    let resources = Resources::new();
    let mut group = criterion.benchmark_group(function.name());
    group.throughput(Throughput::Elements(COUNT as u64));
    group.bench_function(BenchmarkId::from_parameter(S::NAME), |bench| {
        bench.iter(|| function.call(&arguments, COUNT, &resources));
    });
    group.finish();
}

/// Times native code that gives the very numbers that the evaluator gives.
fn native(
    criterion: &mut Criterion,
    function: &Function,
    inputs: &[Vec<f32>],
    f: impl Fn(usize) -> f32,
) {
    let name = function.name();
    let arguments: Vec<_> = inputs.iter().map(|c| Lanes::<f32>::scalars(c)).collect();
    let found = function.call(&arguments, COUNT, &Resources::new());
    let found = found.expect("runs");
    for (i, found) in found.floats(0).expect("floats").iter().enumerate() {
        assert_eq!(found.to_bits(), f(i).to_bits(), "{name}, input {i}");
    }
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(COUNT as u64));
    group.bench_function("native", |bench| {
        bench.iter(|| (0..COUNT).map(&f).collect::<Vec<f32>>());
    });
    group.finish();
}

fn evaluations(criterion: &mut Criterion) {
    let module = naga::front::wgsl::parse_str(SOURCE).expect("parses");
    let mut validator = naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::empty(),
    );
    let info = validator.validate(&module).expect("is valid");
    let program = Program::new(&module, &info, Settings::default()).expect("a program");
    let crossing = [
        column(0.3, 30.0),
        column(0.1, 10.0),
        column(0.05, 200.0),
        column(1.2, 2.4),
    ];
    let reflection = [column(0.001, 1.0), column(1.1, 2.5)];
    let [snells, fresnels] =
        ["snell", "fresnel"].map(|name| program.function(name).expect("compiles"));
    for (function, inputs) in [(&snells, &crossing[..]), (&fresnels, &reflection[..])] {
        evaluate::<f32>(criterion, function, inputs);
        evaluate::<f64>(criterion, function, inputs);
        evaluate::<DoubleDouble>(criterion, function, inputs);
        evaluate::<Interval>(criterion, function, inputs);
        evaluate::<Dual>(criterion, function, inputs);
        evaluate::<Stochastic>(criterion, function, inputs);
    }
    let [f, s, d, n] = &crossing;
    native(criterion, &snells, &crossing, |i| {
        snell(f[i], s[i], d[i], n[i])
    });
    let [cosine, n] = &reflection;
    native(criterion, &fresnels, &reflection, |i| {
        fresnel(cosine[i], n[i])
    });
}

criterion_group!(benches, evaluations);
criterion_main!(benches);
