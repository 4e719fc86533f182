//! Rectangles of a picture that may show water, found on the GPU: a pass over the water is drawn as
//! those.
//!
//! Threads look at depths from the rectangles' sides until they find water: where there is much of it
//! they are done at once, where there is little the pass itself has little to do.

use std::borrow::Cow;
use std::sync::OnceLock;

use meniscus_pipeline::Covers;
use wgpu::util::DeviceExt;

use crate::region::Region;
use crate::{Gpu, GpuError, pipelines};

/// Pixels on the side of a block that a workgroup looks at, and its threads, each of which may find a
/// rectangle.
const BLOCK: u32 = 128;
const WORKGROUP: u32 = 256;

const SHADER: &str = concat!(include_str!("wet.wgsl"), include_str!("tiles.wgsl"));

/// The vertex stage of passes that are drawn as tiles: two triangles each.
pub(crate) const VERTEX: &str = "
@vertex fn corner(@builtin(vertex_index) index: u32, @location(0) tile: vec4f) -> @builtin(position) vec4f {
    let first = array(0u, 1u, 2u, 3u, 2u, 1u)[index];
    let low = tile.xy;
    let high = tile.zw;
    return vec4f(select(low.x, high.x, (first & 1u) == 1u), select(low.y, high.y, first > 1u), 0.0, 1.0);
}";
/// Its entry point.
pub(crate) const VERTEX_ENTRY: &str = "corner";

/// What all lists of tiles are made with.
#[derive(Debug, Default)]
pub(crate) struct TilePipelines(OnceLock<Made>);

#[derive(Debug, Clone)]
struct Made {
    layout: wgpu::BindGroupLayout,
    classify: wgpu::ComputePipeline,
    finish: wgpu::ComputePipeline,
}

/// A list of tiles for one pass.
#[derive(Debug)]
pub(crate) struct Tiles {
    made: Made,
    region: wgpu::Buffer,
    count: wgpu::Buffer,
    list: wgpu::Buffer,
    arguments: wgpu::Buffer,
    bindings: wgpu::BindGroup,
    groups: u32,
}

impl TilePipelines {
    fn get(&self, gpu: &Gpu) -> Result<Made, GpuError> {
        if let Some(made) = self.0.get() {
            return Ok(made.clone());
        }
        let device = gpu.device();
        let module = gpu.create("the shader of tiles", || {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("tiles"),
                source: wgpu::ShaderSource::Wgsl(Cow::Borrowed(SHADER)),
            })
        })?;
        let buffer = |ty| wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let written = wgpu::BufferBindingType::Storage { read_only: false };
        let types = [
            buffer(wgpu::BufferBindingType::Uniform),
            wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Depth,
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            buffer(written),
            buffer(written),
            buffer(written),
        ];
        let entry = |(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty,
            count: None,
        };
        let entries: Vec<_> = (0..).zip(types).map(entry).collect();
        let layout = gpu.create("the bindings of tiles", || {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("tiles"),
                entries: &entries,
            })
        })?;
        let pipeline_layout = pipelines::device_layout(gpu, "tiles", &layout)?;
        let pipeline = |entry: &str| {
            gpu.compile("the pipeline of tiles", || {
                device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(entry),
                    layout: Some(&pipeline_layout),
                    module: &module,
                    entry_point: Some(entry),
                    compilation_options: Default::default(),
                    cache: gpu.driver_cache(),
                })
            })
        };
        let made = Made {
            classify: pipeline("classify")?,
            finish: pipeline("finish")?,
            layout,
        };
        Ok(self.0.get_or_init(|| made).clone())
    }
}

impl Tiles {
    /// For a pass over the water that what `front` holds stands before.
    pub fn new(
        gpu: &Gpu,
        pipelines: &TilePipelines,
        front: &wgpu::TextureView,
        region: &Region,
    ) -> Result<Self, GpuError> {
        use wgpu::BufferUsages as Usages;
        let made = pipelines.get(gpu)?;
        let device = gpu.device();
        let buffer = |what: &str, size: u64, usage| {
            gpu.create(what, || {
                device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some(what),
                    size,
                    usage: usage | Usages::STORAGE,
                    mapped_at_creation: false,
                })
            })
        };
        let blocks = ((region.size + (BLOCK - 1)) / BLOCK).element_product();
        let most = u64::from(blocks) * u64::from(WORKGROUP);
        let list = buffer("a list of tiles", 16 * most, Usages::VERTEX)?;
        let count = buffer("a count of tiles", 8, Usages::COPY_DST)?;
        let arguments = buffer("the draw of tiles", 16, Usages::INDIRECT)?;
        let values = gpu.create("the region of tiles", || {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("the region of tiles"),
                contents: &bytes(region),
                usage: Usages::UNIFORM | Usages::COPY_DST,
            })
        })?;
        let resources = [
            values.as_entire_binding(),
            wgpu::BindingResource::TextureView(front),
            count.as_entire_binding(),
            list.as_entire_binding(),
            arguments.as_entire_binding(),
        ];
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let bindings = gpu.create("the bind group of tiles", || {
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("tiles"),
                layout: &made.layout,
                entries: &entries,
            })
        })?;
        Ok(Self {
            groups: groups(region),
            region: values,
            made,
            count,
            list,
            arguments,
            bindings,
        })
    }

    /// Looks elsewhere; bytes that were written.
    pub fn update(&mut self, gpu: &Gpu, region: &Region) -> Result<u64, GpuError> {
        let bytes = bytes(region);
        gpu.attempt("writing the region of tiles", || {
            gpu.queue().write_buffer(&self.region, 0, &bytes);
        })?;
        self.groups = groups(region);
        Ok(bytes.len() as u64)
    }

    /// Records the making of the list.
    pub fn classify(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("tiles"),
            timestamp_writes: None,
        });
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.set_pipeline(&self.made.classify);
        pass.dispatch_workgroups(self.groups, 1, 1);
        pass.set_pipeline(&self.made.finish);
        pass.dispatch_workgroups(1, 1, 1);
    }

    /// Records the drawing of the tiles that were found.
    pub fn draw(&self, pass: &mut wgpu::RenderPass) {
        pass.set_vertex_buffer(0, self.list.slice(..));
        pass.draw_indirect(&self.arguments, 0);
    }

    /// How many dispatches the list takes.
    pub const DISPATCHES: u64 = 2;

    /// How many threads the list takes.
    pub fn threads(&self) -> u64 {
        u64::from(self.groups) * u64::from(WORKGROUP) + 1
    }

    /// Bytes of its buffers.
    pub fn bytes(&self) -> u64 {
        let buffers = [&self.region, &self.count, &self.list, &self.arguments];
        buffers.map(wgpu::Buffer::size).iter().sum()
    }
}

/// Workgroups for the water's rectangle.
fn groups(region: &Region) -> u32 {
    let rects = region.rects(Covers::Water);
    let blocks = rects.iter().map(|rect| {
        let (low, high) = (rect.low / BLOCK, (rect.high + (BLOCK - 1)) / BLOCK);
        (high - low).element_product()
    });
    blocks.sum()
}

/// The shader's `Region`.
fn bytes(region: &Region) -> [u8; 48] {
    let rects = region.rects(Covers::Water);
    let [low, high] = rects.first().map_or([[0; 2]; 2], |rect| {
        [rect.low.to_array(), rect.high.to_array()]
    });
    let [x, y, z] = region.plane.map(f32::to_bits);
    let size = region.size.as_vec2().to_array().map(f32::to_bits);
    let words = [
        x, y, z, 0, low[0], low[1], high[0], high[1], size[0], size[1], 0, 0,
    ];
    let mut bytes = [0; 48];
    bytes.copy_from_slice(bytemuck::cast_slice(&words));
    bytes
}
