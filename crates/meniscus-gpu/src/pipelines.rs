//! Shader modules and pipelines, made once and shared by all plans.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use meniscus_pipeline::PlannedPass;
use meniscus_shader::{Binding, BindingKind, Entry, Sample, Shader};

use crate::geometry::Vertex;
use crate::tiles::TilePipelines;
use crate::{Gpu, GpuError, formats, tiles};

/// Shader modules by content, and pipelines by content, numbers and formats. It belongs to the
/// [`Gpu`] that first used it.
#[derive(Debug, Default)]
pub struct PipelineCache {
    modules: Mutex<HashMap<String, wgpu::ShaderModule>>,
    pipelines: Mutex<HashMap<Key, Arc<Pipeline>>>,
    tiled: OnceLock<wgpu::ShaderModule>,
    pub(crate) tiles: Arc<TilePipelines>,
}

/// What a pipeline depends on.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct Key {
    hash: String,
    /// Bits, since numbers that differ in them may mean something else.
    numbers: Vec<(String, u64)>,
    formats: Vec<wgpu::TextureFormat>,
    depth: bool,
    /// Drawn as tiles.
    tiled: bool,
}

/// A pipeline and the layout of its only bind group.
#[derive(Debug)]
pub(crate) struct Pipeline {
    pub layout: wgpu::BindGroupLayout,
    pub stages: Stages,
}

#[derive(Debug)]
pub(crate) enum Stages {
    Render(wgpu::RenderPipeline),
    Compute(wgpu::ComputePipeline),
}

impl PipelineCache {
    /// How many shader modules and how many pipelines were made.
    pub fn sizes(&self) -> (usize, usize) {
        (held(&self.modules).len(), held(&self.pipelines).len())
    }

    /// The pipeline of a pass that writes targets of these formats. One that is `tiled` draws tiles
    /// in place of the triangle over everything.
    pub(crate) fn get(
        &self,
        gpu: &Gpu,
        pass: &PlannedPass,
        formats: &[wgpu::TextureFormat],
        tiled: bool,
    ) -> Result<Arc<Pipeline>, GpuError> {
        let key = Key {
            hash: pass.shader.hash.clone(),
            numbers: constants(pass)
                .map(|(n, v)| (n.to_owned(), v.to_bits()))
                .collect(),
            formats: formats.to_vec(),
            depth: pass.depth.is_some(),
            tiled,
        };
        let known = held(&self.pipelines).get(&key).cloned();
        if let Some(known) = known {
            return Ok(known);
        }
        // Made without holding the lock, so that passes can be compiled side by side; of two that
        // are the same, the first to be done stays.
        let module = self.module(gpu, pass)?;
        let tiles = match tiled {
            true => Some(self.tile_vertices(gpu)?),
            false => None,
        };
        let pipeline = Arc::new(make(gpu, pass, &module, formats, tiles.as_ref())?);
        Ok(held(&self.pipelines).entry(key).or_insert(pipeline).clone())
    }

    fn tile_vertices(&self, gpu: &Gpu) -> Result<wgpu::ShaderModule, GpuError> {
        if let Some(known) = self.tiled.get() {
            return Ok(known.clone());
        }
        let module = gpu.create("the vertex shader of tiles", || {
            let source = wgpu::ShaderSource::Wgsl(Cow::Borrowed(tiles::VERTEX));
            let label = Some("the vertices of tiles");
            gpu.device()
                .create_shader_module(wgpu::ShaderModuleDescriptor { label, source })
        })?;
        Ok(self.tiled.get_or_init(|| module).clone())
    }

    fn module(&self, gpu: &Gpu, pass: &PlannedPass) -> Result<wgpu::ShaderModule, GpuError> {
        let shader = &pass.shader;
        let known = held(&self.modules).get(&shader.hash).cloned();
        if let Some(known) = known {
            return Ok(known);
        }
        let module = shader_module(gpu, &pass.name, &shader.module)?;
        let mut modules = held(&self.modules);
        let held = modules.entry(shader.hash.clone()).or_insert(module);
        Ok(held.clone())
    }
}

/// What a mutex guards; nothing that is held here can be left half-made.
fn held<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The numbers that a pipeline is made with: all but the live ones, which stand in a buffer.
fn constants(pass: &PlannedPass) -> impl Iterator<Item = (&str, f64)> {
    let is_live = |name: &str| pass.shader.live.iter().any(|number| number.name == name);
    let numbers = pass
        .numbers
        .iter()
        .map(|(name, value)| (name.as_str(), *value));
    numbers.filter(move |(name, _)| !is_live(name))
}

/// A shader module from the IR.
pub(crate) fn shader_module(
    gpu: &Gpu,
    name: &str,
    module: &naga::Module,
) -> Result<wgpu::ShaderModule, GpuError> {
    let source = wgpu::ShaderSource::Naga(Cow::Owned(module.clone()));
    gpu.create(&format!("the shader of `{name}`"), || {
        let label = Some(name);
        gpu.device()
            .create_shader_module(wgpu::ShaderModuleDescriptor { label, source })
    })
}

fn make(
    gpu: &Gpu,
    pass: &PlannedPass,
    module: &wgpu::ShaderModule,
    formats: &[wgpu::TextureFormat],
    tiles: Option<&wgpu::ShaderModule>,
) -> Result<Pipeline, GpuError> {
    let device = gpu.device();
    let label = Some(pass.name.as_str());
    let entries = layout_entries(pass)?;
    let layout = gpu.create(&format!("the bindings of `{}`", pass.name), || {
        let entries = &entries;
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries })
    })?;
    let pipeline_layout = device_layout(gpu, &pass.name, &layout)?;
    let constants: Vec<(&str, f64)> = constants(pass).collect();
    let options = wgpu::PipelineCompilationOptions {
        constants: &constants,
        ..Default::default()
    };
    let what = format!("the pipeline of `{}`", pass.name);
    let stages = match &pass.shader.entry {
        Entry::Compute { name, .. } => {
            let descriptor = wgpu::ComputePipelineDescriptor {
                label,
                layout: Some(&pipeline_layout),
                module,
                entry_point: Some(name),
                compilation_options: options,
                cache: gpu.driver_cache(),
            };
            Stages::Compute(gpu.compile(&what, || device.create_compute_pipeline(&descriptor))?)
        }
        Entry::Render { vertex, fragment } => {
            let attributes = attributes(pass, &pass.shader)?;
            let buffer = wgpu::VertexBufferLayout {
                array_stride: size_of::<Vertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &attributes,
            };
            let tile = wgpu::VertexBufferLayout {
                array_stride: 16,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: &wgpu::vertex_attr_array![0 => Float32x4],
            };
            let buffers = match tiles {
                Some(_) => vec![Some(tile)],
                None if attributes.is_empty() => vec![],
                None => vec![Some(buffer)],
            };
            let targets: Vec<_> = formats.iter().map(|&format| Some(format.into())).collect();
            let descriptor = wgpu::RenderPipelineDescriptor {
                label,
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: tiles.unwrap_or(module),
                    entry_point: Some(tiles.map_or(vertex.as_str(), |_| tiles::VERTEX_ENTRY)),
                    compilation_options: match tiles {
                        Some(_) => Default::default(),
                        None => options.clone(),
                    },
                    buffers: &buffers,
                },
                fragment: Some(wgpu::FragmentState {
                    module,
                    entry_point: Some(fragment),
                    compilation_options: options,
                    targets: &targets,
                }),
                // Reversed depth: near/z, 0 at infinity.
                depth_stencil: pass.depth.is_some().then(|| wgpu::DepthStencilState {
                    format: wgpu::TextureFormat::Depth32Float,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::Greater),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                primitive: wgpu::PrimitiveState::default(),
                multisample: wgpu::MultisampleState::default(),
                multiview_mask: None,
                cache: gpu.driver_cache(),
            };
            Stages::Render(gpu.compile(&what, || device.create_render_pipeline(&descriptor))?)
        }
    };
    Ok(Pipeline { layout, stages })
}

/// A pipeline layout with one bind group.
pub(crate) fn device_layout(
    gpu: &Gpu,
    name: &str,
    layout: &wgpu::BindGroupLayout,
) -> Result<wgpu::PipelineLayout, GpuError> {
    gpu.create(&format!("the pipeline layout of `{name}`"), || {
        gpu.device()
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(name),
                bind_group_layouts: &[Some(layout)],
                immediate_size: 0,
            })
    })
}

fn attributes(pass: &PlannedPass, shader: &Shader) -> Result<Vec<wgpu::VertexAttribute>, GpuError> {
    let attribute = |a: &meniscus_shader::Attribute| {
        let (format, offset) = Vertex::attribute(&a.name).ok_or_else(|| {
            GpuError::Plan(format!(
                "pass `{}` reads the unknown vertex attribute `{}`",
                pass.name, a.name
            ))
        })?;
        Ok(wgpu::VertexAttribute {
            format,
            offset,
            shader_location: a.location,
        })
    };
    shader.attributes.iter().map(attribute).collect()
}

fn layout_entries(pass: &PlannedPass) -> Result<Vec<wgpu::BindGroupLayoutEntry>, GpuError> {
    let entry = |binding: &Binding| {
        let ty = binding_type(binding).ok_or_else(|| {
            GpuError::Plan(format!(
                "pass `{}` declares `{}` as a texture of a kind that no pipeline has",
                pass.name, binding.variable
            ))
        })?;
        Ok(wgpu::BindGroupLayoutEntry {
            binding: binding.index,
            visibility: stages(binding),
            ty,
            count: None,
        })
    };
    pass.shader.bindings.iter().map(entry).collect()
}

fn stages(binding: &Binding) -> wgpu::ShaderStages {
    let used = [
        (binding.in_vertex, wgpu::ShaderStages::VERTEX),
        (binding.in_fragment, wgpu::ShaderStages::FRAGMENT),
        (binding.in_compute, wgpu::ShaderStages::COMPUTE),
    ];
    used.into_iter()
        .filter(|&(used, _)| used)
        .map(|(_, stage)| stage)
        .collect()
}

fn binding_type(binding: &Binding) -> Option<wgpu::BindingType> {
    let buffer = |ty| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    Some(match binding.kind {
        BindingKind::Uniform(_) => buffer(wgpu::BufferBindingType::Uniform),
        BindingKind::Storage { read_only, .. } => {
            buffer(wgpu::BufferBindingType::Storage { read_only })
        }
        BindingKind::Sampler => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        BindingKind::Texture {
            dimension: naga::ImageDimension::D2,
            sample,
            filtered,
        } => wgpu::BindingType::Texture {
            sample_type: match sample {
                Sample::Float => wgpu::TextureSampleType::Float {
                    filterable: filtered,
                },
                Sample::Depth => wgpu::TextureSampleType::Depth,
                Sample::Sint => wgpu::TextureSampleType::Sint,
                Sample::Uint => wgpu::TextureSampleType::Uint,
            },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        BindingKind::StorageTexture {
            dimension: naga::ImageDimension::D2,
            format,
            reads,
        } => wgpu::BindingType::StorageTexture {
            access: if reads {
                wgpu::StorageTextureAccess::ReadWrite
            } else {
                wgpu::StorageTextureAccess::WriteOnly
            },
            format: formats::storage(format)?,
            view_dimension: wgpu::TextureViewDimension::D2,
        },
        BindingKind::Texture { .. } | BindingKind::StorageTexture { .. } => return None,
    })
}
