//! A scene's triangles on the GPU, shared by all frames that show it.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use meniscus_pipeline::{Cull, Geometry};
use meniscus_scene::{Moving, Scene, WaterBand};
use wgpu::util::DeviceExt;

use crate::bodies::{self, Bodies, Versions};
use crate::geometry::{Triangles, Vertex};
use crate::host_scene::HostScene;
use crate::moving::Reads;
use crate::runs::{self, Runs};
use crate::scene_arrays::SceneArrays;
use crate::sight::Sight;
use crate::subdivide::{self, BOW_PX};
use crate::{Gpu, GpuError, moving};

/// A scene on the GPU: its triangles are uploaded once, in an order in which either side of the
/// water is one range of them. What flat water bends is divided as each camera and picture size
/// needs it; frames that share these share the result.
#[derive(Debug)]
pub struct SceneBuffers {
    pub(crate) host: HostScene,
    arrays: SceneArrays,
    band: WaterBand,
    triangles: usize,
    heights: [f64; 2],
    made: Triangles,
    geometry: Option<GeometryBuffers>,
    bow_px: f64,
    far: Mutex<Vec<(Sight, FarGeometry)>>,
    /// What moves, as the scene was uploaded.
    moving: Moving,
    bodies: Bodies,
    /// Bytes that were written into the arrays to follow what moves.
    written: AtomicU64,
}

/// How many cameras' far sides are kept.
const FAR_KEPT: usize = 2;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct GeometryBuffers {
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
}

/// What the far side is drawn from for one camera; the scene's own triangles where it is whole.
#[derive(Debug, Clone)]
pub(crate) struct FarGeometry {
    divided: Option<GeometryBuffers>,
    /// Where the indices begin that each cluster became, and where all end; of what is divided.
    starts: Arc<[u32]>,
    facts: FarSide,
}

/// Something that was made of a scene on the CPU before it could be drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preprocessing {
    /// What was made: `bvh` (triangles in boxes, for rays), `distance_field` (distances to the
    /// triangles), `far_side` (triangles divided for flat water and the camera that asked last).
    pub name: &'static str,
    /// With how many voxels, where a shader can ask for more or fewer: see [`crate::field_voxels`].
    pub voxels: Option<u32>,
    /// How long it took, milliseconds.
    pub ms: f64,
    /// Bytes that it takes on the GPU; 0 where nothing had to be made.
    pub bytes: u64,
}

/// How the far side's triangles were divided for a camera and picture size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FarSide {
    /// Triangles with a part on the far side, as the scene has them.
    pub triangles: u64,
    /// What they became.
    pub drawn: u64,
    /// The largest distance of a drawn edge from where its points appear that was allowed, pixels:
    /// what was asked for ([`BOW_PX`]), or more where that would have taken too many triangles.
    pub bow_px: f64,
    /// How long it took, milliseconds.
    pub ms: f64,
}

impl GeometryBuffers {
    pub fn new(gpu: &Gpu, vertices: &[Vertex], indices: &[u32]) -> Result<Self, GpuError> {
        use wgpu::BufferUsages as Usages;
        let buffer = |what: &str, contents: &[u8], usage| {
            let limit = gpu.device().limits().max_buffer_size;
            if contents.len() as u64 > limit {
                return Err(GpuError::Size(format!(
                    "the scene's {what} take {} bytes; the adapter allows {limit} (max_buffer_size)",
                    contents.len()
                )));
            }
            let descriptor = wgpu::util::BufferInitDescriptor {
                label: Some(what),
                contents,
                usage: usage | Usages::COPY_DST,
            };
            gpu.create(&format!("the buffer of {what}"), || {
                gpu.device().create_buffer_init(&descriptor)
            })
        };
        Ok(Self {
            vertices: buffer("vertices", bytemuck::cast_slice(vertices), Usages::VERTEX)?,
            indices: buffer("indices", bytemuck::cast_slice(indices), Usages::INDEX)?,
        })
    }

    pub fn bytes(&self) -> u64 {
        self.vertices.size() + self.indices.size()
    }

    /// Whether there is room for so many vertices and indices.
    pub fn holds(&self, vertices: usize, indices: usize) -> bool {
        let bytes = [vertices * size_of::<Vertex>(), indices * size_of::<u32>()];
        let room = [&self.vertices, &self.indices].map(wgpu::Buffer::size);
        (0..2).all(|i| bytes[i] as u64 <= room[i])
    }

    /// Writes vertices from one of them on; how many bytes.
    pub fn write_vertices(
        &self,
        gpu: &Gpu,
        first: usize,
        vertices: &[Vertex],
    ) -> Result<u64, GpuError> {
        let offset = (first * size_of::<Vertex>()) as u64;
        let bytes = bytemuck::cast_slice(vertices);
        gpu.attempt("writing vertices", || {
            gpu.queue().write_buffer(&self.vertices, offset, bytes);
        })?;
        Ok(bytes.len() as u64)
    }

    /// Writes the first indices; how many bytes.
    pub fn write_indices(&self, gpu: &Gpu, indices: &[u32]) -> Result<u64, GpuError> {
        let bytes = bytemuck::cast_slice(indices);
        gpu.attempt("writing indices", || {
            gpu.queue().write_buffer(&self.indices, 0, bytes);
        })?;
        Ok(bytes.len() as u64)
    }
}

impl SceneBuffers {
    /// Uploads a scene.
    ///
    /// # Errors
    /// When a triangle names a vertex that is not there or has a corner that is not finite, and
    /// when the scene exceeds the adapter's limits.
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, GpuError> {
        let band = WaterBand::of(scene);
        moving::check(scene)?;
        let made = match scene.moving.is_empty() {
            true => Triangles::new(&scene.mesh, band)?,
            false => Triangles::new(&bodies::still(scene), band)?,
        };
        let geometry = if made.indices.is_empty() {
            None
        } else {
            Some(GeometryBuffers::new(gpu, &made.vertices, &made.indices)?)
        };
        Ok(Self {
            host: HostScene::new(scene),
            arrays: SceneArrays::new(scene),
            band,
            triangles: scene.mesh.triangles.len(),
            heights: still_heights(scene),
            made,
            geometry,
            bow_px: BOW_PX,
            far: Mutex::default(),
            moving: scene.moving.clone(),
            bodies: Bodies::new(gpu, scene)?,
            written: AtomicU64::new(0),
        })
    }

    /// The same scene with another bound, pixels, on how far a drawn edge may lie from where its
    /// points appear through flat water; infinite: triangles are cut at the rest plane alone.
    #[must_use]
    pub fn with_bow_bound(mut self, px: f64) -> Self {
        self.bow_px = px;
        self.far = Mutex::default();
        self
    }

    /// Bytes of vertices and indices, and of what is uploaded for rays so far.
    pub fn bytes(&self) -> u64 {
        let divided = self.held_far();
        let divided = divided.iter().filter_map(|(_, far)| far.divided.as_ref());
        let geometry = self.geometry.iter().chain(divided);
        let still = geometry.map(GeometryBuffers::bytes).sum::<u64>();
        still + self.bodies.bytes() + self.arrays.bytes()
    }

    /// How the far side was divided for the camera that asked last; none while none has.
    pub fn far_side(&self) -> Option<FarSide> {
        self.held_far().last().map(|(_, far)| far.facts)
    }

    /// What was made of the scene on the CPU so far, with its cost; only what some frame has asked
    /// for.
    pub fn preprocessing(&self) -> Vec<Preprocessing> {
        let far = self.held_far().last().map(|(_, far)| {
            let bytes = far.divided.as_ref().map_or(0, GeometryBuffers::bytes);
            (far.facts.ms, bytes)
        });
        let made = |name: &'static str, (ms, bytes): (f64, u64)| Preprocessing {
            name,
            voxels: None,
            ms,
            bytes,
        };
        let trees = self.arrays.build_ms();
        let mut all = Vec::new();
        all.extend(trees.map(|ms| made("bvh", (ms, self.arrays.tracing_bytes()))));
        let fields = self.arrays.distance_fields().into_iter();
        all.extend(fields.map(|(voxels, ms, bytes)| Preprocessing {
            voxels: Some(voxels),
            ..made("distance_field", (ms, bytes))
        }));
        all.extend(far.map(|cost| made("far_side", cost)));
        all
    }

    /// The arrays that are made of the triangles.
    pub(crate) fn arrays(&self) -> &SceneArrays {
        &self.arrays
    }

    /// Whether a frame of these triangles can show this scene: the mesh is taken to be the same,
    /// and the heights between which the water may lie have to be.
    pub(crate) fn fits(&self, scene: &Scene) -> bool {
        let same = self.triangles == scene.mesh.triangles.len();
        same && self.band == WaterBand::of(scene) && self.moving.is_of(&scene.moving)
    }

    /// What moves, as the scene was uploaded.
    pub(crate) fn moving(&self) -> &Moving {
        &self.moving
    }

    /// Puts all that moves where it is at a time at which it stands so, as far as it is drawn or read;
    /// and how long trees for rays took, milliseconds.
    ///
    /// # Errors
    /// When the graphics library refuses.
    pub(crate) fn follow(
        &self,
        gpu: &Gpu,
        moving: &Moving,
        reads: Reads,
    ) -> Result<(Versions, f64), GpuError> {
        if moving.is_empty() {
            return Ok((Versions::default(), 0.0));
        }
        let mut versions = self.bodies.follow(gpu, moving)?;
        if !reads.arrays {
            return Ok((versions, 0.0));
        }
        let followed = self.arrays.follow(gpu, moving)?;
        versions.rays = followed.version;
        self.written.fetch_add(followed.bytes, Ordering::Relaxed);
        Ok((versions, followed.tree_ms))
    }

    /// Bytes that were written so far to follow what moves.
    pub(crate) fn written(&self) -> u64 {
        self.bodies.written() + self.written.load(Ordering::Relaxed)
    }

    /// What to draw of objects that move; none where there is nothing.
    ///
    /// # Errors
    /// When the adapter does not allow so large buffers.
    pub(crate) fn moving_drawing(
        &self,
        gpu: &Gpu,
        geometry: Geometry,
        sight: &Sight,
    ) -> Result<Option<(GeometryBuffers, Range<u32>)>, GpuError> {
        self.bodies.drawing(gpu, geometry, sight, self.bow_px)
    }

    /// The lowest and highest z of what is drawn.
    pub(crate) fn heights(&self) -> [f64; 2] {
        let bodies = self.bodies.heights();
        bodies.map_or(self.heights, |bodies| both(self.heights, bodies))
    }

    /// What to draw: all but the clusters that `cull` misses; none where there is nothing. The far
    /// side is divided for `sight` if that has not been done yet.
    ///
    /// # Errors
    /// When the adapter does not allow so large buffers.
    pub(crate) fn drawing(
        &self,
        gpu: &Gpu,
        geometry: Geometry,
        sight: &Sight,
        cull: Option<&Cull>,
    ) -> Result<Option<(GeometryBuffers, Runs)>, GpuError> {
        let range = self.made.range(geometry, sight.eye_above());
        let Some(whole) = self.geometry.as_ref().filter(|_| !range.is_empty()) else {
            return Ok(None);
        };
        let clusters = self.made.clusters_of(&range);
        let far = match geometry {
            Geometry::FarSide => Some(self.far(gpu, sight)?),
            _ => None,
        };
        let divided = far.as_ref().and_then(|far| {
            let buffers = far.divided.as_ref()?;
            Some((buffers, far.starts.windows(2).map(|ends| ends[0]..ends[1])))
        });
        let (buffers, ranges): (_, Runs) = match divided {
            Some((buffers, ranges)) => (buffers, ranges.collect()),
            None => {
                let ranges = clusters.iter().map(|c| &c.triangles);
                (whole, ranges.map(|t| 3 * t.start..3 * t.end).collect())
            }
        };
        let seen = ranges.into_iter().zip(clusters);
        let seen = seen.filter(|(_, c)| cull.is_none_or(|cull| !cull.misses(c.low, c.high)));
        let runs = runs::joined(seen.map(|(range, _)| range));
        Ok(Some((buffers.clone(), runs)).filter(|(_, runs)| !runs.is_empty()))
    }

    fn far(&self, gpu: &Gpu, sight: &Sight) -> Result<FarGeometry, GpuError> {
        let mut held = self.held_far();
        if let Some(known) = held.iter().position(|(of, _)| of == sight) {
            let known = held.remove(known);
            let far = known.1.clone();
            held.push(known);
            return Ok(far);
        }
        let start = Instant::now();
        let range = self.made.range(Geometry::FarSide, sight.eye_above());
        let clusters = self.made.clusters_of(&range);
        let triangles = range.len() / 3;
        let first = range.start / 3;
        let budget = subdivide::budget(triangles);
        let divided = subdivide::divided(&self.made, range, self.band, sight, self.bow_px, budget);
        let facts = FarSide {
            triangles: triangles as u64,
            drawn: divided.as_ref().map_or(triangles, |d| d.indices.len() / 3) as u64,
            bow_px: divided.as_ref().map_or(self.bow_px, |d| d.bow_px),
            ms: start.elapsed().as_secs_f64() * 1e3,
        };
        let starts = divided.as_ref().map_or_else(Arc::default, |divided| {
            let ends = clusters.iter().map(|cluster| cluster.triangles.end);
            let bounds = std::iter::once(first).chain(ends);
            let starts = bounds.map(|triangle| divided.starts[(triangle - first) as usize]);
            starts.collect()
        });
        let divided = divided.map(|d| GeometryBuffers::new(gpu, &d.vertices, &d.indices));
        let far = FarGeometry {
            divided: divided.transpose()?,
            starts,
            facts,
        };
        if held.len() >= FAR_KEPT {
            held.remove(0);
        }
        held.push((*sight, far.clone()));
        Ok(far)
    }

    fn held_far(&self) -> std::sync::MutexGuard<'_, Vec<(Sight, FarGeometry)>> {
        // Nothing is left half done by a thread that ended while it held the lock.
        self.far.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The lowest and highest z of what is drawn, or may be at another time, and of the rest plane.
pub(crate) fn heights(scene: &Scene) -> [f64; 2] {
    let still = still_heights(scene);
    bodies::heights(&scene.moving).map_or(still, |bodies| both(still, bodies))
}

fn both([low, high]: [f64; 2], [least, most]: [f64; 2]) -> [f64; 2] {
    [low.min(least), high.max(most)]
}

/// The same without what moves.
fn still_heights(scene: &Scene) -> [f64; 2] {
    let triangles = scene.mesh.triangles.iter();
    let still = triangles.filter(|t| scene.motion_of(t.object).is_none());
    let corners = still.flat_map(|t| t.corners);
    let heights = corners.map(|c| f64::from(scene.mesh.positions[c as usize].z));
    heights.fold([scene.water.level; 2], |[low, high], z| {
        [low.min(z), high.max(z)]
    })
}
