//! Textures and buffers back to the CPU.

use std::sync::mpsc;

use glam::UVec2;
use meniscus_pipeline::Format;

use crate::{Gpu, GpuError, formats};

/// Bytes of a texture that are copied at once.
const BAND_BYTES: u64 = 64 << 20;

/// A picture of numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Pixels {
    /// Width and height.
    pub size: UVec2,
    /// Numbers a pixel.
    pub channels: usize,
    /// All numbers, row by row from the top, a pixel's numbers side by side.
    pub data: Vec<f32>,
}

impl Pixels {
    /// The numbers of a pixel; none outside.
    pub fn at(&self, x: u32, y: u32) -> Option<&[f32]> {
        if x >= self.size.x || y >= self.size.y {
            return None;
        }
        let start = (y as usize * self.size.x as usize + x as usize) * self.channels;
        self.data.get(start..start + self.channels)
    }
}

/// Reads a texture of this format and size.
pub(crate) fn texture(
    gpu: &Gpu,
    texture: &wgpu::Texture,
    format: Format,
    size: UVec2,
) -> Result<Pixels, GpuError> {
    let channels = formats::channels(format);
    let mut data = Vec::with_capacity(size.x as usize * size.y as usize * channels);
    rows(gpu, texture, format, size, |row| {
        formats::decode(format, row, &mut data)
    })?;
    Ok(Pixels {
        size,
        channels,
        data,
    })
}

/// Hands the rows of a texture to `use_row` as bytes, from the top.
pub(crate) fn rows(
    gpu: &Gpu,
    texture: &wgpu::Texture,
    format: Format,
    size: UVec2,
    mut use_row: impl FnMut(&[u8]),
) -> Result<(), GpuError> {
    let row = size.x * formats::texel_bytes(format);
    let pitch = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let rows = u32::try_from(BAND_BYTES / u64::from(pitch))
        .unwrap_or(u32::MAX)
        .clamp(1, size.y);
    let staging = staging(gpu, u64::from(pitch) * u64::from(rows))?;
    for top in (0..size.y).step_by(rows as usize) {
        let height = rows.min(size.y - top);
        gpu.attempt("copying a texture", || {
            let mut encoder = gpu.device().create_command_encoder(&Default::default());
            encoder.copy_texture_to_buffer(
                wgpu::TexelCopyTextureInfo {
                    texture,
                    mip_level: 0,
                    origin: wgpu::Origin3d { x: 0, y: top, z: 0 },
                    aspect: wgpu::TextureAspect::All,
                },
                wgpu::TexelCopyBufferInfo {
                    buffer: &staging,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(pitch),
                        rows_per_image: None,
                    },
                },
                wgpu::Extent3d {
                    width: size.x,
                    height,
                    depth_or_array_layers: 1,
                },
            );
            gpu.queue().submit([encoder.finish()]);
        })?;
        mapped(gpu, &staging, |bytes| {
            for line in bytes.chunks_exact(pitch as usize).take(height as usize) {
                use_row(&line[..row as usize]);
            }
        })?;
    }
    Ok(())
}

/// Reads a buffer; its length is a multiple of four.
pub(crate) fn buffer(gpu: &Gpu, source: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
    let staging = staging(gpu, source.size())?;
    gpu.attempt("copying a buffer", || {
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(source, 0, &staging, 0, source.size());
        gpu.queue().submit([encoder.finish()]);
    })?;
    mapped(gpu, &staging, <[u8]>::to_vec)
}

/// A buffer that can be copied to and mapped for reading.
pub(crate) fn staging(gpu: &Gpu, size: u64) -> Result<wgpu::Buffer, GpuError> {
    let descriptor = wgpu::BufferDescriptor {
        label: Some("read-back"),
        size,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    };
    gpu.create("a read-back buffer", || {
        gpu.device().create_buffer(&descriptor)
    })
}

/// Waits for the GPU and hands a staging buffer's bytes to `use_bytes`.
pub(crate) fn mapped<T>(
    gpu: &Gpu,
    staging: &wgpu::Buffer,
    use_bytes: impl FnOnce(&[u8]) -> T,
) -> Result<T, GpuError> {
    let failed = |message: String| GpuError::Failed {
        doing: "reading back".to_owned(),
        message,
    };
    let (sender, receiver) = mpsc::channel();
    gpu.attempt("mapping a read-back buffer", || {
        staging.map_async(wgpu::MapMode::Read, .., move |result| {
            // A receiver that is gone has given up waiting.
            drop(sender.send(result));
        });
    })?;
    gpu.wait()?;
    let outcome = receiver.recv().map_err(|e| failed(e.to_string()))?;
    outcome.map_err(|e| failed(e.to_string()))?;
    let result = {
        let view = staging
            .get_mapped_range(..)
            .map_err(|e| failed(e.to_string()))?;
        use_bytes(&view)
    };
    staging.unmap();
    Ok(result)
}
