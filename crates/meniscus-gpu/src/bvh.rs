//! A tree of boxes about a scene's triangles, as rays in shaders walk it.

use glam::{Vec3, Vec3A};
use meniscus_pipeline::host::{BVH_DEPTH, WIDE_BVH_STACK};
use meniscus_scene::Mesh;
pub(crate) use obvhs::aabb::Aabb;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use crate::wide_bvh::{most_waiting, widened};

/// Triangles of a leaf at most.
pub(crate) const MOST_IN_A_LEAF: u32 = 4;
/// What visiting a node costs beside testing a triangle.
const TRAVERSAL_COST: f32 = 1.0;
/// The part of the nodes that is put in at a better place.
const REINSERTED: f32 = 0.05;
/// Areas of larger boxes could overflow in single precision.
const LARGEST_AREA_SIDE: f32 = 1e15;

/// A box with two children, or a leaf. See `bvh_nodes` in `meniscus_pipeline::host::ARRAYS`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Node {
    pub low: Vec3,
    pub high: Vec3,
    /// The first of two nodes, or the first triangle.
    pub first: u32,
    /// How many triangles a leaf has; 0 in other nodes.
    pub count: u32,
}

impl Node {
    /// A leaf without anything in it.
    pub const EMPTY: Self = Self {
        low: Vec3::ZERO,
        high: Vec3::ZERO,
        first: 0,
        count: 0,
    };
}

/// The tree, and the order of the triangles that its leaves name.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Bvh {
    pub nodes: Vec<Node>,
    /// Indices of what was given.
    pub order: Vec<u32>,
}

impl Bvh {
    /// Builds the tree about these boxes, which are finite; empty without any.
    ///
    /// Meister and Bittner 2018, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy
    /// Construction", then reinsertion (Meister and Bittner 2017), by the crate obvhs. Where that
    /// becomes too deep for a shader's stack, or boxes are so large that their areas overflow,
    /// triangles are halved along the widest axis instead, which is never deeper than log₂ of
    /// their number.
    pub fn new(boxes: &[Aabb]) -> Self {
        let sides = boxes
            .iter()
            .fold(Vec3A::ZERO, |s, b| s.max(b.min.abs()).max(b.max.abs()));
        let mut tree = None;
        if sides.max_element() < LARGEST_AREA_SIDE {
            let (nodes, order) = clustered(boxes);
            tree = Some(Self { nodes, order }).filter(|tree| fits(&tree.nodes));
        }
        tree.unwrap_or_else(|| Self::halved(boxes, MOST_IN_A_LEAF))
    }

    /// The tree that is never deeper than log₂ of the number of boxes, with so many in a leaf at most.
    pub fn halved(boxes: &[Aabb], most: u32) -> Self {
        let (nodes, order) = halved(boxes, most);
        Self { nodes, order }
    }
}

/// Gives nodes the boxes of what they hold now, the last ones first: children stand behind their
/// parents, which `first` counts from `base` on. `leaf` is the box about a leaf's triangles.
pub(crate) fn refit(nodes: &mut [Node], base: usize, leaf: impl Fn(&Node) -> [Vec3; 2]) {
    for index in (0..nodes.len()).rev() {
        let node = nodes[index];
        let [low, high] = match node.count {
            0 => {
                let first = node.first as usize - base;
                let [a, b] = [nodes[first], nodes[first + 1]];
                [a.low.min(b.low), a.high.max(b.high)]
            }
            _ => leaf(&node),
        };
        (nodes[index].low, nodes[index].high) = (low, high);
    }
}

/// The box about a triangle of a mesh in which its corners are.
pub(crate) fn around(mesh: &Mesh, triangle: u32) -> Aabb {
    let corners = mesh.triangles[triangle as usize].corners;
    let [a, b, c] = corners.map(|c| Vec3A::from(mesh.positions[c as usize]));
    Aabb::new(a.min(b).min(c), a.max(b).max(c))
}

fn clustered(boxes: &[Aabb]) -> (Vec<Node>, Vec<u32>) {
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        boxes,
        (0..boxes.len() as u32).collect(),
        SortPrecision::U64,
        3,
    );
    let mut reinsertion = ReinsertionOptimizer::default();
    reinsertion.run(&mut tree, REINSERTED, None);
    collapse(&mut tree, MOST_IN_A_LEAF, TRAVERSAL_COST);
    reinsertion.run(&mut tree, 2.0 * REINSERTED, None);
    tree.reorder_in_stack_traversal_order();
    let mut order = Vec::with_capacity(boxes.len());
    let nodes = tree.nodes.iter().map(|node| {
        let mut first = node.first_index;
        if node.is_leaf() {
            let from = first as usize;
            first = order.len() as u32;
            let items = &tree.primitive_indices[from..from + node.prim_count as usize];
            order.extend_from_slice(items);
        }
        Node {
            low: node.aabb().min.into(),
            high: node.aabb().max.into(),
            first,
            count: node.prim_count,
        }
    });
    (nodes.collect(), order)
}

/// Whether walks through the tree, as it is and widened, need no more room than shaders have.
fn fits(nodes: &[Node]) -> bool {
    depth(nodes) <= BVH_DEPTH && most_waiting(&widened(nodes).0) <= WIDE_BVH_STACK
}

/// The most steps from the root to a leaf.
pub(crate) fn depth(nodes: &[Node]) -> usize {
    let mut deepest = 0;
    let mut open = vec![(0, 0)];
    while let Some((index, depth)) = open.pop() {
        let Some(node) = nodes.get(index) else {
            continue;
        };
        deepest = deepest.max(depth);
        if node.count == 0 {
            let first = node.first as usize;
            open.extend([(first, depth + 1), (first + 1, depth + 1)]);
        }
    }
    deepest
}

/// Boxes in two halves along the widest axis of their centres, and so on.
fn halved(boxes: &[Aabb], most: u32) -> (Vec<Node>, Vec<u32>) {
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut nodes = Vec::new();
    if boxes.is_empty() {
        return (nodes, order);
    }
    // Halves, so that sums of very large numbers stay finite.
    let centre = |item: u32| {
        let aabb = boxes[item as usize];
        0.5 * aabb.min + 0.5 * aabb.max
    };
    let around = |items: &[u32]| {
        let mut aabb = boxes[items[0] as usize];
        for &item in items {
            let other = boxes[item as usize];
            aabb = Aabb::new(aabb.min.min(other.min), aabb.max.max(other.max));
        }
        Node {
            low: aabb.min.into(),
            high: aabb.max.into(),
            first: 0,
            count: 0,
        }
    };
    nodes.push(around(&order));
    let mut open = vec![(0, 0..boxes.len())];
    while let Some((index, range)) = open.pop() {
        let items = &mut order[range.clone()];
        if items.len() <= most as usize {
            nodes[index].first = range.start as u32;
            nodes[index].count = items.len() as u32;
            continue;
        }
        let centres = items.iter().map(|&item| centre(item));
        let (low, high) = centres.fold((Vec3A::MAX, Vec3A::MIN), |(low, high), c| {
            (low.min(c), high.max(c))
        });
        let axis = (0.5 * high - 0.5 * low).max_position();
        let middle = items.len() / 2;
        items.select_nth_unstable_by(middle, |&a, &b| centre(a)[axis].total_cmp(&centre(b)[axis]));
        let (left, right) = (around(&items[..middle]), around(&items[middle..]));
        let first = nodes.len();
        nodes[index].first = first as u32;
        nodes.extend([left, right]);
        open.push((first, range.start..range.start + middle));
        open.push((first + 1, range.start + middle..range.end));
    }
    (nodes, order)
}

/// Expected cost of a ray by the surface area heuristic: visits and triangle tests.
#[cfg(test)]
pub(crate) fn cost(nodes: &[Node]) -> f32 {
    let area = |n: &Node| {
        let s = n.high - n.low;
        s.x * s.y + s.y * s.z + s.z * s.x
    };
    let work = |n: &Node| area(n) * (n.count as f32).max(TRAVERSAL_COST);
    nodes.iter().map(work).sum::<f32>() / area(&nodes[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use meniscus_scene::Triangle;

    fn boxes(mesh: &Mesh) -> Vec<Aabb> {
        let all = 0..mesh.triangles.len() as u32;
        all.map(|triangle| around(mesh, triangle)).collect()
    }

    fn soup(count: usize, place: impl Fn(usize) -> [Vec3; 3]) -> Mesh {
        let positions: Vec<Vec3> = (0..count).flat_map(place).collect();
        Mesh {
            normals: vec![Vec3::Z; positions.len()],
            positions,
            triangles: (0..count as u32)
                .map(|i| Triangle {
                    corners: [3 * i, 3 * i + 1, 3 * i + 2],
                    object: 0,
                })
                .collect(),
        }
    }

    /// A number in [0, 1) from another: fractions of multiples of the golden ratio.
    fn scattered(i: usize) -> f32 {
        (i as f64 * 0.618_033_988_749_895).fract() as f32
    }

    fn meshes() -> Vec<Mesh> {
        let random = |i: usize| {
            let at = |k: usize| Vec3::from_array([0, 1, 2].map(|a| scattered(9 * i + 3 * k + a)));
            [0, 1, 2].map(at)
        };
        let tiny = |i: usize| random(i).map(|p| Vec3::splat(scattered(7 * i)) + 1e-3 * p);
        // Each box is twice as large as all before it: what makes trees as deep as they can be.
        let growing = |i: usize| random(i).map(|p| p * 2.0_f32.powi(i as i32 - 60));
        vec![
            soup(0, random),
            soup(1, random),
            soup(2, random),
            soup(5, random),
            soup(1000, random),
            soup(3000, tiny),
            soup(1000, |_| [Vec3::ZERO, Vec3::X, Vec3::Y]),
            soup(120, growing),
            soup(500, |i| random(i).map(|p| p * 3e38)),
        ]
    }

    #[test]
    fn every_triangle_is_in_one_leaf_and_all_boxes_above_it() {
        for mesh in meshes() {
            let bvh = Bvh::new(&boxes(&mesh));
            let mut found = vec![0; mesh.triangles.len()];
            let root = bvh.nodes.first().copied();
            let mut open: Vec<(Node, Vec<Node>)> = root.map(|n| (n, vec![])).into_iter().collect();
            let mut visited = 0;
            while let Some((node, mut above)) = open.pop() {
                visited += 1;
                above.push(node);
                assert!(above.len() <= BVH_DEPTH + 1);
                let first = node.first as usize;
                if node.count == 0 {
                    open.push((bvh.nodes[first], above.clone()));
                    open.push((bvh.nodes[first + 1], above));
                    continue;
                }
                assert!(node.count <= MOST_IN_A_LEAF);
                for &item in &bvh.order[first..first + node.count as usize] {
                    found[item as usize] += 1;
                    for corner in mesh.triangles[item as usize].corners {
                        let at = mesh.positions[corner as usize];
                        let inside = |n: &Node| at.cmpge(n.low).all() && at.cmple(n.high).all();
                        assert!(above.iter().all(inside));
                    }
                }
            }
            assert_eq!(visited, bvh.nodes.len());
            let inner = bvh.nodes.iter().enumerate().filter(|(_, n)| n.count == 0);
            for (index, node) in inner {
                assert!(
                    node.first as usize > index,
                    "children stand behind their parents"
                );
            }
            assert!(most_waiting(&widened(&bvh.nodes).0) <= WIDE_BVH_STACK);
            crate::wide_bvh::tests::check(&bvh.nodes);
            assert!(found.iter().all(|&count| count == 1));
        }
    }

    #[test]
    fn clustering_is_used_where_it_can_be_and_beats_halving() {
        // Triangles of very different sizes, as scenes have them.
        let mesh = soup(2000, |i| {
            let at = |k: usize| Vec3::from_array([0, 1, 2].map(|a| scattered(9 * i + 3 * k + a)));
            let centre = 10.0 * Vec3::new(scattered(5 * i), scattered(11 * i + 3), scattered(i));
            let size = if i % 50 == 0 { 5.0 } else { 0.05 };
            [0, 1, 2].map(|k| centre + size * at(k))
        });
        let boxes = boxes(&mesh);
        let built = Bvh::new(&boxes);
        assert_eq!(built.nodes, clustered(&boxes).0);
        assert!(cost(&built.nodes) < cost(&halved(&boxes, MOST_IN_A_LEAF).0));
    }
}
