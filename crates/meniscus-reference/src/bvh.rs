//! A bounding volume hierarchy over a mesh, for rays in f64.
//!
//! Boxes are stored in f32 because the mesh's vertices are, so they are exact; all arithmetic on
//! rays is f64.

use glam::{DVec3, Vec3};
use meniscus_scene::Mesh;

use crate::triangle::{Meeting, Ray};

/// Bins of the surface area heuristic along an axis.
const BINS: usize = 16;
/// Above this many triangles a leaf is always split.
const LARGEST_LEAF: usize = 8;
/// Below this depth nodes are split at the median, which bounds the depth of any tree.
const HEURISTIC_DEPTH: usize = 48;
/// More than [`HEURISTIC_DEPTH`] + log₂ of the most triangles that a u32 can count.
const STACK: usize = 96;
/// From this many triangles on, the two halves of a node are built in parallel.
const PARALLEL: usize = 8192;

/// An axis-aligned box.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    low: Vec3,
    high: Vec3,
}

impl Bounds {
    const EMPTY: Self = Self {
        low: Vec3::INFINITY,
        high: Vec3::NEG_INFINITY,
    };

    fn include(&mut self, other: Self) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
    }

    /// Half the surface.
    fn area(&self) -> f64 {
        let size = (self.high.as_dvec3() - self.low.as_dvec3()).max(DVec3::ZERO);
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}

/// A triangle while the tree is built.
#[derive(Debug, Clone, Copy)]
struct Entry {
    bounds: Bounds,
    triangle: u32,
}

impl Entry {
    /// Twice the centre.
    fn centre(&self, axis: usize) -> f64 {
        f64::from(self.bounds.low[axis]) + f64::from(self.bounds.high[axis])
    }
}

/// Nodes stand depth first, so an inner node's first child follows it.
#[derive(Debug, Clone, Copy)]
struct Node {
    bounds: Bounds,
    /// Leaf: its first triangle. Inner node: how far on its second child stands.
    offset: u32,
    /// Triangles of a leaf; 0 for an inner node.
    count: u32,
}

/// The hierarchy, with its own copy of the corners.
#[derive(Debug)]
pub(crate) struct Bvh {
    nodes: Vec<Node>,
    /// In the order of the leaves.
    corners: Vec<[Vec3; 3]>,
    /// Index in the mesh of each of them.
    triangles: Vec<u32>,
}

impl Bvh {
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let corners = |triangle: u32| {
            mesh.triangles[triangle as usize]
                .corners
                .map(|corner| mesh.positions[corner as usize])
        };
        let mut entries: Vec<Entry> = (0..mesh.triangles.len() as u32)
            .map(|triangle| {
                let [a, b, c] = corners(triangle);
                let bounds = Bounds {
                    low: a.min(b).min(c),
                    high: a.max(b).max(c),
                };
                Entry { bounds, triangle }
            })
            .collect();
        let mut nodes = Vec::with_capacity(entries.len());
        if !entries.is_empty() {
            grow(&mut entries, 0, 0, &mut nodes);
        }
        let triangles: Vec<u32> = entries.iter().map(|entry| entry.triangle).collect();
        Self {
            nodes,
            corners: triangles
                .iter()
                .map(|&triangle| corners(triangle))
                .collect(),
            triangles,
        }
    }

    /// The nearest triangle that the ray meets at `nearest` ≤ t < `farthest`: its index in the
    /// mesh, and where.
    pub(crate) fn nearest(&self, ray: &Ray, nearest: f64, farthest: f64) -> Option<(u32, Meeting)> {
        let root = self.nodes.first()?;
        // The triangle test may accept a triangle that the ray misses by rounding. Widening every
        // box by that much keeps the tree from hiding it.
        let extent = (root.bounds.low.as_dvec3() - ray.origin)
            .abs()
            .max((root.bounds.high.as_dvec3() - ray.origin).abs());
        let margin = DVec3::splat(8.0 * f64::EPSILON * extent.max_element());
        let enter = |node: &Node, farthest: f64| {
            let low = (node.bounds.low.as_dvec3() - margin - ray.origin) * ray.inverse;
            let high = (node.bounds.high.as_dvec3() + margin - ray.origin) * ray.inverse;
            let from = low.min(high).max_element().max(nearest);
            let to = low.max(high).min_element().min(farthest);
            (from <= to).then_some(from)
        };

        let mut best: Option<(u32, Meeting)> = None;
        let mut farthest = farthest;
        let mut stack = [(0_usize, 0.0_f64); STACK];
        let mut waiting = 0;
        if let Some(from) = enter(root, farthest) {
            stack[0] = (0, from);
            waiting = 1;
        }
        while waiting > 0 {
            waiting -= 1;
            let (index, from) = stack[waiting];
            if from > farthest {
                continue;
            }
            let node = &self.nodes[index];
            if node.count > 0 {
                let first = node.offset as usize;
                for i in first..first + node.count as usize {
                    let corners = self.corners[i].map(|corner| corner.as_dvec3());
                    if let Some(meeting) = ray.meet(corners)
                        && meeting.t >= nearest
                        && meeting.t < farthest
                    {
                        farthest = meeting.t;
                        best = Some((self.triangles[i], meeting));
                    }
                }
                continue;
            }
            let children = [index + 1, index + node.offset as usize];
            let [a, b] = children.map(|child| enter(&self.nodes[child], farthest));
            let swap = matches!((a, b), (Some(a), Some(b)) if a < b);
            let order = if swap { [1, 0] } else { [0, 1] };
            for i in order {
                if let Some(from) = [a, b][i] {
                    stack[waiting] = (children[i], from);
                    waiting += 1;
                }
            }
        }
        best
    }
}

/// Appends the tree over these entries, the first of which will be triangle `first` of the leaves.
fn grow(entries: &mut [Entry], first: u32, depth: usize, nodes: &mut Vec<Node>) {
    let mut bounds = Bounds::EMPTY;
    for entry in entries.iter() {
        bounds.include(entry.bounds);
    }
    let Some(middle) = split(entries, &bounds, depth) else {
        nodes.push(Node {
            bounds,
            offset: first,
            count: entries.len() as u32,
        });
        return;
    };
    let parallel = entries.len() >= PARALLEL;
    let (left, right) = entries.split_at_mut(middle);
    let second = first + middle as u32;
    let place = nodes.len();
    nodes.push(Node {
        bounds,
        offset: 0,
        count: 0,
    });
    if parallel {
        let subtree = |entries: &mut [Entry], first| {
            let mut nodes = Vec::with_capacity(entries.len());
            grow(entries, first, depth + 1, &mut nodes);
            nodes
        };
        let (left, right) = rayon::join(|| subtree(left, first), || subtree(right, second));
        nodes.extend(left);
        nodes[place].offset = (nodes.len() - place) as u32;
        nodes.extend(right);
    } else {
        grow(left, first, depth + 1, nodes);
        nodes[place].offset = (nodes.len() - place) as u32;
        grow(right, second, depth + 1, nodes);
    }
}

/// Sorts the entries into two halves and says where the second begins; none for a leaf.
///
/// Binned surface area heuristic (Wald, *On fast Construction of SAH-based Bounding Volume
/// Hierarchies*, 2007).
fn split(entries: &mut [Entry], bounds: &Bounds, depth: usize) -> Option<usize> {
    if entries.len() <= 2 {
        return None;
    }
    let ranges = [0, 1, 2].map(|axis| {
        entries
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), entry| {
                let centre = entry.centre(axis);
                (low.min(centre), high.max(centre))
            })
    });
    let best = if depth < HEURISTIC_DEPTH {
        (0..3)
            .filter_map(|axis| best_cut(entries, axis, ranges[axis]))
            .min_by(|a, b| a.cost.total_cmp(&b.cost))
    } else {
        None
    };
    // Passing through a node costs about as much as one triangle.
    let leaf_cost = (entries.len() as f64 - 1.0) * bounds.area();
    if let Some(cut) = best
        && (cut.cost < leaf_cost || entries.len() > LARGEST_LEAF)
    {
        let mut middle = 0;
        for i in 0..entries.len() {
            if cut.bins.of(entries[i].centre(cut.axis)) < cut.bin {
                entries.swap(i, middle);
                middle += 1;
            }
        }
        return Some(middle);
    }
    if entries.len() <= LARGEST_LEAF {
        return None;
    }
    let axis = (0..3)
        .max_by(|&a, &b| {
            let size = |axis: usize| ranges[axis].1 - ranges[axis].0;
            size(a).total_cmp(&size(b))
        })
        .unwrap_or(0);
    let middle = entries.len() / 2;
    entries.select_nth_unstable_by(middle, |a, b| a.centre(axis).total_cmp(&b.centre(axis)));
    Some(middle)
}

/// Equal intervals of an axis.
#[derive(Debug, Clone, Copy)]
struct Bins {
    low: f64,
    scale: f64,
}

impl Bins {
    fn of(&self, centre: f64) -> usize {
        (((centre - self.low) * self.scale) as usize).min(BINS - 1)
    }
}

/// A way to split: entries in bins before `bin` on one side.
#[derive(Debug, Clone, Copy)]
struct Cut {
    axis: usize,
    bins: Bins,
    bin: usize,
    /// Sum of area times count.
    cost: f64,
}

/// The cheapest cut along an axis with entries on both sides.
fn best_cut(entries: &[Entry], axis: usize, (low, high): (f64, f64)) -> Option<Cut> {
    if high <= low {
        return None;
    }
    let bins = Bins {
        low,
        scale: BINS as f64 / (high - low),
    };
    let mut filled = [(Bounds::EMPTY, 0_usize); BINS];
    for entry in entries {
        let bin = &mut filled[bins.of(entry.centre(axis))];
        bin.0.include(entry.bounds);
        bin.1 += 1;
    }
    let mut after = [0.0; BINS];
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    for bin in (1..BINS).rev() {
        bounds.include(filled[bin].0);
        count += filled[bin].1;
        after[bin] = if count == 0 {
            0.0
        } else {
            bounds.area() * count as f64
        };
    }
    (bounds, count) = (Bounds::EMPTY, 0);
    let mut best: Option<Cut> = None;
    for bin in 1..BINS {
        bounds.include(filled[bin - 1].0);
        count += filled[bin - 1].1;
        if count == 0 || count == entries.len() {
            continue;
        }
        let cost = bounds.area() * count as f64 + after[bin];
        if best.is_none_or(|best| cost < best.cost) {
            best = Some(Cut {
                axis,
                bins,
                bin,
                cost,
            });
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use meniscus_scene::Triangle;

    /// A number in [0, 1) for each index, spread evenly (Roberts's sequence in four dimensions).
    fn spread(index: usize) -> [f64; 4] {
        let g = 1.1673039782614187_f64;
        [1, 2, 3, 4].map(|i| (0.5 + index as f64 * g.powi(-i)).fract())
    }

    fn triangle_soup(count: usize) -> Mesh {
        let mut mesh = Mesh::default();
        for i in 0..count {
            let [x, y, z, size] = spread(i);
            for corner in 0..3 {
                let [a, b, c, _] = spread(7919 * i + 31 * corner + 5);
                let at = DVec3::new(x, y, z) + 0.1 * size * (DVec3::new(a, b, c) - 0.5);
                mesh.positions.push(at.as_vec3());
                mesh.normals.push(Vec3::Z);
            }
            let first = 3 * i as u32;
            mesh.triangles.push(Triangle {
                corners: [first, first + 1, first + 2],
                object: 0,
            });
        }
        mesh
    }

    fn brute_force(mesh: &Mesh, ray: &Ray, nearest: f64) -> Option<(u32, Meeting)> {
        let mut best: Option<(u32, Meeting)> = None;
        for (i, triangle) in mesh.triangles.iter().enumerate() {
            let corners = triangle
                .corners
                .map(|c| mesh.positions[c as usize].as_dvec3());
            if let Some(meeting) = ray.meet(corners)
                && meeting.t >= nearest
                && best.is_none_or(|(_, best)| meeting.t < best.t)
            {
                best = Some((i as u32, meeting));
            }
        }
        best
    }

    #[test]
    fn the_tree_finds_what_testing_every_triangle_finds() {
        // The last is large enough to be built in parallel.
        for (count, rays) in [(0, 10), (1, 100), (9, 1000), (700, 3000), (20_000, 60)] {
            let mesh = triangle_soup(count);
            let bvh = Bvh::new(&mesh);
            let mut hits = 0;
            for i in 0..rays {
                let [a, b, c, d] = spread(104_729 + i);
                let origin = DVec3::new(2.0 * a - 0.5, 2.0 * b - 0.5, -1.0 + c);
                let target = DVec3::new(b, d, a);
                let ray = Ray::new(origin, (target - origin).normalize());
                let found = bvh.nearest(&ray, 0.3, f64::INFINITY);
                assert_eq!(found, brute_force(&mesh, &ray, 0.3));
                hits += usize::from(found.is_some());
            }
            assert!(count < 700 || hits > rays / 8, "{hits} hits");
        }
    }

    #[test]
    fn triangles_at_one_place_do_not_defeat_the_tree() {
        let mut mesh = triangle_soup(1);
        mesh.triangles = vec![mesh.triangles[0]; 5000];
        let bvh = Bvh::new(&mesh);
        let centre = mesh.positions.iter().sum::<Vec3>().as_dvec3() / 3.0;
        let ray = Ray::new(centre + DVec3::Z, DVec3::NEG_Z);
        assert!(bvh.nearest(&ray, 0.0, f64::INFINITY).is_some());
    }

    /// A closed, bumpy sphere about the origin, with vertices that are not round numbers.
    fn closed_mesh(rings: u32, sectors: u32) -> Mesh {
        let mut mesh = Mesh::default();
        for ring in 0..=rings {
            for sector in 0..sectors {
                let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
                let around = std::f64::consts::TAU * f64::from(sector) / f64::from(sectors);
                // The poles are one point each, or the mesh would not be closed.
                let pole = ring == 0 || ring == rings;
                let radius = if pole {
                    1.0
                } else {
                    1.0 + 0.1 * (7.0 * around).sin()
                };
                let side = if pole { 0.0 } else { polar.sin() };
                let at = radius * DVec3::new(side * around.cos(), side * around.sin(), polar.cos());
                mesh.positions.push(at.as_vec3());
                mesh.normals.push(at.as_vec3());
            }
        }
        for ring in 0..rings {
            for sector in 0..sectors {
                let at = |r: u32, s: u32| r * sectors + s % sectors;
                let corners = [
                    at(ring, sector),
                    at(ring + 1, sector),
                    at(ring + 1, sector + 1),
                    at(ring, sector + 1),
                ];
                for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
                    mesh.triangles.push(Triangle {
                        corners: [corners[a], corners[b], corners[c]],
                        object: 0,
                    });
                }
            }
        }
        mesh
    }

    #[test]
    fn no_ray_leaves_a_closed_mesh() {
        let mesh = closed_mesh(12, 19);
        let bvh = Bvh::new(&mesh);
        let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
        for i in 0..40 {
            let [a, b, c, _] = spread(i);
            let mut origin = 0.8 * (DVec3::new(a, b, c) - 0.5);
            if i % 4 == 0 {
                // From round places, axes and edges of boxes line up with rays.
                origin = (origin * 4.0).round() / 4.0;
            }
            for (k, triangle) in mesh.triangles.iter().enumerate() {
                let [p, q, r] = triangle.corners.map(corner);
                let [s, t, ..] = spread(i + 40 * k);
                for target in [
                    p,
                    (p + q) * 0.5,
                    p.lerp(q, s),
                    q.lerp(r, t),
                    (p + q + r) / 3.0,
                ] {
                    let ray = Ray::new(origin, target - origin);
                    let (_, meeting) = bvh
                        .nearest(&ray, 0.0, f64::INFINITY)
                        .unwrap_or_else(|| panic!("leak from {origin} towards {target}"));
                    assert!(meeting.t > 0.0 && meeting.t < 1.0 + 1e-12, "{meeting:?} {origin} {target}");
                }
            }
        }
    }
}
