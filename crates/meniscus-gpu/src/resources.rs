//! The textures and buffers between the passes of a plan.

use std::collections::BTreeMap;

use glam::UVec2;
use meniscus_pipeline::{Buffer, Format, Plan, Size};

use crate::host_scene::Views;
use crate::sharing::{self, Wanted};
use crate::uses::{self, Uses};
use crate::{Gpu, GpuError, formats};

/// A texture with what is known of it.
#[derive(Debug, Clone)]
pub(crate) struct Target {
    pub texture: wgpu::Texture,
    pub view: wgpu::TextureView,
    pub format: Format,
    pub size: UVec2,
    /// Textures of the same number share their memory.
    pub memory: usize,
    /// The first and the last pass that touch it; none where it is not to be shared.
    pub life: Option<[usize; 2]>,
}

/// Everything that lies between passes.
#[derive(Debug)]
pub(crate) struct Resources {
    pub textures: BTreeMap<String, Target>,
    pub buffers: BTreeMap<String, wgpu::Buffer>,
    /// What they are as large as.
    pub views: Views,
    /// Bilinear, clamped to the edge.
    pub sampler: wgpu::Sampler,
}

/// Whether a picture of this size can be made.
///
/// # Errors
/// When a side is 0 or exceeds the adapter's limit, which is named.
pub(crate) fn check_size(gpu: &Gpu, what: &str, size: UVec2) -> Result<(), GpuError> {
    let limit = gpu.max_size();
    if size.min_element() == 0 || size.max_element() > limit {
        return Err(GpuError::Size(format!(
            "{what} of {}×{} pixels cannot be made: width and height are to be at least 1 and at most \
             {limit}, the limit max_texture_dimension_2d of {}",
            size.x,
            size.y,
            gpu.facts().name
        )));
    }
    Ok(())
}

/// What must be alike for textures to share memory: format, size, and whether shaders store to it.
pub(crate) type Kind = (Format, UVec2, bool);

impl Resources {
    /// Makes the textures and buffers of a plan. With `share`, textures that are never needed at
    /// once share memory; what comes out of the frame is not among them.
    pub fn new(gpu: &Gpu, plan: &Plan, views: &Views, share: bool) -> Result<Self, GpuError> {
        check_size(gpu, "a picture", views.size(Size::Frame))?;
        check_size(
            gpu,
            "a picture with its guard band",
            views.size(Size::Guarded),
        )?;
        let textures = textures(gpu, plan, views, share)?;
        let mut buffers = BTreeMap::new();
        for (name, buffer) in &plan.buffers {
            let bytes = buffer_bytes(buffer, views.size(Size::Frame));
            buffers.insert(name.clone(), storage(gpu, name, bytes, buffer.indirect)?);
        }
        let sampler = gpu.create("the sampler", || {
            gpu.device().create_sampler(&wgpu::SamplerDescriptor {
                label: Some("linear_sampler"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            })
        })?;
        Ok(Self {
            textures,
            buffers,
            views: *views,
            sampler,
        })
    }

    /// Bytes of all textures.
    pub fn texture_bytes(&self) -> u64 {
        let mut seen = Vec::new();
        let first = |t: &&Target| {
            let first = !seen.contains(&t.memory);
            seen.push(t.memory);
            first
        };
        self.textures.values().filter(first).map(bytes).sum()
    }

    /// Bytes of all textures if none shared memory with another.
    pub fn texture_sum_bytes(&self) -> u64 {
        self.textures.values().map(bytes).sum()
    }

    /// Bytes of the textures that are needed at once.
    pub fn texture_peak_bytes(&self) -> u64 {
        let needed: Vec<_> = self.textures.values().map(|t| (bytes(t), t.life)).collect();
        sharing::peak(&needed)
    }

    /// A texture that later took the memory of this one over.
    pub fn successor(&self, name: &str) -> Option<&str> {
        let of = self.textures.get(name)?;
        let later = |t: &Target| t.memory == of.memory && t.life > of.life;
        let mut all = self.textures.iter();
        all.find(|(_, t)| later(t)).map(|(name, _)| name.as_str())
    }

    /// Bytes of all buffers.
    pub fn buffer_bytes(&self) -> u64 {
        self.buffers.values().map(wgpu::Buffer::size).sum()
    }
}

fn bytes(t: &Target) -> u64 {
    texture_bytes(t.format, t.size)
}

fn texture_bytes(format: Format, size: UVec2) -> u64 {
    u64::from(size.x) * u64::from(size.y) * u64::from(formats::texel_bytes(format))
}

/// Bytes of a texture of a kind.
pub(crate) fn kind_bytes((format, size, _): Kind) -> u64 {
    texture_bytes(format, size)
}

/// Bytes of a buffer in whole words, for a frame of this size; none where they are too many to count.
pub(crate) fn buffer_bytes(buffer: &Buffer, frame: UVec2) -> Option<u64> {
    let pixels = u64::from(frame.x) * u64::from(frame.y);
    let bytes = buffer.bytes_per_pixel.checked_mul(pixels)?;
    bytes.checked_add(buffer.bytes)?.checked_next_multiple_of(4)
}

/// The textures of a plan in the order of their names, and the memory that each has, by a number.
pub(crate) fn placed(plan: &Plan, views: &Views, share: bool) -> (Vec<Wanted<Kind>>, Vec<usize>) {
    let uses = Uses::new(plan);
    let lives = uses.lifetimes();
    let life = |name: &str| {
        let comes_out = name == plan.output || plan.shown.as_deref() == Some(name);
        let known = uses.names.iter().position(|known| *known == name);
        known.filter(|_| share && !comes_out).map(|i| lives[i])
    };
    let stored = uses::stored(plan);
    let wanted: Vec<Wanted<Kind>> = plan
        .textures
        .iter()
        .map(|(name, texture)| Wanted {
            kind: (
                texture.format,
                views.size(texture.size),
                stored.contains(name.as_str()),
            ),
            life: life(name),
        })
        .collect();
    let memories = sharing::memories(&wanted);
    (wanted, memories)
}

fn textures(
    gpu: &Gpu,
    plan: &Plan,
    views: &Views,
    share: bool,
) -> Result<BTreeMap<String, Target>, GpuError> {
    let (wanted, memories) = placed(plan, views, share);
    let mut made: Vec<Target> = Vec::new();
    let mut textures = BTreeMap::new();
    for ((name, wanted), memory) in plan.textures.keys().zip(&wanted).zip(memories) {
        let held = made.iter().find(|t| t.memory == memory);
        let target = match held {
            Some(held) => Target {
                life: wanted.life,
                ..held.clone()
            },
            None => target(gpu, name, wanted, memory)?,
        };
        made.push(target.clone());
        textures.insert(name.clone(), target);
    }
    Ok(textures)
}

fn target(gpu: &Gpu, name: &str, wanted: &Wanted<Kind>, memory: usize) -> Result<Target, GpuError> {
    let (format, size, stored) = wanted.kind;
    let mut usage = wgpu::TextureUsages::RENDER_ATTACHMENT
        | wgpu::TextureUsages::TEXTURE_BINDING
        | wgpu::TextureUsages::COPY_SRC;
    if stored {
        usage |= wgpu::TextureUsages::STORAGE_BINDING;
    }
    // Depth cannot be copied into on every adapter.
    if !formats::is_depth(format) {
        usage |= wgpu::TextureUsages::COPY_DST;
    }
    let descriptor = wgpu::TextureDescriptor {
        label: Some(name),
        size: wgpu::Extent3d {
            width: size.x,
            height: size.y,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: formats::to_wgpu(format),
        usage,
        view_formats: &[],
    };
    let what = format!("the texture `{name}` of {}×{} pixels", size.x, size.y);
    let (texture, view) = gpu.create(&what, || {
        let texture = gpu.device().create_texture(&descriptor);
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        (texture, view)
    })?;
    Ok(Target {
        texture,
        view,
        format,
        size,
        memory,
        life: wanted.life,
    })
}

/// A buffer of this many bytes, a multiple of 4; too many are none.
fn storage(
    gpu: &Gpu,
    name: &str,
    bytes: Option<u64>,
    indirect: bool,
) -> Result<wgpu::Buffer, GpuError> {
    let limits = gpu.device().limits();
    let limit = limits
        .max_buffer_size
        .min(limits.max_storage_buffer_binding_size);
    let Some(size) = bytes.filter(|&b| b > 0 && b <= limit) else {
        let bytes = bytes.map_or("too many".to_owned(), |b| b.to_string());
        return Err(GpuError::Size(format!(
            "the buffer `{name}` of {bytes} bytes cannot be made: it is to have at least 1 and at most \
             {limit} bytes, the limit max_storage_buffer_binding_size of {}",
            gpu.facts().name
        )));
    };
    let mut usage =
        wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
    if indirect {
        usage |= wgpu::BufferUsages::INDIRECT;
    }
    let descriptor = wgpu::BufferDescriptor {
        label: Some(name),
        size,
        usage,
        mapped_at_creation: false,
    };
    gpu.create(&format!("the buffer `{name}`"), || {
        gpu.device().create_buffer(&descriptor)
    })
}
