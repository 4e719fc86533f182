//! Questions about a scene's triangles.

use glam::DVec3;

use crate::{Mesh, Scene};

impl Mesh {
    /// The corners of a triangle, metres.
    ///
    /// # Panics
    /// When there is no such triangle.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle]
            .corners
            .map(|corner| self.positions[corner as usize].as_dvec3())
    }

    /// The smallest box about all corners of triangles, low and high corner; none without
    /// triangles.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        (0..self.triangles.len())
            .flat_map(|triangle| self.corners(triangle))
            .map(|corner| (corner, corner))
            .reduce(|(low, high), (a, b)| (low.min(a), high.max(b)))
    }
}

/// How a scene's triangles lie to the rest plane of its water.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Sides {
    /// No corner lies under the plane.
    pub above: usize,
    /// No corner lies above the plane, and at least one under it.
    pub below: usize,
    /// Corners on both sides.
    pub across: usize,
}

impl Scene {
    /// The smallest box about all triangles, low and high corner.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        self.mesh.bounds()
    }

    /// How many triangles lie on which side of the rest plane.
    pub fn sides(&self) -> Sides {
        let mut sides = Sides::default();
        for triangle in 0..self.mesh.triangles.len() {
            let corners = self.mesh.corners(triangle);
            let below = corners.iter().any(|corner| corner.z < self.water.level);
            let above = corners.iter().any(|corner| corner.z > self.water.level);
            match (above, below) {
                (true, true) => sides.across += 1,
                (false, true) => sides.below += 1,
                (_, false) => sides.above += 1,
            }
        }
        sides
    }

    /// How many triangles an object has.
    pub fn triangles_of(&self, object: u32) -> usize {
        self.mesh
            .triangles
            .iter()
            .filter(|t| t.object == object)
            .count()
    }
}
