//! The eye, and the views drawn from it.

use glam::{DVec2, DVec3, UVec2};

/// A pinhole camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// World space, metres.
    pub eye: DVec3,
    /// The point looked at; differs from `eye`.
    pub target: DVec3,
    /// Vertical field of view of the frame, radians.
    pub field_of_view: f64,
    /// Distance of the near plane along the view direction, metres. There is no far plane.
    pub near: f64,
}

/// A camera with a picture size: what maps pixels to rays.
///
/// Pixel centres stand at half integers, y runs down. A guarded view is concentric with its frame
/// and has the same focal length; only its size differs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// World space, metres.
    pub eye: DVec3,
    /// Unit vector to the right of the picture.
    pub right: DVec3,
    /// Unit vector to its top.
    pub up: DVec3,
    /// Unit vector into the picture.
    pub forward: DVec3,
    /// Focal length, pixels.
    pub focal: f64,
    /// Width and height, pixels.
    pub size: UVec2,
    /// Distance of the near plane, metres.
    pub near: f64,
}

impl Camera {
    /// The view of a frame of this size.
    pub fn view(&self, size: UVec2) -> View {
        let forward = (self.target - self.eye).normalize_or(DVec3::Y);
        // Looking straight up or down, the picture's top points along +y.
        let right = forward.cross(DVec3::Z).normalize_or(DVec3::X);
        View {
            eye: self.eye,
            right,
            up: right.cross(forward),
            forward,
            focal: 0.5 * f64::from(size.y) / (0.5 * self.field_of_view).tan(),
            size,
            near: self.near,
        }
    }
}

impl View {
    /// The same view with `guard` more pixels on every side.
    #[must_use]
    pub fn guarded(&self, guard: UVec2) -> Self {
        Self {
            size: self.size + 2 * guard,
            ..*self
        }
    }

    /// Unit direction of the ray through a point of the picture, in pixels.
    pub fn direction(&self, pixel: DVec2) -> DVec3 {
        let centred = pixel - 0.5 * self.size.as_dvec2();
        (self.forward * self.focal + self.right * centred.x - self.up * centred.y).normalize()
    }

    /// Where a world point stands in the picture, in pixels; none behind the eye.
    pub fn project(&self, point: DVec3) -> Option<DVec2> {
        let offset = point - self.eye;
        let depth = offset.dot(self.forward);
        (depth > 0.0).then(|| {
            let scale = self.focal / depth;
            0.5 * self.size.as_dvec2()
                + DVec2::new(offset.dot(self.right), -offset.dot(self.up)) * scale
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projection_inverts_the_ray_through_a_pixel() {
        for target in [DVec3::new(3.0, 2.0, -1.0), DVec3::new(0.5, -1.0, -9.0)] {
            let camera = Camera {
                eye: DVec3::new(0.5, -1.0, 1.7),
                target,
                field_of_view: 0.9,
                near: 0.05,
            };
            let view = camera.view(UVec2::new(640, 360));
            for guard in [0, 24] {
                let view = view.guarded(UVec2::splat(guard));
                for pixel in [DVec2::new(0.5, 0.5), DVec2::new(333.25, 12.0)] {
                    let point = view.eye + 7.3 * view.direction(pixel);
                    assert!((view.project(point).unwrap() - pixel).length() < 1e-9);
                }
            }
        }
    }
}
