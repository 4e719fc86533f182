//! Shader modules and pipelines, made once and shared by all plans.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use meniscus_pipeline::PlannedPass;
use meniscus_shader::{Binding, BindingKind, Entry, Sample, Shader};

use crate::geometry::Vertex;
use crate::{Gpu, GpuError, formats};

/// Shader modules by content, and pipelines by content, numbers and formats. It belongs to the
/// [`Gpu`] that first used it.
#[derive(Debug, Default)]
pub struct PipelineCache {
    modules: Mutex<HashMap<String, wgpu::ShaderModule>>,
    pipelines: Mutex<HashMap<Key, Arc<Pipeline>>>,
    given: OnceLock<wgpu::ShaderModule>,
}

/// The vertex stage of passes whose triangle is given.
const GIVEN_TRIANGLE: &str = "
@vertex fn corner(@location(0) clip: vec4f) -> @builtin(position) vec4f {
    return clip;
}";

/// What a pipeline depends on.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct Key {
    hash: String,
    /// Bits, since numbers that differ in them may mean something else.
    numbers: Vec<(String, u64)>,
    formats: Vec<wgpu::TextureFormat>,
    depth: bool,
    /// Drawn as a triangle that is given, tested against depths.
    tested: bool,
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
        let modules = self
            .modules
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .len();
        let pipelines = self
            .pipelines
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .len();
        (modules, pipelines)
    }

    /// The pipeline of a pass that writes targets of these formats. One that is `tested` draws a
    /// triangle whose clip-space corners it is given, where that is not behind a depth buffer.
    pub(crate) fn get(
        &self,
        gpu: &Gpu,
        pass: &PlannedPass,
        formats: &[wgpu::TextureFormat],
        tested: bool,
    ) -> Result<Arc<Pipeline>, GpuError> {
        let key = Key {
            hash: pass.shader.hash.clone(),
            numbers: constants(pass)
                .map(|(n, v)| (n.to_owned(), v.to_bits()))
                .collect(),
            formats: formats.to_vec(),
            depth: pass.depth.is_some(),
            tested,
        };
        let known = self
            .pipelines
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .get(&key)
            .cloned();
        if let Some(known) = known {
            return Ok(known);
        }
        // Made without holding the lock, so that passes can be compiled side by side; of two that
        // are the same, the first to be done stays.
        let module = self.module(gpu, pass)?;
        let given = match tested {
            true => Some(self.given_triangle(gpu)?),
            false => None,
        };
        let pipeline = Arc::new(make(gpu, pass, &module, formats, given.as_ref())?);
        let mut pipelines = self
            .pipelines
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        Ok(pipelines.entry(key).or_insert(pipeline).clone())
    }

    fn given_triangle(&self, gpu: &Gpu) -> Result<wgpu::ShaderModule, GpuError> {
        if let Some(known) = self.given.get() {
            return Ok(known.clone());
        }
        let module = gpu.create("the shader of a given triangle", || {
            let source = wgpu::ShaderSource::Wgsl(Cow::Borrowed(GIVEN_TRIANGLE));
            let label = Some("a given triangle");
            gpu.device()
                .create_shader_module(wgpu::ShaderModuleDescriptor { label, source })
        })?;
        Ok(self.given.get_or_init(|| module).clone())
    }

    fn module(&self, gpu: &Gpu, pass: &PlannedPass) -> Result<wgpu::ShaderModule, GpuError> {
        let shader = &pass.shader;
        let known = self
            .modules
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .get(&shader.hash)
            .cloned();
        if let Some(known) = known {
            return Ok(known);
        }
        let module = shader_module(gpu, &pass.name, &shader.module)?;
        let mut modules = self.modules.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(modules.entry(shader.hash.clone()).or_insert(module).clone())
    }
}

/// The numbers that a pipeline is made with: all but the live ones, which stand in a buffer.
fn constants(pass: &PlannedPass) -> impl Iterator<Item = (&str, f64)> {
    let is_live = |name: &str| pass.shader.live.iter().any(|number| number.name == name);
    let numbers = pass.numbers.iter().map(|(name, value)| (name.as_str(), *value));
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
    given: Option<&wgpu::ShaderModule>,
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
                cache: None,
            };
            Stages::Compute(gpu.create(&what, || device.create_compute_pipeline(&descriptor))?)
        }
        Entry::Render { vertex, fragment } => {
            let attributes = attributes(pass, &pass.shader)?;
            let buffer = wgpu::VertexBufferLayout {
                array_stride: size_of::<Vertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &attributes,
            };
            let corner = wgpu::VertexBufferLayout {
                array_stride: 16,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &wgpu::vertex_attr_array![0 => Float32x4],
            };
            let buffers = match given {
                Some(_) => vec![Some(corner)],
                None if attributes.is_empty() => vec![],
                None => vec![Some(buffer)],
            };
            // Reversed depth: near/z, 0 at infinity.
            let depth = wgpu::DepthStencilState {
                format: wgpu::TextureFormat::Depth32Float,
                depth_write_enabled: Some(given.is_none()),
                depth_compare: Some(match given {
                    Some(_) => wgpu::CompareFunction::GreaterEqual,
                    None => wgpu::CompareFunction::Greater,
                }),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            };
            let targets: Vec<_> = formats.iter().map(|&format| Some(format.into())).collect();
            let descriptor = wgpu::RenderPipelineDescriptor {
                label,
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: given.unwrap_or(module),
                    entry_point: Some(given.map_or(vertex, |_| "corner")),
                    compilation_options: match given {
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
                depth_stencil: (pass.depth.is_some() || given.is_some()).then_some(depth),
                primitive: wgpu::PrimitiveState::default(),
                multisample: wgpu::MultisampleState::default(),
                multiview_mask: None,
                cache: None,
            };
            Stages::Render(gpu.create(&what, || device.create_render_pipeline(&descriptor))?)
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
