//! Textures are loaded, sampled and stored as WebGPU has it; quads give derivatives.

mod common;

use common::{Chance, program};
use meniscus_stress::{Column, Kind, Lanes, Resources, Sampler, Texture, Wrap};

const WIDTH: u32 = 5;
const HEIGHT: u32 = 3;

/// A texture of which red is x, green y: bilinear filtering gives the place back.
fn ramp() -> Texture {
    let texel = |i: u32| [(i % WIDTH) as f32 + 0.5, (i / WIDTH) as f32 + 0.5, 1.0, 0.0];
    let texels: Vec<_> = (0..WIDTH * HEIGHT).map(texel).collect();
    Texture::from_floats([WIDTH, HEIGHT, 1], &texels)
}

const SAMPLING: &str = "
@group(0) @binding(0) var image: texture_2d<f32>;
@group(0) @binding(1) var filtering: sampler;
fn sampled(uv: vec2f) -> vec4f { return textureSampleLevel(image, filtering, uv, 0.0); }
fn moved(uv: vec2f) -> vec4f {
    return textureSampleLevel(image, filtering, uv, 0.0, vec2i(1, -1));
}
fn gathered(uv: vec2f) -> vec4f { return textureGather(0, image, filtering, uv); }
fn loaded(at: vec2i) -> vec4f { return textureLoad(image, at, 0); }
fn size() -> vec3u { return vec3u(textureDimensions(image), textureNumLevels(image)); }
";

fn sampled(name: &str, sampler: Sampler, uv: &[[f32; 2]]) -> Lanes<f64> {
    let texture = ramp();
    let resources = Resources::new()
        .texture("image", &texture)
        .sampler("filtering", sampler);
    let function = program(SAMPLING).function(name).expect("compiles");
    function
        .call(&[Lanes::vectors(uv)], uv.len(), &resources)
        .expect("runs")
}

#[test]
fn a_ramp_filters_to_the_place_itself() {
    let mut chance = Chance::new(8);
    let uv: Vec<[f32; 2]> = (0..200)
        .map(|_| [chance.within(-0.5, 1.5), chance.within(-0.5, 1.5)])
        .collect();
    let found = sampled("sampled", Sampler::default(), &uv);
    let moved = sampled("moved", Sampler::default(), &uv);
    for (lane, [u, v]) in uv.iter().enumerate() {
        let inside = |x: f64, size: u32| x.clamp(0.5, f64::from(size) - 0.5);
        let place = [
            f64::from(*u) * f64::from(WIDTH),
            f64::from(*v) * f64::from(HEIGHT),
        ];
        let right = [inside(place[0], WIDTH), inside(place[1], HEIGHT)];
        assert_near(&found.lane(lane), right);
        let right = [
            inside(place[0] + 1.0, WIDTH),
            inside(place[1] - 1.0, HEIGHT),
        ];
        assert_near(&moved.lane(lane), right);
    }
}

fn assert_near(found: &[f64], right: [f64; 2]) {
    for (found, right) in found.iter().zip(right) {
        assert!((found - right).abs() < 1e-12, "{found} is not {right}");
    }
}

#[test]
fn address_modes_repeat_and_mirror() {
    let uv: Vec<[f32; 2]> = (-8..18).map(|i| [(i as f32 + 0.5) / 5.0, 0.5]).collect();
    for (wrap, place) in [
        (Wrap::Repeat, (|x: i32| x.rem_euclid(5)) as fn(i32) -> i32),
        (Wrap::Mirror, |x: i32| {
            let x = x.rem_euclid(10);
            if x < 5 { x } else { 9 - x }
        }),
        (Wrap::Clamp, |x: i32| x.clamp(0, 4)),
    ] {
        let sampler = Sampler {
            wrap: [wrap; 3],
            linear: false,
            ..Sampler::default()
        };
        let found = sampled("sampled", sampler, &uv);
        for (lane, x) in (-8..18).enumerate() {
            assert_eq!(
                found.lane(lane)[0],
                f64::from(place(x)) + 0.5,
                "{wrap:?} at {x}"
            );
        }
    }
}

#[test]
fn gathering_goes_round_from_the_lower_left() {
    let found = sampled("gathered", Sampler::default(), &[[2.0 / 5.0, 1.0 / 3.0]]);
    assert_eq!(found.lane(0), [1.5, 2.5, 2.5, 1.5]);
}

#[test]
fn loads_outside_are_zero_and_sizes_are_told() {
    let texture = ramp();
    let resources = Resources::new().texture("image", &texture);
    let program = program(SAMPLING);
    let at = Lanes::<f32> {
        columns: vec![
            Column::Sint(vec![4, 5, -1, 0]),
            Column::Sint(vec![2, 0, 0, 3]),
        ],
    };
    let loaded = program
        .function("loaded")
        .expect("compiles")
        .call(&[at], 4, &resources);
    let loaded = loaded.expect("runs");
    assert_eq!(loaded.lane(0), [4.5, 2.5, 1.0, 0.0]);
    assert!((1..4).all(|lane| loaded.lane(lane) == [0.0; 4]));
    let size = program
        .function("size")
        .expect("compiles")
        .call::<f32>(&[], 1, &resources);
    assert_eq!(size.expect("runs").lane(0), [5.0, 3.0, 1.0]);
}

#[test]
fn levels_are_mixed_by_the_level_asked_for() {
    let mut texture = Texture::from_floats([4, 4, 1], &[[1.0; 4]; 16]);
    texture.push_level(&[[3.0; 4]; 4]);
    let source = "@group(0) @binding(0) var image: texture_2d<f32>;
        @group(0) @binding(1) var filtering: sampler;
        fn f(level: f32) -> f32 { return textureSampleLevel(image, filtering, vec2f(0.3), level).x; }";
    let sampler = Sampler {
        between_levels: true,
        ..Sampler::default()
    };
    let resources = Resources::new()
        .texture("image", &texture)
        .sampler("filtering", sampler);
    let levels = Lanes::<f32>::scalars(&[-1.0, 0.0, 0.25, 1.0, 9.0, f32::NAN]);
    let found = program(source)
        .function("f")
        .expect("compiles")
        .call(&[levels], 6, &resources);
    assert_eq!(
        found.expect("runs").floats(0),
        Some(&[1.0, 1.0, 1.5, 3.0, 3.0, 1.0][..])
    );
}

#[test]
fn depth_is_compared_before_it_is_mixed() {
    let texture = Texture::from_floats([2, 1, 1], &[[0.25, 0.0, 0.0, 1.0], [0.75, 0.0, 0.0, 1.0]]);
    let source = "@group(0) @binding(0) var image: texture_depth_2d;
        @group(0) @binding(1) var comparing: sampler_comparison;
        fn f(depth: f32) -> vec2f {
            return vec2f(
                textureSampleCompareLevel(image, comparing, vec2f(0.5), depth),
                textureLoad(image, vec2i(1, 0), 0),
            );
        }";
    let resources = Resources::new()
        .texture("image", &texture)
        .sampler("comparing", Sampler::default());
    let depths = Lanes::<f32>::scalars(&[0.1, 0.5, 0.9]);
    let found = program(source)
        .function("f")
        .expect("compiles")
        .call(&[depths], 3, &resources);
    assert_eq!(
        found.as_ref().expect("runs").floats(0),
        Some(&[1.0, 0.5, 0.0][..])
    );
    assert_eq!(found.expect("runs").floats(1), Some(&[0.75; 3][..]));
}

#[test]
fn storage_textures_keep_what_their_format_can() {
    let source = "@group(0) @binding(0) var fine: texture_storage_2d<rgba32float, write>;
        @group(0) @binding(1) var half: texture_storage_2d<rgba16float, write>;
        @group(0) @binding(2) var coarse: texture_storage_2d<rgba8unorm, write>;
        @group(0) @binding(3) var one: texture_storage_2d<r32float, read_write>;
        @compute @workgroup_size(8, 8)
        fn main(@builtin(global_invocation_id) id: vec3u) {
            let v = vec4f(f32(id.x) / 7.0, 1.5, -1.0, f32(id.y));
            textureStore(fine, id.xy, v);
            textureStore(half, id.xy, v);
            textureStore(coarse, id.xy, v);
            textureStore(one, id.xy, v + textureLoad(one, id.xy));
        }";
    let size = [10, 9, 1];
    let [fine, half, coarse, one] = std::array::from_fn(|_| Texture::zeros(Kind::Float, size));
    let resources = Resources::new()
        .texture("fine", &fine)
        .texture("half", &half)
        .texture("coarse", &coarse)
        .texture("one", &one);
    // More threads than texels: what falls outside is dropped.
    program(source)
        .entry("main")
        .expect("compiles")
        .dispatch::<f32>([2, 2, 1], &resources)
        .expect("runs");
    for y in 0..9_u32 {
        for x in 0..10_u32 {
            let at = (y * 10 + x) as usize;
            let exact = x as f32 / 7.0;
            assert_eq!(fine.floats()[at], [exact, 1.5, -1.0, y as f32]);
            let rounded = half::f16::from_f32(exact).to_f32();
            assert_eq!(half.floats()[at], [rounded, 1.5, -1.0, y as f32]);
            let red = (exact.min(1.0) * 255.0).round() / 255.0;
            assert_eq!(
                coarse.floats()[at],
                [red, 1.0, 0.0, if y > 0 { 1.0 } else { 0.0 }]
            );
            assert_eq!(one.floats()[at], [exact, 0.0, 0.0, 1.0]);
        }
    }
}

#[test]
fn pixels_have_their_centres_and_derivatives() {
    let source = "
struct Out { @location(0) a: vec4f, @location(1) b: vec2f }
@fragment
fn main(@builtin(position) at: vec4f, @location(0) uv: vec2f) -> Out {
    if at.x > 3.0 && at.y < 1.0 { discard; }
    let square = at.x * at.x + 3.0 * at.y;
    return Out(vec4f(at.xy, dpdxFine(square), dpdy(square)), uv + vec2f(fwidth(at.y)));
}";
    let entry = program(source).entry("main").expect("compiles");
    let [width, height] = [75_u32, 5];
    let varying =
        |location: u32, [x, y]: [f32; 2]| (location == 0).then_some([x / 75.0, y / 5.0, 0.0, 0.0]);
    let pixels = entry
        .shade::<f64>([width, height], &Resources::new(), &varying)
        .expect("runs");
    assert_eq!(pixels.kept.len(), 75 * 5);
    for (i, kept) in pixels.kept.iter().enumerate() {
        let (column, row) = (i % 75, i / 75);
        let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
        assert_eq!(*kept, !(x > 3.0 && y < 1.0));
        if !kept {
            continue;
        }
        // Differences to the neighbour in the same two columns.
        let left = (column - column % 2) as f64 + 0.5;
        let right = (left + 1.0).powi(2) - left.powi(2);
        let u = f64::from(x as f32 / 75.0) + 1.0;
        let v = f64::from(y as f32 / 5.0) + 1.0;
        assert_eq!(pixels.value.lane(i), [x, y, right, 3.0, u, v]);
    }
    let missing = entry.shade::<f32>([2, 2], &Resources::new(), &|_, _| None);
    let message = missing.expect_err("no uv").to_string();
    assert_eq!(
        message,
        "`main` reads @location(0), which this run does not provide"
    );
}

#[test]
fn helper_lanes_write_nothing() {
    let source = "
@group(0) @binding(0) var<storage, read_write> count: atomic<u32>;
@fragment
fn main() -> @location(0) f32 { return f32(atomicAdd(&count, 1u)); }";
    let count = meniscus_stress::Buffer::zeros(4);
    let entry = program(source).entry("main").expect("compiles");
    let resources = Resources::new().buffer("count", &count);
    entry
        .shade::<f32>([7, 3], &resources, &|_, _| None)
        .expect("runs");
    assert_eq!(count.words(), [21]);
}

#[test]
fn textures_can_be_arguments() {
    let source = "
@group(0) @binding(0) var first: texture_2d<f32>;
@group(0) @binding(1) var second: texture_2d<u32>;
fn red(image: texture_2d<f32>, at: vec2u) -> f32 { return textureLoad(image, at, 0).r; }
fn f(at: vec2u) -> f32 { return red(first, at) + f32(textureLoad(second, at, 0).g); }";
    let first = ramp();
    let second = Texture::from_words(Kind::Uint, [1, 1, 1], &[[0, 4_000_000_000, 0, 0]]);
    let resources = Resources::new()
        .texture("first", &first)
        .texture("second", &second);
    let at = Lanes::<f64> {
        columns: vec![Column::Uint(vec![0]), Column::Uint(vec![0])],
    };
    let found = program(source)
        .function("f")
        .expect("compiles")
        .call(&[at], 1, &resources);
    assert_eq!(found.expect("runs").floats(0), Some(&[4_000_000_000.5][..]));
}
