//! Generators: shapes as grids of vertices, finer or coarser on request.
//!
//! Grids that meet share the very same coordinates along the seam, so that solids are closed
//! bit for bit.

use std::f64::consts::TAU;
use std::rc::Rc;

use glam::{DAffine3, DVec2, DVec3};

/// No grid has more cells along one side.
const MOST_CELLS: usize = 1 << 13;

/// Vertices in columns and rows. Going along columns, then along rows, turns counter-clockwise
/// seen from outside.
pub(crate) struct Patch {
    /// Cells along the columns.
    pub columns: usize,
    /// Cells along the rows.
    pub rows: usize,
    /// Whether the last column or row is the first one again.
    pub closed: (bool, bool),
    /// Rows of vertices that shrink to a point; each costs a triangle a column.
    pub collapsed: usize,
    /// Position and unit normal of a vertex.
    pub vertex: Box<dyn Fn(usize, usize) -> (DVec3, DVec3)>,
}

impl Patch {
    /// How many triangles that are not degenerate it has.
    pub fn triangles(&self) -> u64 {
        (self.columns * (2 * self.rows - self.collapsed)) as u64
    }

    fn moved(self, by: DAffine3) -> Self {
        let vertex = self.vertex;
        Self {
            vertex: Box::new(move |i, j| {
                let (position, normal) = vertex(i, j);
                // Only rotations and translations come here.
                (by.transform_point3(position), by.transform_vector3(normal))
            }),
            ..self
        }
    }
}

/// How fine a shape is to be.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fineness {
    /// Longest side of a cell, metres.
    pub edge: f64,
    /// z of the water, where a row of vertices is wanted; in the shape's own space.
    pub water: Option<f64>,
}

/// Coordinates from `low` to `high`, no further apart than the edge, one of them `at`.
fn cuts(low: f64, high: f64, edge: f64, at: Option<f64>) -> Vec<f64> {
    let run = |from: f64, to: f64| {
        let cells = cells(to - from, edge);
        (0..cells).map(move |i| from + (to - from) * (i as f64 / cells as f64))
    };
    let mut cuts: Vec<f64> = match at {
        // Closer to an end than this, a row would make slivers.
        Some(at) if at - low > 1e-6 && high - at > 1e-6 => {
            run(low, at).chain(run(at, high)).collect()
        }
        _ => run(low, high).collect(),
    };
    cuts.push(high);
    cuts
}

fn cells(length: f64, edge: f64) -> usize {
    ((length / edge).ceil() as usize).clamp(1, MOST_CELLS)
}

/// A flat grid that faces `sign` along `axis`, at coordinate `at` of it; `tables` hold the
/// coordinates of the three axes.
fn flat(tables: &[Rc<Vec<f64>>; 3], axis: usize, sign: f64, at: f64) -> Patch {
    let (mut u, mut v) = ((axis + 1) % 3, (axis + 2) % 3);
    if sign < 0.0 {
        std::mem::swap(&mut u, &mut v);
    }
    let (along_u, along_v) = (tables[u].clone(), tables[v].clone());
    Patch {
        columns: along_u.len() - 1,
        rows: along_v.len() - 1,
        closed: (false, false),
        collapsed: 0,
        vertex: Box::new(move |i, j| {
            let (mut position, mut normal) = (DVec3::ZERO, DVec3::ZERO);
            position[axis] = at;
            position[u] = along_u[i];
            position[v] = along_v[j];
            normal[axis] = sign;
            (position, normal)
        }),
    }
}

/// A box about the origin.
pub(crate) fn cuboid(size: DVec3, fineness: Fineness) -> Vec<Patch> {
    let half = 0.5 * size;
    let tables = [0, 1, 2].map(|axis| {
        let water = fineness.water.filter(|_| axis == 2);
        Rc::new(cuts(-half[axis], half[axis], fineness.edge, water))
    });
    (0..3)
        .flat_map(|axis| [(axis, 1.0), (axis, -1.0)])
        .map(|(axis, sign)| flat(&tables, axis, sign, sign * half[axis]))
        .collect()
}

/// A rectangle about the origin that faces +z.
pub(crate) fn rectangle(size: DVec2, fineness: Fineness) -> Vec<Patch> {
    let table = |length: f64| Rc::new(cuts(-0.5 * length, 0.5 * length, fineness.edge, None));
    let tables = [table(size.x), table(size.y), Rc::new(vec![0.0])];
    vec![flat(&tables, 2, 1.0, 0.0)]
}

/// Floor and walls of a basin seen from inside, open above: the rest plane of its water is z = 0,
/// the floor lies `depth` under it, the walls end `rise` above it.
pub(crate) fn basin(size: DVec2, depth: f64, rise: f64, fineness: Fineness) -> Vec<Patch> {
    let half = 0.5 * size;
    let table = |half: f64| Rc::new(cuts(-half, half, fineness.edge, None));
    let heights = Rc::new(cuts(-depth, rise, fineness.edge, fineness.water));
    let tables = [table(half.x), table(half.y), heights];
    vec![
        flat(&tables, 2, 1.0, -depth),
        flat(&tables, 0, 1.0, -half.x),
        flat(&tables, 0, -1.0, half.x),
        flat(&tables, 1, 1.0, -half.y),
        flat(&tables, 1, -1.0, half.y),
    ]
}

/// A slab about the origin with a rectangular hole right through it along z.
pub(crate) fn frame(inner: DVec2, outer: DVec2, height: f64, fineness: Fineness) -> Vec<Patch> {
    let edge = fineness.edge;
    // Before, beside and behind the hole, and all of it.
    let spans = |axis: usize| {
        let (hole, end) = (0.5 * inner[axis], 0.5 * outer[axis]);
        let spans = [
            cuts(-end, -hole, edge, None),
            cuts(-hole, hole, edge, None),
            cuts(hole, end, edge, None),
        ];
        let whole: Vec<f64> = [&spans[0][..], &spans[1][1..], &spans[2][1..]].concat();
        let [before, beside, behind] = spans.map(Rc::new);
        [before, beside, behind, Rc::new(whole)]
    };
    let (x, y) = (spans(0), spans(1));
    let (low, high) = (-0.5 * height, 0.5 * height);
    let z = Rc::new(cuts(low, high, edge, fineness.water));
    let tables = |i: usize, j: usize| [x[i].clone(), y[j].clone(), z.clone()];
    let mut patches = Vec::new();
    for (sign, at) in [(1.0, high), (-1.0, low)] {
        for (i, j) in [(0, 3), (2, 3), (1, 0), (1, 2)] {
            patches.push(flat(&tables(i, j), 2, sign, at));
        }
    }
    for sign in [-1.0, 1.0] {
        for axis in [0, 1] {
            patches.push(flat(&tables(3, 3), axis, sign, sign * 0.5 * outer[axis]));
            patches.push(flat(&tables(1, 1), axis, -sign, sign * 0.5 * inner[axis]));
        }
    }
    patches
}

/// A sphere about the origin: a cube's six grids blown up, cells of about equal angle.
pub(crate) fn sphere(radius: f64, fineness: Fineness) -> Vec<Patch> {
    let count = cells(0.25 * TAU * radius, fineness.edge).max(2);
    let table: Vec<f64> = (0..=count)
        .map(|i| {
            // Computed on one side and mirrored, with exact ends, so that faces meet exactly.
            let from_end = i.min(count - i);
            let end = if i < count - i { -1.0 } else { 1.0 };
            match from_end {
                0 => end,
                _ => end * (0.125 * TAU * (1.0 - 2.0 * from_end as f64 / count as f64)).tan(),
            }
        })
        .collect();
    let table = Rc::new(table);
    let tables = [table.clone(), table.clone(), table];
    (0..3)
        .flat_map(|axis| [(axis, 1.0), (axis, -1.0)])
        .map(|(axis, sign)| {
            let cube = flat(&tables, axis, sign, sign);
            let vertex = cube.vertex;
            Patch {
                vertex: Box::new(move |i, j| {
                    let normal = vertex(i, j).0.normalize();
                    (radius * normal, normal)
                }),
                ..cube
            }
        })
        .collect()
}

/// Cosines and sines of equal angles; quarter turns are exact.
fn circle(count: usize) -> Rc<Vec<DVec2>> {
    let directions = (0..count).map(|i| {
        let direction = DVec2::from_angle(TAU * i as f64 / count as f64);
        DVec2::from_array(
            direction
                .to_array()
                .map(|c| if c.abs() < 1e-12 { 0.0 } else { c }),
        )
    });
    Rc::new(directions.collect())
}

/// An upright cylinder about the origin, with both ends.
pub(crate) fn cylinder(radius: f64, height: f64, fineness: Fineness) -> Vec<Patch> {
    let columns = cells(TAU * radius, fineness.edge).max(6);
    let (low, high) = (-0.5 * height, 0.5 * height);
    let directions = circle(columns);
    let heights = cuts(low, high, fineness.edge, fineness.water);
    let around = directions.clone();
    let mut patches = vec![Patch {
        columns,
        rows: heights.len() - 1,
        closed: (true, false),
        collapsed: 0,
        vertex: Box::new(move |i, j| {
            let normal = around[i].extend(0.0);
            ((radius * around[i]).extend(heights[j]), normal)
        }),
    }];
    let rings = cells(radius, fineness.edge);
    for (at, normal) in [(high, DVec3::Z), (low, DVec3::NEG_Z)] {
        let around = directions.clone();
        patches.push(Patch {
            columns,
            rows: rings,
            closed: (true, false),
            collapsed: 1,
            vertex: Box::new(move |i, j| {
                // Inwards above, outwards below, so that both face away from the cylinder.
                let ring = if normal.z > 0.0 { rings - j } else { j };
                let ring_radius = radius * (ring as f64 / rings as f64);
                ((ring_radius * around[i]).extend(at), normal)
            }),
        });
    }
    patches
}

/// A ring about the z axis: `radius` to the middle of the tube, `tube` from there.
pub(crate) fn torus(radius: f64, tube: f64, fineness: Fineness) -> Vec<Patch> {
    let columns = cells(TAU * (radius + tube), fineness.edge).max(6);
    let rows = cells(TAU * tube, fineness.edge).max(5);
    let (around, across) = (circle(columns), circle(rows));
    vec![Patch {
        columns,
        rows,
        closed: (true, true),
        collapsed: 0,
        vertex: Box::new(move |i, j| {
            let normal = (around[i] * across[j].x).extend(across[j].y);
            ((radius * around[i]).extend(0.0) + tube * normal, normal)
        }),
    }]
}

/// A lattice in the x–z plane: `count.0` upright bars and, just behind them, `count.1` level ones.
pub(crate) fn bars(
    size: DVec2,
    count: (u32, u32),
    thickness: f64,
    fineness: Fineness,
) -> Vec<Patch> {
    let spread = |index: u32, count: u32, length: f64| {
        let step = if count > 1 {
            (length - thickness) / f64::from(count - 1)
        } else {
            0.0
        };
        f64::from(index) * step
            - if count > 1 {
                0.5 * (length - thickness)
            } else {
                0.0
            }
    };
    let upright = DVec3::new(thickness, thickness, size.y);
    let level = DVec3::new(size.x, thickness, thickness);
    // A gap between the two keeps their faces from coinciding.
    let apart = 0.525 * thickness;
    let mut patches = Vec::new();
    for index in 0..count.0 {
        let at = DVec3::new(spread(index, count.0, size.x), -apart, 0.0);
        patches.extend(placed(cuboid(upright, fineness), at));
    }
    for index in 0..count.1 {
        let at = DVec3::new(0.0, apart, spread(index, count.1, size.y));
        let water = fineness.water.map(|water| water - at.z);
        patches.extend(placed(cuboid(level, Fineness { water, ..fineness }), at));
    }
    patches
}

fn placed(patches: Vec<Patch>, at: DVec3) -> impl Iterator<Item = Patch> {
    patches
        .into_iter()
        .map(move |patch| patch.moved(DAffine3::from_translation(at)))
}

/// Where and how slanted thin things grow.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Growth {
    /// How many.
    pub count: u32,
    /// The rectangle about the origin that they stand in, metres.
    pub area: DVec2,
    /// Length of the longest, metres; the shortest has half of it.
    pub height: f64,
    /// Radius of each, metres.
    pub radius: f64,
    /// Largest angle to the vertical, radians.
    pub lean: f64,
    /// Another seed, other places.
    pub seed: u64,
}

/// Thin rods that stand on z = 0 at random places.
pub(crate) fn reeds(growth: &Growth, fineness: Fineness) -> Vec<Patch> {
    let mut state = growth.seed;
    let mut random = move || {
        // SplitMix64 (Steele, Lea, Flood 2014), whose upper bits make a number in [0, 1).
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut patches = Vec::new();
    for _ in 0..growth.count {
        let foot = (DVec2::new(random(), random()) - 0.5) * growth.area;
        let length = growth.height * (0.5 + 0.5 * random());
        let tilt = DAffine3::from_rotation_z(TAU * random())
            * DAffine3::from_rotation_x(growth.lean * random());
        let place = DAffine3::from_translation(foot.extend(0.0))
            * tilt
            * DAffine3::from_translation(DVec3::Z * (0.5 * length));
        let fineness = Fineness {
            water: None,
            ..fineness
        };
        patches.extend(
            cylinder(growth.radius, length, fineness)
                .into_iter()
                .map(|p| p.moved(place)),
        );
    }
    patches
}
