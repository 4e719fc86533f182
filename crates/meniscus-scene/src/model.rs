//! What a scene is made of.

use glam::{DVec2, DVec3, Vec3};

use crate::{Camera, Moving};

/// A scene at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The name it was loaded by.
    pub name: String,
    /// One line about it.
    pub about: String,
    /// Objects; an object's id is its index.
    pub objects: Vec<Object>,
    /// Materials that objects name by index.
    pub materials: Vec<Material>,
    /// All triangles, in world space.
    pub mesh: Mesh,
    /// What of it moves with the water's time: see [`Scene::set_time`].
    pub moving: Moving,
    /// The water; it reaches to the horizon, and solid things above it hide it.
    pub water: Water,
    /// The eye.
    pub camera: Camera,
    /// The light.
    pub sun: Sun,
    /// What rays see that meet nothing.
    pub sky: Sky,
}

/// Something that has a name and an id.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Unique within the scene.
    pub name: String,
    /// Index into [`Scene::materials`].
    pub material: u32,
}

/// Indexed triangles with a shading normal at every vertex, all in world space (metres).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions; finite.
    pub positions: Vec<Vec3>,
    /// Unit shading normals, one a vertex.
    pub normals: Vec<Vec3>,
    /// Triangles without degenerate ones, counter-clockwise seen from outside.
    pub triangles: Vec<Triangle>,
}

/// Three corners and the object they belong to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Triangle {
    /// Indices into the mesh's vertices; in range.
    pub corners: [u32; 3],
    /// The object's id.
    pub object: u32,
}

/// How a surface looks: diffuse, with a pattern fixed in world space.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Linear RGB albedo.
    pub colour: Vec3,
    /// What overlays it.
    pub pattern: Pattern,
}

/// A pattern in world space, on the axis plane that the geometric normal is nearest to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pattern {
    /// One colour.
    Plain,
    /// Square tiles with lines between them. A point p is on a line where, for either axis of the
    /// plane, fract((p + offset) / size) < line / size. `offset` keeps lines off the walls' planes.
    Tiles {
        /// Edge of a tile with its line, metres.
        size: f32,
        /// Width of the lines, metres.
        line: f32,
        /// Shift of the pattern along each axis, metres.
        offset: f32,
        /// Linear RGB albedo of the lines.
        line_colour: Vec3,
    },
}

/// A water surface: a sum of waves about the rest plane.
///
/// h(x, y, t) = Σ amplitude · sin(wave_vector · (x, y) − angular_frequency · t + phase)
#[derive(Debug, Clone, PartialEq)]
pub struct Water {
    /// z of the rest plane, metres; an f32, so that vertices can lie on it exactly.
    pub level: f64,
    /// Refractive index of the water relative to the air above it.
    pub refractive_index: f64,
    /// The waves' terms; empty or of amplitude 0 where the water is flat.
    pub waves: Vec<Wave>,
    /// Time, seconds. Where objects move, [`Scene::set_time`] sets it.
    pub time: f64,
    /// Whether rays meet the rest plane or the waves.
    pub geometry: WaterGeometry,
}

/// One term of the wave sum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    /// Metres.
    pub amplitude: f64,
    /// Radians per metre.
    pub wave_vector: DVec2,
    /// Radians per second.
    pub angular_frequency: f64,
    /// Radians.
    pub phase: f64,
}

/// Where a ray meets water.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WaterGeometry {
    /// On the rest plane, with the normal of the waves above that point.
    Flat,
    /// On the waves themselves.
    Displaced,
}

/// A directional light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// Unit vector towards the sun.
    pub direction: DVec3,
    /// Linear RGB irradiance on a surface that faces it, over π.
    pub colour: Vec3,
    /// Linear RGB light from all around, over π.
    pub ambient: Vec3,
}

/// The colour of rays that meet nothing: `horizon` to `zenith` by max(direction.z, 0),
/// `deep` where direction.z < 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sky {
    /// Linear RGB.
    pub horizon: Vec3,
    /// Linear RGB.
    pub zenith: Vec3,
    /// Linear RGB.
    pub deep: Vec3,
}
