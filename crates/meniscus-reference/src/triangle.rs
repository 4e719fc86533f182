//! A ray–triangle test that does not leak between neighbours.

use glam::DVec3;

/// A ray made ready for many tests.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ray {
    pub(crate) origin: DVec3,
    /// 1 / direction; finite.
    pub(crate) inverse: DVec3,
    /// The axis that the direction is longest along, last; the two others in an order that keeps
    /// the orientation of triangles.
    axes: [usize; 3],
    shear: DVec3,
}

/// Where a ray meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Meeting {
    /// Along the ray, in units of its direction.
    pub(crate) t: f64,
    /// Barycentric weights of the corners.
    pub(crate) weights: DVec3,
}

impl Ray {
    pub(crate) fn new(origin: DVec3, direction: DVec3) -> Self {
        let size = direction.abs();
        let z = if size.x > size.y && size.x > size.z {
            0
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if direction[z] < 0.0 {
            (x, y) = (y, x);
        }
        Self {
            origin,
            inverse: DVec3::from_array(direction.to_array().map(|d| {
                if d.abs() < 1e-300 {
                    1e300_f64.copysign(d)
                } else {
                    1.0 / d
                }
            })),
            axes: [x, y, z],
            shear: DVec3::new(direction[x], direction[y], 1.0) / direction[z],
        }
    }

    /// Woop, Benthin, Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013: the triangle
    /// is sheared so that the ray becomes the z axis; signs of the edge functions then agree
    /// between triangles that share an edge. Both faces are hit.
    ///
    /// The paper falls back to more bits where an edge function is 0. Here 0 counts as inside, for
    /// either neighbour: rounding is monotonic, so a sign is never wrong but only lost, and the ray
    /// cannot slip through.
    pub(crate) fn meet(&self, corners: [DVec3; 3]) -> Option<Meeting> {
        let [x, y, z] = self.axes;
        let [a, b, c] = corners.map(|corner| {
            let p = corner - self.origin;
            DVec3::new(
                p[x] - self.shear.x * p[z],
                p[y] - self.shear.y * p[z],
                self.shear.z * p[z],
            )
        });
        let edges = DVec3::new(
            c.x * b.y - c.y * b.x,
            a.x * c.y - a.y * c.x,
            b.x * a.y - b.y * a.x,
        );
        if edges.min_element() < 0.0 && edges.max_element() > 0.0 {
            return None;
        }
        let determinant = edges.element_sum();
        if determinant == 0.0 {
            return None;
        }
        let weights = edges / determinant;
        Some(Meeting {
            t: weights.dot(DVec3::new(a.z, b.z, c.z)),
            weights,
        })
    }
}
