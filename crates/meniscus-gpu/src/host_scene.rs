//! The values that the host offers to shaders, by name (see `meniscus_pipeline::host`).

use std::f64::consts::TAU;

use glam::{DVec3, UVec2, Vec3};
use meniscus_pipeline::{Size, host};
use meniscus_scene::{Camera, Material, Pattern, Scene, Sky, Sun, View, Water, WaterGeometry};

use crate::guard::{self, GUARD_MAX, GuardFacts};
use crate::layout::Value;
use crate::sight::Sight;

/// A scene without its mesh: what uniform blocks and small arrays are made of.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HostScene {
    water: Water,
    camera: Camera,
    sun: Sun,
    sky: Sky,
    materials: Vec<Material>,
    /// The material of every object.
    objects: Vec<u32>,
}

/// A frame's views: as large as the frame, and with the guard band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Views {
    frame: View,
    guarded: View,
}

/// The view that a pass draws, and that with which its inputs were drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PassViews {
    pub target: Size,
    pub seen: Size,
}

impl PassViews {
    /// Of passes that neither draw nor read beyond the frame.
    pub const FRAME: Self = Self {
        target: Size::Frame,
        seen: Size::Frame,
    };
}

impl Views {
    pub fn get(&self, size: Size) -> &View {
        match size {
            Size::Frame => &self.frame,
            Size::Guarded => &self.guarded,
        }
    }

    pub fn size(&self, size: Size) -> UVec2 {
        self.get(size).size
    }
}

impl HostScene {
    pub fn new(scene: &Scene) -> Self {
        Self {
            water: scene.water.clone(),
            camera: scene.camera,
            sun: scene.sun,
            sky: scene.sky,
            materials: scene.materials.clone(),
            objects: scene.objects.iter().map(|o| o.material).collect(),
        }
    }

    /// The water at its moment.
    pub fn water(&self) -> &Water {
        &self.water
    }

    /// The eye.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Whether the eye is above the water that rays meet, or on it.
    pub fn eye_above(&self) -> bool {
        let waves = match self.water.geometry {
            WaterGeometry::Flat => 0.0,
            WaterGeometry::Displaced => self.water.height(self.camera.eye.truncate()),
        };
        self.camera.eye.z >= self.water.level + waves
    }

    /// The views of a frame of this size over a scene that reaches from the lowest to the highest z.
    pub fn views(&self, size: UVec2, heights: [f64; 2]) -> Views {
        let frame = self.camera.view(size);
        let (above, below) = (heights[1] - self.water.level, self.water.level - heights[0]);
        let facts = GuardFacts {
            tilt: guard::largest_tilt(&self.water),
            relative_index: self.relative_index(),
            eye_distance: (self.camera.eye.z - self.water.level).abs(),
            far_reach: if self.eye_above() { below } else { above },
            near_reach: if self.eye_above() { 0.0 } else { below },
        };
        let guard = guard::guard(&frame, &facts, GUARD_MAX);
        Views {
            frame,
            guarded: frame.guarded(guard),
        }
    }

    /// What flat water does to the view of what stands behind it.
    pub fn sight(&self, views: &Views) -> Sight {
        let level = self.water.level as f32;
        Sight::new(
            views.guarded,
            level,
            self.eye_above(),
            self.relative_index(),
        )
    }

    fn relative_index(&self) -> f64 {
        if self.eye_above() {
            self.water.refractive_index
        } else {
            1.0 / self.water.refractive_index
        }
    }

    /// Whether the host offers a uniform block of this name.
    pub fn has_block(block: &str) -> bool {
        host::BLOCKS.iter().any(|(name, _)| *name == block)
    }

    /// A member of a uniform block; the views belong to the block that tells of them.
    pub fn block(
        &self,
        block: &str,
        member: &str,
        views: &Views,
        pass: PassViews,
    ) -> Option<Value> {
        match block {
            "view_target" if member == "seen_size" => {
                Some(Value::Vec2(views.size(pass.seen).as_vec2().to_array()))
            }
            "view_target" => view_member(views.get(pass.target), member),
            "water" => self.water_member(member),
            "light" => match member {
                "sun_direction" => Some(vec3(self.sun.direction)),
                "sun_colour" => Some(colour(self.sun.colour)),
                "ambient" => Some(colour(self.sun.ambient)),
                "horizon" => Some(colour(self.sky.horizon)),
                "zenith" => Some(colour(self.sky.zenith)),
                "deep" => Some(colour(self.sky.deep)),
                _ => None,
            },
            _ => None,
        }
    }

    fn water_member(&self, member: &str) -> Option<Value> {
        let water = &self.water;
        let n = water.refractive_index;
        let larger = n.max(1.0 / n);
        // (N − 1)(N + 1) rather than N² − 1, which cancels for N near 1.
        let root = ((larger - 1.0) * (larger + 1.0)).sqrt();
        let root_high = root as f32;
        let value = match member {
            "level" => water.level,
            "refractive_index" => n,
            "relative_index" => self.relative_index(),
            "camera_side" if self.eye_above() => 1.0,
            "camera_side" => -1.0,
            "height_bound" => water.height_bound(),
            "slope_bound" => water.slope_bound(),
            "curvature_bound" => curvature_bound(water),
            "larger_index" => larger,
            "root_high" => root,
            "root_low" => root - f64::from(root_high),
            "time" => water.time,
            "wave_count" => {
                let count = water.waves.len();
                return Some(Value::U32(u32::try_from(count).unwrap_or(u32::MAX)));
            }
            _ => return None,
        };
        Some(Value::F32(value as f32))
    }

    /// The number of elements of an array of the host's; none if there is no such array.
    pub fn array_length(&self, array: &str) -> Option<usize> {
        match array {
            "waves" => Some(self.water.waves.len()),
            "materials" => Some(self.materials.len()),
            "objects" => Some(self.objects.len()),
            _ => None,
        }
    }

    /// A member of an array's element, which is in range.
    pub fn element(&self, array: &str, index: usize, member: &str) -> Option<Value> {
        match (array, member) {
            ("waves", "wave_vector") => Some(Value::Vec2(
                self.water.waves[index].wave_vector.as_vec2().to_array(),
            )),
            ("waves", "amplitude") => Some(Value::F32(self.water.waves[index].amplitude as f32)),
            ("waves", "phase") => {
                let wave = &self.water.waves[index];
                Some(Value::F32(turn(
                    wave.phase - wave.angular_frequency * self.water.time,
                )))
            }
            ("materials", _) => material_member(&self.materials[index], member),
            ("objects", "material") => Some(Value::U32(self.objects[index])),
            _ => None,
        }
    }
}

/// Nowhere does a wave sum bend more than this: Σ |A| |k|², 1/m.
fn curvature_bound(water: &Water) -> f64 {
    let terms = water.waves.iter();
    0.0 + terms
        .map(|wave| wave.amplitude.abs() * wave.wave_vector.length_squared())
        .sum::<f64>()
}

/// An angle in [0, 2π), in single precision.
fn turn(angle: f64) -> f32 {
    let turned = angle.rem_euclid(TAU) as f32;
    // Rounding may lead to 2π itself, which is 0.
    if turned >= TAU as f32 { 0.0 } else { turned }
}

fn view_member(view: &View, member: &str) -> Option<Value> {
    Some(match member {
        "eye" => vec3(view.eye),
        "right" => vec3(view.right),
        "up" => vec3(view.up),
        "forward" => vec3(view.forward),
        "focal" => Value::F32(view.focal as f32),
        "size" => Value::Vec2(view.size.as_vec2().to_array()),
        "near" => Value::F32(view.near as f32),
        _ => return None,
    })
}

fn material_member(material: &Material, member: &str) -> Option<Value> {
    let (tile_size, line_width, tile_offset, line_colour) = match material.pattern {
        // Of no width: no line. A tile size that can be divided by, wherever a shader does so first.
        Pattern::Plain => (1.0, 0.0, 0.0, material.colour),
        Pattern::Tiles {
            size,
            line,
            offset,
            line_colour,
        } => (size, line, offset, line_colour),
    };
    Some(match member {
        "colour" => colour(material.colour),
        "line_colour" => colour(line_colour),
        "tile_size" => Value::F32(tile_size),
        "line_width" => Value::F32(line_width),
        "tile_offset" => Value::F32(tile_offset),
        _ => return None,
    })
}

fn vec3(v: DVec3) -> Value {
    Value::Vec3(v.as_vec3().to_array())
}

fn colour(v: Vec3) -> Value {
    Value::Vec3(v.to_array())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use glam::DVec2;
    use meniscus_scene::{Mesh, Object, WaterGeometry, Wave};

    /// A scene without triangles.
    pub(crate) fn scene() -> Scene {
        Scene {
            name: "test".to_owned(),
            about: String::new(),
            objects: vec![Object {
                name: "one".to_owned(),
                material: 0,
            }],
            materials: vec![Material {
                colour: Vec3::splat(0.5),
                pattern: Pattern::Plain,
            }],
            mesh: Mesh::default(),
            moving: meniscus_scene::Moving::default(),
            water: Water {
                level: 0.0,
                refractive_index: 1.333,
                waves: vec![Wave {
                    amplitude: 0.02,
                    wave_vector: DVec2::new(3.0, 4.0),
                    angular_frequency: 7.0,
                    phase: 0.3,
                }],
                time: 0.0,
                geometry: WaterGeometry::Flat,
            },
            camera: Camera {
                eye: DVec3::new(0.0, -2.0, 1.7),
                target: DVec3::ZERO,
                field_of_view: 0.9,
                near: 0.05,
            },
            sun: Sun {
                direction: DVec3::Z,
                colour: Vec3::ONE,
                ambient: Vec3::splat(0.1),
            },
            sky: Sky {
                horizon: Vec3::ONE,
                zenith: Vec3::X,
                deep: Vec3::ZERO,
            },
        }
    }

    fn kind(value: Value) -> host::ValueType {
        match value {
            Value::F32(_) => host::ValueType::F32,
            Value::U32(_) => host::ValueType::U32,
            Value::Vec2(_) => host::ValueType::Vec2,
            Value::Vec3(_) => host::ValueType::Vec3,
        }
    }

    #[test]
    fn everything_that_the_host_lists_is_there_with_its_type() {
        let host = HostScene::new(&scene());
        let views = host.views(UVec2::new(64, 48), [-1.0, 1.0]);
        for (block, members) in host::BLOCKS {
            for (member, ty) in *members {
                let value = host.block(block, member, &views, PassViews::FRAME);
                assert_eq!(value.map(kind), Some(*ty), "{block}.{member}");
            }
        }
        let small =
            |array: &&(&str, host::Members)| !crate::scene_arrays::SceneArrays::has(array.0);
        for (array, members) in host::ARRAYS.iter().filter(small) {
            assert_eq!(host.array_length(array), Some(1), "{array}");
            for (member, ty) in *members {
                let value = host.element(array, 0, member);
                assert_eq!(value.map(kind), Some(*ty), "{array}.{member}");
            }
        }
        for (attribute, _) in host::ATTRIBUTES {
            assert!(
                crate::geometry::Vertex::attribute(attribute).is_some(),
                "{attribute}"
            );
        }
    }

    fn float(value: Option<Value>) -> f64 {
        match value {
            Some(Value::F32(v)) => f64::from(v),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_root_is_exact_to_twice_single_precision() {
        for n in [1.333, 1.0 / 1.333, 1.0 + 1e-7, 2.5, 1.0] {
            let mut scene = scene();
            scene.water.refractive_index = n;
            let host = HostScene::new(&scene);
            let sum = float(host.water_member("root_high")) + float(host.water_member("root_low"));
            let larger = n.max(1.0 / n);
            let square = (larger - 1.0) * (larger + 1.0);
            assert!((sum * sum - square).abs() <= 1e-13 * square, "{n}: {sum}");
        }
    }

    #[test]
    fn the_relative_index_is_that_of_the_other_side() {
        let mut scene = scene();
        for (z, side) in [(1.0, 1.0), (0.0, 1.0), (-1e-9, -1.0)] {
            scene.camera.eye.z = z;
            let host = HostScene::new(&scene);
            assert_eq!(float(host.water_member("camera_side")), side);
            let product = float(host.water_member("relative_index")) / 1.333_f64.powf(side);
            assert!((product - 1.0).abs() < 1e-7);
        }
    }

    #[test]
    fn phases_stay_in_one_turn_and_follow_time() {
        let mut scene = scene();
        for time in [0.0, 1e-9, 0.3 / 7.0, 12.0, 1e6, -5.0] {
            scene.water.time = time;
            let phase = float(HostScene::new(&scene).element("waves", 0, "phase"));
            assert!((0.0..TAU).contains(&phase), "{time}: {phase}");
            let expected = (0.3 - 7.0 * time).sin();
            assert!((phase.sin() - expected).abs() < 1e-6, "{time}");
        }
    }

    #[test]
    fn the_guard_does_not_depend_on_time_or_on_where_the_eye_looks() {
        let mut scene = scene();
        let size = |scene: &Scene| {
            HostScene::new(scene)
                .views(UVec2::new(640, 360), [-2.0, 1.0])
                .size(Size::Guarded)
        };
        let first = size(&scene);
        assert!(first.cmpgt(UVec2::new(640, 360)).all());
        scene.water.time = 3.0;
        scene.camera.target = DVec3::new(1.0, 1.0, -3.0);
        assert_eq!(size(&scene), first);
        scene.water.waves.clear();
        assert_eq!(size(&scene), UVec2::new(640, 360));
    }
}
