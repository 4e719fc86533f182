//! The far side's triangles as flat water asks for them: cut at its rest plane, and divided until
//! the straight edges that the adapter draws lie where the bent ones appear.
//!
//! Vertices behind the water are drawn where they appear, edges between them straight, while the
//! image of a straight edge bows. Whether an edge is divided, and where, depends on its two ends
//! alone, so that triangles that share an edge stay joined.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DVec3, Vec3};
use meniscus_scene::WaterBand;
use rayon::prelude::*;

use crate::geometry::{Triangles, Vertex};
use crate::sight::{Sight, Sighted};

/// Largest distance of a drawn edge from where its points appear, pixels, where the budget allows
/// it. A tenth of a pixel keeps an outline within the half pixel that a sample may be off anyway.
pub const BOW_PX: f64 = 0.1;

/// How often an edge is halved at most.
const DEPTH: u32 = 14;

/// How many triangles the far side may become: eight times its own, but this many in any case …
const BUDGET_LEAST: usize = 1 << 18;
/// … and this many at most, or as many as it has uncut.
const BUDGET_MOST: usize = 1 << 22;

/// How far above the plane the feet of triangles are drawn to an eye below, metres, or parts of the
/// plane's own height where that is larger: the least that single precision can tell.
const LIFT: f32 = 5e-7;

/// Beyond this bound, pixels, nothing is divided any more.
const BOW_MOST: f64 = 1e6;

/// The far side, divided.
#[derive(Debug)]
pub(crate) struct Divided {
    pub vertices: Vec<Vertex>,
    pub indices: Vec<u32>,
    /// Where the indices begin that each triangle became, and where all end.
    pub starts: Vec<u32>,
    /// The bound that was kept to, pixels: larger than asked for where the budget was short.
    pub bow_px: f64,
}

/// How many triangles a far side of so many may become.
pub(crate) fn budget(triangles: usize) -> usize {
    triangles
        .saturating_mul(8)
        .clamp(BUDGET_LEAST, BUDGET_MOST)
        .max(triangles.saturating_mul(3))
}

/// Divides a range of triangles, which are those on the far side of the water. None where nothing
/// is to be divided: the triangles serve as they are.
pub(crate) fn divided(
    made: &Triangles,
    range: Range<u32>,
    band: WaterBand,
    sight: &Sight,
    bow_px: f64,
    budget: usize,
) -> Option<Divided> {
    let seen: Vec<Sighted> = made
        .vertices
        .par_iter()
        .map(|vertex| sight.sighted(wide(vertex.position)))
        .collect();
    let far = &made.indices[range.start as usize..range.end as usize];
    let mut bow_px = bow_px;
    loop {
        if bow_px.is_nan() || bow_px > BOW_MOST {
            bow_px = f64::INFINITY;
        }
        let divider = Divider {
            sight,
            band,
            bow_px,
            budget,
            made: AtomicUsize::new(0),
        };
        let parts: Vec<Option<Pieces>> = far
            .par_chunks_exact(3)
            .with_min_len(256)
            .map(|corners| divider.triangle(made, &seen, corners))
            .collect();
        if bow_px.is_infinite() || divider.made.into_inner() <= budget {
            return joined(made, far, parts, bow_px);
        }
        // Half as many triangles, roughly: the bow of an edge goes with its length squared.
        bow_px = 2.0 * bow_px.max(f64::MIN_POSITIVE.sqrt());
    }
}

/// All vertices, then those of the pieces; triangles in their order.
fn joined(
    made: &Triangles,
    far: &[u32],
    parts: Vec<Option<Pieces>>,
    bow_px: f64,
) -> Option<Divided> {
    if parts.iter().all(Option::is_none) {
        return None;
    }
    let mut vertices = made.vertices.clone();
    let mut indices = Vec::with_capacity(far.len());
    let mut starts = Vec::with_capacity(parts.len() + 1);
    for (corners, part) in far.chunks_exact(3).zip(parts) {
        starts.push(indices.len() as u32);
        match part {
            None => indices.extend_from_slice(corners),
            Some(part) => {
                let first = vertices.len() as u32;
                vertices.extend(part.vertices);
                indices.extend(part.indices.iter().map(|index| first + index));
            }
        }
    }
    starts.push(indices.len() as u32);
    Some(Divided {
        vertices,
        indices,
        starts,
        bow_px,
    })
}

/// What one triangle became: vertices of its own, all with its normal and object.
#[derive(Debug, Default)]
struct Pieces {
    vertices: Vec<Vertex>,
    indices: Vec<u32>,
}

struct Divider<'a> {
    sight: &'a Sight,
    band: WaterBand,
    bow_px: f64,
    budget: usize,
    made: AtomicUsize,
}

impl Divider<'_> {
    /// The pieces of a triangle; none where it stays whole.
    fn triangle(&self, made: &Triangles, seen: &[Sighted], corners: &[u32]) -> Option<Pieces> {
        let [a, b, c] = [corners[0], corners[1], corners[2]].map(|i| i as usize);
        let z = [a, b, c].map(|i| made.vertices[i].position[2]);
        if !self.crosses(z)
            && !self.torn(z)
            && ![(a, b), (b, c), (c, a)]
                .iter()
                .any(|&(i, j)| self.bows(&seen[i], &seen[j]))
        {
            self.made.fetch_add(1, Ordering::Relaxed);
            return None;
        }
        // The first vertex carries what belongs to the triangle.
        let of = made.vertices[a];
        let mut workshop = Workshop {
            divider: self,
            vertices: Vec::new(),
            seen: Vec::new(),
            middles: HashMap::new(),
            indices: Vec::new(),
        };
        for i in [a, b, c] {
            workshop.vertices.push(Vertex {
                geometric_normal: of.geometric_normal,
                object: of.object,
                ..made.vertices[i]
            });
            workshop.seen.push(seen[i]);
        }
        workshop.cut_and_divide();
        Some(Pieces {
            vertices: workshop.vertices,
            indices: workshop.indices,
        })
    }

    fn crosses(&self, z: [f32; 3]) -> bool {
        let level = self.sight.level();
        z.iter().any(|&z| z < level) && z.iter().any(|&z| z > level)
    }

    /// Whether a triangle that stands on the plane would be drawn torn: to an eye below, what lies in
    /// the plane appears in it, but what stands beyond the critical distance, however little above it,
    /// at the rim of Snell's window. What is drawn between the two is no higher than nothing.
    fn torn(&self, z: [f32; 3]) -> bool {
        let level = self.sight.level();
        !self.sight.eye_above() && z.contains(&level) && z.iter().any(|&z| z > level)
    }

    fn bows(&self, a: &Sighted, b: &Sighted) -> bool {
        let px = self.bow_px;
        px.is_finite() && self.sight.bow_bound(a, b) > px && self.sight.bow(a, b) > px
    }

    fn exhausted(&self) -> bool {
        self.bow_px.is_finite() && self.made.load(Ordering::Relaxed) > self.budget
    }
}

/// One triangle on its way into pieces.
struct Workshop<'a> {
    divider: &'a Divider<'a>,
    vertices: Vec<Vertex>,
    seen: Vec<Sighted>,
    /// Of edges that were looked at, by their ends: the vertex in the middle, if they are divided.
    middles: HashMap<[u32; 2], Option<u32>>,
    indices: Vec<u32>,
}

impl Workshop<'_> {
    fn cut_and_divide(&mut self) {
        let mut waiting: Vec<([u32; 3], u32)> = Vec::new();
        let mut lifted = HashMap::new();
        for piece in self.cut() {
            let piece = self.lifted(piece, &mut lifted);
            let z = piece.map(|i| self.vertices[i as usize].position[2]);
            if self.divider.band.is_far(z, self.divider.sight.eye_above()) {
                waiting.push((piece, 0));
            }
        }
        while let Some((corners, depth)) = waiting.pop() {
            if self.divider.exhausted() {
                return;
            }
            let [a, b, c] = corners;
            let middles = if depth < DEPTH {
                [(a, b), (b, c), (c, a)].map(|(i, j)| self.middle(i, j))
            } else {
                [None; 3]
            };
            if middles == [None; 3] {
                self.indices.extend(corners);
                self.divider.made.fetch_add(1, Ordering::Relaxed);
            } else {
                let pieces = self.divided(corners, middles);
                waiting.extend(pieces.into_iter().map(|piece| (piece, depth + 1)));
            }
        }
    }

    /// The same with its feet a little above the plane, where it would be drawn torn.
    fn lifted(&mut self, piece: [u32; 3], known: &mut HashMap<u32, u32>) -> [u32; 3] {
        let level = self.divider.sight.level();
        let z = piece.map(|i| self.vertices[i as usize].position[2]);
        if !self.divider.torn(z) {
            return piece;
        }
        piece.map(|i| {
            let vertex = self.vertices[i as usize];
            let [x, y, z] = vertex.position;
            if z != level {
                return i;
            }
            *known.entry(i).or_insert_with(|| {
                let position = [x, y, level + LIFT * level.abs().max(1.0)];
                self.push(Vertex { position, ..vertex })
            })
        })
    }

    /// The first three vertices as a triangle, cut at the rest plane: wholly on one side each.
    fn cut(&mut self) -> Vec<[u32; 3]> {
        let z = [0, 1, 2].map(|i| self.vertices[i].position[2]);
        if !self.divider.crosses(z) {
            return vec![[0, 1, 2]];
        }
        let level = self.divider.sight.level();
        let height = z.map(|z| z.partial_cmp(&level).map_or(0, |order| order as i8));
        // Around the triangle, with the points where it passes through the plane.
        let mut sides: [Vec<u32>; 2] = Default::default();
        for i in 0..3 {
            let j = (i + 1) % 3;
            if height[i] <= 0 {
                sides[0].push(i as u32);
            }
            if height[i] >= 0 {
                sides[1].push(i as u32);
            }
            if height[i] * height[j] < 0 {
                let crossing = self.crossing(i, j);
                for side in &mut sides {
                    side.push(crossing);
                }
            }
        }
        let fan = |side: &Vec<u32>| -> Vec<[u32; 3]> {
            match side[..] {
                [a, b, c] => vec![[a, b, c]],
                [a, b, c, d] => self.halves([a, b, c, d]).to_vec(),
                _ => Vec::new(),
            }
        };
        sides
            .iter()
            .flat_map(fan)
            .filter(|piece| !self.is_line(*piece))
            .collect()
    }

    /// The vertex where an edge passes through the rest plane, exactly at its height.
    fn crossing(&mut self, i: usize, j: usize) -> u32 {
        let level = self.divider.sight.level();
        let (low, high) = if self.vertices[i].position[2] < level {
            (i, j)
        } else {
            (j, i)
        };
        let [low, high] = [low, high].map(|i| self.vertices[i]);
        let (from, to) = (wide(low.position), wide(high.position));
        let part = (f64::from(level) - from.z) / (to.z - from.z);
        let at = ((1.0 - part) * from + part * to).as_vec3();
        let normal = (1.0 - part) * wide(low.normal) + part * wide(high.normal);
        self.push(Vertex {
            position: [at.x, at.y, level],
            normal: normal.as_vec3().to_array(),
            ..low
        })
    }

    /// The vertex that divides an edge, made if it was not; none if the edge stays.
    fn middle(&mut self, i: u32, j: u32) -> Option<u32> {
        let key = [i.min(j), i.max(j)];
        if let Some(&known) = self.middles.get(&key) {
            return known;
        }
        let middle = self.new_middle(i as usize, j as usize);
        self.middles.insert(key, middle);
        middle
    }

    fn new_middle(&mut self, i: usize, j: usize) -> Option<u32> {
        if !self.divider.bows(&self.seen[i], &self.seen[j]) {
            return None;
        }
        let (a, b) = (self.vertices[i], self.vertices[j]);
        // Halved first, so that the sum of large numbers is finite. Normals are not made unit
        // vectors: between the pieces' corners they are thus what they were in the whole.
        let half =
            |a: [f32; 3], b: [f32; 3]| (0.5 * Vec3::from(a) + 0.5 * Vec3::from(b)).to_array();
        let position = half(a.position, b.position);
        // Too short an edge for single precision to divide.
        if position == a.position || position == b.position {
            return None;
        }
        let normal = half(a.normal, b.normal);
        Some(self.push(Vertex {
            position,
            normal,
            ..a
        }))
    }

    fn push(&mut self, vertex: Vertex) -> u32 {
        self.seen
            .push(self.divider.sight.sighted(wide(vertex.position)));
        self.vertices.push(vertex);
        (self.vertices.len() - 1) as u32
    }

    /// A triangle cut at the middles of some edges, of which the first follows the first corner.
    fn divided(&self, [a, b, c]: [u32; 3], middles: [Option<u32>; 3]) -> Vec<[u32; 3]> {
        match middles {
            [Some(ab), Some(bc), Some(ca)] => {
                vec![[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            }
            [Some(ab), None, None] => vec![[a, ab, c], [ab, b, c]],
            [Some(ab), Some(bc), None] => {
                let [first, second] = self.halves([a, ab, bc, c]);
                vec![[ab, b, bc], first, second]
            }
            [None, None, None] => vec![[a, b, c]],
            [first, second, third] => self.divided([b, c, a], [second, third, first]),
        }
    }

    /// A convex quadrilateral cut along its shorter diagonal.
    fn halves(&self, [a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
        let at = |i: u32| self.seen[i as usize].world;
        if at(a).distance_squared(at(c)) <= at(b).distance_squared(at(d)) {
            [[a, b, c], [a, c, d]]
        } else {
            [[a, b, d], [b, c, d]]
        }
    }

    /// Whether two corners are one: rounding may put a crossing where a corner stands.
    fn is_line(&self, [a, b, c]: [u32; 3]) -> bool {
        let at = |i: u32| self.vertices[i as usize].position;
        at(a) == at(b) || at(b) == at(c) || at(c) == at(a)
    }
}

fn wide(v: [f32; 3]) -> DVec3 {
    Vec3::from(v).as_dvec3()
}

#[cfg(test)]
#[path = "subdivide_tests.rs"]
mod tests;
