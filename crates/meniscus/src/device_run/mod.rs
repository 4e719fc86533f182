//! The passes of one pipeline one by one, each on the CPU or on the GPU.
//!
//! Where there is a GPU, it holds the textures and buffers between passes, and a pass on the CPU
//! takes from there what it reads. Without one they are held here, and what draws would make is
//! missing.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::UVec2;
use meniscus_cpu::{CpuError, Store, Texels, is_drawn, run_pass};
use meniscus_gpu::{Frame, Gpu, GpuError, HostValues, PipelineCache, SceneBuffers, Skipping};
use meniscus_pipeline::{Format, Pipeline, Plan, Size};
use meniscus_scene::Scene;

use crate::ablation::AblationError;
use crate::facts::facts_of;
use crate::project::Project;

mod difference;

pub use difference::{PassDifference, bound};

/// What runs a pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Device {
    /// The evaluator, on all cores.
    Cpu,
    /// The graphics adapter.
    Gpu,
}

/// Why a pass did not run.
#[derive(Debug)]
pub enum PassError {
    /// There is no pass of this name.
    Unknown {
        /// What was asked for.
        name: String,
        /// What there is.
        known: Vec<String>,
    },
    /// The pass cannot run on the CPU.
    Cpu(CpuError),
    /// The pass reads what a draw makes, and there is no GPU to draw.
    NotDrawn {
        /// The pass.
        pass: String,
        /// What it reads.
        resource: String,
        /// What would make it.
        draw: String,
    },
    /// There is no GPU.
    NoGpu {
        /// The pass.
        pass: String,
    },
    /// The GPU refuses.
    Gpu(GpuError),
}

impl std::fmt::Display for PassError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unknown { name, known } => {
                let known = known.join(", ");
                write!(
                    f,
                    "there is no pass `{name}` for this scene; there is {known}"
                )
            }
            Self::Cpu(error) => error.fmt(f),
            Self::NotDrawn {
                pass,
                resource,
                draw,
            } => write!(
                f,
                "pass `{pass}` uses `{resource}`, which hangs on what `{draw}` draws; drawing takes a GPU"
            ),
            Self::NoGpu { pass } => {
                write!(f, "pass `{pass}` is to run on a GPU, and there is none")
            }
            Self::Gpu(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for PassError {}

impl From<CpuError> for PassError {
    fn from(error: CpuError) -> Self {
        Self::Cpu(error)
    }
}

impl From<GpuError> for PassError {
    fn from(error: GpuError) -> Self {
        Self::Gpu(error)
    }
}

/// The passes of a pipeline for one scene and picture size.
#[derive(Debug)]
pub struct Passes {
    plan: Plan,
    host: HostValues,
    store: Store,
    frame: Option<Frame>,
    /// What draws would have made, and which of them.
    missing: BTreeMap<String, String>,
    size: [u32; 2],
}

impl Passes {
    /// Makes them ready. Without a GPU, draws cannot run.
    ///
    /// # Errors
    /// When the pipeline does not compose, and when the GPU refuses the scene or the size.
    pub fn new(
        project: &Project,
        gpu: Option<&Gpu>,
        pipeline: &Pipeline,
        scene: &Scene,
        size: [u32; 2],
    ) -> Result<Self, AblationError> {
        let plan = Plan::new(pipeline, &project.composer, &facts_of(scene, size), false)?;
        let host = HostValues::new(scene, UVec2::from_array(size));
        let frame = match gpu {
            Some(gpu) => Some(Frame::with(
                gpu,
                &plan,
                Arc::new(SceneBuffers::new(gpu, scene)?),
                UVec2::from_array(size),
                &PipelineCache::default(),
                Skipping::NONE,
            )?),
            None => None,
        };
        let store = Store::new(&plan, |view| host.view_size(view).to_array());
        Ok(Self {
            plan,
            host,
            store,
            frame,
            missing: BTreeMap::new(),
            size,
        })
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The number of the pass of this name.
    ///
    /// # Errors
    /// When there is none.
    pub fn find(&self, name: &str) -> Result<usize, PassError> {
        let mut passes = self.plan.passes.iter();
        passes
            .position(|pass| pass.name == name)
            .ok_or_else(|| PassError::Unknown {
                name: name.to_owned(),
                known: self.plan.passes.iter().map(|p| p.name.clone()).collect(),
            })
    }

    /// Whether a pass draws triangles, which takes a GPU.
    pub fn is_drawn(&self, index: usize) -> bool {
        self.plan.passes.get(index).is_some_and(is_drawn)
    }

    /// Runs the pass of this number; all before it have to have run. Without a GPU a draw is noted as
    /// missing: who reads what it makes cannot run.
    ///
    /// # Errors
    /// See [`PassError`].
    pub fn run(&mut self, index: usize, device: Device) -> Result<(), PassError> {
        let pass = self.pass(index)?;
        match (device, &self.frame) {
            (Device::Gpu, Some(frame)) => Ok(frame.run_pass(index)?),
            (Device::Cpu, Some(frame)) => {
                frame.begin_pass(index)?;
                self.fetch(index)?;
                self.evaluate(index)?;
                self.hand_over(index)
            }
            (_, None) if is_drawn(&pass) => {
                for name in meniscus_cpu::writes(&pass) {
                    self.missing.insert(name.to_owned(), pass.name.clone());
                }
                Ok(())
            }
            (Device::Gpu, None) => Err(PassError::NoGpu { pass: pass.name }),
            (Device::Cpu, None) => {
                let used = meniscus_cpu::uses(&pass);
                let missing = used
                    .iter()
                    .find_map(|name| self.missing.get_key_value(*name));
                if let Some((name, draw)) = missing {
                    let (resource, draw) = (name.clone(), draw.clone());
                    // What this pass would have made is missing likewise.
                    for name in meniscus_cpu::writes(&pass) {
                        self.missing.insert(name.to_owned(), draw.clone());
                    }
                    return Err(PassError::NotDrawn {
                        pass: pass.name.clone(),
                        resource,
                        draw,
                    });
                }
                self.evaluate(index)
            }
        }
    }

    /// Runs a compute or screen pass on both, from the same inputs; what the GPU makes stays. One
    /// difference for each texture and buffer that it writes.
    ///
    /// # Errors
    /// See [`PassError`].
    pub fn compare(&mut self, index: usize) -> Result<Vec<PassDifference>, PassError> {
        let pass = self.pass(index)?;
        let Some(frame) = &self.frame else {
            return Err(PassError::NoGpu { pass: pass.name });
        };
        frame.begin_pass(index)?;
        self.fetch(index)?;
        self.evaluate(index)?;
        let on_cpu = self.store.clone();
        if let Some(frame) = &self.frame {
            frame.run_pass(index)?;
        }
        self.fetch(index)?;
        let mut found = Vec::new();
        for name in meniscus_cpu::writes(&pass) {
            let is_list = self.plan.lists.values().any(|list| list == name);
            found.extend(difference::of(&on_cpu, &self.store, name, is_list));
        }
        Ok(found)
    }

    /// A texture or buffer as it stands.
    ///
    /// # Errors
    /// When the GPU does not give it.
    pub fn store(&mut self) -> Result<&Store, PassError> {
        if let Some(frame) = &self.frame {
            for name in self.plan.textures.keys() {
                self.store
                    .textures
                    .insert(name.clone(), texels(frame, name)?);
            }
            for name in self.plan.buffers.keys() {
                self.store.buffers.insert(name.clone(), words(frame, name)?);
            }
        }
        Ok(&self.store)
    }

    /// Width and height of the picture.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    fn pass(&self, index: usize) -> Result<meniscus_pipeline::PlannedPass, PassError> {
        let pass = self.plan.passes.get(index).cloned();
        pass.ok_or_else(|| PassError::Unknown {
            name: index.to_string(),
            known: self.plan.passes.iter().map(|p| p.name.clone()).collect(),
        })
    }

    /// Takes from the GPU what a pass reads and writes.
    fn fetch(&mut self, index: usize) -> Result<(), PassError> {
        let Some(frame) = &self.frame else {
            return Ok(());
        };
        for name in meniscus_cpu::uses(&self.plan.passes[index]) {
            if self.plan.textures.contains_key(name) {
                self.store
                    .textures
                    .insert(name.to_owned(), texels(frame, name)?);
            } else if self.plan.buffers.contains_key(name) {
                self.store
                    .buffers
                    .insert(name.to_owned(), words(frame, name)?);
            }
        }
        Ok(())
    }

    fn evaluate(&mut self, index: usize) -> Result<(), PassError> {
        let host = &self.host;
        let size = |view: Size| host.view_size(view).to_array();
        let bytes = |pass: &_, binding: &_| host.bytes(pass, binding);
        Ok(run_pass(
            &self.plan.passes[index],
            &mut self.store,
            &bytes,
            &size,
        )?)
    }

    /// Gives the GPU what a pass has written.
    fn hand_over(&self, index: usize) -> Result<(), PassError> {
        let Some(frame) = &self.frame else {
            return Ok(());
        };
        for name in meniscus_cpu::writes(&self.plan.passes[index]) {
            if let Some(texels) = self.store.textures.get(name) {
                frame.write_texture_words(name, &texels.words)?;
            } else if let Some(words) = self.store.buffers.get(name) {
                let bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
                frame.write_buffer(name, &bytes)?;
            }
        }
        Ok(())
    }
}

fn texels(frame: &Frame, name: &str) -> Result<Texels, GpuError> {
    let read = frame.texture_words(name)?;
    Ok(Texels {
        size: read.size,
        format: read.format,
        words: read.words,
    })
}

fn words(frame: &Frame, name: &str) -> Result<Vec<u32>, GpuError> {
    let bytes = frame.read_buffer(name)?;
    let word = |b: &[u8]| u32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    Ok(bytes.chunks_exact(4).map(word).collect())
}

/// Linear RGB of the texels of a texture.
pub fn colours(texels: &Texels) -> Vec<[f32; 3]> {
    let whole = matches!(texels.format, Format::R32Uint | Format::Rgba32Uint);
    let number = |word: u32| match whole {
        true => word as f32,
        false => f32::from_bits(word),
    };
    let rgb = |t: &[u32; 4]| [number(t[0]), number(t[1]), number(t[2])];
    texels.words.iter().map(rgb).collect()
}
