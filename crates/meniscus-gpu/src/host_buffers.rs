//! Uniform blocks and small arrays of the host, in the layouts that shaders declare.

use std::ops::Range;
use std::sync::Arc;

use meniscus_pipeline::{PlannedPass, host};
use meniscus_shader::{Binding, Shader};
use naga::{Handle, Type};
use wgpu::util::DeviceExt;

use crate::host_scene::{HostScene, PassViews, Views};
use crate::{Gpu, GpuError, layout};

/// The host's buffers of one frame; passes that declare a block alike share it.
#[derive(Debug, Default)]
pub(crate) struct HostBuffers(Vec<HostBuffer>);

#[derive(Debug)]
struct HostBuffer {
    resource: String,
    /// The views of its pass; for blocks that hold none, the frame's stand here.
    view: PassViews,
    /// The shader that first declared it, and the type.
    shader: Arc<Shader>,
    ty: Handle<Type>,
    /// As `layout::signature` gives it.
    signature: String,
    bytes: Vec<u8>,
    /// What the last update replaced; empty where it changed nothing.
    before: Vec<u8>,
    buffer: wgpu::Buffer,
}

/// What became of new values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Written {
    /// They are in place; so many bytes were written.
    Bytes(u64),
    /// An array has another length now, so that its buffer has to be made anew.
    Outgrown,
}

impl HostBuffers {
    /// The buffer for a binding that the host serves; made where no earlier pass declared the same.
    ///
    /// # Errors
    /// When the host has nothing of that name, or not with these members.
    pub fn get(
        &mut self,
        gpu: &Gpu,
        pass: &PlannedPass,
        binding: &Binding,
        ty: Handle<Type>,
        scene: &HostScene,
        views: &Views,
    ) -> Result<wgpu::Buffer, GpuError> {
        let resource = binding.resource.as_str();
        let view = match resource {
            "view_target" => PassViews {
                target: pass.view_target,
                seen: pass.view_seen,
            },
            _ => PassViews::FRAME,
        };
        let signature = layout::signature(&pass.shader.module, ty);
        let same =
            |b: &&HostBuffer| b.resource == resource && b.view == view && b.signature == signature;
        if let Some(known) = self.0.iter().find(same) {
            return Ok(known.buffer.clone());
        }
        let bytes = bytes(resource, &pass.shader, ty, scene, views, view).map_err(|problem| {
            GpuError::Plan(format!(
                "pass `{}` cannot read `{resource}`: {problem}",
                pass.name
            ))
        })?;
        let descriptor = wgpu::util::BufferInitDescriptor {
            label: Some(resource),
            contents: &bytes,
            usage: wgpu::BufferUsages::UNIFORM
                | wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_DST,
        };
        let buffer = gpu.create(&format!("the buffer `{resource}`"), || {
            gpu.device().create_buffer_init(&descriptor)
        })?;
        self.0.push(HostBuffer {
            resource: resource.to_owned(),
            view,
            shader: pass.shader.clone(),
            ty,
            signature,
            bytes,
            before: Vec::new(),
            buffer: buffer.clone(),
        });
        Ok(buffer)
    }

    /// Writes what has changed.
    pub fn update(
        &mut self,
        gpu: &Gpu,
        scene: &HostScene,
        views: &Views,
    ) -> Result<Written, GpuError> {
        let mut fresh = Vec::with_capacity(self.0.len());
        for held in &self.0 {
            let new = bytes(
                &held.resource,
                &held.shader,
                held.ty,
                scene,
                views,
                held.view,
            )
            .map_err(|problem| {
                GpuError::Plan(format!("`{}` cannot be written: {problem}", held.resource))
            })?;
            if new.len() != held.bytes.len() {
                return Ok(Written::Outgrown);
            }
            fresh.push(new);
        }
        let mut written = 0;
        for (held, new) in self.0.iter_mut().zip(fresh) {
            held.before.clear();
            if new != held.bytes {
                let what = format!("writing `{}`", held.resource);
                gpu.attempt(&what, || gpu.queue().write_buffer(&held.buffer, 0, &new))?;
                written += new.len() as u64;
                held.before = std::mem::replace(&mut held.bytes, new);
            }
        }
        Ok(Written::Bytes(written))
    }

    /// Whether the last update changed some byte of a buffer within these ranges. A buffer that is
    /// not the host's never changes.
    pub fn changed(&self, buffer: &wgpu::Buffer, ranges: &[Range<usize>]) -> bool {
        let held = self.0.iter().find(|held| held.buffer == *buffer);
        held.is_some_and(|held| {
            let differs = |range: &Range<usize>| {
                held.before.get(range.clone()) != held.bytes.get(range.clone())
            };
            !held.before.is_empty() && ranges.iter().any(differs)
        })
    }
}

/// A uniform block of the host's for one pass.
struct Block<'a> {
    name: &'a str,
    scene: &'a HostScene,
    views: &'a Views,
    view: PassViews,
}

impl layout::Values for Block<'_> {
    fn value(&self, member: &str) -> Option<layout::Value> {
        self.scene.block(self.name, member, self.views, self.view)
    }

    fn length(&self, array: &str) -> Option<usize> {
        host::block_array(self.name, array)?;
        self.scene.array_length(array)
    }

    fn element(&self, array: &str, index: usize, member: &str) -> Option<layout::Value> {
        self.scene.element(array, index, member)
    }
}

/// The bytes of a block or array, in the layout that a shader declares.
pub(crate) fn bytes(
    resource: &str,
    shader: &Shader,
    ty: Handle<Type>,
    scene: &HostScene,
    views: &Views,
    view: PassViews,
) -> Result<Vec<u8>, String> {
    if let Some(length) = scene.array_length(resource) {
        let element = |index: usize, member: &str| scene.element(resource, index, member);
        layout::array_bytes(&shader.module, ty, length, &element)
    } else if HostScene::has_block(resource) {
        let block = Block {
            name: resource,
            scene,
            views,
            view,
        };
        layout::block_bytes(&shader.module, ty, &block)
    } else {
        Err("neither the pipeline nor the host has anything of that name".to_owned())
    }
}
