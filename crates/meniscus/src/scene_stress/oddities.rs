//! What can be odd about a scene. Each oddity can be taken back alone, so that of a scene that
//! fails the ones can be found that make it fail.

use super::draft::{Draft, object};

/// One thing that is unusual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Oddity {
    kind: usize,
    value: f64,
}

/// A kind of oddity: its name, the values that it may have, and what it does to a scene. Of kinds
/// in one family a scene has one at most.
struct Kind {
    name: &'static str,
    family: u8,
    values: &'static [f64],
    apply: fn(&mut Draft, f64),
}

const EYE: u8 = 0;
const GAZE: u8 = 1;
const LENS: u8 = 2;
const NEAR: u8 = 3;
const INDEX: u8 = 4;
const SLOPE: u8 = 5;
const WAVES: u8 = 6;
const TIME: u8 = 7;
const LEVEL: u8 = 8;
const LIGHT: u8 = 9;
const THINGS: u8 = 10;
const MORE: u8 = 11;
const SIZE: u8 = 12;

static KINDS: &[Kind] = &[
    kind(
        "eye above the rest plane, m",
        EYE,
        &[
            0.0, 1e-7, -1e-7, 3e-8, -1e-12, 1e-4, -1e-4, -0.01, -0.7, -1.9, -2.5, 30.0, 1e3, 1e5,
            -1e5,
        ],
        |d, v| d.height = v,
    ),
    kind(
        "eye above the waves, m",
        EYE,
        &[0.0, 1e-7, -1e-7, 1e-4, -1e-4, 0.02, -0.02],
        |d, v| {
            d.height = v;
            d.rides = true;
        },
    ),
    kind(
        "eye in the ball, m from its middle",
        EYE,
        &[0.0, 0.1],
        |d, v| {
            d.position = [0.3, 0.6];
            d.height = -1.2 + v;
        },
    ),
    kind("eye on the wall, m from it", EYE, &[0.0, 1e-6], |d, v| {
        d.position = [0.2, 2.0 - v];
        d.height = -0.5;
        d.target = [0.0, -2.0, -0.7];
    }),
    kind("eye this far away, m", EYE, &[1e3, 9e4], |d, v| {
        d.position = [0.3 * v, -v];
        d.height = 0.1 * v;
    }),
    kind(
        "gaze level, off by",
        GAZE,
        &[0.0, 1e-9, -1e-9, 1e-4, -1e-4, -1e-3],
        |d, v| {
            let eye = d.water.level + d.height;
            d.target = [d.position[0], d.position[1] + 100.0, eye + 100.0 * v];
        },
    ),
    kind(
        "gaze straight down, off by m",
        GAZE,
        &[0.0, 1e-7, 1e-3],
        |d, v| {
            let eye = d.water.level + d.height;
            d.target = [d.position[0] + v, d.position[1], eye - 10.0];
        },
    ),
    kind(
        "gaze straight up, off by m",
        GAZE,
        &[0.0, 1e-7, 1e-3],
        |d, v| {
            let eye = d.water.level + d.height;
            d.target = [d.position[0], d.position[1] + v, eye + 10.0];
        },
    ),
    kind(
        "gaze at a point this near, m",
        GAZE,
        &[2e-6, 1e-3],
        |d, v| {
            let eye = d.water.level + d.height;
            d.target = [d.position[0], d.position[1] + 0.8 * v, eye - 0.6 * v];
        },
    ),
    kind("gaze away from everything", GAZE, &[1.0, -1.0], |d, v| {
        d.target = [d.position[0] * 3.0, d.position[1] * 1e3, v * 5.0];
    }),
    kind(
        "field of view, degrees",
        LENS,
        &[1.0, 8.0, 120.0, 170.0],
        |d, v| d.field_of_view = v,
    ),
    kind("near plane, m", NEAR, &[1e-5, 1e-3, 1.9, 100.0], |d, v| {
        d.near = v
    }),
    kind("far / near = 1e7", NEAR, &[1e-2], |d, v| {
        d.near = v;
        d.objects.push(object(
            "far wall",
            "Plane(size: (1e5, 1e5)), edge: 2e4, \
            translate: (0, 1e5, 0), rotate: (90, 0, 0)",
        ));
    }),
    kind(
        "refractive index",
        INDEX,
        &[
            1.0,
            1.0 + 1e-7,
            1.0 - 1e-7,
            1.0 + 1e-4,
            0.4,
            0.75,
            1.0003,
            2.5,
        ],
        |d, v| d.water.index = v,
    ),
    kind(
        "rms slope",
        SLOPE,
        &[0.0, 1e-30, 1e-9, 1e-4, 0.4, 1.0, 4.0],
        |d, v| {
            if !d.water.waves.is_empty() {
                d.water.slope = v;
            }
        },
    ),
    kind("no waves at all", WAVES, &[0.0], |d, _| {
        d.water.waves.clear();
        d.water.slope = 0.0;
    }),
    kind("wavelength, m", WAVES, &[1e-3, 0.01, 50.0, 1e4], |d, v| {
        d.water.waves.iter_mut().for_each(|wave| wave[1] = v);
    }),
    kind("wavelengths a million apart", WAVES, &[1e3], |d, v| {
        d.water.waves[0][1] = v;
        d.water.waves[1][1] = v * 1e-6;
    }),
    kind("waves", WAVES, &[1.0, 2.0, 40.0], |d, v| {
        let wave = |i: usize| {
            let i = i as f64;
            [17.0 * i % 360.0, 0.3 + 0.1 * i, 1.0, 40.0 * i]
        };
        d.water.waves = (0..v as usize).map(wave).collect();
    }),
    kind("waves against each other", WAVES, &[0.0, 180.0], |d, v| {
        d.water.waves = vec![[0.0, 1.0, 1.0, 0.0], [v, 1.0, 1.0, 180.0]];
    }),
    kind("one wave without weight", WAVES, &[0.0], |d, v| {
        d.water.waves[0][2] = v
    }),
    kind("time, s", TIME, &[1e6, -1e6, 1e-9], |d, v| d.water.time = v),
    kind(
        "water's level, m",
        LEVEL,
        &[1e4, -1e4, 0.1, -2.0, -1.2, 0.4, 1e-7],
        |d, v| {
            // The eye stays at its height above the water, and goes on looking at what it looked at.
            d.water.level = v;
        },
    ),
    kind(
        "everything this far from the origin, m",
        LEVEL,
        &[1e3, 1e4, 1e5],
        |d, v| {
            let shift = [v, -v];
            d.position =
                [d.position[0] + shift[0], d.position[1] + shift[1]].map(|x| x.clamp(-1e5, 1e5));
            d.target = [d.target[0] + shift[0], d.target[1] + shift[1], d.target[2]]
                .map(|x| x.clamp(-1e5, 1e5));
            d.objects = vec![
                object(
                    "basin",
                    &format!(
                        "Pool(size: (6, 4), depth: 2, rise: 0.1), edge: 1, translate: ({v:?}, {:?}, 0)",
                        -v
                    ),
                ),
                object(
                    "ball",
                    &format!(
                        "Sphere(radius: 0.4), edge: 0.2, translate: ({:?}, {:?}, -1.2)",
                        v + 0.3,
                        0.6 - v
                    ),
                ),
            ];
        },
    ),
    kind(
        "sun at an elevation of, degrees",
        LIGHT,
        &[-90.0, 0.0, 90.0],
        |d, v| d.sun.elevation = v,
    ),
    kind("light, times", LIGHT, &[0.0, 1e-6, 1e3], |d, v| {
        d.sun.strength = v
    }),
    kind(
        "nothing but a ball of radius, m",
        THINGS,
        &[1e-4, 1e-2, 50.0, 1e5],
        |d, v| {
            d.objects = vec![object(
                "ball",
                &format!(
                    "Sphere(radius: {v:?}), edge: {:?}, translate: (0, 1, -0.5)",
                    v
                ),
            )];
        },
    ),
    kind(
        "nothing but a floor this deep, m",
        THINGS,
        &[0.0, 1e-6, 1e-4, 0.1, 1e3, 1e5],
        |d, v| {
            d.objects = vec![object(
                "floor",
                &format!(
                    "Plane(size: (100, 100)), edge: 10, translate: (0, 0, {:?})",
                    -v
                ),
            )];
        },
    ),
    kind(
        "a basin this deep, m",
        THINGS,
        &[1e-4, 0.01, 300.0, 1e5],
        |d, v| {
            let size = (6.0 * v).clamp(6.0, 1e5);
            let edge = 0.5 * size.max(v);
            d.objects[0] = object(
                "basin",
                &format!("Pool(size: ({size:?}, {size:?}), depth: {v:?}, rise: 0), edge: {edge:?}"),
            );
        },
    ),
    kind(
        "nothing in the water, a ball above it at, m",
        THINGS,
        &[0.41, 5.0, 1e5],
        |d, v| {
            d.objects = vec![object(
                "ball",
                &format!("Sphere(radius: 0.4), edge: 0.2, translate: (0, 1, {v:?})"),
            )];
        },
    ),
    kind("a speck of, m", MORE, &[1e-4, 1e-3], |d, v| {
        d.objects.push(object(
            "speck",
            &format!("Box(size: ({v:?}, {v:?}, {v:?})), translate: (0, 0, -0.3)"),
        ));
    }),
    kind("a thing as far away as, m", MORE, &[1e4, 1e5], |d, v| {
        let side = 0.1 * v;
        d.objects.push(object("far box", &format!("Box(size: ({side:?}, {side:?}, {side:?})), edge: {side:?}, translate: (0, {v:?}, 0)")));
    }),
    kind(
        "a thing that ends in the water's plane, off by m",
        MORE,
        &[0.0, 1e-7, -1e-7],
        |d, v| {
            let z = d.water.level - 0.2 + v;
            d.objects.push(object(
                "slab",
                &format!("Box(size: (1, 1, 0.4)), edge: 0.5, translate: (0, 0.5, {z:?})"),
            ));
        },
    ),
    kind(
        "a sheet in the water's plane, off by m",
        MORE,
        &[0.0, 1e-7, -1e-7, 1e-4],
        |d, v| {
            let z = d.water.level + v;
            d.objects.push(object(
                "sheet",
                &format!("Plane(size: (1, 1)), edge: 0.5, translate: (0, 0.5, {z:?})"),
            ));
        },
    ),
    kind("a blade this thin, m", MORE, &[1e-4, 1e-3], |d, v| {
        d.objects.push(object("blade", &format!("Box(size: ({v:?}, 8, {v:?})), edge: 100, rotate: (50, 0, 20), translate: (0.2, 0, 0)")));
    }),
    kind("huge triangles, m", MORE, &[1e3, 1e5], |d, v| {
        d.objects.push(object(
            "plain",
            &format!(
                "Plane(size: ({v:?}, {v:?})), edge: 1e5, rotate: (3, 2, 0), translate: (0, 0, -3)"
            ),
        ));
    }),
    kind(
        "flattened and stretched, times",
        MORE,
        &[1e-6, 1e-3, 1e3],
        |d, v| {
            d.objects.push(object("pancake", &format!("Sphere(radius: 0.5), edge: {:?}, scale: (1, 1, {v:?}), translate: (0, 0, -0.4)", 0.2 * v.max(1.0))));
        },
    ),
    kind("degenerate triangles", MORE, &[0.0], |d, _| {
        d.objects.push(object(
            "splinters",
            &format!("Mesh(file: \"{SPLINTERS}\", up: Z), translate: (0, 0.5, -0.3)"),
        ));
    }),
    kind(
        "picture 1 pixel wide, of height",
        SIZE,
        &[1.0, 2.0, 33.0],
        |d, v| d.size = [1, v as u32],
    ),
    kind(
        "picture 1 pixel high, of width",
        SIZE,
        &[2.0, 57.0],
        |d, v| d.size = [v as u32, 1],
    ),
    kind(
        "picture of odd size",
        SIZE,
        &[2.0, 3.0, 17.0, 31.0],
        |d, v| d.size = [v as u32, v as u32 / 2 + 2],
    ),
];

const fn kind(
    name: &'static str,
    family: u8,
    values: &'static [f64],
    apply: fn(&mut Draft, f64),
) -> Kind {
    Kind {
        name,
        family,
        values,
        apply,
    }
}

/// The mesh file that scenes with degenerate triangles name.
pub(crate) const SPLINTERS: &str = "splinters.obj";

/// Corners that coincide, or nearly; three in a line, or nearly; and one proper triangle.
pub(crate) const SPLINTERS_OBJ: &str = "\
v 0 0 0\nv 1 0 0\nv 0 1 0.2\nv 0 0 0\nv 0.5 0 0\nv 0.5 1e-7 0\nv 1e-30 0 0\nv 0 1e-6 0\nv 100 0 1e-5\n\
v 1 1e-3 0.3\n\
f 1 2 3\nf 1 1 1\nf 1 4 2\nf 1 5 2\nf 1 6 2\nf 1 7 8\nf 1 8 9\nf 3 10 9\nf 2 10 1\n";

impl Oddity {
    /// Up to `most` of them, of different families, in the order in which they act.
    pub fn some(random: &mut fastrand::Rng, most: usize) -> Vec<Self> {
        let mut chosen: Vec<Self> = Vec::new();
        // Every second scene is odd in two ways at most, so that many stay in the modules' domains.
        let most = if random.bool() { most } else { most.min(2) };
        for _ in 0..random.usize(0..=most) {
            let kind = random.usize(0..KINDS.len());
            let values = KINDS[kind].values;
            let mut value = values[random.usize(0..values.len())];
            // Two in three are extreme as listed, one lies anywhere between two of the same sign.
            let other = values[random.usize(0..values.len())];
            if random.u32(0..3) == 0 && value * other > 0.0 {
                let part = random.f64();
                let between =
                    value.signum() * value.abs().powf(part) * other.abs().powf(1.0 - part);
                // Rounding is not to lead beyond what scene files may say.
                value = between.clamp(value.min(other), value.max(other));
            }
            let family = KINDS[kind].family;
            if chosen.iter().all(|c| KINDS[c.kind].family != family) {
                chosen.push(Self { kind, value });
            }
        }
        // Where the eye is comes before where it looks, and objects before those that are added.
        chosen.sort_by_key(|c| {
            let family = KINDS[c.kind].family;
            let first = [LEVEL, EYE, THINGS].iter().position(|f| *f == family);
            first.unwrap_or(3 + usize::from(family))
        });
        chosen
    }

    /// Makes a scene odd.
    pub fn apply(&self, draft: &mut Draft) {
        (KINDS[self.kind].apply)(draft, self.value);
    }

    /// Its name and value.
    pub fn said(&self) -> String {
        format!("{}: {:?}", KINDS[self.kind].name, self.value)
    }
}

/// The names of all kinds.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    KINDS.iter().map(|kind| kind.name)
}
