//! One compute shader over plain bytes, for trying functions of modules.

use std::collections::BTreeMap;

use crate::given::{Bound, Given};
use crate::{Gpu, GpuError, pipelines, readback};

/// A compute entry point over bytes: the module reads a storage buffer at group 0, binding 0, and
/// writes one at group 0, binding 1. Made once and run often.
#[derive(Debug)]
pub struct Compute {
    gpu: Gpu,
    entry: String,
    group_size: u32,
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    given: Vec<(u32, Bound)>,
}

impl Compute {
    /// Prepares an entry point. `given`: what it reads besides, at bindings of group 0 from 2 on;
    /// `constants`: values of its `override`s by their names.
    ///
    /// # Errors
    /// When there is no such entry point, something given cannot be had, or the graphics library
    /// refuses the module.
    pub fn new(
        gpu: &Gpu,
        module: &naga::Module,
        entry: &str,
        given: &[(u32, Given<'_>)],
        constants: &BTreeMap<String, f64>,
    ) -> Result<Self, GpuError> {
        let found = module.entry_points.iter().find(|e| e.name == entry);
        let Some(point) = found.filter(|e| e.stage == naga::ShaderStage::Compute) else {
            return Err(GpuError::Plan(format!(
                "the module has no compute entry point `{entry}`"
            )));
        };
        let device = gpu.device();
        let storage = |binding: u32, read_only: bool| {
            layout_entry(
                binding,
                wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Storage { read_only },
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
            )
        };
        let mut entries = vec![storage(0, true), storage(1, false)];
        let mut bound = Vec::new();
        for (binding, given) in given {
            entries.push(layout_entry(*binding, given.binding_type()));
            bound.push((*binding, given.upload(gpu)?));
        }
        let layout = gpu.create("the bindings", || {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: None,
                entries: &entries,
            })
        })?;
        let shader = pipelines::shader_module(gpu, entry, module)?;
        let pipeline_layout = pipelines::device_layout(gpu, entry, &layout)?;
        let constants: Vec<(&str, f64)> = constants.iter().map(|(n, v)| (n.as_str(), *v)).collect();
        let pipeline = gpu.compile(&format!("the pipeline of `{entry}`"), || {
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: None,
                layout: Some(&pipeline_layout),
                module: &shader,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants,
                    ..Default::default()
                },
                cache: gpu.driver_cache(),
            })
        })?;
        Ok(Self {
            gpu: gpu.clone(),
            entry: entry.to_owned(),
            group_size: point.workgroup_size[0].max(1),
            pipeline,
            layout,
            given: bound,
        })
    }

    /// The most threads that one run may have.
    pub fn most_threads(&self) -> u32 {
        let limits = self.gpu.device().limits();
        let groups = limits.max_compute_workgroups_per_dimension;
        groups.saturating_mul(self.group_size)
    }

    /// Runs at least `threads` threads along x, rounded up to whole workgroups; the module has to
    /// stop those beyond its data itself. `output_len` bytes come back, zero where nothing was
    /// written; both lengths are rounded up to whole words inside.
    ///
    /// # Errors
    /// When lengths or threads are 0 or beyond the adapter's limits, and when the device is lost.
    pub fn run(&self, input: &[u8], output_len: usize, threads: u32) -> Result<Vec<u8>, GpuError> {
        let gpu = &self.gpu;
        let limits = gpu.device().limits();
        let groups = threads.div_ceil(self.group_size);
        let most = limits.max_compute_workgroups_per_dimension;
        if groups == 0 || groups > most {
            return Err(GpuError::Size(format!(
                "{threads} threads take {groups} workgroups; there are to be at least 1 and at most {most}"
            )));
        }
        let bytes = limits
            .max_buffer_size
            .min(limits.max_storage_buffer_binding_size);
        let mut buffers = Vec::new();
        for (what, len) in [("input", input.len()), ("output", output_len)] {
            let size = (len as u64).checked_next_multiple_of(4).unwrap_or(u64::MAX);
            if size == 0 || size > bytes {
                return Err(GpuError::Size(format!(
                    "an {what} of {len} bytes cannot be had; it is to have at least 1 and at most {bytes}"
                )));
            }
            let descriptor = wgpu::BufferDescriptor {
                label: Some(what),
                size,
                usage: wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_SRC
                    | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            };
            buffers.push(gpu.create(what, || gpu.device().create_buffer(&descriptor))?);
        }
        let mut padded = input.to_vec();
        padded.resize(buffers[0].size() as usize, 0);
        gpu.attempt("writing the input", || {
            gpu.queue().write_buffer(&buffers[0], 0, &padded)
        })?;
        self.dispatch(&buffers, groups)?;
        let mut output = readback::buffer(gpu, &buffers[1])?;
        output.truncate(output_len);
        Ok(output)
    }

    fn dispatch(&self, buffers: &[wgpu::Buffer], groups: u32) -> Result<(), GpuError> {
        let gpu = &self.gpu;
        let data = buffers.iter().enumerate();
        let data = data.map(|(binding, buffer)| (binding as u32, buffer.as_entire_binding()));
        let given = self.given.iter().map(|(b, bound)| (*b, bound.resource()));
        let entries: Vec<wgpu::BindGroupEntry<'_>> = data
            .chain(given)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let group = gpu.create("the bind group", || {
            gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &self.layout,
                entries: &entries,
            })
        })?;
        gpu.attempt(&format!("running `{}`", self.entry), || {
            let mut encoder = gpu.device().create_command_encoder(&Default::default());
            {
                let mut pass = encoder.begin_compute_pass(&Default::default());
                pass.set_pipeline(&self.pipeline);
                pass.set_bind_group(0, &group, &[]);
                pass.dispatch_workgroups(groups, 1, 1);
            }
            gpu.queue().submit([encoder.finish()]);
        })?;
        gpu.wait()
    }
}

fn layout_entry(binding: u32, ty: wgpu::BindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty,
        count: None,
    }
}

/// Runs a compute entry point once, with nothing but input and output: see [`Compute`].
///
/// # Errors
/// Those of [`Compute::new`] and [`Compute::run`].
pub fn run_compute(
    gpu: &Gpu,
    module: &naga::Module,
    entry: &str,
    input: &[u8],
    output_len: usize,
    threads: u32,
) -> Result<Vec<u8>, GpuError> {
    Compute::new(gpu, module, entry, &[], &BTreeMap::new())?.run(input, output_len, threads)
}
