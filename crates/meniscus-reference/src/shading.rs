//! How a surface looks: Lambert's law under a sun and an ambient dome, without shadows.

use glam::DVec3;
use meniscus_scene::{Material, Pattern, Scene, Sky};

use crate::path::Hit;

/// Linear RGB of a point that a ray meets in this (unit) direction.
///
/// albedo · (sun · max(n · s, 0) + ambient · (½ + ½ n.z)), both sides of a surface being lit: n is
/// turned to the side that the ray comes from.
pub(crate) fn shade(scene: &Scene, hit: &Hit, direction: DVec3) -> DVec3 {
    let object = &scene.objects[hit.object as usize];
    let material = &scene.materials[object.material as usize];
    let facing = if hit.geometric_normal.dot(direction) > 0.0 {
        -1.0
    } else {
        1.0
    };
    let normal = facing * hit.shading_normal;
    let sun = normal.dot(scene.sun.direction).max(0.0) * scene.sun.colour.as_dvec3();
    let ambient = (0.5 + 0.5 * normal.z) * scene.sun.ambient.as_dvec3();
    albedo(material, hit.point, hit.geometric_normal) * (sun + ambient)
}

/// The material's colour at a point, its pattern included.
fn albedo(material: &Material, point: DVec3, geometric_normal: DVec3) -> DVec3 {
    let colour = match material.pattern {
        Pattern::Plain => material.colour,
        Pattern::Tiles {
            size,
            line,
            offset,
            line_colour,
        } => {
            let size = f64::from(size);
            let share = f64::from(line) / size;
            let on_line = |at: f64| {
                let tiles = (at + f64::from(offset)) / size;
                tiles - tiles.floor() < share
            };
            // Where components are equal, the later axis counts as the largest.
            let n = geometric_normal.abs();
            let [a, b] = if n.x > n.y && n.x > n.z {
                [point.y, point.z]
            } else if n.y > n.z {
                [point.x, point.z]
            } else {
                [point.x, point.y]
            };
            if on_line(a) || on_line(b) {
                line_colour
            } else {
                material.colour
            }
        }
    };
    colour.as_dvec3()
}

/// What a ray sees that meets nothing, by its (unit) direction.
pub(crate) fn sky(sky: &Sky, direction: DVec3) -> DVec3 {
    if direction.z < 0.0 {
        sky.deep.as_dvec3()
    } else {
        sky.horizon
            .as_dvec3()
            .lerp(sky.zenith.as_dvec3(), direction.z.min(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const TILES: Material = Material {
        colour: Vec3::ONE,
        pattern: Pattern::Tiles {
            size: 0.25,
            line: 0.0625,
            offset: 0.125,
            line_colour: Vec3::ZERO,
        },
    };

    #[test]
    fn lines_cover_their_share_of_every_plane_and_ignore_the_normals_axis() {
        // With lines a quarter of a tile wide, (3/4)² of a plane is bare.
        for (normal, axis) in [(DVec3::X, 0), (DVec3::NEG_Y, 1), (DVec3::Z, 2)] {
            let mut bare = 0;
            for i in 0..64 {
                for k in 0..64 {
                    let mut at = [f64::from(i) - 31.5, f64::from(k) - 31.5, 0.0].map(|c| c / 64.0);
                    at.rotate_right((axis + 1) % 3);
                    let colour = |depth: f64| {
                        let mut at = at;
                        at[axis] = depth;
                        albedo(&TILES, DVec3::from_array(at), normal)
                    };
                    assert_eq!(colour(0.1), colour(-7.3));
                    bare += i32::from(colour(0.0) == DVec3::ONE);
                }
            }
            assert_eq!(bare, 64 * 64 * 9 / 16);
        }
    }

    #[test]
    fn the_sky_is_continuous_above_the_horizon_and_deep_below() {
        let colours = Sky {
            horizon: Vec3::X,
            zenith: Vec3::Y,
            deep: Vec3::Z,
        };
        assert_eq!(sky(&colours, DVec3::X), DVec3::X);
        assert_eq!(sky(&colours, DVec3::Z), DVec3::Y);
        assert_eq!(sky(&colours, DVec3::new(0.8, 0.0, -0.6)), DVec3::Z);
    }
}
