//! What each pass is given: its bind group.

use meniscus_pipeline::PlannedPass;
use meniscus_shader::{Binding, BindingKind, LIVE_NUMBERS};

use crate::host_buffers::HostBuffers;
use crate::host_scene::HostScene;
use crate::host_uses::HostUse;
use crate::live::LiveNumbers;
use crate::resources::Resources;
use crate::scene_arrays::SceneArrays;
use crate::{Gpu, GpuError, formats, uses};

/// Connects the names of shaders to resources.
pub(crate) struct Binder<'a> {
    pub gpu: &'a Gpu,
    pub resources: &'a Resources,
    pub scene: &'a HostScene,
    pub arrays: &'a SceneArrays,
    pub host: HostBuffers,
    pub live: LiveNumbers,
    /// What the pass that was bound last reads of the host's buffers.
    pub host_uses: Vec<HostUse>,
}

/// A resource that is bound.
enum Bound<'a> {
    Buffer(wgpu::Buffer),
    View(&'a wgpu::TextureView),
    Sampler(&'a wgpu::Sampler),
}

impl Bound<'_> {
    fn entry(&self, binding: u32) -> wgpu::BindGroupEntry<'_> {
        let resource = match self {
            Self::Buffer(buffer) => buffer.as_entire_binding(),
            Self::View(view) => wgpu::BindingResource::TextureView(view),
            Self::Sampler(sampler) => wgpu::BindingResource::Sampler(sampler),
        };
        wgpu::BindGroupEntry { binding, resource }
    }
}

impl<'a> Binder<'a> {
    /// The bind group of a pass.
    ///
    /// # Errors
    /// When a name is connected to nothing, or to something of another kind.
    pub fn bind(
        &mut self,
        pass: &PlannedPass,
        layout: &wgpu::BindGroupLayout,
    ) -> Result<wgpu::BindGroup, GpuError> {
        self.host_uses.clear();
        let mut bound = Vec::with_capacity(pass.shader.bindings.len());
        for binding in &pass.shader.bindings {
            bound.push((binding.index, self.resource(pass, binding)?));
        }
        let entries: Vec<_> = bound
            .iter()
            .map(|(index, bound)| bound.entry(*index))
            .collect();
        let descriptor = wgpu::BindGroupDescriptor {
            label: Some(&pass.name),
            layout,
            entries: &entries,
        };
        let device = self.gpu.device();
        self.gpu
            .create(&format!("the bind group of `{}`", pass.name), || {
                device.create_bind_group(&descriptor)
            })
    }

    fn resource(&mut self, pass: &PlannedPass, binding: &Binding) -> Result<Bound<'a>, GpuError> {
        match binding.kind {
            BindingKind::Storage { .. } if binding.resource == LIVE_NUMBERS => {
                Ok(Bound::Buffer(self.live.add(self.gpu, pass)?))
            }
            BindingKind::Uniform(ty) | BindingKind::Storage { ty, .. } => {
                match self.resources.buffers.get(&binding.resource) {
                    Some(buffer) => Ok(Bound::Buffer(buffer.clone())),
                    None if SceneArrays::has(&binding.resource) => {
                        let buffer = self.arrays.get(self.gpu, pass, binding, ty)?;
                        Ok(Bound::Buffer(buffer))
                    }
                    None => {
                        let views = &self.resources.views;
                        let buffer = self
                            .host
                            .get(self.gpu, pass, binding, ty, self.scene, views)?;
                        let used = HostUse::new(&pass.shader, binding, &buffer);
                        self.host_uses.push(used);
                        Ok(Bound::Buffer(buffer))
                    }
                }
            }
            BindingKind::Texture { filtered, .. } => self.texture(pass, binding, filtered),
            BindingKind::StorageTexture { .. } => self.texture(pass, binding, false),
            BindingKind::Sampler => Ok(Bound::Sampler(&self.resources.sampler)),
        }
    }

    fn texture(
        &self,
        pass: &PlannedPass,
        binding: &Binding,
        filtered: bool,
    ) -> Result<Bound<'a>, GpuError> {
        let name = uses::texture_name(pass, binding);
        let wrong = |message: String| {
            Err(GpuError::Plan(format!(
                "pass `{}` connects `{}` to `{name}`, {message}",
                pass.name, binding.variable
            )))
        };
        let Some(target) = self.resources.textures.get(name) else {
            return wrong("a texture that is not there".to_owned());
        };
        if filtered && !formats::is_filterable(target.format) {
            return wrong(format!(
                "whose format {:?} cannot be filtered: sample it without a sampler, by textureLoad",
                target.format
            ));
        }
        if let BindingKind::StorageTexture { format, .. } = binding.kind
            && formats::storage(format) != Some(formats::to_wgpu(target.format))
        {
            return wrong(format!(
                "whose format is {:?}, and declares it as {format:?}",
                target.format
            ));
        }
        Ok(Bound::View(&target.view))
    }
}
