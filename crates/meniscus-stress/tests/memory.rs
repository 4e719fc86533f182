//! Buffers, workgroup memory, atomics and barriers; what is missing is told.

mod common;

use common::program;
use meniscus_stress::{Buffer, Lanes, Resources, Trap};

#[test]
fn buffers_have_the_layout_of_the_host() {
    let source = "
struct Inner { a: vec3f, b: f32, m: mat3x3f, c: vec2u }
struct Uniforms { scale: f32, inner: array<Inner, 2>, last: i32 }
@group(0) @binding(0) var<uniform> uniforms: Uniforms;
@group(0) @binding(1) var<storage, read_write> out: array<f32>;

fn f(i: u32) -> f32 {
    let inner = uniforms.inner[i];
    out[i * 3u] = inner.b;
    out[i * 3u + 1u] = inner.m[2].y + f32(inner.c.y);
    out[100u + i] = 77.0;
    return uniforms.scale + f32(uniforms.last) + uniforms.inner[i].m[i][i] + f32(arrayLength(&out));
}";
    // Offsets by WGSL's rules: Inner is a 0, b 12, m 16 (columns of 16), c 64, size 80.
    let mut words = vec![0_u32; 4 + 2 * 20 + 4];
    words[0] = 0.5_f32.to_bits();
    for i in 0..2 {
        let first = 4 + i * 20;
        words[first + 3] = (10.0_f32 + i as f32).to_bits();
        for column in 0..3 {
            for row in 0..3 {
                words[first + 4 + 4 * column + row] =
                    (100.0 * i as f32 + 10.0 * column as f32 + row as f32).to_bits();
            }
        }
        words[first + 17] = 7;
    }
    words[44] = -3_i32 as u32;
    let (uniforms, out) = (Buffer::from_words(&words), Buffer::zeros(6 * 4));
    let resources = Resources::new()
        .buffer("uniforms", &uniforms)
        .buffer("out", &out);
    let function = program(source).function("f").expect("compiles");
    let index = Lanes::<f32> {
        columns: vec![meniscus_stress::Column::Uint(vec![0, 1])],
    };
    let found = function.call(&[index], 2, &resources).expect("runs");
    assert_eq!(
        found.floats(0),
        Some(&[0.5 - 3.0 + 6.0, 0.5 - 3.0 + 111.0 + 6.0][..])
    );
    // What is written beyond the end lands in the last element.
    assert_eq!(
        out.floats(),
        [10.0, 21.0 + 7.0, 0.0, 11.0, 121.0 + 7.0, 77.0]
    );
}

#[test]
fn a_workgroup_adds_up_across_its_barriers() {
    let source = "
@group(0) @binding(0) var<storage, read> numbers: array<u32>;
@group(0) @binding(1) var<storage, read_write> sums: array<u32>;
@group(0) @binding(2) var<storage, read_write> total: atomic<u32>;
@group(0) @binding(3) var<storage, read_write> most: atomic<i32>;
var<workgroup> partial: array<u32, 256>;
var<workgroup> seen: atomic<u32>;

@compute @workgroup_size(16, 16)
fn main(
    @builtin(local_invocation_index) i: u32,
    @builtin(workgroup_id) group: vec3u,
    @builtin(global_invocation_id) id: vec3u,
    @builtin(num_workgroups) groups: vec3u,
) {
    let n = group.y * groups.x + group.x;
    partial[i] = numbers[n * 256u + i];
    workgroupBarrier();
    for (var step = 128u; step > 0u; step >>= 1u) {
        if i < step { partial[i] += partial[i + step]; }
        workgroupBarrier();
    }
    atomicAdd(&seen, 1u);
    atomicMax(&most, i32(id.x) - 1000);
    workgroupBarrier();
    if i == 0u {
        sums[n] = partial[0] + atomicLoad(&seen) * 1000000u;
        let before = atomicAdd(&total, partial[0]);
        let exchanged = atomicCompareExchangeWeak(&sums_done, before, before);
    }
}
var<private> unused: u32;
@group(0) @binding(4) var<storage, read_write> sums_done: atomic<u32>;
";
    let groups = [5, 3, 1];
    let numbers: Vec<u32> = (0..15 * 256).map(|i| i * 7 % 1000).collect();
    let (input, sums) = (Buffer::from_words(&numbers), Buffer::zeros(15 * 4));
    let (total, most, done) = (
        Buffer::zeros(4),
        Buffer::from_words(&[-5000_i32 as u32]),
        Buffer::zeros(4),
    );
    let resources = Resources::new()
        .buffer("numbers", &input)
        .buffer("sums", &sums)
        .buffer("total", &total)
        .buffer("most", &most)
        .buffer("sums_done", &done);
    let entry = program(source).entry("main").expect("compiles");
    assert_eq!(entry.workgroup(), [16, 16, 1]);
    entry.dispatch::<f32>(groups, &resources).expect("runs");
    let right: Vec<u32> = numbers
        .chunks(256)
        .map(|c| c.iter().sum::<u32>() + 256_000_000)
        .collect();
    assert_eq!(sums.words(), right);
    assert_eq!(total.words(), [numbers.iter().sum::<u32>()]);
    assert_eq!(most.words(), [(5 * 16 - 1 - 1000) as u32]);
}

#[test]
fn workgroups_start_with_zeros_and_share_what_is_loaded_uniformly() {
    let source = "
@group(0) @binding(0) var<storage, read_write> out: array<u32>;
var<workgroup> counter: u32;
override size: u32 = 32;

@compute @workgroup_size(size)
fn main(@builtin(local_invocation_index) i: u32, @builtin(workgroup_id) group: vec3u) {
    if i == 31u { counter += 5u + group.x; }
    let all = workgroupUniformLoad(&counter);
    out[group.x * 32u + i] = all;
}";
    let out = Buffer::zeros(4 * 32 * 4);
    let entry = program(source).entry("main").expect("compiles");
    entry
        .dispatch::<f64>([4, 1, 1], &Resources::new().buffer("out", &out))
        .expect("runs");
    let right: Vec<u32> = (0..128).map(|i| 5 + i / 32).collect();
    assert_eq!(out.words(), right);
}

#[test]
fn compare_exchange_tells_whether_it_swapped() {
    let source = "
@group(0) @binding(0) var<storage, read_write> place: atomic<u32>;
fn f(expected: u32) -> vec2u {
    let r = atomicCompareExchangeWeak(&place, expected, 9u);
    return vec2u(r.old_value, u32(r.exchanged));
}";
    let place = Buffer::from_words(&[4]);
    let function = program(source).function("f").expect("compiles");
    let lanes = Lanes::<f32> {
        columns: vec![meniscus_stress::Column::Uint(vec![3, 4, 4])],
    };
    let found = function
        .call(&[lanes], 3, &Resources::new().buffer("place", &place))
        .expect("runs");
    assert_eq!(
        [0, 1, 2].map(|i| found.lane(i)),
        [[4.0, 0.0], [4.0, 1.0], [9.0, 0.0]]
    );
}

#[test]
fn what_is_missing_is_told() {
    let source = "
@group(0) @binding(0) var<uniform> table: array<vec4f, 4>;
fn f(x: f32) -> f32 { return x + table[1].x; }
fn wide(x: f32) -> f32 { let y: f64 = f64(x); return f32(y * y); }";
    let program = program(source);
    let function = program.function("f").expect("compiles");
    let x = || Lanes::<f32>::scalars(&[1.0]);
    let call = |arguments: &[Lanes<f32>], resources: &Resources<'_>| {
        function
            .call(arguments, 1, resources)
            .expect_err("a trap")
            .to_string()
    };
    assert_eq!(
        call(&[x()], &Resources::new()),
        "`table` is used, but no buffer is connected to it"
    );
    let short = Buffer::zeros(8);
    let resources = Resources::new().buffer("table", &short);
    assert_eq!(
        call(&[x()], &resources),
        "the buffer for `table` has 8 bytes; its type needs at least 64"
    );
    assert_eq!(call(&[], &resources), "`f` takes 1 arguments, not 0");
    assert_eq!(
        call(&[Lanes::vectors(&[[1.0, 2.0]])], &resources),
        "argument `x` of `f` is f32; the columns given do not match"
    );
    assert_eq!(
        program.function("g").expect_err("no g").to_string(),
        "there is no function `g`; there are: f, wide"
    );
    let Err(Trap::Unsupported(unsupported)) = program.function("wide") else {
        panic!("64 bits")
    };
    assert_eq!(unsupported.construct, "a floating-point number of 64 bits");
    let span = unsupported.site.span.expect("a place");
    assert!(source[span].contains("f64(x)"));
}
