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
mod tests;
