//! The tree of boxes with up to four children a node, their boxes in bytes.
//!
//! A node with its children takes 64 bytes where the binary tree takes up to 192 for as many leaves,
//! and rays visit half as many. After Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray
//! Traversal on GPUs Through Compressed Wide BVHs", with four children instead of eight.

use glam::{DVec3, Vec3};

use crate::bvh::Node;

/// Children of a node at most.
pub(crate) const WIDTH: usize = 4;
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

/// Which nodes of the binary tree are a wide node's children; [`NO_CHILD`] where there is none.
pub(crate) type Cut = [u32; WIDTH];

/// The wide tree of a binary one, the root first, and the cuts that it was made by; empty for an
/// empty one.
pub(crate) fn widened(nodes: &[Node]) -> (Vec<WideNode>, Vec<Cut>) {
    let room = nodes.len() / WIDTH + 1;
    let (mut wide, mut cuts) = (Vec::with_capacity(room), Vec::with_capacity(room));
    if nodes.is_empty() {
        return (wide, cuts);
    }
    wide.push(WideNode::NONE);
    cuts.push([NO_CHILD; WIDTH]);
    let mut open = vec![(0, 0)];
    while let Some((place, index)) = open.pop() {
        let cut = cut(nodes, index);
        let mut made = WideNode::refitted([NO_CHILD; WIDTH], &cut, nodes);
        for (child, &index) in made.children.iter_mut().zip(&cut) {
            let Some(inner) = nodes.get(index as usize) else {
                continue;
            };
            *child = inner.first << 3 | inner.count;
            if inner.count == 0 {
                *child = (wide.len() as u32) << 3;
                open.push((wide.len(), index));
                wide.push(WideNode::NONE);
                cuts.push([NO_CHILD; WIDTH]);
            }
        }
        wide[place] = made;
        cuts[place] = cut;
    }
    (wide, cuts)
}

/// Up to four nodes that hold everything in one: the largest are opened first.
fn cut(nodes: &[Node], node: u32) -> Cut {
    let area = |index: u32| {
        let n = nodes[index as usize];
        let s = n.high.as_dvec3() - n.low.as_dvec3();
        s.x * s.y + s.y * s.z + s.z * s.x
    };
    let mut cut = [NO_CHILD; WIDTH];
    cut[0] = node;
    for count in 1..WIDTH {
        let inner = (0..count).filter(|&i| nodes[cut[i] as usize].count == 0);
        let largest = inner.max_by(|&a, &b| area(cut[a]).total_cmp(&area(cut[b])));
        let Some(place) = largest else { break };
        let opened = nodes[cut[place] as usize].first;
        cut[place] = cut[count - 1];
        cut[count - 1] = opened;
        cut[count] = opened + 1;
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
    /// One without children.
    pub const NONE: Self = Self {
        low: Vec3::ZERO,
        step: Vec3::ZERO,
        lows: [u32::MAX; 3],
        highs: [0; 3],
        children: [NO_CHILD; WIDTH],
    };

    /// A node with these children, whose boxes are those of the cut in the binary tree.
    pub fn refitted(children: [u32; WIDTH], cut: &Cut, nodes: &[Node]) -> Self {
        let mut boxes = [Node::EMPTY; WIDTH];
        let there = cut.iter().filter_map(|&index| nodes.get(index as usize));
        let count = boxes
            .iter_mut()
            .zip(there)
            .map(|(to, node)| *to = *node)
            .count();
        Self {
            children,
            ..Self::around(&boxes[..count])
        }
    }

    fn around(children: &[Node]) -> Self {
        let lowest = |low: Vec3, n: &Node| low.min(n.low);
        let highest = |high: Vec3, n: &Node| high.max(n.high);
        let low = children.iter().fold(Vec3::MAX, lowest).as_dvec3();
        let high = children.iter().fold(Vec3::MIN, highest).as_dvec3();
        let mut node = Self::NONE;
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

    impl WideNode {
        /// The box of a child in single precision, as shaders make it.
        pub(crate) fn box_of(&self, child: usize) -> [Vec3; 2] {
            let byte = |words: [u32; 3]| {
                let part = |word: u32| (word >> (8 * child) & 255) as f32;
                Vec3::new(part(words[0]), part(words[1]), part(words[2]))
            };
            [byte(self.lows), byte(self.highs)].map(|at| self.low + at * self.step)
        }
    }

    /// That every leaf of a binary tree is in the wide one once, inside all boxes above it.
    pub(crate) fn check(nodes: &[Node]) {
        let (wide, _) = widened(nodes);
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
                above.push(node.box_of(child));
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
