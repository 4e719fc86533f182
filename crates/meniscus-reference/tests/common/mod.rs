//! A small pool built by hand.

use glam::{DVec2, DVec3, UVec2, Vec3};
use meniscus_scene::{
    Camera, Material, Mesh, Object, Pattern, Scene, Sky, Sun, Triangle, View, Water, WaterGeometry,
    Wave,
};

/// Appends a quad, counter-clockwise from outside.
fn quad(mesh: &mut Mesh, corners: [DVec3; 4], object: u32) {
    let first = mesh.positions.len() as u32;
    let normal = (corners[1] - corners[0])
        .cross(corners[2] - corners[0])
        .normalize();
    for corner in corners {
        mesh.positions.push(corner.as_vec3());
        mesh.normals.push(normal.as_vec3());
    }
    for corners in [[0, 1, 2], [0, 2, 3]] {
        mesh.triangles.push(Triangle {
            corners: corners.map(|corner| first + corner),
            object,
        });
    }
}

/// Appends a box between two corners; `inwards` turns its faces to the inside and leaves out the
/// top.
fn cuboid(mesh: &mut Mesh, low: DVec3, high: DVec3, inwards: bool, object: u32) {
    for axis in 0..3 {
        for end in [low, high] {
            let top = end[axis] == high[axis];
            if inwards && axis == 2 && top {
                continue;
            }
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut corners = [(low, low), (high, low), (high, high), (low, high)].map(|(a, b)| {
                let mut corner = DVec3::ZERO;
                (corner[axis], corner[u], corner[v]) = (end[axis], a[u], b[v]);
                corner
            });
            if top == inwards {
                corners.reverse();
            }
            quad(mesh, corners, object);
        }
    }
}

/// Appends a ball.
fn ball(mesh: &mut Mesh, centre: DVec3, radius: f64, object: u32) {
    let first = mesh.positions.len() as u32;
    let (rings, sectors) = (24, 48);
    for ring in 0..=rings {
        for sector in 0..sectors {
            let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
            let around = std::f64::consts::TAU * f64::from(sector) / f64::from(sectors);
            let normal = DVec3::new(
                polar.sin() * around.cos(),
                polar.sin() * around.sin(),
                polar.cos(),
            );
            mesh.positions.push((centre + radius * normal).as_vec3());
            mesh.normals.push(normal.as_vec3());
        }
    }
    for ring in 0..rings {
        for sector in 0..sectors {
            let at = |r: u32, s: u32| first + r * sectors + s % sectors;
            let [a, b] = [at(ring, sector), at(ring + 1, sector)];
            let [c, d] = [at(ring + 1, sector + 1), at(ring, sector + 1)];
            // At the poles one of the two has no area.
            if ring + 1 < rings {
                mesh.triangles.push(Triangle {
                    corners: [a, b, c],
                    object,
                });
            }
            if ring > 0 {
                mesh.triangles.push(Triangle {
                    corners: [a, c, d],
                    object,
                });
            }
        }
    }
}

/// Waves of five directions, scaled to this root mean square slope.
pub fn waves(rms_slope: f64) -> Vec<Wave> {
    let directions = [0.3_f64, 1.4, 2.6, 4.0, 5.1];
    directions
        .iter()
        .zip([2.0, 1.3, 0.9, 0.7, 0.5])
        .map(|(angle, wavelength)| {
            let wave_number = std::f64::consts::TAU / wavelength;
            Wave {
                // ⟨|∇h|²⟩ = Σ (amplitude · wave number)² / 2.
                amplitude: rms_slope * (2.0 / 5.0_f64).sqrt() / wave_number,
                wave_vector: wave_number * DVec2::from_angle(*angle),
                angular_frequency: (9.81 * wave_number).sqrt(),
                phase: 3.0 * angle,
            }
        })
        .collect()
}

/// A tiled pool of 6 × 4 × 2 m with a ball under water, a post through the surface and a board
/// above it.
pub fn pool(geometry: WaterGeometry, rms_slope: f64) -> Scene {
    let mut mesh = Mesh::default();
    cuboid(
        &mut mesh,
        DVec3::new(-3.0, -2.0, -2.0),
        DVec3::new(3.0, 2.0, 0.6),
        true,
        0,
    );
    ball(&mut mesh, DVec3::new(-0.6, 0.4, -1.3), 0.5, 1);
    cuboid(
        &mut mesh,
        DVec3::new(0.9, 0.5, -2.0),
        DVec3::new(1.2, 0.8, 0.9),
        false,
        2,
    );
    cuboid(
        &mut mesh,
        DVec3::new(-0.3, -1.2, 0.5),
        DVec3::new(0.3, -1.1, 0.7),
        false,
        3,
    );
    let tiles = Material {
        colour: Vec3::new(0.7, 0.8, 0.85),
        pattern: Pattern::Tiles {
            size: 0.25,
            line: 0.02,
            offset: 0.06,
            line_colour: Vec3::splat(0.2),
        },
    };
    let plain = Material {
        colour: Vec3::new(0.8, 0.3, 0.2),
        pattern: Pattern::Plain,
    };
    Scene {
        name: "pool".into(),
        about: "a pool for tests".into(),
        objects: ["pool", "ball", "post", "board"]
            .iter()
            .enumerate()
            .map(|(i, name)| Object {
                name: (*name).into(),
                material: u32::from(i > 0),
            })
            .collect(),
        materials: vec![tiles, plain],
        mesh,
        moving: meniscus_scene::Moving::default(),
        water: Water {
            level: 0.0,
            refractive_index: 1.333,
            waves: waves(rms_slope),
            time: 0.7,
            geometry,
        },
        camera: Camera {
            eye: DVec3::new(0.2, -5.0, 1.7),
            target: DVec3::new(0.0, 0.0, -0.5),
            field_of_view: 0.9,
            near: 0.01,
        },
        sun: Sun {
            direction: DVec3::new(0.3, -0.4, 0.8).normalize(),
            colour: Vec3::new(0.9, 0.85, 0.8),
            ambient: Vec3::splat(0.3),
        },
        sky: Sky {
            horizon: Vec3::new(0.7, 0.8, 0.9),
            zenith: Vec3::new(0.2, 0.4, 0.8),
            deep: Vec3::new(0.0, 0.05, 0.1),
        },
    }
}

/// The view of a small picture from `eye` to `target`.
pub fn view(scene: &Scene, eye: DVec3, target: DVec3) -> View {
    Camera {
        eye,
        target,
        ..scene.camera
    }
    .view(UVec2::new(96, 54))
}

/// An eye over the water, one just over it, one on its floor and one right under the surface; each
/// with a target.
pub const EYES: [(DVec3, DVec3); 4] = [
    (DVec3::new(0.2, -1.9, 1.7), DVec3::new(0.0, 0.5, -1.0)),
    (DVec3::new(-2.0, -1.0, 0.3), DVec3::new(1.0, 0.5, -0.1)),
    (DVec3::new(-2.0, -1.5, -1.9), DVec3::new(0.5, 0.3, 0.2)),
    (DVec3::new(2.0, 1.5, -0.3), DVec3::new(-1.0, -0.5, -0.4)),
];

/// Centres of all pixels.
pub fn pixels(view: &View) -> impl Iterator<Item = DVec2> {
    let UVec2 {
        x: width,
        y: height,
    } = view.size;
    (0..height).flat_map(move |y| {
        (0..width).map(move |x| DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5))
    })
}

/// Height of the waves over a place, and its gradient, straight from the scene.
pub fn height(water: &Water, at: DVec2) -> (f64, DVec2) {
    water
        .waves
        .iter()
        .fold((water.level, DVec2::ZERO), |(height, gradient), wave| {
            let angle = wave.wave_vector.dot(at) - wave.angular_frequency * water.time + wave.phase;
            (
                height + wave.amplitude * angle.sin(),
                gradient + wave.amplitude * angle.cos() * wave.wave_vector,
            )
        })
}
