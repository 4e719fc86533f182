//! Triangles as the GPU is given them: attributes of the triangle on its first vertex, and the
//! triangles in an order in which each side of the water is one range.

use std::collections::HashMap;
use std::ops::Range;

use glam::Vec3;
use meniscus_pipeline::Geometry;
use meniscus_scene::{Cluster, Clusters, Mesh, WaterBand};

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

/// Vertices and indices of a scene.
#[derive(Debug, Default)]
pub(crate) struct Triangles {
    /// In the order in which the indices first name them.
    pub vertices: Vec<Vertex>,
    pub indices: Vec<u32>,
    /// The triangles' order, and runs of them.
    pub clusters: Clusters,
}

impl Triangles {
    /// Orders the triangles by their side and so that neighbours follow each other, which lets
    /// adapters transform vertices that they share once, and gives each a first vertex of its own
    /// where its attributes differ from those that the vertex already carries.
    ///
    /// # Errors
    /// When an index is out of range or a position is not finite.
    pub fn new(mesh: &Mesh, band: WaterBand) -> Result<Self, GpuError> {
        for (number, triangle) in mesh.triangles.iter().enumerate() {
            let corners = triangle.corners.map(|c| mesh.positions.get(c as usize));
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
        }
        let clusters = Clusters::new(mesh, band);
        let mut builder = Builder::new(mesh);
        let order = clusters.order.iter();
        let mut indices: Vec<u32> = order
            .flat_map(|&number| builder.triangle(number as usize))
            .collect();
        if indices.len() > u32::MAX as usize || builder.vertices.len() > u32::MAX as usize {
            return Err(GpuError::Size(format!(
                "{} triangles are too many",
                mesh.triangles.len()
            )));
        }
        Ok(Self {
            vertices: renumbered(&builder.vertices, &mut indices),
            indices,
            clusters,
        })
    }

    /// Where the indices of triangles stand that are drawn for an eye above the water or below.
    pub fn range(&self, geometry: Geometry, eye_above: bool) -> Range<u32> {
        let (above, below) = (&self.clusters.above, &self.clusters.below);
        let triangles = match (geometry, eye_above) {
            (Geometry::All, _) => above.start..below.end,
            (Geometry::NearSide, true) | (Geometry::FarSide, false) => above.clone(),
            (Geometry::NearSide, false) | (Geometry::FarSide, true) => below.clone(),
        };
        3 * triangles.start..3 * triangles.end
    }

    /// The clusters of a range of indices that ends where clusters do.
    pub fn clusters_of(&self, range: &Range<u32>) -> &[Cluster] {
        let all = &self.clusters.clusters;
        let first = all.partition_point(|c| 3 * c.triangles.start < range.start);
        let end = all.partition_point(|c| 3 * c.triangles.end <= range.end);
        all.get(first..end).unwrap_or_default()
    }
}

/// The vertices that indices name, in the order in which they first do.
fn renumbered(vertices: &[Vertex], indices: &mut [u32]) -> Vec<Vertex> {
    let mut places = vec![u32::MAX; vertices.len()];
    let mut used = Vec::with_capacity(vertices.len());
    for index in indices {
        let old = *index as usize;
        if places[old] == u32::MAX {
            places[old] = used.len() as u32;
            used.push(vertices[old]);
        }
        *index = places[old];
    }
    used
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
pub(crate) fn finite(direction: Vec3) -> Vec3 {
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

    fn flat() -> WaterBand {
        WaterBand::about(0.0, 0.0)
    }

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
        let made = Triangles::new(&mesh, flat()).unwrap();
        for (indices, &number) in made.indices.chunks(3).zip(&made.clusters.order) {
            let triangle = &mesh.triangles[number as usize];
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
        assert_eq!(Triangles::new(&cone(9), flat()).unwrap().vertices.len(), 10);
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
        assert_eq!(Triangles::new(&fourfold, flat()).unwrap().vertices.len(), 4);
        let same = mesh(&square, &[([0, 1, 2], 0), ([1, 2, 0], 0), ([2, 0, 1], 0)]);
        assert_eq!(Triangles::new(&same, flat()).unwrap().vertices.len(), 3);
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
            let made = Triangles::new(&mesh, WaterBand::about(0.0, margin)).unwrap();
            let side = |geometry| made.range(geometry, true);
            let (near, far) = (side(Geometry::NearSide), side(Geometry::FarSide));
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
            assert_eq!(sorted(objects(&near)), sorted(above), "margin {margin}");
            assert_eq!(sorted(objects(&far)), sorted(below), "margin {margin}");
            assert_eq!(near.start, 0);
            assert_eq!(far.end, 3 * heights.len() as u32);
            assert!(far.start <= near.end);
            assert_eq!(side(Geometry::All), near.start..far.end);
            let clusters = made.clusters_of(&far);
            let first = clusters.first().map(|c| 3 * c.triangles.start);
            assert_eq!(first, Some(far.start));
        }
    }

    #[test]
    fn a_mesh_that_cannot_be_drawn_is_an_error() {
        let good = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
        let error = Triangles::new(&mesh(&good, &[([0, 1, 3], 0)]), flat()).unwrap_err();
        assert!(error.to_string().contains("vertex 3 of 3"), "{error}");
        let bad = [[0.0, f32::NAN, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
        let error = Triangles::new(&mesh(&bad, &[([0, 1, 2], 0)]), flat()).unwrap_err();
        assert!(error.to_string().contains("not finite"), "{error}");
        assert!(
            Triangles::new(&Mesh::default(), flat())
                .unwrap()
                .indices
                .is_empty()
        );
    }
}
