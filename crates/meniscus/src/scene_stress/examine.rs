//! What must hold of a frame, whatever the scene.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::UVec2;
use meniscus_gpu::{Frame, Gpu, GpuError, PipelineCache, SceneBuffers, Skipping};
use meniscus_pipeline::{Facts, Format, Pipeline, Plan, Pruning};
use meniscus_scene::Scene;

use super::Fault;
use crate::facts::facts_of;
use crate::project::Project;

/// Renders scenes with some pipelines and looks at all that is left behind.
pub(crate) struct Examiner<'a> {
    pub project: &'a Project,
    pub gpu: &'a Gpu,
    pub pipelines: &'a [Pipeline],
    cache: PipelineCache,
    plans: BTreeMap<Kind, Arc<Plan>>,
}

/// What plans are told apart by: the pipeline's index, the facts, what is left out, and whether it
/// tells what is shown.
type Kind = (usize, Facts, Pruning, bool);

/// What a plan's textures and buffers hold: numbers and bytes, by name.
#[derive(Debug, Default, PartialEq)]
struct Held {
    /// Bits of the numbers, and how many there are to a pixel.
    textures: BTreeMap<String, (usize, Vec<u32>)>,
    buffers: BTreeMap<String, Vec<u8>>,
}

/// What was rendered, in so far as it is held to the truth.
#[derive(Debug)]
pub(crate) struct Rendered {
    /// World point and object id of which each pixel shows the colour; empty where the pipeline
    /// cannot tell.
    pub shown: Vec<[f32; 4]>,
    /// Whether some pass traces the scene's triangles.
    pub traces: bool,
}

/// Buffer that whoever traces the scene's triangles reads.
const TRACED: &str = "triangles";

impl<'a> Examiner<'a> {
    pub fn new(project: &'a Project, gpu: &'a Gpu, pipelines: &'a [Pipeline]) -> Self {
        Self {
            project,
            gpu,
            pipelines,
            cache: PipelineCache::default(),
            plans: BTreeMap::new(),
        }
    }

    /// Uploads a scene.
    pub fn upload(&self, scene: &Scene) -> Result<Arc<SceneBuffers>, Fault> {
        Ok(Arc::new(
            SceneBuffers::new(self.gpu, scene).map_err(refused_or_not)?,
        ))
    }

    /// Renders all of the plan twice, what is left when all is left out that may be, and what is shown.
    ///
    /// # Errors
    /// What does not hold: a number that is none, two frames that differ, a complaint of the driver.
    pub fn render(
        &mut self,
        pipeline: usize,
        scene: &Scene,
        buffers: &Arc<SceneBuffers>,
        size: [u32; 2],
    ) -> Result<Rendered, Fault> {
        let facts = facts_of(scene, size);
        let size = UVec2::from_array(size);
        let plan = self.plan((pipeline, facts, Pruning::None, false))?;
        let traces = plan
            .passes
            .iter()
            .flat_map(|pass| &pass.shader.bindings)
            .any(|binding| binding.resource == TRACED);
        let mut frame = self.frame(&plan, buffers, size, Skipping::NONE)?;
        let first = held(&mut frame)?;
        let again = held(&mut frame)?;
        equal(&first, &again, "a second frame")?;
        // Which of two surfaces in one place is seen is decided by rounding, which other shaders do
        // otherwise.
        let pruning = match has_sheet_in_water(scene) {
            true => Pruning::None,
            false => Pruning::Exact,
        };
        let plan = self.plan((pipeline, facts, pruning, false))?;
        let mut other = self.frame(&plan, buffers, size, Skipping::ALL)?;
        other.render().map_err(broken)?;
        let whole = Held::default().with(&other, &plan.output)?;
        equal(&whole, &first, "a frame that saves what it can")?;
        let plan = self.plan((pipeline, facts, Pruning::Approximate, true))?;
        let Some(texture) = plan.shown.clone() else {
            return Ok(Rendered {
                shown: Vec::new(),
                traces,
            });
        };
        let mut frame = self.frame(&plan, buffers, size, Skipping::NONE)?;
        held(&mut frame)?;
        let texels = frame.read(&texture).map_err(broken)?;
        let texel = |t: &[f32]| [t[0], t[1], t[2], t[3]];
        Ok(Rendered {
            shown: texels.data.chunks_exact(4).map(texel).collect(),
            traces,
        })
    }

    fn frame(
        &self,
        plan: &Plan,
        buffers: &Arc<SceneBuffers>,
        size: UVec2,
        skipping: Skipping,
    ) -> Result<Frame, Fault> {
        Frame::with(self.gpu, plan, buffers.clone(), size, &self.cache, skipping)
            .map_err(refused_or_not)
    }

    fn plan(&mut self, kind: Kind) -> Result<Arc<Plan>, Fault> {
        if let Some(known) = self.plans.get(&kind) {
            return Ok(known.clone());
        }
        let (index, facts, pruning, shown) = &kind;
        let pipeline = &self.pipelines[*index];
        let plan = Plan::pruned(pipeline, &self.project.composer, facts, *pruning, *shown)
            .map_err(|report| Fault::Refused(report.to_string()))?;
        let plan = Arc::new(plan);
        self.plans.insert(kind, plan.clone());
        Ok(plan)
    }
}

/// Nearer than this to the rest plane, metres, a triangle that runs along it lies in it: beyond what
/// 32-bit floats can tell apart of a few kilometres.
const IN_WATER: f64 = 1e-3;

/// Whether a triangle lies in the water's rest plane.
pub(crate) fn has_sheet_in_water(scene: &Scene) -> bool {
    let mesh = &scene.mesh;
    let in_water = |corner: &u32| {
        let z = mesh.positions.get(*corner as usize).map(|p| f64::from(p.z));
        z.is_some_and(|z| (z - scene.water.level).abs() <= IN_WATER)
    };
    let mut triangles = mesh.triangles.iter();
    triangles.any(|triangle| triangle.corners.iter().all(in_water))
}

/// Renders a frame and reads everything in it; numbers have to be numbers.
fn held(frame: &mut Frame) -> Result<Held, Fault> {
    frame.render().map_err(broken)?;
    let mut held = Held::default();
    for name in frame.plan().textures.keys() {
        held = held.with(frame, name)?;
    }
    for name in frame.plan().buffers.keys() {
        let mut bytes = frame.read_buffer(name).map_err(broken)?;
        if frame.plan().lists.values().any(|list| list == name) {
            sort_list(&mut bytes);
        }
        held.buffers.insert(name.clone(), bytes);
    }
    Ok(held)
}

impl Held {
    /// With a texture of a frame.
    fn with(mut self, frame: &Frame, name: &str) -> Result<Self, Fault> {
        let pixels = frame.read(name).map_err(broken)?;
        let format = frame.plan().textures.get(name).map(|t| t.format);
        let whole = matches!(format, Some(Format::R32Uint | Format::Rgba32Uint));
        let none = pixels.data.iter().position(|n| !n.is_finite());
        if let Some(at) = none.filter(|_| !whole) {
            let pixel = (at / pixels.channels) as u32;
            let wrong = pixels.data.iter().filter(|n| !n.is_finite()).count();
            let (x, y) = (pixel % pixels.size.x, pixel / pixels.size.x);
            let number = pixels.data[at];
            return Err(Fault::NotFinite(format!(
                "the texture `{name}` of {}×{} texels holds {wrong} numbers that are none, first \
                 {number} at {x}, {y}",
                pixels.size.x, pixels.size.y
            )));
        }
        let bits = pixels.data.iter().map(|n| n.to_bits()).collect();
        self.textures
            .insert(name.to_owned(), (pixels.channels, bits));
        Ok(self)
    }
}

/// Puts the pixels of a list in order, and leaves out what lies beyond its end: threads append as
/// they come, and what stands there is the last frame's.
fn sort_list(bytes: &mut Vec<u8>) {
    let mut words: Vec<u32> = bytes
        .chunks_exact(4)
        .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        .collect();
    let count = words.first().map_or(0, |count| *count as usize);
    words.truncate(count.saturating_add(1));
    if let Some((_, pixels)) = words.split_first_mut() {
        pixels.sort_unstable();
    }
    *bytes = words.iter().flat_map(|word| word.to_le_bytes()).collect();
}

fn equal(first: &Held, second: &Held, what: &str) -> Result<(), Fault> {
    for (name, (channels, bits)) in &first.textures {
        let other = &second.textures[name].1;
        if let Some(at) = bits.iter().zip(other).position(|(a, b)| a != b) {
            let differing = bits.iter().zip(other).filter(|(a, b)| a != b).count();
            return Err(Fault::Unequal(format!(
                "{what} differs in {differing} numbers of the texture `{name}`, first at pixel {}: {} and {}",
                at / channels,
                f32::from_bits(bits[at]),
                f32::from_bits(other[at])
            )));
        }
    }
    for (name, bytes) in &first.buffers {
        if *bytes != second.buffers[name] {
            return Err(Fault::Unequal(format!(
                "{what} differs in the buffer `{name}`"
            )));
        }
    }
    Ok(())
}

/// What an adapter or the product says no to in words is no fault.
fn refused_or_not(error: GpuError) -> Fault {
    match error {
        GpuError::Size(_) | GpuError::Scene(_) => Fault::Refused(error.to_string()),
        _ => broken(error),
    }
}

fn broken(error: GpuError) -> Fault {
    Fault::Driver(error.to_string())
}
