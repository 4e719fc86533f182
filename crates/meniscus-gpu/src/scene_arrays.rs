//! Large arrays made of a scene's triangles, for rays: built and uploaded when a shader first
//! reads them, once for all frames of the scene.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use meniscus_pipeline::PlannedPass;
use meniscus_scene::{Mesh, Moving, Scene};
use meniscus_shader::{Binding, Shader};
use naga::{Handle, Type};
use wgpu::util::DeviceExt;

use crate::distance_field::{self, DistanceField};
use crate::layout;
use crate::tracing::Tracing;
use crate::{Gpu, GpuError};

/// The arrays of one scene.
#[derive(Debug)]
pub(crate) struct SceneArrays {
    /// z of the water's level, metres.
    level: f64,
    /// The water's level, and how far above it its waves reach at most; metres.
    water: [f32; 2],
    state: Mutex<State>,
}

/// The arrays at some moment.
#[derive(Debug)]
struct State {
    mesh: Mesh,
    /// The bodies of the mesh, and the time at which it shows them.
    moving: Moving,
    tracing: Option<Tracing>,
    /// By how many voxels were asked for.
    distances: Vec<(u32, Arc<DistanceField>)>,
    uploaded: Vec<Uploaded>,
    /// Counts the moments at which something stood elsewhere.
    version: u64,
}

#[derive(Debug)]
struct Uploaded {
    array: String,
    /// As `layout::signature` gives it: shaders may declare the members in another order.
    signature: String,
    /// Of the distance field that it is a part of, if it is.
    voxels: Option<u32>,
    /// What declared it.
    shader: Arc<Shader>,
    ty: Handle<Type>,
    buffer: wgpu::Buffer,
}

/// What it took to follow what moves.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Followed {
    /// Of the arrays now.
    pub version: u64,
    /// Bytes that were written.
    pub bytes: u64,
    /// What the trees took, milliseconds.
    pub tree_ms: f64,
}

impl SceneArrays {
    /// Of a scene with a mesh whose corners are finite and their indices in range.
    pub fn new(scene: &Scene) -> Self {
        Self {
            level: scene.water.level,
            water: [scene.water.level, scene.water.height_bound()].map(|z| z as f32),
            state: Mutex::new(State {
                mesh: scene.mesh.clone(),
                moving: scene.moving.clone(),
                tracing: None,
                distances: Vec::new(),
                uploaded: Vec::new(),
                version: 0,
            }),
        }
    }

    /// Whether there is an array of this name.
    pub fn has(array: &str) -> bool {
        matches!(array, "triangles" | "bvh_nodes" | "bvh_wide_nodes") || is_of_distances(array)
    }

    /// How long the tree took to build, milliseconds; none while nothing has asked for it.
    pub fn build_ms(&self) -> Option<f64> {
        self.held().tracing.as_ref().map(|tracing| tracing.build_ms)
    }

    /// How long the distances took to measure that were asked for, by their voxels, milliseconds,
    /// and their bytes.
    pub fn distance_fields(&self) -> Vec<(u32, f64, u64)> {
        let held = self.held();
        let of = |voxels: u32| {
            let parts = held.uploaded.iter().filter(|u| u.voxels == Some(voxels));
            parts.map(|u| u.buffer.size()).sum()
        };
        let fields = held.distances.iter();
        fields
            .map(|(voxels, field)| (*voxels, field.build_ms, of(*voxels)))
            .collect()
    }

    /// Bytes that are uploaded of triangles and their trees.
    pub fn tracing_bytes(&self) -> u64 {
        let held = self.held();
        let parts = held.uploaded.iter().filter(|u| u.voxels.is_none());
        parts.map(|u| u.buffer.size()).sum()
    }

    /// Bytes that are uploaded.
    pub fn bytes(&self) -> u64 {
        self.held().uploaded.iter().map(|u| u.buffer.size()).sum()
    }

    /// Puts everything where it is at a time at which these stand so: trees get new boxes, and what
    /// has changed of them is uploaded. Distances are measured anew when they are next asked for, into
    /// other buffers.
    ///
    /// # Errors
    /// When the graphics library refuses.
    pub fn follow(&self, gpu: &Gpu, moving: &Moving) -> Result<Followed, GpuError> {
        let mut held = self.held();
        let state = &mut *held;
        let from = state.moving.time();
        let mut followed = Followed {
            version: state.version,
            ..Followed::default()
        };
        let bodies = moving.bodies().iter().enumerate();
        let moved = bodies.filter(|(_, body)| body.moves_between(from, moving.time()));
        let moved: Vec<usize> = moved.map(|(index, _)| index).collect();
        state.moving = moving.clone();
        if moved.is_empty() {
            return Ok(followed);
        }
        state.version += 1;
        followed.version = state.version;
        for &index in &moved {
            let body = &moving.bodies()[index];
            let points = body.points(moving.time(), self.level);
            for (&vertex, (position, normal)) in body.vertices().iter().zip(points) {
                state.mesh.positions[vertex as usize] = position;
                state.mesh.normals[vertex as usize] = normal;
            }
        }
        state.distances.clear();
        state.uploaded.retain(|uploaded| uploaded.voxels.is_none());
        if let Some(tracing) = &mut state.tracing {
            let start = Instant::now();
            tracing.follow(&state.mesh, &moved);
            followed.tree_ms = start.elapsed().as_secs_f64() * 1e3;
            for uploaded in &state.uploaded {
                followed.bytes += uploaded.write(gpu, tracing, &moved)?;
            }
        }
        Ok(followed)
    }

    /// The buffer of an array, in the layout that a shader declares.
    ///
    /// # Errors
    /// When the shader declares other members, and when the adapter does not allow so large a
    /// buffer.
    pub fn get(
        &self,
        gpu: &Gpu,
        pass: &PlannedPass,
        binding: &Binding,
        ty: Handle<Type>,
    ) -> Result<wgpu::Buffer, GpuError> {
        let array = binding.resource.as_str();
        let signature = layout::signature(&pass.shader.module, ty);
        let mut held = self.held();
        let state = &mut *held;
        let voxels = is_of_distances(array).then(|| distance_field::voxels_asked(pass));
        let same =
            |u: &&Uploaded| u.array == array && u.signature == signature && u.voxels == voxels;
        if let Some(known) = state.uploaded.iter().find(same) {
            return Ok(known.buffer.clone());
        }
        let bytes = state
            .laid_out(self.water, pass, binding, ty)
            .map_err(|problem| {
                GpuError::Plan(format!(
                    "pass `{}` cannot read `{array}`: {problem}",
                    pass.name
                ))
            })?;
        let limits = gpu.device().limits();
        let limit = limits
            .max_buffer_size
            .min(limits.max_storage_buffer_binding_size);
        if bytes.len() as u64 > limit {
            return Err(GpuError::Size(format!(
                "`{array}` of {} triangles takes {} bytes; the adapter allows {limit} \
                 (max_storage_buffer_binding_size)",
                state.mesh.triangles.len(),
                bytes.len()
            )));
        }
        let descriptor = wgpu::util::BufferInitDescriptor {
            label: Some(array),
            contents: &bytes,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        };
        let buffer = gpu.create(&format!("the buffer `{array}`"), || {
            gpu.device().create_buffer_init(&descriptor)
        })?;
        state.uploaded.push(Uploaded {
            array: array.to_owned(),
            signature,
            voxels,
            shader: pass.shader.clone(),
            ty,
            buffer: buffer.clone(),
        });
        Ok(buffer)
    }

    /// The bytes of an array, in the layout that a shader declares.
    ///
    /// # Errors
    /// When the shader declares other members.
    pub fn laid_out(
        &self,
        pass: &PlannedPass,
        binding: &Binding,
        ty: Handle<Type>,
    ) -> Result<Vec<u8>, String> {
        self.held().laid_out(self.water, pass, binding, ty)
    }

    fn held(&self) -> MutexGuard<'_, State> {
        // Nothing is left half done by a thread that ended while it held the lock.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn laid_out(
        &mut self,
        water: [f32; 2],
        pass: &PlannedPass,
        binding: &Binding,
        ty: Handle<Type>,
    ) -> Result<Vec<u8>, String> {
        let (array, module) = (binding.resource.as_str(), &pass.shader.module);
        if is_of_distances(array) {
            let field = self.distances(water, distance_field::voxels_asked(pass));
            let column = |member: &str| field.column(array, member);
            return layout::column_bytes(module, ty, field.length(array), column);
        }
        let (mesh, moving) = (&self.mesh, &self.moving);
        let tracing = self
            .tracing
            .get_or_insert_with(|| Tracing::new(mesh, moving));
        let column = |member: &str| tracing.column(array, member, 0);
        layout::column_bytes(module, ty, tracing.length(array), column)
    }

    /// The field with so many voxels, measured when it is first asked for.
    fn distances(&mut self, water: [f32; 2], voxels: u32) -> Arc<DistanceField> {
        if let Some((_, known)) = self.distances.iter().find(|(of, _)| *of == voxels) {
            return known.clone();
        }
        let field = Arc::new(DistanceField::new(&self.mesh, water, voxels));
        self.distances.push((voxels, field.clone()));
        field
    }
}

impl Uploaded {
    /// Writes what has changed of trees and triangles; how many bytes.
    fn write(&self, gpu: &Gpu, tracing: &Tracing, moved: &[usize]) -> Result<u64, GpuError> {
        let mut written = 0;
        let stride = self.buffer.size() / tracing.length(&self.array).max(1) as u64;
        for range in tracing.changed(&self.array, moved) {
            let column = |member: &str| tracing.column(&self.array, member, range.start);
            let bytes = layout::column_bytes(&self.shader.module, self.ty, range.len(), column)
                .map_err(|problem| {
                    GpuError::Plan(format!("`{}` cannot be written: {problem}", self.array))
                })?;
            gpu.attempt(&format!("writing `{}`", self.array), || {
                let offset = range.start as u64 * stride;
                gpu.queue().write_buffer(&self.buffer, offset, &bytes);
            })?;
            written += bytes.len() as u64;
        }
        Ok(written)
    }
}

/// Whether an array is part of the distance field.
pub(crate) fn is_of_distances(array: &str) -> bool {
    matches!(
        array,
        "distance_grids" | "distance_voxels" | "distance_objects"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use meniscus_pipeline::host::{self, ValueType};

    use crate::layout::Column;

    fn arrays() -> Tracing {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NEG_X],
            normals: vec![Vec3::Z, Vec3::X, Vec3::NEG_Y],
            triangles: [[0, 1, 2], [0, 2, 3]]
                .into_iter()
                .zip(5..)
                .map(|(corners, object)| meniscus_scene::Triangle { corners, object })
                .collect(),
        };
        Tracing::new(&mesh, &Moving::default())
    }

    #[test]
    fn every_listed_member_has_a_column_of_its_type() {
        let field = DistanceField::new(&Mesh::default(), [0.0; 2], distance_field::VOXELS);
        for tracing in [arrays(), Tracing::new(&Mesh::default(), &Moving::default())] {
            for (array, members) in host::ARRAYS {
                for (member, ty) in members.iter().filter(|_| SceneArrays::has(array)) {
                    let column = tracing.column(array, member, 0);
                    let found = match column.or(field.column(array, member)).unwrap() {
                        Column::F32(_) => ValueType::F32,
                        Column::Vec3(_) => ValueType::Vec3,
                        Column::U32(_) => ValueType::U32,
                    };
                    assert_eq!(found, *ty, "{array}.{member}");
                    assert!(tracing.length(array) > 0 && field.length(array) > 0);
                }
            }
        }
    }
}
