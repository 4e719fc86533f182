//! Adapters, and an opened one.

use std::fmt;
use std::future::Future;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;

use crate::GpuError;
use crate::kept_pipelines::KeptPipelines;

/// How long a submission may take before it counts as one that never ends.
const PATIENCE: Duration = Duration::from_secs(300);

/// Where figures come from: the adapter and its driver.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AdapterFacts {
    /// The adapter's name.
    pub name: String,
    /// The driver's name.
    pub driver: String,
    /// The driver's version and whatever else it says of itself.
    pub driver_info: String,
    /// The graphics interface: `vulkan`, `metal`, `dx12` or `gl`.
    pub backend: String,
    /// `discrete GPU`, `integrated GPU`, `virtual GPU`, `CPU` or `other`.
    pub device_type: String,
}

impl From<wgpu::AdapterInfo> for AdapterFacts {
    fn from(info: wgpu::AdapterInfo) -> Self {
        let device_type = match info.device_type {
            wgpu::DeviceType::DiscreteGpu => "discrete GPU",
            wgpu::DeviceType::IntegratedGpu => "integrated GPU",
            wgpu::DeviceType::VirtualGpu => "virtual GPU",
            wgpu::DeviceType::Cpu => "CPU",
            wgpu::DeviceType::Other => "other",
        };
        Self {
            name: info.name,
            driver: info.driver,
            driver_info: info.driver_info,
            backend: info.backend.to_string(),
            device_type: device_type.to_owned(),
        }
    }
}

impl fmt::Display for AdapterFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}, {})", self.name, self.backend, self.device_type)?;
        if !self.driver.is_empty() {
            write!(f, ", driver {} {}", self.driver, self.driver_info)?;
        }
        Ok(())
    }
}

/// An opened adapter. Cloning shares it.
#[derive(Debug, Clone)]
pub struct Gpu(Arc<Opened>);

#[derive(Debug)]
struct Opened {
    device: wgpu::Device,
    queue: wgpu::Queue,
    facts: AdapterFacts,
    /// What went wrong outside every error scope, the device's loss included; the first one.
    fault: Arc<Mutex<Option<String>>>,
    created: AtomicU64,
    compiled: AtomicU64,
    /// What the driver has compiled in this run and in earlier ones.
    kept: OnceLock<KeptPipelines>,
}

impl Drop for Opened {
    fn drop(&mut self) {
        let fault = self.fault.lock().unwrap_or_else(PoisonError::into_inner);
        let compiled = self.compiled.load(Ordering::Relaxed) > 0;
        if let Some(kept) = self.kept.get().filter(|_| compiled && fault.is_none()) {
            kept.keep();
        }
    }
}

/// The adapters that are there, best first.
pub fn adapters() -> Vec<AdapterFacts> {
    let mut all = enumerate(wgpu::Backends::PRIMARY);
    all.extend(enumerate(wgpu::Backends::SECONDARY));
    all.into_iter().map(|a| a.get_info().into()).collect()
}

fn enumerate(backends: wgpu::Backends) -> Vec<wgpu::Adapter> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        // Layers that check calls are wanted only where the environment asks for them.
        flags: wgpu::InstanceFlags::empty().with_env(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let mut adapters = pollster::block_on(instance.enumerate_adapters(backends));
    adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    adapters
}

/// Whether it can render what pipelines keep between passes; some drivers of older interfaces cannot.
fn renders_floats(adapter: &wgpu::Adapter) -> bool {
    let needed = [
        wgpu::TextureFormat::Rgba16Float,
        wgpu::TextureFormat::Rgba32Float,
    ];
    needed.into_iter().all(|format| {
        let usages = adapter.get_texture_format_features(format).allowed_usages;
        usages.contains(wgpu::TextureUsages::RENDER_ATTACHMENT)
    })
}

/// The best adapter whose name contains `wanted`, or the best that can render floating point; the
/// older interfaces are asked last.
fn choose(wanted: Option<&str>) -> Result<wgpu::Adapter, GpuError> {
    let mut found = Vec::new();
    for backends in [wgpu::Backends::PRIMARY, wgpu::Backends::SECONDARY] {
        for adapter in enumerate(backends) {
            let facts = AdapterFacts::from(adapter.get_info());
            let chosen = match wanted {
                Some(part) => facts.name.to_lowercase().contains(&part.to_lowercase()),
                None => renders_floats(&adapter),
            };
            if chosen {
                return Ok(adapter);
            }
            found.push(facts.to_string());
        }
    }
    Err(GpuError::NoAdapter {
        wanted: wanted.map(str::to_owned),
        found,
    })
}

impl Gpu {
    /// Opens the adapter whose name contains `adapter` (case does not matter), or the best one:
    /// discrete before integrated before virtual before software.
    ///
    /// # Errors
    /// When there is none, with a list of those that are there and the way to a software adapter;
    /// when it cannot be opened.
    pub fn open(adapter: Option<&str>) -> Result<Self, GpuError> {
        Self::keeping(adapter, None)
    }

    /// The same with what the driver compiles kept in a folder (see [`crate::cache_folder`]) until the
    /// next time, where the driver hands it out: Vulkan's do. It is written when the last clone of
    /// what was opened is gone. A folder that cannot be used, and a file that is broken or another
    /// driver's, are as good as none.
    ///
    /// # Errors
    /// As [`Gpu::open`].
    pub fn keeping(adapter: Option<&str>, folder: Option<&Path>) -> Result<Self, GpuError> {
        let adapter = choose(adapter)?;
        let facts = AdapterFacts::from(adapter.get_info());
        let mut useful =
            wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::PIPELINE_STATISTICS_QUERY;
        if folder.is_some() {
            useful |= wgpu::Features::PIPELINE_CACHE;
        }
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("meniscus"),
            required_features: adapter.features() & useful,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|error| {
                GpuError::Failed {
                    doing: format!("opening the adapter {facts}"),
                    message: error.to_string(),
                }
            })?;
        let fault = Arc::new(Mutex::new(None));
        let note = {
            let fault = fault.clone();
            move |message: String| {
                let mut fault = fault.lock().unwrap_or_else(PoisonError::into_inner);
                fault.get_or_insert(message);
            }
        };
        let note_loss = note.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| note(error.to_string())));
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                note_loss(message);
            }
        });
        let opened = Self(Arc::new(Opened {
            device,
            queue,
            facts,
            fault,
            created: AtomicU64::new(0),
            compiled: AtomicU64::new(0),
            kept: OnceLock::new(),
        }));
        if let Some(folder) = folder {
            let kept = opened.attempt("handing compiled pipelines to the driver", || {
                KeptPipelines::open(opened.device(), folder)
            });
            // Without them everything is compiled anew.
            if let Ok(Some(kept)) = kept {
                opened.0.kept.get_or_init(|| kept);
            }
        }
        Ok(opened)
    }

    /// The adapter and its driver.
    pub fn facts(&self) -> &AdapterFacts {
        &self.0.facts
    }

    /// Whether passes can be timed by the GPU.
    pub fn has_timestamps(&self) -> bool {
        self.device()
            .features()
            .contains(wgpu::Features::TIMESTAMP_QUERY)
    }

    /// Whether shader invocations can be counted.
    pub fn has_statistics(&self) -> bool {
        let features = self.device().features();
        features.contains(wgpu::Features::PIPELINE_STATISTICS_QUERY)
    }

    /// Whether shaders run on the CPU.
    pub fn is_software(&self) -> bool {
        self.device().adapter_info().device_type == wgpu::DeviceType::Cpu
    }

    /// Largest width and height of a picture, pixels.
    pub fn max_size(&self) -> u32 {
        self.device().limits().max_texture_dimension_2d
    }

    /// How many GPU objects (shaders, pipelines, textures, buffers, …) were created so far.
    pub fn created(&self) -> u64 {
        self.0.created.load(Ordering::Relaxed)
    }

    /// How many pipelines the driver was asked to compile so far.
    pub fn compiled(&self) -> u64 {
        self.0.compiled.load(Ordering::Relaxed)
    }

    /// What the driver has compiled already, and adds to.
    pub(crate) fn driver_cache(&self) -> Option<&wgpu::PipelineCache> {
        self.0.kept.get().map(KeptPipelines::cache)
    }

    #[cfg(test)]
    pub(crate) fn kept(&self) -> Option<&KeptPipelines> {
        self.0.kept.get()
    }

    pub(crate) fn device(&self) -> &wgpu::Device {
        &self.0.device
    }

    pub(crate) fn queue(&self) -> &wgpu::Queue {
        &self.0.queue
    }

    /// Runs `work`, and turns whatever the graphics library objects to into an error.
    pub(crate) fn attempt<T>(&self, doing: &str, work: impl FnOnce() -> T) -> Result<T, GpuError> {
        self.fault()?;
        let device = self.device();
        let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
        let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let result = work();
        let errors = [
            wait(validation.pop()),
            wait(internal.pop()),
            wait(memory.pop()),
        ];
        if let Some(error) = errors.into_iter().flatten().next() {
            return Err(GpuError::Failed {
                doing: doing.to_owned(),
                message: error.to_string(),
            });
        }
        self.fault()?;
        Ok(result)
    }

    /// [`Self::attempt`] for creations, which are counted.
    pub(crate) fn create<T>(&self, what: &str, work: impl FnOnce() -> T) -> Result<T, GpuError> {
        self.0.created.fetch_add(1, Ordering::Relaxed);
        self.attempt(&format!("creating {what}"), work)
    }

    /// [`Self::create`] for pipelines, of which the driver compiles the shaders.
    pub(crate) fn compile<T>(&self, what: &str, work: impl FnOnce() -> T) -> Result<T, GpuError> {
        self.0.compiled.fetch_add(1, Ordering::Relaxed);
        self.create(what, work)
    }

    /// Waits until everything submitted is done.
    pub(crate) fn wait(&self) -> Result<(), GpuError> {
        let all = wgpu::PollType::Wait {
            submission_index: None,
            timeout: Some(PATIENCE),
        };
        self.device().poll(all).map_err(|error| {
            GpuError::Lost(format!("{error} (waited up to {} s)", PATIENCE.as_secs()))
        })?;
        self.fault()
    }

    /// The error that came outside every scope, if there was one.
    fn fault(&self) -> Result<(), GpuError> {
        let fault = self.0.fault.lock().unwrap_or_else(PoisonError::into_inner);
        fault
            .clone()
            .map_or(Ok(()), |message| Err(GpuError::Lost(message)))
    }
}

fn wait<T>(future: impl Future<Output = T>) -> T {
    pollster::block_on(future)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_adapter_is_told_with_those_that_are_there() {
        let error = Gpu::open(Some("no such adapter")).unwrap_err().to_string();
        assert!(error.contains("`no such adapter`"), "{error}");
        assert!(error.contains("mesa-vulkan-drivers libvulkan1"), "{error}");
        for adapter in adapters() {
            assert!(error.contains(&adapter.name), "{error}");
        }
    }

    #[test]
    fn a_part_of_the_name_in_any_case_opens_an_adapter() {
        let facts = Gpu::open(None)
            .unwrap_or_else(|e| panic!("{e}"))
            .facts()
            .clone();
        let gpu = Gpu::open(Some(&facts.name.to_uppercase())).unwrap();
        assert_eq!(gpu.facts().name, facts.name);
    }

    #[test]
    fn what_the_library_objects_to_is_an_error_that_says_what_was_done() {
        let gpu = Gpu::open(None).unwrap_or_else(|e| panic!("{e}"));
        let descriptor = wgpu::BufferDescriptor {
            label: None,
            size: 16,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::MAP_WRITE,
            mapped_at_creation: false,
        };
        let made = gpu.create("a buffer of two minds", || {
            gpu.device().create_buffer(&descriptor)
        });
        let error = made.unwrap_err().to_string();
        assert!(
            error.starts_with("creating a buffer of two minds: "),
            "{error}"
        );
        gpu.create("another", || ()).unwrap();
    }
}
