//! What rays are traced through: trees of boxes over a scene's triangles, in the arrays that shaders
//! walk.
//!
//! What is static has one tree, and each object that moves one of its own; a small tree on top joins
//! their roots. A rigid motion does not change which triangles of an object lie together, so that its
//! tree is kept and only given new boxes; the rest is not touched but for the top, which is made anew.

use std::ops::Range;
use std::time::Instant;

use glam::Vec3;
use meniscus_pipeline::host::{BVH_DEPTH, WIDE_BVH_STACK};
use meniscus_scene::{Mesh, Moving};

use crate::bvh::{self, Aabb, Bvh, Node};
use crate::layout::Column;
use crate::wide_bvh::{Cut, NO_CHILD, WideNode, most_waiting, widened};

/// Trees and triangles.
#[derive(Debug)]
pub(crate) struct Tracing {
    /// First room for the top, where there are several parts.
    pub nodes: Vec<Node>,
    pub wide: Vec<WideNode>,
    pub triangles: Vec<Triangle>,
    parts: Vec<Part>,
    /// How long the trees took to build, milliseconds.
    pub build_ms: f64,
}

/// A triangle, in the order of the leaves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Triangle {
    pub corners: [Vec3; 3],
    pub normals: [u32; 3],
    pub object: u32,
}

/// The tree of what moves together.
#[derive(Debug)]
struct Part {
    /// Index of the body; none of what is static.
    body: Option<usize>,
    nodes: Range<usize>,
    wide: Range<usize>,
    triangles: Range<usize>,
    /// Indices in the mesh of its triangles.
    order: Vec<u32>,
    /// Of its wide nodes, among its own nodes.
    cuts: Vec<Cut>,
}

impl Tracing {
    /// Of a mesh whose corners are finite and their indices in range.
    pub fn new(mesh: &Mesh, moving: &Moving) -> Self {
        let start = Instant::now();
        let groups = groups(mesh, moving);
        let mut made = Self::planted(mesh, &groups, Bvh::new);
        let deep = bvh::depth(&made.nodes) > BVH_DEPTH;
        if deep || most_waiting(&made.wide) > WIDE_BVH_STACK {
            // Each fits by itself, and is too deep under the top.
            made = Self::planted(mesh, &groups, |boxes| {
                Bvh::halved(boxes, bvh::MOST_IN_A_LEAF)
            });
        }
        made.build_ms = start.elapsed().as_secs_f64() * 1e3;
        made
    }

    fn planted(mesh: &Mesh, groups: &[Group], tree: impl Fn(&[Aabb]) -> Bvh) -> Self {
        let room = groups.len().saturating_sub(1);
        let top = if room > 0 { 2 * room + 1 } else { 0 };
        let mut made = Self {
            nodes: vec![Node::EMPTY; top],
            wide: vec![WideNode::NONE; room],
            triangles: Vec::new(),
            parts: Vec::new(),
            build_ms: 0.0,
        };
        for (body, members) in groups {
            let boxes: Vec<Aabb> = members.iter().map(|&t| bvh::around(mesh, t)).collect();
            made.plant(mesh, *body, members, tree(&boxes));
        }
        if made.triangles.is_empty() {
            // A leaf with a triangle of no area, which no ray meets: arrays cannot be empty.
            made.triangles.push(Triangle::NONE);
            made.nodes.push(Node {
                count: 1,
                ..Node::EMPTY
            });
            made.wide = widened(&made.nodes).0;
        }
        made.join();
        made
    }

    /// Adds a part.
    fn plant(&mut self, mesh: &Mesh, body: Option<usize>, members: &[u32], tree: Bvh) {
        let (wide, cuts) = widened(&tree.nodes);
        let first = [self.nodes.len(), self.wide.len(), self.triangles.len()];
        let [node, wide_node, triangle] = first.map(|index| index as u32);
        let order: Vec<u32> = tree.order.iter().map(|&i| members[i as usize]).collect();
        self.triangles
            .extend(order.iter().map(|&t| Triangle::of(mesh, t)));
        self.nodes.extend(tree.nodes.iter().map(|n| Node {
            first: n.first + if n.count == 0 { node } else { triangle },
            ..*n
        }));
        let child = |child: u32| match (child, child & 7) {
            (NO_CHILD, _) => NO_CHILD,
            (child, 0) => child + (wide_node << 3),
            (child, _) => child + (triangle << 3),
        };
        self.wide.extend(wide.into_iter().map(|w| WideNode {
            children: w.children.map(child),
            ..w
        }));
        self.parts.push(Part {
            body,
            nodes: first[0]..self.nodes.len(),
            wide: first[1]..self.wide.len(),
            triangles: first[2]..self.triangles.len(),
            order,
            cuts,
        });
    }

    /// Makes the top anew: copies of the parts' roots are its leaves.
    fn join(&mut self) {
        if self.parts.len() < 2 {
            return;
        }
        let roots: Vec<Node> = self
            .parts
            .iter()
            .map(|p| self.nodes[p.nodes.start])
            .collect();
        let boxes: Vec<Aabb> = roots
            .iter()
            .map(|root| Aabb::new(root.low.into(), root.high.into()))
            .collect();
        let top = Bvh::halved(&boxes, 1);
        let part = |first: u32| top.order[first as usize] as usize;
        for (slot, node) in self.nodes.iter_mut().zip(&top.nodes) {
            *slot = match node.count {
                0 => *node,
                _ => roots[part(node.first)],
            };
        }
        let (wide, _) = widened(&top.nodes);
        let child = |child: u32| match child & 7 {
            _ if child == NO_CHILD => NO_CHILD,
            0 => child,
            _ => {
                let part = part(child >> 3);
                match roots[part] {
                    Node { count: 0, .. } => (self.parts[part].wide.start as u32) << 3,
                    leaf => leaf.first << 3 | leaf.count,
                }
            }
        };
        let room = self.parts.len() - 1;
        self.wide[..room].fill(WideNode::NONE);
        for (slot, node) in self.wide.iter_mut().zip(wide) {
            *slot = WideNode {
                children: node.children.map(child),
                ..node
            };
        }
    }

    /// Puts these bodies' triangles where the mesh has them now, and gives their trees new boxes.
    pub fn follow(&mut self, mesh: &Mesh, moved: &[usize]) {
        for part in &self.parts {
            if !part.body.is_some_and(|body| moved.contains(&body)) {
                continue;
            }
            let places = self.triangles[part.triangles.clone()].iter_mut();
            for (triangle, &index) in places.zip(&part.order) {
                *triangle = Triangle::of(mesh, index);
            }
            let triangles = &self.triangles;
            let nodes = &mut self.nodes[part.nodes.clone()];
            bvh::refit(nodes, part.nodes.start, |leaf| {
                let first = leaf.first as usize;
                let corners = triangles[first..first + leaf.count as usize].iter();
                let none = [Vec3::INFINITY, Vec3::NEG_INFINITY];
                corners
                    .flat_map(|t| t.corners)
                    .fold(none, |[low, high], at| [low.min(at), high.max(at)])
            });
            for (wide, cut) in self.wide[part.wide.clone()].iter_mut().zip(&part.cuts) {
                *wide = WideNode::refitted(wide.children, cut, nodes);
            }
        }
        self.join();
    }

    /// The elements of an array that [`Self::follow`] changes for these bodies.
    pub fn changed(&self, array: &str, moved: &[usize]) -> Vec<Range<usize>> {
        let room = self.parts.len().saturating_sub(1);
        let top = match array {
            "triangles" => 0..0,
            "bvh_wide_nodes" => 0..room,
            _ => 0..if room > 0 { 2 * room + 1 } else { 0 },
        };
        let parts = self.parts.iter();
        let parts = parts.filter(|p| p.body.is_some_and(|body| moved.contains(&body)));
        let ranges = parts.map(|part| match array {
            "triangles" => part.triangles.clone(),
            "bvh_wide_nodes" => part.wide.clone(),
            _ => part.nodes.clone(),
        });
        let all = std::iter::once(top).chain(ranges);
        all.filter(|range| !range.is_empty()).collect()
    }

    /// How many elements an array has.
    pub fn length(&self, array: &str) -> usize {
        match array {
            "triangles" => self.triangles.len(),
            "bvh_wide_nodes" => self.wide.len(),
            _ => self.nodes.len(),
        }
    }

    /// A member of the elements of an array from one of them on.
    pub fn column(&self, array: &str, member: &str, from: usize) -> Option<Column<'_>> {
        let (t, n) = (
            self.triangles.get(from..).unwrap_or_default(),
            self.nodes.get(from..).unwrap_or_default(),
        );
        if array == "bvh_wide_nodes" {
            return self.wide_column(member, from);
        }
        Some(match (array, member) {
            ("triangles", "first") => Column::vec3(|i| t[i].corners[0]),
            ("triangles", "second") => Column::vec3(|i| t[i].corners[1]),
            ("triangles", "third") => Column::vec3(|i| t[i].corners[2]),
            ("triangles", "first_normal") => Column::u32(|i| t[i].normals[0]),
            ("triangles", "second_normal") => Column::u32(|i| t[i].normals[1]),
            ("triangles", "third_normal") => Column::u32(|i| t[i].normals[2]),
            ("triangles", "object") => Column::u32(|i| t[i].object),
            ("bvh_nodes", "low") => Column::vec3(|i| n[i].low),
            ("bvh_nodes", "high") => Column::vec3(|i| n[i].high),
            ("bvh_nodes", "first") => Column::u32(|i| n[i].first),
            ("bvh_nodes", "count") => Column::u32(|i| n[i].count),
            _ => return None,
        })
    }

    fn wide_column(&self, member: &str, from: usize) -> Option<Column<'_>> {
        let wide = self.wide.get(from..).unwrap_or_default();
        let axis = ["x", "y", "z"].iter().position(|a| member.ends_with(a));
        let child = ["first", "second", "third", "fourth"]
            .iter()
            .position(|c| *c == member);
        Some(match (member, axis, child) {
            ("low", ..) => Column::vec3(|i| wide[i].low),
            ("step", ..) => Column::vec3(|i| wide[i].step),
            ("low_x" | "low_y" | "low_z", Some(axis), _) => {
                Column::u32(move |i| wide[i].lows[axis])
            }
            ("high_x" | "high_y" | "high_z", Some(axis), _) => {
                Column::u32(move |i| wide[i].highs[axis])
            }
            (_, _, Some(child)) => Column::u32(move |i| wide[i].children[child]),
            _ => return None,
        })
    }
}

/// What moves together: the index of a body, none for what is static, and its triangles.
type Group = (Option<usize>, Vec<u32>);

fn groups(mesh: &Mesh, moving: &Moving) -> Vec<Group> {
    let mut groups: Vec<Group> = vec![(None, Vec::new())];
    groups.extend((0..moving.bodies().len()).map(|body| (Some(body), Vec::new())));
    for (index, triangle) in (0..).zip(&mesh.triangles) {
        let bodies = moving.bodies();
        let body = bodies.binary_search_by_key(&triangle.object, |body| body.object());
        let group = body.map_or(0, |body| body + 1);
        groups[group].1.push(index);
    }
    groups.retain(|(_, triangles)| !triangles.is_empty());
    groups
}

impl Triangle {
    /// One of no area.
    const NONE: Self = Self {
        corners: [Vec3::ZERO; 3],
        normals: [0; 3],
        object: 0,
    };

    fn of(mesh: &Mesh, index: u32) -> Self {
        let triangle = &mesh.triangles[index as usize];
        let normal = |c: u32| mesh.normals.get(c as usize).copied().unwrap_or(Vec3::Z);
        Self {
            corners: triangle.corners.map(|c| mesh.positions[c as usize]),
            normals: triangle.corners.map(|c| packed(normal(c))),
            object: triangle.object,
        }
    }
}

/// A unit vector as `unpack2x16snorm` and the octahedral map find it again, to about 3e-5. One
/// without direction becomes z.
fn packed(v: Vec3) -> u32 {
    let sum = v.abs().element_sum();
    if !(sum > 0.0 && sum.is_finite()) {
        return 0;
    }
    let mut flat = v.truncate() / sum;
    if v.z < 0.0 {
        let sign = |x: f32| if x < 0.0 { -1.0 } else { 1.0 };
        flat = glam::Vec2::new(
            (1.0 - flat.y.abs()) * sign(flat.x),
            (1.0 - flat.x.abs()) * sign(flat.y),
        );
    }
    let part = |x: f32| u32::from((x.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16);
    part(flat.x) | part(flat.y) << 16
}

#[cfg(test)]
#[path = "tracing_tests.rs"]
mod tests;
