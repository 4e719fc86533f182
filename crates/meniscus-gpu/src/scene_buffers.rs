//! A scene's triangles on the GPU, shared by all frames that show it.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use meniscus_pipeline::Geometry;
use meniscus_scene::Scene;
use wgpu::util::DeviceExt;

use crate::geometry::{Triangles, Vertex, WaterBand};
use crate::host_scene::HostScene;
use crate::scene_arrays::SceneArrays;
use crate::sight::Sight;
use crate::subdivide::{self, BOW_PX};
use crate::{Gpu, GpuError};

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
    facts: FarSide,
}

/// Something that was made of a scene on the CPU before it could be drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preprocessing {
    /// What was made: `bvh` (triangles in boxes, for rays), `distance_field` (distances to the
    /// triangles), `far_side` (triangles divided for flat water and the camera that asked last).
    pub name: &'static str,
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
    fn new(gpu: &Gpu, vertices: &[Vertex], indices: &[u32]) -> Result<Self, GpuError> {
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
                usage,
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

    fn bytes(&self) -> u64 {
        self.vertices.size() + self.indices.size()
    }

    fn count(&self) -> u32 {
        (self.indices.size() / 4) as u32
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
        let made = Triangles::new(&scene.mesh, band)?;
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
            heights: heights(scene),
            made,
            geometry,
            bow_px: BOW_PX,
            far: Mutex::default(),
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
        geometry.map(GeometryBuffers::bytes).sum::<u64>() + self.arrays.bytes()
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
        let bvh = |ms| {
            (
                ms,
                self.arrays
                    .bytes_of(&["triangles", "bvh_nodes", "bvh_wide_nodes"]),
            )
        };
        let distances = ["distance_grids", "distance_voxels", "distance_objects"];
        let field = |ms| (ms, self.arrays.bytes_of(&distances));
        let made = [
            ("bvh", self.arrays.build_ms().map(bvh)),
            ("distance_field", self.arrays.distance_field_ms().map(field)),
            ("far_side", far),
        ];
        let told = |(name, cost): (&'static str, Option<(f64, u64)>)| {
            cost.map(|(ms, bytes)| Preprocessing { name, ms, bytes })
        };
        made.into_iter().filter_map(told).collect()
    }

    /// The arrays that are made of the triangles.
    pub(crate) fn arrays(&self) -> &SceneArrays {
        &self.arrays
    }

    /// Whether a frame of these triangles can show this scene: the mesh is taken to be the same,
    /// and the heights between which the water may lie have to be.
    pub(crate) fn fits(&self, scene: &Scene) -> bool {
        self.band == WaterBand::of(scene) && self.triangles == scene.mesh.triangles.len()
    }

    /// The lowest and highest z of what is drawn.
    pub(crate) fn heights(&self) -> [f64; 2] {
        self.heights
    }

    /// What to draw; none where there is nothing. The far side is divided for `sight` if that has
    /// not been done yet.
    ///
    /// # Errors
    /// When the adapter does not allow so large buffers.
    pub(crate) fn drawing(
        &self,
        gpu: &Gpu,
        geometry: Geometry,
        sight: &Sight,
    ) -> Result<Option<(GeometryBuffers, Range<u32>)>, GpuError> {
        let range = self.range(geometry, sight.eye_above());
        let Some(whole) = self.geometry.as_ref().filter(|_| !range.is_empty()) else {
            return Ok(None);
        };
        if geometry != Geometry::FarSide {
            return Ok(Some((whole.clone(), range)));
        }
        let (buffers, range) = match self.far(gpu, sight)?.divided {
            Some(divided) => {
                let all = 0..divided.count();
                (divided, all)
            }
            None => (whole.clone(), range),
        };
        Ok(Some((buffers, range)).filter(|(_, range)| !range.is_empty()))
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
        let range = self.range(Geometry::FarSide, sight.eye_above());
        let triangles = range.len() / 3;
        let budget = subdivide::budget(triangles);
        let divided = subdivide::divided(&self.made, range, self.band, sight, self.bow_px, budget);
        let facts = FarSide {
            triangles: triangles as u64,
            drawn: divided.as_ref().map_or(triangles, |d| d.indices.len() / 3) as u64,
            bow_px: divided.as_ref().map_or(self.bow_px, |d| d.bow_px),
            ms: start.elapsed().as_secs_f64() * 1e3,
        };
        let divided = divided.map(|d| GeometryBuffers::new(gpu, &d.vertices, &d.indices));
        let far = FarGeometry {
            divided: divided.transpose()?,
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

    /// The range of indices that is drawn; empty where nothing is.
    fn range(&self, geometry: Geometry, eye_above: bool) -> Range<u32> {
        let (above, below) = (&self.made.above, &self.made.below);
        match (geometry, eye_above) {
            (Geometry::All, _) => above.start..below.end,
            (Geometry::NearSide, true) | (Geometry::FarSide, false) => above.clone(),
            (Geometry::NearSide, false) | (Geometry::FarSide, true) => below.clone(),
        }
    }
}

/// The lowest and highest z of what is drawn and of the rest plane.
pub(crate) fn heights(scene: &Scene) -> [f64; 2] {
    let corners = scene.mesh.triangles.iter().flat_map(|t| t.corners);
    let heights = corners.map(|c| f64::from(scene.mesh.positions[c as usize].z));
    heights.fold([scene.water.level; 2], |[low, high], z| {
        [low.min(z), high.max(z)]
    })
}
