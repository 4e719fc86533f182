//! Lanes that go different ways come out as each would alone.

mod common;

use common::{Chance, call, program, program_with};
use meniscus_stress::{Column, Lanes, Resources, Settings, Trap};

/// Every construct that changes which lanes run, nested in each other.
const TWISTED: &str = "
struct Pair { count: i32, sum: array<f32, 4> }
var<private> steps: u32 = 0u;

fn note(p: ptr<function, Pair>, at: i32, x: f32) {
    (*p).count += 1;
    (*p).sum[at] += x;
    steps += 1u;
}

fn early(x: f32) -> f32 {
    if x < 0.2 { return x * 2.0; }
    for (var i = 0; i < 5; i++) {
        if x < f32(i) * 0.2 { return x + f32(i); }
        if i == 2 && x > 0.7 { break; }
    }
    return -x;
}

fn twisted(start: i32, x: f32) -> vec4f {
    var pair = Pair(0, array<f32, 4>());
    var n = start;
    var y = x;
    loop {
        if n <= 1 || pair.count > 40 { break; }
        switch n % 5 {
            case 0: { n /= 5; continue; }
            case 1, 4: {
                note(&pair, n % 4, y);
                if y > 2.0 { break; }
                y *= 1.25;
            }
            case 2: {
                var k = 0;
                while k < n % 7 {
                    k += 1;
                    if k == 3 { continue; }
                    note(&pair, k % 4, early(fract(y)));
                }
            }
            default: { if y < 0.5 { return vec4f(f32(n), y, f32(steps), -1.0); } }
        }
        n -= 1;
        continuing {
            y -= 0.125;
            break if y < -3.0;
        }
    }
    return vec4f(f32(pair.count), pair.sum[0] + pair.sum[1], pair.sum[2] + pair.sum[3], y + f32(steps));
}
";

#[derive(Default)]
struct Native {
    count: i32,
    sum: [f32; 4],
    steps: u32,
}

impl Native {
    fn note(&mut self, at: usize, x: f32) {
        self.count += 1;
        self.sum[at] += x;
        self.steps += 1;
    }

    fn early(x: f32) -> f32 {
        if x < 0.2 {
            return x * 2.0;
        }
        for i in 0..5 {
            if x < i as f32 * 0.2 {
                return x + i as f32;
            }
            if i == 2 && x > 0.7 {
                break;
            }
        }
        -x
    }

    fn twisted(mut self, start: i32, x: f32) -> [f32; 4] {
        let (mut n, mut y) = (start, x);
        loop {
            if n <= 1 || self.count > 40 {
                break;
            }
            let mut skips = false;
            match n % 5 {
                0 => {
                    n /= 5;
                    skips = true;
                }
                1 | 4 => {
                    self.note((n % 4) as usize, y);
                    if y <= 2.0 {
                        y *= 1.25;
                    }
                }
                2 => {
                    let mut k = 0;
                    while k < n % 7 {
                        k += 1;
                        if k == 3 {
                            continue;
                        }
                        let x = Self::early(y - y.floor());
                        self.note((k % 4) as usize, x);
                    }
                }
                _ => {
                    if y < 0.5 {
                        return [n as f32, y, self.steps as f32, -1.0];
                    }
                }
            }
            if !skips {
                n -= 1;
            }
            y -= 0.125;
            if y < -3.0 {
                break;
            }
        }
        let [a, b, c, d] = self.sum;
        [self.count as f32, a + b, c + d, y + self.steps as f32]
    }
}

#[test]
fn divergent_lanes_are_those_of_native_code() {
    let mut chance = Chance::new(11);
    let starts: Vec<i32> = (0..3000).map(|_| (chance.bits() % 400) as i32).collect();
    let xs: Vec<f32> = (0..3000).map(|_| chance.within(-1.0, 4.0)).collect();
    let arguments = [
        Lanes::<f32> {
            columns: vec![Column::Sint(starts.clone())],
        },
        Lanes::scalars(&xs),
    ];
    let found = call(&program(TWISTED), "twisted", &arguments);
    for lane in 0..starts.len() {
        let right = Native::default().twisted(starts[lane], xs[lane]);
        let found: [f32; 4] = std::array::from_fn(|i| found.floats(i).expect("floats")[lane]);
        assert_eq!(
            found.map(f32::to_bits),
            right.map(f32::to_bits),
            "of {}, {}: {found:?} {right:?}",
            starts[lane],
            xs[lane]
        );
    }
}

#[test]
fn a_lane_does_not_feel_its_neighbours() {
    let mut chance = Chance::new(2);
    let starts: Vec<i32> = (0..64).map(|_| (chance.bits() % 400) as i32).collect();
    let xs: Vec<f32> = (0..64).map(|_| chance.within(-1.0, 4.0)).collect();
    let program = program(TWISTED);
    let lanes = |s: &[i32], x: &[f32]| {
        [
            Lanes::<f32> {
                columns: vec![Column::Sint(s.to_vec())],
            },
            Lanes::scalars(x),
        ]
    };
    let together = call(&program, "twisted", &lanes(&starts, &xs));
    for lane in 0..64 {
        let alone = call(
            &program,
            "twisted",
            &lanes(&starts[lane..=lane], &xs[lane..=lane]),
        );
        assert_eq!(alone.lane(0), together.lane(lane));
    }
}

#[test]
fn indices_beyond_the_end_name_the_last_element() {
    let source = "fn f(i: i32) -> vec3f {
        var a = array<vec2f, 3>(vec2f(1, 2), vec2f(3, 4), vec2f(5, 6));
        var m = mat2x2f(1, 2, 3, 4);
        let v = vec3f(7, 8, 9);
        a[i].y = 10.0;
        return vec3f(a[i].x + a[0].y, m[i][i], v[i]);
    }";
    let index = Lanes::<f32> {
        columns: vec![Column::Sint(vec![0, 1, 2, 3, -1])],
    };
    let found = call(&program(source), "f", &[index]);
    assert_eq!(found.floats(0), Some(&[11.0, 5.0, 7.0, 7.0, 7.0][..]));
    assert_eq!(found.floats(1), Some(&[1.0, 4.0, 4.0, 4.0, 4.0][..]));
    assert_eq!(found.floats(2), Some(&[7.0, 8.0, 9.0, 9.0, 9.0][..]));
}

#[test]
fn nested_dynamic_indices_reach_their_element() {
    let source = "struct Cell { tag: u32, corner: array<vec2f, 2> }
    fn f(i: u32, j: u32, k: u32) -> f32 {
        var grid: array<array<Cell, 3>, 2>;
        for (var a = 0u; a < 2u; a++) {
            for (var b = 0u; b < 3u; b++) {
                for (var c = 0u; c < 2u; c++) {
                    grid[a][b].tag = 1000u;
                    let p = &grid[a][b].corner[c];
                    *p = vec2f(f32(a * 100u + b * 10u + c), 0.5);
                    (*p).y += 0.25;
                }
            }
        }
        let copy = grid;
        grid[i][j].corner[k] = vec2f(-1.0);
        return copy[i][j].corner[k].x + copy[i][j].corner[k].y + f32(grid[i][j].tag);
    }";
    let picks: Vec<[u32; 3]> = (0..12).map(|n| [n / 6, n / 2 % 3, n % 2]).collect();
    let column = |axis: usize| Lanes::<f32> {
        columns: vec![Column::Uint(picks.iter().map(|p| p[axis]).collect())],
    };
    let found = call(&program(source), "f", &[column(0), column(1), column(2)]);
    let right: Vec<f32> = picks
        .iter()
        .map(|[i, j, k]| (i * 100 + j * 10 + k) as f32 + 1000.75)
        .collect();
    assert_eq!(found.floats(0), Some(&right[..]));
}

#[test]
fn an_endless_loop_stops_and_is_named() {
    let source = "fn f(x: f32) -> f32 {\n    var y = x;\n    loop {\n        y += 1.0;\n        if y < 0.0 { break; }\n    }\n    return y;\n}";
    let settings = Settings {
        loop_cap: 100,
        ..Settings::default()
    };
    let function = program_with(source, settings)
        .function("f")
        .expect("compiles");
    let result = function.call(&[Lanes::<f32>::scalars(&[1.0])], 1, &Resources::new());
    let Err(Trap::EndlessLoop { site, cap }) = result else {
        panic!("{result:?}")
    };
    assert_eq!((site.function.as_str(), cap), ("f", 100));
    let start = site.span.expect("a place").start;
    assert_eq!(
        source[..start].lines().count(),
        3,
        "the loop begins in line 3"
    );
}

#[test]
fn a_loop_may_reach_the_cap() {
    let source = "fn f() -> i32 { var n = 0; for (var i = 0; i < 99; i++) { n += 1; } return n; }";
    let settings = Settings {
        loop_cap: 100,
        ..Settings::default()
    };
    let found = call::<f32>(&program_with(source, settings), "f", &[]);
    assert_eq!(found.columns, [Column::Sint(vec![99])]);
}
