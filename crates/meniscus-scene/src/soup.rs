//! Meshes on their way into a scene.

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DVec3};

use crate::motion::rounded;
use crate::shapes::Patch;
use crate::{Mesh, Triangle};

/// Larger scenes are refused: beyond this, indices and buffers no longer fit what adapters allow.
pub(crate) const MOST_TRIANGLES: u64 = 64_000_000 / 3;

/// Triangles of one object in its own space; normals may be missing.
#[derive(Debug, Clone, Default)]
pub(crate) struct Soup {
    /// Finite positions.
    pub positions: Vec<DVec3>,
    /// One a position, of any length; empty if there are none. A zero is to be computed.
    pub normals: Vec<DVec3>,
    /// Indices in range, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Soup {
    /// The vertices of grids.
    pub fn from_patches(patches: &[Patch]) -> Self {
        let mut soup = Self::default();
        for patch in patches {
            let columns = patch.columns + usize::from(!patch.closed.0);
            let rows = patch.rows + usize::from(!patch.closed.1);
            let first = soup.positions.len();
            for j in 0..rows {
                for i in 0..columns {
                    let (position, normal) = (patch.vertex)(i, j);
                    soup.positions.push(position);
                    soup.normals.push(normal);
                }
            }
            let index = |i: usize, j: usize| (first + (j % rows) * columns + i % columns) as u32;
            for j in 0..patch.rows {
                for i in 0..patch.columns {
                    let (a, b) = (index(i, j), index(i + 1, j));
                    let (c, d) = (index(i + 1, j + 1), index(i, j + 1));
                    soup.triangles.push([a, b, c]);
                    soup.triangles.push([a, c, d]);
                }
            }
        }
        soup
    }

    /// Gives every vertex without a normal the mean of the faces that share its position,
    /// weighted by their angle there (Thürmer and Wüthrich 1998).
    pub fn smooth(&mut self) {
        self.normals.resize(self.positions.len(), DVec3::ZERO);
        if !self.normals.contains(&DVec3::ZERO) {
            return;
        }
        let key = |p: DVec3| (p + 0.0).to_array().map(f64::to_bits);
        let mut sums: HashMap<[u64; 3], DVec3> = HashMap::new();
        for corners in &self.triangles {
            let at = corners.map(|c| self.positions[c as usize]);
            let face = (at[1] - at[0]).cross(at[2] - at[0]).normalize_or_zero();
            for k in 0..3 {
                let (p, q) = (at[(k + 1) % 3] - at[k], at[(k + 2) % 3] - at[k]);
                let angle = p.cross(q).length().atan2(p.dot(q));
                *sums.entry(key(at[k])).or_default() += face * angle;
            }
        }
        for (normal, &position) in self.normals.iter_mut().zip(&self.positions) {
            if *normal == DVec3::ZERO {
                *normal = sums.get(&key(position)).copied().unwrap_or_default();
            }
        }
    }

    /// Gives every triangle vertices of its own, with its geometric normal.
    pub fn facet(&mut self) {
        let old = std::mem::take(self);
        for corners in old.triangles {
            let at = corners.map(|c| old.positions[c as usize]);
            let first = self.positions.len() as u32;
            self.positions.extend(at);
            self.normals
                .extend([(at[1] - at[0]).cross(at[2] - at[0]); 3]);
            self.triangles.push([first, first + 1, first + 2]);
        }
    }

    /// Positions and unit normals in the world.
    pub fn placed(&self, place: DAffine3) -> impl Iterator<Item = (DVec3, DVec3)> {
        let normal_matrix = normal_matrix(place.matrix3);
        self.positions.iter().enumerate().map(move |(index, &at)| {
            let normal = self.normals.get(index).copied().unwrap_or(DVec3::Z);
            let normal = (normal_matrix * normal).normalize_or(DVec3::Z);
            (place.transform_point3(at), normal)
        })
    }

    /// Adds this to a scene's mesh and returns how many triangles were added: degenerate ones are
    /// left out. Points within rounding of the water's level are put onto it.
    pub fn append(&self, to: &mut Mesh, place: DAffine3, level: f64, object: u32) -> usize {
        let first = to.positions.len() as u32;
        for (position, normal) in self.placed(place) {
            to.positions.push(rounded(position, level));
            to.normals.push(normal.as_vec3().normalize());
        }
        let before = to.triangles.len();
        for corners in &self.triangles {
            let corners = corners.map(|c| first + c);
            let at = corners.map(|c| to.positions[c as usize].as_dvec3());
            if is_proper(at) {
                to.triangles.push(Triangle { corners, object });
            }
        }
        to.triangles.len() - before
    }
}

/// What turns normals when `matrix` moves points, up to a factor: the matrix of cofactors.
fn normal_matrix(matrix: DMat3) -> DMat3 {
    DMat3::from_cols(
        matrix.y_axis.cross(matrix.z_axis),
        matrix.z_axis.cross(matrix.x_axis),
        matrix.x_axis.cross(matrix.y_axis),
    )
}

/// Whether a triangle has an area that f32 corners can tell from none.
pub(crate) fn is_proper(at: [DVec3; 3]) -> bool {
    let (p, q, r) = (at[1] - at[0], at[2] - at[0], at[2] - at[1]);
    let longest = p
        .length_squared()
        .max(q.length_squared())
        .max(r.length_squared());
    let area = p.cross(q).length();
    area.is_finite() && area > 1e-9 * longest
}
