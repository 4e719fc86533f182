//! A scene's triangles in an order in which each side of the water is one range and neighbours
//! stand near each other, and runs of them with boxes around them.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::DVec3;

use crate::{Mesh, Scene, Triangle, WaterGeometry};

/// The most triangles of a run: small enough for tight boxes, large enough to be told of one by one.
const MOST: usize = 128;

/// A run that has this many ends where the next triangle would make its box …
const LEAST: usize = 16;
/// … so many times as large: the curve that orders triangles leaves and enters what they lie on.
const JUMP: f64 = 1.5;

/// A triangle that reaches over more than this part of the scene would widen any box that it is in:
/// those have runs of their own.
const LARGE: f64 = 0.125;

/// Bits of each coordinate along the curve that orders triangles.
const BITS: u32 = 20;

/// The heights between which the water's surface may lie: what decides on a triangle's side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaterBand {
    low: f64,
    high: f64,
}

/// Where a triangle stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// Nothing of it may lie under the water.
    Above,
    /// It may have parts on both sides.
    Both,
    /// Nothing of it may lie above the water.
    Below,
}

impl WaterBand {
    /// The rest plane, widened by the sum of the amplitudes where rays meet the waves themselves.
    pub fn of(scene: &Scene) -> Self {
        let water = &scene.water;
        let margin = match water.geometry {
            WaterGeometry::Flat => 0.0,
            WaterGeometry::Displaced => water.height_bound(),
        };
        // As the shaders know it, so that both draw the line at the same height.
        Self::about(f64::from(water.level as f32), margin)
    }

    /// So far about a level, metres.
    pub fn about(level: f64, margin: f64) -> Self {
        Self {
            low: level - margin,
            high: level + margin,
        }
    }

    /// Whether a triangle with corners at these heights has a part on the other side of the water
    /// than an eye above or below it.
    pub fn is_far(&self, z: [f32; 3], eye_above: bool) -> bool {
        let near_alone = if eye_above { Side::Above } else { Side::Below };
        self.side(z) != near_alone
    }

    /// The side of a triangle with corners at these heights.
    pub fn side(&self, z: [f32; 3]) -> Side {
        let least = f64::from(z[0].min(z[1]).min(z[2]));
        let most = f64::from(z[0].max(z[1]).max(z[2]));
        // A triangle that lies in a flat rest plane is on no side of it; it is drawn with those above.
        let above = most > self.low || least >= self.low;
        let below = least < self.high;
        match (above, below) {
            (true, true) => Side::Both,
            (true, false) => Side::Above,
            (false, _) => Side::Below,
        }
    }
}

/// Triangles that stand near each other, on one side of the water.
#[derive(Debug, Clone, PartialEq)]
pub struct Cluster {
    /// Where they stand in [`Clusters::order`].
    pub triangles: Range<u32>,
    /// Low corner of a box around them, world space, metres.
    pub low: DVec3,
    /// Its high corner.
    pub high: DVec3,
}

impl Cluster {
    /// Takes in the next triangle, which has these bounds, if there is room and it is not far off.
    fn take_in(&mut self, low: DVec3, high: DVec3) -> bool {
        let count = self.triangles.len();
        let (low, high) = (self.low.min(low), self.high.max(high));
        let wider = (high - low).length() > JUMP * (self.high - self.low).length();
        let fits = count < MOST && !(wider && count >= LEAST);
        if fits {
            self.triangles.end += 1;
            (self.low, self.high) = (low, high);
        }
        fits
    }
}

/// A mesh's triangles in the order in which they are drawn.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Clusters {
    /// Numbers of the mesh's triangles: those above the water, those that may have parts on both
    /// sides, those below; of each, neighbouring objects follow each other, and in an object
    /// neighbouring triangles.
    pub order: Vec<u32>,
    /// Runs of them, in order, none of them over more than one side.
    pub clusters: Vec<Cluster>,
    /// Triangles with a part above the water's lowest height.
    pub above: Range<u32>,
    /// Triangles with a part below the water's greatest height.
    pub below: Range<u32>,
}

impl Clusters {
    /// Orders the triangles of a mesh. Those with a corner that is missing or not finite have boxes
    /// that are not finite.
    pub fn new(mesh: &Mesh, band: WaterBand) -> Self {
        let objects = objects(mesh);
        let scene = objects.values().copied().reduce(around).unwrap_or_default();
        let extent = (scene.1 - scene.0).max_element();
        let placed = |(number, triangle): (u32, &Triangle)| {
            let corners = corners(mesh, triangle);
            let side = band.side(corners.map(|corner| corner.z as f32));
            let (low, high) = bounds(corners);
            let large = (high - low).max_element() > LARGE * extent;
            let object = objects.get(&triangle.object).copied().unwrap_or(scene);
            let place = (within(object, scene), triangle.object);
            (side, large, place, within((low, high), object), number)
        };
        let mut all: Vec<_> = (0..).zip(&mesh.triangles).map(placed).collect();
        all.sort_unstable();
        let mut clusters = Vec::new();
        for run in all.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let mut open: Option<Cluster> = None;
            for &(.., number) in run {
                let (low, high) = bounds(corners(mesh, &mesh.triangles[number as usize]));
                if let Some(full) = open.take_if(|open| !open.take_in(low, high)) {
                    clusters.push(full);
                }
                open.get_or_insert_with(|| {
                    let start = clusters.last().map_or(0, |c: &Cluster| c.triangles.end);
                    Cluster {
                        triangles: start..start + 1,
                        low,
                        high,
                    }
                });
            }
            clusters.extend(open);
        }
        let end_of = |side: Side| all.partition_point(|&(s, ..)| s <= side) as u32;
        Self {
            clusters,
            above: 0..end_of(Side::Both),
            below: end_of(Side::Above)..all.len() as u32,
            order: all.into_iter().map(|(.., number)| number).collect(),
        }
    }
}

fn corners(mesh: &Mesh, triangle: &Triangle) -> [DVec3; 3] {
    let at = |corner: u32| mesh.positions.get(corner as usize);
    let corners = triangle.corners.map(|corner| at(corner).copied());
    match corners {
        [Some(a), Some(b), Some(c)] if (a + b + c).is_finite() => [a, b, c].map(|at| at.as_dvec3()),
        // Everywhere.
        _ => [DVec3::NEG_INFINITY, DVec3::ZERO, DVec3::INFINITY],
    }
}

/// A low and a high corner.
type Bounds = (DVec3, DVec3);

fn bounds([a, b, c]: [DVec3; 3]) -> Bounds {
    (a.min(b).min(c), a.max(b).max(c))
}

fn around((low, high): Bounds, (a, b): Bounds) -> Bounds {
    (low.min(a), high.max(b))
}

/// Boxes around objects, without what is not finite.
fn objects(mesh: &Mesh) -> BTreeMap<u32, Bounds> {
    let mut objects: BTreeMap<u32, Bounds> = BTreeMap::new();
    for triangle in &mesh.triangles {
        let bounds = bounds(corners(mesh, triangle));
        if (bounds.1 - bounds.0).is_finite() {
            let of = objects.entry(triangle.object).or_insert(bounds);
            *of = around(*of, bounds);
        }
    }
    objects
}

/// How far along a curve through an outer box the middle of an inner one stands.
fn within(inner: Bounds, outer: Bounds) -> u64 {
    let extent = (outer.1 - outer.0).max_element();
    curve((0.5 * (inner.0 + inner.1) - outer.0) / extent)
}

/// How far along a Hilbert curve through the unit cube a point stands (Skilling 2004, Programming the
/// Hilbert curve). What is outside or not a number is put onto a side.
fn curve(point: DVec3) -> u64 {
    let cells = f64::from(1_u32 << BITS);
    let mut x = point
        .to_array()
        .map(|part| (part * cells).clamp(0.0, cells - 1.0) as u32);
    // From coordinates to what Skilling calls the transposed index.
    for bit in (1..BITS).rev().map(|bit| 1_u32 << bit) {
        for axis in 0..3 {
            if x[axis] & bit != 0 {
                x[0] ^= bit - 1;
            } else {
                let turn = (x[0] ^ x[axis]) & (bit - 1);
                x[0] ^= turn;
                x[axis] ^= turn;
            }
        }
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    let flips = (1..BITS)
        .map(|bit| 1_u32 << bit)
        .filter(|bit| x[2] & bit != 0)
        .fold(0, |flips, bit| flips ^ (bit - 1));
    let bits = (0..BITS)
        .rev()
        .flat_map(|bit| x.map(|part| u64::from((part ^ flips) >> bit & 1)));
    bits.fold(0, |index, bit| index << 1 | bit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A square of cells at a height, each of two triangles, that share their corners.
    fn grid(cells: u32, height: f32) -> Mesh {
        let mut mesh = Mesh::default();
        let row = cells + 1;
        for j in 0..row {
            for i in 0..row {
                mesh.positions.push(Vec3::new(i as f32, j as f32, height));
            }
        }
        for j in 0..cells {
            for i in 0..cells {
                let a = j * row + i;
                for corners in [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]] {
                    mesh.triangles.push(Triangle { corners, object: 0 });
                }
            }
        }
        mesh
    }

    #[test]
    fn the_curve_goes_through_every_cell_from_neighbour_to_neighbour() {
        let side = 8;
        let mut cells: Vec<(u64, [i32; 3])> = (0..side * side * side)
            .map(|i| [i % side, i / side % side, i / side / side])
            .map(|cell| {
                let middle = DVec3::from_array(cell.map(|c| (f64::from(c) + 0.5) / 8.0));
                (curve(middle), cell)
            })
            .collect();
        cells.sort_unstable();
        for pair in cells.windows(2) {
            let apart: i32 = (0..3).map(|i| (pair[0].1[i] - pair[1].1[i]).abs()).sum();
            assert_eq!(apart, 1, "{pair:?}");
        }
        for odd in [DVec3::NAN, DVec3::INFINITY, DVec3::NEG_INFINITY] {
            assert!(curve(odd) < 1 << (3 * BITS));
        }
    }

    #[test]
    fn every_triangle_is_in_one_cluster_and_within_its_box() {
        let mut mesh = grid(40, -1.0);
        let more = grid(20, 1.0);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(&more.positions);
        mesh.triangles
            .extend(more.triangles.iter().map(|t| Triangle {
                corners: t.corners.map(|c| first + c),
                ..*t
            }));
        let made = Clusters::new(&mesh, WaterBand::about(0.0, 0.0));
        let mut order = made.order.clone();
        order.sort_unstable();
        assert!((0..4000).eq(order));
        assert_eq!(
            (made.above.clone(), made.below.clone()),
            (0..800, 800..4000)
        );
        let mut end = 0;
        let mut area = 0.0;
        for cluster in &made.clusters {
            assert_eq!(cluster.triangles.start, end);
            end = cluster.triangles.end;
            assert!(cluster.triangles.len() <= MOST);
            for place in cluster.triangles.clone() {
                let number = made.order[place as usize] as usize;
                assert_eq!(made.above.contains(&place), number >= 3200);
                for corner in mesh.corners(number) {
                    assert!(corner.cmpge(cluster.low).all() && corner.cmple(cluster.high).all());
                }
            }
            let size = cluster.high - cluster.low;
            area += size.x * size.y;
        }
        assert_eq!(end, 4000);
        // Boxes overlap little.
        assert!(area < 1.7 * 2000.0, "{area}");
    }

    #[test]
    fn a_large_triangle_widens_no_box_of_small_ones() {
        let mut mesh = grid(40, -1.0);
        mesh.triangles[700].corners = [0, 40, 41 * 41 - 1];
        let made = Clusters::new(&mesh, WaterBand::about(0.0, 0.0));
        let wide = |c: &&Cluster| (c.high - c.low).max_element() > 25.0;
        let wide: Vec<&Cluster> = made.clusters.iter().filter(wide).collect();
        assert!(wide.len() == 1 && wide[0].triangles.len() == 1, "{wide:?}");
    }

    #[test]
    fn what_is_not_a_triangle_may_be_anywhere() {
        let mut mesh = grid(2, -1.0);
        mesh.positions[0].x = f32::NAN;
        mesh.triangles[3].corners[2] = 99;
        let made = Clusters::new(&mesh, WaterBand::about(0.0, 0.0));
        assert_eq!(made.order.len(), 8);
        assert!(made.clusters.iter().any(|c| !c.low.is_finite()));
        let none = Clusters::new(&Mesh::default(), WaterBand::about(0.0, 0.0));
        assert_eq!(none, Clusters::default());
    }
}
