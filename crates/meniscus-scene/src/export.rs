//! A scene as numbers that a stranger's tracer can start from.

use serde::Serialize;

use crate::{Material, Pattern, Scene, View, WaterGeometry};

/// Everything that a picture of a scene depends on; serialises to `scene.json`.
///
/// World space is right-handed with z up, in metres; angles are in radians, colours linear RGB.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneExport {
    /// The scene's name.
    pub name: String,
    /// The view that pictures were drawn with.
    pub camera: CameraExport,
    /// The water.
    pub water: WaterExport,
    /// The light.
    pub sun: SunExport,
    /// The colours of rays that meet nothing.
    pub sky: SkyExport,
    /// Materials in order.
    pub materials: Vec<MaterialExport>,
    /// Objects; ids are indices.
    pub objects: Vec<ObjectExport>,
    /// Vertex positions.
    pub positions: Vec<[f32; 3]>,
    /// Unit shading normals, one a position.
    pub normals: Vec<[f32; 3]>,
    /// Three indices of positions, counter-clockwise from outside, and the object's id.
    pub triangles: Vec<[u32; 4]>,
}

/// A view. The ray through the point (x, y) of the picture, in pixels from its upper left corner
/// (pixel centres at half integers), runs along
/// focal·forward + (x − width/2)·right − (y − height/2)·up.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CameraExport {
    /// Metres.
    pub eye: [f64; 3],
    /// Unit vector.
    pub right: [f64; 3],
    /// Unit vector.
    pub up: [f64; 3],
    /// Unit vector.
    pub forward: [f64; 3],
    /// Pixels.
    pub focal: f64,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Metres along `forward`.
    pub near: f64,
    /// Three rows of four: carries (x, y, z, 1) to (w·x, w·y, w) in pixels; w is the depth.
    pub world_to_pixel: [[f64; 4]; 3],
}

/// h(x, y, t) = Σ amplitude · sin(wave_vector · (x, y) − angular_frequency · t + phase).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WaterExport {
    /// z of the rest plane.
    pub level: f64,
    /// Of the water relative to the air.
    pub refractive_index: f64,
    /// Seconds.
    pub time: f64,
    /// `flat`: rays meet the rest plane, with the waves' normal there; `displaced`: the waves.
    pub geometry: &'static str,
    /// √⟨|∇h|²⟩.
    pub rms_slope: f64,
    /// The terms.
    pub waves: Vec<WaveExport>,
}

/// One term of the sum.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WaveExport {
    /// Metres.
    pub amplitude: f64,
    /// Radians per metre.
    pub wave_vector: [f64; 2],
    /// Radians per second.
    pub angular_frequency: f64,
    /// Radians.
    pub phase: f64,
}

/// A directional light.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SunExport {
    /// Unit vector towards it.
    pub direction: [f64; 3],
    /// Irradiance over π.
    pub colour: [f32; 3],
    /// Light from all around, over π.
    pub ambient: [f32; 3],
}

/// The colours of rays that meet nothing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SkyExport {
    /// Where direction.z = 0.
    pub horizon: [f32; 3],
    /// Where direction.z = 1.
    pub zenith: [f32; 3],
    /// Where direction.z < 0.
    pub deep: [f32; 3],
}

/// A diffuse surface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MaterialExport {
    /// Albedo.
    pub colour: [f32; 3],
    /// Tiles over it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tiles: Option<TilesExport>,
}

/// Tiles in world space; see [`Pattern::Tiles`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TilesExport {
    /// Metres.
    pub size: f32,
    /// Metres.
    pub line: f32,
    /// Metres.
    pub offset: f32,
    /// Albedo of the lines.
    pub line_colour: [f32; 3],
}

/// An object.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ObjectExport {
    /// Its name.
    pub name: String,
    /// Index of its material.
    pub material: u32,
    /// How it moves with the water's time; positions and normals are those of that time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionExport>,
}

/// A rigid motion; see [`crate::Motion`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MotionExport {
    /// What it turns about at time 0, metres.
    pub pivot: [f64; 3],
    /// Metres per second.
    pub velocity: [f64; 3],
    /// The axis, as long as it turns in radians per second.
    pub turn: [f64; 3],
    /// How far it rises and falls, metres.
    pub heave: f64,
    /// Seconds.
    pub period: f64,
}

impl Scene {
    /// The scene as seen in a view, for other programs.
    pub fn export(&self, view: &View) -> SceneExport {
        let water = &self.water;
        SceneExport {
            name: self.name.clone(),
            camera: camera(view),
            water: WaterExport {
                level: water.level,
                refractive_index: water.refractive_index,
                time: water.time,
                geometry: match water.geometry {
                    WaterGeometry::Flat => "flat",
                    WaterGeometry::Displaced => "displaced",
                },
                rms_slope: water.rms_slope(),
                waves: water
                    .waves
                    .iter()
                    .map(|wave| WaveExport {
                        amplitude: wave.amplitude,
                        wave_vector: wave.wave_vector.to_array(),
                        angular_frequency: wave.angular_frequency,
                        phase: wave.phase,
                    })
                    .collect(),
            },
            sun: SunExport {
                direction: self.sun.direction.to_array(),
                colour: self.sun.colour.to_array(),
                ambient: self.sun.ambient.to_array(),
            },
            sky: SkyExport {
                horizon: self.sky.horizon.to_array(),
                zenith: self.sky.zenith.to_array(),
                deep: self.sky.deep.to_array(),
            },
            materials: self.materials.iter().map(material).collect(),
            objects: (0..)
                .zip(&self.objects)
                .map(|(id, object)| ObjectExport {
                    name: object.name.clone(),
                    material: object.material,
                    motion: motion(self, id),
                })
                .collect(),
            positions: self.mesh.positions.iter().map(|p| p.to_array()).collect(),
            normals: self.mesh.normals.iter().map(|n| n.to_array()).collect(),
            triangles: self
                .mesh
                .triangles
                .iter()
                .map(|t| [t.corners[0], t.corners[1], t.corners[2], t.object])
                .collect(),
        }
    }
}

fn motion(scene: &Scene, object: u32) -> Option<MotionExport> {
    let mut bodies = scene.moving.bodies().iter();
    let body = bodies.find(|body| body.object() == object)?;
    let motion = body.motion();
    Some(MotionExport {
        pivot: body.pivot().to_array(),
        velocity: motion.velocity.to_array(),
        turn: motion.turn.to_array(),
        heave: motion.heave,
        period: motion.period,
    })
}

fn camera(view: &View) -> CameraExport {
    let centre = 0.5 * view.size.as_dvec2();
    let row = |vector: glam::DVec3| {
        let [x, y, z] = vector.to_array();
        [x, y, z, -vector.dot(view.eye)]
    };
    CameraExport {
        eye: view.eye.to_array(),
        right: view.right.to_array(),
        up: view.up.to_array(),
        forward: view.forward.to_array(),
        focal: view.focal,
        size: view.size.to_array(),
        near: view.near,
        world_to_pixel: [
            row(view.right * view.focal + view.forward * centre.x),
            row(view.forward * centre.y - view.up * view.focal),
            row(view.forward),
        ],
    }
}

fn material(material: &Material) -> MaterialExport {
    MaterialExport {
        colour: material.colour.to_array(),
        tiles: match material.pattern {
            Pattern::Plain => None,
            Pattern::Tiles {
                size,
                line,
                offset,
                line_colour,
            } => Some(TilesExport {
                size,
                line,
                offset,
                line_colour: line_colour.to_array(),
            }),
        },
    }
}
