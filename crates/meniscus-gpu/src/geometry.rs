//! Triangles as the GPU is given them: attributes of the triangle on its first vertex, and the
//! triangles in an order in which each side of the water is one range.

use std::collections::HashMap;
use std::ops::Range;

use glam::Vec3;
use meniscus_scene::{Mesh, Scene, WaterGeometry};

use crate::GpuError;

/// One vertex: the host's attributes, interleaved in the order of `host::ATTRIBUTES`.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Vertex {
    pub position: [f32; 3],
    pub normal: [f32; 3],
    /// Of the triangle that begins with this vertex.
    pub geometric_normal: [f32; 3],
    /// Of the triangle that begins with this vertex.
    pub object: u32,
}

impl Vertex {
    /// Format and offset of an attribute by the host's name.
    pub fn attribute(name: &str) -> Option<(wgpu::VertexFormat, u64)> {
        use wgpu::VertexFormat::{Float32x3, Uint32};
        let (format, offset) = match name {
            "position" => (Float32x3, std::mem::offset_of!(Self, position)),
            "normal" => (Float32x3, std::mem::offset_of!(Self, normal)),
            "geometric_normal" => (Float32x3, std::mem::offset_of!(Self, geometric_normal)),
            "object" => (Uint32, std::mem::offset_of!(Self, object)),
            _ => return None,
        };
        Some((format, offset as u64))
    }
}

/// The heights between which the water's surface may lie: what decides on a triangle's side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WaterBand {
    low: f64,
    high: f64,
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

    fn side(&self, z: [f32; 3]) -> Side {
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

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Side {
    Above,
    Both,
    Below,
}

/// Vertices and indices of a scene.
#[derive(Debug, Default)]
pub(crate) struct Triangles {
    pub vertices: Vec<Vertex>,
    pub indices: Vec<u32>,
    /// Indices of triangles with a part above the water's lowest height.
    pub above: Range<u32>,
    /// Indices of triangles with a part below the water's greatest height.
    pub below: Range<u32>,
}

impl Triangles {
    /// Orders the triangles by their side, keeping their order within it, and gives each a first
    /// vertex of its own where its attributes differ from those that the vertex already carries.
    ///
    /// # Errors
    /// When an index is out of range or a position is not finite.
    pub fn new(mesh: &Mesh, band: WaterBand) -> Result<Self, GpuError> {
        let mut sides = Vec::with_capacity(mesh.triangles.len());
        for (number, triangle) in mesh.triangles.iter().enumerate() {
            let corners = triangle
                .corners
                .map(|c| mesh.positions.get(c as usize).copied());
            let [Some(a), Some(b), Some(c)] = corners else {
                return Err(GpuError::Scene(format!(
                    "triangle {number} names vertex {} of {}",
                    triangle.corners.iter().max().unwrap_or(&0),
                    mesh.positions.len()
                )));
            };
            if !(a.is_finite() && b.is_finite() && c.is_finite()) {
                return Err(GpuError::Scene(format!(
                    "a corner of triangle {number} is not finite"
                )));
            }
            sides.push((band.side([a.z, b.z, c.z]), number));
        }
        sides.sort_by_key(|&(side, _)| side);
        let mut builder = Builder::new(mesh);
        let mut indices = Vec::with_capacity(3 * sides.len());
        for &(_, number) in &sides {
            indices.extend(builder.triangle(number));
        }
        if indices.len() > u32::MAX as usize || builder.vertices.len() > u32::MAX as usize {
            return Err(GpuError::Size(format!(
                "{} triangles are too many",
                sides.len()
            )));
        }
        let end_of = |side: Side| 3 * sides.partition_point(|&(s, _)| s <= side) as u32;
        let all = indices.len() as u32;
        Ok(Self {
            above: 0..end_of(Side::Both),
            below: end_of(Side::Above)..all,
            vertices: builder.vertices,
            indices,
        })
    }
}

/// What a triangle's first vertex carries for it: the normal's bits and the object.
type Flat = ([u32; 3], u32);

struct Builder<'a> {
    mesh: &'a Mesh,
    vertices: Vec<Vertex>,
    /// Whether a vertex of the mesh already carries some triangle's attributes.
    taken: Vec<bool>,
    /// Where a vertex of the mesh with these attributes stands.
    carriers: HashMap<(u32, Flat), u32>,
}

impl<'a> Builder<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        let vertex = |(i, position): (usize, &Vec3)| Vertex {
            position: position.to_array(),
            normal: finite(mesh.normals.get(i).copied().unwrap_or(Vec3::Z)).to_array(),
            geometric_normal: [0.0; 3],
            object: 0,
        };
        Self {
            mesh,
            vertices: mesh.positions.iter().enumerate().map(vertex).collect(),
            taken: vec![false; mesh.positions.len()],
            carriers: HashMap::new(),
        }
    }

    /// The three indices of a triangle, turned so that the first vertex carries its attributes.
    fn triangle(&mut self, number: usize) -> [u32; 3] {
        let triangle = self.mesh.triangles[number];
        let [a, b, c] = triangle.corners;
        let corner = |i: u32| self.mesh.positions[i as usize].as_dvec3();
        let edges = (corner(b) - corner(a)).cross(corner(c) - corner(a));
        let normal = finite(edges.normalize_or_zero().as_vec3());
        let flat: Flat = (normal.to_array().map(f32::to_bits), triangle.object);
        let turns = [[a, b, c], [b, c, a], [c, a, b]];
        for [first, second, third] in turns {
            if let Some(&carrier) = self.carriers.get(&(first, flat)) {
                return [carrier, second, third];
            }
        }
        let free = turns.into_iter().find(|turn| !self.taken[turn[0] as usize]);
        let [first, second, third] = free.unwrap_or([a, b, c]);
        let carrier = if free.is_some() {
            self.taken[first as usize] = true;
            first
        } else {
            self.vertices.push(self.vertices[first as usize]);
            (self.vertices.len() - 1) as u32
        };
        let vertex = &mut self.vertices[carrier as usize];
        vertex.geometric_normal = normal.to_array();
        vertex.object = triangle.object;
        self.carriers.insert((first, flat), carrier);
        [carrier, second, third]
    }
}

/// A direction that is not finite tells nothing; up is as good as any.
fn finite(direction: Vec3) -> Vec3 {
    if direction.is_finite() {
        direction
    } else {
        Vec3::Z
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use meniscus_scene::Triangle;

    const FLAT: WaterBand = WaterBand {
        low: 0.0,
        high: 0.0,
    };

    fn mesh(positions: &[[f32; 3]], triangles: &[([u32; 3], u32)]) -> Mesh {
        Mesh {
            positions: positions.iter().map(|&p| p.into()).collect(),
            normals: vec![Vec3::Z; positions.len()],
            triangles: triangles
                .iter()
                .map(|&(corners, object)| Triangle { corners, object })
                .collect(),
        }
    }

    /// A closed fan of triangles around an apex, no two coplanar, each an object of its own.
    fn cone(sides: u32) -> Mesh {
        let rim = (0..sides).map(|i| {
            let angle = std::f32::consts::TAU * i as f32 / sides as f32;
            [angle.cos(), angle.sin(), -0.5]
        });
        let positions: Vec<[f32; 3]> = std::iter::once([0.0, 0.0, 1.0]).chain(rim).collect();
        let fan: Vec<_> = (0..sides)
            .map(|i| ([0, 1 + i, 1 + (i + 1) % sides], i))
            .collect();
        mesh(&positions, &fan)
    }

    #[test]
    fn every_triangle_begins_with_its_own_attributes_and_keeps_its_corners() {
        let mesh = cone(9);
        let made = Triangles::new(&mesh, FLAT).unwrap();
        for (indices, triangle) in made.indices.chunks(3).zip(&mesh.triangles) {
            let corners: Vec<Vec3> = indices
                .iter()
                .map(|&i| made.vertices[i as usize].position.into())
                .collect();
            let expected = triangle.corners.map(|c| mesh.positions[c as usize]);
            let turn = corners.iter().position(|&c| c == expected[0]).unwrap();
            for i in 0..3 {
                assert_eq!(corners[(turn + i) % 3], expected[i], "winding");
            }
            let first = made.vertices[indices[0] as usize];
            assert_eq!(first.object, triangle.object);
            let normal = (corners[1] - corners[0])
                .cross(corners[2] - corners[0])
                .normalize();
            assert!(normal.distance(first.geometric_normal.into()) < 1e-6);
        }
    }

    #[test]
    fn vertices_are_doubled_only_where_needed() {
        // Nine triangles, ten vertices: each can begin with a vertex of its own.
        assert_eq!(Triangles::new(&cone(9), FLAT).unwrap().vertices.len(), 10);
        // A coplanar square of one object shares; two objects on one triangle's corners cannot.
        let square = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
        let fourfold = mesh(
            &square,
            &[
                ([0, 1, 2], 0),
                ([0, 1, 2], 1),
                ([0, 1, 2], 2),
                ([0, 1, 2], 3),
            ],
        );
        assert_eq!(Triangles::new(&fourfold, FLAT).unwrap().vertices.len(), 4);
        let same = mesh(&square, &[([0, 1, 2], 0), ([1, 2, 0], 0), ([2, 0, 1], 0)]);
        assert_eq!(Triangles::new(&same, FLAT).unwrap().vertices.len(), 3);
    }

    #[test]
    fn a_crossing_triangle_is_on_both_sides_and_every_triangle_on_one() {
        let heights = [
            [1.0, 2.0, 3.0],
            [-1.0, -2.0, -3.0],
            [-1.0, 1.0, 2.0],
            [0.0; 3],
            [0.0, 0.0, -1.0],
        ];
        let positions: Vec<[f32; 3]> = heights
            .iter()
            .enumerate()
            .flat_map(|(i, z)| {
                [
                    [0.0, 0.0, z[0]],
                    [1.0, i as f32, z[1]],
                    [0.0, 1.0 + i as f32, z[2]],
                ]
            })
            .collect();
        let all: Vec<_> = (0..heights.len() as u32)
            .map(|i| ([3 * i, 3 * i + 1, 3 * i + 2], i))
            .collect();
        let mesh = mesh(&positions, &all);
        for (margin, above, below) in [
            (0.0, vec![0, 3, 2], vec![2, 1, 4]),
            (1.5, vec![2, 3, 4, 0, 1], vec![2, 3, 4, 0, 1]),
        ] {
            let made = Triangles::new(
                &mesh,
                WaterBand {
                    low: -margin,
                    high: margin,
                },
            )
            .unwrap();
            let objects = |range: &Range<u32>| -> Vec<u32> {
                made.indices[range.start as usize..range.end as usize]
                    .chunks(3)
                    .map(|t| made.vertices[t[0] as usize].object)
                    .collect()
            };
            let sorted = |mut v: Vec<u32>| {
                v.sort_unstable();
                v
            };
            assert_eq!(
                sorted(objects(&made.above)),
                sorted(above),
                "margin {margin}"
            );
            assert_eq!(
                sorted(objects(&made.below)),
                sorted(below),
                "margin {margin}"
            );
            assert_eq!(made.above.start, 0);
            assert_eq!(made.below.end, 3 * heights.len() as u32);
            assert!(made.below.start <= made.above.end);
        }
    }

    #[test]
    fn a_mesh_that_cannot_be_drawn_is_an_error() {
        let good = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
        let error = Triangles::new(&mesh(&good, &[([0, 1, 3], 0)]), FLAT).unwrap_err();
        assert!(error.to_string().contains("vertex 3 of 3"), "{error}");
        let bad = [[0.0, f32::NAN, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
        let error = Triangles::new(&mesh(&bad, &[([0, 1, 2], 0)]), FLAT).unwrap_err();
        assert!(error.to_string().contains("not finite"), "{error}");
        assert!(
            Triangles::new(&Mesh::default(), FLAT)
                .unwrap()
                .indices
                .is_empty()
        );
    }
}
