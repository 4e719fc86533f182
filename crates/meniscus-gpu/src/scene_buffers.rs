//! A scene's triangles on the GPU, shared by all frames that show it.

use std::ops::Range;

use meniscus_pipeline::Geometry;
use meniscus_scene::Scene;
use wgpu::util::DeviceExt;

use crate::geometry::{Triangles, WaterBand};
use crate::host_scene::HostScene;
use crate::scene_arrays::SceneArrays;
use crate::{Gpu, GpuError};

/// A scene on the GPU: its triangles are uploaded once, in an order in which either side of the
/// water is one range of them.
#[derive(Debug)]
pub struct SceneBuffers {
    pub(crate) host: HostScene,
    arrays: SceneArrays,
    band: WaterBand,
    triangles: usize,
    heights: [f64; 2],
    geometry: Option<GeometryBuffers>,
    above: Range<u32>,
    below: Range<u32>,
    bytes: u64,
}

#[derive(Debug)]
pub(crate) struct GeometryBuffers {
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
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
        let vertices: &[u8] = bytemuck::cast_slice(&made.vertices);
        let indices: &[u8] = bytemuck::cast_slice(&made.indices);
        let limit = gpu.device().limits().max_buffer_size;
        for (what, bytes) in [("vertices", vertices), ("indices", indices)] {
            if bytes.len() as u64 > limit {
                return Err(GpuError::Size(format!(
                    "the scene's {what} take {} bytes; the adapter allows {limit} (max_buffer_size)",
                    bytes.len()
                )));
            }
        }
        let buffer = |what: &str, contents: &[u8], usage| {
            let descriptor = wgpu::util::BufferInitDescriptor {
                label: Some(what),
                contents,
                usage,
            };
            let device = gpu.device();
            gpu.create(&format!("the buffer of {what}"), || {
                device.create_buffer_init(&descriptor)
            })
        };
        let geometry = if made.indices.is_empty() {
            None
        } else {
            Some(GeometryBuffers {
                vertices: buffer("vertices", vertices, wgpu::BufferUsages::VERTEX)?,
                indices: buffer("indices", indices, wgpu::BufferUsages::INDEX)?,
            })
        };
        Ok(Self {
            host: HostScene::new(scene),
            arrays: SceneArrays::new(scene),
            band,
            triangles: scene.mesh.triangles.len(),
            heights: heights(scene),
            geometry,
            above: made.above,
            below: made.below,
            bytes: (vertices.len() + indices.len()) as u64,
        })
    }

    /// Bytes of vertices and indices, and of what is uploaded for rays so far.
    pub fn bytes(&self) -> u64 {
        self.bytes + self.arrays.bytes()
    }

    /// How long it took to sort the triangles for rays (`bvh_nodes`), milliseconds; none while no
    /// frame of this scene has asked for it.
    pub fn build_ms(&self) -> Option<f64> {
        self.arrays.build_ms()
    }

    /// How long it took to measure distances to the triangles (`distance_voxels`), milliseconds;
    /// none while no frame of this scene has asked for them.
    pub fn distance_field_ms(&self) -> Option<f64> {
        self.arrays.distance_field_ms()
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

    /// The buffers of triangles; none where there are no triangles.
    pub(crate) fn buffers(&self) -> Option<&GeometryBuffers> {
        self.geometry.as_ref()
    }

    /// The range of indices that is drawn; empty where nothing is.
    pub(crate) fn range(&self, geometry: Geometry, eye_above: bool) -> Range<u32> {
        match (geometry, eye_above) {
            (Geometry::All, _) => self.above.start..self.below.end,
            (Geometry::NearSide, true) | (Geometry::FarSide, false) => self.above.clone(),
            (Geometry::NearSide, false) | (Geometry::FarSide, true) => self.below.clone(),
        }
    }
}

fn heights(scene: &Scene) -> [f64; 2] {
    let corners = scene.mesh.triangles.iter().flat_map(|t| t.corners);
    let heights = corners.map(|c| f64::from(scene.mesh.positions[c as usize].z));
    heights.fold([scene.water.level; 2], |[low, high], z| {
        [low.min(z), high.max(z)]
    })
}
