//! Large arrays made of a scene's triangles, for rays: built and uploaded when a shader first
//! reads them, once for all frames of the scene.

use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use glam::Vec3;
use meniscus_pipeline::PlannedPass;
use meniscus_scene::{Mesh, Scene};
use meniscus_shader::Binding;
use naga::{Handle, Type};
use wgpu::util::DeviceExt;

use crate::bvh::{Bvh, Node};
use crate::distance_field::{self, DistanceField};
use crate::layout::{self, Column};
use crate::wide_bvh::{WideNode, widened};
use crate::{Gpu, GpuError};

/// The arrays of one scene.
#[derive(Debug)]
pub(crate) struct SceneArrays {
    mesh: Mesh,
    /// The water's level, and how far above it its waves reach at most; metres.
    water: [f32; 2],
    tracing: OnceLock<Tracing>,
    /// By how many voxels were asked for.
    distances: Mutex<Vec<(u32, Arc<DistanceField>)>>,
    uploaded: Mutex<Vec<Uploaded>>,
}

#[derive(Debug)]
struct Uploaded {
    array: String,
    /// As `layout::signature` gives it: shaders may declare the members in another order.
    signature: String,
    /// Of the distance field that it is a part of, if it is.
    voxels: Option<u32>,
    buffer: wgpu::Buffer,
}

/// What rays are traced through.
#[derive(Debug)]
struct Tracing {
    bvh: Bvh,
    /// Made when a shader first reads it.
    wide: OnceLock<Vec<WideNode>>,
    triangles: Vec<Triangle>,
}

/// A triangle, in the order of the tree's leaves.
#[derive(Debug, Clone, Copy)]
struct Triangle {
    corners: [Vec3; 3],
    normals: [u32; 3],
    object: u32,
}

impl SceneArrays {
    /// Of a scene with a mesh whose corners are finite and their indices in range.
    pub fn new(scene: &Scene) -> Self {
        Self {
            mesh: scene.mesh.clone(),
            water: [scene.water.level, scene.water.height_bound()].map(|z| z as f32),
            tracing: OnceLock::new(),
            distances: Mutex::default(),
            uploaded: Mutex::default(),
        }
    }

    /// Whether there is an array of this name.
    pub fn has(array: &str) -> bool {
        matches!(array, "triangles" | "bvh_nodes" | "bvh_wide_nodes") || is_of_distances(array)
    }

    /// How long the tree took to build, milliseconds; none while nothing has asked for it.
    pub fn build_ms(&self) -> Option<f64> {
        self.tracing.get().map(|tracing| tracing.bvh.build_ms)
    }

    /// How long the distances took to measure, at all resolutions, milliseconds; none while nothing
    /// has asked for them.
    pub fn distance_field_ms(&self) -> Option<f64> {
        let held = held(&self.distances);
        let all = held.iter().map(|(_, field)| field.build_ms);
        (!held.is_empty()).then(|| all.sum())
    }

    /// Bytes that are uploaded of these arrays.
    pub fn bytes_of(&self, arrays: &[&str]) -> u64 {
        let held = self.held();
        let of = held.iter().filter(|u| arrays.contains(&u.array.as_str()));
        of.map(|u| u.buffer.size()).sum()
    }

    /// Bytes that are uploaded.
    pub fn bytes(&self) -> u64 {
        self.held().iter().map(|u| u.buffer.size()).sum()
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
        let voxels = is_of_distances(array).then(|| distance_field::voxels_asked(pass));
        let same =
            |u: &&Uploaded| u.array == array && u.signature == signature && u.voxels == voxels;
        if let Some(known) = held.iter().find(same) {
            return Ok(known.buffer.clone());
        }
        let bytes = self.laid_out(pass, binding, ty).map_err(|problem| {
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
                self.mesh.triangles.len(),
                bytes.len()
            )));
        }
        let descriptor = wgpu::util::BufferInitDescriptor {
            label: Some(array),
            contents: &bytes,
            usage: wgpu::BufferUsages::STORAGE,
        };
        let buffer = gpu.create(&format!("the buffer `{array}`"), || {
            gpu.device().create_buffer_init(&descriptor)
        })?;
        held.push(Uploaded {
            array: array.to_owned(),
            signature,
            voxels,
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
        let (array, module) = (binding.resource.as_str(), &pass.shader.module);
        if is_of_distances(array) {
            let field = self.distances(distance_field::voxels_asked(pass));
            let column = |member: &str| field.column(array, member);
            layout::column_bytes(module, ty, field.length(array), column)
        } else {
            let tracing = self.tracing.get_or_init(|| Tracing::new(&self.mesh));
            let column = |member: &str| tracing.column(array, member);
            layout::column_bytes(module, ty, tracing.length(array), column)
        }
    }

    /// The field with so many voxels, measured when it is first asked for.
    fn distances(&self, voxels: u32) -> Arc<DistanceField> {
        let mut held = held(&self.distances);
        if let Some((_, known)) = held.iter().find(|(of, _)| *of == voxels) {
            return known.clone();
        }
        let field = Arc::new(DistanceField::new(&self.mesh, self.water, voxels));
        held.push((voxels, field.clone()));
        field
    }

    fn held(&self) -> MutexGuard<'_, Vec<Uploaded>> {
        held(&self.uploaded)
    }
}

/// Nothing is left half done by a thread that ended while it held the lock.
fn held<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Whether an array is part of the distance field.
fn is_of_distances(array: &str) -> bool {
    matches!(
        array,
        "distance_grids" | "distance_voxels" | "distance_objects"
    )
}

impl Tracing {
    fn new(mesh: &Mesh) -> Self {
        let mut bvh = Bvh::new(mesh);
        let triangle = |&index: &u32| {
            let triangle = &mesh.triangles[index as usize];
            let corners = triangle.corners.map(|c| mesh.positions[c as usize]);
            let normal = |c: u32| mesh.normals.get(c as usize).copied().unwrap_or(Vec3::Z);
            Triangle {
                corners,
                normals: triangle.corners.map(|c| packed(normal(c))),
                object: triangle.object,
            }
        };
        let mut triangles: Vec<Triangle> = bvh.order.iter().map(triangle).collect();
        if triangles.is_empty() {
            // A leaf with a triangle of no area, which no ray meets: arrays cannot be empty.
            triangles.push(Triangle {
                corners: [Vec3::ZERO; 3],
                normals: [packed(Vec3::Z); 3],
                object: 0,
            });
            bvh.nodes.push(Node {
                low: Vec3::ZERO,
                high: Vec3::ZERO,
                first: 0,
                count: 1,
            });
        }
        Self {
            bvh,
            wide: OnceLock::new(),
            triangles,
        }
    }

    fn wide(&self) -> &[WideNode] {
        self.wide.get_or_init(|| widened(&self.bvh.nodes))
    }

    fn length(&self, array: &str) -> usize {
        match array {
            "triangles" => self.triangles.len(),
            "bvh_wide_nodes" => self.wide().len(),
            _ => self.bvh.nodes.len(),
        }
    }

    fn column(&self, array: &str, member: &str) -> Option<Column<'_>> {
        let (t, n) = (&self.triangles, &self.bvh.nodes);
        if array == "bvh_wide_nodes" {
            return self.wide_column(member);
        }
        Some(match (array, member) {
            ("triangles", "first") => Column::vec3(|i| t[i].corners[0]),
            ("triangles", "second") => Column::vec3(|i| t[i].corners[1]),
            ("triangles", "third") => Column::vec3(|i| t[i].corners[2]),
            ("triangles", "first_normal") => Column::u32(|i| t[i].normals[0]),
            ("triangles", "second_normal") => Column::u32(|i| t[i].normals[1]),
            ("triangles", "third_normal") => Column::u32(|i| t[i].normals[2]),
            ("triangles", "object") => Column::u32(|i| t[i].object),
            ("bvh_nodes", "low") => Column::vec3(|i| n[i].low),
            ("bvh_nodes", "high") => Column::vec3(|i| n[i].high),
            ("bvh_nodes", "first") => Column::u32(|i| n[i].first),
            ("bvh_nodes", "count") => Column::u32(|i| n[i].count),
            _ => return None,
        })
    }
}

impl Tracing {
    fn wide_column(&self, member: &str) -> Option<Column<'_>> {
        let wide = self.wide();
        let axis = ["x", "y", "z"].iter().position(|a| member.ends_with(a));
        let child = ["first", "second", "third", "fourth"]
            .iter()
            .position(|c| *c == member);
        Some(match (member, axis, child) {
            ("low", ..) => Column::vec3(|i| wide[i].low),
            ("step", ..) => Column::vec3(|i| wide[i].step),
            ("low_x" | "low_y" | "low_z", Some(axis), _) => {
                Column::u32(move |i| wide[i].lows[axis])
            }
            ("high_x" | "high_y" | "high_z", Some(axis), _) => {
                Column::u32(move |i| wide[i].highs[axis])
            }
            (_, _, Some(child)) => Column::u32(move |i| wide[i].children[child]),
            _ => return None,
        })
    }
}

/// A unit vector as `unpack2x16snorm` and the octahedral map find it again, to about 3e-5. One
/// without direction becomes z.
fn packed(v: Vec3) -> u32 {
    let sum = v.abs().element_sum();
    if !(sum > 0.0 && sum.is_finite()) {
        return 0;
    }
    let mut flat = v.truncate() / sum;
    if v.z < 0.0 {
        let sign = |x: f32| if x < 0.0 { -1.0 } else { 1.0 };
        flat = glam::Vec2::new(
            (1.0 - flat.y.abs()) * sign(flat.x),
            (1.0 - flat.x.abs()) * sign(flat.y),
        );
    }
    let part = |x: f32| u32::from((x.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16);
    part(flat.x) | part(flat.y) << 16
}

#[cfg(test)]
mod tests {
    use super::*;
    use meniscus_pipeline::host::{self, ValueType};

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
        Tracing::new(&mesh)
    }

    #[test]
    fn every_listed_member_has_a_column_of_its_type() {
        let field = DistanceField::new(&Mesh::default(), [0.0; 2], distance_field::VOXELS);
        for tracing in [arrays(), Tracing::new(&Mesh::default())] {
            for (array, members) in host::ARRAYS {
                for (member, ty) in members.iter().filter(|_| SceneArrays::has(array)) {
                    let column = tracing.column(array, member);
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

    #[test]
    fn triangles_keep_their_corners_and_objects_in_any_order() {
        let tracing = arrays();
        for triangle in &tracing.triangles {
            let last = [Vec3::Y, Vec3::NEG_X][triangle.object as usize - 5];
            assert_eq!(triangle.corners[2], last);
        }
        assert_ne!(tracing.triangles[0].object, tracing.triangles[1].object);
    }

    #[test]
    fn normals_are_found_again() {
        let unpacked = |bits: u32| {
            let part = |shift: u32| f32::from((bits >> shift) as u16 as i16) / 32767.0;
            let flat = glam::Vec2::new(part(0), part(16));
            let z = 1.0 - flat.x.abs() - flat.y.abs();
            let back = (-z).max(0.0);
            let sign = |x: f32| if x < 0.0 { -1.0 } else { 1.0 };
            let x = flat.x - sign(flat.x) * back;
            Vec3::new(x, flat.y - sign(flat.y) * back, z).normalize()
        };
        for i in 0..1000 {
            let (turn, z) = (2.4 * i as f32, i as f32 / 499.5 - 1.0);
            let v = ((1.0 - z * z).max(0.0).sqrt() * glam::Vec2::from_angle(turn)).extend(z);
            assert!(unpacked(packed(v)).distance(v) < 1e-4, "{v}");
        }
        for v in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
            assert_eq!(unpacked(packed(v)), Vec3::Z);
        }
    }
}
