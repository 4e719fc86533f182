//! Triangles of objects that move, in buffers of their own beside those of what is static.
//!
//! Which vertices they share, and which of them carry triangles' attributes, is found once, where the
//! objects were placed. At another time vertices are rewritten, triangles sorted by the side of the
//! water that they are on now, and what flat water bends of them is divided anew; all else stays.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::Vec3;
use meniscus_pipeline::Geometry;
use meniscus_scene::{Body, Mesh, Moving, Scene, Side, Triangle, WaterBand};

use crate::geometry::{Triangles, Vertex, finite};
use crate::scene_buffers::GeometryBuffers;
use crate::sight::Sight;
use crate::subdivide;
use crate::{Gpu, GpuError};

/// How many cameras' divided triangles are kept.
const FAR_KEPT: usize = 2;

/// Counts of how often something moved on a side of the water: what was drawn at other counts is old.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Versions {
    pub above: u64,
    pub below: u64,
    /// Of what rays are traced through; 0 where nothing reads that.
    pub rays: u64,
}

impl Versions {
    /// Whether what a pass draws of the scene has moved between two counts.
    pub fn differ(&self, other: &Self, geometry: Geometry, eye_above: bool) -> bool {
        let [above, below] = sides(geometry, eye_above);
        above && self.above != other.above || below && self.below != other.below
    }
}

/// Whether triangles above the water are drawn, and those below.
fn sides(geometry: Geometry, eye_above: bool) -> [bool; 2] {
    match geometry {
        Geometry::All => [true, true],
        Geometry::NearSide => [eye_above, !eye_above],
        Geometry::FarSide => [!eye_above, eye_above],
    }
}

/// The moving triangles of a scene.
#[derive(Debug)]
pub(crate) struct Bodies {
    level: f64,
    band: WaterBand,
    parts: Vec<Part>,
    state: Mutex<State>,
}

/// What does not change of a body.
#[derive(Debug)]
struct Part {
    /// Its vertices among all.
    vertices: Range<usize>,
    /// Of each of them, which of the body's points it is.
    sources: Vec<u32>,
    /// Vertices of its triangles; the first carries the triangle's attributes.
    triangles: Vec<[u32; 3]>,
}

#[derive(Debug)]
struct State {
    moving: Moving,
    made: Triangles,
    /// How many triangles lie above, on both sides, and below.
    counts: [usize; 3],
    buffers: Option<GeometryBuffers>,
    far: Vec<Far>,
    versions: Versions,
    written: u64,
}

/// What is drawn behind the water for a camera.
#[derive(Debug)]
struct Far {
    sight: Sight,
    bow_px: f64,
    /// The count at which it was made.
    version: u64,
    buffers: GeometryBuffers,
    indices: u32,
}

impl Bodies {
    /// Of a scene, at its time.
    ///
    /// # Errors
    /// When the mesh cannot be drawn.
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, GpuError> {
        let (level, band) = (scene.water.level, WaterBand::of(scene));
        let mut made = Triangles::default();
        let mut parts = Vec::new();
        for body in scene.moving.bodies() {
            let part = Part::new(scene, body, band, made.vertices.len())?;
            made.vertices.extend(&part.1);
            parts.push(part.0);
        }
        let bodies = Self {
            level,
            band,
            parts,
            state: Mutex::new(State {
                moving: scene.moving.clone(),
                made,
                counts: [0; 3],
                buffers: None,
                far: Vec::new(),
                versions: Versions::default(),
                written: 0,
            }),
        };
        let mut held = bodies.held();
        let state = &mut *held;
        for (part, body) in bodies.parts.iter().zip(scene.moving.bodies()) {
            part.pose(body, scene.moving.time(), level, &mut state.made.vertices);
        }
        bodies.sort(state);
        if !state.made.indices.is_empty() {
            let made = &state.made;
            state.buffers = Some(GeometryBuffers::new(gpu, &made.vertices, &made.indices)?);
        }
        drop(held);
        Ok(bodies)
    }

    /// Puts the bodies where they are at a time at which they stand so, and uploads what differs.
    ///
    /// # Errors
    /// When the graphics library refuses.
    pub fn follow(&self, gpu: &Gpu, moving: &Moving) -> Result<Versions, GpuError> {
        let mut held = self.held();
        let state = &mut *held;
        let from = state.moving.time();
        state.moving = moving.clone();
        let mut touched = [false; 2];
        let mut note = |side: Side| {
            touched[0] |= side != Side::Below;
            touched[1] |= side != Side::Above;
        };
        let mut moved = Vec::new();
        for (part, body) in self.parts.iter().zip(moving.bodies()) {
            if !body.moves_between(from, moving.time()) {
                continue;
            }
            let vertices = &mut state.made.vertices;
            part.sides(vertices, self.band).for_each(&mut note);
            part.pose(body, moving.time(), self.level, vertices);
            part.sides(vertices, self.band).for_each(&mut note);
            moved.push(part.vertices.clone());
        }
        if moved.is_empty() {
            return Ok(state.versions);
        }
        state.versions.above += u64::from(touched[0]);
        state.versions.below += u64::from(touched[1]);
        let before = std::mem::take(&mut state.made.indices);
        self.sort(state);
        if let Some(buffers) = &state.buffers {
            for range in moved {
                let first = range.start;
                let part = &state.made.vertices[range];
                state.written += buffers.write_vertices(gpu, first, part)?;
            }
            if state.made.indices != before {
                state.written += buffers.write_indices(gpu, &state.made.indices)?;
            }
        }
        Ok(state.versions)
    }

    /// What to draw; none where there is nothing.
    ///
    /// # Errors
    /// When the adapter does not allow so large buffers.
    pub fn drawing(
        &self,
        gpu: &Gpu,
        geometry: Geometry,
        sight: &Sight,
        bow_px: f64,
    ) -> Result<Option<(GeometryBuffers, Range<u32>)>, GpuError> {
        let mut held = self.held();
        let state = &mut *held;
        let range = state.range(geometry, sight.eye_above());
        let Some(whole) = state.buffers.clone().filter(|_| !range.is_empty()) else {
            return Ok(None);
        };
        match geometry {
            Geometry::FarSide => self.far(gpu, state, sight, bow_px, range),
            _ => Ok(Some((whole, range))),
        }
    }

    /// What is drawn behind the water.
    fn far(
        &self,
        gpu: &Gpu,
        state: &mut State,
        sight: &Sight,
        bow_px: f64,
        range: Range<u32>,
    ) -> Result<Option<(GeometryBuffers, Range<u32>)>, GpuError> {
        let version = match sight.eye_above() {
            true => state.versions.below,
            false => state.versions.above,
        };
        let same = |far: &Far| far.sight == *sight && far.bow_px == bow_px;
        let known = state.far.iter().position(same).map(|i| state.far.remove(i));
        if let Some(far) = known.as_ref().filter(|far| far.version == version) {
            let drawn = (far.buffers.clone(), 0..far.indices);
            state.far.extend(known);
            return Ok(Some(drawn));
        }
        let budget = subdivide::budget(range.len() / 3);
        let place = range.start as usize..range.end as usize;
        let divided = subdivide::divided(&state.made, range, self.band, sight, bow_px, budget);
        let (vertices, indices) = match &divided {
            Some(divided) => (&divided.vertices[..], &divided.indices[..]),
            None => (&state.made.vertices[..], &state.made.indices[place]),
        };
        let fitting = known.filter(|far| far.buffers.holds(vertices.len(), indices.len()));
        let buffers = match fitting {
            Some(far) => {
                state.written += far.buffers.write_vertices(gpu, 0, vertices)?;
                state.written += far.buffers.write_indices(gpu, indices)?;
                far.buffers
            }
            None => {
                // Room for what other moments need.
                let (mut vertices, mut indices) = (vertices.to_vec(), indices.to_vec());
                let limit = gpu.device().limits().max_buffer_size as usize;
                let room = |count: usize, bytes: usize| match 2 * count * bytes <= limit {
                    true => 2 * count,
                    false => count,
                };
                vertices.resize(room(vertices.len(), size_of::<Vertex>()), vertices[0]);
                indices.resize(room(indices.len(), size_of::<u32>()), 0);
                let buffers = GeometryBuffers::new(gpu, &vertices, &indices)?;
                state.written += buffers.bytes();
                buffers
            }
        };
        let indices = indices.len() as u32;
        if state.far.len() >= FAR_KEPT {
            state.far.remove(0);
        }
        state.far.push(Far {
            sight: *sight,
            bow_px,
            version,
            buffers: buffers.clone(),
            indices,
        });
        Ok(Some((buffers, 0..indices)))
    }

    /// Bytes that were written so far.
    pub fn written(&self) -> u64 {
        self.held().written
    }

    /// Bytes of all buffers.
    pub fn bytes(&self) -> u64 {
        let held = self.held();
        let far = held.far.iter().map(|far| &far.buffers);
        held.buffers
            .iter()
            .chain(far)
            .map(GeometryBuffers::bytes)
            .sum()
    }

    /// The lowest and highest z that bodies may reach, metres; as they are now where one sinks or
    /// rises for good.
    pub fn heights(&self) -> Option<[f64; 2]> {
        let held = self.held();
        heights(&held.moving)
    }

    /// Indices of triangles above the water, on both sides and below, in this order.
    fn sort(&self, state: &mut State) {
        let vertices = &state.made.vertices;
        let triangles = || self.parts.iter().flat_map(|part| &part.triangles);
        state.counts = [Side::Above, Side::Both, Side::Below].map(|wanted| {
            let of = triangles().filter(|t| side(t, vertices, self.band) == wanted);
            let before = state.made.indices.len();
            state.made.indices.extend(of.flatten());
            (state.made.indices.len() - before) / 3
        });
    }

    fn held(&self) -> MutexGuard<'_, State> {
        // Nothing is left half done by a thread that ended while it held the lock.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// See [`Bodies::heights`].
pub(crate) fn heights(moving: &Moving) -> Option<[f64; 2]> {
    let bodies = moving.bodies().iter();
    let each = bodies.map(|body| body.heights(moving.time()));
    each.reduce(|[low, high], [l, h]| [low.min(l), high.max(h)])
}

/// A scene's mesh without what moves.
pub(crate) fn still(scene: &Scene) -> Mesh {
    let moves = |object: u32| scene.motion_of(object).is_some();
    let triangles = scene.mesh.triangles.iter().copied();
    Mesh {
        positions: scene.mesh.positions.clone(),
        normals: scene.mesh.normals.clone(),
        triangles: triangles.filter(|t| !moves(t.object)).collect(),
    }
}

impl State {
    fn range(&self, geometry: Geometry, eye_above: bool) -> Range<u32> {
        let [above, both, below] = self.counts.map(|count| 3 * count as u32);
        match sides(geometry, eye_above) {
            [true, true] => 0..above + both + below,
            [true, false] => 0..above + both,
            _ => above..above + both + below,
        }
    }
}

impl Part {
    /// Of a body whose vertices come behind so many others; and its vertices where it was placed.
    fn new(
        scene: &Scene,
        body: &Body,
        band: WaterBand,
        first: usize,
    ) -> Result<(Self, Vec<Vertex>), GpuError> {
        let (positions, normals) = body.points(0.0, scene.water.level).unzip();
        let mut mesh = Mesh {
            positions,
            normals,
            triangles: Vec::new(),
        };
        let of_body = scene.mesh.triangles.iter();
        for triangle in of_body.filter(|t| t.object == body.object()) {
            let corners = triangle.corners.map(|c| body.vertices().binary_search(&c));
            let [Ok(a), Ok(b), Ok(c)] = corners else {
                return Err(GpuError::Scene(format!(
                    "object {} moves, and has a vertex that does not",
                    body.object()
                )));
            };
            mesh.triangles.push(Triangle {
                corners: [a, b, c].map(|corner| corner as u32),
                object: triangle.object,
            });
        }
        let made = Triangles::new(&mesh, band)?;
        // Vertices that are equal bit for bit move alike.
        let bits = |at: [f32; 3], normal: [f32; 3]| [at, normal].map(|v| v.map(f32::to_bits));
        let points = mesh.positions.iter().zip(&mesh.normals).zip(0..);
        let known: HashMap<[[u32; 3]; 2], u32> = points
            .map(|((at, normal), index)| (bits(at.to_array(), finite(*normal).to_array()), index))
            .collect();
        let source = |v: &Vertex| known.get(&bits(v.position, v.normal)).copied();
        let sources = made.vertices.iter().map(|v| source(v).unwrap_or(0));
        let corners = made.indices.chunks_exact(3);
        let part = Self {
            vertices: first..first + made.vertices.len(),
            sources: sources.collect(),
            triangles: corners
                .map(|t| [t[0], t[1], t[2]].map(|corner| first as u32 + corner))
                .collect(),
        };
        Ok((part, made.vertices))
    }

    /// Puts the body's vertices, which are among these, where they are at a time.
    fn pose(&self, body: &Body, time: f64, level: f64, vertices: &mut [Vertex]) {
        let points: Vec<(Vec3, Vec3)> = body.points(time, level).collect();
        let own = vertices[self.vertices.clone()].iter_mut();
        for (vertex, &source) in own.zip(&self.sources) {
            let (position, normal) = points[source as usize];
            (vertex.position, vertex.normal) = (position.to_array(), normal.to_array());
        }
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|i| Vec3::from(vertices[i as usize].position).as_dvec3());
            let normal = (b - a).cross(c - a).normalize_or_zero().as_vec3();
            vertices[corners[0] as usize].geometric_normal = finite(normal).to_array();
        }
    }

    /// The sides that its triangles are on.
    fn sides(&self, vertices: &[Vertex], band: WaterBand) -> impl Iterator<Item = Side> {
        let triangles = self.triangles.iter();
        triangles.map(move |triangle| side(triangle, vertices, band))
    }
}

fn side(triangle: &[u32; 3], vertices: &[Vertex], band: WaterBand) -> Side {
    band.side(triangle.map(|i| vertices[i as usize].position[2]))
}
