//! Query sets with the way of their results to the CPU.

use crate::{Gpu, GpuError, readback};

/// Queries whose results are 64-bit numbers.
#[derive(Debug)]
pub(crate) struct Queries {
    pub set: wgpu::QuerySet,
    count: u32,
    resolved: wgpu::Buffer,
    staging: wgpu::Buffer,
}

impl Queries {
    /// So many queries, each of which gives so many numbers.
    pub fn new(gpu: &Gpu, ty: wgpu::QueryType, count: u32, numbers: u32) -> Result<Self, GpuError> {
        let device = gpu.device();
        let set = gpu.create("queries", || {
            device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("queries"),
                ty,
                count,
            })
        })?;
        let size = u64::from(count) * u64::from(numbers) * u64::from(wgpu::QUERY_SIZE);
        let resolved = gpu.create("a buffer for queries", || {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("queries"),
                size,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            })
        })?;
        let staging = readback::staging(gpu, size)?;
        Ok(Self {
            set,
            count,
            resolved,
            staging,
        })
    }

    /// Records the results' way into the staging buffer.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.set, 0..self.count, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.staging, 0, self.staging.size());
    }

    /// The results, once what recorded them has been submitted.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<u64>, GpuError> {
        readback::mapped(gpu, &self.staging, |bytes| {
            bytes
                .chunks_exact(8)
                .map(bytemuck::pod_read_unaligned)
                .collect()
        })
    }
}
