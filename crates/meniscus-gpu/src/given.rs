//! Blocks, arrays, textures and samplers that a compute shader is given as plain words.

use half::f16;

use crate::{Gpu, GpuError, pipelines};

/// What a shader reads, in words of four bytes.
#[derive(Debug, Clone, Copy)]
pub enum Given<'a> {
    /// A uniform block.
    Uniform(&'a [u32]),
    /// A storage buffer that is only read.
    Storage(&'a [u32]),
    /// A texture of one layer and level.
    Texture {
        /// Width and height.
        size: [u32; 2],
        /// What its texels are.
        texels: GivenTexels,
        /// Four words a texel, row by row; of a depth the first counts.
        words: &'a [[u32; 4]],
    },
    /// A sampler that mixes texels and keeps to the edge.
    Sampler,
}

/// Kinds of texels that can be given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GivenTexels {
    /// Floats that are loaded one by one.
    Float,
    /// Floats that samplers mix: kept in 16 bits, which every adapter filters.
    Filtered,
    /// Signed integers.
    Sint,
    /// Unsigned integers.
    Uint,
    /// Depths from 0 to 1.
    Depth,
}

/// What has been given, on the adapter.
#[derive(Debug)]
pub(crate) enum Bound {
    Buffer(wgpu::Buffer),
    Texture(wgpu::TextureView),
    Sampler(wgpu::Sampler),
}

impl Bound {
    pub(crate) fn resource(&self) -> wgpu::BindingResource<'_> {
        match self {
            Self::Buffer(buffer) => buffer.as_entire_binding(),
            Self::Texture(view) => wgpu::BindingResource::TextureView(view),
            Self::Sampler(sampler) => wgpu::BindingResource::Sampler(sampler),
        }
    }
}

impl Given<'_> {
    pub(crate) fn binding_type(&self) -> wgpu::BindingType {
        let buffer = |ty| wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        match self {
            Self::Uniform(_) => buffer(wgpu::BufferBindingType::Uniform),
            Self::Storage(_) => buffer(wgpu::BufferBindingType::Storage { read_only: true }),
            Self::Texture { texels, .. } => wgpu::BindingType::Texture {
                sample_type: match texels {
                    GivenTexels::Float => wgpu::TextureSampleType::Float { filterable: false },
                    GivenTexels::Filtered => wgpu::TextureSampleType::Float { filterable: true },
                    GivenTexels::Sint => wgpu::TextureSampleType::Sint,
                    GivenTexels::Uint => wgpu::TextureSampleType::Uint,
                    GivenTexels::Depth => wgpu::TextureSampleType::Depth,
                },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            Self::Sampler => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        }
    }

    pub(crate) fn upload(&self, gpu: &Gpu) -> Result<Bound, GpuError> {
        match self {
            Self::Uniform(words) => buffer(gpu, words, wgpu::BufferUsages::UNIFORM),
            Self::Storage(words) => buffer(gpu, words, wgpu::BufferUsages::STORAGE),
            Self::Texture {
                size,
                texels,
                words,
            } => texture(gpu, *size, *texels, words),
            Self::Sampler => {
                let descriptor = wgpu::SamplerDescriptor {
                    mag_filter: wgpu::FilterMode::Linear,
                    min_filter: wgpu::FilterMode::Linear,
                    ..Default::default()
                };
                let sampler =
                    gpu.create("a sampler", || gpu.device().create_sampler(&descriptor))?;
                Ok(Bound::Sampler(sampler))
            }
        }
    }
}

fn buffer(gpu: &Gpu, words: &[u32], usage: wgpu::BufferUsages) -> Result<Bound, GpuError> {
    let descriptor = wgpu::BufferDescriptor {
        label: Some("given"),
        size: 4 * words.len().max(1) as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    };
    let buffer = gpu.create("what is given", || gpu.device().create_buffer(&descriptor))?;
    gpu.attempt("writing what is given", || {
        gpu.queue()
            .write_buffer(&buffer, 0, bytemuck::cast_slice(words));
    })?;
    Ok(Bound::Buffer(buffer))
}

fn texture(
    gpu: &Gpu,
    size: [u32; 2],
    texels: GivenTexels,
    words: &[[u32; 4]],
) -> Result<Bound, GpuError> {
    if words.len() as u64 != u64::from(size[0]) * u64::from(size[1]) || words.is_empty() {
        return Err(GpuError::Size(format!(
            "a texture of {} × {} texels was given {}",
            size[0],
            size[1],
            words.len()
        )));
    }
    let (format, bytes) = match texels {
        GivenTexels::Sint => (wgpu::TextureFormat::Rgba32Sint, plain(words)),
        GivenTexels::Uint => (wgpu::TextureFormat::Rgba32Uint, plain(words)),
        GivenTexels::Float | GivenTexels::Depth => (wgpu::TextureFormat::Rgba32Float, plain(words)),
        GivenTexels::Filtered => (wgpu::TextureFormat::Rgba16Float, halves(words)?),
    };
    let source = made(gpu, size, format, wgpu::TextureUsages::COPY_DST)?;
    gpu.attempt("writing a texture", || {
        gpu.queue().write_texture(
            source.as_image_copy(),
            &bytes,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some((bytes.len() / size[1] as usize) as u32),
                rows_per_image: None,
            },
            extent(size),
        );
    })?;
    let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
    match texels {
        GivenTexels::Depth => Ok(Bound::Texture(view(&as_depth(gpu, &source, size)?))),
        _ => Ok(Bound::Texture(view(&source))),
    }
}

fn plain(words: &[[u32; 4]]) -> Vec<u8> {
    bytemuck::cast_slice(words).to_vec()
}

/// Half floats; an error where one cannot hold a number.
fn halves(words: &[[u32; 4]]) -> Result<Vec<u8>, GpuError> {
    let half = |word: &u32| {
        let number = f32::from_bits(*word);
        let half = f16::from_f32(number);
        (half.to_f32() == number)
            .then(|| half.to_bits().to_le_bytes())
            .ok_or_else(|| {
                GpuError::Plan(format!(
                    "a texture that a sampler reads holds {number}, which 16 bits cannot"
                ))
            })
    };
    let halves: Result<Vec<[u8; 2]>, GpuError> = words.iter().flatten().map(half).collect();
    Ok(halves?.concat())
}

fn extent(size: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width: size[0],
        height: size[1],
        depth_or_array_layers: 1,
    }
}

fn made(
    gpu: &Gpu,
    size: [u32; 2],
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> Result<wgpu::Texture, GpuError> {
    let descriptor = wgpu::TextureDescriptor {
        label: Some("given"),
        size: extent(size),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    gpu.create("a texture", || gpu.device().create_texture(&descriptor))
}

/// Depths cannot be copied from memory: a triangle that covers everything writes them.
const DEPTH_SHADER: &str = "
@group(0) @binding(0) var texels: texture_2d<f32>;

@vertex
fn corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn depth(@builtin(position) at: vec4f) -> @builtin(frag_depth) f32 {
    return textureLoad(texels, vec2i(at.xy), 0).x;
}";

fn as_depth(gpu: &Gpu, source: &wgpu::Texture, size: [u32; 2]) -> Result<wgpu::Texture, GpuError> {
    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
    let depth = made(gpu, size, FORMAT, wgpu::TextureUsages::RENDER_ATTACHMENT)?;
    let device = gpu.device();
    let shader = gpu.create("the shader of depths", || {
        device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(DEPTH_SHADER.into()),
        })
    })?;
    let layout = gpu.create("the bindings of depths", || {
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Float { filterable: false },
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
                count: None,
            }],
        })
    })?;
    let pipeline_layout = pipelines::device_layout(gpu, "depths", &layout)?;
    let pipeline = gpu.create("the pipeline of depths", || {
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &shader,
                entry_point: Some("corner"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Always),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &shader,
                entry_point: Some("depth"),
                compilation_options: Default::default(),
                targets: &[],
            }),
            multiview_mask: None,
            cache: None,
        })
    })?;
    gpu.attempt("writing depths", || {
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(
                    &source.create_view(&Default::default()),
                ),
            }],
        });
        let view = depth.create_view(&Default::default());
        let mut encoder = device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &view,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(0.0),
                        store: wgpu::StoreOp::Store,
                    }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.draw(0..3, 0..1);
        }
        gpu.queue().submit([encoder.finish()]);
    })?;
    Ok(depth)
}
