//! Triangles, as seen from the voxels of a distance field.

use std::collections::HashMap;

use glam::Vec3;
use meniscus_scene::Mesh;

/// A triangle of some area.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    pub corners: [Vec3; 3],
    /// Unit.
    pub normal: Vec3,
    pub object: u32,
    /// Whether the edge from this corner to the next belongs to no other triangle.
    rim: [bool; 3],
}

/// A position that equal ones share; −0 is 0.
fn key(corner: Vec3) -> [u32; 3] {
    (corner + 0.0).to_array().map(f32::to_bits)
}

/// Where a face is nearest to a point.
pub(super) struct Nearest {
    pub squared: f32,
    pub offset: Vec3,
    /// On an edge that no other triangle shares.
    pub on_rim: bool,
}

impl Face {
    /// The triangles of a mesh that have an area.
    pub fn all(mesh: &Mesh) -> Vec<Self> {
        let mut faces = Vec::with_capacity(mesh.triangles.len());
        for triangle in &mesh.triangles {
            let corners = triangle.corners.map(|c| mesh.positions[c as usize]);
            let [a, b, c] = corners.map(|corner| corner.as_dvec3());
            let normal = (b - a).cross(c - a).as_vec3().try_normalize();
            faces.extend(normal.map(|normal| Self {
                corners,
                normal,
                object: triangle.object,
                rim: [false; 3],
            }));
        }
        let mut edges = HashMap::<_, u32>::new();
        let edge = |face: &Self, i: usize| {
            let (a, b) = (key(face.corners[i]), key(face.corners[(i + 1) % 3]));
            (a.min(b), a.max(b))
        };
        for face in &faces {
            for i in 0..3 {
                *edges.entry(edge(face, i)).or_default() += 1;
            }
        }
        for face in &mut faces {
            face.rim = std::array::from_fn(|i| edges[&edge(face, i)] == 1);
        }
        faces
    }

    /// Where it is nearest to a point.
    pub fn nearest(&self, point: Vec3) -> Nearest {
        let height = self.normal.dot(point - self.corners[0]);
        let foot = point - height * self.normal;
        let mut inside = true;
        let mut best = Nearest {
            squared: f32::INFINITY,
            offset: Vec3::ZERO,
            on_rim: false,
        };
        for i in 0..3 {
            let (a, b) = (self.corners[i], self.corners[(i + 1) % 3]);
            let along = b - a;
            inside &= self.normal.dot(along.cross(foot - a)) >= 0.0;
            let part = (point - a).dot(along) / along.length_squared().max(f32::MIN_POSITIVE);
            let offset = point - (a + part.clamp(0.0, 1.0) * along);
            let squared = offset.length_squared();
            if squared < best.squared {
                best = Nearest {
                    squared,
                    offset,
                    on_rim: self.rim[i],
                };
            }
        }
        if inside {
            best = Nearest {
                squared: height * height,
                offset: height * self.normal,
                on_rim: false,
            };
        }
        best
    }
}
