//! One compute shader over plain bytes, for trying functions of modules.

use crate::{Gpu, GpuError, pipelines, readback};

/// Runs a compute entry point over bytes: the module reads a storage buffer at group 0, binding 0,
/// and writes one at group 0, binding 1. At least `threads` threads run along x, rounded up to
/// whole workgroups; the module has to stop those beyond its data itself.
///
/// `output_len` bytes come back, zero where nothing was written; both lengths are rounded up to
/// whole words inside.
///
/// # Errors
/// When there is no such entry point, when lengths or threads are 0 or beyond the adapter's
/// limits, and when the graphics library refuses the module.
pub fn run_compute(
    gpu: &Gpu,
    module: &naga::Module,
    entry: &str,
    input: &[u8],
    output_len: usize,
    threads: u32,
) -> Result<Vec<u8>, GpuError> {
    let found = module.entry_points.iter().find(|e| e.name == entry);
    let Some(point) = found.filter(|e| e.stage == naga::ShaderStage::Compute) else {
        return Err(GpuError::Plan(format!(
            "the module has no compute entry point `{entry}`"
        )));
    };
    let limits = gpu.device().limits();
    let groups = threads.div_ceil(point.workgroup_size[0].max(1));
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
    dispatch(gpu, module, entry, &buffers, groups)?;
    let mut output = readback::buffer(gpu, &buffers[1])?;
    output.truncate(output_len);
    Ok(output)
}

fn dispatch(
    gpu: &Gpu,
    module: &naga::Module,
    entry: &str,
    buffers: &[wgpu::Buffer],
    groups: u32,
) -> Result<(), GpuError> {
    let device = gpu.device();
    let shader = pipelines::shader_module(gpu, entry, module)?;
    let binding = |binding: u32, read_only: bool| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let layout = gpu.create("the bindings", || {
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &[binding(0, true), binding(1, false)],
        })
    })?;
    let pipeline_layout = pipelines::device_layout(gpu, entry, &layout)?;
    let pipeline = gpu.create(&format!("the pipeline of `{entry}`"), || {
        device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: Some(&pipeline_layout),
            module: &shader,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            cache: None,
        })
    })?;
    let entry_of = |binding: u32| wgpu::BindGroupEntry {
        binding,
        resource: buffers[binding as usize].as_entire_binding(),
    };
    let group = gpu.create("the bind group", || {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &[entry_of(0), entry_of(1)],
        })
    })?;
    gpu.attempt(&format!("running `{entry}`"), || {
        let mut encoder = device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(groups, 1, 1);
        }
        gpu.queue().submit([encoder.finish()]);
    })?;
    gpu.wait()
}
