//! The tree of boxes with up to four children a node, their boxes in bytes.
//!
//! A node with its children takes 64 bytes where the binary tree takes up to 192 for as many leaves,
//! and rays visit half as many. After Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray
//! Traversal on GPUs Through Compressed Wide BVHs", with four children instead of eight.

use glam::{DVec3, Vec3};

use crate::bvh::Node;

/// Children of a node at most.
const WIDTH: usize = 4;
/// Boxes are widened by this part of a step, so that rounding in a shader misses none.
const MARGIN: f64 = 1e-2;
/// A child that is not there.
pub(crate) const NO_CHILD: u32 = u32::MAX;

/// See `bvh_wide_nodes` in `meniscus_pipeline::host::ARRAYS`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WideNode {
    pub low: Vec3,
    pub step: Vec3,
    /// By axes; a byte for each child.
    pub lows: [u32; 3],
    pub highs: [u32; 3],
    pub children: [u32; WIDTH],
}

/// The wide tree of a binary one, the root first; empty for an empty one.
pub(crate) fn widened(nodes: &[Node]) -> Vec<WideNode> {
    let mut wide = Vec::with_capacity(nodes.len() / WIDTH + 1);
    let Some(root) = nodes.first() else {
        return wide;
    };
    wide.push(WideNode::around(&[]));
    let mut open = vec![(0, *root)];
    while let Some((place, node)) = open.pop() {
        let cut = cut(nodes, node);
        let mut made = WideNode::around(&cut);
        for (child, inner) in made.children.iter_mut().zip(&cut) {
            *child = inner.first << 3 | inner.count;
            if inner.count == 0 {
                *child = (wide.len() as u32) << 3;
                open.push((wide.len(), *inner));
                wide.push(WideNode::around(&[]));
            }
        }
        wide[place] = made;
    }
    wide
}

/// Up to four nodes that hold everything in one: the largest are opened first.
fn cut(nodes: &[Node], node: Node) -> Vec<Node> {
    let area = |n: &Node| {
        let s = n.high.as_dvec3() - n.low.as_dvec3();
        s.x * s.y + s.y * s.z + s.z * s.x
    };
    let mut cut = vec![node];
    while cut.len() < WIDTH {
        let inner = cut.iter().enumerate().filter(|(_, n)| n.count == 0);
        let largest = inner.max_by(|a, b| area(a.1).total_cmp(&area(b.1)));
        let Some((index, _)) = largest else { break };
        let opened = cut.swap_remove(index).first as usize;
        cut.extend_from_slice(&nodes[opened..opened + 2]);
    }
    cut
}

/// The most nodes that wait on a stack while a ray walks through the tree.
pub(crate) fn most_waiting(wide: &[WideNode]) -> usize {
    let mut most = 0;
    let mut open = vec![(0, 0)];
    while let Some((index, waiting)) = open.pop() {
        let Some(node) = wide.get(index) else {
            continue;
        };
        let there = node.children.iter().filter(|c| **c != NO_CHILD);
        let beside = there.clone().count().saturating_sub(1);
        most = most.max(waiting + beside);
        let inner = there.filter(|c| *c & 7 == 0);
        open.extend(inner.map(|c| ((c >> 3) as usize, waiting + beside)));
    }
    most
}

impl WideNode {
    fn around(children: &[Node]) -> Self {
        let lowest = |low: Vec3, n: &Node| low.min(n.low);
        let highest = |high: Vec3, n: &Node| high.max(n.high);
        let low = children.iter().fold(Vec3::MAX, lowest).as_dvec3();
        let high = children.iter().fold(Vec3::MIN, highest).as_dvec3();
        let mut node = Self {
            low: Vec3::ZERO,
            step: Vec3::ZERO,
            lows: [u32::MAX; 3],
            highs: [0; 3],
            children: [NO_CHILD; WIDTH],
        };
        if children.is_empty() {
            return node;
        }
        // A step is left on either side for the margins.
        let step = ((high - low) / 253.0).as_vec3();
        let most = DVec3::splat(f64::from(f32::MAX));
        let first = (low - step.as_dvec3()).clamp(-most, most).as_vec3();
        (node.low, node.step) = (first, step);
        for axis in 0..3 {
            let place = |x: f32| {
                let step = f64::from(step[axis]);
                match step > 0.0 {
                    true => (f64::from(x) - f64::from(first[axis])) / step,
                    false => 0.0,
                }
            };
            let byte = |x: f64, child: usize| (x.clamp(0.0, 255.0) as u32) << (8 * child);
            node.lows[axis] = 0;
            for (child, inner) in children.iter().enumerate() {
                let (from, to) = (place(inner.low[axis]), place(inner.high[axis]));
                node.lows[axis] |= byte((from - MARGIN).floor(), child);
                node.highs[axis] |= byte((to + MARGIN).ceil(), child);
            }
        }
        node
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The box of a child in single precision, as shaders make it.
    fn box_of(node: &WideNode, child: usize) -> [Vec3; 2] {
        let byte = |words: [u32; 3]| {
            let part = |word: u32| (word >> (8 * child) & 255) as f32;
            Vec3::new(part(words[0]), part(words[1]), part(words[2]))
        };
        [byte(node.lows), byte(node.highs)].map(|at| node.low + at * node.step)
    }

    /// That every leaf of a binary tree is in the wide one once, inside all boxes above it.
    pub(crate) fn check(nodes: &[Node]) {
        let wide = widened(nodes);
        assert_eq!(wide.is_empty(), nodes.is_empty());
        let leaf = |n: &&Node| n.count > 0;
        let mut leaves: Vec<(u32, &Node)> = nodes
            .iter()
            .filter(leaf)
            .map(|n| (n.first << 3 | n.count, n))
            .collect();
        leaves.sort_unstable_by_key(|(key, _)| *key);
        let (mut met, mut visited) = (Vec::new(), 0);
        let mut open = vec![(0, Vec::new())];
        while let Some((index, above)) = open.pop() {
            let Some(node): Option<&WideNode> = wide.get(index) else {
                continue;
            };
            visited += 1;
            assert!(node.low.is_finite() && node.step.is_finite());
            for (child, &key) in node.children.iter().enumerate() {
                if key == NO_CHILD {
                    continue;
                }
                let mut above: Vec<[Vec3; 2]> = above.clone();
                above.push(box_of(node, child));
                if key & 7 == 0 {
                    open.push(((key >> 3) as usize, above));
                    continue;
                }
                let found = leaves.binary_search_by_key(&key, |(key, _)| *key);
                let inner = leaves[found.expect("a leaf of the binary tree")].1;
                let holds = |[low, high]: &[Vec3; 2]| {
                    inner.low.cmpge(*low).all() && inner.high.cmple(*high).all()
                };
                assert!(above.iter().all(holds), "{inner:?} in {above:?}");
                met.push(key);
            }
        }
        assert_eq!(visited, wide.len());
        met.sort_unstable();
        assert!(met.iter().eq(leaves.iter().map(|(key, _)| key)));
    }
}
